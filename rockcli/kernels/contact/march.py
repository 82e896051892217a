"""The body on the ground as a hybrid automaton with five modes: flow, guard, mode by complementarity (docs/contact.md).

Steps land on the breakpoints of the motion; flows are Taylor series, guards their polynomials, so that an event is
known to rounding (`steps`).  After an event the mode is chosen anew, with the ground motion just after it (`events`).
"""

from __future__ import annotations

import math

from rockcli.kernels import handover as carry
from rockcli.kernels.ahead import CUBE, MATRIX
from rockcli.kernels.constants import (
    DONE,
    FALLS,
    HOLDS,
    MAX_ORDER,
    NOT_FINITE,
    NOT_YET,
    OUT_OF_STEPS,
    PATIENCE,
    RETURNS,
    STALLED,
    UNDECIDED,
)
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.codes import (
    DIVERGES,
    FLIGHT,
    JAMS,
    LANDS,
    NO_EDGE,
    NO_EVENT,
    ON_BASE,
    ON_EDGE,
    REST,
    ROCK,
    SETTLED,
    SLIDE,
    SLIDE_ROCK,
    STOPS,
    STRIKES,
    TOPPLES,
)
from rockcli.kernels.contact.decay import only_decays, shows_more, swung
from rockcli.kernels.contact.events import entered, flown, gave_way, landed, moved, struck
from rockcli.kernels.contact.parts import add_part
from rockcli.kernels.contact.readings import (
    counts,
    energy_in_flight,
    energy_on_edge,
    note_angle,
    note_carried,
    note_event,
    note_impact,
    note_slide,
    note_step,
    slide_in_flight,
    work,
    write_bounces,
    write_rest,
    write_step,
)
from rockcli.kernels.contact.rest import creeps, scales_of, settles
from rockcli.kernels.contact.sliding import skimmed
from rockcli.kernels.contact.state import Air, Foot, Settings, edge_under
from rockcli.kernels.contact.steps import ground_ahead, next_step
from rockcli.kernels.jit import entry, jit, jit_part, rows
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, piece_at, piece_end
from rockcli.kernels.rigid.settings import Channel

SAME_INSTANT = 3
"""Events at one instant up to which the mode is chosen anew; after that they are taken as they come."""

A_WHILE = 1.0
"""Samples for which a foot has held after which a case is handed back: bounces that end in rest are not worth it."""


def work_space():
    """Work space of `march_all`, the rows of `workspace`."""
    return rows(row.N_ROWS, MAX_ORDER + 2)


@jit
def begin(par, start, out):
    """Where a case starts, and its results so far: (foot, what the mode is chosen for).

    Of one that goes on from a row of `handover` `out` holds what has been found up to there.
    """
    if start[carry.T] >= 0.0:
        q, v = start[carry.Q], start[carry.V]
        foot = Foot(start[carry.SIDE], 0.0, q, v, start[carry.U], start[carry.SLIDE])
        return foot, ON_BASE if q == v == 0.0 else ON_EDGE
    for i in range(to.N_OUT):
        out[i] = 0.0
    for i in (to.T_PEAK, to.T_UPLIFT, to.T_OVERTURN, to.T_REST, to.T_SLIP, to.T_SLIDE_ROCK, to.T_FLIGHT):
        out[i] = math.nan
    out[to.N_MIN] = out[to.N_STANDING] = out[to.NEARLY_FLAT] = math.inf
    s, q, v, pick = 1.0, abs(par[at.THETA_0]), 0.0, ON_BASE
    if par[at.THETA_0] != 0.0 or par[at.THETA_DOT_0] != 0.0:
        lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
        s = 1.0 if lead > 0.0 else -1.0
        v, pick = s * par[at.THETA_DOT_0], ON_EDGE
        out[to.T_UPLIFT] = 0.0
        note_angle(q, s, 0.0, 0.0, out)
        if q >= par[edge_under(s) + at.ALPHA]:
            out[to.T_OVERTURN] = 0.0
    out[to.RATE_PEAK] = abs(v)
    out[to.TOP_PEAK] = par[at.TOP] * math.sin(min(q, 0.5 * math.pi))
    return Foot(s, 0.0, q, v, par[at.SLIDE_RATE_0], 0.0), pick


