"""A Dask cluster that solves chunks; the only module that imports Dask."""

from __future__ import annotations

import logging
import pickle
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from rockcli import version
from rockcli.engine.sweep.chunk_result import cases_of, spans_of
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.memory import keep_freed
from rockcli.engine.sweep.work import Team, Work, in_halves
from rockcli.errors import MACHINE, MachineError, StudyError
from rockcli.study.cases.buildable import Unsolved
from rockcli.study.study import Index

T = TypeVar("T")

ANSWERS_WITHIN = 8.0
"""Time that the scheduler has to answer [s]; with what it takes to load Dask, the ten seconds that are promised."""

LONGEST = 200
"""Characters passed on of what somebody else answers."""

AHEAD = 2
"""Tasks at the scheduler for every thread of a worker."""

CHUNKS = 32
"""Chunks in a task, at most: what a task costs beside its work hardly depends on what it holds."""

ANSWER = 1 << 24
"""Size that the answer of a task may have, unless one chunk's has more [bytes]."""

_turn = threading.Lock()
"""Kernels are loaded by one thread, and a process solves one chunk at a time."""

_unpacked: dict[int, Any] = {}


def check_cluster(address: str) -> None:
    """`StudyError` if a cluster cannot be used: Dask is missing, nobody answers, or workers run another version."""
    with _client(address):
        pass


def on_cluster(work: Work[T], chunks: Chunks, pace: Pace, team: Team) -> Iterator[tuple[Index, T]]:
    """Solve what is left on the cluster `team.dask`; see `executors.answers`.

    A worker that dies costs what it was at, which the scheduler has done again by another one.
    """
    assert team.dask is not None
    with _client(team.dask) as client:
        from distributed.scheduler import KilledWorker

        packed = pickle.dumps(work)
        held = client.submit(_kept, packed, pure=False)  # a task: if who holds it dies, another one makes it again
        taken: dict[Any, tuple[Index, int]] = {}
        size = float(ANSWER)  # of the answer of a case
        threads = max(sum(client.nthreads().values()), 1)

        def submit() -> list[Any]:
            new = []
            while chunks.left and len(taken) < AHEAD * threads:
                chunk = pace.most
                cases = chunks.take(pace.step(chunks.left, threads, int(np.clip(ANSWER / (size * chunk), 1, CHUNKS))))
                future = client.submit(_solve, held, spans_of(cases), chunk, pure=False, retries=0)
                taken[future.key] = cases, chunk
                new.append(future)
            return new

        results = _as_completed(submit(), client)
        for future in results:
            cases, chunk = taken.pop(future.key)
            try:
                answers, refused, seconds = future.result()
            except KilledWorker:
                team.note("worker processes of the cluster died; their cases were solved again")
                if len(cases) == 1:
                    yield cases, work.lost(cases, Unsolved("the solver's process died, on several workers"))
                else:
                    for half in np.array_split(cases, 2):
                        chunks.give_back(half)
            except MACHINE as error:
                yield from in_halves(work, cases, error, chunks, pace)
            except CancelledError:
                raise MachineError(f"--dask {team.dask}: the scheduler cannot be reached any more") from None
            else:
                parts = _in_chunks(cases, chunk)
                if answers:
                    done = sum(map(len, parts[: len(answers)]))
                    size = sum(map(len, answers)) / done
                    pace.learn(done, seconds)
                for part, answer in zip(parts, answers, strict=False):
                    yield part, pickle.loads(answer)
                for untouched in parts[len(answers) + 1 :]:
                    chunks.give_back(untouched)
                if refused is not None:
                    yield from in_halves(work, parts[len(answers)], refused, chunks, pace)
            for new in submit():
                results.add(new)


def _as_completed(futures: list[Any], client: Any) -> Any:
    """Futures as they are done; more may be added."""
    import distributed

    as_completed: Any = distributed.as_completed
    return as_completed(futures, loop=client.loop)


def _kept(packed: bytes) -> bytes:
    return packed


def _in_chunks(cases: Index, most: int) -> list[Index]:
    return [cases[first : first + most] for first in range(0, len(cases), most)]


