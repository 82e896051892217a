"""The lock of a result folder: one process, or one per share; a lock dies with its process."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from rockcli.errors import OutputError, StudyError
from rockcli.storage.places import passing, reason

LOCK_NAME = ".lock"

_OF_SHARE = re.compile(rf"{re.escape(LOCK_NAME)}-\d+-of-\d+")

BUSY = "another process is working in this folder"

_MOMENT = 2.0
"""Time within which another share is done with the folder's lock, which it needs only to begin [s]."""


@contextmanager
def locked(folder: Path, share: tuple[int, int] | None = None) -> Iterator[None]:
    """Hold the folder's lock (made if it is missing); with a share, beside the other shares.

    Raises:
        StudyError: another process holds the folder, or the same share of it.
        OutputError: the folder cannot be written in.
    """
    with ExitStack() as held:
        if share is None:
            held.enter_context(_held(folder / LOCK_NAME, BUSY))
            for other in [path for path in folder.iterdir() if _OF_SHARE.fullmatch(path.name)]:
                with _held(other, BUSY):  # of a share that was killed, if none is at work
                    pass
        else:
            k, n = share
            with _held(folder / LOCK_NAME, BUSY, _MOMENT):
                busy = f"another process is working on share {k}/{n} in this folder"
                held.enter_context(_held(folder / f"{LOCK_NAME}-{k}-of-{n}", busy))
        yield


@contextmanager
def _held(path: Path, busy: str, patience: float = 0.0) -> Iterator[None]:
    """Hold one lock; its file is removed before it is released: who opened it meanwhile sees that it is gone."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(path, timeout=patience).acquire()
    except Timeout:
        raise StudyError(busy, file=path.parent) from None
    except OSError as error:
        raise OutputError(f"cannot be written in: {reason(error)}", file=path.parent) from error
    with lock, passing(path):
        yield
