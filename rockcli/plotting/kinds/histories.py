"""Histories: rotation, angular velocity, sliding and ground acceleration against time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array, Shown, number_at, outcome_at, pick, selection_note, values_at
from rockcli.plotting.common.ground import draw_ground, height_of, motions, panels_of, uplift_at
from rockcli.plotting.common.labels import lifts_word, title_of, unit_in_brackets, variable_label
from rockcli.plotting.common.response import (
    SHOWN_UP_TO,
    Position,
    Window,
    impacts_of,
    over_alpha,
    response_of,
    sliding_speed,
    symmetric,
    window,
)
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LINES,
    MOST_CURVES,
    QUIET,
    headline,
    legend_of,
    new_figure,
    width_or,
)
from rockcli.scene.counted import counted

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Fill = Callable[..., None]
"""Draws cases into a panel: (axes, dataset, cases shown, window)."""

_RATES_UP_TO = 4
"""Curves up to which the rate is drawn too: more of them are only readable with room for theta."""

_IMPACTS_UP_TO = 3
"""Curves up to which impacts are marked."""

MOST_IMPACTS = 30
"""Marks up to which impacts are marked: more of them make a band."""

_FOLLOWED, _LEAST = 2.0, 0.1
"""Part of a panel that bodies that overturn have beside others: over the peak of those, and at least [alpha]."""

_SLOW = 0.1
"""Impacts slower than this fraction of the fastest are not marked: near rest they would make a bar."""


def draw(dataset: xarray.Dataset) -> Figure:
    """Panels over a common time axis: ground acceleration, theta/alpha, sliding, theta_dot.

    Sliding has a panel where something slides; where nothing else moves it is the only response.
    """
    shown, total = pick(dataset, MOST_CURVES)
    positions = [case.position for case in shown]
    found = motions(dataset, positions)
    uplift, word = uplift_at(dataset, positions), lifts_word(dataset)
    grounds = panels_of(found)
    panels = _panels(dataset, positions)
    heights = [(0.55 if len(grounds) < 2 else 0.42) * height_of(panel) for panel in grounds]
    heights += [height for height, _ in panels]
    figure = new_figure(width_or(DOUBLE), 0.6 + 1.75 * sum(heights))
    grid = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    time = dataset["time"].values
    seen = window(dataset, positions)
    for axes, panel in zip(grid, grounds, strict=False):
        coloured = len(shown) > 1 and len(found) > 1
        draw_ground(axes, time, panel, coloured=coloured, named=len(grounds) > 1, uplift=uplift, word=word)
    _alike([grid[number] for number in range(len(grounds))])
    for axes, (_, fill) in zip(grid[len(grounds) :], panels, strict=True):
        fill(axes, dataset, shown, seen)
    grid[-1].set_xlabel("time [s]")
    grid[-1].set_xlim(seen.start, seen.end)
    figure.align_ylabels()
    notes = [selection_note(len(shown), total)]
    if len(shown) == 1:
        notes += [shown[0].label, _summary(dataset, shown[0])]
    notes.append(seen.note)
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    if len(shown) > 1:
        legend_of(figure, grid[len(grounds)])
    return figure


def _panels(dataset: xarray.Dataset, positions: list[Position]) -> list[tuple[float, Fill]]:
    """Heights of the panels of the response, and what draws them."""
    crowded = len(positions) > _RATES_UP_TO
    slides = any(sliding_speed(dataset, position).any() for position in positions)
    turns = any(np.nan_to_num(values_at(dataset, "theta", position)).any() for position in positions)
    if not slides:
        return [(1.6, _rotation)] if crowded else [(1.0, _rotation), (0.75, _rate)]
    if not turns:
        return [(1.6 if crowded else 1.2, _slide)]
    return [(1.3, _rotation), (1.1, _slide)] if crowded else [(1.0, _rotation), (0.85, _slide), (0.75, _rate)]


def _alike(panels: list[Axes]) -> None:
    """The same scale for all panels of one quantity."""
    if len({axes.get_ylabel() for axes in panels}) == 1:
        limits = np.array([axes.get_ylim() for axes in panels])
        for axes in panels:
            axes.set_ylim(limits[:, 0].min(), limits[:, 1].max())


def _rotation(axes: Axes, dataset: xarray.Dataset, shown: list[Shown], seen: Window) -> None:
    low, high = 0.0, 0.0
    fell: list[Array] = []
    marks = [_marked_impacts(dataset, case, seen) for case in shown]
    marked = len(shown) <= _IMPACTS_UP_TO and sum(len(mark) for mark in marks) <= MOST_IMPACTS
    for number, case in enumerate(shown):
        colour = COLOURS[number]
        response = response_of(dataset, case.position)
        outcome = outcome_at(dataset, case.position)
        if outcome == "sliding":  # it does not turn: its panel is below
            axes.plot([], [], label=_label(dataset, case), **_look(dataset, case, number))
            continue
        axes.plot(response.time, response.ratio, label=_label(dataset, case), zorder=3, **_look(dataset, case, number))
        if marked and len(impacts := marks[number]):
            known = np.isfinite(response.ratio)  # 0 at the impacts of a body on two edges, not of one that rolls
            where = np.interp(impacts, response.time[known], response.ratio[known])
            axes.plot(impacts, where, "o", color=colour, markersize=2.6, markeredgewidth=0.0, zorder=4)
        if len(shown) == 1:
            _mark_peak(axes, dataset, case)
        reach = response.ratio
        if outcome.startswith("overturned"):
            fell.append(reach)
            reach = _before_the_fall(reach)
        low = min(low, float(np.nanmin(reach, initial=0.0)))
        high = max(high, float(np.nanmax(reach, initial=0.0)))
    # what overturns leaves the panel with its last swing, which is followed no further than the others need room
    most = min(SHOWN_UP_TO, max(_FOLLOWED * max(high, -low), _LEAST)) if len(fell) < len(shown) else SHOWN_UP_TO
    for ratio in fell:
        low = min(low, float(np.nanmin(np.maximum(ratio, -most), initial=0.0)))
        high = max(high, float(np.nanmax(np.minimum(ratio, most), initial=0.0)))
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    margin = _limits(axes, low, high)
    for level in (-1.0, 1.0):
        if low - margin < level < high + margin:
            axes.axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    axes.set_ylabel(r"$\theta/\alpha$")


def _before_the_fall(ratio: Array) -> Array:
    """The swings of a body that overturns from which it came back: up to its last passage through zero."""
    known = ratio[np.isfinite(ratio) & (ratio != 0.0)]
    passed = np.flatnonzero(known[1:] * known[:-1] < 0.0)
    return np.asarray(known[: passed[-1] + 1 if len(passed) else 0])


def _look(dataset: xarray.Dataset, case: Shown, number: int) -> dict[str, Any]:
    """Colour and style of a case; one that is unresolved is no answer, and pale."""
    pale = outcome_at(dataset, case.position) == "unresolved"
    look: dict[str, Any] = {"color": COLOURS[number], "linestyle": LINES[number % len(LINES)]}
    return look | ({"alpha": 0.4, "linewidth": 0.7} if pale else {})


def _mark_peak(axes: Axes, dataset: xarray.Dataset, case: Shown) -> None:
    """A ring at the peak of a body that comes back."""
    when, ratio = _peak(dataset, case.position)
    if np.isfinite(when) and np.isfinite(ratio):
        axes.plot(when, ratio, "o", markersize=5.0, markerfacecolor="none", color="black", zorder=5)
        words = f"{ratio:.3g}".replace("-", "\N{MINUS SIGN}")
        axes.annotate(words, (when, ratio), (6.0, 0.0), textcoords="offset points", va="center", fontsize=8.0)


def _peak(dataset: xarray.Dataset, position: Position) -> tuple[float, float]:
    """When |theta|/alpha is largest [s], and theta/alpha then; NaN or infinite for a body that does not come back.

    `t_peak` is the time of the largest rotation, which on two different edges may be another: then the sample is told
    in which |theta|/alpha is largest.
    """
    names = ("t_peak", "theta_peak", "theta_peak_over_alpha")
    when, peak, most = (number_at(dataset, name, position) for name in names)
    ratio = float(over_alpha(dataset, position, np.array(peak)))
    if symmetric(dataset, position) or not most > (1.0 + 1e-9) * abs(ratio):
        return when, ratio
    response = response_of(dataset, position)
    at = int(np.nanargmax(np.abs(response.ratio)))
    return float(response.time[at]), float(np.copysign(most, response.ratio[at]))


def _label(dataset: xarray.Dataset, case: Shown) -> str:
    """A case in the legend, with what became of it unless it rocks or stays at rest."""
    outcome = outcome_at(dataset, case.position)
    if outcome.startswith("overturned"):
        return f"{case.label} (overturns)"
    return f"{case.label} ({outcome})" if outcome in ("failed", "unresolved", "sliding") else case.label or "response"


def _slide(axes: Axes, dataset: xarray.Dataset, shown: list[Shown], seen: Window) -> None:
    low, high = 0.0, 0.0
    time = dataset["time"].values
    for number, case in enumerate(shown):
        u = values_at(dataset, "slide", case.position)
        axes.plot(time, u, label=_label(dataset, case), zorder=3, **_look(dataset, case, number))
        low, high = min(low, float(np.nanmin(u, initial=0.0))), max(high, float(np.nanmax(u, initial=0.0)))
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    _limits(axes, low, high)
    axes.set_ylabel("sliding " + variable_label("slide"))


def _marked_impacts(dataset: xarray.Dataset, case: Shown, seen: Window) -> Array:
    t, before, _ = impacts_of(dataset, case.position)
    speed = np.abs(before)
    return t[(speed >= _SLOW * float(np.max(speed, initial=0.0))) & (t >= seen.start) & (t <= seen.end)]


def _rate(axes: Axes, dataset: xarray.Dataset, shown: list[Shown], seen: Window) -> None:
    low, high = 0.0, 0.0
    for number, case in enumerate(shown):
        if outcome_at(dataset, case.position) == "sliding":
            continue
        response = response_of(dataset, case.position)
        rate = response.theta_dot
        axes.plot(response.time, rate, zorder=3, **_look(dataset, case, number))
        near = np.isfinite(rate) & (np.abs(response.ratio) <= SHOWN_UP_TO)
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


def _summary(dataset: xarray.Dataset, case: Shown) -> str:
    outcome = outcome_at(dataset, case.position)
    if outcome == "sliding":
        peak, end = (number_at(dataset, name, case.position) for name in ("slide_peak", "slide_residual"))
        most = f"slides at most {peak:.3g} m, " if np.isfinite(peak) else ""
        return most + (f"{abs(end):.3g} m in the end" if np.isfinite(end) else "slides on for ever")
    if outcome != "rocking":
        return outcome.replace("_", " ")
    peak = number_at(dataset, "theta_peak_over_alpha", case.position)
    when = _peak(dataset, case.position)[0]
    impacts = number_at(dataset, "n_impacts", case.position)
    words = rf"peak $|\theta|/\alpha$ = {peak:.4g}" + (f" at {when:.3g} s" if np.isfinite(when) else "")
    return words + (f", {counted(round(impacts), 'impact')}" if np.isfinite(impacts) else "")
