"""The numbers of one case: what stands at the top of its script, and the motion's files."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rockcli.errors import SolverError
from rockcli.scene.backends import unfit_base
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.constants import (
    ALPHA_D,
    DENSITY,
    ELEMENTS,
    FIBRES,
    REARM,
    RIGID,
    YIELD_ROTATION,
)
from rockcli.scene.ground.excitation import Channel, Samples, acceleration
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.rotary import lacking
from rockcli.solvers.common.stepping import check_step
from rockcli.solvers.flexible.column import check_upright

REST = 0.5
"""At rest: not opened beyond `REARM` for this many 1/p after the motion's end."""

TOLERANCE = 1e-10
"""Newton's iterations end when the norm of the displacement increment is below this [m, rad]."""

FINE = 20
"""Steps taken in place of one where the base closes."""

Parameter = tuple[str, float | int | str, str]
"""Name, value and comment of a line at the top of the script."""


@dataclass(frozen=True, eq=False)
class CaseOfOpenSees:
    """One case.

    Attributes:
        kind: key of the column's piece: `1` ... `4`, `flexible`, `4 on fibres`.
        law: of the base: `softening`, `plastic`, `winkler`, `fibres`.
        consistent: whether the masses are in the elements.
        parameters: lines at the top of the script.
        motions: a_g and a_v as file contents, None where there is none.
        values: the parameters by name.
    """

    kind: str
    law: str
    consistent: bool
    parameters: list[Parameter]
    motions: tuple[str | None, str | None]

    @property
    def values(self) -> dict[str, float | int | str]:
        """The parameters by name."""
        return {name: value for name, value, _ in self.parameters}

    def number(self, name: str) -> float:
        """One parameter."""
        return float(self.values[name])


def mass_of(batch: Batch, case: int) -> float:
    """Mass of a body [kg]: as given, or that of the column per unit depth, or of a block of `DENSITY`."""
    block, column = batch.block, batch.column
    area = 4.0 * float(block.b[case, LEFT]) * float(block.h[case])
    if batch.model == "flexible" and column is not None:
        return float(column.rho[case]) * area
    given = float(block.mass[case])
    return given if np.isfinite(given) else DENSITY * area


def law_of(batch: Batch) -> str:
    """Law of the base of a batch; `SolverError` where model, base and damping do not go together."""
    if why := unfit_base(batch):
        raise SolverError(why)
    base = batch.base
    if base is None or base.law == "rigid":
        law = "softening" if batch.geometry == "negative_stiffness" else "plastic"
    else:
        law = "fibres" if batch.damping.scheme == "hht" or base.fibres is not None else "winkler"
    if batch.excitation.vertical is not None and law != "fibres":
        raise SolverError(
            "the base spring of backend opensees knows the weight at rest only: vertical motion needs fibres "
            "(base: {law: winkler, kw: ..., fibres: ...}) or another backend"
        )
    return law


def default_dt(batch: Batch, case: int) -> float:
    """Time step [s]: 2e-4/p, 1/2000 of the pulse's period, 1/10 of the record's step, the least; times the level's."""
    dt = 2e-4 / float(batch.p[case, LEFT]) * batch.numerics.level.penalty_step
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Samples):
            dt = channel.dt / np.ceil(channel.dt / min(dt, channel.dt / 10.0) * (1.0 - 1e-9))
        elif channel is not None:
            dt = min(dt, 2.0 * np.pi / float(channel.omega_p[case]) / 2000.0 * batch.numerics.level.penalty_step)
    if batch.save.histories and dt < batch.save.dt_out:  # land on the output times
        landing = batch.save.dt_out / np.ceil(batch.save.dt_out / dt * (1.0 - 1e-9))
        dt = dt if _divides_a_record(batch, dt) and not _divides_a_record(batch, landing) else landing
    return float(dt)


def _divides_a_record(batch: Batch, dt: float) -> bool:
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    steps = [channel.dt / dt for channel in channels if isinstance(channel, Samples)]
    return bool(steps) and all(abs(n - round(n)) < 1e-6 for n in steps)


