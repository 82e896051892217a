"""The event-driven solver of the flexible column: from a batch to a response (docs/flexible.md)."""

from __future__ import annotations

import time
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.column import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.constants import REARM
from rockcli.scene.ground.excitation import Pulses, Samples, acceleration
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import MAX_IMPACTS_STORED, Response
from rockcli.solvers.common.certainty import CERTAINTY, Judgement, Perturbation, Traces, judge, perturbed
from rockcli.solvers.common.duration import durations_of, output_times
from rockcli.solvers.common.ground import channel_of, factors_of
from rockcli.solvers.flexible.column import Prepared, RefusedError, first_state, key_of, prepare
from rockcli.solvers.flexible.unpack import Raw, histories_of, scalars_of

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PULSE_STEPS, ROCKING_STEP = 60.0, 0.03
"""Steps per period of a pulse, and the longest step in units of 1/p, at accuracy `draft`."""

PERTURBATION_OF_RECORDS = 1e-5
"""Under records the motion of the second run, and of an ensemble, differs by this share, and under pulses by that of
the level: above the errors of the steps (docs/accuracy.md, docs/flexible.md), which records have at every level."""

WEIGHT = 2.0
"""The error is estimated as this many times the difference that the other step and the other motion make."""

MAX_STEPS = 2_000_000
"""Steps a case may take."""

DECIDE = 200.0
"""Free rocking is followed this many 1/p beyond the report to decide the outcome."""


def solve(batch: Batch) -> Response:
    """Solve every case of the batch; see `Response` for what comes back.

    A column that cannot stand, or is none, is `failed` with a message.
    """
    began = time.perf_counter()
    numerics = batch.numerics
    fineness = _fineness(numerics)
    prepared, refusals = _prepare(batch)
    run = _march(batch, prepared, fineness, histories=batch.save.histories)
    scalars, reasons = scalars_of(batch, run, prepared, refusals)
    if batch.save.scalars & CERTAINTY:
        _judged(batch, prepared, refusals, scalars).enter(scalars, reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    used = {
        "backend": "event",
        "method": "modal steps exact between events, loads by collocation",
        "dt": repr(numerics.dt)
        if numerics.dt is not None
        else f"T_p/{PULSE_STEPS / fineness:g}, {ROCKING_STEP * fineness:g}/p",
    }
    histories, impacts, t = histories_of(batch, run) if batch.save.histories else ({}, {}, np.empty(0))
    return Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)


def _judged(
    batch: Batch, prepared: list[Prepared | None], refusals: list[str], scalars: dict[str, NDArray[Any]]
) -> Judgement:
    """What further runs show: one of another step and another motion, and members of an ensemble of the same step."""
    fineness = _fineness(batch.numerics)
    # a record's samples cap the step at every level: there a run with half of it tells
    sampled = any(isinstance(c, Samples) for c in (batch.excitation.horizontal, batch.excitation.vertical))
    perturbation = PERTURBATION_OF_RECORDS if sampled else batch.numerics.level.perturbation

    def again(rows: Index, factors: Array, fine: bool) -> Traces:
        second = not fine
        other_step = (0.5 if sampled else 2.0) if second else 1.0
        others = perturbed(batch, rows, factors)
        columns, said = [prepared[i] for i in rows], [refusals[i] for i in rows]
        run = _march(others, columns, other_step * fineness, histories=False, halved=sampled and second)
        return Traces.of(others, scalars_of(others, run, columns, said)[0])

    first = Traces.of(batch, scalars)
    return judge(first, again, Perturbation(perturbation, WEIGHT), first.rows, None, perturbation)


def _fineness(numerics: Numerics) -> float:
    """Factor of the accuracy level on the steps of `draft`."""
    return 0.5 * numerics.level.wave_step


def _kernel() -> ModuleType:
    """The kernel module, compiled unless the environment forbids: a column is too much for plain Python."""
    return kernels.load("column.automaton", compile_them=True)


def _prepare(batch: Batch) -> tuple[list[Prepared | None], list[str]]:
    """Columns of all cases (None where refused) and the sentences."""
    made: dict[tuple[float, ...], Prepared | RefusedError] = {}
    columns: list[Prepared | None] = []
    refusals: list[str] = []
    for i in range(batch.size):
        key = key_of(batch, i) if batch.column is not None else ()
        if key not in made:
            try:
                made[key] = prepare(batch, i)
            except RefusedError as refused:
                made[key] = refused
        result = made[key]
        columns.append(result if isinstance(result, Prepared) else None)
        refusals.append("" if isinstance(result, Prepared) else str(result))
    return columns, refusals


