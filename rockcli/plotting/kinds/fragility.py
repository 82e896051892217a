"""Fragility: the share of the suite that exceeds each limit state against intensity, and the lognormal through it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array
from rockcli.plotting.common.labels import (
    axis_label,
    axis_symbol,
    axis_values,
    searched_symbol,
    shown_unit,
    title_of,
    unit_in_brackets,
)
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LINES,
    MARKERS,
    SHORTEST,
    SINGLE,
    fit_panels,
    grid_of,
    headline,
    legend_below,
    name_panels,
    new_figure,
    width_or,
)
from rockcli.plotting.common.suite import Suite, left_out_words, members_word, panels, suite_of
from rockcli.plotting.kinds.map import is_log, scale_axes
from rockcli.scene.limit_states import OVERTURNED
from rockcli.scene.thresholds import FOUND
from rockcli.scene.variables import VARIABLES

if TYPE_CHECKING:
    import xarray
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BANDS = 2
"""Curves up to which each has a band of its own: more of them hide one another."""

_STEP = 0.02
"""Distance of the limits of neighbouring medians [1]."""

_BEYOND = 0.015
"""Part of its length by which the axis goes on beyond the last intensity, whose points are drawn whole [1]."""

THETA = r"$|\theta|_{\mathrm{max}}/\alpha$"

_NAMES = {"pga": "PGA", "pgv": "PGV", "pgv_over_pga": "PGV/PGA", "arias": r"$I_A$", "cav": "CAV"}


def without_fragility(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    suite = suite_of(dataset)
    if suite is None:
        return "the study takes no statistics over an axis (over: record)"
    if "fragility_median" not in dataset:
        return (
            "no amplitude of the motion is varied (vary: motion.record.pga, ...; or over: {axis, along or intensity})"
        )
    return ""


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel for each point of the axes beside the suite and the intensity."""
    suite = suite_of(dataset)
    if suite is None or "fragility_median" not in dataset:
        raise ValueError("fragility curves need an ensemble and an intensity")
    shown, note = panels(dataset, suite)
    rows, columns = grid_of(len(shown))
    width = width_or(SINGLE * 1.3 if columns == 1 else DOUBLE)
    figure = new_figure(width, 1.25 + rows * (width / columns))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    single = len(shown) == 1
    x = _intensity(dataset, suite)
    for axes, case in zip(grid.flat, shown, strict=False):
        banded = _panel(axes, dataset.isel(case.place), suite, float(x.max(initial=0.0)), numbers=single)
    name_panels(grid, [case.label for case in shown], intensity_label(dataset, suite), "probability of exceedance")
    first = grid.flat[0]
    first.set_ylim(-0.02, 1.02)
    log = is_log(np.sort(x))
    scale_axes(first, log)
    begin = float(dataset["fragility_begins_at"].min()) / shown_unit(dataset, "fragility_median")[0]
    low, last = max(float(x.min()), 0.7 * begin) if log else 0.0, float(x.max())
    beyond = (last / low) ** _BEYOND if log else 1.0 + _BEYOND
    first.set_xlim(low, last * beyond)
    legend_below(figure, _entries(list(grid.flat)), 1 if single else 3)
    limits = "bands" if banded else "bars"
    points = "points: shares" if _stripes(dataset, suite) is not None else ""
    fitted = bool(np.isfinite(dataset["fragility_median"].values).any())
    words = f"{limits}: 95 % limits" + " of the medians" * (not banded) if fitted else ""
    missing = left_out_words(dataset, suite, shown)
    signed = _turned(dataset, suite)
    notes = [members_word(dataset, suite), signed, missing, second_words(dataset), points, words, note]
    headline(figure, title_of(dataset), "; ".join(filter(None, notes)))
    fit_panels(figure, first, max(0.62 * width / columns, SHORTEST), rows)
    return figure


