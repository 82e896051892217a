"""Boundaries between outcomes of a refined map as lines: overturning spectra for a journal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import axes_of
from rockcli.plotting.common.labels import axis_label, axis_symbol, axis_values, title_of
from rockcli.plotting.common.style import COLOURS, MOST_CURVES, SINGLE, headline, legend_below, new_figure, width_or
from rockcli.plotting.kinds.map import is_log, plane, scale_axes

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

_STYLES: dict[str, Any] = {"uplift": ":", "overturning": "-", "overturning_after_impact": (0, (3.5, 1.6))}

_WORDS = {
    "uplift": "uplift",
    "overturning": "overturning",
    "overturning_after_impact": "overturning with and without impact",
}


def without_boundaries(dataset: xarray.Dataset) -> str:
    """Why a dataset has no boundaries to draw; "" if it has."""
    if "boundary_curve" not in dataset.variables:
        return "the dataset holds no boundary curves (refine: true)"
    return "" if dataset["boundary_curve"].size else "one outcome is all there is: no boundary"


def draw(dataset: xarray.Dataset) -> Figure:
    """All curves in one panel: the style tells what changes, the colour which point of the other axes."""
    found = plane(dataset)
    assert found is not None
    others = tuple(axis for axis in axes_of(dataset) if axis not in found)
    said = [dataset[f"boundary_{axis}"].values for axis in others]
    group = np.array([", ".join(_named(dataset, others, point)) for point in zip(*said, strict=True)])
    groups = list(dict.fromkeys(group.tolist())) if others else [""]
    meanings = str(dataset["boundary"].attrs["flag_meanings"]).split()
    kinds, numbers = dataset["boundary"].values, dataset["boundary_curve"].values
    x, y = (dataset[f"boundary_{axis}"].values * _scale(dataset, axis) for axis in found)
    figure = new_figure(width_or(SINGLE * 1.3), SINGLE)
    axes = figure.subplots()
    begins = np.flatnonzero(np.diff(numbers, prepend=-1))
    for begin, end in zip(begins, [*begins[1:], len(numbers)], strict=True):
        which = groups.index(group[begin]) if others else 0
        if which < MOST_CURVES:
            style = _STYLES[meanings[kinds[begin]]]
            axes.plot(x[begin:end], y[begin:end], color=_colour(which, others), linestyle=style, linewidth=0.9)
    values = [axis_values(dataset, axis) for axis in found]
    scale_axes(axes, *(is_log(v) for v in values))
    axes.set_xlim(values[0].min(), values[0].max())
    axes.set_ylim(values[1].min(), values[1].max())
    axes.set_xlabel(axis_label(dataset, found[0]))
    axes.set_ylabel(axis_label(dataset, found[1]))
    handles = [
        Line2D([], [], color="black", linestyle=_STYLES[meanings[kind]], label=_WORDS[meanings[kind]])
        for kind in np.unique(kinds)
    ]
    shown = enumerate(groups[:MOST_CURVES]) if others else ()
    handles += [Line2D([], [], color=_colour(i, others), label=label) for i, label in shown]
    legend_below(figure, handles, 2)
    left = f"{MOST_CURVES} of {len(groups)} maps" if len(groups) > MOST_CURVES else ""
    headline(figure, title_of(dataset), left)
    return figure


def _named(dataset: xarray.Dataset, others: tuple[str, ...], point: tuple[Any, ...]) -> list[str]:
    shown = (f"{value:.4g}" if isinstance(value, float) else str(value) for value in point)
    return [f"{axis_symbol(dataset, axis)} = {value}" for axis, value in zip(others, shown, strict=True)]


def _colour(which: int, others: tuple[str, ...]) -> str:
    return COLOURS[which] if others else "black"


def _scale(dataset: xarray.Dataset, axis: str) -> float:
    """What figures multiply the values of an axis with: accelerations are shown in g."""
    raw, shown = dataset[axis].values, axis_values(dataset, axis)
    at = int(np.argmax(np.abs(raw)))
    return float(shown[at] / raw[at])
