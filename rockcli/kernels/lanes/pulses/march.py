"""Many pulse cases at once: lanes that run each at its own pace, refilled as their cases end (docs/lanes.md).

A lane goes through the same modes, guards and resets as `march`; what is rare or doubtful is left to `march`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rockcli.kernels.ahead import MATRIX, ROWS, VECTOR
from rockcli.kernels.constants import FALLS, FAST, LEFT_TO_MARCH, RETURNS
from rockcli.kernels.jit import entry, jit, jit_part
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.early_outcome import judge
from rockcli.kernels.lanes.pulses.events import find_impacts, find_tops, find_uplifts
from rockcli.kernels.lanes.pulses.forces import WAITING, bounces_matter, find_extremes, note_standing
from rockcli.kernels.lanes.pulses.free_rocking import BACKLOG, count_impacts
from rockcli.kernels.lanes.pulses.ground import expand
from rockcli.kernels.lanes.pulses.path import (
    enter_path,
    follow,
    is_followed,
    judge_path,
    leave_path,
    never_lifted,
)
from rockcli.kernels.lanes.pulses.rolling import (
    SLOWEST,
    bounce,
    enter_rolling,
    find_touches,
    judge_rolling,
    leave_rolling,
    left_alone,
    may_only_bounce,
    rest_on_facet,
    roll_freely,
    roll_over,
)
from rockcli.kernels.lanes.pulses.series import flow, flow_linear, look_along, reach_of
from rockcli.kernels.lanes.pulses.state import (
    ORDER,
    STRIDE,
    enter,
    leave,
    next_piece,
    put,
    series_of_a,
    series_of_q,
    to_the_edge,
)
from rockcli.kernels.lanes.pulses.uplift_screen import (
    BELL_E,
    ENERGY,
    KNOWN,
    SCREEN_FIELDS,
    SIDE,
    UPLIFT_T,
    leave_screened,
    screen,
)
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import load, note, room, select, some, store
from rockcli.kernels.quadrature import LOW
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.ground import NEAR
from rockcli.kernels.rigid.law import edge_of, potential
from rockcli.kernels.rigid.march import ALL, OUTCOME
from rockcli.kernels.rigid.rest import rest_time
from rockcli.kernels.rigid.settings import Degrees
from rockcli.kernels.rigid.settings import Settings as Settings

SAFE = 0.03
"""Part of the tolerance that the last two terms of a step may have: then errors are those of single bodies, whose
series are longer, and the estimates of errors hold for both.  A tenth of it costs an eighth more steps."""


class Cases(NamedTuple):
    """Of all cases, row by row, and their order; see `sweep`."""

    order: Any
    pars: Any
    bodies: Any
    tables: Any
    pieces: int
    out: Any


class Asked(NamedTuple):
    """How they are solved, and what for; see `sweep`.  rolls: bodies may roll; watch: forces are asked for."""

    how: Any
    two_sided: bool
    rolls: bool
    path: bool
    watch: bool
    until_fall: bool


class Space(NamedTuple):
    """Work space.

    Lanes; room for the series of a vector; what is screened; postponed cases; extremes that wait; then lists of lanes.
    """

    state: Any
    scratch: Any
    screened: Any
    backlog: Any
    waiting: Any
    asking: Any
    lifting: Any
    ending: Any
    moving: Any
    slowing: Any
    bouncing: Any
    touching: Any


@entry(ROWS, MATRIX, MATRIX, Settings, MATRIX, int, bool, bool, bool, VECTOR, MATRIX)
def sweep(order, pars, bodies, how, tables, pieces, two_sided, path, until_fall, work, out):
    """Solve every row of `pars` under the pulse of its row of `tables`, in an `order` that changes no answer.

    `two_sided`: the edges of these bodies differ.  `path`: the whole path is asked for, and with `how.detail` ALL the
    forces on it; then under a nonlinear law.  `until_fall`: but not beyond the last passage of the equilibrium of
    a body on two edges.  `work`: `work_space()`; `out`
    zeros.
    bodies: none, or the table of `kernels.rolling.parameters` of bodies that roll; then the edges in `pars` are those
    of the facet on which a body stands, and a last column is the row of its body.
    What is not done here has STATUS LEFT_TO_MARCH.
    """
    space = space_of(work)
    state = space.state
    cases = Cases(order, pars, bodies, tables, pieces, out)
    asked = Asked(how, two_sided, len(bodies) > 0, path, path and how.detail == ALL, until_fall)
    upcoming = busy = n_postponed = n_ending = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        for i in range(o, o + WIDTH):
            put(state, i, lane.MODE, lane.IDLE)
            put(state, i, lane.EVENT, lane.IDLE)
            put(state, i, lane.CASE, -1.0)
            space.ending[n_ending] = i
            n_ending += 1
    while True:
        for j in range(n_ending):
            i = int(space.ending[j])
            if state[i + lane.CASE * WIDTH] >= 0.0:
                finish_case(state, i, cases, asked)
                busy -= 1
            upcoming, came = next_case(state, i, upcoming, space.screened, cases, asked)
            busy += came
        if busy == 0:
            if n_postponed > 0:
                count_impacts(space.backlog, n_postponed, how.linear, two_sided, path, out)
            return
        touch(look_at_all(space, asked), space, cases, asked)
        n_moving, n_slowing, n_bouncing = advance_all(space, asked)
        slow_down(n_slowing, space, cases, asked)
        for j in range(n_moving):
            i = int(space.moving[j])
            next_piece(state, i, tables[int(state[i + lane.CASE * WIDTH])], pieces)
        n_postponed = leave_bouncing(n_bouncing, n_postponed, space, cases, asked)
        n_ending = judge_all(space, cases, asked)


@jit_part
def look_at_all(space, asked):
    """Expand all lanes and find their events: how many touch the next facet, or their wall, listed in `touching`."""
    how, state = asked.how, space.state
    n_asking = n_lifting = n_waiting = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        look(state, o, how.linear, asked.two_sided, asked.rolls or asked.path, how.tol, space.scratch)
        event = load(state, o + lane.EVENT * WIDTH)
        n_asking = listed(event == lane.IMPACT, o, space.asking, n_asking)
        n_lifting = listed(event == lane.UPLIFT, o, space.lifting, n_lifting)
    find_impacts(state, space.scratch, space.asking, n_asking)
    find_uplifts(state, asked.two_sided, space.scratch, space.lifting, n_lifting)
    n_touching = find_touches(state, space.scratch, space.touching) if asked.rolls or asked.path else 0
    if how.detail > OUTCOME:
        find_tops(state, how.tol, space.scratch, space.asking)
    if asked.path:
        for o in range(0, lane.VECTORS * STRIDE, STRIDE):
            n_waiting = follow(
                state, o, asked.watch, asked.two_sided, asked.rolls, space.waiting, n_waiting, space.scratch
            )
        if n_waiting > 0:
            find_extremes(state, space.waiting, 0, n_waiting, space.scratch)
    return n_touching


@jit_part
def touch(count, space, cases, asked):
    """Turn the first `count` lanes of `touching` over to the next facet, or put them on the ground."""
    state = space.state
    for j in range(count):
        i = int(space.touching[j])
        if state[i + lane.EVENT * WIDTH] != lane.TOUCH:
            continue
        if asked.rolls:
            par = cases.pars[int(state[i + lane.CASE * WIDTH])]
            roll_over(state, i, cases.bodies[int(par[at.N_PAR])], par[at.G], asked.path)
        else:
            put(state, i, lane.NEW_Q, state[i + lane.L_EXTENT * WIDTH])


@jit_part
def advance_all(space, asked):
    """Take all lanes to the ends of their steps: how many are at the end of a piece, may rest, may only bounce."""
    how, state = asked.how, space.state
    n_moving = n_slowing = n_bouncing = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        if asked.watch:
            note_standing(state, o)
        slow = SLOWEST * how.rest_speed if asked.rolls else how.rest_speed
        advance(state, o, asked.two_sided, asked.rolls, asked.path, slow)
        event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
        past = load(state, o + lane.T * WIDTH) >= load(state, o + lane.T_NEXT * WIDTH)
        n_moving = listed((event >= lane.NONE) & (event < lane.DONE) & past, o, space.moving, n_moving)
        n_slowing = listed((event == lane.IMPACT) & (mode == lane.REST), o, space.slowing, n_slowing)
        if how.detail > OUTCOME and asked.rolls:
            n_bouncing = listed(may_only_bounce(state, o), o, space.bouncing, n_bouncing)
        elif how.detail > OUTCOME:
            bounces = only_bounces(state, o, how.tol, how.linear, asked.two_sided)
            if asked.watch:
                bounces = bounces & ~bounces_matter(state, o, asked.two_sided)
            n_bouncing = listed(bounces, o, space.bouncing, n_bouncing)
    return n_moving, n_slowing, n_bouncing


@jit_part
def slow_down(count, space, cases, asked):
    """The first `count` lanes of `slowing` come to rest, or go on rocking."""
    state, rest_speed = space.state, asked.how.rest_speed
    for j in range(count):
        i = int(space.slowing[j])
        par = cases.pars[int(state[i + lane.CASE * WIDTH])]
        if asked.rolls:
            rest_on_facet(state, i, cases.bodies[int(par[at.N_PAR])], par[at.G], rest_speed, space.scratch)
        else:
            v = state[i + lane.V * WIDTH]
            come_to_rest(state, i, par, rest_speed, space.scratch)
            if asked.path and state[i + lane.V * WIDTH] == 0.0:
                put(state, i, lane.LOST, state[i + lane.LOST * WIDTH] + state[i + lane.L_MASS * WIDTH] * v * v)


@jit_part
def leave_bouncing(count, n_postponed, space, cases, asked):
    """Of the first `count` lanes of `bouncing` only impacts are to be counted: how many wait for that by now."""
    how, state = asked.how, space.state
    for j in range(count):
        i = int(space.bouncing[j])
        if asked.rolls:
            par = cases.pars[int(state[i + lane.CASE * WIDTH])]
            body = cases.bodies[int(par[at.N_PAR])]
            bounce(state, i, body, par[at.G], how.rest_speed, asked.path, asked.watch)
            continue
        postpone(state, i, space.backlog, n_postponed, asked.two_sided, how.rest_speed)
        n_postponed += 1
        if n_postponed == WIDTH:
            count_impacts(space.backlog, n_postponed, how.linear, asked.two_sided, asked.path, cases.out)
            n_postponed = 0
    return n_postponed


@jit_part
def judge_all(space, cases, asked):
    """Decide what is known of all lanes: how many are done, listed in `ending`."""
    how, state = asked.how, space.state
    count = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        if asked.rolls:
            free = listed(left_alone(state, o), o, space.touching, 0)
            for j in range(free):
                i = int(space.touching[j])
                par = cases.pars[int(state[i + lane.CASE * WIDTH])]
                roll_freely(state, i, cases.bodies[int(par[at.N_PAR])], par[at.G], how.margin, how.detail)
            judge_rolling(state, o, how, asked.path)
        elif asked.path:
            judge_path(state, o, how, asked.two_sided, asked.until_fall)
        else:
            judge(state, o, how, asked.two_sided)
        count = listed(load(state, o + lane.EVENT * WIDTH) >= lane.DONE, o, space.ending, count)
    return count


def work_space():
    """Work space of `sweep`."""
    return room(
        lane.VECTORS * STRIDE + (3 * ORDER + 6) * WIDTH + (SCREEN_FIELDS + BACKLOG + 7 * lane.VECTORS) * WIDTH + WAITING
    )


@jit
def space_of(work):
    """The parts of the work space."""
    i = lane.VECTORS * STRIDE
    j = i + (3 * ORDER + 6) * WIDTH
    k = j + SCREEN_FIELDS * WIDTH
    m = k + BACKLOG * WIDTH
    p, n = m + WAITING, lane.VECTORS * WIDTH
    return Space(
        work[:i], work[i:j], work[j:k], work[k:m], work[m:p], work[p : p + n], work[p + n : p + 2 * n],
        work[p + 2 * n : p + 3 * n], work[p + 3 * n : p + 4 * n], work[p + 4 * n : p + 5 * n],
        work[p + 5 * n : p + 6 * n], work[p + 6 * n : p + 7 * n],
    )  # fmt: skip


@jit
def finish_case(state, i, cases, asked):
    """The case in lane i has its answer, or is left to `march`."""
    case = int(state[i + lane.CASE * WIDTH])
    par, out = cases.pars[case], cases.out[case]
    if state[i + lane.EVENT * WIDTH] == lane.FOR_MARCH:
        out[to.STATUS] = LEFT_TO_MARCH
    if asked.path and state[i + lane.VERDICT * WIDTH] == FALLS:
        put(state, i, lane.L_GIVEN, 1.0)  # its rotation grows to the end, as that of a report cut off
    leave(state, i, asked.two_sided and not asked.rolls, state[i + lane.VERDICT * WIDTH], out)
    if asked.path:
        leave_path(state, i, asked.watch, asked.two_sided, par, out)
    if asked.rolls:
        leave_rolling(state, i, cases.bodies[int(par[at.N_PAR])], par[at.G], asked.path, out)
    put(state, i, lane.CASE, -1.0)
    put(state, i, lane.EVENT, lane.IDLE)


@jit
def next_case(state, i, upcoming, screened, cases, asked):
    """The next case that has to be followed goes into lane i: (number of the one after it, 1 or 0 if there is none)."""
    pars, tables, pieces, how, two_sided = cases.pars, cases.tables, cases.pieces, asked.how, asked.two_sided
    while upcoming < len(cases.order):
        case, place = int(cases.order[upcoming]), upcoming % WIDTH
        if place == 0:
            early = how.detail == OUTCOME and not two_sided
            screen(screened, upcoming, cases, how.linear, 100.0 * how.margin, early)
        upcoming += 1
        par, table, out = pars[case], tables[case], cases.out[case]
        if screened[place + KNOWN * WIDTH] > 0.0:
            leave_screened(screened, place, par, out)
            if asked.watch and not never_lifted(par, table, pieces, out):
                out[to.STATUS] = LEFT_TO_MARCH
        elif asked.path and not is_followed(par, table, pieces):
            out[to.STATUS] = LEFT_TO_MARCH
        elif enter(
            state, i, case, par, table, pieces, how.linear, two_sided, screened[place + ENERGY * WIDTH],
            screened[place + UPLIFT_T * WIDTH], screened[place + SIDE * WIDTH], screened[place + BELL_E * WIDTH],
        ):  # fmt: skip
            if asked.rolls:
                enter_rolling(state, i, cases.bodies[int(par[at.N_PAR])], par[at.G], asked.path)
            if asked.path:
                enter_path(state, i, par, table, asked.rolls, asked.watch)
            next_piece(state, i, table, pieces)
            return upcoming, 1
        else:
            out[to.STATUS] = LEFT_TO_MARCH
    return upcoming, 0


@jit
def look(state, o, linear, two_sided, rolls, tol, work):
    """One vector: series, step, and what has to be looked at more closely."""
    mode, event = load(state, o + lane.MODE * WIDTH), load(state, o + lane.EVENT * WIDTH)
    going = (mode >= lane.REST) & (event == lane.NONE)
    if not some(going):
        return
    rocks = mode == lane.ROCK
    expand(state, o)
    forced = some((load(state, o + lane.KIND * WIDTH) > lane.FREE) & rocks)
    if linear:
        flow_linear(state, o, forced, work)
    else:
        flow(state, o, forced, work)
    c = series_of_q(o)
    h = load(state, o + lane.T_NEXT * WIDTH) - load(state, o + lane.T * WIDTH)
    early = (load(state, o + lane.KIND * WIDTH) == lane.BELL) & (load(state, o + lane.UP_T * WIDTH) <= 0.0)
    if some(early):
        most = NEAR / select(early, load(state, o + lane.C1 * WIDTH), 1.0)
        h = select(early & (most < h), most, h)
    most = load(state, o + lane.L_LONGEST * WIDTH)
    rock_h = reach_of(state, c, SAFE * tol * load(state, o + lane.L_ALPHA * WIDTH), select(h < most, h, most))
    if some(mode == lane.REST):
        rock_h = select(rocks, rock_h, h)
        a, guard = series_of_a(o), load(state, o + lane.L_GUARD * WIDTH)
        if two_sided:
            other = load(state, o + lane.TO_OTHER + lane.L_GUARD * WIDTH)
            guard = select(other < guard, other, guard)
        rest_h = reach_of(state, a, 1e-16 * guard, h)
        h = select(rocks, rock_h, rest_h)
        _, _, _, most = look_along(state, a, h)
        event = select(going & (mode == lane.REST) & ~(most < guard), lane.UPLIFT, event)
    else:
        h = rock_h
    P, dP, M, reach = look_along(state, c, h)
    event = select(going & rocks & may_land(state, o, c, h, P, dP, M, reach), lane.IMPACT, event)
    if not linear and not rolls:
        far = going & rocks & (reach >= 0.5 * math.pi)
        if some(far):
            v = load(state, o + lane.V * WIDTH)
            sure = far & (event == lane.NONE) & (0.5 * math.pi <= P) & (v > 0.0) & (dP > 0.0)
            maybe = far & ~sure & ((event == lane.IMPACT) | (0.5 * math.pi <= P) | ((v > 0.0) & (dP <= 0.0)))
            verdict = load(state, o + lane.VERDICT * WIDTH)
            store(state, o + lane.VERDICT * WIDTH, select(sure, 1.0 * FALLS, verdict))
            event = select(sure, lane.DONE, select(maybe, lane.FOR_MARCH, event))
    event = select(going & rocks & ~(h > 0.0), lane.FOR_MARCH, event)
    store(state, o + lane.EVENT * WIDTH, event)
    store(state, o + lane.H * WIDTH, h)
    store(state, o + lane.X * WIDTH, h)
    store(state, o + lane.NEW_Q * WIDTH, select(rocks, P, 0.0))
    store(state, o + lane.NEW_V * WIDTH, select(rocks, dP, 0.0))
    store(state, o + lane.REACH * WIDTH, reach)
    store(state, o + lane.N_STEPS * WIDTH, load(state, o + lane.N_STEPS * WIDTH) + 1.0)


@jit
def listed(where, o, lanes, n):
    """`note` of the lanes of the vector at o, mostly none."""
    return note(where, 1.0 * o, lanes, n) if some(where) else n


@jit
def may_land(state, o, c, h, P, dP, M, reach):
    """Whether the polynomial of q at c, P and dP at h, may have a zero on (0, h]: |P''| <= M and |P| <= reach there.

    Not if the parabolas with M from both ends stay above zero to the middle, nor if P'' < 0 with both ends above, nor
    if the first terms are positive and at h more than all others together.
    """
    q, v, second = load(state, c), load(state, c + WIDTH), load(state, c + 2 * WIDTH)
    bent = 0.125 * M * h * h
    bump = abs(M) > 4.0 * abs(second)  # else P'' has the sign of c2
    low = (q + 0.5 * v * h - bent <= 0.0) | (P - 0.5 * dP * h - bent <= 0.0)
    low = low & (bump | (second >= 0.0))
    lead = q + v * h
    third = load(state, c + 3 * WIDTH)
    launched = (load(state, o + lane.LAUNCH * WIDTH) > 0.0) & (third > 0.0)  # from q = v = 0, P'' >= 0
    lead = select(launched, (second + third * h) * h * h, lead)
    leads = ((v > 0.0) | launched) & (2.0 * lead > reach)
    return (P <= 0.0) | (low & ~leads)


@jit
def advance(state, o, two_sided, rolls, path, rest_speed):
    """One vector: take the step, turn over at impacts, leave rest at uplifts."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    if not some(event >= lane.NONE):
        return
    t, h, x = load(state, o + lane.T * WIDTH), load(state, o + lane.H * WIDTH), load(state, o + lane.X * WIDTH)
    t_next, stop = load(state, o + lane.T_NEXT * WIDTH), load(state, o + lane.L_STOP * WIDTH)
    q, v, s = load(state, o + lane.NEW_Q * WIDTH), load(state, o + lane.NEW_V * WIDTH), load(state, o + lane.S * WIDTH)
    p_alpha = load(state, o + lane.L_P * WIDTH) * load(state, o + lane.L_ALPHA * WIDTH)
    goes = (event >= lane.NONE) & (event < lane.DONE)
    lands = event == lane.IMPACT
    lifts = event == lane.UPLIFT

    rate = select(v < 0.0, -v, 0.0)
    n_impacts = load(state, o + lane.N_IMPACTS * WIDTH)
    counted = lands & (rate > FAST * p_alpha) & (t < stop)
    s = select(lands, -s, s)
    if two_sided:
        store(state, o + lane.S * WIDTH, s)
        to_the_edge(state, o, lane.OF_EDGE if path else (lane.OF_ROLLING if rolls else lane.OF_PLAIN))
        p_alpha = load(state, o + lane.L_P * WIDTH) * load(state, o + lane.L_ALPHA * WIDTH)
    if rolls:
        counted = lands & (rate > FAST * p_alpha) & (t < stop)
    after = load(state, o + lane.L_ETA * WIDTH) * rate
    slow = lands & ((after <= rest_speed * p_alpha) | (after <= 0.0))
    v = select(lands, after, v)
    now = select((event == lane.NONE) & (h == t_next - t), t_next, t + x)
    up = load(state, o + lane.UP_T * WIDTH)

    store(state, o + lane.N_IMPACTS * WIDTH, select(counted, n_impacts + 1.0, n_impacts))
    store(state, o + lane.T * WIDTH, select(goes, now, t))
    store(state, o + lane.Q * WIDTH, select(goes, q, load(state, o + lane.Q * WIDTH)))
    store(state, o + lane.V * WIDTH, select(goes, v, load(state, o + lane.V * WIDTH)))
    store(state, o + lane.S * WIDTH, s)
    store(state, o + lane.UP_T * WIDTH, select(lifts & ~(up >= 0.0), now, up))
    store(state, o + lane.LAUNCH * WIDTH, select(lifts, 1.0, 0.0))
    store(state, o + lane.MODE * WIDTH, select(lifts, lane.ROCK, select(slow, lane.REST, mode)))


