"""Checksum of a dataset, kept among its attributes: shows whether the contents are still those that were written."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np

from rockcli.storage.contents import Contents
from rockcli.storage.on_disk import in_blocks

NAME = "checksum"

FREE = (NAME, "history", "date_created")
"""Attributes that are not summed: dates, and what other programs add to `history`."""

FREE_VALUES = ("wall_time",)
"""Variables whose values differ from run to run."""

_opened: dict[Path, None] = {}


def checksum(contents: Contents) -> str:
    """SHA-256 of all that a dataset says, but for dates and the time it took."""
    total = hashlib.sha256()

    def add(what: Any) -> None:
        total.update(json.dumps(what, sort_keys=True, default=str).encode("utf-8", "surrogatepass"))

    add(list(contents.axes))
    add({name: str(value) for name, value in contents.attrs.items() if name not in FREE})
    for name, item in sorted(contents.fields.items()):
        attrs = {key: np.atleast_1d(value).tolist() for key, value in item.attrs.items()}
        add([name, list(item.dims), list(item.values.shape), item.is_text, attrs])
        if item.is_text:
            add([str(value) for value in item.values.ravel()])
        elif name not in FREE_VALUES:
            for at in in_blocks(item.values):
                total.update(np.ascontiguousarray(item.values[at]).reshape(-1).view(np.uint8).data)
    return total.hexdigest()


def note_opened(path: Path) -> None:
    """Remember that a dataset was read (see `opened`)."""
    _opened[path] = None


def forget_opened() -> None:
    """Begin anew."""
    _opened.clear()


def opened() -> tuple[Path, ...]:
    """The datasets that this process has read."""
    return tuple(_opened)
