"""Rotation, its rate and the ground acceleration against time."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.cases import (
    Array,
    Shown,
    number_at,
    outcome_at,
    pick,
    selection_note,
    values_at,
)
from rockcli.plotting.labels import title_of, unit_in_brackets
from rockcli.plotting.style import COLOURS, DOUBLE, QUIET, headline, legend_beside, new_figure

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_CURVES = 8

_RATES_UP_TO = 4
"""Curves up to which the rate is drawn too: more of them are only readable with room for theta."""

_IMPACTS_UP_TO = 3
"""Curves up to which impacts are marked."""

_SLOW = 0.1
"""Impacts slower than this fraction of the fastest are not marked: near rest they would make a bar."""

_SHOWN_UP_TO = 1.3
"""|theta|/alpha beyond which an overturning body is no longer followed."""

_G = 9.81
"""Unit of acceleration in plots [m/s^2], whatever the g of the study."""


def draw(dataset: xarray.Dataset) -> Figure:
    """Panels over a common time axis: ground acceleration, theta/alpha, theta_dot."""
    shown, total = pick(dataset, MOST_CURVES)
    moving = "a_g" in dataset and bool(np.nanmax(np.abs(dataset["a_g"].values), initial=0.0) > 0.0)
    crowded = len(shown) > _RATES_UP_TO
    heights = {
        "ground": 0.55 if moving else 0.0,
        "theta": 1.6 if crowded else 1.0,
        "rate": 0.0 if crowded else 0.75,
    }
    names = [name for name, height in heights.items() if height]
    figure = new_figure(DOUBLE, 0.6 + 1.75 * sum(heights.values()))
    grid = figure.subplots(len(names), 1, sharex=True, squeeze=False, height_ratios=[heights[n] for n in names])
    panel: dict[str, Axes] = dict(zip(names, grid[:, 0], strict=True))
    if moving:
        _ground(panel["ground"], dataset, shown)
    _rotation(panel["theta"], dataset, shown)
    if not crowded:
        _rate(panel["rate"], dataset, shown)
    _time_axis(panel, dataset, shown)
    figure.align_ylabels()
    notes = [selection_note(len(shown), total)]
    if len(shown) == 1:
        notes.append(_summary(dataset, shown[0]))
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    if total > 1:
        legend_beside(figure, panel["theta"], columns=_columns(shown))
    return figure


def _columns(shown: list[Shown]) -> int:
    longest = max(len(re.sub(r"\\[a-z]+|[$,]", "", case.label)) for case in shown)
    most = max(1, min(len(shown), 4, int(125 / (longest + 14))))
    rows = -(-len(shown) // most)
    return -(-len(shown) // rows)


def _ground(axes: Axes, dataset: xarray.Dataset, shown: list[Shown]) -> None:
    time = dataset["time"].values
    ground = [values_at(dataset, "a_g", case.position) / _G for case in shown]
    same = all(_agree(ground[0], other) for other in ground[1:])
    longest = max(ground, key=lambda a: int(np.isfinite(a).sum()))
    for number, a in enumerate([longest] if same else ground):
        axes.plot(time, a, color="#333333" if same else COLOURS[number], linewidth=0.7)
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    axes.set_ylabel(r"$a_g$ [g]")


def _agree(a: Array, b: Array) -> bool:
    both = np.isfinite(a) & np.isfinite(b)
    return bool(np.array_equal(a[both], b[both]))


def _rotation(axes: Axes, dataset: xarray.Dataset, shown: list[Shown]) -> None:
    time = dataset["time"].values
    low, high = 0.0, 0.0
    for number, case in enumerate(shown):
        colour = COLOURS[number]
        ratio = _ratio(dataset, case.position)
        fate = outcome_at(dataset, case.position)
        ended = fate.startswith("overturned")
        label = case.label + (" (overturns)" if ended else f" ({fate})" if fate in ("failed", "unresolved") else "")
        axes.plot(time, ratio, color=colour, label=label or "response", zorder=3)
        if len(shown) <= _IMPACTS_UP_TO:
            impacts = _marked_impacts(dataset, case)
            axes.plot(impacts, np.zeros_like(impacts), "o", color=colour, markersize=2.6, markeredgewidth=0.0, zorder=4)
        seen = np.clip(ratio, -_SHOWN_UP_TO, _SHOWN_UP_TO) if ended else ratio
        low = min(low, float(np.nanmin(seen, initial=0.0)))
        high = max(high, float(np.nanmax(seen, initial=0.0)))
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    margin = _limits(axes, low, high)
    for level in (-1.0, 1.0):
        if low - margin < level < high + margin:
            axes.axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    axes.set_ylabel(r"$\theta/\alpha$")


def _marked_impacts(dataset: xarray.Dataset, case: Shown) -> Array:
    if "t_impact" not in dataset or "theta_dot_before" not in dataset:
        return np.empty(0)
    speed = np.abs(values_at(dataset, "theta_dot_before", case.position))
    fastest = float(np.nanmax(speed, initial=0.0))
    return values_at(dataset, "t_impact", case.position)[speed >= _SLOW * fastest]


def _rate(axes: Axes, dataset: xarray.Dataset, shown: list[Shown]) -> None:
    time = dataset["time"].values
    low, high = 0.0, 0.0
    for number, case in enumerate(shown):
        rate = values_at(dataset, "theta_dot", case.position)
        axes.plot(time, rate, color=COLOURS[number], zorder=3)
        near = np.isfinite(rate) & (np.abs(_ratio(dataset, case.position)) <= _SHOWN_UP_TO)
        low = min(low, float(np.min(rate, where=near, initial=0.0)))
        high = max(high, float(np.max(rate, where=near, initial=0.0)))
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    _limits(axes, low, high)
    axes.set_ylabel(r"$\dot\theta$" + unit_in_brackets("rad s-1"))


def _limits(axes: Axes, low: float, high: float) -> float:
    """Room for what lies between low and high; the margin left above and below."""
    margin = 0.08 * (high - low) or 0.1
    axes.set_ylim(low - margin, high + margin)
    return margin


def _time_axis(panel: dict[str, Axes], dataset: xarray.Dataset, shown: list[Shown]) -> None:
    last = list(panel.values())[-1]
    last.set_xlabel("time [s]")
    time = dataset["time"].values
    alive = np.zeros(len(time), dtype=bool)
    for case in shown:
        alive |= np.isfinite(values_at(dataset, "theta", case.position))
    end = float(time[alive][-1]) if alive.any() else float(time[-1])
    last.set_xlim(0.0, end if end > 0.0 else 1.0)


def _ratio(dataset: xarray.Dataset, position: tuple[int, ...]) -> Array:
    return values_at(dataset, "theta", position) / number_at(dataset, "alpha", position)


def _summary(dataset: xarray.Dataset, case: Shown) -> str:
    fate = outcome_at(dataset, case.position)
    if fate != "rocking":
        return fate.replace("_", " ")
    peak = number_at(dataset, "theta_peak_over_alpha", case.position)
    when = number_at(dataset, "t_peak", case.position)
    impacts = number_at(dataset, "n_impacts", case.position)
    words = rf"peak $|\theta|/\alpha$ = {peak:.4g}" + (f" at {when:.3g} s" if np.isfinite(when) else "")
    return words + (f", {impacts:.0f} impacts" if np.isfinite(impacts) else "")
