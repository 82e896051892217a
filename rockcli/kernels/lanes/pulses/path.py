"""The whole path of bodies in the lanes of pulses: passages of the equilibrium, forces, rates, energy (docs/lanes.md).

For what is asked of the way there, and not of the outcome alone: a body is followed until it lies on its side or
nothing is left of its motion, its forces looked at at the nodes of a quadrature of the work of the ground (theory.md
T9).  Bodies that stand at first; nonlinear laws.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, FAST, MEANINGFUL, RETURNS
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.early_outcome import now
from rockcli.kernels.lanes.pulses.forces import (
    forces_at,
    largest_of_bell,
    levers_of,
    look_between,
    note_extremes,
    stood,
)
from rockcli.kernels.lanes.pulses.ground import to_come
from rockcli.kernels.lanes.pulses.series import value_and_slope
from rockcli.kernels.lanes.pulses.state import put, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import load, select, some, spread, sqrt, store
from rockcli.kernels.quadrature import NODES, POINTS, WEIGHTS
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import edge_of, potential


@jit
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


@jit
def put_levers(state, i, edge, sine, cosine):
    """What forces about an edge need, sine and cosine those of its alpha."""
    put(state, i, lane.L_SIN, sine)
    put(state, i, lane.L_COS, cosine)
    put(state, i, lane.L_SHAKE, 1.0 / edge.radius)
    put(state, i, lane.L_WEIGHT, edge.g / edge.radius)
    put(state, i, lane.L_GRIP, edge.threshold)


@jit
def is_followed(par, table, pieces):
    """Whether the path of a body is for lanes: one that stands at first, and that the ground may lift."""
    guard = par[at.G] * min(par[at.LEFT + at.THRESHOLD], par[at.RIGHT + at.THRESHOLD])
    return par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0 and pieces > 0 and table[13] >= guard


@jit
def never_lifted(par, table, pieces, out):
    """Friction of a body that a bell does not lift, whose results `out` are else known; False if that is not known."""
    if pieces != 1 or table[2] != lane.BELL:
        return False
    out[to.MU] = largest_of_bell(table, table[4] * (min(table[1], par[at.T_MOTION]) - table[3])) / par[at.G]
    out[to.N_MIN] = 1.0
    return True


@jit
def follow(state, o, watch, two_sided, rolls, waiting, count, scratch):
    """One vector, before it takes its step: what happens on the way to X; how many extremes wait to be found.

    Not the landing on the next facet of one that rolls.
    """
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    taken = (event >= lane.NONE) & (event < lane.DONE)
    going = taken & (mode == lane.ROCK)
    t, x = load(state, o + lane.T * WIDTH), load(state, o + lane.X * WIDTH)
    if some(going):
        star = load(state, o + lane.L_STAR * WIDTH)
        may_pass = going & (star > 0.0) & (load(state, o + lane.REACH * WIDTH) >= star)
        if watch:
            count = _look_along(state, o, going, may_pass, t, x, waiting, count, scratch)
        elif some(may_pass):
            _find_passage(state, o, may_pass, star, t, x)
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
    return count


@jit
def add(state, o, field, value):
    """Add to one number of the vector at o."""
    store(state, o + field * WIDTH, load(state, o + field * WIDTH) + value)


@jit
def _look_along(state, o, going, may_pass, t, x, waiting, count, scratch):
    """Passages of the equilibrium, work and extremes of `follow`, from place to place; how many extremes wait."""
    star, s = load(state, o + lane.L_STAR * WIDTH), load(state, o + lane.S * WIDTH)
    fc, fs = load(state, o + lane.L_FC * WIDTH), load(state, o + lane.L_FS * WIDTH)
    c, a, levers = series_of_q(o), series_of_a(o), levers_of(state, o)
    reported, passes = going & (t < load(state, o + lane.L_STOP * WIDTH)), some(may_pass)
    work, low = spread(0.0), spread(0.0)
    was = forces_at(state, c, a, levers, low)
    note_extremes(state, o, was, reported)
    for j in range(POINTS + 1):
        high = NODES[j] * x if j < POINTS else x
        new = forces_at(state, c, a, levers, high)
        if passes:
            over = may_pass & (was[0] < star) & (new[0] >= star)
            if some(over):
                z = _pass(state, o, over, star, t, low, high)
                _keep_until(state, o, over & reported, forces_at(state, c, a, levers, z))
        note_extremes(state, o, new, reported)
        count = look_between(state, o, reported, low, high, was, new, waiting, count, scratch)
        if j < POINTS:
            work = work + WEIGHTS[j] * (new[5] * (fc * new[4] + fs * new[3]) * new[1])
        low, was = high, new
    add(state, o, lane.WORK, select(going, load(state, o + lane.L_MASS * WIDTH) * (s * x * work), 0.0))
    return count


@jit
def _find_passage(state, o, may_pass, star, t, x):
    """Passages of the equilibrium alone, from place to place as in `_look_along`."""
    low = spread(0.0)
    was, _ = value_and_slope(state, series_of_q(o), low)
    for j in range(POINTS + 1):
        high = NODES[j] * x if j < POINTS else x
        new, _ = value_and_slope(state, series_of_q(o), high)
        over = may_pass & (was < star) & (new >= star)
        if some(over):
            _pass(state, o, over, star, t, low, high)
        low, was = high, new


@jit
def _pass(state, o, over, star, t, low, high):
    """Where the equilibrium is passed between two places; sets OVER_T."""
    lo, hi = low, select(over, high, low)
    z, going = hi, over
    for _ in range(60):
        q, v = value_and_slope(state, series_of_q(o), z)
        miss = q - star
        lo, hi = select(going & (miss < 0.0), z, lo), select(going & ~(miss < 0.0), z, hi)
        step, near = z - miss / v, 1e-10 * (t + z)  # of second order: after a step so short the next one is rounding
        step = select((lo - near < step) & (step < hi + near), step, 0.5 * (lo + hi))
        far = abs(step - z) > near
        z = select(going, step, z)
        going = going & far
        if not some(going):
            break
    store(state, o + lane.OVER_T * WIDTH, select(over, t + z, load(state, o + lane.OVER_T * WIDTH)))
    return z


@jit
def _keep_until(state, o, where, forces):
    """The extremes until the equilibrium is passed, with these forces there; those that wait follow when found."""
    note_extremes(state, o, forces, where)
    for field, until in ((lane.MU_MOST, lane.MU_UP), (lane.N_LEAST, lane.N_UP)):
        kept = load(state, o + until * WIDTH)
        store(state, o + until * WIDTH, select(where, load(state, o + field * WIDTH), kept))


@jit
def judge_path(state, o, how, two_sided, until_fall):
    """One vector: what is known once the motion has ended, and which lanes are done.

    `until_fall`: so are those beyond the equilibrium that the rest of the motion cannot bring back.
    """
    event, mode = load(state, o + lane.EVENT * WIDTH), load(state, o + lane.MODE * WIDTH)
    going = (mode >= lane.REST) & (event < lane.DONE)
    if not some(going):
        return
    t, q, v = load(state, o + lane.T * WIDTH), load(state, o + lane.Q * WIDTH), load(state, o + lane.V * WIDTH)
    sine, bend = now(state, o, q, False)
    plus, minus = to_come(state, o, t)
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
    done = still | lies | back
    if until_fall:
        right, pull = load(state, o + lane.S * WIDTH) > 0.0, load(state, o + lane.L_PULL * WIDTH)
        lost = v > pull * select(right, plus, minus) + 100.0 * how.margin * sqrt(top)
        lost = going & (mode == lane.ROCK) & ~inside & (lost | (verdict == 1.0 * FALLS))
        verdict, done = select(lost, 1.0 * FALLS, verdict), done | lost
    next_event = select(done, lane.DONE, lane.NONE)
    doubtful = (asked & near & ~lies) | (load(state, o + lane.N_STEPS * WIDTH) >= how.max_steps)
    next_event = select(doubtful, lane.FOR_MARCH, next_event)
    store(state, o + lane.VERDICT * WIDTH, verdict)
    store(state, o + lane.EVENT * WIDTH, select(going, next_event, event))


@jit
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
