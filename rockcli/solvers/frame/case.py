"""From one case of a batch to what the frame kernels take."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.kernels.constants import FAST
from rockcli.kernels.frame import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.constants import ALPHA_D, REARM, YIELD_ROTATION
from rockcli.scene.ground.excitation import Channel, Pulses, acceleration
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.scene.laws.models import MODELS
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.stepping import check_step
from rockcli.solvers.flexible.column import check_upright
from rockcli.solvers.frame.base import fibres_of, kind_of_base
from rockcli.solvers.frame.structure import Structure, structure_of

Array = NDArray[np.float64]

SEARCH = 60.0
"""The search for the outcome goes on this many 1/p after the report."""

TOLERANCE = 1e-11
"""Newton's iterations end when no rotation changes by more [rad]."""

SURE = 0.999
"""Fraction of the barrier below which a body left alone is sure to return."""


@dataclass(frozen=True, eq=False)
class CaseOfFrame:
    """What the kernel `run` takes of one case; par as in `kernels.frame.layout`, u and v the state to begin with."""

    par: Array
    structure: Structure
    fibres: Array
    a_g: Array
    a_v: Array
    u: Array
    v: Array


@dataclass(frozen=True)
class Kernels:
    """The kernel modules, compiled or not."""

    frame: ModuleType
    steps: ModuleType
    elements: ModuleType


def default_dt(batch: Batch, case: int) -> float:
    """Time step [s]: 1e-4/p, 1/2000 of the pulse's period, 1/10 of the record's step, the least; times `STEP`."""
    dt = 1e-4 / float(batch.p[case, LEFT])
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Pulses):
            dt = min(dt, 2.0 * np.pi / float(channel.omega_p[case]) / 2000.0)
        elif channel is not None:
            dt = min(dt, channel.dt / np.ceil(channel.dt / min(dt, channel.dt / 10.0)))
    return float(dt * batch.numerics.level.penalty_step)


def case_of(batch: Batch, case: int, kernel: Kernels, *, coarser: float = 1.0) -> CaseOfFrame:
    """One case; `coarser` multiplies its time step and yield rotation.

    Raises:
        SolverError: the step is too long, the yield rotation is not small against alpha, or the column buckles.
    """
    kind = kind_of_base(batch)
    structure = structure_of(batch, case, fibres=kind == at.FIBRES)
    block, numerics = batch.block, batch.numerics
    g, m = float(batch.g[case]), structure.m
    R, alpha, p = float(block.R[case, LEFT]), float(block.alpha[case, LEFT]), float(batch.p[case, LEFT])
    b = float(block.b[case, LEFT])
    dt = (numerics.dt or default_dt(batch, case)) * coarser
    q_y = (numerics.yield_rotation or YIELD_ROTATION) * coarser
    if not q_y < REARM * alpha:
        raise SolverError(f"yield_rotation {q_y:.3g} is not small against alpha = {alpha:.3g}")
    kw = float(batch.base.kw[case]) if batch.base is not None else np.nan
    elastic_base = kind in (at.WINKLER, at.FIBRES)
    if elastic_base:
        q_y = m * g / (2.0 * kw * b * b)
    gravity = kind != at.SOFTENING
    corotational = numerics.method != "linear"
    end, stop, own = durations_of(batch).of(case)
    if coarser == 1.0:
        check_step(batch, case, dt, stop)
    damping = batch.damping
    if batch.model == "flexible":
        check_upright(batch, case)

    par = np.zeros(at.N_PAR)
    par[at.LENGTH], par[at.AXIAL], par[at.BENDING] = structure.length, structure.axial, structure.bending
    par[at.COROTATIONAL], par[at.BASE], par[at.GRAVITY] = corotational, kind, gravity
    par[at.YIELD_MOMENT] = m * g * (b if gravity else R * np.sin(alpha - q_y))
    par[at.YIELD_ROTATION], par[at.UPLIFT], par[at.ALPHA] = q_y, q_y, alpha
    par[at.KW], par[at.HALF_WIDTH], par[at.WEIGHT], par[at.G] = kw, b, m * g, g
    par[at.HINGED] = kind != at.FIBRES
    if damping.coefficient is not None:
        rate = dashpot_rate(
            damping.coefficient[case : case + 1], block.alpha[case, :1], block.R[case, :1], block.inertia[case, :1],
            batch.g[case : case + 1],
        )  # fmt: skip
        par[at.DASHPOT] = float(rate[0]) * float(block.inertia[case, LEFT]) * m * R * R
    par[at.STIFF_DAMPING] = structure.damping
    par[at.ETA_LEFT], par[at.ETA_RIGHT] = damping.eta[case, LEFT], damping.eta[case, RIGHT]
    par[at.ALPHA_D] = 1.0
    if damping.scheme == "hht":
        par[at.ALPHA_D] = ALPHA_D if damping.alpha_d is None else damping.alpha_d[case]
    par[at.TOLERANCE] = numerics.rtol or TOLERANCE
    par[at.REARM] = REARM * alpha
    par[at.REACH] = structure.n * structure.length
    par[at.DT], par[at.T_MOTION], par[at.T_STOP], par[at.OWN_DURATION] = dt, end, stop, own
    par[at.T_LAST] = stop + SEARCH / p
    par[at.DT_OUT] = batch.save.dt_out if batch.save.histories else 0.0
    par[at.FAST] = FAST * p * alpha
    fibres = fibres_of(batch, case)
    height, summit = barrier(par, structure, fibres, kernel)
    law = MODELS.get((batch.model, batch.geometry))
    rigid = None if law is None or elastic_base else law.law(block.alpha[case], block.tan_alpha[case])
    par[at.Q_STAR] = summit if rigid is None else rigid.q_star[LEFT]
    par[at.BARRIER] = SURE * height
    spring = par.copy()
    spring[at.BASE] = at.WINKLER if elastic_base else kind
    par[at.SHUT] = kernel.elements.spring_energy(spring, q_y)

    u, v = _turned(batch, case, structure, corotational=corotational)
    u[1::3] += lift(par, fibres, u[2])
    if len(fibres):
        v[1::3] += fibres[:, 0].max() * np.sign(u[2] if u[2] != 0.0 else v[2]) * v[2]
    t: Array = np.arange(int(np.ceil(end / dt)) + 2) * np.float64(dt)
    excitation = batch.excitation
    a_g, a_v = (_sampled(channel, t, end, case) for channel in (excitation.horizontal, excitation.vertical))
    return CaseOfFrame(par, structure, fibres, a_g, a_v, u, v)


