"""The kernels as plain Python, for tests that look into them or spoil them."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from rockcli import kernels


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Plain kernels, those of record lanes too; loaded afresh afterwards."""
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    kernels.forget()
    kernels.load(compile_them=False)
    yield
    kernels.forget()


@contextmanager
def in_plain_lanes() -> Iterator[None]:
    """Have maps under records solved in lanes of plain Python: what only compiled lanes have, written with numpy.

    Fused multiply-adds round twice here, so bits differ from those of compiled lanes.
    """
    for name in ("march", "step", "impacts", "forces", "slips"):
        module = importlib.import_module(f"rockcli.kernels.lanes.records.{name}")
        for word, function in FUSED.items():
            if hasattr(module, word):
                setattr(module, word, function)
    kernels.compiled = True  # they are asked for where kernels are compiled
    with np.errstate(all="ignore"):  # idle lanes divide by zero too
        yield


def _scatter(array: Any, index: Any, value: Any) -> None:
    array[index.astype(np.int64)] = value


FUSED = {
    "fma": lambda a, b, c: a * b + c,
    "gather": lambda array, index: array[index.astype(np.int64)],
    "scatter": _scatter,
    "bits": lambda where: sum(1 << int(lane) for lane in np.flatnonzero(where)),
    "lowest_bit": lambda number: (number & -number).bit_length() - 1,
    "page_the_stack": lambda: None,
}


@contextmanager
def spoilt(name: str, right: str, wrong: str) -> Iterator[ModuleType]:
    """A module in which one passage of its source, which stands there once, is another; for all who use it."""
    module = importlib.import_module(name)
    assert module.__file__ is not None
    source = Path(module.__file__).read_text(encoding="utf-8")
    assert source.count(right) == 1, f"{name}: {right!r} stands there {source.count(right)} times"
    before = dict(vars(module))
    exec(compile(source.replace(right, wrong), module.__file__, "exec"), vars(module))
    new = {id(before[word]): value for word, value in vars(module).items() if callable(before.get(word))}
    taken = []
    for other in [m for n, m in list(sys.modules.items()) if m is not module and n.split(".")[0] in USERS]:
        for word, value in list(vars(other).items()):
            if callable(value) and id(value) in new:
                taken.append((other, word, value))
                setattr(other, word, new[id(value)])
    try:
        yield module
    finally:
        for other, word, value in taken:
            setattr(other, word, value)
        vars(module).clear()
        vars(module).update(before)


USERS = (
    "rockcli",
    "analytic",
    "cli",
    "contact",
    "cross",
    "engine",
    "flexible",
    "frame",
    "general",
    "literature",
    "rolling_cases",
    "swept",
)
"""Packages whose modules hold names of others: the program, and the tests by folder."""
