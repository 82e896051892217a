"""From what the scripts wrote to variables by name, and the outcome by energy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, FAST, RETURNS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.excitation import acceleration
from rockcli.scene.models import MODELS
from rockcli.scene.response import (
    FAILED,
    MAX_IMPACTS_STORED,
    NO_UPLIFT,
    OVERTURNED_AFTER_IMPACT,
    OVERTURNED_WITHOUT_IMPACT,
    ROCKING,
    UNRESOLVED,
)
from rockcli.scene.variables import SCALARS
from rockcli.solvers.opensees.case import CaseOfOpenSees
from rockcli.solvers.opensees.run import Answer

Array = NDArray[np.float64]

MARGIN = {False: 1e-3, True: 0.05}
"""Fraction of the barrier by which the energy must differ from it for the outcome to be told; True: elastic."""

Outcome = tuple[CaseOfOpenSees, Answer] | str
"""A case with its answer, or the sentence of why there is none."""


def scalars_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case; forces at the edge and energies are not computed (NaN)."""
    n = batch.size
    scalars: dict[str, NDArray[Any]] = {name: np.full(n, np.nan) for name in SCALARS if name != "reason"}
    scalars["outcome"] = np.full(n, FAILED, dtype=np.int8)
    scalars |= {name: np.full(n, -1, dtype=np.int64) for name in ("n_impacts", "n_steps", "n_rhs")}
    reasons = [""] * n
    for i, outcome in enumerate(outcomes):
        if isinstance(outcome, str):
            reasons[i] = outcome
            continue
        values, reasons[i] = _scalars(batch, i, *outcome)
        for name, value in values.items():
            scalars[name][i] = value
    return scalars, reasons


def _scalars(batch: Batch, i: int, case: CaseOfOpenSees, answer: Answer) -> tuple[dict[str, Any], str]:
    found, alpha = answer.summary, float(batch.block.alpha[i, LEFT])
    fast = np.abs(answer.impacts[:, 1]) > FAST * float(batch.p[i, LEFT]) * alpha
    impacts = int(fast.sum())
    verdict = fate(batch, i, answer)
    moved, fell = found["t_uplift"] is not None, verdict == FALLS
    outcome = ROCKING if moved else NO_UPLIFT
    if fell:
        outcome = OVERTURNED_AFTER_IMPACT if impacts else OVERTURNED_WITHOUT_IMPACT
    elif verdict == UNDECIDED:
        outcome = UNRESOLVED
    peak = found["theta_peak"] if moved else 0.0
    side = np.sign(found["theta"] if fell else peak)

    def known(value: float) -> float:
        if outcome == UNRESOLVED:
            return np.nan
        return np.inf if fell else (value if moved else 0.0)

    values = {
        "outcome": outcome,
        "theta_peak": side * known(abs(peak)) if moved else 0.0,
        "theta_peak_over_alpha": known(abs(peak) / alpha),
        "theta_dot_peak": known(found["theta_dot_peak"]),
        "u_top_peak": known(
            found["u_top_peak"]
            if batch.model == "flexible"
            else float(batch.block.top[i]) * np.sin(min(abs(peak), 0.5 * np.pi))
        ),
        "t_peak": found["t_peak"] if outcome == ROCKING else np.nan,
        "t_uplift": found["t_uplift"] if moved else np.nan,
        "t_overturn": _last_outward(answer.table, unstable(batch, i)) if fell else np.nan,
        "t_end": found["t_end"],
        "n_impacts": impacts,
        "n_steps": found["steps"],
        "n_rhs": found["iterations"],
    }
    reason = ""
    if outcome == UNRESOLVED:
        reason = "in the end its energy is about what overturning needs: whether it overturns is not told"
    elif batch.save.histories and impacts > MAX_IMPACTS_STORED:
        reason = f"of its impacts the first {MAX_IMPACTS_STORED} are stored"
    return values, reason


def unstable(batch: Batch, i: int) -> float:
    """Rotation at which the restoring moment vanishes [rad]; of the flexible column that of its law for E = inf."""
    return float(_law(batch, i)[0])


