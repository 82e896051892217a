"""Result of a chunk of cases: the piece of a sweep that travels between processes and into parts."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep.chunk_symbols import Values
from rockcli.scene.response import FAILED
from rockcli.storage.on_disk import full
from rockcli.study.study import Index

Array = NDArray[np.float64]

DTYPES: dict[str, type[np.generic]] = {
    "outcome": np.int8,
    "n_impacts": np.int64,
    "n_steps": np.int64,
    "n_rhs": np.int64,
    "model_used": np.int8,
}
"""Scalars that are not floats."""

UNSAID: dict[str, int] = {"outcome": FAILED, "n_impacts": -1, "n_steps": -1, "n_rhs": -1, "model_used": -1}
"""What stands where there is no answer; NaN among the floats."""


class _Travelling:
    """Whose cases are pickled as runs: most chunks are one, and their numbers would be most of what is sent."""

    cases: Index

    def __getstate__(self) -> dict[str, Any]:
        spans = spans_of(self.cases)
        return self.__dict__ | {"cases": spans if len(spans) < 0.01 * len(self.cases) else self.cases}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        if self.cases.ndim == 2:
            self.cases = cases_of(self.cases)


@dataclass(eq=False)
class Description(_Travelling):
    """What is known of m cases before they are solved.

    Attributes:
        cases: flat indices, ascending, of those that could be built.
        symbols: (m,) by name, or reduced along axes on which it does not depend, or one number where all cases have it;
            NaN where a case has none.
        warnings: sentences about the physics.
        has_mass: whether every case has a mass; symmetric: whether every body is.
    """

    cases: Index
    symbols: Values
    warnings: list[str]
    has_mass: bool = True
    symmetric: bool = True


@dataclass(eq=False)
class ChunkResult(_Travelling):
    """Results of m cases.

    Attributes:
        cases: flat indices, ascending, (m,).
        scalars: (m,) by name.
        sentences: sentence -> flat indices of the cases that have it.
        used: settings of solvers, each with the lowest case they were used for.
        time: (k,) [s]; histories: (m, k) by name; impacts: (m, j) by name, NaN-padded.
        shaken: (m,) by name, of a_g and a_v: at how many of the output times they are told.  They follow from the
            motion, so that their values are not among the histories.
        described: of the same cases, None where that has still to be found.
        unsolved: what the machine refused -> cases asked for that are not among these, and have no answer.
    """

    cases: Index
    scalars: dict[str, NDArray[Any]]
    sentences: dict[str, Index] = field(default_factory=dict)
    used: list[tuple[int, dict[str, str]]] = field(default_factory=list)
    time: Array = field(default_factory=lambda: np.empty(0))
    histories: dict[str, Array] = field(default_factory=dict)
    impacts: dict[str, Array] = field(default_factory=dict)
    shaken: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    described: Description | None = None
    unsolved: dict[str, Index] = field(default_factory=dict)

    def among(self, wanted: NDArray[np.bool_]) -> ChunkResult:
        """Those of the cases that are wanted, (m,)."""
        if wanted.all():
            return self
        cases = self.cases[wanted]
        sentences = {sentence: np.intersect1d(where, cases) for sentence, where in self.sentences.items()}
        return ChunkResult(
            cases,
            {name: values[wanted] for name, values in self.scalars.items()},
            {sentence: where for sentence, where in sentences.items() if len(where)},
            self.used if len(cases) else [],
            self.time,
            {name: values[wanted] for name, values in self.histories.items()},
            {name: values[wanted] for name, values in self.impacts.items()},
            {name: values[wanted] for name, values in self.shaken.items()},
        )


def blank(
    names: tuple[str, ...], n: int, folder: Path | None = None, *, filled: bool = True
) -> dict[str, NDArray[Any]]:
    """Scalars of n cases of which nothing is known, (n,) each; `reason` is told by sentences.

    Large ones lie in a folder, None = in memory (`storage.on_disk`).  Not filled, they hold nothing in particular.
    """
    return {
        name: full(n, UNSAID.get(name, np.nan) if filled else None, DTYPES.get(name, np.float64), folder)
        for name in names
        if name != "reason"
    }


def spans_of(cases: Index) -> Index:
    """First and last + 1 of every run of consecutive cases, (k, 2); cases: ascending."""
    if len(cases) and cases[-1] - cases[0] == len(cases) - 1:  # one run, as most chunks are
        return np.array([[cases[0], cases[-1] + 1]])
    firsts = np.flatnonzero(np.diff(cases, prepend=cases[:1] - 2) != 1)
    lasts = np.flatnonzero(np.diff(cases, append=cases[-1:] + 2) != 1)
    return np.column_stack([cases[firsts], cases[lasts] + 1])


def cases_of(spans: Index) -> Index:
    """The cases of `spans_of`."""
    return np.concatenate([np.arange(first, stop) for first, stop in spans])
