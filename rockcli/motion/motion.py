"""`Motion`, a recorded ground motion: values, time step, and everything that was ever done to them."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from numpy.typing import NDArray

NO_START = datetime(1970, 1, 1, tzinfo=UTC)
"""What ObsPy says of files without a time of their first sample."""

NO_DATE = 86400.0
"""Seconds around it that are no time of day, but the first time of a file without a date, as of SAC."""

_START = re.compile(
    r".*\bstart: *(?:(\d{4}-\d\d-\d\dT[\d:.]+(?:Z|[+-]\d\d:\d\d))|([+-]?\d+\.?\d*(?:E[+-]?\d+)?) s)(?![^\s,;)])", re.I
)
"""When a first sample was taken, as `start_of` writes it."""

VERTICAL = re.compile(r"UP?|UD[12]?|V(?:ER(?:T(?:ICAL)?)?)?|DW?N|DOWN|Z|[A-Z]{2}Z", re.I)
"""What files call a vertical component; of KiK-net UD1 and UD2, of the seismological formats HNZ and the like."""

AZIMUTH = r"0|[4-9]\d|\d{3}"
"""Names of components that are degrees from north, and not numbers of channels."""

HORIZONTAL = re.compile(
    AZIMUTH + r"|[NSEWLT]|NS[12]?|EW[12]?|SN|WE|N-S|E-W|[NS]\d\d?[EW]|[A-Z]{2}[NE12]|NORTH|SOUTH|EAST|WEST|H[12]|F[NP]",
    re.I,
)
"""What files call a horizontal component: degrees from north, directions, HNE and the like."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One component of ground acceleration, equally spaced in time.

    Attributes:
        values: acceleration, (k,), k >= 2, in g if `in_g`, else in m/s².
        dt: time between samples [s].
        in_g: whether `values` are in g, to be multiplied by the g of whoever uses them.
        name: the file's name, without its folder.
        sha256: of the bytes of the file.
        processing: what was done to the values since the file, one sentence each, in order.
        warnings: what a careful reader of the file would remark, one sentence each.
        format: name of the format: `AT2`, `text`, or ObsPy's.
        component: as the file names it, empty if it does not.
        header: what else the file says.
    """

    values: NDArray[np.float64]
    dt: float
    in_g: bool
    name: str = ""
    sha256: str = ""
    processing: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    format: str = ""
    component: str = ""
    header: dict[str, Any] = field(default_factory=dict)

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return (len(self.values) - 1) * self.dt

    @property
    def is_vertical(self) -> bool:
        """Whether the file calls it a vertical component."""
        return VERTICAL.fullmatch(self.component) is not None

    @property
    def is_horizontal(self) -> bool:
        """Whether the file calls it a horizontal component."""
        return not self.is_vertical and HORIZONTAL.fullmatch(self.component) is not None

    @property
    def begins(self) -> tuple[str, float] | None:
        """By which clock and when the first sample was taken [s]; None where the file does not say."""
        if (said := self.header.get("first_time")) is not None:
            return "column of times", said
        if "start" not in self.header:
            return None
        seconds = datetime.fromisoformat(self.header["start"]).timestamp()
        if abs(seconds) < NO_DATE:
            return ("column of times", seconds) if seconds else None
        return "UTC", seconds

    def begins_after(self, other: Motion) -> float:
        """How much later it begins than another motion [s]; 0 to within half a time step, or where one does not say."""
        mine, others = self.begins, other.begins
        if mine is None or others is None or not self.same_clock(other):
            return 0.0
        later = round(mine[1] - others[1], 6)
        return later if abs(later) > 0.5 * self.dt else 0.0

    def same_clock(self, other: Motion) -> bool:
        """Whether both say, by one clock, when they begin."""
        return self.begins is not None and other.begins is not None and self.begins[0] == other.begins[0]

    def header_from(self, after: float) -> dict[str, Any]:
        """The header of what is left behind the first seconds."""
        if self.begins is None:
            return self.header
        clock, first = self.begins
        if clock == "UTC":
            return self.header | {"start": (NO_START + timedelta(seconds=first + after)).isoformat()}
        return self.header | {"first_time": first + after}

    @property
    def units(self) -> str:
        """Of `values`: `g` or `m/s2`."""
        return "g" if self.in_g else "m/s2"

    def acceleration(self, g: float) -> NDArray[np.float64]:
        """The values in m/s², (k,), values in g multiplied by this g [m/s²]."""
        return self.values * g if self.in_g else self.values


def start_of(motion: Motion) -> str:
    """When the first sample was taken, for a comment: `start: 2010-02-27T06:34:14.000000Z`, of a column of times
    `start: 12.5 s`; "" where that is unknown, and for a column that begins at 0."""
    clock, first = motion.begins or ("", 0.0)
    if clock == "UTC":
        moment = NO_START + timedelta(seconds=first)
        return f"start: {moment.replace(tzinfo=None).isoformat(timespec='microseconds')}Z"
    return f"start: {first!r} s" if first else ""


def start_in(text: str) -> dict[str, Any]:
    """What words as those of `start_of` say, as a header has it; {} for others, as of a time without its zone."""
    if (match := _START.match(text)) is None:
        return {}
    if match[2] is not None:
        return {"first_time": float(match[2])}
    with suppress(ValueError):
        return {"start": datetime.fromisoformat(match[1].upper()).isoformat()}
    return {}


@dataclass(frozen=True, eq=False)
class Given:
    """Values that no file holds: an array, or a trace, which knows its time step.

    Attributes:
        values: acceleration, (k,); dt: time between samples [s], None where it is told beside them.
        start: when the first sample was taken, ISO 8601, empty where that is not known.
    """

    values: NDArray[np.float64]
    dt: float | None = None
    component: str = ""
    start: str = ""
