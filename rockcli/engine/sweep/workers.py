"""The pool of worker processes on this machine; one that dies costs no more than the chunk it was at.

Why it is not `concurrent.futures`: docs/sweeps.md, "Worker processes".
"""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import pickle
import shutil
import signal
import socket
import tempfile
import threading
import time
import warnings
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from time import perf_counter
from typing import Any, NoReturn, TypeVar

import numpy as np

from rockcli.engine.sweep.chunk_result import cases_of, spans_of
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.work import Team, Work, in_halves
from rockcli.errors import MACHINE
from rockcli.forks import FORKS, OURS, begin_as_child
from rockcli.process_groups import GROUPS, OWN_FAULT, held_back, signal_group
from rockcli.study.cases.buildable import Unsolved
from rockcli.study.study import Index

T = TypeVar("T")

QUICK = 0.5
"""Time of a chunk below which a worker is given the next one before it is done [s]."""

SMALL = 128
"""Runs of cases that fit into a pipe whose other end is not listening: more are sent only to a worker that waits, or
both ends might wait for each other for ever."""

ANSWER = 1 << 20
"""Size of an answer, as a rule less [bytes]."""

MAX_RETRIES = 2
"""Workers that a chunk may cost before it is halved to find the case that kills them."""

MAX_CRASHES = 64
"""Dead workers after which what kills one more is not looked into."""

LOOK_EVERY = 0.5
"""Time between two looks whether the parent is alive [s]."""


@dataclass(eq=False)
class Worker:
    """A process, the pipe to it, and the chunks it was given, the one it is at first."""

    process: Any
    pipe: Connection
    given: deque[Index] = field(default_factory=deque)


def on_workers(work: Work[T], chunks: Chunks, pace: Pace, team: Team) -> Iterator[tuple[Index, T]]:
    """Solve what is left in `team.workers` processes; see `executors.answers`.

    The chunk of a worker that dies is solved again.  If it kills another one it is halved, until the case that does it
    is alone and lost.  What a worker raises is raised here.
    """
    if multiprocessing.current_process().daemon:
        team.note("one process at work, as that of a pool of another program may start no other")
        team.workers = 1
        return
    crew: list[Worker] = []
    place = _scratch()
    killed: dict[int, int] = {}  # lowest case of a chunk -> workers it has cost
    deaths = 0
    try:
        while chunks.left or any(worker.given for worker in crew):
            while chunks.left and len(crew) < min(team.workers, chunks.left + len(crew)):
                try:
                    crew.append(_start(work, [worker.pipe for worker in crew], place))
                except (OSError, MemoryError) as error:
                    team.note(f"{len(crew)} processes at work, as no more can be started: {error}")
                    team.workers = max(len(crew), 1)
                    if not crew:
                        return
                    break
                _feed(crew[-1], chunks, pace, team)
            ready = wait([worker.pipe for worker in crew], timeout=60.0)
            for worker in [worker for worker in crew if worker.pipe in ready]:
                try:
                    kind, value, seconds = worker.pipe.recv()
                except (EOFError, OSError):
                    deaths += 1
                    crew.remove(worker)
                    yield from _after_crash(worker, work, chunks, killed, deaths, team)
                    continue
                if kind == "raised" and not isinstance(value, MACHINE):
                    raise value
                cases = worker.given.popleft()
                if kind == "raised":
                    told = list(in_halves(work, cases, value, chunks, pace))
                else:
                    pace.learn(len(cases), seconds)
                    told = [(cases, value)]
                _feed(worker, chunks, pace, team)
                yield from told
    finally:
        for worker in crew:
            _end(worker)
        if place is not None:
            shutil.rmtree(place, ignore_errors=True)


def _scratch() -> str | None:
    """A folder for what workers put into temporary ones, which a killed worker leaves; None: none can be made."""
    try:
        return tempfile.mkdtemp(prefix="rock-")
    except OSError:
        return None


def _feed(worker: Worker, chunks: Chunks, pace: Pace, team: Team) -> None:
    """Give a worker something to do, and if that will not take long, something to do next."""
    while chunks.left:
        step = pace.step(chunks.left, team.workers)
        if len(worker.given) >= (2 if step * pace.seconds_per_case < QUICK else 1):
            return
        cases = chunks.take(step)
        spans = spans_of(cases)
        if worker.given and len(spans) > SMALL:
            chunks.give_back(cases)
            return
        worker.given.append(cases)
        with contextlib.suppress(OSError):  # it is dead: the next look at its pipe tells
            worker.pipe.send(spans)


