"""`refine`: traces the boundaries between outcomes of a two-axis map instead of solving every pixel.

The places of a coarse grid are solved.  The grid is halved again and again, down to single pixels, and a new place has
the outcome of the one before it until it is solved.  At every pitch both places of a pair of neighbours that differ are
solved, while the grid is wide with the eight around each, and so on beside those, until every change lies between two
that are solved: a boundary is followed wherever it leads.  A band thinner than a pixel comes in fragments with gaps
between: ahead of an end of a part one pixel wide the next fragment is sought.  What failed or is unresolved differs
from everything.

What lies wholly between the places of the coarse grid and in no band that was found is missed.  Pixels drawn at random
from those that are not solved tell how much that may be, and what they find is followed too.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.results import Results
from rockcli.engine.sweep.sweep import Sweep, outlook, take_known, work_off
from rockcli.engine.sweep.symbols_of_cases import describe_rest, symbols_of
from rockcli.engine.sweep.work import Team
from rockcli.scene.response import NO_UPLIFT
from rockcli.study.study import Index, Study

Mask = NDArray[np.bool_]

CELLS = 50
"""Cells of the coarse grid along an axis, at least; its pitch is the largest power of two that leaves so many."""


class Search(NamedTuple):
    """Where changes are sought; lengths in pixels."""

    coarsest: int
    """Pitch of the coarse grid, at most."""
    wide: int
    """Pitch down to which what lies beside a change is solved together with the eight around it."""
    ahead: int
    """How far ahead of the end of a part one pixel wide the next is sought, at most; also two pitches of the coarse
    grid."""
    every: int
    """From one row looked at there to the next, at most; less on small maps.  As parts are some pixels long and what is
    found is followed, every row would find little more."""


UNDER_PULSES, UNDER_RECORDS = Search(32, 4, 24, 1), Search(16, 1, 30, 3)
"""Under recorded motions islands are everywhere, and one change lies beside another."""

FEW = 32
"""Places below which they are left to the grid of half the pitch: a round of a few costs as much as one of hundreds."""

PROBES, PROBED = 3000, 20
"""Pixels drawn at random, at most, and one of them for so many solved ones."""

UNSOLVED = np.int8(-128)


def solve_refined(study: Study, sweep: Sweep | None = None) -> Results:
    """Solve what tells where outcomes change over the two axes `study.refine`, for every point of the other axes.

    `Results.solved` says which cases were solved; the others have the outcome that surrounds them, and no other scalar.

    Raises:
        StudyError: a solver cannot do what the study asks for.
        OutputError: what is finished cannot be kept.
    """
    sweep = sweep or Sweep(Team())
    with np.errstate(all="ignore"):
        results = Results.of(study, symbols_of(study, sweep.folder), sweep.folder)
        todo = take_known(sweep, results)
        kept = ~todo
        estimate, compiled = outlook(study, study.size)
        pace = Pace(estimate)
        maps = Maps.of(study)

        for wanted in maps.wanted():
            cases = maps.cases(wanted)
            left = Chunks.of(np.sort(cases[todo[cases]], kind="stable"))
            work_off(study, sweep, results, left, pace, compiled=compiled)
            todo[cases] = False
            maps.take(wanted, results.scalars["outcome"][cases])

        maps.lay(maps.outcome, results.scalars["outcome"])
        results.solved = np.zeros(study.size, dtype=np.int8)
        maps.lay(maps.solved, results.solved)
        results.probes = maps.probes
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
    """The k maps of a study, (k, n, m) places of the present grid each, and how far they are refined.

    A place is a flat index into the present grid.  Apart from a look at all of it when it is halved, what is done goes
    by lists of places, so that it costs what the boundaries are long.

    Attributes:
        outcome: what a place has or, where it is not `solved`, what the one before it has, as far as is known.
        solved: whether the place was solved.
        lines: pixels of the present grid along n and along m, ascending; the last pixel always belongs to it.
        pitch: of the grid; the last step of an axis may be shorter.
        wide: pitch down to which the eight around what lies beside a change are solved too.
        ahead: how far ahead of parts one pixel wide the next is sought [pixels].
        probes: how many pixels were drawn at random from those not solved, and how many of them had another outcome.
    """

    outcome: NDArray[np.int8]
    solved: Mask
    pitch: int
    wide: int
    ahead: range
    lines: tuple[Index, Index]
    _pixels: tuple[int, int]
    _shape: tuple[int, ...]
    _plane: tuple[int, ...]
    probes: tuple[int, int] = (0, 0)

    @classmethod
    def of(cls, study: Study) -> Maps:
        """Nothing solved yet."""
        plane = tuple(i for i, axis in enumerate(study.axes) if axis.name in study.refine)
        n, m = (study.shape[i] for i in plane)
        search = UNDER_RECORDS if study.processing else UNDER_PULSES
        pitch = coarse_pitch(min(n, m), search.coarsest)
        step = min(search.every, 1 + pitch // 8)
        ahead = range(step, min(search.ahead, 2 * pitch) + 1, step)
        lines = (_grid(n, pitch), _grid(m, pitch))
        shape = (study.size // (n * m), len(lines[0]), len(lines[1]))
        nothing = np.full(shape, UNSOLVED), np.zeros(shape, dtype=bool)
        return cls(*nothing, pitch, search.wide, ahead, lines, (n, m), study.shape, plane)

    def wanted(self) -> Iterator[Index]:
        """Places to be solved, ascending, round by round: what one yields is to be taken before the next."""
        yield np.arange(self.outcome.size)
        while self.pitch > 1:
            self._halve()
            yield from self._followed(self._beside_changes())
        probed = self._drawn()
        if len(probed):
            expected = self.outcome.reshape(-1)[probed]
            yield probed
            missed = probed[self.outcome.reshape(-1)[probed] != expected]
            self.probes = len(probed), len(missed)
            yield from self._followed(missed)

    def take(self, places: Index, outcome: NDArray[np.int8]) -> None:
        """The outcomes of some places."""
        self.outcome.reshape(-1)[places], self.solved.reshape(-1)[places] = outcome, True

    def cases(self, places: Index) -> Index:
        """Flat cases of places."""
        at, row, column = np.unravel_index(places, self.outcome.shape)
        others = tuple(i for i in range(len(self._shape)) if i not in self._plane)
        along = dict(zip(others, np.unravel_index(at, [self._shape[i] for i in others] or [1]), strict=False))
        along |= dict(zip(self._plane, (self.lines[0][row], self.lines[1][column]), strict=True))
        return np.ravel_multi_index([along[i] for i in range(len(self._shape))], self._shape).astype(np.int64)

    def lay(self, values: NDArray[Any], onto: NDArray[Any]) -> None:
        """Write values of all pixels (k, n, m) into those of the flat cases."""
        pixels = np.moveaxis(onto.reshape(self._shape), self._plane, (-2, -1))
        pixels[...] = values.reshape(pixels.shape)

    def _halve(self) -> None:
        """Halve the pitch: a new place has the outcome of the one before it, along n and along m."""
        solved = self.solved
        self.pitch //= 2
        n, m = self._pixels
        self.lines = (_grid(n, self.pitch), _grid(m, self.pitch))
        n, m = (len(lines) for lines in self.lines)
        self.outcome = _doubled(_doubled(self.outcome, 2, m), 1, n)
        self.solved = np.zeros(self.outcome.shape, dtype=bool)
        first, last = slice(None, -1), -1
        for row, old_row in ((slice(0, n - 1, 2), first), (last, last)):
            for column, old_column in ((slice(0, m - 1, 2), first), (last, last)):
                self.solved[:, row, column] = solved[:, old_row, old_column]

    def _followed(self, places: Index) -> Iterator[Index]:
        """What is to be solved of places, and then ever further beside and ahead of them."""
        wanted = self._unsolved(self._with_neighbours(places))
        while len(places):
            if len(wanted):
                yield wanted
            near = [self._with_neighbours(self._beside(wanted))]
            if self.pitch == 1:
                near += self._ahead(places)
            places = wanted = self._unsolved(np.concatenate(near))
            if self.pitch > 1 and len(wanted) < FEW:
                return

    def _unsolved(self, places: Index) -> Index:
        """Those of some places that are not solved, once each."""
        return _once(places[~self.solved.reshape(-1)[places]])

    def _with_neighbours(self, places: Index) -> Index:
        """Places, and the eight around each as long as the grid is wide."""
        if self.pitch < self.wide:
            return places
        _, n, m = self.outcome.shape
        first, row, column = places // (n * m) * n, places // m % n, places % m
        rows = [first + np.clip(row + i, 0, n - 1) for i in (-1, 0, 1)]
        columns = [np.clip(column + i, 0, m - 1) for i in (-1, 0, 1)]
        return np.concatenate([y * m + x for y in rows for x in columns])

    def _beside_changes(self) -> Index:
        """Both places of all pairs of neighbours that differ."""
        outcome, (_, n, m) = self.outcome, self.outcome.shape
        down, along = outcome[:, 1:] != outcome[:, :-1], outcome[:, :, 1:] != outcome[:, :, :-1]
        if outcome.min() < NO_UPLIFT:
            unknown = outcome < NO_UPLIFT
            down |= unknown[:, 1:] | unknown[:, :-1]
            along |= unknown[:, :, 1:] | unknown[:, :, :-1]
        y, x = _few(down), _few(along)
        y += y // ((n - 1) * m) * m
        x += x // (m - 1)
        return _once(np.concatenate([y, y + m, x, x + 1]))

    def _beside(self, places: Index) -> Index:
        """Both places of the pairs that differ of places and their neighbours."""
        outcome, (_, n, m) = self.outcome.reshape(-1), self.outcome.shape
        row, column = places // m % n, places % m
        found = [places[:0]]
        for step, inside in ((-m, row > 0), (m, row < n - 1), (-1, column > 0), (1, column < m - 1)):
            here = places[inside]
            own, other = outcome[here], outcome[here + step]
            here = here[(own != other) | (own < NO_UPLIFT)]
            found += [here, here + step]
        return np.concatenate(found)

    def _ahead(self, places: Index) -> list[Index]:
        """Where the next fragments of bands thinner than a pixel are sought; at a pitch of 1.

        From places that are one pixel wide, and the three pixels ahead of them along the band have another outcome.
        """
        outcome, (_, n, m) = self.outcome.reshape(-1), self.outcome.shape
        row, column = places // m % n, places % m
        places = places[(row > 0) & (row < n - 1) & (column > 0) & (column < m - 1)]
        found = []
        for down in (True, False):
            along, across = (m, 1) if down else (1, m)
            own = outcome[places]
            thin = places[(outcome[places - across] != own) & (outcome[places + across] != own)]
            for way in (-1, 1):
                own = outcome[thin]
                ends = thin[np.all([outcome[thin + way * along + i * across] != own for i in (-1, 0, 1)], axis=0)]
                found += self._sought(ends, down, way, self._followed_back(ends, down, way))
        return found

    def _followed_back(self, ends: Index, down: bool, way: int) -> NDArray[np.float64]:
        """How far aside a pixel ahead the bands go that end at some places, as far as they are known.

        Pixel by pixel the band goes on where it has been going, a pixel aside, or more the longer the gap before.
        """
        outcome, solved = self.outcome.reshape(-1), self.solved.reshape(-1)
        own, aside, back = outcome[ends][:, None], np.zeros_like(ends), np.zeros_like(ends)
        off = np.array([0, 1, -1, 2, -2, 3, -3])
        for i in range(1, self.ahead.stop) if len(ends) else ():
            gap = i - back
            aim = (aside + np.rint(aside / np.maximum(back, 1) * gap).astype(np.int64))[:, None] + off
            at = self._at(ends[:, None], down, -way * i, aim)
            goes_on = (outcome[at] == own) & solved[at] & (np.abs(off) <= 1 + gap[:, None] // 3)
            some, first = goes_on.any(axis=1), goes_on.argmax(axis=1)
            aside = np.where(some, np.take_along_axis(aim, first[:, None], axis=1)[:, 0], aside)
            back = np.where(some, i, back)
        return np.asarray(-aside / np.maximum(back, 1))

    def _sought(self, ends: Index, down: bool, way: int, slope: NDArray[np.float64]) -> list[Index]:
        """Unsolved pixels ahead of the ends of bands that go aside by a slope."""
        found = []
        for i in self.ahead if len(ends) else ():
            aside = np.arange(-1 - i // 8, 2 + i // 8)
            expected = np.rint(slope * i).astype(np.int64)[:, None]
            found.append(self._unsolved(self._at(ends[:, None], down, way * i, expected + aside).reshape(-1)))
        return found

    def _at(self, places: Index, down: bool, along: int, aside: Index) -> Index:
        """Places so many pixels on, along n if `down` else along m, and aside; at the edge of the map those there."""
        _, n, m = self.outcome.shape
        first, row, column = places // (n * m) * n, places // m % n, places % m
        i, j = (along, aside) if down else (aside, along)
        row, column = np.minimum(np.maximum(row + i, 0), n - 1), np.minimum(np.maximum(column + j, 0), m - 1)
        return np.asarray((first + row) * m + column)

    def _drawn(self) -> Index:
        """Pixels drawn at random from those not solved, the same ones every time."""
        solved = self.solved.reshape(-1)
        drawn = np.random.default_rng(0).integers(solved.size, size=min(PROBES, int(solved.sum()) // PROBED))
        return self._unsolved(drawn)


def coarse_pitch(n: int, coarsest: int) -> int:
    """Pitch of the coarse grid over n pixels: 16 for 800, 32 for 1600 and more, 1 (which solves all) below 100."""
    return int(np.clip(2 ** int(np.log2(max(n / CELLS, 1.0))), 1, coarsest))


def _grid(n: int, pitch: int) -> Index:
    return np.unique(np.append(np.arange(0, n, pitch), n - 1)).astype(np.int64)


def _doubled(outcome: NDArray[np.int8], axis: int, size: int) -> NDArray[np.int8]:
    """A grid of half the pitch along an axis, of so many places: new ones are like that before them; the last stays."""
    shape = list(outcome.shape)
    shape[axis] = size
    found = np.empty(shape, dtype=np.int8)
    old, new = np.moveaxis(outcome, axis, 0), np.moveaxis(found, axis, 0)
    before = 2 * (len(old) - 1)
    new[:before:2] = old[:-1]
    new[1:before:2] = old[:-1]
    new[-1] = old[-1]
    return found


def _few(places: Mask) -> Index:
    """Flat places where it is so.  As they are few, eight are looked at at once."""
    flat = places.reshape(-1)
    whole = flat.size // 8 * 8
    eights = np.flatnonzero(flat[:whole].view(np.uint64))
    near = (8 * eights[:, None] + np.arange(8)).reshape(-1)
    return np.concatenate([near[flat[near]], whole + np.flatnonzero(flat[whole:])])


def _once(numbers: Index) -> Index:
    """Each of these numbers once, in order.  As they come in a few ordered rows, merging takes a tenth of the time."""
    ordered = np.sort(numbers, kind="stable")
    return ordered[np.append(True, ordered[1:] != ordered[:-1])] if len(ordered) else ordered
