"""Overturning of the linearized block without impact, in closed form: the Laplace-transform pre-screen.

After uplift at t_u the linearized block that has not come back to its base moves as a growing plus a decaying
exponential; it overturns if the growing one wins: with f = |a|/(g alpha), positive in the direction of uplift,

    p * integral of f(t) exp(-p (t - t_u)) dt from t_u on >= 1                                          (T11)

At uplift f = 1.  Scaled by a factor, the motion lifts the block at the time at which the largest |a| so far is
g alpha over the factor; so with J(t) = p * integral of a(s) exp(-p (s - t)) ds from t on, taken in the direction of
a(t), (T11) says J(t_u) >= |a(t_u)|, without alpha or g.  The pre-screen is g alpha over the largest such |a|.

From the first uplift it is exact as long as no impact comes before overturning: mostly so for pulses, seldom for
records, whose first uplift at a large scale is by some small early shake.  The pre-screen of the worst excursion
takes the block to be at rest when any excursion lifts it, and asks which of them needs the smallest factor.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import LINEAR, Pulses, Samples, acceleration
from rockcli.storage.contents import Contents, Field
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]

_PER_PIECE = 16384
"""Straight lines that stand for a curved piece of a pulse: a relative error of some 1e-9."""

_SPAN = 300.0
"""Largest p t over which exponentials are summed at once."""


@dataclass(frozen=True, eq=False)
class Line:
    """Ground acceleration a (k,) [m/s²] at times t (k,) [s], straight between; zero before and after.

    Two values at one time are a jump.
    """

    t: Array
    a: Array


def with_prescreen(contents: Contents, study: Study) -> Contents:
    """Add the pre-screen to what a search over an amplitude of the horizontal motion found.

    One is from the first uplift, one for the worst excursion; inf where (T11) is never met.
    NaN for what they do not speak of: bodies of two different edges, that roll over more, or that move at t = 0,
    vertical motion, a motion cut off by `duration`.
    """
    search = study.search
    if search is None or not search.prescreens:
        return contents
    reference = float(np.max(np.abs(search.axis.values)))
    found = {name: np.full(study.size, np.nan) for name in search.prescreens}

    def at_reference(cases: Index) -> Iterator[tuple[Index, Batch]]:
        return ((cases[rows], batch) for rows, batch in search.at(cases, np.full(len(cases), reference)))

    for cases, batch in buildable(at_reference, np.arange(study.size)):
        alpha, p = batch.block.of_weak_edge(batch.block.alpha), batch.block.of_weak_edge(batch.p)
        for rows, line, factor in _lines(batch):
            for values, first in zip(found.values(), (True, False), strict=True):
                with np.errstate(divide="ignore"):
                    needed = batch.g[rows] * alpha[rows] / (factor * critical_level(line, p[rows], first=first))
                values[cases[rows]] = reference * needed
    words = f"{search.axis.path} from which (T11) overturns the linearized block without impact"
    fields = dict(contents.fields)
    for name, whence in zip(found, ("after its first uplift", "from rest, by the worst excursion"), strict=True):
        attrs = {"long_name": f"{words} {whence}", "units": search.axis.unit}
        fields[name] = Field(contents.axes, found[name].reshape(study.shape), attrs)
    return replace(contents, fields=fields)


def critical_level(line: Line, p: Array, *, first: bool = True) -> Array:
    """Largest |a| (m,) [m/s²] at which blocks of frequency parameters p (m,) [rad/s] may lift and overturn by (T11).

    A linearized block overturns without impact from the factor g alpha/|a| on, unless an impact comes first.  With
    `first` uplift is where |a| is larger than ever before, else wherever it grows; 0 where (T11) is never met.
    """
    t = np.concatenate([line.t[:1], line.t, line.t[-1:]])
    a = np.concatenate([[0.0], line.a, [0.0]])
    past = np.maximum.accumulate(np.abs(a))[:-1] if first else np.maximum(a[:-1] * np.sign(a[1:]), 0.0)
    (rising,) = np.nonzero(np.abs(a[1:]) > past)
    before, top, h = past[rising], np.abs(a[rising + 1]), np.diff(t)[rising]
    side = np.sign(a[rising + 1])
    p = np.asarray(p, dtype=float)[:, None]
    excess = side * future_mean(t, a, p)[:, rising + 1] - top  # J - |a| at the end of each rising line
    slope = np.where(h > 0.0, (top - side * a[rising]) / np.where(h > 0.0, h, 1.0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        back = np.where(h > 0.0, slope * np.log1p(-excess * p / slope) / p, -excess)  # from |a| = top to the root
    level = np.where(excess >= 0.0, top, top - back)
    return np.asarray(np.where(level > before, level, 0.0).max(axis=1, initial=0.0))


def future_mean(t: Array, a: Array, p: Array) -> Array:
    """J = p * integral of a(s) exp(-p (s - t)) ds from every t on, exact for straight lines; p (m, 1), J (m, k)."""
    h = np.diff(t)
    slope = np.divide(np.diff(a), h, out=np.zeros(len(h)), where=h > 0.0)
    gained = -a[:-1] * np.expm1(-p * h) - slope / p * (np.expm1(-p * h) + p * h * np.exp(-p * h))
    J = np.zeros((len(p), len(t)))
    end = len(h)
    while end > 0:  # from the last time backwards, as far at once as the exponentials go
        begin = min(int(np.searchsorted(t, t[end] - _SPAN / float(p.max()))), end - 1)
        weight = np.exp(-p * (t[begin : end + 1] - t[begin]))
        summed = np.cumsum((weight[:, :-1] * gained[:, begin:end])[:, ::-1], axis=1)[:, ::-1]
        J[:, begin:end] = (summed + weight[:, -1:] * J[:, end : end + 1]) / weight[:, :-1]
        end = begin
    return J


def _lines(batch: Batch) -> Iterator[tuple[Index, Line, Array]]:
    """Cases that the pre-screen speaks of, with their motion as straight lines and its factor (n,)."""
    excitation, block = batch.excitation, batch.block
    still = (batch.theta_0 == 0.0) & (batch.theta_dot_0 == 0.0) & np.isnan(excitation.duration)
    rows = np.flatnonzero(still & block.symmetric & ~block.rolls)
    motion = excitation.horizontal
    if motion is None or excitation.vertical is not None or not len(rows):
        return
    if isinstance(motion, Samples):
        line = Line(motion.dt * np.arange(len(motion.values), dtype=np.float64), motion.values)
        yield rows, line, np.abs(np.broadcast_to(motion.factor, still.shape)[rows])
        return
    table = motion.table[rows].reshape(len(rows), -1)
    _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
    for number, i in enumerate(rows[first]):
        alike = rows[inverse.reshape(-1) == number]
        yield alike, line_of_pulse(motion, int(i)), np.ones(len(alike))


def line_of_pulse(pulses: Pulses, case: int) -> Line:
    """A pulse as straight lines, its jumps kept."""
    t: list[Array] = []
    a: list[Array] = []
    for row in pulses.table[case]:
        begin, end = row[0], row[1]
        if end > begin:
            alone = replace(pulses, table=row[None, None], a_p=pulses.a_p[:1], omega_p=pulses.omega_p[:1])
            n = 2 if int(row[2]) == LINEAR else _PER_PIECE + 1
            times: Array = np.linspace(begin, end, n).astype(np.float64)
            t.append(times)
            a.append(acceleration(alone, np.minimum(times, np.nextafter(end, begin))))  # the end is not of the piece
    return Line(np.concatenate(t), np.concatenate(a))
