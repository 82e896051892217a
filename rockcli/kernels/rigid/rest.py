"""The mode REST: when a bouncing body has come to rest, and when one at rest lifts off."""

from __future__ import annotations

import math

from rockcli.kernels.constants import NO_ROOT, STALLED, STANDSTILL
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.rigid.edge_forces import watch_rest
from rockcli.kernels.rigid.law import pressed
from rockcli.kernels.rigid.roots import uplift
from rockcli.kernels.rigid.series import value


@jit
def rest_time(edge, other, s, v, a, a_v, deg, x, t, t_next, rest_speed):
    """When a body just turned onto an edge with rate v comes to rest, or -1 if it goes on rocking.

    Rest needs the ground to press it down on both sides.  Slow enough for both edges, the remaining bounces are those
    of a constant restoring moment, their times a geometric series: if it ends inside this piece, and the guard is
    still closed then, the body is at rest at its end.  Below STANDSTILL it rests at once, and so does a body with a
    base damper and no loss at impacts: its bounces have no end.
    """
    p = math.sqrt(edge.p2)
    if v > rest_speed * min(p * math.sin(edge.alpha), math.sqrt(other.p2) * math.sin(other.alpha)):
        return -1.0
    down = pressed(edge, s, value(a, deg.a, x), value(a_v, deg.v, x))
    down_other = pressed(other, -s, value(a, deg.a, x), value(a_v, deg.v, x))
    if down <= 0.0 or down_other <= 0.0:
        return -1.0
    if v <= STANDSTILL * p * edge.alpha:
        return t
    return bounced_out(edge, other, s, v, down, down_other, a, a_v, deg, x, t, t_next)


@jit
def bounced_out(edge, other, s, v, down, down_other, a, a_v, deg, x, t, t_next):
    """When the bounces of a body that two constant moments press down have ended, or -1 if not inside this piece."""
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


@jit_part
def stand(left, right, least, a, a_v, deg, t, t_next, stalled, push, watched, guard, out):
    """A step of a body at rest on two edges: (t at its end, sign with which it lifts off or 0, stalled, push).

    `least` as for `lift_off`; `watched`: what the ground has to give is noted.
    """
    h = t_next - t
    x, s_up, looked = lift_off(left.threshold, right.threshold, least, a, a_v, deg, left.g, h, guard)
    moved = x if x != NO_ROOT else looked
    if watched and moved > 0.0:  # at a jump of the ground that it answers at once it is not at rest
        watch_rest(a, a_v, deg, left.g, moved, out)
    t_new = t_next if (x == NO_ROOT and looked == h) else t + moved
    if stalled > STALLED:  # lifted and dropped again and again at one instant
        t_new = min(t_next, t + max(push * h, 4e-16 * t))
        return t_new, 0.0, 0, 10.0 * push  # the ground may stay just there for long
    if x == NO_ROOT:
        return t_new, 0.0, stalled, push
    return t_new, s_up, (stalled + 1 if t_new == t else 0), push


@jit
def lift_off(at_left, at_right, least, a, a_v, deg, g, h, guard):
    """Time from now at which a body at rest turns about an edge, or NO_ROOT; its sign; the step looked at, at most h.

    `at_left`, `at_right`: a_g over g + a_v beyond which it turns about that edge; `least`: how small a threshold the
    series of the motion is to resolve; `guard` is work space.
    """
    n = max(deg.a, deg.v)
    if n > 1:  # keep to where the series of the motion has converged
        for k in range(n - 1, n + 1):
            big = max(abs(a[k]) if k <= deg.a else 0.0, abs(a_v[k]) if k <= deg.v else 0.0)
            if big > 0.0:
                h = min(h, (1e-17 * g * least / big) ** (1.0 / k))
    x, s_up = NO_ROOT, 0.0
    for side in range(2):
        threshold, sign = (at_right, 1.0) if side == 1 else (at_left, -1.0)
        for k in range(n + 1):
            guard[k] = 0.0
            if k <= deg.v:
                guard[k] = threshold * (a_v[k] + g if k == 0 else a_v[k])
            elif k == 0:
                guard[k] = threshold * g
            if k <= deg.a:
                guard[k] += sign * a[k]
        root = uplift(guard, n, h, g * abs(threshold))
        if root != NO_ROOT and (x == NO_ROOT or root < x):
            x, s_up = root, sign
    return x, s_up, h