def _law(batch: Batch, i: int) -> tuple[float, Any]:
    """q_star and the potential U(q)/(I_O p^2) of the rigid law of case i."""
    pair = ("3", "corotational") if batch.model == "flexible" else (batch.model, batch.geometry)
    at = slice(i, i + 1)
    law = MODELS[pair].law(batch.block.alpha[at, LEFT], batch.block.tan_alpha[at, LEFT])
    r0, rs, rc = (float(x[0]) for x in (law.r0, law.rs, law.rc))

    def potential(q: float) -> float:
        return r0 * q + 2.0 * rs * float(np.sin(0.5 * q)) ** 2 + rc * float(np.sin(q))

    return float(law.q_star[0]), potential


def fate(batch: Batch, i: int, answer: Answer) -> int:
    """Does the body, left alone from where the script ended, ever fall?  FALLS, RETURNS or UNDECIDED.

    Past pi/2 it has fallen, at rest it has not.  Otherwise the rigid law decides by its energy, impact by impact.
    """
    if answer.summary["ended"] == "overturned":
        return FALLS
    q_star, potential = _law(batch, i)
    if answer.summary["ended"] == "rest" or q_star == np.inf:
        return RETURNS
    theta, rate = answer.summary["rigid_part"]
    s = np.sign(theta) or np.sign(rate) or 1.0
    q, v = abs(theta), s * rate / float(batch.p[i, LEFT])
    barrier = potential(q_star)
    margin = MARGIN[batch.model == "flexible" or batch.base is not None]
    side = RIGHT if s > 0.0 else LEFT
    for _ in range(1000):
        energy = (0.5 * v * v + potential(q)) / barrier
        if abs(energy - 1.0) < margin:
            return UNDECIDED
        if energy < 1.0 and q < q_star:
            return RETURNS
        if v >= 0.0 or energy < 1.0:  # moving outward with more than the barrier, or beyond it with less
            return FALLS
        side = LEFT if side == RIGHT else RIGHT
        v = float(batch.damping.eta[i, side]) * float(np.sqrt(2.0 * energy * barrier))
        q = 0.0
    return UNDECIDED


def _last_outward(table: Array, q: float) -> float:
    """Time of the last outward passage of |theta| = q, linear between rows; NaN if not in the table [s]."""
    t, theta = table[:, 0], np.abs(table[:, 1])
    at = np.flatnonzero((theta[:-1] < q) & (theta[1:] >= q))
    if not len(at):
        return np.nan
    j = int(at[-1])
    return float(t[j] + (t[j + 1] - t[j]) * (q - theta[j]) / (theta[j + 1] - theta[j]))


def histories_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    answered = {i: outcome for i, outcome in enumerate(outcomes) if not isinstance(outcome, str)}
    ends = [float(answer.summary["t_end"]) for _, answer in answered.values()]
    n_time = int(np.floor(max(ends, default=0.0) / batch.save.dt_out * (1.0 + 1e-12))) + 1
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    names = ("theta", "theta_dot", "u_top", "v_top", "u_top_bending", "M_base")
    histories = {name: np.full((batch.size, n_time), np.nan) for name in ("a_g", "a_v", *names)}
    most = max([0, *(len(answer.impacts) for _, answer in answered.values())])
    impacts = np.full((3, batch.size, min(most, MAX_IMPACTS_STORED)), np.nan)
    for i, (case, answer) in answered.items():
        live = t <= float(answer.summary["t_end"]) * (1.0 + 1e-12)
        for name, values in zip(names, _at(answer.table, t[live]), strict=True):
            histories[name][i, live] = values
        if not np.isfinite(batch.block.mass[i]):
            histories["M_base"][i] /= case.number("m")
        for name, channel in (("a_g", batch.excitation.horizontal), ("a_v", batch.excitation.vertical)):
            histories[name][i, live] = acceleration(channel, t[live], i)
        kept = answer.impacts[:MAX_IMPACTS_STORED]
        impacts[:, i, : len(kept)] = kept.T
    if batch.model != "flexible":
        del histories["u_top_bending"]
    return histories, dict(zip(("t_impact", "theta_dot_before", "theta_dot_after"), impacts, strict=True)), t


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
