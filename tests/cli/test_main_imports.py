"""What a command imports and builds: not Dask, which xarray asks for where it is installed, and no other command."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from rockcli.engine.run import run_study
from rockcli.study.open import open_study

PROGRAM = """
import sys
from rockcli.cli import main
main._asked = lambda: lambda: (__import__("xarray").Dataset({"a": ("x", [1.0])}) + 1, print("dask.base" in sys.modules))
main.main()
print(sys.modules.get("dask", "free") is not None)
"""


@pytest.mark.parametrize(("words", "loaded"), [([], "False"), (["--dask=tcp://localhost:1"], "True")])
def test_dask_is_loaded_where_it_is_asked_for(tmp_path: Path, words: list[str], loaded: str) -> None:
    pytest.importorskip("dask")
    done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [loaded, "True"]


@pytest.mark.parametrize(
    ("words", "built"), [(["run", "a.yaml"], {"run"}), (["records", "info"], {"records"}), (["rum"], None), ([], None)]
)
def test_the_command_that_is_asked_for_is_built_alone(
    monkeypatch: pytest.MonkeyPatch, words: list[str], built: set[str] | None
) -> None:
    from rockcli.cli import main

    monkeypatch.setattr(sys, "argv", ["rock", *words])
    asked = {str(command.name) for command in main._asked().registered_commands}
    assert asked == (built or {str(command.name) for command in main.app.registered_commands})


NEEDLESS = {
    "rockcli.analysis.suites.statistics", "rockcli.engine.sweep.workers", "multiprocessing", "xarray", "pandas",
    "mpl_toolkits.mplot3d",
}  # fmt: skip


STUDIES = Path(__file__).resolve().parents[2] / "studies" / "examples"

FIRST = (STUDIES / "first_rock.yaml").read_text(encoding="utf-8")

MOTION = FIRST.replace("plots: [histories, phase]", "plots: [motion, phase]")
"""With a figure that not every case can be drawn as."""


@pytest.mark.parametrize(
    ("text", "more", "figure"),
    [
        (FIRST, ["--no-plots"], ""),
        (FIRST, [], "first-rock/phase.png"),
        (MOTION, [], "first-rock/motion.png"),
    ],
)
def test_a_plain_study_loads_no_xarray_no_statistics_of_suites_and_no_processes(
    tmp_path: Path, text: str, more: list[str], figure: str
) -> None:
    study = tmp_path / "study.yaml"
    study.write_text(text, encoding="utf-8")
    words = ["run", str(study), "--quiet", "--out", str(tmp_path), *more]
    program = f"""
import sys
from rockcli.cli.main import main
sys.argv = ["rock", *{words!r}]
try:
    main()
except SystemExit:
    pass
print({NEEDLESS!r} & sys.modules.keys())
"""
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["set()"]
    assert not done.stderr
    assert bool(figure) == bool([*tmp_path.glob("*/*.png")])
    assert (tmp_path / figure).exists()


def test_the_page_of_a_map_loads_no_xarray(tmp_path: Path) -> None:
    """As it asks for values, dimensions and single cases alone."""
    study = yaml.safe_load(FIRST) | {"vary": {"motion.pulse.a_p": [1.0, 2.0, 3.0], "block.R": [1.0, 1.5, 2.0]}}
    report = run_study(open_study(study), tmp_path, plots=False)
    program = f"""
import sys
from rockcli.cli.main import main
sys.argv = ["rock", "report", {str(report.file)!r}]
try:
    main()
except SystemExit:
    pass
print({{"xarray", "pandas", "mpl_toolkits.mplot3d"}} & sys.modules.keys())
"""
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("set()\n"), done.stderr
    assert report.file is not None
    assert report.file.with_suffix(".html").is_file()


def test_a_process_of_python_has_matplotlib_whole() -> None:
    """A check of a study's figures, and a figure itself, leave three dimensions and docstrings as they are."""
    program = f"""
import rockcli, yaml
rockcli.plot(rockcli.run(yaml.safe_load({MOTION!r})), "phase")
import matplotlib.pyplot as plt
print(plt.figure().add_subplot(projection="3d").name, "linewidth" in plt.Line2D.set.__doc__)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["3d", "True"]


def test_a_command_draws_whatever_shows_figures_elsewhere(tmp_path: Path) -> None:
    """Notebooks set MPLBACKEND, and pass it on to `!rock run`, which may lack the package that it names."""
    (tmp_path / "a.yaml").write_text(FIRST)
    done = subprocess.run(
        [sys.executable, "-m", "rockcli", "run", "a.yaml"],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "somebody's own"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert len([*tmp_path.rglob("*.png")]) == 2


AT_THE_END = """
import atexit, gc, sys
atexit.register(lambda: print(gc.get_freeze_count() > 10_000))  # called after what is registered later
from rockcli.cli.main import main
main()
"""


def test_nothing_is_left_to_look_through_when_a_command_ends() -> None:
    done = subprocess.run([sys.executable, "-c", AT_THE_END, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == "True"
