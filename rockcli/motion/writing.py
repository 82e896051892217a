"""Writing records: files appear whole or not at all, and replace none unless asked."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError

__all__ = ["write_two_columns", "write_whole"]


def write_whole(path: str | Path, text: str, *, force: bool = False) -> None:
    """Write a text file through a neighbour that takes its name only when complete.

    Raises:
        RecordError: the file is there and `force` is not given, or it cannot be written.
    """
    path = Path(path)
    if path.exists() and not force:
        raise RecordError("the file is already there; choose another name, or replace it with --force", path)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8", newline="\n")
        part.replace(path)
    except OSError as error:
        raise RecordError(f"cannot be written: {error.strerror or error}", path) from error
    finally:
        part.unlink(missing_ok=True)


def write_two_columns(
    path: str | Path, values: NDArray[np.float64], dt: float, units: str, title: str, *, force: bool = False
) -> None:
    """Write time [s] and acceleration [units] in two columns, every digit kept; the head states the units."""
    head = f"# {title}\n# time [s], acceleration\n# units: {units}\n"
    rows = (f"{float(f'{i * dt:.12g}')!r} {float(value)!r}\n" for i, value in enumerate(values))
    write_whole(path, head + "".join(rows), force=force)
