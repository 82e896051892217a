"""Events of the lanes that have one, WIDTH of them at a time whichever lanes they are in (docs/sweeps.md)."""

from __future__ import annotations

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lane_roots import LOST, NO_ROOT, first_root, turning_point
from rockcli.kernels.lane_series import slope_of
from rockcli.kernels.lane_state import (
    DONE,
    EVENT,
    HANDED,
    L_GUARD,
    LANES,
    MODE,
    NEW_Q,
    NEW_V,
    NONE,
    REACH,
    ROCK,
    TOP,
    TOP_SIDE,
    TOP_T,
    H,
    Q,
    S,
    T,
    V,
    X,
)
from rockcli.kernels.lane_vector import WIDTH, gather, load, note, select, some, spread, store


@jit_lean
def find_impacts(state, n, c, poly, lanes, count):
    """First roots of q of the lanes that asked, WIDTH of them at a time."""
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        for j in range(slots):
            i = int(lanes[begin + j])
            skip = 0  # a root at once is divided out
            if state[Q * LANES + i] == 0.0:
                skip = 1
                while skip < 4 and c[skip * LANES + i] == 0.0:
                    skip += 1
            poly[j], poly[WIDTH + j] = 1.0 * i, 1.0 * skip
        for j in range(slots, WIDTH):
            poly[j], poly[WIDTH + j] = poly[0], poly[WIDTH]
        lane, skips = load(poly, 0), load(poly, WIDTH)
        for k in range(n + 1):
            store(poly, k * WIDTH, gather(c, (skips + k) * LANES + lane))
        sinks = (load(poly, 0) <= 0.0) & (skips > 0.0)  # would enter the ground at once
        x, slope = first_root(poly, n, gather(state, H * LANES + lane))
        for power in range(4):
            slope = select(skips > power, slope * x, slope)
        x = select(sinks, LOST, x)
        store(poly, 0, x)
        store(poly, WIDTH, slope)
        for j in range(slots):
            i, root = int(lanes[begin + j]), poly[j]
            if root >= 0.0:
                state[X * LANES + i], state[NEW_Q * LANES + i], state[NEW_V * LANES + i] = root, 0.0, poly[WIDTH + j]
            else:
                state[EVENT * LANES + i] = NONE if root == NO_ROOT else HANDED


@jit_lean
def padded(lanes, begin, slots, space):
    """The next lanes of a list as a vector, the last repeated to fill it."""
    for j in range(WIDTH):
        space[j] = lanes[begin + min(j, slots - 1)]
    return load(space, 0)


@jit_lean
def find_uplifts(state, n, a, poly, lanes, count):
    """First time the ground lifts the resting lanes that asked, on either side."""
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        lane = padded(lanes, begin, slots, poly)
        h, guard = gather(state, H * LANES + lane), gather(state, L_GUARD * LANES + lane)
        side, first = spread(0.0), spread(NO_ROOT)
        for sign in (-1.0, 1.0):
            for k in range(n + 1):
                store(poly, k * WIDTH, sign * gather(a, 1.0 * (k * LANES) + lane))
            store(poly, 0, load(poly, 0) + guard)
            x, _ = first_root(poly, n, h)
            sooner = (x >= 0.0) & ((x < first) | (first == NO_ROOT)) & ~(first == LOST)
            first = select(sooner | (x == LOST), x, first)
            side = select(sooner, sign, side)
        store(poly, 0, first)
        store(poly, WIDTH, side)
        for j in range(slots):
            i, root = int(lanes[begin + j]), poly[j]
            if root >= 0.0:
                state[X * LANES + i], state[S * LANES + i] = root, poly[WIDTH + j]
            else:
                state[EVENT * LANES + i] = NONE if root == NO_ROOT else HANDED


@jit_lean
def find_tops(state, n, tol, c, poly, lanes, brackets):
    """Turning points of the lanes that may have passed a higher one than before: in the step or in half of it.

    Equal peaks of an undamped body differ by the errors of the steps: a later one must be higher by more than that.
    """
    count = 0
    for o in range(0, LANES, WIDTH):
        x, v, v_new = load(state, X * LANES + o), load(state, V * LANES + o), load(state, NEW_V * LANES + o)
        event = load(state, EVENT * LANES + o)
        may = (load(state, MODE * LANES + o) == ROCK) & (event >= NONE) & (event < DONE)
        may = may & (load(state, REACH * LANES + o) > load(state, TOP * LANES + o))
        if some(may):
            half = 0.5 * x
            v_half = slope_of(c, o, n, half)
            early, late = (v > 0.0) & (v_half <= 0.0), (v_half > 0.0) & (v_new <= 0.0)
            store(brackets, o, select(early, 0.0, half))
            store(brackets, LANES + o, select(early, half, x))
            count = note(may & (early | late), 1.0 * o, lanes, count)
    for begin in range(0, count, WIDTH):
        slots = min(WIDTH, count - begin)
        lane = padded(lanes, begin, slots, poly)
        lo, hi = gather(brackets, lane), gather(brackets, 1.0 * LANES + lane)
        for k in range(n + 1):
            store(poly, k * WIDTH, gather(c, 1.0 * (k * LANES) + lane))
        x, P = turning_point(poly, n, lo, hi)
        store(poly, 0, x)
        store(poly, WIDTH, P)
        for j in range(slots):
            i = int(lanes[begin + j])
            if poly[WIDTH + j] > state[TOP * LANES + i] * (1.0 + 1e-12 + 100.0 * tol):
                state[TOP * LANES + i], state[TOP_T * LANES + i] = poly[WIDTH + j], state[T * LANES + i] + poly[j]
                state[TOP_SIDE * LANES + i] = state[S * LANES + i]
