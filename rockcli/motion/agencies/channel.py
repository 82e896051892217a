"""One component of a strong-motion file, and what the readers of all agencies need."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError
from rockcli.motion.numbers import read_numbers
from rockcli.motion.units import unit_named

Array = NDArray[np.float64]

_NUMERIC = re.compile(r"[\s0-9.eEdD+\-]*[0-9][\s0-9.eEdD+\-]*")

_START = re.compile(r"start time:\s*(\d+/\d+/\d+),?\s+(\d+:[ \d]\d:[ \d.]*\d)\s+UTC", re.I)
_DATES, _TIMES = ("%Y/%m/%d", "%m/%d/%Y", "%m/%d/%y"), ("%H:%M:%S.%f", "%H:%M:%S")
"""As CESMD and as CGS write them, seconds also with blanks for zeros."""


@dataclass(frozen=True, eq=False)
class Channel:
    """One component as its file has it.

    Attributes:
        values: acceleration, (k,), in `units`, a name of `motion.units`.
        dt: time between samples [s].
        component: as the file names it, "" if it does not.
        station: its code or name.
        peak: of |values| as the header states it, in `units`; NaN where it does not.
        header: what else the file says.
    """

    values: Array
    dt: float
    units: str
    component: str
    station: str = ""
    peak: float = math.nan
    header: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Format:
    """A format: its name, whether the first lines of a file are its own, and its reader.

    `parse(lines, name of the file)` gives the components and raises RecordError, naming the line.
    """

    name: str
    recognises: Callable[[list[str]], bool]
    parse: Callable[[list[str], str], list[Channel]]


def begun(text: str, *forms: str) -> dict[str, str]:
    """When the first sample was taken, as `start` of a header; {} for what is in none of the forms of `strptime`."""
    for form in forms:
        with suppress(ValueError):
            moment = datetime.strptime(text.strip(), form)
            aware = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
            return {"start": aware.astimezone(UTC).isoformat()}
    return {}


def start_time(header: list[str]) -> dict[str, str]:
    """What the line `Start time:  8/24/14, 10:20:33.0 UTC` of a COSMOS or CSMIP file says, as `begun` does."""
    said = next((f"{m[1]} {m[2].replace(' ', '0')}" for line in header if (m := _START.search(line))), "")
    return begun(said, *(f"{date} {time}" for date in _DATES for time in _TIMES))


def counted(lines: list[str], first: int, count: int, name: str, times: int = 1) -> tuple[Array, int]:
    """The `count` numbers from a line on, the first of `times` series that follow each other, and the line behind.

    Raises:
        RecordError: fewer or more numbers than announced.
    """
    end = first
    while end < len(lines) and (not lines[end].strip() or _NUMERIC.fullmatch(lines[end])):
        end += 1
    values = read_numbers(lines[first:end], first + 1, name).values
    if len(values) != count * times:
        message = (
            f"the header announces {count * times} values and {len(values)} follow: the file is damaged; get it anew"
        )
        raise RecordError(message, name, first + 1)
    return values[:count], end


def alone(lines: list[str], end: int, name: str) -> None:
    """Make sure that no numbers stand behind the only component of a file, as those of a second record would.

    Raises:
        RecordError: they do.
    """
    for number, line in enumerate(lines[end:], end + 1):
        if line.strip() and _NUMERIC.fullmatch(line):
            message = "numbers follow behind the only component of the file: write a second record as a file of its own"
            raise RecordError(message, name, number)


def sought(pattern: str, line: str, what: str, name: str, number: int) -> re.Match[str]:
    """What a pattern finds on a line; `RecordError`, which expects `what`, where it finds nothing."""
    match = re.search(pattern, line, re.I)
    if match is None:
        raise RecordError(f"expected {what}, not {line.strip()[:60]!r}", name, number)
    return match


def unit_of(words: str, name: str, number: int) -> str:
    """The unit of acceleration that the file states; `RecordError` for one that is not known."""
    unit = unit_named(words.strip(" ()."))
    if unit is None:
        raise RecordError(f"the values are in {words.strip()!r}, not a unit of acceleration known here", name, number)
    return unit


def number_in(text: str) -> float:
    """The number at the beginning of a text, NaN where there is none."""
    match = re.match(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)", text)
    return float(match[1]) if match else math.nan


def decimal(text: str, what: str, name: str, number: int) -> float:
    """A number, which the text is as a whole, else `RecordError`."""
    if not re.fullmatch(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?", text, re.ASCII):
        raise RecordError(f"{what} is {text!r}; expected a number", name, number)
    return float(re.sub("[dD]", "E", text))


def whole(text: str, what: str, name: str, number: int) -> int:
    """A number of values, two or more, else `RecordError`."""
    if not re.fullmatch(r"\s*\d{1,9}\s*", text) or int(text) < 2:
        raise RecordError(f"{what} is {text.strip()!r}; expected two or more", name, number)
    return int(text)


def step(value: float, name: str, number: int) -> float:
    """A time step [s], above zero, else `RecordError`."""
    if not 0.0 < value < math.inf:
        raise RecordError(f"the time step is {value:g} s; expected seconds, above zero", name, number)
    return value
