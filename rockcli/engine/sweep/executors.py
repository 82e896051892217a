"""Executors of a sweep: this process, processes beside it, or a Dask cluster; all give the same answers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from time import perf_counter
from typing import TypeVar

from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.work import Team, Work, in_halves
from rockcli.errors import MACHINE
from rockcli.forks import FORKS
from rockcli.study.study import Index

T = TypeVar("T")

WORTH = 0.4
"""Estimated time that is left above which processes are started [s]."""

WORTH_AT_ONCE = 0.15
"""Estimated time of all above which processes are forked before anything is solved here [s]: one takes 10 to 20 ms."""

TASTE = 4
"""Cases solved in this process before it is forked."""

COSTLY = 2.0
"""Time of one case above which not even the first is tried in this process [s]."""

WARM = 2
"""Chunks of this process after which a measured time is no longer that of loading the kernels."""


def usable_cores() -> int:
    """Processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def answers(work: Work[T], chunks: Chunks, pace: Pace, team: Team) -> Iterator[tuple[Index, T]]:
    """Yield (cases, answer) until nothing is left, in no particular order.

    Processes are started only when what is left is worth it.  The first cases are solved here, which also compiles what
    the others then have; where kernels were compiled ahead of time a few are, so that what is loaded is loaded once.
    """
    if team.dask is not None and chunks.left:
        from rockcli.engine.sweep.cluster import on_cluster

        yield from on_cluster(work, chunks, pace, team)
        return
    loaded = not pace.at_once
    tasted: list[tuple[Index, T]] = []
    while chunks.left:
        shared = team.workers > 1 and chunks.left > 1 and _worth(chunks, pace)
        if shared and loaded:
            from rockcli.engine.sweep.workers import on_workers

            for told in on_workers(work, chunks, pace, team):
                yield told
                while tasted:
                    yield tasted.pop()
            continue  # with what is left if no process could be started
        cases = chunks.take(TASTE if shared else pace.step(chunks.left))
        began = perf_counter()
        try:
            answer = work(cases)
        except MACHINE as error:
            yield from in_halves(work, cases, error, chunks, pace)
            continue
        loaded = True
        if shared:
            tasted.append((cases, answer))  # results are laid out for it, while processes are at work
            continue
        pace.learn(len(cases), perf_counter() - began)
        yield cases, answer
    yield from tasted


def _worth(chunks: Chunks, pace: Pace) -> bool:
    left = chunks.left * pace.seconds_per_case
    if not pace.measured:
        return pace.seconds_per_case > COSTLY or (FORKS and pace.at_once and left > WORTH_AT_ONCE)
    return left > WORTH * (1.0 if pace.measured >= WARM else 20.0)
