"""`solve` of the backend `scipy`: case after case, each with its own steps."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.kernels.constants import FALLS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.response import Response
from rockcli.solvers.common.certainty import CERTAINTY, Judgement, Perturbation, Traces, judge, perturbed
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.found import Found, from_beyond, note_unstored, rigid_top
from rockcli.solvers.event.unpack import Raw, histories_of
from rockcli.solvers.general import stepwise
from rockcli.solvers.general.body import body_of
from rockcli.solvers.general.event_located import Located
from rockcli.solvers.general.ground import ground_of
from rockcli.solvers.general.methods import (
    ATOL_OVER_RTOL,
    DEFAULT_METHOD,
    FLOOR,
    METHODS,
    Method,
    StuckError,
    Walker,
)
from rockcli.solvers.general.trajectory import Trajectory

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FINER = 0.1
"""The error estimate is the difference to a run with this many times the tolerance."""

NOT_COMPUTED = ("mu_required", "mu_impact", "N_min_over_mg", "energy_residual")
"""Scalars this backend does not find out: NaN."""


@dataclass(frozen=True)
class Settings:
    """How a batch is solved: rest_speed as in scene/numerics.py."""

    method: Method
    rtol: float
    events: bool
    rest_speed: float


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with a general method.

    The scalars about contact forces and energy are NaN.  A case in which the method fails is `failed` with a message;
    one on a separatrix within the tolerance, or whose outcome differs within it, is `unresolved`.

    Raises:
        SolverError: the method is unknown, or restitution is asked for without located impacts.
    """
    settings = _settings(batch)
    began = time.perf_counter()
    trajectories: list[Trajectory] = []
    columns: dict[str, list[Any]] = {"wall_time": [], "n_steps": [], "n_rhs": []}
    reasons: list[str] = []
    for i in range(batch.size):
        trajectory, walker = _solve_one(batch, i, settings, histories=batch.save.histories)
        trajectories.append(trajectory)
        reasons.append(_reason(batch, i, trajectory))
        now = time.perf_counter()
        for name, value in (("wall_time", now - began), ("n_steps", walker.taken), ("n_rhs", walker.evaluated)):
            columns[name].append(value)
        began = now
    scalars = _scalars(batch, trajectories)
    note_unstored(batch, scalars["n_impacts"], reasons)
    scalars["wall_time"] = np.array(columns["wall_time"])
    scalars |= {name: np.array(columns[name], dtype=np.int64) for name in ("n_steps", "n_rhs")}
    if batch.save.scalars & CERTAINTY:
        _judged(batch, settings, scalars).enter(scalars, reasons)
    histories, impacts, t = _histories(batch, trajectories) if batch.save.histories else ({}, {}, np.empty(0))
    used = {
        "backend": "scipy",
        "method": f"{settings.method.name}: {settings.method.reference}",
        "events": "located" if settings.events else "none: sgn(theta) integrated as it is",
        "rtol": repr(settings.rtol),
        "atol": repr(settings.rtol * ATOL_OVER_RTOL),
    }
    if settings.events:
        used["rest_speed"] = repr(settings.rest_speed)
    return Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)


def unfit(batch: Batch) -> str:
    """Why a batch is not solved; "" if it is."""
    name = batch.numerics.method
    if name is not None and name not in METHODS:
        return f"the backend scipy has no method {name!r}; it has {', '.join(METHODS)}"
    if batch.numerics.events is False and (batch.damping.eta != 1.0).any():
        return "restitution needs located impacts: without events (solver.events: false) damping is none or dashpot"
    return ""


