"""Events of the lanes that have one, WIDTH of them at a time whichever lanes they are in (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.constants import NO_ROOT
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.series import look_along
from rockcli.kernels.lanes.pulses.state import ORDER, STRIDE, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import gather, load, note, select, some, spread, store
from rockcli.kernels.lanes.vector.roots import LOST, first_root, turning_point

PARTS = 8
"""Places of a step at which the rate is looked at where more than one turning point is possible."""


@jit
def find_impacts(state, poly, lanes, count):
    """First roots of q of the lanes that asked, WIDTH of them at a time."""
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        for j in range(slots):
            i = int(lanes[begin + j])
            skip = 0  # a root at once is divided out
            if state[i + lane.Q * WIDTH] == 0.0:
                skip = 1
                while skip < 4 and state[series_of_q(i) + skip * WIDTH] == 0.0:
                    skip += 1
            poly[j], poly[WIDTH + j] = 1.0 * i, 1.0 * skip
        for j in range(slots, WIDTH):
            poly[j], poly[WIDTH + j] = poly[0], poly[WIDTH]
        chosen, skips = load(poly, 0), load(poly, WIDTH)
        where = chosen + skips * (1.0 * WIDTH)
        for k in range(ORDER + 1):
            store(poly, k * WIDTH, gather(state, where, series_of_q(k * WIDTH)))
        sinks = (load(poly, 0) <= 0.0) & (skips > 0.0)  # would enter the ground at once
        x, slope = first_root(poly, ORDER, gather(state, chosen, lane.H * WIDTH))
        for power in range(4):
            slope = select(skips > power, slope * x, slope)
        x = select(sinks, LOST, x)
        store(poly, 0, x)
        store(poly, WIDTH, slope)
        for j in range(slots):
            i, root = int(lanes[begin + j]), poly[j]
            if root >= 0.0:
                state[i + lane.X * WIDTH], state[i + lane.NEW_Q * WIDTH], state[i + lane.NEW_V * WIDTH] = (
                    root,
                    0.0,
                    poly[WIDTH + j],
                )
            else:
                state[i + lane.EVENT * WIDTH] = lane.NONE if root == NO_ROOT else lane.FOR_MARCH


@jit
def padded(lanes, begin, slots, space):
    """The next lanes of a list as a vector, the last repeated to fill it."""
    for j in range(WIDTH):
        space[j] = lanes[begin + min(j, slots - 1)]
    return load(space, 0)


@jit
def find_uplifts(state, two_sided, poly, lanes, count):
    """First time the ground lifts the resting lanes that asked, on either side."""
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        chosen = padded(lanes, begin, slots, poly)
        h, one = gather(state, chosen, lane.H * WIDTH), gather(state, chosen, lane.L_GUARD * WIDTH)
        onto = gather(state, chosen, lane.L_SIDE * WIDTH)
        other = one
        if two_sided:
            other = gather(state, chosen, lane.TO_OTHER + lane.L_GUARD * WIDTH)
        side, first = spread(0.0), spread(NO_ROOT)
        for sign in (-1.0, 1.0):
            for k in range(ORDER + 1):
                store(poly, k * WIDTH, sign * gather(state, chosen, series_of_a(k * WIDTH)))
            store(poly, 0, load(poly, 0) + select(onto * sign > 0.0, one, other))
            x, _ = first_root(poly, ORDER, h)
            sooner = (x >= 0.0) & ((x < first) | (first == NO_ROOT)) & ~(first == LOST)
            first = select(sooner | (x == LOST), x, first)
            side = select(sooner, sign, side)
        store(poly, 0, first)
        store(poly, WIDTH, side)
        for j in range(slots):
            i, root = int(lanes[begin + j]), poly[j]
            if root >= 0.0:
                state[i + lane.X * WIDTH], state[i + lane.S * WIDTH] = root, poly[WIDTH + j]
            else:
                state[i + lane.EVENT * WIDTH] = lane.NONE if root == NO_ROOT else lane.FOR_MARCH


@jit
def find_tops(state, tol, poly, lanes):
    """Turning points of the lanes that may have passed a higher one than before.

    If P'' keeps its sign there is at most one; else the highest of those that show at PARTS places is taken.
    Equal peaks of an undamped body differ by the errors of the steps: a later one must be higher by more than that.
    """
    count = 0
    for o in range(0, lane.VECTORS * STRIDE, STRIDE):
        x, v, v_new = (
            load(state, o + lane.X * WIDTH),
            load(state, o + lane.V * WIDTH),
            load(state, o + lane.NEW_V * WIDTH),
        )
        event = load(state, o + lane.EVENT * WIDTH)
        may = (load(state, o + lane.MODE * WIDTH) == lane.ROCK) & (event >= lane.NONE) & (event < lane.DONE)
        may = may & (load(state, o + lane.REACH * WIDTH) > load(state, o + lane.TOP * WIDTH))
        if some(may):
            c = series_of_q(o)
            second = load(state, c + 2 * WIDTH)
            rises = (v > 0.0) | ((v == 0.0) & (second > 0.0))
            _, _, bends, _ = look_along(state, c, x)
            bump = abs(bends) > 4.0 * abs(second)
            turns = rises & ~bump & (v_new <= 0.0)
            begin, breadth, best = spread(0.0), spread(1.0), spread(-1.0)
            if some(may & bump):
                for j in range(1, PARTS + 1):
                    P, dP, _, _ = look_along(state, c, (j / PARTS) * x)
                    here = bump & rises & (dP <= 0.0) & (best < P)
                    begin, breadth = select(here, (j - 1) / PARTS, begin), select(here, 1.0 / PARTS, breadth)
                    best = select(here, P, best)
                    rises = dP > 0.0
            store(state, o + lane.BRACKET * WIDTH, begin)
            store(state, o + lane.BREADTH * WIDTH, breadth)
            count = note(may & (turns | (best > -1.0)), 1.0 * o, lanes, count)
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        chosen = padded(lanes, begin, slots, poly)
        x = gather(state, chosen, lane.X * WIDTH)
        share = gather(state, chosen, lane.BRACKET * WIDTH)
        breadth = gather(state, chosen, lane.BREADTH * WIDTH)
        for k in range(ORDER + 1):
            store(poly, k * WIDTH, gather(state, chosen, series_of_q(k * WIDTH)))
        x, P = turning_point(poly, ORDER, share * x, (share + breadth) * x)
        store(poly, 0, x)
        store(poly, WIDTH, P)
        for j in range(slots):
            i = int(lanes[begin + j])
            if poly[WIDTH + j] > state[i + lane.TOP * WIDTH] * (1.0 + 1e-12 + 100.0 * tol):
                state[i + lane.TOP * WIDTH] = poly[WIDTH + j]
                state[i + lane.TOP_T * WIDTH] = state[i + lane.T * WIDTH] + poly[j]
                state[i + lane.TOP_SIDE * WIDTH] = state[i + lane.S * WIDTH]
