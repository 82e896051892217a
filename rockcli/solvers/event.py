"""The event-driven solver: exact flow between located events (docs/theory.md).

Packs a batch into the parameter vectors of the kernels, runs them compiled or as plain Python, whichever
is faster for the amount of work, and names what comes back.
"""

from __future__ import annotations

import time
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels import layout as k
from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.excitation import PIECE_WIDTH, Channel, Pulses, Samples, acceleration
from rockcli.scene.models import MODELS, Law
from rockcli.scene.numerics import Accuracy
from rockcli.scene.response import (
    FAILED,
    MAX_IMPACTS_STORED,
    NO_UPLIFT,
    OVERTURNED_AFTER_IMPACT,
    OVERTURNED_WITHOUT_IMPACT,
    ROCKING,
    UNRESOLVED,
    Response,
)

Array = NDArray[np.float64]

FREE_ROCKING = 20.0
"""The report goes on this many 1/p after the motion's end."""

MAX_STEPS = {True: 200_000_000, False: 30_000}
"""Steps a case may take, compiled or not; a case that needs more uncompiled is solved again compiled."""

COMPILE_ABOVE = 2.0
"""Estimated seconds of plain Python above which the kernels are compiled."""

PEAK_SCALARS = frozenset(
    "outcome theta_peak theta_peak_over_alpha u_top_peak t_peak t_uplift t_overturn t_end n_impacts mu_impact "
    "error_estimate wall_time n_steps reason".split()
)
"""Scalars that need neither the forces at the edge nor the energy balance; the others are NaN when not wanted."""

