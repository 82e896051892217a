"""The outcome of free rocking in closed form: energy against the separatrix."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, NOT_YET, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid.ground import NOTHING, bound_from


@jit_lean
def barrier(par, e, q, linear):
    """Potential energy still missing to the unstable equilibrium, over I_O p^2.

    With y = q_star - q the restoring law is r0 (1 - cos y) + SLOPE sin y, so the energy is
    r0 (y - sin y) + 2 SLOPE sin^2(y/2): no cancellation near the top.  Linear: SLOPE y^2/2.
    """
    y = par[e + at.Q_STAR] - q
    if linear:
        return 0.5 * par[e + at.SLOPE] * y * y
    half = math.sin(0.5 * y)
    return par[e + at.R0] * (y - math.sin(y)) + 2.0 * par[e + at.SLOPE] * half * half


@jit_lean
def separatrix(par, e, q, v, linear):
    """Distance from the separatrix in units of rotation: > 0 falls, < 0 returns.

    v/p - sgn(q_star - q) sqrt(2 barrier): the unstable coordinate of the saddle at q_star.
    """
    root = math.sqrt(2.0 * max(barrier(par, e, q, linear), 0.0))
    side = 1.0 if q <= par[e + at.Q_STAR] else -1.0
    return v / math.sqrt(par[e + at.P2]) - side * root


@jit_lean
def free_rocking(par, e, other, q, v, linear, margin):
    """Does a body rocking freely about edge e, no forcing, ever fall?  RETURNS, FALLS or UNDECIDED.

    Each impact multiplies the rate by eta of the edge landed on; on the other edge the barrier may be lower.
    `margin` is the distance from a separatrix, in units of rotation, below which rounding decides.
    """
    if par[e + at.Q_STAR] == math.inf:
        return RETURNS
    if par[e + at.DAMPER] > 0.0:
        return damped_rocking(par, e, other, q, v, linear, margin)
    u = separatrix(par, e, q, v, linear)
    if abs(u) <= margin:
        return UNDECIDED
    if u > 0.0:
        return FALLS
    # energy below the barrier (a turning point on this side), the same barrier on the other: no impact gains energy
    same = par[e + at.Q_STAR] == par[other + at.Q_STAR] and par[e + at.P2] == par[other + at.P2]
    inward = -v / math.sqrt(par[e + at.P2]) - math.sqrt(2.0 * max(barrier(par, e, q, linear), 0.0))
    if same and q <= par[e + at.Q_STAR] and inward < -margin:
        return RETURNS
    # rate at the coming impact: energy above the bottom of the well at q = 0
    rate2 = v * v + 2.0 * par[e + at.P2] * (barrier(par, e, 0.0, linear) - barrier(par, e, q, linear))
    rate = math.sqrt(max(rate2, 0.0))
    here, there = e, other
    for _ in range(100000):
        here, there = there, here
        rate *= par[here + at.ETA]
        u = separatrix(par, here, 0.0, rate, linear)
        if abs(u) <= margin:
            return UNDECIDED
        if u > 0.0:
            return FALLS
        if same or separatrix(par, there, 0.0, rate, linear) < -margin:
            return RETURNS
    return UNDECIDED


@jit_lean
def damped_rocking(par, e, other, q, v, linear, margin):
    """With a damper at the base: RETURNS or FALLS where the energy, which can only fall, tells; else NOT_YET."""
    if q >= par[e + at.Q_STAR] and v >= 0.0:
        return FALLS if v > 0.0 or q > par[e + at.Q_STAR] + margin else UNDECIDED
    if q > par[e + at.Q_STAR]:
        return NOT_YET
    # the largest rate the energy allows, against that which reaches the top on either side
    energy = 0.5 * v * v + par[e + at.P2] * (barrier(par, e, 0.0, linear) - barrier(par, e, q, linear))
    inertia = par[e + at.RADIUS] / par[e + at.P2]  # I_O over m g, as I_O p^2 = m g R
    lowest = min(
        par[e + at.RADIUS] * barrier(par, e, 0.0, linear), par[other + at.RADIUS] * barrier(par, other, 0.0, linear)
    )
    at_rest_below = par[e + at.P2] == par[other + at.P2] and abs(v) <= margin and q < par[e + at.Q_STAR] - margin
    return RETURNS if at_rest_below or inertia * energy < lowest * (1.0 - margin) else NOT_YET


@jit_lean
def lost_for_good(par, e, g, q, v, after, hk, h_table, h_tail, ih, h_n, vk, v_table, v_tail, iv, v_n):
    """Linear body beyond its equilibrium: no return whatever the rest of the motion does.

    q'' = p^2 [(1 + a_v/g)(q - alpha) - s a_g/g] stays positive if it is so for the largest pull to come.
    """
    if v < 0.0 or q <= par[e + at.ALPHA]:
        return False
    if after:
        return True
    pull = bound_from(hk, h_table, h_tail, par[at.FACTOR_H], ih) if hk != NOTHING and ih < h_n else 0.0
    shake = bound_from(vk, v_table, v_tail, par[at.FACTOR_V], iv) if vk != NOTHING and iv < v_n else 0.0
    return (g - shake) * (q - par[e + at.ALPHA]) > pull
