"""A step of each mode: its flow, and the first of its guards to end it (docs/contact.md, section 2)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import NO_ROOT, SAME, STALLED
from rockcli.kernels.contact import flows
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import (
    BOTH_EDGES,
    DIVERGES,
    FLIGHT,
    JAMS,
    LANDS,
    LEAVES,
    LEFT_EDGE,
    LIFTS,
    NO_EVENT,
    REST,
    RIGHT_EDGE,
    ROCK,
    SLIDE,
    SLIDE_ROCK,
    SLIPS,
    STOPS,
    STRIKES,
    TOPPLES,
)
from rockcli.kernels.contact.state import Ahead, Event, Step, edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.ground import NOTHING, PULSES, expand, piece_end
from rockcli.kernels.rigid.roots import first_root, uplift

EXACT = 1e-17
"""Truncation of the series of the motion, over the weight, where its integrals are all there is to the flow."""

FAR = 1e-9
"""A guard of forces whose bound is more than this on a step, over their scale, surely has no root on it."""


@jit
def within(c, lo, hi, small, h):
    """The step cut so that terms lo ... hi of a series are below `small`."""
    power, longest = 1.0, h
    for k in range(1, hi + 1):
        power *= longest
        if k >= lo and abs(c[k]) * power > small:  # seldom, and a root costs as much as the rest
            h = min(h, (small / abs(c[k])) ** (1.0 / k))
    return h


@jit
def leaves(c, n, h, scale):
    """First x in [0, h] where a guard of forces turns negative, or NO_ROOT; what rounding of `scale` hides is zero."""
    if abs(c[0]) <= 1e-13 * scale:
        c[0] = 0.0
    least = 0.0
    for k in range(n, 0, -1):
        least = (least - abs(c[k])) * h
    if c[0] + least > FAR * scale:  # as mostly
        return NO_ROOT
    return uplift(c, n, h, scale)


@jit
def starts(c, n, h, handled):
    """First x in (0, h] where a guard reaches zero, or NO_ROOT; 0 where it turns negative at once.

    `handled` leading coefficients are zero but for rounding, and none of them can point the wrong way.
    """
    for k in range(handled):
        c[k] = max(c[k], 0.0) if k == handled - 1 else 0.0
    skip = 0
    while skip < min(n, 4) and c[skip] == 0.0:
        skip += 1
    if c[skip] <= 0.0:
        return 0.0
    least = 0.0
    for k in range(n, skip, -1):
        least = (least - abs(c[k])) * h
    if c[skip] + least > FAR * c[skip]:  # as mostly
        return NO_ROOT
    return first_root(c, n, h, skip)


@jit
def sooner(event, kind, x, way):
    """The event so far, or the other at x if that comes first."""
    if x != NO_ROOT and (event.kind == NO_EVENT or x < event.x):
        return Event(kind, x, way)
    return event


@jit
def step_to(event, h, ahead, order, slip_order, reach):
    """A step to its event, or over its length h."""
    if ahead.stuck or event.kind == NO_EVENT:
        return Step(NO_EVENT, event.way, h, order, slip_order, reach)
    return Step(event.kind, event.way, event.x, order, slip_order, reach)


@jit
def ground_ahead(par, how, scales, mode, t, t_next, stalled, ih, iv, horizontal, h_data, vertical, v_data, w):
    """Series about t of the ground's a_g and of W = g + a_v into `w`, from the pieces ih and iv on."""
    a, W, n, g = w[row.A_G], w[row.WEIGHT], how.order, par[at.G]
    deg_a = deg_v = 0
    a[0] = a[1] = W[0] = W[1] = 0.0
    if t < par[at.T_MOTION]:
        t_next = min(t_next, par[at.T_MOTION])
        if ih < horizontal.pieces:
            t_next = min(t_next, piece_end(horizontal, h_data, ih))
            deg_a = expand(horizontal, h_data, par[at.FACTOR_H], ih, t, n, a)
        if iv < vertical.pieces:
            t_next = min(t_next, piece_end(vertical, v_data, iv))
            deg_v = expand(vertical, v_data, par[at.FACTOR_V], iv, t, n, W)
    if horizontal.kind == PULSES:  # the others have no further terms
        for k in range(deg_a + 1, n + 1):
            a[k] = 0.0
    if vertical.kind == PULSES:
        for k in range(deg_v + 1, n + 1):
            W[k] = 0.0
    W[0] += g
    h = t_next - t
    fine = how.tol if mode in (ROCK, SLIDE_ROCK) else min(how.tol, EXACT)
    if deg_a > 1:
        h = within(a, n - 2, n, fine * g * min(max(par[at.MU_S], 0.01), math.tan(scales.alpha_min)), h)
    if deg_v > 1:
        h = within(W, n - 2, n, fine * g, h)
    if stalled > STALLED:
        h = min(h, max(1e-12 * (t_next - t), 4e-16 * t))
    return Ahead(t_next, h, max(deg_a, deg_v, 1), vertical.kind == NOTHING, stalled > STALLED)


