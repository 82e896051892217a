"""Flexible columns beside other models: rotation of the base, displacement of the top, its part due to bending."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import Shown, axes_of, has_overturned, pick, selection_note, values_at
from rockcli.plotting.common.ground import draw_ground, motions
from rockcli.plotting.common.labels import path_of, title_of, variable_label
from rockcli.plotting.common.response import SHOWN_UP_TO, Window, over_alpha, window
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MOST_COLUMNS,
    MOST_LINES,
    QUIET,
    headline,
    legend_below,
    new_figure,
    panel_title,
    trace_title,
    width_or,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

BENDING = "u_top_bending"

_ROWS: tuple[str, ...] = ("theta", "u_top", BENDING)
"""Rows from the top."""

_GROUND, _ROW, _STRIP = 0.5, 0.85, 0.45
"""Heights of the panels of a_g, of the rows below it, and of bending where it has several, over 1.75 in."""

_APART = ("motion", "block", "initial", "let", "g")
"""Axes under these keys are columns; cases that differ in anything else are compared with one another."""

_DASHES: tuple[tuple[float, ...], ...] = ((), (3.5, 1.5), (6.0, 1.5, 1.2, 1.5), (1.2, 1.4))
"""Dash patterns, in turn, for curves that lie on one another."""

Position = tuple[int, ...]


def bends(dataset: xarray.Dataset) -> bool:
    """Whether a dataset has the bending of a flexible body in it."""
    if BENDING not in dataset.variables:
        return False
    return bool(np.nanmax(np.abs(dataset[BENDING].values), initial=0.0) > 0.0)


def without_bending(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn; "" if it can."""
    missing = [name for name in ("theta", "u_top", "alpha", "time") if name not in dataset.variables]
    if missing:
        return "the dataset holds no histories (save: {histories: true})"
    return "" if bends(dataset) else "no body in the dataset bends (model: flexible)"


def draw(dataset: xarray.Dataset) -> Figure:
    """A column for each motion, body or start; in each the ground, if it moves, and the rows of all models.

    Of several bodies that bend each has a panel of its bending: vibrations over one another hide one another.
    """
    every = axes_of(dataset)
    across = tuple(axis for axis in every if _apart(dataset, axis))
    lines = tuple(axis for axis in every if axis not in across)
    if not any(dataset.sizes[axis] > 1 for axis in lines):  # nothing to compare in a column
        across, lines = (), every
    columns, n_columns = pick(dataset, MOST_COLUMNS, across)
    curves, n_curves = pick(dataset, MOST_LINES, lines)
    cases = [[_join(column.position, curve.position) for curve in curves] for column in columns]
    grounds = [motions(dataset, positions) for positions in cases]
    bent = [i for i in range(len(curves)) if any(_bends(dataset, positions[i]) for positions in cases)]
    below = [[i] for i in bent] if len(bent) > 1 else [[*range(len(curves))]]
    rows = [*((name, [*range(len(curves))]) for name in _ROWS if name != BENDING), *((BENDING, each) for each in below)]
    heights = [_GROUND] * any(grounds) + [_STRIP if name == BENDING and len(below) > 1 else _ROW for name, _ in rows]
    figure = new_figure(width_or(DOUBLE), 0.7 + 1.75 * sum(heights))
    grid = figure.subplots(len(heights), len(columns), sharex="col", sharey="row", squeeze=False, height_ratios=heights)
    notes = [selection_note(len(columns), n_columns, "columns"), selection_note(len(curves), n_curves, "curves")]
    limits = dict.fromkeys(_ROWS, (0.0, 0.0))
    fell = False
    for number, (column, positions) in enumerate(zip(columns, cases, strict=True)):
        panels = grid[:, number]
        seen = window(dataset, positions)
        if grounds[number]:
            draw_ground(panels[0], dataset["time"].values, grounds[number], coloured=len(grounds[number]) > 1)
        for axes, (name, members) in zip(panels[-len(rows) :], rows, strict=True):
            for i in members:
                low, high = _curve(axes, dataset, name, positions[i], seen, i)
                limits[name] = min(limits[name][0], low), max(limits[name][1], high)
            axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
            if len(members) < len(curves) and number == 0:
                trace_title(axes, curves[members[0]].label, width_or(DOUBLE) / len(columns))
        fell |= any(has_overturned(dataset, position) for position in positions)
        panel_title(panels[0], column.label, width_or(DOUBLE) / len(columns), fontsize=9.0)
        panels[-1].set_xlabel("time [s]")
        panels[-1].set_xlim(seen.start, seen.end)
        if len(columns) == 1:
            notes.append(seen.note)
    for line, (name, _) in zip(grid[-len(rows) :], rows, strict=True):
        _name(line, name, limits[name])
    figure.align_ylabels()
    notes.append("crosses: overturning" if fell else "")
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    _legend(figure, curves)
    return figure