def case_of(batch: Batch, case: int, *, coarser: float = 1.0) -> CaseOfOpenSees:
    """One case; `coarser` multiplies its time step and yield rotation.

    Raises:
        SolverError: model, base and damping do not go together, or a number is not possible here.
    """
    law, block, numerics, column = law_of(batch), batch.block, batch.numerics, batch.column
    R, alpha, b = (float(both[case, LEFT]) for both in (block.R, block.alpha, block.b))
    h, g, p, m = float(block.h[case]), float(batch.g[case]), float(batch.p[case, LEFT]), mass_of(batch, case)
    dt = (numerics.dt or default_dt(batch, case)) * coarser
    theta_y = (numerics.yield_rotation or YIELD_ROTATION) * coarser
    if not theta_y < REARM * alpha:
        raise SolverError(f"yield_rotation {theta_y:.3g} is not small against alpha = {alpha:.3g}")
    if column is not None and batch.model == "flexible":
        E, stiff = float(column.E[case]), "Young's modulus [Pa]"
        check_upright(batch, case)
    else:
        E = m / (2.0 * b * h) * g * h * h / (b * RIGID)
        stiff = f"Young's modulus of the column [Pa]: m g b bends it by about {RIGID:.0e} rad"
    on_fibres, (end, stop, given) = law == "fibres", durations_of(batch).of(case)
    if coarser == 1.0:
        check_step(batch, case, dt, stop)
    lines: list[Parameter] = [
        ("g", g, "acceleration of gravity [m/s2]"),
        ("R", R, "from the edge to the centre of mass [m]"),
        ("alpha", alpha, "slenderness angle [rad]"),
        ("h", h, "height of the centre of mass [m]"),
        ("b", b, "half the width of the base [m]"),
        ("m", m, "mass [kg]"),
        ("I_O", float(block.inertia[case, LEFT]) * m * R * R, "moment of inertia about the edge [kg m2]"),
        ("E", E, stiff),
        ("A", 2.0 * b, "area of the column, per unit depth [m2]"),
        ("I", (2.0 * b) ** 3 / 12.0, "its second moment [m4]"),
    ]
    kind, consistent = batch.model, False
    if batch.model in ("4", "flexible"):
        kind = "4 on fibres" if on_fibres and batch.model == "4" else batch.model
        consistent = column is None or column.mass != "lumped"
        line = 2.0 * R if kind == "4" else 2.0 * h
        lacking(float(block.inertia[case, LEFT]), m, R, line, m * b * b if on_fibres else 0.0)
        lines.append(("n", ELEMENTS if column is None else column.elements, "elements of the column"))
        if batch.model == "flexible" and column is not None and float(column.zeta[case]) > 0.0:
            lines.append(("zeta", float(column.zeta[case]), "damping ratio of the first clamped mode"))
    lines += _base_lines(batch, case, law, theta_y, m * g)
    lines += _damping_lines(batch, case, m * R * R)
    lines += [
        ("theta_0", float(batch.theta_0[case]), "initial rotation [rad]"),
        ("theta_dot_0", float(batch.theta_dot_0[case]), "initial angular velocity [rad/s]"),
        (
            "z_top",
            2.0 * h if batch.model == "flexible" else float(block.top[case]),
            "height of the point whose displacement is reported [m]",
        ),
        ("DIRECTION", 3 if batch.model == "2" else 1, "of the ground motion: 1 horizontal, 3 rotation"),
        ("DT", dt, "time step [s]"),
        ("FINE", FINE, "steps in place of one where the base closes"),
        ("TOLERANCE", numerics.rtol or TOLERANCE, "on the norm of displacement increments [m, rad]"),
        ("T_MOTION", end, "end of the motion [s]"),
        ("T_STOP", stop, "end of the report [s]"),
        ("STEPS", max(1, int(np.ceil(stop / dt * (1.0 - 1e-12)))), "of DT, up to there"),
        ("T_REST", 1e30 if given else REST / p, "still this long after the motion: at rest [s]"),
        ("EVERY", every(batch, dt), "steps between rows of the results"),
    ]
    motions = []
    for name, channel in (("MOTION", batch.excitation.horizontal), ("VERTICAL", batch.excitation.vertical)):
        text, spacing = _motion_text(channel, case, dt)
        if text is not None:
            lines.append((f"DT_{name}", spacing, "spacing of the values in the file [s]"))
        motions.append(text)
    return CaseOfOpenSees(kind, law, consistent, lines, (motions[0], motions[1]))


def every(batch: Batch, dt: float) -> int:
    """Steps between rows: those of the output times where they coincide, else four rows for each."""
    ratio = batch.save.dt_out / dt
    if abs(ratio - round(ratio)) < 1e-6 * ratio and ratio >= 0.5:
        return round(ratio)
    return max(1, int(ratio / 4.0))


def _base_lines(batch: Batch, case: int, law: str, theta_y: float, weight: float) -> list[Parameter]:
    alpha, b = float(batch.block.alpha[case, LEFT]), float(batch.block.b[case, LEFT])
    lines: list[Parameter] = []
    if law in ("winkler", "fibres"):
        assert batch.base is not None
        kw = float(batch.base.kw[case])
        theta_y = weight / (2.0 * kw * b * b)
        lines.append(("kw", kw, "stiffness of the base [N/m3], per unit depth"))
    if law == "fibres":
        assert batch.base is not None
        lines.append(("fibres", batch.base.fibres or FIBRES, "fibres of the base"))
    what = "rotation at which an edge of the base opens [rad]" if lines else "rotation at which the base opens [rad]"
    armed = max(REARM * alpha, theta_y)
    return [*lines, ("theta_y", theta_y, what), ("theta_armed", armed, "beyond it the next closing is an impact [rad]")]


def _damping_lines(batch: Batch, case: int, mR2: float) -> list[Parameter]:
    damping, block, at = batch.damping, batch.block, slice(case, case + 1)
    lines: list[Parameter] = [
        ("eta_left", float(damping.eta[case, LEFT]), "theta_dot after / before an impact on the left edge"),
        ("eta_right", float(damping.eta[case, RIGHT]), "and on the right"),
    ]
    if damping.coefficient is not None:
        inertia = block.inertia[at, LEFT]
        rate = dashpot_rate(damping.coefficient[at], block.alpha[at, LEFT], block.R[at, LEFT], inertia, batch.g[at])
        lines.append(("c", float(rate[0] * inertia[0]) * mR2, "rotational damper at the base (3.3) [N m s]"))
    if damping.scheme == "hht":
        alpha_d = ALPHA_D if damping.alpha_d is None else float(damping.alpha_d[case])
        lines.append(("alpha_d", alpha_d, "parameter of the HHT integrator"))
    return lines


def _motion_text(channel: Channel | None, case: int, dt: float) -> tuple[str | None, float]:
    """A motion as OpenSees reads it, one value [m/s2] per line, and its spacing: a record's own, a pulse's the step."""
    if channel is None:
        return None, 0.0
    if isinstance(channel, Samples):
        values, spacing = channel.values * channel.factor[case], channel.dt
    else:
        n = int(np.ceil(float(channel.end[case]) / dt * (1.0 - 1e-12)))
        t = np.arange(n + 1, dtype=np.float64) * np.float64(dt)
        values, spacing = acceleration(channel, t, case), dt
    return "".join(f"{x:.17g}\n" for x in values.tolist()), spacing
