"""Where a foot in lanes gives way and where it holds again, body by body, with the means of the kernel of contact.

What is not the beginning, the going on or the end of a slip on one edge, or an impact on the way, that kernel follows:
flight, bounces that end in rest, slides on the base, jams, the end of the motion.
"""

from __future__ import annotations

import math

from rockcli.kernels import handover as carry
from rockcli.kernels.constants import DONE, FALLS, GIVES_WAY, HOLDS, LEFT_TO_MARCH, RETURNS
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import (
    DIVERGES,
    LANDS,
    NO_EDGE,
    NO_EVENT,
    ROCK,
    SLIDE_ROCK,
    SLIPS,
    STOPS,
    TOPPLES,
)
from rockcli.kernels.contact.events import landed, moved
from rockcli.kernels.contact.march import march
from rockcli.kernels.contact.parts import add_part
from rockcli.kernels.contact.readings import (
    counts,
    energy_on_edge,
    note_carried,
    note_on_edge,
    note_slide,
    note_slip,
    note_uplift,
    work,
)
from rockcli.kernels.contact.rest import scales_of, settles
from rockcli.kernels.contact.selection import on_base, on_edge, stiffness
from rockcli.kernels.contact.state import Ahead, Air, Foot, Settings, edge_under
from rockcli.kernels.contact.steps import first_event, next_step
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import slips
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.slips import copy_series
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.rigid import results as of_lanes
from rockcli.kernels.rigid.ground import NOTHING, SAMPLES
from rockcli.kernels.rigid.march import ALL
from rockcli.kernels.rigid.settings import Channel

ENDED, SLIPPING, HOLDING, ELSEWHERE = range(4)
"""What becomes of a body: it is done, goes on slipping, holds again, or is for the kernel of contact to follow."""


@jit
def settings(how):
    """`Settings` of the kernel of contact for those of lanes."""
    everything = how.detail == ALL
    return Settings(how.tol, how.rest_speed, how.max_steps, how.order, everything, everything, True)


@jit
def follow(par, how, span, start, values, w, nothing, out):
    """Let the kernel of contact follow a body until its foot has held for a while, or it is done."""
    first, last = int(span[0]), int(span[1])
    march(
        par, how, Channel(SAMPLES, span[2], last - first), values[first : last + 1], Channel(NOTHING, 0.0, 0),
        values[:0], 1.0, start, nothing, nothing, nothing, w, out,
    )  # fmt: skip
    start[carry.SINCE] = -1.0
    return HOLDING if out[to.STATUS] == HOLDS else ENDED


@jit
def count_in(par, start, part, out):
    """Add what lanes have found of a body to its results; LEFT_TO_MARCH is one of which they do not know the end."""
    add_part(par, start[carry.SLIDE], part, out)
    if out[to.STATUS] == DONE and out[to.VERDICT] not in (RETURNS, FALLS):
        out[to.STATUS] = LEFT_TO_MARCH


@jit
def give_way(st, i, sl, j, k, par, how, start, values, slopes, w, part, out):
    """What becomes of the body that lane i has stopped, or is done with; if it slips, it is put in place j of `sl`.

    start: row of `handover`; w: `contact.work_space`; part: what lanes have found, added to `out`; k: its row.
    """
    count_in(par, start, part, out)
    if part[of_lanes.STATUS] != GIVES_WAY:
        return ENDED
    t, q, v = start[carry.T], start[carry.Q], start[carry.V]
    if st[lane.PIECE + i] >= st[lane.LAST + i] or t <= start[carry.SINCE]:
        return ELSEWHERE
    start[carry.SINCE] = t
    slips.clear(sl, j)
    sl[slips.LEN + j], sl[slips.DT + j], sl[slips.END + j] = st[lane.DT + i], st[lane.DT + i], st[lane.LAST + i]
    sl[slips.FIRST + j], sl[slips.PIECE + j], sl[slips.X + j] = (
        st[lane.FIRST + i], st[lane.PIECE + i], st[lane.X + i],
    )  # fmt: skip
    sl[slips.CASE + j] = k
    foot = Foot(start[carry.SIDE], 0.0, q, v, 0.0, start[carry.SLIDE])
    sl[slips.WORK + j] = energy_on_edge(par, foot)
    scales, ahead = scales_of(par, how.tol), look_ahead(sl, j, par, values, slopes, w)
    if q == v == 0.0:
        mode, s, sigma = on_base(par, 0.0, w[row.A_G][0], par[at.G])
        foot = Foot(s, sigma, 0.0, 0.0, 0.0, foot.place)
        if mode == SLIDE_ROCK:
            note_uplift(t, out)
            note_slip(t, True, False, out)
            put(sl, j, par, scales, foot, 2.0, out)
            return SLIPPING
        if mode != ROCK:
            return ELSEWHERE
    step = next_step(par, how, scales, ROCK, foot, Air(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, NO_EDGE), 0, ahead, w)
    return go(sl, j, par, how, scales, ROCK, foot, step, ahead, start, w, out)


