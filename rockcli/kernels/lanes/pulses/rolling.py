"""Bodies that roll from vertex to vertex in the lanes of pulses: the next facet, energy and barriers (docs/rolling.md).

The two edges of a lane are the ends of the facet the body turns about.  On them it is a body with two different edges,
and so are its flow, its landings on that facet and its peaks; what is here is the guard of the next facet, the reset
onto it, and what becomes of the body.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, NO_ROOT, NOT_YET, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.early_outcome import now
from rockcli.kernels.lanes.pulses.events import padded
from rockcli.kernels.lanes.pulses.ground import to_come
from rockcli.kernels.lanes.pulses.state import put, put_edge, series_of_a, series_of_q, stride
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import gather, load, note, select, some, sqrt, store
from rockcli.kernels.lanes.vector.roots import first_root
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential
from rockcli.kernels.rigid.march import OUTCOME
from rockcli.kernels.rigid.settings import Degrees
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.bounces import impacts_until, swings_low
from rockcli.kernels.rolling.free_rolling import SAME_TOP, free_rolling
from rockcli.kernels.rolling.law import end_of
from rockcli.kernels.rolling.rest import rest_time

SLOWEST = 8.0
"""Impacts up to this many times the rest speed are looked at, as the ground's acceleration presses a body down too."""


@jit_lean
def enter_rolling(state, i, body, g):
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
    put_facet(state, i, body, g, int(body[at.STANDING]), state[i + lane.S * WIDTH])


@jit_lean
def put_facet(state, i, body, g, facet, s):
    """Lane i turns about the end s of a facet."""
    tilt = body[at.FIRST + facet * at.FACET + at.TILT]
    put(state, i, lane.FACET, 1.0 * facet)
    put(state, i, lane.OUTSIDE_LEFT, 1.0 * facet)
    put(state, i, lane.OUTSIDE_RIGHT, body[at.COUNT] - 1.0 - facet)
    put(state, i, lane.TILT, tilt)
    put(state, i, lane.FLOOR, g * (body[at.FIRST + facet * at.FACET + at.HEIGHT] - body[at.LOWEST]))
    put_end(state, i, body, end_of(body, g, facet, s), s)
    put_end(state, i + lane.TO_OTHER, body, end_of(body, g, facet, -s), -s)
    for o, side in ((i, s), (i + lane.TO_OTHER, -s)):
        peak = state[i + (lane.PEAK_RIGHT if side > 0.0 else lane.PEAK_LEFT) * WIDTH]
        put(state, o, lane.TOP, peak - abs(tilt) if side * tilt >= 0.0 else math.inf)


@jit_lean
def put_end(state, i, body, end, s):
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
    put(state, i, lane.L_TOP, top)
    put(state, i, lane.L_EXTENT, end.extent)
    put(state, i, lane.L_MASS, end.radius * end.g / end.p2)  # I/m


@jit_lean
def find_touches(state, n, poly, lanes):
    """The next facet: first roots of extent - q of the lanes that may reach it; how many they are."""
    count = 0
    size = stride(n)
    for o in range(0, lane.VECTORS * size, size):
        event = load(state, o + lane.EVENT * WIDTH)
        may = (load(state, o + lane.MODE * WIDTH) == lane.ROCK) & (event >= lane.NONE) & (event <= lane.IMPACT)
        may = may & (load(state, o + lane.REACH * WIDTH) >= load(state, o + lane.L_EXTENT * WIDTH))
        count = note(may, 1.0 * o, lanes, count)
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        chosen = padded(lanes, begin, slots, poly)
        x = gather(state, chosen + 1.0 * (lane.X * WIDTH))
        for k in range(n + 1):
            store(poly, k * WIDTH, 0.0 - gather(state, chosen + 1.0 * series_of_q(k * WIDTH)))
        store(poly, 0, gather(state, chosen + 1.0 * (lane.L_EXTENT * WIDTH)) + load(poly, 0))
        x, slope = first_root(poly, n, x)
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


@jit_lean
def note_tops(state, i):
    """The peaks of the facet that lane i turns about become those of the body."""
    tilt = abs(state[i + lane.TILT * WIDTH])
    for o in (i, i + lane.TO_OTHER):
        t = state[o + lane.TOP_T * WIDTH]
        if t >= 0.0:
            right = state[o + lane.L_SIDE * WIDTH] > 0.0
            put(state, i, lane.PEAK_RIGHT if right else lane.PEAK_LEFT, tilt + state[o + lane.TOP * WIDTH])
            put(state, i, lane.PEAK_RIGHT_T if right else lane.PEAK_LEFT_T, t)