@jit
def next_step(par, how, scales, mode, foot, air, launch, ahead, w):
    """The step of a mode; `launch` leading coefficients of its guard of slip or flight are known to be zero."""
    if mode == REST:
        return at_rest(par, how, ahead, w)
    if mode == SLIDE:
        return sliding(par, how, foot, launch, ahead, w)
    if mode == FLIGHT:
        return flying(par, how, scales, air, launch, ahead, w)
    return on_one_edge(par, how, scales, mode, foot, launch, ahead, w)


@jit
def at_rest(par, how, ahead, w):
    """Rest ends where friction or the base does not hold the body, or the weight vanishes."""
    a, W, guard, h, g = w[row.A_G], w[row.WEIGHT], w[row.GUARD], ahead.h, par[at.G]
    event = Event(NO_EVENT, NO_ROOT, 0.0)
    for side in range(4):
        sign = 1.0 if side % 2 == 1 else -1.0
        hold = par[at.MU_S] if side < 2 else par[edge_under(sign) + at.B] / par[at.H]
        if side >= 2 and par[at.MU_S] <= hold * SAME:
            continue  # it slides before it tips
        for k in range(ahead.degree + 1):
            guard[k] = hold * W[k] + sign * a[k]
        event = sooner(event, SLIPS if side < 2 else LIFTS, leaves(guard, ahead.degree, h, g * hold), sign)
    event = sooner(event, LEAVES, weightless(par, ahead, w), 0.0)
    return step_to(event, h, ahead, how.order, how.order, 0.0)


@jit
def weightless(par, ahead, w):
    """When the weight of a body flat on the ground vanishes, or NO_ROOT."""
    if ahead.level:
        return NO_ROOT
    for k in range(ahead.degree + 1):
        w[row.GUARD][k] = w[row.WEIGHT][k]
    return leaves(w[row.GUARD], ahead.degree, ahead.h, par[at.G])


@jit
def sliding(par, how, foot, launch, ahead, w):
    """A slide ends where its velocity does, or the weight vanishes."""
    guard, slip, n, h = w[row.GUARD], w[row.SLIP], ahead.degree + 1, ahead.h
    flows.slide(par[at.MU_K], foot, n, w)
    for k in range(n + 1):
        guard[k] = foot.sigma * slip[k]
    event = Event(NO_EVENT, NO_ROOT, 0.0)
    event = sooner(event, STOPS, starts(guard, n, h, 0 if foot.u != 0.0 else 1 + launch), 0.0)
    event = sooner(event, LEAVES, weightless(par, ahead, w), 0.0)
    return step_to(event, h, ahead, how.order, n, 0.0)


@jit
def flying(par, how, scales, air, launch, ahead, w):
    """Flight ends where an edge meets the ground, or the body has turned by pi/2."""
    guard, height, n, h = w[row.GUARD], w[row.HEIGHT], how.order, ahead.h
    flows.fly(air, n, w)
    if air.turn != 0.0:
        h = min(h, 1.0 / abs(air.turn))
    for side in range(2):
        sign = 1.0 if side == 1 else -1.0
        flows.turning(-sign * par[edge_under(sign) + at.B], -par[at.H], air, n, guard)
        h = within(guard, n - 1, n, scales.small * scales.R_min, h)
    event = Event(NO_EVENT, NO_ROOT, 0.0)
    for side in range(2):
        sign = 1.0 if side == 1 else -1.0
        flows.turning(-sign * par[edge_under(sign) + at.B], -par[at.H], air, n, guard)
        for k in range(n + 1):
            guard[k] += height[k]
        touching = air.touching == BOTH_EDGES or air.touching == (RIGHT_EDGE if side == 1 else LEFT_EDGE)
        handled = launch if touching else 0
        if handled == 0 and guard[0] <= 0.0:
            guard[0] = 0.0
        event = sooner(event, STRIKES, starts(guard, n, h, handled), sign)
    if air.turn != 0.0:
        root = (0.5 * math.pi - math.copysign(1.0, air.turn) * air.theta) / abs(air.turn)
        if root <= h:
            event = sooner(event, TOPPLES, max(root, 0.0), 0.0)
    return step_to(event, h, ahead, n, n, 0.0)


