"""From the raw output of the frame kernels to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, UNDECIDED
from rockcli.kernels.frame import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT
from rockcli.scene.excitation import acceleration
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

Array = NDArray[np.float64]


def scalars_of(batch: Batch, out: Array, par: list[Array]) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case; forces at the edge are not computed (NaN)."""
    failed = out[:, at.STATUS] != at.DONE
    fell = ~failed & (out[:, at.VERDICT] == FALLS)
    moved = np.isfinite(out[:, at.T_UPLIFT])
    impacts = np.rint(out[:, at.N_IMPACTS]).astype(np.int64)
    outcome = np.where(moved, ROCKING, NO_UPLIFT)
    outcome = np.where(fell, np.where(impacts > 0, OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT), outcome)
    outcome = np.where(out[:, at.VERDICT] == UNDECIDED, UNRESOLVED, outcome)
    outcome = np.where(failed, FAILED, outcome)
    unknown = outcome < 0

    def known(values: Array, *, if_still: float = 0.0) -> Array:
        """Values of a body that rocks; infinite overturned, `if_still` where it never uplifts."""
        values = np.where(moved, values, if_still)
        return np.where(unknown, np.nan, np.where(fell, np.inf, values))

    peak = known(out[:, at.PEAK])
    barrier = np.array([row[at.BARRIER] for row in par])
    top = batch.block.top * np.sin(np.minimum(out[:, at.PEAK], 0.5 * np.pi))
    nan = np.full(batch.size, np.nan)
    scalars: dict[str, NDArray[Any]] = {name: nan.copy() for name in SCALARS if name != "reason"}
    scalars |= {
        "outcome": outcome.astype(np.int8),
        "theta_peak": np.where(peak == 0.0, 0.0, np.copysign(peak, out[:, at.PEAK_SIDE])),
        "theta_peak_over_alpha": peak / batch.block.alpha[:, LEFT],
        "theta_dot_peak": known(out[:, at.RATE_PEAK]),
        "u_top_peak": np.where(unknown | fell, known(top), out[:, at.TOP_PEAK])
        if batch.model == "flexible"
        else known(top),
        "t_peak": np.where(fell | ~moved | unknown, np.nan, out[:, at.T_PEAK]),
        "t_uplift": np.where(failed, np.nan, out[:, at.T_UPLIFT]),
        "t_overturn": np.where(fell, out[:, at.T_OVERTURN], np.nan),
        "t_end": np.where(failed, np.nan, out[:, at.T_END]),
        "n_impacts": impacts,
        "energy_residual": np.where(failed, np.nan, out[:, at.ENERGY] / np.where(barrier > 0.0, barrier, np.nan)),
        "n_steps": np.rint(out[:, at.N_STEPS]).astype(np.int64),
        "n_rhs": np.rint(out[:, at.N_RHS]).astype(np.int64),
    }
    return scalars, [_reason(row, int(outcome[i]), int(impacts[i]), batch, par[i]) for i, row in enumerate(out)]


def _reason(out: Array, outcome: int, impacts: int, batch: Batch, par: Array) -> str:
    if out[at.STATUS] == at.NO_CONVERGENCE:
        return (
            f"Newton's iterations did not converge at t = {out[at.T_END]:.6g} s, "
            f"not even with a step of {par[at.DT] / 1e4:.3g} s: try a smaller dt or a larger yield_rotation"
        )
    if out[at.STATUS] == at.NO_STATICS:
        return "no equilibrium under its own weight to begin with: the column buckles or the base is too soft"
    if outcome == UNRESOLVED:
        return "after the motion its energy stays at what overturning needs: whether it overturns is not told"
    if batch.save.histories and impacts > MAX_IMPACTS_STORED:
        return f"of its impacts the first {MAX_IMPACTS_STORED} are stored"
    return ""


def histories_of(
    batch: Batch, out: Array, mass: list[float], rows: list[Array], landings: list[Array]
) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    n_time = max([1, *(int(np.isfinite(row[:, at.TH]).sum()) for row in rows)])
    raw = np.full((batch.size, n_time, at.N_HISTORY), np.nan)
    for i, row in enumerate(rows):
        kept = row[:n_time]
        raw[i, : len(kept)] = kept
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    theta, top = raw[:, :, at.TH], batch.block.top[:, None]
    given = np.isfinite(batch.block.mass) | (batch.model == "flexible")
    scale = np.where(given, 1.0, 1.0 / np.array(mass))[:, None]
    histories = {
        "theta": theta,
        "theta_dot": raw[:, :, at.RATE],
        "a_g": np.empty_like(theta),
        "a_v": np.empty_like(theta),
        "u_top": raw[:, :, at.U_TOP] if batch.model == "flexible" else top * np.sin(theta),
        "v_top": raw[:, :, at.V_TOP] if batch.model == "flexible" else -top * (1.0 - np.cos(theta)),
        "M_base": raw[:, :, at.MOMENT] * scale,
    }
    if batch.model == "flexible":
        histories["u_top_bending"] = raw[:, :, at.U_BENDING]
    channels = {"a_g": batch.excitation.horizontal, "a_v": batch.excitation.vertical}
    for name, channel in channels.items():
        for i in range(batch.size):
            a = acceleration(channel, t, i)
            a[t > batch.excitation.duration[i]] = 0.0
            histories[name][i] = np.where(np.isfinite(theta[i]), a, np.nan)
    stored = np.full((3, batch.size, max([0, *(len(x) for x in landings)])), np.nan)
    for i, x in enumerate(landings):
        stored[:, i, : len(x)] = x.T
    names = ("t_impact", "theta_dot_before", "theta_dot_after")
    return histories, dict(zip(names, stored, strict=True)), t
