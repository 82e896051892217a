"""The flexible rocking column as a hybrid automaton: flow, guard, reset, mode (docs/flexible.md).

Phases: CONTACT (rigid base: held, a cantilever; Winkler base: full contact) and OPEN (rocking on edge s).  In
each the deformation is a sum of modes, advanced exactly; steps land on the breakpoints of the motion.
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, TABLES, VECTOR
from rockcli.kernels.column import layout as at
from rockcli.kernels.column.events import guards, mode_of
from rockcli.kernels.column.law import along, dot, energy, gap, ground, limit, opens_at, step
from rockcli.kernels.column.oscillator import fill, wander
from rockcli.kernels.column.readings import add_work, note_extremes, note_landing, passage, rearms, write
from rockcli.kernels.constants import FALLS, NOT_FINITE, OUT_OF_STEPS, RETURNS, UNDECIDED
from rockcli.kernels.jit import entry, jit
from rockcli.kernels.rigid.ground import PULSES, piece_at, piece_end
from rockcli.kernels.rigid.ground import WIDTH as PIECE
from rockcli.kernels.rigid.settings import Channel as Channel

SLOTS = 8
"""Step tables kept per phase."""

FALLEN = 0.5 * math.pi
"""|theta| of a column that lies on the ground."""

WORK_SPACE = ("tables", "influences", "keys", "used", "paces", "filled", "work", "S", "F", "A", "about", "found")
"""Arrays of the work space.  Kept for further cases of the same column: tables (2, SLOTS, 14, N), influences (2, SLOTS,
24), keys and used (2, SLOTS) of the steps, paces (2, LEVELS, 7, N) and filled (2, LEVELS) of the search."""


@jit
def rounded(h):
    """h to ten digits, so that steps which differ by rounding share a table, and the table does not tell which came."""
    part, power = math.frexp(h)
    return math.ldexp(math.floor(part * 2.0**33 + 0.5) / 2.0**33, power)


@jit
def slot_of(keys, used, clock, h):
    """Slot of a step table for h, and whether it is filled: the least recently used one if there is none."""
    oldest = 0
    for k in range(SLOTS):
        if keys[k] == h:
            used[k] = clock
            return k, True
        if used[k] < used[oldest]:
            oldest = k
    keys[oldest], used[oldest] = h, clock
    return oldest, False


@jit
def smooth_until(channel, data, i, t):
    """When piece i of a channel ends, or begins if t is before it; inf if there is none."""
    if i >= channel.pieces:
        return math.inf
    if channel.kind == PULSES and t < data[i * PIECE]:
        return min(data[i * PIECE], piece_end(channel, data, i))
    return piece_end(channel, data, i)


@jit
def switch(T, back, z, v, z_x, v_x):
    """Modal state in the other phase: T z, or its transpose (the M-orthogonal projection onto the held base)."""
    n = len(z)
    for i in range(n):
        z_x[i] = v_x[i] = 0.0
        for j in range(n):
            a = T[j, i] if back else T[i, j]
            z_x[i] += a * z[j]
            v_x[i] += a * v[j]


@jit
def begin(par, modes, phase, s, z, v, out):
    """Results so far of a column with the state of t = 0; its energy."""
    lam, _, bu, th, _, _, _ = mode_of(modes, phase)
    for i in range(at.N_OUT):
        out[i] = 0.0
    out[at.T_PEAK] = out[at.T_UPLIFT] = out[at.T_OVERTURN] = math.nan
    if phase == at.OPEN:
        out[at.T_UPLIFT] = 0.0
        out[at.PEAK], out[at.PEAK_SIDE], out[at.T_PEAK] = abs(dot(th, z)), s, 0.0
    return energy(par, phase, lam, bu, th, z, v)


@jit
def ended(par, modes, phase, s, t, reported, F, z, v, found, out):
    """Whether the case ends after the motion: it is below the barrier, at rest, or was followed long enough."""
    lam, c, bu, th, _, row, row_v = mode_of(modes, phase)
    if t >= par[at.T_STOP]:
        e = energy(par, phase, lam, bu, th, z, v)
        if e < par[at.BARRIER] * (1.0 - 1e-9) and abs(dot(th, z)) < par[at.THETA_STAR]:
            out[at.VERDICT] = RETURNS
            return True
    if phase == at.CONTACT:
        for k in range(12):
            F[k] = 0.0
        wander(lam, c, bu, th, F, 1e9, z, v, row, row_v, math.inf, math.inf, found)
        if 0.5 * found[0] < 1e-3 * limit(par, phase, 0.0):
            out[at.VERDICT] = RETURNS
            if not reported:
                out[at.T_END] = par[at.T_STOP] if par[at.HAS_DURATION] > 0.0 else t
            return True
    given_up = t >= par[at.T_STOP] + par[at.GIVE_UP]
    if given_up:
        out[at.VERDICT] = UNDECIDED
    return given_up


@jit
def fine_enough(par, h, theta, rate, a_v):
    """h halved to what the tangent stiffness of an open Winkler base and the change of theta allow."""
    edge = opens_at(par, a_v)
    q = max(abs(theta), edge, 0.1 * par[at.THETA_1])
    stiff = (
        par[at.G]
        * par[at.WIDTH]
        / (par[at.LENGTH] * par[at.LENGTH] * 3.0 * par[at.THETA_1])
        * min(max(edge, par[at.THETA_1]) / q, 1.0) ** 1.5
    )
    fine = par[at.FINENESS]
    while h * h * stiff * par[at.MOBILITY] > 0.1 * fine * fine or h * abs(rate) > 0.3 * fine * q:
        h *= 0.5
    return h


@jit
def span(par, phase, th, t, horizontal, h_data, ih, vertical, v_data, iv, S, z, v):
    """The next step as far as the motion and the base allow: (when it lands, whether it does, its length)."""
    t_motion, t_stop = par[at.T_MOTION], par[at.T_STOP]
    after = t >= t_motion
    t_next = t_motion if not after else (t_stop if t < t_stop else math.inf)
    if not after:
        t_next = min(t_next, smooth_until(horizontal, h_data, ih, t), smooth_until(vertical, v_data, iv, t))
    h = par[at.H_FREE] if after else par[at.H_MAX]
    if par[at.THETA_1] > 0.0 and phase == at.OPEN:
        a_v = ground(vertical, v_data, par[at.FACTOR_V], iv, t, t_motion, S) if not after else 0.0
        h = fine_enough(par, h, dot(th, z), dot(th, v), a_v)
    lands = t_next - t <= h * (1.0 + 1e-9)
    return t_next, lands, rounded(t_next - t if lands else h)


@jit
def take_step(par, modes, phase, s, t, h, clock, channels, ih, h_data, iv, v_data, kept, A, F, S, z, v, work, out):
    """A step of h, halved until its loads converge: (its length, whether they do)."""
    (horizontal, vertical), (tables, influences, keys, used) = channels, kept
    lam, c, bu, th, _, _, _ = mode_of(modes, phase)
    t_motion, z_1, v_1 = par[at.T_MOTION], work[0], work[1]
    A[0], A[3] = 0.0, 0.0
    while True:
        for k in range(3):
            x = t + 0.5 * h * k
            A[k] = ground(horizontal, h_data, par[at.FACTOR_H], ih, x, t_motion, S) if t < t_motion else 0.0
            A[3 + k] = ground(vertical, v_data, par[at.FACTOR_V], iv, x, t_motion, S) if t < t_motion else 0.0
        slot, ready = slot_of(keys[phase], used[phase], clock, h)
        table, influence = tables[phase, slot], influences[phase, slot]
        if not ready:
            fill(lam, c, bu, th, h, S, table, influence)
        evaluated = step(par, phase, s, lam, bu, th, h, table, influence, A, z, v, z_1, v_1, F)
        out[at.N_RHS] += abs(evaluated)
        if evaluated > 0 or h < 1e-9 * par[at.H_MAX]:
            return h, evaluated > 0
        h *= 0.5


@jit
def struck(par, t, th, v, reported, landings, out):
    """eta acts on all velocities; energy that an impact within the report takes."""
    lost = 0.5 * (1.0 - par[at.ETA] * par[at.ETA]) * dot(v, v)
    note_landing(par, t, dot(th, v), reported, landings, out)
    for m in range(len(v)):
        v[m] *= par[at.ETA]
    return 0.0 if reported else lost


@jit
def opened(par, modes, T, t, x, F, z, v, z_x, v_x, out):
    """The base opens at x of a step, on the side that theta tells, or its moment, which is returned."""
    th, row, row_v = modes[at.TURN, at.CONTACT], modes[at.ROW, at.CONTACT], modes[at.ROW_RATE, at.CONTACT]
    value = dot(row, z) + dot(row_v, v) + par[at.R_A] * along(F, 6, x)
    to_right = dot(th, z) > 0.0 if par[at.THETA_1] > 0.0 else not value > 0.0
    switch(T, False, z, v, z_x, v_x)
    for m in range(len(z)):
        z[m], v[m] = z_x[m], v_x[m]
    if math.isnan(out[at.T_UPLIFT]):
        out[at.T_UPLIFT] = t
    return 1.0 if to_right else -1.0


@jit
def came_back(par, modes, T, s, t, x, F, armed, reported, z, v, z_x, v_x, landings, balance, out):
    """An open rigid base is back at zero at x of a step: an impact, or it sticks, or goes on to the other side."""
    lam, _, bu, th, _, _, _ = mode_of(modes, at.OPEN)
    lam_c, _, bu_c, th_c, _, row, row_v = mode_of(modes, at.CONTACT)
    if armed:
        balance -= struck(par, t, th, v, reported, landings, out)
        s = -s
        if par[at.ETA] > 0.0:
            return at.OPEN, s, balance
    # it sticks if the moment can hold it
    switch(T, True, z, v, z_x, v_x)
    value = dot(row, z_x) + dot(row_v, v_x) + par[at.R_A] * along(F, 6, x)
    if gap(par, at.CONTACT, s, False, value, along(F, 9, x)) <= 0.0:
        return at.OPEN, s if par[at.ETA] == 0.0 and dot(v, v) == 0.0 else -s, balance
    lost = energy(par, at.OPEN, lam, bu, th, z, v)
    lost -= energy(par, at.CONTACT, lam_c, bu_c, th_c, z_x, v_x)
    if not reported:
        out[at.LANDING_LOSS] += lost
        out[at.CAPTURES] += 1
        balance -= lost
    for m in range(len(z)):
        z[m], v[m] = z_x[m], v_x[m]
    return at.CONTACT, s, balance


@jit
def reset(par, modes, T, phase, s, armed, t, x, F, reported, z, v, work, landings, balance, out):
    """What a guard at x of a step makes of the state: (phase, side, whether eta is armed, balance)."""
    th, winkler, z_x, v_x = modes[at.TURN, phase], par[at.THETA_1] > 0.0, work[2], work[3]
    if phase == at.CONTACT and winkler and armed and s * dot(th, z) < 0.0:
        balance -= struck(par, t, th, v, reported, landings, out)
        return phase, -s, False, balance
    if phase == at.CONTACT:
        s = opened(par, modes, T, t, x, F, z, v, z_x, v_x, out)
        return at.OPEN, s, armed and winkler, balance
    if winkler:
        switch(T, True, z, v, z_x, v_x)
        for m in range(len(z)):
            z[m], v[m] = z_x[m], v_x[m]
        return at.CONTACT, s, armed, balance
    phase, s, balance = came_back(par, modes, T, s, t, x, F, armed, reported, z, v, z_x, v_x, landings, balance, out)
    return phase, s, False, balance


@jit
def fallen(par, t, theta, reported, out):
    """Whether the column lies on the ground; noted if so."""
    falls = abs(theta) >= FALLEN
    if falls:
        out[at.VERDICT], out[at.PEAK_SIDE] = FALLS, 1.0 if theta > 0.0 else -1.0
        if not reported:
            out[at.T_END] = par[at.T_STOP] if par[at.HAS_DURATION] > 0.0 else t
    return falls


@entry(
    VECTOR, CUBE, MATRIX, VECTOR, VECTOR, int, Channel, VECTOR, Channel, VECTOR, float, MATRIX, MATRIX, VECTOR,
    (TABLES, CUBE, MATRIX, MATRIX, TABLES, MATRIX, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR),
)  # fmt: skip
def march(
    par, modes, T, z, v, max_steps, horizontal, h_data, vertical, v_data, dt_out, hist, landings, out, space
):  # fmt: skip
    """Solve one case.

    modes (7, 2, N), second index the phase: lam, c, components along uniform load, base rotation and top, and the two
    rows of the guard; T (N, N) takes contact modes to open ones.  z, v the state at 0.  hist (4, k): theta, its rate,
    bending at the top over L, base moment; landings (3, j): time, rate before, after.  space: `WORK_SPACE`, of which
    some is kept for further cases of the same column.
    """
    tables, influences, keys, used, paces, filled, work, S, F, A, about, found = space
    z_1, v_1, z_x, v_x, peaks = work[0], work[1], work[2], work[3], out[at.PEAK : at.U_PEAK + 1]
    kept, channels = (tables, influences, keys, used), (horizontal, vertical)
    phase, s, armed = int(par[at.PHASE_0]), par[at.SIDE_0], par[at.PHASE_0] == at.OPEN
    ih = iv = i_hist = clock = stuck = 0
    t, t_stop, reported = 0.0, par[at.T_STOP], False
    balance = begin(par, modes, phase, s, z, v, out)
    while True:
        clock += 1
        if clock > max_steps:
            out[at.STATUS] = OUT_OF_STEPS
            break
        ih = piece_at(horizontal, h_data, ih, t * (1.0 + 1e-14))
        iv = piece_at(vertical, v_data, iv, t * (1.0 + 1e-14))
        th, known = modes[at.TURN, phase], (paces[phase], filled[phase])
        if t >= t_stop and not reported:
            reported, out[at.T_END] = True, t_stop
            balance -= energy(par, phase, modes[at.LAM, phase], modes[at.UNIFORM, phase], th, z, v)
        if t >= par[at.T_MOTION] and ended(par, modes, phase, s, t, reported, F, z, v, found, out):
            break

        t_next, lands, wanted = span(par, phase, th, t, horizontal, h_data, ih, vertical, v_data, iv, S, z, v)
        h, converged = take_step(
            par, modes, phase, s, t, wanted, clock, channels, ih, h_data, iv, v_data, kept, A, F, S, z, v, work, out
        )  # fmt: skip
        if not converged:
            out[at.STATUS] = NOT_FINITE
            break
        x, event, bound = guards(par, modes, phase, s, armed, F, h, z, v, known, work, about, S, found)
        theta, theta_1 = dot(th, z), dot(th, z_1)
        if abs(theta_1) >= FALLEN:
            x, lands = passage(modes, phase, F, x, FALLEN, z, v, work, S), False
            for m in range(len(z)):
                z_1[m], v_1[m] = z_x[m], v_x[m]
            theta_1 = dot(th, z_1)

        i_hist = write(par, modes, phase, s, F, x, t, dt_out, i_hist, z, v, work, S, hist)
        if not reported or par[at.HAS_DURATION] == 0.0:
            note_extremes(par, modes, phase, F, x, t, theta, bound, z, v, known, work, about, S, found, peaks)
        if not armed and phase == at.OPEN and abs(theta) + bound.stray > par[at.REARM]:
            armed = rearms(par, modes, F, x, t, theta_1, bound, z, v, known, work, about, S)
        if abs(theta) < par[at.THETA_STAR] <= abs(theta_1):
            out[at.T_OVERTURN] = t + passage(modes, phase, F, x, par[at.THETA_STAR], z, v, work, S)
        if par[at.DETAIL] > 0.0 and t < par[at.T_MOTION] and not reported:
            balance = add_work(par, modes, phase, s, F, x, theta, theta_1, z, v, work, S, balance)

        t = t_next if lands and h == wanted and not event else t + x
        for m in range(len(z)):
            z[m], v[m] = z_1[m], v_1[m]
        if not math.isfinite(theta_1 + dot(modes[at.TOP, phase], z)):
            out[at.STATUS] = NOT_FINITE
            break
        if fallen(par, t, theta_1, reported, out):
            break
        stuck = stuck + 1 if event and x < 1e-13 * (t + h) else 0
        if stuck > 200:
            out[at.STATUS] = OUT_OF_STEPS
            break
        if event:
            phase, s, armed, balance = reset(
                par, modes, T, phase, s, armed, t, x, F, reported, z, v, work, landings, balance, out
            )  # fmt: skip

    if not reported:
        balance -= energy(par, phase, modes[at.LAM, phase], modes[at.UNIFORM, phase], modes[at.TURN, phase], z, v)
    out[at.N_STEPS], out[at.ENERGY] = clock, balance
