"""Ordered probit by maximum likelihood: nested states of members seen at several intensities.

A member at intensities u is in category j or above with probability Phi(s.u - t_j), t_1 <= t_2 <= ...: one slope for
all states, so their curves never cross (McCullagh 1980; with one state the ordinary probit).  A row may be known to lie
in a range of categories only.  The same member is seen at every intensity, so rows are no independent trials: the
covariance is clustered by member (Liang and Zeger 1986), with the factor n/(n - 1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_ITERATIONS = 200

_FAR = 40.0
"""Standardised slope beyond which the likelihood has no maximum: the states are separated."""


@dataclass(frozen=True, eq=False)
class Rows:
    """What was seen, r rows.

    Attributes:
        u: (r, d) explaining variables, such as ln(intensity).
        low, high: (r,) lowest and highest category it may be in, of 0 ... states.
        weight: (r,) > 0.
        member: (r,) whose row it is.
    """

    u: Array
    low: Index
    high: Index
    weight: Array
    member: Index


@dataclass(frozen=True, eq=False)
class Probit:
    """Slopes (d,), cuts (states,), and their covariance in this order, (d + states, d + states)."""

    slopes: Array
    cuts: Array
    covariance: Array


def ordered_probit(rows: Rows, states: int) -> Probit | None:
    """The maximum of the likelihood; None where there is none, as the categories are separated.

    Every category up to `states` must have rows whose `low` and `high` it is: states without any between them are one.
    """
    centre = rows.u.mean(axis=0)
    spread = rows.u.std(axis=0)
    spread = np.where(spread > 0.0, spread, 1.0)
    u = (rows.u - centre) / spread
    d = u.shape[1]
    order = np.arange(states)
    upper = _design(u, rows.low, states)  # of the lower cut, which bounds the category from below
    lower = _design(u, rows.high + 1, states)
    total = rows.weight.sum()
    shares = [(rows.weight * (rows.low > j)).sum() / total for j in order]
    x = np.concatenate([np.zeros(d), _starts(np.array(shares))])
    best, gradient, bend = _likelihood(x, upper, lower, rows, states)
    for _ in range(_ITERATIONS):
        step = np.linalg.solve(bend, gradient.sum(axis=0))
        size = 1.0
        while True:
            trial = x + size * step
            found = _likelihood(trial, upper, lower, rows, states) if (np.diff(trial[d:]) > 0.0).all() else None
            if found is not None and found[0] >= best - 1e-13 * abs(best):
                break
            size *= 0.5
            if size < 1e-12:
                return None
        x, (best, gradient, bend) = trial, found
        if np.abs(x[:d]).max() > _FAR or not np.isfinite(bend).all():
            return None
        if (np.abs(size * step) <= 1e-12 * (1.0 + np.abs(x))).all():
            return _unscaled(x, gradient, bend, rows.member, centre, spread)
    return None


def _starts(shares: Array) -> Array:
    """Cuts that give the shares, each at least a little above the one before."""
    from scipy.special import ndtri

    cuts = -ndtri(np.clip(shares, 1e-3, 1.0 - 1e-3))
    return np.asarray(np.maximum.accumulate(cuts) + 1e-3 * np.arange(len(cuts)))


def _design(u: Array, category: Index, states: int) -> Array:
    """Rows of s.u - t_category as a linear function of (s, t); what has no such cut has the slopes alone."""
    cuts = -(category[:, None] == np.arange(1, states + 1)).astype(float)
    return np.concatenate([u, cuts], axis=1)


def _likelihood(x: Array, upper: Array, lower: Array, rows: Rows, states: int) -> tuple[float, Array, Array]:
    """Log-likelihood, its gradient row by row (r, q), and minus its second derivative (q, q)."""
    from scipy.special import log_ndtr

    a = np.where(rows.low > 0, upper @ x, np.inf)
    c = np.where(rows.high < states, lower @ x, -np.inf)
    turned = c > 0.0  # in the upper tail, where differences of probabilities near 1 would cancel
    above, below = np.where(turned, -c, a), np.where(turned, -a, c)
    log_p = log_ndtr(above) + np.log1p(-np.exp(log_ndtr(below) - log_ndtr(above)))
    f_a, f_c = (np.exp(-0.5 * v * v - 0.5 * np.log(2.0 * np.pi) - log_p) for v in (a, c))
    finite_a, finite_c = (np.where(np.isfinite(v), v, 0.0) for v in (a, c))
    w = rows.weight
    gradient = w[:, None] * (f_a[:, None] * upper - f_c[:, None] * lower)
    h_aa, h_cc, h_ac = f_a * (finite_a + f_a), f_c * (f_c - finite_c), f_a * f_c
    bend = (upper.T * (w * h_aa)) @ upper + (lower.T * (w * h_cc)) @ lower
    mixed = (upper.T * (w * h_ac)) @ lower
    return float((w * log_p).sum()), gradient, bend - mixed - mixed.T


def _unscaled(x: Array, gradient: Array, bend: Array, member: Index, centre: Array, spread: Array) -> Probit:
    """Back to the variables as they were given, with the clustered covariance."""
    d = len(centre)
    _, who = np.unique(member, return_inverse=True)
    n = int(who.max()) + 1
    score = np.zeros((n, len(x)))
    np.add.at(score, who.ravel(), gradient)
    inverse = np.linalg.inv(bend)
    covariance = inverse @ (score.T @ score) @ inverse * (n / max(n - 1, 1))
    back = np.eye(len(x))
    back[:d, :d] = np.diag(1.0 / spread)
    back[d:, :d] = centre / spread
    moved = back @ x
    return Probit(moved[:d], moved[d:], back @ covariance @ back.T)
