from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rockcli.cli import main as command

Rock = Callable[..., int]


def pytest_collection_finish() -> None:
    """Thousands of tests stay as long as the process does: garbage is not sought among them."""
    gc.freeze()


@pytest.fixture
def rock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Rock:
    """Run `rock ARGS...` in an empty folder and return its exit code."""
    monkeypatch.chdir(tmp_path)

    def run(*args: object) -> int:
        monkeypatch.setattr(sys, "argv", ["rock", *map(str, args)])
        with pytest.raises(SystemExit) as left:
            command.main()
        return int(left.value.code or 0)

    return run
