"""What is read off a step of the flexible column: histories, extremes, impacts, work (docs/flexible.md)."""

from __future__ import annotations

import math

from rockcli.kernels.column import layout as at
from rockcli.kernels.column.events import matters, mode_of, note, note_peaks
from rockcli.kernels.column.law import along, base_moment, contact_moment, dot, ground_loads, work_of
from rockcli.kernels.column.oscillator import advance, wander
from rockcli.kernels.constants import FAST
from rockcli.kernels.jit import jit


@jit
def passage(modes, phase, F, x, angle, z, v, work, S):
    """When |theta| passes an angle in a step of x that ends beyond it; rows 2, 3 of `work` hold the state there."""
    lam, c, bu, th, _, _, _ = mode_of(modes, phase)
    z_x, v_x = work[2], work[3]
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
def write(par, modes, phase, s, F, x, t, dt_out, i_hist, z, v, work, S, hist):
    """Histories at output times in [t, t + x]; returns the next index."""
    lam, c, bu, th, top, row, row_v = mode_of(modes, phase)
    z_x, v_x = work[2], work[3]
    while i_hist < hist.shape[1] and i_hist * dt_out <= min(t + x, par[at.T_STOP]) * (1.0 + 1e-9):
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


@jit
def note_extremes(par, modes, phase, F, x, t, theta, bound, z, v, known, work, about, S, found, peaks):
    """Raise the peaks to those of a step of x: by its ends, and walked where they may be larger in between."""
    mode, z_1, v_1 = mode_of(modes, phase), work[0], work[1]
    lam, c, bu, th, top, _, _ = mode
    rate = dot(th, v)
    turning = phase == at.OPEN or par[at.THETA_1] > 0.0  # whether the base can turn
    turns, sways = rate * dot(th, v_1) <= 0.0, dot(top, v) * dot(top, v_1) <= 0.0
    long = bound.omega * x > 1.0  # the ends do not tell: may the rates vanish in between?
    turns = turns or (long and abs(rate) <= bound.swing)
    seen = turning and turns and abs(theta) + bound.stray > peaks[0]
    quick = turning and abs(rate) + bound.swing > peaks[3]
    if seen or sways or long:
        wander(
            lam, c, bu, th, F, x, z, v, top, modes[at.ROW_RATE, at.OPEN], matters(par) * par[at.ALPHA], math.inf, found
        )
        sways = sways or (long and abs(dot(top, v)) <= found[2])
        seen = seen or (sways and 1.1 * par[at.LENGTH] * (abs(dot(top, z)) + found[0]) > peaks[4])
    if seen or quick:
        fast = max(found[1] if seen else 0.0, bound.omega_swing if quick else 0.0)
        ends = (z, v, z_1, v_1)
        note_peaks(par, mode, F, x, fast, seen, t, ends, known, work[4:8], about, S, work[2], work[3], peaks)
    else:
        note(par, th, top, t + x, z_1, v_1, peaks)


@jit
def rearms(par, modes, F, x, t, theta_1, bound, z, v, known, work, about, S):
    """Whether an open base goes beyond where eta is armed again, be it for a moment within a step of x."""
    if abs(theta_1) > par[at.REARM]:
        return True
    highest, ends = about[12:17], (z, v, work[0], work[1])
    highest[0] = 0.0
    note_peaks(
        par, mode_of(modes, at.OPEN), F, x, bound.omega, True, t, ends, known, work[4:8], about, S, work[2], work[3],
        highest,
    )  # fmt: skip
    return highest[0] > par[at.REARM]


@jit
def add_work(par, modes, phase, s, F, x, theta_0, theta_1, z, v, work, S, balance):
    """The balance with the work of the ground in a step of x: its part of the loads, along the quartic of the step."""
    lam, c, bu, th, _, _, _ = mode_of(modes, phase)
    z_1, v_1, z_x, v_x = work[0], work[1], work[2], work[3]
    advance(lam, c, bu, th, F, 0.5 * x, S, z, v, z_x, v_x)
    theta_b = dot(th, z_x)
    y_0, y_b, y_1 = dot(bu, z), dot(bu, z_x), dot(bu, z_1)
    ground_loads(par, phase, s, theta_0, theta_b, theta_1, y_0, y_b, y_1, x, F)
    balance += work_of(F, 12, x, y_0, y_b, y_1, dot(bu, v), dot(bu, v_1))
    balance += work_of(F, 15, x, theta_0, theta_b, theta_1, dot(th, v), dot(th, v_1))
    return balance


@jit
def note_landing(par, t, rate, reported, landings, out):
    """Count and store a landing."""
    if abs(rate) > FAST * par[at.P] * par[at.ALPHA]:
        out[at.STRUCK_LATER if reported else at.N_LANDINGS] += 1
    if reported:
        return
    k = int(out[at.N_STORED])
    if k < landings.shape[1]:
        landings[0, k], landings[1, k], landings[2, k] = t, rate, par[at.ETA] * rate
        out[at.N_STORED] += 1
