"""Risk: hazard curves with the fragility on them, what intensities it comes from, and survival over the years."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import LogLocator

from rockcli.plotting.common.cases import Array
from rockcli.plotting.common.labels import escape, shown_unit, title_of
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MARKERS,
    QUIET,
    headline,
    legend_below,
    new_figure,
    panel_label,
    panel_title,
    width_or,
)
from rockcli.plotting.common.suite import panels, suite_of
from rockcli.plotting.kinds.fragility import intensity_label
from rockcli.plotting.kinds.map import scale_axes
from rockcli.scene.ground.hazard import CONSISTENT, hazard_words
from rockcli.scene.variables import HAZARD

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINES: tuple[Any, ...] = ("-", "--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))

_MOST_BODIES = 3

_CROWDED = 1.6
"""Decades of intensity from which labels at 1, 2 and 5 touch in one of three panels."""

_THREE, _PANEL = 5.6, 1.55
"""Widths that three panels beside one another need, and one panel [in]."""


def without_risk(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    return "" if "annual_rate" in dataset else "the study gives no hazard curve (hazard: FILE.csv, beside over)"


def draw(dataset: xarray.Dataset) -> Figure:
    """Three panels for each body, of overturning: in a row, or below one another where the figure is narrow.

    Of more than there is room for, three at most, those that overturn most often.
    """
    suite = suite_of(dataset)
    if suite is None or "annual_rate" not in dataset:
        raise ValueError("risk needs an ensemble and a hazard curve")
    rates = dataset["annual_rate"].isel(limit_state=-1).max(HAZARD)
    width = width_or(DOUBLE)
    most = _MOST_BODIES if width >= _THREE else min(_MOST_BODIES, max(1, int(width / _PANEL)))
    least = -rates.fillna(-1.0), "those of the highest rates"
    shown, some = panels(dataset, suite, most=most, least=least, what="bodies")
    figure, grid = _grid(width, len(shown))
    label = intensity_label(dataset, suite)
    abreast = _abreast(width, len(shown))
    columns = 3 if width >= _THREE else len(shown) if abreast else 1
    for number, (row, case) in enumerate(zip(grid, shown, strict=True)):
        part = dataset.isel(case.place).isel(limit_state=-1)
        beside = _hazard(row[0], part)
        _deaggregation(row[1], part)
        _survival(row[2], part)
        for axes in row[:2]:
            panel_label(axes, label, width / columns)
        if case.label:
            panel_title(row[0], case.label, width / 3.0)
        first, last = number == 0, number == len(shown) - 1
        for axes in (*(row if abreast and not first else ()), *((beside,) if abreast and not last else ())):
            axes.set_ylabel("")
            axes.tick_params(axis="y", labelleft=False, labelright=False)
    shares = [axes.dataLim.ymax for axes in grid[:, 1]]
    for axes, own in zip(grid[:, 1], shares, strict=True):
        seen = max(shares) if abreast else own  # bodies beside one another have one scale
        axes.set_ylim(0.0, None if seen > 0.0 else 1.0)
    entries = [axes.get_legend_handles_labels() for axes in grid[:, 0]]  # a body without a curve has fewer
    named = {word: handle for handles, words in entries for handle, word in zip(handles, words, strict=True)}
    legend_below(figure, list(named.values()))
    note = "of overturning; bands: 95 % by the scatter of the suite"
    headline(figure, title_of(dataset), "; ".join(filter(None, [note, some])))
    return figure


def _abreast(width: float, bodies: int) -> bool:
    """Whether bodies stand beside one another, each with its panels below: their scales are one, and named once."""
    return width < _THREE and width >= _PANEL * bodies


def _grid(width: float, bodies: int) -> tuple[Figure, Any]:
    """A figure and its panels, a row of three for each body, wherever they stand."""
    if width >= _THREE:
        figure = new_figure(width, 0.85 + 2.3 * bodies)
        return figure, figure.subplots(bodies, 3, squeeze=False)
    if _abreast(width, bodies):
        figure = new_figure(width, 0.85 + 2.0 * 3)
        return figure, figure.subplots(3, bodies, squeeze=False, sharey="row").T
    figure = new_figure(width, 0.85 + 1.7 * 3 * bodies)
    return figure, figure.subplots(3 * bodies, 1, squeeze=False).reshape(bodies, 3)


def _style(i: int) -> dict[str, Any]:
    return {"color": COLOURS[i % len(COLOURS)], "linestyle": _LINES[i % len(_LINES)]}


def _hazard(axes: Axes, part: xarray.Dataset) -> Axes:
    """Hazard curves, and the fragility of the body on an axis of its own, which is returned."""
    from scipy.special import ndtr  # late: other figures need none of it

    divisor = shown_unit(part, "hazard_intensity")[0]
    for i, label in enumerate(part["hazard"].values):
        x, rate = (part[name].values[i] for name in ("hazard_intensity", "hazard_rate"))
        axes.plot(x / divisor, rate, marker=MARKERS[i % len(MARKERS)], markersize=2.6, markeredgewidth=0.0,
                  label=escape(hazard_words(str(label))), **_style(i))  # fmt: skip
    scale_axes(axes, x_log=True)
    if np.ptp(np.log10(part["hazard_intensity"].values[part["hazard_intensity"].values > 0.0])) > _CROWDED:
        subs = (1.0, 3.0) if width_or(DOUBLE) >= _THREE else (1.0,)
        axes.xaxis.set_major_locator(LogLocator(subs=subs, numticks=99))  # by itself it leaves a narrow panel without
    axes.set_yscale("log")
    axes.set_ylabel("annual rate of exceedance")
    median, beta, begin = (float(part[f"fragility_{name}"]) for name in ("median", "beta_total", "begins_at"))
    beside = axes.twinx()
    beside.set_ylim(0.0, 1.05)
    beside.spines["right"].set_visible(True)
    beside.set_ylabel("probability of overturning")
    if np.isfinite(median):
        low, high = axes.get_xlim()
        x = np.geomspace(low, high, 400) * divisor
        with np.errstate(divide="ignore", invalid="ignore"):
            p = np.where(x > begin, ndtr(np.log((x - begin) / (median - begin)) / beta), 0.0)
        beside.plot(x / divisor, p, color="black", linewidth=1.4)
        axes.plot([], [], color="black", linewidth=1.4, label="fragility")
        axes.set_xlim(low, high)
    return beside


def _deaggregation(axes: Axes, part: xarray.Dataset) -> None:
    """Of which intensities the rate is made."""
    divisor = shown_unit(part, "intensity_bin_low")[0]
    edges = np.append(part["intensity_bin_low"].values, part["intensity_bin_high"].values[-1]) / divisor
    there: Array = np.zeros(len(edges) - 1)
    for i in range(part.sizes["hazard"]):
        share = np.nan_to_num(part["deaggregation"].values[i])
        axes.stairs(100.0 * share, edges, **_style(i))
        there = np.maximum(there, share)
    scale_axes(axes, x_log=True)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    if (there > 0.0).any():
        seen = np.flatnonzero(there > 1e-3)
        axes.set_xlim(edges[seen[0]], edges[seen[-1] + 1])
    else:
        _empty(axes)
    axes.set_ylabel("share of the rate [%]")


def _empty(axes: Axes, *, along: bool = False) -> None:
    """Say why there is nothing in a panel; `along`: there is something on its axis all the same."""
    axes.text(0.5, 0.5, "no curve of\noverturning", color=QUIET, ha="center", va="center", transform=axes.transAxes)
    if not along:
        axes.set_xticks([])
        axes.set_xticks([], minor=True)


def _survival(axes: Axes, part: xarray.Dataset) -> None:
    """Probability of standing over the years, and the age of the body."""
    age = json.loads(part.attrs.get("ensemble", "{}")).get("age")
    rate = part["annual_rate"].values
    known = rate[np.isfinite(rate) & (rate > 0.0)]
    ends = [*(1.0 / known), *([age] if age else [])]
    years = np.geomspace(0.02 * min(ends, default=1.0), 20.0 * max(ends, default=1.0), 300)
    for i, one in enumerate(rate):
        low, high = (float(part[f"annual_rate_ci_{end}"].values[i]) for end in ("low", "high"))
        axes.fill_between(
            years, np.exp(-high * years), np.exp(-low * years), color=_style(i)["color"], alpha=0.12, linewidth=0.0
        )
        axes.plot(years, np.exp(-one * years), **_style(i))
        if age:
            axes.plot(
                [age],
                [np.exp(-one * age)],
                color=_style(i)["color"],
                marker=MARKERS[i % len(MARKERS)],
                markersize=4.0,
            )
    axes.axhline(CONSISTENT, color=QUIET, linewidth=0.7, linestyle=(0, (1.5, 1.5)))
    axes.text(years[0], CONSISTENT + 0.01, " 5 %", color=QUIET, fontsize=7.0, va="bottom")
    if age:
        axes.axvline(age, color=QUIET, linewidth=0.7)
    axes.set_xscale("log")
    axes.set_xlim(years[0], years[-1])
    axes.set_ylim(0.0, 1.02)
    if not np.isfinite(rate).any():
        _empty(axes, along=bool(age))
    axes.set_xlabel("age [years]")
    axes.set_ylabel("probability of survival")
