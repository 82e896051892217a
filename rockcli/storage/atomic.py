"""Writing files atomically: each appears whole or not at all."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rockcli.errors import OutputError
from rockcli.process_groups import is_running
from rockcli.storage.places import passing, reason

_MARK = ".part"

_SCRATCH = re.compile(rf"\..+\.\d+{re.escape(_MARK)}\.(nc|npz|png|pdf|svg|gif|mp4|html|csv|xlsx|parquet)")
"""Scratch files of what is written into result folders; other files of such names are somebody's own."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a scratch file beside `path`; on success it takes the place of `path`, on any exception it is removed.

    Its folder is made if it is missing.  Scratch files of the same name whose process is gone are removed.

    Raises:
        OutputError: it cannot be written.
    """
    scratch = path.with_name(f".{path.stem}.{os.getpid()}{_MARK}{path.suffix}")
    with passing(scratch):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _sweep_killed(path)
            yield scratch
            with scratch.open("rb+") as file:
                os.fsync(file.fileno())
            scratch.replace(path)
            _sync_folder(path.parent)
        except OSError as error:
            raise OutputError(f"cannot be written: {reason(error)}", file=path) from error


def write_text(path: Path, text: str) -> None:
    """Write a text file, UTF-8 with the line ends of `text`.

    Raises:
        OutputError: it cannot be written.
    """
    with replacing(path) as scratch:
        scratch.write_text(text, encoding="utf-8", newline="")


def datasets_below(folder: Path) -> list[Path]:
    """The files NAME.nc in a folder and its folders, but for those that are just being written."""
    return sorted(file for file in folder.rglob("*.nc") if not _SCRATCH.fullmatch(file.name))


def sweep_leftovers(folder: Path) -> None:
    """Remove scratch files of killed runs; only for who holds the folder's lock."""
    for scratch in folder.iterdir():
        if _SCRATCH.fullmatch(scratch.name):
            scratch.unlink(missing_ok=True)


def _sweep_killed(path: Path) -> None:
    """Remove what killed writers of one file left; parts of sweeps have their own (`sweep_leftovers`), and are many."""
    begin, end = f".{path.stem}.", f"{_MARK}{path.suffix}"
    if path.suffix == ".npz":
        return
    for name in os.listdir(path.parent):
        if name.startswith(begin) and name.endswith(end):
            number = name[len(begin) : -len(end)]
            if number.isdecimal() and not is_running(int(number)):
                path.with_name(name).unlink(missing_ok=True)


def _sync_folder(folder: Path) -> None:
    """Make the new name itself durable, where a folder can be opened: on Windows none can."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:
        return
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
