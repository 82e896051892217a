"""Parts of a sweep on disk: arrays and a few words, whole or not there."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.storage.atomic import replacing

_WORDS, _ARRAYS = "words", "arrays"


def write_part(path: Path, arrays: dict[str, NDArray[Any]], words: dict[str, Any]) -> None:
    """Write arrays by name and JSON-like words; the file appears whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    said = words | {_ARRAYS: list(arrays)}
    every: dict[str, Any] = {_WORDS: np.frombuffer(json.dumps(said).encode(), dtype=np.uint8), **arrays}
    with replacing(path) as scratch, scratch.open("wb") as file:
        np.savez(file, **every)


def read_part(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]] | None:
    """Arrays and words of a part; None for a file that is none, or damaged.

    Every array has a checksum; the archive's directory has none, and may lose entries without a word.
    """
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        words = json.loads(arrays.pop(_WORDS).tobytes())
        return (arrays, words) if set(words.pop(_ARRAYS, arrays)) == arrays.keys() else None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    except RuntimeError:  # a directory that speaks of another compression, or of a password
        return None
