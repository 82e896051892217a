"""Without what only Linux or Unix have (fcntl, process groups, masked signals, fork): the same results and locks."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest

ELSEWHERE = """\
import os, signal, sys
sys.modules["fcntl"] = None  # an import of it fails
for module, names in (os, ("fork", "setpgid", "killpg")), (signal, ("pthread_sigmask", "pthread_kill")):
    for name in names:
        delattr(module, name)
opened = os.open
def no_folders(path, *how, **more):
    if os.path.isdir(path):
        raise PermissionError(13, "a folder", path)
    return opened(path, *how, **more)
os.open = no_folders
from rockcli.engine.sweep import executors, sweep
executors._worth, sweep.CHUNK = (lambda *_: True), 50  # processes from the beginning, a few cases at a time
if "SLOW" in os.environ:
    import time
    from rockcli.solvers.event import solver
    solve = solver.solve
    solver.solve = lambda batch: (time.sleep(1.0), solve(batch))[1]
from rockcli.cli.main import main
if __name__ == "__main__":
    main()
else:
    open("workers", "a").write("begun ")
"""

SWEEP = """\
name: sweep
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p: 1.0, omega_p: 9.0, cycles: 1}}
  damping: none
vary:
  motion.pulse.a_p_over_g_tan_alpha: {from: 1.0, to: 6.0, n: 40}
  motion.pulse.omega_p_over_p: {from: 1.0, to: 20.0, n: 25}
"""

FIRST = Path(__file__).parents[2] / "studies" / "examples" / "first_rock.yaml"


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    """A `rock` for a machine that has none of it."""
    script = tmp_path / "rock.py"
    script.write_text(ELSEWHERE)
    return script


def start(script: Path, *words: str, slow: bool = False) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, str(script), *words],
        cwd=script.parent,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONWARNINGS": "ignore"} | ({"SLOW": "1"} if slow else {}),
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # tests in the background ignore it
    )


def ended(script: Path, *words: str) -> tuple[int, str, str]:
    process = start(script, *words)
    printed, told = process.communicate(timeout=180.0)
    return process.returncode, printed, told


def same(one: Path, other: Path) -> bool:
    with netCDF4.Dataset(one) as a, netCDF4.Dataset(other) as b:
        numbers = [name for name, v in a.variables.items() if v.dtype is not str and name != "wall_time"]
        assert "theta_peak_over_alpha" in numbers
        return all(np.array_equal(np.ma.getdata(a[n][...]), np.ma.getdata(b[n][...]), equal_nan=True) for n in numbers)


def test_the_first_study_runs(elsewhere: Path) -> None:
    code, _, told = ended(elsewhere, "run", str(FIRST), "--out", "made")
    assert code == 0, told
    assert list((elsewhere.parent / "made").rglob("*.nc"))


def test_a_sweep_has_the_same_results_with_two_workers(elsewhere: Path) -> None:
    study = elsewhere.parent / "sweep.yaml"
    study.write_text(SWEEP)
    here = subprocess.run(
        [sys.executable, "-m", "rockcli", "run", str(study), "--out", "here", "--no-plots"],
        cwd=study.parent,
        timeout=180,
    )
    assert here.returncode == 0
    code, _, told = ended(elsewhere, "run", str(study), "--out", "there", "--no-plots", "--workers", "2")
    assert code == 0, told
    assert (study.parent / "workers").read_text().count("begun") >= 2
    assert same(study.parent / "here/sweep/sweep.nc", study.parent / "there/sweep/sweep.nc")


@pytest.mark.slow
def test_an_interrupted_sweep_keeps_others_out_and_resumes(elsewhere: Path) -> None:
    study = SWEEP.replace("n: 40", "n: 100").replace("n: 25", "n: 80")
    (elsewhere.parent / "sweep.yaml").write_text(study)
    command = ("run", "sweep.yaml", "--out", "there", "--no-plots", "--workers", "2")
    process = start(elsewhere, *command, slow=True)
    parts = elsewhere.parent / "there" / "sweep" / ".parts"
    limit = time.monotonic() + 120.0
    while not (parts.exists() and any(parts.iterdir())) and process.poll() is None and time.monotonic() < limit:
        time.sleep(0.05)
    code, _, told = ended(elsewhere, *command)
    assert code == 2, told
    assert "another process is working in this folder" in told
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=30.0)
    assert process.returncode == 130, told
    kept = [path.name for path in parts.iterdir()]
    assert kept
    code, printed, told = ended(elsewhere, *command)
    assert code == 0, told
    assert re.search(r"kept +[1-9]\d* cases of earlier runs", printed + told)
    assert sorted(path.name for path in parts.parent.iterdir()) == ["sweep.nc"]
