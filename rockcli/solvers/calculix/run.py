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
from rockcli.solvers.common.programs import check_machine

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


WITH_ITS_PARENT = """\
exec 3<&0
"$@" 3<&- </dev/null &
child=$!
(read -r nothing <&3; kill -9 $child) 2>/dev/null &
guard=$!
wait $child
code=$?
kill -9 $guard 2>/dev/null
exit $code
"""
"""Shell that runs a program and kills it when the other end of its standard input closes: when this process dies."""


@dataclass(frozen=True)
class Ending:
    """How a run ended: what went wrong ("" if nothing did), and whether `enough` ended it."""

    complaint: str
    stopped: bool


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
        SolverError: the program is not installed.
        MachineError: it got no memory, or no space for its files.
    """
    command = ["/bin/sh", "-c", WITH_ITS_PARENT, "rock-calculix", program(), "-i", JOB]
    alone = {**os.environ, "OMP_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"}
    began = time.monotonic()
    with (folder / f"{JOB}.log").open("wb") as log:
        process = subprocess.Popen(
            command, cwd=folder, env=alone, stdin=subprocess.PIPE, stdout=log, stderr=log, start_new_session=True
        )
        try:
            while not _ended(process, LOOK_EVERY):
                if enough():
                    return Ending("", stopped=True)
                if time.monotonic() - began > limit:
                    return Ending(f"the time limit of {limit:g} s was reached", stopped=False)
        finally:
            _end_group(process)
    return Ending(_complaint(process.returncode, folder), stopped=False)


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
    if process.stdin is not None:
        process.stdin.close()


def _complaint(code: int | None, folder: Path) -> str:
    """What the program complained of: its own *ERROR, a signal, an exit code; "" if it ended as it should."""
    log = (folder / f"{JOB}.log").read_text(encoding="utf-8", errors="replace")
    check_machine("CalculiX", code, log)
    lines = [line.strip() for line in log.splitlines()]
    for i, line in enumerate(lines):
        if line.startswith("*ERROR"):
            more = [text for text in lines[i + 1 : i + 3] if text and not text.startswith("*")]
            return " ".join([line, *more])[:300]
    if code is not None and (code < 0 or 128 < code < 128 + signal.NSIG):
        number = -code if code < 0 else code - 128  # the shell's way of saying it
        return f"CalculiX died of signal {signal.Signals(number).name}"
    if code:
        last = next((line for line in reversed(lines) if line), "it said nothing")
        return f"CalculiX ended with code {code}: {last[:200]}"
    return ""