def _histories(batch: Batch, trajectories: list[Trajectory]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories by name (n, k), impacts by name (n, j), and the output times (k,) [s]; NaN-padded."""
    raw = Raw(batch.size, max(len(d.theta) for d in trajectories), max(len(d.impacts) for d in trajectories))
    for i, trajectory in enumerate(trajectories):
        raw.histories[i, 0, : trajectory.written] = trajectory.theta[: trajectory.written]
        raw.histories[i, 1, : trajectory.written] = trajectory.rate[: trajectory.written]
        for k, impact in enumerate(trajectory.impacts):
            raw.impacts[i, :, k] = impact
    return histories_of(batch, raw)


def _settings(batch: Batch) -> Settings:
    if why := unfit(batch):
        raise SolverError(why)
    numerics = batch.numerics
    name = numerics.method or DEFAULT_METHOD
    events = numerics.events is not False
    rtol = numerics.level.ode_rtol if numerics.rtol is None else numerics.rtol
    return Settings(METHODS[name], max(rtol, FLOOR), events, numerics.tolerances.rest_speed)


def _judged(batch: Batch, settings: Settings, scalars: dict[str, NDArray[Any]]) -> Judgement:
    """What further runs show, each of another tolerance; the work of all is in the counts of the case."""

    def again(rows: Index, factors: Array, fine: bool) -> Traces:
        others = perturbed(batch, rows, factors)
        how, trajectories = _compared(settings), []
        for i, row in enumerate(rows):
            began = time.perf_counter()
            trajectory, walker = _solve_one(others, i, how, histories=False)
            trajectories.append(trajectory)
            scalars["n_steps"][row] += walker.taken
            scalars["n_rhs"][row] += walker.evaluated
            scalars["wall_time"][row] += time.perf_counter() - began
        return Traces.of(others, _scalars(others, trajectories))

    first = Traces.of(batch, scalars)
    return judge(first, again, Perturbation(settings.rtol, weight=1.0), first.rows, None, settings.rtol)


def _solve_one(batch: Batch, i: int, how: Settings, *, histories: bool) -> tuple[Trajectory, Walker]:
    """The trajectory of one case, and who counted the work."""
    body, ground = body_of(batch, i), ground_of(batch, i)
    n_time = output_times(batch.save.dt_out, ground.t_stop) if histories else 0
    margin = max(2e-14, 10.0 * how.rtol)
    trajectory = Trajectory(body, batch.save.dt_out, np.full(n_time, np.nan), np.full(n_time, np.nan), margin)
    theta, rate = float(batch.theta_0[i]), float(batch.theta_dot_0[i])
    walker = Walker(how.method, how.rtol, math.inf)
    try:
        if how.events:
            Located(body, ground, walker, trajectory, how.rest_speed, margin).run(theta, rate)
        else:
            stepwise.run(body, ground, walker, trajectory, theta, rate, margin)
    except StuckError as stuck:
        trajectory.failure = str(stuck)
    return trajectory, walker


def _compared(how: Settings) -> Settings:
    """Settings of the run that tells the error: finer, or coarser where nothing finer is to be had."""
    finer = how.rtol * FINER
    return replace(how, rtol=finer if finer >= FLOOR else how.rtol / FINER)


def _reason(batch: Batch, i: int, trajectory: Trajectory) -> str:
    said = []
    if trajectory.failure:
        said.append(trajectory.failure)
    elif trajectory.verdict == UNDECIDED:
        said.append("on the separatrix within the tolerance, which does not decide whether it overturns")
    if np.isfinite(batch.block.mu[i]):
        said.append("mu is given, but the backend scipy does not find out the friction needed")
    return "; ".join(said)


def _scalars(batch: Batch, trajectories: list[Trajectory]) -> dict[str, NDArray[Any]]:
    """Scalars by name but for those of the run itself."""
    failed, verdict = np.array([bool(d.failure) for d in trajectories]), np.array([d.verdict for d in trajectories])
    names = ("peak", "side", "rate_peak", "t_peak", "t_uplift", "t_overturn", "t_end")
    peak, side, rate, t_peak, t_uplift, t_overturn, t_end = (
        np.array([getattr(trajectory, name) for trajectory in trajectories]) for name in names
    )
    sides = np.array([d.peaks for d in trajectories]).reshape(-1, 2)
    found = Found(
        moved=np.isfinite(t_uplift),
        fell=~failed & (verdict == FALLS),
        undecided=verdict == UNDECIDED,
        failed=failed,
        n_impacts=np.array([d.n_impacts for d in trajectories], dtype=np.int64),
        peak=peak,
        side=side,
        rate=rate,
        top=rigid_top(batch, peak, sides),
        t_peak=t_peak,
        t_uplift=t_uplift,
        t_overturn=from_beyond(t_overturn),
        t_end=t_end,
        struck_later=np.array([d.struck_later for d in trajectories]),
    )
    sides = np.where(found.fell[:, None] & (side[:, None] == (-1.0, 1.0)), np.inf, sides)
    sides = np.where(found.outcome[:, None] < 0, np.nan, sides)
    sided = np.where(batch.block.symmetric[:, None], np.nan, sides)
    scalars = found.scalars(batch)
    larger = np.max(sides / batch.block.alpha, axis=1)
    return scalars | {
        "theta_peak_left": sided[:, LEFT],
        "theta_peak_right": sided[:, RIGHT],
        "theta_peak_over_alpha": np.where(batch.block.symmetric, scalars["theta_peak_over_alpha"], larger),
        **{name: np.full(batch.size, np.nan) for name in NOT_COMPUTED},
    }
