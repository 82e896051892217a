"""Statistics of suites: fractiles that count overturning as infinite, rank correlation, inverse Mills ratio.

NaN is no answer and is left out; inf is an answer larger than every other.  scipy is imported where it is called, as
studies without a suite need none of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def fractile(values: Array, q: float, axis: int) -> Array:
    """The fractile q in [0, 1] along an axis: linear between the order statistics around rank 1 + (n - 1) q.

    n counts what is not NaN; inf where the upper of the two is inf and counts, -inf where the lower one is -inf and
    counts; NaN where n = 0.
    """
    ordered = np.sort(np.moveaxis(values, axis, 0), axis=0)  # NaN last
    n = np.sum(~np.isnan(ordered), axis=0)
    rank = np.round(np.maximum(n - 1, 0) * q, 9)  # a whole rank is whole in spite of rounding
    low = np.floor(rank).astype(int)
    below = np.take_along_axis(ordered, low[None], axis=0)[0]
    above = np.take_along_axis(ordered, np.ceil(rank).astype(int)[None], axis=0)[0]
    with np.errstate(invalid="ignore"):
        between = below + (rank - low) * (above - below)
    between = np.where(np.isposinf(above), above, np.where(np.isneginf(below), below, between))
    return np.asarray(np.where(rank == low, below, between))


def ranks(values: Array) -> Array:
    """Ranks along the last axis from 1; equal values share their mean rank; NaN stays NaN."""
    from scipy.stats import rankdata

    return np.asarray(rankdata(values, axis=-1, nan_policy="omit"))


def pearson(x: Array, y: Array) -> Array:
    """Correlation along the last axis of the pairs without NaN; NaN for fewer than three, or where one is constant."""
    known = ~(np.isnan(x) | np.isnan(y))
    n = known.sum(axis=-1, keepdims=True)
    deviations = []
    for values in (x, y):
        mean = np.where(known, values, 0.0).sum(axis=-1, keepdims=True) / np.maximum(n, 1)
        d = np.where(known, values - mean, 0.0)
        noise = 1e-12 * np.max(np.abs(np.where(known, values, 0.0)), axis=-1, initial=0.0, keepdims=True)
        deviations.append(np.where(np.abs(d).max(axis=-1, initial=0.0, keepdims=True) <= noise, 0.0, d))
    dx, dy = deviations
    scale = np.sqrt((dx * dx).sum(axis=-1) * (dy * dy).sum(axis=-1))
    enough = (n[..., 0] >= 3) & (scale > 0.0)
    return np.where(enough, (dx * dy).sum(axis=-1) / np.where(enough, scale, 1.0), np.nan)


def spearman(x: Array, y: Array) -> Array:
    """Rank correlation along the last axis of the pairs without NaN; inf is the largest rank."""
    missing = np.isnan(x) | np.isnan(y)
    return pearson(ranks(np.where(missing, np.nan, x)), ranks(np.where(missing, np.nan, y)))
