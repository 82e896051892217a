"""Bodies that roll from vertex to vertex in the lanes of pulses: the next facet, energy and barriers (docs/rolling.md).

The two edges of a lane are the ends of the facet the body turns about.  On them it is a body with two different edges,
and so are its flow, its landings on that facet and its peaks; what is here is the guard of the next facet, the reset
onto it, and what becomes of the body.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, FAST, LEFT_TO_MARCH, MEANINGFUL, NO_ROOT, NOT_YET, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.early_outcome import now
from rockcli.kernels.lanes.pulses.events import padded
from rockcli.kernels.lanes.pulses.ground import to_come
from rockcli.kernels.lanes.pulses.path import put_levers
from rockcli.kernels.lanes.pulses.state import ORDER, STRIDE, put, put_edge, put_top, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import gather, load, note, select, some, sqrt, store
from rockcli.kernels.lanes.vector.roots import first_root
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential
from rockcli.kernels.rigid.march import OUTCOME
from rockcli.kernels.rigid.settings import Degrees
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.bounces import impacts_until, swings_low, swings_softly
from rockcli.kernels.rolling.free_rolling import SAME_TOP, free_rolling
from rockcli.kernels.rolling.law import end_of, push_of
from rockcli.kernels.rolling.rest import rest_time

SLOWEST = 8.0
"""Impacts up to this many times the rest speed are looked at, as the ground's acceleration presses a body down too."""


@jit
def enter_rolling(state, i, body, g, path):
    """A body that stands, or has just been lifted, has been put into lane i as one on two edges."""
    put(state, i, lane.PEAK_LEFT, 0.0)
    put(state, i, lane.PEAK_RIGHT, 0.0)
    put(state, i, lane.PEAK_LEFT_T, math.nan)
    put(state, i, lane.PEAK_RIGHT_T, math.nan)
    put(state, i, lane.RESTS_ON, body[at.VALLEY])
    rises = body[at.TOP] - body[at.LOWEST]
    put(state, i, lane.BRIM, math.sqrt(2.0 * g * rises) if body[at.VALLEY] >= 0.0 and rises > 0.0 else 0.0)
    put(state, i, lane.SWAY, body[at.SWAY])
    put(state, i, lane.KEEP_LEFT, body[at.KEEP_LEFT])
    put(state, i, lane.KEEP_RIGHT, body[at.KEEP_RIGHT])
    put_facet(state, i, body, g, int(body[at.STANDING]), state[i + lane.S * WIDTH], path)


@jit
def put_facet(state, i, body, g, facet, s, path):
    """Lane i turns about the end s of a facet; with what forces need where its `path` is followed."""
    tilt = body[at.FIRST + facet * at.FACET + at.TILT]
    put(state, i, lane.FACET, 1.0 * facet)
    put(state, i, lane.OUTSIDE_LEFT, 1.0 * facet)
    put(state, i, lane.OUTSIDE_RIGHT, body[at.COUNT] - 1.0 - facet)
    put(state, i, lane.TILT, tilt)
    put(state, i, lane.FLOOR, g * (body[at.FIRST + facet * at.FACET + at.HEIGHT] - body[at.LOWEST]))
    put_end(state, i, body, end_of(body, g, facet, s), s, path)
    put_end(state, i + lane.TO_OTHER, body, end_of(body, g, facet, -s), -s, path)
    for o, side in ((i, s), (i + lane.TO_OTHER, -s)):
        peak = state[i + (lane.PEAK_RIGHT if side > 0.0 else lane.PEAK_LEFT) * WIDTH]
        put(state, o, lane.TOP, peak - abs(tilt) if side * tilt >= 0.0 else math.inf)


@jit
def put_end(state, i, body, end, s, path):
    """What goes with an end on the side s: its equilibrium is the last barrier on that side, or is of no account."""
    fall = body[at.FALL_RIGHT if s > 0.0 else at.FALL_LEFT]
    star, top = math.inf, math.inf
    if end.tilt >= body[at.FALL_RIGHT] or end.tilt <= body[at.FALL_LEFT]:
        star = -1.0
    elif 0.0 < end.alpha < end.extent and s * (end.tilt - fall) + end.alpha >= -SAME_TOP:
        star = end.alpha
        half = math.sin(0.5 * star)
        top = 2.0 * end.p2 * half * half
    put_edge(state, i, end, s, star)
    put(state, i, lane.L_ALPHA, body[at.SCALE])  # by which errors and rates are told
    put_top(state, i, top)
    put(state, i, lane.L_EXTENT, end.extent)
    put(state, i, lane.L_MASS, end.radius * end.g / end.p2)  # I/m
    if path:
        put_levers(state, i, end, end.fs, end.fc)


