"""Accumulations: bounces without end that end in rest, or in sliding, at a known time (docs/contact.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import STANDSTILL
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import REST, SLIDE
from rockcli.kernels.contact.selection import on_base, stiffness
from rockcli.kernels.contact.state import Scales, edge_beyond, edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.law import pull
from rockcli.kernels.rigid.series import value

SURE = 10.0
"""A slip is taken to keep its direction if it is this many times what can change it until the bounces have ended."""


@jit
def frequency(par, e):
    """p of an edge."""
    R = par[e + at.RADIUS]
    return math.sqrt(par[at.G] * R / (par[at.RG2] + R * R))


@jit
def scales_of(par, tol):
    """`Scales` of a case."""
    p_left, p_right = frequency(par, at.LEFT), frequency(par, at.RIGHT)
    alpha_min = min(par[at.LEFT + at.ALPHA], par[at.RIGHT + at.ALPHA])
    R_min = min(par[at.LEFT + at.RADIUS], par[at.RIGHT + at.RADIUS])
    p_max, small = max(p_left, p_right), tol * alpha_min
    return Scales(min(p_left, p_right), p_max, alpha_min, R_min, small, small * p_max * R_min)


@jit
def slowest(par):
    """The lesser p sin(alpha) of the two edges."""
    return min(
        frequency(par, at.LEFT) * math.sin(par[at.LEFT + at.ALPHA]),
        frequency(par, at.RIGHT) * math.sin(par[at.RIGHT + at.ALPHA]),
    )


@jit
def creeps(par, foot):
    """Whether a slip velocity is no more than rounding."""
    e = edge_under(foot.s)
    return abs(foot.u) <= 10.0 * STANDSTILL * frequency(par, e) * par[e + at.ALPHA] * par[e + at.RADIUS]


@jit
def settles(par, foot, w, n, x, left, rest_speed):
    """How long a body goes on bouncing that has just come down on an edge: (time, slip velocity then).

    The ground is as `w` has it (degree n) at x.  Slow enough, the bounces are those of constant accelerations, their
    times a geometric series.  A time of -1: it goes on rocking, or the series does not end within `left`.
    """
    a, W = w[row.A_G], w[row.WEIGHT]
    s, v, u, e, other = foot.s, foot.v, foot.u, edge_under(foot.s), edge_beyond(foot.s)
    p, alpha = frequency(par, e), par[e + at.ALPHA]
    if v > rest_speed * slowest(par):
        return -1.0, u
    a_g, weight = value(a, n, x), value(W, n, x)
    if v <= STANDSTILL * p * alpha:
        return 0.0, (0.0 if creeps(par, foot) else u)
    if weight <= 0.0:
        return -1.0, u
    if u == 0.0:
        if on_base(par, 0.0, a_g, weight)[0] != REST:
            return -1.0, u
        down, eta = held(par, e, other, s, a_g, weight)
        down_other, eta_other = held(par, other, e, -s, a_g, weight)
    else:
        sigma = 1.0 if u > 0.0 else -1.0
        if on_base(par, u, a_g, weight)[0] != SLIDE:
            return -1.0, u
        down, eta = slipping(par, e, other, s, sigma, weight)
        down_other, eta_other = slipping(par, other, e, -s, sigma, weight)
    if down <= 0.0 or down_other <= 0.0 or eta < 0.0 or eta_other < 0.0 or eta * eta_other >= 1.0:
        return -1.0, u
    tail = 2.0 * v * (1.0 / down + eta_other / down_other) / (1.0 - eta * eta_other)
    if tail > left:
        return -1.0, u
    a_then, weight_then = value(a, n, x + tail), value(W, n, x + tail)
    if u == 0.0:
        return (tail, 0.0) if on_base(par, 0.0, a_then, weight_then)[0] == REST else (-1.0, u)
    # all normal impulse, that of the impacts too, is what carries the weight and stops the centre of mass
    normal = weight * tail - par[e + at.B] * v
    u_then = u + s * par[at.H] * v - a_g * tail - par[at.MU_K] * sigma * normal
    change = (abs(a_g) + par[at.MU_K] * weight) * tail + 2.0 * par[at.H] * v
    if abs(u) <= SURE * change or weight_then <= 0.0:
        return -1.0, u
    return tail, u_then


@jit
def held(par, e, other, s, a, W):
    """Deceleration of a small rotation about edge e and restitution when landing on it, of a foot that holds.

    -1 where friction does not hold it.
    """
    R, h, rg2, place = par[e + at.RADIUS], par[at.H], par[at.RG2], par[e + at.PLACE]
    sin_a, cos_a = math.sin(par[e + at.ALPHA]), math.cos(par[e + at.ALPHA])
    acc = -R / (rg2 + R * R) * pull(W, sin_a, s * a, cos_a)
    if abs(a + s * R * cos_a * acc) > par[at.MU_S] * (W + R * sin_a * acc):
        return -1.0, 0.0
    if h * place > par[at.MU_S] * (rg2 + h * h):
        return -1.0, 0.0
    whole = rg2 + h * h
    return -acc, (whole - place * par[other + at.B]) / (whole + place * par[e + at.B])


@jit
def slipping(par, e, other, s, sigma, W):
    """The same of a foot that slips one way all the time."""
    alpha, mu, rg2 = par[e + at.ALPHA], par[at.MU_K], par[at.RG2]
    way = mu * s * sigma
    A = stiffness(par, e, alpha, way)
    down = par[e + at.RADIUS] / rg2 * W / A * (math.sin(alpha) - way * math.cos(alpha))
    turn = (par[at.H] * way - par[e + at.PLACE]) / rg2
    lift = 1.0 - par[e + at.B] * turn
    if A <= 0.0 or lift <= 0.0:
        return -1.0, 0.0
    return down, 1.0 + turn * (par[e + at.B] + par[other + at.B]) / lift
