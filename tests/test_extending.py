"""The recipes of docs/extending.md, followed word by word in a copy of the package."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
PYTHON = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.M)
(STUDY,) = re.findall(r"^```yaml\n(.*?)^```", PAGE, re.DOTALL | re.M)

VARIED = """vary:
  case:
    pulse: {motion: {pulse: {shape: haversine, a_p: 1.8*g*tan_alpha, omega_p: 8}}}
    model: {model: linearized_tan}
    backend: {solver: {backend: leapfrog}}
    block: {solver: {backend: event}}
save: {histories: false}
expect:
  - {quantity: theta_peak_over_alpha, min: 0.1}
"""


def put(file: Path, mark: str, text: str, *, before: bool = False) -> None:
    whole = file.read_text(encoding="utf-8")
    assert whole.count(mark) == 1, mark
    file.write_text(whole.replace(mark, text + mark if before else mark + text), encoding="utf-8")


@pytest.mark.slow
def test_the_recipes_work(tmp_path):
    pulse, pulse_row, model, model_row, backend, backend_row, for_tests = PYTHON
    package = tmp_path / "rockcli"
    shutil.copytree(ROOT / "rockcli", package, ignore=shutil.ignore_patterns("__pycache__"))
    put(package / "scene" / "pulses.py", "_ROWS: tuple[Shape, ...] = (\n", pulse_row)
    put(package / "scene" / "pulses.py", "_ROWS: tuple[Shape, ...] = (\n", f"{pulse}\n\n", before=True)
    put(package / "scene" / "models.py", "_ROWS: tuple[Model, ...] = (\n", model_row)
    put(package / "scene" / "models.py", "_ROWS: tuple[Model, ...] = (\n", f"{model}\n\n", before=True)
    (package / "solvers" / "leapfrog.py").write_text(backend, encoding="utf-8")
    put(package / "scene" / "backends.py", "_ROWS: tuple[Backend, ...] = (\n", backend_row)
    shutil.copytree(ROOT / "tests" / "cross", tmp_path / "tests" / "cross")
    for file in ("pyproject.toml", "tests/scenes.py", "tests/tables.py"):
        shutil.copy(ROOT / file, tmp_path / file)
    setting, *tolerances = for_tests.splitlines(keepends=True)
    put(tmp_path / "tests" / "cross" / "test_backends.py", "\nSETTINGS = {\n", setting)
    put(tmp_path / "tests" / "cross" / "test_backends.py", "\nTOLERANCES = {\n", "".join(tolerances))
    (tmp_path / "trial.yaml").write_text(STUDY + VARIED, encoding="utf-8")

    def rock(*words: str) -> str:
        return run("-m", "rockcli", *words)

    def run(*words: str) -> str:
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        done = subprocess.run([sys.executable, *words], cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    assert "1 of 1 met" in rock("run", "trial.yaml", "--no-plots")
    for topic, name in (("pulses", "haversine"), ("models", "linearized_tan"), ("backends", "leapfrog")):
        assert re.search(rf"^{name} ", rock("show", topic), re.M)
    tests = "haversine or leapfrog or linearized_tan or tolerance"
    files = ("tests/cross/test_backends.py", "tests/cross/test_lanes_pulses.py")
    passed = run("-m", "pytest", "-q", "-m", "", "-k", tests, "-p", "no:cacheprovider", *files)
    assert int(re.search(r"(\d+) passed", passed)[1]) >= 9
