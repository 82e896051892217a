"""`refine`: traces the boundaries between outcomes of a two-axis map instead of solving every pixel.

The pixels of a coarse grid are solved.  A cell of the grid whose four corners do not have one outcome is halved in both
directions, and so are its neighbours while cells are wide; the new pixels are solved and looked at in the same way,
down to single pixels.  At every width this is repeated until no cell beside what is solved is left to look at, so that
a boundary that leaves the cells it was found in is followed.  A band thinner than a pixel comes in fragments with gaps
between: around every part of one pixel's width all pixels in reach are solved too.  A pixel that is never solved lies
in a cell whose corners have one outcome, and gets that.  Cells with a corner that failed or is unresolved are always
halved.

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

COARSEST = 32
"""Pitch of the coarse grid, at most [pixels]."""

WIDE = 8
"""Cells at least this wide are halved together with their neighbours [pixels]."""

REACH = 8
"""Pixels around a part of one pixel's width in which its next fragment is sought."""

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
        results = Results.of(study, symbols_of(study, sweep.folder), sweep.folder)
        todo = take_known(sweep, results)
        kept = ~todo
        estimate, compiled = outlook(study, study.size)
        pace = Pace(estimate)
        maps = Maps.of(study)

        while len(wanted := maps.wanted()):
            cases = maps.cases(wanted)
            left = Chunks.of(np.sort(cases[todo[cases]], kind="stable"))
            work_off(study, sweep, results, left, pace, compiled=compiled)
            todo[cases] = False
            maps.take(wanted, results.scalars["outcome"][cases])

        maps.lay(maps.outcome, results.scalars["outcome"])
        results.solved = np.zeros(study.size, dtype=np.int8)
        maps.lay(maps.solved, results.solved)
        plane = {i for i, axis in enumerate(study.axes) if axis.name in study.refine}
        if all(len(plane & set(axes)) < 2 for axes in results.symbols.reduction.kept.values()):
            todo &= _along_two_sides(study.shape, plane)  # what is left tells nothing that these and the solved do not
        describe_rest(study, results, todo | kept)
        results.finish()
    return results


def _along_two_sides(shape: tuple[int, ...], plane: set[int]) -> Mask:
    """Which flat cases are first along one axis or the other of their map."""
    first = np.zeros(shape, dtype=bool)
    for axis in plane:
        first[tuple(0 if i == axis else slice(None) for i in range(len(shape)))] = True
    return first.reshape(-1)


