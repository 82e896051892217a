"""What becomes of a body that rolls freely: energy against barriers, vertex by vertex, in closed form."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling.law import end_of

MOST_SEGMENTS = 100_000
"""Segments that a body is followed through."""

SAME_TOP = 1e-12
"""Barriers nearer than this are the same one, seen from the facets on its two sides [rad]."""


@jit
def free_rolling(body, g, facet, s, q, v, margin):
    """RETURNS, FALLS or UNDECIDED, the facet it comes to rest on, and how many facets touch until it lies on its side.

    It comes to rest once it has turned back on both sides without a barrier between; beyond a last barrier it has
    fallen, and so it has when it passes one.  `margin`: distance from a separatrix below which rounding decides.
    """
    count = int(body[at.COUNT])
    hits = 0
    turns = 0  # back, since it last passed a barrier
    right = left = False  # whether it has ever turned back there: no barrier beyond is passed any more
    onward = 1.0 if v > 0.0 else -1.0  # the direction in which q goes
    end = end_of(body, g, facet, s)
    if q == 0.0 and v == 0.0:  # on a facet, which it may only have rested on while the ground moved
        near = end_of(body, g, facet, -s)
        if end.alpha >= 0.0 and near.alpha >= 0.0:
            verdict, rest = settled(body, g, facet, s, q)
            return verdict, rest, hits
        if end.alpha >= 0.0:
            s, end = -s, near
    if v == 0.0:
        onward = 1.0 if q > end.alpha else -1.0
    rate = abs(v)
    for _ in range(MOST_SEGMENTS):
        # to q = 0, or to the next facet; over the top at q = alpha if that is between
        target = end.extent if onward > 0.0 else 0.0
        ahead = onward * (end.alpha - q)
        if 0.0 <= ahead <= onward * (target - q):
            u = rate / math.sqrt(end.p2) - 2.0 * math.sin(0.5 * ahead)
            if abs(u) <= margin:
                return UNDECIDED, -1, hits
            if u > 0.0:
                turns = 0
                top = end.tilt + s * end.alpha
                if s * onward > 0.0 and top >= body[at.FALL_RIGHT] - SAME_TOP:
                    return FALLS, -1, hits + count - facet - (1 if onward > 0.0 else 0)
                if s * onward < 0.0 and top <= body[at.FALL_LEFT] + SAME_TOP:
                    return FALLS, -1, hits + facet + (0 if onward > 0.0 else 1)
        else:
            u = math.inf
        rate2 = rate * rate + 4.0 * end.p2 * math.sin(end.alpha - 0.5 * (q + target)) * math.sin(0.5 * (q - target))
        if u <= 0.0 or rate2 <= 0.0:  # turns back
            turns += 1
            right, left = right or s * onward > 0.0, left or s * onward < 0.0
            onward = -onward
            if right and left and body[at.LOSSLESS] == 1.0 and turns < 2:
                return RETURNS, -1, hits
            if turns == 2:
                verdict, rest = settled(body, g, facet, s, q)
                return verdict, rest, hits
            continue
        last = (s > 0.0 and facet == count - 1) or (s < 0.0 and facet == 0)
        if onward > 0.0 and last:
            return FALLS, -1, hits  # a quarter turn
        hits += 1
        if onward > 0.0:  # onto the next facet, from its near end
            facet += 1 if s > 0.0 else -1
            s = -s
        s = -s
        end = end_of(body, g, facet, s)
        q, onward, rate = 0.0, 1.0, end.eta * math.sqrt(rate2)
        if rate == 0.0:
            near = end_of(body, g, facet, -s)
            if end.alpha > 0.0 and near.alpha > 0.0:
                verdict, rest = settled(body, g, facet, s, 0.0)
                return verdict, rest, hits
            if near.alpha <= 0.0:  # it rolls back over the end it came from
                s, end = -s, near
    return RETURNS if right and left else UNDECIDED, -1, hits


@jit
def settled(body, g, facet, s, q):
    """RETURNS and the facet at the bottom of the well in which the body is, FALLS if that is beyond a last barrier."""
    count = int(body[at.COUNT])
    end = end_of(body, g, facet, s)
    theta = end.tilt + s * q
    if theta > body[at.FALL_RIGHT] or theta < body[at.FALL_LEFT]:
        return FALLS, -1
    if q > end.alpha:  # downhill is away from the facet
        facet += 1 if s > 0.0 else -1
    elif end_of(body, g, facet, -s).alpha < 0.0:  # or over its other end
        facet += -1 if s > 0.0 else 1
    for _ in range(count):
        if facet < 0 or facet >= count:
            return FALLS, -1
        left, right = end_of(body, g, facet, -1.0), end_of(body, g, facet, 1.0)
        if left.alpha >= 0.0 and right.alpha >= 0.0:
            return RETURNS, facet
        facet += 1 if right.alpha < 0.0 else -1
    return UNDECIDED, -1
