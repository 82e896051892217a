"""Largest friction and rate and smallest normal force on the steps of the lanes of pulses (docs/lanes.md).

They are looked at at the nodes of a quadrature and where the slopes at two of these tell of an extreme between them.
Such extremes wait until there are WIDTH of them, whichever lanes they are in.
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.series import look_along, value_and_slope
from rockcli.kernels.lanes.pulses.state import ORDER, put, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import fma, gather, load, note, select, some, spread, store
from rockcli.kernels.quadrature import NODES, POINTS

RATE, PRESS, GRIP, GRIP_BACK = 0.0, 1.0, 2.0, 3.0
"""What an extreme that waits is of: |q'|, -N, T/N, -T/N."""

BEYOND = 2.0
"""How far beyond the values at its ends a quantity may go between two places, in slopes times the distance."""

FLAT = 1e-6
"""Last step towards an extreme, over its place: the next one would be far less, and the value is off by its square."""

ROOM = 4 * WIDTH
WAITING = 6 * ROOM
"""Of extremes that wait: lane, what, the two places and the slopes there; room for ROOM of them."""

EXTREMES = (0.0, math.sqrt(3.0), math.sqrt(3.0 - math.sqrt(6.0)), math.sqrt(3.0 + math.sqrt(6.0)))
"""|y| of the extremes of a bell: two of the even one, two of the odd one."""


@jit
def levers_of(state, o):
    """Of a vector, or of one gathered: sin alpha, cos alpha, s/R and g/R."""
    shake = load(state, o + lane.S * WIDTH) * load(state, o + lane.L_SHAKE * WIDTH)
    return (
        load(state, o + lane.L_SIN * WIDTH), load(state, o + lane.L_COS * WIDTH), shake,
        load(state, o + lane.L_WEIGHT * WIDTH),
    )  # fmt: skip


@jit
def forces_at(series, c, a, levers, y):
    """At y in the step under way: q, its rate and acceleration, sin q, cos q, a_g; T, N, the slope of N, and turn.

    c, a: where the coefficients of q and of a_g begin.  T (towards the edge) and N are over m R; the slope of T/N is
    turn/N^2.
    """
    q, ground = load(series, c + ORDER * WIDTH), load(series, a + ORDER * WIDTH)
    v, bend, third, rise = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for k in range(ORDER - 1, -1, -1):
        third = fma(third, y, bend)
        bend = fma(bend, y, v)
        v = fma(v, y, q)
        q = fma(q, y, load(series, c + k * WIDTH))
        rise = fma(rise, y, ground)
        ground = fma(ground, y, load(series, a + k * WIDTH))
    acc, jerk, vv = 2.0 * bend, 6.0 * third, v * v
    sine, cosine = sin_cos(q)
    up, along, shake, weight = levers
    sin_b, cos_b = fma(up, cosine, -along * sine), fma(along, cosine, up * sine)
    T = fma(shake, ground, fma(cos_b, acc, sin_b * vv))
    N = fma(sin_b, acc, fma(-cos_b, vv, weight))
    dT = fma(shake, rise, fma(cos_b, jerk, v * fma(3.0 * sin_b, acc, -cos_b * vv)))
    dN = fma(sin_b, jerk, -v * fma(3.0 * cos_b, acc, sin_b * vv))
    return q, v, acc, sine, cosine, ground, T, N, dN, fma(dT, N, -T * dN)


@jit
def ratio_of(T, N):
    """T/N, infinite where nothing presses."""
    return select(N > 0.0, T / N, math.inf)


@jit
def slope_of_ratio(N, turn):
    """Of T/N."""
    return turn / (N * N + 1e-300)


