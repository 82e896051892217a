"""Rocking spectra: peaks against 2 pi/p, the size of the body as a period; of one motion, or of a suite.

Where cases overturn there is no curve, but a bar at the top.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from rockcli.plotting.common.cases import Array, axes_of, is_numeric, isolated, pick, selection_note, thresholds_in
from rockcli.plotting.common.labels import searched_symbol, shown_unit, title_of, unit_in_brackets, variable_label
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LINES,
    MOST_COLUMNS,
    MOST_CURVES,
    QUIET,
    SINGLE,
    headline,
    legend_below,
    legend_of,
    new_figure,
    panel_title,
    width_or,
)
from rockcli.plotting.common.suite import members_word, suite_of
from rockcli.plotting.kinds.ida import BOLD, MEMBER, fractiles_of
from rockcli.plotting.kinds.map import is_log, scale_axes
from rockcli.scene.thresholds import BELOW, BRACKETED, FOUND, NONE

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Order = NDArray[np.intp]

_FEWEST_SIZES = 3

_BESIDE = 0.02
"""Share of the axis that is left free at either end."""

_BAR, _BAR_OF_MEMBERS, _APART = 0.97, 0.93, 0.04
"""Heights of bars over the top of the axis, and between those of curves."""

_MEMBERS = 1
"""Where the members of a suite lie, below its percentiles."""

_PRESCREENS = (
    ("_prescreen", ":", "closed form, after first uplift"),
    ("_prescreen_worst", (0, (5, 1, 1, 1)), "closed form, worst excursion"),
)
"""Ends of names of what is told without solving, lines, words."""


@dataclass(frozen=True)
class Row:
    """A quantity of the spectrum: the variable, its label, whether it is divided by p, and the unit of the label."""

    name: str
    label: str
    over_p: bool = False
    unit: float = 1.0


_ROWS: tuple[Row, ...] = (
    Row("theta_peak_over_alpha", variable_label("theta_peak_over_alpha")),
    Row("theta_dot_peak", r"$|\dot\theta|_{\mathrm{max}}/p$ [rad]", over_p=True),
    Row("u_top_peak", variable_label("u_top_peak")),
)


def size_axis(dataset: xarray.Dataset) -> str | None:
    """The numeric axis along which p changes; None if there is none, or more than one."""
    if "p" not in dataset.variables:
        return None
    along = [a for a in axes_of(dataset) if a in dataset["p"].dims]
    suite = suite_of(dataset)
    if suite is not None and along == [suite.axis]:  # sizes of the members
        return None
    single = len(along) == 1 and is_numeric(dataset, along[0]) and dataset.sizes[along[0]] >= _FEWEST_SIZES
    return along[0] if single else None


def without_spectrum(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if size_axis(dataset) is None:
        return "p changes along no axis of numbers, or along several (vary: block.R, at least three sizes)"
    return "" if _rows(dataset) else "none of theta_peak_over_alpha, theta_dot_peak, u_top_peak was saved"


def draw(dataset: xarray.Dataset) -> Figure:
    """Rows of quantities; of a suite a column for each point of the other axes, else a curve."""
    axis = size_axis(dataset)
    if axis is None:
        raise ValueError("a rocking spectrum needs an axis of sizes")
    period = 2.0 * np.pi / dataset["p"].values
    order = np.argsort(period)
    suite = suite_of(dataset)
    return _of_cases(dataset, axis, period, order) if suite is None else _of_suite(dataset, axis, period, order)


def _rows(dataset: xarray.Dataset) -> list[Row]:
    """Peaks that were saved; what a search found (`find: overturning`), which has no peaks."""
    sought = [str(name) for name in dataset.data_vars if str(name).endswith(FOUND)]
    found = [Row(name, found_label(dataset, name), unit=shown_unit(dataset, name)[0]) for name in sought]
    return [*(row for row in _ROWS if row.name in dataset.variables), *found]


def found_label(dataset: xarray.Dataset, name: str) -> str:
    """Label of the lowest value of a range at which a case overturns."""
    unit = shown_unit(dataset, name)[1]
    return f"lowest overturning {searched_symbol(dataset, name.removesuffix(FOUND))}{unit_in_brackets(unit)}"


def _of_cases(dataset: xarray.Dataset, axis: str, period: Array, order: Order) -> Figure:
    rows = _rows(dataset)
    others = tuple(name for name in axes_of(dataset) if name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    figure = new_figure(width_or(SINGLE * 1.3), 1.4 + 1.75 * len(rows))
    grid = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
    for axes, row in zip(grid, rows, strict=True):
        curves = []
        for case in shown:
            curves.append(_values(dataset.isel(case.place), row, row.name)[order])
        top = _top(row, curves)
        fallen = sum(bool(np.isposinf(curve).any()) for curve in curves)
        whole = top * (1.0 + _APART * max(fallen - 1, 0))  # bars of several lay on one another
        bars = iter(whole - top * (1.0 - _BAR + _APART * np.arange(fallen)))
        for number, (case, curve) in enumerate(zip(shown, curves, strict=True)):
            style = {"color": COLOURS[number], "linestyle": LINES[number % len(LINES)], "label": case.label}
            _run(axes, period[order], curve, next(bars) if np.isposinf(curve).any() else top, **style)
        _finish(axes, row, whole)
        axes.set_ylabel(row.label)
    _periods(grid[-1], period[order])
    note = "; ".join(filter(None, [selection_note(len(shown), total, "curves"), _leaving(dataset, rows)]))
    headline(figure, title_of(dataset), note)
    if len(shown) > 1:
        legend_of(figure, grid[0], 3)
    return figure


def _of_suite(dataset: xarray.Dataset, axis: str, period: Array, order: Order) -> Figure:
    suite = suite_of(dataset)
    assert suite is not None
    rows = _rows(dataset)
    others = tuple(name for name in axes_of(dataset) if name not in (axis, suite.axis))
    shown, total = pick(dataset, MOST_COLUMNS, others)
    columns = len(shown)
    width = width_or(SINGLE * 1.3 if columns == 1 else DOUBLE)
    figure = new_figure(width, 1.5 + 1.75 * len(rows))
    grid = figure.subplots(len(rows), columns, sharex=True, sharey="row", squeeze=False)
    seen: set[str] = set()
    for line, row in zip(grid, rows, strict=True):
        parts = [dataset.isel(case.place) for case in shown]
        members = [_values(part.transpose(suite.axis, axis, ...), row, row.name)[:, order] for part in parts]
        high = [_values(part, row, f"{row.name}_p84")[order] for part in parts]
        top = _top(row, members, high)
        for axes, part, curves in zip(line, parts, members, strict=True):
            for curve in curves:
                _run(axes, period[order], curve, _BAR_OF_MEMBERS * top, color=MEMBER, linewidth=0.7, zorder=_MEMBERS)
            for end, line_of, _ in _prescreens(part, row):
                curve = _values(part, row, f"{row.name}{end}_p50")[order]
                axes.plot(period[order], curve, color=COLOURS[1], linewidth=1.0, linestyle=line_of, zorder=2)
                seen |= {end} if (curve < top).any() else set()
            for end, _, dashes in fractiles_of(len(curves)):
                curve = _values(part, row, f"{row.name}_{end}")[order]
                _run(axes, period[order], curve, _BAR * top, color=BOLD, linewidth=1.6, zorder=3, dashes=dashes)
            _finish(axes, row, top)
        line[0].set_ylabel(row.label)
    for axes, case in zip(grid[0], shown, strict=True):
        if case.label:
            panel_title(axes, case.label, width / columns)
    for axes in grid[-1]:
        _periods(axes, period[order])
    words = [Line2D([], [], color=MEMBER, linewidth=0.8, label=members_word(dataset, suite))]
    for _, word, dashes in fractiles_of(int(dataset.sizes[suite.axis])):
        words.append(Line2D([], [], color=BOLD, linewidth=1.6, label=word))
        if dashes:
            words[-1].set_dashes(dashes)
    above = []
    for end, line_of, word in _prescreens(dataset, rows[-1]):
        if end in seen:
            words.append(Line2D([], [], color=COLOURS[1], linewidth=1.0, linestyle=line_of, label=f"median, {word}"))
        else:
            above.append(f"above the axis: median, {word}")
    legend_below(figure, words)
    note = "; ".join(filter(None, [selection_note(columns, total, "columns"), _leaving(dataset, rows), *above]))
    headline(figure, title_of(dataset), note)
    return figure


def _prescreens(part: xarray.Dataset, row: Row) -> list[tuple[str, Any, str]]:
    """What is told of the suite's lowest overturning value without solving."""
    return [one for one in _PRESCREENS if f"{row.name}{one[0]}_p50" in part.variables]


