"""The trials of a search: solved, kept where a run that is ended finds them again, and told where they are failures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunk_result import ChunkResult
from rockcli.engine.sweep.results import of_failed
from rockcli.engine.sweep.sweep import Solving, Sweep, check_solved, note_damaged, note_unsolved
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trials:
    """Cases (k,) of a study, each at m values of the searched range, (m, k): row r is case r % k at its value r // k.

    A `CaseSource`, whose cases are the rows.
    """

    study: Study
    cases: Index
    values: Array

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.values.size

    def work(self, compiled: bool) -> Solving:
        """What solves rows for their outcome."""
        asked = replace(self.study, cases=self, scalars=("outcome",), histories=False, histories_at=None)
        return Solving(asked, compiled, described=False)

    def batches(self, rows: Index) -> Iterator[tuple[Index, Batch]]:
        """Yield (rows, batch)."""
        assert self.study.search is not None
        k = len(self.cases)
        for local, batch in self.study.search.at(self.cases[rows % k], self.values[rows // k, rows % k]):
            yield rows[local], batch


class Tried:
    """What came of all trials: kept where a run that is ended finds it again, and told where it is a failure.

    Trials are numbered through: the scan first, then round after round of the bisection, in each of which a case has
    its place whether it takes part or not.  A run that goes on asks for the same values again.

    Attributes:
        failed: sentence -> cases of which a trial failed.
    """

    def __init__(self, n: int, sweep: Sweep) -> None:
        self.n = n
        self.sweep = sweep
        self.failed: dict[str, Index] = {}
        self._first = 0
        self._refused: dict[str, int] = {}
        kept = list(sweep.keeper.kept()) if sweep.keeper else []
        note_damaged(sweep)
        numbers = np.concatenate([answer.cases for answer in kept]) if kept else np.empty(0, dtype=np.int64)
        order = np.argsort(numbers, kind="stable")
        self._numbers = numbers[order]
        self._kept = {
            name: np.concatenate([answer.scalars[name] for answer in kept])[order] if kept else np.empty(0)
            for name in ("value", "outcome")
        }
        for answer in kept:
            self._note_failed(answer)

    def before(self, trials: Trials) -> tuple[NDArray[np.int8], NDArray[np.bool_]]:
        """Outcomes of the trials that earlier runs have kept, and which they are, (rows,)."""
        numbers = self._numbers_of(trials, np.arange(trials.size))
        found = np.full(trials.size, FAILED, dtype=np.int8)
        if not len(self._numbers):
            return found, np.zeros(trials.size, dtype=bool)
        at = np.minimum(np.searchsorted(self._numbers, numbers), len(self._numbers) - 1)
        known = (self._numbers[at] == numbers) & (self._kept["value"][at] == trials.values.ravel())
        found[known] = self._kept["outcome"][at[known]]
        self.sweep.resumed += int(known.sum())
        return found, known

    def keep(self, trials: Trials, answer: ChunkResult) -> None:
        """Keep the answer of some trials."""
        values = {"value": trials.values.ravel()[answer.cases], "outcome": answer.scalars["outcome"]}
        sentences = {sentence: self._numbers_of(trials, rows) for sentence, rows in of_failed(answer)}
        numbered = ChunkResult(self._numbers_of(trials, answer.cases), values, sentences)
        note_unsolved(self._refused, answer)
        self._note_failed(numbered)
        if self.sweep.keeper is not None and len(numbered.cases):
            self.sweep.keeper.keep(numbered)

    def close(self, trials: Trials) -> None:
        """Go on to the next round; `MachineError` if there are trials that the machine refused to solve."""
        check_solved(self._refused, trials.size)
        self._first += len(trials.values) * self.n

    def _numbers_of(self, trials: Trials, rows: Index) -> Index:
        k = len(trials.cases)
        return self._first + self.n * (rows // k) + trials.cases[rows % k]

    def _note_failed(self, answer: ChunkResult) -> None:
        for sentence, where in of_failed(answer):
            self.failed[sentence] = np.union1d(self.failed.get(sentence, where[:0]), where % self.n)