@jit_lean
def roll_over(state, i, body, g):
    """Lane i touches the next facet, or the ground where there is none: it has an impact there, at that facet's end.

    `advance` takes it for one that lands and turns over, from the near end to the far one.
    """
    s, facet = state[i + lane.S * WIDTH], int(state[i + lane.FACET * WIDTH])
    if state[i + (lane.OUTSIDE_RIGHT if s > 0.0 else lane.OUTSIDE_LEFT) * WIDTH] == 0.0:
        put(state, i, lane.VERDICT, 1.0 * FALLS)
        put(state, i, lane.EVENT, lane.DONE)
        return
    note_tops(state, i)
    facet += 1 if s > 0.0 else -1
    tilt, t = body[at.FIRST + facet * at.FACET + at.TILT], state[i + lane.T * WIDTH] + state[i + lane.X * WIDTH]
    right = tilt > 0.0
    peak = lane.PEAK_RIGHT if right else lane.PEAK_LEFT
    if tilt != 0.0 and abs(tilt) > state[i + peak * WIDTH]:
        put(state, i, peak, abs(tilt))
        put(state, i, lane.PEAK_RIGHT_T if right else lane.PEAK_LEFT_T, t)
    put_facet(state, i, body, g, facet, s)
    put(state, i, lane.S, -s)
    put(state, i, lane.NEW_V, -state[i + lane.NEW_V * WIDTH])
    put(state, i, lane.EVENT, lane.IMPACT)


@jit_lean
def rest_on_facet(state, i, n, body, g, rest_speed, queue):
    """A slow impact of lane i, put into REST on trial: whether it stays there, or goes on rocking."""
    s, facet = state[i + lane.S * WIDTH], int(state[i + lane.FACET * WIDTH])
    end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
    v = state[i + lane.V * WIDTH]
    nothing = queue[n + 1 :]
    nothing[0] = 0.0
    for k in range(n + 1):
        queue[k] = state[series_of_a(i, n) + k * WIDTH]
    rest_at = rest_time(
        end, other, s, v, queue, nothing, Degrees(n, 0), state[i + lane.X * WIDTH], state[i + lane.T * WIDTH],
        state[i + lane.T_NEXT * WIDTH], rest_speed,
    )  # fmt: skip
    if rest_at >= 0.0 and end.threshold > 0.0 and other.threshold > 0.0:
        put(state, i, lane.T, rest_at)
        put(state, i, lane.V, 0.0)
    elif rest_at < 0.0 and v > 0.0:
        put(state, i, lane.MODE, lane.ROCK)
    else:  # held by the ground's acceleration alone
        put(state, i, lane.EVENT, lane.FOR_MARCH)


