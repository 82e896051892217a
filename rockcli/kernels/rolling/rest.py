"""When a body that bounces on a facet has come to rest on it."""

from __future__ import annotations

import math

from rockcli.kernels.constants import STANDSTILL
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid.law import pressed
from rockcli.kernels.rigid.rest import bounced_out
from rockcli.kernels.rigid.series import value

NEAR = 1e-9
"""Bounces that may end in rest reach no farther than this fraction of the turn to the next facet."""


@jit_lean
def rest_time(end, other, s, v, a, a_v, deg, x, t, t_next, rest_speed):
    """When a body just turned onto an end of a facet with rate v comes to rest on it, or -1 if it goes on.

    As `kernels.rigid.rest.rest_time`, but that what presses the body onto the facet may be the ground's acceleration.
    """
    down = pressed(end, s, value(a, deg.a, x), value(a_v, deg.v, x))
    down_other = pressed(other, -s, value(a, deg.a, x), value(a_v, deg.v, x))
    if down <= 0.0 or down_other <= 0.0:
        return -1.0
    p = math.sqrt(end.p2)
    if v > rest_speed * min(down, down_other) / p:
        return -1.0
    if 0.5 * v * v > NEAR * min(down * end.extent, down_other * other.extent):
        return -1.0
    if v <= STANDSTILL * down / p:
        return t
    return bounced_out(end, other, s, v, down, down_other, a, a_v, deg, x, t, t_next)
