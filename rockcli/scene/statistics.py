"""Statistics of suites: fractiles that count overturning as infinite, correlations, and the normal law in its tails.

NaN is no answer and is left out; inf is an answer larger than every other.
"""

from __future__ import annotations

from math import erfc, pi, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_FAR = -30.0
"""Below it the tail of the normal law is taken from its asymptotic series, good to rounding there."""

_erfc = np.vectorize(erfc, otypes=[float])


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
    n = values.shape[-1]
    order = np.argsort(values, axis=-1, kind="stable")
    ordered = np.take_along_axis(values, order, axis=-1)
    new = np.ones(ordered.shape, dtype=bool)
    new[..., 1:] = ordered[..., 1:] != ordered[..., :-1]
    last = np.roll(new, -1, axis=-1)
    last[..., -1] = True
    place = np.arange(n)
    first = np.maximum.accumulate(np.where(new, place, 0), axis=-1)
    end = np.flip(np.minimum.accumulate(np.flip(np.where(last, place, n), axis=-1), axis=-1), axis=-1)
    found = np.empty(values.shape)
    np.put_along_axis(found, order, 0.5 * (first + end) + 1.0, axis=-1)
    return np.where(np.isnan(values), np.nan, found)


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


def normal_cdf(z: Array) -> Array:
    """Probability that a standard normal variable is below z."""
    return np.asarray(0.5 * _erfc(-np.asarray(z) / sqrt(2.0)))


def normal_log_cdf(z: Array) -> Array:
    """Logarithm of `normal_cdf`, finite far below zero and not rounded to nothing far above it."""
    low = np.minimum(z, 0.0)
    below = -0.5 * low * low - 0.5 * np.log(2.0 * pi) - np.log(inverse_mills(low))
    return np.where(z > 0.0, np.log1p(-normal_cdf(-np.maximum(z, 0.0))), below)


def inverse_mills(z: Array) -> Array:
    """Density over probability of the standard normal law below z."""
    near = np.maximum(z, _FAR)
    ratio = np.exp(-0.5 * near * near) / sqrt(2.0 * pi) / normal_cdf(near)
    with np.errstate(divide="ignore", invalid="ignore"):
        far = -z / (1.0 - z**-2 + 3.0 * z**-4 - 15.0 * z**-6)
    return np.asarray(np.where(z < _FAR, far, ratio))