@jit_lean
def left_alone(state, o):
    """Lanes that move after the motion's end, and of which nobody knows what becomes."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (event >= lane.NONE) & (event < lane.DONE) & (mode == lane.ROCK)
    over = load(state, o + lane.T * WIDTH) >= load(state, o + lane.L_END * WIDTH)
    return going & over & (load(state, o + lane.VERDICT * WIDTH) == 1.0 * NOT_YET)


@jit_lean
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


@jit_lean
def may_only_bounce(state, o):
    """Lanes that have just landed after the motion and return: their later swings may need no steps."""
    lands = (load(state, o + lane.EVENT * WIDTH) == lane.IMPACT) & (load(state, o + lane.MODE * WIDTH) == lane.ROCK)
    lands = lands & (load(state, o + lane.VERDICT * WIDTH) == 1.0 * RETURNS)
    return lands & (load(state, o + lane.T * WIDTH) >= load(state, o + lane.L_END * WIDTH))


@jit_lean
def bounce(state, i, body, g, rest_speed):
    """Such a lane is done where no later swing is higher than the peaks: its impacts are counted."""
    note_tops(state, i)
    facet, s, v = int(state[i + lane.FACET * WIDTH]), state[i + lane.S * WIDTH], state[i + lane.V * WIDTH]
    if body[at.VALLEY] < 0.0 or body[at.LOSSLESS] == 1.0:
        return
    left, right = state[i + lane.PEAK_LEFT * WIDTH], state[i + lane.PEAK_RIGHT * WIDTH]
    if swings_low(body, g, facet, s, v, left, right):
        t, stop = state[i + lane.T * WIDTH], state[i + lane.L_STOP * WIDTH]
        more = impacts_until(body, g, facet, s, v, t, stop, rest_speed)
        put(state, i, lane.N_IMPACTS, state[i + lane.N_IMPACTS * WIDTH] + more)
        put(state, i, lane.EVENT, lane.DONE)


@jit_lean
def judge_rolling(state, o, how):
    """One vector: its energy against that of the last barriers, with what the rest of the motion can still change.

    The ground changes sqrt(2 E/m) by at most SWAY, the largest R/sqrt(I/m), times the integral of |a_g| (V6); an impact
    leaves KEEP of it or more, of those beyond the last barrier.
    """
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (mode >= lane.REST) & (event < lane.DONE)
    if not some(going):
        return
    t, q, v = load(state, o + lane.T * WIDTH), load(state, o + lane.Q * WIDTH), load(state, o + lane.V * WIDTH)
    s = load(state, o + lane.S * WIDTH)
    sine, bend = now(state, o, q, how.linear)
    plus, minus = to_come(state, o, t)
    rc, rs = load(state, o + lane.L_RC * WIDTH), load(state, o + lane.L_RS * WIDTH)
    own = v * v + 2.0 * potential(0.0 * q, rc, q, rs * bend, sine)
    mass, sway = load(state, o + lane.L_MASS * WIDTH), load(state, o + lane.SWAY * WIDTH)
    energy = mass * own + 2.0 * load(state, o + lane.FLOOR * WIDTH)
    brim, star = load(state, o + lane.BRIM * WIDTH), load(state, o + lane.L_STAR * WIDTH)
    doubt = 1.0 - 100.0 * how.margin
    inside, right = q < star, s > 0.0
    speed = sqrt(select(energy > 0.0, energy, 0.0))
    returns = inside & (speed + sway * (plus + minus) < brim * doubt)
    over = t >= load(state, o + lane.L_END * WIDTH)
    inward = select(right, plus, minus) * sway / sqrt(mass)
    keep = doubt * select(right, load(state, o + lane.KEEP_RIGHT * WIDTH), load(state, o + lane.KEEP_LEFT * WIDTH))
    crest = sqrt(2.0 * load(state, o + lane.L_TOP * WIDTH))
    passes = (sqrt(select(own > 0.0, own, 0.0)) - inward - crest) * keep > inward
    falls = (v > 0.0) & ~over & ((inside & passes) | (~inside & (star > 0.0) & (v * keep > inward)))

    verdict = load(state, o + lane.VERDICT * WIDTH)
    asked = going & (mode == lane.ROCK) & (verdict == 1.0 * NOT_YET)
    falls = asked & falls
    verdict = select(asked & returns, 1.0 * RETURNS, select(falls, 1.0 * FALLS, verdict))
    still = going & (mode == lane.REST) & over
    verdict = select(still, select(star < 0.0, 1.0 * FALLS, 1.0 * RETURNS), verdict)  # on a facet beyond
    known = verdict >= 0.0
    if how.detail > OUTCOME:
        theta = load(state, o + lane.TILT * WIDTH) + s * q
        ends = select(verdict == 1.0 * FALLS, 0.0, s * v * theta) <= 0.0
        ends = ends & ((verdict == 1.0 * RETURNS) | (~inside & (s * v * theta > 0.0)))
        known = still | falls | (known & ends & (t >= load(state, o + lane.L_STOP * WIDTH)))
    # the facets that are still to touch as it falls
    left = select(right, load(state, o + lane.OUTSIDE_RIGHT * WIDTH), load(state, o + lane.OUTSIDE_LEFT * WIDTH))
    n_impacts = load(state, o + lane.N_IMPACTS * WIDTH)
    store(state, o + lane.N_IMPACTS * WIDTH, select(falls, n_impacts + left, n_impacts))
    next_event = select(known, lane.DONE, lane.NONE)
    next_event = select(load(state, o + lane.N_STEPS * WIDTH) >= how.max_steps, lane.FOR_MARCH, next_event)
    rests_on = load(state, o + lane.RESTS_ON * WIDTH)
    store(state, o + lane.RESTS_ON * WIDTH, select(still, load(state, o + lane.FACET * WIDTH), rests_on))
    store(state, o + lane.VERDICT * WIDTH, verdict)
    store(state, o + lane.EVENT * WIDTH, select(going, next_event, event))


@jit_lean
def leave_rolling(state, i, out):
    """The peaks of a case that leaves lane i, and where it comes to rest."""
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