COARSER = 1e3
"""The error estimate is the difference to a run with this many times the tolerance."""


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with the event-driven kernels; see `Response` for what comes back.

    A case that cannot be solved is `failed` with a sentence; an outcome that rounding would decide, or on
    which two accuracies disagree, is `unresolved`.
    """
    began = time.perf_counter()
    level = batch.numerics.tolerances
    parameters = _parameters(batch)
    march = kernels.load(compile_them=_estimated_seconds(batch, parameters) > COMPILE_ABOVE)
    run = _march(march, batch, parameters, level, histories=batch.save.histories)
    if not kernels.compiled and np.any(run.out[:, k.STATUS] == k.OUT_OF_STEPS):
        march = kernels.load(compile_them=True)
        run = _march(march, batch, parameters, level, histories=batch.save.histories)

    scalars, reasons = _scalars(batch, run)
    if "error_estimate" in batch.save.scalars:
        coarse = Accuracy(max(level.rtol, 1e-16) * COARSER, level.rest_speed * 10.0)
        other, _ = _scalars(batch, _march(march, batch, parameters, coarse, histories=False))
        _compare(scalars, other, reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    used = {
        "backend": "event",
        "method": f"Taylor series to order {_order(level.rtol)}, events located on the polynomial",
        "rtol": repr(level.rtol),
        "rest_speed": repr(level.rest_speed),
        "kernels": "compiled" if kernels.compiled else "interpreted",
    }
    histories, impacts, t = _histories(batch, run) if batch.save.histories else ({}, {}, np.empty(0))
    return Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)


# -- packing ------------------------------------------------------------------------------------------------


def _parameters(batch: Batch) -> Array:
    """One row per case in the layout of `kernels.layout`."""
    model = MODELS[batch.model, batch.geometry]
    block, p = batch.block, batch.p
    law = model.law(block.alpha, block.tan_alpha)
    edges = np.stack(
        [
            p**2, block.alpha, law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold, law.q_star,
            _slope(law, model.linear), batch.damping.eta, np.zeros_like(p), block.R,
        ],
        axis=2,
    )  # fmt: skip
    end = _motion_end(batch)
    duration = batch.excitation.duration
    given = np.isfinite(duration)
    end = np.where(given, np.minimum(end, duration), end)
    stop = np.where(given, duration, end + FREE_ROCKING / p.min(axis=1))
    return np.column_stack(
        [
            batch.g, edges[:, LEFT], edges[:, RIGHT], batch.theta_0, batch.theta_dot_0, end, stop, given,
            _factor(batch.excitation.horizontal, batch.size), _factor(batch.excitation.vertical, batch.size),
        ]
    )  # fmt: skip


def _slope(law: Law, linear: bool) -> Array:
    """|d(restoring law)/dq| at q_star, where the law vanishes."""
    if linear:
        return -law.rs
    return np.asarray(law.rc * np.sin(law.q_star) - law.rs * np.cos(law.q_star))


def _motion_end(batch: Batch) -> Array:
    """Time the last component of the ground motion ends, (n,) [s]."""
    end = np.zeros(batch.size)
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if channel is not None:
            end = np.maximum(end, channel.end)
    return end


def _factor(channel: Channel | None, n: int) -> Array:
    return channel.factor if isinstance(channel, Samples) else np.ones(n)


def _channel(channel: Channel | None, n: int) -> tuple[int, Any, Any, float, Any, int]:
    """A channel as the kernels want it: kind, values, running bound, dt, tables, number of pieces."""
    nothing = np.zeros(1)
    if isinstance(channel, Samples):
        tail = np.maximum.accumulate(np.abs(channel.values)[::-1])[::-1]
        values, tail = np.ascontiguousarray(channel.values), np.ascontiguousarray(tail)
        return 1, values, tail, channel.dt, np.zeros((1, 1)), len(values) - 1
    if isinstance(channel, Pulses):
        pieces = channel.table.shape[1]
        return 2, nothing, nothing, 1.0, channel.table.reshape(n, pieces * PIECE_WIDTH), pieces
    return 0, nothing, nothing, 1.0, np.zeros((1, 1)), 0


def _estimated_seconds(batch: Batch, parameters: Array) -> float:
    """Rough time of plain Python for the batch [s]."""
    pieces = 0
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Samples):
            pieces += len(channel.values)
    swings = float(np.sum(parameters[:, k.T_STOP] * batch.p.max(axis=1)))
    passes = 2 if "error_estimate" in batch.save.scalars else 1
    return passes * (batch.size * (0.01 + 60e-6 * pieces) + 1e-3 * swings)


# -- running ------------------------------------------------------------------------------------------------


class _Run:
    """Raw output of the kernels for a batch: `out` (n, N_OUT), columns as in `kernels.layout`."""

    def __init__(self, n: int, n_time: int, n_impacts: int) -> None:
        self.out = np.zeros((n, k.N_OUT))
        self.theta = np.full((n, n_time), np.nan)
        self.rate = np.full((n, n_time), np.nan)
        self.t_impact, self.before, self.after = (np.full((n, n_impacts), np.nan) for _ in range(3))


def _march(march: ModuleType, batch: Batch, parameters: Array, level: Accuracy, *, histories: bool) -> _Run:
    n = batch.size
    n_time = 0
    if histories:
        stop = parameters[:, k.T_STOP].max()
        n_time = int(np.floor(stop / batch.save.dt_out * (1.0 + 1e-12))) + 1
    run = _Run(n, n_time, MAX_IMPACTS_STORED if histories else 0)
    arrays = [run.theta, run.rate, run.t_impact, run.before, run.after, run.out]
    horizontal = _channel(batch.excitation.horizontal, n)
    vertical = _channel(batch.excitation.vertical, n)
    rows: Any = np.ascontiguousarray(parameters)
    outputs: list[Any] = arrays
    if not kernels.compiled:  # lists are three times faster than arrays for plain Python
        rows = parameters.tolist()
        horizontal, vertical = _as_lists(horizontal), _as_lists(vertical)
        outputs = [x.tolist() for x in arrays]
    margin = max(2e-14, 10.0 * level.rtol)
    detail = _detail(march, batch, histories)
    march.march_all(
        rows,
        MODELS[batch.model, batch.geometry].linear,
        level.rtol,
        level.rest_speed,
        margin,
        MAX_STEPS[bool(kernels.compiled)],
        _order(level.rtol),
        detail,
        *horizontal,
        *vertical,
        batch.save.dt_out,
        *outputs,
    )
    if not kernels.compiled:
        for array, output in zip(arrays, outputs, strict=True):
            array[...] = output
    return run


def _order(rtol: float) -> int:
    """Order of the Taylor series: about where the cost of a step of given error per unit of time is least."""
    return int(np.clip(round(2.0 - 1.75 * np.log10(rtol)), 8, 30))


def _detail(march: ModuleType, batch: Batch, histories: bool) -> int:
    """How much the kernels have to find out; a given `mu` has to be checked whatever is saved."""
    scalars = batch.save.scalars
    if histories or scalars - PEAK_SCALARS or np.isfinite(batch.block.mu).any():
        return int(march.ALL)
    return int(march.OUTCOME if scalars <= {"outcome", "wall_time", "reason"} else march.PEAKS)


def _as_lists(channel: tuple[int, Any, Any, float, Any, int]) -> tuple[int, Any, Any, float, Any, int]:
    kind, values, tail, dt, tables, pieces = channel
    return kind, values.tolist(), tail.tolist(), dt, tables.tolist(), pieces


# -- naming what came back ----------------------------------------------------------------------------------


def _scalars(batch: Batch, run: _Run) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case from the raw output."""
    out = run.out
    status, verdict = out[:, k.STATUS], out[:, k.FELL]
    moved = np.isfinite(out[:, k.T_UPLIFT])
    fell = verdict == k.FALLS
    impacts = np.rint(out[:, k.N_IMPACTS]).astype(np.int64)
    outcome = np.where(moved, ROCKING, NO_UPLIFT)
    outcome = np.where(fell & (impacts == 0), OVERTURNED_WITHOUT_IMPACT, outcome)
    outcome = np.where(fell & (impacts > 0), OVERTURNED_AFTER_IMPACT, outcome)
    outcome = np.where(verdict == k.UNDECIDED, UNRESOLVED, outcome)
    outcome = np.where(status != k.DONE, FAILED, outcome)

    unknown = outcome < 0
    side = out[:, k.PEAK_SIDE]
    peak = np.where(unknown, np.nan, np.where(fell, np.inf, out[:, k.PEAK]))
    stands = np.where(fell | ~moved | unknown, np.nan, out[:, k.T_PEAK])
    top = batch.block.top * np.sin(np.minimum(out[:, k.PEAK], 0.5 * np.pi))
    failed = outcome == FAILED

    def known(values: Array, missing: NDArray[np.bool_] = failed) -> Array:
        return np.where(missing, np.nan, values)

    scalars: dict[str, NDArray[Any]] = {
        "outcome": outcome.astype(np.int8),
        "theta_peak": np.where(peak == 0.0, 0.0, np.copysign(peak, side)),
        "theta_peak_over_alpha": peak / out[:, k.PEAK_ALPHA],
        "theta_dot_peak": known(np.where(fell, np.inf, out[:, k.RATE_PEAK]), unknown),
        "u_top_peak": known(np.where(fell, np.inf, top), unknown),
        "t_peak": stands,
        "t_uplift": known(out[:, k.T_UPLIFT]),
        "t_overturn": np.where(fell & ~failed, out[:, k.T_OVERTURN], np.nan),
        "t_end": known(out[:, k.T_END]),
        "n_impacts": impacts,
        "mu_required": known(out[:, k.MU]),
        "mu_impact": known(_impact_friction(batch, out[:, k.ONTO_LEFT] > 0, out[:, k.ONTO_RIGHT] > 0)),
        "N_min_over_mg": known(out[:, k.N_MIN]),
        "energy_residual": known(out[:, k.ENERGY] / _barrier(batch)),
        "n_steps": np.rint(out[:, k.N_STEPS]).astype(np.int64),
    }
    return scalars, _reasons(batch, scalars, status)


