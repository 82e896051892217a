"""When two names are the same to a reader."""

from __future__ import annotations

import re


def as_read(name: str) -> str:
    """A name in small letters and without zeros that fill up its numbers: `cab-3` of CAB-03."""
    return re.sub(r"(?<![\d.])0+(?=\d)", "", name.lower())
