"""A case of the frame backend from its beginning to its outcome (docs/frame.md)."""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.constants import DUE, FALLS, RETURNS
from rockcli.kernels.frame import layout as at
from rockcli.kernels.frame.banded import clear, copy
from rockcli.kernels.frame.elements import damping, stored_energy
from rockcli.kernels.frame.newmark import accelerate, settle, step
from rockcli.kernels.frame.readings import add_work, kinetic, note, note_end_of_step, note_start, opened, record
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
def acting(par, values, i, first, part, last):
    """Acceleration of the ground whose work a part of step i does: at the instant of equilibrium, or the ends' mean."""
    if par[at.ALPHA_D] == 1.0:
        return 0.5 * (between(values, i, first) + between(values, i, last))
    return between(values, i, part)


@jit
def begin(par, n, mass, damped, pull, weights, fibres, a_g, a_v, u, v, a, work, bands, B):
    """Bring the body into equilibrium: (whether there is one, energy it begins with, energy of one upright [J])."""
    upright = work[at.UPRIGHT]
    clear(upright)
    if not settle(par, n, pull, weights, fibres, upright, work, bands, B):
        return False, 0.0, 0.0
    bottom = stored_energy(par, upright, n, weights, fibres, B)
    if not settle(par, n, pull, weights, fibres, u, work, bands, B):
        return False, 0.0, 0.0
    damping(par, u, n, bands[at.DAMPING], B)
    accelerate(par, n, mass, damped, pull, weights, fibres, a_g, a_v, u, v, a, work, bands, B)
    return True, stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work), bottom


@jit
def converged(iterations, out):
    """Whether the part of a step that was tried has converged, in so many iterations; counted."""
    out[at.N_RHS] += abs(iterations)
    if iterations < 0:
        out[at.CUTS] += 1.0
        return False
    out[at.ITERATIONS] += iterations
    out[at.N_STEPS] += 1.0
    return True


@jit
def land(par, n, mass, damped, pull, weights, fibres, a_g, a_v, rate_old, now, u, v, a, work, bands, B, impacts, out):
    """Impact at the end of a step in which the base came back to zero (E13): velocities times eta; energy lost [J]."""
    before, lost = 0.5 * (rate_old + v[2]), 0.0
    eta = par[at.ETA_RIGHT] if u[2] > 0.0 else par[at.ETA_LEFT]
    if eta < 1.0:
        lost = (1.0 - eta * eta) * kinetic(mass, v, work)
        for k in range(len(v)):
            v[k] *= eta
        accelerate(par, n, mass, damped, pull, weights, fibres, a_g, a_v, u, v, a, work, bands, B)
        out[at.N_RHS] += 1.0
    if now > par[at.T_STOP]:
        out[at.STRUCK_LATER] = 1.0
    elif abs(before) > par[at.FAST]:
        stored = int(out[at.N_IMPACTS])
        if stored < len(impacts):
            impacts[stored, 0], impacts[stored, 1], impacts[stored, 2] = now, before, eta * before
            out[at.N_STORED] = stored + 1.0
        out[at.N_IMPACTS] += 1.0
    return lost


@jit
def fallen(theta, now, out):
    """Whether the body lies on the ground; noted if so."""
    falls = abs(theta) >= 0.5 * math.pi
    if falls:
        out[at.VERDICT], out[at.PEAK_SIDE] = FALLS, 1.0 if theta > 0.0 else -1.0
        if math.isnan(out[at.T_END]):
            out[at.T_END] = now
    return falls


@jit
def ended(par, n, mass, weights, fibres, now, bottom, u, v, work, B, out):
    """Whether the case ends after the motion: its outcome is known, or is searched for no longer."""
    energy = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - bottom
    told = not math.isnan(out[at.T_END])
    if energy < par[at.BARRIER] and abs(u[2]) < par[at.Q_STAR]:
        out[at.VERDICT] = RETURNS
        if not told and energy < par[at.SHUT] and par[at.OWN_DURATION] == 0.0:
            out[at.T_END] = now
            return True
        if told and (par[at.OWN_DURATION] > 0.0 or u[2] * v[2] <= 0.0):
            return True
    return now >= par[at.T_LAST]


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
    damped = par[at.DASHPOT] > 0.0 or par[at.STIFF_DAMPING] > 0.0
    stands, begun, bottom = begin(
        par, n, mass, damped, pull, weights, fibres, a_g[0], a_v[0], u, v, a, work, bands, B
    )  # fmt: skip
    if not stands:
        out[at.STATUS] = at.NO_STATICS
        return
    note_start(par, a_v[0], u, v, out)
    side, armed = 1.0 if u[2] >= 0.0 else -1.0, abs(u[2]) > par[at.REARM] and opened(par, u, a_v[0])
    note(par, u, v, 1.0 + a_v[0] / par[at.G], fibres, rows[1])
    written = record(par, -par[at.DT], par[at.DT], rows[1], rows[1], history, 0)
    worked, lost, u_old = 0.0, 0.0, work[at.BEFORE]

    i, position, units = 0, 0, UNITS  # the step, how much of it is done, and the part to try
    while True:
        first, last = position / UNITS, (position + units) / UNITS
        part = (position + par[at.ALPHA_D] * units) / UNITS
        t, h = (i + first) * par[at.DT], par[at.DT] * units / UNITS
        if par[at.STIFF_DAMPING] > 0.0:
            damping(par, u, n, bands[at.DAMPING], B)
        copy(u, u_old)
        rate_old, up = v[2], between(a_v, i, part)
        iterations = step(
            par, n, mass, damped, pull, weights, fibres, h, between(a_g, i, part), up, u, v, a, work, bands, B
        )
        if not converged(iterations, out):
            units //= 10
            if units == 0:
                out[at.STATUS], out[at.T_END] = at.NO_CONVERGENCE, t
                return
            continue
        now, position = t + h, position + units
        acting_g, acting_v = acting(par, a_g, i, first, part, last), acting(par, a_v, i, first, part, last)
        end_g, end_v = between(a_g, i, last), between(a_v, i, last)

        worked, lost = add_work(par, damped, pull, weights, acting_g, acting_v, u, work, worked, lost)
        if armed and side * u[2] <= 0.0:
            lost += land(
                par, n, mass, damped, pull, weights, fibres, end_g, end_v, rate_old, now, u, v, a, work, bands, B,
                impacts, out,
            )  # fmt: skip
            armed = False
        if abs(u[2]) > par[at.REARM] and opened(par, u, end_v):
            armed, side = True, 1.0 if u[2] > 0.0 else -1.0
        written = note_end_of_step(par, fibres, end_v, t, h, abs(u_old[2]), u, v, rows, history, written, out)
        if fallen(u[2], now, out):
            break
        if position < UNITS:
            if position % (10 * units) == 0:
                units *= 10
            continue
        i, position, units = i + 1, 0, UNITS
        if now >= par[at.T_STOP] * (1.0 - DUE) and math.isnan(out[at.T_END]):
            out[at.T_END] = par[at.T_STOP]
        looked = now >= par[at.T_MOTION] and i % LOOK == 0
        if looked and ended(par, n, mass, weights, fibres, now, bottom, u, v, work, B, out):
            break
    out[at.STATUS] = at.DONE
    out[at.ENERGY] = stored_energy(par, u, n, weights, fibres, B) + kinetic(mass, v, work) - begun - worked + lost
