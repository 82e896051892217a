"""Many pulse cases at once: lanes that run each at its own pace, refilled as their cases end (docs/sweeps.md).

A lane goes through the same modes, guards and resets as `march`; what is rare or doubtful is left to `march`.
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit_lean, zeros_maker
from rockcli.kernels.lane_bounces import BACKLOG, LEFT_TO_MARCH, LOW, settle
from rockcli.kernels.lane_events import find_impacts, find_tops, find_uplifts
from rockcli.kernels.lane_ground import expand
from rockcli.kernels.lane_math import sin_cos
from rockcli.kernels.lane_series import bends_and_reach, flow, reach_of, value_and_slope
from rockcli.kernels.lane_state import (
    CASE,
    DONE,
    EVENT,
    FIELDS,
    FREE,
    HANDED,
    IDLE,
    IMPACT,
    KIND,
    L_ALPHA,
    L_END,
    L_ETA,
    L_GUARD,
    L_P,
    L_PULL,
    L_R0,
    L_RC,
    L_RS,
    L_STAR,
    L_STOP,
    L_TOP,
    LANES,
    LAUNCH,
    MODE,
    N_IMPACTS,
    N_STEPS,
    NEW_Q,
    NEW_V,
    NONE,
    REACH,
    REST,
    ROCK,
    T_NEXT,
    TOP,
    UP_T,
    UPLIFT,
    VERDICT,
    H,
    Q,
    S,
    T,
    V,
    X,
    enter,
    leave,
    next_piece,
)
from rockcli.kernels.lane_vector import WIDTH, load, note, room, select, some, sqrt, store
from rockcli.kernels.layout import FALLS, LEFT, RETURNS, RIGHT, STATUS, G
from rockcli.kernels.march import FAST, OUTCOME
from rockcli.kernels.rest import rest_time

zeros = zeros_maker()

LONGEST = 2.0
"""Longest step, over 1/p."""


@jit_lean
def sweep(pars, linear, tol, rest_speed, margin, max_steps, n, detail, tables, pieces, work, out):
    """Solve every row of `pars` under the pulse of its row of `tables` with series of order n.

    `work`: `work_space(n)`; `out` zeros.  What is not done here has STATUS LEFT_TO_MARCH.
    """
    state, c, a, scratch, poly, lists = split(work, n)
    asking, lifting, ending, moving, slowing, bouncing = (
        lists[:LANES], lists[LANES : 2 * LANES], lists[2 * LANES : 3 * LANES], lists[3 * LANES : 4 * LANES],
        lists[4 * LANES : 5 * LANES], lists[5 * LANES : 6 * LANES],
    )  # fmt: skip
    backlog = lists[6 * LANES :]
    waiting = busy = n_aside = 0
    n_ending = LANES
    for i in range(LANES):
        ending[i] = i
        state[MODE * LANES + i], state[EVENT * LANES + i], state[CASE * LANES + i] = IDLE, IDLE, -1.0
    while True:
        for j in range(n_ending):
            i = int(ending[j])
            case = int(state[CASE * LANES + i])
            if case >= 0:
                if state[EVENT * LANES + i] == HANDED:
                    out[case][STATUS] = LEFT_TO_MARCH
                leave(state, i, state[VERDICT * LANES + i], out[case])
                state[CASE * LANES + i], state[EVENT * LANES + i] = -1.0, IDLE
                busy -= 1
            while waiting < len(pars):
                case = waiting
                waiting += 1
                if enter(state, i, case, pars[case], tables[case], pieces, linear):
                    next_piece(state, i, tables[case], pieces)
                    busy += 1
                    break
                out[case][STATUS] = LEFT_TO_MARCH
        if busy == 0:
            if n_aside > 0:
                settle(backlog, n_aside, linear, out)
            return
        n_asking = n_lifting = n_ending = n_moving = n_slowing = n_bouncing = 0
        for o in range(0, LANES, WIDTH):
            look(state, o, n, linear, tol, margin, max_steps, detail, c, a, scratch)
            event = load(state, EVENT * LANES + o)
            n_asking = note(event == IMPACT, 1.0 * o, asking, n_asking)
            n_lifting = note(event == UPLIFT, 1.0 * o, lifting, n_lifting)
        find_impacts(state, n, c, poly, asking, n_asking)
        find_uplifts(state, n, a, poly, lifting, n_lifting)
        if detail > OUTCOME:
            find_tops(state, n, tol, c, poly, asking, scratch)
        for o in range(0, LANES, WIDTH):
            advance(state, o, rest_speed)
            event, mode = load(state, EVENT * LANES + o), load(state, MODE * LANES + o)
            n_ending = note(event >= DONE, 1.0 * o, ending, n_ending)
            goes = (event >= NONE) & (event < DONE)
            past = goes & (load(state, T * LANES + o) >= load(state, T_NEXT * LANES + o))
            n_moving = note(past, 1.0 * o, moving, n_moving)
            n_slowing = note((event == IMPACT) & (mode == REST), 1.0 * o, slowing, n_slowing)
            if detail > OUTCOME:
                n_bouncing = note(only_bounces(state, o, tol, linear), 1.0 * o, bouncing, n_bouncing)
        for j in range(n_slowing):
            i = int(slowing[j])
            come_to_rest(state, i, n, a, pars[int(state[CASE * LANES + i])], rest_speed, poly)
        for j in range(n_moving):
            i = int(moving[j])
            next_piece(state, i, tables[int(state[CASE * LANES + i])], pieces)
        for j in range(n_bouncing):
            i = int(bouncing[j])
            lay_aside(state, i, backlog, n_aside)
            ending[n_ending] = i
            n_ending += 1
            n_aside += 1
            if n_aside == WIDTH:
                settle(backlog, n_aside, linear, out)
                n_aside = 0


def work_space(n):
    """Work space of `sweep` for series of order n."""
    return room(FIELDS * LANES + (2 * n + 6) * LANES + (5 * n + 7) * WIDTH + 6 * LANES + BACKLOG * WIDTH)


@jit_lean
def split(work, n):
    """Work space: state; coefficients of q and of a_g of all lanes; four series of a vector; the polynomials whose
    roots are sought; lists of lanes.  Four more coefficients of q stay zero."""
    i = FIELDS * LANES
    j = i + (n + 5) * LANES
    k = j + (n + 1) * LANES
    m = k + 4 * (n + 1) * WIDTH
    r = m + (n + 3) * WIDTH
    return work[:i], work[i:j], work[j:k], work[k:m], work[m:r], work[r:]


@jit_lean
def look(state, o, n, linear, tol, margin, max_steps, detail, c, a, scratch):
    """One vector: series, verdict, step, and what has to be looked at more closely."""
    mode = load(state, MODE * LANES + o)
    if not some(mode >= REST):
        return
    left = expand(state, o, n, a)
    size = (n + 1) * WIDTH
    sine, cosine = flow(
        state, o, n, a, some((load(state, KIND * LANES + o) > FREE) & (mode == ROCK)), linear, c,
        scratch[:size], scratch[size : 2 * size], scratch[2 * size : 3 * size], scratch[3 * size :],
    )  # fmt: skip
    t, q, v = load(state, T * LANES + o), load(state, Q * LANES + o), load(state, V * LANES + o)
    star, guard = load(state, L_STAR * LANES + o), load(state, L_GUARD * LANES + o)
    p, end, stop = load(state, L_P * LANES + o), load(state, L_END * LANES + o), load(state, L_STOP * LANES + o)
    alpha = load(state, L_ALPHA * LANES + o)
    rocks = mode == ROCK

    # verdict: energy against that of the equilibrium, with what the rest of the motion can still change
    verdict = load(state, VERDICT * LANES + o)
    top = 2.0 * load(state, L_TOP * LANES + o)
    potential = 2.0 * (
        load(state, L_R0 * LANES + o) * q
        + load(state, L_RS * LANES + o) * cosine
        + load(state, L_RC * LANES + o) * sine
    )
    energy = v * v + potential
    brim, speed = sqrt(top), sqrt(select(energy > 0.0, energy, 0.0))
    pull = load(state, L_PULL * LANES + o) * left
    doubt = 100.0 * margin * brim
    returns = (q < star) & (speed + pull < brim - doubt)
    falls = ((v > 0.0) & (speed - pull > brim + doubt) & (q < star)) | ((q >= star) & (v > pull + doubt))
    over = t >= end  # nothing more to come: the sign of the excess decides
    excess = energy - top
    returns = returns | (over & (q < star) & (excess < 0.0))
    falls = falls | (over & (((q < star) & (excess > 0.0) & (v > 0.0)) | ((q >= star) & (excess < 0.0))))
    near = abs(excess) <= 10.0 * margin * alpha * p * (abs(v) + sqrt(abs(top - potential))) + 1e-13 * p * p
    asked = rocks & (verdict < 0.0)
    verdict = select(asked & returns, 1.0 * RETURNS, verdict)
    verdict = select(asked & falls, 1.0 * FALLS, verdict)
    still = (mode == REST) & over
    verdict = select(still, 1.0 * RETURNS, verdict)
    event = select(asked & over & near, HANDED, NONE)
    n_steps = load(state, N_STEPS * LANES + o)
    event = select(n_steps >= max_steps, HANDED, event)
    known = verdict >= 0.0
    if detail > OUTCOME:
        known = still | (verdict == 1.0 * FALLS) | (known & (t >= stop) & (v <= 0.0))
    event = select(known & (event == NONE), DONE, event)

    # step
    h = load(state, T_NEXT * LANES + o) - t
    most = LONGEST / p
    rock_h = reach_of(c, o, n, tol * alpha, select(h < most, h, most))
    rest_h = reach_of(a, o, n, 1e-16 * guard, h) if some(mode == REST) else h
    h = select(rocks, rock_h, rest_h)
    P, dP = value_and_slope(c, o, n, h)
    M, reach = bends_and_reach(c, o, n, h)
    bent = 0.125 * M * h * h
    bump = abs(M) > 4.0 * abs(load(c, 2 * LANES + o))  # else P'' has the sign of c2
    low = (q + 0.5 * v * h - bent <= 0.0) | (P - 0.5 * dP * h - bent <= 0.0)
    low = (P <= 0.0) | (low & (bump | (load(c, 2 * LANES + o) >= 0.0)))
    event = select(rocks & low & (event == NONE), IMPACT, event)
    if not linear:
        far = rocks & (reach >= 0.5 * math.pi)
        if some(far):
            sure = far & (event == NONE) & (0.5 * math.pi <= P) & (v > 0.0) & (dP > 0.0)
            maybe = far & ~sure & ((event == IMPACT) | (0.5 * math.pi <= P) | ((v > 0.0) & (dP <= 0.0)))
            verdict = select(sure, 1.0 * FALLS, verdict)
            event = select(sure, DONE, select(maybe & (event < DONE), HANDED, event))
    strange = rocks & ~(h > 0.0)
    event = select(strange, HANDED, event)
    if some(mode == REST):
        _, most = bends_and_reach(a, o, n, h)
        event = select((mode == REST) & ~(most < guard) & (event == NONE), UPLIFT, event)
    store(state, VERDICT * LANES + o, verdict)
    store(state, EVENT * LANES + o, select(mode < REST, IDLE, event))
    store(state, H * LANES + o, h)
    store(state, X * LANES + o, h)
    store(state, NEW_Q * LANES + o, select(rocks, P, 0.0))
    store(state, NEW_V * LANES + o, select(rocks, dP, 0.0))
    store(state, REACH * LANES + o, reach)
    store(state, N_STEPS * LANES + o, n_steps + 1.0)


@jit_lean
def advance(state, o, rest_speed):
    """One vector: take the step, turn over at impacts, leave rest at uplifts."""
    event, mode = load(state, EVENT * LANES + o), load(state, MODE * LANES + o)
    if not some(event >= NONE):
        return
    t, h, x = load(state, T * LANES + o), load(state, H * LANES + o), load(state, X * LANES + o)
    t_next, stop = load(state, T_NEXT * LANES + o), load(state, L_STOP * LANES + o)
    q, v, s = load(state, NEW_Q * LANES + o), load(state, NEW_V * LANES + o), load(state, S * LANES + o)
    p_alpha = load(state, L_P * LANES + o) * load(state, L_ALPHA * LANES + o)
    goes = (event >= NONE) & (event < DONE)
    lands = event == IMPACT
    lifts = event == UPLIFT

    rate = select(v < 0.0, -v, 0.0)
    n_impacts = load(state, N_IMPACTS * LANES + o)
    counted = lands & (rate > FAST * p_alpha) & (t < stop)
    after = load(state, L_ETA * LANES + o) * rate
    slow = lands & ((after <= rest_speed * p_alpha) | (after <= 0.0))
    v = select(lands, after, v)
    s = select(lands, -s, s)
    now = select((event == NONE) & (h == t_next - t), t_next, t + x)
    up = load(state, UP_T * LANES + o)

    store(state, N_IMPACTS * LANES + o, select(counted, n_impacts + 1.0, n_impacts))
    store(state, T * LANES + o, select(goes, now, t))
    store(state, Q * LANES + o, select(goes, q, load(state, Q * LANES + o)))
    store(state, V * LANES + o, select(goes, v, load(state, V * LANES + o)))
    store(state, S * LANES + o, s)
    store(state, UP_T * LANES + o, select(lifts & ~(up >= 0.0), now, up))
    store(state, LAUNCH * LANES + o, select(lifts, 1.0, 0.0))
    store(state, MODE * LANES + o, select(lifts, ROCK, select(slow, REST, mode)))


@jit_lean
def only_bounces(state, o, tol, linear):
    """Lanes that have just landed after the motion, and whose later swings are lower than the peak: only counted."""
    v, eta = load(state, V * LANES + o), load(state, L_ETA * LANES + o)
    lands = (load(state, EVENT * LANES + o) == IMPACT) & (load(state, MODE * LANES + o) == ROCK)
    lands = lands & (load(state, T * LANES + o) >= load(state, L_END * LANES + o))
    lands = lands & (v * v < LOW * LOW * 2.0 * load(state, L_TOP * LANES + o))
    if some(lands):
        q, star = load(state, TOP * LANES + o), load(state, L_STAR * LANES + o)
        q = select(q < star, q, star)
        sine, bend = q, 0.5 * q * q
        if not linear:
            sine, cosine = sin_cos(q)
            bend = 1.0 - cosine
        height = load(state, L_R0 * LANES + o) * q + load(state, L_RS * LANES + o) * bend
        height = height + load(state, L_RC * LANES + o) * sine
        lands = lands & (0.5 * v * v <= height * (1.0 + 1e-12 + 100.0 * tol)) & (eta <= 1.0)
    return lands


@jit_lean
def lay_aside(state, i, backlog, slot):
    """Lane i is done but for its bounces, which are counted when a vector of such cases has come together."""
    state[VERDICT * LANES + i], state[EVENT * LANES + i] = 1.0 * RETURNS, DONE
    slowest = FAST * state[L_P * LANES + i] * state[L_ALPHA * LANES + i]
    backlog[slot], backlog[WIDTH + slot] = state[CASE * LANES + i], state[L_STOP * LANES + i]
    backlog[2 * WIDTH + slot], backlog[3 * WIDTH + slot] = state[T * LANES + i], state[V * LANES + i]
    backlog[4 * WIDTH + slot], backlog[5 * WIDTH + slot] = state[L_ETA * LANES + i], slowest
    backlog[6 * WIDTH + slot], backlog[7 * WIDTH + slot] = state[L_R0 * LANES + i], state[L_RS * LANES + i]
    backlog[8 * WIDTH + slot] = state[L_RC * LANES + i]


@jit_lean
def come_to_rest(state, i, n, a, par, rest_speed, queue):
    """A slow impact of lane i, put into REST on trial: whether it stays there, or goes on rocking (`rest_time`)."""
    e, other = (RIGHT, LEFT) if state[S * LANES + i] > 0.0 else (LEFT, RIGHT)
    v = state[V * LANES + i]
    nothing = queue[n + 1 :]
    nothing[0] = 0.0
    for k in range(n + 1):
        queue[k] = a[k * LANES + i]
    rest_at = rest_time(
        par, e, other, state[S * LANES + i], par[G], v, queue, n, nothing, 0,
        state[X * LANES + i], state[T * LANES + i], state[T_NEXT * LANES + i], rest_speed,
    )  # fmt: skip
    if rest_at >= 0.0:
        state[T * LANES + i] = rest_at
        state[V * LANES + i] = 0.0
    elif v > 0.0:
        state[MODE * LANES + i] = ROCK
