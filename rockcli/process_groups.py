"""Process groups and signals that are held back, where the system has them: on Windows a process is ended alone."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Iterator, Set
from contextlib import contextmanager

GROUPS = hasattr(os, "killpg") and hasattr(os, "setpgid")
"""Whether a process can be ended with all it has started."""

OWN_FAULT = {
    getattr(signal, name, None) for name in ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT", "SIGSYS", "SIGTRAP")
}
"""Signals that a process brings upon itself; others come from outside, as SIGKILL where memory has run out."""


def lead_group() -> None:
    """Put this process into a group of its own: what is typed into the terminal is not for it."""
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)


_KILL = signal.Signals(getattr(signal, "SIGKILL", signal.SIGTERM))


def signal_group(leader: int, number: signal.Signals = _KILL) -> None:
    """Send a signal to all processes of a group that are left; 0 is the group of this process."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, number)


def is_running(number: int) -> bool:
    """Whether a process of this number runs; on Windows, where asking would end it, it is taken to."""
    if sys.platform == "win32":
        return True
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):  # another user's; no number of a process
        return True
    return True


@contextmanager
def held_back(numbers: Set[signal.Signals]) -> Iterator[None]:
    """Keep signals waiting; a process that is forked meanwhile has to let them in."""
    if sys.platform == "win32" or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def release(numbers: Set[signal.Signals]) -> None:
    """Let signals in that were held back when this process began."""
    if sys.platform != "win32" and hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, numbers)