@jit
def only_bounces(state, o, tol, linear, two_sided):
    """Lanes that have just landed after the motion, and whose later swings are lower than the peak: only counted."""
    v, eta = load(state, o + lane.V * WIDTH), load(state, o + lane.L_ETA * WIDTH)
    lands = (load(state, o + lane.EVENT * WIDTH) == lane.IMPACT) & (load(state, o + lane.MODE * WIDTH) == lane.ROCK)
    lands = lands & (load(state, o + lane.T * WIDTH) >= load(state, o + lane.L_END * WIDTH))
    lands = lands & (eta <= 1.0)
    if some(lands):
        lands = lands & swings_low(state, o, v, tol, linear)
        if two_sided:
            there = o + lane.TO_OTHER
            lands = lands & swings_low(state, there, v, tol, linear) & (load(state, there + lane.L_ETA * WIDTH) <= 1.0)
    return lands


@jit
def swings_low(state, o, v, tol, linear):
    """Whether a swing that begins with rate v about the edge at o stays below the peak so far of its side."""
    q, star = load(state, o + lane.TOP * WIDTH), load(state, o + lane.L_STAR * WIDTH)
    q = select(q < star, q, star)
    sine, bend = q, 0.5 * q * q
    if not linear:
        sine, cosine = sin_cos(q)
        bend = 1.0 - cosine
    r0, rs, rc = (
        load(state, o + lane.L_R0 * WIDTH), load(state, o + lane.L_RS * WIDTH), load(state, o + lane.L_RC * WIDTH),
    )  # fmt: skip
    height = potential(r0, rc, q, rs * bend, sine)
    low = v * v < LOW * LOW * 2.0 * load(state, o + lane.L_TOP * WIDTH)
    return low & (0.5 * v * v <= height * (1.0 + 1e-12 + 100.0 * tol))


