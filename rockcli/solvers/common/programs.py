"""Other programs that solve: when their end is the machine's doing, and says nothing about the case."""

from __future__ import annotations

import errno
import os
import signal

from rockcli.errors import MachineError

_NO_SPACE, _NO_MEMORY = (os.strerror(code) for code in (errno.ENOSPC, errno.ENOMEM))
REFUSALS = (_NO_SPACE, _NO_MEMORY, "MemoryError", "bad_alloc", "error allocating memory")
"""Words of a program that was refused memory or space: the system's, Python's, C++'s and CalculiX's own."""


def check_machine(program: str, code: int | None, words: str) -> None:
    """`MachineError` if a process that ended with a code and some last words got no memory or no space.

    Nobody here has sent SIGKILL to a process that has ended by then: the system does where memory has run out.
    """
    if code in (-signal.SIGKILL, 128 + signal.SIGKILL):  # the latter is a shell's way of saying it
        raise MachineError(f"{program} was killed by the system, as it does where memory has run out")
    for refusal in REFUSALS:
        if code and refusal in words:
            raise MachineError(f"{program} ended with {refusal!r}")
