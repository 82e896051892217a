"""Bounces of a lane to and fro between its two edges inside a sample, flight by flight (docs/lanes.md, L4 and L5)."""

from __future__ import annotations

import math
from typing import NamedTuple

from rockcli.kernels.constants import FAST
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.lanes.records.facets import SCALE, rolls, scales
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid.law import edge_of, pressed
from rockcli.kernels.rolling.rest import uncounted

NEARLY_STEADY = 5e-5
"""Change of the moment from one impact to the next, relative, below which it is taken to first order."""


class Foot(NamedTuple):
    """One of the edges of a body that bounces: what presses it down there, over I_O, y after the bounces begin."""

    edge: int
    """Place of the edge in a row of parameters."""
    side: float
    """Its sign of theta."""
    press: float
    """Of gravity [1/s^2]."""
    push: float
    """Of the ground at y = 0 [1/s^2]."""
    trend: float
    """Change of both [1/s^3]."""
    eta: float
    p: float
    fast: float
    """Rate from which an impact on it counts [rad/s]."""


@jit_part
def feet(par, s, a, slope, weight, lighter):
    """The edge of side s and the other one; a and slope: a_g over its scale and its slope; so of gravity over g."""
    e, o = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
    scale, scale_o = scales(par, e, o)
    return (
        foot(par, e, s, a, slope, weight, lighter, FAST * scale),
        foot(par, o, -s, a, slope, weight, lighter, FAST * scale_o),
    )


@jit_part
def foot(par, e, s, a, slope, weight, lighter, fast):
    """One of them."""
    press = pressed(edge_of(par, e), s, 0.0, 0.0)
    force = s * par[e + at.P2] * par[e + at.FC] * par[at.FACTOR_H] / par[at.G]
    return Foot(
        e, s, press * weight, force * a, force * slope + press * lighter, par[e + at.ETA], math.sqrt(par[e + at.P2]),
        fast,
    )  # fmt: skip


@jit
def moment(one, y):
    """What presses a foot down."""
    return one.press + (one.push + one.trend * y)


@jit_part
def slowest(par, rest_speed, here, there):
    """Rate below which a body is at rest and its impacts are not worth counting; of one that rolls only at y = 0."""
    if rolls(par):
        return slowest_rolling(par, rest_speed, here, there, 0.0, here.p)
    alpha, alpha_o = par[here.edge + at.ALPHA], par[there.edge + at.ALPHA]
    return rest_speed * min(here.p * math.sin(alpha), there.p * math.sin(alpha_o))


@jit
def slowest_rolling(par, rest_speed, here, there, y, p):
    """The same of a body that rolls, by what presses it down."""
    limit = uncounted(here.p, here.eta, there.p, there.eta, par[SCALE])
    return min(rest_speed * min(moment(here, y), moment(there, y)) / p, limit)


@jit
def in_all(here, there, v):
    """How long all bounces from a rate v on take while what presses the body down stays as it is."""
    per_cycle = here.eta * there.eta
    return 2.0 * v * (1.0 / (here.press + here.push) + there.eta / (there.press + there.push)) / (1.0 - per_cycle)


@jit_part
def weakest(here, there, whole, both):
    """Bound of what presses a body down on one edge, or on both, up to y = whole."""
    least = here.press - max(abs(here.push), abs(here.push + here.trend * whole))
    if both:
        least = min(least, there.press - max(abs(there.push), abs(there.push + there.trend * whole)))
    return least


@jit_part
def counted(rate, one, n, n_left):
    """Impacts with one more, of which so many on the left edge, if it is fast enough to count."""
    if rate > one.fast:
        n += 1.0
        if one.side > 0.0:
            n_left += 1.0
    return n, n_left


@jit_part
def bounce_out(par, rest_speed, here, there, v, slow, still, left, lowest):
    """Bounces of a body that leaves `here` with rate v: (their duration, impacts, those on the left edge).

    slow, still: rates whose impacts are not counted, and not followed; left: rest of the sample; lowest: bound of the
    moments.  The duration is -1 where a flight leaves the sample or the ground lifts the body.
    """
    y, rate, n, n_left, p = 0.0, v, 0.0, 0.0, here.p
    straight = NEARLY_STEADY * lowest * lowest / max(abs(here.trend), abs(there.trend))
    while rate > slow and rate > straight:
        D = moment(here, y)
        flight = 2.0 * rate / (0.5 * D + math.sqrt(0.25 * D * D + 2.0 / 3.0 * here.trend * rate))
        y += flight
        if not (y < left and moment(here, y) > 0.0 and moment(there, y) > 0.0):
            return -1.0, n, n_left
        rate = (D + 0.5 * here.trend * flight) * flight - rate
        n, n_left = counted(rate, here, n, n_left)
        rate *= there.eta
        here, there = there, here
        if rolls(par):
            slow = slowest_rolling(par, rest_speed, here, there, y, p)
    if not rate > still:
        return y, n, n_left
    if rolls(par):
        slow = slowest_rolling(par, rest_speed, here, there, y, p)
    return die_out(here, there, rate, y, slow, left, n, n_left)


@jit_part
def die_out(here, there, rate, y, slow, left, n, n_left):
    """The bounces from y on as a geometric series, the change of the moments to first order."""
    D, D_o = moment(here, y), moment(there, y)
    series = 1.0 / (1.0 - here.eta * there.eta)
    y += 2.0 * rate * (1.0 / D + there.eta / D_o) * series
    if not (y < left and moment(here, y) > 0.0 and moment(there, y) > 0.0):
        return -1.0, n, n_left
    if rate > slow:  # they are worth counting
        rate *= 1.0 + 2.0 / 3.0 * rate * (here.trend / (D * D) + there.trend * there.eta / (D_o * D_o)) * series
        while rate > slow:
            n, n_left = counted(rate, here, n, n_left)
            rate *= there.eta
            here, there = there, here
    return y, n, n_left
