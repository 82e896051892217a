"""Analytic pulses of the ground (the thesis's chapter 2 and the usual near-fault shapes).

tau = t - t0 and T_p = 2 pi / omega_p throughout; every pulse is zero for t < 0 and outside its support.
A shape is one row of `SHAPES`: its name, the options it takes, and the function that writes its pieces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.excitation import BELL, LINEAR, PIECE_WIDTH, WAVES, Pulses

Array = NDArray[np.float64]

RICKER_HALF_SUPPORT = 2.0
"""A Ricker pulse acts on t0 +/- this many T_p."""

ANTISYMMETRIC_PEAK = float(np.sqrt(6.0 * (3.0 - np.sqrt(6.0))) * np.exp(-0.5 * (3.0 - np.sqrt(6.0))))
"""Maximum of |y (y^2 - 3)| exp(-y^2/2), at y^2 = 3 - sqrt 6: 1.3801."""


@dataclass(frozen=True)
class Shape:
    """A pulse shape: what it is, what it needs beside a_p and omega_p, and how it is written in pieces."""

    name: str
    sentence: str
    options: tuple[str, ...]
    lead_in_periods: float
    pieces: Callable[..., list[Array]]


def make_pulses(shape: str, *, a_p: Array, omega_p: Array, t0: Array | None = None, **options: Array) -> Pulses:
    """Pulses of one shape for n cases: a_p (n,) [m/s²], omega_p (n,) [rad/s], t0 (n,) [s], options (n,)."""
    law = SHAPES[shape]
    T_p = 2.0 * np.pi / omega_p
    if t0 is None:
        t0 = 0.5 * options["gamma"] * T_p if shape == "mavroeidis_papageorgiou" else law.lead_in_periods * T_p
    rows = law.pieces(a_p=a_p, omega_p=omega_p, T_p=T_p, t0=np.broadcast_to(t0, a_p.shape), **options)
    table = rows[0][:, None] if len(rows) == 1 else np.stack(rows, axis=1)
    start = table[:, 0, 0]
    late = start > 0.0
    if late.any():  # silence before the pulse is a piece too
        table = np.concatenate([_row(np.zeros_like(start), np.maximum(start, 0.0), LINEAR)[:, None], table], axis=1)
    np.clip(table[:, :, 0], 0.0, None, out=table[:, :, 0])
    np.clip(table[:, :, 1], 0.0, None, out=table[:, :, 1])
    table[:, :, 13] = np.abs(a_p)[:, None] * _OVERSHOOT.get(shape, 1.0)
    return Pulses(table=table, shape=shape, a_p=np.abs(a_p), omega_p=omega_p)


def _row(t_a: Array, t_b: Array, kind: int, *c: Array | float) -> Array:
    row = np.zeros((len(t_a), PIECE_WIDTH))
    row[:, 0], row[:, 1], row[:, 2] = t_a, t_b, kind
    for j, value in enumerate(c):
        row[:, 3 + j] = value
    return row


def _waves(t_a: Array, t_b: Array, t_r: Array, *waves: tuple[Array, Array, Array | float]) -> Array:
    return _row(t_a, t_b, WAVES, t_r, *(x for wave in waves for x in wave))


def _sine(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array, cycles: Array | float = 1.0) -> list[Array]:
    return [_waves(t0, t0 + cycles * T_p, t0, (a_p, omega_p, 0.0))]


def _cosine(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array, cycles: Array | float = 1.0) -> list[Array]:
    return [_waves(t0, t0 + cycles * T_p, t0, (a_p, omega_p, 0.5 * np.pi))]


def _half_sine(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array) -> list[Array]:
    return [_waves(t0, t0 + 0.5 * T_p, t0, (a_p, omega_p, 0.0))]


def _rectangular(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array) -> list[Array]:
    return [_row(t0, t0 + 0.5 * T_p, LINEAR, a_p)]


def _square_cycle(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array) -> list[Array]:
    half = t0 + 0.5 * T_p
    return [_row(t0, half, LINEAR, a_p), _row(half, t0 + T_p, LINEAR, -a_p)]


def _ricker(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array) -> list[Array]:
    # a_p (1 - x) exp(-x/2), x = omega_p^2 tau^2 / 2: with y = omega_p tau / sqrt 2, (1 - y^2) exp(-y^2/2)
    half = RICKER_HALF_SUPPORT * T_p
    return [_row(t0 - half, t0 + half, BELL, t0, omega_p / np.sqrt(2.0), a_p, 0.0, -a_p, 0.0)]


def _ricker_antisymmetric(*, a_p: Array, omega_p: Array, T_p: Array, t0: Array) -> list[Array]:
    # (a_p/beta) y (y^2 - 3) exp(-y^2/2), y = omega_p tau / sqrt 3
    half, unit = RICKER_HALF_SUPPORT * T_p, a_p / ANTISYMMETRIC_PEAK
    return [_row(t0 - half, t0 + half, BELL, t0, omega_p / np.sqrt(3.0), 0.0, -3.0 * unit, 0.0, unit)]


def _mavroeidis_papageorgiou(
    *, a_p: Array, omega_p: Array, T_p: Array, t0: Array, gamma: Array, nu: Array | float = 0.0, A: Array | None = None
) -> list[Array]:
    # velocity (A/2)(1 + cos(w tau/gamma)) cos(w tau + nu); its derivative is three sines.
    # `A` [m/s] when the study gives it, else the velocity amplitude that makes the peak acceleration a_p
    half = 0.5 * gamma * T_p
    nu = np.broadcast_to(nu, gamma.shape)
    if A is None:
        A = a_p / mavroeidis_papageorgiou_peak(omega_p, gamma, nu)
    w_plus, w_minus = omega_p * (1.0 + 1.0 / gamma), omega_p * (1.0 - 1.0 / gamma)
    # cos a cos b = (cos(a+b) + cos(a-b))/2, d/dtau cos = -sin
    waves = (
        (-0.5 * A * omega_p, omega_p, nu),
        (-0.25 * A * w_plus, w_plus, nu),
        (-0.25 * A * w_minus, w_minus, nu),
    )
    return [_waves(t0 - half, t0 + half, t0, *waves)]


def mavroeidis_papageorgiou_peak(omega_p: Array, gamma: Array, nu: Array) -> Array:
    """Peak |a_g| of the pulse of unit velocity amplitude A = 1 m/s: (n,) [1/s]."""
    peak = np.empty_like(omega_p)
    for i, (w, G, phase) in enumerate(zip(omega_p, gamma, nu, strict=True)):

        def a(tau: Array, w: float = w, G: float = G, phase: float = phase) -> Array:
            slow, fast = w * tau / G, w * tau + phase
            return np.abs(0.5 * w * (np.sin(slow) / G * np.cos(fast) + (1.0 + np.cos(slow)) * np.sin(fast)))

        half = np.pi * G / w
        tau = np.linspace(-half, half, int(256 * max(G, 1.0)) + 1)
        for _ in range(8):  # zoom in on the largest sample: the error falls by 64^2 each time
            best = int(np.argmax(a(tau)))
            lo, hi = tau[max(best - 1, 0)], tau[min(best + 1, len(tau) - 1)]
            tau = np.linspace(lo, hi, 129)
        peak[i] = float(np.max(a(tau)))
    return peak


_OVERSHOOT = {"ricker_antisymmetric": 1.0 + 1e-12, "mavroeidis_papageorgiou": 1.0 + 1e-12}
"""The bound of |a| must not be cut by the rounding of a normalising constant."""

_ROWS: tuple[Shape, ...] = (
    Shape("sine", "a_p sin(omega_p tau), `cycles` of it", ("cycles",), 0.0, _sine),
    Shape("cosine", "a_p cos(omega_p tau), `cycles` of it", ("cycles",), 0.0, _cosine),
    Shape("half_sine", "a_p sin(omega_p tau) over T_p/2", (), 0.0, _half_sine),
    Shape("rectangular", "a_p over T_p/2", (), 0.0, _rectangular),
    Shape("square_cycle", "a_p over T_p/2, then -a_p over T_p/2", (), 0.0, _square_cycle),
    Shape("ricker", "a_p (1 - x) exp(-x/2), x = (omega_p tau)^2/2", (), RICKER_HALF_SUPPORT, _ricker),
    Shape(
        "ricker_antisymmetric",
        "(a_p/1.3801) y (y^2 - 3) exp(-y^2/2), y = omega_p tau/sqrt 3",
        (),
        RICKER_HALF_SUPPORT,
        _ricker_antisymmetric,
    ),
    Shape(
        "mavroeidis_papageorgiou",
        "derivative of the velocity (A/2)(1 + cos(omega_p tau/gamma)) cos(omega_p tau + nu)",
        ("gamma", "nu", "A"),
        0.0,
        _mavroeidis_papageorgiou,
    ),
)

SHAPES: dict[str, Shape] = {row.name: row for row in _ROWS}
