"""The lock of a result folder: one process, or one per share; a lock dies with its process."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rockcli.errors import OutputError, StudyError
from rockcli.storage.places import passing, reason

LOCK_NAME = ".lock"

_OF_SHARE = re.compile(rf"{re.escape(LOCK_NAME)}-\d+-of-\d+")

BUSY = "another process is working in this folder"


@contextmanager
def locked(folder: Path, share: tuple[int, int] | None = None) -> Iterator[None]:
    """Hold the folder's lock (made if it is missing); with a share, beside the other shares.

    Raises:
        StudyError: another process holds the folder, or the same share of it.
        OutputError: the folder cannot be written in.
    """
    path = folder / LOCK_NAME
    if share is None:
        with _held(path, fcntl.LOCK_EX, BUSY), passing(path):
            # removed while held: who opened it meanwhile sees in `_acquire` that it is gone
            for stale in folder.iterdir():  # of shares that were killed; none is at work
                if _OF_SHARE.fullmatch(stale.name):
                    stale.unlink(missing_ok=True)
            yield
        return
    k, n = share
    own = folder / f"{LOCK_NAME}-{k}-of-{n}"
    with _held(path, fcntl.LOCK_SH, BUSY) as common:
        with _held(own, fcntl.LOCK_EX, f"another process is working on share {k}/{n} in this folder"), passing(own):
            yield
        with contextlib.suppress(OSError):  # the last share removes what the shares hold together
            fcntl.flock(common, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink(missing_ok=True)


@contextmanager
def _held(path: Path, kind: int, busy: str) -> Iterator[int]:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = _acquire(path, kind, busy)
    except OSError as error:
        raise OutputError(f"cannot be written in: {reason(error)}", file=path.parent) from error
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def _acquire(path: Path, kind: int, busy: str) -> int:
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
        except OSError:
            os.close(descriptor)
            raise StudyError(busy, file=path.parent) from None
        try:
            if os.stat(path).st_ino == os.fstat(descriptor).st_ino:
                return descriptor
        except FileNotFoundError:
            pass
        os.close(descriptor)