def _parameters(batch: Batch, i: int, column: Prepared, fineness: float, halved: bool) -> Array:
    """Parameters of case i in the layout of `kernels.column.layout`; `halved`: sampled motions in half steps."""
    block, excitation = batch.block, batch.excitation
    channels = (excitation.horizontal, excitation.vertical)
    p = float(batch.p[i, 0])
    lasts = durations_of(batch).of(i)
    h_free = fineness * ROCKING_STEP / p
    steps = [h_free]
    for channel in channels:
        if isinstance(channel, Samples):
            steps.append(0.5 * channel.dt if halved else channel.dt)
        elif isinstance(channel, Pulses):
            steps.append(fineness * 2.0 * np.pi / float(channel.omega_p[i]) / PULSE_STEPS)
    h = min(steps)
    if batch.numerics.dt is not None:
        h = h_free = batch.numerics.dt * fineness / _fineness(batch.numerics)
    for channel in channels:
        if isinstance(channel, Samples):
            h = min(h, channel.dt / np.ceil(channel.dt / h * (1.0 - 1e-9)))
    par = np.zeros(at.N_PAR)
    values = {
        at.G: column.g,
        at.LENGTH: column.length,
        at.WIDTH: column.width,
        at.THETA_1: column.theta_1,
        at.ALPHA: float(block.alpha[i, 0]),
        at.P: p,
        at.ETA: float(batch.damping.eta[i, 0]),
        at.REARM: REARM * float(block.alpha[i, 0]),
        at.BARRIER: column.barrier,
        at.THETA_STAR: column.theta_star,
        at.H_MAX: h,
        at.H_FREE: h_free,
        at.T_MOTION: lasts.motion,
        at.T_STOP: lasts.report,
        at.HAS_DURATION: float(lasts.given),
        at.FACTOR_H: factors_of(excitation.horizontal, batch.size)[i],
        at.FACTOR_V: factors_of(excitation.vertical, batch.size)[i],
        at.R_A: column.modes.r_a,
        at.MOBILITY: column.modes.mobility,
        at.TOL: 1e-12 * float(block.alpha[i, 0]),
        at.GIVE_UP: DECIDE / p,
        at.DETAIL: float("energy_residual" in batch.save.scalars),
        at.FINENESS: fineness,
    }
    for place, value in values.items():
        par[place] = value
    return par


def _march(
    batch: Batch, columns: list[Prepared | None], fineness: float, *, histories: bool, halved: bool = False
) -> Raw:
    kernel = _kernel()
    n = batch.size
    parameters = [None if c is None else _parameters(batch, i, c, fineness, halved) for i, c in enumerate(columns)]
    n_time = 0
    if histories:
        stop = max([0.0, *(float(par[at.T_STOP]) for par in parameters if par is not None)])
        n_time = output_times(batch.save.dt_out, stop)
    run = Raw(n, n_time, MAX_IMPACTS_STORED if histories else 0)
    horizontal, h_data = channel_of(kernel, batch.excitation.horizontal, n)
    vertical, v_data = channel_of(kernel, batch.excitation.vertical, n)
    N = 2 * (batch.column.elements if batch.column is not None else 1) + 1
    space = _work_space(N)
    arrays = tuple(space[name] for name in kernel.WORK_SPACE)
    before: Prepared | None = None
    modes = np.empty(0)
    for i, (column, par) in enumerate(zip(columns, parameters, strict=True)):
        if column is None or par is None:
            continue
        start, rate = float(batch.theta_0[i]), float(batch.theta_dot_0[i])
        upright = start == 0.0 and rate == 0.0
        channels = () if upright else (batch.excitation.horizontal, batch.excitation.vertical)
        a_g, a_v = (float(acceleration(one, np.zeros(1), i)[0]) for one in channels) if channels else (0.0, 0.0)
        phase, s, z, v = first_state(column, start, rate, a_g, a_v)
        par[at.PHASE_0], par[at.SIDE_0] = phase, s
        m = column.modes
        if column is not before:
            space["keys"][...], space["filled"][...] = -1.0, 0.0
            modes = np.stack([m.lam, m.c, m.bu, m.th, m.top, m.row, m.row_v])
            before = column
        space["used"][...] = 0.0
        kernel.march(
            par, modes, m.T, z, v, MAX_STEPS,
            horizontal, h_data[i if len(h_data) > 1 else 0], vertical, v_data[i if len(v_data) > 1 else 0],
            batch.save.dt_out, run.histories[i], run.impacts[i], run.out[i], arrays,
        )  # fmt: skip
    return run


def _work_space(N: int) -> dict[str, Array]:
    """Arrays the kernel works in, by name (`automaton.WORK_SPACE`)."""
    from rockcli.kernels.column.events import PACE_SHAPE
    from rockcli.kernels.column.oscillator import INFLUENCES, TABLE_ROWS

    slots = 8
    return {
        "tables": np.zeros((2, slots, TABLE_ROWS, N)),
        "influences": np.zeros((2, slots, INFLUENCES)),
        "keys": np.full((2, slots), -1.0),
        "used": np.zeros((2, slots)),
        "paces": np.zeros((2, *PACE_SHAPE, N)),
        "filled": np.zeros((2, PACE_SHAPE[0])),
        "work": np.zeros((8, N)),
        "S": np.zeros(5),
        "F": np.zeros(24),
        "A": np.zeros(6),
        "about": np.zeros(17),
        "found": np.zeros(4),
    }
