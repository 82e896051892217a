"""The whole path of bodies in the lanes of pulses: passages of the equilibrium, forces, rates, energy (docs/sweeps.md).

For what is asked of the way there, and not of the outcome alone: a body is followed until it lies on its side or
nothing is left of its motion, its forces looked at at the nodes of a quadrature of the work of the ground (theory.md
T9).  Bodies that stand at first; nonlinear laws.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, FAST, MEANINGFUL, RETURNS
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.early_outcome import now
from rockcli.kernels.lanes.pulses.ground import to_come
from rockcli.kernels.lanes.pulses.series import look_along
from rockcli.kernels.lanes.pulses.state import put, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import load, select, some, spread, sqrt, store
from rockcli.kernels.quadrature import NODES, POINTS, WEIGHTS
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import edge_of, potential

STANDING = 3
"""What is looked for beside the numbers of `slope_of`: |a_g| of a body that rests."""

BEYOND = 2.0
"""How far beyond the values at its ends a quantity may go between two places, in slopes times the distance."""

EXTREMES = (0.0, math.sqrt(3.0), math.sqrt(3.0 - math.sqrt(6.0)), math.sqrt(3.0 + math.sqrt(6.0)))
"""|y| of the extremes of a bell: two of the even one, two of the odd one."""


@jit_lean
def enter_path(state, i, par, table, rolls, watch):
    """A body that stands, or has just been lifted, has been put into lane i."""
    for field in range(lane.RATE_MAX, lane.N_UP):
        put(state, i, field, 0.0)
    for o, side in ((i, state[i + lane.S * WIDTH]), (i + lane.TO_OTHER, -state[i + lane.S * WIDTH])):
        if not rolls:  # else done as its facet was put there
            edge = edge_of(par, at.RIGHT if side > 0.0 else at.LEFT)
            put(state, o, lane.L_EXTENT, 0.5 * math.pi)
            put(state, o, lane.L_MASS, edge.radius * edge.g / edge.p2)  # I/m
            put_levers(state, o, edge, math.sin(edge.alpha), math.cos(edge.alpha))
    put(state, i, lane.N_LEAST, math.inf)
    put(state, i, lane.OVER_T, math.nan)
    put(state, i, lane.N_UP, math.inf)
    if watch and state[i + lane.UP_T * WIDTH] > 0.0:
        stood(state, i, table)


@jit_lean
def put_levers(state, i, edge, sine, cosine):
    """What forces about an edge need, sine and cosine those of its alpha."""
    put(state, i, lane.L_SIN, sine)
    put(state, i, lane.L_COS, cosine)
    put(state, i, lane.L_SHAKE, 1.0 / edge.radius)
    put(state, i, lane.L_WEIGHT, edge.g / edge.radius)
    put(state, i, lane.L_GRIP, edge.threshold)


@jit_lean
def is_followed(par, table, pieces):
    """Whether the path of a body is for lanes: one that stands at first, and that the ground may lift."""
    guard = par[at.G] * min(par[at.LEFT + at.THRESHOLD], par[at.RIGHT + at.THRESHOLD])
    return par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0 and pieces > 0 and table[13] >= guard


@jit_lean
def stood(state, i, table):
    """Lane i has been at rest until a bell lifted it."""
    until = table[4] * (state[i + lane.UP_T * WIDTH] - table[3])
    largest = largest_of_bell(table, until) * state[i + lane.L_SHAKE * WIDTH] / state[i + lane.L_WEIGHT * WIDTH]
    put(state, i, lane.N_LEAST, 1.0)
    put(state, i, lane.MU_MOST, max(largest, state[i + lane.L_GRIP * WIDTH]))


@jit_lean
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


@jit_lean
def bell(even, odd, y):
    """a_g of a bell at y."""
    z = y * y
    return (even * (1.0 - z) + odd * y * (z - 3.0)) * math.exp(-0.5 * z)


@jit_lean
def never_lifted(par, table, pieces, out):
    """Friction of a body that a bell does not lift, whose results `out` are else known; False if that is not known."""
    if pieces != 1 or table[2] != lane.BELL:
        return False
    out[to.MU] = largest_of_bell(table, table[4] * (min(table[1], par[at.T_MOTION]) - table[3])) / par[at.G]
    out[to.N_MIN] = 1.0
    return True


@jit_lean
def forces_at(state, o, n, y):
    """Of a vector, at y in the step under way: q, its rate and acceleration, sin q, cos q, a_g; T, N and their slopes.

    T (towards the edge) and N are over m R; the slope of |T|/N to its sign and size.
    """
    c, a = series_of_q(o), series_of_a(o, n)
    q, ground = load(state, c + n * WIDTH), load(state, a + n * WIDTH)
    v, bend, third, rise = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for k in range(n - 1, -1, -1):
        third = third * y + bend
        bend = bend * y + v
        v = v * y + q
        q = q * y + load(state, c + k * WIDTH)
        rise = rise * y + ground
        ground = ground * y + load(state, a + k * WIDTH)
    acc, jerk, vv = 2.0 * bend, 6.0 * third, v * v
    sine, cosine = sin_cos(q)
    up, along = load(state, o + lane.L_SIN * WIDTH), load(state, o + lane.L_COS * WIDTH)
    sin_b, cos_b = up * cosine - along * sine, along * cosine + up * sine
    shake = load(state, o + lane.S * WIDTH) * load(state, o + lane.L_SHAKE * WIDTH)
    T = shake * ground + cos_b * acc + sin_b * vv
    N = load(state, o + lane.L_WEIGHT * WIDTH) + sin_b * acc - cos_b * vv
    dT = shake * rise + cos_b * jerk + v * (3.0 * sin_b * acc - cos_b * vv)
    dN = sin_b * jerk - v * (3.0 * cos_b * acc + sin_b * vv)
    return q, v, acc, sine, cosine, ground, T, N, dN, T * (dT * N - T * dN)


@jit_lean
def size_of(T, N):
    """|T|/N, infinite where nothing presses."""
    return select(N > 0.0, abs(T) / N, math.inf)


@jit_lean
def slope_of(what, v, acc, T, N, dN, turn):
    """Of |q'|, -N or |T|/N, by number 0, 1 and 2: value and slope."""
    if what == 0:
        speed = abs(v)
        return speed, select(v > 0.0, acc, -acc)
    if what == 1:
        return -N, -dN
    size = size_of(T, N)
    return size, turn / (abs(T) * (N * N) + 1e-300)


