"""Overturning over two intensities: every case a point, and lines of equal probability, as for balanced rocks.

Lines are those of the fitted curve, whose median moves with a power of the second intensity (Purvance et al. 2008,
Earthq. Eng. Struct. Dyn. 37: 793-808).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.plotting.common.cases import Array
from rockcli.plotting.common.labels import shown_unit, title_of, unit_in_brackets
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LIFTS,
    LINES,
    OUTCOME_COLOURS,
    QUIET,
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
from rockcli.plotting.common.suite import left_out_words, members_word, panels, suite_of
from rockcli.plotting.kinds.fragility import first_motion, intensity_label, second_symbol
from rockcli.plotting.kinds.map import scale_axes
from rockcli.scene.response import overturned

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SECOND = "fragility_intensity_second"

_LEVELS = {0.05: LINES[1], 0.5: LINES[0], 0.95: LINES[2]}
"""Probabilities of overturning that have a line, and its style."""


def without_intensities(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if {SECOND, "outcome"} <= set(map(str, dataset.variables)) and suite_of(dataset) is not None:
        return ""
    return "its fragility is not told against two intensities (over: {axis, intensity: [pga, pgv_over_pga]})"


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel for each point of the axes beside the suite and the intensity."""
    suite = suite_of(dataset)
    if suite is None or SECOND not in dataset.variables:
        raise ValueError("two intensities of an ensemble are needed")
    shown, note = panels(dataset, suite)
    rows, columns = grid_of(len(shown))
    width = width_or(SINGLE * 1.3 if columns == 1 else DOUBLE)
    figure = new_figure(width, 1.25 + rows * 0.85 * (width / columns))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, case in zip(grid.flat, shown, strict=False):
        _panel(axes, dataset.isel(case.place), suite.told_against)
    across = second_symbol(dataset) + unit_in_brackets(shown_unit(dataset, SECOND)[1])
    name_panels(grid, [case.label for case in shown], across, intensity_label(dataset, suite))
    first = grid.flat[0]
    x, y = (values[values > 0.0] for values in _both(dataset, suite.told_against))
    first.set_xlim(0.9 * x.min(), 1.1 * x.max())
    first.set_ylim(0.9 * y.min(), 1.1 * y.max())
    scale_axes(first, True, True)
    # a body without a curve, as one that none overturns, has fewer entries than the others
    entries = [axes.get_legend_handles_labels() for axes in list(grid.flat)[: len(shown)]]
    named = {word: handle for handles, words in entries for handle, word in zip(handles, words, strict=True)}
    legend_below(figure, list(named.values()), 3)
    words = f"{members_word(dataset, suite)}; lines: probability of overturning by the fitted curve"
    headline(figure, title_of(dataset), "; ".join(filter(None, [left_out_words(dataset, suite, shown), words, note])))
    fit_panels(figure, first, max(0.7 * width / columns, 1.2 * SHORTEST), rows)
    return figure


def _both(dataset: xarray.Dataset, told_against: str) -> tuple[Array, Array]:
    """The second intensity and the first, which may be an axis, of every case, as they are shown."""
    second = dataset[SECOND]
    name = "fragility_intensity" if "fragility_intensity" in dataset.variables else told_against
    first = dataset[name].transpose(*[dim for dim in second.dims if dim in dataset[name].dims])
    every = first.values.reshape(
        [size if dim in first.dims else 1 for dim, size in zip(second.dims, second.shape, strict=True)]
    )
    of_cases = np.broadcast_to(every, second.shape)
    return second.values / shown_unit(dataset, SECOND)[0], of_cases / shown_unit(dataset, name)[0]


def _panel(axes: Axes, part: xarray.Dataset, told_against: str) -> None:
    x, y = _both(part, told_against)
    flags = part["outcome"].transpose(*part[SECOND].dims).values
    fell = overturned(flags)
    stands = ~fell & (flags >= 0)
    dots: dict[str, Any] = {"linestyle": "", "markersize": 3.0, "markeredgewidth": 0.5}
    axes.plot(x[stands], y[stands], "o", color=QUIET, markerfacecolor="none", label="remains stable", **dots)
    colour = OUTCOME_COLOURS["overturned_without_impact"]
    axes.plot(x[fell], y[fell], "o", color=colour, label="overturned", **dots)
    divisor = shown_unit(part, "fragility_median")[0]
    begin = float(part["fragility_begins_at"]) / divisor
    if begin > 0.0:
        axes.axhline(begin, zorder=1, label=first_motion(part), **LIFTS)
    median, beta, c = (
        float(part[f"fragility_{name}"].isel(limit_state=-1)) for name in ("median", "beta_total", "exponent")
    )
    if not np.isfinite(median):
        return
    from scipy.special import ndtri  # late: other figures need none of it

    positive = x[x > 0.0]  # a motion of no acceleration has none
    second = np.geomspace(positive.min(), positive.max(), 100)
    reference = float(part["fragility_second"]) / shown_unit(part, "fragility_second")[0]
    above = (median / divisor - begin) * (second / reference) ** -c
    for level, line in _LEVELS.items():
        curve = begin + above * np.exp(float(ndtri(level)) * beta)
        axes.plot(second, curve, color=COLOURS[0], linestyle=line, label=f"{100 * level:.0f} %")
