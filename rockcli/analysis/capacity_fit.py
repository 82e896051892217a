"""A lognormal distribution of capacities, each known, or known to lie in an interval, by maximum likelihood.

P(capacity <= x) = Phi(a u - b), u = ln(x - x_0), a = 1/beta, b = ln(median - x_0)/beta: the likelihood is concave in a
and b (Olsen 1978).  The covariance is that of the sandwich with the factor n/(n - 1), so that limits of the median of
capacities that are all known are Student's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_ITERATIONS = 100

_STEEPEST = 1e6
"""1/beta, over the range of the capacities, beyond which they are one."""


@dataclass(frozen=True, eq=False)
class Capacities:
    """Capacities u = ln(x - x_0): each above `low` and at most `high`, known where the two are the same.

    Attributes:
        low, high: (n,), -inf and inf where there is no bound.
        member: (n,) whose it is: those of one are not independent.
    """

    low: Array
    high: Array
    member: Index


def fit(seen: Capacities) -> tuple[Array, Array] | None:
    """(a, b) and their covariance (2, 2); None where the likelihood has no maximum."""
    known = seen.low == seen.high
    ends = np.concatenate([seen.low, seen.high])
    ends = ends[np.isfinite(ends)]
    if not len(ends) or np.ptp(ends) == 0.0:
        return None
    centre, spread = float(ends.mean()), float(np.ptp(ends))
    low, high = ((end - centre) / spread for end in (seen.low, seen.high))
    x = np.array([2.0, 0.0])
    best, gradient, bend = _likelihood(x, low, high, known)
    for _ in range(_ITERATIONS):
        step = np.linalg.solve(bend, gradient.sum(axis=0))
        size = 1.0
        while True:
            trial = x + size * step
            found = _likelihood(trial, low, high, known) if trial[0] > 0.0 else None
            if found is not None and found[0] >= best - 1e-13 * abs(best):
                break
            size *= 0.5
            if size < 1e-12:
                return None
        x, (best, gradient, bend) = trial, found
        if x[0] > _STEEPEST or not np.isfinite(bend).all():
            return None
        if (np.abs(size * step) <= 1e-11 * (1.0 + np.abs(x))).all():
            return _unscaled(x, gradient, bend, seen.member, centre, spread)
    return None


def _likelihood(x: Array, low: Array, high: Array, known: NDArray[np.bool_]) -> tuple[float, Array, Array]:
    """Log-likelihood, its gradient row by row (n, 2), and minus its second derivative (2, 2)."""
    from scipy.special import log_ndtr

    n = len(low)
    gradient = np.zeros((n, 2))
    u = high[known]
    z = x[0] * u - x[1]
    total = float((-0.5 * z * z + np.log(x[0])).sum())
    gradient[known] = np.column_stack([1.0 / x[0] - z * u, z])
    bend = np.array([[(1.0 / x[0] ** 2 + u * u).sum(), -u.sum()], [-u.sum(), float(len(u))]])
    upper, lower = (np.where(np.isfinite(end), end, 0.0)[~known] for end in (high, low))
    a = np.where(np.isfinite(high[~known]), x[0] * upper - x[1], np.inf)
    c = np.where(np.isfinite(low[~known]), x[0] * lower - x[1], -np.inf)
    turned = c > 0.0  # in the upper tail, where differences of probabilities near 1 would cancel
    above, below = np.where(turned, -c, a), np.where(turned, -a, c)
    log_p = log_ndtr(above) + np.log1p(-np.exp(log_ndtr(below) - log_ndtr(above)))
    f_a, f_c = (np.exp(-0.5 * v * v - 0.5 * np.log(2.0 * np.pi) - log_p) for v in (a, c))
    by_a, by_c = (np.column_stack([end, -np.ones(len(end))]) for end in (upper, lower))
    gradient[~known] = f_a[:, None] * by_a - f_c[:, None] * by_c
    finite_a, finite_c = (np.where(np.isfinite(v), v, 0.0) for v in (a, c))
    bend = bend + (by_a.T * (f_a * (finite_a + f_a))) @ by_a + (by_c.T * (f_c * (f_c - finite_c))) @ by_c
    mixed = (by_a.T * (f_a * f_c)) @ by_c
    return total + float(log_p.sum()), gradient, bend - mixed - mixed.T


def _unscaled(
    x: Array, gradient: Array, bend: Array, member: Index, centre: float, spread: float
) -> tuple[Array, Array]:
    """Back to u as it was given, with the covariance clustered by member."""
    _, who = np.unique(member, return_inverse=True)
    n = int(who.max()) + 1
    score = np.zeros((n, 2))
    np.add.at(score, who.ravel(), gradient)
    inverse = np.linalg.inv(bend)
    covariance = inverse @ (score.T @ score) @ inverse * (n / max(n - 1, 1))
    back = np.array([[1.0 / spread, 0.0], [centre / spread, 1.0]])
    return back @ x, back @ covariance @ back.T
