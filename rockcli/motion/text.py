"""Records as columns of numbers, without a header or with one line that names time and acceleration.

One column, or more than two: acceleration, line by line, with stated `dt`.  Two columns: time and
acceleration, which a first line may name, as spreadsheets and loggers do: `time [s],acceleration [cm/s2]`; only then
may the time begin anywhere.  Lines that begin with # or % are comments; one that says `# units: g` states the units, as
that of the second name does, `# dt: 0.01` the time step, and `# start: 2010-02-27T06:34:14.000000Z` when the first
sample was taken.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError
from rockcli.motion.motion import start_in
from rockcli.motion.numbers import Numbers, read_numbers
from rockcli.motion.options import OptionError
from rockcli.motion.units import same_unit, unit_named

UNIFORM = 0.05
"""A time column may deviate from equal steps by this part of a step (times are printed with few digits)."""

FEW_DIGITS = 3
DRIFT = 0.01
"""A step is rounded to few digits if the last time moves by less than this part of a step; to more of them only as
far as the times leave open, as 1/120 s is no 0.0083333 s where they are printed with all digits."""

AGREE = 1e-3
"""Relative difference at which a stated dt contradicts the time column."""

ROUGH = 1.3
"""Change from one number to the next over that down a column above which columns read line by line are doubted: of
150 records it is at most .8, of three components side by side 1.9 and more."""

FEW = 20
"""Values up to which one that is as large as their number is an acceleration."""

SEMICOLON = "separate columns by commas or blanks and decimals by a point; a semicolon stands here"

_COMMENT = re.compile(r"\s*[#%]")
_UNITS = re.compile(r"\s*[#%]\s*units\s*[:=]\s*(\S+)", re.I)
_DT = re.compile(r"\s*[#%]\s*dt\s*[:=]\s*(.*?)\s*", re.I)
_SECONDS = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(?:\s*(?:s|sec|seconds?)\b.*|\s*[,;(](?!\d).*)?", re.I)
_HEAD = re.compile(
    r"\s*+\"?\s*+t(?:ime)?(?:\s*+[\[(]\s*+(?:s|sec|seconds)\s*+[\])])?(?:\s*+\")?[^\S\t]*+(?:,|\t\s*+,?+)"
    r"\s*+\"?\s*+(?:a|acc|accel|acceleration|a_g)\.?\s*+(?:[\[(]([^\])]*+)[\])])?\s*+\"?\s*+",
    re.I,
)
"""The names of time, in seconds if it says a unit, and of acceleration, with its unit.