@jit
def followed_until(par, scales, t, mode, foot):
    """Time up to which a case is followed from t: the report, then PATIENCE; a slide after the motion to its end."""
    t_stop = par[at.T_STOP]
    if t < t_stop:
        return t_stop
    last = t_stop + PATIENCE / scales.p_min
    if mode == SLIDE and t >= par[at.T_MOTION] and par[at.MU_K] > 0.0:
        last = max(last, t + 2.0 * abs(foot.u) / (par[at.MU_K] * par[at.G]))
    return last


@jit
def ended(par, scales, t, mode, foot, air, watched, out):
    """What becomes of a body by now, or NOT_YET."""
    t_motion, t_stop, lasts = par[at.T_MOTION], par[at.T_STOP], par[at.HAS_DURATION] == 1.0
    if t >= t_motion and mode == REST and (not lasts or t >= t_stop):
        return RETURNS
    if t >= max(t_motion, t_stop) and mode == ROCK and not watched and only_decays(par, foot, out):
        return RETURNS
    if t < t_stop + PATIENCE / scales.p_min:
        return NOT_YET
    if mode in (REST, SLIDE):
        return RETURNS if t >= t_motion else UNDECIDED
    R_min = min(par[at.LEFT + at.RADIUS], par[at.RIGHT + at.RADIUS])
    barrier = par[at.G] * R_min - par[at.G] * par[at.H]
    if mode == FLIGHT:
        energy, angle = energy_in_flight(par, air), abs(air.theta)
    else:
        energy, angle = energy_on_edge(par, foot), foot.q
    return RETURNS if t >= t_motion and angle < scales.alpha_min and energy < barrier else UNDECIDED


@jit_part
def taken_along(par, how, mode, foot, air, step, t, t_new, counted, ahead, w, dt_out, i_hist, histories, out):
    """A body goes along its step, and what is found on the way is noted: (foot, air, work, next output)."""
    worked, n = 0.0, how.order
    if how.balance:
        worked = work(par, mode, foot, step, n, ahead.degree, ahead.level, w)
    note_step(par, how, mode, foot, air, step, t, counted, ahead, w, out)
    until = min(t_new, par[at.T_STOP])
    i_hist = write_step(par, mode, foot, air, step, t, until, n, w, dt_out, i_hist, histories)
    if mode == FLIGHT:
        return foot, flown(air, n, step.x, w), worked, i_hist
    foot = moved(mode, foot, step, step.event == STOPS, step.event == LANDS, w)
    if counted and mode in (SLIDE, SLIDE_ROCK):
        note_slide(foot.place, out)
        if mode == SLIDE:
            out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(foot.place))
    return foot, air, worked, i_hist


@jit
def came_down(
    par, how, scales, t_was, t, foot, ahead, stalled, counted, skips, dt_out, i_hist, histories, impacts, w, balance,
    out,
):  # fmt: skip
    """A body comes down on its other edge, and may bounce to rest: (pick, t, foot, next output, balance)."""
    hit = -foot.v
    if hit == 0.0:
        return ON_BASE, t, foot, i_hist, balance
    foot, change = landed(par, foot, out)
    balance += change
    if t <= par[at.T_STOP]:
        note_carried(scales, hit, t, out)
        if counts(par, -foot.s, hit):
            note_impact(t, foot.s * hit, foot.s * foot.v, impacts, out)
    if stalled > STALLED:
        foot = Foot(foot.s, foot.sigma, 0.0, 0.0, foot.u, foot.place)
    if not foot.v > 0.0:
        return ON_BASE, t, foot, i_hist, balance
    if skips and t_was >= par[at.T_MOTION] and only_decays(par, foot, out) and not shows_more(par, foot, out):
        t, foot, change = swung(par, scales, t, foot, how.rest_speed, impacts, out)
        balance += change
    wait, slid = settles(par, foot, w, ahead.degree, t - t_was, ahead.t_next - t, how.rest_speed)
    if wait < 0.0:
        return ON_EDGE, t, foot, i_hist, balance
    balance -= energy_on_edge(par, foot) - 0.5 * slid * slid
    i_hist = write_bounces(foot, t, min(t + wait, par[at.T_STOP]), dt_out, i_hist, histories)
    foot = Foot(foot.s, foot.sigma, 0.0, 0.0, slid, foot.place + 0.5 * (foot.u + slid) * wait)
    if counted:
        note_slide(foot.place, out)
    return ON_BASE, t + wait, foot, i_hist, balance


