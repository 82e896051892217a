"""Whether a fragility curve misses the shares it was fitted to, by the binomial distribution of every share.

A share of n members has the probability P(X <= hits) or P(X >= hits) under the curve.  The farthest of k shares is told
with k times its two-sided probability (Bonferroni): a bound, whatever the dependence of shares of the same members, and
a little too large, as the curve was fitted to them.  Members that belong together count as one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

LEVEL = 0.01
"""Probability below which a curve is said to miss its shares."""

_GROUPS = 10
"""Groups of equal size, ordered by the curve, where intensities are too many for shares (Hosmer and Lemeshow 1980)."""

_LEAST = 5
"""Rows per intensity from which the share at every intensity is taken."""


def groups_of(x: Array, p: Array) -> Index:
    """Which rows make one share, (r,): those of one intensity, or of a tenth of the rows."""
    found, at = np.unique(x, return_inverse=True)
    if len(found) * _LEAST <= len(x):
        return np.asarray(at.ravel())
    place = np.empty(len(p), dtype=np.int64)
    place[np.argsort(p, kind="stable")] = np.arange(len(p))
    return place * min(_GROUPS, max(len(p) // _LEAST, 1)) // len(p)


def misfit(p: Array, exceeds: Array, weight: Array, member: Index, group: Index) -> tuple[float, int]:
    """The bound on the probability of the farthest share, at most 1, and its group.

    Args:
        p: (r,) probability of every row by the curve; exceeds: (r,) 0 or 1; weight: (r,) > 0.
        member: (r,) which rows are not independent; group: (r,) from 0, which rows make a share.
    """
    k = int(group.max()) + 1
    total = np.bincount(group, weight, k)
    expected, share = (np.bincount(group, weight * values, k) / total for values in (p, exceeds))
    pairs = np.unique(np.stack([group, member]), axis=1)
    found = two_sided(share, np.bincount(pairs[0], minlength=k).astype(float), expected)
    at = int(np.argmin(found))
    return min(1.0, k * float(found[at])), at


def two_sided(share: Array, members: Array, p: Array) -> Array:
    """Twice the smaller tail of the binomial distribution of `members` at probability p that begins at `share`."""
    from scipy.special import betainc

    hits = share * members
    left = np.clip(members - hits, 0.0, None)
    with np.errstate(invalid="ignore"):
        at_least = np.where(hits > 0.0, betainc(np.maximum(hits, 1e-300), left + 1.0, p), 1.0)
        at_most = np.where(left > 0.0, 1.0 - betainc(hits + 1.0, np.maximum(left, 1e-300), p), 1.0)
    return np.asarray(np.minimum(1.0, 2.0 * np.minimum(at_least, at_most)))
