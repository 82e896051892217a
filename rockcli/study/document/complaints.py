"""What is wrong with a study, gathered, so that it is told at once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rockcli.errors import RecordError, StudyError

Wrong = StudyError | RecordError

MOST, SHORT = 8, 180
"""Complaints about one study that are told; characters of each but the first."""

TRIES = 64
"""Pieces of a study that may fail while it is searched for more."""


def short(sentence: str) -> str:
    """The beginning of a complaint that is not the first."""
    return sentence if len(sentence) <= SHORT else sentence[: SHORT - 4] + " ..."


@dataclass(eq=False)
class Complaints:
    """Errors as they were met, by file, line and value; `tried`: how many there were, repetitions too."""

    found: dict[tuple[str | None, int | None, str], Wrong] = field(default_factory=dict)
    tried: int = 0

    @property
    def enough(self) -> bool:
        """Whether looking for more is over."""
        return len(self.found) >= MOST or self.tried >= TRIES

    def note(self, error: Wrong) -> None:
        """Keep an error, of every value the first."""
        self.tried += 1
        about = error.message.splitlines()[0].partition(": ")[0]
        self.found.setdefault((error.file, error.line, about), error)

    @contextmanager
    def gathered(self) -> Iterator[None]:
        """Keep the error that what stands below raises, and go on after it."""
        try:
            yield
        except (StudyError, RecordError) as error:
            self.note(error)

    def tell(self, last: type[RecordError] = RecordError) -> None:
        """Raise what was gathered, if anything was: the first in the file at its place, the others a line each below.

        Args:
            last: a kind of error that is told after the others, and raised where all are of it.
        """
        errors = sorted(self.found.values(), key=lambda error: (isinstance(error, last), error.line or 0))
        if not errors:
            return
        first, *others = errors
        if not others:
            raise first
        kind = last if isinstance(first, last) else type(first) if isinstance(first, StudyError) else RecordError
        lines = [f"\n  {_at(error, first)}{short(error.message.splitlines()[0])}" for error in others[: MOST - 1]]
        raise kind(first.message + "".join(lines), file=first.file, line=first.line)


def _at(error: Wrong, first: Wrong) -> str:
    """Where another error stands."""
    if error.file == first.file:
        return "" if error.line is None else f"line {error.line}: "
    return "" if error.file is None else f"{error.file}: " if error.line is None else f"{error.file}:{error.line}: "
