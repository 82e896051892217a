"""A lognormal distribution of capacities, each known, or known to lie in an interval, by maximum likelihood.

P(capacity <= x) = Phi(a u - b), u = ln(x - x_0), a = 1/beta, b = ln(median - x_0)/beta: the likelihood is concave in a
and b (Olsen 1978).  The covariance is that of the sandwich with the factor n/(n - 1), so that limits of the median of
capacities that are all known are Student's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.interval_likelihood import (
    Likelihood,
    clustered_covariance,
    covariance_of_shared,
    interval_likelihood,
    maximum,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_STEEPEST = 1e6
"""1/beta, over the range of the capacities, beyond which they are one."""


@dataclass(frozen=True, eq=False)
class Capacities:
    """Capacities u = ln(x - x_0): each above `low` and at most `high`, known where the two are the same.

    Attributes:
        low, high: (n,), -inf and inf where there is no bound.
        member: (n,) whose it is: those of one are not independent.
        shared: (n,) which sample, drawn for all members together, it belongs to; None = there are none.
    """

    low: Array
    high: Array
    member: Index
    shared: Index | None = None


def fit(seen: Capacities) -> tuple[Array, Array] | None:
    """(a, b) and their covariance (2, 2); None where the likelihood has no maximum."""
    known = seen.low == seen.high
    ends = np.concatenate([seen.low, seen.high])
    ends = ends[np.isfinite(ends)]
    if not len(ends) or np.ptp(ends) == 0.0:
        return None
    centre, spread = float(ends.mean()), float(np.ptp(ends))
    low, high = ((end - centre) / spread for end in (seen.low, seen.high))
    peak = maximum(
        lambda x: _likelihood(x, low, high, known) if x[0] > 0.0 else None,
        np.array([2.0, 0.0]),
        lost=lambda x: bool(x[0] > _STEEPEST),
    )
    if peak is None:
        return None
    x, gradient, bend = peak
    covariance = clustered_covariance(gradient, bend, seen.member)
    if seen.shared is not None:
        covariance = covariance + covariance_of_shared(gradient, bend, seen.member, seen.shared)
    back = np.array([[1.0 / spread, 0.0], [centre / spread, 1.0]])
    return back @ x, back @ covariance @ back.T


def _likelihood(x: Array, low: Array, high: Array, known: NDArray[np.bool_]) -> Likelihood:
    """Of (a, b): the density of what is known, the probability of the intervals."""
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
    by_a, by_c = (np.column_stack([end, -np.ones(len(end))]) for end in (upper, lower))
    among, gradient[~known], curve = interval_likelihood(a, c, by_a, by_c)
    return total + among, gradient, bend + curve