def _solve(packed: bytes, spans: Index, most: int) -> tuple[list[bytes], Exception | None, float]:
    """On a worker: the answers of a task's chunks, what the machine said to the next one, and the time it took [s].

    Answers travel as bytes, which Dask hands on as they are.
    """
    with _turn:
        key = hash(packed)
        if key not in _unpacked:
            keep_freed()
            _unpacked.clear()
            _unpacked[key] = pickle.loads(packed)
        began = perf_counter()
        answers: list[bytes] = []
        refused = None
        with np.errstate(all="ignore"):
            try:
                for cases in _in_chunks(cases_of(spans), most):
                    answers.append(pickle.dumps(_unpacked[key](cases), pickle.HIGHEST_PROTOCOL))
            except MACHINE as error:
                refused = error
        return answers, refused, perf_counter() - began


def _version() -> str:
    return version.__version__


def _client(address: str) -> Any:
    """A client of a cluster that answers, and whose workers run this version.

    Raises:
        StudyError: see `check_cluster`.
    """
    try:
        import distributed
    except ImportError:
        raise StudyError("--dask needs the packages dask and distributed: pip install 'rockcli[distributed]'") from None
    import asyncio  # 50 ms, which every run would pay

    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # a scheduler that goes is told by our error
    start: Any = distributed.Client
    try:
        secrets = _secrets(address)
    except StudyError:
        raise
    except Exception as error:  # files that are not there, or hold something else
        raise StudyError(f"--dask {address}: the certificates cannot be used: {error}") from None
    try:
        asyncio.run(asyncio.wait_for(_greet(address, secrets), ANSWERS_WITHIN))  # a client would wait for ever
        client = _within(lambda: start(address, timeout=ANSWERS_WITHIN, set_as_default=False))
    except Exception as error:  # whatever somebody there may answer
        said = str(error) or f"nothing within {ANSWERS_WITHIN:g} s"
        raise StudyError(f"--dask {address}: no Dask scheduler answers there ({said[:LONGEST]})") from None
    try:
        found = _within(lambda: client.run(_version))
    except Exception as error:
        client.close()
        why = f"rockcli has to be installed on the workers as it is here ({type(error).__name__}: {error})"
        raise StudyError(f"--dask {address}: {why}") from None
    others = sorted(set(found.values()) - {version.__version__})
    if others or not found:
        client.close()
        why = f"workers run rockcli {', '.join(others)}, not {version.__version__}" if others else "it has no workers"
        raise StudyError(f"--dask {address}: {why}")
    return client


def _secrets(address: str) -> dict[str, Any]:
    """What a connection to a `tls://` address needs, from Dask's own configuration.

    Raises:
        StudyError: nothing is said there; and whatever a certificate raises that cannot be loaded.
    """
    from distributed.security import Security

    load: Any = Security
    secrets: dict[str, Any] = load().get_connection_args("client")
    if address.startswith("tls://") and secrets["ssl_context"] is None:
        keys = "distributed.comm.tls: {ca-file, client: {cert, key}}"
        raise StudyError(f"--dask {address}: tls needs certificates; name them in Dask's configuration ({keys})")
    return secrets


async def _greet(address: str, secrets: dict[str, Any]) -> None:
    """Ask a scheduler who it is."""
    from distributed.core import rpc

    ask: Any = rpc
    async with ask(address, connection_args=secrets) as scheduler:
        await scheduler.identity()


def _within(call: Callable[[], T]) -> T:
    """What a call gives within the time allowed; it is left alone if it takes longer.

    Raises:
        TimeoutError: it takes longer; and what the call raises.
    """
    answer: Future[T] = Future()

    def work() -> None:
        try:
            answer.set_result(call())
        except BaseException as error:
            answer.set_exception(error)

    threading.Thread(target=work, daemon=True).start()
    try:
        return answer.result(ANSWERS_WITHIN)
    except TimeoutError:
        raise TimeoutError(f"no answer within {ANSWERS_WITHIN:g} s") from None
