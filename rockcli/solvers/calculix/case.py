"""One case as a deck: what is refused, how fine, and the motion of the ground as a table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.body.block import RECTANGLE_INERTIA
from rockcli.scene.constants import ELEMENTS, REARM
from rockcli.scene.ground.excitation import Pulses, Samples
from rockcli.solvers.calculix.deck import Deck
from rockcli.solvers.calculix.mesh import make_mesh
from rockcli.solvers.calculix.verdict import Body
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.ground import ground_of_case

Array = NDArray[np.float64]

POISSON = 0.2
"""Poisson's ratio (concrete); in plane stress the answer hardly depends on it."""

RIGID_BASE = 100.0
"""kw b/E of a base of law `rigid`: as stiff as the mesh needs it, and no stiffer."""

DISSIPATION = -0.05
"""alpha of the integrator without the damping scheme `hht`: CalculiX's own default."""

STEPS = 180.0
"""Increments per clamped period of the body, at accuracy `standard`."""

LEAST_STEPS = 8.0
"""Increments per clamped period below which an impact may give energy, so that a body overturns that would not."""

PULSE_STEPS, ROCKING_STEPS = 100.0, 50.0
"""Increments at least per period of a pulse, and per 1/p, at accuracy `standard`."""


class Refused(ValueError):  # noqa: N818 - a verdict, as in solvers/flexible
    """A case that is no mesh, with the sentence."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A case: its deck, the body behind it, and the rotation beyond which it rocks, if an edge is open [rad]."""

    deck: Deck
    body: Body
    threshold: float


def clamped_period(E: float, rho: float, h: float, tan_alpha: float) -> float:
    """First period of the body clamped at its base [s], (4.3): 12.3809 sqrt(rho/E) h/tan(alpha)."""
    return float(12.3809 * np.sqrt(rho / E) * h / tan_alpha)


def period_of(batch: Batch, i: int) -> float:
    """Clamped period of the column of case i [s]."""
    assert batch.column is not None
    h, tan_alpha = float(batch.block.h[i]), float(batch.block.tan_alpha[i, 0])
    return clamped_period(float(batch.column.E[i]), float(batch.column.rho[i]), h, tan_alpha)


def elements_along(batch: Batch, i: int) -> int:
    """Elements along the height of case i: the study's, or as many as make them square."""
    assert batch.column is not None
    across = batch.column.across
    return batch.column.elements or max(1, round(across * float(batch.block.h[i] / batch.block.b[i, 0])))


def prepare(batch: Batch, i: int) -> Prepared:
    """Prepare case i.

    Raises:
        Refused: asymmetric or not a rectangle, values that cannot be, a base too soft to stand on, set in motion at the
            start, too long a step.
    """
    column, block, base = batch.column, batch.block, batch.base
    if column is None:
        raise Refused("model continuum needs a column: {E, rho}")
    if not block.symmetric[i]:
        raise Refused("the mesh is that of a symmetric body: give one b")
    if abs(block.inertia[i, 0] - RECTANGLE_INERTIA) > 1e-12:
        raise Refused("the mesh is that of a rectangle: inertia and r_g do not apply")
    if batch.theta_dot_0[i] != 0.0:
        raise Refused("model continuum starts from rest: initial.theta_dot does not apply")
    E, rho, zeta = float(column.E[i]), float(column.rho[i]), float(column.zeta[i])
    if not (E > 0.0 and rho > 0.0 and zeta >= 0.0 and np.isfinite([E, rho, zeta]).all()):
        raise Refused("E and rho must be positive and zeta not negative")
    g, h, b = float(batch.g[i]), float(block.h[i]), float(block.b[i, 0])
    from rockcli.solvers.flexible.column import critical_modulus

    least = critical_modulus(rho, g, h, b)
    if least > E:
        raise Refused(f"the body buckles under its own weight: E = {E:.6g} Pa, at least {least:.5g} Pa is needed")
    kw = float(base.kw[i]) if base is not None and base.law == "winkler" else RIGID_BASE * E / b
    if not kw > 0.0:
        raise Refused("a winkler base needs a positive kw")
    period = period_of(batch, i)
    p, alpha = float(batch.p[i, 0]), float(block.alpha[i, 0])
    lasts = durations_of(batch).of(i)
    dt = largest_step(batch, i)
    if dt * LEAST_STEPS > period:
        raise Refused(
            f"a step of {dt:.3g} s is too long for a body of clamped period {period:.3g} s: at most an eighth"
        )
    t = breakpoints(batch, i, lasts.report, dt)
    a_g, a_v = ground_of_case(batch, i, t)
    deck = Deck(
        mesh=make_mesh(2.0 * h, 2.0 * b, column.across, elements_along(batch, i)),
        E=E,
        nu=POISSON,
        rho=rho,
        kw=kw,
        g=g,
        beta=zeta * period / np.pi,
        dissipation=_dissipation(batch, i),
        theta_0=float(batch.theta_0[i]),
        t_stop=lasts.report,
        dt=dt,
        t=t,
        a_g=a_g,
        a_v=a_v,
    )
    theta_star, barrier = _unstable_equilibrium(batch, i)
    body = Body(alpha, p, period, lasts.motion, theta_star, barrier)
    return Prepared(deck, body, REARM * alpha)


