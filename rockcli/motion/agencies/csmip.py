"""CSMIP and CDMG volumes 1 and 2 (California), one or more components."""

from __future__ import annotations

import re

from rockcli.errors import RecordError
from rockcli.motion.agencies.channel import (
    Channel,
    Format,
    counted,
    decimal,
    number_in,
    start_time,
    step,
    unit_of,
    whole,
)

_KINDS = ("CORRECTED ACCELEROGRAM", "UNCORRECTED ACCELEROGRAM DATA")
"""How the first lines of a component begin; in most files `/&  ---- END OF DATA ...` stands before the next one."""

_V2 = re.compile(
    r"^\s*(\d+) POINTS OF ACCEL\w* DATA EQUALLY SPACED AT\s+([\d.]+) SEC[.,]*\s*(?:\(UNITS:|IN\s)([^()]+)", re.I
)
"""`... SEC.  (UNITS: CM/SEC/SEC)` in the older files, `... sec, in cm/sec2. (8f10.6)` in the newer."""

_V1 = re.compile(r"^\s*(\d+)\s+Accelerogram points at\s+([\d.]+)\s*pts/sec in units of\s+(\S+)", re.I)
_UNEVEN = re.compile(r"^\s*\d+\s+(?:POINTS OF|ACCELEROGRAM POINTS)", re.I)
_PEAK = re.compile(r"PEAK ACCELERATION\s*=\s*(\S+)|\bMax\s*=\s*(\S+)\s+g\b", re.I)
_CHANNEL = re.compile(r"^CHAN\s*(\d+):\s*(\S+)(?:\s+DEG)?", re.I)


def recognises(lines: list[str]) -> bool:
    """`CORRECTED ACCELEROGRAM ... CHAN 1: 90 DEG` with `UNCORRECTED ACCELEROGRAM DATA` below, or the latter first."""
    kinds = [line.upper().startswith(_KINDS) for line in lines[:2]]
    return bool(kinds) and kinds[0] and ("DATA" in lines[0].upper() or (len(kinds) > 1 and kinds[1]))


def parse(lines: list[str], name: str) -> list[Channel]:
    """Every component of a file; of volume 2 the acceleration."""
    found: list[Channel] = []
    begin = at = 0
    while at < len(lines):
        match = _V2.match(lines[at]) or _V1.match(lines[at])
        if match is None:
            at += 1
            continue
        header = lines[begin:at]
        is_V2 = _V2.match(lines[at]) is not None
        said = decimal(match[2], "the interval" if is_V2 else "the rate", name, at + 1)
        interval = step(said if is_V2 or said == 0.0 else 1.0 / said, name, at + 1)
        values, at = counted(lines, at + 1, whole(match[1], "the number of points", name, at + 1), name)
        found.append(_channel(header, values, interval, unit_of(match[3], name, at + 1)))
        while at < len(lines) and not lines[at].upper().startswith(("/&", *_KINDS)):
            at += 1
        at = begin = at + (at < len(lines) and lines[at].startswith("/&"))
    if not found:
        uneven = next((i for i, line in enumerate(lines) if _UNEVEN.match(line)), 0)
        raise RecordError("no acceleration at equal time steps in it", name, uneven + 1)
    return found


def _channel(header: list[str], values: object, dt: float, units: str) -> Channel:
    peaks = [number_in(m[1] or m[2]) for line in header if (m := _PEAK.search(line))]
    places = [m for line in header if (m := _CHANNEL.match(line))]
    component = places[0][2] if places else ""
    station = next((m[1] for line in header if (m := re.match(r"STATION (?:NO|ID)\.\s*(\S+)", line, re.I))), "")
    said = {"title": [" ".join(line.split()) for line in header[2:4]], **start_time(header)}
    return Channel(values, dt, units, component, station, abs(peaks[-1]) if peaks else float("nan"), said)  # type: ignore[arg-type]


CSMIP = Format("CSMIP", recognises, parse)
