"""PGA and PGV of analytic pulses, to machine precision: closed forms, at the zeros of their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import erf

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.excitation import BELL, LINEAR, WAVES

Array = NDArray[np.float64]
Law = Callable[[Array, Array], Array]
"""Rows of pieces (k, PIECE_WIDTH) and times (k, j) -> values (k, j)."""

_erf = np.vectorize(erf, otypes=[float])

_PER_CYCLE = 128
"""Points per cycle among which changes of sign are sought."""

_POINTS = (256, 65536)
"""Fewest and most points over a piece."""

_AT_ONCE = 2_000_000
"""Points looked at at a time."""

_HALVINGS = 45


def extremes(table: Array, until: Array) -> tuple[Array, Array]:
    """Largest |acceleration| and |velocity| of pulses (n, m, PIECE_WIDTH), each cut off at a time (n,)."""
    n = len(table)
    pga, pgv, velocity = np.zeros(n), np.zeros(n), np.zeros(n)
    for kind, part, rows, begin, end in _alike(table, until):
        a, v, gained = _piece(kind, rows, begin, end, velocity[part])
        pga[part], pgv[part] = np.maximum(pga[part], a), np.maximum(pgv[part], v)
        velocity[part] += gained
    return pga, pgv


def extremes_of_both_signs(table: Array, until: Array) -> Array:
    """Largest acceleration of pulses (n, m, PIECE_WIDTH) cut off at a time (n,), and of them turned round: (n, 2).

    [m/s²], none below 0.
    """
    found = np.zeros((len(table), 2))
    for kind, part, rows, begin, end in _alike(table, until):
        a = _accelerations(kind, rows, begin, end)
        found[part] = np.maximum(found[part], np.column_stack([a.max(axis=1), -a.min(axis=1)]))
    return found


def _alike(table: Array, until: Array) -> Iterator[tuple[int, NDArray[np.intp], Array, Array, Array]]:
    """Pieces of one kind, one after another, some cases at a time: kind, cases, rows, begin and end of each."""
    for j in range(table.shape[1]):
        begin, end = table[:, j, 0], np.minimum(table[:, j, 1], until)
        for kind in (LINEAR, WAVES, BELL):
            (which,) = np.nonzero((end > begin) & (table[:, j, 2] == kind))
            step = max(_AT_ONCE // _points(kind, table[which, j], end[which] - begin[which]), 1)
            for start in range(0, len(which), step):
                part = which[start : start + step]
                yield kind, part, table[part, j], begin[part], end[part]


def _piece(kind: int, rows: Array, begin: Array, end: Array, before: Array) -> tuple[Array, Array, Array]:
    """Peaks of |a| and |v| over a piece, and the velocity gained in it; `before` is the velocity at its beginning."""
    acceleration, _, path = _LAWS[kind]
    if _one_wave(kind, rows):
        steepest = _zeros_of_sine(rows, begin, 0.0)
    elif kind == LINEAR:
        with np.errstate(all="ignore"):
            steepest = (begin - rows[:, 3] / rows[:, 4])[:, None]
    else:
        steepest = _zeros(kind, acceleration, rows, begin, end)
    times = np.column_stack([begin, end, _inside(steepest, begin, end)])
    reached = before[:, None] + path(rows, np.broadcast_to(begin[:, None], times.shape), times)
    largest = np.abs(_accelerations(kind, rows, begin, end)).max(axis=1)
    return largest, np.abs(reached).max(axis=1), reached[:, 1] - before


def _accelerations(kind: int, rows: Array, begin: Array, end: Array) -> Array:
    """Acceleration at both ends of a piece and where its slope is zero in between, (k, j)."""
    acceleration, slope, _ = _LAWS[kind]
    if _one_wave(kind, rows):
        highest = _zeros_of_sine(rows, begin, 0.5)
    elif kind == LINEAR:
        highest = begin[:, None]
    else:
        highest = _zeros(kind, slope, rows, begin, end)
    return acceleration(rows, np.column_stack([begin, end, _inside(highest, begin, end)]))


def _one_wave(kind: int, rows: Array) -> bool:
    """Whether pieces are one sine each, whose extremes are where they always are."""
    return kind == WAVES and not rows[:, [7, 10]].any()


def _inside(times: Array, begin: Array, end: Array) -> Array:
    """Times of a piece; others are moved to its beginning."""
    begin, end = begin[:, None], end[:, None]
    return np.where((times > begin) & (times < end), times, begin)


def _zeros_of_sine(rows: Array, begin: Array, shift: float) -> Array:
    """First two times from `begin` on at which w (t - t_ref) + phi = (k + shift) pi."""
    w, phi = rows[:, 5], rows[:, 6]
    first = np.ceil((w * (begin - rows[:, 3]) + phi) / np.pi - shift) + shift
    return np.column_stack([rows[:, 3] + ((first + k) * np.pi - phi) / w for k in (0, 1)])


def _points(kind: int, rows: Array, length: Array) -> int:
    """Points over pieces of some length that show every change of sign."""
    cycles = np.max(np.abs(rows[:, [5, 8, 11]]), axis=1) * length / (2.0 * np.pi) if kind == WAVES else length * 0.0
    return int(np.clip(np.ceil(np.max(cycles, initial=0.0) * _PER_CYCLE), *_POINTS))


def _zeros(kind: int, law: Law, rows: Array, begin: Array, end: Array) -> Array:
    """Times at which a law changes its sign, (k, j); `begin` where there are fewer than j."""
    points = _points(kind, rows, end - begin)
    grid = begin[:, None] + np.linspace(0.0, 1.0, points + 1) * (end - begin)[:, None]
    values = np.sign(law(rows, grid))
    at, step = np.nonzero((values[:, :-1] * values[:, 1:] <= 0.0) & (values[:, :-1] != values[:, 1:]))
    low, high, sign = grid[at, step], grid[at, step + 1], values[at, step]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        same = np.sign(law(rows[at], middle[:, None])[:, 0]) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    count = np.bincount(at, minlength=len(rows))
    zeros = np.repeat(begin[:, None], max(int(count.max(initial=0)), 1), axis=1)
    place = np.arange(len(at)) - np.repeat(np.cumsum(count) - count, count)
    zeros[at, place] = 0.5 * (low + high)
    return zeros


def _column(rows: Array, j: int) -> Array:
    return rows[:, j, None]


def _line(rows: Array, t: Array) -> Array:
    return _column(rows, 3) + _column(rows, 4) * (t - _column(rows, 0))


def _line_slope(rows: Array, t: Array) -> Array:
    return np.broadcast_to(_column(rows, 4), t.shape)


def _line_path(rows: Array, t_a: Array, t: Array) -> Array:
    return np.asarray(0.5 * (t - t_a) * (_line(rows, t_a) + _line(rows, t)))


def _phase(rows: Array, j: int, t: Array) -> Array:
    return _column(rows, 5 + 3 * j) * (t - _column(rows, 3)) + _column(rows, 6 + 3 * j)


def _waves(rows: Array, t: Array) -> Array:
    return np.asarray(sum(_column(rows, 4 + 3 * j) * np.sin(_phase(rows, j, t)) for j in range(3)))


def _waves_slope(rows: Array, t: Array) -> Array:
    rates = rows[:, [4, 7, 10]] * rows[:, [5, 8, 11]]
    return np.asarray(sum(rates[:, j, None] * np.cos(_phase(rows, j, t)) for j in range(3)))


def _waves_path(rows: Array, t_a: Array, t: Array) -> Array:
    total = np.zeros_like(t)
    for j in range(3):
        A, w = _column(rows, 4 + 3 * j), _column(rows, 5 + 3 * j)
        half = 0.5 * w * (t - t_a)
        # A sin(half)/w without dividing by a w of nothing
        total += A * (t - t_a) * np.sinc(half / np.pi) * np.sin(0.5 * (_phase(rows, j, t_a) + _phase(rows, j, t)))
    return total


def _y(rows: Array, t: Array) -> Array:
    return np.asarray(_column(rows, 4) * (t - _column(rows, 3)))


def _bell(rows: Array, t: Array) -> Array:
    y, (d0, d1, d2, d3) = _y(rows, t), (_column(rows, j) for j in range(5, 9))
    return np.asarray((d0 + y * (d1 + y * (d2 + y * d3))) * np.exp(-0.5 * y * y))


def _bell_slope(rows: Array, t: Array) -> Array:
    y, (d0, d1, d2, d3) = _y(rows, t), (_column(rows, j) for j in range(5, 9))
    bent = d1 + y * (2.0 * d2 - d0 + y * (3.0 * d3 - d1 - y * (d2 + y * d3)))
    return np.asarray(bent * np.exp(-0.5 * y * y))


def _bell_path(rows: Array, t_a: Array, t: Array) -> Array:
    return np.asarray((_bell_sum(rows, _y(rows, t)) - _bell_sum(rows, _y(rows, t_a))) / _column(rows, 4))


def _bell_sum(rows: Array, y: Array) -> Array:
    """Integral of (d0 + d1 y + d2 y^2 + d3 y^3) exp(-y^2/2) over y."""
    d0, d1, d2, d3 = (_column(rows, j) for j in range(5, 9))
    total = -(d1 + d2 * y + d3 * (y * y + 2.0)) * np.exp(-0.5 * y * y)
    even = d0 + d2
    if even.any():
        total = total + even * np.sqrt(0.5 * np.pi) * _erf(y / np.sqrt(2.0))
    return np.asarray(total)


_LAWS: dict[int, tuple[Law, Law, Callable[[Array, Array, Array], Array]]] = {
    LINEAR: (_line, _line_slope, _line_path),
    WAVES: (_waves, _waves_slope, _waves_path),
    BELL: (_bell, _bell_slope, _bell_path),
}
"""Acceleration, its slope, and the velocity gained between two times."""
