"""COSMOS strong-motion files, V1 and V2 (format version 1.20 and its forerunners), one or more components."""

from __future__ import annotations

import re

from rockcli.errors import RecordError
from rockcli.motion.agencies.channel import (
    Channel,
    Format,
    counted,
    decimal,
    number_in,
    sought,
    start_time,
    step,
    unit_of,
    whole,
)

PEAK, INTERVAL = 63, 61
"""Places, from 0, in the header of reals: largest acceleration, and time step [ms]."""

UNKNOWN = -999.0

_DIRECTION = re.compile(r"Sta Cha(?:n|nnel)?\b[\s:]*\d+[\s:]*(?:(\d+)\s*deg|(up|down|vert)\b)", re.I)
"""`Sta Chan  1: 340 deg (Rcrdr Chan  1)` or `Sta Chan  2:  Up     (Rcrdr Chan  2)`."""


def recognises(lines: list[str]) -> bool:
    """`Corrected acceleration (Format v01.20 with 13 text lines)`."""
    return bool(lines) and re.search(r"\(Format v0?\d+\.\d+ with\s+\d+ text lines", lines[0]) is not None


def parse(lines: list[str], name: str) -> list[Channel]:
    """Every component of a file."""
    found, at = [], 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        channel, at = _channel(lines, at, name)
        found.append(channel)
    return found


def _channel(lines: list[str], at: int, name: str) -> tuple[Channel, int]:
    first = lines[at]
    texts = int(sought(r"with\s+(\d+) text lines", first, "the number of text lines", name, at + 1)[1])
    text = lines[at : at + texts]
    at = _skip(lines, at + texts, "Integer", name)
    reals, at = _reals(lines, at, name)
    while at < len(lines) and (re.search(r"Comment line", lines[at], re.I) or lines[at].lstrip().startswith("|")):
        at += 1
    line = lines[at] if at < len(lines) else ""
    said = sought(
        r"(\d+)\s+(\w+)\s+(?:pts|points).*?units\s*=\s*([^(,]+)",
        line,
        "'... acceleration pts, ... units=...'",
        name,
        at + 1,
    )
    if not said[2].lower().startswith("accel"):
        raise RecordError(f"this is a {said[2].lower()} record; a motion needs the acceleration", name, at + 1)
    units = unit_of(said[3], name, at + 1)
    values, end = counted(lines, at + 1, whole(said[1], "the number of points", name, at + 1), name)
    dt = step(1e-3 * reals[INTERVAL], name, at + 1)
    peak = abs(reals[PEAK]) if reals[PEAK] != UNKNOWN else float("nan")
    channel = re.search(r"End.of.data for Chan(?:nel)?\s*(\S+)", lines[end], re.I) if end < len(lines) else None
    direction = next((m[1] or m[2] for one in text if (m := _DIRECTION.search(one))), "")
    component = direction or (channel[1] if channel else "")
    code = next((m[1] for one in text if (m := re.search(r"Code:\s*(\S+)", one))), "")
    header = {"title": [" ".join(one.split()) for one in text[:2]], "processed": "uncorrected" not in first.lower()}
    return Channel(values, dt, units, component, code, peak, header | start_time(text)), end + 1


def _skip(lines: list[str], at: int, kind: str, name: str) -> int:
    return at + 1 + int(_announced(lines, at, kind, name)[2])


def _reals(lines: list[str], at: int, name: str) -> tuple[list[float], int]:
    said = _announced(lines, at, "Real", name)
    end = at + 1 + int(said[2])
    words = [word for line in lines[at + 1 : end] for word in line.split()]
    if len(words) < PEAK + 1:
        raise RecordError(f"{len(words)} real-header values; expected {said[1]}", name, at + 1)
    reals = [number_in(word) for word in words]
    reals[INTERVAL] = decimal(words[INTERVAL], "the time step [ms]", name, at + 1)
    return reals, end


def _announced(lines: list[str], at: int, kind: str, name: str) -> re.Match[str]:
    line = lines[at] if at < len(lines) else ""
    pattern = rf"(\d+)\s+{kind}-header values follow on\s+(\d+)\s+lines"
    return sought(pattern, line, f"the number of lines of the {kind.lower()} header", name, at + 1)


COSMOS = Format("COSMOS", recognises, parse)
