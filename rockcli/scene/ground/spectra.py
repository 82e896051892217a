"""Design spectra: pseudo-acceleration over the period, one row of a table per shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DesignSpectrum:
    """A design spectrum per case of a batch.

    Attributes:
        shape: a key of SPECTRA.
        values: by the keys of that shape; numbers (n,), lists (n, k); SI, accelerations in m/s².
    """

    shape: str
    values: dict[str, Array]

    def S_a(self, periods: Array, beta: float, case: int = 0) -> Array:
        """Pseudo-acceleration of one case at periods (m,) [s] >= 0, damping ratio beta: (m,) [m/s²].

        NaN where the spectrum says nothing (a table beyond its last period).
        """
        row = SPECTRA[self.shape]
        return row.law(np.asarray(periods, dtype=np.float64), beta, *(self.values[key][case] for key in row.keys))


@dataclass(frozen=True, eq=False)
class FloorSpectrum:
    """Pseudo-acceleration S_a, (m,) [m/s², or in the g of each case if `in_g`], at ascending periods (m,) [s]."""

    periods: Array
    S_a: Array
    in_g: bool


@dataclass(frozen=True)
class SpectrumShape:
    """A row: the keys it takes (`lists` of them are lists), a sentence, and S_a(T (m,), beta, *values) -> (m,)."""

    name: str
    keys: tuple[str, ...]
    sentence: str
    law: Callable[..., Array]
    lists: bool = False


def _constant(T: Array, beta: float, S_a: Array) -> Array:
    return np.full(T.shape, S_a)


def _flat_S_v(T: Array, beta: float, S_v: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.where(T > 0.0, 2.0 * np.pi * S_v / T, np.inf if S_v > 0.0 else 0.0)


def _table(T: Array, beta: float, periods: Array, S_a: Array) -> Array:
    return np.interp(T, periods, S_a, right=np.nan)


EFFECTIVE_DAMPING = (0.02, 0.05, 0.10, 0.20, 0.30, 0.40, 0.50)
"""Effective damping of FEMA-356, table 1-6 (recalled, not re-read), linear between; B_S, B_1 divide the spectrum."""

B_S = (0.8, 1.0, 1.3, 1.8, 2.3, 2.7, 3.0)
B_1 = (0.8, 1.0, 1.2, 1.5, 1.7, 1.9, 2.0)


def _fema356(T: Array, beta: float, S_XS: Array, S_X1: Array) -> Array:
    # section 1.6.1.5: from 0.4 S_XS up to the plateau S_XS/B_S at T_0 = 0.2 T_S, then S_X1/(B_1 T) from T_S on
    short, long = (float(np.interp(beta, EFFECTIVE_DAMPING, B)) for B in (B_S, B_1))
    T_S = S_X1 * short / (S_XS * long)
    rise = S_XS * ((5.0 / short - 2.0) * T / T_S + 0.4)
    with np.errstate(divide="ignore"):
        fall = S_X1 / (long * T)
    return np.where(T < 0.2 * T_S, rise, np.minimum(S_XS / short, fall))


_ROWS: tuple[SpectrumShape, ...] = (
    SpectrumShape("constant", ("S_a",), "S_a at every period", _constant),
    SpectrumShape("flat_S_v", ("S_v",), "S_a = 2 pi S_v/T: constant spectral velocity", _flat_S_v),
    SpectrumShape(
        "table",
        ("periods", "S_a"),
        "linear between the periods, constant below the first, unknown beyond the last",
        _table,
        lists=True,
    ),
    SpectrumShape(
        "fema356",
        ("S_XS", "S_X1"),
        "general spectrum of FEMA-356, 1.6.1.5: 5 % values at short periods and at 1 s, divided by B_S, B_1",
        _fema356,
    ),
)

SPECTRA: dict[str, SpectrumShape] = {row.name: row for row in _ROWS}
"""All but `fema356` are taken as they stand, whatever the damping."""