@jit
def find_touches(state, poly, lanes):
    """The next facet: first roots of extent - q of the lanes that may reach it; how many they are."""
    count = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        event = load(state, o + lane.EVENT * WIDTH)
        may = (load(state, o + lane.MODE * WIDTH) == lane.ROCK) & (event >= lane.NONE) & (event <= lane.IMPACT)
        may = may & (load(state, o + lane.REACH * WIDTH) >= load(state, o + lane.L_EXTENT * WIDTH))
        count = note(may, 1.0 * o, lanes, count)
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        chosen = padded(lanes, begin, slots, poly)
        x = gather(state, chosen, lane.X * WIDTH)
        for k in range(ORDER + 1):
            store(poly, k * WIDTH, 0.0 - gather(state, chosen, series_of_q(k * WIDTH)))
        store(poly, 0, gather(state, chosen, lane.L_EXTENT * WIDTH) + load(poly, 0))
        x, slope = first_root(poly, ORDER, x)
        store(poly, 0, x)
        store(poly, WIDTH, slope)
        for j in range(slots):
            i, root = int(lanes[begin + j]), poly[j]
            if root >= 0.0:
                put(state, i, lane.EVENT, lane.TOUCH)
                put(state, i, lane.X, root)
                put(state, i, lane.NEW_Q, 0.0)
                put(state, i, lane.NEW_V, -poly[WIDTH + j])
            elif root != NO_ROOT:
                put(state, i, lane.EVENT, lane.FOR_MARCH)
    return count


@jit
def note_tops(state, i):
    """The peaks of the facet that lane i turns about become those of the body."""
    tilt = abs(state[i + lane.TILT * WIDTH])
    for o in (i, i + lane.TO_OTHER):
        t = state[o + lane.TOP_T * WIDTH]
        if t >= 0.0:
            right = state[o + lane.L_SIDE * WIDTH] > 0.0
            put(state, i, lane.PEAK_RIGHT if right else lane.PEAK_LEFT, tilt + state[o + lane.TOP * WIDTH])
            put(state, i, lane.PEAK_RIGHT_T if right else lane.PEAK_LEFT_T, t)


@jit
def roll_over(state, i, body, g, path):
    """Lane i touches the next facet, or the ground where there is none: it has an impact there, at that facet's end.

    `advance` takes it for one that lands and turns over, from the near end to the far one.  Where its `path` is
    followed it goes as far as the ground.
    """
    s, facet = state[i + lane.S * WIDTH], int(state[i + lane.FACET * WIDTH])
    if state[i + (lane.OUTSIDE_RIGHT if s > 0.0 else lane.OUTSIDE_LEFT) * WIDTH] == 0.0:
        if path:
            put(state, i, lane.NEW_Q, state[i + lane.L_EXTENT * WIDTH])
            return
        put(state, i, lane.VERDICT, 1.0 * FALLS)
        put(state, i, lane.EVENT, lane.DONE)
        return
    note_tops(state, i)
    if path:
        note_pushes(state, i, body)
    facet += 1 if s > 0.0 else -1
    mass, rate = state[i + lane.L_MASS * WIDTH], state[i + lane.NEW_V * WIDTH]
    tilt, t = body[at.FIRST + facet * at.FACET + at.TILT], state[i + lane.T * WIDTH] + state[i + lane.X * WIDTH]
    right = tilt > 0.0
    peak = lane.PEAK_RIGHT if right else lane.PEAK_LEFT
    if tilt != 0.0 and abs(tilt) > state[i + peak * WIDTH]:
        put(state, i, peak, abs(tilt))
        put(state, i, lane.PEAK_RIGHT_T if right else lane.PEAK_LEFT_T, t)
    put_facet(state, i, body, g, facet, s, path)
    put(state, i, lane.S, -s)
    put(state, i, lane.NEW_V, -rate)
    put(state, i, lane.EVENT, lane.IMPACT)
    if path:
        carry_over(state, i, s, mass, rate, t)