def _apart(dataset: xarray.Dataset, axis: str) -> bool:
    return path_of(dataset, axis).removeprefix("case.").split(".")[0] in _APART


def _join(one: Position, other: Position) -> Position:
    """A position from its parts, each 0 on the axes of the other."""
    return tuple(i + j for i, j in zip(one, other, strict=True))


def _curve(
    axes: Axes, dataset: xarray.Dataset, name: str, position: Position, seen: Window, number: int
) -> tuple[float, float]:
    """Draw one history, with a cross where an overturning body leaves; its lowest and highest value that matter."""
    if name not in dataset.variables:
        return 0.0, 0.0
    time = np.asarray(dataset["time"].values, dtype=float)
    theta = values_at(dataset, "theta", position)
    ratio = over_alpha(dataset, position, theta)
    values = ratio if name == "theta" else values_at(dataset, name, position)
    last = len(time)
    inside = (time >= seen.start) & (time <= seen.end) & np.isfinite(values)
    if has_overturned(dataset, position):
        standing = np.flatnonzero(np.abs(ratio) <= 1.0)
        followed = np.flatnonzero(np.abs(ratio) <= SHOWN_UP_TO)
        last = followed[-1] + 2 if len(followed) else 0
        inside[max(last - 1, 0) :] = False
        if name == "theta" and len(standing):
            at = standing[-1]
            axes.plot(time[at], values[at], "x", color=COLOURS[number], markersize=5.0, markeredgewidth=1.1, zorder=5)
    axes.plot(time[:last], values[:last], zorder=3, **_look(number, dashed=name != BENDING))
    if not inside.any():
        return 0.0, 0.0
    return float(values[inside].min()), float(values[inside].max())


def _look(number: int, *, dashed: bool = True) -> dict[str, Any]:
    """Colour, width and dashes of a curve; vibration is not dashed, which would hide it."""
    dashes = _DASHES[number % len(_DASHES)] if dashed else ()
    look: dict[str, Any] = {"color": COLOURS[number % len(COLOURS)], "linewidth": 0.9 if dashed else 0.7}
    return look | ({"dashes": dashes} if dashes else {})


def _bends(dataset: xarray.Dataset, position: Position) -> bool:
    return bool(np.nan_to_num(values_at(dataset, BENDING, position)).any())


def _name(line: NDArray[Any], name: str, limits: tuple[float, float]) -> None:
    """Label of a row, room for what it shows, and theta = alpha where it is in sight."""
    low, high = limits
    margin = 0.08 * (high - low) or 0.1
    for axes in line:
        axes.set_ylim(low - margin, high + margin)
        for level in (-1.0, 1.0):
            if name == "theta" and low - margin < level < high + margin:
                axes.axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
        axes.set_ylabel("")
    line[0].set_ylabel(r"$\theta_{\mathrm{base}}/\alpha$" if name == "theta" else variable_label(name))


def _legend(figure: Figure, curves: list[Shown]) -> None:
    if len(curves) < 2:
        return
    handles = [Line2D([], [], label=curve.label, **_look(number)) for number, curve in enumerate(curves)]
    legend_below(figure, handles)
