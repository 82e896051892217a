"""Incremental dynamic analysis: peak rotation against intensity, every member of the suite and its fractiles.

Overturned cases run off to the right: their curve leaves the figure along the intensity.  Where nothing rocks and
bodies slide, it is the peak of the slide.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import Array
from rockcli.plotting.common.labels import (
    axis_label,
    axis_values,
    coordinate_label,
    has_floors,
    lifts_from,
    path_of,
    shown_unit,
    title_of,
    two_edged,
    uplift_label,
    variable_label,
)
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LIFTS,
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
from rockcli.plotting.common.suite import Suite, left_out_words, members_word, panels, suite_of, without_intensity
from rockcli.plotting.kinds.map import is_log, scale_axes
from rockcli.scene.variables import PEAK, SLIDE

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FRACTILES: tuple[tuple[str, str, tuple[float, ...]], ...] = (
    ("p16", "16th percentile", (4, 1.5)),
    ("p50", "median", ()),
    ("p84", "84th percentile", (1.5, 1.2)),
)
"""End of the variable's name, word, dashes."""

MEMBER, BOLD = "#8494A3", COLOURS[0]

_FEW = 8
"""Members below which percentiles say nothing that the members do not."""

_MANY: dict[str, Any] = {"color": MEMBER, "linewidth": 0.5, "dashes": ()}
"""Look of each of many members."""

_DARK, _FAINTEST = 150.0, 0.06
"""Members up to which lines are opaque, and how faint those of very many are."""

_DASHES: tuple[tuple[float, ...], ...] = ((), (5.0, 1.5), (1.2, 1.2), (5.0, 1.2, 1.2, 1.2))
"""Dashes of neighbours among few members, in turn."""

_BEYOND = 1.6
"""Where overturned cases are, over the right end of the axis."""