def _turned(dataset: xarray.Dataset, suite: Suite) -> str:
    """That motions turned round have no part in the curves, where the intensity has a sign; "" where it has none."""
    name = suite.told_against
    signed = name in dataset.dims and bool((dataset[name].values < 0.0).any())
    return f"positive {axis_symbol(dataset, name)} alone" if signed else ""


def _entries(grid: list[Axes]) -> list[Artist]:
    """What the legend of some panels shows: of a state without a curve in the first of them that of another."""
    found: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            if label not in found or found[label].get_linestyle() == "None":
                found[label] = handle
    return list(found.values())


def second_words(dataset: xarray.Dataset) -> str:
    """At which value of a second intensity the curves are drawn, from the least to the largest of the bodies."""
    if "fragility_second" not in dataset:
        return ""
    divisor, unit = shown_unit(dataset, "fragility_second")
    at = dataset["fragility_second"].values.ravel() / divisor
    at = at[np.isfinite(at)]
    if not len(at):
        return ""
    words = " to ".join(dict.fromkeys(f"{end:.3g}" for end in (at.min(), at.max())))
    return f"at {second_symbol(dataset)} = {words} {unit_in_brackets(unit).strip(' []')}".rstrip()


def intensity_label(dataset: xarray.Dataset, suite: Suite) -> str:
    """Symbol and unit of the intensity."""
    name = suite.told_against
    if name in dataset.dims:
        return axis_label(dataset, name)
    symbol = searched_symbol(dataset, name) if f"{name}{FOUND}" in dataset.variables else intensity_symbol(name)
    return symbol + unit_in_brackets(shown_unit(dataset, "fragility_median")[1])


def second_symbol(dataset: xarray.Dataset) -> str:
    """Symbol of the second of two intensities."""
    name = str(dataset["fragility_intensity_second"].attrs["long_name"])
    return axis_symbol(dataset, name) if name in dataset.dims else intensity_symbol(name)


def intensity_symbol(name: str) -> str:
    """Symbol of an intensity that is no axis, `pgv_over_pga` or `ground_sa(0.5)`."""
    bare = name.removeprefix("ground_")
    spectral = bare.lower().replace("sa(", r"$S_a$(").replace(")", " s, 5 %)")
    return _NAMES.get(bare, spectral) + ("" if bare == name else " of the ground")


def _intensity(part: xarray.Dataset, suite: Suite) -> Array:
    """All positive values of the intensity, as they are shown."""
    if suite.told_against in part.dims:
        values = axis_values(part, suite.told_against)
    else:
        values = part["fragility_intensity"].values.ravel() / shown_unit(part, "fragility_median")[0]
    return np.asarray(values[values > 0.0])


def _stripes(dataset: xarray.Dataset, suite: Suite) -> Array | None:
    """Intensities at which all members were solved, as they are shown; None where each has its own."""
    if suite.along is None or "p_exceeded" not in dataset:
        return None
    if suite.told_against in dataset.dims:
        return axis_values(dataset, suite.told_against)
    x = dataset["fragility_intensity"].transpose(suite.along, ...).values / shown_unit(dataset, "fragility_median")[0]
    x = x.reshape(len(x), -1)
    return np.asarray(x[:, 0]) if (np.ptp(x, axis=1) <= 1e-9 * x.max(axis=1)).all() else None


def first_motion(part: xarray.Dataset) -> str:
    """What happens where the curves begin."""
    slides = any(">" in str(label) for label in part["limit_state"].values)
    return "uplift or slip" if slides else "uplift"


def _state(label: str, *, alone: bool = True) -> str:
    """A limit state for people; that of a slide is exceeded by bodies that overturn too."""
    if label == OVERTURNED:
        return label
    quantity, _, value = label.rpartition(" > ")
    words = rf"{VARIABLES[quantity].symbol if quantity else THETA} > {value}"
    return f"{words} or {OVERTURNED}" if quantity and alone else words


