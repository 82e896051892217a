"""The flexible rocking column as a hybrid automaton: flow, guard, reset, mode (docs/flexible.md).

Phases: CONTACT (rigid base: held, a cantilever; Winkler base: full contact) and OPEN (rocking on edge s).  In
each the deformation is a sum of modes, advanced exactly; steps land on the breakpoints of the motion.
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, TABLES, VECTOR
from rockcli.kernels.column import layout as at
from rockcli.kernels.column.events import drop, first_event, look, note, note_peaks
from rockcli.kernels.column.law import (
    along,
    base_moment,
    contact_moment,
    dot,
    energy,
    gap,
    ground,
    ground_loads,
    limit,
    opens_at,
    step,
    work_of,
)
from rockcli.kernels.column.oscillator import advance, fill, wander
from rockcli.kernels.constants import FALLS, FAST, NOT_FINITE, NOT_YET, OUT_OF_STEPS, RETURNS, UNDECIDED
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
def passage(mode, F, x, angle, S, z, v, z_x, v_x):
    """When |theta| passes an angle in a step of x that ends beyond it; the state there is left in z_x, v_x."""
    lam, c, bu, th, _, _, _ = mode
    below, beyond = 0.0, x
    for _ in range(50):
        half = 0.5 * (below + beyond)
        advance(lam, c, bu, th, F, half, S, z, v, z_x, v_x)
        if abs(dot(th, z_x)) < angle:
            below = half
        else:
            beyond = half
    advance(lam, c, bu, th, F, beyond, S, z, v, z_x, v_x)
    return beyond


@jit
def write(par, phase, s, mode, F, x, t, t_end, dt_out, i_hist, S, z, v, z_x, v_x, hist):
    """Histories at output times in [t, t + x]; returns the next index."""
    lam, c, bu, th, top, row, row_v = mode
    while i_hist < hist.shape[1] and i_hist * dt_out <= min(t + x, t_end) * (1.0 + 1e-9):
        y = min(max(i_hist * dt_out - t, 0.0), x)
        advance(lam, c, bu, th, F, y, S, z, v, z_x, v_x)
        theta = dot(th, z_x)
        hist[0, i_hist], hist[1, i_hist] = theta, dot(th, v_x)
        hist[2, i_hist] = dot(top, z_x) - theta
        if phase == at.OPEN:
            hist[3, i_hist] = base_moment(par, s, theta, along(F, 9, y))
        elif par[at.THETA_1] > 0.0:
            hist[3, i_hist] = contact_moment(par, theta)
        else:
            hist[3, i_hist] = -(dot(row, z_x) + dot(row_v, v_x) + par[at.R_A] * along(F, 6, y))
        i_hist += 1
    return i_hist


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
    lams, cs, bus, ths, tops, rows, rows_v = modes[0], modes[1], modes[2], modes[3], modes[4], modes[5], modes[6]
    tables, influences, keys, used, paces, filled, work, S, F, A, about, found = space
    for i in range(at.N_OUT):
        out[i] = 0.0
    out[at.T_PEAK] = out[at.T_UPLIFT] = out[at.T_OVERTURN] = math.nan
    z_1, v_1, z_x, v_x, room, peaks = work[0], work[1], work[2], work[3], work[4:8], out[at.PEAK : at.U_PEAK + 1]
    ends = (z, v, z_1, v_1)
    phase, s, armed = int(par[at.PHASE_0]), par[at.SIDE_0], par[at.PHASE_0] == at.OPEN
    winkler = par[at.THETA_1] > 0.0
    t, t_motion, t_stop = 0.0, par[at.T_MOTION], par[at.T_STOP]
    ih = iv = i_hist = clock = stuck = 0
    balance = energy(par, phase, lams[phase], bus[phase], ths[phase], z, v)
    if phase == at.OPEN:
        out[at.T_UPLIFT] = 0.0
        out[at.PEAK], out[at.PEAK_SIDE], out[at.T_PEAK] = abs(dot(ths[at.OPEN], z)), s, 0.0
    verdict, shown = NOT_YET, -1
    reported = False
    while True:
        clock += 1
        if clock > max_steps:
            out[at.STATUS] = OUT_OF_STEPS
            break
        ih = piece_at(horizontal, h_data, ih, t * (1.0 + 1e-14))
        iv = piece_at(vertical, v_data, iv, t * (1.0 + 1e-14))
        after = t >= t_motion
        if phase != shown:
            shown = phase
            lam, c, bu, th, top = lams[phase], cs[phase], bus[phase], ths[phase], tops[phase]
            row, row_v, known = rows[phase], rows_v[phase], (paces[phase], filled[phase])
            mode = (lam, c, bu, th, top, row, row_v)
        if t >= t_stop and not reported:
            reported = True
            out[at.T_END] = t_stop
            balance -= energy(par, phase, lam, bu, th, z, v)
        if after:
            e = energy(par, phase, lam, bu, th, z, v) if t >= t_stop else math.inf
            if t >= t_stop and e < par[at.BARRIER] * (1.0 - 1e-9) and abs(dot(th, z)) < par[at.THETA_STAR]:
                verdict = RETURNS
                break
            if phase == at.CONTACT:
                for k in range(12):
                    F[k] = 0.0
                wander(lam, c, bu, th, F, 1e9, z, v, row, row_v, math.inf, math.inf, found)
                if 0.5 * found[0] < 1e-3 * limit(par, phase, s, 0.0):
                    verdict = RETURNS
                    if not reported:
                        out[at.T_END] = t_stop if par[at.HAS_DURATION] > 0.0 else t
                    break
            if t >= t_stop + par[at.GIVE_UP]:
                verdict = UNDECIDED
                break

        # the step
        t_next = t_motion if not after else (t_stop if t < t_stop else math.inf)
        if not after:
            t_next = min(t_next, smooth_until(horizontal, h_data, ih, t), smooth_until(vertical, v_data, iv, t))
        h = par[at.H_FREE] if after else par[at.H_MAX]
        if winkler and phase == at.OPEN:
            a_v = ground(vertical, v_data, par[at.FACTOR_V], iv, t, t_motion, S) if not after else 0.0
            edge = opens_at(par, a_v)
            q = max(abs(dot(th, z)), edge, 0.1 * par[at.THETA_1])
            stiff = (
                par[at.G]
                * par[at.WIDTH]
                / (par[at.LENGTH] * par[at.LENGTH] * 3.0 * par[at.THETA_1])
                * min(max(edge, par[at.THETA_1]) / q, 1.0) ** 1.5
            )
            fine, rate = par[at.FINENESS], abs(dot(th, v))
            while h * h * stiff * par[at.MOBILITY] > 0.1 * fine * fine or h * rate > 0.3 * fine * q:
                h *= 0.5
        lands = t_next - t <= h * (1.0 + 1e-9)
        h = rounded(t_next - t if lands else h)
        A[0], A[3] = 0.0, 0.0
        converged = False
        while True:
            for k in range(3):
                x = t + 0.5 * h * k
                A[k] = ground(horizontal, h_data, par[at.FACTOR_H], ih, x, t_motion, S) if not after else 0.0
                A[3 + k] = ground(vertical, v_data, par[at.FACTOR_V], iv, x, t_motion, S) if not after else 0.0
            slot, ready = slot_of(keys[phase], used[phase], clock, h)
            table, influence = tables[phase, slot], influences[phase, slot]
            if not ready:
                fill(lam, c, bu, th, h, S, table, influence)
            evaluated = step(par, phase, s, lam, bu, th, h, table, influence, A, z, v, z_1, v_1, F)
            out[at.N_RHS] += abs(evaluated)
            converged = evaluated > 0
            if converged or h < 1e-9 * par[at.H_MAX]:
                break
            h *= 0.5
            lands = False
        if not converged:
            out[at.STATUS] = NOT_FINITE
            break

        # the guard
        # a mode too weak to matter at this accuracy does not set how densely the step is looked at
        weak = 1e-5 if par[at.FINENESS] >= 1.0 else (1e-7 if par[at.FINENESS] >= 0.5 else 1e-9)
        floor = weak * (limit(par, at.CONTACT, s, 0.0) if phase == at.CONTACT else par[at.ALPHA])
        near, _ = look(par, phase, s, armed, lam, c, bu, th, row, row_v, F, 0.0, z, v)
        floor_rate = math.sqrt(weak) * par[at.P] * par[at.ALPHA]
        fall = drop(par, phase, lam, c, bu, th, row, row_v, F, h, z, v, floor, floor_rate, found)
        stray, omega, swing, omega_rate = found[0], found[1], found[2], found[3]
        x, event = h, False
        if near <= fall:
            y = first_event(par, phase, s, armed, mode, F, h, ends, floor, known, room, about, S, found, z_x, v_x)
            if y >= 0.0:
                event, x = True, y
                for m in range(len(z)):
                    z_1[m], v_1[m] = z_x[m], v_x[m]
        if abs(dot(th, z_1)) >= FALLEN:
            x, lands = passage(mode, F, x, FALLEN, S, z, v, z_x, v_x), False
            for m in range(len(z)):
                z_1[m], v_1[m] = z_x[m], v_x[m]
        i_hist = write(par, phase, s, mode, F, x, t, t_stop, dt_out, i_hist, S, z, v, z_x, v_x, hist)

        # what is read off
        theta_0, theta_1, rate_0, rate_1 = dot(th, z), dot(th, z_1), dot(th, v), dot(th, v_1)
        turning = phase == at.OPEN or winkler  # whether the base can turn
        if not reported or par[at.HAS_DURATION] == 0.0:
            turns, sways = rate_0 * rate_1 <= 0.0, dot(top, v) * dot(top, v_1) <= 0.0
            long = omega * x > 1.0  # the ends do not tell: may the rates vanish in between?
            turns = turns or (long and abs(rate_0) <= swing)
            seen = turning and turns and abs(theta_0) + stray > out[at.PEAK]
            quick = turning and abs(rate_0) + swing > out[at.RATE_PEAK]
            if seen or sways or long:
                wander(lam, c, bu, th, F, x, z, v, top, rows_v[at.OPEN], weak * par[at.ALPHA], math.inf, found)
                sways = sways or (long and abs(dot(top, v)) <= found[2])
                seen = seen or (sways and 1.1 * par[at.LENGTH] * (abs(dot(top, z)) + found[0]) > out[at.U_PEAK])
            if seen or quick:
                fast = max(found[1] if seen else 0.0, omega_rate if quick else 0.0)
                note_peaks(par, mode, F, x, fast, seen, t, ends, known, room, about, S, z_x, v_x, peaks)
            else:
                note(par, th, top, t + x, z_1, v_1, peaks)
        if not armed and phase == at.OPEN and abs(theta_0) + stray > par[at.REARM]:
            armed = abs(theta_1) > par[at.REARM]
            if not armed:
                # it may have been beyond and come back
                highest = about[12:17]
                highest[0] = 0.0
                note_peaks(par, mode, F, x, omega, True, t, ends, known, room, about, S, z_x, v_x, highest)
                armed = highest[0] > par[at.REARM]
        if abs(theta_0) < par[at.THETA_STAR] <= abs(theta_1):
            out[at.T_OVERTURN] = t + passage(mode, F, x, par[at.THETA_STAR], S, z, v, z_x, v_x)
        if par[at.DETAIL] > 0.0 and not after and not reported:
            # work of the ground: its part of the loads, along the quartic of the step
            advance(lam, c, bu, th, F, 0.5 * x, S, z, v, z_x, v_x)
            theta_b = dot(th, z_x)
            y_0, y_b, y_1 = dot(bu, z), dot(bu, z_x), dot(bu, z_1)
            ground_loads(par, phase, s, theta_0, theta_b, theta_1, y_0, y_b, y_1, x, F)
            balance += work_of(F, 12, x, y_0, y_b, y_1, dot(bu, v), dot(bu, v_1))
            balance += work_of(F, 15, x, theta_0, theta_b, theta_1, rate_0, rate_1)
        t = t_next if lands and not event else t + x
        for m in range(len(z)):
            z[m], v[m] = z_1[m], v_1[m]
        if not math.isfinite(theta_1 + dot(top, z_1)):
            out[at.STATUS] = NOT_FINITE
            break
        if abs(theta_1) >= FALLEN:
            verdict = FALLS
            out[at.PEAK_SIDE] = 1.0 if theta_1 > 0.0 else -1.0
            if not reported:
                out[at.T_END] = t_stop if par[at.HAS_DURATION] > 0.0 else t
            break
        stuck = stuck + 1 if event and x < 1e-13 * (t + h) else 0
        if stuck > 200:
            out[at.STATUS] = OUT_OF_STEPS
            break
        if not event:
            continue

        # the reset
        if phase == at.CONTACT:
            if winkler and armed and s * theta_1 < 0.0:
                lost = 0.5 * (1.0 - par[at.ETA] * par[at.ETA]) * dot(v, v)
                _land(par, t, rate_1, reported, landings, out)
                balance -= 0.0 if reported else lost
                for m in range(len(v)):
                    v[m] *= par[at.ETA]
                armed, s = False, -s
                continue
            value = dot(row, z) + dot(row_v, v) + par[at.R_A] * along(F, 6, x)
            s = (1.0 if theta_1 > 0.0 else -1.0) if winkler else (-1.0 if value > 0.0 else 1.0)
            switch(T, False, z, v, z_x, v_x)
            phase = at.OPEN
            if not winkler:
                armed = False
            if math.isnan(out[at.T_UPLIFT]):
                out[at.T_UPLIFT] = t
        elif winkler:
            switch(T, True, z, v, z_x, v_x)
            phase = at.CONTACT
        else:
            if armed:
                lost = 0.5 * (1.0 - par[at.ETA] * par[at.ETA]) * dot(v, v)
                _land(par, t, rate_1, reported, landings, out)
                balance -= 0.0 if reported else lost
                for m in range(len(v)):
                    v[m] *= par[at.ETA]
                armed = False
                s = -s
                if par[at.ETA] > 0.0:
                    continue
            # the base comes back: it sticks if the moment can hold it
            switch(T, True, z, v, z_x, v_x)
            value = dot(rows[at.CONTACT], z_x) + dot(rows_v[at.CONTACT], v_x) + par[at.R_A] * along(F, 6, x)
            if gap(par, at.CONTACT, s, False, value, along(F, 9, x)) <= 0.0:
                s = s if par[at.ETA] == 0.0 and dot(v, v) == 0.0 else -s
                continue
            lost = energy(par, at.OPEN, lam, bu, th, z, v)
            lost -= energy(par, at.CONTACT, lams[at.CONTACT], bus[at.CONTACT], ths[at.CONTACT], z_x, v_x)
            if not reported:
                out[at.LANDING_LOSS] += lost
                out[at.CAPTURES] += 1
                balance -= lost
            phase = at.CONTACT
        for m in range(len(z)):
            z[m], v[m] = z_x[m], v_x[m]

    if verdict != NOT_YET:
        out[at.VERDICT] = verdict
    if not reported:
        balance -= energy(par, phase, lams[phase], bus[phase], ths[phase], z, v)
    out[at.N_STEPS] = clock
    out[at.ENERGY] = balance


@jit
def _land(par, t, rate, reported, landings, out):
    """Count and store a landing."""
    if abs(rate) > FAST * par[at.P] * par[at.ALPHA]:
        out[at.STRUCK_LATER if reported else at.N_LANDINGS] += 1
    if reported:
        return
    k = int(out[at.N_STORED])
    if k < landings.shape[1]:
        landings[0, k], landings[1, k], landings[2, k] = t, rate, par[at.ETA] * rate
        out[at.N_STORED] += 1