@jit
def look_after(sl, j, par, how, start, values, slopes, series, w, out):
    """What becomes of a body that slips, the step of which in `series` may hold an event or an extreme."""
    scales, ahead = scales_of(par, how.tol), look_ahead(sl, j, par, values, slopes, w)
    h, foot = sl[slips.H + j], foot_of(sl, j)
    copy_series(series, j % WIDTH, h, how.extremes, w)
    out[to.N_MIN] = min(out[to.N_MIN], sl[slips.N_LEAST + j])
    launch = int(sl[slips.LAUNCH + j]) - 1
    step = first_event(par, scales, SLIDE_ROCK, foot, launch, h, ahead, lane.ORDER, lane.ORDER - 1, w)
    return go(sl, j, par, how, scales, SLIDE_ROCK, foot, step, ahead, start, w, out)


@jit
def foot_of(sl, j):
    """The body at place j."""
    side, sigma, q, v = sl[slips.SIDE + j], sl[slips.SIGMA + j], sl[slips.Q + j], sl[slips.V + j]
    return Foot(side, sigma, q, v, sl[slips.U + j], sl[slips.SLIDE + j])


@jit
def look_ahead(sl, j, par, values, slopes, w):
    """What lies ahead of a body in its sample."""
    k, x = int(sl[slips.PIECE + j]), sl[slips.X + j]
    pitch = slopes[k] * par[at.FACTOR_H]
    w[row.A_G][0], w[row.A_G][1] = values[k] * par[at.FACTOR_H] + pitch * x, pitch
    w[row.WEIGHT][0], w[row.WEIGHT][1] = par[at.G], 0.0
    left = sl[slips.LEN + j] - x
    return Ahead(time_of(sl, j) + left, left, 1, True, False)


@jit
def time_of(sl, j):
    """Time of a body [s]."""
    return (sl[slips.PIECE + j] - sl[slips.FIRST + j]) * sl[slips.DT + j] + sl[slips.X + j]


@jit
def go(sl, j, par, how, scales, mode, foot, step, ahead, start, w, out):
    """Take a body to the end of its step, its event or not, and see to that."""
    if step.event == DIVERGES:
        return leave(sl, j, par, foot, ELSEWHERE, start, out)
    t = time_of(sl, j)
    if how.balance:
        sl[slips.WORK + j] += work(par, mode, foot, step, how.order, 1, True, w)
    if step.x > 0.0:  # a foot that slips at once has other forces
        note_on_edge(par, how, mode, foot, step, t, True, 1, w, out)
    event = step.event
    foot = moved(mode, foot, step, event == STOPS, event == LANDS, w)
    if mode == SLIDE_ROCK:
        note_slide(foot.place, out)
    if step.x == ahead.h or sl[slips.X + j] + step.x >= sl[slips.LEN + j]:
        sl[slips.PIECE + j] += 1.0
        sl[slips.X + j] = 0.0
    else:
        sl[slips.X + j] += step.x
    t = time_of(sl, j)

    becomes, launch = SLIPPING, 0.0
    if event == NO_EVENT:
        becomes = HOLDING if mode == ROCK else SLIPPING
    elif event == SLIPS:
        foot = Foot(foot.s, step.way, foot.q, foot.v, 0.0, foot.place)
        beta = par[edge_under(foot.s) + at.ALPHA] - foot.q
        launch = 2.0 if par[at.MU_S] == par[at.MU_K] else 1.0
        if stiffness(par, edge_under(foot.s), beta, par[at.MU_K] * foot.s * step.way) <= 0.0:
            becomes = ELSEWHERE
        else:
            note_slip(t, True, False, out)
    elif event == TOPPLES:
        becomes = ENDED
    elif event in (STOPS, LANDS):
        slow = False
        if event == LANDS:
            hit = -foot.v
            foot, change = landed(par, foot, out)
            sl[slips.WORK + j] += change
            note_carried(scales, hit, t, out)
            if counts(par, -foot.s, hit):
                out[to.N_IMPACTS] += 1
            slow = foot.v <= 0.0 or settles(par, foot, w, 1, step.x, ahead.h - step.x, how.rest_speed)[0] >= 0.0
        new, sigma = on_edge(par, foot, w[row.A_G][0] + w[row.A_G][1] * step.x, par[at.G])
        if slow or new not in (ROCK, SLIDE_ROCK):
            becomes = ELSEWHERE
        elif new == ROCK:
            becomes = HOLDING
        else:
            note_slip(t, True, mode == SLIDE_ROCK, out)
            launch = 2.0 if foot.u == 0.0 else 0.0
            foot = Foot(foot.s, sigma, foot.q, foot.v, foot.u, foot.place)
    else:
        becomes = ELSEWHERE
    if becomes in (HOLDING, SLIPPING) and t >= par[at.T_MOTION] - sl[slips.DT + j]:
        if becomes == SLIPPING and foot.u == 0.0:
            out[to.N_SLIPS] -= 1  # the kernel of contact counts it, which has it begin
        becomes = ELSEWHERE  # the end of the motion is near
    if becomes == SLIPPING:
        if mode == SLIDE_ROCK and event != LANDS:
            place_at(sl, j, foot, launch, out)
        else:
            put(sl, j, par, scales, foot, launch, out)
        return SLIPPING
    return leave(sl, j, par, foot, becomes, start, out)


