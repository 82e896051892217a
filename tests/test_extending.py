"""The recipes of docs/extending.md, followed word by word in a copy of the package."""

from __future__ import annotations

import math
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

P = math.sqrt(0.75 * 9.81 / 2.0)
"""Of the studies' block [rad/s]."""

VARIED = """vary:
  case:
    ratio: {damping: {scheme: damping_ratio, zeta: 0.05}}
    dashpot: {damping: {scheme: dashpot, coefficient: %r}}
    pulse: {motion: {pulse: {shape: haversine, a_p: 1.8*g*tan_alpha, omega_p: 8}}}
    model: {model: linearized_tan}
    backend: {solver: {backend: leapfrog}}
    block: {solver: {backend: event}}
    coarse: {solver: {accuracy: coarse}}
    slides: {block: {mu: 0.15}}
over: case
rules: [velocity]
save: {histories: true}
expect:
  - {quantity: theta_peak_over_alpha, at: {case: block}, min: 0.1}
"""


def put(file: Path, mark: str, text: str, *, before: bool = False) -> None:
    whole = file.read_text(encoding="utf-8")
    assert whole.count(mark) == 1, mark
    file.write_text(whole.replace(mark, text + mark if before else mark + text), encoding="utf-8")


def lengthened(file: Path, columns: str) -> None:
    """One column more at the end of a layout."""
    whole = file.read_text(encoding="utf-8")
    (n,) = re.findall(r" N_OUT,\n\) = range\((\d+)\)", whole)
    longer = whole.replace(" N_OUT,\n", f" {columns}").replace(f"range({n})", f"range({int(n) + 1})")
    file.write_text(longer, encoding="utf-8")


def coefficient(rate: float) -> float:
    """Of the dashpot (3.3) whose c/I_O is `rate`, for the studies' rectangle of R = 2 m and tan(alpha) = 0.2."""
    g, R, alpha = 9.81, 2.0, math.atan(0.2)
    return rate * 4.0 / 3.0 * math.sqrt(R / g) * (0.1 / alpha) ** 2


CHECKED = """
import numpy as np, xarray
(path,) = __import__("pathlib").Path("results").rglob("trial.nc")
data = xarray.open_dataset(path)
peak = data["theta_peak_over_alpha"]
np.testing.assert_allclose(peak.sel(case="ratio"), peak.sel(case="dashpot"), rtol=1e-9)
assert 0.0 < peak.sel(case="ratio") < peak.sel(case="block")
first = data["t_first_impact"].sel(case=["ratio", "block", "model"])
np.testing.assert_array_equal(first, data["t_impact"].isel(impact=0).sel(case=first["case"]))
assert np.isfinite(first).all()
assert 0.0 < abs(peak.sel(case="coarse") - peak.sel(case="block")) < 1e-4
assert data["n_certain"].item() == data.sizes["case"]
pgv, R, alpha = data["pgv"].sel(case="block"), 2.0, np.arctan(0.2)
impulsive = np.sqrt(16.0 / 3.0 * 9.81 * R) * np.sin(0.5 * alpha) / np.cos(alpha)
np.testing.assert_allclose(data["velocity_ratio"].sel(case="block"), pgv / impulsive, rtol=1e-12)
assert np.isnan(data["t_first_impact"].sel(case=["backend", "slides"])).all()
assert data["outcome"].sel(case="slides") == 4
assert 0.0 < data["t_uplift_first"].item() == data["t_uplift"].min()
"""

MAP = """name: map
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p: 1.8*g*tan_alpha, omega_p: 8}}
vary:
  motion.pulse.a_p: [0.25*g, 0.3*g]
  damping: {none: none, dashpot: {scheme: dashpot}, edges: {scheme: edge_dampers, left: %r, right: %r}}
save: {histories: false, scalars: [theta_peak_over_alpha, n_impacts]}
"""

CHECKED_MAP = """
import numpy as np, xarray
(path,) = __import__("pathlib").Path("results").rglob("map.nc")
data = xarray.open_dataset(path)
assert "many bodies in lanes" in data.attrs["solver_settings"]  # those without a damper
peak = data["theta_peak_over_alpha"]
np.testing.assert_allclose(peak.sel(damping="edges"), peak.sel(damping="dashpot"), rtol=1e-9)
assert (abs(peak.sel(damping="none") - peak.sel(damping="edges")) > 1e-3).all()
"""