@jit
def carry_over(state, i, s, mass, rate, t):
    """What the impact of lane i on the facet it has been put on carries and loses; mass: I/m before it."""
    eta, onto = state[i + lane.L_ETA * WIDTH], state[i + lane.L_MASS * WIDTH]
    put(state, i, lane.LOST, state[i + lane.LOST * WIDTH] + rate * rate * (mass - onto * eta * eta))
    if state[i + lane.T * WIDTH] >= state[i + lane.L_STOP * WIDTH]:
        return
    pace = rate / (state[i + lane.L_P * WIDTH] * state[i + lane.L_ALPHA * WIDTH])
    carried = pace * pace - MEANINGFUL * MEANINGFUL
    if carried > 0.0:
        put(state, i, lane.SWUNG, state[i + lane.SWUNG * WIDTH] + carried)
        put(state, i, lane.SWUNG_T, state[i + lane.SWUNG_T * WIDTH] + carried * t)
    if pace > FAST:
        put(state, i, lane.ONTO_RIGHT if s > 0.0 else lane.ONTO_LEFT, 1.0)


@jit
def note_pushes(state, i, body):
    """Raise the ratio of the impulses to those of the landings of lane i on the facet it is about to leave."""
    first = at.FIRST + int(state[i + lane.FACET * WIDTH]) * at.FACET
    height = body[first + at.HEIGHT]
    for onto, end, far in ((lane.ONTO_LEFT, at.LEFT, at.RIGHT), (lane.ONTO_RIGHT, at.RIGHT, at.LEFT)):
        if state[i + onto * WIDTH] > 0.0:
            push = push_of(height, body[first + end + at.ETA], body[first + end + at.B], body[first + far + at.B])
            put(state, i, lane.PUSHED, max(state[i + lane.PUSHED * WIDTH], push))
        put(state, i, onto, 0.0)


@jit
def rest_on_facet(state, i, body, g, rest_speed, queue):
    """A slow impact of lane i, put into REST on trial: whether it stays there, or goes on rocking."""
    s, facet = state[i + lane.S * WIDTH], int(state[i + lane.FACET * WIDTH])
    end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
    v = state[i + lane.V * WIDTH]
    nothing = queue[ORDER + 1 :]
    nothing[0] = 0.0
    for k in range(ORDER + 1):
        queue[k] = state[series_of_a(i) + k * WIDTH]
    rest_at = rest_time(
        end, other, s, v, body[at.SCALE], queue, nothing, Degrees(ORDER, 0), state[i + lane.X * WIDTH],
        state[i + lane.T * WIDTH], state[i + lane.T_NEXT * WIDTH], rest_speed,
    )  # fmt: skip
    if rest_at >= 0.0 and end.threshold > 0.0 and other.threshold > 0.0:
        put(state, i, lane.LOST, state[i + lane.LOST * WIDTH] + state[i + lane.L_MASS * WIDTH] * v * v)
        put(state, i, lane.T, rest_at)
        put(state, i, lane.V, 0.0)
    elif rest_at < 0.0 and v > 0.0:
        put(state, i, lane.MODE, lane.ROCK)
    else:  # held by the ground's acceleration alone
        put(state, i, lane.EVENT, lane.FOR_MARCH)


