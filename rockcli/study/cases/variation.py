"""`Variation`, one axis of a study (`vary`): its coordinates, and what each puts into a case."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.study.building.numbers import Varied
from rockcli.study.cases.file_names import names_in
from rockcli.study.document.overlay import Path, Setting, leaves
from rockcli.study.document.tree import Map, Where
from rockcli.study.study import OF_DIRECTIONS, OF_RECORDS, Axis

RECORD_PATHS: tuple[Path, ...] = tuple(("case", *path.split(".")) for path in OF_RECORDS)
"""Where the name of the horizontal record may stand."""


@dataclass(frozen=True, eq=False)
class Variation:
    """An axis and what its points put into a case.

    Attributes:
        axis: as the dataset has it.
        path: of the axis from the top of a study.
        settings: per point, what is put where (several settings for `case` and for a table); none where `columns`
            say all of it, as they do but for points that are mappings or say words.
        columns: path -> number of every point (NaN: not said), for an axis of which some points differ only in numbers
            that may differ within a batch; None for others.
        first_alike: the first point that a point differs from in no more than its numbers, (n,); None where that is the
            same for all, or without columns.
        first_but_for_record: the first point that a point differs from in no more than its numbers and the name of its
            record, (n,); None where that tells no more than `first_alike`.
        where: place of every point in the study file.
        table: name of the file the axis was read from; None = none.
        find: `overturning` for a range that is searched and adds no dimension, else None.
        sampled: whether its points are samples of uncertain inputs, which the coordinate does not tell.
    """

    axis: Axis
    path: Path
    settings: tuple[tuple[Setting, ...], ...]
    columns: dict[Path, NDArray[np.float64]] | None
    where: Callable[[int], Where]
    table: str | None = None
    find: str | None = None
    sampled: bool = False
    first_alike: NDArray[np.int64] | None = None
    first_but_for_record: NDArray[np.int64] | None = None

    @property
    def structural(self) -> bool:
        """Whether its points need several batches."""
        return self.columns is None or self.first_alike is not None

    def batch_of(self, points: NDArray[np.int64]) -> NDArray[np.int64]:
        """The first point with which each of these is in a batch, as far as this axis goes."""
        if self.columns is None:
            return points
        return np.zeros_like(points) if self.first_alike is None else self.first_alike[points]

    def batch_of_records(self, points: NDArray[np.int64]) -> NDArray[np.int64]:
        """The same of a batch in which every case may have a record, or a direction, of its own."""
        alike = self.first_but_for_record
        return np.zeros_like(points) if alike is None else alike[points]

    def motion_of(self, point: int) -> tuple[Any, Where] | None:
        """The name of the record that a point says, or its direction, and where it stands; None where it says none."""
        turned = self.axis.path == OF_DIRECTIONS
        said = numbers_of(self.settings[point])
        return next(((value, where) for path, value, where in said if turned or is_record(path, value)), None)

    @property
    def size(self) -> int:
        """Number of points."""
        return self.axis.size

    @property
    def makes_bodies(self) -> bool:
        """Whether the body of a case, or what it loses, may depend on this axis."""
        columns = () if self.columns is None else self.columns
        said = chain(columns, (path for point in self.settings for path, _, _ in point))
        return any(path[0] != "case" or path[1] in ("block", "damping") for path in said)

    @property
    def paths(self) -> frozenset[Path]:
        """Paths, from the top of a study, of all that its points say."""
        said = (item for point in self.points() for item in point)
        return frozenset((*path, *below) for path, value, _ in said for below, _ in leaves(value))

    def points(self) -> tuple[tuple[Setting, ...], ...]:
        """What each point puts into a case; of points that differ only in numbers, the first."""
        if self.columns is None:
            return self.settings
        if self.settings:
            first = (0,) if self.first_alike is None else np.unique(self.first_alike).tolist()
            return tuple(self.settings[point] for point in first)
        return (tuple((path, values[0], self.where(0)) for path, values in self.columns.items()),)

    def varied(self, axis: int, point: int) -> tuple[Setting, ...]:
        """What a point of this axis, the one at a place among all, puts into a case: `Varied` for its columns."""
        if self.columns is None:
            return self.settings[point]
        columns = enumerate(self.columns.items())
        numbers = {path: Varied.of(axis, k, of[point]) for k, (path, of) in columns if np.isfinite(of[point])}
        if self.settings:
            return tuple((path, _replaced(path, value, numbers), where) for path, value, where in self.settings[point])
        return tuple((path, number, self.where(0)) for path, number in numbers.items())

    def place(self, column: int, point: int) -> Where:
        """Place in the study file of the number of a column at a point."""
        if not self.settings or self.columns is None:
            return self.where(point)
        path = list(self.columns)[column]
        return next((where for at, _, where in numbers_of(self.settings[point]) if at == path), self.where(point))


def numbers_of(point: tuple[Setting, ...]) -> Iterator[Setting]:
    """The settings of a point with what mappings say one by one; a mapping that stands for all of a key as it is."""
    for path, value, where in point:
        if isinstance(value, Map) and not value.whole:
            yield from numbers_of(tuple(((*path, key), item, value.where.get(key)) for key, item in value.items()))
        else:
            yield path, value, where


def is_record(path: Path, value: Any) -> bool:
    """Whether a value at a path is the name of the horizontal record, in which no axis fills in anything."""
    return path in RECORD_PATHS and isinstance(value, str) and not names_in(value)


def _replaced(path: Path, value: Any, numbers: dict[Path, Varied]) -> Any:
    """A value at a path with some of the numbers in it replaced."""
    if path in numbers:
        return numbers[path]
    if not isinstance(value, Map):
        return value
    return Map({key: _replaced((*path, key), item, numbers) for key, item in value.items()}, value.where)
