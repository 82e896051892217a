"""Samples of uncertain inputs: how probable a peak rotation is, and which input it comes from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array
from rockcli.plotting.common.labels import axis_symbol, path_of, title_of, variable_label
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
from rockcli.plotting.common.suite import end_to_end, members_word, panels, suite_of
from rockcli.scene.variables import INPUT, PEAK

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MATTERS: tuple[tuple[str, str, str], ...] = (
    ("sobol_total", "sobol_first", "Sobol index of\noverturning (total;\nfilled: first order)"),
    ("sobol_total_peak", "sobol_first_peak", "Sobol index of\nthe peak (total;\nfilled: first order)"),
    ("input_spearman", "input_spearman", "rank correlation\nwith the peak\n(Spearman)"),
)
"""What tells which input matters, the best first: outer and filled bar, and what they are."""

_WIDE = 0.8 * DOUBLE
"""Width from which these words stand in one line [in]."""


def without_samples(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if "p_overturned_se" not in dataset.variables or suite_of(dataset) is None:
        return "the study has no statistics over samples (uncertain: {PATH: DISTRIBUTION})"
    return "" if PEAK in dataset.variables else f"{PEAK} was not saved"


def draw(dataset: xarray.Dataset) -> Figure:
    """Left the share of samples whose peak is larger, right what matters; a colour for each point of the other axes."""
    suite = suite_of(dataset)
    if suite is None or without_samples(dataset):
        raise ValueError("a figure of samples needs statistics over samples")
    whole = end_to_end(dataset)
    members = suite_of(whole)
    assert members is not None
    inputs = [str(path) for path in dataset[INPUT].values]
    shown, some = panels(whole, members, along=True, most=MOST_CURVES, what="points")
    figure = new_figure(width_or(DOUBLE), max(3.2, 1.6 + 0.16 * len(inputs) * (len(shown) + 1)))
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 0.9))
    peaks = whole[PEAK].values
    finite = peaks[np.isfinite(peaks)]
    end = max(1.0, 1.05 * float(finite.max(initial=0.0)))
    for number, case in enumerate(shown):
        part = whole.isel(case.place)
        colour = COLOURS[number % len(COLOURS)]
        style = {"color": colour, "linestyle": LINES[number % len(LINES)], "label": case.label}
        _exceedance(left, np.ravel(part[PEAK].values), end, style)
        p, low, high = (float(part[f"p_overturned{name}"]) for name in ("", "_ci_low", "_ci_high"))
        if np.isfinite(p):
            at = end * (1.04 + 0.02 * number)
            left.errorbar([at], [p], [[max(p - low, 0.0)], [max(high - p, 0.0)]], fmt="o", color=colour,
                          markersize=3.0, capsize=3.0, linewidth=0.9, clip_on=False)  # fmt: skip
        _bars(right, part, inputs, number, len(shown), colour)
    if end > 1.05:
        left.axvline(1.0, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    left.set_xlim(0.0, end * (1.07 + 0.02 * len(shown)))
    left.set_xticks([tick for tick in left.get_xticks() if 0.0 <= tick <= end])  # the points are beyond all peaks
    left.set_ylim(_bottom(whole.isel(case.place) for case in shown), 1.02)
    left.set_xlabel(variable_label(PEAK))
    left.set_ylabel("probability of exceedance")
    right.set_yticks(range(len(inputs)), [_symbol(dataset, path) for path in inputs])
    right.set_ylim(len(inputs) - 0.5, -0.5)
    right.axvline(0.0, color=QUIET, linewidth=0.6)
    words = _matters(dataset)[2]
    right.set_xlabel(words.replace("\n", " ") if figure.get_figwidth() >= _WIDE else words)
    if len(shown) > 1:
        legend_of(figure, left, 3)
    note = f"{members_word(whole, members)}; points: overturned, with 95 % limits"
    headline(figure, title_of(dataset), "; ".join(filter(None, [note, some])))
    return figure


def _bottom(parts: Iterable[xarray.Dataset]) -> float:
    """Bottom of the axis: 0, or just below the probability of overturning where that is high."""
    least = min(float(np.nan_to_num(part["p_overturned_ci_low"])) for part in parts)
    return -0.02 if least < 0.5 else np.floor(10.0 * least - 1.0) / 10.0


def _exceedance(axes: Axes, peaks: Array, end: float, style: dict[str, Any]) -> None:
    """Share of the samples with an answer whose peak is larger than x."""
    known = np.sort(peaks[~np.isnan(peaks)])
    if not len(known):
        return
    inside = known[np.isfinite(known)]
    x = np.concatenate([[0.0], inside, [end]])
    larger = 1.0 - np.concatenate([[0.0], np.arange(1, len(inside) + 1), [len(inside)]]) / len(known)
    axes.step(x, larger, where="post", linewidth=1.2, **style)


def _matters(dataset: xarray.Dataset) -> tuple[str, str, str]:
    """What tells which input matters best."""
    there = (row for row in MATTERS if row[0] in dataset and np.isfinite(dataset[row[0]].values).any())
    return next(there, MATTERS[-1])


def _bars(axes: Axes, part: xarray.Dataset, inputs: list[str], number: int, of: int, colour: str) -> None:
    outer, filled, _ = _matters(part)
    height = 0.8 / of
    y = np.arange(len(inputs)) - 0.4 + (number + 0.5) * height
    if outer != filled:
        axes.barh(y, part[outer].values, 0.9 * height, facecolor="none", edgecolor=colour, linewidth=0.9)
    errors = part[outer.replace("total", "total_se")].values if outer.startswith("sobol") else None
    axes.barh(y, part[filled].values, 0.9 * height, color=colour, alpha=0.75)
    if errors is not None:
        axes.errorbar(part[outer].values, y, xerr=1.96 * errors, fmt="none", color=colour, linewidth=0.8, capsize=1.5)


def _symbol(dataset: xarray.Dataset, path: str) -> str:
    """Symbol of an input, or its path."""
    name = next((str(c) for c in dataset.coords if str(c).startswith("sampled_")
                 and path_of(dataset, str(c)) == path), "")  # fmt: skip
    symbol = axis_symbol(dataset, name) if name else path
    return path if symbol.startswith("sampled ") else symbol