@jit_lean
def follow(state, o, n, watch, two_sided, rolls):
    """One vector, before it takes its step: what happens on the way to X.

    Not the landing on the next facet of one that rolls.
    """
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    taken = (event >= lane.NONE) & (event < lane.DONE)
    going = taken & (mode == lane.ROCK)
    t, x = load(state, o + lane.T * WIDTH), load(state, o + lane.X * WIDTH)
    if some(going):
        _between_places(state, o, n, watch, going, t, x)
    lands = going & (event == lane.IMPACT)
    if some(lands):
        there = o + lane.TO_OTHER if two_sided else o
        paced = there if rolls else o
        rate = load(state, o + lane.NEW_V * WIDTH)
        of_alpha = rate / (load(state, paced + lane.L_P * WIDTH) * load(state, paced + lane.L_ALPHA * WIDTH))
        carried = of_alpha * of_alpha - MEANINGFUL * MEANINGFUL
        carried = select(lands & (carried > 0.0) & (t < load(state, o + lane.L_STOP * WIDTH)), carried, 0.0)
        add(state, o, lane.SWUNG, carried)
        add(state, o, lane.SWUNG_T, carried * (t + x))
        mass, onto = load(state, o + lane.L_MASS * WIDTH), load(state, there + lane.L_MASS * WIDTH)
        eta = load(state, there + lane.L_ETA * WIDTH)
        add(state, o, lane.LOST, select(lands, rate * rate * (mass - onto * eta * eta), 0.0))
        counted = lands & (abs(of_alpha) > FAST) & (t < load(state, o + lane.L_STOP * WIDTH))
        right = load(state, o + lane.S * WIDTH) > 0.0
        add(state, o, lane.ONTO_LEFT, select(counted & right, 1.0, 0.0))
        add(state, o, lane.ONTO_RIGHT, select(counted & ~right, 1.0, 0.0))


@jit_lean
def add(state, o, field, value):
    """Add to one number of the vector at o."""
    store(state, o + field * WIDTH, load(state, o + field * WIDTH) + value)


