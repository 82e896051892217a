"""What an event makes of the state: take-off, impacts, corners that strike, and the mode chosen after it."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FAST, ILL_POSED
from rockcli.kernels.contact import impacts
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import (
    BOTH_EDGES,
    FLIGHT,
    JAM,
    LEAVES,
    LEFT_EDGE,
    LIFTS,
    NEITHER,
    NO_EDGE,
    ON_BASE,
    ON_EDGE,
    REST,
    RIGHT_EDGE,
    ROCK,
    SETTLED,
    SLIDE,
    SLIDE_ROCK,
    SLIPS,
)
from rockcli.kernels.contact.readings import (
    energy_in_flight,
    energy_on_edge,
    integral,
    note_event,
    note_flight,
    note_impact,
    note_slip,
    note_uplift,
)
from rockcli.kernels.contact.selection import on_base, on_edge, stiffness
from rockcli.kernels.contact.state import Air, Foot, edge_beyond, edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.series import slope, value

DOWN = 1e-9
"""A corner or a base that bounces slower than this is taken as down [m/s]."""

FROM_GROUND = 3
"""Leading coefficients of the gap of an edge that leaves the ground: gap, velocity and acceleration are zero."""


@jit
def chosen(par, pick, foot, a_g, weight, out):
    """The mode by complementarity with the ground's motion just after an event: (mode, foot, gain in a jam)."""
    change = 0.0
    if pick == ON_BASE:
        mode, s, sigma = on_base(par, foot.u, a_g, weight)
        foot = Foot(s, sigma, 0.0, 0.0, foot.u, foot.place)
    else:
        mode, sigma = on_edge(par, foot, a_g, weight)
    if mode == JAM:
        before, s, q = energy_on_edge(par, foot), foot.s, foot.q
        v = s * impacts.jam(par, edge_under(s), q, s * foot.v, foot.u)
        out[to.N_JAMS] += 1
        foot = Foot(s, foot.sigma, q, v, 0.0, foot.place)
        change = energy_on_edge(par, foot) - before
        out[to.GAIN] = max(out[to.GAIN], change)
        if q == 0.0 and v < 0.0:
            foot = Foot(s, foot.sigma, q, 0.0, 0.0, foot.place)
        mode, sigma = on_edge(par, foot, a_g, weight)
    if mode == NEITHER:
        out[to.TWO_WAYS] += 1
        mode = FLIGHT
    return mode, Foot(foot.s, sigma, foot.q, foot.v, foot.u, foot.place), change


@jit
def take_off(par, flat, foot):
    """The body as it leaves the ground, from both edges or from one."""
    if flat:
        return Air(foot.place, foot.u, par[at.H], 0.0, 0.0, 0.0, BOTH_EDGES)
    s, e = foot.s, edge_under(foot.s)
    R, beta = par[e + at.RADIUS], par[e + at.ALPHA] - foot.q
    z, z_rate = R * math.cos(beta), R * math.sin(beta) * foot.v
    x = foot.place + s * par[e + at.B] - s * R * math.sin(beta)
    touching = LEFT_EDGE if e == at.LEFT else RIGHT_EDGE
    return Air(x, foot.u + s * z * foot.v, z, z_rate, s * foot.q, s * foot.v, touching)


@jit
def moved(mode, foot, step, stops, lands, w):
    """The body on the ground at the end of a step."""
    c, slip, x = w[row.Q], w[row.SLIP], step.x
    q, v, u, place = foot.q, foot.v, foot.u, foot.place
    if mode in (SLIDE, SLIDE_ROCK):
        place += integral(slip, step.slip_order, x)
        u = 0.0 if stops else value(slip, step.slip_order, x)
    if mode in (ROCK, SLIDE_ROCK):
        q, v = (0.0 if lands else value(c, step.order, x)), slope(c, step.order, x)
        if lands:
            v = min(v, 0.0)
    return Foot(foot.s, foot.sigma, q, v, u, place)


@jit
def flown(air, n, x, w):
    """The body in flight at the end of a step."""
    slip, height = w[row.SLIP], w[row.HEIGHT]
    return Air(
        air.x + integral(slip, n, x), value(slip, n, x), value(height, n, x), slope(height, n, x),
        air.theta + air.turn * x, air.turn, NO_EDGE if x > 0.0 else air.touching,
    )  # fmt: skip


@jit
def landed(par, foot, out):
    """The body after it came down from one edge onto the other, turning about that: (foot, energy it gained)."""
    before = energy_on_edge(par, foot)
    v, slid, _ = impacts.landing(par, edge_under(foot.s), edge_beyond(foot.s), -foot.v, -foot.s * foot.u)
    foot = Foot(-foot.s, foot.sigma, 0.0, v, -foot.s * slid, foot.place)
    change = energy_on_edge(par, foot) - before
    out[to.GAIN] = max(out[to.GAIN], change)
    return foot, change