def _panel(axes: Axes, part: xarray.Dataset, suite: Suite, last: float, *, numbers: bool) -> bool:
    """Shares and curves of a body up to `last`; whether the limits of the curves are bands, not bars."""
    from scipy.special import ndtr  # late: other figures need none of it

    positive = _intensity(part, suite)
    divisor, unit = shown_unit(part, "fragility_median")
    begin = float(part["fragility_begins_at"]) / divisor
    # closer where the curves begin, so that they are smooth on a logarithmic axis too
    x = begin + (positive.max() - begin) * np.geomspace(1e-3, 1.0, 401) if len(positive) else np.empty(0)
    stripes = _stripes(part, suite)
    if begin > 0.0:
        named = first_motion(part) if begin <= last else ""
        axes.axvline(begin, color="0.45", linewidth=0.8, linestyle=(0, (1.5, 1.5)), zorder=1, label=named)
    # several panels have one legend
    same = _same_curve(part) if numbers else [[i] for i in range(part.sizes["limit_state"])]
    banded = sum(bool(each) for each in same) <= _BANDS
    drawn: list[int] = []
    for i in range(part.sizes["limit_state"]):
        colour = COLOURS[i % len(COLOURS)]
        median, se, se_beta, rho, beta, total = (float(part[f"fragility_{name}"].values[i]) for name in _FITTED)
        above = median / divisor - begin
        words = (
            " and ".join(_state(str(part["limit_state"].values[j]), alone=len(same[i]) == 1) for j in same[i])
            if same[i]
            else ""
        )
        fitted = np.isfinite(median)
        if numbers and words:
            size = f"{median / divisor:.3g}{unit_in_brackets(unit).translate({ord('['): None, ord(']'): None})}"
            words += rf": median {size}, $\beta$ = {total:.2f}" if fitted else ": no curve"
        alone = "" if fitted else words
        first = fitted and bool(same[i])  # of the states that share one curve
        style: Any = {"marker": MARKERS[i % len(MARKERS)], "markersize": 3.0, "markeredgewidth": 0.6,
                      "markerfacecolor": "none"}  # fmt: skip
        if stripes is not None:
            shares = part["p_exceeded"].values[:, i]
            axes.plot(stripes, shares, linestyle="", color=colour, zorder=2,
                      label=alone, **style)  # fmt: skip
        elif alone:
            axes.plot([], [], linestyle="", color=colour, label=alone, **style)
        if first:
            z = np.log((x - begin) / above) / total
            ends = [float(part[f"fragility_median_ci_{end}"].values[i]) / divisor for end in ("low", "high")]
            if banded:
                # to first order in both estimates (delta method), as many standard errors as the limits of the median
                steep, reach = z * beta / total, np.log((ends[1] - begin) / above) / se if se > 0.0 else np.nan
                half = reach * np.sqrt(se**2 + 2.0 * steep * rho * se * se_beta + (steep * se_beta) ** 2) / total
                # of curves that grow: where a band widens faster, its limits farther along bound it too
                low, high = np.maximum.accumulate(z - half), np.minimum.accumulate((z + half)[::-1])[::-1]
                axes.fill_between(x, ndtr(low), ndtr(high), color=colour, alpha=0.15, linewidth=0.0)
            else:
                axes.hlines(0.5 + _STEP * (len(drawn) - 1.5), ends[0], ends[1], color=colour, linewidth=2.0, zorder=4)
            drawn.append(i)
            axes.plot(x, ndtr(z), color=colour, linestyle=LINES[i % len(LINES)], zorder=3, label=words)
    return banded


def _same_curve(part: xarray.Dataset) -> list[list[int]]:
    """Of every limit state the states whose curve is its own, itself the first; none if it is drawn with one before."""
    numbers = np.stack([part[f"fragility_{name}"].values for name in ("median", "beta")])
    same: list[list[int]] = []
    for i in range(numbers.shape[1]):
        before = next(
            (s for s in same if s and np.allclose(numbers[:, s[0]], numbers[:, i], rtol=1e-9, atol=0.0)), None
        )
        if before is not None:
            before.append(i)
        same.append([] if before is not None else [i])
    return same


_FITTED = ("median", "se_ln_median", "se_beta", "correlation", "beta", "beta_total")
