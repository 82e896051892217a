"""`solve(batch)` of the backend `frame`: case by case through the compiled kernels."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.errors import SolverError
from rockcli.kernels.frame import layout as at
from rockcli.scene.backends import unfit_beams
from rockcli.scene.batch import Batch
from rockcli.scene.constants import COARSER
from rockcli.scene.response import MAX_IMPACTS_STORED, Response
from rockcli.solvers.common.certainty import CERTAINTY, compare_steps
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.frame.case import Kernels, case_of
from rockcli.solvers.frame.results import histories_of, scalars_of

Array = NDArray[np.float64]


@dataclass
class Runs:
    """Raw results of a batch: `out` (n, N_OUT) of `kernels.frame.layout`; per case its par, history and impacts."""

    out: Array
    par: list[Array] = field(default_factory=list)
    mass: list[float] = field(default_factory=list)
    history: list[Array] = field(default_factory=list)
    impacts: list[Array] = field(default_factory=list)


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with beam elements on a yielding base; see `Response` for what comes back.

    A case whose steps do not converge is `failed` with the time and a sentence.

    Raises:
        SolverError: the batch asks for what these elements cannot do.
    """
    began = time.perf_counter()
    if why := unfit_beams(batch):
        raise SolverError(why)
    if not batch.block.symmetric.all():
        raise SolverError("backend frame solves symmetric bodies only")
    if batch.model == "flexible" and batch.column is None:
        raise SolverError("model flexible needs a column")
    runs = run(batch, histories=batch.save.histories)
    scalars, reasons = scalars_of(batch, runs.out, runs.par)
    if batch.save.scalars & CERTAINTY:
        rough = run(batch, histories=False, coarser=COARSER)
        compare_steps(batch, scalars, scalars_of(batch, rough.out, rough.par)[0], reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    histories: dict[str, Array] = {}
    impacts: dict[str, Array] = {}
    t = np.empty(0)
    if batch.save.histories:
        histories, impacts, t = histories_of(batch, runs.mass, runs.history, runs.impacts)
    return Response(scalars, reasons, t, histories, impacts, _used(batch, runs))


def load() -> Kernels:
    """The kernels, compiled unless ROCK_KERNELS says otherwise."""
    return Kernels(*(kernels.load(f"frame.{name}", compile_them=True) for name in ("march", "newmark", "elements")))


def run(batch: Batch, *, histories: bool, coarser: float = 1.0) -> Runs:
    """Run every case, its time step and yield rotation multiplied by `coarser`."""
    kernel = load()
    runs = Runs(np.zeros((batch.size, at.N_OUT)))
    for i in range(batch.size):
        case = case_of(batch, i, kernel, coarser=coarser)
        N = len(case.u)
        rows = output_times(batch.save.dt_out, case.par[at.T_STOP]) if histories else 0
        history = np.full((rows, at.N_HISTORY), np.nan)
        impacts = np.full((MAX_IMPACTS_STORED if histories else 0, 3), np.nan)
        kernel.frame.run(
            case.par, case.structure.n, case.structure.mass, case.structure.pull, case.structure.weights, case.fibres,
            case.a_g, case.a_v, case.u, case.v, np.zeros(N), np.zeros((at.N_ROWS, N)),
            np.zeros((at.N_BANDS, N, at.BAND)), np.zeros((3, 6)), np.zeros((2, at.N_HISTORY)),
            history, impacts, runs.out[i],
        )  # fmt: skip
        runs.par.append(case.par)
        runs.mass.append(case.structure.m)
        runs.history.append(history)
        runs.impacts.append(impacts[: int(runs.out[i, at.N_STORED])])
    return runs


def _used(batch: Batch, runs: Runs) -> dict[str, str]:
    par = np.array(runs.par)

    def span(column: int) -> str:
        low, high = f"{par[:, column].min():.6g}", f"{par[:, column].max():.6g}"
        return low if low == high else f"{low} ... {high}"

    hht = batch.damping.scheme == "hht"
    used = {
        "backend": "frame",
        "method": f"{batch.numerics.method or 'corotational'} Euler-Bernoulli elements, "
        + ("HHT" if hht else "Newmark, average acceleration"),
        "dt": span(at.DT),
        "yield_rotation": span(at.YIELD_ROTATION),
        "divided_steps": f"{int(runs.out[:, at.CUTS].sum())}",
    }
    if hht:
        used["alpha_d"] = span(at.ALPHA_D)
    if batch.column is not None:
        used["stiffness_damping"] = span(at.STIFF_DAMPING)
    return used
