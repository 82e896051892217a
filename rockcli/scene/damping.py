"""Damping: what is lost at impacts or between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.spectra import DesignSpectrum

Array = NDArray[np.float64]

DASHPOT = 0.02
"""The source's coefficient of the base damper (3.3)."""


@dataclass(frozen=True, eq=False)
class Fema356:
    """What the procedure of FEMA-356 [3.4] needs beside the body.

    Attributes:
        W_over_Mg: weight carried at the base over M g of the seismic mass, (n,).
        fixed_base_period: elastic period without rocking, (n,) [s]; NaN where the study gives none.
        spectrum: design spectrum, or None for the response spectrum of the motion itself.
    """

    W_over_Mg: Array
    fixed_base_period: Array
    spectrum: DesignSpectrum | None = None


@dataclass(frozen=True, eq=False)
class Damping:
    """A damping scheme of a batch.

    Attributes:
        scheme: `none`; `restitution` (event-based damping, [3.2, 3.5]); `dashpot` (a rotational damper at the base,
            acting all the time, no loss at impacts, (3.3)); `hht` (the dissipation of the time integrator over a
            no-tension base, [3.3]); `fema356` (an equivalent linear oscillator, [3.4]).
        eta: ratio of angular velocities just after / just before an impact, (n, 2); column j when the body
            lands on edge j (0 left, 1 right).  Ones where nothing is lost.
        coefficient: of the dashpot c = coefficient (alpha/0.1)^2 m g^0.5 R^1.5 (3.3), (n,); zeros without one.
        fema356: of that scheme, else None.
        alpha_d: parameter of the HHT integrator in [2/3, 1] of that scheme, (n,); None = the backend's default.
    """

    scheme: str
    eta: Array
    coefficient: Array | None = None
    fema356: Fema356 | None = None
    alpha_d: Array | None = None


def dashpot_rate(coefficient: Array, alpha: Array, R: Array, inertia: Array, g: Array) -> Array:
    """c / I_O of the base damper (3.3), of the shape of alpha [1/s]: c = coefficient (alpha/0.1)^2 m g^0.5 R^1.5."""
    return np.asarray(coefficient * (alpha / 0.1) ** 2 * np.sqrt(g / R) / inertia)
