"""Fragility: a lognormal curve through the fractions of a suite that exceed a limit state, by maximum likelihood.

P(exceed | x) = Phi(ln(x/median)/beta).  The same suite is used at every intensity, so the points of a curve are not
independent trials: the covariance of the fit is clustered by the members of the suite (Liang and Zeger 1986, with
the factor n/(n-1)).  Binomial fit: Shinozuka et al. (2000); multiple stripes: Baker (2015), Earthq. Spectra 31(1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.statistics import inverse_mills

Array = NDArray[np.float64]

FITTED, NONE_EXCEEDS, ALL_EXCEED, SEPARABLE, FALLING = 0, 1, 2, 3, 4

STATUS: dict[int, str] = {
    FITTED: "fitted",
    NONE_EXCEEDS: "none_exceeds",
    ALL_EXCEED: "all_exceed",
    SEPARABLE: "separable",
    FALLING: "falling",
}

WHY_NOT: dict[int, str] = {
    NONE_EXCEEDS: "no case exceeds it, so the range is too low",
    ALL_EXCEED: "every case exceeds it, so the range is too high",
    SEPARABLE: "it goes from none to all between two intensities: beta cannot be estimated, the median only roughly",
    FALLING: "it is not exceeded more often as the intensity grows",
}
"""Why there is no curve."""

_ITERATIONS = 100


@dataclass(frozen=True, eq=False)
class Fit:
    """Lognormal curves, (f,) each: `median` in the units of the intensity, `beta` [1], NaN where not FITTED.

    `se_ln_median`, `se_beta`: standard errors; `correlation`: of the two estimates; `status`: int8, a key of STATUS.
    """

    median: Array
    beta: Array
    se_ln_median: Array
    se_beta: Array
    correlation: Array
    status: NDArray[np.int8]


def fit(intensity: Array, exceeds: Array, weight: Array) -> Fit:
    """Fit f curves at once.

    Args:
        intensity: (k,); values that are not positive have no logarithm and are left out.
        exceeds: (f, n, k) whether member n of the suite exceeds the limit state, or the share of its runs that do.
        weight: (f, n, k) or (1, n, k) the share of a member that is known: 0 left out, 1 whole.
    """
    positive = intensity > 0.0
    x = np.log(intensity[positive])
    known = np.broadcast_to(weight, exceeds.shape)[..., positive].astype(float)
    over = exceeds[..., positive] * known
    hits, trials = over.sum(axis=1), known.sum(axis=1)
    status = _status(x, hits, trials)
    centre, spread = (x.mean(), x.std() or 1.0) if len(x) else (0.0, 1.0)
    u = (x - centre) / spread
    solvable = status == FITTED
    c = np.full((len(hits), 2), np.nan)
    c[solvable] = _maximum(u, hits[solvable], trials[solvable])
    b = c[:, 1] / spread
    status[solvable & ~(b > 0.0)] = FALLING
    b = np.where(status == FITTED, b, np.nan)
    ln_median = centre - c[:, 0] / b
    covariance = np.full((len(hits), 2, 2), np.nan)
    good = status == FITTED
    covariance[good] = _clustered(u, over[good], known[good], c[good])
    # (c0, c1) -> (ln median, beta) = (centre - spread c0/c1, spread/c1)
    jacobian = np.empty_like(covariance)
    jacobian[:, 0, 0], jacobian[:, 0, 1] = -1.0 / b, (centre - ln_median) / (b * spread)
    jacobian[:, 1, 0], jacobian[:, 1, 1] = 0.0, -1.0 / (b * b * spread)
    moved = jacobian @ covariance @ np.swapaxes(jacobian, 1, 2)
    se = np.sqrt(np.maximum(np.diagonal(moved, axis1=1, axis2=2), 0.0))
    product = se[:, 0] * se[:, 1]
    correlation = np.divide(moved[:, 0, 1], product, out=np.full(len(b), np.nan), where=product > 0.0)
    return Fit(np.exp(ln_median), 1.0 / b, se[:, 0], se[:, 1], correlation, status)


def _status(x: Array, hits: Array, trials: Array) -> NDArray[np.int8]:
    """Whether a finite maximum exists: some intensity with misses lies above some intensity with hits."""
    some_hit, some_miss = hits > 0.0, hits < trials
    lowest_hit = np.where(some_hit, x, np.inf).min(axis=1, initial=np.inf)
    highest_hit = np.where(some_hit, x, -np.inf).max(axis=1, initial=-np.inf)
    lowest_miss = np.where(some_miss, x, np.inf).min(axis=1, initial=np.inf)
    highest_miss = np.where(some_miss, x, -np.inf).max(axis=1, initial=-np.inf)
    status = np.full(len(hits), FITTED, dtype=np.int8)
    status[highest_hit <= lowest_miss] = FALLING
    status[lowest_hit >= highest_miss] = SEPARABLE
    status[~some_miss.any(axis=1)] = ALL_EXCEED
    status[~some_hit.any(axis=1)] = NONE_EXCEEDS
    return status


def _maximum(u: Array, hits: Array, trials: Array) -> Array:
    """Newton's method with halved steps on the concave log-likelihood of z = c0 + c1 u; (f, 2)."""
    from scipy.special import log_ndtr

    misses = trials - hits
    c = np.zeros((len(hits), 2))

    def likelihood(c: Array) -> Array:
        z = c[:, :1] + c[:, 1:] * u
        return np.asarray((hits * log_ndtr(z) + misses * log_ndtr(-z)).sum(axis=1))

    best = likelihood(c)
    for _ in range(_ITERATIONS):
        z = c[:, :1] + c[:, 1:] * u
        slope, bend = _derivatives(z, hits, misses)
        g = np.stack([slope.sum(axis=1), (slope * u).sum(axis=1)], axis=1)
        step = np.linalg.solve(_moments(bend, u), g[..., None])[..., 0]
        size = np.ones(len(c))
        for _ in range(40):
            found = likelihood(c + size[:, None] * step)
            worse = found < best - 1e-13 * np.abs(best)
            if not worse.any():
                break
            size[worse] *= 0.5
        c = c + size[:, None] * step
        best = np.maximum(found, best)
        if (np.abs(size[:, None] * step) <= 1e-13 * (1.0 + np.abs(c))).all():
            break
    return c


