"""How a case is solved, and what the ground does: named values that travel together through the kernels."""

from __future__ import annotations

from typing import Any, NamedTuple


class Settings(NamedTuple):
    """How a case of one rigid body is solved.

    Attributes:
        linear: sin q stands for q and cos q for 1.
        tol: error of a step over alpha.
        rest_speed: rate over p sin(alpha), the lesser of the two edges, below which bounces may end in rest.
        margin: distance from a separatrix over alpha below which rounding decides.
        max_steps: most steps of a case.
        order: of the Taylor series.
        detail: how much is wanted, `march.OUTCOME`, `PEAKS` or `ALL`.
    """

    linear: bool
    tol: float
    rest_speed: float
    margin: float
    max_steps: int
    order: int
    detail: int


class Channel(NamedTuple):
    """One component of the ground motion; its numbers come beside it as `data`.

    Attributes:
        kind: `ground.NOTHING`, `SAMPLES` (data: the values at i dt, then for each the largest modulus from there on)
            or `PULSES` (data: rows of `ground.WIDTH` numbers, scene/ground/excitation.py).
        dt: time between samples [s].
        pieces: intervals between samples, or rows.
    """

    kind: int
    dt: float
    pieces: int


class Ground(NamedTuple):
    """Both components of the ground motion, and by what a case scales their samples."""

    horizontal: Channel
    h_data: Any
    factor_h: float
    vertical: Channel
    v_data: Any
    factor_v: float


class Degrees(NamedTuple):
    """Degrees of the polynomials of the horizontal and the vertical acceleration of the ground."""

    a: int
    v: int
