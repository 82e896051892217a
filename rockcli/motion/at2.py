"""AT2: the text format of the PEER strong-motion databases, as an ObsPy waveform plug-in.

A few lines of title, one that states quantity and units ("ACCELERATION TIME SERIES IN UNITS OF G"), one with
the number of values and the time step ("NPTS=   4000, DT=   .0050 SEC"), then the values.  Every generation
of the database and every program that wrote the format has its own manner; all that state the three things
needed (how many values, how often, in which units) are read, all others are refused with the reason.

`obspy.read` finds `is_at2` and `read_at2` by entry point.  They are called with whatever file the user gives,
so this module imports ObsPy only when it hands a Stream back.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rockcli.errors import RecordError
from rockcli.motion.file import record_bytes
from rockcli.motion.motion import start_in
from rockcli.motion.numbers import Numbers, read_text
from rockcli.motion.options import OptionError
from rockcli.motion.units import same_unit, unit_named

if TYPE_CHECKING:
    from obspy import Stream

HEADER_LINES = 60
"""NPTS and DT are sought on so many lines at most."""

MARK = b"\xef\xbb\xbf"
"""What editors put before a text in UTF-8."""

UNKNOWN = ("event not stated", "station not stated")
"""What stands in a title in place of an event and a station that are not known."""

PAIRED = 0.1
"""Numbers of which every other one grows by DT, to this part of it, are times and accelerations."""

_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"
_KEYED = re.compile(r"\bNPTS\b\s*[=:]?\s*(?P<npts>[^\s,]*).*?\bDT\b\s*[=:]?\s*(?P<dt>[^\s,]*)(?P<rest>.*)", re.I)
_TRAILING = re.compile(rf"^\s*(?P<npts>\d+)\s*,?\s+(?P<dt>{_DECIMAL})\s*,?\s*NPTS\s*,?\s*DT\b(?P<rest>.*)", re.I)
_UNITS = re.compile(
    r"\b(?:IN\s+UNITS?\s+OF|UNITS?\s+(?:ARE|IS|OF)|UNITS?\s*[:=]|ACC\w*\.?\s+IN)\s*[(\[]?\s*(?P<unit>[A-Z][A-Z0-9/*^]*)",
    re.I,
)
_QUANTITY = re.compile(r"\b(ACCELERATION|VELOCITY|DISPLACEMENT)\b", re.I)
_SERIES = re.compile(r"\b(?:ACCELERATION|VELOCITY|DISPLACEMENT) TIME (?:HISTORY|SERIES) IN UNITS? OF\b", re.I)
_COUNTS = re.compile(r"\bNPTS\b\s*[=:]?\s*(\d+)(?:\s*,?\s+(\d+)(?=\s*,?\s*DT\b))?", re.I)
_STEPS = re.compile(rf"\bDT\b\s*[=:]?\s*({_DECIMAL})(?:\s*,?\s+({_DECIMAL})\b(?!\s*POLE))?", re.I)
"""A number of values and a time step, and a second one behind it."""
_MILLI = re.compile(r"\s*,?\s*(?:MSEC|MS|MILLI\w*)\b", re.I)
_RATE = re.compile(r"\s*,?\s*(?:HZ|SPS)\b", re.I)
_DATE = re.compile(r"\b\d{1,2}/\d{1,2}/\d{2,4}\b")


@dataclass(frozen=True, eq=False)
class AT2:
    """What an AT2 file says.

    Attributes:
        values: as printed, (npts,), in `units`.
        dt: time step [s].
        units: `g`, or the unit the header or the caller states.
        titles: the header's lines before the one with NPTS and DT, stripped.
        event, date, station, component: read from the title line, empty where it is not in the usual form.
        warnings: what was tolerated.
    """

    values: NDArray[np.float64]
    dt: float
    units: str
    titles: tuple[str, ...]
    event: str
    date: str
    station: str
    component: str
    warnings: tuple[str, ...]


def is_at2(filename: Any) -> bool:
    """Whether this is meant to be an AT2 file (ObsPy's `isFormat`); never raises.

    True also for the databases' velocity and displacement files, so that reading them says what they are.
    """
    try:
        if hasattr(filename, "read"):
            return looks_like_at2(filename.read(8192))
        with open(filename, "rb") as file:
            return looks_like_at2(file.read(8192))
    except Exception:
        return False


def looks_like_at2(data: bytes) -> bool:
    """Whether the beginning of a file is an AT2 header."""
    head = data[:8192].removeprefix(MARK)
    if b"\0" in head:
        return False
    lines = _lines(head)[:HEADER_LINES]
    named = any(_SERIES.search(line) for line in lines[:4])
    return named or any(_KEYED.search(line) or _TRAILING.search(line) for line in lines)


def read_at2(filename: Any, **kwargs: Any) -> Stream:
    """An AT2 file as a Stream of one Trace (ObsPy's `readFormat`); the data stay in g, float64.

    `stats.at2` holds title, units, quantity, event, date, station, component and warnings; station and
    channel are also set in `stats`, the start time where a title states it, else ObsPy's zero.  Of ObsPy's options,
    `headonly` is heeded.

    Raises:
        RecordError: see `parse_at2`; also if the file is in other units than g.
    """
    from obspy import Stream, Trace, UTCDateTime
    from obspy.core import AttribDict

    name = str(getattr(filename, "name", "record")) if hasattr(filename, "read") else str(filename)
    record = parse_at2(_bytes(filename), name)
    if record.units != "g":
        raise RecordError(f"the values are in {record.units}, not in g; read the file with rockcli, not ObsPy", name)
    trace = Trace(data=np.array([]) if kwargs.get("headonly") else record.values)
    trace.stats.delta = record.dt
    if kwargs.get("headonly"):
        trace.stats.npts = len(record.values)
    if (start := start_in(" ".join(record.titles)).get("start")) is not None:
        trace.stats.starttime = UTCDateTime(start)
    trace.stats.station = record.station
    trace.stats.channel = record.component
    trace.stats.at2 = AttribDict(
        title=list(record.titles),
        units=record.units,
        quantity="acceleration",
        event=record.event,
        date=record.date,
        station=record.station,
        component=record.component,
        warnings=list(record.warnings),
    )
    return Stream([trace])


def parse_at2(data: bytes, name: str, units: str | None = None) -> AT2:
    """The bytes of an AT2 file, checked.

    Args:
        data: the whole file.
        name: of the file, for messages.
        units: of the values, for a file without a line that says so; must agree with a line that does.

    Raises:
        RecordError: with file, line and remedy: empty or binary, no line with NPTS and DT, no units, not an
            acceleration, dt or NPTS not positive, units, dt or NPTS stated twice and not the same, times among
            the values, fewer or more values than NPTS (zeros at the end are tolerated with a warning), a number
            cut by the end of the file, a word among the values.
    """
    text = _with_line_feeds(_checked_text_bytes(data, name))
    lines, match, body = _header(text, name)
    index = len(lines)
    npts, dt = _npts(match, name, index + 1), _dt(match, name, index + 1)
    _refuse_second("NPTS", _COUNTS, match.string, npts, name, index + 1)
    _refuse_second("DT", _STEPS, match.string, dt, name, index + 1)
    stated = _stated_unit([*lines, match.string], match["rest"], name)
    numbers = read_text(text[body:], index + 2, name, expected=npts)
    values, warnings = _counted(numbers, npts, data, name)
    if len(values) > 6 and (np.abs(np.diff(values[::2]) - dt) < PAIRED * dt).all():
        said = "every other number is a time: write the accelerations alone, with their number as NPTS"
        raise RecordError(said, name, index + 2)
    unit = _unit(stated, units, name, index + 1)
    titles = tuple(line.strip() for line in lines)
    event, date, station, component = _identity(titles)
    return AT2(values, dt, unit, titles, event, date, station, component, tuple(warnings))


def at2_text(values_in_g: ArrayLike, dt: float, title_lines: Sequence[str], name: str | Path | None = None) -> str:
    """The text of an AT2 file, five values per line with eight digits.

    Args:
        values_in_g: acceleration in g, (k,), k >= 2, finite.
        dt: time step [s].
        title_lines: one or more lines of header; the second one by custom "event, date, station, component".
        name: of the file, for messages.

    Raises:
        RecordError: the values are not finite, or a title line cannot stand in a header.
    """
    values = np.asarray(values_in_g, dtype=float) + 0.0  # -0 becomes 0
    if values.ndim != 1 or len(values) < 2 or not np.isfinite(values).all() or not 0.0 < dt < np.inf:
        raise RecordError("an AT2 file holds two or more finite values and a time step above zero", name)
    for line in title_lines:
        misread = _KEYED.search(line) or _TRAILING.search(line) or _UNITS.search(line)
        if misread or not line.isprintable():
            raise RecordError(f"this title would be taken for something else when read: {line!r}", name)
    rows = ["".join(f"{value:15.7E}" for value in values[i : i + 5]) for i in range(0, len(values), 5)]
    header = [*title_lines, "ACCELERATION TIME SERIES IN UNITS OF G", f"NPTS= {len(values):6d}, DT= {float(dt)!r} SEC"]
    return "\n".join([*header, *rows]) + "\n"


def _bytes(filename: Any) -> bytes:
    return bytes(filename.read()) if hasattr(filename, "read") else record_bytes(Path(filename))


def _lines(data: bytes) -> list[str]:
    return _with_line_feeds(data).decode("latin-1").split("\n")


def _with_line_feeds(data: bytes) -> bytes:
    if b"\r" not in data:  # a tenth of the time of reading a file, were it sought three times
        return data
    return data.replace(b"\r\r\n", b"\n").replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _checked_text_bytes(data: bytes, name: str) -> bytes:
    if not data or data.isspace():
        raise RecordError("the file is empty; get it anew", name)
    if b"\0" in data:
        raise RecordError("the file holds binary data, not the text of an AT2 file", name)
    return data.removeprefix(MARK)


def _header(text: bytes, name: str) -> tuple[list[str], re.Match[str], int]:
    """The lines before the one with NPTS and DT, what it says, and where the next one begins."""
    lines: list[str] = []
    begin = 0
    while begin <= len(text) and len(lines) < HEADER_LINES:
        end = text.find(b"\n", begin)
        end = len(text) if end < 0 else end
        line = text[begin:end].decode("latin-1")
        match = _TRAILING.search(line) or _KEYED.search(line)
        if match:
            return lines, match, end + 1
        lines.append(line)
        begin = end + 1
    raise RecordError(
        "no header line gives the number of values and the time step; expected a line like "
        "'NPTS=  4000, DT=  .0050 SEC' (for values without a header give `dt` and `units`)",
        name,
    )


def _npts(match: re.Match[str], name: str, line: int) -> int:
    word = match["npts"].rstrip(".")
    if not re.fullmatch(r"\d{1,9}", word, re.ASCII) or int(word) < 2:
        raise RecordError(f"NPTS is {match['npts']!r}; expected the number of values, two or more", name, line)
    return int(word)


def _dt(match: re.Match[str], name: str, line: int) -> float:
    word = match["dt"]
    number = re.match(_DECIMAL, word)
    suffix = "" if number is None else word[number.end() :] + match["rest"]
    dt = float(re.sub("[dD]", "E", number[0])) if number else np.nan
    whole = number is not None and re.fullmatch("[A-Z.]*", word[number.end() :], re.I)  # not 1/200
    if not whole or not 0.0 < dt < np.inf:
        raise RecordError(f"DT is {word!r}; expected the time step in seconds, above zero", name, line)
    if _MILLI.match(suffix):
        raise RecordError("DT is in milliseconds; write it in seconds", name, line)
    if _RATE.match(suffix):
        raise RecordError("DT is a rate, in Hz; write the time step in seconds", name, line)
    return dt


def _refuse_second(what: str, pattern: re.Pattern[str], line: str, first: float, name: str, number: int) -> None:
    """Make sure that a line does not state a number of values or a time step twice, and differently."""
    for word in (word for found in pattern.findall(line) for word in found if word):
        if float(re.sub("[dD]", "E", word)) != first:
            raise RecordError(f"{what} is {first:g}, and {word} on the same line; leave one out", name, number)


def _stated_unit(header: list[str], behind: str, name: str) -> str | None:
    """The unit the header states, after making sure that it states an acceleration, and one unit.

    Args:
        header: the lines, with that of NPTS and DT.
        behind: the end of the last one, where a unit may stand alone.
    """
    first: str | None = None
    for number, line in enumerate(header, 1):
        match = _UNITS.search(line)
        if match is None:
            continue
        quantity = _QUANTITY.search(line)
        word = match["unit"]
        unit = unit_named(word)
        if quantity and quantity[0].upper() != "ACCELERATION":
            raise RecordError(
                f"this is a {quantity[0].lower()} record, in {word}; a motion needs the acceleration (the .AT2 file)",
                name,
                number,
            )
        if unit is None and first is None:
            raise RecordError(f"the values are in {word!r}, not a unit of acceleration known here", name, number)
        first = _one_unit(first, unit, name, number)
    for word in re.split(r"[\s,()\[\]]+", behind):
        first = _one_unit(first, unit_named(word), name, len(header))
    return first


def _one_unit(first: str | None, unit: str | None, name: str, number: int) -> str | None:
    if first is not None and unit is not None and not same_unit(first, unit):
        raise RecordError(
            f"the header says that the values are in {first}, and in {unit} here; correct it", name, number
        )
    return first or unit


def _unit(stated: str | None, given: str | None, name: str, line: int) -> str:
    if stated is None and given is None:
        raise OptionError(
            "units",
            "no header line states the units (expected '... IN UNITS OF G'); give them with `units:`, "
            "one of g, m/s2, cm/s2, gal, mm/s2",
            name,
            line,
        )
    if stated is not None and given is not None and not same_unit(stated, given):
        raise OptionError("units", f"the file says its units are {stated}, `units` says {given}; leave it out", name)
    return stated if stated is not None else str(given)


def _counted(numbers: Numbers, npts: int, data: bytes, name: str) -> tuple[NDArray[np.float64], list[str]]:
    """Exactly NPTS values, and what was tolerated to get them."""
    values, warnings = numbers.values, []
    if not len(values):
        raise RecordError(f"the header announces {npts} values and none follows; get the file anew", name)
    if len(values) < npts:
        _refuse_short(numbers, npts, _last_line(data), name)
    extra = values[npts:]
    if extra.any():
        raise RecordError(
            f"the header announces {npts} values and {len(values)} follow; correct NPTS or remove what is too much",
            name,
        )
    if len(extra):
        warnings.append(f"{len(extra)} zero(s) behind the {npts} values the header announces were left out")
    elif not (numbers.text_after or _ends_its_line(data)) and len(numbers.last) < numbers.shortest:
        raise RecordError(
            f"the last value, {numbers.last!r}, is shorter than all others and no line end follows: the file seems "
            "cut inside it; get the file anew, or end its last line if it is whole",
            name,
            _last_line(data),
        )
    if numbers.text_after:
        warnings.append(f"text behind the values was left out: {numbers.text_after[0]!r}")
    return values[:npts], warnings


def _ends_its_line(data: bytes) -> bool:
    return data.rstrip(b" ").endswith((b"\n", b"\r"))


def _last_line(data: bytes) -> int:
    return _with_line_feeds(data).count(b"\n") + 1


def _refuse_short(numbers: Numbers, npts: int, last_line: int, name: str) -> NoReturn:
    text = f" before {numbers.text_after[0]!r}" if numbers.text_after else ""
    raise RecordError(
        f"the header announces {npts} values and only {len(numbers.values)} follow{text}: "
        "the file has been cut; get it anew",
        name,
        last_line,
    )


def _identity(titles: tuple[str, ...]) -> tuple[str, str, str, str]:
    """Event, date, station, component as the databases' second of three title lines gives them, else empty."""
    if len(titles) != 3 or not _SERIES.search(titles[2]):
        return "", "", "", ""
    parts = [part.strip() for part in re.sub(r"\([^()]*\)\s*$", "", titles[1]).split(",")]
    if len(parts) < 3 or not all(parts[-2:]):
        return "", "", "", ""
    before = ", ".join(parts[:-2])
    date = _DATE.search(before)
    event = before[: date.start()] if date else before
    event, station = ("" if each in UNKNOWN else each for each in (event.strip(" ,"), parts[-2]))
    return event, date[0] if date else "", station, parts[-1]
