"""Runs CalculiX in a working folder: watched, limited in time, and ended with all it started."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rockcli.errors import SolverError

PROGRAM = "ccx"

HOW_TO_INSTALL = (
    "backend calculix needs the program CalculiX, and there is no `ccx` in PATH: "
    "on Debian or Ubuntu `apt-get install calculix-ccx`, elsewhere see https://www.calculix.de"
)

LOOK_EVERY = 0.25
"""Time between two looks at a running process [s]."""

GRACE = 2.0
"""Time a process is given to end when asked to, before it is killed [s]."""

JOB = "rocking"
"""Name of the files in the working folder."""


@dataclass(frozen=True)
class Ending:
    """How a run ended.

    Attributes:
        complaint: what went wrong, "" if nothing did.
        stopped: whether it was ended because `enough` said so.
        cpu: processor time of the process [s].
    """

    complaint: str
    stopped: bool
    cpu: float


def program() -> str:
    """Path of CalculiX.

    Raises:
        SolverError: it is not installed; the message says how to install it.
    """
    found = shutil.which(PROGRAM)
    if found is None:
        raise SolverError(HOW_TO_INSTALL)
    return found


def run(folder: Path, *, limit: float, enough: Callable[[], bool]) -> Ending:
    """Run the deck JOB.inp of `folder` there.

    Args:
        folder: working folder; everything the program writes stays in it.
        limit: wall time after which the run is ended [s].
        enough: looked at several times per second; True ends the run. What it raises ends the run and is passed on.

    The process has a session of its own: whatever happens, the whole group is gone when this returns.

    Raises:
        SolverError: the program is not installed or cannot be started.
    """
    command = [program(), "-i", JOB]
    alone = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    began = time.monotonic()
    with (folder / f"{JOB}.log").open("wb") as log:
        try:
            process = subprocess.Popen(
                command, cwd=folder, env=alone, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
            )
        except OSError as error:
            raise SolverError(f"CalculiX cannot be started: {command[0]}: {error.strerror}") from None
        cpu, stopped, late = 0.0, False, False
        try:
            while not _ended(process, LOOK_EVERY):
                cpu = _cpu_seconds(process.pid, cpu)
                if enough():
                    stopped = True
                    break
                if time.monotonic() - began > limit:
                    late = True
                    break
        finally:
            _end_group(process)
    if late:
        return Ending(f"the time limit of {limit:g} s was reached", stopped, cpu)
    return Ending("" if stopped else _complaint(process.returncode, folder), stopped, cpu)


def _ended(process: subprocess.Popen[bytes], timeout: float) -> bool:
    try:
        process.wait(timeout)
    except subprocess.TimeoutExpired:
        return False
    return True


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End the process and whatever it has started, by its process group."""
    for sign in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, sign)
        if _ended(process, GRACE):
            break
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)  # children that outlived it
    process.wait()


def _cpu_seconds(pid: int, before: float) -> float:
    """Processor time of a process [s], or what was known before where the system does not say."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return max(before, (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK"))
    except (OSError, ValueError, IndexError):
        return before


def _complaint(code: int | None, folder: Path) -> str:
    """What the program complained of: its own *ERROR, a signal, an exit code; "" if it ended as it should."""
    log = (folder / f"{JOB}.log").read_text(encoding="utf-8", errors="replace")
    lines = [line.strip() for line in log.splitlines()]
    for i, line in enumerate(lines):
        if line.startswith("*ERROR"):
            more = [text for text in lines[i + 1 : i + 3] if text and not text.startswith("*")]
            return " ".join([line, *more])[:300]
    if code is not None and code < 0:
        return f"CalculiX died of signal {signal.Signals(-code).name}"
    if code:
        last = next((line for line in reversed(lines) if line), "it said nothing")
        return f"CalculiX ended with code {code}: {last[:200]}"
    return ""