def _unstable_equilibrium(batch: Batch, i: int) -> tuple[float, float]:
    """Rotation [rad] and energy over m g R of the unstable equilibrium, the lower of those of a beam and the block."""
    from rockcli.solvers.flexible.column import RefusedError
    from rockcli.solvers.flexible.column import prepare as prepare_column

    assert batch.column is not None
    alpha, R = float(batch.block.alpha[i, 0]), float(batch.block.R[i, 0])
    try:
        beam = prepare_column(replace(batch, column=replace(batch.column, elements=ELEMENTS)), i)
    except RefusedError as error:
        raise Refused(str(error)) from None
    return min(beam.theta_star, alpha), min(beam.barrier * beam.length**2 / (beam.g * R), 1.0 - float(np.cos(alpha)))


def _dissipation(batch: Batch, i: int) -> float:
    """alpha of CalculiX's integrator: alpha_d - 1 in the convention of the thesis, (alpha_d in [2/3, 1])."""
    alpha_d = batch.damping.alpha_d
    if batch.damping.scheme != "hht" or alpha_d is None or not np.isfinite(alpha_d[i]):
        return DISSIPATION
    return float(alpha_d[i]) - 1.0


def largest_step(batch: Batch, i: int) -> float:
    """Largest increment [s]: the study's, or a part of what is shortest of body, pulse and rocking."""
    if batch.numerics.dt is not None:
        return batch.numerics.dt
    finer = batch.numerics.level.wave_step
    longest = [period_of(batch, i) / (STEPS / finer), finer / (ROCKING_STEPS * float(batch.p[i, 0]))]
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Pulses):
            longest.append(finer * 2.0 * np.pi / float(channel.omega_p[i]) / PULSE_STEPS)
    return float(min(longest))


def breakpoints(batch: Batch, i: int, stop: float, dt: float) -> Array:
    """Times of the table of the ground motion, (k,) [s], from 0 to `stop`; a jump has a time on each side of it."""
    near = 1e-6 * dt
    times = [np.array([0.0, stop])]
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Samples):
            at = np.arange(len(channel.values)) * channel.dt
            times += [at, at[-1:] + near]
        elif channel is not None:
            step = min(0.5 * dt, 2.0 * np.pi / float(channel.omega_p[i]) / 200.0)
            for row in channel.table[i]:
                times.append(np.linspace(row[0], row[1], max(2, int(np.ceil((row[1] - row[0]) / step)) + 1)))
                times.append(np.array([row[0] - near, row[1] - near, row[1] + near]))
    t = np.unique(np.concatenate(times))
    t = t[(t >= 0.0) & (t <= stop)]
    return np.asarray(t[np.concatenate([[True], np.diff(t) > 0.1 * near])])