@jit
def finish(par, how, t, mode, foot, air, balance, dt_out, i_hist, histories, out):
    """Results that the end of a case gives."""
    lasts, t_stop = par[at.HAS_DURATION] == 1.0, par[at.T_STOP]
    out[to.T_END] = t_stop if lasts else min(t, t_stop)
    if out[to.STATUS] != DONE:
        out[to.VERDICT] = UNDECIDED
    left, place = (energy_on_edge(par, foot) if mode != REST else 0.0), foot.place
    if mode == FLIGHT:
        left, place = energy_in_flight(par, air), slide_in_flight(par, air.x, air.theta)
    if mode == SLIDE and par[at.MU_K] == 0.0 and not creeps(par, foot):  # nothing stops it
        place = math.copysign(math.inf, foot.u)
        if not lasts:
            out[to.SLIDE_PEAK], out[to.TOP_PEAK] = place, math.inf
    out[to.SLIP_LEFT] = foot.u if mode == SLIDE_ROCK and out[to.VERDICT] != FALLS else 0.0
    out[to.BALANCE], out[to.SLIDE_END] = (balance - left if how.balance else math.nan), place
    if mode == REST:
        write_rest(foot, out[to.T_END], dt_out, i_hist, histories)


@jit
def march(par, how, horizontal, h_data, vertical, v_data, dt_out, start, histories, impacts, events, w, out):
    """Solve one case, from where `start`, a row of `handover`, has it: then `out` goes on from what it holds.

    Motion channels as those of `rigid.march`.  `histories` are theta, theta', slide, slide rate, mode and lift at
    i dt_out as far as they are long, `impacts` t, theta' before and after, `events` time and mode entered; the mode
    at t = 0 is no event.  A body of which only free swings are left is not followed through them, nor to its rest after
    the report, unless histories or events are wanted.
    """
    lasts, t_stop = par[at.HAS_DURATION] == 1.0, par[at.T_STOP]
    scales = scales_of(par, how.tol)
    for i in range(row.N_ROWS):  # nothing of the case before
        for k in range(MAX_ORDER + 2):
            w[i][k] = 0.0
    foot, pick = begin(par, start, out)
    out[to.STATUS], out[to.VERDICT] = DONE, UNDECIDED
    air = Air(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, NO_EDGE)
    balance = energy_on_edge(par, foot) + out[to.BALANCE]
    t, mode, launch = max(start[carry.T], 0.0), REST, 0
    ih = iv = i_hist = stalled = 0
    t_held = t
    hands_back = how.hands_back and horizontal.kind == SAMPLES
    if horizontal.kind == SAMPLES:
        ih = max(int(t / horizontal.dt) - 1, 0)
    slipped, jumped = foot.u != 0.0 and start[carry.T] >= 0.0, False
    watched = len(events[0]) > 0
    skips = len(histories[0]) == 0 and not watched
    skims = horizontal.kind == SAMPLES and vertical.kind == NOTHING and len(histories[0]) == 0

    while True:
        if pick == SETTLED:
            verdict = ended(par, scales, t, mode, foot, air, watched, out)
            if verdict != NOT_YET:
                out[to.VERDICT] = verdict
                break
            if mode not in (REST, ROCK):
                t_held = t
            if hands_back and t - t_held > A_WHILE * horizontal.dt and t < par[at.T_MOTION] - horizontal.dt:
                out[to.STATUS] = HOLDS
                break
        if skims and pick == SETTLED and t < par[at.T_MOTION] and (mode == REST or (mode == SLIDE and foot.u != 0.0)):
            ih = piece_at(horizontal, h_data, ih, t)
            after, foot, worked = skimmed(par, mode, horizontal, h_data, ih, t, foot, out)
            if after > ih:
                balance += worked
                t, ih, stalled, launch = piece_end(horizontal, h_data, after - 1), after, 0, 0
                t_held = t if mode == SLIDE else t_held
                continue
        if out[to.N_STEPS] >= how.max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break
        out[to.N_STEPS] += 1
        if t < par[at.T_MOTION]:
            ih, iv = piece_at(horizontal, h_data, ih, t), piece_at(vertical, v_data, iv, t)
        t_end = followed_until(par, scales, t, mode, foot)
        ahead = ground_ahead(
            par, how, scales, mode, t, t_end, stalled, ih, iv, horizontal, h_data, vertical, v_data, w
        )  # fmt: skip

        # the mode, with the ground motion from now on
        if pick != SETTLED:
            mode, foot, air, launch, slipped, change = entered(
                par, pick, mode, t, foot, air, slipped, jumped, w[row.A_G][0], w[row.WEIGHT][0], events, out
            )  # fmt: skip
            balance += change
            pick, jumped = SETTLED, False
            continue  # expanded again, as the step may begin with this mode's own guards

        step = next_step(par, how, scales, mode, foot, air, launch, ahead, w)
        if step.event == DIVERGES:
            out[to.STATUS] = NOT_FINITE
            break

        x, event = step.x, step.event
        t_was, t_new = t, (ahead.t_next if x == ahead.t_next - t else t + x)
        counted = t < t_stop or not lasts
        foot, air, worked, i_hist = taken_along(
            par, how, mode, foot, air, step, t, t_new, counted, ahead, w, dt_out, i_hist, histories, out
        )  # fmt: skip
        balance += worked
        stalled = 0 if ahead.stuck else stalled
        stalled = stalled + 1 if t_new == t else 0
        t = t_new
        if event == NO_EVENT:
            if x > 0.0:
                launch = 0
            continue

        # the event
        if event in (STRIKES, LANDS) and t > t_stop:
            out[to.STRUCK_LATER] = 1.0
        if event == TOPPLES:
            out[to.VERDICT] = FALLS
            out[to.PEAK_SIDE] = foot.s if mode != FLIGHT else math.copysign(1.0, air.theta)
            break
        if event == STRIKES:
            pick, foot, air, change = struck(par, scales, t, step.way, foot, air, impacts, out)
            balance += change
            if pick == SETTLED:  # it bounces
                launch = 1
                note_event(t, FLIGHT, events, out)
                continue
            if not (pick == ON_EDGE and foot.q == 0.0 and foot.v < 0.0):
                continue
            event, mode = LANDS, ROCK  # the other edge at once
        if event == LANDS:
            pick, t, foot, i_hist, balance = came_down(
                par, how, scales, t_was, t, foot, ahead, stalled, counted, skips, dt_out, i_hist, histories, impacts, w,
                balance, out,
            )  # fmt: skip
            continue
        if event == STOPS:
            foot = Foot(foot.s, foot.sigma, foot.q, foot.v, 0.0, foot.place)
            pick = ON_BASE if mode == SLIDE else ON_EDGE
            continue
        if event == JAMS or x == 0.0:  # also a jump of the ground: what holds is told by complementarity
            pick = ON_BASE if mode in (REST, SLIDE) else ON_EDGE
            jumped = event != JAMS
            if event == JAMS or stalled <= SAME_INSTANT:
                continue
        pick, jumped = SETTLED, False
        mode, foot, air, launch, slipped = gave_way(
            par, event, step.way, mode, t, foot, air, launch, slipped, events, out
        )  # fmt: skip

    if hands_back:
        start[carry.T], start[carry.SIDE], start[carry.SLIDE], start[carry.U] = t, foot.s, foot.place, 0.0
        start[carry.Q], start[carry.V] = (0.0, 0.0) if mode == REST else (foot.q, foot.v)
    finish(par, how, t, mode, foot, air, balance, dt_out, i_hist, histories, out)


@entry(MATRIX, Settings, Channel, MATRIX, Channel, MATRIX, float, MATRIX, CUBE, CUBE, CUBE, MATRIX, MATRIX)
def march_all(
    pars, how, horizontal, h_data, vertical, v_data, dt_out, starts, histories, impacts, events, w, out
):  # fmt: skip
    """`march` for every row of `pars`; starts, histories, impacts, events, results, tables of pulses row by row too.

    w: `work_space()`.
    """
    for i in range(len(pars)):
        ih, iv = (i if horizontal.kind == PULSES else 0), (i if vertical.kind == PULSES else 0)
        march(
            pars[i], how, horizontal, h_data[ih], vertical, v_data[iv], dt_out, starts[i], histories[i], impacts[i],
            events[i], w, out[i],
        )  # fmt: skip


@entry(MATRIX, MATRIX, MATRIX, MATRIX)
def add_parts(pars, starts, parts, out):
    """Add to results what lanes have found of bodies up to their start, row by row."""
    for i in range(len(pars)):
        add_part(pars[i], starts[i][carry.SLIDE], parts[i], out[i])
