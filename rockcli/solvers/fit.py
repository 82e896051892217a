"""Least squares with confidence intervals (scipy's `least_squares`, Student's t)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """Parameters that make the residuals smallest.

    Attributes:
        values: (k,); low, high: ends of the 95 % confidence intervals, NaN where the data do not determine them.
        scatter: standard deviation of the residuals, with n - k degrees of freedom.
        converged: whether the search ended at a minimum.
    """

    values: Array
    low: Array
    high: Array
    scatter: float
    converged: bool


def least_squares_fit(
    residuals: Callable[[Array], Array],
    start: Array,
    step: Array,
    bounds: tuple[Array, Array],
    *,
    size: float,
    final: bool,
) -> Fit:
    """Smallest sum of squares of the residuals over x (k,), from `start`, by trust regions.

    The intervals are linear: the covariance is s² (JᵀJ)⁻¹ with the Jacobian at the solution, s² the residual variance.

    Args:
        residuals: of several x at once, (m, k) -> (m, n), finite within the bounds.
        start, step: first guess and steps of the finite differences, (k,) each.
        bounds: lowest and highest values, (k,) each.
        size: of what was measured, > 0: the search looks at residuals over it, so that small ones do not end it.
        final: search to the end and work out the intervals; else only nearly.
    """
    from scipy import optimize, stats

    k = len(start)

    def at(x: Array) -> Array:
        return np.asarray(residuals(x[None])[0])

    def jacobian(x: Array) -> Array:
        ahead, behind = np.minimum(x + np.diag(step), bounds[1]), np.maximum(x - np.diag(step), bounds[0])
        moved = residuals(np.concatenate([ahead, behind]))
        return np.asarray(((moved[:k] - moved[k:]) / np.diag(ahead - behind)[:, None]).T)

    found = optimize.least_squares(
        lambda x: at(x) / size,
        start,
        jac=lambda x: jacobian(x) / size,
        bounds=bounds,
        x_scale=np.maximum(np.abs(start), step),
        xtol=1e-8,
        ftol=1e-9 if final else 1e-4,
    )
    x, r = np.asarray(found.x, dtype=float), size * np.asarray(found.fun, dtype=float)
    n = len(r)
    unknown = np.full(k, np.nan)
    if not final or n <= k:
        return Fit(x, unknown, unknown, float("nan"), bool(found.success))
    J = jacobian(x)
    variance = float(r @ r) / (n - k)
    try:
        covariance = variance * np.linalg.inv(J.T @ J)
        half = stats.t.ppf(0.975, n - k) * np.sqrt(np.diag(covariance))
    except np.linalg.LinAlgError:
        half = unknown
    return Fit(x, x - half, x + half, float(np.sqrt(variance)), bool(found.success))