@jit
def struck_flat(par, t, foot, air, out):
    """A body that comes down flat: (pick, foot, air, speed of the impact, energy it gained).

    SETTLED where it bounces; else it stays down, flat or turning about the leading edge.
    """
    before, hit = energy_in_flight(par, air), abs(air.z_rate)
    turn, x_rate, z_rate = impacts.flat(par, air.x_rate, air.z_rate)
    air = Air(air.x, x_rate, air.z, z_rate, 0.0, turn, air.touching)
    change = energy_in_flight(par, air) - before
    if turn == 0.0:
        if z_rate > DOWN:
            return SETTLED, foot, Air(air.x, x_rate, par[at.H], z_rate, 0.0, 0.0, BOTH_EDGES), hit, change
        return ON_BASE, Foot(foot.s, foot.sigma, foot.q, foot.v, x_rate, air.x), air, hit, change
    note_uplift(t, out)
    s = 1.0 if turn > 0.0 else -1.0
    if z_rate - s * par[edge_under(s) + at.B] * turn > DOWN:
        touching = RIGHT_EDGE if s > 0.0 else LEFT_EDGE
        return SETTLED, foot, Air(air.x, x_rate, air.z, z_rate, 0.0, turn, touching), hit, change
    return ON_EDGE, Foot(s, foot.sigma, 0.0, s * turn, x_rate - par[at.H] * turn, air.x), air, hit, change


@jit
def struck_corner(par, way, foot, air):
    """A body of which the edge on the side `way` comes down: as `struck_flat`.

    SETTLED where the corner bounces; else it stays down.
    """
    before, theta, z, turn = energy_in_flight(par, air), air.theta, air.z, air.turn
    if par[at.FIRST] != 0.0 and abs(theta) < ILL_POSED * par[edge_under(way) + at.ALPHA]:
        way, theta, z = par[at.FIRST], 0.0, par[at.H]
    sin_t, cos_t = math.sin(theta), math.cos(theta)
    b = way * par[edge_under(way) + at.B]
    c, d = b * cos_t - par[at.H] * sin_t, -b * sin_t - par[at.H] * cos_t
    along, across = air.x_rate + d * turn, air.z_rate - c * turn
    hit = abs(across)
    turn, along, across = impacts.corner(par, c, d, turn, along, min(across, 0.0))
    air = Air(air.x, along - d * turn, z, across + c * turn, theta, turn, air.touching)
    change = energy_in_flight(par, air) - before
    if across > DOWN:
        touching = RIGHT_EDGE if way > 0.0 else LEFT_EDGE
        return SETTLED, foot, Air(air.x, air.x_rate, -d, air.z_rate, theta, turn, touching), hit, change
    foot = Foot(way, foot.sigma, max(way * theta, 0.0), way * turn, along, air.x + c - b)
    return ON_EDGE, foot, air, hit, change


@jit
def entered(par, pick, mode, t, foot, air, slipped, jumped, a_g, weight, events, out):
    """The mode after an event, with the ground's motion from now on: (mode, foot, air, launch, slipped, gain)."""
    new, foot, change = chosen(par, pick, foot, a_g, weight, out)
    launch, slips = 0, new in (SLIDE, SLIDE_ROCK)
    if new == FLIGHT:
        air, launch = take_off(par, pick == ON_BASE, foot), FROM_GROUND
        note_flight(t, air, out)
    elif slips:
        launch = 1 if foot.u == 0.0 else 0
        note_slip(t, new == SLIDE_ROCK, slipped, out)
    if new in (ROCK, SLIDE_ROCK):
        note_uplift(t, out)
    unchanged = jumped and new == mode  # only rounding made a guard of it
    if not (unchanged or (t == 0.0 and out[to.N_STEPS] == 1)):
        note_event(t, new, events, out)
    if new == REST and not unchanged:
        out[to.T_REST] = t
    return new, foot, air, launch, slips, change


@jit
def struck(par, scales, t, way, foot, air, stored, out):
    """A body in flight meets the ground, the edge on the side `way` first: (pick, foot, air, energy it gained).

    stored: impacts so far, as those of `march`.
    """
    out[to.NEARLY_FLAT] = min(out[to.NEARLY_FLAT], abs(air.theta) / scales.alpha_min)
    rate = air.turn
    if air.theta == 0.0 and rate == 0.0 and par[at.FIRST] == 0.0:
        pick, foot, air, hit, change = struck_flat(par, t, foot, air, out)
    else:
        pick, foot, air, hit, change = struck_corner(par, way, foot, air)
    out[to.GAIN] = max(out[to.GAIN], change)
    if hit > FAST * scales.p_min * scales.alpha_min * scales.R_min and t <= par[at.T_STOP]:
        note_impact(t, rate, air.turn, stored, out)
    return pick, foot, air, change


@jit
def gave_way(par, event, way, mode, t, foot, air, launch, slipped, events, out):
    """A foot that held slips or leaves the ground, a body at rest tips: (mode, foot, air, launch, slipped)."""
    if event == SLIPS:
        e, beta = edge_under(foot.s), par[edge_under(foot.s) + at.ALPHA] - foot.q
        foot = Foot(foot.s, way, foot.q, foot.v, 0.0, foot.place)
        launch, slipped = (1 if par[at.MU_S] == par[at.MU_K] else 0), True
        if mode == ROCK and stiffness(par, e, beta, par[at.MU_K] * foot.s * way) <= 0.0:
            event = LEAVES  # as it gives way it leaves, as W < R cos(beta) q'^2: no slip is consistent
        mode = SLIDE if mode == REST else SLIDE_ROCK
        note_slip(t, mode == SLIDE_ROCK, False, out)
        note_event(t, mode, events, out)
    if event == LEAVES:
        air, launch, slipped, mode = take_off(par, mode in (REST, SLIDE), foot), FROM_GROUND, False, FLIGHT
        note_flight(t, air, out)
        note_event(t, mode, events, out)
    elif event == LIFTS:
        foot, mode, launch = Foot(way, foot.sigma, 0.0, 0.0, 0.0, foot.place), ROCK, 0
        note_uplift(t, out)
        note_event(t, mode, events, out)
    return mode, foot, air, launch, slipped
