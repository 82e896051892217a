"""From what the scripts wrote to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, FAST, NO_ANSWER, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT
from rockcli.scene.response import UNRESOLVED
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.found import Found, impacts_of, last_outward, note_unstored, rigid_top
from rockcli.solvers.opensees.case import CaseOfOpenSees
from rockcli.solvers.opensees.run import Answer
from rockcli.solvers.opensees.verdict import outcome_law, verdict_afterwards

Array = NDArray[np.float64]

Outcome = tuple[CaseOfOpenSees, Answer] | str
"""A case with its answer, or the sentence of why there is none."""


def scalars_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case; forces at the edge and energies are not computed (NaN)."""
    n = batch.size
    counted = {name: np.full(n, -1, dtype=np.int64) for name in ("n_impacts", "n_steps", "n_rhs")}
    verdict, side, struck_later = np.full(n, NO_ANSWER), np.zeros(n), np.zeros(n, dtype=bool)
    names = ("theta_peak", "theta_dot_peak", "u_top_peak", "t_peak", "t_uplift", "t_overturn", "t_end")
    said = {name: np.full(n, np.nan) for name in names}
    for i, outcome in enumerate(outcomes):
        if isinstance(outcome, str):
            continue
        answer = outcome[1]
        law = outcome_law(batch, i, outcome[0].number("m"))
        verdict[i], side[i], struck_later[i] = verdict_afterwards(batch, i, answer, law)
        for name in names:
            said[name][i] = answer.summary.get(name)  # null where there is none
        if verdict[i] == FALLS:
            t, theta = answer.table[:, 0], answer.table[:, 1]
            said["t_overturn"][i] = np.nan if struck_later[i] else last_outward(t, theta, law.q_star)
        fast = FAST * float(batch.p[i, LEFT]) * float(batch.block.alpha[i, LEFT])
        counted["n_impacts"][i] = np.count_nonzero(np.abs(answer.impacts[:, 1]) > fast)
        counted["n_steps"][i], counted["n_rhs"][i] = answer.summary["steps"], answer.summary["iterations"]
    moved = np.isfinite(said["t_uplift"])
    peak, rate = (np.where(moved, said[name], 0.0) for name in ("theta_peak", "theta_dot_peak"))
    found = Found(
        moved=moved,
        fell=verdict == FALLS,
        undecided=verdict == UNDECIDED,
        failed=verdict == NO_ANSWER,
        n_impacts=counted["n_impacts"],
        peak=np.abs(peak),
        side=np.where(verdict == FALLS, side, np.sign(peak)),
        rate=rate,
        top=said["u_top_peak"] if batch.model == "flexible" else rigid_top(batch, np.abs(peak)),
        t_peak=said["t_peak"],
        t_uplift=said["t_uplift"],
        t_overturn=said["t_overturn"],
        t_end=said["t_end"],
        struck_later=struck_later,
    )
    scalars: dict[str, NDArray[Any]] = {name: np.full(n, np.nan) for name in SCALARS if name != "reason"}
    reasons = [outcome if isinstance(outcome, str) else "" for outcome in outcomes]
    for which in np.flatnonzero(found.outcome == UNRESOLVED):
        reasons[which] = "in the end its energy does not decide whether it overturns: give a longer duration"
    note_unstored(batch, found.n_impacts, reasons)
    return scalars | counted | found.scalars(batch), reasons


def histories_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    answered = {i: outcome for i, outcome in enumerate(outcomes) if not isinstance(outcome, str)}
    ends = [float(answer.summary["t_end"]) for _, answer in answered.values()]
    n_time = output_times(batch.save.dt_out, max(ends, default=0.0))
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    names = ("theta", "theta_dot", "u_top", "v_top", "u_top_bending", "M_base")
    histories = {name: np.full((batch.size, n_time), np.nan) for name in names}
    for i, (case, answer) in answered.items():
        live = t <= float(answer.summary["t_end"]) * (1.0 + 1e-12)
        for name, values in zip(names, _at(answer.table, t[live]), strict=True):
            histories[name][i, live] = values
        # a column is solved by the metre of its depth, whatever its mass
        mass = float(batch.block.mass[i])
        histories["M_base"][i] *= (mass if np.isfinite(mass) else 1.0) / case.number("m")
    if batch.model != "flexible":
        del histories["u_top_bending"]
    none = np.empty((0, 3))
    impacts = [answered[i][1].impacts if i in answered else none for i in range(batch.size)]
    return histories, impacts_of(impacts), t


def _at(table: Array, t: Array) -> list[Array]:
    """The columns of a table at times t: rotation by cubic Hermite interpolation, the others linearly."""
    if len(table) == 1:
        return [np.full(len(t), column[0]) for column in table.T[1:]]
    own, theta, rate = table[:, 0], table[:, 1], table[:, 2]
    j = np.clip(np.searchsorted(own, t, side="right") - 1, 0, len(own) - 2)
    h = own[j + 1] - own[j]
    x = np.clip((t - own[j]) / h, 0.0, 1.0)
    y = 1.0 - x
    turned = y * y * ((1.0 + 2.0 * x) * theta[j] + x * h * rate[j])
    turned += x * x * ((1.0 + 2.0 * y) * theta[j + 1] - y * h * rate[j + 1])
    return [turned, *(np.interp(t, own, column) for column in table.T[2:])]
