"""Peak rotation along one numeric axis, a curve for each point of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.cases import axes_of, is_numeric, pick, selection_note
from rockcli.plotting.labels import axis_label, title_of, variable_label
from rockcli.plotting.map import is_log, scale_axes
from rockcli.plotting.style import COLOURS, QUIET, SINGLE, headline, legend_beside, new_figure

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_CURVES = 8


def along(dataset: xarray.Dataset) -> str | None:
    """The longest numeric axis."""
    numeric = [a for a in axes_of(dataset) if is_numeric(dataset, a) and dataset.sizes[a] >= 2]
    return max(numeric, key=lambda a: int(dataset.sizes[a]), default=None)


def draw(dataset: xarray.Dataset) -> Figure:
    """Curves of theta_peak_over_alpha; overturned points are crosses on the upper rim."""
    axis = along(dataset)
    if axis is None:
        raise ValueError("a curve needs a numeric axis")
    every = axes_of(dataset)
    others = tuple(name for name in every if name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    figure = new_figure(SINGLE * 1.3, 3.3)
    axes = figure.add_subplot()
    x = dataset[axis].values
    curves = []
    for case in shown:
        rest = {a: i for a, i in zip(every, case.position, strict=True) if a in others}
        curves.append(dataset["theta_peak_over_alpha"].isel(rest).values)
    finite = np.concatenate([c[np.isfinite(c)] for c in curves])
    top = 1.08 * max(float(finite.max(initial=0.0)), 0.1)
    marker = "o" if len(x) <= 40 else ""
    lost = False
    for number, (case, y) in enumerate(zip(shown, curves, strict=True)):
        style: dict[str, Any] = {"marker": marker, "markersize": 2.8, "markeredgewidth": 0.0}
        axes.plot(x, np.where(np.isfinite(y), y, np.nan), label=case.label, color=COLOURS[number], **style)
        over = np.isposinf(y)
        lost |= bool(over.any())
        rim = top * (1.0 - 0.035 * number)
        axes.plot(x[over], np.full(over.sum(), rim), "x", color=COLOURS[number], markersize=3.5, markeredgewidth=0.8)
    _frame(axes, top, x_log=is_log(x))
    axes.set_xlabel(axis_label(dataset, axis))
    axes.set_ylabel(variable_label("theta_peak_over_alpha"))
    notes = (selection_note(len(shown), total, "curves"), "crosses: overturned" if lost else "")
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    if len(shown) > 1:
        longest = max(len(case.label) for case in shown)
        legend_beside(figure, axes, columns=3 if longest < 20 else 2 if longest < 34 else 1)
    return figure


def _frame(axes: Axes, top: float, *, x_log: bool) -> None:
    if top > 1.0:
        axes.axhline(1.0, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    axes.set_ylim(0.0, top * 1.04)
    scale_axes(axes, x_log)
