"""The mode REST: when a bouncing body has come to rest."""

from __future__ import annotations

import math

from rockcli.kernels.constants import STANDSTILL
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid.series import value


@jit_lean
def rest_time(par, e, other, s, g, v, a, deg_a, a_v, deg_v, x, t, t_next, rest_speed):
    """When a body just turned onto edge e with rate v comes to rest, or -1 if it goes on rocking.

    Rest needs the ground to press it down on both sides.  Slow enough, the remaining bounces are those of a
    constant restoring moment, their times a geometric series: if it ends inside this piece, and the guard is
    still closed then, the body is at rest at its end.  Below STANDSTILL it rests at once, and so does a body with a
    base damper and no loss at impacts: its bounces have no end.
    """
    p = math.sqrt(par[e + at.P2])
    if v > rest_speed * p * math.sin(par[e + at.ALPHA]):
        return -1.0
    down = pressed(par, e, s, g, value(a, deg_a, x), value(a_v, deg_v, x))
    down_other = pressed(par, other, -s, g, value(a, deg_a, x), value(a_v, deg_v, x))
    if down <= 0.0 or down_other <= 0.0:
        return -1.0
    if v <= STANDSTILL * p * par[e + at.ALPHA]:
        return t
    per_cycle = par[e + at.ETA] * par[other + at.ETA]
    if per_cycle >= 1.0:
        # a damper slows the bounces as exp(-c t/3 I_O), without end: too slow to be seen is at rest
        return t if par[e + at.DAMPER] > 0.0 else -1.0
    tail = 2.0 * v * (1.0 / down + par[other + at.ETA] / down_other) / (1.0 - per_cycle)
    if t + tail > t_next:
        return -1.0
    y = x + tail
    if pressed(par, e, s, g, value(a, deg_a, y), value(a_v, deg_v, y)) <= 0.0:
        return -1.0
    if pressed(par, other, -s, g, value(a, deg_a, y), value(a_v, deg_v, y)) <= 0.0:
        return -1.0
    return t + tail


@jit_lean
def pressed(par, e, s, g, a, a_v):
    """Deceleration of a body that starts to turn about edge e: -q'' at q = 0."""
    return par[e + at.P2] * ((1.0 + a_v / g) * (par[e + at.R0] + par[e + at.RC]) + s * a / g * par[e + at.FC])
