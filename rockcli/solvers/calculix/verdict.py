"""What became of the body: read off its motion, never guessed (docs/calculix.md, section 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.kernels.formulas import potential

Array = NDArray[np.float64]

NO_RETURN = 1.25
"""After the motion, moving outward beyond this many alpha: fallen."""

MARGIN = 0.05
"""Energy within this part of the barrier decides nothing: the vibration of the body may add or take as much."""


@dataclass(frozen=True)
class Body:
    """The rigid body behind the mesh: alpha [rad], p [rad/s], first clamped period [s], end of the motion [s].

    theta_star, barrier: rotation [rad] and energy over m g R from which it may not come back, those of a beam that
    bends under its own lean on the base there is, at most those of the rigid block.
    """

    alpha: float
    p: float
    period: float
    motion_end: float
    theta_star: float
    barrier: float


def falls_at(body: Body, t: Array, theta: Array) -> int | None:
    """The first of the increments (k,) at which it has overturned: at pi/2, or beyond return after the motion's end."""
    size = np.abs(theta)
    outward = np.diff(size, prepend=np.inf) > 0.0
    fallen = (size >= 0.5 * np.pi) | (outward & (size > NO_RETURN * body.alpha) & (t > body.motion_end))
    return int(np.argmax(fallen)) if fallen.any() else None


def judge(body: Body, t: Array, theta: Array) -> int:
    """RETURNS, FALLS, or UNDECIDED: not to be told from this motion.

    After the end of the motion a body that cannot climb to its unstable equilibrium stands.  Its energy is that
    of the rigid block at the rotation and mean rate of the base over windows of the first clamped period,
    (1/2) (theta'/p)^2 + cos(alpha - |theta|) - cos(alpha), no less than that of a body that bends or sinks in.
    """
    if falls_at(body, t, theta) is not None:
        return FALLS
    after = t >= body.motion_end - 1e-9
    if np.count_nonzero(after) < 3 and t[-1] < body.motion_end - 1e-3:
        return UNDECIDED
    window = t >= t[-1] - body.period
    if np.count_nonzero(window) < 3:
        window = np.arange(len(t)) >= len(t) - 3
    slope, middle = np.polyfit(t[window] - t[window].mean(), theta[window], 1)
    barrier = 1.0 - np.cos(body.alpha)
    q, bent = abs(middle), -2.0 * np.cos(body.alpha) * np.sin(0.5 * middle) ** 2
    energy = 0.5 * (slope / body.p) ** 2 + potential(0.0, np.sin(body.alpha), q, bent, np.sin(q))
    if energy < (1.0 - MARGIN) * body.barrier and abs(middle) < body.theta_star:
        return RETURNS
    if energy > (1.0 + MARGIN) * barrier and abs(middle) > body.alpha and slope * middle > 0.0:
        return FALLS
    return UNDECIDED