LIMITED = """name: limited
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p: 1.8*g*tan_alpha, omega_p: 8}}
over: {axis: omega_p, limits: [0.5, {u_top_peak: 0.1}]}
vary:
  motion.pulse.omega_p: [3, 5, 6, 8, 10]
  motion.pulse.a_p: {from: 0.15*g, to: 0.7*g, n: 12}
save: {histories: false, scalars: [outcome, theta_peak_over_alpha, u_top_peak]}
"""

CHECKED_LIMITED = """
import numpy as np, xarray
(path,) = __import__("pathlib").Path("results").rglob("limited.nc")
data = xarray.open_dataset(path)
far = ((data["u_top_peak"] > 0.1) | (data["outcome"] >= 2)).mean("motion_pulse_omega_p")
assert 0.0 == far[0] < far[2] < far[-1] == 1.0
state = data.sel(limit_state="u_top_peak > 0.1 m")
np.testing.assert_array_equal(state["p_exceeded"], far)
assert 0.2 * 9.81 < state["fragility_median"] < data["fragility_median"].sel(limit_state="overturned")
"""


ROWS = dict(re.findall(r"^\| \*?([a-z -]+?)\*? \| (`.*) \|$", (ROOT / "docs" / "building.md").read_text("utf-8"), re.M))
MOST = {"a pulse": 1, "a model of one rotation": 1, "a damping scheme": 4, "a backend": 3, "an output scalar": 3}
MOST |= {"a backend that runs an external program": 4}
MOST |= {
    "a suite statistic": 2,
    "a limit state": 2,
    "a code rule": 1,
    "a level of accuracy": 1,
    "a command": 2,
    "a plot": 3,
}


@pytest.mark.parametrize("change", MOST)
def test_a_change_touches_few_files(change):
    """As many as the page says at most, where it names two ways the longer of them."""
    ways = ROWS[change].split("; one that")
    assert max(len(re.findall(r"`[\w/]+\.py`", way)) for way in ways) <= MOST[change]


def test_the_files_of_the_page_are_there():
    files = {file for row in ROWS.values() for file in re.findall(r"`([\w/]+\.(?:py|toml))`", row)}
    missing = {f for f in files if "NAME" not in f and not (ROOT / "rockcli" / f).exists() and not (ROOT / f).exists()}
    assert len(files) > 25
    assert not missing


def test_every_room_of_the_program_is_in_the_table():
    package = ROOT / "rockcli"
    rooms = {str(init.parent.relative_to(package)) for init in package.glob("*/*/__init__.py")}
    page = (ROOT / "docs" / "building.md").read_text(encoding="utf-8")
    told = set()
    for cell in re.findall(r"^\| (`[^|]*`) \| ", page, re.M):
        first, *more = re.findall(r"`([\w/]+)`", cell) or [""]
        told |= {first, *(f"{first.split('/')[0]}/{name}" for name in more)}
    assert len(rooms) > 20
    assert not rooms - told