@jit
def put(sl, j, par, scales, foot, launch, out):
    """Put a body that begins to slip, or to slip about another edge, into its place."""
    e = edge_under(foot.s)
    alpha, radius = par[e + at.ALPHA], par[e + at.RADIUS]
    sl[slips.SMALL + j], sl[slips.SPEED + j] = 0.08 * scales.small, 0.08 * scales.speed
    sl[slips.SIN_ALPHA + j], sl[slips.COS_ALPHA + j], sl[slips.ALPHA + j] = math.sin(alpha), math.cos(alpha), alpha
    sl[slips.R + j], sl[slips.K2 + j], sl[slips.GRAVITY + j] = radius, radius * radius / par[at.RG2], par[at.G]
    sl[slips.FACTOR + j], sl[slips.MU + j], sl[slips.TOP + j] = par[at.FACTOR_H], par[at.MU_K], par[at.TOP]
    sl[slips.CAP + j] = sl[slips.LEN + j]
    out[to.RATE_PEAK] = max(out[to.RATE_PEAK], abs(foot.v))  # a foot that slips may turn faster as it lands
    place_at(sl, j, foot, launch, out)


@jit
def place_at(sl, j, foot, launch, out):
    """Where a body that slips is, and what may be extreme from there on."""
    sl[slips.SIGMA + j], sl[slips.SIDE + j], sl[slips.LAUNCH + j] = foot.sigma, foot.s, launch
    sl[slips.Q + j], sl[slips.V + j], sl[slips.U + j], sl[slips.SLIDE + j] = foot.q, foot.v, foot.u, foot.place
    sl[slips.PEAK + j] = out[to.PEAK_RIGHT] if foot.s > 0.0 else out[to.PEAK_LEFT]
    sl[slips.RATE_MAX + j], sl[slips.N_LEAST + j], sl[slips.TOP_MOST + j] = (
        out[to.RATE_PEAK], out[to.N_MIN], out[to.TOP_PEAK],
    )  # fmt: skip


@jit
def leave(sl, j, par, foot, becomes, start, out):
    """Take a body out of its place, and write down where it goes on."""
    t = time_of(sl, j)
    start[carry.T], start[carry.SIDE], start[carry.Q], start[carry.V] = t, foot.s, foot.q, foot.v
    start[carry.U], start[carry.SLIDE] = foot.u, foot.place
    note_slide(foot.place, out)
    out[to.BALANCE] += sl[slips.WORK + j] - energy_on_edge(par, foot)
    out[to.N_STEPS] += sl[slips.STEPS + j]
    out[to.T_END], out[to.SLIDE_END] = min(t, par[at.T_STOP]), foot.place
    if becomes == ENDED:
        out[to.STATUS], out[to.VERDICT], out[to.PEAK_SIDE] = DONE, FALLS, foot.s
    return becomes


@jit
def give_up(sl, j, par, start, out):
    """Leave a body that slips to the kernel of contact where it is: the motion ends, or its steps are too short."""
    out[to.N_MIN] = min(out[to.N_MIN], sl[slips.N_LEAST + j])
    return leave(sl, j, par, foot_of(sl, j), ELSEWHERE, start, out)