def _derivatives(z: Array, hits: Array, misses: Array) -> tuple[Array, Array]:
    """First derivative, and minus the second, of the log-likelihood by z."""
    up, down = inverse_mills(z), inverse_mills(-z)
    return hits * up - misses * down, hits * up * (z + up) + misses * down * (down - z)


def _moments(weight: Array, u: Array) -> Array:
    """Sums of weight (1, u; u, u^2) over the last axis, (..., 2, 2)."""
    sums = [(weight * u**power).sum(axis=-1) for power in range(3)]
    return np.stack([np.stack(sums[:2], axis=-1), np.stack(sums[1:], axis=-1)], axis=-2)


def _clustered(u: Array, over: Array, known: Array, c: Array) -> Array:
    """Covariance of c (f, 2, 2), the scores of each member of the suite taken together."""
    z = c[:, :1] + c[:, 1:] * u
    missed = known - over
    hits, misses = over.sum(axis=1), missed.sum(axis=1)
    inverse = np.linalg.inv(_moments(_derivatives(z, hits, misses)[1], u))
    up, down = inverse_mills(z)[:, None], inverse_mills(-z)[:, None]
    slope = over * up - missed * down
    score = np.stack([slope.sum(axis=-1), (slope * u).sum(axis=-1)], axis=-1)  # (f, n, 2)
    n = (known > 0.0).any(axis=-1).sum(axis=-1).astype(float)
    meat = np.einsum("fni,fnj->fij", score, score) * (n / np.maximum(n - 1.0, 1.0))[:, None, None]
    return np.asarray(inverse @ meat @ inverse)
