"""Work and precision: error against cost of every setting that `rock trade` measured, by kind of error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from rockcli.plotting.common.labels import title_of
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    PAIR,
    QUIET,
    headline,
    legend_below,
    new_figure,
    panel_title,
    width_or,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Panel = tuple[str, str]
"""Part of the dataset, and model where it has a panel of its own."""

LEAST = 1e-17
"""Errors below are drawn here: on a logarithmic axis nothing is 0."""

MOST_MODELS = 3
"""Panels of numerical errors at most, one per model of the study."""

LINE, LETTER = 0.14, 0.055
"""Height of a line of names and width of a letter [in]."""

_WIDE = 5.6
"""Width from which three panels have room beside one another [in]."""

_PARTS = 6
"""Columns of the grid, of which each of one, two or three panels of a row takes its share."""

HIGH = 2.5
"""Height of a row of panels, unless it only has a few names [in]."""

FRONT = "Pareto front"

LOOKS: dict[str, tuple[str, str, str]] = {
    "event": (COLOURS[0], "-", "o"),
    "event, elements": (COLOURS[0], "--", "s"),
    "frame": (COLOURS[1], "--", "^"),
    "opensees": (COLOURS[2], "--", "D"),
    "calculix": (COLOURS[3], "--", "h"),
    "calculix, elements": (COLOURS[4], "--", "p"),
    "scipy RK23": (COLOURS[1], "-", "s"),
    "scipy RK45": (COLOURS[2], "-", "^"),
    "scipy DOP853": (COLOURS[3], "-", "D"),
    "scipy Radau": (COLOURS[4], "-", "v"),
    "scipy BDF": (COLOURS[5], "-", "P"),
    "scipy LSODA": (COLOURS[6], "-", "X"),
    "scipy ode23s": (COLOURS[7], "-", "<"),
    "scipy RK45, impacts not located": (COLOURS[5], "--", ">"),
}
"""Colour, line and marker of a family, the same in every study: general methods solid, other backends dashed."""

_NEAR = 0.15
"""Powers of ten that errors differ by at most where one line of names is for both."""

_ERROR = r"median error of $|\theta|_{\mathrm{max}}/\alpha$"

UNKNOWN = (QUIET, ":", "*")
"""Look of a family that is not in the table."""

_OVER = {"cost": "cost per case [s]", "n_rhs": "right-hand sides per case"}

_HEADS = {"numerics": "numerics", "model": "models, at accuracy standard", "data": "sampling of the record"}


def without_trade(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    needed = ("part", "family", "cost", "error_median", "on_front")
    if any(name not in dataset.variables for name in needed):
        return "work and precision are measured by `rock trade`, and drawn from its dataset"
    rows = _drawable(dataset)
    if rows.any() and dataset["error_median"].values[rows].any():
        return ""
    why = "every error is 0" if rows.any() else "no setting has an error of its peaks"
    return ": ".join(filter(None, [f"nothing to draw, {why}", str(dataset.attrs.get("trade_notes", ""))]))


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel of numerical errors per model of the study, one of model errors, one of sampling, over time.

    The numerical errors have one scale, and again a panel over evaluations of the right-hand side where the file knows
    them; what has names beside its points has a scale of its own.
    """
    parts = dataset["part"].values
    drawable = _drawable(dataset)
    models = list(dict.fromkeys(dataset["model"].values[parts == "numerics"]))
    numerics = [("numerics", model) for model in models[:MOST_MODELS]]
    numerics = [one for one in numerics if (drawable & _rows(dataset, *one)).any()]
    named = [(part, "") for part in ("model", "data") if (drawable & _rows(dataset, part, "")).any()]
    efforts = {"cost": np.asarray(dataset["cost"].values, dtype=float), "n_rhs": _evaluations(dataset)}
    known = drawable & np.isfinite(efforts["n_rhs"])
    again = [one for one in numerics if (known & _rows(dataset, *one)).any()]
    width = width_or(DOUBLE if len(numerics) + len(again) + len(named) > 1 else DOUBLE * 0.6)
    shown = _arranged(numerics, again, named, 3 if width >= _WIDE else 2 if width >= PAIR else 1)
    lines = {part: len(_labels_of(dataset, drawable & _rows(dataset, part, ""), part)) for part, _ in named}
    highs = [HIGH if any(part == "numerics" for (part, _), _ in row) else
             max(1.1, LINE * (2 + max(lines[part] for (part, _), _ in row))) for row in shown]  # fmt: skip
    figure = new_figure(width, 0.8 + sum(0.75 + high for high in highs))
    grid = figure.add_gridspec(len(shown), _PARTS, height_ratios=highs)
    for number, row in enumerate(shown):
        share = _PARTS // len(row)
        for column, ((part, model), over) in enumerate(row):
            axes = figure.add_subplot(grid[number, column * share : (column + 1) * share])
            rows = drawable & _rows(dataset, part, model) & np.isfinite(efforts[over])
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel(_OVER[over])
            first = ((part, model), over) == row[0]
            if part == "numerics":
                errors = _errors(dataset, drawable & (parts == "numerics"))
                axes.set_ylim(errors.min() / 10.0, errors.max() * 10.0)
                axes.tick_params(labelleft=first)
                _numerics(axes, dataset, rows, efforts[over])
                if over == "cost":
                    _front(axes, dataset, rows)
            else:
                _named(axes, dataset, rows, part, (width / len(row) - 0.7, highs[number]))
            if first or part != "numerics":
                axes.set_ylabel(_ERROR if part == "numerics" else "median error")
            head = f"numerics: model {model}" if model and len(models) > 1 else _HEADS[part]
            panel_title(axes, head, width / len(row))
            axes.grid(visible=True, which="major", color="#EBEBEB", linewidth=0.5)
            axes.set_axisbelow(True)
            axes.xaxis.set_minor_formatter(NullFormatter())
    handles = _legend(figure.axes)
    legend_below(figure, handles, columnspacing=1.2)
    absent = int((drawable & (parts == "numerics") & ~known).sum()) if again else 0
    headline(figure, f"{title_of(dataset)}: error against cost", _note(dataset, absent))
    return figure


