"""Phase portrait: angular velocity against rotation, impacts as jumps, with the separatrix of free rocking."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.common.boundaries import rolls
from rockcli.plotting.common.case_law import may_have_dashpot, model_of
from rockcli.plotting.common.cases import (
    Array,
    Shown,
    has_overturned,
    outcome_at,
    pick,
    reference_words,
    selection_note,
    spread,
    values_at,
)
from rockcli.plotting.common.labels import title_of
from rockcli.plotting.common.response import Response, edges, impacts_of, response_of
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MOST_PANELS,
    QUIET,
    SINGLE,
    grid_of,
    headline,
    new_figure,
    panel_title,
    width_or,
)
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.models import Model

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ACROSS, _UP = r"$\theta/\alpha$", r"$\dot\theta/(p\,\alpha)$"

_GREY = "#B9B9B9"

_DOTS: Any = (0, (1, 1))

_HEIGHT = 0.86
"""Of a panel, over its width."""

_POINTS, _SEEN = 72.0, 2.0
"""Points in an inch; length from which a dotted line is seen, a dot and a gap [pt]."""

_EVERY = 10_000
"""Cases that are looked through."""

_WIDE = 0.5
"""Reach from which the whole separatrix is shown."""

_SHOWN_UP_TO = 1.6
"""|theta|/alpha beyond which an overturning body is no longer followed."""


def draw(dataset: xarray.Dataset) -> Figure:
    """One panel per case, theta_dot/(p alpha) against theta/alpha."""
    cases, _ = pick(dataset, _EVERY)
    moving = [case for case in cases if np.nan_to_num(values_at(dataset, "theta", case.position)).any()] or cases
    shown, total = spread(moving, MOST_PANELS), len(moving)
    still = len(cases) - len(moving)
    rows, columns = grid_of(len(shown))
    width = width_or(SINGLE * 1.25 if columns == 1 else DOUBLE)
    figure = new_figure(width, 0.7 + rows * (width / columns) * _HEIGHT)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    reach = np.zeros(3)
    outcomes = []
    for number, case in enumerate(shown):
        axes = grid.flat[number]
        reach = np.maximum(reach, _portrait(axes, dataset, case.position, width=0.9 if len(shown) == 1 else 0.6))
        if case.reference is not None:
            _portrait(axes, dataset, case.reference, width=0.6, quiet=True)
        outcome = outcome_at(dataset, case.position).replace("_", " ")
        outcomes.append("" if outcome == "rocking" else outcome)
        if len(shown) > 1:
            panel_title(axes, ", ".join(part for part in (case.label, outcomes[-1]) if part), width / columns)
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_axis_off()
    models = [_falls_by(dataset, case) for case in shown]
    wide = bool(reach[:2].max() > _WIDE) and any(models)
    across = 1.08 * max(reach[0], 1.0 if wide else 0.01)
    for number, case in enumerate(shown):
        axes = grid.flat[number]
        model = models[number]
        if model is not None:
            _separatrix(axes, model, edges(dataset, "alpha", case.position), across)
        axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        axes.axvline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        axes.tick_params(labelbottom=number + columns >= len(shown))
    grid.flat[0].set_xlim(-across, across)
    up = 1.08 * max(reach[1], 1.0 if wide else 0.01)
    grid.flat[0].set_ylim(-up, up)
    high = _POINTS * width / columns * _HEIGHT  # of a panel
    alone = grid.flat[0] if len(shown) == 1 else None
    if alone is not None:
        alone.set_xlabel(_ACROSS)
        alone.set_ylabel(_UP)
    else:
        figure.supxlabel(_ACROSS, fontsize=9.0)
        figure.supylabel(_UP, fontsize=9.0)
    without_dashpot = " without the dashpot" if may_have_dashpot(dataset) else ""
    notes = [
        ", ".join(part for part in (shown[0].label, outcomes[0]) if part) if alone is not None else "",
        selection_note(len(shown), total),
        f"{still} without rotation not drawn" if still else "",
        "dotted: impacts" if reach[2] / (2.0 * up) * high >= _SEEN else "",
        f"dashed: separatrix of free rocking{without_dashpot}" if wide else "",
        f"grey: {reference_words(dataset)}" if any(case.reference for case in shown) else "",
    ]
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note), over=alone)
    return figure


def _portrait(axes: Axes, dataset: xarray.Dataset, at: tuple[int, ...], width: float, quiet: bool = False) -> Array:
    """Draw one case, in grey if `quiet`; how far it reaches, (theta/alpha, theta_dot/(p alpha)), its longest jump."""
    jump = 0.0
    response = response_of(dataset, at, apart=True)
    x, y = response.ratio, response.rate
    axes.plot(x, y, color=_GREY if quiet else COLOURS[0], linewidth=width, zorder=2 if quiet else 3)
    if not quiet:
        gaps = _jumps(dataset, at, response)
        jump = np.abs(y[gaps + 1] - y[gaps - 1]).max(initial=0.0)
        axes.vlines(x[gaps - 1], y[gaps - 1], y[gaps + 1], color=COLOURS[1], linewidth=1.0, linestyles=_DOTS, zorder=4)
        if np.isfinite(x[0]) and abs(x[0]) + abs(y[0]) > 0.0:
            axes.plot(x[0], y[0], "o", color=COLOURS[0], markersize=3.5, zorder=5)
    inside = np.isfinite(x) & np.isfinite(y)
    if has_overturned(dataset, at):
        inside &= np.abs(x) <= _SHOWN_UP_TO
    return np.array([np.abs(x[inside]).max(initial=0.0), np.abs(y[inside]).max(initial=0.0), jump])


def _jumps(dataset: xarray.Dataset, at: tuple[int, ...], response: Response) -> NDArray[np.intp]:
    """Where a response jumps: the gaps between the two points of its impacts."""
    known = impacts_of(dataset, at)[0]
    gaps = np.flatnonzero(np.isnan(response.rate[1:-1])) + 1
    return gaps[np.isin(response.time[gaps], known) & ~np.isnan(response.rate[gaps - 1] + response.rate[gaps + 1])]


def _falls_by(dataset: xarray.Dataset, case: Shown) -> Model | None:
    """The model of a case; None where rotation and velocity alone do not tell whether it falls, or it cannot fall."""
    of_case = dataset.isel(case.place)
    model = None if rolls(of_case) else model_of(of_case)
    if model is None:
        return None
    alpha = edges(dataset, "alpha", case.position)
    return model if np.isfinite(model.law(alpha, np.tan(alpha)).q_star).any() else None


def _separatrix(axes: Axes, model: Model, alpha: Array, reach: float) -> None:
    """The free motions of a body on two edges that end in its unstable equilibria, by side, where it has any.

    There |theta_dot| = p sqrt(2 B(|theta|)), B of (T7), for the block 2 p |sin((alpha - |theta|)/2)|.
    """
    law = model.law(alpha, np.tan(alpha))
    for side, i in ((-1.0, LEFT), (1.0, RIGHT)):
        top = float(law.q_star[i])
        if not np.isfinite(top):
            continue
        q = np.linspace(0.0, reach, 201)
        missing = model.missing(law, q[:, None] * alpha)[:, i]
        rate = np.sign(top - q * alpha[i]) * np.sqrt(2.0 * np.maximum(missing, 0.0)) / alpha[i]
        for sign in (-1.0, 1.0):
            axes.plot(side * q, sign * rate, color=QUIET, linewidth=0.7, dashes=(4, 2), zorder=1)