def barrier(par: Array, structure: Structure, fibres: Array, kernel: Kernels) -> tuple[float, float]:
    """Energy from the upright equilibrium to the unstable one [J], the highest on the path of held base rotations.

    The rotation of the base there [rad] comes with it.
    """
    N = 3 * (structure.n + 1)
    work, bands, B = np.zeros((at.N_ROWS, N)), np.zeros((at.N_BANDS, N, at.BAND)), np.zeros((3, 6))
    s = structure.heights

    def energy(theta: float) -> float:
        u = np.zeros(N)
        u[2::3], u[0::3], u[1::3] = theta, s * np.sin(theta), -s * (1.0 - np.cos(theta))
        if par[at.COROTATIONAL] == 0.0:
            u[0::3], u[1::3] = s * theta, 0.0
        u[1::3] += lift(par, fibres, theta)
        if not kernel.steps.settle(par, structure.n, structure.pull, structure.weights, fibres, u, work, bands, B):
            return np.nan  # it would buckle
        return float(kernel.elements.stored_energy(par, u, structure.n, structure.weights, fibres, B))

    low, high, parts = 0.0, 0.5 * np.pi, 64
    highest, summit = 0.0, 0.0
    for _ in range(4):  # the path has one summit: look closer around the highest point
        q = np.linspace(low, high, parts + 1)
        heights = np.array([energy(x) for x in q]) - energy(0.0)
        if np.isnan(heights).all():
            return 0.0, 0.0
        top = int(np.nanargmax(heights))
        highest, summit, low, high = float(heights[top]), float(q[top]), q[max(top - 1, 0)], q[min(top + 1, parts)]
    return highest, summit


def lift(par: Array, fibres: Array, theta: float) -> float:
    """Rise of the base on fibres at theta [m], from which Newton finds the equilibrium: a little too deep."""
    if not len(fibres):
        return 0.0
    return float(fibres[:, 0].max() * abs(theta) - 2.0 * par[at.WEIGHT] / fibres[:, 1].min())


def _sampled(channel: Channel | None, t: Array, end: float, case: int) -> Array:
    a = acceleration(channel, t, case)
    a[t > end * (1.0 + 1e-12)] = 0.0
    return a


def _turned(batch: Batch, case: int, structure: Structure, *, corotational: bool) -> tuple[Array, Array]:
    """Displacements and velocities of the column turned rigidly."""
    theta, rate, s = float(batch.theta_0[case]), float(batch.theta_dot_0[case]), structure.heights
    u, v = np.zeros(3 * len(s)), np.zeros(3 * len(s))
    u[2::3], v[2::3] = theta, rate
    u[0::3], v[0::3] = (s * np.sin(theta), s * np.cos(theta) * rate) if corotational else (s * theta, s * rate)
    if corotational:
        u[1::3], v[1::3] = -s * (1.0 - np.cos(theta)), -s * np.sin(theta) * rate
    return u, v
