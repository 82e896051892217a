"""Scripts of benchmarks/ as modules: some are named as modules and folders of the tests are."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

FOLDER = Path(__file__).resolve().parents[1] / "benchmarks"


@contextmanager
def benchmark(name: str) -> Iterator[ModuleType]:
    """A script, imported; it and what it imported of that folder are forgotten afterwards."""
    own = {path.stem for path in FOLDER.glob("*.py")}
    others = {word: sys.modules.pop(word) for word in own & sys.modules.keys()}
    sys.path.insert(0, str(FOLDER))
    try:
        yield importlib.import_module(name)
    finally:
        sys.path.remove(str(FOLDER))
        for word in own:
            sys.modules.pop(word, None)
        sys.modules.update(others)
