"""The mode REST: when a bouncing body has come to rest."""

from __future__ import annotations

import math

from rockcli.kernels.constants import STANDSTILL
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid.law import pressed
from rockcli.kernels.rigid.series import value


@jit_lean
def rest_time(edge, other, s, v, a, a_v, deg, x, t, t_next, rest_speed):
    """When a body just turned onto an edge with rate v comes to rest, or -1 if it goes on rocking.

    Rest needs the ground to press it down on both sides.  Slow enough, the remaining bounces are those of a
    constant restoring moment, their times a geometric series: if it ends inside this piece, and the guard is
    still closed then, the body is at rest at its end.  Below STANDSTILL it rests at once, and so does a body with a
    base damper and no loss at impacts: its bounces have no end.
    """
    p = math.sqrt(edge.p2)
    if v > rest_speed * p * math.sin(edge.alpha):
        return -1.0
    down = pressed(edge, s, value(a, deg.a, x), value(a_v, deg.v, x))
    down_other = pressed(other, -s, value(a, deg.a, x), value(a_v, deg.v, x))
    if down <= 0.0 or down_other <= 0.0:
        return -1.0
    if v <= STANDSTILL * p * edge.alpha:
        return t
    per_cycle = edge.eta * other.eta
    if per_cycle >= 1.0:
        # a damper slows the bounces as exp(-c t/3 I_O), without end: too slow to be seen is at rest
        return t if edge.damper > 0.0 else -1.0
    tail = 2.0 * v * (1.0 / down + other.eta / down_other) / (1.0 - per_cycle)
    if t + tail > t_next:
        return -1.0
    y = x + tail
    if pressed(edge, s, value(a, deg.a, y), value(a_v, deg.v, y)) <= 0.0:
        return -1.0
    if pressed(other, -s, value(a, deg.a, y), value(a_v, deg.v, y)) <= 0.0:
        return -1.0
    return t + tail
