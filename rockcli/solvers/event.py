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
from rockcli.kernels.rigid import layout as k
from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Samples
from rockcli.scene.models import MODELS
from rockcli.scene.numerics import Accuracy
from rockcli.scene.response import MAX_IMPACTS_STORED, NO_UPLIFT, Response
from rockcli.solvers import lane_pulses, lane_records
from rockcli.solvers.agreement import compare_accuracies, disagreement, horizon_of, parted_later
from rockcli.solvers.pack import channel_of, parameters_of
from rockcli.solvers.sliding import with_sliding
from rockcli.solvers.unpack import Raw, histories_of, scalars_of

Array = NDArray[np.float64]

MAX_STEPS = {True: 20_000_000, False: 30_000}
"""Steps a case may take, compiled or not; a case that needs more uncompiled is solved again compiled."""

METHOD = "Taylor series to order {}, events located on the polynomial"

COMPILE_ABOVE = 2.0
"""Estimated seconds of plain Python above which the kernels are compiled."""

FORCES = frozenset({"theta_dot_peak", "mu_required", "N_min_over_mg", "energy_residual"})
"""Scalars that cost a look along every step; NaN when nothing of the kind is wanted."""

COARSER, FINEST = 1e3, 1e-16
"""The error estimate is the difference to a run with this many times the tolerance; where that leaves an outcome in
doubt, to one with so many times less, down to the finest."""