def _leaving(dataset: xarray.Dataset, rows: list[Row]) -> str:
    """What is not drawn as a value: cases that overturn, or of a search what lies outside its range."""
    if not rows[0].name.endswith(FOUND):
        peaks = dataset[rows[0].name].values
        missing = int(np.isnan(peaks).sum())
        words = ["bars at the top: overturned"] if np.isposinf(peaks).any() else []
        return "; ".join(
            [*words, *([f"{missing} of {peaks.size} cases without an answer left out"] if missing else [])]
        )
    state = thresholds_in(dataset, rows[0].name).state
    words = ["bars at the top: nothing in the range overturns"] if (state == NONE).any() else []
    for flag, why in ((BELOW, "below the range"), (BRACKETED, "without an answer")):
        if count := int((state == flag).sum()):
            words.append(f"{count} of {state.size} {why}, not drawn")
    return "; ".join(words)


def _values(part: xarray.Dataset, row: Row, name: str) -> Array:
    """A variable of the row, over p where it is to be."""
    values = part[name] / row.unit
    return np.asarray((values / part["p"] if row.over_p else values).values, dtype=float)


def _top(row: Row, curves: list[Array], high: list[Array] | None = None) -> float:
    """Top of the axis: above the largest that returned, but of a suite not far above its 84th percentile."""
    largest = _largest(curves)
    if row.name == "theta_peak_over_alpha":
        return float(np.clip(1.06 * largest, 1.1, 1.8))
    room = 1.16 if any(np.isposinf(curve).any() for curve in curves) else 1.08  # of bars, above all values
    return min(room * largest, 1.6 * _largest(high or curves) or np.inf) or 1.0


