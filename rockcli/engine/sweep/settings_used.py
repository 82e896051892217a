"""Settings of solvers as they were used, whatever chunks and shares the cases were solved in."""

from __future__ import annotations

import re
from collections.abc import Iterable

Used = dict[str, str]

SPANS = ("dt", "alpha_d", "yield_rotation", "stiffness_damping")
"""Settings that may differ from case to case, told as `lowest ... highest`, and as `-` where no case has one."""

COUNTS = ("divided_steps",)
"""What is counted over the cases."""

_SPAN = re.compile(r"(\S+?)(?: \.\.\. (\S+))?\Z")


def joined(entries: Iterable[tuple[int, Used]]) -> list[tuple[int, Used]]:
    """Entries (lowest case, settings) with those that differ in spans and counts alone made one, by the lowest case."""
    found: dict[tuple[tuple[str, str], ...], tuple[int, Used]] = {}
    for first, one in entries:
        kind = tuple(sorted((key, "" if _mergeable(key, value) else value) for key, value in one.items()))
        if kind in found:
            before, other = found[kind]
            found[kind] = min(before, first), {key: _merged(key, other[key], value) for key, value in one.items()}
        else:
            found[kind] = first, one
    return sorted(found.values(), key=lambda item: item[0])


def _mergeable(key: str, value: str) -> bool:
    return key in COUNTS or (key in SPANS and _ends(value) is not None)


def _merged(key: str, one: str, other: str) -> str:
    if one == other and key not in COUNTS:
        return one
    if key in COUNTS:
        return str(int(one) + int(other))
    ends = [*(_ends(one) or ()), *(_ends(other) or ())]
    low, high = min(ends, key=float), max(ends, key=float)
    return low if float(low) == float(high) else f"{low} ... {high}"


def _ends(value: str) -> tuple[str, ...] | None:
    """The ends of a span, as written, of an empty one nothing; None for words."""
    if value == "-":
        return ()
    found = _SPAN.match(value)
    if found is None:
        return None
    ends = found[1], found[2] or found[1]
    try:
        float(ends[0]), float(ends[1])
    except ValueError:
        return None
    return ends