@jit
def on_one_edge(par, how, scales, mode, foot, launch, ahead, w):
    """A step of a body that rocks, its foot held or slipping."""
    c, n, slip_order = w[row.Q], how.order, how.order
    h = min(ahead.h, 1.0 / scales.p_max)
    last = 2 if ahead.degree > 1 else 1
    if mode == ROCK:
        m = flows.rock(par, foot, h, scales.small, n, ahead.degree, w)
    else:
        m = flows.slide_rock(par, foot, h, scales.small, n, ahead.degree, w)
        slip_order = m - 1
        h = within(w[row.SLIP], m - last - 1, m - 1, scales.speed, h)
    h = within(c, m - last, m, scales.small, h)
    if not h > 0.0 or math.isnan(c[m]):
        return Step(DIVERGES, 0.0, h, m, slip_order, 0.0)
    return first_event(par, scales, mode, foot, launch, h, ahead, m, slip_order, w)


@jit
def first_event(par, scales, mode, foot, launch, h, ahead, m, slip_order, w):
    """`on_one_edge` for a step of length h whose series, of order m, are in `w`."""
    c = w[row.Q]
    event = sooner(Event(NO_EVENT, NO_ROOT, 0.0), LANDS, lands(scales, foot, m, h, w), 0.0)
    event = foot_gives_way(par, event, m, h, w) if mode == ROCK else slip_ends(par, event, foot, launch, m, h, w)
    normal, guard = (w[row.NORMAL] if mode == ROCK else w[row.HELD]), w[row.GUARD]
    for k in range(m - 1):
        guard[k] = normal[k]
    event = sooner(event, LEAVES, leaves(guard, m - 2, h, par[at.G]), 0.0)
    reach = 0.0
    for k in range(m, -1, -1):
        reach = reach * (h if event.kind == NO_EVENT else event.x) + abs(c[k])
    if reach >= 0.5 * math.pi:
        for k in range(m + 1):
            guard[k] = -c[k]
        guard[0] = 0.5 * math.pi - foot.q
        event = sooner(event, TOPPLES, 0.0 if guard[0] <= 0.0 else first_root(guard, m, h, 0), 0.0)
    return step_to(event, h, ahead, m, slip_order, reach)


@jit
def lands(scales, foot, m, h, w):
    """When theta is 0 again, or NO_ROOT; a body that just began to rise is not there."""
    guard = w[row.GUARD]
    for k in range(m + 1):
        guard[k] = w[row.Q][k]
    handled = 0
    if foot.q == 0.0:
        handled = 1 if foot.v > 0.0 else 3
        if foot.v == 0.0 and guard[2] != 0.0:
            handled = 2 if guard[2] > 1e-13 * scales.p_max * scales.p_max else 3
    return starts(guard, m, h, handled)


@jit
def foot_gives_way(par, event, m, h, w):
    """The event, or an earlier end of a foot that holds: |T| = mu_s N."""
    guard, N, T, mu = w[row.GUARD], w[row.NORMAL], w[row.FRICTION], par[at.MU_S]
    for side in range(2):
        sign = 1.0 if side == 1 else -1.0
        for k in range(m - 1):
            guard[k] = mu * N[k] + sign * T[k]
        event = sooner(event, SLIPS, leaves(guard, m - 2, h, max(mu, 1e-3) * par[at.G]), sign)
    return event


@jit
def slip_ends(par, event, foot, launch, m, h, w):
    """The event, or an earlier end of a slip on one edge: it stops, or jams where A = 0."""
    guard, slip, stiff = w[row.GUARD], w[row.SLIP], w[row.STIFFNESS]
    for k in range(m):
        guard[k] = foot.sigma * slip[k]
    event = sooner(event, STOPS, starts(guard, m - 1, h, 0 if foot.u != 0.0 else 1 + launch), 0.0)
    R, rg2 = par[edge_under(foot.s) + at.RADIUS], par[at.RG2]
    if par[at.MU_K] * R * R / rg2 > math.sqrt(1.0 + R * R / rg2):  # (K7), half of it, to be safe
        for k in range(m - 1):
            guard[k] = stiff[k]
        event = sooner(event, JAMS, leaves(guard, m - 2, h, 1.0), 0.0)
    return event