@dataclass(eq=False)
class Maps:
    """The k maps of a study, (k, n, m) pixels each, and how far they are refined.

    What is done at a pitch goes by lists of the cells that are looked at, so that it costs what the boundaries are long
    and not what the maps are large.

    Attributes:
        outcome: what a pixel has or, where it is not `solved`, what surrounds it, as far as is known.
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
    _divided: Mask
    _inside: Index
    _looked_at: Index
    _found: list[Index]
    _began: bool = False

    @classmethod
    def of(cls, study: Study) -> Maps:
        """Nothing solved yet."""
        plane = tuple(i for i, axis in enumerate(study.axes) if axis.name in study.refine)
        n, m = (study.shape[i] for i in plane)
        shape = (study.size // (n * m), n, m)
        pitch = coarse_pitch(min(n, m))
        lines = (_grid(n, pitch), _grid(m, pitch))
        nothing = np.zeros(shape[0] * (len(lines[0]) - 1) * (len(lines[1]) - 1), dtype=bool)
        cells = np.arange(len(nothing))
        return cls(
            np.full(shape, UNSOLVED), np.zeros(shape, dtype=bool), pitch, lines, study.shape, plane, nothing,
            cells, cells, [],
        )  # fmt: skip

    def wanted(self) -> Index:
        """Pixels (j, 3) to be solved next; none when all maps are known."""
        if not self.solved[0, 0, 0]:
            return self._unsolved(self._corners(self._looked_at))
        if not self._began:
            self._began = True
            self._surround()
        while True:
            found = self._looked_at[self._mixed(self._looked_at)]
            if self.pitch >= WIDE:
                found = self._with_neighbours(found)
            found = _once(found[~self._divided[found]])
            self._divided[found] = True
            pixels = self._unsolved(np.append(self._corners(found), self._near_thin()))
            self._found.append(found)
            if len(pixels):
                self._looked_at = self._around(pixels)
                return pixels
            if self.pitch == 1:
                if not len(found):
                    return pixels
                continue  # what was found last has not been looked at for parts of one pixel's width
            self._halve()
            pixels = self._unsolved(self._corners(self._inside))
            self._looked_at = _once(np.concatenate([self._inside, self._around(pixels)]))
            if len(pixels):
                return pixels

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

    @property
    def _cells(self) -> tuple[int, int, int]:
        """Cells of the present grid: maps, along n, along m."""
        return len(self.outcome), len(self.lines[0]) - 1, len(self.lines[1]) - 1

    def _place(self, cells: Index) -> tuple[Index, Index, Index]:
        """Map, row and column of cells of the present grid."""
        at, row, column = np.unravel_index(cells, self._cells)
        return at, row, column

    def _corners(self, cells: Index) -> Index:
        """Flat pixels of the corners of cells, (4, j)."""
        at, row, column = self._place(cells)
        _, n, m = self.outcome.shape
        first = at * (n * m)
        rows = [self.lines[0][row + i] * m for i in (0, 1)]
        columns = [self.lines[1][column + i] for i in (0, 1)]
        return np.array([first + y + x for y in rows for x in columns])

    def _unsolved(self, pixels: Index) -> Index:
        """Those of some flat pixels that are not solved, once each, (j, 3)."""
        rest = _once(pixels[~self.solved.reshape(-1)[pixels]])
        return np.column_stack(np.unravel_index(rest, self.outcome.shape)).astype(np.int64)

    def _mixed(self, cells: Index) -> Mask:
        """Which cells have corners of more than one outcome, or one that failed or is unresolved."""
        known = self.outcome.reshape(-1)[self._corners(cells)]
        return np.asarray((known < NO_UPLIFT).any(axis=0) | (known != known[0]).any(axis=0))

    def _with_neighbours(self, cells: Index) -> Index:
        """Cells, and the eight around each."""
        at, row, column = self._place(cells)
        _, n, m = self._cells
        found = [cells]
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                inside = (row + i >= 0) & (row + i < n) & (column + j >= 0) & (column + j < m)
                found.append(((at * n + row + i) * m + column + j)[inside])
        return _once(np.concatenate(found))

    def _around(self, pixels: Index) -> Index:
        """The cells that pixels (j, 3) of the present grid are corners of."""
        _, n, m = self._cells
        row, column = (np.searchsorted(of, pixels[:, i + 1]) for i, of in enumerate(self.lines))
        found = []
        for i in (-1, 0):
            for j in (-1, 0):
                inside = (row + i >= 0) & (row + i < n) & (column + j >= 0) & (column + j < m)
                found.append(((pixels[:, 0] * n + row + i) * m + column + j)[inside])
        return _once(np.concatenate(found))

    def _near_thin(self) -> Index:
        """Flat pixels in reach of those found last that are one pixel wide; at a pitch of 1.

        One pixel wide: those on both sides of it, along n or along m, have one outcome, and it has another.
        """
        if self.pitch > 1:
            return self._looked_at[:0]
        found, self._found = np.concatenate([self._looked_at[:0], *self._found]), []
        pixels = _once(self._corners(found).reshape(-1))
        _, n, m = self.outcome.shape
        row, column = pixels // m % n, pixels % m
        pixels = pixels[(row > 0) & (row < n - 1) & (column > 0) & (column < m - 1)]
        flat = self.outcome.reshape(-1)
        own, up, down, left, right = (flat[pixels + step] for step in (0, -m, m, -1, 1))
        thin = pixels[((up == down) & (up != own)) | ((left == right) & (left != own))]
        along, row, column = np.arange(-REACH, REACH + 1), thin // m % n, thin % m
        rows, columns = np.clip(row[:, None] + along, 0, n - 1), np.clip(column[:, None] + along, 0, m - 1)
        first = (thin // (n * m) * n)[:, None]
        return np.asarray(((first + rows) * m)[:, :, None] + columns[:, None, :]).reshape(-1)

    def _surround(self) -> None:
        """Give every pixel that is not on the coarse grid what the cell it lies in has in its first corner."""
        rows, columns = self.lines
        known = self.outcome[:, rows[:, None], columns]
        _, n, m = self.outcome.shape
        high, wide = np.append(np.diff(rows[:-1]), n - rows[-2]), np.append(np.diff(columns[:-1]), m - columns[-2])
        along = np.repeat(known[:, :-1, :-1], wide, axis=2)
        self.outcome[...] = np.repeat(along, high, axis=1)
        self.outcome[:, rows[:, None], columns] = known

    def _fill(self, cells: Index) -> None:
        """Give what is not solved inside cells, and before the next one, what they have in their first corner.

        Of those pixels only the corner is solved, if the cell is not the last of an axis.
        """
        at, row, column = self._place(cells)
        _, rows, columns = self._cells
        last = (row == rows - 1) | (column == columns - 1)
        _, n, m = self.outcome.shape
        flat = self.outcome.reshape(-1)
        corners = ((at * n + self.lines[0][row]) * m + self.lines[1][column])[~last]
        known, along = flat[corners][:, None], np.arange(self.pitch)
        for i in range(self.pitch):
            flat[corners[:, None] + (i * m + along)] = known
        at, row, column = at[last], row[last], column[last]
        y0, x0 = self.lines[0][row], self.lines[1][column]
        (y1, x1), outcome = (self.lines[0][row + 1], self.lines[1][column + 1]), self.outcome[at, y0, x0]
        for i in range(self.pitch + 1):
            for j in range(self.pitch + 1):
                y, x = y0 + i, x0 + j
                of = ((y < y1) | (y == n - 1)) & ((x < x1) | (x == m - 1)) & (y <= y1) & (x <= x1)
                of[of] &= ~self.solved[at[of], y[of], x[of]]
                self.outcome[at[of], y[of], x[of]] = outcome[of]

    def _halve(self) -> None:
        """Halve the pitch: what is to be looked at are the cells inside those that are divided."""
        if self.pitch < coarse_pitch(min(self.outcome.shape[1:])):  # else all have been given that
            self._fill(self._inside[~self._divided[self._inside]])
        at, row, column = self._place(np.concatenate(self._found))
        coarse = self.lines
        self.pitch //= 2
        self.lines = (_grid(self.outcome.shape[1], self.pitch), _grid(self.outcome.shape[2], self.pitch))
        _, n, m = self._cells
        rows, columns = (
            [np.searchsorted(fine, of[place]), np.searchsorted(fine, of[place + 1]) - 1]
            for fine, of, place in zip(self.lines, coarse, (row, column), strict=True)
        )
        inside = [(at * n + y) * m + x for y in rows for x in columns]
        self._inside = _once(np.concatenate(inside))
        self._divided, self._found = np.zeros(len(self.outcome) * n * m, dtype=bool), []


def coarse_pitch(n: int) -> int:
    """Pitch of the coarse grid over n pixels: 32 for 1600 and more, 1 (which solves everything) below 100."""
    return int(np.clip(2 ** int(np.log2(max(n / CELLS, 1.0))), 1, COARSEST))


def _grid(n: int, pitch: int) -> Index:
    return np.unique(np.append(np.arange(0, n, pitch), n - 1)).astype(np.int64)


def _once(numbers: Index) -> Index:
    """Each of these numbers once, in order.  As they come in a few ordered rows, merging takes a tenth of the time."""
    ordered = np.sort(numbers, kind="stable")
    return ordered[np.append(True, ordered[1:] != ordered[:-1])] if len(ordered) else ordered
