"""`Variation`, one axis of a study (`vary`): its coordinates, and what each puts into a case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.study.document.overlay import Path, Setting
from rockcli.study.document.tree import Where
from rockcli.study.study import Axis


@dataclass(frozen=True, eq=False)
class Variation:
    """An axis and what its points put into a case.

    Attributes:
        axis: as the dataset has it.
        path: of the axis from the top of a study.
        settings: per point, what is put where (several settings for `case` and for a table).
        columns: path -> number of every point, for an axis whose points differ only in numbers that may differ
            within a batch; None for others.
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

    @property
    def size(self) -> int:
        """Number of points."""
        return self.axis.size

    def points(self) -> tuple[tuple[Setting, ...], ...]:
        """What each point puts into a case; of points that differ only in numbers, the first."""
        if self.columns is None:
            return self.settings
        return (tuple((path, values[0], self.where(0)) for path, values in self.columns.items()),)
