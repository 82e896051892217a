"""The event-driven solver: exact flow between located events (docs/theory.md).

Packs a batch into the parameter vectors of the kernels, runs them compiled or as plain Python, whichever
is faster for the amount of work, and names what comes back.
"""

from __future__ import annotations

import time
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.constants import DONE, NO_ANSWER, OUT_OF_STEPS, RETURNS
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Pulses, Samples
from rockcli.scene.laws.contact import slides_only
from rockcli.scene.numerics import Accuracy
from rockcli.scene.response import MAX_IMPACTS_STORED, Response, merged
from rockcli.solvers.common.certainty import (
    CERTAINTY,
    Judgement,
    Traces,
    judge,
    perturbed,
)
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.ground import channel_of
from rockcli.solvers.contact.screen import surely_holds, surely_presses
from rockcli.solvers.contact.solver import Opened, has_contact_forces, leaves_rocking, with_contact
from rockcli.solvers.contact.turns import BESIDE, by_turns, can_take_turns
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event import record_lanes as lane_records
from rockcli.solvers.event.pack import order_of, parameters_of, settings_of
from rockcli.solvers.event.perturbations import finer_than, perturbations
from rockcli.solvers.event.unpack import FORCES, Raw, friction_and_normal, histories_of, scalars_of
from rockcli.solvers.rolling import solver as rolling_bodies

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

