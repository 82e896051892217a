"""Bodies that roll over several vertices, solved by `kernels.rolling`."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.constants import DONE, NO_ANSWER, OUT_OF_STEPS
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.scene.batch import Batch
from rockcli.scene.body.lower_outline import Facets
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.numerics import Accuracy
from rockcli.scene.response import MAX_IMPACTS_STORED, Response
from rockcli.solvers.common.certainty import CERTAINTY, Judgement, Traces, judge, perturbed
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.ground import channel_of
from rockcli.solvers.contact.solver import Opened, with_contact
from rockcli.solvers.event.pack import order_of, settings_of
from rockcli.solvers.event.perturbations import finer_than, perturbations
from rockcli.solvers.event.pulse_lanes import path_asked
from rockcli.solvers.event.unpack import FORCES, Raw
from rockcli.solvers.rolling import pulse_lanes, record_lanes
from rockcli.solvers.rolling.answers import answer, histories_of
from rockcli.solvers.rolling.pack import facets_in, parameters_of

Array = NDArray[np.float64]
Index = NDArray[np.int64]

LANES: dict[str, Any] = {"lanes.pulses.march": pulse_lanes, "lanes.records.march": record_lanes}
"""What takes bodies into the lanes of a kernel."""

METHOD_OF_ROLLING = "Taylor series to order {} from vertex to vertex, events located on the polynomial"


def solve(batch: Batch) -> Response:
    """Solve a batch of bodies that all roll; see `Response` and `solvers.event.solver`."""
    began = time.perf_counter()
    level = batch.numerics.tolerances
    facets = facets_in(batch)
    seconds = _estimated_seconds(batch, facets)
    compiled_only = record_lanes.asked(batch) or path_asked(batch)  # as of two edges, however few they are
    ready = pulse_lanes.asked(batch) and kernels.compiled_ahead()  # with the same bits
    kernels.load("rolling.march", compile_them=compiled_only or ready or kernels.pays(seconds))
    way = _way(batch)
    run = _run(batch, facets, level, way, histories=batch.save.histories)
    judgement = _judged(batch, facets, level, run, way, seconds) if batch.save.scalars & CERTAINTY else None
    scalars, reasons = answer(batch, facets, run)
    if judgement is not None:
        judgement.enter(scalars, reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    used = {
        "backend": "event",
        "method": LANES[way].method(batch) if way else METHOD_OF_ROLLING.format(order_of(level.rtol)),
        "rtol": repr(level.rtol),
        "rest_speed": repr(level.rest_speed),
    }
    histories, impacts, t = histories_of(batch, facets, run) if batch.save.histories else ({}, {}, np.empty(0))
    response = Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)
    nothing = np.zeros(batch.size, dtype=bool)
    return with_contact(batch, response, level, Opened(nothing, nothing))


def _way(batch: Batch) -> str:
    """The kernel of the lanes that find what is asked, "" where none do."""
    if record_lanes.asked(batch) and kernels.compiled:
        return "lanes.records.march"
    return "lanes.pulses.march" if pulse_lanes.asked(batch) else ""


def _run(batch: Batch, facets: Facets, level: Accuracy, way: str, *, histories: bool) -> Raw:
    """Raw results, by the lanes of a kernel as far as they go.

    A case that needs more steps than plain Python may take is solved again compiled.
    """
    pars, bodies = parameters_of(batch, facets)
    n_time = output_times(batch.save.dt_out, pars[:, at.T_STOP].max()) if histories else 0

    def attempt() -> Raw:
        run = Raw(batch.size, n_time, MAX_IMPACTS_STORED if histories else 0)
        run.out = np.zeros((batch.size, also.N_OUT))
        alone = ~LANES[way].fit(batch, pars, bodies) if way else np.ones(batch.size, dtype=bool)
        if not alone.all():
            cases = np.flatnonzero(~alone)
            lanes = kernels.load(way, compile_them=bool(kernels.compiled))
            how = settings_of(lanes, batch, level, _detail(batch))
            run.out[cases] = LANES[way].run(lanes, batch, pars, bodies, how, cases)
            alone |= np.isnan(run.out[:, to.STATUS])
        if alone.all():
            _march(batch, pars, bodies, level, run)
        elif alone.any():
            rest = Raw(int(alone.sum()), 0, 0)
            rest.out = np.zeros((int(alone.sum()), also.N_OUT))
            _march(batch.rows(np.flatnonzero(alone)), np.ascontiguousarray(pars[alone]), bodies, level, rest)
            run.out[alone] = rest.out
        return run

    run = attempt()
    if not kernels.compiled and np.any(run.out[:, to.STATUS] == OUT_OF_STEPS):
        kernels.load("rolling.march", compile_them=True)
        run = attempt()
    return run


def _march(batch: Batch, pars: Array, bodies: Array, level: Accuracy, run: Raw) -> None:
    if batch.excitation.suite is not None:
        for places, one in batch.apart():
            alone = Raw(len(places), run.histories.shape[2], run.impacts.shape[2])
            alone.out = np.zeros((len(places), also.N_OUT))
            _march(one, np.ascontiguousarray(pars[places]), bodies, level, alone)
            run.put(places, alone)
        return
    kernel = kernels.load("rolling.march", compile_them=bool(kernels.compiled))
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    (horizontal, h_data), (vertical, v_data) = (channel_of(kernel, c, batch.size) for c in channels)
    arrays = [run.histories, run.impacts, run.out]
    inputs: list[Any] = [pars, bodies, h_data, v_data]
    outputs: list[Any] = list(arrays)
    if not kernels.compiled:  # lists are three times faster than arrays for plain Python
        inputs, outputs = [x.tolist() for x in inputs], [x.tolist() for x in arrays]
    rows, table, h_data, v_data = inputs
    how = settings_of(kernel, batch, level, _detail(batch))
    spaces = kernel.work_space()
    kernel.march_all(
        rows, table, how, horizontal, h_data, vertical, v_data, batch.save.dt_out, *outputs[:2], spaces, outputs[2]
    )
    if not kernels.compiled:
        for array, output in zip(arrays, outputs, strict=True):
            array[...] = output


def _detail(batch: Batch) -> int:
    """How much the kernel has to find out, `kernels.rolling.march.OUTCOME`, `PEAKS` or `ALL`."""
    scalars = batch.save.scalars
    if batch.save.histories or scalars & FORCES or np.isfinite(batch.block.mu).any():
        return 2
    return 0 if scalars <= {"outcome", "wall_time", "reason", "residual_tilt"} else 1


def _judged(batch: Batch, facets: Facets, level: Accuracy, run: Raw, way: str, seconds: float) -> Judgement:
    """What further runs show; where two part, the more accurate one takes the place of the first in `run`.

    The more accurate ones are those of the single body: what lanes take small bounces for does not get better with the
    tolerance.  Lanes take none where they did not take the first (`way`).
    """
    finer = finer_than(level)
    peaks = replace(
        batch,
        block=replace(batch.block, mu=np.full(batch.size, np.nan)),  # friction moves nothing here
        save=replace(batch.save, histories=False, scalars=frozenset({"theta_peak", "error_estimate"})),
    )

    def again(rows: Index, factors: Array, fine: bool) -> Traces:
        kernels.load("rolling.march", compile_them=kernels.pays(seconds / batch.size * len(rows)))
        others = perturbed(peaks, rows, factors)
        its = facets_in(others)
        how_well = finer if fine else level
        its_way = _way(others) if way and not fine else ""
        return traces_of(others, its, _run(others, its, how_well, its_way, histories=False).out)

    def refine(rows: Index) -> Traces:
        if finer.rtol < level.rtol:
            some = batch.rows(rows)
            run.put(rows, _as_long(_run(some, facets_in(some), finer, "", histories=batch.save.histories), run))
        return traces_of(batch, facets, run.out).rows(rows)

    first, second, reach = perturbations(level, finer)
    found = judge(traces_of(batch, facets, run.out), again, first, refine, second, reach)
    # rotations were compared over that of the last barrier; the error is told of theta/alpha, as the peak is
    return replace(found, error=found.error * np.abs(facets.fall).min(axis=1) / batch.block.alpha.min(axis=1))


def _as_long(run: Raw, whole: Raw) -> Raw:
    """Runs of some cases with histories as long as those of all."""
    missing = whole.histories.shape[2] - run.histories.shape[2]
    run.histories = np.pad(run.histories, ((0, 0), (0, 0), (0, missing)), constant_values=np.nan)
    return run


def traces_of(batch: Batch, facets: Facets, out: Array) -> Traces:
    """What is compared of runs: rotations over that of the last barrier of their side."""
    p = batch.p.min(axis=1)
    verdict = np.where(out[:, to.STATUS] == DONE, out[:, to.VERDICT], NO_ANSWER).astype(np.int8)
    left, right = np.abs(facets.fall).T
    swings = out[:, to.SWINGS]
    when = np.divide(out[:, to.SWINGS_T] * p, swings, out=np.zeros_like(swings), where=swings > 0.0)
    sides = np.maximum(out[:, to.PEAK_LEFT] / left, out[:, to.PEAK_RIGHT] / right)
    return Traces(verdict, out[:, to.T_OVERTURN] * p, sides, swings, when)


def _estimated_seconds(batch: Batch, facets: Facets) -> float:
    """Rough time of plain Python for the batch [s]."""
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    pieces = float(sum(len(channel.values) for channel in channels if isinstance(channel, Samples)))
    if batch.excitation.suite is not None:
        pieces += float(np.mean([len(record.values) for record in batch.excitation.suite.records]))
    passes = 2 if batch.save.scalars & CERTAINTY else 1
    return float(passes * batch.size * (0.02 + 60e-6 * pieces + 1e-3 * facets.tilt.shape[1]))
