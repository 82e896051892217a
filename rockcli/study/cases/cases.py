"""The cases of a study, built in batches: what differs only in numbers is one batch of arrays, never a loop."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import islice, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError, StudyError
from rockcli.scene.batch import Batch, Save
from rockcli.study.building.batch import build_batch
from rockcli.study.building.body import make_body, sufficient_pair
from rockcli.study.building.floors import waveforms
from rockcli.study.building.ground_motion import alike_but_for_records
from rockcli.study.building.numbers import Motions, Numbers, Varied
from rockcli.study.building.records import Records
from rockcli.study.cases.file_names import filled_in
from rockcli.study.cases.variation import Variation
from rockcli.study.document.check import check_case
from rockcli.study.document.expressions import ExpressionError, parse
from rockcli.study.document.overlay import overlaid
from rockcli.study.document.tree import Keys, Map, Source, Where, value_at
from rockcli.study.schema import CasePart
from rockcli.study.study import OF_DIRECTIONS, Index

Array = NDArray[np.float64]
Points = dict[int, NDArray[np.int64]]
"""Axis -> index of every case on it."""

PROBED = 20_000
"""A study of at most so many cases is built whole before it is solved; of a larger one, corners and edges."""

_KEPT = 256
"""Combinations of structural points kept."""


@dataclass(eq=False)
class Cases:
    """Builds batches of cases (the `CaseSource` of a study).

    Args:
        study: {case, let}, short forms written out.
        variations: the axes, outermost first.
        save: what every batch is asked for.
        histories_at: axis -> the only point on it whose histories are saved; empty = all.
    """

    source: Source
    study: Map
    variations: list[Variation]
    records: Records
    save: Save
    histories_at: dict[int, int] = field(default_factory=dict)
    _checked: dict[tuple[int, ...], tuple[Map, CasePart]] = field(default_factory=dict)

    @property
    def shape(self) -> tuple[int, ...]:
        """Points of every axis."""
        return tuple(v.size for v in self.variations)

    @property
    def structural(self) -> list[int]:
        """Axes whose points need several batches."""
        return [i for i, v in enumerate(self.variations) if v.structural]

    def batches(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """Yield (flat indices, batch); a batch holds all the cases given that share every tag.

        Raises:
            StudyError, RecordError: a case cannot be built.
        """
        for part, combination, points in self.groups(np.asarray(indices, dtype=np.int64)):
            for rows, save in self._saves(points, len(part)):
                chosen = {axis: p[rows] for axis, p in points.items()}
                numbers = self.numbers(combination, chosen, len(part[rows]))
                yield part[rows], build_batch(numbers, self.records, save)

    def suites(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """`batches`, but cases of many records in one where an axis names them and they differ in nothing else.

        Raises:
            StudyError, RecordError: a case cannot be built.
        """
        for part, combination, points, motions in self.groups_of_suites(np.asarray(indices, dtype=np.int64)):
            built = None
            if motions is not None:
                with suppress(StudyError, RecordError):  # told below, by the batch of the record that is at fault
                    built = build_batch(self.numbers(combination, points, len(part), motions), self.records, self.save)
            if built is None:
                yield from self.batches(part)
            else:
                yield part, built

    def groups_of_suites(self, indices: Index) -> Iterator[tuple[Index, tuple[int, ...], Points, Motions | None]]:
        """`groups`, but recorded motions together where they may be; None for a group as it is."""
        axis = self._of_records
        if axis is None:
            yield from ((*group, None) for group in self.groups(indices))
            return
        variation = self.variations[axis]
        directions = variation.axis.path == OF_DIRECTIONS
        for part, combination, points in self._by_structure(indices, axis):
            there, which = np.unique(points[axis], return_inverse=True)
            keys: Keys = ("case", "motion", "record", "angle" if directions else "file")
            said = [found for found in map(variation.motion_of, there.tolist()) if found is not None]
            motions: dict[Any, Where] = {}
            first: dict[Any, int] = {}
            for point, (motion, where) in zip(there.tolist(), said, strict=False):
                motions.setdefault(motion, where)
                first.setdefault(motion, point)
            together = len(motions) > 1 and len(said) == len(there)  # else one motion, or points that say none
            together = together and alike_but_for_records(self.checked(combination)[1], directions=directions)
            if not together or not self._decides(axis, combination, keys, first):
                yield from ((*group, None) for group in self.groups(part))
                continue
            number = {motion: i for i, motion in enumerate(motions)}
            of_point = np.array([number[motion] for motion, _ in said])
            yield part, combination, points, Motions(keys, tuple(motions.items()), of_point[which])

    def _decides(self, axis: int, combination: tuple[int, ...], keys: Keys, points: dict[Any, int]) -> bool:
        """Whether what points of a structural axis say at some keys, each another value, stays beside the other axes.

        Two of them tell: what another axis puts there is the same for both.
        """
        at = self.structural.index(axis)
        some = islice(points.items(), 2)
        trees = ((self.checked((*combination[:at], point, *combination[at + 1 :]))[0], value) for value, point in some)
        return all(value_at(tree, keys) == value for tree, value in trees)

    @property
    def _of_records(self) -> int | None:
        """The axis of directions, or the only one of whose points some differ in the record alone; None for none."""
        if self.save.histories:
            return None
        turned = [i for i, v in enumerate(self.variations) if v.columns is None and v.axis.path == OF_DIRECTIONS]
        if turned:
            numbers = all(isinstance(s[0][1], int | float) for s in self.variations[turned[0]].settings)
            return turned[0] if numbers else None
        found = [i for i, v in enumerate(self.variations) if v.first_but_for_record is not None]
        return found[0] if len(found) == 1 else None

    def _saves(self, points: Points, n: int) -> Iterator[tuple[Any, Save]]:
        """Rows of a group and what is asked for them: histories may be wanted of some only."""
        if not self.histories_at or not self.save.histories:
            yield slice(None), self.save
            return
        wanted = np.ones(n, dtype=bool)
        for axis, point in self.histories_at.items():
            wanted &= points[axis] == point
        for rows, save in ((wanted, self.save), (~wanted, replace(self.save, histories=False))):
            if rows.any():
                yield rows, save

    def groups(self, indices: Index) -> Iterator[tuple[Index, tuple[int, ...], Points]]:
        """Split flat indices by the points on the structural axes, and by waveform; keep the points on the others."""
        for part, combination, points in self._by_structure(indices):
            if not self.checked(combination)[1].motion.through:
                yield part, combination, points
                continue
            said = waveforms(self.numbers(combination, points, len(part)))
            assert said is not None
            _, which = np.unique(said, axis=0, return_inverse=True)
            order = np.argsort(which.ravel(), kind="stable")
            for rows in np.split(order, np.flatnonzero(np.diff(which.ravel()[order])) + 1):
                yield part[rows], combination, {i: p[rows] for i, p in points.items()}

    def _by_structure(
        self, indices: Index, together: int | None = None
    ) -> Iterator[tuple[Index, tuple[int, ...], Points]]:
        """Split flat indices by the points on the structural axes, on one of them without regard to records."""
        if not len(indices):
            return
        if not self.variations:
            yield indices, (), {}
            return
        points = [np.asarray(p, dtype=np.int64) for p in np.unravel_index(indices, self.shape)]
        structural = self.structural
        if not structural:
            yield indices, (), dict(enumerate(points))
            return
        first = {i: self.variations[i].batch_of(points[i]) for i in structural}
        if together is not None:
            first[together] = self.variations[together].batch_of_records(points[together])
        key = np.ravel_multi_index([first[i] for i in structural], [self.shape[i] for i in structural])
        order = np.argsort(key, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(key[order])) + 1):
            combination = tuple(int(first[i][rows[0]]) for i in structural)
            yield indices[rows], combination, {i: p[rows] for i, p in enumerate(points)}

    def numbers(self, combination: tuple[int, ...], points: Points, n: int, suite: Motions | None = None) -> Numbers:
        """The numbers of the cases at a combination of structural points; those of a suite have a record each."""

        def column(axis: int, which: int) -> Array:
            columns = self.variations[axis].columns
            assert columns is not None
            return list(columns.values())[which][points[axis]]

        def spot(varied: Varied | None, i: int, *, bodies: bool = False) -> tuple[Where, str]:
            where = None
            if varied is not None:
                where = self.variations[varied.axis].place(varied.column, int(points[varied.axis][i]))
            told = ((a, v) for a, v in enumerate(self.variations) if v.makes_bodies or not bodies)
            return where, ", ".join(f"{v.axis.path} = {_shown(v.axis.values[points[a][i]])}" for a, v in told)

        return Numbers(self.source, *self.checked(combination), n, column, spot, sufficient_pair, make_body, suite)

    def checked(self, combination: tuple[int, ...]) -> tuple[Map, CasePart]:
        """The study of a combination of structural points, with `Varied` where the other axes stand, and its case."""
        if combination not in self._checked:
            if len(self._checked) >= _KEPT:
                self._checked.clear()
            study = self._overlaid(dict(zip(self.structural, combination, strict=True)))
            self._checked[combination] = study, check_case(self.source, study)
        return self._checked[combination]

    def _overlaid(self, chosen: dict[int, int]) -> Map:
        at = dict.fromkeys(range(len(self.variations)), 0) | chosen
        points = [variation.varied(axis, at[axis]) for axis, variation in enumerate(self.variations)]
        axes = (v.axis for i, v in enumerate(self.variations) if i in chosen)
        labels = {axis.name: str(axis.values[chosen[i]]) for axis, i in zip(axes, sorted(chosen), strict=True)}
        return filled_in(overlaid(self.study, *points), labels)

    def probe(self) -> Index:
        """Flat indices that together show whatever can be wrong: all, or the corners and edges of every combination.

        The edges are walked from the first point of each axis; the corners are the smallest and the largest
        values, where a quantity that grows or falls along each axis has its extremes.
        """
        shape = self.shape
        if int(np.prod(shape, dtype=np.int64)) <= PROBED:
            return np.arange(int(np.prod(shape, dtype=np.int64)))
        structural = [i for i, v in enumerate(self.variations) if v.columns is None]
        walked = {i: [0] for i in range(len(shape)) if i not in structural}
        ends = {i: self._ends(i) for i in walked}
        corners = list(product(*(ends[i] for i in walked)))
        spots = [np.array(corners, dtype=np.int64).reshape(len(corners), len(walked))]
        for k, i in enumerate(walked):
            spots.append(np.zeros((shape[i], len(walked)), dtype=np.int64))
            spots[-1][:, k] = np.arange(shape[i])
        numeric = np.concatenate(spots)
        sizes = [shape[i] for i in structural]
        combos = (
            np.indices(sizes, dtype=np.int64).reshape(len(sizes), -1) if sizes else np.zeros((0, 1), dtype=np.int64)
        )
        count = combos.shape[1]
        points = np.empty((len(shape), count, len(numeric)), dtype=np.int64)
        for k, i in enumerate(structural):
            points[i] = combos[k][:, None]
        for k, i in enumerate(walked):
            points[i] = numeric[:, k][None, :]
        return np.unique(np.ravel_multi_index(tuple(points.reshape(len(shape), -1)), shape))

    def _ends(self, axis: int) -> list[int]:
        """Points of an axis with columns where one of these is smallest or largest, of all that are in one batch."""
        variation = self.variations[axis]
        assert variation.columns is not None
        first = variation.batch_of(np.arange(variation.size))
        order = np.argsort(first, kind="stable")
        ends = set()
        for points in np.split(order, np.flatnonzero(np.diff(first[order])) + 1):
            ends.add(int(points[0]))
            for values in (of[points] for of in variation.columns.values()):
                if np.isfinite(values[0]):
                    ends |= {int(points[np.argmin(values)]), int(points[np.argmax(values)])}
        return sorted(ends)

    def evaluate(self, text: str) -> float:
        """The value of an expression that is the same in all cases.

        Raises:
            ExpressionError: it differs from case to case.
        """
        expression = parse(text)
        first: float | None = None
        for part, combination, points, motions in self.groups_of_suites(self.probe()):
            values = np.ravel(expression.evaluate(self.numbers(combination, points, len(part), motions).symbol))
            first = float(values[0]) if first is None else first
            if not (values == first).all():
                raise ExpressionError(
                    f"{text!r} differs from case to case, so it cannot be a coordinate; vary a dimensionless key "
                    "(a_p_over_g_tan_alpha, pga_over_g_tan_alpha, omega_p_over_p), or a symbol of `let`, instead"
                )
        assert first is not None
        return first


def _shown(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)
