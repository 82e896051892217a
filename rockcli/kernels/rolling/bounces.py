"""Impacts of a body that rolls freely to the one facet that can carry it: each swing is as long as an integral says."""

from __future__ import annotations

import math

import numpy as np

from rockcli.kernels.constants import FAST, MEANINGFUL
from rockcli.kernels.jit import jit
from rockcli.kernels.quadrature import NODES, POINTS, WEIGHTS
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling.free_rolling import MOST_SEGMENTS
from rockcli.kernels.rolling.law import end_of, energy, push_of
from rockcli.kernels.rolling.rest import NEAR, uncounted

FEW, FEW_WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(3)[1] / 2.0
"""Of Gauss and Legendre on [0, 1]."""

EVEN = 0.1
"""Change of cos(alpha - q) along a swing over its distance from 1, up to which few nodes are good to 1e-6."""

STEEP, STEEPER = 0.2, 0.7
"""Least moment on a swing over the largest, from which on the quadrature is good to 1e-5 of its time, or to 1e-10."""


@jit
def swings_low(body, g, facet, s, v, left, right, fine):
    """Whether a body that has landed, and turns about the end s of a facet at rate v, swings less from now on.

    Less than |theta| = left and right to the two sides, and not so near to a barrier that the quadrature is not exact,
    to what times are to be told by if `fine`.
    """
    steep = STEEPER if fine else STEEP
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
                if math.sqrt(1.0 - turn * turn) < steep * math.sin(end.alpha):
                    return False
                break
            if math.sin(end.alpha - end.extent) < steep * math.sin(end.alpha):
                return False
            j += 1 if side > 0.0 else -1
    return True


@jit
def swings_softly(body, g, facet, s, v, rate, least, most):
    """Whether the free swings of such a body keep within `rate`, N/(m g) within `least`, |T|/N within `most`.

    By bounds: about an end |q''| = p^2 |sin b| with b = alpha - q, so |T| <= m R |sin b| (p^2 + v^2) and
    N >= m g - m R (p^2 sin^2 b + v^2), the sine and the rate the largest on the way.
    """
    height = energy(end_of(body, g, facet, s), 0.0, v)
    for side in (-1.0, 1.0):
        j = int(body[at.VALLEY])
        while True:
            for about in (-1.0, 1.0):
                end = end_of(body, g, j, about)
                sine = math.sin(end.alpha if end.alpha > 0.0 else min(end.extent - end.alpha, 0.5 * math.pi))
                lever = end.radius / g
                fastest = 2.0 * end.p2 * ((height - end.height) / end.radius - min(end.rise, 0.0))
                normal = 1.0 - lever * (end.p2 * sine * sine + fastest)
                if fastest > rate * rate or normal < least or lever * sine * (end.p2 + fastest) > most * normal:
                    return False
            end = end_of(body, g, j, side)
            last = (side > 0.0 and j == int(body[at.COUNT]) - 1) or (side < 0.0 and j == 0)
            if end.extent >= end.alpha or last or energy(end, end.extent, 0.0) > height:
                break
            j += 1 if side > 0.0 else -1
    return True


@jit
def duration(p2, start, v, w, fine):
    """Time in which the rate goes from v to w, both at least 0, about an end where cos(alpha - q) is `start` at v.

    dt = dw/|M| with M^2 = p^4 [1 - cos^2(alpha - q)], and cos(alpha - q) = cos(alpha - q_v) + (v^2 - w^2)/(2 p^2).
    """
    change = 0.5 * (v - w) * (v + w) / p2
    total = 0.0
    if not fine and abs(change) < EVEN * (1.0 - max(start, start + change)):
        for i in range(3):
            total += FEW_WEIGHTS[i] / moment(p2, start, v, w + (v - w) * FEW[i])
    else:
        for i in range(POINTS):
            total += WEIGHTS[i] / moment(p2, start, v, w + (v - w) * NODES[i])
    return abs(v - w) * total / p2


@jit
def moment(p2, start, v, rate):
    """|M|/p^2 where the rate has gone from v to `rate`."""
    near = start + 0.5 * (v - rate) * (v + rate) / p2
    return math.sqrt(max(1.0 - near * near, 1e-300))


@jit
def impacts_until(body, g, facet, s, v, t, stop, rest_speed, fine):
    """Impacts of a body that swings low (`swings_low`) from now on and up to the time `stop`.

    Also when it comes to rest, or `stop`; and if `fine` what the impacts carry, the same times their time, and the
    largest ratio of their impulses.
    """
    scale = body[at.SCALE]
    count = 0
    swung = swung_t = push = 0.0
    end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
    for _ in range(MOST_SEGMENTS):
        if end.alpha > 0.0 and other.alpha > 0.0:
            down, down_other = end.p2 * end.fs, other.p2 * other.fs
            least, lowest = rest_speed * min(down, down_other), min(down * end.extent, down_other * other.extent)
            limit = uncounted(math.sqrt(end.p2), end.eta, math.sqrt(other.p2), other.eta, scale)
            if v * v * end.p2 <= least * least and v <= limit and 0.5 * v * v <= NEAR * lowest:
                t += 2.0 * v * (1.0 / down + other.eta / down_other) / (1.0 - end.eta * other.eta)
                break
        rate2 = v * v - 2.0 * end.p2 * end.rise
        start = end.fc  # cos(alpha)
        if rate2 <= 0.0 or 0.0 < end.alpha <= end.extent:  # turns back before the next facet
            t += 2.0 * duration(end.p2, start, v, 0.0, fine)
            rate = v
            end, other = other, end
            s = -s
        else:
            rate = math.sqrt(rate2)
            t += duration(end.p2, start, v, rate, fine)
            facet += 1 if s > 0.0 else -1
            end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
        if t >= stop:
            break
        if rate * rate > FAST * FAST * end.p2 * scale * scale:
            count += 1
            if fine:
                push = max(push, push_of(end.height, end.eta, end.b, other.b))
                carried = rate * rate / (end.p2 * scale * scale) - MEANINGFUL * MEANINGFUL
                if carried > 0.0:
                    swung += carried
                    swung_t += carried * t
        v = end.eta * rate
        if v == 0.0:
            break
    return count, min(t, stop), swung, swung_t, push
