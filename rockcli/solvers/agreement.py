"""Two runs of one batch at different accuracies: the error they show, and where it leaves the outcome unknown."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT, UNRESOLVED

Array = NDArray[np.float64]
Scalars = dict[str, NDArray[Any]]

HORIZON, GROWTH = 1e-2, 1e3
"""Two runs have parted where their peaks theta/alpha are this far apart, and so many times the tolerance of the coarser
one: a motion that multiplies its errors so has forgotten its start."""

FALLS_APART = 10.0
"""Falls of one body are the same one if they are no more than this many horizons apart, in units of 1/p: near a
boundary the time of a fall is known less well than a peak."""


def horizon_of(rtol: float) -> float:
    """Difference of peaks theta/alpha from which runs have parted, the coarser one of tolerance rtol."""
    return max(HORIZON, GROWTH * rtol)


def disagreement(batch: Batch, scalars: Scalars, other: Scalars, horizon: float | Array) -> Array:
    """How far the peaks theta/alpha of two runs are apart, (n,).

    Where both overturn 0, if it is the same fall, else inf; inf where one alone overturns; NaN where either has no
    answer.
    """
    fell, fell_too = (run["outcome"] >= OVERTURNED_WITHOUT_IMPACT for run in (scalars, other))
    answered = (scalars["outcome"] >= NO_UPLIFT) & (other["outcome"] >= NO_UPLIFT)
    with np.errstate(invalid="ignore"):
        peaks = np.abs(scalars["theta_peak_over_alpha"] - other["theta_peak_over_alpha"])
        between = np.abs(scalars["t_overturn"] - other["t_overturn"]) * batch.p.min(axis=1)
        falls = np.where(between > FALLS_APART * horizon, np.inf, 0.0)
    apart = np.where(fell & fell_too, falls, np.where(fell | fell_too, np.inf, peaks))
    return np.where(answered, apart, np.nan)


def compare_accuracies(
    batch: Batch, scalars: Scalars, other: Scalars, reasons: list[str], horizon: float | Array = np.inf
) -> None:
    """Set `error_estimate` from another run; make a case `unresolved` if the two leave its outcome unknown.

    That is so where one run overturns and the other does not, and where they have parted: peaks farther apart than
    `horizon`, or falls in different swings.  That both came to one outcome is then chance.  A backend whose errors are
    those of its steps, and no sign of chaos, has no horizon: inf.
    """
    apart = disagreement(batch, scalars, other, horizon)
    scalars["error_estimate"] = apart
    unknown = apart >= horizon
    for i in np.flatnonzero(unknown):
        times = scalars["t_overturn"][i], other["t_overturn"][i]
        if np.isfinite(apart[i]):
            said = f"two accuracies differ by {apart[i]:.2g} in peak theta/alpha: chaotic, its outcome would be chance"
        elif np.isfinite(times).all():
            said = "two accuracies overturn at {:.5g} and {:.5g} s: chaotic, its outcome would be chance".format(*times)
        else:
            said = "two accuracies disagree on the outcome: it is too close to a boundary, chaotic, or too coarse"
        reasons[i] = "; ".join(filter(None, [reasons[i], said]))
    withdraw(scalars, unknown)


def withdraw(scalars: Scalars, which: NDArray[np.bool_]) -> None:
    """Make cases `unresolved`: what they came to is not known."""
    scalars["outcome"][which] = UNRESOLVED
    for name in ("theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "t_peak", "t_overturn"):
        scalars[name][which] = np.nan
