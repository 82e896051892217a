"""A case of the frame backend from its beginning to its outcome (docs/frame.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.kernels.frame.banded import clear, copy, times
from rockcli.kernels.frame.elements import base_moment, damping, spring, stored_energy
from rockcli.kernels.frame.layout import (
    ALPHA_D,
    BARRIER,
    BEFORE,
    CUTS,
    DAMPING,
    DASHPOT,
    DONE,
    DRAG,
    DT,
    DT_OUT,
    ENERGY,
    ETA_LEFT,
    ETA_RIGHT,
    FAST,
    GRAVITY,
    INERTIA,
    ITERATIONS,
    LENGTH,
    LOAD,
    MOMENT,
    N_IMPACTS,
    N_RHS,
    N_STEPS,
    N_STORED,
    NO_CONVERGENCE,
    NO_STATICS,
    OWN_DURATION,
    PEAK,
    PEAK_SIDE,
    Q_STAR,
    RATE,
    RATE_PEAK,
    REARM,
    SHUT,
    STATUS,
    STIFF_DAMPING,
    T_END,
    T_LAST,
    T_MOTION,
    T_OVERTURN,
    T_PEAK,
    T_STOP,
    T_UPLIFT,
    TH,
    TOP_PEAK,
    U_BENDING,
    U_TOP,
    UPLIFT,
    UPRIGHT,
    V_TOP,
    VERDICT,
    G,
)  # fmt: skip
from rockcli.kernels.frame.newmark import accelerate, load, settle, step
from rockcli.kernels.jit import jit

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
    times(mass, v, work[INERTIA])
    total = 0.0
    for i in range(len(v)):
        total += 0.5 * v[i] * work[INERTIA, i]
    return total


@jit
def note(par, u, v, factor, fibres, row):
    """Write a row of the history."""
    top = len(u) - 3
    row[TH], row[RATE], row[U_TOP], row[V_TOP] = u[2], v[2], u[top], u[top + 1]
    row[U_BENDING] = u[top] - par[LENGTH] * (top // 3) * math.sin(u[2])
    row[MOMENT] = base_moment(par, u, factor, fibres)


@jit
def record(par, t, h, old, new, history, written):
    """Write the output times in (t, t + h], linear between the rows old and new; return how many are written."""
    while written < len(history) and written * par[DT_OUT] <= t + h * (1.0 + 1e-9):
        x = min(1.0, (written * par[DT_OUT] - t) / h)
        for k in range(len(old)):
            history[written, k] = old[k] + x * (new[k] - old[k])
        written += 1
    return written


@jit
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
    upright = work[UPRIGHT]
    clear(upright)
    if not settle(par, n, pull, weights, fibres, upright, work, bands, B):
        out[STATUS] = NO_STATICS
        return
    bottom = stored_energy(par, upright, n, weights, fibres, B)
    if not settle(par, n, pull, weights, fibres, u, work, bands, B):
        out[STATUS] = NO_STATICS
        return
    damped = par[DASHPOT] > 0.0 or par[STIFF_DAMPING] > 0.0
    damping(par, u, n, bands[DAMPING], B)
    accelerate(par, n, mass, damped, pull, weights, fibres, a_g[0], a_v[0], u, v, a, work, bands, B)
    out[N_RHS] = 1.0
    begun = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work)
    worked = lost = 0.0

    moving = abs(u[2]) > 0.0 or abs(v[2]) > 0.0
    out[T_UPLIFT] = 0.0 if moving else math.nan
    out[T_PEAK] = out[T_OVERTURN] = out[T_END] = math.nan
    out[PEAK], out[PEAK_SIDE] = abs(u[2]), 1.0 if u[2] >= 0.0 else -1.0
    if moving:
        out[T_PEAK], out[RATE_PEAK], out[TOP_PEAK] = 0.0, abs(v[2]), abs(u[len(u) - 3])
    side = 1.0 if u[2] >= 0.0 else -1.0
    armed = abs(u[2]) > par[REARM]
    old, new = rows[0], rows[1]
    note(par, u, v, 1.0 + a_v[0] / par[G], fibres, new)
    written = record(par, -par[DT], par[DT], new, new, history, 0)
    out[VERDICT] = UNDECIDED
    u_old = work[BEFORE]

    i, position, units = 0, 0, UNITS
    while True:
        t, h = (i + position / UNITS) * par[DT], par[DT] * units / UNITS
        part = (position + par[ALPHA_D] * units) / UNITS
        if par[STIFF_DAMPING] > 0.0:
            damping(par, u, n, bands[DAMPING], B)
        copy(u, u_old)
        q_old, rate_old = abs(u[2]), v[2]
        up = between(a_v, i, part)
        iterations = step(
            par, n, mass, damped, pull, weights, fibres, h, between(a_g, i, part), up, u, v, a, work, bands, B
        )
        out[N_RHS] += abs(iterations)
        if iterations < 0:
            out[CUTS] += 1.0
            units //= 10
            if units == 0:
                out[STATUS], out[T_END] = NO_CONVERGENCE, t
                return
            continue
        out[ITERATIONS] += iterations
        out[N_STEPS] += 1.0
        position += units
        now = t + h
        theta, q = u[2], abs(u[2])
        end_g, end_v = between(a_g, i, position / UNITS), between(a_v, i, position / UNITS)

        # work of the ground and of the dampers over the step
        middle_g, middle_v = between(a_g, i, part), between(a_v, i, part)
        if par[ALPHA_D] == 1.0:
            middle_g = 0.5 * (between(a_g, i, (position - units) / UNITS) + end_g)
            middle_v = 0.5 * (between(a_v, i, (position - units) / UNITS) + end_v)
        load(par, pull, weights, middle_g, middle_v, work[LOAD])
        for k in range(len(u)):
            weight = par[G] * weights[k] if par[GRAVITY] > 0.0 else 0.0
            worked += (work[LOAD, k] + weight) * (u[k] - u_old[k])
            if damped:
                lost += work[DRAG, k] * (u[k] - u_old[k])
        if middle_v != 0.0:
            M, _ = spring(par, 0.5 * (theta + u_old[2]))
            worked -= middle_v / par[G] * M * (theta - u_old[2])

        if math.isnan(out[T_UPLIFT]) and q > par[UPLIFT]:
            out[T_UPLIFT] = now
        if q_old < par[Q_STAR] <= q:
            out[T_OVERTURN] = now

        if armed and side * theta <= 0.0:  # a landing
            armed = False
            before = 0.5 * (rate_old + v[2])
            eta = par[ETA_RIGHT] if theta > 0.0 else par[ETA_LEFT]
            if eta < 1.0:
                lost += (1.0 - eta * eta) * kinetic(mass, v, work)
                for k in range(len(v)):
                    v[k] *= eta
                accelerate(par, n, mass, damped, pull, weights, fibres, end_g, end_v, u, v, a, work, bands, B)
                out[N_RHS] += 1.0
            if abs(before) > par[FAST] and now <= par[T_STOP]:
                stored = int(out[N_IMPACTS])
                if stored < len(impacts):
                    impacts[stored, 0], impacts[stored, 1], impacts[stored, 2] = now, before, eta * before
                    out[N_STORED] = stored + 1.0
                out[N_IMPACTS] += 1.0
        if q > par[REARM]:
            armed, side = True, 1.0 if theta > 0.0 else -1.0

        if now <= par[T_STOP] + 0.5 * h:
            for k in range(len(old)):
                old[k] = new[k]
            note(par, u, v, 1.0 + end_v / par[G], fibres, new)
            written = record(par, t, h, old, new, history, written)
            out[RATE_PEAK] = max(out[RATE_PEAK], abs(v[2]))
        if now <= par[T_STOP] + 0.5 * h or par[OWN_DURATION] == 0.0:
            if q > out[PEAK]:
                out[PEAK], out[PEAK_SIDE], out[T_PEAK] = q, 1.0 if theta > 0.0 else -1.0, now
            out[TOP_PEAK] = max(out[TOP_PEAK], abs(u[len(u) - 3]))

        if q >= 0.5 * math.pi:
            out[VERDICT] = FALLS
            if math.isnan(out[T_END]):
                out[T_END] = now
            break
        if position < UNITS:
            if position % (10 * units) == 0:
                units *= 10
            continue
        i, position, units = i + 1, 0, UNITS
        if now >= par[T_STOP] - 0.5 * h and math.isnan(out[T_END]):
            out[T_END] = par[T_STOP]
        if now >= par[T_MOTION] and i % LOOK == 0:
            energy = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - bottom
            ended = not math.isnan(out[T_END])
            if energy < par[BARRIER]:
                out[VERDICT] = RETURNS
                if not ended and energy < par[SHUT] and par[OWN_DURATION] == 0.0:
                    out[T_END] = now
                    break
                if ended and (par[OWN_DURATION] > 0.0 or theta * v[2] <= 0.0):
                    break
            if now >= par[T_LAST]:
                break
    out[STATUS] = DONE
    out[ENERGY] = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - begun - worked + lost
