"""Maximum likelihood of normal variables known to lie in intervals: the likelihood, its maximum by Newton's method, and
the covariance of the estimate where rows of one member are no independent trials.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Likelihood = tuple[float, Array, Array]
"""Its logarithm, the gradient of it row by row (rows, k), and minus its second derivative (k, k)."""

_ITERATIONS = 200


def interval_likelihood(a: Array, c: Array, by_a: Array, by_c: Array, weight: Array | float = 1.0) -> Likelihood:
    """Of normal variables that lie between c and a.

    Args:
        a, c: (rows,) standardised ends, a > c; inf and -inf where there is none.
        by_a, by_c: (rows, k) derivatives of the ends by what is estimated; the ends are linear in it.
        weight: (rows,) or one for all.
    """
    log_p, gradient, (aa, cc, ac) = _rows(a, c, by_a, by_c, weight)
    mixed = (by_a.T * ac) @ by_c
    return float(log_p.sum()), gradient, (by_a.T * aa) @ by_a + (by_c.T * cc) @ by_c - mixed - mixed.T


def bends_of_members(
    a: Array, c: Array, by_a: Array, by_c: Array, weight: Array | float, member: NDArray[np.int64]
) -> Array:
    """Minus the second derivative of `interval_likelihood`, the part of every member, (members, k, k)."""
    aa, cc, ac = _rows(a, c, by_a, by_c, weight)[2]
    _, who = np.unique(member, return_inverse=True)
    k = by_a.shape[1]
    found = np.empty((int(who.max()) + 1, k, k))
    for i, j in np.ndindex(k, k):
        one = aa * by_a[:, i] * by_a[:, j] + cc * by_c[:, i] * by_c[:, j]
        one -= ac * (by_a[:, i] * by_c[:, j] + by_a[:, j] * by_c[:, i])
        found[:, i, j] = np.bincount(who.ravel(), one, len(found))
    return found


def _rows(a: Array, c: Array, by_a: Array, by_c: Array, weight: Array | float) -> tuple[Array, Array, Array]:
    """Of every row: the logarithm, its gradient (rows, k), and its curvature by a, by c and by both (3, rows)."""
    from scipy.special import log_ndtr

    turned = c > 0.0  # in the upper tail, where differences of probabilities near 1 would cancel
    above, below = np.where(turned, -c, a), np.where(turned, -a, c)
    log_p = log_ndtr(above) + np.log1p(-np.exp(log_ndtr(below) - log_ndtr(above)))
    f_a, f_c = (np.exp(-0.5 * v * v - 0.5 * np.log(2.0 * np.pi) - log_p) for v in (a, c))
    finite_a, finite_c = (np.where(np.isfinite(v), v, 0.0) for v in (a, c))
    w = np.broadcast_to(weight, a.shape)
    gradient = w[:, None] * (f_a[:, None] * by_a - f_c[:, None] * by_c)
    return w * log_p, gradient, w * np.stack([f_a * (finite_a + f_a), f_c * (f_c - finite_c), f_a * f_c])


def maximum(
    likelihood: Callable[[Array], Likelihood | None], x: Array, lost: Callable[[Array], bool]
) -> tuple[Array, Array, Array] | None:
    """Where the likelihood is largest, (k,), with its gradient and second derivative there; None without a maximum.

    Args:
        likelihood: of (k,) parameters; None where they are not allowed.
        x: (k,) to begin with, allowed.
        lost: whether the parameters are so far out that there is no maximum.
    """
    found = likelihood(x)
    assert found is not None
    best, gradient, bend = found
    for _ in range(_ITERATIONS):
        try:
            step = np.linalg.solve(bend, gradient.sum(axis=0))
        except np.linalg.LinAlgError:
            return None
        size = 1.0
        while (found := likelihood(x + size * step)) is None or not found[0] >= best - 1e-13 * abs(best):
            size *= 0.5
            if size < 1e-12:
                return None
        x = x + size * step
        best, gradient, bend = found
        if lost(x) or not np.isfinite(bend).all():
            return None
        if (np.abs(size * step) <= 1e-12 * (1.0 + np.abs(x))).all():
            return x, gradient, bend
    return None


def clustered_covariance(gradient: Array, bend: Array, member: NDArray[np.int64]) -> Array:
    """Covariance (k, k) of an estimate: the sandwich, with the factor n/(n - 1) (Liang and Zeger 1986).

    NaN for n = 1: the gradient of a single member is zero at the maximum, and tells no scatter.

    Args:
        gradient: (rows, k) at the maximum.
        bend: (k, k) minus the second derivative there.
        member: (rows,) which of n independent members a row belongs to.
    """
    score = _scores(gradient, member)
    n = len(score)
    if n == 1:
        return np.full(bend.shape, np.nan)
    inverse = np.linalg.inv(bend)
    return np.asarray(inverse @ (score.T @ score) @ inverse * (n / (n - 1)))


def covariance_of_shared(gradient: Array, bend: Array, member: NDArray[np.int64], shared: NDArray[np.int64]) -> Array:
    """What samples that all members share add to `clustered_covariance`, (k, k) (Cameron, Gelbach and Miller 2011).

    The covariance clustered by sample less that of sample and member, without what of it is negative.

    Args:
        gradient, bend, member: as of `clustered_covariance`.
        shared: (rows,) which sample a row belongs to.
    """
    _, both = np.unique(np.stack([member, shared]), axis=1, return_inverse=True)
    more = clustered_covariance(gradient, bend, shared) - clustered_covariance(gradient, bend, both.ravel())
    values, vectors = np.linalg.eigh(0.5 * (more + more.T))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)


def moves_without_members(gradient: Array, bends: Array, member: NDArray[np.int64]) -> Array | None:
    """How the estimate moves without each member, (members, k), in one Newton step (Bell and McCaffrey 2002, CR3).

    Args:
        gradient, member: as of `clustered_covariance`; bends: (members, k, k) of `bends_of_members`.

    Returns:
        None where there is no estimate without some member.
    """
    try:
        return np.asarray(-np.linalg.solve(bends.sum(axis=0) - bends, _scores(gradient, member)[..., None])[..., 0])
    except np.linalg.LinAlgError:
        return None


def jackknife_covariance(moves: Array) -> Array:
    """Covariance (k, k) from how the estimate moves without each of n members, (n, k).

    The sandwich is too small for what differs between few members.
    """
    n = len(moves)
    return np.asarray(moves.T @ moves * ((n - 1) / n))


def _scores(gradient: Array, member: NDArray[np.int64]) -> Array:
    """The gradient of every member, (members, k)."""
    _, who = np.unique(member, return_inverse=True)
    score = np.zeros((int(who.max()) + 1, gradient.shape[1]))
    np.add.at(score, who.ravel(), gradient)
    return score
