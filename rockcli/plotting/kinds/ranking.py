"""Bodies by name, a row for each, those that overturn most easily on top: peaks, thresholds, or what a suite says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.common.cases import Array, Shown, axes_of, is_numeric, pick, reference_on_axes, selection_note
from rockcli.plotting.common.labels import coordinate_label, shown_unit, title_of, variable_label
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MARKERS,
    MOST_CURVES,
    MOST_PANELS,
    QUIET,
    SINGLE,
    fit_panels,
    headline,
    legend_of,
    new_figure,
    panel_label,
    width_or,
    wrapped,
)
from rockcli.plotting.common.suite import (
    Suite,
    end_to_end,
    left_out_words,
    medians_beyond,
    members_word,
    suite_axes,
    suite_of,
)
from rockcli.plotting.kinds.curve import STRIP, quantity, without_value
from rockcli.plotting.kinds.fragility import intensity_label, second_words
from rockcli.plotting.kinds.map import scale_axes
from rockcli.plotting.kinds.spectrum import found_label
from rockcli.plotting.kinds.suite_curve import MEDIAN, SHARE
from rockcli.scene.variables import PEAK, SLIDE

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPACITY = "fragility_median"

_MOST_ROWS = 60
"""Rows of a page."""

_ROW, _LINE, _COLUMN, _MARK = 0.155, 0.125, 0.14, 0.03
"""Height of a row and of one more line of its name, width of a column of the strip, and of a mark in it [in]."""

_STRIP = 0.35
"""Share of the width that the strip takes at most."""

_NAMES, _LETTERS = 0.42, 21.0
"""Share of the width that names take at most, beyond which they have several lines; letters of theirs in an inch."""

_APART, _ACROSS = 0.2, 0.6
"""Between the marks of neighbouring alternatives in a row, and at most between the first and the last [rows]."""

_DECADES = 50.0
"""Between the least and the most of medians and their limits, from which their axis is logarithmic."""

_SEEN = 1e-3
"""Slide from which it has a panel [m]."""

_ALWAYS, _NEVER, _NO_CURVE = "all overturn", "none overturns", "no curve"
"""Why a suite has no median, beside the reasons of `curve`."""

_FIRST, _LAST = (_ALWAYS, "below range"), (_NEVER, "none in range")
"""Reasons that a threshold is lower, or higher, than all that are known."""

Reasons = dict[str, NDArray[np.bool_]]


@dataclass(frozen=True)
class _Panel:
    """A quantity of all rows and of the alternatives in each, (n, m), in the unit of its label; with limits or none."""

    label: str
    values: Array
    limits: tuple[Array, Array] | None = None
    positive: bool = False
    """Whether it has no values at and below zero."""

    @property
    def barred(self) -> bool:
        """Whether any limits lie apart."""
        return self.limits is not None and bool((self.limits[0] < self.limits[1]).any())

    def of(self, rows: NDArray[np.intp]) -> _Panel:
        """The same of some rows, in their order."""
        limits = None if self.limits is None else (self.limits[0][rows], self.limits[1][rows])
        return replace(self, values=self.values[rows], limits=limits)


def along(dataset: xarray.Dataset) -> str | None:
    """The longest axis of names: of those that a suite leaves, or of its members where it leaves none."""
    named = [axis for axis in _left(dataset) if _named(dataset, axis)]
    return max(named, key=lambda axis: int(dataset.sizes[axis]), default=None)


def without_ranking(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if along(dataset) is None:
        return "no axis has bodies or motions by name (vary: {case: TABLE.csv}, or a list of names)"
    return "" if _ranked(dataset) else f"neither {PEAK} nor what a suite or a search makes of outcomes was saved"


def telling(dataset: xarray.Dataset, *, beside: bool = False) -> bool:
    """Whether it is worth drawing unasked: of what a suite or a search found, unless figures of all are `beside` it.

    Of other cases where they are more than histories distinguish, and nothing is compared.
    """
    axis = along(dataset)
    of_members = suite_of(dataset) is not None and _suite(dataset) is None
    if axis is None or not _ranked(dataset) or of_members or reference_on_axes(dataset):
        return False
    if beside:  # figures with a panel for each body and alternative
        return int(np.prod([dataset.sizes[name] for name in _left(dataset) if _named(dataset, name)])) > MOST_PANELS
    return int(dataset.sizes[axis]) > (MOST_CURVES if _ranked(dataset) == PEAK else 2)


def draw(dataset: xarray.Dataset) -> Figure:
    """A row for each name, in it a mark for each point of the other axes; what has no value is marked at the side."""
    axis = along(dataset)
    assert axis is not None
    others = tuple(name for name in _left(dataset) if name != axis)
    shown, total = pick(dataset, MOST_CURVES, others)
    panels, reasons = _read(dataset, axis, shown)
    order = _worst_first(dataset, panels, reasons)[:_MOST_ROWS]
    panels = [panel.of(order) for panel in panels]
    columns = [r for r in (*STRIP, _NO_CURVE, _NEVER, _ALWAYS) if r in reasons and reasons[r][order].any()]
    natural = SINGLE * 1.3 if len(panels) == 1 else DOUBLE
    width = width_or(natural)
    names = [coordinate_label(dataset, axis, int(i)) for i in order]
    names = ["\n".join(wrapped(name, int(_NAMES * width * _LETTERS))) for name in names]
    row = _ROW + _LINE * max((name.count("\n") for name in names), default=0)
    figure = new_figure(width, 1.5 + row * len(order))
    strip = [min(_COLUMN + _MARK * len(shown), _STRIP * width / len(columns)) * len(columns)] if columns else []
    share = (0.7 * width - sum(strip)) / len(panels)
    widths = [share, *strip, *([share] * (len(panels) - 1))]
    grid = figure.subplots(1, len(widths), sharey=True, squeeze=False, width_ratios=widths)[0]
    beside = [grid[0], *grid[1 + len(strip) :]]
    for axes, panel in zip(beside, panels, strict=True):
        _draw_panel(axes, panel, shown)
        panel_label(axes, panel.label, 1.3 * share)
    if columns:
        _draw_strip(grid[1], columns, reasons, order)
    first = grid[0]
    first.set_yticks(range(len(order)), names, fontsize=7.5, linespacing=1.0)
    first.set_ylim(len(order) - 0.4, -0.6)
    headline(figure, title_of(dataset), "; ".join(filter(None, _notes(dataset, axis, order, shown, total, panels))))
    if len(shown) > 1:
        legend_of(figure, first, 3)
    fit_panels(figure, first, row * (len(order) + 0.4))
    return figure


def _named(dataset: xarray.Dataset, axis: str) -> bool:
    return not is_numeric(dataset, axis) and bool(dataset.sizes[axis] >= 2)


def _suite(dataset: xarray.Dataset) -> Suite | None:
    """The ensemble of which there is a number for every name; None where names are of its members alone."""
    left = set(axes_of(dataset)) - set(suite_axes(dataset))
    return suite_of(dataset) if any(_named(dataset, axis) for axis in left) else None


def _ranked(dataset: xarray.Dataset) -> str:
    """The quantity that rows are put in order by; "" where there is none."""
    suite = _suite(dataset)
    if suite is None:
        return PEAK if PEAK in dataset.variables else quantity(dataset)
    every = suite.along is None or dataset.sizes.get(suite.along, 1) > 1  # not those at one intensity
    return next((name for name in (CAPACITY,) * every + (SHARE,) if name in dataset.variables), "")


def _left(dataset: xarray.Dataset) -> tuple[str, ...]:
    """The axes of the study but those of the members of a suite and, of a median, of the intensity."""
    suite = _suite(dataset)
    gone = set(suite_axes(dataset)) if suite is not None else set()
    if suite is not None and _ranked(dataset) == SHARE:
        gone.discard(suite.along or "")
    return tuple(axis for axis in axes_of(dataset) if axis not in gone)


def _read(dataset: xarray.Dataset, axis: str, shown: list[Shown]) -> tuple[list[_Panel], Reasons]:
    """What is drawn, and by the reason what has no value, (n, m)."""
    name = _ranked(dataset)

    def table(variable: str, divisor: float = 1.0) -> Array:
        item = dataset[variable]
        if "limit_state" in item.dims:
            item = item.isel(limit_state=-1)  # overturning
        n = int(dataset.sizes[axis])
        columns = [item.isel({a: i for a, i in case.place.items() if a in item.dims}).values for case in shown]
        return np.column_stack([np.broadcast_to(column, n) for column in columns]).astype(float) / divisor

    suite = _suite(dataset)
    if suite is not None and name == CAPACITY:
        divisor = shown_unit(dataset, CAPACITY)[0]
        limits = table(f"{CAPACITY}_ci_low", divisor), table(f"{CAPACITY}_ci_high", divisor)
        panel = _Panel(f"median capacity, {intensity_label(dataset, suite)}", table(CAPACITY, divisor), limits, True)
        return [panel], _without_median(dataset, panel.values, table("fragility_status"))
    if suite is not None:
        share = _Panel("share that overturns", table(SHARE), (table(f"{SHARE}_low"), table(f"{SHARE}_high")))
        more = [_Panel(f"median {variable_label(PEAK)}", table(MEDIAN))] if MEDIAN in dataset.variables else []
        return [share, *more], {"no answer": np.isnan(share.values)}
    divisor = shown_unit(dataset, name)[0]
    panel = _Panel(variable_label(PEAK) if name == PEAK else found_label(dataset, name), table(name, divisor))
    found = [without_value(dataset, case.place, y) for case, y in zip(shown, panel.values.T, strict=True)]
    none = np.zeros(len(panel.values), dtype=bool)
    reasons = {row: np.column_stack([each.get(row, none) for each in found]) for row in STRIP}
    slides = name == PEAK and SLIDE in dataset.variables and bool((dataset[SLIDE].values > _SEEN).any())
    return [panel, *([_Panel(variable_label(SLIDE), table(SLIDE))] if slides else [])], reasons


def _without_median(dataset: xarray.Dataset, medians: Array, status: Array) -> Reasons:
    flags = str(dataset["fragility_status"].attrs["flag_meanings"]).split()
    always, never = (status == flags.index(flag) for flag in ("all_exceed", "none_exceeds"))
    return {_ALWAYS: always, _NEVER: never, _NO_CURVE: np.isnan(medians) & ~always & ~never}


def _worst_first(dataset: xarray.Dataset, panels: list[_Panel], reasons: Reasons) -> NDArray[np.intp]:
    """Rows in the order of how easily they overturn; what is not known comes last.

    Members of a body without a curve overturn: it comes before those of which none does.
    """
    values = panels[0].values
    lowest = _ranked(dataset) not in (PEAK, SHARE)
    if lowest:
        values = np.where(np.isfinite(values), -values, -np.inf)
        for which, instead in ((_FIRST, np.inf), ((_NO_CURVE,), -1e299), (_LAST, -1e300)):
            for reason in which:
                values = np.where(reasons.get(reason, False), instead, values)
    keys = [np.nan_to_num(values, nan=-1.0, posinf=np.inf, neginf=-np.inf)]
    keys += [np.nan_to_num(panel.values, nan=-1.0, posinf=np.inf) for panel in panels[1:]]
    columns = []
    for key in keys:
        fell = np.isposinf(key)
        columns += [key.max(axis=1), fell.sum(axis=1), np.where(fell, -1.0, key).max(axis=1)]
    return np.lexsort([-column for column in reversed(columns)])


def _draw_panel(axes: Axes, panel: _Panel, shown: list[Shown]) -> None:
    apart = min(_APART, _ACROSS / max(len(shown) - 1, 1))
    for number, case in enumerate(shown):
        y = np.arange(len(panel.values)) + apart * (number - 0.5 * (len(shown) - 1))  # so that alike ones are all seen
        x, colour = panel.values[:, number], COLOURS[number]
        x = np.where(np.isfinite(x), x, np.nan)
        if panel.barred:
            low, high = (end[:, number] for end in panel.limits or ())
            wide = np.isfinite(low) & np.isfinite(high) & (low < high)
            axes.hlines(y[wide], low[wide], high[wide], color=colour, linewidth=0.9, zorder=2)
        elif len(shown) == 1:
            axes.hlines(y, 0.0, x, color=colour, linewidth=0.7, alpha=0.5, zorder=2)
        style: dict[str, Any] = {
            "linestyle": "",
            "markersize": 3.4,
            "markeredgewidth": 0.0,
            "zorder": 3,
            "clip_on": False,
        }
        axes.plot(x, y, MARKERS[number], color=colour, label=case.label, **style)
    values = panel.values if panel.limits is None else np.stack([panel.values, *panel.limits])
    finite = values[np.isfinite(values)]
    left, right = 1.05 * float(finite.min(initial=0.0)), 1.05 * float(finite.max(initial=0.0))
    axes.set_xlim(left, right if right > left else 1.0)
    if panel.positive and finite.size and finite.max() > _DECADES * finite.min() > 0.0:  # an extrapolated limit
        scale_axes(axes, x_log=True)
        axes.set_xlim(float(finite.min()) / 1.2, 1.2 * float(finite.max()))
    axes.grid(axis="y", color=QUIET, linewidth=0.3, alpha=0.5)
    axes.tick_params(axis="y", length=0.0)
    axes.spines["left"].set_visible(False)


def _draw_strip(axes: Axes, columns: list[str], reasons: Reasons, order: NDArray[np.intp]) -> None:
    """A column for each reason, in it a mark for each alternative."""
    for place, reason in enumerate(columns):
        where = reasons[reason][order]
        m = where.shape[1]
        for number in range(m):
            rows = np.flatnonzero(where[:, number])
            x = np.full(len(rows), place + 0.8 * ((number + 0.5) / m - 0.5))
            axes.plot(x, rows, MARKERS[number], color=COLOURS[number], markersize=2.8, markeredgewidth=0.0)
    axes.set_xlim(-0.5, len(columns) - 0.5)
    axes.set_xticks(range(len(columns)), columns, rotation=90.0)
    axes.tick_params(length=0.0)
    axes.grid(axis="y", color=QUIET, linewidth=0.3, alpha=0.5)
    axes.spines["left"].set_visible(False)
    axes.spines["bottom"].set_visible(False)


def _notes(
    dataset: xarray.Dataset,
    axis: str,
    order: NDArray[np.intp],
    shown: list[Shown],
    total: int,
    panels: list[_Panel],
) -> list[str]:
    some = selection_note(len(order), int(dataset.sizes[axis]), "rows")
    suite = _suite(dataset)
    members = members_word(end_to_end(dataset), suite) if suite is not None else ""
    far, bars, missing = 0, "", ""
    if suite is not None and _ranked(dataset) == CAPACITY:
        missing = left_out_words(end_to_end(dataset), suite, shown)
        beyond = medians_beyond(dataset.isel({"limit_state": -1, axis: order}))
        far = sum(int(beyond.isel({a: i for a, i in case.place.items() if a in beyond.dims}).sum()) for case in shown)
    if panels[0].barred:
        bars = "bars: 95 % limits" if _ranked(dataset) == CAPACITY else "bars: as members without an answer may go"
    endless = int(np.isposinf(panels[1].values).sum()) if len(panels) > 1 and suite is None else 0
    fallen = len(panels) > 1 and suite is not None and bool(np.isposinf(panels[1].values).any())
    return [
        members,
        missing,
        second_words(dataset) if _ranked(dataset) == CAPACITY else "",
        f"{some}, those that overturn most easily" if some else "",
        selection_note(len(shown), total, "alternatives"),
        bars,
        f"{far} median{'' if far == 1 else 's'} beyond the intensities of the suite, extrapolated" if far else "",
        "no median where half or more overturn" if fallen else "",
        f"{endless} of {panels[-1].values.size} slide on for ever" if endless else "",
    ]