def without_ida(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    return without_intensity(dataset) or ("" if PEAK in dataset.variables else f"{PEAK} was not saved")


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel for each point of the axes beside the suite and the intensity."""
    suite = suite_of(dataset)
    if suite is None or suite.along is None:
        raise ValueError("an IDA needs an ensemble along an intensity")
    shown, some = panels(dataset, suite)
    rows, columns = grid_of(len(shown))
    width = width_or(SINGLE * 1.3 if columns == 1 else DOUBLE)
    figure = new_figure(width, 1.0 + rows * (width / columns))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    intensity = axis_values(dataset, suite.along)
    order = np.argsort(intensity)
    peak = _told(dataset)
    right = _right(dataset, peak)
    few = int(dataset.sizes[suite.axis]) < _FEW
    lifts, top = False, _top(dataset, suite, intensity, peak)
    for axes, case in zip(grid.flat, shown, strict=False):
        part = dataset.isel(case.place)
        members = part[peak].transpose(suite.axis, suite.along).values[:, order]
        faint = float(np.clip(_DARK / len(members), _FAINTEST, 1.0))
        for i, curve in enumerate(members):
            look = _own_look(i) if few else _MANY | {"alpha": faint}
            _run(axes, curve, intensity[order], right, zorder=1, **look)
        for end, _, dashes in () if few else FRACTILES:
            curve = _fractile(part, suite, peak, end)[order]
            _run(axes, curve, intensity[order], right, color=BOLD, linewidth=1.6, dashes=dashes, zorder=3)
        if _told(part) != peak:  # its curves are a line at zero
            axes.text(0.5, 0.5, "only slides", transform=axes.transAxes, ha="center", color="#555555")
        elif peak == PEAK:
            lifts |= _uplift(axes, part, suite.along, top)
            if right > 1.05:
                axes.axvline(1.0, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=0)
    name_panels(grid, [case.label for case in shown], variable_label(peak), axis_label(dataset, suite.along))
    grid.flat[0].set_xlim(0.0, right)
    scale_axes(grid.flat[0], False, is_log(intensity[order]))
    low = _bottom(dataset, suite, intensity, peak) if is_log(intensity[order]) else min(0.0, float(intensity.min()))
    grid.flat[0].set_ylim(low, top)
    looks = [(members_word(dataset, suite), _MANY)]
    looks += [(word, {"color": BOLD, "linewidth": 1.6, "dashes": dashes}) for _, word, dashes in FRACTILES]
    if few:  # each is named, and no percentile is drawn: it would leap from one of them to another
        names = range(int(dataset.sizes[suite.axis]))
        looks = [(coordinate_label(dataset, suite.axis, i), _own_look(i)) for i in names]
    words = []
    for word, look in looks:
        words.append(Line2D([], [], color=look["color"], linewidth=look["linewidth"], label=word))
        if look["dashes"]:
            words[-1].set_dashes(look["dashes"])
    if lifts:
        words.append(Line2D([], [], label=uplift_label(dataset), **LIFTS))
    legend_below(figure, words)
    beyond = bool(np.isposinf(dataset[peak].values).any())
    said = ["overturned cases leave to the right"] * beyond
    if peak == SLIDE:
        said = ["nothing rocks: displacements along the ground"]
        said += ["what slides on for ever leaves to the right"] * beyond
    note = "; ".join(filter(None, [left_out_words(dataset, suite, shown), some, *said]))
    headline(figure, title_of(dataset), note)
    fit_panels(figure, grid.flat[0], max(0.62 * width / columns, SHORTEST), rows)
    return figure


def _told(dataset: xarray.Dataset) -> str:
    """The peak that is drawn: of bodies that only slide, however far they are shaken, that of the slide."""
    slides = SLIDE in dataset.variables and bool((dataset[SLIDE].values > 0.0).any())
    return SLIDE if slides and not (dataset[PEAK].values > 0.0).any() else PEAK


def _fractile(part: xarray.Dataset, suite: Suite, peak: str, end: str) -> Array:
    """A fractile over the suite at every intensity, those of the slide not being in the dataset."""
    if peak == PEAK:
        return np.asarray(part[f"{PEAK}_{end}"].values)
    members = part[peak].transpose(suite.axis, suite.along).values
    found = np.full(members.shape[1], np.nan)
    known = ~np.isnan(members).all(axis=0)
    found[known] = np.nanpercentile(members[:, known], float(end[1:]), axis=0)
    return found


def _own_look(i: int) -> dict[str, Any]:
    """Colour and dashes of a member among few."""
    return {"color": COLOURS[i], "linewidth": 1.1, "dashes": _DASHES[i % len(_DASHES)]}


def fractiles_of(members: int) -> tuple[tuple[str, str, tuple[float, ...]], ...]:
    """Of few members the median alone: the others would be one member or another."""
    return FRACTILES if members >= _FEW else FRACTILES[1:2]


def _uplift(axes: Axes, part: xarray.Dataset, along: str, top: float) -> bool:
    """Draw the acceleration at which a rigid body lifts, where that is one number below `top`; whether it is."""
    peak_of_ground = part[along].attrs.get("units") == "m s-2" and not path_of(part, along).endswith(".sa")
    if not peak_of_ground or "alpha" not in part.variables or has_floors(part):
        return False
    lifts = lifts_from(part)
    if two_edged(part):  # to each side about an edge of its own: one number where all members are alike
        if "pga_uplift" not in part.variables:
            return False
        lifts = part["pga_uplift"]
    found = False
    for sign in (1.0, -1.0):  # amplitudes may have one
        rows = np.flatnonzero(sign * part[along].values > 0.0)
        level = np.unique((lifts.isel({along: rows}) if along in lifts.dims else lifts).values)
        if rows.size and level.size and np.ptp(level) <= 1e-9 * level[0]:
            shown = sign * float(level[0]) / shown_unit(part, along)[0]
            axes.axhline(shown, zorder=0, **LIFTS)
            found |= shown <= top
    return found


def _bottom(dataset: xarray.Dataset, suite: Suite, intensity: Array, peak: str) -> float:
    """Bottom of a logarithmic axis: not far below where the first body moves, as there is nothing to see."""
    peaks = dataset[peak].transpose(suite.along, ...).values
    moved = intensity[(peaks.reshape(len(peaks), -1) > 0.0).any(axis=1)]
    still = intensity[intensity < (moved.min() if len(moved) else np.inf)]
    return float(min(0.7 * moved.min(), still.max()) if len(moved) and len(still) else intensity.min())


def _top(dataset: xarray.Dataset, suite: Suite, intensity: Array, peak: str) -> float:
    """Top of the axis: where all have overturned there is nothing more to see."""
    peaks = dataset[peak].transpose(suite.along, ...).values
    whole = np.asarray(np.isposinf(peaks).reshape(len(peaks), -1).all(axis=1))
    last = np.flatnonzero(~whole[np.argsort(intensity)])
    ordered = np.sort(intensity)
    return float(ordered[min(last[-1] + 2, len(ordered) - 1)]) if len(last) else float(ordered[-1])


def _right(dataset: xarray.Dataset, peak: str) -> float:
    """Right end of the axis: just beyond the largest rotation that returned, at least alpha, at most 1.8 alpha."""
    peaks = dataset[peak].values
    finite = peaks[np.isfinite(peaks)]
    if peak == SLIDE:
        return float(1.06 * finite.max(initial=0.0)) or 1.0
    return float(np.clip(1.06 * finite.max(initial=0.0), 1.1, 1.8))


def _run(
    axes: Axes,
    peak: Array,
    intensity: Array,
    right: float,
    *,
    color: str,
    linewidth: float,
    zorder: int,
    alpha: float = 1.0,
    dashes: tuple[float, ...] = (),
) -> None:
    """One curve; what has no answer leaves a gap, what overturned runs off to the right."""
    x = np.where(np.isposinf(peak), _BEYOND * right, peak)
    (line,) = axes.plot(x, intensity, color=color, linewidth=linewidth, alpha=alpha, zorder=zorder)
    if dashes:
        line.set_dashes(dashes)
