"""A peer process that misbehaves: the case fails with a sentence, nothing is left behind, neither process nor file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest
from mesh_cases import fig60

from rockcli.engine.backends import choose
from rockcli.errors import MachineError, SolverError
from rockcli.scene.backends import BACKENDS
from rockcli.scene.response import FAILED
from rockcli.solvers.calculix import folder, solve
from rockcli.solvers.common import programs


@pytest.fixture
def temp(tmp_path, monkeypatch):
    """A folder for temporary files of its own, so that leftovers are seen."""
    place = tmp_path / "temp"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    monkeypatch.delenv(folder.KEEP, raising=False)
    monkeypatch.delenv(folder.LIMIT, raising=False)
    return place


@pytest.fixture
def pretend(tmp_path, monkeypatch, temp):
    """Put a shell script in the place of CalculiX."""
    programs = tmp_path / "bin"
    programs.mkdir()
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")

    def write(script: str) -> None:
        (programs / "ccx").write_text(
            f'#!/bin/sh\n[ "$1" = -v ] && echo "This is Version 0.{len(script)}" && exit\n{script}\n'
        )
        (programs / "ccx").chmod(0o755)

    return write


def failure() -> str:
    response = solve(fig60(duration=0.5))
    assert response.scalars["outcome"][0] == FAILED
    for name in ("theta_peak", "theta_peak_over_alpha", "t_end", "u_top_peak"):
        assert np.isnan(response.scalars[name][0])
    assert np.isnan(response.histories["theta"]).all()
    return response.reasons[0]


def alive(pid: int) -> bool:
    """Whether a process runs (one that is dead and not yet collected does not)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def gone(pid: int, within: float = 5.0) -> bool:
    end = time.monotonic() + within
    while alive(pid) and time.monotonic() < end:
        time.sleep(0.05)
    return not alive(pid)


MISBEHAVIOUR = {
    "own error": ("echo ' *ERROR: too many cutbacks'; echo ' best solution in the frd file'; exit 201", "too many cutbacks best"),
    "error and success": ("echo '*ERROR in somewhere'; exit 0", "ERROR in somewhere"),
    "crash": ("kill -SEGV $$", "died of signal SIGSEGV"),
    "exit code": ("echo no licence; exit 3", "ended with code 3: no licence"),
    "silence": ("exit 0", "holds no displacements"),
    "garbage": ("echo ' displacements (vx,vy,vz) for set X and time  1.0' > rocking.dat; echo ' 1 2 x y' >> rocking.dat", "cannot be read"),
    "bytes": ("head -c 20000 /dev/urandom > rocking.dat; head -c 20000 /dev/urandom", "CalculiX"),
}  # fmt: skip


@pytest.mark.parametrize("kind", MISBEHAVIOUR)
def test_misbehaviour_is_a_failed_case(pretend, temp, kind):
    script, sentence = MISBEHAVIOUR[kind]
    pretend(script)
    said = failure()
    assert sentence in said
    assert "it reached t = 0 of 0.5 s" in said
    assert list(temp.iterdir()) == []


@pytest.mark.parametrize(
    "script",
    [
        "kill -KILL $$",
        "kill -TERM $$",
        "echo '*ERROR in u_calloc: error allocating memory'; exit 16",
        "echo 'Fortran runtime error: No space left on device'; exit 2",
    ],
)
def test_what_the_machine_refuses_is_no_answer(pretend, temp, script):
    pretend(script)
    with pytest.raises(MachineError, match=r"CalculiX (was killed by the system|was ended from outside|ended with)"):
        failure()
    assert list(temp.iterdir()) == []


def test_a_run_that_ends_early_is_no_result(pretend, temp):
    rows = "\\n".join(f" {n} 0. 0. 0." for n in range(1, 6))
    block = f"\\n displacements (vx,vy,vz) for set WATCHED and time  %s\\n\\n{rows}\\n"
    pretend(f"printf '{block}{block}' 1.0 1.2 > rocking.dat")
    assert "ended early without a message" in failure()


def test_a_hanging_process_and_its_children_are_ended(pretend, temp, tmp_path, monkeypatch):
    monkeypatch.setenv(folder.LIMIT, "1.0")
    note = tmp_path / "pids"
    pretend(f"trap '' TERM; sleep 600 & echo $$ $! > {note}; wait; sleep 600")
    monkeypatch.setattr(programs, "GRACE", 0.2)
    began = time.monotonic()
    assert "time limit of 1 s" in failure()
    assert time.monotonic() - began < 20.0
    assert all(gone(int(pid)) for pid in note.read_text().split())
    assert list(temp.iterdir()) == []


def test_the_process_does_not_outlive_its_parent(pretend, tmp_path):
    note = tmp_path / "pid"
    pretend(f"echo $$ > {note}; exec sleep 600")
    work = tmp_path / "work"
    work.mkdir()
    script = (
        "from pathlib import Path; from rockcli.solvers.calculix.run import run; "
        f"run(Path({str(work)!r}), limit=600.0, enough=lambda: False)"
    )
    parent = subprocess.Popen([sys.executable, "-c", script])
    end = time.monotonic() + 30.0
    while not (note.exists() and note.read_text().strip()) and time.monotonic() < end:
        time.sleep(0.05)
    pid = int(note.read_text())
    assert alive(pid)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    assert gone(pid)


def test_without_calculix_the_message_says_how_to_install_it(tmp_path, monkeypatch, temp):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SolverError, match="apt-get install calculix-ccx"):
        solve(fig60(duration=0.5))


def test_a_limit_that_is_no_number(pretend, monkeypatch):
    pretend("exit 0")
    monkeypatch.setenv(folder.LIMIT, "soon")
    with pytest.raises(SolverError, match="ROCK_CALCULIX_LIMIT must be a number"):
        solve(fig60(duration=0.5))


def test_a_failed_run_is_not_kept(pretend, tmp_path, monkeypatch):
    home = tmp_path / "kept"
    monkeypatch.setenv(folder.KEEP, str(home))
    pretend("echo ' *ERROR: no'; exit 201")
    failure()
    assert list(home.iterdir()) == []


def test_what_a_killed_process_left_is_swept(pretend, tmp_path, monkeypatch):
    home = tmp_path / "kept"
    monkeypatch.setenv(folder.KEEP, str(home))
    pretend("exit 1")
    failure()
    made = []
    original = folder._sweep
    monkeypatch.setattr(folder, "_sweep", lambda home, key: (made.append(key), original(home, key)))
    failure()
    dead = subprocess.Popen(["true"])
    dead.wait()
    (home / f".{made[0]}.{dead.pid}").mkdir()
    failure()
    assert list(home.iterdir()) == []


def test_auto_takes_it_for_the_continuum_only():
    assert choose(fig60(duration=0.5)).name == "calculix"
    assert BACKENDS["calculix"].models == {("continuum", None)}
