"""Gathers the answers of all chunks, in whatever order they come."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunk_result import Array, ChunkResult, Description, blank
from rockcli.engine.sweep.chunk_symbols import Reduction
from rockcli.engine.sweep.settings_used import Used, joined
from rockcli.engine.sweep.symbols import Symbols
from rockcli.scene.response import FAILED, MAX_IMPACTS_STORED
from rockcli.storage.on_disk import full, in_blocks, let_go
from rockcli.study.study import Index, Study

LET_GO = 1 << 21
"""Cases put after which what lies on disk is no longer held in memory too."""


@dataclass(eq=False)
class Said:
    """A sentence: its code while gathering, the lowest case that has it, and how many have it."""

    code: int
    first: int
    count: int


@dataclass(eq=False)
class Tally:
    """Counts answers, and holds nothing of them: for who keeps them elsewhere.

    Attributes:
        answered: cases of which there is an answer.
    """

    answered: int = 0
    reduction = None
    describes = False

    def describe(self, found: Description) -> None:
        """What is known of cases before they are solved is found again by who puts the answers together."""

    def put(self, answer: ChunkResult) -> None:
        """Count the answer of cases that were not answered before."""
        self.answered += len(answer.cases)


@dataclass(eq=False)
class Results:
    """Everything the solvers said, over the flat cases of a study.

    Attributes:
        names: of the scalars.
        symbols: R alpha p eta a_p omega_p pga pgv, over the axes they depend on.
        reason: (n,) code of the sentence of each case, 0 for none; where the study does not save it, of those alone
            that failed, and empty if none did.
        said: by sentence; `reasons` lists them in the order of their final codes.
        time: output times (k,) [s].
        histories: (n, k) by name, NaN after a case's t_end; impacts: (n, j), NaN-padded.
        shaken: (n,) by name, of a_g and a_v: at how many of the output times they are told.
        has_mass: whether every case has a mass (M_base is then in N m).
        symmetric: whether every body is.
        answered: cases of which there is an answer.
        solved: (n,) of a refined map, 1 where the case was solved and 0 where its outcome is filled in; else None.
        probes: of a refined map, how many cases were drawn at random, and how many of them had been filled in wrongly.
        folder: where what is too large for memory lies; None = in memory.
        whole: whether every case gets an answer, so that none has to be laid out without one.
        ahead: is told of all cases that are answered.
    """

    size: int
    names: tuple[str, ...]
    symbols: Symbols
    reason: NDArray[np.int32]
    reason_asked: bool = True
    said: dict[str, Said] = field(default_factory=dict)
    reasons: list[str] = field(default_factory=list)
    time: Array = field(default_factory=lambda: np.empty(0))
    histories: dict[str, Array] = field(default_factory=dict)
    impacts: dict[str, Array] = field(default_factory=dict)
    shaken: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    has_mass: bool = True
    symmetric: bool = True
    answered: int = 0
    solved: NDArray[np.int8] | None = None
    probes: tuple[int, int] = (0, 0)
    folder: Path | None = None
    whole: bool = False
    ahead: Callable[[Index, Results], None] | None = None
    _warnings: set[str] = field(default_factory=set)
    _used: list[tuple[int, Used]] = field(default_factory=list)
    _pending: list[ChunkResult] = field(default_factory=list)
    _held: int = 0

    @classmethod
    def of(cls, study: Study, symbols: Symbols, folder: Path | None = None, *, solved: bool = True) -> Results:
        """Nothing yet; `solved`: whether there will be answers."""
        asked = "reason" in study.scalars
        reason = full(study.size if asked else 0, 0, np.int32, folder)
        return cls(study.size, study.scalars if solved else (), symbols, reason, asked, folder=folder)

    describes = True

    @cached_property
    def scalars(self) -> dict[str, NDArray[Any]]:
        """(n,) by name; floats NaN and counts -1 where there is no answer.

        Laid out with the first answer, while workers are busy with the next.
        """
        return blank(self.names, self.size, self.folder, filled=not self.whole)

    @property
    def reduction(self) -> Reduction:
        """How symbols are reduced, as far as is known by now."""
        return self.symbols.reduction

    @property
    def warnings(self) -> list[str]:
        """Sentences about the physics, in an order of their own."""
        return sorted(self._warnings)

    @property
    def used(self) -> list[Used]:
        """Distinct settings of the solvers, by the first case they were used for."""
        return [one for _, one in self._used]

    def describe(self, found: Description) -> None:
        """Take what is known of cases before they are solved."""
        if len(found.cases):
            self.symbols.put(found.cases, found.symbols)
        self._warnings.update(found.warnings)
        self.has_mass &= found.has_mass
        self.symmetric &= found.symmetric

    def put(self, answer: ChunkResult) -> None:
        """Take the answer of cases that were not answered before."""
        cases = answer.cases
        self.answered += len(cases)
        contiguous = len(cases) and cases[-1] - cases[0] + 1 == len(cases)
        at: Any = slice(int(cases[0]), int(cases[-1]) + 1) if contiguous else cases
        for name, values in answer.scalars.items():
            self.scalars[name][at] = values
        for sentence, where in answer.sentences.items() if self.reason_asked else of_failed(answer):
            self.explain(sentence, where)
        for name, counted in answer.shaken.items():
            self.shaken.setdefault(name, np.zeros(self.size, dtype=np.int64))[at] = counted
        self._used = joined([*self._used, *answer.used])
        if answer.histories or answer.impacts:
            self._pending.append(answer)
        if self.ahead is not None:
            self.ahead(cases, self)
        self._held += len(cases)
        if self._held > LET_GO:
            self._held = 0
            let_go(self.reason, *self.scalars.values(), *self.symbols.arrays)

    def explain(self, sentence: str, where: Index) -> None:
        """Give cases a sentence."""
        if not len(self.reason):
            self.reason = full(self.size, 0, np.int32, self.folder)
        said = self.said.setdefault(sentence, Said(len(self.said) + 1, int(where.min()), 0))
        said.first = min(said.first, int(where.min()))
        said.count += len(where)
        self.reason[where] = said.code

    def finish(self) -> None:
        """Number the sentences by the first case that has them and join the histories, whatever the order was."""
        assert not self.whole or self.answered == self.size, f"{self.answered} of {self.size} cases have an answer"
        order = sorted(self.said.items(), key=lambda item: (item[1].first, item[0]))
        self.reasons = ["", *(sentence for sentence, _ in order)]
        place = np.zeros(len(order) + 1, dtype=np.int32)
        place[[said.code for _, said in order]] = np.arange(1, len(order) + 1)
        for at in in_blocks(self.reason):
            self.reason[at] = place[self.reason[at]]
        self._join_histories()

    def _join_histories(self) -> None:
        """Lay the histories of all chunks on the longest of their time axes, and pad the impacts."""
        self.time = max((answer.time for answer in self._pending), key=len, default=np.empty(0))
        longest = max((a.shape[1] for one in self._pending for a in one.impacts.values()), default=0)
        width = min(max(longest, 1), MAX_IMPACTS_STORED)
        for kind, into, columns in (("histories", self.histories, len(self.time)), ("impacts", self.impacts, width)):
            names = {name for answer in self._pending for name in getattr(answer, kind)}
            into.update({name: np.empty((self.size, columns)) for name in sorted(names)})
        missing = np.ones(self.size, dtype=bool)
        while self._pending:  # each is let go once it is laid down, so that there are never two of everything
            answer = self._pending.pop()
            missing[answer.cases] = False
            for into, found in ((self.histories, answer.histories), (self.impacts, answer.impacts)):
                for name, values in into.items():
                    rows = np.full((len(answer.cases), values.shape[1]), np.nan)
                    if name in found:
                        rows[:, : found[name].shape[1]] = found[name]
                    values[answer.cases] = rows
        for values in (*self.histories.values(), *self.impacts.values()):
            values[missing] = np.nan


def of_failed(answer: ChunkResult) -> Iterator[tuple[str, Index]]:
    """The sentences of the cases that failed."""
    failed = answer.cases[answer.scalars["outcome"] == FAILED] if "outcome" in answer.scalars else answer.cases[:0]
    for sentence, where in answer.sentences.items() if len(failed) else ():
        if len(both := np.intersect1d(where, failed)):
            yield sentence, both
