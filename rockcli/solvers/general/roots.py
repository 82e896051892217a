"""Roots of a smooth function on a step, none lost: all roots of its Chebyshev interpolant.

The dense output of every method is a polynomial of degree <= 12 over a step, which thirteen values determine.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]

N = 13
"""Number of nodes: polynomials up to degree 12, that of LSODA's highest order, are caught exactly."""

_ANGLES = np.pi * (np.arange(N) + 0.5) / N
NODES: Array = 0.5 * (1.0 + np.cos(_ANGLES))
"""Where a function has to be known, fractions of the step in (0, 1)."""

_WEIGHTS = np.cos(np.outer(np.arange(N), _ANGLES)) * (2.0 / N)
_WEIGHTS[0] *= 0.5


def coefficients(values: ArrayLike) -> Array:
    """Chebyshev coefficients over [0, 1] from the values at NODES."""
    return np.asarray(_WEIGHTS @ np.asarray(values))


def reach(c: Array) -> float:
    """A bound of |c_1 T_1 + c_2 T_2 + ...|: what the function strays from c_0."""
    return float(np.abs(c[1:]).sum())


def value(c: Array, x: float) -> float:
    """The polynomial at the fraction x of the step."""
    return float(chebyshev.chebval(2.0 * x - 1.0, c))


def roots(c: Array) -> list[float]:
    """Where the polynomial may change sign in (0, 1), in order; near-double roots are all there."""
    size = np.abs(c)
    kept = np.flatnonzero(size > 1e-16 * size.max())
    if len(kept) == 0 or kept[-1] == 0:
        return []
    z = chebyshev.chebroots(c[: kept[-1] + 1])
    x = 0.5 * (1.0 + z.real[np.abs(z.imag) < 0.1])
    return [float(r) for r in np.sort(x[(x > 0.0) & (x < 1.0)])]


def first_below(c: Array) -> float | None:
    """The first x in [0, 1] from which on the polynomial is negative; None if it nowhere is."""
    if c[0] > reach(c):
        return None
    above = None
    cuts = [0.0, *roots(c), 1.0]
    for i in range(len(cuts) - 1):
        middle = 0.5 * (cuts[i] + cuts[i + 1])
        if value(c, middle) < 0.0:
            if above is None:
                return 0.0
            return float(brentq(lambda x: value(c, x), above, middle, xtol=1e-16, rtol=1e-15))
        above = middle
    if value(c, 1.0) < 0.0:
        assert above is not None
        return float(brentq(lambda x: value(c, x), above, 1.0, xtol=1e-16, rtol=1e-15))
    return None