def _impact_friction(batch: Batch, onto_left: NDArray[np.bool_], onto_right: NDArray[np.bool_]) -> Array:
    """Largest ratio of the impulses at an impact, h (1 - eta)/(b_i + eta b_j) from edge i onto j, (n,)."""
    block, eta = batch.block, batch.damping.eta
    ratio = block.h[:, None] * (1.0 - eta) / (block.b[:, ::-1] + eta * block.b)
    happened = np.column_stack([onto_left, onto_right])
    return np.asarray(np.max(np.where(happened, ratio, 0.0), axis=1))


def _barrier(batch: Batch) -> Array:
    """Energy from upright to the unstable equilibrium of the weak edge, over m g, (n,) [m]."""
    model = MODELS[batch.model, batch.geometry]
    law = model.law(batch.block.alpha, batch.block.tan_alpha)
    q = law.q_star
    if model.linear:
        energy = q * (law.r0 + 0.5 * law.rs * q)
    else:
        energy = law.r0 * q + 2.0 * law.rs * np.sin(0.5 * q) ** 2 + law.rc * np.sin(q)
    return batch.block.of_weak_edge(batch.block.R * energy)


def _reasons(batch: Batch, scalars: dict[str, NDArray[Any]], status: Array) -> list[str]:
    reasons = [""] * batch.size
    outcome, mu = scalars["outcome"], batch.block.mu
    needs = np.fmax(scalars["mu_required"], scalars["mu_impact"])
    with np.errstate(invalid="ignore"):
        slides = needs > mu  # False where no mu is given
        lifts = scalars["N_min_over_mg"] <= 0.0
    many = scalars["n_impacts"] > MAX_IMPACTS_STORED if batch.save.histories else np.zeros(batch.size, bool)
    for i in np.flatnonzero((outcome < 0) | slides | lifts | many):
        said = []
        if status[i] == k.OUT_OF_STEPS:
            said.append(f"gave up after {scalars['n_steps'][i]} steps at t = {scalars['t_end'][i]:.6g} s")
        elif status[i] != k.DONE:
            said.append("the solution ceased to be finite: check the motion and the block for extreme numbers")
        elif outcome[i] == UNRESOLVED:
            said.append("on the separatrix within rounding: whether it overturns cannot be told in double precision")
        if slides[i]:
            said.append(f"needs friction {needs[i]:.4g} but mu = {mu[i]:.4g}: it would slide, which is not simulated")
        if lifts[i]:
            said.append(f"normal force falls to {scalars['N_min_over_mg'][i]:.3g} m g: the body would leave the ground")
        if many[i]:
            said.append(f"{scalars['n_impacts'][i]} impacts, the first {MAX_IMPACTS_STORED} are stored")
        reasons[i] = "; ".join(said)
    return reasons


