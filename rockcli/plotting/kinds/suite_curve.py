"""What a suite comes to along one numeric axis: the share that overturns and the median peak, a curve for each body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import axes_of, in_order, is_numeric, isolated, pick, selection_note
from rockcli.plotting.common.labels import axis_label, axis_values, title_of, variable_label
from rockcli.plotting.common.style import (
    COLOURS,
    LINES,
    MARKERS,
    MOST_CURVES,
    SINGLE,
    headline,
    legend_of,
    new_figure,
    width_or,
)
from rockcli.plotting.common.suite import left_out_words, members_word, suite_of
from rockcli.plotting.kinds.map import is_log, scale_axes
from rockcli.scene.variables import PEAK

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

SHARE, MEDIAN = "p_overturned", f"{PEAK}_p50"


def along(dataset: xarray.Dataset) -> str | None:
    """The longest numeric axis that a suite without intensities leaves; None where there is none, or no suite."""
    suite = suite_of(dataset)
    if suite is None or suite.along is not None or SHARE not in dataset.variables:
        return None
    left = [str(axis) for axis in dataset[SHARE].dims if is_numeric(dataset, str(axis)) and dataset.sizes[axis] >= 2]
    return max(left, key=lambda axis: int(dataset.sizes[axis]), default=None)


def draw(dataset: xarray.Dataset) -> Figure:
    """The share above, the median of the peak below it where it was saved; a median that overturns is a gap."""
    axis, suite = along(dataset), suite_of(dataset)
    if axis is None or suite is None:
        raise ValueError("a suite and a numeric axis beside it are needed")
    dataset = in_order(dataset, axis)
    others = tuple(name for name in axes_of(dataset) if name in dataset[SHARE].dims and name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    rows = [name for name in (SHARE, MEDIAN) if name in dataset.variables]
    figure = new_figure(width_or(SINGLE * 1.3), 0.9 + 1.9 * len(rows))
    grid = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
    x = axis_values(dataset, axis)
    for number, case in enumerate(shown):
        style: dict[str, Any] = {"marker": MARKERS[number] if len(x) <= 40 else "", "markersize": 3.0}
        style |= {"color": COLOURS[number], "linestyle": LINES[number % len(LINES)], "markeredgewidth": 0.0}
        for axes, name in zip(grid, rows, strict=True):
            y = np.asarray(dataset[name].isel(case.place).values, dtype=float)
            axes.plot(x, np.where(np.isfinite(y), y, np.nan), label=case.label, **style)
            if not style["marker"] and len(alone := isolated(y)):
                axes.plot(x[alone], y[alone], "o", color=COLOURS[number], markersize=1.6, markeredgewidth=0.0)
    grid[0].set_ylabel("share that overturns")
    grid[0].set_ylim(-0.02, 1.02)
    if MEDIAN in rows:
        grid[-1].set_ylabel(f"median {variable_label(PEAK)}")
        grid[-1].set_ylim(bottom=0.0)
    scale_axes(grid[-1], is_log(x))
    grid[-1].set_xlabel(axis_label(dataset, axis))
    members = members_word(dataset, suite) if suite.axis in dataset.sizes else ""  # "": over several axes
    fallen = MEDIAN in rows and bool(np.isposinf(dataset[MEDIAN].values).any())
    missing = left_out_words(dataset, suite, shown) if suite.axis in dataset.sizes else ""
    notes = [
        members,
        missing,
        selection_note(len(shown), total, "curves"),
        "no median where half or more overturn" * fallen,
    ]
    headline(figure, title_of(dataset), "; ".join(filter(None, notes)))
    if len(shown) > 1:
        legend_of(figure, grid[0], 3)
    return figure
