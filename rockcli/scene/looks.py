"""How a figure is wanted: its width, title, selection, labels and limits; as studies and commands ask for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rockcli.errors import StudyError

WIDTHS: dict[str, float] = {"single": 90.0, "double": 180.0}
"""Widths of one and two columns of a journal [mm]."""

NARROWEST, WIDEST = 60.0, 500.0
"""Widths that figures can have [mm]."""

WIDTHS_IN_WORDS = f"{' or '.join(WIDTHS)}, or a number from {NARROWEST:g} to {WIDEST:g} [mm]"


@dataclass(frozen=True)
class Look:
    """A figure as it is wanted.

    Attributes:
        width: [mm]; None = as wide as its content needs.
        title: words instead of the study's title; "" = the study's, None = no title and no note below it.
        select: {axis, by name or path: value or values} of the cases shown.
        labels: {"x", "y", "y1", ...: words}: of all panels, or of the rows of panels counted from the top.
        limits: as `labels`, (low, high) in the unit of the label.
        letters: whether panels are lettered (a), (b), ...
        line: of the study file that asks for it.
    """

    width: float | None = None
    title: str | None = ""
    select: Mapping[str, Any] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    letters: bool = False
    line: int | None = field(default=None, compare=False)


def width_of(said: str | float | None) -> float | None:
    """A width [mm] of `single`, `double` or a number, which may say `mm`; `StudyError` if it is none."""
    if said is None or said in WIDTHS:
        return None if said is None else WIDTHS[str(said)]
    try:
        width = float(str(said).removesuffix("mm"))
    except ValueError:
        width = float("nan")
    if not NARROWEST <= width <= WIDEST:
        raise StudyError(f"width {said}: expected {WIDTHS_IN_WORDS}")
    return width
