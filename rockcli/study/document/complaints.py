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
    """Errors as they were met, those of one sentence together; `tried`: how many there were, repetitions too."""

    found: dict[tuple[str | None, str], list[Wrong]] = field(default_factory=dict)
    tried: int = 0
    _values: set[tuple[str | None, int | None, str]] = field(default_factory=set)

    @property
    def enough(self) -> bool:
        """Whether looking for more is over."""
        return len(self.found) >= MOST or self.tried >= TRIES

    def note(self, error: Wrong) -> None:
        """Keep an error, of every value at its line the first."""
        self.tried += 1
        sentence = _without_case(error.message.splitlines()[0])
        value = (error.file, error.line, sentence.partition(": ")[0])
        if value not in self._values:
            self._values.add(value)
            self.found.setdefault((error.file, sentence), []).append(error)

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
        alike = [sorted(errors, key=_place) for errors in self.found.values()]
        alike.sort(key=lambda errors: (isinstance(errors[0], last), *_place(errors[0])))
        if not alike:
            return
        (first, *again), *others = alike
        if not again and not others:
            raise first
        kind = last if isinstance(first, last) else type(first) if isinstance(first, StudyError) else RecordError
        sentence, *more = first.message.splitlines()
        lines = [sentence + _also(again), *more]
        for error, *again in others[: MOST - 1]:
            lines.append(f"  {_at(error, first)}{short(error.message.splitlines()[0])}{_also(again)}")
        if len(others) >= MOST:
            lines.append(f"  and {len(others) - MOST + 1} more")
        raise kind("\n".join(lines), file=first.file, line=first.line)


def _place(error: StudyError | RecordError) -> tuple[int, str, int]:
    """Where an error is, in order: by line of the study, then of a table, which is told as `FILE.csv:8`."""
    file, _, row = str(error.file or "").rpartition(":")
    in_table = error.line is None and row.isdigit()
    return error.line or 0, file if in_table else str(error.file or ""), int(row) if in_table else 0


def _without_case(sentence: str) -> str:
    """A sentence without the case in which it was met."""
    return sentence.rpartition(" (at ")[0] or sentence


def _also(errors: list[Wrong]) -> str:
    """The lines at which the same was met again."""
    if not errors:
        return ""
    lines = ", ".join(str(error.line) for error in errors[:MOST])
    return f" (also in line{'s' if len(errors) > 1 else ''} {lines}{', ...' if len(errors) > MOST else ''})"


def _at(error: Wrong, first: Wrong) -> str:
    """Where another error stands."""
    if error.file == first.file:
        return "" if error.line is None else f"line {error.line}: "
    return "" if error.file is None else f"{error.file}: " if error.line is None else f"{error.file}:{error.line}: "
