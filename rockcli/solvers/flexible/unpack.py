"""From the raw output of the column's kernel to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.column import layout as at
from rockcli.kernels.constants import DONE, FALLS, OUT_OF_STEPS, UNDECIDED
from rockcli.scene.batch import Batch
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
from rockcli.solvers.flexible.column import Prepared

Array = NDArray[np.float64]


class Raw:
    """Raw output for a batch: `out` (n, N_OUT), histories (n, 4, k), landings (n, 3, j)."""

    def __init__(self, n: int, n_time: int, n_landings: int) -> None:
        self.out = np.full((n, at.N_OUT), np.nan)
        self.histories = np.full((n, 4, n_time), np.nan)
        self.landings = np.full((n, 3, n_landings), np.nan)


def scalars_of(
    batch: Batch, run: Raw, columns: list[Prepared | None], refusals: list[str]
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case."""
    assert batch.column is not None or all(c is None for c in columns)
    out = run.out
    refused = np.array([c is None for c in columns])
    landings = np.where(refused, 0, np.rint(np.nan_to_num(out[:, at.N_LANDINGS]))).astype(np.int64)
    moved = np.isfinite(out[:, at.T_UPLIFT])
    fell = out[:, at.VERDICT] == FALLS
    outcome = np.where(moved, ROCKING, NO_UPLIFT)
    outcome = np.where(fell, np.where(landings > 0, OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT), outcome)
    outcome = np.where(out[:, at.VERDICT] == UNDECIDED, UNRESOLVED, outcome)
    outcome = np.where(refused | (out[:, at.STATUS] != DONE), FAILED, outcome)
    unknown, failed = outcome < 0, outcome == FAILED

    def known(values: Array, missing: NDArray[np.bool_]) -> Array:
        return np.where(missing, np.nan, values)

    peak = known(np.where(fell, np.inf, np.where(moved, out[:, at.PEAK], 0.0)), unknown)
    barrier = np.array([np.nan if c is None else c.barrier for c in columns])
    undamped = batch.column.zeta == 0.0 if batch.column is not None else np.zeros(batch.size, bool)
    nothing = np.full(batch.size, np.nan)
    scalars: dict[str, NDArray[Any]] = {
        "outcome": outcome.astype(np.int8),
        "theta_peak": np.where(peak == 0.0, 0.0, np.copysign(peak, out[:, at.PEAK_SIDE])),
        "theta_peak_over_alpha": peak / batch.block.alpha[:, 0],
        "theta_dot_peak": known(np.where(fell, np.inf, out[:, at.RATE_PEAK]), unknown),
        "u_top_peak": known(np.where(fell, np.inf, out[:, at.U_PEAK]), unknown),
        "t_peak": known(out[:, at.T_PEAK], fell | ~moved | unknown),
        "t_uplift": known(out[:, at.T_UPLIFT], failed),
        "t_overturn": known(out[:, at.T_OVERTURN], ~fell | failed),
        "t_end": known(out[:, at.T_END], failed),
        "n_impacts": landings,
        "mu_required": nothing,
        "mu_impact": nothing,
        "N_min_over_mg": nothing,
        "energy_residual": known(-out[:, at.ENERGY] / barrier, failed | ~undamped),
        "landing_loss": known(out[:, at.LANDING_LOSS] / barrier, failed),
        "n_steps": np.where(refused, 0, np.rint(np.nan_to_num(out[:, at.N_STEPS]))).astype(np.int64),
        "n_rhs": np.where(refused, 0, np.rint(np.nan_to_num(out[:, at.N_RHS]))).astype(np.int64),
    }
    reasons = list(refusals)
    for i in np.flatnonzero((outcome < 0) & ~refused):
        if out[i, at.STATUS] == OUT_OF_STEPS:
            reasons[i] = f"gave up after {scalars['n_steps'][i]} steps"
        elif out[i, at.STATUS] != DONE:
            reasons[i] = "the solution ceased to be finite: check the motion and the column for extreme numbers"
        else:
            reasons[i] = "vibration keeps its energy above that of overturning: free rocking did not decide"
    if batch.save.histories:
        for i in np.flatnonzero(landings > MAX_IMPACTS_STORED):
            reasons[i] = "; ".join(filter(None, [reasons[i], f"the first {MAX_IMPACTS_STORED} impacts are stored"]))
    return scalars, reasons


def histories_of(
    batch: Batch, run: Raw, columns: list[Prepared | None]
) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    theta, rate, bend, moment = (run.histories[:, j] for j in range(4))
    written = np.isfinite(theta).any(axis=0)
    n_time = int(np.flatnonzero(written)[-1]) + 1 if written.any() else 1
    theta, rate, bend, moment = (x[:, :n_time] for x in (theta, rate, bend, moment))
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    live = np.isfinite(theta)
    shaken = np.empty((2, batch.size, n_time))
    for j, channel in enumerate((batch.excitation.horizontal, batch.excitation.vertical)):
        for i in range(batch.size):
            shaken[j, i] = acceleration(channel, t, i)
    with np.errstate(invalid="ignore"):
        shaken[:, np.broadcast_to(t, theta.shape) > batch.excitation.duration[:, None]] = 0.0
    length = 2.0 * batch.block.h[:, None]
    mass = np.where(np.isfinite(batch.block.mass), batch.block.mass, 1.0)[:, None]
    across = length * bend
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "a_g": np.where(live, shaken[0], np.nan),
        "a_v": np.where(live, shaken[1], np.nan),
        "u_top": length * np.sin(theta) + across * np.cos(theta),
        "v_top": -length * (1.0 - np.cos(theta)) - across * np.sin(theta),
        "M_base": moment * length**2 * mass,
        "u_top_bending": across * np.cos(theta),
    }
    n_impacts = int(np.isfinite(run.landings[:, 0]).any(axis=0).sum())
    names = ("t_impact", "theta_dot_before", "theta_dot_after")
    impacts = {name: run.landings[:, j, :n_impacts] for j, name in enumerate(names)}
    return histories, impacts, t
