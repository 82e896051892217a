"""Fragility: the share of the suite that exceeds each limit state against intensity, and the lognormal through it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array, selection_note
from rockcli.plotting.common.labels import axis_label, axis_values, title_of, unit_in_brackets
from rockcli.plotting.common.style import COLOURS, DOUBLE, SINGLE, headline, new_figure, panel_title
from rockcli.plotting.common.suite import Suite, grid_of, members_word, panels, suite_of, without_intensity
from rockcli.plotting.kinds.map import is_log, scale_axes

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")


def without_fragility(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    return without_intensity(dataset)


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel for each point of the axes beside the suite and the intensity."""
    suite = suite_of(dataset)
    if suite is None or suite.along is None:
        raise ValueError("fragility curves need an ensemble along an intensity")
    shown, total = panels(dataset, suite)
    rows, columns = grid_of(len(shown))
    width = SINGLE * 1.3 if columns == 1 else DOUBLE
    figure = new_figure(width, 1.1 + rows * (width / columns) * (0.72 if columns == 1 else 0.85))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    single = len(shown) == 1
    for number, (case, place) in enumerate(shown):
        axes = grid.flat[number]
        _panel(axes, dataset.isel(place), suite, numbers=single)
        if case.label:
            panel_title(axes, case.label, width / columns)
        if number + columns >= len(shown):
            axes.set_xlabel(axis_label(dataset, suite.along))
            axes.tick_params(labelbottom=True)
        if number % columns == 0:
            axes.set_ylabel("probability of exceedance")
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_axis_off()
    intensity = axis_values(dataset, suite.along)
    first = grid.flat[0]
    first.set_ylim(-0.02, 1.02)
    log = is_log(np.sort(intensity))
    scale_axes(first, log)
    first.set_xlim(float(intensity.min()) if log else 0.0, float(intensity.max()))
    handles, labels = first.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=1 if single else 4, columnspacing=1.4)
    words = f"{members_word(dataset, suite)}; lognormal by maximum likelihood, 95 % band (delta method, clustered)"
    headline(figure, title_of(dataset), "; ".join(filter(None, [words, selection_note(len(shown), total, "panels")])))
    return figure


def _panel(axes: Axes, part: xarray.Dataset, suite: Suite, *, numbers: bool) -> None:
    from scipy.special import ndtr, ndtri  # late: other figures need none of it

    assert suite.along is not None
    intensity = axis_values(part, suite.along)
    scale = float(part[suite.along].values[-1]) / float(intensity[-1]) if intensity[-1] else 1.0
    positive = intensity[intensity > 0.0]
    x = np.linspace(0.0, positive.max(), 401)[1:] if len(positive) else np.empty(0)
    for i, label in enumerate(part["limit_state"].values):
        colour = COLOURS[i % len(COLOURS)]
        median, beta, se, se_beta, rho = (float(part[f"fragility_{name}"].values[i]) for name in _FITTED)
        median /= scale
        words = "overturned" if label == "overturned" else rf"$|\theta|_{{\mathrm{{max}}}}/\alpha$ > {label}"
        fitted = np.isfinite(median)
        if numbers:
            unit = axis_label(part, suite.along).rsplit(" [", 1)
            bracket = f" {unit[1][:-1]}" if len(unit) == 2 else unit_in_brackets("1")
            words += rf": median {median:.3g}{bracket}, $\beta$ = {beta:.2f}" if fitted else ": no curve"
        share = part["p_exceeded"].values[:, i]
        style: Any = {"marker": _MARKERS[i % len(_MARKERS)], "markersize": 3.0, "markeredgewidth": 0.0}
        alone = "" if fitted else words
        axes.plot(intensity, share, linestyle="", color=colour, alpha=0.75, zorder=2, label=alone, **style)
        if fitted:
            z = np.log(x / median) / beta
            half = ndtri(0.975) * np.sqrt(_variance(z, beta, se, se_beta, rho))
            axes.fill_between(x, ndtr(z - half), ndtr(z + half), color=colour, alpha=0.15, linewidth=0.0)
            axes.plot(x, ndtr(z), color=colour, zorder=3, label=words)


_FITTED = ("median", "beta", "se_ln_median", "se_beta", "correlation")


def _variance(z: Array, beta: float, se: float, se_beta: float, rho: float) -> Array:
    """Variance of z = ln(x/median)/beta to first order in both estimates (delta method)."""
    return np.asarray((se**2 + 2.0 * z * rho * se * se_beta + (z * se_beta) ** 2) / beta**2)
