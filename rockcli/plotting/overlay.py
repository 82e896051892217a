"""Compared cases over their reference: a column for each slenderness, motion or size, the difference below."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.cases import (
    Array,
    axes_of,
    number_at,
    outcome_at,
    reference_on_axes,
    reference_words,
    selection_note,
    values_at,
)
from rockcli.plotting.labels import coordinate_label, title_of
from rockcli.plotting.style import COLOURS, DOUBLE, QUIET, SINGLE, headline, new_figure

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_COLUMNS, MOST_CURVES = 6, 7

_ACROSS = 3
"""Columns beside one another; more go below."""

_SHOWN_UP_TO = 1.3
"""|theta|/alpha beyond which an overturning body is no longer followed."""

_G = 9.81
"""Unit of acceleration in plots [m/s^2], whatever the g of the study."""

_HEIGHTS = {"ground": 0.5, "theta": 1.15, "rate": 0.8, "difference": 0.65}

_REFERENCE: dict[str, Any] = {"linewidth": 0.9, "dashes": (3.5, 1.8), "zorder": 4}

Position = tuple[int, ...]
T = TypeVar("T")


@dataclass(frozen=True)
class Point:
    """A place on some of the axes and its name: a column on those that are not compared, a curve on the others."""

    place: dict[str, int]
    label: str


def compares(dataset: xarray.Dataset) -> bool:
    """Whether there is something to lay over a reference."""
    reference = reference_on_axes(dataset)
    return bool(reference) and any(dataset.sizes[axis] > 1 for axis in reference)


def draw(dataset: xarray.Dataset) -> Figure:
    """Panels of a_g, theta/alpha, its rate and the difference to the reference, which is dashed and black."""
    reference = reference_on_axes(dataset)
    every = axes_of(dataset)
    columns = _points(dataset, tuple(axis for axis in every if axis not in reference))
    lines = [point for point in _points(dataset, tuple(reference)) if point.place != reference]
    shown, curves = _spread(columns, MOST_COLUMNS), _spread(lines, MOST_CURVES)
    across = len(shown) if len(shown) <= _ACROSS else 2 if len(shown) == 4 else _ACROSS
    down = -(-len(shown) // across)
    names = [name for name in _HEIGHTS if _worth(name, dataset, down)]
    width = SINGLE * 1.35 if across == 1 else DOUBLE
    heights = [_HEIGHTS[name] for name in names]
    figure = new_figure(width, 0.9 + down * 1.75 * sum(heights))
    grid = figure.subplots(
        down * len(names), across, sharex=True, sharey="row", squeeze=False, height_ratios=heights * down
    )
    end = 0.0
    fell = False
    for number, column in enumerate(shown):
        row, at = divmod(number, across)
        block = dict(zip(names, grid[row * len(names) : (row + 1) * len(names), at], strict=True))
        cases = [_position(every, column.place | line.place) for line in curves]
        base = _position(every, column.place | reference)
        end = max(end, _end(dataset, [*cases, base]))
        fell |= _column(block, dataset, cases, base)
        if column.label:
            block[names[0]].set_title(column.label, fontsize=9.0)
        if at == 0:
            _name_axes(block, dataset)
        if number + across >= len(shown):
            block[names[-1]].set_xlabel("time [s]")
            block[names[-1]].tick_params(labelbottom=True)
    for number in range(len(shown), down * across):
        for axes in grid[(number // across) * len(names) : (number // across + 1) * len(names), number % across]:
            axes.set_axis_off()
    grid[0, 0].set_xlim(0.0, end or 1.0)
    figure.align_ylabels()
    notes = (
        selection_note(len(shown), len(columns), "columns"),
        selection_note(len(curves), len(lines), "curves"),
        "crosses: overturning" if fell else "",
    )
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    _legend(figure, curves, reference_words(dataset))
    return figure


def _points(dataset: xarray.Dataset, axes: tuple[str, ...]) -> list[Point]:
    """Every point of some axes, with its name."""
    found = []
    for position in np.ndindex(*(int(dataset.sizes[axis]) for axis in axes)):
        place = dict(zip(axes, (int(i) for i in position), strict=True))
        words = [coordinate_label(dataset, axis, i) for axis, i in place.items() if dataset.sizes[axis] > 1]
        found.append(Point(place, ", ".join(words).replace("_", " ")))
    return found


def _spread(items: list[T], most: int) -> list[T]:
    if len(items) <= most:
        return items
    return [items[int(i)] for i in np.unique(np.linspace(0, len(items) - 1, most).round())]


def _position(axes: tuple[str, ...], place: dict[str, int]) -> Position:
    return tuple(place[axis] for axis in axes)


def _worth(name: str, dataset: xarray.Dataset, down: int) -> bool:
    """Ground motion where there is one, and rates, as long as one row of columns leaves room for them."""
    if name == "ground":
        moving = "a_g" in dataset and bool(np.nanmax(np.abs(dataset["a_g"].values), initial=0.0) > 0.0)
        return moving and down == 1
    return name != "rate" or down == 1


def _column(panel: dict[str, Axes], dataset: xarray.Dataset, cases: list[Position], base: Position) -> bool:
    """Draw a column; whether something in it overturns."""
    time = dataset["time"].values
    if "ground" in panel:
        ground = values_at(dataset, "a_g", _longest(dataset, [*cases, base])) / _G
        panel["ground"].plot(time, ground, color="#333333", linewidth=0.7)
    fell = False
    for number, case in enumerate([*cases, base]):
        is_base = number == len(cases)
        colour = "#000000" if is_base else COLOURS[number]
        drawn: dict[str, Any] = (
            _REFERENCE if is_base else {"linewidth": 1.9 - 0.9 * number / max(len(cases) - 1, 1), "zorder": 3}
        )
        alpha, p = number_at(dataset, "alpha", case), number_at(dataset, "p", case)
        ratio = values_at(dataset, "theta", case) / alpha
        lost = outcome_at(dataset, case).startswith("overturned") & (np.abs(ratio) > _SHOWN_UP_TO)
        panel["theta"].plot(time, np.where(lost, np.nan, ratio), color=colour, **drawn)
        if "rate" in panel:
            rate = values_at(dataset, "theta_dot", case) / (p * alpha)
            panel["rate"].plot(time, np.where(lost, np.nan, rate), color=colour, **drawn)
        if not is_base:
            panel["difference"].plot(time, _difference(dataset, case, base), color=colour, linewidth=0.9, zorder=3)
        passed = number_at(dataset, "t_overturn", case)
        if np.isfinite(passed):
            fell = True
            side = np.sign(ratio[np.flatnonzero(np.isfinite(ratio))[-1]])
            panel["theta"].plot(passed, side, "x", color=colour, markersize=4.0, markeredgewidth=1.0, zorder=5)
    for axes in panel.values():
        axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        axes.margins(y=0.08)
    if fell:
        for level in (-1.0, 1.0):
            panel["theta"].axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    return fell


def _difference(dataset: xarray.Dataset, case: Position, base: Position) -> Array:
    """(theta - theta_ref)/alpha over time, NaN once either has overturned."""
    gap = values_at(dataset, "theta", case) - values_at(dataset, "theta", base)
    until = np.fmin(number_at(dataset, "t_overturn", case), number_at(dataset, "t_overturn", base))
    late = dataset["time"].values >= until  # false where neither overturns
    return np.where(late, np.nan, gap) / number_at(dataset, "alpha", case)


def _longest(dataset: xarray.Dataset, cases: list[Position]) -> Position:
    return max(cases, key=lambda case: int(np.isfinite(values_at(dataset, "a_g", case)).sum()))


def _end(dataset: xarray.Dataset, cases: list[Position]) -> float:
    """Last time at which one of the cases has moved: nothing is seen of the rest after it."""
    last = 0.0
    time = dataset["time"].values
    for case in cases:
        theta = values_at(dataset, "theta", case)
        moving = np.flatnonzero(np.isfinite(theta) & (theta != 0.0))
        last = max(last, float(time[min(moving[-1] + 1, len(time) - 1)]) if len(moving) else 0.0)
    return last


def _name_axes(panel: dict[str, Axes], dataset: xarray.Dataset) -> None:
    words = {
        "ground": r"$a_g$ [g]",
        "theta": r"$\theta/\alpha$",
        "rate": r"$\dot\theta/(p\,\alpha)$",
        "difference": r"$\Delta\theta/\alpha$",
    }
    for name, axes in panel.items():
        axes.set_ylabel(words[name])


def _legend(figure: Figure, lines: list[Point], reference: str) -> None:
    handles = [
        Line2D([], [], color=COLOURS[number], linewidth=1.1, label=line.label) for number, line in enumerate(lines)
    ]
    last = Line2D([], [], color="#000000", linewidth=0.9, label=f"{reference} (reference)")
    last.set_dashes((3.5, 1.8))
    handles.append(last)
    longest = max(len(str(handle.get_label())) for handle in handles)
    fitting = max(1, min(len(handles), int(figure.get_figwidth() * 15) // (longest + 6)))
    figure.legend(handles=handles, loc="outside lower center", ncols=fitting, columnspacing=1.4, handlelength=2.6)
