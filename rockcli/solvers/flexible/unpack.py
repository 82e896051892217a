"""From the raw output of the column's kernel to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.column import layout as at
from rockcli.kernels.constants import DONE, FALLS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.solvers.common.found import IMPACTS, Found, broke_off, counts, from_beyond, note_unstored
from rockcli.solvers.flexible.column import Prepared

Array = NDArray[np.float64]


class Raw:
    """Raw output for a batch: `out` (n, N_OUT), histories (n, 4, k), impacts (n, 3, j)."""

    def __init__(self, n: int, n_time: int, n_impacts: int) -> None:
        self.out = np.full((n, at.N_OUT), np.nan)
        self.histories = np.full((n, 4, n_time), np.nan)
        self.impacts = np.full((n, 3, n_impacts), np.nan)


def scalars_of(
    batch: Batch, run: Raw, columns: list[Prepared | None], refusals: list[str]
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case."""
    assert batch.column is not None or all(c is None for c in columns)
    out = run.out
    refused = np.array([c is None for c in columns])
    moved = np.isfinite(out[:, at.T_UPLIFT])
    counted = counts(np.where(refused, -1.0, out[:, [at.N_LANDINGS, at.N_STEPS, at.N_RHS]].T))
    found = Found(
        moved=moved,
        fell=out[:, at.VERDICT] == FALLS,
        undecided=out[:, at.VERDICT] == UNDECIDED,
        failed=refused | (out[:, at.STATUS] != DONE),
        n_impacts=counted[0],
        peak=np.where(moved, out[:, at.PEAK], 0.0),
        side=out[:, at.PEAK_SIDE],
        rate=np.where(moved, out[:, at.RATE_PEAK], 0.0),
        top=out[:, at.U_PEAK],
        t_peak=out[:, at.T_PEAK],
        t_uplift=out[:, at.T_UPLIFT],
        t_overturn=from_beyond(out[:, at.T_OVERTURN]),
        t_end=out[:, at.T_END],
        struck_later=out[:, at.STRUCK_LATER] > 0.0,
    )
    barrier = np.array([np.nan if c is None else c.barrier for c in columns])
    undamped = batch.column.zeta == 0.0 if batch.column is not None else np.zeros(batch.size, bool)
    nothing = np.full(batch.size, np.nan)
    scalars = found.scalars(batch) | {
        "mu_required": nothing,
        "mu_impact": nothing,
        "N_min_over_mg": nothing,
        "energy_residual": np.where(found.failed | ~undamped, np.nan, -out[:, at.ENERGY] / barrier),
        "landing_loss": found.unless_failed(out[:, at.LANDING_LOSS] / barrier),
        "n_steps": counted[1],
        "n_rhs": counted[2],
    }
    reasons = list(refusals)
    for i in np.flatnonzero((found.outcome < 0) & ~refused):
        reasons[i] = broke_off(out[i, at.STATUS], scalars["n_steps"][i])
        if out[i, at.STATUS] == DONE:
            reasons[i] = "vibration keeps its energy above that of overturning: free rocking did not decide"
    note_unstored(batch, found.n_impacts, reasons)
    return scalars, reasons


def histories_of(batch: Batch, run: Raw) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    theta, rate, bend, moment = (run.histories[:, j] for j in range(4))
    written = np.isfinite(theta).any(axis=0)
    n_time = int(np.flatnonzero(written)[-1]) + 1 if written.any() else 1
    theta, rate, bend, moment = (x[:, :n_time] for x in (theta, rate, bend, moment))
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    length = 2.0 * batch.block.h[:, None]
    mass = batch.block.mass_or_1[:, None]
    across = length * bend
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "u_top": length * np.sin(theta) + across * np.cos(theta),
        "v_top": -length * (1.0 - np.cos(theta)) - across * np.sin(theta),
        "M_base": moment * length**2 * mass,
        "u_top_bending": across * np.cos(theta),
    }
    n_impacts = int(np.isfinite(run.impacts[:, 0]).any(axis=0).sum())
    impacts = {name: run.impacts[:, j, :n_impacts] for j, name in enumerate(IMPACTS)}
    return histories, impacts, t