@pytest.mark.slow
def test_the_recipes_work(tmp_path):
    pulse, pulse_row, model, model_row, scheme, scheme_row, scheme_name, *rest = PYTHON
    field, dampers, dampers_row, dampers_name, dampers_read, *rest = rest
    scalar_row, scalar_column, scalar_first, scalar_then, level, rule, statistic, statistic_row, *rest = rest
    of_scalar, of_scalar_row, limit_name, limit_key, backend, backend_row, for_tests = rest
    package = tmp_path / "rockcli"
    shutil.copytree(ROOT / "rockcli", package, ignore=shutil.ignore_patterns("__pycache__"))
    put(package / "scene" / "ground" / "pulses.py", "_ROWS: tuple[Shape, ...] = (\n", pulse_row)
    put(package / "scene" / "ground" / "pulses.py", "_ROWS: tuple[Shape, ...] = (\n", f"{pulse}\n\n", before=True)
    put(package / "scene" / "laws" / "models.py", "_ROWS: tuple[Model, ...] = (\n", model_row)
    put(package / "scene" / "laws" / "models.py", "_ROWS: tuple[Model, ...] = (\n", f"{model}\n\n", before=True)
    put(package / "scene" / "laws" / "damping.py", "_ROWS: tuple[Scheme, ...] = (\n", scheme_row)
    put(package / "scene" / "laws" / "damping.py", "_ROWS: tuple[Scheme, ...] = (\n", f"{scheme}\n\n", before=True)
    put(package / "scene" / "backends.py", "_RIGID = frozenset({", f"{scheme_name.strip()} ")
    put(package / "scene" / "laws" / "damping.py", "    alpha_d: Array | None = None\n", field)
    put(package / "scene" / "laws" / "damping.py", "_ROWS: tuple[Scheme, ...] = (\n", dampers_row)
    put(package / "scene" / "laws" / "damping.py", "_ROWS: tuple[Scheme, ...] = (\n", f"{dampers}\n\n", before=True)
    backends = (package / "scene" / "backends.py").read_text(encoding="utf-8")
    assert backends.index("        damping=_RIGID,\n") < backends.index('"frame"')  # the first is that of `event`
    (package / "scene" / "backends.py").write_text(
        backends.replace("        damping=_RIGID,\n", dampers_name, 1), encoding="utf-8"
    )
    put(
        package / "solvers" / "event" / "pack.py",
        "    block, coefficient = batch.block, batch.damping.coefficient\n",
        dampers_read,
        before=True,
    )
    put(package / "scene" / "variables.py", "\n_ROWS: tuple[Variable, ...] = (\n", scalar_row)
    put(package / "scene" / "variables.py", "SCALARS: tuple[str, ...] = (\n", '    "t_first_impact",\n')
    lengthened(package / "kernels" / "rigid" / "results.py", f"{scalar_column.strip()} N_OUT,\n")
    readings = package / "kernels" / "rigid" / "readings.py"
    put(readings, "    out[to.PEAK_ALPHA] = 1.0\n", scalar_first)
    put(readings, "    out[to.N_IMPACTS] += 1\n", scalar_then, before=True)
    put(package / "scene" / "numerics.py", "ACCURACIES: dict[str, Accuracy] = {\n", level)
    put(package / "scene" / "rules.py", "_ROWS: tuple[Rule, ...] = (\n", rule)
    put(
        package / "analysis" / "suites" / "statistics.py",
        "STATISTICS: dict[str, Statistic] = {\n",
        statistic + of_scalar,
    )
    put(package / "scene" / "variables.py", "_SUITE_ROWS: tuple[Variable, ...] = (\n", statistic_row + of_scalar_row)
    put(package / "study" / "cases" / "suite_axes.py", "QUANTITIES = (PEAK, ", f"{limit_name.strip()} ")
    put(
        package / "study" / "schema.py", '    """A limit state of a body that slides: one of the two."""\n\n', limit_key
    )
    (package / "solvers" / "leapfrog.py").write_text(backend, encoding="utf-8")
    put(package / "scene" / "backends.py", "_ROWS: tuple[Backend, ...] = (\n", backend_row)
    shutil.copytree(ROOT / "tests" / "cross", tmp_path / "tests" / "cross")
    for file in ("pyproject.toml", "tests/reference.py", "tests/scenes.py", "tests/tables.py"):
        shutil.copy(ROOT / file, tmp_path / file)
    setting, *tolerances = for_tests.splitlines(keepends=True)
    put(tmp_path / "tests" / "cross" / "test_backends.py", "\nSETTINGS = {\n", setting)
    put(tmp_path / "tests" / "cross" / "test_backends.py", "\nTOLERANCES = {\n", "".join(tolerances))
    (tmp_path / "trial.yaml").write_text(STUDY + VARIED % coefficient(0.1 * P), encoding="utf-8")
    (tmp_path / "limited.yaml").write_text(LIMITED, encoding="utf-8")
    rate = 0.02 / coefficient(1.0)
    (tmp_path / "map.yaml").write_text(MAP % (rate, rate), encoding="utf-8")

    def rock(*words: str) -> str:
        return run("-m", "rockcli", *words)

    def run(*words: str) -> str:
        environment = os.environ | {"PYTHONPATH": str(tmp_path)}
        done = subprocess.run([sys.executable, *words], cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    assert "1 of 1 met" in rock("run", "trial.yaml", "--no-plots")
    run("-c", CHECKED)
    rock("run", "map.yaml", "--no-plots")
    run("-c", CHECKED_MAP)
    rock("run", "limited.yaml", "--no-plots")
    run("-c", CHECKED_LIMITED)
    for topic, name in (
        ("variables", "t_first_impact"),
        ("pulses", "haversine"),
        ("models", "linearized_tan"),
        ("backends", "leapfrog"),
    ):
        assert re.search(rf"^{name} ", rock("show", topic), re.M)
    tests = "haversine or leapfrog or linearized_tan or tolerance"
    files = ("tests/cross/test_backends.py", "tests/cross/test_lanes_pulses.py")
    passed = run("-m", "pytest", "-q", "-m", "", "-k", tests, "-p", "no:cacheprovider", *files)
    assert int(re.search(r"(\d+) passed", passed)[1]) >= 9
