"""A process that crashes, hangs, or writes garbage is one failed case with a sentence, and leaves nothing behind."""

from __future__ import annotations

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from thesis_cases import rigid

from rockcli.errors import MachineError, SolverError
from rockcli.scene.response import FAILED
from rockcli.solvers.common import programs
from rockcli.solvers.opensees import run, solver
from rockcli.solvers.opensees.script import Script, script_of

WRITES = (
    "import json\nopen('case_results.txt', 'w').write({table!r})\nopen('case_summary.json', 'w').write({summary!r})\n"
)


@pytest.fixture(autouse=True)
def own_temporary_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    yield
    assert list(tmp_path.iterdir()) == []


def peer(text: str) -> Script:
    script = script_of(rigid(), 0)
    return replace(script, files={"case.py": text})


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)", "ended by signal SIGSEGV"),
        ("import sys\nsys.exit('no convergence at t = 1 s')", "OpenSees: no convergence at t = 1 s"),
        ("import sys\nsys.exit(7)", "exit code 7 and no message"),
        ("raise RuntimeError('bad\\x1b[31m element')", "RuntimeError: bad.31m element"),
        ("print('all is well')", "without writing its results"),
        (
            "import sys\nprint('WARNING: singular', file=sys.stderr)",
            r"without writing its results \(WARNING: singular\)",
        ),
        ("raise ImportError('libblas.so.3: cannot open shared object file')", "libblas3 liblapack3"),
        (WRITES.format(table="garbage", summary="{}"), "cannot be read"),
        (WRITES.format(table="0 0 0\n1 1 1\n", summary="{}"), "cannot be read"),
        (WRITES.format(table="# nothing\n", summary="{"), "cannot be read"),
        (WRITES.format(table="", summary="{"), "without writing its results"),
        (WRITES.format(table="\xff\xfe", summary="[]"), "cannot be read"),
    ],
)
def test_what_goes_wrong_is_a_sentence(text, sentence):
    with pytest.raises(run.PeerError, match=sentence):
        run.run_script(peer(text))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)", "killed by the system"),
        ("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)", "ended from outside by signal SIGTERM"),
        ("raise OSError(28, 'No space left on device')", "No space left on device"),
        ("raise MemoryError('Unable to allocate 9 GiB')", "MemoryError"),
    ],
)
def test_what_the_machine_refuses_is_no_answer(text, words):
    with pytest.raises(MachineError, match=words):
        run.run_script(peer(text))


@pytest.mark.parametrize("rows", ["0 0 0 0 0 0 0\n1 nan 0 0 0 0 0\n", "0 0 0 0 0 0 0\n0 0 0 0 0 0 0\n", "0 0 0\n"])
def test_a_table_that_is_no_history(rows):
    numbers = dict.fromkeys(run._NUMBERS, 0.0)
    summary = numbers | {"ended": "end", "impacts": [], "t_uplift": None, "rigid_part": [0, 0], "steps": 1}
    text = f"import json\nopen('case_results.txt', 'w').write({rows!r})\n"
    text += f"json.dump({summary | {'divided_steps': 0}!r}, open('case_summary.json', 'w'))\n"
    with pytest.raises(run.PeerError, match="no history of a rocking body"):
        run.run_script(peer(text))


def alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_a_process_that_hangs_is_stopped_with_its_children(tmp_path_factory):
    note = tmp_path_factory.mktemp("note") / "pids"
    text = f"""\
import os, signal, subprocess, sys, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
open({str(note)!r}, "w").write(f"{{os.getpid()}} {{child.pid}}")
time.sleep(600)
"""
    began = time.monotonic()
    with pytest.raises(run.PeerError, match="did not finish within 3 s and was stopped"):
        run.run_script(peer(text), seconds=3.0)
    assert time.monotonic() - began < 60.0
    pids = [int(word) for word in note.read_text().split()]
    assert len(pids) == 2
    for _ in range(100):
        if not any(alive(pid) for pid in pids):
            break
        time.sleep(0.1)
    assert not any(alive(pid) for pid in pids)


def test_time_in_which_all_stands_still_does_not_count(tmp_path_factory, monkeypatch):
    """As that of a job that is suspended, or of a machine that sleeps: the clock then jumps between two looks."""

    class Jumping:
        looks = 0

        def monotonic(self):
            self.looks += 1
            return time.monotonic() + 3600.0 * (self.looks > 2)

    monkeypatch.setattr(programs, "time", Jumping())
    command = [sys.executable, "-c", "import time; time.sleep(0.8)"]
    place = tmp_path_factory.mktemp("place")
    ending = programs.watch(command, place, log=place / "log", limit=60.0)
    assert (ending.code, ending.late) == (0, False)


def test_an_interruption_leaves_nothing(monkeypatch):
    seen = []

    def interrupted(self, timeout=None):
        if not seen:
            seen.append(self.pid)
            raise KeyboardInterrupt
        return original(self, timeout)

    original = programs.subprocess.Popen.wait
    monkeypatch.setattr(programs.subprocess.Popen, "wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run.run_script(peer("import time\ntime.sleep(600)"))
    with pytest.raises(ProcessLookupError):
        os.kill(seen[0], 0)


def test_one_bad_case_does_not_lose_the_batch(monkeypatch):
    monkeypatch.setattr(solver, "require_opensees", lambda: None)
    monkeypatch.setattr(solver, "version_of_opensees", lambda: "none")
    monkeypatch.setattr(solver, "script_of", lambda batch, i, **how: peer("import os\nos.abort()"))
    response = solver.solve(rigid(histories=True))
    assert response.scalars["outcome"][0] == FAILED
    assert "SIGABRT" in response.reasons[0]
    assert response.scalars["n_steps"][0] == -1
    assert np.isnan(response.histories["theta"]).all()


def test_absent_openseespy_is_one_sentence(monkeypatch):
    monkeypatch.setattr(run.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(SolverError, match=r"pip install 'rockcli\[opensees\]'.*libblas3 liblapack3"):
        solver.solve(rigid())


@pytest.fixture
def other_python(tmp_path_factory, monkeypatch):
    """Makes a shell script the interpreter of OpenSees; None names a program that is not there."""

    def make(program: str | None) -> Path:
        path = tmp_path_factory.mktemp("other") / "python"
        if program is not None:
            path.write_text(f"#!/bin/sh\n{program}\n", encoding="utf-8")
            path.chmod(0o755)
        monkeypatch.setenv(run.INTERPRETER, str(path))
        return path

    return make


def test_another_interpreter_runs_the_scripts(other_python):
    other_python(f'echo "of the other" >&2; exec {sys.executable} "$@"')
    with pytest.raises(run.PeerError, match=r"without writing its results \(of the other\)"):
        run.run_script(peer("print('all is well')"))


def test_the_version_is_that_of_the_other_interpreter(other_python):
    other_python("echo 9.9.9")
    assert run.version_of_opensees() == "9.9.9"


@pytest.mark.parametrize(
    ("program", "message"),
    [
        (None, r"ROCK_OPENSEES_PYTHON is '.*python': no such program"),
        ("echo None", r"has no openseespy; install it there: .*python -m pip install openseespy"),
        ("exit 3", "is no Python 3.8 or newer that runs"),
    ],
)
def test_an_interpreter_that_will_not_do_is_one_sentence(program, message, other_python):
    other_python(program)
    with pytest.raises(SolverError, match=message):
        solver.solve(rigid())
