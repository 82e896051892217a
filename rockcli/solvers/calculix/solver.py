"""The full mesh as a backend: from a batch to a response, one process of CalculiX per case (docs/calculix.md)."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, UNDECIDED
from rockcli.scene.batch import Batch
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
from rockcli.scene.variables import COUNTS
from rockcli.solvers.calculix.body import Landings, Motion, landings, motion_of
from rockcli.solvers.calculix.case import Prepared, Refused, ground, prepare
from rockcli.solvers.calculix.folder import solve_deck
from rockcli.solvers.calculix.run import program
from rockcli.solvers.calculix.verdict import fallen, judge

Array = NDArray[np.float64]

KNOWN = (
    "theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "t_peak", "t_uplift", "t_overturn", "t_end",
    "N_min_over_mg", "wall_time",
)  # fmt: skip
"""Scalars in floating point this backend knows; the others stay NaN."""


@dataclass(frozen=True, eq=False)
class _Solved:
    """A case that was solved."""

    prepared: Prepared
    motion: Motion
    landings: Landings


def solve(batch: Batch) -> Response:
    """Solve every case of the batch, one after the other; see `Response` for what comes back.

    A case CalculiX does not finish is `failed` with what it said.

    Raises:
        SolverError: CalculiX is not installed; the message says how to install it.
    """
    program()
    n = batch.size
    scalars: dict[str, NDArray[Any]] = {name: np.full(n, np.nan) for name in KNOWN}
    scalars |= {name: np.full(n, -1, dtype=np.int64) for name in COUNTS}
    scalars["outcome"] = np.full(n, FAILED, dtype=np.int8)
    reasons = [""] * n
    solved: list[_Solved | None] = [None] * n
    for i in range(n):
        began = time.perf_counter()
        try:
            prepared = prepare(batch, i)
        except Refused as refused:
            reasons[i] = str(refused)
            continue
        result = solve_deck(prepared.deck, partial(fallen, prepared.body))
        reasons[i] = result.complaint
        scalars["n_steps"][i], scalars["n_rhs"][i] = result.increments, result.iterations
        if not result.complaint:
            motion = motion_of(prepared.deck, result.t, result.u)
            solved[i] = _Solved(prepared, motion, landings(motion.t, motion.theta, prepared.threshold))
            reasons[i] = _report(batch, i, solved[i], scalars)
        scalars["wall_time"][i] = time.perf_counter() - began
    used = _used(batch)
    if not batch.save.histories:
        return Response(scalars=scalars, reasons=reasons, used=used)
    histories, impacts, t = _histories(batch, solved)
    return Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)


def _report(batch: Batch, i: int, case: _Solved | None, scalars: dict[str, NDArray[Any]]) -> str:
    """Write the scalars of a solved case; return what there is to say."""
    assert case is not None
    motion, found, prepared = case.motion, case.landings, case.prepared
    alpha = prepared.body.alpha
    verdict = judge(prepared.body, motion.t, motion.theta)
    moved = bool(np.isfinite(found.opened))
    count = len(found.t)
    peak = int(np.argmax(np.abs(motion.theta)))
    if verdict == FALLS:
        outcome = OVERTURNED_AFTER_IMPACT if count else OVERTURNED_WITHOUT_IMPACT
    elif verdict == UNDECIDED and moved:
        outcome = UNRESOLVED
    else:
        outcome = ROCKING if moved else NO_UPLIFT
    fell, unknown = verdict == FALLS, outcome == UNRESOLVED
    size = np.inf if fell else float(abs(motion.theta[peak])) if moved else 0.0
    side = float(np.sign(motion.theta[peak]))
    t_overturn = _last_passage(motion, alpha) if fell else np.nan
    standing = motion.t <= (t_overturn if np.isfinite(t_overturn) else np.inf)
    values = {
        "theta_peak": np.nan if unknown else side * size if size else 0.0,
        "theta_peak_over_alpha": np.nan if unknown else size / alpha,
        "theta_dot_peak": np.nan if unknown else np.inf if fell else float(np.max(np.abs(_rate(motion)))),
        "u_top_peak": np.nan if unknown else np.inf if fell else float(np.max(np.abs(motion.u_top))),
        "t_peak": np.nan if fell or unknown or not moved else float(motion.t[peak]),
        "t_uplift": found.opened,
        "t_overturn": t_overturn,
        "t_end": float(motion.t[-1]),
        "N_min_over_mg": float(motion.N[standing].min()) / (prepared.deck.mass * prepared.deck.g),
    }
    for name, value in values.items():
        scalars[name][i] = value
    scalars["outcome"][i] = outcome
    scalars["n_impacts"][i] = count
    said = []
    if unknown:
        said.append(
            f"at t = {motion.t[-1]:.6g} s theta/alpha = {motion.theta[-1] / alpha:.3g} and its rate leave open "
            "whether it overturns: give a longer duration"
        )
    if count > MAX_IMPACTS_STORED:
        said.append(f"of its impacts the first {MAX_IMPACTS_STORED} are stored")
    return "; ".join(said)


def _rate(motion: Motion) -> Array:
    """Rate of rotation at the increments, (k,) [rad/s]."""
    return np.asarray(np.gradient(motion.theta, motion.t) if len(motion.t) > 1 else np.zeros(len(motion.t)))


def _last_passage(motion: Motion, alpha: float) -> float:
    """Last time |theta| passes alpha outward [s]."""
    beyond = np.abs(motion.theta) - alpha
    up = np.flatnonzero((beyond[:-1] < 0.0) & (beyond[1:] >= 0.0))
    if not len(up):
        return float("nan")
    i = int(up[-1])
    return float(motion.t[i] - beyond[i] * (motion.t[i + 1] - motion.t[i]) / (beyond[i + 1] - beyond[i]))


def _histories(batch: Batch, solved: list[_Solved | None]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k), linear between increments, impacts (n, j), and output times (k,) [s]; NaN after the end."""
    dt_out = batch.save.dt_out
    stop = max((case.motion.t[-1] for case in solved if case is not None), default=0.0)
    t = np.arange(int(np.floor(stop / dt_out * (1.0 + 1e-9))) + 1, dtype=np.float64) * dt_out
    names = ("theta", "theta_dot", "a_g", "a_v", "u_top", "v_top", "M_base", "u_top_bending")
    histories = {name: np.full((batch.size, len(t)), np.nan) for name in names}
    stored = min(max((len(case.landings.t) for case in solved if case is not None), default=0), MAX_IMPACTS_STORED)
    impacts = {
        name: np.full((batch.size, stored), np.nan) for name in ("t_impact", "theta_dot_before", "theta_dot_after")
    }
    for i, case in enumerate(solved):
        if case is None:
            continue
        motion, found = case.motion, case.landings
        live = t <= motion.t[-1] * (1.0 + 1e-9)
        mass = batch.block.mass[i]
        shaken = ground(batch, i, t[live])
        rows = {
            "theta": motion.theta,
            "theta_dot": _rate(motion),
            "u_top": motion.u_top,
            "v_top": motion.v_top,
            "M_base": motion.M / case.prepared.deck.mass * (mass if np.isfinite(mass) else 1.0),
            "u_top_bending": motion.u_bend,
        }
        for name, values in rows.items():
            histories[name][i, live] = np.interp(t[live], motion.t, values)
        histories["a_g"][i, live], histories["a_v"][i, live] = shaken
        k = min(len(found.t), stored)
        for name, values in zip(impacts, (found.t, found.before, found.after), strict=True):
            impacts[name][i, :k] = values[:k]
    return histories, impacts, t


def _used(batch: Batch) -> dict[str, str]:
    across, along = (batch.column.across, batch.column.elements) if batch.column is not None else (0, 0)
    return {
        "backend": "calculix",
        "method": "C3D8I, geometrically nonlinear, no-tension struts at the base, Hilber-Hughes-Taylor",
        "mesh": f"{across} x {along or 'square elements'}",
        "dt": repr(batch.numerics.dt) if batch.numerics.dt is not None else batch.numerics.accuracy,
    }
