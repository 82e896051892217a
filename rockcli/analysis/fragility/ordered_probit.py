"""Ordered probit by maximum likelihood: nested states of members seen at several intensities.

A member at intensities u is in category j or above with probability Phi(s.u - t_j), t_1 <= t_2 <= ...: one slope for
all states, so their curves never cross (McCullagh 1980; with one state the ordinary probit).  A row may be known to lie
in a range of categories only.  The same member is seen at every intensity, so rows are no independent trials: the
covariance is clustered by member (Liang and Zeger 1986), with the factor n/(n - 1), and by samples that members share.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.interval_likelihood import (
    Likelihood,
    bends_of_members,
    clustered_covariance,
    covariance_of_shared,
    interval_likelihood,
    maximum,
    moves_without_members,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_FAR = 40.0
"""Standardised slope beyond which the likelihood has no maximum: the states are separated."""

_FLAT = 1e-9
"""Standardised slope below which it is rounding: the shares do not change."""

_SMALL = 0.25
"""Part of the distance of two cuts by which one step may bring them closer; with few members between them it errs."""


@dataclass(frozen=True, eq=False)
class Rows:
    """What was seen, r rows.

    Attributes:
        u: (r, d) explaining variables, such as ln(intensity).
        low, high: (r,) lowest and highest category it may be in, of 0 ... states.
        weight: (r,) > 0.
        member: (r,) whose row it is.
        shared: (r,) which sample, drawn for all members together, a row belongs to; None = there are none.
    """

    u: Array
    low: Index
    high: Index
    weight: Array
    member: Index
    shared: Index | None = None


@dataclass(frozen=True, eq=False)
class Probit:
    """An estimate.

    Attributes:
        slopes, cuts: (d,) and (states,).
        covariance: of both in this order, (d + states, d + states).
        of_shared: the part of it that comes from samples that members share.
        without: both as they are without each member, (members, d + states), by a step from the estimate or by a fit;
            None where that is not known.
        fitted: without which members it is by a fit, (members,).
    """

    slopes: Array
    cuts: Array
    covariance: Array
    of_shared: Array
    without: Array | None = None
    fitted: NDArray[np.bool_] | None = None


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
    peak = _maximum(np.concatenate([np.zeros(d), _starts(np.array(shares))]), upper, lower, rows)
    if peak is None:
        return None
    x, gradient, bend = peak
    x[:d][np.abs(x[:d]) < _FLAT] = 0.0
    covariance, of_shared = clustered_covariance(gradient, bend, rows.member), np.zeros_like(bend)
    if rows.shared is not None:
        of_shared = covariance_of_shared(gradient, bend, rows.member, rows.shared)
    bends = bends_of_members(*_ends(x, upper, lower, rows, states), rows.weight, rows.member)
    moves = moves_without_members(gradient, bends, rows.member)
    fitted = None
    if moves is not None:
        fitted = _fit_again(x, moves, Rows(u, rows.low, rows.high, rows.weight, rows.member))
    back = np.eye(len(x))
    back[:d, :d] = np.diag(1.0 / spread)
    back[d:, :d] = centre / spread
    moved = back @ x
    without = None if moves is None else (x + moves) @ back.T
    whole, part = (back @ of @ back.T for of in (covariance + of_shared, of_shared))
    return Probit(moved[:d], moved[d:], whole, part, without, fitted)


def _maximum(x: Array, upper: Array, lower: Array, rows: Rows) -> tuple[Array, Array, Array] | None:
    """`maximum` over slopes and ascending cuts, from x on."""
    d = rows.u.shape[1]
    states = len(x) - d
    return maximum(
        lambda x: _likelihood(x, upper, lower, rows, states) if (np.diff(x[d:]) > 0.0).all() else None,
        x,
        lost=lambda x: bool(np.abs(x[:d]).max() > _FAR),
    )


def _fit_again(x: Array, moves: Array, rows: Rows) -> NDArray[np.bool_]:
    """Put what a fit finds in place of those moves of the estimate x that bring two cuts much closer; which ones it is.

    Where there is no estimate without a member, its step ends where two cuts meet.
    """
    d = rows.u.shape[1]
    gaps, members = np.diff(x[d:]), np.unique(rows.member)
    fitted = np.zeros(len(members), dtype=bool)
    closer = -np.diff(moves[:, d:], axis=1) / gaps
    for k in np.flatnonzero((closer > _SMALL).any(axis=1)):
        kept = rows.member != members[k]
        found = _estimate(x, Rows(*(of[kept] for of in (rows.u, rows.low, rows.high, rows.weight, rows.member))))
        fitted[k] = found is not None
        moves[k] = moves[k] / max(1.0, float(closer[k].max())) if found is None else found - x
    return fitted


def _estimate(x: Array, rows: Rows) -> Array | None:
    """The estimate of some of the rows of which x is that of all; cuts without a row between them are one."""
    d = rows.u.shape[1]
    states = len(x) - d
    there = np.bincount(rows.low[rows.low == rows.high], minlength=states + 1) > 0
    if not there[0] or not there[states]:
        return None
    group = np.concatenate([[0], np.cumsum(there[1:states])])  # of every cut
    low = np.where(rows.low > 0, group[rows.low - 1] + 1, 0)
    high = np.where(rows.high < states, group[np.minimum(rows.high, states - 1)], group[-1] + 1)
    if (low > high).any():  # known only to lie between cuts that are one now
        return None
    fewer = Rows(rows.u, low, high, rows.weight, rows.member)
    cuts = np.bincount(group, x[d:]) / np.bincount(group)
    upper, lower = (_design(rows.u, category, len(cuts)) for category in (low, high + 1))
    peak = _maximum(np.concatenate([x[:d], cuts]), upper, lower, fewer)
    return None if peak is None else np.concatenate([peak[0][:d], peak[0][d:][group]])


def _starts(shares: Array) -> Array:
    """Cuts that give the shares, each at least a little above the one before."""
    from scipy.special import ndtri

    cuts = -ndtri(np.clip(shares, 1e-3, 1.0 - 1e-3))
    return np.asarray(np.maximum.accumulate(cuts) + 1e-3 * np.arange(len(cuts)))


def _design(u: Array, category: Index, states: int) -> Array:
    """Rows of s.u - t_category as a linear function of (s, t); what has no such cut has the slopes alone."""
    cuts = -(category[:, None] == np.arange(1, states + 1)).astype(float)
    return np.concatenate([u, cuts], axis=1)


def _likelihood(x: Array, upper: Array, lower: Array, rows: Rows, states: int) -> Likelihood:
    """Of slopes and cuts."""
    return interval_likelihood(*_ends(x, upper, lower, rows, states), rows.weight)


def _ends(x: Array, upper: Array, lower: Array, rows: Rows, states: int) -> tuple[Array, Array, Array, Array]:
    """A row lies between the cuts below its lowest and above its highest category; with the derivatives of both."""
    a = np.where(rows.low > 0, upper @ x, np.inf)
    c = np.where(rows.high < states, lower @ x, -np.inf)
    return a, c, upper, lower
