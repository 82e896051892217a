"""GeoNet files of New Zealand, V1A (as recorded) and V2A (corrected), mm/s², three components."""

from __future__ import annotations

import re
from contextlib import suppress
from datetime import UTC, datetime, timedelta

from rockcli.motion.agencies.channel import Channel, Format, counted, decimal, number_in, sought, step, whole

TEXTS, HEADER = 16, 26
"""Lines of text, and of the whole header."""

PREPENDED, BUFFER_START = 31, (8, 9, 18, 19, 38, 39)
"""Places, from 0, among the 40 integers of the header: samples put before the recorded ones, and year, month, day,
hour, minute and milliseconds of the first recorded one (UTC)."""


def recognises(lines: list[str]) -> bool:
    """`Corrected accelerogram 20180212_211554_WPWS_20 GNS Science` with `Site ...` below."""
    first = bool(lines) and re.match(r"(?:Unc|C)orrected accelerogram \S", lines[0]) is not None
    return first and len(lines) > 1 and lines[1].startswith("Site ")


def parse(lines: list[str], name: str) -> list[Channel]:
    """Every component of a file; of a corrected one the acceleration, before velocity and displacement."""
    found, at = [], 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        found.append(_channel(lines, at, name))
        at = _behind(lines, at)
    return found


def _behind(lines: list[str], at: int) -> int:
    """Where the next component begins."""
    following = (i for i in range(at + 1, len(lines)) if re.match(r"(?:Unc|C)orrected accelerogram", lines[i]))
    return next(following, len(lines))


def _channel(lines: list[str], at: int, name: str) -> Channel:
    text = [*lines[at : at + TEXTS], *[""] * TEXTS][:TEXTS]
    corrected = text[0].startswith("C")
    said = sought(r"Number of points\s+(\d+)", text[9], "'Number of points ...'", name, at + 10)
    count = whole(said[1], "the number of points", name, at + 10)
    if corrected:
        said = sought(r"at\s+([\d.]+)\s*s\w* intervals", text[10], "'... at 0.020 sec intervals'", name, at + 11)
        unit = 1.0
    else:
        pattern = r"in units of\s+([\d.]+)\s*mm/s/s\s+at intervals of\s+([\d.]+)"
        said = sought(pattern, text[10], "'Raw readings in units of ... mm/s/s at intervals of ... s'", name, at + 11)
        unit = decimal(said[1], "the unit", name, at + 11)
    dt = step(decimal(said[said.re.groups], "the interval", name, at + 11), name, at + 11)
    part = lines[: _behind(lines, at)]
    values, _ = counted(part, at + HEADER, count, name, times=3 if corrected else 1)
    place = re.match(r"Component\s+(\S+)", text[12])
    title = {"title": [" ".join(text[i].split()) for i in (6, 7)]}
    peak = re.search(r"peak\s+([+-]?[\d.]+)\s*mm/s/s", text[13], re.I)
    site = re.match(r"Site\s+(\S+)", text[1])
    return Channel(
        values * unit, dt, "mm/s2", place[1] if place else "", site[1] if site else "",
        abs(number_in(peak[1])) if peak else float("nan"), title | _start(part[at + TEXTS : at + TEXTS + 4], dt),
    )  # fmt: skip


def _start(lines: list[str], dt: float) -> dict[str, str]:
    """When the first sample was taken; {} for times to the minute only, or none."""
    with suppress(ValueError, IndexError, OverflowError):
        integers = [int(word) for line in lines for word in line.split()]
        year, month, day, hour, minute, milliseconds = (integers[place] for place in BUFFER_START)
        if len(integers) == 40 and 0 < milliseconds < 60000:
            recorded = datetime(year, month, day, hour, minute, tzinfo=UTC) + timedelta(milliseconds=milliseconds)
            return {"start": (recorded - timedelta(seconds=integers[PREPENDED] * dt)).isoformat()}
    return {}


GEONET = Format("GEONET", recognises, parse)