@jit
def note_extremes(state, o, forces, where):
    """Raise the largest rate and friction, lower the smallest normal force."""
    v, T, N = forces[1], forces[6], forces[7]
    rate, least = load(state, o + lane.RATE_MAX * WIDTH), load(state, o + lane.N_LEAST * WIDTH)
    most, weight = load(state, o + lane.MU_MOST * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    speed, normal, size = abs(v), N / weight, ratio_of(abs(T), N)
    store(state, o + lane.RATE_MAX * WIDTH, select(where & (speed > rate), speed, rate))
    store(state, o + lane.N_LEAST * WIDTH, select(where & (normal < least), normal, least))
    store(state, o + lane.MU_MOST * WIDTH, select(where & (size > most), size, most))


@jit
def look_between(state, o, where, low, high, was, new, waiting, count, scratch):
    """Extremes between two places of which the slopes tell are to be sought; how many wait now."""
    speed, rate = abs(was[1]), load(state, o + lane.RATE_MAX * WIDTH)
    slope, next_slope = select(was[1] > 0.0, was[2], -was[2]), select(new[1] > 0.0, new[2], -new[2])
    count = _let_wait(
        RATE, o, where, low, high, speed, slope, abs(new[1]), next_slope, rate, waiting, count, scratch
    )  # fmt: skip
    press = -load(state, o + lane.N_LEAST * WIDTH) * load(state, o + lane.L_WEIGHT * WIDTH)
    count = _let_wait(
        PRESS, o, where, low, high, -was[7], -was[8], -new[7], -new[8], press, waiting, count, scratch
    )  # fmt: skip
    if some(where & (was[9] * new[9] < 0.0)):
        # a maximum of T/N, or of -T/N: |T|/N may have one, and T change its sign between the two
        for what, side in ((GRIP, 1.0), (GRIP_BACK, -1.0)):
            T, next_T = side * was[6], side * new[6]
            turns = where & (side * was[9] > 0.0) & (side * new[9] < 0.0) & ((T > 0.0) | (next_T > 0.0))
            if some(turns):
                count = _let_wait(
                    what, o, turns, low, high, ratio_of(T, was[7]), side * slope_of_ratio(was[7], was[9]),
                    ratio_of(next_T, new[7]), side * slope_of_ratio(new[7], new[9]),
                    load(state, o + lane.MU_MOST * WIDTH), waiting, count, scratch,
                )  # fmt: skip
    while count >= WIDTH:
        count -= WIDTH
        find_extremes(state, waiting, count, WIDTH, scratch)
    return count


@jit
def _let_wait(what, o, where, low, high, at_low, f_low, at_high, f_high, best, waiting, count, scratch):
    """Where a quantity may have a maximum above `best` between two places, it waits to be found; how many do now."""
    where = where & (f_low > 0.0) & (f_high < 0.0)
    if not some(where):
        return count
    far = BEYOND * (high - low)
    from_low, from_high = at_low + far * f_low, at_high - far * f_high
    where = where & (select(from_low < from_high, from_low, from_high) > best)
    begin = count
    count = note(where, 1.0 * o, waiting, count)
    if count == begin:
        return count
    store(scratch, 0, low)
    store(scratch, WIDTH, high)
    store(scratch, 2 * WIDTH, f_low)
    store(scratch, 3 * WIDTH, f_high)
    for j in range(begin, count):
        k = int(waiting[j]) - o
        waiting[ROOM + j] = what
        for field in range(4):
            waiting[(2 + field) * ROOM + j] = scratch[field * WIDTH + k]
    return count


@jit
def find_extremes(state, waiting, begin, slots, series):
    """Find the maxima of `slots` of those that wait, from `begin` on, by their slopes (Illinois method).

    One before the last passage of the equilibrium, as far as that is known, is also one of those until then.
    """
    for field in range(6):
        for j in range(begin + slots, begin + WIDTH):
            waiting[field * ROOM + j] = waiting[field * ROOM + begin]
    chosen, what = load(waiting, begin), load(waiting, ROOM + begin)
    lo, hi = load(waiting, 2 * ROOM + begin), load(waiting, 3 * ROOM + begin)
    f_lo, f_hi = load(waiting, 4 * ROOM + begin), load(waiting, 5 * ROOM + begin)
    a = (ORDER + 1) * WIDTH
    for k in range(ORDER + 1):
        store(series, k * WIDTH, gather(state, chosen, series_of_q(k * WIDTH)))
        store(series, a + k * WIDTH, gather(state, chosen, series_of_a(k * WIDTH)))
    shake = gather(state, chosen, lane.S * WIDTH) * gather(state, chosen, lane.L_SHAKE * WIDTH)
    weight = gather(state, chosen, lane.L_WEIGHT * WIDTH)
    up, along = gather(state, chosen, lane.L_SIN * WIDTH), gather(state, chosen, lane.L_COS * WIDTH)
    levers = up, along, shake, weight
    going, z, kept = lo < hi, lo, spread(0.0)
    v, T, N = spread(0.0), spread(0.0), spread(0.0)
    for _ in range(40):
        new = (lo * f_hi - hi * f_lo) / (f_hi - f_lo)
        far = abs(new - z) > FLAT * hi
        z = select(going, new, z)
        _, v, acc, _, _, _, T, N, dN, turn = forces_at(series, 0, a, levers, z)
        slope = select(what == GRIP, 1.0, -1.0) * slope_of_ratio(N, turn)
        f = select(what == PRESS, -dN, select(what == RATE, select(v > 0.0, acc, -acc), slope))
        lo, hi, f_lo, f_hi, kept = narrowed(going, z, f, lo, hi, f_lo, f_hi, kept)
        going = going & far
        if not some(going):
            break
    store(series, 0, z)
    store(series, WIDTH, abs(v))
    store(series, 2 * WIDTH, N / weight)
    store(series, 3 * WIDTH, ratio_of(abs(T), N))
    for j in range(slots):
        i = int(waiting[begin + j])
        rate, normal, size = series[WIDTH + j], series[2 * WIDTH + j], series[3 * WIDTH + j]
        put(state, i, lane.RATE_MAX, max(state[i + lane.RATE_MAX * WIDTH], rate))
        put(state, i, lane.N_LEAST, min(state[i + lane.N_LEAST * WIDTH], normal))
        put(state, i, lane.MU_MOST, max(state[i + lane.MU_MOST * WIDTH], size))
        if state[i + lane.T * WIDTH] + series[j] <= state[i + lane.OVER_T * WIDTH]:
            put(state, i, lane.N_UP, min(state[i + lane.N_UP * WIDTH], normal))
            put(state, i, lane.MU_UP, max(state[i + lane.MU_UP * WIDTH], size))


@jit
def narrowed(going, z, f, lo, hi, f_lo, f_hi, kept):
    """The bracket lo, hi of a fall through zero, and f there, with f at z inside; an end `kept` twice counts half."""
    below = f < 0.0
    f_lo = select(going & below & (kept > 0.0), 0.5 * f_lo, select(going & ~below, f, f_lo))
    f_hi = select(going & ~below & (kept < 0.0), 0.5 * f_hi, select(going & below, f, f_hi))
    return select(going & ~below, z, lo), select(going & below, z, hi), f_lo, f_hi, select(below, 1.0, -1.0)


@jit
def stood(state, i, table):
    """Lane i has been at rest until a bell lifted it."""
    until = table[4] * (state[i + lane.UP_T * WIDTH] - table[3])
    largest = largest_of_bell(table, until) * state[i + lane.L_SHAKE * WIDTH] / state[i + lane.L_WEIGHT * WIDTH]
    put(state, i, lane.N_LEAST, 1.0)
    put(state, i, lane.MU_MOST, max(largest, state[i + lane.L_GRIP * WIDTH]))


@jit
def largest_of_bell(table, end):
    """Largest |a_g| of a bell up to its y = end: there, where it begins, or at an extreme between."""
    even, odd = table[5], table[8]
    begin = table[4] * (table[0] - table[3])
    most = max(abs(bell(even, odd, begin)), abs(bell(even, odd, end)))
    for y in EXTREMES:
        for side in range(2):
            place = y if side == 0 else -y
            if begin < place < end:
                most = max(most, abs(bell(even, odd, place)))
    return most


@jit
def bell(even, odd, y):
    """a_g of a bell at y."""
    z = y * y
    return (even * (1.0 - z) + odd * y * (z - 3.0)) * math.exp(-0.5 * z)


@jit
def note_standing(state, o):
    """Friction |a_g|/g and weight of resting lanes on the step they are about to take, not of those lifted at once."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    x = load(state, o + lane.X * WIDTH)
    rests = (event >= lane.NONE) & (event < lane.DONE) & (mode == lane.REST) & (x > 0.0)
    if not some(rests):
        return
    least = load(state, o + lane.N_LEAST * WIDTH)
    store(state, o + lane.N_LEAST * WIDTH, select(rests & (least > 1.0), 1.0, least))
    x = select(rests, x, 0.0)
    _, _, _, bound = look_along(state, series_of_a(o), x)
    if not some(rests & _is_most(state, o, bound)):
        return
    low = spread(0.0)
    was = ground_at(state, o, low)
    _note_grip(state, o, was[0], rests)
    for j in range(POINTS + 1):
        high = NODES[j] * x if j < POINTS else x
        new = ground_at(state, o, high)
        _note_grip(state, o, new[0], rests)
        turns = rests & (was[1] > 0.0) & (new[1] < 0.0)
        if some(turns):
            z = _top_of_ground(state, o, turns, low, high, was[1], new[1])
            size, _ = ground_at(state, o, z)
            _note_grip(state, o, size, turns)
        low, was = high, new


@jit
def _top_of_ground(state, o, where, lo, hi, f_lo, f_hi):
    """Where maxima of |a_g| are, by their slopes, as in `find_extremes`."""
    going, z, kept = where, lo, spread(0.0)
    for _ in range(40):
        new = (lo * f_hi - hi * f_lo) / (f_hi - f_lo)
        far = abs(new - z) > FLAT * hi
        z = select(going, new, z)
        _, f = ground_at(state, o, z)
        lo, hi, f_lo, f_hi, kept = narrowed(going, z, f, lo, hi, f_lo, f_hi, kept)
        going = going & far
        if not some(going):
            break
    return z


@jit
def ground_at(state, o, y):
    """|a_g| of a vector at y in the step under way, and its slope."""
    ground, rise = value_and_slope(state, series_of_a(o), y)
    return abs(ground), select(ground > 0.0, rise, -rise)


@jit
def _is_most(state, o, size):
    """Where |a_g| = size needs more friction of a body that stands than was needed so far."""
    shake, weight = load(state, o + lane.L_SHAKE * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    return size * shake > load(state, o + lane.MU_MOST * WIDTH) * weight


@jit
def _note_grip(state, o, size, where):
    """Raise the largest friction to that of a body that stands while |a_g| = size."""
    shake, weight = load(state, o + lane.L_SHAKE * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    most = load(state, o + lane.MU_MOST * WIDTH)
    store(state, o + lane.MU_MOST * WIDTH, select(where & _is_most(state, o, size), size * shake / weight, most))


@jit
def bounces_matter(state, o, two_sided):
    """Lanes whose later swings, lower and free, may need more friction, or press less, than those so far."""
    matter = matter_about(state, o, o)
    return matter | matter_about(state, o, o + lane.TO_OTHER) if two_sided else matter


@jit
def matter_about(state, o, edge):
    """`bounces_matter` of the swings about the edge whose numbers stand at `edge`.

    Not those where |q''| = down and the present rate together do not: both are less from now on.
    """
    v, weight = load(state, o + lane.V * WIDTH), load(state, edge + lane.L_WEIGHT * WIDTH)
    down = load(state, edge + lane.L_R0 * WIDTH) + load(state, edge + lane.L_RC * WIDTH)
    up = load(state, edge + lane.L_SIN * WIDTH)
    normal = 1.0 - (up * down + v * v) / weight
    friction = (down + up * v * v) / weight
    least, most = load(state, o + lane.N_LEAST * WIDTH), load(state, o + lane.MU_MOST * WIDTH)
    return ~((normal >= least) & (friction <= most * normal))
