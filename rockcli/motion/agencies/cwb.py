"""Free-format files of the Central Weather Bureau of Taiwan: time and three components, gal."""

from __future__ import annotations

import re

import numpy as np

from rockcli.errors import RecordError
from rockcli.motion.agencies.channel import Channel, Format, begun, decimal, number_in, step, unit_of
from rockcli.motion.numbers import read_numbers

ROUNDED = 1.0
"""The length of a record may be stated in whole seconds [s]."""


def recognises(lines: list[str]) -> bool:
    """`#Earthquake Information`, and a line `#DataSequence: ...` behind it."""
    return bool(lines) and lines[0].startswith("#Earthquake Information")


def parse(lines: list[str], name: str) -> list[Channel]:
    """The components of a file, in the order of its columns."""
    header = [line for line in lines if line.startswith("#")]
    said = {key.strip("# "): value.strip() for key, _, value in (line.partition(":") for line in header)}
    order = re.findall(r"(\w+)\(\+\)", said.get("DataSequence", ""))
    if not order or not said.get("DataSequence", "").startswith("Time"):
        raise RecordError("no header line '#DataSequence: Time U(+); N(+); E(+)'", name)
    unit = unit_of(re.split(r"[.\s]", said.get("AmplitudeUnit", ""), maxsplit=1)[0], name, 1)
    rate = decimal(said.get("SampleRate(Hz)", ""), "SampleRate(Hz)", name, 1)
    dt = step(1.0 / rate if rate > 0.0 else 0.0, name, 1)
    body = ["" if line.startswith("#") else line for line in lines]
    table = read_numbers(body, 1, name).values
    if table.size % (len(order) + 1) or table.size < 2 * (len(order) + 1):
        raise RecordError(f"expected lines of {len(order) + 1} numbers", name, len(header) + 1)
    table = table.reshape(-1, len(order) + 1)
    off = table[:, 0] - table[0, 0] - dt * np.arange(len(table))
    if np.abs(off).max() > 0.05 * dt + 1e-3:  # times are printed to 1 ms
        raise RecordError(f"the time column does not grow by {dt:g} s", name, len(header) + 1)
    length = number_in(said.get("RecordLength(sec)", ""))
    if length - dt * len(table) > ROUNDED:  # False where none is stated
        there = f"the header announces {length:g} s and {dt * len(table):g} s follow"
        raise RecordError(f"{there}: the file has been cut; get it anew", name, len(header) + 1)
    station, start = said.get("StationCode", ""), _start(said)
    return [
        Channel(np.ascontiguousarray(table[:, i + 1]), dt, unit, place, station, _peak(said, place), start)
        for i, place in enumerate(order)
    ]


def _start(said: dict[str, str]) -> dict[str, str]:
    """`#StartTime(GMT+08): 2018/02/06-23:50:29.000`."""
    for key, value in said.items():
        if zone := re.fullmatch(r"StartTime\(GMT([+-]\d\d)\)", key):
            return begun(f"{value} {zone[1]}00", "%Y/%m/%d-%H:%M:%S.%f %z", "%Y/%m/%d-%H:%M:%S %z")
    return {}


def _peak(said: dict[str, str], place: str) -> float:
    """Larger of the two extremes of a component."""
    ends = next((value for key, value in _maxima(said) if key == place), "")
    return max((abs(number_in(end)) for end in ends.split("~")), default=float("nan"))


def _maxima(said: dict[str, str]) -> list[tuple[str, str]]:
    return [(key.rsplit(maxsplit=1)[-1], value) for key, value in said.items() if key.startswith("AmplitudeMAX")]


CWB = Format("CWB", recognises, parse)