def _compare(scalars: dict[str, NDArray[Any]], coarse: dict[str, NDArray[Any]], reasons: list[str]) -> None:
    """Error estimate of the peak from a coarser run; `unresolved` where the two disagree on the outcome."""
    fine, rough = scalars["theta_peak_over_alpha"], coarse["theta_peak_over_alpha"]
    with np.errstate(invalid="ignore"):
        estimate = np.abs(fine - rough)
    overturned = scalars["outcome"] >= OVERTURNED_WITHOUT_IMPACT
    agree = overturned == (coarse["outcome"] >= OVERTURNED_WITHOUT_IMPACT)
    scalars["error_estimate"] = np.where(overturned & agree, 0.0, estimate)
    torn = ~agree & (scalars["outcome"] >= NO_UPLIFT) & (coarse["outcome"] >= NO_UPLIFT)
    for i in np.flatnonzero(torn):
        reasons[i] = "; ".join(
            filter(None, [reasons[i], "two accuracies disagree on the outcome: it is too close to a boundary"])
        )
        scalars["outcome"][i] = UNRESOLVED
        for name in ("theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "t_peak"):
            scalars[name][i] = np.nan


def _histories(batch: Batch, run: _Run) -> tuple[dict[str, Array], dict[str, Array], Array]:
    written = np.isfinite(run.theta).any(axis=0)
    n_time = int(np.flatnonzero(written)[-1]) + 1 if written.any() else 1
    theta, rate = run.theta[:, :n_time], run.rate[:, :n_time]
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    live = np.isfinite(theta)
    shaken = np.empty((2, batch.size, n_time))
    for j, channel in enumerate((batch.excitation.horizontal, batch.excitation.vertical)):
        for i in range(batch.size):
            shaken[j, i] = acceleration(channel, t, i)
    duration = batch.excitation.duration[:, None]
    with np.errstate(invalid="ignore"):
        shaken[:, np.broadcast_to(t, theta.shape) > duration] = 0.0
    a_g, a_v = (np.where(live, a, np.nan) for a in shaken)

    block, q = batch.block, np.abs(theta)
    top = block.top[:, None]
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "a_g": a_g,
        "a_v": a_v,
        "u_top": top * np.sin(theta),
        "v_top": -top * (1.0 - np.cos(theta)),
        "M_base": _base_moment(batch, theta, q, a_g, a_v),
    }
    stored = np.isfinite(run.t_impact).any(axis=0)
    n_impacts = int(stored.sum())
    impacts = {
        "t_impact": run.t_impact[:, :n_impacts],
        "theta_dot_before": run.before[:, :n_impacts],
        "theta_dot_after": run.after[:, :n_impacts],
    }
    return histories, impacts, t


def _base_moment(batch: Batch, theta: Array, q: Array, a_g: Array, a_v: Array) -> Array:
    """Moment of the base opposing theta: restoring moment while rocking, -m a_g h at rest, (n, k)."""
    model = MODELS[batch.model, batch.geometry]
    block = batch.block
    law = model.law(block.alpha, block.tan_alpha)

    def of_side(both: Array) -> Array:
        return np.where(theta > 0.0, both[:, RIGHT, None], both[:, LEFT, None])

    r0, rs, rc, R = (of_side(x) for x in (law.r0, law.rs, law.rc, block.R))
    shape = r0 + rs * q if model.linear else r0 + rs * np.sin(q) + rc * np.cos(q)
    rocking = np.sign(theta) * R * (batch.g[:, None] + a_v) * shape
    moment = np.where(theta == 0.0, -a_g * block.h[:, None], rocking)
    mass = np.where(np.isfinite(block.mass), block.mass, 1.0)
    return np.asarray(moment * mass[:, None])
