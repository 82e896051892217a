"""What a command imports: not Dask, which xarray asks for where it is installed, unless it is told to use it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
from rockcli.cli import main
main.app = lambda: (__import__("xarray").Dataset({"a": ("x", [1.0])}) + 1, print("dask.base" in sys.modules))
main.main()
print(sys.modules.get("dask", "free") is not None)
"""


@pytest.mark.parametrize(("words", "loaded"), [([], "False"), (["--dask=tcp://localhost:1"], "True")])
def test_dask_is_loaded_where_it_is_asked_for(tmp_path: Path, words: list[str], loaded: str) -> None:
    pytest.importorskip("dask")
    done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [loaded, "True"]
