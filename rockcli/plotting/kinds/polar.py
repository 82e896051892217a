"""Peak rotation by direction, of the motion or of the body: a polar plot in degrees, the worst direction marked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array, axes_of, in_order, is_numeric, pick, selection_note
from rockcli.plotting.common.labels import path_of, title_of, variable_label
from rockcli.plotting.common.style import (
    COLOURS,
    LINES,
    MARKERS,
    MOST_CURVES,
    QUIET,
    SINGLE,
    headline,
    legend_of,
    new_figure,
    width_or,
)
from rockcli.scene.variables import PEAK

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

_DIRECTIONS = ("angle", "direction")
"""Ends of the paths of axes of directions."""

_FEWEST = 5

_TELLING = 0.2
"""Peak over the largest from which the worst direction of a curve is marked."""

_BESIDE, _ABOVE, _BELOW = 0.4, 0.2, 0.25
"""Room for the angles and numbers at either side of a half circle, above and below it [in]."""

_TITLE, _GAP = 0.25, 0.06
"""Room for the title of the panel, and next to those of the figure [in]."""

_EDGE, _EDGES = 1.12, (1.17, 1.06)
"""Radius at which what overturns is marked, over the largest drawn; outermost and innermost of several curves."""


def towards(dataset: xarray.Dataset) -> str | None:
    """The axis of directions; None if there is none."""
    for axis in axes_of(dataset):
        directions = path_of(dataset, axis).rsplit(".", 1)[-1] in _DIRECTIONS
        if directions and is_numeric(dataset, axis) and dataset.sizes[axis] >= _FEWEST:
            return axis
    return None


def without_directions(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if towards(dataset) is None:
        return "the dataset has no axis of directions (vary: motion.record.angle or block.direction, at least five)"
    return "" if PEAK in dataset.variables else f"{PEAK} was not saved"


def draw(dataset: xarray.Dataset) -> Figure:
    """A curve for each point of the other axes; crosses at the edge overturn, a ring marks the worst direction."""
    axis = towards(dataset)
    assert axis is not None
    dataset = in_order(dataset, axis)
    others = tuple(name for name in axes_of(dataset) if name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    angle = np.asarray(dataset[axis].values, dtype=float)
    curves = [np.asarray(dataset[PEAK].isel(case.place).values, dtype=float) for case in shown]
    closed = _closes(angle)
    flat = not closed and angle.min() >= 0.0 and angle.max() > 0.5 * np.pi  # a half circle, above its diameter
    width = width_or(SINGLE)
    side = width - 2.0 * _BESIDE
    figure = new_figure(width, 0.9 + 0.95 * width)
    axes: Any = figure.add_subplot(projection="polar")
    top = max((float(np.max(y, where=np.isfinite(y), initial=0.0)) for y in curves), default=0.0) or 1.0
    if top > 0.7:
        top = max(top, 1.0)
    ringed = False
    fallen = sum(bool(np.isposinf(y).any()) for y in curves)
    edges = iter(top * np.linspace(*_EDGES, fallen) if fallen > 1 else [_EDGE * top])
    for number, (case, y) in enumerate(zip(shown, curves, strict=True)):
        around = np.append(np.arange(len(angle)), 0) if closed else np.arange(len(angle))
        colour = COLOURS[number]
        finite = np.where(np.isfinite(y), y, np.nan)
        axes.plot(angle[around], finite[around], color=colour, linestyle=LINES[number % len(LINES)], label=case.label,
                  marker=MARKERS[number], markersize=2.4, markeredgewidth=0.0)  # fmt: skip
        if len(shown) == 1 and np.isfinite(y).all():
            axes.fill(angle, y, color=colour, alpha=0.12, linewidth=0.0)
        fell = np.isposinf(y)
        edge = next(edges) if fell.any() else 0.0
        axes.plot(angle[fell], np.full(int(fell.sum()), edge), "x", color=colour, markersize=3.5)
        if not fell.any() and np.isfinite(y).any() and np.nanmax(finite) > _TELLING * top:
            ringed, worst = True, int(np.nanargmax(finite))
            axes.plot(angle[worst], y[worst], "o", markersize=6.5, markerfacecolor="none", color="black", zorder=5)
            words = f"{np.degrees(angle[worst]):.4g}\N{DEGREE SIGN}: {y[worst]:.3g}"
            box = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.8}
            how: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7.5, "zorder": 6, "bbox": box}
            axes.annotate(words, (angle[worst], y[worst]), (8.0, 4.0), **how)
    if not closed:
        low, high = np.degrees(angle.min()), np.degrees(angle.max())
        axes.set_thetamin(30.0 * np.floor(low / 30.0 + 1e-9))
        axes.set_thetamax(30.0 * np.ceil(high / 30.0 - 1e-9))
    axes.set_rlim(0.0, 1.2 * top)
    axes.set_rlabel_position(_free(angle, curves))
    axes.yaxis.get_major_locator().base.set_params(nbins=4, prune="lower")
    axes.tick_params(labelsize=7.5, pad=1.0)
    axes.grid(color=QUIET, linewidth=0.4, alpha=0.6)
    place = {"y": 0.75 + _ABOVE / side} if flat else {}
    axes.set_title(f"{variable_label(PEAK)} by direction", fontsize=8.5, pad=8.0, **place)
    missing = sum(int(np.isnan(y).sum()) for y in curves)
    notes = (
        selection_note(len(shown), total, "curves"),
        "ring: worst direction" if ringed else "",
        "crosses: overturned" if any(np.isposinf(y).any() for y in curves) else "",
        f"{missing} of {len(shown) * len(angle)} cases without an answer left out" if missing else "",
    )
    headline(figure, title_of(dataset), "; ".join(filter(None, notes)))
    if len(shown) > 1:
        legend_of(figure, axes, 3)
    if flat:
        _crop(figure, axes, side)
    return figure


def _crop(figure: Figure, axes: Any, side: float) -> None:
    """Place the square `side` [in] of a half circle, two quarters of it empty, between title and legend."""
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    beside = [figure._suptitle, *figure.legends]  # type: ignore[attr-defined]
    title, legend = (
        sum(each.get_window_extent(renderer).height / figure.dpi + _GAP for each in some if each is not None)
        for some in (beside[:1], beside[1:])
    )
    high = legend + _BELOW + 0.5 * side + _ABOVE + _TITLE + title
    figure.set_figheight(high)
    low = legend + _BELOW - 0.25 * side
    axes.set_position((_BESIDE / figure.get_figwidth(), low / high, side / figure.get_figwidth(), side / high))


def _closes(angle: Array) -> bool:
    """Whether directions go all around, so that the last and the first are neighbours."""
    step = float(np.max(np.diff(angle), initial=0.0))
    return bool(2.0 * np.pi - np.ptp(angle) <= 1.5 * step)


def _free(angle: Array, curves: list[Array]) -> float:
    """A direction in which little is drawn, for the numbers of the rings [deg]."""
    size = np.max([np.nan_to_num(y, nan=0.0, posinf=np.nanmax(y[np.isfinite(y)], initial=1.0)) for y in curves], axis=0)
    return float(np.degrees(angle[int(np.argmin(size))]) + 11.0)
