"""A case of the frame backend from its beginning to its outcome (docs/frame.md)."""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.kernels.frame import layout as at
from rockcli.kernels.frame.banded import clear, copy, times
from rockcli.kernels.frame.elements import base_moment, damping, spring, stored_energy
from rockcli.kernels.frame.newmark import accelerate, load, settle, step
from rockcli.kernels.jit import entry, jit

DIVISIONS = 4
"""A step that does not converge is divided by ten, up to this many times over."""

UNITS = 10**DIVISIONS
"""Parts of a step that its shortest division is one of."""

LOOK = 20
"""Steps between looks at the energy once the motion is over."""


@jit
def between(values, i, part):
    """Value at the fraction `part` of step i; zero after the last."""
    if i + 1 >= len(values):
        return 0.0
    return values[i] + part * (values[i + 1] - values[i])


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


@entry(
    VECTOR, int, MATRIX, VECTOR, VECTOR, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, CUBE, MATRIX, MATRIX,
    MATRIX, MATRIX, VECTOR,
)  # fmt: skip
def run(par, n, mass, pull, weights, fibres, a_g, a_v, u, v, a, work, bands, B, rows, history, impacts, out):
    """Solve one case.

    Args:
        par: numbers of the case (frame_layout); n: elements; mass: (N, 6) band.
        pull: forces per unit of -a_g, (N,); weights: masses that feel gravity, at the vertical freedoms, (N,).
        fibres: (k, 2) place [m] and stiffness [N/m]; a_g, a_v: ground accelerations at i dt, up to the motion's end.
        u, v: state to begin with, (N,), overwritten; a: (N,); work, bands, B: work space (frame_steps).
        rows: (2, N_HISTORY) work space; history: (k, N_HISTORY), written up to T_END; impacts: (j, 3).
        out: results (frame_layout).
    """
    upright = work[at.UPRIGHT]
    clear(upright)
    if not settle(par, n, pull, weights, fibres, upright, work, bands, B):
        out[at.STATUS] = at.NO_STATICS
        return
    bottom = stored_energy(par, upright, n, weights, fibres, B)
    if not settle(par, n, pull, weights, fibres, u, work, bands, B):
        out[at.STATUS] = at.NO_STATICS
        return
    damped = par[at.DASHPOT] > 0.0 or par[at.STIFF_DAMPING] > 0.0
    damping(par, u, n, bands[at.DAMPING], B)
    accelerate(par, n, mass, damped, pull, weights, fibres, a_g[0], a_v[0], u, v, a, work, bands, B)
    out[at.N_RHS] = 1.0
    begun = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work)
    worked = lost = 0.0

    moving = abs(u[2]) > 0.0 or abs(v[2]) > 0.0
    out[at.T_UPLIFT] = 0.0 if moving else math.nan
    out[at.T_PEAK] = out[at.T_OVERTURN] = out[at.T_END] = math.nan
    out[at.PEAK], out[at.PEAK_SIDE] = abs(u[2]), 1.0 if u[2] >= 0.0 else -1.0
    if moving:
        out[at.T_PEAK], out[at.RATE_PEAK], out[at.TOP_PEAK] = 0.0, abs(v[2]), abs(u[len(u) - 3])
    side = 1.0 if u[2] >= 0.0 else -1.0
    armed = abs(u[2]) > par[at.REARM]
    old, new = rows[0], rows[1]
    note(par, u, v, 1.0 + a_v[0] / par[at.G], fibres, new)
    written = record(par, -par[at.DT], par[at.DT], new, new, history, 0)
    out[at.VERDICT] = UNDECIDED
    u_old = work[at.BEFORE]

    i, position, units = 0, 0, UNITS
    while True:
        t, h = (i + position / UNITS) * par[at.DT], par[at.DT] * units / UNITS
        part = (position + par[at.ALPHA_D] * units) / UNITS
        if par[at.STIFF_DAMPING] > 0.0:
            damping(par, u, n, bands[at.DAMPING], B)
        copy(u, u_old)
        q_old, rate_old = abs(u[2]), v[2]
        up = between(a_v, i, part)
        iterations = step(
            par, n, mass, damped, pull, weights, fibres, h, between(a_g, i, part), up, u, v, a, work, bands, B
        )
        out[at.N_RHS] += abs(iterations)
        if iterations < 0:
            out[at.CUTS] += 1.0
            units //= 10
            if units == 0:
                out[at.STATUS], out[at.T_END] = at.NO_CONVERGENCE, t
                return
            continue
        out[at.ITERATIONS] += iterations
        out[at.N_STEPS] += 1.0
        position += units
        now = t + h
        theta, q = u[2], abs(u[2])
        end_g, end_v = between(a_g, i, position / UNITS), between(a_v, i, position / UNITS)

        # work of the ground and of the dampers over the step
        middle_g, middle_v = between(a_g, i, part), between(a_v, i, part)
        if par[at.ALPHA_D] == 1.0:
            middle_g = 0.5 * (between(a_g, i, (position - units) / UNITS) + end_g)
            middle_v = 0.5 * (between(a_v, i, (position - units) / UNITS) + end_v)
        load(par, pull, weights, middle_g, middle_v, work[at.LOAD])
        for k in range(len(u)):
            weight = par[at.G] * weights[k] if par[at.GRAVITY] > 0.0 else 0.0
            worked += (work[at.LOAD, k] + weight) * (u[k] - u_old[k])
            if damped:
                lost += work[at.DRAG, k] * (u[k] - u_old[k])
        if middle_v != 0.0 and par[at.BASE] != at.FIBRES:  # those carry the weight itself, whose work is counted
            middle = 0.5 * (theta + u_old[2])
            M, _ = spring(par, middle, 1.0 + middle_v / par[at.G])
            at_rest, _ = spring(par, middle, 1.0)
            worked -= (M - at_rest) * (theta - u_old[2])

        opens = par[at.UPLIFT]
        if par[at.BASE] == at.WINKLER or par[at.BASE] == at.FIBRES:  # by the weight it carries
            opens *= max(1.0 + end_v / par[at.G], 0.0)
        if math.isnan(out[at.T_UPLIFT]) and q > opens:
            out[at.T_UPLIFT] = now
        if q_old < par[at.Q_STAR] <= q:
            out[at.T_OVERTURN] = now

        if armed and side * theta <= 0.0:  # a landing
            armed = False
            before = 0.5 * (rate_old + v[2])
            eta = par[at.ETA_RIGHT] if theta > 0.0 else par[at.ETA_LEFT]
            if eta < 1.0:
                lost += (1.0 - eta * eta) * kinetic(mass, v, work)
                for k in range(len(v)):
                    v[k] *= eta
                accelerate(par, n, mass, damped, pull, weights, fibres, end_g, end_v, u, v, a, work, bands, B)
                out[at.N_RHS] += 1.0
            if now > par[at.T_STOP]:
                out[at.STRUCK_LATER] = 1.0
            if abs(before) > par[at.FAST] and now <= par[at.T_STOP]:
                stored = int(out[at.N_IMPACTS])
                if stored < len(impacts):
                    impacts[stored, 0], impacts[stored, 1], impacts[stored, 2] = now, before, eta * before
                    out[at.N_STORED] = stored + 1.0
                out[at.N_IMPACTS] += 1.0
        if q > par[at.REARM]:
            armed, side = True, 1.0 if theta > 0.0 else -1.0

        if now <= par[at.T_STOP] + 0.5 * h:
            for k in range(len(old)):
                old[k] = new[k]
            note(par, u, v, 1.0 + end_v / par[at.G], fibres, new)
            written = record(par, t, h, old, new, history, written)
            out[at.RATE_PEAK] = max(out[at.RATE_PEAK], abs(v[2]))
        if now <= par[at.T_STOP] + 0.5 * h or par[at.OWN_DURATION] == 0.0:
            if q > out[at.PEAK]:
                out[at.PEAK], out[at.PEAK_SIDE], out[at.T_PEAK] = q, 1.0 if theta > 0.0 else -1.0, now
            out[at.TOP_PEAK] = max(out[at.TOP_PEAK], abs(u[len(u) - 3]))

        if q >= 0.5 * math.pi:
            out[at.VERDICT], out[at.PEAK_SIDE] = FALLS, 1.0 if theta > 0.0 else -1.0
            if math.isnan(out[at.T_END]):
                out[at.T_END] = now
            break
        if position < UNITS:
            if position % (10 * units) == 0:
                units *= 10
            continue
        i, position, units = i + 1, 0, UNITS
        if now >= par[at.T_STOP] - 0.5 * h and math.isnan(out[at.T_END]):
            out[at.T_END] = par[at.T_STOP]
        if now >= par[at.T_MOTION] and i % LOOK == 0:
            energy = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - bottom
            ended = not math.isnan(out[at.T_END])
            if energy < par[at.BARRIER] and q < par[at.Q_STAR]:
                out[at.VERDICT] = RETURNS
                if not ended and energy < par[at.SHUT] and par[at.OWN_DURATION] == 0.0:
                    out[at.T_END] = now
                    break
                if ended and (par[at.OWN_DURATION] > 0.0 or theta * v[2] <= 0.0):
                    break
            if now >= par[at.T_LAST]:
                break
    out[at.STATUS] = at.DONE
    out[at.ENERGY] = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - begun - worked + lost
