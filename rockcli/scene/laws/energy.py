"""What a damping scheme loses per cycle of free rocking, against amplitude: impacts (3.1) and the base damper (3.3).

The base damper is followed on the linearized block (2.3), in closed form but for one root per half swing.  With
y = alpha - q, a swing obeys y'' + d y' - p^2 y = 0, d = c/I_O, whose exponents are l+ > 0 > l-.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block, housner_eta
from rockcli.scene.laws.damping import Damping, dashpot_rate

Array = NDArray[np.float64]

_ITERATIONS = 60


def energy_ratio(damping: Damping, block: Block, g: Array, ratio: Array) -> Array:
    """Energy after one cycle (two impacts) over energy before, (n, k), for amplitudes ratio = theta/alpha (k,).

    Impacts keep eta^2 each, eta^4 per cycle whatever the amplitude (3.1); the damper keeps more, the smaller the
    swing.  For unequal edges: both impacts, and the damper about the edge with the smaller alpha.
    """
    kept = (damping.eta[:, 0] * damping.eta[:, 1]) ** 2
    flat = np.repeat(kept[:, None], len(ratio), axis=1)
    if damping.coefficient is None:
        return flat
    alpha, R, inertia, p = (block.of_weak_edge(both) for both in (block.alpha, block.R, block.inertia, block.p(g)))
    d = dashpot_rate(damping.coefficient, alpha, R, inertia, g)[:, None] / p[:, None]  # in units of p t
    root = np.sqrt(d**2 + 4.0)
    up, down = 0.5 * (root - d), -0.5 * (root + d)
    start = np.broadcast_to(1.0 - ratio, flat.shape)
    y = start
    for _ in range(2):
        y = _turning_point(_impact_rate(y, up, down), up, down)
    with np.errstate(invalid="ignore"):
        energy = (1.0 - y**2) / (1.0 - start**2)
    return np.asarray(flat * np.where(start >= 1.0, 1.0, energy))


def energy_ratio_of_impacts(block: Block) -> Array:
    """eta^4 of Housner's eta, (n,): what the block keeps per cycle (3.1); zero where eta would be negative."""
    eta = np.maximum(housner_eta(block), 0.0)
    return np.asarray((eta[:, 0] * eta[:, 1]) ** 2)


def _impact_rate(y_0: Array, up: Array, down: Array) -> Array:
    """Rate y' at y = 1 of a body let go at y_0 in [0, 1], y in units of alpha.

    y(t) = y_0 (l+ e^(l- t) - l- e^(l+ t))/(l+ - l-) = 1, x = e^(l+ t): convex in x, so Newton from above is monotone.
    From y_0 -> 0 the body leaves along the unstable direction: y' -> l+.
    """
    power, gap = down / up, up - down
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        x = gap / (-down * y_0)
        for _ in range(_ITERATIONS):
            f = y_0 / gap * (up * x**power - down * x) - 1.0
            slope = y_0 / gap * (up * power * x ** (power - 1.0) - down)
            x = np.maximum(x - np.where(slope > 0.0, f / slope, 0.0), 1.0)
        rate = y_0 * up * down / gap * (x**power - x)
    return np.asarray(np.where(y_0 <= 0.0, up, np.where(y_0 >= 1.0, 0.0, rate)))


def _turning_point(rate: Array, up: Array, down: Array) -> Array:
    """y where a body that leaves the base (y = 1) with rate y' = -rate turns round."""
    gap = up - down
    A, B = (-rate - down) / gap, (up + rate) / gap
    x = (-B * down / (A * up)) ** (1.0 / gap)  # e^t there
    return np.asarray(A * x**up + B * x**down)
