"""Peak rotation, or what a search found, along one numeric axis, a curve for each point of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.common.cases import Array, axes_of, in_order, is_numeric, isolated, pick, selection_note
from rockcli.plotting.common.labels import axis_label, axis_values, shown_unit, title_of, variable_label
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
from rockcli.plotting.common.suite import suite_of
from rockcli.plotting.kinds.map import is_log, scale_axes
from rockcli.plotting.kinds.spectrum import found_label
from rockcli.scene.response import FAILED, SLIDING, UNRESOLVED, overturned
from rockcli.scene.thresholds import BELOW, BRACKETED, FOUND, NONE
from rockcli.scene.variables import PEAK

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STRIP = ("failed", "unresolved", "no answer", "not solved", "below range", "sliding", "overturned", "none in range")
"""What has no value, or slides and has none but 0, from the bottom of the strip upwards."""


_SOME_POINTS = 5


def along(dataset: xarray.Dataset) -> str | None:
    """The longest numeric axis."""
    numeric = [a for a in axes_of(dataset) if is_numeric(dataset, a) and dataset.sizes[a] >= 2]
    return max(numeric, key=lambda a: int(dataset.sizes[a]), default=None)


def quantity(dataset: xarray.Dataset) -> str:
    """What is drawn: the peak, or what a search found (`find: overturning`), which has none; "" where neither is."""
    found = [str(name) for name in dataset.data_vars if str(name).endswith(FOUND)]
    return PEAK if PEAK in dataset.variables else found[0] if found and suite_of(dataset) is None else ""


def telling(dataset: xarray.Dataset) -> bool:
    """Whether curves are worth drawing unasked: not many curves of few points, of which some would be left out."""
    axis = along(dataset)
    points = int(dataset.sizes[axis]) if axis else 0
    curves = int(np.prod([dataset.sizes[other] for other in axes_of(dataset) if other != axis]))
    return points >= _SOME_POINTS or curves <= MOST_CURVES


def draw(dataset: xarray.Dataset) -> Figure:
    """Curves of the peak, or of the lowest overturning value; what has none, or slides, is marked in a strip above."""
    axis = along(dataset)
    if axis is None:
        raise ValueError("a curve needs a numeric axis")
    dataset = in_order(dataset, axis)
    others = tuple(name for name in axes_of(dataset) if name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    x = axis_values(dataset, axis)
    name = quantity(dataset)
    divisor = shown_unit(dataset, name)[0]
    curves = [np.asarray(dataset[name].isel(case.place).values, dtype=float) / divisor for case in shown]
    missing = [without_value(dataset, case.place, y) for case, y in zip(shown, curves, strict=True)]
    rows = [row for row in STRIP if any(row in found for found in missing)]
    thick = 0.14 + 0.03 * len(shown)
    figure = new_figure(width_or(SINGLE * 1.3), 3.3 + thick * len(rows))
    heights = [thick * len(rows), 2.4] if rows else [2.4]
    grid = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    axes = grid[-1]
    marker = "o" if len(x) <= 40 else ""
    for number, (case, y) in enumerate(zip(shown, curves, strict=True)):
        style: dict[str, Any] = {"marker": marker and MARKERS[number], "markersize": 3.0, "markeredgewidth": 0.0}
        style |= {"color": COLOURS[number], "linestyle": LINES[number % len(LINES)]}
        axes.plot(x, np.where(np.isfinite(y), y, np.nan), label=case.label, **style)
        alone = isolated(y) if not marker else np.zeros(0, dtype=int)
        axes.plot(x[alone], y[alone], "o", color=COLOURS[number], markersize=1.4, markeredgewidth=0.0)
    finite = np.concatenate([y[np.isfinite(y)] for y in curves])
    low, top = 1.12 * float(finite.min(initial=0.0)), 1.12 * float(finite.max(initial=0.0))
    if top > 1.0 and name == PEAK:
        axes.axhline(1.0, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    axes.set_ylim(low, top if top > low else 0.1)
    axes.set_xlabel(axis_label(dataset, axis))
    axes.set_ylabel(variable_label(PEAK) if name == PEAK else found_label(dataset, name))
    if rows:
        _strip(grid[0], x, rows, missing)
    scale_axes(axes, is_log(x))
    notes = [selection_note(len(shown), total, "curves"), _islands(dataset, name)]
    headline(figure, title_of(dataset), "; ".join(filter(None, notes)), over=axes)
    if len(shown) > 1:
        legend_of(figure, axes, 3)
    return figure


def without_value(dataset: xarray.Dataset, place: dict[str, int], peaks: Array) -> dict[str, NDArray[np.bool_]]:
    """Where a curve has no value, or the body slides, by the reason."""
    found = {"overturned": np.isposinf(peaks), "no answer": np.isnan(peaks)}
    if f"{quantity(dataset)}_state" in dataset.variables:
        state = dataset[f"{quantity(dataset)}_state"].isel(place).values
        found = {"none in range": state == NONE, "below range": state == BELOW, "no answer": state == BRACKETED}
    if "outcome" in dataset.variables:
        flags = dataset["outcome"].isel(place).values
        found |= {"failed": flags == FAILED, "unresolved": flags == UNRESOLVED, "sliding": flags == SLIDING}
        found["no answer"] &= ~found["failed"] & ~found["unresolved"]
        if "solved" in dataset.variables:  # a refined map knows what became of the others, and not how far they turned
            filled = dataset["solved"].isel(place).values == 0
            found |= {"overturned": overturned(flags), "not solved": filled & found["no answer"] & ~overturned(flags)}
            found["no answer"] &= ~filled
    return {name: where for name, where in found.items() if where.any()}


def _islands(dataset: xarray.Dataset, name: str) -> str:
    """How many of the values that a search found have stable islands above them."""
    if f"{name}_islands" not in dataset.variables:
        return ""
    count = dataset[f"{name}_islands"].values
    return f"stable islands above {np.sum(count > 0)} of {count.size} points" if (count > 0).any() else ""


def _strip(axes: Axes, x: Array, rows: list[str], missing: list[dict[str, NDArray[np.bool_]]]) -> None:
    """A row for each reason, in it a line of the marks of each curve."""
    for level, row in enumerate(rows):
        for number, found in enumerate(missing):
            where = x[found[row]] if row in found else np.empty(0)
            height = level + 0.8 * ((len(missing) - number - 0.5) / len(missing) - 0.5)
            axes.plot(
                where,
                np.full(len(where), height),
                MARKERS[number],
                color=COLOURS[number],
                markersize=2.8,
                markeredgewidth=0.0,
            )
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(-0.5, len(rows) - 0.5)
    axes.tick_params(axis="y", length=0.0)
    axes.tick_params(axis="x", which="both", length=0.0)
    axes.spines["bottom"].set_visible(False)
    axes.spines["left"].set_visible(False)
    axes.axhline(-0.5, color=QUIET, linewidth=0.6)