@jit_lean
def _between_places(state, o, n, watch, going, t, x):
    """Passages of the equilibrium, work and extremes of `follow`, from place to place of the steps of a vector."""
    star, s = load(state, o + lane.L_STAR * WIDTH), load(state, o + lane.S * WIDTH)
    fc, fs = load(state, o + lane.L_FC * WIDTH), load(state, o + lane.L_FS * WIDTH)
    reported = going & (t < load(state, o + lane.L_STOP * WIDTH))
    may_pass = going & (star > 0.0) & (load(state, o + lane.REACH * WIDTH) >= star)
    passes = some(may_pass)
    if not (watch or passes):
        return
    work, low = spread(0.0), spread(0.0)
    was = forces_at(state, o, n, low)
    if watch:
        note_extremes(state, o, was, reported)
    for j in range(POINTS + 1):
        high = NODES[j] * x if j < POINTS else x
        new = forces_at(state, o, n, high)
        if passes:
            over = may_pass & (was[0] < star) & (new[0] >= star)
            if some(over):
                _pass(state, o, n, watch, over, reported, star, t, low, high, was)
        if watch:
            note_extremes(state, o, new, reported)
            _look_between(state, o, n, reported, low, high, was, new)
            if j < POINTS:
                work = work + WEIGHTS[j] * (new[5] * (fc * new[4] + fs * new[3]) * new[1])
        low, was = high, new
    if watch:
        add(state, o, lane.WORK, select(going, load(state, o + lane.L_MASS * WIDTH) * (s * x * work), 0.0))


