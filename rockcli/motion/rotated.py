"""Measures of two horizontal components in every direction: RotD50 and RotD100 (Boore 2010, BSSA 100: 1830-1835)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rockcli.motion.measures import velocity
from rockcli.motion.spectrum import Stretch, history

Array = NDArray[np.float64]

ANGLES = 180
"""Directions, one a degree."""

POINTS_PER_PERIOD = 100
"""Points of a history per period at least: a free oscillation is at most 0.05 % higher between two of them."""

POINTS_PER_STEP = 4
"""Points of a history per time step at least: of a long period it is the ground's acceleration that bends it."""

_AT_ONCE = 20_000
"""Points turned at a time."""

_FARTHEST = 500
"""Points of largest amplitude by which most of the others are seen to be the peak in no direction."""


def rotated(one: ArrayLike, two: ArrayLike) -> tuple[float, float]:
    """RotD50 and RotD100 of two components, (k,) each: median and largest over the directions of the peaks."""
    x, y = np.asarray(one, dtype=float), np.asarray(two, dtype=float)
    angle = np.pi * np.arange(ANGLES) / ANGLES
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    if len(x) > 2 * _FARTHEST:
        far = np.hypot(x, y)
        first = far >= np.partition(far, -_FARTHEST)[-_FARTHEST]
        kept = first | (far >= _peaks(x[first], y[first], cos, sin).min() * (1.0 - 1e-12))
        x, y = x[kept], y[kept]
    peak = _peaks(x, y, cos, sin)
    return float(np.median(peak)), float(peak.max())


def _peaks(x: Array, y: Array, cos: Array, sin: Array) -> Array:
    """Peaks of two components (k,) in directions of these cosines and sines, (m, 1) each: (m,)."""
    peak = np.zeros(len(cos))
    for i in range(0, len(x), _AT_ONCE):
        turned = np.abs(cos * x[i : i + _AT_ONCE] + sin * y[i : i + _AT_ONCE])
        peak = np.maximum(peak, turned.max(axis=1))
    return peak


def rotated_measures(one: Array, two: Array, dt: float) -> dict[str, tuple[float, float]]:
    """RotD50 and RotD100 of PGA [m/s²] and PGV [m/s] of two components, (k,) each [m/s²]."""
    return {"pga": rotated(one, two), "pgv": rotated(velocity(one, dt), velocity(two, dt))}


def rotated_spectrum(one: Array, two: Array, dt: float, periods: Array, zeta: float = 0.05) -> tuple[Array, Array]:
    """RotD50 and RotD100 of the pseudo-acceleration of oscillators under two components.

    Args:
        one, two: of equal length, (k,) [m/s²], linear between samples.
        dt: time step [s].
        periods: (m,) [s], > 0.
        zeta: damping ratio.

    Returns:
        (m,) each [m/s²].
    """
    motions = [(Stretch(0.0, dt, np.column_stack([a[:-1], np.diff(a) / dt])),) for a in (one, two)]
    found = np.zeros((2, len(periods)))
    for i, period in enumerate(periods):
        parts = max(int(np.ceil(POINTS_PER_PERIOD * dt / period)), POINTS_PER_STEP)
        h = float(dt / parts)
        t = np.multiply(h, np.arange(int(np.ceil(((len(one) - 1) * dt + period) / h)) + 1), dtype=np.float64)
        x, y = (history(motion, float(period), zeta, t)[0] for motion in motions)
        found[:, i] = rotated(x, y)
    return (2.0 * np.pi / periods) ** 2 * found[0], (2.0 * np.pi / periods) ** 2 * found[1]