def _arranged(
    numerics: list[Panel], again: list[Panel], named: list[Panel], most: int
) -> list[list[tuple[Panel, str]]]:
    """Rows of (panel, what it is over), filled alike; the panels of several models have rows of their own."""
    over = [(one, "cost") for one in numerics], [(one, "n_rhs") for one in again], [(one, "cost") for one in named]
    rows, loose = (list(over[:2]), over[2]) if len(numerics) > 1 else ([], [each for some in over for each in some])
    across = -(-len(loose) // max(-(-len(loose) // most), 1))
    return [*filter(None, rows), *(loose[i : i + across] for i in range(0, len(loose), across))]


def _drawable(dataset: xarray.Dataset) -> NDArray[np.bool_]:
    """Settings with a median error and a time that a logarithmic axis has a place for."""
    return np.asarray(np.isfinite(dataset["error_median"].values) & (dataset["cost"].values > 0.0))


def _rows(dataset: xarray.Dataset, part: str, model: str) -> NDArray[np.bool_]:
    of_part = dataset["part"].values == part
    return np.asarray(of_part & (dataset["model"].values == model) if model else of_part)


def _errors(dataset: xarray.Dataset, rows: NDArray[np.bool_]) -> NDArray[np.float64]:
    return np.asarray(np.maximum(dataset["error_median"].values[rows], LEAST), dtype=float)


def _evaluations(dataset: xarray.Dataset) -> NDArray[np.float64]:
    """Median evaluations of the right-hand side per setting; NaN where they are not known, or 0: no logarithm."""
    if "n_rhs" not in dataset:
        return np.full(dataset.sizes["setting"], np.nan)
    values = np.asarray(dataset["n_rhs"].transpose("setting", "case").values, dtype=float)
    known = np.isfinite(values).any(axis=1)
    middle = np.array([np.nanmedian(row) if any_ else np.nan for row, any_ in zip(values, known, strict=True)])
    return np.where(middle > 0.0, middle, np.nan)


def _numerics(axes: Axes, dataset: xarray.Dataset, rows: NDArray[np.bool_], over: NDArray[np.float64]) -> None:
    """A line per family from coarse to fine, over what it costs."""
    for family in dict.fromkeys(dataset["family"].values[rows]):
        own = rows & (dataset["family"].values == family)
        colour, line, marker = LOOKS.get(str(family), UNKNOWN)
        axes.plot(
            over[own], _errors(dataset, own), label=str(family), markersize=3.6, markeredgewidth=0.0,
            color=colour, linestyle=line, marker=marker,
        )  # fmt: skip
    low, high = np.log10(over[rows].min()), np.log10(over[rows].max())
    middle, half = 0.5 * (low + high), max(0.58 * (high - low), 1.05)  # two powers of ten at least
    axes.set_xlim(10.0 ** (middle - half), 10.0 ** (middle + half))


def _front(axes: Axes, dataset: xarray.Dataset, rows: NDArray[np.bool_]) -> None:
    """The Pareto front below the lines, one for each reference: errors against different ones are not compared."""
    best = rows & (dataset["on_front"].values == 1)
    against = dataset["against"].values
    for reference in dict.fromkeys(against[best]):
        own = best & (against == reference)
        cost, error = np.asarray(dataset["cost"].values[own], dtype=float), _errors(dataset, own)
        order = np.argsort(cost)
        axes.plot(
            cost[order], error[order], drawstyle="steps-post", color=QUIET, linewidth=4.0, alpha=0.35, zorder=1,
            label=FRONT, solid_capstyle="round",
        )  # fmt: skip


def _named(axes: Axes, dataset: xarray.Dataset, rows: NDArray[np.bool_], part: str, size: tuple[float, float]) -> None:
    """Points at the left, their names in a column at the right of a panel of some size [in], and lines between."""
    cost, error = np.asarray(dataset["cost"].values[rows], dtype=float), _errors(dataset, rows)
    labels = _labels_of(dataset, rows, part)
    least, most = np.log10(error.min()), np.log10(error.max())
    around = max(0.15 * (most - least), 0.5)
    bottom, top = least - around, most + around
    axes.set_ylim(10.0**bottom, 10.0**top)
    gap = (top - bottom) * LINE / size[1]
    low, high = np.log10(cost.min()) - 0.15, max(np.log10(cost.max()), np.log10(cost.min()) + 0.9) + 0.15
    column = max(1.0 - (LETTER * max(len(words) for words, _ in labels) + 0.35) / size[0], 0.2)
    right = low + (high - low) / column
    axes.set_xlim(10.0**low, 10.0**right)
    axes.spines["bottom"].set_bounds(10.0**low, 10.0**high)
    tens = range(int(np.floor(low)), int(np.floor(high)) + 1)
    axes.set_xticks([10.0**n for n in tens if n >= low])
    axes.set_xticks([k * 10.0**n for n in tens for k in range(2, 10) if low <= n + np.log10(k) <= high], minor=True)
    axes.xaxis.label.set_x(0.5 * column)
    axes.plot(cost, error, linestyle="", marker="o", markersize=3.6, color="#000000", markeredgewidth=0.0)
    beside = 10.0 ** (high + 0.25 * (right - low) / size[0])
    wanted = np.array([np.log10(error[members]).mean() for _, members in labels])
    for (words, members), place in zip(labels, _apart(wanted, gap, bottom, top), strict=True):
        for i in members:
            axes.plot([cost[i], beside], [error[i], 10.0**place], color=QUIET, linewidth=0.4, zorder=1)
        axes.annotate(words, (beside, 10.0**place), (2, 0), textcoords="offset points", va="center", fontsize=7.0)


def _labels_of(dataset: xarray.Dataset, rows: NDArray[np.bool_], part: str) -> list[tuple[str, list[int]]]:
    """(words, points they name) of a panel from low to high."""
    names = [str(model) for model in dataset["model"].values[rows]]
    if part == "data":
        of = [f", {model}" if len(set(names)) > 1 else "" for model in names]
        names = [f"{how}{whose}" for how, whose in zip(dataset["step"].values[rows], of, strict=True)]
    return _labels(names, np.log10(_errors(dataset, rows)), _NEAR)


def _labels(names: list[str], heights: NDArray[np.float64], near: float) -> list[tuple[str, list[int]]]:
    """(words, points they name) from low to high: `1, 2 corotational` for models of a geometry within `near`."""
    found: list[tuple[str, list[int]]] = []
    for i in np.argsort(heights, kind="stable"):
        geometry = names[i].partition(" ")[2] if names[i][0].isdigit() else ""
        same = (own for kind, own in found if geometry and kind == geometry and heights[i] - heights[own[0]] <= near)
        own = next(same, None)
        if own is None:
            found.append((geometry, [int(i)]))
        else:
            own.append(int(i))
    return [(_words([names[i] for i in sorted(own)], geometry), own) for geometry, own in found]


def _words(names: list[str], geometry: str) -> str:
    if not geometry:
        return names[0]
    return f"{', '.join(name.partition(' ')[0] for name in names)} {geometry.replace('_', ' ')}"


def _apart(wanted: NDArray[np.float64], gap: float, low: float, high: float) -> NDArray[np.float64]:
    """Places for ascending ones, `gap` apart at least: moved up, and down again where they would leave at `high`."""
    steps = gap * np.arange(len(wanted))
    places = np.maximum.accumulate(np.maximum(wanted, low + 0.5 * gap) - steps) + steps
    return np.asarray(np.minimum(places, high - 0.5 * gap - steps[::-1]))


def _legend(grid: list[Axes]) -> list[Any]:
    found: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values())


def _note(dataset: xarray.Dataset, absent: int) -> str:
    """The sample, the references, and how many settings have no place over right-hand sides."""
    said = [str(dataset.attrs.get("sample", ""))]
    against = dict.fromkeys(str(a) for a in dataset["against"].values[dataset["part"].values == "numerics"])
    said.append("numerics against " + "; ".join(against))
    if "model" in dataset["part"].values:
        better = dict.fromkeys(str(a) for a in dataset["against"].values[dataset["part"].values == "model"])
        said.append("models against " + "; ".join(better))
    if absent:
        said.append(f"{absent} without a number of right-hand sides above 0 are over time only")
    return ". ".join(filter(None, said))