@jit
def postpone(state, i, backlog, slot, two_sided, rest_speed):
    """Lane i is done but for its bounces, which are counted when a vector of such cases has come together."""
    state[i + lane.VERDICT * WIDTH], state[i + lane.EVENT * WIDTH] = 1.0 * RETURNS, lane.DONE
    backlog[slot], backlog[WIDTH + slot] = state[i + lane.CASE * WIDTH], state[i + lane.L_STOP * WIDTH]
    backlog[2 * WIDTH + slot], backlog[3 * WIDTH + slot] = state[i + lane.T * WIDTH], state[i + lane.V * WIDTH]
    slow = rest_speed * state[i + lane.L_P * WIDTH] * math.sin(state[i + lane.L_ALPHA * WIDTH])
    if two_sided:
        there = i + lane.TO_OTHER
        slow = min(slow, rest_speed * state[there + lane.L_P * WIDTH] * math.sin(state[there + lane.L_ALPHA * WIDTH]))
    for edge in range(2):
        o, b = i + edge * lane.TO_OTHER, slot + (4 + 6 * edge) * WIDTH
        p, alpha = state[o + lane.L_P * WIDTH], state[o + lane.L_ALPHA * WIDTH]
        backlog[b], backlog[b + WIDTH] = state[o + lane.L_ETA * WIDTH], FAST * p * alpha
        backlog[b + 2 * WIDTH] = slow
        backlog[b + 3 * WIDTH], backlog[b + 4 * WIDTH] = state[o + lane.L_R0 * WIDTH], state[o + lane.L_RS * WIDTH]
        backlog[b + 5 * WIDTH] = state[o + lane.L_RC * WIDTH]


@jit
def come_to_rest(state, i, par, rest_speed, queue):
    """A slow impact of lane i, put into REST on trial: whether it stays there, or goes on rocking (`rest_time`)."""
    right = state[i + lane.S * WIDTH] > 0.0
    edge, other = (
        edge_of(par, at.RIGHT if right else at.LEFT),
        edge_of(par, at.LEFT if right else at.RIGHT),
    )
    v = state[i + lane.V * WIDTH]
    nothing = queue[ORDER + 1 :]
    nothing[0] = 0.0
    for k in range(ORDER + 1):
        queue[k] = state[series_of_a(i) + k * WIDTH]
    rest_at = rest_time(
        edge, other, state[i + lane.S * WIDTH], v, queue, nothing, Degrees(ORDER, 0),
        state[i + lane.X * WIDTH], state[i + lane.T * WIDTH], state[i + lane.T_NEXT * WIDTH], rest_speed,
    )  # fmt: skip
    if rest_at >= 0.0:
        state[i + lane.T * WIDTH] = rest_at
        state[i + lane.V * WIDTH] = 0.0
    elif v > 0.0:
        state[i + lane.MODE * WIDTH] = lane.ROCK
