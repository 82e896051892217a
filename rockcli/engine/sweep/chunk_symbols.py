"""The symbols of a chunk over the axes they depend on: a worker sends a few numbers instead of one a case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.storage.reduced import same
from rockcli.study.study import Index

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reduced:
    """A symbol of some cases: values (k,) at flat places (k,), ascending, among the points of some axes."""

    axes: tuple[int, ...]
    places: Index
    values: Array

    def expanded(self, cases: Index, shape: tuple[int, ...]) -> Array:
        """One value a case, of the same cases."""
        return self.values[np.searchsorted(self.places, places_of(cases, self.axes, shape))]


Values = dict[str, Array | Reduced | float]


@dataclass(frozen=True, eq=False)
class Reduction:
    """Reduces symbols along the axes on which they do not depend; one that does depend on them is left as it is.

    Attributes:
        shape: points of every axis; kept: symbol -> axes it is known to depend on.
    """

    shape: tuple[int, ...]
    kept: dict[str, tuple[int, ...]]

    def __call__(self, cases: Index, symbols: Values) -> Values:
        """The symbols of some flat cases, reduced where they can be."""
        places: dict[tuple[int, ...], Index] = {}
        return {name: self._reduced(self.kept.get(name), cases, values, places) for name, values in symbols.items()}

    def _reduced(
        self,
        kept: tuple[int, ...] | None,
        cases: Index,
        values: Array | Reduced | float,
        places: dict[tuple[int, ...], Index],
    ) -> Array | Reduced | float:
        if not isinstance(values, np.ndarray) or kept is None or len(kept) == len(self.shape):
            return values
        if kept not in places:
            places[kept] = places_of(cases, kept, self.shape)
        at = places[kept]
        points = int(np.prod([self.shape[axis] for axis in kept], dtype=np.int64))
        if points > len(cases):  # nothing gained
            return values
        table, said = np.full(points, np.nan), np.zeros(points, dtype=bool)
        table[at], said[at] = values, True
        where = np.flatnonzero(said)
        return Reduced(kept, where, table[where]) if same(table[at], values).all() else values


def places_of(cases: Index, kept: tuple[int, ...], shape: tuple[int, ...]) -> Index:
    """Flat places of flat cases among the points of some axes."""
    places = np.zeros(len(cases), dtype=np.int64)
    for axis in kept:
        inner = int(np.prod(shape[axis + 1 :], dtype=np.int64))
        places = places * shape[axis] + cases // inner % shape[axis]
    return places