Blanks are not tried again (`*+`): of `time` and a hundred tabs there are millions of ways to share them out.
"""
_CHARACTERS = re.compile(r"[0-9.eEdD+\-,;\s]*", re.ASCII)
_NUMBERED = re.compile(r"\s*[+-]?\d[0-9.eEdD+\-,;\s]*", re.ASCII)
_ONE_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*")
_PAIRS_OF_COMMAS = re.compile(r"\s*[+-]?\d+,\d+(?:,[+-]?\d+,\d+)+,?\s*")
_PADDED = re.compile(r",0\d")
"""In whole numbers with commas between: no whole number is written 05, decimals behind a comma are."""
_BLANK_OF_SAC = re.compile(rb"-12345(?:\.0*)?(?![\d.])")


@dataclass(frozen=True, eq=False)
class Text:
    """Values (k,) in `units`, dt [s], what was made of the file, when it begins, as `Motion.header`, and doubts."""

    values: NDArray[np.float64]
    dt: float
    units: str
    processing: tuple[str, ...]
    header: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def is_numeric_text(data: bytes) -> bool:
    """Whether the file names two columns, or holds nothing but numbers and comments.

    It is no SAC text, whose blanks are -12345.
    """
    lines = [line for line in _lines(data) if line.strip() and not _COMMENT.match(line)]
    if lines and _HEAD.fullmatch(lines[0]):
        return True
    if _BLANK_OF_SAC.search(data, 0, 4096):
        return False
    body = "\n".join(lines)
    return bool(_CHARACTERS.fullmatch(body)) and any(character.isdigit() for character in body)


def first_line_of_words(data: bytes) -> tuple[int, str] | None:
    """Number and text of the first line that is none of numbers, of a text that begins with them; None of another."""
    lines = [(i, line) for i, line in enumerate(_lines(data), 1) if line.strip() and not _COMMENT.match(line)]
    other = next(((i, line) for i, line in lines if not _CHARACTERS.fullmatch(line)), None)
    return other if other is not None and other != lines[0] else None


def first_semicolon(data: bytes) -> int | None:
    """Number of the first line in which a semicolon separates numbers, whatever stands above it; None without one."""
    lines = enumerate(_lines(data), 1)
    return next((number for number, line in lines if ";" in line and _NUMBERED.fullmatch(line)), None)


def parse_text(data: bytes, name: str, units: str | None, dt: float | None) -> Text:
    """The bytes of a file for which `is_numeric_text`, checked.

    Args:
        data: the whole file.
        name: of the file, for messages.
        units: of the acceleration, if stated outside the file.
        dt: time step [s], if stated outside the file.

    Raises:
        RecordError: units or dt missing or contradicted, columns that are not as described above.
    """
    lines = _lines(data)
    unit = _stated_unit(lines, units, name)
    said_dt = _said_dt(lines, dt, name)
    begins = next((said for line in lines if _COMMENT.match(line) and (said := start_in(line))), {})
    plain = _without_commas(lines, name)
    numbers = read_numbers(plain, 1, name)
    if numbers.text_after:
        raise RecordError(f"{numbers.text_after[0]!r} is no line of numbers; remove it or begin it with #", name)
    if not len(numbers.values):
        raise RecordError("no number follows the names of its columns; get the file anew", name)
    places = [number for number, line in enumerate(plain, 1) if line.strip()]
    columns = _columns(numbers, places, name)
    heads = [number for number, line in enumerate(lines, 1) if _HEAD.fullmatch(line)]
    if len(heads) > 1:
        raise RecordError("its columns are named twice; leave this line out", name, heads[1])
    named = bool(heads)
    _refuse_decimal_commas(lines, name)
    if columns != 2 and named:
        raise RecordError(f"its head names two columns, time and acceleration, and it has {columns}", name)
    first = numbers.values[::columns]
    if named:
        _refuse_unequal_steps(first, places, name)
    is_time = columns > 1 and len(first) > 2 and (named or _is_time(first))
    if columns == 2 and len(first) > 2 and not is_time and _is_time(first - first[0]):
        raise RecordError(
            f"the first of two columns grows in equal steps from {first[0]:.10g}, not from zero: if it is time, "
            "say so in a first line, time [s],acceleration [m/s2]",
            name,
        )
    if unit is None:
        raise OptionError(
            "units", _unstated(needs_dt=dt is None and said_dt is None and not (columns == 2 and is_time)), name
        )
    if columns == 2 and is_time:
        step, start = _time_step(first, dt, name)
        if said_dt is not None and abs(said_dt - step) > AGREE * step:
            raise RecordError(f"a comment says dt is {said_dt:g} s, the time column {step:.6g} s; correct it", name)
        step = said_dt if dt is None and said_dt is not None else step
        shifted = () if start == 0.0 else (f"time counted from the first sample, {start:g} s in the file",)
        return Text(numbers.values[1::2], step, unit, shifted, begins or {"first_time": start})
    if columns == 2 and all(_ONE_COMMA.fullmatch(line) for line in lines if line.strip() and not _COMMENT.match(line)):
        raise RecordError("a comma separates columns, and the first is no time: write decimals with a point", name)
    _refuse_table(columns, is_time, name)
    dt = said_dt if dt is None else dt
    if dt is None:
        raise OptionError("dt", "the file does not state the time step; give it with `dt:` in seconds", name)
    if columns == 1:
        _refuse_count(numbers, plain, name)
        return Text(numbers.values, float(dt), unit, (), begins)
    row_major = f"values read line by line, {columns} on each"
    return Text(numbers.values, float(dt), unit, (row_major,), begins, _side_by_side(numbers.values, columns))


def _refuse_decimal_commas(lines: list[str], name: str) -> None:
    """Say of columns such as `0,01,0,0012` that commas stand between them and before decimals."""
    read = [line for line in lines if line.strip() and not _COMMENT.match(line) and not _HEAD.fullmatch(line)]
    if all(map(_PAIRS_OF_COMMAS.fullmatch, read)) and (padded := next(filter(_PADDED.search, read), "")):
        said = f"commas stand before decimals and between columns, {padded.strip()}: write decimals with a point"
        raise RecordError(said, name, lines.index(padded) + 1)


def _refuse_count(numbers: Numbers, lines: list[str], name: str) -> None:
    """Say that the first or second of a column is no acceleration: how many follow, alone or beside the time step."""
    values, n = numbers.values, len(numbers.values)
    if n <= FEW:
        return
    after, before = (0.0 < value < 1.0 for value in (values[1], values[0]))  # a time step
    for at, follow, possible in ((0, n - 1, True), (0, n - 2, after), (1, n - 2, before)):
        if possible and values[at] == follow and numbers.tokens[at] == str(follow):
            line = [number for number, line in enumerate(lines, 1) if line.strip()][at]
            said = f"{follow} is how many values follow: leave out what is none, or begin it with #"
            raise RecordError(said, name, line)


def _side_by_side(values: NDArray[np.float64], columns: int) -> tuple[str, ...]:
    """A sentence where values read line by line are rougher than each column: several motions side by side."""
    with np.errstate(all="ignore"):
        along, down = np.abs(np.diff(values)).sum(), np.abs(values[columns:] - values[:-columns]).sum()
    if len(values) <= 4 * columns or not along > ROUGH * down:
        return ()
    said = f"each of its {columns} columns is smoother than the values read line by line, as of {columns} motions side"
    return (f"{said} by side: if they are, write the one you mean as one column",)


def _lines(data: bytes) -> list[str]:
    """The lines of a text in UTF-8, else in Latin-1, without the mark that spreadsheets put before it."""
    lines = data.removeprefix(b"\xef\xbb\xbf").splitlines()  # those of a `str` also end at U+0085, half an A with ring
    try:
        return [line.decode() for line in lines]
    except UnicodeDecodeError:
        return [line.decode("latin-1") for line in lines]


def _unstated(*, needs_dt: bool) -> str:
    units = "give them with `units:`, one of g, m/s2, cm/s2, gal, mm/s2"
    if needs_dt:
        return f"numbers alone state neither units nor time step: {units}, and the time step with `dt:` in seconds"
    return f"columns of numbers do not state their units: {units}"


def _stated_unit(lines: list[str], given: str | None, name: str) -> str | None:
    """The units the file or its user states; None where nobody does."""
    first: str | None = None
    for number, line in enumerate(lines, 1):
        match = _UNITS.match(line) or _HEAD.fullmatch(line)
        if match is None or match[1] is None:
            continue
        stated = unit_named(match[1])
        if stated is None:
            raise RecordError(f"{match[1]!r} is not a unit of acceleration known here", name, number)
        if given is not None and not same_unit(stated, given):
            message = f"the file says its units are {stated}, `units` says {given}; leave it out"
            raise OptionError("units", message, name, number)
        if first is not None and not same_unit(stated, first):
            raise RecordError(f"the file says its units are {first}, and here {stated}; correct it", name, number)
        first = first or stated
    return first or given


def _said_dt(lines: list[str], given: float | None, name: str) -> float | None:
    """The time step that comments state [s]; None where none does."""
    first: float | None = None
    for number, line in enumerate(lines, 1):
        if (match := _DT.fullmatch(line)) is None:
            continue
        seconds = _SECONDS.fullmatch(match[1])
        if seconds is None or not float(seconds[1]) > 0.0:
            raise RecordError(f"dt is {match[1]!r}; expected the time step in seconds, above zero", name, number)
        said = float(seconds[1])
        if first is not None and said != first:
            raise RecordError(
                f"the file says its time step is {first:g} s, and here {said:g} s; correct it", name, number
            )
        if given is not None and abs(given - said) > 1e-6 * said:
            message = f"the file says its time step is {said:g} s, `dt` says {given:g} s; leave `dt` out"
            raise OptionError("dt", message, name, number)
        first = said
    return first


def _without_commas(lines: list[str], name: str) -> list[str]:
    """The lines with comments emptied and separating commas removed; a decimal comma is refused."""
    plain = []
    for number, line in enumerate(lines, 1):
        if _COMMENT.match(line) or _HEAD.fullmatch(line):
            plain.append("")
            continue
        if ";" in line:
            raise RecordError(SEMICOLON, name, number)
        commas = line.strip().rstrip(",").count(",")
        if commas and commas != len(line.replace(",", " ").split()) - 1:
            raise RecordError("a comma can only separate numbers; write decimals with a point", name, number)
        plain.append(line.replace(",", " "))
    return plain


def _columns(numbers: Numbers, lines: list[int], name: str) -> int:
    """How many numbers stand on each line (the last may hold fewer); lines: where they stand in the file."""
    per_line = numbers.per_line
    columns = int(per_line[0])
    different = np.flatnonzero(per_line[:-1] != columns)
    if len(different) or per_line[-1] > columns or (columns == 2 and per_line[-1] != 2):
        at = int(different[0]) if len(different) else len(per_line) - 1
        raise RecordError(
            f"numbers on this line: {per_line[at]}, on those before: {columns}; the file is damaged, or a table of "
            "another kind",
            name,
            lines[at],
        )
    return columns


def _is_time(column: NDArray[np.float64]) -> bool:
    """Whether it grows in equal steps from zero or from one step."""
    step = (column[-1] - column[0]) / (len(column) - 1)
    if not step > 0.0 or not -0.5 * step < column[0] < 1.5 * step:
        return False
    expected = column[0] + step * np.arange(len(column))
    return bool((np.abs(column - expected) <= UNIFORM * step).all())


def _refuse_unequal_steps(time: NDArray[np.float64], lines: list[int], name: str) -> None:
    """Say where a column that is named time [s] does not grow in equal steps; lines: where its numbers stand."""
    if len(time) < 3 or _is_time(time - time[0]):
        return
    steps = np.diff(time)
    usual = float(np.median(steps))
    if not usual > 0.0:
        at = int(np.argmin(steps > 0.0))
        raise RecordError(
            f"time goes from {time[at]:.10g} to {time[at + 1]:.10g} s here: write samples in order of time",
            name,
            lines[at + 1],
        )
    # times are printed with few digits, which a step may differ by twice; else the step that differs most
    odd = np.append(np.flatnonzero(np.abs(steps - usual) > 2.0 * UNIFORM * abs(usual)), np.abs(steps - usual).argmax())
    at = int(odd[0])
    raise RecordError(
        f"time goes from {time[at]:.10g} to {time[at + 1]:.10g} s here, in other steps by {usual:.6g} s: write "
        "samples in equal steps of time, none left out",
        name,
        lines[at + 1],
    )


def _time_step(time: NDArray[np.float64], stated: float | None, name: str) -> tuple[float, float]:
    """Step, as the file means it (few digits), and the first time [s]."""
    step = float(time[-1] - time[0]) / (len(time) - 1)
    if stated is not None:
        if abs(stated - step) > AGREE * step:
            raise OptionError(
                "dt", f"the time column says dt is {step:.6g} s, `dt` says {stated:g} s; leave it out", name
            )
        return float(stated), float(time[0])
    uneven = np.abs(time - time[0] - step * np.arange(len(time))).max()
    left_open = min(DRIFT * step, 2.0 * uneven + 8.0 * np.spacing(np.abs(time).max()))
    for digits in range(1, 17):
        rounded = float(f"{step:.{digits}g}")
        if abs(rounded - step) * (len(time) - 1) <= (DRIFT * step if digits <= FEW_DIGITS else left_open):
            return rounded, float(time[0])
    return step, float(time[0])


def _refuse_table(columns: int, is_time: bool, name: str) -> None:
    if columns == 2:
        raise RecordError(
            "two columns must be time [s] and acceleration, and the first does not grow in equal steps from zero "
            "(values on both are better written one per line)",
            name,
        )
    if is_time:
        raise RecordError(
            f"the file holds a time column and {columns - 1} others; write the one you mean as two columns, "
            "time [s] and acceleration",
            name,
        )


def two_columns(values: NDArray[np.float64], dt: float, units: str, titles: list[str]) -> str:
    """Time [s] and acceleration [units], every digit kept; the head states the units and the time step."""
    head = "".join(
        f"# {line}\n" for line in [*titles, "time [s], acceleration", f"units: {units}", f"dt: {float(dt)!r}"]
    )
    rows = (f"{float(f'{i * dt:.12g}')!r} {float(value)!r}\n" for i, value in enumerate(values))
    return head + "".join(rows)
