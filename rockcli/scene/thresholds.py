"""Overturning thresholds of `find: overturning`: the lowest value of a range, or on which side of what it lies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.units import SI, Units, unit_words

Array = NDArray[np.float64]

FOUND = "_overturning"
"""End of the name of what a search found, after that of the axis searched."""

IN_RANGE, NONE, BELOW, BRACKETED = range(4)

STATES: dict[int, str] = {
    IN_RANGE: "found",
    NONE: "none_in_range",
    BELOW: "below_range",
    BRACKETED: "bracketed",
}
"""Flags of `<axis>_overturning_state`.  BELOW: the first point overturns already; BRACKETED: a point on the way has no
answer, or a statistic depends on members that have none."""

PARTS: tuple[str, ...] = ("state", "low", "high")
"""What stands beside a value found, and beside every statistic of it: its state and the bracket that holds it."""

BESIDE: tuple[str, ...] = ("islands", "island_low", "island_high", "rocks_at_lowest")
"""What stands beside the value of a case: the stable islands above it, and whether it may overturn below the range."""

SENTENCES: dict[str, str] = {
    "": "lowest {} of the range at which the case overturns; inf: none in the range, NaN: see the state",
    "state": "whether the lowest overturning {} was found",
    "low": "the lowest overturning {} is above this",
    "high": "the lowest overturning {} is at most this",
    "islands": "stable islands above the lowest overturning {}: runs of scanned points at which it remains stable",
    "island_low": "lowest scanned {} above an overturning one at which the case remains stable; NaN: none",
    "island_high": "highest scanned {} above an overturning one at which the case remains stable; NaN: none",
    "rocks_at_lowest": "1 where the case rocks at the lowest {} of the range already: it may overturn below the range",
}
"""By end of the name: what it is, for the path of the axis searched."""


@dataclass(frozen=True, eq=False)
class Thresholds:
    """Lowest overturning values of some cases, arrays of one shape.

    Attributes:
        state: flags of STATES.
        low, high: the value is above `low` and at most `high`: -inf and the first point of the range BELOW it, its last
            point and inf where there is NONE; IN_RANGE high is the value, and low as close as the search goes.
        islands: number of stable islands above; island_low, island_high: their lowest and highest scanned point, NaN
            where there is none; rocks_at_lowest: 1 where the case rocks at the lowest point of the range and remains
            stable, so that it may have overturned below the range.  None for statistics.
    """

    state: NDArray[np.int8]
    low: Array
    high: Array
    islands: NDArray[np.int64] | None = None
    island_low: Array | None = None
    island_high: Array | None = None
    rocks_at_lowest: NDArray[np.int8] | None = None

    @property
    def value(self) -> Array:
        """The lowest overturning value; inf where there is none in the range, NaN where it is not known."""
        return np.where(self.state == IN_RANGE, self.high, np.where(self.state == NONE, np.inf, np.nan))

    @classmethod
    def read(cls, name: str, values: Callable[[str], Array | None], end: str = "") -> Thresholds:
        """From the variables of a dataset: `values(name)` gives one of them, None where there is none.

        `end`: that of a statistic, such as `_p50`.  Of a value without a state nothing but itself is known.
        """
        found = values(name + end)
        assert found is not None
        state, low, high = (values(f"{name}_{part}{end}") for part in PARTS)
        if state is None or low is None or high is None:
            state = np.where(np.isfinite(found), IN_RANGE, np.where(np.isinf(found), NONE, BRACKETED))
            low, high = (np.where(np.isnan(found), side, found) for side in (-np.inf, np.inf))
        beside: list[Any] = [None if end else values(f"{name}_{part}") for part in BESIDE]
        return cls(state.astype(np.int8), low, high, *beside)

    def reshaped(self, shape: tuple[int, ...]) -> Thresholds:
        """The same over other axes."""
        return Thresholds(*(None if x is None else x.reshape(shape) for x in vars(self).values()))  # type: ignore[arg-type]

    def bounds(self) -> tuple[Array, Array]:
        """What the values are at least and at most; one number where it was found."""
        return np.where(self.state == IN_RANGE, self.high, self.low), self.high

    def reduced(self, reduce: Callable[[Array], Array]) -> Thresholds:
        """A statistic that grows with each of the values, such as a fractile along an axis.

        It lies between what it is for the smallest and for the largest values there can be.  NONE or BELOW where it
        falls among, or next to, values of that state; BRACKETED where values without an answer leave it open.
        """
        low, high = self.bounds()
        least, most = reduce(low), reduce(high)
        none = np.isposinf(reduce(np.where(self.state == NONE, np.inf, low))) & (least > -np.inf)
        below = np.isneginf(reduce(np.where(self.state == BELOW, -np.inf, high))) & (most < np.inf)
        state = np.select([least == most, none, below], [IN_RANGE, NONE, BELOW], BRACKETED)
        return Thresholds(state.astype(np.int8), least, most)


def threshold_words(found: Thresholds, axes: Mapping[str, NDArray[Any]], unit: str = "1", units: Units = SI) -> str:
    """The lowest overturning values in words: how far they go and where, and what is known of the others.

    Args:
        found: over the axes.
        axes: name -> coordinates, numbers or words, outermost first.
        unit: of the values, as in a dataset; units: those they are told in.
    """
    size = found.state.size
    divisor, shown = units.of(unit)

    def number(value: float) -> str:
        return f"{value / divisor:.6g}{unit_words(shown)}"

    def at(flat: int) -> str:
        place = np.unravel_index(flat, found.state.shape)
        words = [
            f"{name}={x[i]}" if x.dtype.kind in "OUT" else f"{name}={x[i]:.6g}"
            for (name, x), i in zip(axes.items(), place, strict=True)
        ]
        return f" ({', '.join(words)})" if size > 1 else ""

    def often(where: NDArray[np.intp]) -> str:
        return f" in {where.size} of {size} cases" if size > 1 else ""

    said = []
    known = np.flatnonzero(found.state == IN_RANGE)
    if known.size:
        order = known[np.argsort(found.high.flat[known], kind="stable")]
        ends = [number(found.high.flat[i]) + at(i) for i in (order[0], order[-1])]
        said.append(" to ".join(dict.fromkeys(ends)))
    for state in (NONE, BELOW, BRACKETED):
        where = np.flatnonzero(found.state == state)
        if where.size:
            first = where[0]
            said.append(_outside(found, state, first, number) + at(first) + often(where))
    if found.islands is not None and found.island_low is not None and found.island_high is not None:
        where = np.flatnonzero(found.islands)
        if where.size:
            ends = [number(x.flat[where[0]]) for x in (found.island_low, found.island_high)]
            said.append(f"stable islands above it at {' to '.join(dict.fromkeys(ends))}{at(where[0])}{often(where)}")
    if found.rocks_at_lowest is not None and (where := np.flatnonzero(found.rocks_at_lowest)).size:
        said.append(f"rocks at the lowest point of the range already{often(where)}, and may overturn below it")
    return "; ".join(said)


def _outside(found: Thresholds, state: int, flat: np.intp, number: Callable[[float], str]) -> str:
    """What is known of a value that was not found."""
    low, high = float(found.low.flat[flat]), float(found.high.flat[flat])
    bracket = " and ".join([f"above {number(low)}"] * isfinite(low) + [f"at most {number(high)}"] * isfinite(high))
    if found.islands is None:  # a statistic
        return f"censored: {bracket or 'not known'}"
    if state == NONE:
        return f"none up to {number(low)}"
    if state == BELOW:
        return f"below the range, whose lowest point {number(high)} overturns already"
    return f"{bracket or 'not known'}, as a point on the way has no answer"
