"""From the raw output of the frame kernels to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, UNDECIDED
from rockcli.kernels.frame import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.response import UNRESOLVED
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.found import Found, counts, from_beyond, impacts_of, note_unstored, rigid_top

Array = NDArray[np.float64]


def scalars_of(batch: Batch, out: Array, par: list[Array]) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case; forces at the edge are not computed (NaN)."""
    failed = out[:, at.STATUS] != at.DONE
    moved = np.isfinite(out[:, at.T_UPLIFT])
    peak, rate = (np.where(moved, out[:, column], 0.0) for column in (at.PEAK, at.RATE_PEAK))
    found = Found(
        moved=moved,
        fell=~failed & (out[:, at.VERDICT] == FALLS),
        undecided=out[:, at.VERDICT] == UNDECIDED,
        failed=failed,
        n_impacts=counts(out[:, at.N_IMPACTS]),
        peak=peak,
        side=out[:, at.PEAK_SIDE],
        rate=rate,
        top=out[:, at.TOP_PEAK] if batch.model == "flexible" else rigid_top(batch, peak),
        t_peak=out[:, at.T_PEAK],
        t_uplift=out[:, at.T_UPLIFT],
        t_overturn=from_beyond(out[:, at.T_OVERTURN]),
        t_end=out[:, at.T_END],
        struck_later=out[:, at.STRUCK_LATER] > 0.0,
    )
    barrier = np.array([row[at.BARRIER] for row in par])
    nan = np.full(batch.size, np.nan)
    scalars: dict[str, NDArray[Any]] = {name: nan.copy() for name in SCALARS if name != "reason"}
    scalars |= found.scalars(batch) | {
        "energy_residual": found.unless_failed(out[:, at.ENERGY] / np.where(barrier > 0.0, barrier, np.nan)),
        "n_steps": counts(out[:, at.N_STEPS]),
        "n_rhs": counts(out[:, at.N_RHS]),
    }
    reasons = [_reason(row, int(found.outcome[i]), par[i]) for i, row in enumerate(out)]
    note_unstored(batch, found.n_impacts, reasons)
    return scalars, reasons


def _reason(out: Array, outcome: int, par: Array) -> str:
    if out[at.STATUS] == at.NO_CONVERGENCE:
        return (
            f"Newton's iterations did not converge at t = {out[at.T_END]:.6g} s, "
            f"not even with a step of {par[at.DT] / 1e4:.3g} s: try a smaller dt or a larger yield_rotation"
        )
    if out[at.STATUS] == at.NO_STATICS:
        return "no equilibrium under its own weight to begin with: the column buckles or the base is too soft"
    if outcome == UNRESOLVED:
        return "after the motion its energy stays at what overturning needs: whether it overturns is not decided"
    return ""


def histories_of(
    batch: Batch, mass: list[float], rows: list[Array], impacts: list[Array]
) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    n_time = max([1, *(int(np.isfinite(row[:, at.TH]).sum()) for row in rows)])
    raw = np.full((batch.size, n_time, at.N_HISTORY), np.nan)
    for i, row in enumerate(rows):
        kept = row[:n_time]
        raw[i, : len(kept)] = kept
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    theta, top = raw[:, :, at.TH], batch.block.top[:, None]
    # solved with the mass of a metre of depth if a column's, with any mass if none is given
    scale = (batch.block.mass_or_1 / np.array(mass))[:, None]
    histories = {
        "theta": theta,
        "theta_dot": raw[:, :, at.RATE],
        "u_top": raw[:, :, at.U_TOP] if batch.model == "flexible" else top * np.sin(theta),
        "v_top": raw[:, :, at.V_TOP] if batch.model == "flexible" else -top * (1.0 - np.cos(theta)),
        "M_base": raw[:, :, at.MOMENT] * scale,
    }
    if batch.model == "flexible":
        histories["u_top_bending"] = raw[:, :, at.U_BENDING]
    return histories, impacts_of(impacts), t