METHOD = "Taylor series to order {}, events located on the polynomial"


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with the event-driven kernels; see `Response` for what comes back.

    A case that cannot be solved is `failed` with a message; an outcome that rounding would decide, or that differs
    within the tolerance, is `unresolved`.
    """
    rolls = batch.block.rolls
    if not rolls.any():
        return _on_two_edges(batch)
    if rolls.all():
        return rolling_bodies.solve(batch)
    rows, others = np.flatnonzero(rolls), np.flatnonzero(~rolls)
    parts = [(others, _on_two_edges(batch.rows(others))), (rows, rolling_bodies.solve(batch.rows(rows)))]
    return merged(batch.size, parts)


def _on_two_edges(batch: Batch) -> Response:
    began = time.perf_counter()
    level = batch.numerics.tolerances
    parameters = parameters_of(batch)
    pulses = lane_pulses.asked(batch)
    compiled_only = lane_records.asked(batch) or lane_pulses.path_asked(batch)
    seconds = lane_pulses.SECONDS * batch.size if pulses else _estimated_seconds(batch, parameters)
    # who solves a case hangs on what is asked alone, how its kernels run also on how many there are: with the same bits
    ready = pulses and kernels.compiled_ahead()  # sooner than lanes in plain Python, however few
    march = kernels.load(compile_them=compiled_only or ready or kernels.pays(seconds))
    in_lanes = pulses or (bool(kernels.compiled) and compiled_only)

    def attempt() -> tuple[Raw, Opened]:
        if in_lanes:
            return _lanes(march, batch, parameters, level)
        run = _march(march, batch, parameters, level, histories=batch.save.histories)
        return run, Opened(np.zeros(batch.size, dtype=bool), np.zeros(batch.size, dtype=bool))

    run, opened = attempt()
    if not kernels.compiled and np.any(run.out[:, to.STATUS] == OUT_OF_STEPS):
        march = kernels.load(compile_them=True)
        run, opened = attempt()  # by the same kernels, so that no case depends on those it is solved with

    judgement, leaves = None, _surely_leave(batch, run)
    if batch.save.scalars & CERTAINTY:
        judgement = _judged(batch, parameters, level, run, leaves, in_lanes=in_lanes)
    scalars, reasons = scalars_of(batch, run, leaves)
    if judgement is not None:
        judgement.enter(scalars, reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    used = {
        "backend": "event",
        "method": _method(batch, in_lanes, level),
        "rtol": repr(level.rtol),
        "rest_speed": repr(level.rest_speed),
    }
    histories, impacts, t = histories_of(batch, run) if batch.save.histories else ({}, {}, np.empty(0))
    response = Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)
    return with_contact(batch, response, level, opened)


def _judged(batch: Batch, parameters: Array, level: Accuracy, run: Raw, leaves: Mask, *, in_lanes: bool) -> Judgement:
    """What further runs show; where two part, the more accurate one takes the place of the first in `run`.

    What was solved in lanes is solved there again, as far as their tolerances go.  Not judged are those that do not
    end as pure rocking has it, `leaves`.
    """
    finer = finer_than(level)
    peaks = replace(
        batch,
        block=replace(batch.block, mu=np.full(batch.size, np.nan)),  # friction moves nothing here
        save=replace(batch.save, histories=False, scalars=frozenset({"theta_peak", "error_estimate"})),
    )
    seconds = _estimated_seconds(batch, parameters) / batch.size

    def again(rows: Index, factors: Array, fine: bool) -> Traces:
        # the same bits compiled or not, so that an ensemble may be compiled where one run was not
        kernel = kernels.load(compile_them=kernels.pays(seconds * len(rows)))
        others = perturbed(peaks, rows, factors)
        packed = parameters_of(others)
        how_well = finer if fine else level
        if in_lanes and how_well.rtol >= lane_records.FINEST_AGAIN:
            raw, _ = _lanes(kernel, others, packed, how_well)
        else:
            raw = _march(kernel, others, packed, how_well, histories=False)
        return Traces.of_kernel(others, raw.out, to)

    def refine(rows: Index) -> Traces:
        if finer.rtol < level.rtol:
            kernel = kernels.load(compile_them=bool(kernels.compiled))
            some = np.ascontiguousarray(parameters[rows])
            if in_lanes and finer.rtol >= lane_records.FINEST_AGAIN:
                alone, _ = _lanes(kernel, batch.rows(rows), some, finer)
            else:
                alone = Raw(len(rows), run.histories.shape[2], run.impacts.shape[2])
                detail = _detail(kernel, batch, batch.save.histories)
                _march_rows(kernel, batch, some, finer, alone, detail, cases=rows)
            run.put(rows, alone)
        return Traces.of_kernel(batch, run.out, to).rows(rows)

    first, second, reach = perturbations(level, finer)
    runs = Traces.of_kernel(batch, run.out, to)
    runs = replace(runs, verdict=np.where(leaves, NO_ANSWER, runs.verdict).astype(np.int8))
    return judge(runs, again, first, refine, second, reach)


def _surely_leave(batch: Batch, run: Raw) -> Mask:
    """Cases with a `mu` of which forces of pure rocking are known and say that they slide or leave the ground, (n,)."""
    if not np.isfinite(batch.block.mu).any():
        return np.zeros(batch.size, dtype=bool)
    needs, least = friction_and_normal(batch, run.out)
    leaves = leaves_rocking(batch, np.where(batch.block.rise == 0.0, needs, np.nan), least)
    return np.asarray(np.isfinite(batch.block.mu) & leaves)


def _estimated_seconds(batch: Batch, parameters: Array) -> float:
    """Rough time of plain Python for the batch [s]."""
    pieces = 0.0
    for channel in (batch.excitation.horizontal, batch.excitation.vertical):
        if isinstance(channel, Samples):
            pieces += len(channel.values)
    if batch.excitation.suite is not None:
        pieces += float(np.mean([len(record.values) for record in batch.excitation.suite.records]))
    swings = float(np.sum(parameters[:, at.T_STOP] * batch.p.max(axis=1)))
    passes = 2 if batch.save.scalars & CERTAINTY else 1
    return passes * (batch.size * (0.01 + 60e-6 * pieces) + 1e-3 * swings)


def _method(batch: Batch, in_lanes: bool, level: Accuracy) -> str:
    if not in_lanes:
        return METHOD.format(order_of(level.rtol))
    if lane_records.asked(batch):
        return lane_records.METHOD
    return lane_pulses.METHOD if lane_pulses.asked(batch) else lane_pulses.METHOD_ON_PATH


def _lanes(march: ModuleType, batch: Batch, parameters: Array, level: Accuracy) -> tuple[Raw, Opened]:
    """A map of pulses or of a record in lanes, and where it is open whether friction holds a body.

    One by one those the lanes do not take, and those they hand over.  What is found without a `mu` is found alike with
    one, so that friction that holds changes no bit.  Where nothing is asked of those that slide but what they do,
    bodies under a record go by turns.  Else, where that tells no forces, and how far a body rocks does not settle it
    (K15), the lanes look at its forces in a run of their own.  Open are those that may need more friction than there
    is; of bodies without consistent contact forces that is told from the forces of pure rocking, one by one.  Bodies
    that only slide do not rock at all unless it is asked what that would have needed.
    """
    rows = np.ascontiguousarray(parameters)
    given = np.isfinite(batch.block.mu)
    compiled = bool(kernels.compiled)
    pulses = isinstance(batch.excitation.horizontal, Pulses)
    fit = lane_pulses.fit(batch, rows) if pulses else lane_records.fit(batch, rows)
    whole = fit.all() and not given.any()  # mostly so, and then nothing is copied
    run = Raw(batch.size, 0, 0, np.empty((0, to.N_OUT)) if whole else None)
    detail = _detail(march, batch, False)
    forces = bool(batch.save.scalars & FORCES)
    how_much = int(march.PEAKS) if given.any() and not forces else detail
    none = np.zeros(batch.size, dtype=bool)
    turns, idle, open_, slides, slid = none, none, none.copy(), none.copy(), None
    if given.any() and not batch.save.scalars & BESIDE:
        idle = slides_only(batch) & has_contact_forces(batch) & (batch.excitation.vertical is None)
        turns = none if pulses else fit & can_take_turns(batch) & has_contact_forces(batch)
    run.out[:, to.STATUS] = np.nan
    if idle.any():
        run.out[idle] = _never_moved(run.out.shape[1])
        fit &= ~idle
    if turns.any():
        taking = np.flatnonzero(turns)
        run.out[taking], slides[taking], slid = by_turns(
            batch if turns.all() else batch.rows(taking), rows[taking], level
        )
        fit &= ~turns
    cases = slice(None) if fit.all() else np.flatnonzero(fit)
    if pulses:
        lanes = kernels.load("lanes.pulses.march", compile_them=compiled)
        how, path = settings_of(lanes, batch, level, how_much), lane_pulses.path_asked(batch)
        found = lane_pulses.run(lanes, batch, rows[cases], how, cases, path=path)
    else:
        lanes = kernels.load("lanes.records.march", compile_them=compiled)
        some = None if fit.all() else np.flatnonzero(fit)
        found = lane_records.run(lanes, batch, rows[cases], settings_of(lanes, batch, level, how_much), cases=some)
    if fit.all():
        run.out = found
    else:
        run.out[cases] = found
    if given.any() and not forces and not turns.all():
        held = surely_holds(batch, run.out[:, to.PEAK], run.out[:, to.VERDICT] == RETURNS)
        open_ = given & ~turns & ~held & ~slides_only(batch) & ~np.isnan(run.out[:, to.STATUS])
        asked = np.flatnonzero(open_ & has_contact_forces(batch) if pulses else open_)
        if len(asked) and (compiled or not pulses):
            how = settings_of(lanes, batch, level, int(lanes.ALL))
            if pulses:
                forced = lane_pulses.run(lanes, batch, rows[asked], how, asked, path=True)
            else:
                forced = lane_records.run(lanes, batch, rows[asked], how, cases=asked)
            needs, least = friction_and_normal(batch.rows(asked), forced)
            open_[asked] = ~surely_presses(batch.block.mu[asked], needs, least)
        run.out[open_ & ~has_contact_forces(batch), to.STATUS] = np.nan
        open_ &= ~np.isnan(run.out[:, to.STATUS])
    left = np.flatnonzero(np.isnan(run.out[:, to.STATUS]))
    if len(left):
        alone = Raw(len(left), 0, 0)
        _march_rows(march, batch, rows[left], level, alone, detail, cases=left)
        run.out[left] = alone.out
    return run, Opened(open_, slides, slid)


def _never_moved(n: int) -> Any:
    """Results of a body of which nothing is told here, (n,)."""
    out = np.zeros(n)
    out[[to.T_PEAK, to.T_UPLIFT, to.T_OVERTURN]] = np.nan
    out[[to.STATUS, to.VERDICT, to.PEAK_ALPHA]] = DONE, RETURNS, 1.0
    return out


def _march(march: ModuleType, batch: Batch, parameters: Array, level: Accuracy, *, histories: bool) -> Raw:
    n = batch.size
    n_time = 0
    if histories:
        n_time = output_times(batch.save.dt_out, parameters[:, at.T_STOP].max())
    run = Raw(n, n_time, MAX_IMPACTS_STORED if histories else 0)
    _march_rows(march, batch, np.ascontiguousarray(parameters), level, run, _detail(march, batch, histories))
    return run


def _march_rows(
    march: ModuleType, batch: Batch, rows: Any, level: Accuracy, run: Raw, detail: int, cases: Any = slice(None)
) -> None:
    """The single-body kernels for the rows of parameters of some cases of the batch, into `run`."""
    if batch.excitation.suite is not None:
        some = batch.rows(np.arange(batch.size)[cases])
        for places, one in some.apart():
            alone = Raw(len(places), run.histories.shape[2], run.impacts.shape[2])
            _march_rows(march, one, np.ascontiguousarray(rows[places]), level, alone, detail)
            run.put(places, alone)
        return
    arrays = [run.histories, run.impacts, run.out]
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    (horizontal, h_data), (vertical, v_data) = (channel_of(march, c, batch.size, cases) for c in channels)
    inputs, outputs = [rows, h_data, v_data], list(arrays)
    if not kernels.compiled:  # lists are three times faster than arrays for plain Python
        inputs, outputs = [x.tolist() for x in inputs], [x.tolist() for x in arrays]
    rows, h_data, v_data = inputs
    how = settings_of(march, batch, level, detail)
    histories, impacts, out = outputs
    march.march_all(
        rows, how, horizontal, h_data, vertical, v_data, batch.save.dt_out, histories, impacts, march.work_space(), out
    )
    if not kernels.compiled:
        for array, output in zip(arrays, outputs, strict=True):
            array[...] = output


def _detail(march: ModuleType, batch: Batch, histories: bool) -> int:
    """How much the kernels have to find out; a given `mu` has to be checked whatever is saved."""
    scalars = batch.save.scalars
    if histories or scalars & FORCES or np.isfinite(batch.block.mu).any():
        return int(march.ALL)
    return int(march.OUTCOME if scalars <= {"outcome", "wall_time", "reason"} else march.PEAKS)
