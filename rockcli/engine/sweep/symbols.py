"""The symbols of the cases (R alpha p ...), held over the axes they depend on, never over all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunk_symbols import Reduced, Reduction, Values, places_of
from rockcli.storage.on_disk import full, in_blocks
from rockcli.storage.reduced import reduce, same
from rockcli.study.study import Index

Array = NDArray[np.float64]

EDGES = (*(f"{name}_{side}" for name in ("R", "alpha", "p", "eta") for side in ("left", "right")), "pga_uplift")
"""Symbols of either edge of an asymmetric body, and from where it lifts about one of them."""

LOOKED_AT = 64
"""Points of an axis looked at to see what changes along it."""


class Symbols:
    """Collects symbols case by case.

    A first look along the axes tells what depends on what.  A case that contradicts it later makes its symbol one of
    all axes, so that the result never depends on the look.

    Args:
        shape: points of every axis.
        look: symbols of some flat cases, ascending.
        folder: where what is too large for memory lies; None = in memory.
    """

    def __init__(self, shape: tuple[int, ...], look: Callable[[Index], Values], folder: Path | None = None) -> None:
        self.shape = shape
        self._folder = folder
        self._kept: dict[str, tuple[int, ...]] = {}
        self._values: dict[str, Array] = {}
        self._known: dict[str, NDArray[np.bool_]] = {}
        for axis in range(len(shape)):
            for corner in (np.zeros(len(shape), dtype=np.int64), np.array(shape) - 1):
                line = self._line(axis, corner)
                for name, values in look(line).items():
                    kept = self._kept.setdefault(name, ())
                    if isinstance(values, np.ndarray) and axis not in kept:
                        self._kept[name] = tuple(sorted((*kept, axis)))

    @property
    def arrays(self) -> tuple[Array, ...]:
        """What is held."""
        return tuple(self._values.values())

    def _line(self, axis: int, corner: Index) -> Index:
        n = self.shape[axis]
        points = np.repeat(corner[:, None], min(n, LOOKED_AT), axis=1)
        points[axis] = np.unique(np.linspace(0, n - 1, min(n, LOOKED_AT)).astype(np.int64))
        return np.asarray(np.ravel_multi_index(tuple(points), self.shape), dtype=np.int64)

    @property
    def reduction(self) -> Reduction:
        """Reduces the symbols of other cases as far as is known by now."""
        return Reduction(self.shape, dict(self._kept))

    def put(self, cases: Index, found: Values) -> None:
        """Take the symbols of some flat cases; one that is not among them has no value there."""
        places: dict[tuple[int, ...], Index] = {}
        for name in dict.fromkeys((*found, *self._values)):
            self._put(name, cases, places, found.get(name, float("nan")))

    def _put(
        self, name: str, cases: Index, places: dict[tuple[int, ...], Index], values: Array | Reduced | float
    ) -> None:
        kept = self._kept.setdefault(name, tuple(range(len(self.shape))))
        if name not in self._values:
            size = tuple(self.shape[axis] for axis in kept)
            self._values[name] = full(size, np.nan, np.float64, self._folder)
            self._known[name] = np.zeros(() if len(kept) == len(self.shape) else size, dtype=bool)
        held = self._values[name].reshape(-1)
        if isinstance(values, Reduced) and values.axes != kept:  # by now it is known to depend on more
            values = values.expanded(cases, self.shape)
        said: Array | float
        if isinstance(values, Reduced):
            at, said = values.places, values.values
        elif len(kept) == len(self.shape):
            held[cases] = values
            return
        else:
            if kept not in places:
                places[kept] = places_of(cases, kept, self.shape)
            at, said = places[kept], values
        known = self._known[name].reshape(-1)
        if (known.all() or known[at].all()) and same(held[at], said).all():
            return  # as most chunks say
        before = np.where(known[at], held[at], said)
        held[at], known[at] = said, True
        if not (same(before, said).all() and same(held[at], said).all()):
            held[at] = before  # as it was, but for what this chunk was the first to say
            self._over_all(name, kept)
            self._put(name, cases, places, values)

    def _over_all(self, name: str, kept: tuple[int, ...]) -> None:
        inserted = tuple(slice(None) if axis in kept else None for axis in range(len(self.shape)))
        held = self._values[name][inserted]
        self._values[name] = full(self.shape, np.nan, np.float64, self._folder)
        self._values[name][...] = held
        self._kept[name] = tuple(range(len(self.shape)))
        del self._known[name]

    def over(self, name: str, axes: tuple[str, ...]) -> tuple[tuple[str, ...], Array] | None:
        """Dims and values of a symbol over the axes it depends on; None if no case has it."""
        values = self._values.get(name)
        if values is None or all(np.isnan(values[at]).all() for at in in_blocks(values)):
            return None
        return reduce(values, tuple(axes[axis] for axis in self._kept[name]))
