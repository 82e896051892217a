"""Runs another program that solves a case: in a folder, watched, limited in time, and ended with all it has started.

What its end says of the case is the solver's to tell; what it says of the machine is told here.
"""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rockcli.errors import MachineError
from rockcli.process_groups import GROUPS, OWN_FAULT, signal_group

_NO_SPACE, _NO_MEMORY = (os.strerror(code) for code in (errno.ENOSPC, errno.ENOMEM))
REFUSALS = (_NO_SPACE, _NO_MEMORY, "MemoryError", "bad_alloc", "error allocating memory")
"""Words of a program that was refused memory or space: the system's, Python's, C++'s and CalculiX's own."""

ALONE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Environment of a program that takes one processor."""

LOOK_EVERY = 0.25
"""Time between two looks at a running process [s]."""

LONGEST = 1.0
"""Time between two looks that counts at most [s]: if it is more, this process was stopped, and the other too."""

GRACE = 2.0
"""Time a process is given to end when asked to, before it is killed [s]."""

WITH_ITS_PARENT = """\
exec 3<&0
"$@" 3<&- </dev/null &
child=$!
(read -r nothing <&3; kill -9 $child) >/dev/null 2>&1 &
guard=$!
wait $child
code=$?
kill -9 $guard 2>/dev/null
exit $code
"""
"""Shell that runs a program and kills it when the other end of its standard input closes: when this process dies."""


@dataclass(frozen=True)
class Ending:
    """How a watched process ended.

    Attributes:
        code: its exit code, 128 + n if it died of signal n; None if it was ended here.
        late: whether its time was up; without a code and not late it had done `enough`.
    """

    code: int | None
    late: bool = False

    @property
    def signal(self) -> str:
        """Name of the signal it died of, "" if of none."""
        number = (self.code or 0) - 128
        try:
            return signal.Signals(number).name if number > 0 else ""
        except ValueError:
            return ""


def watch(
    command: Sequence[str],
    folder: Path,
    *,
    log: Path,
    limit: float,
    printed: bool = True,
    environment: Mapping[str, str] | None = None,
    enough: Callable[[], bool] = lambda: False,
) -> Ending:
    """Run a command in a folder to its end.

    The process has a session of its own: whatever happens, the whole group is gone when this returns, or this process
    dies.

    Args:
        command: the program and its words; folder: where it works.
        log: file for what it complains of, and, if `printed`, for what it prints.
        limit: wall time after which it is ended [s], without that in which all stands still, as a suspended job does.
        environment: beside `ALONE` and that of this process.
        enough: looked at several times per second; True ends the run.  What it raises ends the run and is passed on.
    """
    shell = ["/bin/sh", "-c", WITH_ITS_PARENT, "rock"] if GROUPS else []
    left, looked = limit, time.monotonic()
    with log.open("wb") as said:
        process = subprocess.Popen(
            [*shell, *command],
            cwd=folder,
            env={**os.environ, **ALONE, **(environment or {})},
            stdin=subprocess.PIPE,
            stdout=said if printed else subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
        )
        try:
            while not _ended(process, min(LOOK_EVERY, max(left, 0.0))):
                if enough():
                    return Ending(None)
                now = time.monotonic()
                left, looked = left - min(now - looked, LONGEST), now
                if left <= 0.0:
                    return Ending(None, late=True)
        finally:
            _end_group(process)
    code = process.returncode
    return Ending(code if code >= 0 else 128 - code)


def asked(command: Sequence[str], limit: float) -> tuple[Ending, str]:
    """Ask a program for a few words, as its version: how it ended, and all it printed; `limit`: its time [s]."""
    with tempfile.TemporaryDirectory(prefix="rock-asks-", ignore_cleanup_errors=True) as place:
        said = Path(place, "said.txt")
        ending = watch(command, Path(place), log=said, limit=limit)
        return ending, said.read_text(encoding="utf-8", errors="replace").strip()


def _ended(process: subprocess.Popen[bytes], timeout: float) -> bool:
    try:
        process.wait(timeout)
    except subprocess.TimeoutExpired:
        return False
    return True


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End the process and whatever it has started, where there are process groups."""
    if not GROUPS:
        process.kill()
    else:
        signal_group(process.pid, signal.SIGTERM)
        _ended(process, GRACE)
        signal_group(process.pid)  # itself if it did not hear, and children that outlived it
    process.wait()
    if process.stdin is not None:
        process.stdin.close()


def check_machine(program: str, code: int | None, words: str) -> None:
    """`MachineError` if a process that ended with a code and some last words got no memory or no space, or was ended.

    Nobody here has sent a signal to a process that has ended by then: the system sends SIGKILL where memory has run
    out, a queue SIGTERM to all processes of a job whose time is up.
    """
    if (name := Ending(code).signal) == "SIGKILL":
        raise MachineError(f"{program} was killed by the system, as it does where memory has run out")
    if name and signal.Signals[name] not in OWN_FAULT:
        raise MachineError(f"{program} was ended from outside by signal {name}")
    for refusal in REFUSALS:
        if code and refusal in words:
            raise MachineError(f"{program} ended with {refusal!r}")
