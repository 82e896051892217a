"""SMC files of the U.S. Geological Survey: one component, cm/s²."""

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
    whole,
)

TEXTS, INTEGERS, REALS = 11, 6, 10
"""Lines of the three parts of the header."""

UNDEFINED, START, COUNT, RATE, MAXIMUM, MINIMUM = 0, slice(1, 7), 16, 1, 29, 31
"""Places, from 0: what stands for no value, year to milliseconds of the first sample (UTC), and number of values, among
the integers; samples a second, extremes among the reals."""

_KINDS = {"0": "UNKNOWN", "1": "UNCORRECTED ACCELEROGRAM", "2": "CORRECTED ACCELEROGRAM", "3": "VELOCITY",
          "4": "DISPLACEMENT", "5": "RESPONSE SPECTR"}  # fmt: skip


def recognises(lines: list[str]) -> bool:
    """`2 CORRECTED ACCELEROGRAM` and ten more lines of text, `*` where there is none."""
    if len(lines) < TEXTS + 1 or sum(line.startswith("*") for line in lines[1:TEXTS]) < 2:
        return False
    return any(re.match(rf"{digit}\s+{words}", lines[0], re.I) for digit, words in _KINDS.items())


def parse(lines: list[str], name: str) -> list[Channel]:
    """The component of a file."""
    kind = lines[0][0]
    if kind in "345":
        raise RecordError(f"this is a file of {_KINDS[kind].lower()}; a motion needs the acceleration", name, 1)
    text = [line.rstrip() for line in lines[:TEXTS]]
    integers = " ".join(lines[TEXTS : TEXTS + INTEGERS]).split()
    words = [word for line in lines[TEXTS + INTEGERS :][:REALS] for word in line.split()]
    reals = [number_in(word) for word in words]
    if len(integers) < 48 or len(reals) < 50:
        raise RecordError("the header is not whole: expected 48 integers and 50 reals", name, TEXTS + 1)
    count = whole(integers[COUNT], "the number of values", name, TEXTS + 3)
    rate = decimal(words[RATE], "the rate", name, TEXTS + INTEGERS + 1)
    dt = step(1.0 / rate if rate > 0.0 else 0.0, name, TEXTS + INTEGERS + 1)
    at = TEXTS + INTEGERS + REALS
    while at < len(lines) and lines[at].startswith("|"):
        at += 1
    values, end = counted(lines, at, count, name)
    alone(lines, end, name)
    peak = max(abs(reals[MAXIMUM]), abs(reals[MINIMUM]))
    place = re.search(r"component\s*=\s*(\S+)", text[5], re.I)
    station = sought(r"(?:station\s*=)?\s*(.*?)\s*(?:component\s*=|$)", text[5].strip("* "), "a station", name, 6)[1]
    header = {"title": [" ".join(text[3].split())]} if text[3].strip("* ") else {}
    component, stated = place[1] if place else "", peak if peak < 1e30 else float("nan")
    return [Channel(values, dt, "cm/s2", component, station, stated, header | _start(integers))]


def _start(integers: list[str]) -> dict[str, str]:
    """When the first sample was taken; older files give the minute of the earthquake in its place."""
    said = integers[START]
    if integers[UNDEFINED] in said or said[4:] == ["0", "0"]:
        return {}
    return begun(f"{' '.join(said[:5])}.{said[5]:0>3}", "%Y %j %H %M %S.%f")


SMC = Format("SMC", recognises, parse)
