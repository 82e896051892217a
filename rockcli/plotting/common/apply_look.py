"""What a study or a command changes of a drawn figure: labels, limits, letters of its panels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rockcli.errors import StudyError
from rockcli.scene.counted import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rockcli.scene.looks import Look


def apply_look(figure: Figure, look: Look, kind: str) -> None:
    """Give a figure the labels, limits and letters that are wanted.

    Raises:
        StudyError: it has no such row of panels, or limits that are none.
    """
    panels = _panels(figure)
    rows = _rows(panels)
    for where, words in _of_axes(look.labels, rows, kind, "labels"):
        for axes, direction in where:
            axis = getattr(axes, f"{direction}axis")
            if axis.get_label_text():
                axis.set_label_text(words)
    for where, (low, high) in _of_axes(look.limits, rows, kind, "limits"):
        if not -math.inf < low < high < math.inf:
            raise StudyError(f"plot {kind!r}: limits ({low:g}, {high:g}): expected two finite numbers, low below high")
        for axes, direction in where:
            if low <= 0.0 and getattr(axes, f"get_{direction}scale")() == "log":
                raise StudyError(f"plot {kind!r}: limits from {low:g}: the axis is logarithmic")
            getattr(axes, f"set_{direction}lim")(low, high)
    if look.letters:
        seen = [axes for axes in panels if axes.axison]
        for number, axes in enumerate(seen):
            letter = f"({chr(ord('a') + number)})" if number < 26 else f"({number + 1})"
            axes.annotate(letter, (0.0, 1.0), (-5.0, 3.0), xycoords="axes fraction", textcoords="offset points",
                          va="bottom", ha="right", fontweight="bold", zorder=9)  # fmt: skip


def _panels(figure: Figure) -> list[Axes]:
    """The axes that stand in a grid, without scales of colour and second axes over others."""
    found: dict[Any, Axes] = {}
    order = []
    grids: list[Any] = []
    for axes in figure.axes:
        spec = axes.get_subplotspec()
        if (
            spec is not None
            and not hasattr(axes, "_colorbar")
            and (key := (spec.get_gridspec(), spec.num1)) not in found
        ):
            found[key] = axes
            grids += [key[0]] * (key[0] not in grids)
            order.append((grids.index(key[0]), spec.rowspan.start, spec.colspan.start, key))
    return [found[place[-1]] for place in sorted(order, key=lambda place: place[:3])]  # as read, not as made


def _rows(panels: list[Axes]) -> list[list[Axes]]:
    """Panels by row, from the top."""
    rows: dict[Any, list[Axes]] = {}
    for axes in panels:
        spec = axes.get_subplotspec()
        assert spec is not None
        rows.setdefault((id(spec.get_gridspec()), spec.rowspan.start), []).append(axes)
    return list(rows.values())


def _of_axes(
    said: Mapping[str, Any], rows: list[list[Axes]], kind: str, what: str
) -> list[tuple[list[tuple[Axes, str]], Any]]:
    """What is said of `x`, `y`, `y1`, ..., with the axes it is said of."""
    found = []
    for name, value in said.items():
        direction, number = name[:1], name[1:]
        if direction not in ("x", "y") or (number and not number.isdecimal()):
            raise StudyError(f"plot {kind!r}: {what} of {name!r}: expected x or y, or y1, y2, ... of rows of panels")
        if number and not 1 <= int(number) <= len(rows):
            raise StudyError(f"plot {kind!r}: {what} of {name}: it has {counted(len(rows), 'row')} of panels")
        chosen = rows[int(number) - 1 : int(number)] if number else rows
        found.append(([(axes, direction) for row in chosen for axes in row], value))
    return found
