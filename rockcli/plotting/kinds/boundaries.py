"""Boundaries between outcomes of a refined map as lines: overturning spectra for a journal.

A boundary lies somewhere between two neighbouring points of the map.  Half-way between them it goes in steps; it is
drawn as a smooth line that stays between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import Array, axes_of
from rockcli.plotting.common.labels import axis_label, axis_values, coordinate_label, title_of
from rockcli.plotting.common.style import COLOURS, MOST_CURVES, SINGLE, headline, legend_below, new_figure, width_or
from rockcli.plotting.kinds.map import is_log, plane, scale_axes

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

_STYLES: dict[str, Any] = {"uplift": ":", "overturning": "-", "overturning_after_impact": (0, (3.5, 1.6))}

_SMOOTHED = 30
"""Times that the points of a line move towards their neighbours: steps go, and a circle does not shrink yet."""

_ISLAND = 12
"""Points of a closed line that is drawn as such; of smaller ones the map does not know the shape, and a dot says so."""

_DOT: dict[str, Any] = {"linestyle": "", "marker": "o", "markersize": 1.8, "markeredgewidth": 0.0}

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
    group = np.array([", ".join(words) for words in zip(*(_named(dataset, axis) for axis in others), strict=True)])
    groups = list(dict.fromkeys(group.tolist())) if others else [""]
    meanings = str(dataset["boundary"].attrs["flag_meanings"]).split()
    kinds, numbers = dataset["boundary"].values, dataset["boundary_curve"].values
    places = [_places(dataset, axis) for axis in found]
    values = [axis_values(dataset, axis) for axis in found]
    width = width_or(SINGLE * 1.3)
    figure = new_figure(width, max(SINGLE, 0.9 + 0.56 * width))
    axes = figure.subplots()
    dots = False
    begins = np.flatnonzero(np.diff(numbers, prepend=-1))
    for begin, end in zip(begins, [*begins[1:], len(numbers)], strict=True):
        which = groups.index(group[begin]) if others else 0
        if which < MOST_CURVES:
            line = np.column_stack([place[begin:end] for place in places])
            small = end - begin < _ISLAND and bool((line[0] == line[-1]).all())
            line = line[: max(1, len(line) - 1)].mean(axis=0, keepdims=True) if small else smoothed(line)
            style = _DOT if small else {"linestyle": _STYLES[meanings[kinds[begin]]], "linewidth": 0.9}
            x, y = (np.interp(i, np.arange(len(v)), v) for i, v in zip(line.T, values, strict=True))
            axes.plot(x, y, color=_colour(which, others), **style)
            dots |= small
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
    if dots:
        handles.append(Line2D([], [], color="black", label="islands of a few points of the map", **_DOT))
    legend_below(figure, handles, 2)
    left = f"{MOST_CURVES} of {len(groups)} maps" if len(groups) > MOST_CURVES else ""
    headline(figure, title_of(dataset), left)
    return figure


def _named(dataset: xarray.Dataset, axis: str) -> list[str]:
    """Where on another axis each point of the boundaries is, in words."""
    there, which = np.unique(dataset[f"boundary_{axis}"].values, return_inverse=True)
    values = dataset[axis].values
    words = [coordinate_label(dataset, axis, int(np.flatnonzero(values == value)[0])) for value in there]
    return [words[i] for i in which]


def _colour(which: int, others: tuple[str, ...]) -> str:
    return COLOURS[which] if others else "black"


def _places(dataset: xarray.Dataset, axis: str) -> Array:
    """Points of the boundaries along an axis, in numbers of its points."""
    along = np.asarray(dataset[axis].values, dtype=float)
    order = np.argsort(along)
    return np.asarray(np.interp(dataset[f"boundary_{axis}"].values, along[order], order.astype(float)))


def smoothed(line: Array) -> Array:
    """A line (n, 2) between points of a map, in numbers of its points, without its steps.

    No point leaves its place by more than half the distance of two points of the map; ends stay where they are.
    """
    closed = len(line) > 1 and bool((line[0] == line[-1]).all())
    found = line
    for _ in range(_SMOOTHED):
        before, after = (np.roll(found[:-1], 1, axis=0), found[1:]) if closed else (found[:-2], found[2:])
        inner = found[:-1] if closed else found[1:-1]
        moved = 0.5 * inner + 0.25 * (before + after)
        found = np.concatenate([moved, moved[:1]]) if closed else np.concatenate([found[:1], moved, found[-1:]])
        found = np.clip(found, line - 0.5, line + 0.5)
    return found
