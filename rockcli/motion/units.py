"""Units of acceleration a record can be in."""

from __future__ import annotations

import re

FACTORS = {"m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 0.001}
"""What turns a value into m/s²; `g` is not among them: a study says how large its g is."""

UNIT_NAMES = {
    "g": "g",
    "m/s2": "m/s2",
    "m/s/s": "m/s2",
    "m/sec2": "m/s2",
    "m/sec/sec": "m/s2",
    "cm/s2": "cm/s2",
    "cm/s/s": "cm/s2",
    "cm/sec2": "cm/s2",
    "cm/sec/sec": "cm/s2",
    "gal": "gal",
    "gals": "gal",
    "mm/s2": "mm/s2",
    "mm/s/s": "mm/s2",
}
"""Words for units, without what powers are written with, and what they mean."""


def unit_named(word: str) -> str | None:
    """The unit a word means (`CM/SEC**2` -> `cm/s2`), None if it means none."""
    return UNIT_NAMES.get(re.sub(r"\*\*|\^|\s", "", word.lower()).replace("²", "2"))


def same_unit(a: str, b: str) -> bool:
    """Whether two units of this table are of the same size (gal and cm/s2 are)."""
    return a == b or (a != "g" and b != "g" and FACTORS[a] == FACTORS[b])
