"""Work and team of a sweep: what is done with cases, by how many processes, and in halves where the machine refuses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Protocol, TypeVar

import numpy as np

from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.study.cases.buildable import ATTEMPTS, Unsolved, reason_of
from rockcli.study.study import Index

T_co = TypeVar("T_co", covariant=True)
T = TypeVar("T")


class Work(Protocol[T_co]):
    """What is to be done with cases; it travels to other processes."""

    def __call__(self, cases: Index) -> T_co:
        """The answer of some cases."""
        ...

    def lost(self, cases: Index, why: str) -> T_co:
        """The answer of cases that no process survives; `why` is `Unsolved` where that is the machine's fault."""
        ...


@dataclass
class Team:
    """Who may work.

    Attributes:
        workers: processes on this machine, at most.
        dask: address of a Dask scheduler, which then does all the work.
        notes: what happened to them, sentences for people.
    """

    workers: int = 1
    dask: str | None = None
    notes: list[str] = field(default_factory=list)

    def note(self, sentence: str) -> None:
        """Say something, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)


def in_halves(
    work: Work[T], cases: Index, error: BaseException, chunks: Chunks, pace: Pace
) -> Iterator[tuple[Index, T]]:
    """Give back what the machine refused to solve at once, for smaller chunks.

    A case alone is yielded as unsolved, and so is all that is left when nothing but refusals has come for a while.
    """
    pace.refused += 1
    why = Unsolved(reason_of(error, ""))
    if len(cases) > 1:
        pace.most = max(len(cases) // 2, 1)
        for half in np.array_split(cases, 2):
            chunks.give_back(half)
    else:
        yield cases, work.lost(cases, why)
    while pace.refused > ATTEMPTS and chunks.left:
        rest = chunks.take(chunks.left)
        yield rest, work.lost(rest, why)