@jit_lean
def note_extremes(state, o, forces, where):
    """Raise the largest rate and friction, lower the smallest normal force."""
    v, T, N = forces[1], forces[6], forces[7]
    rate, least = load(state, o + lane.RATE_MAX * WIDTH), load(state, o + lane.N_LEAST * WIDTH)
    most, weight = load(state, o + lane.MU_MOST * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    speed, normal, size = abs(v), N / weight, size_of(T, N)
    store(state, o + lane.RATE_MAX * WIDTH, select(where & (speed > rate), speed, rate))
    store(state, o + lane.N_LEAST * WIDTH, select(where & (normal < least), normal, least))
    store(state, o + lane.MU_MOST * WIDTH, select(where & (size > most), size, most))


@jit_lean
def _look_between(state, o, n, where, low, high, was, new):
    """Extremes between two places of which the slopes tell."""
    for what in range(3):
        one, f_low = slope_of(what, was[1], was[2], was[6], was[7], was[8], was[9])
        two, f_high = slope_of(what, new[1], new[2], new[6], new[7], new[8], new[9])
        if what == 0:
            best = load(state, o + lane.RATE_MAX * WIDTH)
        elif what == 1:
            best = -load(state, o + lane.N_LEAST * WIDTH) * load(state, o + lane.L_WEIGHT * WIDTH)
        else:
            best = load(state, o + lane.MU_MOST * WIDTH)
        far = BEYOND * (high - low)
        from_low, from_high = one + far * f_low, two - far * f_high
        most = select(from_low < from_high, from_low, from_high)
        inside = where & (f_low > 0.0) & (f_high < 0.0) & (most > best)
        if some(inside):
            there = forces_at(state, o, n, _top_between(state, o, n, what, inside, low, high, f_low, f_high))
            note_extremes(state, o, there, inside)


@jit_lean
def _top_between(state, o, n, what, where, lo, hi, f_lo, f_hi):
    """Where maxima are, by their slopes (Illinois method)."""
    going, z, kept = where, lo, spread(0.0)
    for _ in range(40):
        new = (lo * f_hi - hi * f_lo) / (f_hi - f_lo)
        far = abs(new - z) > 1e-9 * hi  # flat here: the error is of second order
        z = select(going, new, z)
        if what == STANDING:
            _, f = ground_at(state, o, n, z)
        else:
            forces = forces_at(state, o, n, z)
            _, f = slope_of(what, forces[1], forces[2], forces[6], forces[7], forces[8], forces[9])
        below = f < 0.0
        f_lo = select(going & below & (kept > 0.0), 0.5 * f_lo, select(going & ~below, f, f_lo))
        f_hi = select(going & ~below & (kept < 0.0), 0.5 * f_hi, select(going & below, f, f_hi))
        hi, lo = select(going & below, z, hi), select(going & ~below, z, lo)
        kept = select(below, 1.0, -1.0)
        going = going & far
        if not some(going):
            break
    return z


@jit_lean
def _pass(state, o, n, watch, over, reported, star, t, low, high, was):
    """The equilibrium is passed between two places: when, and the extremes until then."""
    lo, hi = low, select(over, high, low)
    z, going = hi, over
    for _ in range(60):
        forces = forces_at(state, o, n, z)
        miss = forces[0] - star
        lo, hi = select(going & (miss < 0.0), z, lo), select(going & ~(miss < 0.0), z, hi)
        step = z - miss / forces[1]
        step = select((lo < step) & (step < hi), step, 0.5 * (lo + hi))
        far = abs(step - z) > 4e-16 * (t + z)
        z = select(going & far, step, z)
        going = going & far
        if not some(going):
            break
    store(state, o + lane.OVER_T * WIDTH, select(over, t + z, load(state, o + lane.OVER_T * WIDTH)))
    counts = over & reported
    if watch and some(counts):
        there = forces_at(state, o, n, z)
        note_extremes(state, o, there, counts)
        _look_between(state, o, n, counts, low, z, was, there)
        for field, until in ((lane.MU_MOST, lane.MU_UP), (lane.N_LEAST, lane.N_UP)):
            kept = load(state, o + until * WIDTH)
            store(state, o + until * WIDTH, select(counts, load(state, o + field * WIDTH), kept))


@jit_lean
def note_standing(state, o, n):
    """Friction |a_g|/g and weight of resting lanes on the step they are about to take, not of those lifted at once."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    x = load(state, o + lane.X * WIDTH)
    rests = (event >= lane.NONE) & (event < lane.DONE) & (mode == lane.REST) & (x > 0.0)
    if not some(rests):
        return
    least = load(state, o + lane.N_LEAST * WIDTH)
    store(state, o + lane.N_LEAST * WIDTH, select(rests & (least > 1.0), 1.0, least))
    x = select(rests, x, 0.0)
    _, _, _, bound = look_along(state, series_of_a(o, n), n, x)
    if not some(rests & _is_most(state, o, bound)):
        return
    low = spread(0.0)
    was = ground_at(state, o, n, low)
    _note_grip(state, o, was[0], rests)
    for j in range(POINTS + 1):
        high = NODES[j] * x if j < POINTS else x
        new = ground_at(state, o, n, high)
        _note_grip(state, o, new[0], rests)
        turns = rests & (was[1] > 0.0) & (new[1] < 0.0)
        if some(turns):
            z = _top_between(state, o, n, STANDING, turns, low, high, was[1], new[1])
            size, _ = ground_at(state, o, n, z)
            _note_grip(state, o, size, turns)
        low, was = high, new


@jit_lean
def ground_at(state, o, n, y):
    """|a_g| of a vector at y in the step under way, and its slope."""
    a = series_of_a(o, n)
    ground, rise = load(state, a + n * WIDTH), spread(0.0)
    for k in range(n - 1, -1, -1):
        rise = rise * y + ground
        ground = ground * y + load(state, a + k * WIDTH)
    return abs(ground), select(ground > 0.0, rise, -rise)


@jit_lean
def _is_most(state, o, size):
    """Where |a_g| = size needs more friction of a body that stands than was needed so far."""
    shake, weight = load(state, o + lane.L_SHAKE * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    return size * shake > load(state, o + lane.MU_MOST * WIDTH) * weight


@jit_lean
def _note_grip(state, o, size, where):
    """Raise the largest friction to that of a body that stands while |a_g| = size."""
    shake, weight = load(state, o + lane.L_SHAKE * WIDTH), load(state, o + lane.L_WEIGHT * WIDTH)
    most = load(state, o + lane.MU_MOST * WIDTH)
    store(state, o + lane.MU_MOST * WIDTH, select(where & _is_most(state, o, size), size * shake / weight, most))


@jit_lean
def bounces_matter(state, o, two_sided):
    """Lanes whose later swings, lower and free, may need more friction, or press less, than those so far."""
    matter = matter_about(state, o, o)
    return matter | matter_about(state, o, o + lane.TO_OTHER) if two_sided else matter


@jit_lean
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


@jit_lean
def judge_path(state, o, how, two_sided):
    """One vector: what is known once the motion has ended, and which lanes are done."""
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (mode >= lane.REST) & (event < lane.DONE)
    if not some(going):
        return
    t, q, v = load(state, o + lane.T * WIDTH), load(state, o + lane.Q * WIDTH), load(state, o + lane.V * WIDTH)
    sine, bend = now(state, o, q, False)
    to_come(state, o, t)  # sets BELL_E
    r0, rs, rc = (
        load(state, o + lane.L_R0 * WIDTH), load(state, o + lane.L_RS * WIDTH), load(state, o + lane.L_RC * WIDTH),
    )  # fmt: skip
    stored, top = 2.0 * potential(r0, rc, q, rs * bend, sine), 2.0 * load(state, o + lane.L_TOP * WIDTH)
    excess, inside = v * v + stored - top, q < load(state, o + lane.L_STAR * WIDTH)
    missing = excess  # to fall over either edge: the rate goes on over an impact, less by eta
    if two_sided:
        missing = v * v + stored - 2.0 * load(state, o + lane.TO_OTHER + lane.L_TOP * WIDTH)
        missing = select(missing > excess, missing, excess)
    p = load(state, o + lane.L_P * WIDTH)
    near = 10.0 * how.margin * load(state, o + lane.L_ALPHA * WIDTH) * p * (abs(v) + sqrt(abs(top - stored)))
    near = near + 1e-13 * p * p
    near = (abs(excess) <= near) | (abs(missing) <= near)

    over, stop = t >= load(state, o + lane.L_END * WIDTH), load(state, o + lane.L_STOP * WIDTH)
    verdict = load(state, o + lane.VERDICT * WIDTH)
    asked = going & over & (mode == lane.ROCK) & (verdict < 0.0)
    falls = (inside & (excess > 0.0) & (v > 0.0)) | (~inside & ((excess < 0.0) | (v > 0.0)))
    verdict = select(asked & inside & (missing < 0.0), 1.0 * RETURNS, select(asked & falls, 1.0 * FALLS, verdict))
    still = going & (mode == lane.REST) & over
    lies = going & (event == lane.TOUCH)
    verdict = select(still, 1.0 * RETURNS, select(lies, 1.0 * FALLS, verdict))
    back = (verdict == 1.0 * RETURNS) & (t >= stop) & (v <= 0.0)
    next_event = select(still | lies | back, lane.DONE, lane.NONE)
    doubtful = (asked & near & ~lies) | (load(state, o + lane.N_STEPS * WIDTH) >= how.max_steps)
    next_event = select(doubtful, lane.FOR_MARCH, next_event)
    store(state, o + lane.VERDICT * WIDTH, verdict)
    store(state, o + lane.EVENT * WIDTH, select(going, next_event, event))


@jit_lean
def leave_path(state, i, watch, two_sided, par, out):
    """What goes with the path of a case that leaves lane i."""
    out[to.T_OVERTURN] = state[i + lane.OVER_T * WIDTH]
    out[to.T_END] = min(out[to.T_END], state[i + lane.L_STOP * WIDTH])
    out[to.SWINGS] += state[i + lane.SWUNG * WIDTH]
    out[to.SWINGS_T] += state[i + lane.SWUNG_T * WIDTH]
    if not two_sided:
        right = state[i + lane.TOP_SIDE * WIDTH] > 0.0
        out[to.PEAK_RIGHT if right else to.PEAK_LEFT] = state[i + lane.TOP * WIDTH]
    out[to.ONTO_LEFT] += state[i + lane.ONTO_LEFT * WIDTH]
    out[to.ONTO_RIGHT] += state[i + lane.ONTO_RIGHT * WIDTH]
    out[to.N_MIN] = out[to.N_STANDING] = math.inf
    if not watch:
        return
    out[to.RATE_PEAK], out[to.MU] = state[i + lane.RATE_MAX * WIDTH], state[i + lane.MU_MOST * WIDTH]
    out[to.N_MIN] = state[i + lane.N_LEAST * WIDTH]
    out[to.MU_STANDING], out[to.N_STANDING] = state[i + lane.MU_UP * WIDTH], state[i + lane.N_UP * WIDTH]
    q, v, mass = state[i + lane.Q * WIDTH], state[i + lane.V * WIDTH], state[i + lane.L_MASS * WIDTH]
    half = math.sin(0.5 * q)
    stored = potential(
        state[i + lane.L_R0 * WIDTH], state[i + lane.L_RC * WIDTH], q,
        state[i + lane.L_RS * WIDTH] * 2.0 * half * half, math.sin(q),
    )  # fmt: skip
    left = mass * (0.5 * v * v + stored) + 0.5 * state[i + lane.LOST * WIDTH]
    out[to.ENERGY] = -(state[i + lane.WORK * WIDTH] + left) / par[at.G]
