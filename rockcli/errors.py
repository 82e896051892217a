"""The errors a user can meet; each carries the exit code of the command that met it.

A failed case is not an error: it is a `Response` with an outcome and a sentence.
"""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Any


class RockError(Exception):
    """Something the user can mend: what was wrong, where, and what was expected.

    Args:
        message: one sentence or two: what is wrong and what to do.
        file: the file it was found in, if any.
        line: the line in that file, counted from 1, if known.
    """

    exit_code = 4

    def __init__(self, message: str, file: str | Path | None = None, line: int | None = None) -> None:
        self.message = message
        self.file = None if file is None else str(file)
        self.line = line
        super().__init__(str(self))

    def __str__(self) -> str:
        if self.file is None:
            return self.message
        where = self.file if self.line is None else f"{self.file}:{self.line}"
        return f"{where}: {self.message}"


class StudyError(RockError):
    """The study file or the command line is wrong."""

    exit_code = 2


class RecordError(RockError):
    """A ground-motion record is missing, unreadable or not what it should be."""

    exit_code = 2


def path_given(value: Any, kind: type[RockError] = StudyError) -> Path:
    """The argument `path` of a function that Python calls; an error of the `kind` where it is none."""
    try:
        return Path(value)
    except TypeError:
        said = repr(value) if isinstance(value, int | float | None) else f"of type {type(value).__name__}"
        raise kind(f"path is {said}; expected the path of a file, as text or a pathlib.Path") from None


def is_file(path: Path) -> bool:
    """Whether a file stands at a path that was given.

    Raises:
        StudyError: the system does not tell, as where a folder on the way is locked or the name is too long.
    """
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError, ValueError):
        return False
    except OSError as error:
        raise StudyError(f"cannot be read: {error.strerror}", file=path) from None


class SolverError(RockError):
    """A solver was asked for what it cannot do."""

    exit_code = 3


class OutputError(RockError):
    """A result cannot be written: no space, no permission, something in the way."""

    exit_code = 4


class MachineError(RockError):
    """The machine refuses what a solution needs, such as memory: no answer of the case, which is solved again."""

    exit_code = 4


MACHINE = (MachineError, MemoryError, OSError, ImportError)
"""What is raised where the machine refuses: it says nothing about the case."""
