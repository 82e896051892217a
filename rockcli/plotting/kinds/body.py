"""Bodies: outlines or rectangles, centre of mass, the two edges, and alpha of each."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from matplotlib.patches import Arc, PathPatch
from matplotlib.ticker import MaxNLocator

from rockcli.plotting.common.cases import axes_of, group_label, selection_note, spread
from rockcli.plotting.common.labels import title_of
from rockcli.plotting.common.response import edges
from rockcli.plotting.common.shape import NARROWEST, body_of, outline, path_of, with_room_beside
from rockcli.plotting.common.style import (
    BODY_EDGE,
    BODY_FACE,
    COLOURS,
    DOUBLE,
    GROUND_LINE,
    MOST_PANELS,
    PAIR,
    QUIET,
    SINGLE,
    grid_of,
    headline,
    new_figure,
    panel_title,
    width_or,
)
from rockcli.scene.body.block import LEFT, RIGHT

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.text import Annotation

_ROW, _AROUND = 2.9, (0.85, 0.9)
"""Most that a row of panels is high, and what words take of a panel's width and height [in]."""

_ONE_LINE = 2.2
"""Width of a panel from which alpha and R stand on one line [in]."""

_BESIDE = 0.04
"""Part of the width left free beside words that stand beside a body."""

_SLIMMEST = 0.3
"""Width over height of the panel of a body with words beside it, which is higher than others, for the same."""

_MORE_LINES = 0.35
"""What alpha and R on lines of their own take [in]."""

_ROOM = 0.08
"""Room around narrow panels, twice that of others [in]."""

_OF_BODY = ("outline_x", "outline_z", "R", "alpha", "R_left", "R_right", "alpha_left", "alpha_right")


def without_outline(dataset: xarray.Dataset) -> str:
    """Why a dataset has no body to draw; "" if it has."""
    if "outline_x" not in dataset.variables or not np.isfinite(dataset["outline_x"].values).any():
        return "the dataset holds no outline of a body"
    return ""


def without_body(dataset: xarray.Dataset) -> str:
    """Why a dataset has no body to draw, of an outline or a rectangle; "" if it has."""
    known = {"R", "alpha"} <= set(map(str, dataset.variables)) and np.isfinite(dataset["R"].values).any()
    return "" if known else "the dataset holds no R and alpha of a body"


def draw(dataset: xarray.Dataset) -> Figure:
    """One panel per body."""
    bodies = _bodies(dataset)
    shown = spread(bodies, MOST_PANELS)
    rows, columns = grid_of(len(shown))
    width = width_or(SINGLE * 1.25 if columns == 1 else DOUBLE)
    figure = new_figure(width, 0.7 + rows * (3.4 if columns == 1 else _ROW))
    beside = columns == 1 and width >= PAIR  # where there is room beside the body
    narrow = width / columns < _ONE_LINE
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, position in zip(grid.flat, shown, strict=False):
        _draw(axes, dataset, position, beside=beside, narrow=narrow)
        if len(bodies) > 1:
            panel_title(axes, group_label(dataset, [position], _named(dataset)), width / columns)
    drawn = list(grid.flat)[: len(shown)]
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_axis_off()
    if columns > 1:  # no higher than the bodies are at this width
        slimmest = max(float(np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim())) for axes in drawn)
        high = min(_ROW, _AROUND[1] + slimmest * (width / columns - _AROUND[0])) + _MORE_LINES * narrow
        figure.set_figheight(0.7 + rows * high)
    headline(figure, title_of(dataset), selection_note(len(shown), len(bodies), "bodies"))
    if narrow:  # the layout may end with narrower numbers on an axis than are drawn
        cast("ConstrainedLayoutEngine", figure.get_layout_engine()).set(w_pad=_ROOM, h_pad=_ROOM)
    return figure


def _named(dataset: xarray.Dataset) -> list[str]:
    """The axes along which the body changes."""
    dims = {str(dim) for name in _OF_BODY if name in dataset.variables for dim in dataset[name].dims}
    return [axis for axis in axes_of(dataset) if axis in dims]


def _bodies(dataset: xarray.Dataset) -> list[tuple[int, ...]]:
    """Where on the axes each body is first met: one of an outline or, beside or without such, a rectangle."""
    named, axes = _named(dataset), axes_of(dataset)
    R = dataset["R"].transpose(*(axis for axis in axes if axis in dataset["R"].dims))
    sizes = [int(dataset.sizes[axis]) if axis in named else 1 for axis in axes]
    known = np.isfinite(R.values).reshape([dataset.sizes[axis] if axis in R.dims else 1 for axis in axes])
    return [tuple(int(i) for i in position) for position in np.argwhere(np.broadcast_to(known, sizes))]


