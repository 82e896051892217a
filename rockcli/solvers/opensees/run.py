"""Runs a script in a process of its own, with a time limit, and reads back what it wrote.

OpenSees keeps one model per process, prints at exit, and a mistake in it can end the process: none of this may reach
the program.  The process lives in a temporary folder, which goes with it.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import shutil
import sys
import tempfile
import warnings
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.solvers.common.programs import asked, check_machine, watch
from rockcli.solvers.opensees.script import Script

Array = NDArray[np.float64]

COLUMNS = 7
"""t, theta, theta_dot, u_top, v_top, u_top_bending, M_base."""

INSTALL = (
    "backend opensees needs OpenSeesPy: pip install 'rockcli[opensees]' "
    "(and the system's BLAS and LAPACK; on Debian: apt-get install libblas3 liblapack3)"
)

INTERPRETER = "ROCK_OPENSEES_PYTHON"
"""Another Python for the scripts, a path or a name in PATH: each release of OpenSeesPy fits one Python."""

ASK = (
    "import importlib.util as u, importlib.metadata as m; print(u.find_spec('openseespy') and m.version('openseespy'))"
)

ASK_SECONDS = 60.0
"""Time another Python is given to say so."""

LEAST_SECONDS, SECONDS_PER_STEP = 120.0, 5e-3
"""A process may take LEAST_SECONDS and this much per step: some hundred times what a step costs."""

_NUMBERS = ("t_end", "theta", "theta_dot", "theta_peak", "t_peak", "theta_dot_peak", "u_top_peak", "smallest_step")

_WORDS = 300
"""Letters of a process's last words that are passed on."""


class PeerError(Exception):
    """The process did not give an answer; the sentence says why."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a script wrote: the table (k, COLUMNS), the summary's numbers, the impacts (j, 3)."""

    table: Array
    summary: dict[str, Any]
    impacts: Array


def interpreter() -> str:
    """Path of the Python that runs the scripts: this one, unless ROCK_OPENSEES_PYTHON names another.

    Raises:
        SolverError: the variable names no program.
    """
    named = os.environ.get(INTERPRETER)
    if not named:
        return sys.executable
    found = shutil.which(os.path.expanduser(named))
    if found is None:
        raise SolverError(f"{INTERPRETER} is {named!r}: no such program; expected a Python that has openseespy")
    return os.path.abspath(found)


def version_of_opensees() -> str:
    """Version of OpenSeesPy that the scripts run with; see `require_opensees` for errors."""
    python = interpreter()
    if python != sys.executable:
        return _version_in(python)
    if importlib.util.find_spec("openseespy") is None:
        raise SolverError(f"{INSTALL}, or {INTERPRETER}=PATH of a Python that has it")
    return version("openseespy")


def require_opensees() -> None:
    """Raise `SolverError` with the way to install where OpenSeesPy is absent from the Python that runs the scripts."""
    version_of_opensees()


@cache
def _version_in(python: str) -> str:
    """Version of OpenSeesPy in another Python, which is asked once."""
    ending, answer = asked([python, "-c", ASK], ASK_SECONDS)
    if ending.code or ending.late or not answer:
        words = f" ({answer.splitlines()[-1][:_WORDS]})" if answer else ""
        raise SolverError(
            f"{INTERPRETER}: {python} is no Python 3.8 or newer that runs; expected one with openseespy{words}"
        )
    if answer == "None":
        raise SolverError(
            f"{INTERPRETER}: {python} has no openseespy; install it there: {python} -m pip install openseespy"
        )
    return answer


def run_script(script: Script, *, seconds: float | None = None) -> Answer:
    """Run a script to its end and read its results.

    Args:
        script: as from `script_of`.
        seconds: time limit; default by its number of steps.

    Raises:
        PeerError: it crashed, took too long, or wrote what is no result; with its last words.
        MachineError: it got no memory, or no space for its files.
    """
    if seconds is None:
        seconds = LEAST_SECONDS + SECONDS_PER_STEP * script.case.number("STEPS")
    with tempfile.TemporaryDirectory(prefix="rock-opensees-", ignore_cleanup_errors=True) as place:
        folder = Path(place)
        for name, text in script.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        log = folder / "stderr.txt"
        command = [interpreter(), str(folder / f"{script.name}.py")]
        ending = watch(
            command, folder, log=log, limit=seconds, printed=False, environment={"PYTHONDONTWRITEBYTECODE": "1"}
        )
        words = _last_words(log)
        if ending.late:
            raise PeerError(f"OpenSees did not finish within {seconds:.0f} s and was stopped{_quoted(words)}")
        check_machine("OpenSees", ending.code, words)
        if ending.signal:
            raise PeerError(f"OpenSees was ended by signal {ending.signal}{_quoted(words)}")
        if ending.code:
            if "ImportError" in words or "cannot open shared object" in words:
                raise PeerError(f"OpenSeesPy cannot be loaded{_quoted(words)}: {INSTALL}")
            nothing = f"OpenSees ended with exit code {ending.code} and no message"
            raise PeerError(f"OpenSees: {words}" if words else nothing)
        table, summary = (folder / name for name in script.outputs)
        return _answer(table, summary, words)


def _last_words(file: Path) -> str:
    """The last line of a process's complaints, without the line OpenSees prints at exit."""
    with file.open("rb") as stream:
        stream.seek(max(0, file.stat().st_size - 100_000))
        text = stream.read().decode("utf-8", errors="replace")
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Process 0 Term")]
    words = lines[-1] if lines else ""
    return "".join(letter for letter in words if letter.isprintable())[:_WORDS]


def _quoted(words: str) -> str:
    return f" ({words})" if words else ""


def _answer(table: Path, summary: Path, words: str) -> Answer:
    """Read and check the results.

    Raises:
        PeerError: a file is missing, is no table or summary, or holds what is not finite.
    """
    for file in (table, summary):
        if not file.is_file() or file.stat().st_size == 0:
            raise PeerError(f"OpenSees ended without writing its results{_quoted(words)}")
    try:
        with warnings.catch_warnings(action="error"):  # of an empty table
            rows = np.loadtxt(table, ndmin=2)
        found = json.loads(summary.read_text(encoding="utf-8"))
        impacts = np.array(found["impacts"], dtype=float).reshape(-1, 3)
        numbers = [float(found[name]) for name in _NUMBERS]
        numbers.append(0.0 if found["t_uplift"] is None else float(found["t_uplift"]))
        theta, theta_dot = found["rigid_part"]
        numbers += [float(theta), float(theta_dot)]
        counts = [int(found[name]) for name in ("steps", "divided_steps")]
        ended = found["ended"]
    except (ValueError, KeyError, TypeError, OSError, UserWarning) as error:
        raise PeerError(f"OpenSees wrote results that cannot be read: {_short(error)}") from None
    fits = rows.shape[1] == COLUMNS and bool((np.diff(rows[:, 0]) > 0.0).all()) and rows[0, 0] == 0.0
    finite = bool(np.isfinite(rows).all() and np.isfinite(impacts).all()) and all(map(math.isfinite, numbers))
    if not (fits and finite and ended in ("end", "rest", "overturned") and min(counts) >= 0):
        raise PeerError("OpenSees wrote results that are no history of a rocking body")
    return Answer(rows, found, impacts)


def _short(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"[:_WORDS]
