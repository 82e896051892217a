"""What an uncertain number may be: distributions by name, given by what people know of them, and cut off where asked.

scipy is imported where it is called, as studies without uncertain inputs need none of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Family:
    """A row: what its numbers are, what they have to be, and the frozen distribution of scipy.stats that they make.

    Attributes:
        names: of its numbers, in order.
        fits: whether numbers make a distribution.
        needs: the same in words.
        make: numbers -> distribution with `cdf`, `sf`, `ppf`, `isf`.
    """

    names: tuple[str, ...]
    fits: Callable[..., bool]
    needs: str
    make: Callable[..., Any]


def _normal(mean: float, sd: float) -> Any:
    from scipy.stats import norm

    return norm(mean, sd)


def _lognormal(median: float, beta: float) -> Any:
    from scipy.stats import lognorm

    return lognorm(beta, scale=median)


def _uniform(a: float, b: float) -> Any:
    from scipy.stats import uniform

    return uniform(a, b - a)


def _triangular(a: float, mode: float, b: float) -> Any:
    from scipy.stats import triang

    return triang((mode - a) / (b - a), a, b - a)


def _beta(a: float, b: float, low: float, high: float) -> Any:
    from scipy.stats import beta

    return beta(a, b, low, high - low)


FAMILIES: dict[str, Family] = {
    "normal": Family(("mean", "sd"), lambda mean, sd: sd > 0.0, "sd > 0", _normal),
    "lognormal": Family(
        ("median", "beta"), lambda median, beta: median > 0.0 and beta > 0.0, "median > 0 and beta > 0", _lognormal
    ),
    "uniform": Family(("a", "b"), lambda a, b: a < b, "a < b", _uniform),
    "triangular": Family(
        ("a", "mode", "b"), lambda a, mode, b: a <= mode <= b and a < b, "a <= mode <= b and a < b", _triangular
    ),
    "beta": Family(
        ("a", "b", "low", "high"),
        lambda a, b, low, high: a > 0.0 and b > 0.0 and low < high,
        "a > 0, b > 0 and low < high",
        _beta,
    ),
}


@dataclass(frozen=True)
class Distribution:
    """A distribution by the name of its family, with its numbers; `truncate`: nothing below or above these."""

    family: str
    numbers: tuple[float, ...]
    truncate: tuple[float, float] | None = None

    @property
    def mass(self) -> float:
        """Probability of what the truncation leaves of it."""
        if self.truncate is None:
            return 1.0
        made, (a, b) = FAMILIES[self.family].make(*self.numbers), self.truncate
        return float(max(made.cdf(b) - made.cdf(a), made.sf(a) - made.sf(b)))

    def at(self, u: Array) -> Array:
        """Quantiles: the value that is not exceeded with probability u, 0 < u < 1."""
        made = FAMILIES[self.family].make(*self.numbers)
        if self.truncate is None:
            return np.asarray(made.ppf(u))
        a, b = self.truncate
        if made.cdf(a) > 0.5:  # of an upper tail by what lies above, which keeps its digits
            values = made.isf(made.sf(a) + u * (made.sf(b) - made.sf(a)))
        else:
            values = made.ppf(made.cdf(a) + u * (made.cdf(b) - made.cdf(a)))
        return np.asarray(np.clip(values, a, b))  # rounding leaves the interval by a last bit

    @property
    def words(self) -> str:
        """`lognormal, median 0.5, beta 0.2, between 0.1 and 0.9`."""
        said = (f"{name} {value:.6g}" for name, value in zip(FAMILIES[self.family].names, self.numbers, strict=True))
        ends = () if self.truncate is None else (f"between {self.truncate[0]:.6g} and {self.truncate[1]:.6g}",)
        return ", ".join((self.family, *said, *ends))
