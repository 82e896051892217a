"""How often a year a limit state is exceeded: a fragility curve convolved with a hazard curve.

rate = int P(x) |dH(x)| (McGuire 2004; Cornell 1968), P(x) = Phi(ln((x - x_0)/(median - x_0))/beta), H the hazard curve.
For x_0 = 0 and H a power law of slope k it is H(median) exp((k beta)^2/2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.hazard import HazardCurve

Array = NDArray[np.float64]

TOLERANCE = 1e-8
"""Relative change of a rate at which halving the intervals ends."""

_HALVINGS = 12

_SPACING = 0.2
"""Steps of the capacities of many curves, in their betas."""

_REACH = 12.0
"""Standard deviations of the curve from its median to which its steps are followed."""


@dataclass(frozen=True)
class Fragility:
    """A curve: `median` and `begins_at` in the unit of the hazard curve, `beta` of ln(x - begins_at)."""

    median: float
    beta: float
    begins_at: float = 0.0

    def __call__(self, x: Array) -> Array:
        """Probability of exceedance at intensities."""
        from scipy.special import ndtr

        above = np.maximum(x - self.begins_at, 0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(ndtr(np.log(above / (self.median - self.begins_at)) / self.beta))

    def intensity(self, z: Array) -> Array:
        """Intensity at z standard deviations from the median."""
        return np.asarray(self.begins_at + (self.median - self.begins_at) * np.exp(self.beta * z))


@dataclass(frozen=True, eq=False)
class Rate:
    """Annual rate of a limit state [1/year].

    Attributes:
        total: from the motions within the hazard curve, and from those beyond its end as if at it, the least that they
            can add.
        above: what those beyond its end can add at most.
        below: what motions below its first point would add if its first power law went on down to zero.
        parts: of `total` in the bins asked for; motions beyond the end are in the bin of the end.
    """

    total: float
    above: float
    below: float
    parts: Array


def annual_rate(curve: Fragility, hazard: HazardCurve, edges: Array | None = None) -> Rate:
    """Convolve a fragility curve with a hazard curve.

    Args:
        curve: the fragility.
        hazard: the rates of the intensity it is told against.
        edges: ascending intensities, (n + 1,), of the bins in which `parts` are wanted; the hazard curve lies in them.
    """
    first, last = float(hazard.intensity[0]), float(hazard.intensity[-1])
    bins = np.array([first, last]) if edges is None else np.asarray(edges, dtype=float)
    steps = curve.intensity(np.arange(-_REACH, _REACH + 0.5))
    knots = np.unique(np.concatenate([hazard.intensity, bins, steps, [curve.begins_at]]))
    knots = knots[(knots >= first) & (knots <= last)]
    parts = np.zeros(len(bins) - 1)
    np.add.at(parts, _bin(bins, np.sqrt(knots[1:] * knots[:-1])), _integrals(curve, hazard, knots))
    end, beyond = float(curve(np.array([last]))[0]), float(hazard.rate[-1])
    parts[_bin(bins, np.array([last * (1.0 - 1e-12)]))] += end * beyond
    return Rate(float(parts.sum()), (1.0 - end) * beyond, _below(curve, hazard, steps), parts)


def rates_of(above: Array, beta: Array, begins_at: float, hazard: HazardCurve) -> Array:
    """Rates of many curves at once, (...) [1/year], to a hundredth: mean rates of the hazard at capacities.

    It is `total` of `annual_rate`, integrated by parts: capacities below the first point of the hazard curve have the
    rate there, as motions below it are not counted, and those beyond its last point none.

    Args:
        above: (...) ln(median - begins_at); beta: (...) of the curves.
        begins_at: intensity at and below which they are zero, in units of the hazard curve.
    """
    from scipy.special import ndtr

    beyond = float(hazard.intensity[-1]) - begins_at
    if beyond <= 0.0:
        return np.zeros(above.shape)
    end = ((np.log(beyond) - above) / beta)[..., None]
    z = np.minimum(np.arange(-10.0, 6.0, _SPACING), end)
    u = np.log(begins_at + np.exp(above[..., None] + beta[..., None] * z))
    rate = np.exp(np.interp(u, np.log(hazard.intensity), np.log(hazard.rate)))
    edges = np.concatenate([np.full_like(end, -np.inf), 0.5 * (z[..., 1:] + z[..., :-1]), end], axis=-1)
    return np.asarray((rate * np.diff(ndtr(edges), axis=-1)).sum(axis=-1))


def _bin(edges: Array, x: Array) -> NDArray[np.int64]:
    """The bin that holds each intensity."""
    return np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)


def _below(curve: Fragility, hazard: HazardCurve, steps: Array) -> float:
    """What motions below the first point add if its power law goes on."""
    first = float(hazard.intensity[0])
    # of a curve so flat that its beginning underflows no more than that can be told
    lowest = curve.begins_at or max(float(curve.intensity(np.array(-3.0 * _REACH))), np.finfo(float).tiny)
    if lowest >= first:
        return 0.0
    inner = steps[(steps > lowest) & (steps < first)]
    return float(_integrals(curve, hazard, np.unique(np.concatenate([np.geomspace(lowest, first, 60), inner]))).sum())


def _integrals(curve: Fragility, hazard: HazardCurve, knots: Array) -> Array:
    """int P |dH| between neighbouring knots, (n - 1,): Gauss's rule on ln(x), intervals halved until the sum stands."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    u = np.log(knots)
    middle = 0.5 * (u[1:] + u[:-1])
    # the slope of an interval is that at its middle: knots never straddle a point of the curve
    i = np.clip(np.searchsorted(hazard.intensity, np.exp(middle), side="right") - 1, 0, len(hazard.rate) - 2)
    slope = hazard.slopes[i]
    found: Array = np.zeros(0)
    for halvings in range(_HALVINGS):
        share, before = 2**halvings, found
        width = np.diff(u) / share
        starts = u[:-1, None] + width[:, None] * np.arange(share)
        at = starts[..., None] + width[:, None, None] * 0.5 * (nodes + 1.0)
        rate = hazard.rate[i][:, None, None] * np.exp(
            -slope[:, None, None] * (at - np.log(hazard.intensity[i])[:, None, None])
        )
        density = curve(np.exp(at)) * rate * slope[:, None, None]
        found = np.asarray((density * weights).sum(axis=(1, 2)) * 0.5 * width)
        if halvings and abs(found.sum() - before.sum()) <= TOLERANCE * abs(found.sum()):
            break
    return found
