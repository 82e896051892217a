"""`solve(batch)` of the backend `opensees`: one script, one process per case."""

from __future__ import annotations

import time

import numpy as np

from rockcli.errors import SolverError
from rockcli.scene.backends import unfit_beams
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import RECTANGLE_INERTIA
from rockcli.scene.constants import COARSER
from rockcli.scene.response import Response
from rockcli.solvers.common.certainty import CERTAINTY, compare_steps
from rockcli.solvers.opensees.case import law_of
from rockcli.solvers.opensees.results import Outcome, histories_of, scalars_of
from rockcli.solvers.opensees.run import PeerError, require_opensees, run_script, version_of_opensees
from rockcli.solvers.opensees.script import script_of


def solve(batch: Batch) -> Response:
    """Solve every case of the batch with OpenSees; see `Response` for what comes back.

    A case whose process crashes, hangs or writes no results is `failed` with a message.

    Raises:
        SolverError: OpenSeesPy is absent, or the batch asks for what the backend cannot do.
    """
    check(batch)
    require_opensees()
    began = time.perf_counter()
    outcomes = run(batch)
    scalars, reasons = scalars_of(batch, outcomes)
    if batch.save.scalars & CERTAINTY:
        compare_steps(batch, scalars, scalars_of(batch, run(batch, coarser=COARSER))[0], reasons)
    scalars["wall_time"] = np.full(batch.size, (time.perf_counter() - began) / batch.size)
    histories, impacts, t = histories_of(batch, outcomes) if batch.save.histories else ({}, {}, np.empty(0))
    return Response(scalars, reasons, t, histories, impacts, _used(batch, outcomes))


def check(batch: Batch) -> None:
    """Raise `SolverError` for what neither the backend nor an exported script can do."""
    if why := unfit_beams(batch):
        raise SolverError(why)
    if not batch.block.symmetric.all():
        raise SolverError("backend opensees solves symmetric bodies only")
    if batch.model == "flexible":
        if batch.column is None:
            raise SolverError("model flexible needs a column: {E, rho}")
        if not np.allclose(batch.block.inertia, RECTANGLE_INERTIA, rtol=1e-12, atol=0.0):
            raise SolverError("the flexible column is a rectangle: inertia and r_g do not apply")
    law_of(batch)


def run(batch: Batch, *, coarser: float = 1.0) -> list[Outcome]:
    """Run every case, its time step and yield rotation multiplied by `coarser`."""
    outcomes: list[Outcome] = []
    for i in range(batch.size):
        try:
            script = script_of(batch, i, coarser=coarser)
            outcomes.append((script.case, run_script(script)))
        except (PeerError, SolverError) as failure:
            outcomes.append(str(failure))
    return outcomes


def _used(batch: Batch, outcomes: list[Outcome]) -> dict[str, str]:
    solved = [outcome for outcome in outcomes if not isinstance(outcome, str)]

    def span(name: str) -> str:
        values = [case.number(name) for case, _ in solved]
        if not values:
            return "-"
        low, high = f"{min(values):.6g}", f"{max(values):.6g}"
        return low if low == high else f"{low} ... {high}"

    hht = batch.damping.scheme == "hht"
    divided = sum(int(answer.summary["divided_steps"]) for _, answer in solved)
    return {
        "backend": "opensees",
        "method": f"{batch.numerics.method or 'corotational'} elasticBeamColumn elements, "
        + ("HHT" if hht else "Newmark, average acceleration"),
        **({"alpha_d": span("alpha_d")} if hht else {}),
        "dt": span("DT"),
        "yield_rotation": span("theta_y"),
        "divided_steps": str(divided),
        "version": f"openseespy {version_of_opensees()}",
    }
