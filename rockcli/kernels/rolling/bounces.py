"""Impacts of a body that rolls freely to the one facet that can carry it: each swing is as long as an integral says."""

from __future__ import annotations

import math

import numpy as np

from rockcli.kernels.constants import FAST
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling.free_rolling import MOST_SEGMENTS
from rockcli.kernels.rolling.law import end_of, energy
from rockcli.kernels.rolling.rest import NEAR

FEW, FEW_WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(3)[1] / 2.0
NODES, WEIGHTS = (np.polynomial.legendre.leggauss(8)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(8)[1] / 2.0
"""Of Gauss and Legendre on [0, 1]."""

EVEN = 0.1
"""Change of cos(alpha - q) along a swing over its distance from 1, up to which few nodes are good to 1e-6."""

STEEP = 0.2
"""Least moment on a swing over the largest, from which on the quadrature is good to 1e-5 of its time."""


@jit_lean
def swings_low(body, g, facet, s, v, left, right):
    """Whether a body that has landed, and turns about the end s of a facet at rate v, swings less from now on.

    Less than |theta| = left and right to the two sides, and not so near to a barrier that the quadrature is not exact.
    """
    height = energy(end_of(body, g, facet, s), 0.0, v)
    for side in (-1.0, 1.0):
        j = int(body[at.VALLEY])
        while True:
            end = end_of(body, g, j, side)
            far = (right if side > 0.0 else left) - side * end.tilt
            last = (side > 0.0 and j == int(body[at.COUNT]) - 1) or (side < 0.0 and j == 0)
            beyond = energy(end, end.extent, 0.0)
            here = far <= end.extent or end.extent >= end.alpha or last  # the peak or the barrier
            if here and not (far > 0.0 and height < energy(end, min(far, end.alpha), 0.0)):
                return False
            if beyond > height or end.extent >= end.alpha or last:
                # cos(alpha - q) at its turning point
                turn = min((height - end.height) / end.radius + math.cos(end.alpha), 1.0)
                if math.sqrt(1.0 - turn * turn) < STEEP * math.sin(end.alpha):
                    return False
                break
            if math.sin(end.alpha - end.extent) < STEEP * math.sin(end.alpha):
                return False
            j += 1 if side > 0.0 else -1
    return True


@jit_lean
def duration(p2, start, v, w):
    """Time in which the rate goes from v to w, both at least 0, about an end where cos(alpha - q) is `start` at v.

    dt = dw/|M| with M^2 = p^4 [1 - cos^2(alpha - q)], and cos(alpha - q) = cos(alpha - q_v) + (v^2 - w^2)/(2 p^2).
    """
    change = 0.5 * (v - w) * (v + w) / p2
    total = 0.0
    if abs(change) < EVEN * (1.0 - max(start, start + change)):
        for i in range(3):
            total += FEW_WEIGHTS[i] / moment(p2, start, v, w + (v - w) * FEW[i])
    else:
        for i in range(8):
            total += WEIGHTS[i] / moment(p2, start, v, w + (v - w) * NODES[i])
    return abs(v - w) * total / p2


@jit_lean
def moment(p2, start, v, rate):
    """|M|/p^2 where the rate has gone from v to `rate`."""
    near = start + 0.5 * (v - rate) * (v + rate) / p2
    return math.sqrt(max(1.0 - near * near, 1e-300))


@jit_lean
def impacts_until(body, g, facet, s, v, t, stop, rest_speed):
    """Impacts of a body that swings low (`swings_low`) from now on and up to the time `stop`."""
    scale = body[at.SCALE]
    count = 0
    end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
    for _ in range(MOST_SEGMENTS):
        if end.alpha > 0.0 and other.alpha > 0.0:
            down, down_other = end.p2 * end.fs, other.p2 * other.fs
            least, lowest = rest_speed * min(down, down_other), min(down * end.extent, down_other * other.extent)
            if v * v * end.p2 <= least * least and 0.5 * v * v <= NEAR * lowest:
                break
        rate2 = v * v - 2.0 * end.p2 * end.rise
        start = end.fc  # cos(alpha)
        if rate2 <= 0.0 or 0.0 < end.alpha <= end.extent:  # turns back before the next facet
            t += 2.0 * duration(end.p2, start, v, 0.0)
            rate = v
            end, other = other, end
            s = -s
        else:
            rate = math.sqrt(rate2)
            t += duration(end.p2, start, v, rate)
            facet += 1 if s > 0.0 else -1
            end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
        if t >= stop:
            break
        if rate * rate > FAST * FAST * end.p2 * scale * scale:
            count += 1
        v = end.eta * rate
        if v == 0.0:
            break
    return count
