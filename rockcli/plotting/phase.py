"""Phase portrait: rate of rotation against rotation, impacts as jumps, with the separatrix of free rocking."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.cases import Array, number_at, outcome_at, pick, reference_words, selection_note, values_at
from rockcli.plotting.labels import title_of
from rockcli.plotting.style import COLOURS, DOUBLE, QUIET, SINGLE, headline, new_figure

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS = 6

_GREY = "#B9B9B9"

_WIDE = 0.5
"""Reach from which the whole separatrix is shown."""

_SHOWN_UP_TO = 1.6
"""|theta|/alpha beyond which an overturning body is no longer followed."""


def draw(dataset: xarray.Dataset) -> Figure:
    """One panel per case, theta_dot/(p alpha) against theta/alpha."""
    shown, total = pick(dataset, MOST_PANELS)
    columns = 1 if len(shown) == 1 else 2 if len(shown) in (2, 4) else 3
    rows = -(-len(shown) // columns)
    width = SINGLE * 1.25 if columns == 1 else DOUBLE
    figure = new_figure(width, 0.7 + rows * (width / columns) * 0.86)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    reach = np.zeros(2)
    for number, case in enumerate(shown):
        axes = grid.flat[number]
        reach = np.maximum(reach, _portrait(axes, dataset, case.position, width=0.9 if len(shown) == 1 else 0.6))
        if case.reference is not None:
            _portrait(axes, dataset, case.reference, width=0.6, quiet=True)
        fate = outcome_at(dataset, case.position).replace("_", " ")
        words = ", ".join(part for part in (case.label, "" if fate == "rocking" else fate) if part)
        axes.set_title(words, fontsize=8.5)
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_axis_off()
    wide = bool(reach.max() > _WIDE)
    across = 1.08 * max(reach[0], 1.0 if wide else 0.01)
    for number, case in enumerate(shown):
        axes = grid.flat[number]
        _separatrix(axes, number_at(dataset, "alpha", case.position), across)
        axes.tick_params(labelbottom=number + columns >= len(shown))
    grid.flat[0].set_xlim(-across, across)
    up = 1.08 * max(reach[1], 1.0 if wide else 0.01)
    grid.flat[0].set_ylim(-up, up)
    figure.supxlabel(r"$\theta/\alpha$", fontsize=9.0)
    figure.supylabel(r"$\dot\theta/(p\,\alpha)$", fontsize=9.0)
    notes = [
        selection_note(len(shown), total),
        "dotted: impacts" if reach.max() > 0.0 else "",
        "dashed: separatrix of free rocking" if wide else "",
        f"grey: {reference_words(dataset)}" if any(case.reference for case in shown) else "",
    ]
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    return figure


def _portrait(axes: Axes, dataset: xarray.Dataset, at: tuple[int, ...], width: float, quiet: bool = False) -> Array:
    """Draw one case, in grey if `quiet`; how far it reaches, (theta/alpha, theta_dot/(p alpha))."""
    alpha, p = number_at(dataset, "alpha", at), number_at(dataset, "p", at)
    theta = values_at(dataset, "theta", at) / alpha
    rate = values_at(dataset, "theta_dot", at) / (p * alpha)
    time = dataset["time"].values
    t, before, after = (_impacts(dataset, name, at) for name in ("t_impact", "theta_dot_before", "theta_dot_after"))
    before, after = before / (p * alpha), after / (p * alpha)
    order = np.lexsort((np.repeat([0, 1, 2, 3], [len(time), len(t), len(t), len(t)]), np.concatenate([time, t, t, t])))
    zero, gap = np.zeros_like(t), np.full_like(t, np.nan)
    x = np.concatenate([theta, zero, gap, zero])[order]
    y = np.concatenate([rate, before, gap, after])[order]
    axes.plot(x, y, color=_GREY if quiet else COLOURS[0], linewidth=width, zorder=2 if quiet else 3)
    if not quiet:
        axes.vlines(zero, before, after, color=COLOURS[1], linewidth=1.0, linestyles=(0, (1, 1)), zorder=4)
        if np.isfinite(theta[0]) and abs(theta[0]) + abs(rate[0]) > 0.0:
            axes.plot(theta[0], rate[0], "o", color=COLOURS[0], markersize=3.5, zorder=5)
    inside = np.isfinite(x) & np.isfinite(y)
    if outcome_at(dataset, at).startswith("overturned"):
        inside &= np.abs(x) <= _SHOWN_UP_TO
    return np.array([np.abs(x[inside]).max(initial=0.0), np.abs(y[inside]).max(initial=0.0)])


def _impacts(dataset: xarray.Dataset, name: str, at: tuple[int, ...]) -> Array:
    values = values_at(dataset, name, at) if name in dataset else np.empty(0)
    return values[np.isfinite(values)]


def _separatrix(axes: Axes, alpha: float, reach: float) -> None:
    """The free motions that end in the unstable equilibria, |theta_dot| = 2 p |sin((alpha - |theta|)/2)|."""
    q = np.linspace(0.0, reach, 201)
    rate = 2.0 * np.sin(0.5 * alpha * (1.0 - q)) / alpha
    for side in (-1.0, 1.0):
        for sign in (-1.0, 1.0):
            axes.plot(side * q, sign * rate, color=QUIET, linewidth=0.7, dashes=(4, 2), zorder=1)
    axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
    axes.axvline(0.0, color=QUIET, linewidth=0.4, zorder=0)
