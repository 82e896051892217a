"""The full mesh as a backend: from a batch to a response, one process of CalculiX per case (docs/calculix.md)."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, NO_ANSWER, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.response import UNRESOLVED, Response
from rockcli.scene.variables import COUNTS
from rockcli.solvers.calculix.body import Impacts, Motion, find_impacts, motion_of
from rockcli.solvers.calculix.case import Prepared, Refused, prepare
from rockcli.solvers.calculix.folder import solve_deck
from rockcli.solvers.calculix.run import program, version
from rockcli.solvers.calculix.verdict import falls_at, judge
from rockcli.solvers.common.found import Found, impacts_of, last_outward, note_unstored

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Solved:
    """A case that was solved."""

    prepared: Prepared
    motion: Motion
    impacts: Impacts


def solve(batch: Batch) -> Response:
    """Solve every case of the batch, one after the other; see `Response` for what comes back.

    A case CalculiX does not finish is `failed` with what it said.

    Raises:
        SolverError: CalculiX is not installed; the message says how to install it.
    """
    program()
    n = batch.size
    counted: dict[str, NDArray[Any]] = {name: np.full(n, -1, dtype=np.int64) for name in COUNTS}
    wall_time = np.full(n, np.nan)
    reasons = [""] * n
    solved: list[_Solved | None] = [None] * n
    for i in range(n):
        began = time.perf_counter()
        try:
            prepared = prepare(batch, i)
        except Refused as refused:
            reasons[i] = str(refused)
            continue
        result = solve_deck(prepared.deck, partial(falls_at, prepared.body))
        reasons[i] = result.complaint
        counted["n_steps"][i], counted["n_rhs"][i] = result.increments, result.iterations
        if not result.complaint:
            motion = motion_of(prepared.deck, result.t, result.u)
            solved[i] = _Solved(prepared, motion, find_impacts(motion.t, motion.theta, motion.lift, prepared.threshold))
        wall_time[i] = time.perf_counter() - began
    scalars = counted | _scalars(batch, solved, reasons) | {"wall_time": wall_time}
    used = _used(batch)
    if not batch.save.histories:
        return Response(scalars=scalars, reasons=reasons, used=used)
    histories, t = _histories(batch, solved)
    none = np.empty((0, 3))
    impacts = impacts_of([none if case is None else case.impacts.rows for case in solved])
    return Response(scalars=scalars, reasons=reasons, time=t, histories=histories, impacts=impacts, used=used)


def _scalars(batch: Batch, solved: list[_Solved | None], reasons: list[str]) -> dict[str, NDArray[Any]]:
    """Scalars by name but for those of the run itself, NaN where a case is not solved; completes the sentences."""
    n = batch.size
    verdict, n_impacts = np.full(n, NO_ANSWER), np.full(n, -1, dtype=np.int64)
    names = ("peak", "rate", "top", "t_peak", "t_uplift", "t_overturn", "t_end", "N_min")
    read = {name: np.full(n, np.nan) for name in names}
    side = np.zeros(n)
    for i, case in enumerate(solved):
        if case is None:
            continue
        motion, deck = case.motion, case.prepared.deck
        verdict[i], n_impacts[i] = judge(case.prepared.body, motion.t, motion.theta), len(case.impacts.t)
        at = int(np.argmax(np.abs(motion.theta)))
        t_overturn = last_outward(motion.t, motion.theta, case.prepared.body.theta_star)
        fell = verdict[i] == FALLS
        standing = motion.t <= (t_overturn if fell and np.isfinite(t_overturn) else np.inf)
        N_min = np.nan if fell and t_overturn == 0.0 else motion.N[standing].min() / (deck.mass * deck.g)
        side[i] = np.sign(motion.theta[at])
        values = (
            abs(motion.theta[at]), np.max(np.abs(_rate(motion))), np.max(np.abs(motion.u_top)), motion.t[at],
            case.impacts.opened, t_overturn, motion.t[-1], N_min,
        )  # fmt: skip
        for name, value in zip(names, values, strict=True):
            read[name][i] = value
    moved = np.isfinite(read["t_uplift"])
    turned = read["peak"] > np.array([np.nan if case is None else case.prepared.threshold for case in solved])
    found = Found(
        moved=moved,
        fell=verdict == FALLS,
        undecided=(verdict == UNDECIDED) & turned,
        failed=verdict == NO_ANSWER,
        n_impacts=n_impacts,
        peak=np.where(moved, read["peak"], 0.0),
        side=side,
        rate=np.where(moved, read["rate"], 0.0),
        top=read["top"],
        t_peak=read["t_peak"],
        t_uplift=read["t_uplift"],
        t_overturn=read["t_overturn"],
        t_end=read["t_end"],
    )
    for which in np.flatnonzero(found.outcome == UNRESOLVED):
        case = solved[which]
        assert case is not None
        t, ratio = case.motion.t[-1], case.motion.theta[-1] / case.prepared.body.alpha
        reasons[which] = (
            f"at t = {t:.6g} s theta/alpha = {ratio:.3g} and its angular velocity do not decide "
            "whether it overturns: give a longer duration"
        )
    note_unstored(batch, n_impacts, reasons)
    return found.scalars(batch) | {"N_min_over_mg": read["N_min"]}


def _rate(motion: Motion) -> Array:
    """Rate of rotation at the increments, (k,) [rad/s]."""
    return np.asarray(np.gradient(motion.theta, motion.t) if len(motion.t) > 1 else np.zeros(len(motion.t)))


def _histories(batch: Batch, solved: list[_Solved | None]) -> tuple[dict[str, Array], Array]:
    """Histories (n, k), linear between increments, and output times (k,) [s]; NaN after the end."""
    dt_out = batch.save.dt_out
    stop = max((case.motion.t[-1] for case in solved if case is not None), default=0.0)
    t = np.arange(int(np.floor(stop / dt_out * (1.0 + 1e-9))) + 1, dtype=np.float64) * dt_out
    names = ("theta", "theta_dot", "u_top", "v_top", "M_base", "u_top_bending")
    histories = {name: np.full((batch.size, len(t)), np.nan) for name in names}
    for i, case in enumerate(solved):
        if case is None:
            continue
        motion = case.motion
        live = t <= motion.t[-1] * (1.0 + 1e-9)
        mass = batch.block.mass[i]
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
    return histories, t


def _used(batch: Batch) -> dict[str, str]:
    across, along = (batch.column.across, batch.column.elements) if batch.column is not None else (0, 0)
    return {
        "backend": "calculix",
        "method": "C3D8I, geometrically nonlinear, no-tension struts at the base, Hilber-Hughes-Taylor",
        "mesh": f"{across} x {along or 'square elements'}",
        "dt": repr(batch.numerics.dt) if batch.numerics.dt is not None else batch.numerics.accuracy,
        "version": f"CalculiX {version()}",
    }