CONFIRMED = 0.1
"""The finer run confirms within this part of the horizon: more, and the errors of the coarser one, a thousand times as
large, have been everything there is, so that these may agree by chance."""


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with the event-driven kernels; see `Response` for what comes back.

    A case that cannot be solved is `failed` with a sentence; an outcome that rounding would decide, or that two
    accuracies leave unknown, is `unresolved`.
    """
    began = time.perf_counter()
    level = batch.numerics.tolerances
    parameters = parameters_of(batch)
    pulses, records = lane_pulses.asked(batch), lane_records.asked(batch)
    seconds = lane_pulses.SECONDS * batch.size if pulses else _estimated_seconds(batch, parameters)
    march = kernels.load(compile_them=records or seconds > COMPILE_ABOVE)
    in_lanes = pulses or (records and bool(kernels.compiled))

    def attempt() -> Raw:
        if in_lanes:
            return _lanes(march, batch, parameters, level)
        return _march(march, batch, parameters, level, histories=batch.save.histories)

    run = attempt()
    if not kernels.compiled and np.any(run.out[:, k.STATUS] == k.OUT_OF_STEPS):
        march = kernels.load(compile_them=True)
        run = attempt()  # by the same kernels, so that no case depends on those it is solved with

    scalars, reasons = scalars_of(batch, run)
    if "error_estimate" in batch.save.scalars:
        _compare(march, batch, parameters, level, scalars, reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    used = {
        "backend": "event",
        "method": _method(pulses, in_lanes, level),
        "rtol": repr(level.rtol),
        "rest_speed": repr(level.rest_speed),
        "kernels": "compiled" if kernels.compiled else "interpreted",
    }
    histories, impacts, t = histories_of(batch, run) if batch.save.histories else ({}, {}, np.empty(0))
    response = Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)
    return with_sliding(batch, response, MAX_STEPS[bool(kernels.compiled)])


def _compare(
    march: ModuleType, batch: Batch, parameters: Array, level: Accuracy, scalars: dict[str, Any], reasons: list[str]
) -> None:
    """Error estimates from a coarser run; of cases it leaves in doubt from a finer one, which knows better."""
    coarse = Accuracy(max(level.rtol, FINEST) * COARSER, level.rest_speed * 10.0)
    horizon = np.full(batch.size, horizon_of(coarse.rtol))
    again = _march(march, batch, parameters, coarse, histories=False)
    other, _ = scalars_of(batch, again)
    sure = disagreement(batch, scalars, other, horizon) < horizon  # not where the other run has no answer
    sure &= ~parted_later(scalars, other)
    doubted = np.flatnonzero(~sure & (scalars["outcome"] >= NO_UPLIFT))
    if len(doubted) and level.rtol > FINEST:
        finer = Accuracy(max(level.rtol / COARSER, FINEST), level.rest_speed / 10.0)
        alone = Raw(len(doubted), 0, 0)
        rows = np.ascontiguousarray(parameters[doubted])
        _march_rows(march, batch, rows, finer, alone, _detail(march, batch, False), cases=doubted)
        answered = (alone.out[:, k.STATUS] == k.DONE) & (alone.out[:, k.FELL] != k.UNDECIDED)
        again.out[doubted[answered]] = alone.out[answered]
        horizon[doubted[answered]] *= CONFIRMED
        other, _ = scalars_of(batch, again)
    compare_accuracies(batch, scalars, other, reasons, horizon, to_the_end=True)


def _estimated_seconds(batch: Batch, parameters: Array) -> float:
    """Rough time of plain Python for the batch [s]."""
    pieces = 0
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Samples):
            pieces += len(channel.values)
    swings = float(np.sum(parameters[:, k.T_STOP] * batch.p.max(axis=1)))
    passes = 2 if "error_estimate" in batch.save.scalars else 1
    return passes * (batch.size * (0.01 + 60e-6 * pieces) + 1e-3 * swings)


def _method(pulses: bool, in_lanes: bool, level: Accuracy) -> str:
    if not in_lanes:
        return METHOD.format(_order(level.rtol))
    return lane_pulses.METHOD if pulses else lane_records.METHOD


def _lanes(march: ModuleType, batch: Batch, parameters: Array, level: Accuracy) -> Raw:
    """A map of pulses or of a record in lanes; one by one those of two different edges, with a given duration or mu,
    and those the lanes hand over."""
    rows = np.ascontiguousarray(parameters)
    margin, detail = _margin(level), _detail(march, batch, False)
    compiled = bool(kernels.compiled)
    run = Raw(batch.size, 0, 0)
    left_edge, right_edge = (rows[:, side : side + k.EDGE] for side in (k.LEFT, k.RIGHT))
    fit = np.all(left_edge == right_edge, axis=1) & (rows[:, k.HAS_DURATION] == 0.0) & ~np.isfinite(batch.block.mu)
    pulses = lane_pulses.asked(batch)
    if not pulses:
        fit &= lane_records.fit(batch, rows)
    cases = slice(None) if fit.all() else np.flatnonzero(fit)  # mostly all, and then nothing is copied
    if pulses:
        lanes = kernels.load("lanes.pulses.march", compile_them=compiled)
        found = lane_pulses.run(lanes, batch, rows[cases], level, margin, detail, cases)
    else:
        lanes = kernels.load("lanes.records.march", compile_them=compiled)
        found = lane_records.run(lanes, batch, rows[cases], level, _order(level.rtol), margin, detail)
    run.out[:, k.STATUS] = np.nan
    run.out[cases] = found
    left = np.flatnonzero(np.isnan(run.out[:, k.STATUS]))
    if len(left):
        alone = Raw(len(left), 0, 0)
        _march_rows(march, batch, rows[left], level, alone, detail, cases=left)
        run.out[left] = alone.out
    return run


def _margin(level: Accuracy) -> float:
    """Distance from a separatrix, in units of rotation, below which the outcome is unresolved."""
    return max(2e-14, 10.0 * level.rtol)


def _march(march: ModuleType, batch: Batch, parameters: Array, level: Accuracy, *, histories: bool) -> Raw:
    n = batch.size
    n_time = 0
    if histories:
        stop = parameters[:, k.T_STOP].max()
        n_time = int(np.floor(stop / batch.save.dt_out * (1.0 + 1e-12))) + 1
    run = Raw(n, n_time, MAX_IMPACTS_STORED if histories else 0)
    _march_rows(march, batch, np.ascontiguousarray(parameters), level, run, _detail(march, batch, histories))
    return run


def _march_rows(
    march: ModuleType, batch: Batch, rows: Any, level: Accuracy, run: Raw, detail: int, cases: Any = slice(None)
) -> None:
    """The single-body kernels for the rows of parameters of some cases of the batch, into `run`."""
    arrays = [run.theta, run.rate, run.t_impact, run.before, run.after, run.out]
    horizontal = channel_of(batch.excitation.horizontal, batch.size, cases)
    vertical = channel_of(batch.excitation.vertical, batch.size, cases)
    outputs: list[Any] = arrays
    if not kernels.compiled:  # lists are three times faster than arrays for plain Python
        rows = rows.tolist()
        horizontal, vertical = _as_lists(horizontal), _as_lists(vertical)
        outputs = [x.tolist() for x in arrays]
    march.march_all(
        rows,
        MODELS[batch.model, batch.geometry].linear,
        level.rtol,
        level.rest_speed,
        _margin(level),
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


def _order(rtol: float) -> int:
    """Order of the Taylor series: about where the cost of a step of given error per unit of time is least."""
    return int(np.clip(round(2.0 - 1.75 * np.log10(rtol)), 8, 30))


def _detail(march: ModuleType, batch: Batch, histories: bool) -> int:
    """How much the kernels have to find out; a given `mu` has to be checked whatever is saved."""
    scalars = batch.save.scalars
    if histories or scalars & FORCES or np.isfinite(batch.block.mu).any():
        return int(march.ALL)
    return int(march.OUTCOME if scalars <= {"outcome", "wall_time", "reason"} else march.PEAKS)


def _as_lists(channel: tuple[int, Any, Any, float, Any, int]) -> tuple[int, Any, Any, float, Any, int]:
    kind, values, tail, dt, tables, pieces = channel
    return kind, values.tolist(), tail.tolist(), dt, tables.tolist(), pieces
