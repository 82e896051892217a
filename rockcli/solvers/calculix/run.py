"""Runs CalculiX in a working folder, and tells what it complained of."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

from rockcli.errors import SolverError
from rockcli.solvers.common.programs import Ending, asked, check_machine, watch

PROGRAM = "ccx"

HOW_TO_INSTALL = (
    "backend calculix needs the program CalculiX, and there is no `ccx` in PATH: "
    "on Debian or Ubuntu `apt-get install calculix-ccx`, elsewhere see https://www.calculix.de"
)

JOB = "rocking"
"""Name of the files in the working folder."""

ANSWER = 10.0
"""Time in which CalculiX says which version it is [s]."""


def program() -> str:
    """Path of CalculiX.

    Raises:
        SolverError: it is not installed; the message says how to install it.
    """
    found = shutil.which(PROGRAM)
    if found is None:
        raise SolverError(HOW_TO_INSTALL)
    return found


def version() -> str:
    """What CalculiX says of itself, as "2.20"; "unknown" if it says nothing.

    Raises:
        SolverError: it is not installed.
    """
    return _version_of(program())


@cache
def _version_of(path: str) -> str:
    _, said = asked([path, "-v"], ANSWER)
    found = re.search(r"Version\s+(\S+)", said)
    return found[1] if found else "unknown"


def run(folder: Path, *, limit: float, enough: Callable[[], bool]) -> tuple[str, bool]:
    """Run the deck JOB.inp of `folder` there: what went wrong, "" if nothing did, and whether `enough` ended it.

    Args:
        folder: working folder; everything the program writes stays in it.
        limit: wall time after which the run is ended [s].
        enough: True ends the run as finished; what it raises ends the run and is passed on.

    Raises:
        SolverError: the program is not installed.
        MachineError: it got no memory, or no space for its files.
    """
    ending = watch(
        [program(), "-i", JOB],
        folder,
        log=folder / f"{JOB}.log",
        limit=limit,
        environment={"CCX_NPROC_EQUATION_SOLVER": "1"},
        enough=enough,
    )
    if ending.code is None:
        return f"the time limit of {limit:g} s was reached" * ending.late, not ending.late
    return _complaint(ending, folder), False


def _complaint(ending: Ending, folder: Path) -> str:
    """What the program complained of: its own *ERROR, a signal, an exit code; "" if it ended as it should."""
    log = (folder / f"{JOB}.log").read_text(encoding="utf-8", errors="replace")
    check_machine("CalculiX", ending.code, log)
    lines = [line.strip() for line in log.splitlines()]
    for i, line in enumerate(lines):
        if line.startswith("*ERROR"):
            more = [text for text in lines[i + 1 : i + 3] if text and not text.startswith("*")]
            return " ".join([line, *more])[:300]
    if ending.signal:
        return f"CalculiX died of signal {ending.signal}"
    if ending.code:
        last = next((line for line in reversed(lines) if line), "it said nothing")
        return f"CalculiX ended with code {ending.code}: {last[:200]}"
    return ""
