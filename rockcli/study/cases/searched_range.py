"""A searched range (`find: overturning`): cases at any value of it, and the study's cases without it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch, Save
from rockcli.scene.ground.amplitudes import AMPLITUDES
from rockcli.scene.thresholds import BESIDE, FOUND, PARTS
from rockcli.study.cases.cases import Cases
from rockcli.study.cases.variation import Variation
from rockcli.study.document.tree import Map, Source
from rockcli.study.study import Axis, Index, Over

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Search:
    """What is searched, and how to build its cases.

    Attributes:
        axis: the scanned points, ascending; not a dimension of the dataset.
        name: of the result in the dataset, `<axis>_overturning`.
    """

    axis: Axis
    name: str
    _cases: Cases

    @property
    def _place(self) -> int:
        return next((i for i, value in enumerate(self.axis.values) if value > 0.0), 0)

    @property
    def first(self) -> float:
        """The lowest scanned point above zero, as no motion has an amplitude of zero; without one the lowest."""
        return float(self.axis.values[self._place])

    @property
    def prescreens(self) -> tuple[str, ...]:
        """Names of the pre-screens beside the value found: from the first uplift, and for the worst excursion."""
        path = self.axis.path.removeprefix("case.").split(".")
        of_motion = path[0] == "motion" and len(path) == 3 and path[-1] in AMPLITUDES
        return (f"{self.name}_prescreen", f"{self.name}_prescreen_worst") if of_motion else ()

    def results(self, over: Over | None) -> tuple[str, ...]:
        """Names of what the search gives: the value found, what stands beside it, and its statistics."""
        names = (self.name, *(f"{self.name}_{part}" for part in PARTS), *self.prescreens)
        beside = tuple(f"{self.name}_{part}" for part in BESIDE)
        return (*names, *beside, *(f"{name}_{end}" for name in names for end in (over.ends if over else ())))

    def at(self, indices: Index, values: Array) -> Iterator[tuple[Index, Batch]]:
        """Yield (positions, batch) for the study's flat case indices (k,), each with its own value (k,)."""
        searched = self._cases.variations[-1]
        assert searched.columns is not None
        points = replace(
            searched,
            axis=replace(searched.axis, values=tuple(values.tolist())),
            columns={path: np.asarray(values, dtype=float) for path in searched.columns},
        )
        cases = replace(self._cases, variations=[*self._cases.variations[:-1], points], _checked={})
        k = len(values)
        wanted = indices * k + np.arange(k)
        for flat, batch in cases.batches(wanted):
            yield flat % k, batch

    def batches(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """Yield (flat indices, batch) of the study's cases at the point `first` (a `CaseSource`)."""
        m = self.axis.size
        for flat, batch in self._cases.batches(np.asarray(indices) * m + self._place):
            yield flat // m, batch


def searched(source: Source, study: Map, variations: Sequence[Variation]) -> Variation | None:
    """The searched range of a study, if any.

    Raises:
        StudyError: more than one.
    """
    found = [v for v in variations if v.find]
    if len(found) > 1:
        raise source.error(study, ("vary", found[1].axis.path), "is a second range to search; only one can be")
    return found[0] if found else None


def doubted_range(search: Search | None) -> Iterator[str]:
    """A sentence where amplitudes of both signs, or of the other one, are searched for the lowest."""
    if search is not None and search.prescreens and min(search.axis.values) < 0.0:
        yield (
            f"the range searched of {search.axis.path} begins below 0, and the lowest value of it that overturns is "
            "the one farthest below, no smallest strength: search from 0 up, for the motion turned round with "
            "`polarity: -1` of a record or, of a pulse, along `let.k` in `a_p: -k`"
        )


def make_search(cases: Cases, variation: Variation) -> Search:
    """The search along the last axis of `cases`; all it asks of a solver is the outcome."""
    assert variation.columns is not None
    order = np.argsort(variation.axis.values, kind="stable")
    axis = replace(variation.axis, values=tuple(variation.axis.values[i] for i in order))
    ascending = replace(variation, axis=axis, columns={path: of[order] for path, of in variation.columns.items()})
    save = Save(False, cases.save.dt_out, frozenset({"outcome"}))
    asked = replace(cases, variations=[*cases.variations[:-1], ascending], save=save, histories_at={})
    return Search(axis, f"{axis.name}{FOUND}", asked)
