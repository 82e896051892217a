"""A body of a mesh: how it stands in the direction in which it rocks, and its barrier in every direction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.ticker import MaxNLocator

from rockcli.plotting.common.cases import (
    Array,
    axes_of,
    group_label,
    number_at,
    positions_on,
    selection_note,
    spread,
    values_at,
)
from rockcli.plotting.common.labels import title_of
from rockcli.plotting.common.shape import body_of, outline, path_of, with_room_beside
from rockcli.plotting.common.style import (
    BODY_EDGE,
    BODY_FACE,
    COLOURS,
    GROUND_LINE,
    PAIR,
    QUIET,
    SINGLE,
    headline,
    legend_of,
    new_figure,
    panel_title,
    width_or,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Position = tuple[int, ...]

_MOST_MESHES = 4
"""Meshes whose barriers are drawn over one another."""

_MOST_DIRECTIONS = 40
"""Directions of the study that are marked."""


def without_barriers(dataset: xarray.Dataset) -> str:
    """Why a dataset has no barriers by direction to draw; "" if it has."""
    return "" if "barrier" in dataset.variables else "the dataset holds no body of a mesh (block: {mesh: FILE.obj})"


def draw(dataset: xarray.Dataset) -> Figure:
    """The body in the direction of the first case, and the barriers of each mesh beside it, or below in a column."""
    bodies = _positions(dataset, ("barrier",))
    shown = spread(bodies, _MOST_MESHES)
    width = width_or(SINGLE)
    if width >= PAIR:
        figure = new_figure(width, 1.0 + 0.5 * width)
        grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.25), wspace=0.06)
    else:
        figure = new_figure(width, 2.5 + 0.9 * width)
        grid = figure.add_gridspec(2, 1, height_ratios=(1.0, 1.25), hspace=0.06)
    first = figure.add_subplot(grid[0])
    below: Any = figure.add_subplot(grid[1], projection="polar")
    _draw_body(first, dataset, bodies[0])
    azimuth = np.asarray(dataset["azimuth"].values, dtype=float)
    most = max(float(np.nanmax(values_at(dataset, "barrier", position))) for position in shown)
    unit, words = (1e3, "mm") if most < 1.0 else (1.0, "m")
    varying = [axis for axis in axes_of(dataset) if axis in dataset["barrier"].dims]
    for number, position in enumerate(shown):
        barrier = values_at(dataset, "barrier", position) * unit
        label = group_label(dataset, [position], varying) if len(bodies) > 1 else ""
        around = np.append(np.arange(len(azimuth)), 0)
        below.plot(azimuth[around], barrier[around], color=COLOURS[number], linewidth=1.1, label=label, zorder=3)
        if len(shown) == 1:
            below.fill(azimuth, barrier, color=COLOURS[number], alpha=0.12, linewidth=0.0, zorder=2)
    below.set_ylim(0.0, most * unit * 1.05)
    for number, position in enumerate(shown):
        _mark(below, dataset, position, (unit, words), COLOURS[number])
    below.set_rlabel_position(_beside_the_least(azimuth, values_at(dataset, "barrier", shown[0])))
    below.yaxis.set_major_locator(MaxNLocator(4, prune="lower"))
    below.tick_params(labelsize=7.5, pad=1.0)
    below.grid(color=QUIET, linewidth=0.4, alpha=0.6)
    below.spines["polar"].set_linewidth(0.4)
    below.set_title(f"barrier [{words}] by direction, from $x$ towards $y$", fontsize=8.5, pad=6.0)
    if len(shown) > 1:
        legend_of(figure, below, 2)
    if varying:  # several meshes, or one among other bodies
        panel_title(first, group_label(dataset, [bodies[0]], varying), width * (0.4 if width >= PAIR else 1.0))
    headline(figure, title_of(dataset), selection_note(len(shown), len(bodies), "meshes"))
    return figure


def _positions(dataset: xarray.Dataset, names: tuple[str, ...]) -> list[Position]:
    """Where on the axes each value of some variables is first met, those that are not known left out."""
    dims = {str(dim) for name in names if name in dataset.variables for dim in dataset[name].dims}
    return [each for each in positions_on(dataset, dims) if np.isfinite(values_at(dataset, names[0], each)).all()]


def _draw_body(axes: Axes, dataset: xarray.Dataset, position: Position) -> None:
    """The outline in the vertical plane of its direction, centre of mass, the corners that it turns about."""
    body = body_of(dataset, position)
    points = outline(body, 0.0)
    h = 0.5 * body.height
    lowest = float(np.nanmin(points[:, 1]))
    axes.add_patch(PathPatch(path_of(points), facecolor=BODY_FACE, edgecolor=BODY_EDGE, linewidth=0.8, zorder=2))
    axes.axhline(lowest, color=GROUND_LINE, linewidth=1.0, zorder=1)
    for x, z, colour in (
        (-body.left, -0.5 * body.rise, COLOURS[1]),
        (body.right, 0.5 * body.rise, COLOURS[0]),
    ):
        axes.plot([x, 0.0], [z, h], color=colour, linewidth=1.0, zorder=3)
        axes.plot(x, z, "^", color=colour, markersize=4.0, zorder=4, clip_on=False)
    axes.plot(0.0, h, "o", color="black", markersize=4.0, zorder=5)
    axes.plot([0.0, 0.0], [lowest, h], color=QUIET, linewidth=0.6, linestyle=(0, (1, 2)), zorder=3)
    axes.set_aspect("equal")
    axes.margins(0.06)
    with_room_beside(axes)
    towards = np.degrees(number_at(dataset, "rocks_towards", position)) % 360.0
    axes.set_xlabel(f"along {towards:.4g}\N{DEGREE SIGN}, from the centre of mass [m]", labelpad=1.0)
    axes.set_ylabel("$z$ [m]")


def _mark(axes: Axes, dataset: xarray.Dataset, position: Position, scale: tuple[float, str], colour: str) -> None:
    """The directions of the study on the barrier of their mesh; one alone with its numbers."""
    unit, words = scale
    every = _positions(dataset, ("rocks_towards", "barrier"))
    varying = [i for i, axis in enumerate(axes_of(dataset)) if axis in dataset["barrier"].dims]
    mine = [each for each in every if all(each[i] == position[i] for i in varying)]
    found = {tuple(number_at(dataset, name, each) for name in ("rocks_towards", "barrier_towards")) for each in mine}
    for direction, height in spread(sorted(found), _MOST_DIRECTIONS):
        axes.plot(direction, height * unit, "o", color=colour, markersize=3.5, zorder=5, clip_on=False)
    if len(found) == 1:
        here = height * unit
        axes.annotate(
            f"{np.degrees(direction) % 360.0:.4g}\N{DEGREE SIGN}: {here:.3g} {words}",
            (direction, here),
            (direction + 0.5, max(0.62 * axes.get_ylim()[1], here)),
            fontsize=8.0,
            color=colour,
            ha="center",
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6},
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
            zorder=6,
        )


def _beside_the_least(azimuth: Array, barrier: Array) -> float:
    """A direction near the least barrier, where nothing is drawn and the numbers of the rings are read best [deg]."""
    return float(np.degrees(azimuth[int(np.argmin(barrier))]) - 22.0)
