"""The outcome of free rocking in closed form: energy against the separatrix."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, NOT_YET, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.law import barrier, separatrix


@jit
def free_rocking(edge, other, q, v, linear, margin):
    """Does a body rocking freely about an edge, no forcing, ever fall?  RETURNS, FALLS or UNDECIDED.

    Each impact multiplies the rate by eta of the edge landed on; on the other edge the barrier may be lower.
    `margin` is the distance from a separatrix, in units of rotation, below which rounding decides.
    """
    if edge.q_star == math.inf:
        return RETURNS
    if edge.damper > 0.0:
        return damped_rocking(edge, other, q, v, linear, margin)
    u = separatrix(edge, q, v, linear)
    if abs(u) <= margin:
        return UNDECIDED
    if u > 0.0:
        return FALLS
    # energy below the barrier (a turning point on this side), the same barrier on the other: no impact gains energy
    same = edge.q_star == other.q_star and edge.p2 == other.p2
    inward = -v / math.sqrt(edge.p2) - math.sqrt(2.0 * max(barrier(edge, q, linear), 0.0))
    if same and q <= edge.q_star and inward < -margin:
        return RETURNS
    # rate at the coming impact: energy above the bottom of the well at q = 0
    rate2 = v * v + 2.0 * edge.p2 * (barrier(edge, 0.0, linear) - barrier(edge, q, linear))
    rate = math.sqrt(max(rate2, 0.0))
    here, there = edge, other
    for _ in range(100000):
        here, there = there, here
        rate *= here.eta
        u = separatrix(here, 0.0, rate, linear)
        if abs(u) <= margin:
            return UNDECIDED
        if u > 0.0:
            return FALLS
        if same or separatrix(there, 0.0, rate, linear) < -margin:
            return RETURNS
    return UNDECIDED


@jit
def damped_rocking(edge, other, q, v, linear, margin):
    """With a damper at the base: RETURNS or FALLS where the energy, which can only fall, tells; else NOT_YET."""
    if q >= edge.q_star and v >= 0.0:
        return FALLS if v > 0.0 or q > edge.q_star + margin else UNDECIDED
    if q > edge.q_star:
        return NOT_YET
    # the largest rate the energy allows, against that which reaches the top on either side
    energy = 0.5 * v * v + edge.p2 * (barrier(edge, 0.0, linear) - barrier(edge, q, linear))
    inertia = edge.radius / edge.p2  # I_O over m g, as I_O p^2 = m g R
    lowest = min(edge.radius * barrier(edge, 0.0, linear), other.radius * barrier(other, 0.0, linear))
    at_rest_below = edge.p2 == other.p2 and abs(v) <= margin and q < edge.q_star - margin
    return RETURNS if at_rest_below or inertia * energy < lowest * (1.0 - margin) else NOT_YET


@jit
def lost_for_good(edge, q, v, ground, lightening):
    """Linear body beyond its equilibrium: no return whatever the rest of the motion does.

    q'' = p^2 [(1 + a_v/g)(q - alpha) - s a_g/g] stays positive if it is so for the largest |a_g| and |a_v| to come,
    `ground` and `lightening`.
    """
    if v < 0.0 or q <= edge.alpha:
        return False
    return (edge.g - lightening) * (q - edge.alpha) > ground
