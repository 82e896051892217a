"""A hazard curve: how often a year the ground motion exceeds an intensity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONSISTENT = 0.05
"""Probability of survival below which what has remained stable contradicts a hazard curve."""


@dataclass(frozen=True, eq=False)
class HazardCurve:
    """Annual rates of exceedance, straight between its points on logarithmic axes: a power law in each interval.

    Attributes:
        label: its name in the dataset.
        intensity: ascending, positive, (k,) in the unit of the dataset; k >= 2.
        rate: annual rate at which it is exceeded, positive, never growing, (k,) [1/year].
        notes: what was left out or changed when it was read.
    """

    label: str
    intensity: Array
    rate: Array
    notes: tuple[str, ...] = ()

    @property
    def slopes(self) -> Array:
        """-d ln(rate)/d ln(intensity) in every interval, (k - 1,), >= 0."""
        return -np.diff(np.log(self.rate)) / np.diff(np.log(self.intensity))

    def __call__(self, x: Array) -> Array:
        """The rate at intensities within the curve; below and above it the power laws of its ends go on."""
        i = np.clip(np.searchsorted(self.intensity, x, side="right") - 1, 0, len(self.rate) - 2)
        return np.asarray(self.rate[i] * (x / self.intensity[i]) ** -self.slopes[i])


def hazard_words(label: str) -> str:
    """A hazard curve by its label, which may say that it is one already: `hazard moderate`, `Hazard_site_B`."""
    return label if label.lower().startswith("hazard") else f"hazard {label}"
