"""Files of one component under lines of `key: value`: ESM (and ITACA, AFAD), RESORCE, and CSMNC of China."""

from __future__ import annotations

import re

from rockcli.errors import RecordError
from rockcli.motion.agencies.channel import (
    Channel,
    Format,
    alone,
    begun,
    counted,
    decimal,
    number_in,
    sought,
    step,
    unit_of,
    whole,
)

_PAIR = re.compile(r"\s*([^:]*?)\s*:\s*(.*?)\s*$")


def _pairs(lines: list[str]) -> tuple[dict[str, tuple[str, int]], int]:
    """Values and line numbers by key, and the line behind the header."""
    found: dict[str, tuple[str, int]] = {}
    for number, line in enumerate(lines, 1):
        match = _PAIR.match(line)
        if match is None:
            return found, number - 1
        found.setdefault(match[1], (match[2], number))
    return found, len(lines)


def _value(pairs: dict[str, tuple[str, int]], key: str, name: str) -> tuple[str, int]:
    if key not in pairs or not pairs[key][0]:
        raise RecordError(f"no header line gives {key}", name)
    return pairs[key]


_FIRST_SAMPLE = ("%Y%m%d_%H%M%S.%f", "%Y%m%d_%H%M%S", "%d/%m/%Y %H:%M:%S.%f", "%d/%m/%Y %H:%M:%S")
"""As ESM and as AFAD write it."""


def recognises_esm(lines: list[str]) -> bool:
    """`EVENT_NAME: ...` and `EVENT_ID: ...`."""
    return len(lines) > 1 and lines[0].startswith("EVENT_NAME:") and lines[1].startswith("EVENT_ID:")


def parse_esm(lines: list[str], name: str) -> list[Channel]:
    """The component of a file of the Engineering Strong Motion database, or in its format."""
    pairs, at = _pairs(lines)
    kind = pairs.get("DATA_TYPE", ("ACCELERATION", 1))
    if kind[0].upper() != "ACCELERATION":
        raise RecordError(f"this is a {kind[0].lower()} record; a motion needs the acceleration", name, kind[1])
    dt, dt_line = _value(pairs, "SAMPLING_INTERVAL_S", name)
    count, count_line = _value(pairs, "NDATA", name)
    units, units_line = _value(pairs, "UNITS", name)
    values, end = counted(lines, at, whole(count, "NDATA", name, count_line), name)
    alone(lines, end, name)
    unit = unit_of(units, name, units_line)
    peak = abs(number_in(pairs.get("PGA_CM/S^2", ("", 0))[0])) if unit in ("cm/s2", "gal") else float("nan")
    said = {key: pairs[key][0] for key in ("EVENT_NAME", "STATION_NAME") if pairs.get(key, ("",))[0]}
    header = {"title": list(said.values())} | _numbers(pairs, {"MAGNITUDE_W": "magnitude", "VS30_M/S": "vs30"})
    start = begun(pairs.get("DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS", ("", 0))[0], *_FIRST_SAMPLE)
    station = pairs.get("STATION_CODE", ("", 0))[0]
    component = pairs.get("STREAM", ("", 0))[0]
    interval = step(decimal(dt, "SAMPLING_INTERVAL_S", name, dt_line), name, dt_line)
    return [Channel(values, interval, unit, component, station, peak, header | start)]


def _numbers(pairs: dict[str, tuple[str, int]], names: dict[str, str]) -> dict[str, float]:
    found = {to: number_in(pairs.get(key, ("", 0))[0]) for key, to in names.items()}
    return {key: value for key, value in found.items() if value == value}


def recognises_resorce(lines: list[str]) -> bool:
    """`Event Date & Time : ...` and `Station Code / Name : ...`."""
    return len(lines) > 1 and lines[0].startswith("Event Date & Time") and lines[1].startswith("Station Code / Name")


def parse_resorce(lines: list[str], name: str) -> list[Channel]:
    """The component of a RESORCE file."""
    pairs, at = _pairs(lines)
    dt, dt_line = _value(pairs, "Time Increment (s)", name)
    count, count_line = _value(pairs, "Number of Data", name)
    line = lines[at] if at < len(lines) else ""
    unit = unit_of(sought(r"time series in\s+(\S+)", line, "'... time series in m/s/s'", name, at + 1)[1], name, at + 1)
    values, end = counted(lines, at + 1, whole(count, "the number of data", name, count_line), name)
    alone(lines, end, name)
    peak = abs(number_in(pairs.get("PGA (m/s/s)", ("", 0))[0])) if unit == "m/s2" else float("nan")
    station = pairs.get("Station Code / Name", ("", 0))[0]
    component = pairs.get("Orientation", ("", 0))[0]
    header = {"title": [pairs.get("Event Date & Time", ("", 0))[0]]}
    interval = step(decimal(dt, "the time increment", name, dt_line), name, dt_line)
    return [Channel(values, interval, unit, component, station, peak, header)]


def recognises_csmnc(lines: list[str]) -> bool:
    """A line `NO. OF POINTS: ... EQUALLY SPACED INTERVALS OF: ...` in the header."""
    return any("EQUALLY SPACED INTERVALS OF:" in line for line in lines[:16])


def parse_csmnc(lines: list[str], name: str) -> list[Channel]:
    """The component of a file of the China Strong Motion Network Centre."""
    at = next(i for i, line in enumerate(lines) if "EQUALLY SPACED INTERVALS OF:" in line)
    said = sought(r"POINTS:\s*(\d+).*INTERVALS OF:\s*(\S+)\s*SEC", lines[at], "points and interval", name, at + 1)
    header = lines[: at + 4]
    units = [(m[1], i) for i, line in enumerate(header) if (m := re.search(r"UNIT:\s*(\S+)", line))]
    if not units or "ACCELERATION" not in header[units[0][1]]:
        raise RecordError("no header line states an acceleration and its unit", name, at + 1)
    peak = next((number_in(m[1]) for line in header if (m := re.search(r"PEAK VALUE:\s*(\S+)", line))), float("nan"))
    component = next((m[1] for line in header if (m := re.match(r"COMP\.\s*(\S+)", line))), "")
    station = next((m[1] for line in header if (m := re.match(r"STATION:\s*(\S+)", line))), "")
    values, end = counted(lines, at + 4, whole(said[1], "the number of points", name, at + 1), name)
    alone(lines, end, name)
    unit = unit_of(units[0][0], name, units[0][1] + 1)
    title = [header[2].strip()]
    interval = step(decimal(said[2], "the interval", name, at + 1), name, at + 1)
    return [Channel(values, interval, unit, component, station, abs(peak), {"title": title})]


ESM = Format("ESM", recognises_esm, parse_esm)
RESORCE = Format("RESORCE", recognises_resorce, parse_resorce)
CSMNC = Format("CSMNC", recognises_csmnc, parse_csmnc)
