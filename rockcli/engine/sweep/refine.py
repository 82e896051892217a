"""`refine`: traces the boundaries between outcomes of a two-axis map instead of solving every pixel.

The pixels of a coarse grid are solved.  A cell of the grid whose four corners do not have one outcome is halved in both
directions, and so are its neighbours while cells are wide; the new pixels are solved and looked at in the same way,
down to single pixels.  At every width this is repeated until no cell beside what is solved is left to look at, so that
a boundary that leaves the cells it was found in is followed.  A pixel that is never solved lies in a cell whose corners
have one outcome, and gets that.  Cells with a corner that failed or is unresolved are always halved.

What lies wholly between the pixels of the coarse grid, and is farther than a cell from anything found, is missed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.results import Results
from rockcli.engine.sweep.sweep import Progress, Sweep, outlook, take_known, work_off
from rockcli.engine.sweep.symbols_of_cases import describe_rest, symbols_of
from rockcli.engine.sweep.work import Team
from rockcli.scene.response import NO_UPLIFT
from rockcli.study.study import Index, Study

Mask = NDArray[np.bool_]

CELLS = 50
"""Cells of the coarse grid along an axis, at least; its pitch is the largest power of two that leaves so many."""

COARSEST = 16
"""Pitch of the coarse grid, at most [pixels]."""

WIDE = 4
"""Cells at least this wide are halved together with their neighbours [pixels]."""

UNSOLVED = np.int8(-128)


def solve_refined(study: Study, progress: Progress | None = None, sweep: Sweep | None = None) -> Results:
    """Solve what tells where outcomes change over the two axes `study.refine`, for every point of the other axes.

    `Results.solved` says which cases were solved; the others have the outcome that surrounds them, and no other scalar.

    Raises:
        StudyError: a solver cannot do what the study asks for.
        OutputError: what is finished cannot be kept.
    """
    sweep = sweep or Sweep(Team())
    sweep.progress = progress or sweep.progress
    with np.errstate(all="ignore"):
        results = Results.of(study, symbols_of(study))
        todo = take_known(sweep, results)
        kept = ~todo
        estimate, compiled = outlook(study, study.size)
        pace = Pace(estimate)
        maps = Maps.of(study)

        while len(wanted := maps.wanted()):
            cases = maps.cases(wanted)
            left = np.zeros(study.size, dtype=bool)
            left[cases[todo[cases]]] = True
            work_off(study, sweep, results, Chunks(study.size, left), pace, compiled=compiled)
            todo[cases] = False
            maps.take(wanted, results.scalars["outcome"][cases])

        maps.lay(maps.outcome, results.scalars["outcome"])
        results.solved = np.zeros(study.size, dtype=np.int8)
        maps.lay(maps.solved, results.solved)
        describe_rest(study, results, todo | kept)
        results.finish()
    return results


@dataclass(eq=False)
class Maps:
    """The k maps of a study, (k, n, m) pixels each, and how far they are refined.

    Attributes:
        outcome: UNSOLVED where nothing is known; filled in where not `solved`.
        solved: whether the pixel was solved.
        lines: pixels of the present grid along n and along m, ascending; the last pixel always belongs to it.
        pitch: of the grid; the last cell of an axis may be narrower.
    """

    outcome: NDArray[np.int8]
    solved: Mask
    pitch: int
    lines: tuple[Index, Index]
    _shape: tuple[int, ...]
    _plane: tuple[int, ...]

    @classmethod
    def of(cls, study: Study) -> Maps:
        """Nothing solved yet."""
        plane = tuple(i for i, axis in enumerate(study.axes) if axis.name in study.refine)
        n, m = (study.shape[i] for i in plane)
        shape = (study.size // (n * m), n, m)
        pitch = coarse_pitch(min(n, m))
        lines = (_grid(n, pitch), _grid(m, pitch))
        return cls(np.full(shape, UNSOLVED), np.zeros(shape, dtype=bool), pitch, lines, study.shape, plane)

    def wanted(self) -> Index:
        """Pixels (j, 3) to be solved next; none when all maps are known."""
        while True:
            points = self.outcome[:, self.lines[0][:, None], self.lines[1]] == UNSOLVED
            if not points.any():
                points = self._corners(self._cells()) & ~self.solved[:, self.lines[0][:, None], self.lines[1]]
            if points.any() or self.pitch == 1:
                at, row, column = np.nonzero(points)
                return np.column_stack([at, self.lines[0][row], self.lines[1][column]])
            self._halve()

    def take(self, pixels: Index, outcome: NDArray[np.int8]) -> None:
        """The outcomes of some pixels (j, 3)."""
        at = tuple(pixels.T)
        self.outcome[at], self.solved[at] = outcome, True

    def cases(self, pixels: Index) -> Index:
        """Flat cases of pixels (j, 3)."""
        others = tuple(i for i in range(len(self._shape)) if i not in self._plane)
        along = dict(zip(others, np.unravel_index(pixels[:, 0], [self._shape[i] for i in others] or [1]), strict=False))
        along |= dict(zip(self._plane, pixels[:, 1:].T, strict=True))
        return np.ravel_multi_index([along[i] for i in range(len(self._shape))], self._shape).astype(np.int64)

    def lay(self, values: NDArray[Any], onto: NDArray[Any]) -> None:
        """Write values of all pixels (k, n, m) into those of the flat cases."""
        pixels = np.moveaxis(onto.reshape(self._shape), self._plane, (-2, -1))
        pixels[...] = values.reshape(pixels.shape)

    def _cells(self) -> Mask:
        """Cells of the present grid (k, n - 1, m - 1) all of whose corners are to be solved."""
        known = self.outcome[:, self.lines[0][:, None], self.lines[1]]
        first = known[:, :-1, :-1]
        mixed = (first < NO_UPLIFT) | (first != known[:, 1:, :-1])
        mixed |= (first != known[:, :-1, 1:]) | (first != known[:, 1:, 1:])
        return _with_neighbours(mixed) if self.pitch >= WIDE else mixed

    @staticmethod
    def _corners(cells: Mask) -> Mask:
        points = np.zeros((cells.shape[0], cells.shape[1] + 1, cells.shape[2] + 1), dtype=bool)
        for i in (0, 1):
            for j in (0, 1):
                points[:, i : i + cells.shape[1], j : j + cells.shape[2]] |= cells
        return points

    def _halve(self) -> None:
        """Halve the pitch: what is new lies in a cell of one outcome and gets that, or is left unsolved."""
        cells = self._cells()
        self.pitch //= 2
        finer = tuple(_grid(n, self.pitch) for n in self.outcome.shape[1:])
        beside = [_cells_beside(old, new) for old, new in zip(self.lines, finer, strict=True)]
        divided = np.zeros((len(cells), len(finer[0]), len(finer[1])), dtype=bool)
        for row in beside[0]:
            for column in beside[1]:
                divided |= cells[:, row[:, None], column]
        corner = self.outcome[:, self.lines[0][beside[0][0]][:, None], self.lines[1][beside[1][0]]]
        known = self.outcome[:, finer[0][:, None], finer[1]]
        new = np.where(known == UNSOLVED, np.where(divided, UNSOLVED, corner), known)
        self.outcome[:, finer[0][:, None], finer[1]] = new
        self.lines = (finer[0], finer[1])


def coarse_pitch(n: int) -> int:
    """Pitch of the coarse grid over n pixels: 16 for 800 and more, 1 (which solves everything) below 100."""
    return int(np.clip(2 ** int(np.log2(max(n / CELLS, 1.0))), 1, COARSEST))


def _grid(n: int, pitch: int) -> Index:
    return np.unique(np.append(np.arange(0, n, pitch), n - 1)).astype(np.int64)


def _cells_beside(lines: Index, points: Index) -> tuple[Index, Index]:
    """The cells between `lines` that hold each point: from it on, and up to it; the same within a cell."""
    most = len(lines) - 2
    after = np.clip(np.searchsorted(lines, points, side="right") - 1, 0, most)
    before = np.clip(np.searchsorted(lines, points, side="left") - 1, 0, most)
    return after.astype(np.int64), before.astype(np.int64)


def _with_neighbours(cells: Mask) -> Mask:
    """Cells, and the eight around each."""
    _, n, m = cells.shape
    padded = np.pad(cells, ((0, 0), (1, 1), (1, 1)))
    found = np.zeros_like(cells)
    for i in range(3):
        for j in range(3):
            found |= padded[:, i : i + n, j : j + m]
    return found
