"""Two runs of one batch at different accuracies: the error they show, and where it leaves the outcome unknown."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT, ROCKING, UNRESOLVED

Array = NDArray[np.float64]
Scalars = dict[str, NDArray[Any]]

HORIZON, GROWTH = 1e-2, 1e3
"""Two runs have parted where their peaks theta/alpha are this far apart, and so many times the tolerance of the coarser
one: a motion that multiplies its errors so has forgotten its start."""

FALLS_APART = 10.0
"""Falls of one body are the same one if they are no more than this many horizons apart, in units of 1/p: near a
boundary the time of a fall is known less well than a peak."""


FEW, SHARE = 2, 0.02
"""Runs whose impacts differ by more than this many and by more than this share have parted after the peak."""


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


def parted_later(scalars: Scalars, other: Scalars) -> NDArray[np.bool_]:
    """Where two runs that both rock count other impacts, (n,): after the peak they have gone different ways."""
    rock = (scalars["outcome"] == ROCKING) & (other["outcome"] == ROCKING)
    one, two = scalars["n_impacts"], other["n_impacts"]
    return np.asarray(rock & (np.abs(one - two) > np.maximum(FEW, SHARE * np.maximum(one, two))))


def compare_accuracies(
    batch: Batch,
    scalars: Scalars,
    other: Scalars,
    reasons: list[str],
    horizon: float | Array = np.inf,
    *,
    to_the_end: bool = False,
) -> None:
    """Set `error_estimate` from another run; make a case `unresolved` if the two leave its outcome unknown.

    That is so where one run overturns and the other does not, and where they have parted: peaks farther apart than
    `horizon`, falls in different swings, or, `to_the_end`, other impacts.  That both came to one outcome is then
    chance.  A backend whose errors are those of its steps, and no sign of chaos, has no horizon: inf.
    """
    apart = disagreement(batch, scalars, other, horizon)
    later = parted_later(scalars, other) if to_the_end else np.zeros(batch.size, dtype=bool)
    unknown = (apart >= horizon) | later
    scalars["error_estimate"] = np.where(later, np.inf, apart)
    for i in np.flatnonzero(unknown):
        times = scalars["t_overturn"][i], other["t_overturn"][i]
        if later[i]:
            counts = scalars["n_impacts"][i], other["n_impacts"][i]
            said = "two accuracies count {} and {} impacts: chaotic, its outcome would be chance".format(*counts)
        elif np.isfinite(apart[i]):
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
    peaks = ("theta_peak", "theta_peak_left", "theta_peak_right", "theta_peak_over_alpha", "theta_dot_peak")
    for name in (*peaks, "u_top_peak", "t_peak", "t_overturn"):
        if name in scalars:
            scalars[name][which] = np.nan