def _largest(curves: list[Array]) -> float:
    return max(float(np.max(curve, where=np.isfinite(curve), initial=0.0)) for curve in curves)


def _run(axes: Axes, x: Array, y: Array, bar: float, *, dashes: tuple[float, ...] = (), **style: Any) -> None:
    """One curve; what has no answer leaves a gap, what overturned, too, under a bar at the height `bar`."""
    (line,) = axes.plot(x, np.where(np.isposinf(y), np.nan, y), **style)
    if dashes:
        line.set_dashes(dashes)
    if len(alone := isolated(y)):
        dot: dict[str, Any] = {"markersize": style.get("linewidth", 1.0) + 0.6, "markeredgewidth": 0.0}
        axes.plot(x[alone], y[alone], "o", color=style["color"], zorder=style.get("zorder", 3), **dot)
    member = style.get("zorder") == _MEMBERS  # below those of the median, and thinner
    look: dict[str, Any] = {"linewidth": 0.8 if member else 2.0, "marker": "|", "markersize": 3.0 if member else 4.5}
    height = np.where(np.isposinf(y), bar, np.nan)
    axes.plot(x, height, color=style["color"], zorder=style.get("zorder", 3), **look)


def _finish(axes: Axes, row: Row, top: float) -> None:
    axes.set_ylim(0.0, top)
    if row.name == "theta_peak_over_alpha":
        axes.axhline(1.0, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)


def _periods(axes: Axes, period: Array) -> None:
    scale_axes(axes, is_log(period))
    low, high = float(period.min()), float(period.max())
    beside = (high / low) ** _BESIDE if is_log(period) else 1.0  # a bar at an end lay on the line of the axis
    apart = 0.0 if is_log(period) else _BESIDE * (high - low)
    axes.set_xlim(low / beside - apart, high * beside + apart)
    axes.set_xlabel(r"$2\pi/p$ [s]")