def _draw(axes: Axes, dataset: xarray.Dataset, position: tuple[int, ...], *, beside: bool, narrow: bool) -> None:
    body = body_of(dataset, position)
    points = outline(body, 0.0)
    h = 0.5 * body.height
    size = float(np.ptp(points[np.isfinite(points[:, 0])], axis=0).max())
    axes.add_patch(PathPatch(path_of(points), facecolor=BODY_FACE, edgecolor=BODY_EDGE, linewidth=0.8, zorder=2))
    at = {LEFT: -0.5 * body.rise, RIGHT: 0.5 * body.rise}
    axes.axline((-body.left, at[LEFT]), (body.right, at[RIGHT]), color=GROUND_LINE, linewidth=1.0, zorder=1)
    R, alpha = edges(dataset, "R", position), edges(dataset, "alpha", position)
    sides = ((LEFT, -body.left, "left", COLOURS[1]), (RIGHT, body.right, "right", COLOURS[0]))
    lines = []
    for edge, x, side, colour in sides:
        axes.plot([x, 0.0], [at[edge], h], color=colour, linewidth=1.0, zorder=3)
        axes.plot([x, x], [at[edge], 0.9 * h], color=colour, linewidth=0.6, linestyle=(0, (4, 3)), zorder=3)
        axes.plot(x, at[edge], "^", color=colour, markersize=4.0, zorder=4, clip_on=False)
        begin, end = sorted((90.0, 90.0 - np.copysign(np.degrees(alpha[edge]), -x)))
        across = 1.1 * h
        axes.add_patch(
            Arc((x, at[edge]), across, across, theta1=begin, theta2=end, color=colour, linewidth=0.8, zorder=4)
        )
        words = rf"$\alpha_{{\mathrm{{{side}}}}}$ = {alpha[edge]:.4g} rad = {np.degrees(alpha[edge]):.3g}"
        lines.append((f"{words}\N{DEGREE SIGN}, $R$ = {R[edge]:.4g} m", colour))
    if np.allclose([alpha[LEFT], R[LEFT]], [alpha[RIGHT], R[RIGHT]], rtol=1e-9, atol=0.0):  # one line for both
        lines = [(lines[0][0].replace(r"_{\mathrm{left}}", ""), "black")]
    if narrow or (beside and len(lines) > 1):  # words of two edges are too long for the room beside a body
        lines = [(part, colour) for words, colour in lines for part in words.split(", ")]
    axes.plot(0.0, h, "o", color="black", markersize=4.0, zorder=5)
    axes.plot([0.0, 0.0], [0.0, h], color=QUIET, linewidth=0.6, linestyle=(0, (1, 2)), zorder=3)
    begin = 6.0 if beside else -32.0
    written = [
        axes.annotate(
            words,
            (0.5, 0.5 if beside else 0.0),
            (0.0, begin - 12.0 * number),
            xycoords="axes fraction",
            textcoords="offset points",
            color=colour,
            ha="left" if beside else "center",
            va="top",
            fontsize=8.0,
        )
        for number, (words, colour) in enumerate(lines)
    ]
    if beside:
        _stand_beside(axes, written)
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    axes.set_xlim(min(low[0], -body.left) - 0.08 * size, max(high[0], body.right) + 0.08 * size)
    axes.set_ylim(min(low[1], 0.0) - 0.03 * size, high[1] + 0.05 * size)
    with_room_beside(axes, _SLIMMEST if beside else NARROWEST)
    if narrow or beside:
        axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.set_aspect("equal")
    axes.set_xlabel("$x$ [m]" if narrow else "$x$ from the centre of mass [m]", labelpad=1.0)
    axes.set_ylabel("$z$ [m]")


def _stand_beside(axes: Axes, written: list[Annotation]) -> None:
    """Give words a column of their own at the right, which the layout of a panel with its scale leaves them."""
    figure = cast("Figure", axes.figure)
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    wide = max(words.get_window_extent(renderer).width for words in written) / figure.bbox.width + _BESIDE
    cast("ConstrainedLayoutEngine", figure.get_layout_engine()).set(rect=(0.0, 0.0, 1.0 - wide, 1.0))
    for words in written:
        words.xy, words.xycoords = (1.0 - wide, words.xy[1]), ("figure fraction", "axes fraction")
        words.set_in_layout(False)