def _after_crash(
    worker: Worker, work: Work[T], chunks: Chunks, killed: dict[int, int], deaths: int, team: Team
) -> Iterator[tuple[Index, T]]:
    """Give back what a dead worker had; yield the case that kills every worker as lost."""
    _end(worker)
    how = _death(worker.process.exitcode)
    if not worker.given:
        return
    team.note("a worker process died; its cases were solved again")
    cases = worker.given.popleft()
    for waiting in worker.given:
        chunks.give_back(waiting)
    key = int(cases[0])
    killed[key] = killed.get(key, 0) + 1
    if killed[key] < MAX_RETRIES:
        chunks.give_back(cases)
    elif len(cases) == 1 or deaths > MAX_CRASHES:
        told = f"the solver's process {how}"
        yield cases, work.lost(cases, told if _own_fault(worker.process.exitcode) else Unsolved(told))
    else:
        for half in np.array_split(cases, 2):
            killed[int(half[0])] = MAX_RETRIES - 1
            chunks.give_back(half)


def _death(code: int | None) -> str:
    if code is not None and code < 0:
        return f"died of signal {signal.Signals(-code).name}"
    return f"ended with code {code}"


def _own_fault(code: int | None) -> bool:
    """Whether a process ended by what it did itself; nobody else was asked to kill it, but the system may have to."""
    return code is None or -code in OWN_FAULT or code >= 0


def _start(work: Work[Any], others: list[Connection], place: str | None) -> Worker:
    context: Any = multiprocessing.get_context("fork" if FORKS else "spawn")
    mine, theirs = context.Pipe()
    _widen(theirs)
    foreign = [mine, *others] if FORKS else []
    process = context.Process(target=_serve, args=(theirs, foreign, work, os.getpid(), place), daemon=True)
    with held_back(OURS), warnings.catch_warnings():  # until it no longer has our handlers
        # the only other thread sleeps in a read, and holds no lock
        warnings.filterwarnings("ignore", message=".*multi-threaded.*fork", category=DeprecationWarning)
        process.start()
    theirs.close()
    return Worker(process, mine)


def _widen(pipe: Connection) -> None:
    """Let an answer lie in a pipe whole, as far as the system allows: a worker does not wait until it is read."""
    if FORKS:
        with socket.socket(fileno=os.dup(pipe.fileno())) as end:
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, ANSWER)


def _end(worker: Worker) -> None:
    """End a worker with all it has started."""
    worker.pipe.close()
    signal_group(worker.process.pid)
    worker.process.kill()
    worker.process.join()


def _serve(pipe: Connection, foreign: list[Connection], work: Work[Any], parent: int, place: str | None) -> None:
    """What a worker does: answer one chunk after the other until it is ended."""
    begin_as_child()
    tempfile.tempdir = place
    for other in foreign:
        other.close()
    threading.Thread(target=_end_with, args=(parent, place), daemon=True).start()
    logging.getLogger("rockcli").handlers = []  # the progress line is the parent's
    np.seterr(all="ignore")
    while True:
        try:
            cases = cases_of(pipe.recv())
        except (EOFError, OSError):
            _leave(place)
        began = perf_counter()
        try:
            said: tuple[str, Any, float] = ("solved", work(cases), perf_counter() - began)
        except Exception as error:
            said = ("raised", _portable(error), 0.0)
        try:
            _send(pipe, said)
        except OSError:  # the parent is gone
            _leave(place)


def _send(pipe: Connection, said: tuple[str, Any, float]) -> None:
    """Send an answer, or that there is no memory to send it."""
    try:
        pipe.send(said)
    except MemoryError as error:
        pipe.send(("raised", error, 0.0))


def _portable(error: Exception) -> Exception:
    """The error, or if it cannot travel another one in its words."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def _end_with(parent: int, place: str | None) -> None:
    """End this process when the parent is gone."""
    while os.getppid() == parent:
        time.sleep(LOOK_EVERY)
    _leave(place)


def _leave(place: str | None) -> NoReturn:
    """End this process and all it has started, and remove `place`, which the parent, as it is gone, no longer can."""
    if place is not None:
        shutil.rmtree(place, ignore_errors=True)
    if GROUPS:
        signal_group(0)
    os._exit(1)
