"""Parts of a sweep on disk: arrays and a few words, whole or not there."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.storage.atomic import replacing

_WORDS = "words"


def write_part(path: Path, arrays: dict[str, NDArray[Any]], words: dict[str, Any]) -> None:
    """Write arrays by name and JSON-like words; the file appears whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    every: dict[str, Any] = {_WORDS: np.frombuffer(json.dumps(words).encode(), dtype=np.uint8), **arrays}
    with replacing(path) as scratch, scratch.open("wb") as file:
        np.savez(file, **every)


def read_part(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]] | None:
    """Arrays and words of a part; None for a file that is none, or damaged (every array has a checksum)."""
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        return arrays, json.loads(arrays.pop(_WORDS).tobytes())
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
