"""Processes forked from this one: they have all it has in memory at once; only Linux forks safely."""

from __future__ import annotations

import contextlib
import mmap
import os
import pickle
import signal
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from rockcli.process_groups import held_back, lead_group, release, signal_group

FORKS = sys.platform == "linux" and hasattr(os, "fork")

OURS = {signal.SIGINT, signal.SIGTERM}
"""Signals that the parent answers for all."""

ALIGNED = 64
"""Places of arrays in an answer are multiples of it [bytes]."""

T = TypeVar("T")
R = TypeVar("R")


def begin_as_child() -> None:
    """What a forked process does first; it is forked with OURS held back."""
    lead_group()  # Ctrl-C in a terminal is for the parent, who ends this group
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.set_wakeup_fd(-1)
    release(OURS)


def shared_out(work: Callable[[T], R], items: Sequence[T], processes: int) -> list[R | None]:
    """What `work` makes of each item, in their order, by this process and `processes` - 1 forked ones.

    None where it raised, or where a process ended too early: who asks again, alone, is told why.  Arrays come back in
    memory that is shared, not copied.
    """
    processes = min(processes, len(items)) if FORKS and hasattr(os, "memfd_create") else 1
    found: list[R | None] = [None] * len(items)
    children: list[tuple[int, int]] = []
    try:
        for k in range(1, processes):
            answer = os.memfd_create("answer")
            try:
                children.append((_forked(work, items[k::processes], answer), answer))
            except OSError:  # no more processes: these items are left
                os.close(answer)
                break
        found[::processes] = [_tried(work, item) for item in items[::processes]]
        for k, (child, answer) in enumerate(children, 1):
            os.waitpid(child, 0)
            children[k - 1] = 0, answer
            with contextlib.suppress(Exception):  # it ended before it was done
                found[k::processes] = _read(answer)
    finally:
        for child, answer in children:
            if child:
                signal_group(child)
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
            os.close(answer)
    return found


def _forked(work: Callable[[T], R], items: Sequence[T], answer: int) -> int:
    with held_back(OURS), warnings.catch_warnings():
        # the only other thread sleeps in a read, and holds no lock
        warnings.filterwarnings("ignore", message=".*multi-threaded.*fork", category=DeprecationWarning)
        child = os.fork()
        if child:
            return child
        try:
            begin_as_child()
            _write(answer, [_tried(work, item) for item in items])
        finally:
            os._exit(0)


def _tried(work: Callable[[T], R], item: T) -> R | None:
    try:
        return work(item)
    except Exception:
        return None


def _write(file: int, found: list[Any]) -> None:
    """Sizes, then what was found with its arrays behind it."""
    buffers: list[memoryview] = []
    body = pickle.dumps(found, protocol=5, buffer_callback=lambda one: buffers.append(one.raw()))
    sizes = pickle.dumps([len(body), *(one.nbytes for one in buffers)])
    with os.fdopen(file, "wb", closefd=False) as stream:
        parts: list[bytes | memoryview] = [sizes, body, *buffers]
        for part in parts:
            stream.write(part)
            stream.write(bytes(-memoryview(part).nbytes % ALIGNED))


def _read(file: int) -> list[Any]:
    memory = memoryview(mmap.mmap(file, 0, access=mmap.ACCESS_COPY))
    sizes = pickle.loads(memory)
    body, *buffers = _parts(memory, len(pickle.dumps(sizes)), sizes)
    return list(pickle.loads(body, buffers=buffers))


def _parts(memory: memoryview, at: int, sizes: list[int]) -> Iterator[memoryview]:
    for size in sizes:
        at += -at % ALIGNED
        yield memory[at : at + size]
        at += size
