"""When a body that bounces on a facet has come to rest on it."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FAST, STANDSTILL
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.law import pressed
from rockcli.kernels.rigid.rest import bounced_out
from rockcli.kernels.rigid.series import value

NEAR = 1e-9
"""Bounces that may end in rest reach no farther than this fraction of the turn to the next facet."""


@jit
def uncounted(p, eta, p_other, eta_other, scale):
    """Rate up to which no bounce on a facet counts, of p and eta of its ends; scale: the rotation rates are told by.

    An eta above 1 lets the body leave that end faster than it came.
    """
    return FAST * scale * min(p_other / max(eta, 1.0), p / max(eta_other, 1.0))


@jit
def rest_time(end, other, s, v, scale, a, a_v, deg, x, t, t_next, rest_speed):
    """When a body just turned onto an end of a facet with rate v comes to rest on it, or -1 if it goes on.

    As `kernels.rigid.rest.rest_time`, but that what presses the body onto the facet may be the ground's acceleration,
    and that none of the bounces left out may count, which has nothing to do with the angles of the ends.
    """
    down = pressed(end, s, value(a, deg.a, x), value(a_v, deg.v, x))
    down_other = pressed(other, -s, value(a, deg.a, x), value(a_v, deg.v, x))
    if down <= 0.0 or down_other <= 0.0:
        return -1.0
    p = math.sqrt(end.p2)
    limit = uncounted(p, end.eta, math.sqrt(other.p2), other.eta, scale)
    if v > min(rest_speed * min(down, down_other) / p, limit):
        return -1.0
    if 0.5 * v * v > NEAR * min(down * end.extent, down_other * other.extent):
        return -1.0
    if v <= STANDSTILL * down / p:
        return t
    return bounced_out(end, other, s, v, down, down_other, a, a_v, deg, x, t, t_next)