@jit
def left_alone(state, o):
    """Lanes that move after the motion's end, and of which nobody knows what becomes."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (event >= lane.NONE) & (event < lane.DONE) & (mode == lane.ROCK)
    over = load(state, o + lane.T * WIDTH) >= load(state, o + lane.L_END * WIDTH)
    return going & over & (load(state, o + lane.VERDICT * WIDTH) == 1.0 * NOT_YET)


@jit
def roll_freely(state, i, body, g, margin, detail):
    """What becomes of such a lane."""
    verdict, rests_on, hits = free_rolling(
        body, g, int(state[i + lane.FACET * WIDTH]), state[i + lane.S * WIDTH], state[i + lane.Q * WIDTH],
        state[i + lane.V * WIDTH], margin * body[at.SCALE],
    )  # fmt: skip
    put(state, i, lane.VERDICT, 1.0 * verdict)
    put(state, i, lane.RESTS_ON, 1.0 * rests_on)
    if verdict == UNDECIDED:
        put(state, i, lane.EVENT, lane.FOR_MARCH)
    elif detail == OUTCOME:
        put(state, i, lane.EVENT, lane.DONE)
        if verdict == FALLS:
            put(state, i, lane.N_IMPACTS, state[i + lane.N_IMPACTS * WIDTH] + hits)


@jit
def may_only_bounce(state, o):
    """Lanes that have just landed after the motion and return: their later swings may need no steps."""
    lands = (load(state, o + lane.EVENT * WIDTH) == lane.IMPACT) & (load(state, o + lane.MODE * WIDTH) == lane.ROCK)
    lands = lands & (load(state, o + lane.VERDICT * WIDTH) == 1.0 * RETURNS)
    return lands & (load(state, o + lane.T * WIDTH) >= load(state, o + lane.L_END * WIDTH))


@jit
def bounce(state, i, body, g, rest_speed, path, watch):
    """Such a lane is done where no later swing is higher than the peaks: its impacts are counted.

    With `watch` also only where the forces on these swings are of no account.
    """
    note_tops(state, i)
    facet, s, v = int(state[i + lane.FACET * WIDTH]), state[i + lane.S * WIDTH], state[i + lane.V * WIDTH]
    if body[at.VALLEY] < 0.0 or body[at.LOSSLESS] == 1.0:
        return
    left, right = state[i + lane.PEAK_LEFT * WIDTH], state[i + lane.PEAK_RIGHT * WIDTH]
    if not swings_low(body, g, facet, s, v, left, right, path):
        return
    rate, least, most = (
        state[i + lane.RATE_MAX * WIDTH],
        state[i + lane.N_LEAST * WIDTH],
        state[i + lane.MU_MOST * WIDTH],
    )
    if watch and not swings_softly(body, g, facet, s, v, rate, least, most):
        return
    t, stop = state[i + lane.T * WIDTH], state[i + lane.L_STOP * WIDTH]
    more, until, swung, swung_t, push = impacts_until(body, g, facet, s, v, t, stop, rest_speed, path)
    put(state, i, lane.N_IMPACTS, state[i + lane.N_IMPACTS * WIDTH] + more)
    put(state, i, lane.EVENT, lane.DONE)
    if path:
        put(state, i, lane.T, until)
        put(state, i, lane.SWUNG, state[i + lane.SWUNG * WIDTH] + swung)
        put(state, i, lane.SWUNG_T, state[i + lane.SWUNG_T * WIDTH] + swung_t)
        put(state, i, lane.PUSHED, max(state[i + lane.PUSHED * WIDTH], push))


@jit
def judge_rolling(state, o, how, path):
    """One vector: what becomes of it, and which lanes are done; with its `path` followed, none before the motion's end.

    One that rocks where nothing carries it, beyond the last barrier, and away from there is left to `march`.
    """
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (mode >= lane.REST) & (event < lane.DONE)
    if not some(going):
        return
    t, q, v = load(state, o + lane.T * WIDTH), load(state, o + lane.Q * WIDTH), load(state, o + lane.V * WIDTH)
    s, star, tilt = (
        load(state, o + lane.S * WIDTH),
        load(state, o + lane.L_STAR * WIDTH),
        load(state, o + lane.TILT * WIDTH),
    )
    sine, bend = now(state, o, q, how.linear)
    plus, minus = to_come(state, o, t)
    over, inside = t >= load(state, o + lane.L_END * WIDTH), q < star
    verdict = load(state, o + lane.VERDICT * WIDTH)
    if path:
        falls = going & (event == lane.TOUCH)
        astray = going & (mode == lane.ROCK) & (star < 0.0) & (s * tilt < 0.0)
    else:
        returns, falls = foreseen(state, o, how.margin, q, v, sine, bend, plus, minus)
        asked = going & (mode == lane.ROCK) & (verdict == 1.0 * NOT_YET)
        falls = asked & falls & ~over
        verdict = select(asked & returns, 1.0 * RETURNS, verdict)
    verdict = select(falls, 1.0 * FALLS, verdict)
    still = going & (mode == lane.REST) & over
    verdict = select(still, select(star < 0.0, 1.0 * FALLS, 1.0 * RETURNS), verdict)  # on a facet beyond
    known = verdict >= 0.0
    if how.detail > OUTCOME:
        theta = tilt + s * q
        ends = select(verdict == 1.0 * FALLS, 0.0, s * v * theta) <= 0.0
        ends = ends & ((verdict == 1.0 * RETURNS) | (~inside & (s * v * theta > 0.0)))
        known = still | falls | (known & ends & (t >= load(state, o + lane.L_STOP * WIDTH)))
    if not path:  # the facets that are still to touch as it falls
        out_right, out_left = load(state, o + lane.OUTSIDE_RIGHT * WIDTH), load(state, o + lane.OUTSIDE_LEFT * WIDTH)
        n_impacts = load(state, o + lane.N_IMPACTS * WIDTH)
        ahead = select(s > 0.0, out_right, out_left)
        store(state, o + lane.N_IMPACTS * WIDTH, select(falls, n_impacts + ahead, n_impacts))
    next_event = select(known, lane.DONE, lane.NONE)
    too_long = load(state, o + lane.N_STEPS * WIDTH) >= how.max_steps
    next_event = select(too_long, lane.FOR_MARCH, next_event)
    if path:
        next_event = select(astray, lane.FOR_MARCH, next_event)
    rests_on = load(state, o + lane.RESTS_ON * WIDTH)
    store(state, o + lane.RESTS_ON * WIDTH, select(still, load(state, o + lane.FACET * WIDTH), rests_on))
    store(state, o + lane.VERDICT * WIDTH, verdict)
    store(state, o + lane.EVENT * WIDTH, select(going, next_event, event))


@jit
def foreseen(state, o, margin, q, v, sine, bend, plus, minus):
    """Which lanes return, and which fall, whatever the rest of the motion does: by their energy and the last barriers'.

    The ground changes sqrt(2 E/m) by at most SWAY, the largest R/sqrt(I/m), times the integral of |a_g| (V6), `plus`
    and `minus` to either side; an impact leaves KEEP of it or more, of those beyond the last barrier.
    """
    rc, rs = load(state, o + lane.L_RC * WIDTH), load(state, o + lane.L_RS * WIDTH)
    own = v * v + 2.0 * potential(0.0 * q, rc, q, rs * bend, sine)
    mass, sway = load(state, o + lane.L_MASS * WIDTH), load(state, o + lane.SWAY * WIDTH)
    energy = mass * own + 2.0 * load(state, o + lane.FLOOR * WIDTH)
    brim, star = load(state, o + lane.BRIM * WIDTH), load(state, o + lane.L_STAR * WIDTH)
    doubt = 1.0 - 100.0 * margin
    inside, right = q < star, load(state, o + lane.S * WIDTH) > 0.0
    speed = sqrt(select(energy > 0.0, energy, 0.0))
    returns = inside & (speed + sway * (plus + minus) < brim * doubt)
    inward = select(right, plus, minus) * sway / sqrt(mass)
    keep = doubt * select(right, load(state, o + lane.KEEP_RIGHT * WIDTH), load(state, o + lane.KEEP_LEFT * WIDTH))
    crest = load(state, o + lane.L_CREST * WIDTH)
    passes = (sqrt(select(own > 0.0, own, 0.0)) - inward - crest) * keep > inward
    return returns, (v > 0.0) & ((inside & passes) | (~inside & (star > 0.0) & (v * keep > inward)))


@jit
def leave_rolling(state, i, body, g, path, out):
    """The peaks of a case that leaves lane i, and where it comes to rest."""
    if path:
        note_pushes(state, i, body)
        out[also.MU_IMPACT] = state[i + lane.PUSHED * WIDTH]
        stood = body[at.FIRST + int(body[at.STANDING]) * at.FACET + at.HEIGHT] - body[at.LOWEST]
        out[to.ENERGY] -= state[i + lane.FLOOR * WIDTH] / g - stood
        if out[to.VERDICT] == FALLS and math.isnan(out[to.T_OVERTURN]):
            out[to.STATUS] = LEFT_TO_MARCH
    note_tops(state, i)
    left, right = state[i + lane.PEAK_LEFT * WIDTH], state[i + lane.PEAK_RIGHT * WIDTH]
    out[to.PEAK_LEFT], out[to.PEAK_RIGHT], out[to.PEAK_ALPHA] = left, right, 1.0
    out[to.PEAK] = max(left, right)
    out[to.T_PEAK] = state[i + (lane.PEAK_RIGHT_T if right >= left else lane.PEAK_LEFT_T) * WIDTH]
    if out[to.VERDICT] == FALLS:
        tilt, s = state[i + lane.TILT * WIDTH], state[i + lane.S * WIDTH]
        theta = tilt + s * state[i + lane.Q * WIDTH]
        out[to.PEAK_SIDE] = 1.0 if theta > 0.0 or (theta == 0.0 and s > 0.0) else -1.0
    elif left != right:
        out[to.PEAK_SIDE] = 1.0 if right > left else -1.0
    out[also.FACET] = -1.0
    if out[to.VERDICT] == RETURNS:
        out[also.FACET] = state[i + lane.RESTS_ON * WIDTH]
