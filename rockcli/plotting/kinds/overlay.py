"""Compared cases over their reference: a column for each slenderness, motion or size, the difference below."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import (
    Array,
    axes_of,
    followed,
    group_label,
    has_overturned,
    is_numeric,
    number_at,
    reference_on_axes,
    reference_words,
    same_key,
    selection_note,
    spread,
    values_at,
)
from rockcli.plotting.common.ground import draw_ground, motions
from rockcli.plotting.common.labels import coordinate_label, title_of
from rockcli.plotting.common.response import SHOWN_UP_TO, over_alpha, response_of, window
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MOST_LINES,
    PANELS_ACROSS,
    QUIET,
    SINGLE,
    headline,
    legend_below,
    new_figure,
    panel_title,
    width_or,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_COLUMNS = 6

_HEIGHTS = {"ground": 0.5, "theta": 1.15, "rate": 0.8, "difference": 0.65}

_REFERENCE: dict[str, Any] = {"color": "#000000", "linewidth": 0.9, "dashes": (3.5, 1.8)}

Position = tuple[int, ...]


@dataclass(frozen=True)
class Point:
    """A place on some of the axes and its name: a column on those that are not compared, a curve on the others."""

    place: dict[str, int]
    label: str


def compares(dataset: xarray.Dataset) -> bool:
    """Whether there is something to lay over a reference."""
    reference = reference_on_axes(dataset)
    return any(dataset.sizes[axis] > 1 for axis in reference) and all(_arranged(dataset, reference))


def draw(dataset: xarray.Dataset) -> Figure:
    """Panels of a_g, theta/alpha, its rate and the difference to the reference, which is dashed and black."""
    reference = reference_on_axes(dataset)
    every = axes_of(dataset)
    columns, lines = _arranged(dataset, reference)
    shown, curves = spread(columns, MOST_COLUMNS), spread(lines, MOST_LINES)
    cases = [[_position(every, line.place | column.place) for line in curves] for column in shown]
    bases = [_base(every, column, reference) for column in shown]
    across = len(shown) if len(shown) <= PANELS_ACROSS else 2 if len(shown) == 4 else PANELS_ACROSS
    down = -(-len(shown) // across)
    names = [name for name in _HEIGHTS if name != "ground" and (name != "rate" or down == 1)]
    shaken = down == 1 and bool(motions(dataset, [position for column in cases for position in column] + bases))
    figure, grounds, grid = _laid_out(across, down, names, shaken=shaken, shared=_same_ground(dataset, bases))
    fell = False
    for number, column in enumerate(shown):
        row, at = divmod(number, across)
        panel = dict(zip(names, grid[row * len(names) : (row + 1) * len(names), at], strict=True))
        if number < len(grounds):
            found = motions(dataset, [*cases[number], bases[number]])
            draw_ground(grounds[number], dataset["time"].values, found, coloured=len(found) > 1)
        fell |= _column(panel, dataset, cases[number], bases[number])
        if column.label:
            top = grounds[number] if len(grounds) > 1 else panel["theta"]
            panel_title(top, column.label, figure.get_figwidth() / across, fontsize=9.0)
        if at == 0:
            _name_axes(panel)
        if number + across >= len(shown):
            panel["difference"].set_xlabel("time [s]")
            panel["difference"].tick_params(labelbottom=True)
    for number in range(len(shown), down * across):
        for axes in grid[(number // across) * len(names) : (number // across + 1) * len(names), number % across]:
            axes.set_axis_off()
    for axes in grounds[1:]:
        axes.set_ylabel("")
    seen = window(dataset, [position for column in cases for position in column] + bases)
    grid[0, 0].set_xlim(seen.start, seen.end)
    figure.align_ylabels()
    notes = (
        selection_note(len(shown), len(columns), "columns"),
        selection_note(len(curves), len(lines), "curves"),
        "crosses: overturning" if fell else "",
        seen.note,
    )
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    _legend(figure, curves, reference_words(dataset))
    return figure


def _arranged(dataset: xarray.Dataset, reference: dict[str, int]) -> tuple[list[Point], list[Point]]:
    """Columns and curves.

    A labelled axis on which the reference does not change (the geometry of a model, compared with the rigid block)
    gives curves, not columns, if there is room for them, and curves that are one then are drawn once.  Columns without
    the history of their reference, and curves without any, are left out.
    """
    columns, lines = _all_arranged(dataset, reference)
    every = axes_of(dataset)
    columns = [column for column in columns if followed(dataset, _base(every, column, reference))]
    return columns, [
        line
        for line in lines
        if any(followed(dataset, _position(every, line.place | column.place)) for column in columns)
    ]


def _all_arranged(dataset: xarray.Dataset, reference: dict[str, int]) -> tuple[list[Point], list[Point]]:
    """`_arranged`, whatever histories were saved."""
    every = axes_of(dataset)
    others = [axis for axis in every if axis not in reference]
    moved = [axis for axis in others if dataset.sizes[axis] > 1 and _same_along(dataset, axis, reference)]
    if moved:
        left = [axis for axis in others if axis not in moved]
        columns = _points(dataset, left)
        lines = _distinct(dataset, columns, [axis for axis in every if axis in reference or axis in moved], reference)
        if len(lines) <= MOST_LINES:
            return columns, lines
    lines = [point for point in _points(dataset, list(reference)) if point.place != reference]
    return _points(dataset, others), lines


def _same_along(dataset: xarray.Dataset, axis: str, reference: dict[str, int]) -> bool:
    """Whether the reference is the same at every point of a labelled axis."""
    if is_numeric(dataset, axis):
        return False
    every = axes_of(dataset)
    sizes = [1 if name in reference else int(dataset.sizes[name]) for name in every]
    for position in np.ndindex(*sizes):
        place = dict(zip(every, position, strict=True)) | reference
        if same_key(dataset, _position(every, place)) != same_key(dataset, _position(every, place | {axis: 0})):
            return False
    return True


def _distinct(dataset: xarray.Dataset, columns: list[Point], axes: list[str], reference: dict[str, int]) -> list[Point]:
    """Curves over some axes, those that are one in every column drawn once."""
    every = axes_of(dataset)
    groups: dict[object, list[dict[str, int]]] = {}
    for point in _points(dataset, axes):
        if all(point.place[axis] == i for axis, i in reference.items()):
            continue
        key = tuple(same_key(dataset, _position(every, point.place | column.place)) for column in columns)
        groups.setdefault(key, []).append(point.place)
    found = []
    for group in groups.values():
        positions = [_position(every, dict.fromkeys(every, 0) | place) for place in group]
        found.append(Point(group[0], group_label(dataset, positions, [a for a in axes if dataset.sizes[a] > 1])))
    return found


def _points(dataset: xarray.Dataset, axes: list[str]) -> list[Point]:
    """Every point of some axes, with its name."""
    found = []
    for position in np.ndindex(*(int(dataset.sizes[axis]) for axis in axes)):
        place = dict(zip(axes, (int(i) for i in position), strict=True))
        words = [coordinate_label(dataset, axis, i) for axis, i in place.items() if dataset.sizes[axis] > 1]
        found.append(Point(place, ", ".join(words)))
    return found


def _base(axes: tuple[str, ...], column: Point, reference: dict[str, int]) -> Position:
    return _position(axes, dict.fromkeys(axes, 0) | column.place | reference)


def _position(axes: tuple[str, ...], place: dict[str, int]) -> Position:
    return tuple(int(place[axis]) for axis in axes)


def _same_ground(dataset: xarray.Dataset, bases: list[Position]) -> bool:
    """Whether one motion, in one size, shakes all columns."""
    found = motions(dataset, bases)
    return len(found) == 1 and not found[0].scaled


def _laid_out(
    across: int, down: int, names: list[str], *, shaken: bool, shared: bool
) -> tuple[Figure, list[Axes], Any]:
    """A figure with panels for the ground (one across all columns if shared) and, below them, for the columns."""
    width = width_or(SINGLE * 1.35 if across == 1 else DOUBLE)
    heights = [_HEIGHTS[name] for name in names] * down
    if shaken:
        heights = [_HEIGHTS["ground"], *heights]
    figure = new_figure(width, 0.9 + 1.75 * sum(heights))
    spec = figure.add_gridspec(len(heights), across, height_ratios=heights)
    grounds: list[Axes] = []
    for column in range((1 if shared else across) if shaken else 0):
        first = grounds[0] if grounds else None
        spot = spec[0, :] if shared else spec[0, column]
        grounds.append(figure.add_subplot(spot, sharex=first, sharey=first))
        grounds[-1].tick_params(labelleft=column == 0, labelbottom=shared and across > 1)
    grid = np.empty((len(names) * down, across), dtype=object)
    for row, column in np.ndindex(*grid.shape):
        first = grounds[0] if grounds else grid[0, 0]
        axes = figure.add_subplot(spec[row + shaken, column], sharex=first, sharey=grid[row, 0])
        axes.tick_params(labelleft=column == 0, labelbottom=False)
        grid[row, column] = axes
    return figure, grounds, grid


def _width(number: int, count: int) -> float:
    """Later curves are thinner, so that those below them are seen where they coincide."""
    return 1.9 - 0.9 * number / max(count - 1, 1)


def _column(panel: dict[str, Axes], dataset: xarray.Dataset, cases: list[Position], base: Position) -> bool:
    """Draw a column; whether something in it overturns."""
    time = dataset["time"].values
    fell = False
    for number, case in enumerate([*cases, base]):
        is_base = number == len(cases)
        drawn: dict[str, Any] = (
            _REFERENCE | {"zorder": 4}
            if is_base
            else {"color": COLOURS[number], "linewidth": _width(number, len(cases)), "zorder": 3}
        )
        response = response_of(dataset, case)
        lost = has_overturned(dataset, case) & (np.abs(response.ratio) > SHOWN_UP_TO)
        panel["theta"].plot(response.time, np.where(lost, np.nan, response.ratio), **drawn)
        if "rate" in panel:
            panel["rate"].plot(response.time, np.where(lost, np.nan, response.rate), **drawn)
        if not is_base:
            gap = _difference(dataset, case, base)
            panel["difference"].plot(time, gap, color=COLOURS[number], linewidth=0.9, zorder=3)
        passed = number_at(dataset, "t_overturn", case)
        if np.isfinite(passed):
            fell = True
            known = np.isfinite(response.ratio)
            leaves = np.interp(passed, response.time[known], response.ratio[known])  # alpha, or where models 2, 3 fall
            mark = {"color": drawn["color"], "markersize": 4.0, "markeredgewidth": 1.0, "zorder": 5}
            panel["theta"].plot(passed, leaves, "x", **mark)
    for axes in panel.values():
        axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        axes.margins(y=0.08)
    if fell:
        for level in (-1.0, 1.0):
            panel["theta"].axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    return fell


def _difference(dataset: xarray.Dataset, case: Position, base: Position) -> Array:
    """(theta - theta_ref)/alpha over time, both over the alpha of their side, NaN once either has overturned."""
    one, other = (over_alpha(dataset, case, values_at(dataset, "theta", position)) for position in (case, base))
    until = np.fmin(number_at(dataset, "t_overturn", case), number_at(dataset, "t_overturn", base))
    late = dataset["time"].values >= until  # false where neither overturns
    return np.where(late, np.nan, one - other)


def _name_axes(panel: dict[str, Axes]) -> None:
    words = {
        "theta": r"$\theta/\alpha$",
        "rate": r"$\dot\theta/(p\,\alpha)$",
        "difference": r"$\Delta\theta/\alpha$",
    }
    for name, axes in panel.items():
        axes.set_ylabel(words[name])


def _legend(figure: Figure, lines: list[Point], reference: str) -> None:
    handles = [
        Line2D([], [], color=COLOURS[number], linewidth=_width(number, len(lines)), label=line.label)
        for number, line in enumerate(lines)
    ]
    handles.append(Line2D([], [], **_REFERENCE, label=f"{reference} (reference)"))
    legend_below(figure, handles, 4, handlelength=2.6)
