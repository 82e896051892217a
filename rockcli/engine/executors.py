"""Who solves: this process, processes beside it, or a Dask cluster; all give the same answers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from time import perf_counter
from typing import Protocol, TypeVar

import numpy as np

from rockcli.engine.agenda import Agenda, Pace
from rockcli.engine.apart import ATTEMPTS, Unsolved, reason_of
from rockcli.errors import MACHINE
from rockcli.study.study import Index

T_co = TypeVar("T_co", covariant=True)
T = TypeVar("T")

WORTH = 0.4
"""Estimated time that is left above which processes are started [s]."""

COSTLY = 2.0
"""Time of one case above which not even the first is tried in this process [s]."""

WARM = 2
"""Chunks of this process after which a measured time is no longer that of loading the kernels."""


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


def usable_cores() -> int:
    """Processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def answers(work: Work[T], agenda: Agenda, pace: Pace, team: Team) -> Iterator[tuple[Index, T]]:
    """Yield (cases, answer) until nothing is left, in no particular order.

    Processes are started only when what is left is worth it; the first chunks are solved here, which also compiles
    what the others then have.
    """
    if team.dask is not None and agenda.left:
        from rockcli.engine.cluster import on_cluster

        yield from on_cluster(work, agenda, pace, team)
        return
    while agenda.left:
        if team.workers > 1 and agenda.left > 1 and _worth(agenda, pace):
            from rockcli.engine.workers import on_workers

            yield from on_workers(work, agenda, pace, team)
            continue  # with what is left if no process could be started
        cases = agenda.take(pace.step(agenda.left))
        began = perf_counter()
        try:
            answer = work(cases)
        except MACHINE as error:
            yield from in_halves(work, cases, error, agenda, pace)
            continue
        pace.learn(len(cases), perf_counter() - began)
        yield cases, answer


def in_halves(
    work: Work[T], cases: Index, error: BaseException, agenda: Agenda, pace: Pace
) -> Iterator[tuple[Index, T]]:
    """Give back what the machine refused to solve at once, for smaller chunks.

    A case alone is yielded as unsolved, and so is all that is left when nothing but refusals has come for a while.
    """
    pace.refused += 1
    why = Unsolved(reason_of(error, ""))
    if len(cases) > 1:
        pace.most = max(len(cases) // 2, 1)
        for half in np.array_split(cases, 2):
            agenda.give_back(half)
    else:
        yield cases, work.lost(cases, why)
    while pace.refused > ATTEMPTS and agenda.left:
        rest = agenda.take(agenda.left)
        yield rest, work.lost(rest, why)


def _worth(agenda: Agenda, pace: Pace) -> bool:
    if not pace.measured:
        return pace.seconds_per_case > COSTLY
    left = agenda.left * pace.seconds_per_case
    return left > WORTH * (1.0 if pace.measured >= WARM else 20.0)
