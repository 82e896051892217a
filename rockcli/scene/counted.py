"""Numbers of things in words."""

from __future__ import annotations


def counted(number: int, what: str) -> str:
    """`1 case`, `2 cases`, `2 studies`."""
    plural = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
    return f"{number} {what if number == 1 else plural}"
