"""What is read off a step of the frame: energy, work, peaks, impacts, histories (docs/frame.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import UNDECIDED
from rockcli.kernels.frame import layout as at
from rockcli.kernels.frame.banded import copy, times
from rockcli.kernels.frame.elements import base_moment, spring
from rockcli.kernels.frame.newmark import load
from rockcli.kernels.jit import jit


@jit
def kinetic(mass, v, work):
    """Kinetic energy [J]."""
    times(mass, v, work[at.INERTIA])
    total = 0.0
    for i in range(len(v)):
        total += 0.5 * v[i] * work[at.INERTIA, i]
    return total


@jit
def note(par, u, v, factor, fibres, row):
    """Write a row of the history."""
    top = len(u) - 3
    row[at.TH], row[at.RATE], row[at.U_TOP], row[at.V_TOP] = u[2], v[2], u[top], u[top + 1]
    row[at.U_BENDING] = u[top] - par[at.LENGTH] * (top // 3) * math.sin(u[2])
    row[at.MOMENT] = base_moment(par, u, factor, fibres)


@jit
def record(par, t, h, old, new, history, written):
    """Write the output times in (t, t + h], linear between the rows old and new; return how many are written."""
    while written < len(history) and written * par[at.DT_OUT] <= t + h * (1.0 + 1e-9):
        x = min(1.0, (written * par[at.DT_OUT] - t) / h)
        for k in range(len(old)):
            history[written, k] = old[k] + x * (new[k] - old[k])
        written += 1
    return written


@jit
def add_work(par, damped, pull, weights, a_g, a_v, u, work, worked, lost):
    """Add the work of the ground, at these accelerations, and of the dampers over a step: (worked, lost) [J]."""
    load(par, pull, weights, a_g, a_v, work[at.LOAD])
    u_old = work[at.BEFORE]
    for k in range(len(u)):
        weight = par[at.G] * weights[k] if par[at.GRAVITY] > 0.0 else 0.0
        worked += (work[at.LOAD, k] + weight) * (u[k] - u_old[k])
        if damped:
            lost += work[at.DRAG, k] * (u[k] - u_old[k])
    if a_v != 0.0 and par[at.BASE] != at.FIBRES:  # those carry the weight itself, whose work is counted
        middle = 0.5 * (u[2] + u_old[2])
        M, _ = spring(par, middle, 1.0 + a_v / par[at.G])
        at_rest, _ = spring(par, middle, 1.0)
        worked -= (M - at_rest) * (u[2] - u_old[2])
    return worked, lost


@jit
def opened(par, u, a_v):
    """Whether an edge is lifted; on fibres, where the base moves up and down, the higher corner tells."""
    if par[at.BASE] == at.FIBRES:
        return u[1] + par[at.HALF_WIDTH] * abs(u[2]) > par[at.TOLERANCE] * par[at.REACH]
    carried = max(1.0 + a_v / par[at.G], 0.0) if par[at.BASE] == at.WINKLER else 1.0
    return abs(u[2]) > par[at.UPLIFT] * carried


@jit
def note_start(par, a_v, u, v, out):
    """Results of the state to begin with, whose accelerations took one residual."""
    out[at.VERDICT], out[at.N_RHS] = UNDECIDED, 1.0
    moving = abs(u[2]) > 0.0 or abs(v[2]) > 0.0
    yields = par[at.BASE] == at.WINKLER or par[at.BASE] == at.FIBRES
    begins = opened(par, u, a_v) if yields else moving  # such a base turns in full contact too
    out[at.T_UPLIFT] = 0.0 if begins else math.nan
    out[at.T_PEAK] = out[at.T_OVERTURN] = out[at.T_END] = math.nan
    out[at.PEAK], out[at.PEAK_SIDE] = abs(u[2]), 1.0 if u[2] >= 0.0 else -1.0
    if moving:
        out[at.T_PEAK], out[at.RATE_PEAK], out[at.TOP_PEAK] = 0.0, abs(v[2]), abs(u[len(u) - 3])


@jit
def note_end_of_step(par, fibres, a_v, t, h, q_old, u, v, rows, history, written, out):
    """Note uplift, overturning, peaks by the end of a step, t + h; write the history up to there, return its length."""
    now, theta, q = t + h, u[2], abs(u[2])
    if math.isnan(out[at.T_UPLIFT]) and opened(par, u, a_v):
        out[at.T_UPLIFT] = now
    if q_old < par[at.Q_STAR] <= q:
        out[at.T_OVERTURN] = now
    reported = now <= par[at.T_STOP] + 0.5 * h
    if reported or t < par[at.T_STOP]:
        copy(rows[1], rows[0])
        note(par, u, v, 1.0 + a_v / par[at.G], fibres, rows[1])
        written = record(par, t, h, rows[0], rows[1], history, written)
    if reported:
        out[at.RATE_PEAK] = max(out[at.RATE_PEAK], abs(v[2]))
    if reported or par[at.OWN_DURATION] == 0.0:
        if q > out[at.PEAK]:
            out[at.PEAK], out[at.PEAK_SIDE], out[at.T_PEAK] = q, 1.0 if theta > 0.0 else -1.0, now
        out[at.TOP_PEAK] = max(out[at.TOP_PEAK], abs(u[len(u) - 3]))
    return written
