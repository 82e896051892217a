"""Static curves: the block as a pale band, the models on it, their error below; a column for each body."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import Array, axes_of, is_numeric, number_at, pick, selection_note, values_at
from rockcli.plotting.common.labels import path_of, title_of
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    MOST_LINES,
    PANELS_ACROSS,
    QUIET,
    SINGLE,
    abreast,
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

MOST_COLUMNS = 4

_OF_MODELS = ("model", "geometry", "case")
"""Paths of axes that name models."""

_SPRING: dict[str, Any] = {"color": QUIET, "linewidth": 0.9, "dashes": (1, 1.5), "zorder": 1}
"""The springs of all models have the same moment: that at which the block begins to turn."""

_BLOCK: dict[str, Any] = {"color": "#B8B8B8", "linewidth": 2.8, "zorder": 2}

_PIVOT_SIDE: dict[str, Any] = _BLOCK | {"dashes": (1, 0.8)}

_DASHES: tuple[tuple[float, ...], ...] = ((), (5, 1.5), (2, 1.2), (6, 1.5, 1, 1.5))


@dataclass(frozen=True)
class Panel:
    """A row: what is drawn over what.  Values are divided by the block's `scale` at theta/alpha = `at`, if given."""

    model: str
    block: str
    scale: str
    at: int
    label: str
    error: str
    beside: str = ""


_PANELS: tuple[Panel, ...] = (
    Panel(
        "restoring_moment",
        "restoring_moment_block",
        "restoring_moment_block",
        0,
        r"$M_r\,/\,(mgR\,\sin\alpha)$",
        "curve_error_moment_rotation",
    ),
    Panel(
        "pushover_force",
        "pushover_force_block",
        "pushover_force_block",
        0,
        r"$F\,/\,(mg\,\tan\alpha)$",
        "curve_error_pushover",
    ),
    Panel(
        "u_model",
        "u_free_corner",
        "u_free_corner",
        -1,
        r"$u_{top}\,/\,2b$",
        "curve_error_displacements",
        "u_pivot_corner",
    ),
    Panel(
        "v_model",
        "v_free_corner",
        "u_free_corner",
        -1,
        r"$v_{top}\,/\,2b$",
        "curve_error_displacements_vertical",
        "v_pivot_corner",
    ),
    Panel(
        "overturning_moment",
        "overturning_moment_block",
        "overturning_moment_block",
        0,
        r"$M_o\,/\,(m a_g R\,\cos\alpha)$",
        "curve_error_overturning_moment",
    ),
    Panel("energy_ratio", "energy_ratio_block", "", 0, "energy retained per cycle", ""),
)

Position = tuple[int, ...]


@dataclass
class _Line:
    """Curves that coincide: one position on the labelled axes stands for all, with all their names."""

    position: Position
    names: list[tuple[str, ...]]


def without_curves(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so, "" if it can."""
    return "" if _panels(dataset) else "the dataset holds no static curves (curves: [pushover, ...])"


def _panels(dataset: xarray.Dataset) -> list[Panel]:
    return [panel for panel in _PANELS if panel.model in dataset.variables]


def draw(dataset: xarray.Dataset) -> Figure:
    """A column for each body, or panels side by side; a curve for each of its models.

    Axes of numbers that change no more than a model have a column for each point too, others a curve; others that
    change no curve, as of the motion, have neither.
    """
    panels = _panels(dataset)
    block = _that_change(dataset, [name for panel in panels for name in (panel.block, panel.beside) if name])
    model = _that_change(dataset, _of_models(dataset, panels))
    bodies = tuple(a for a in axes_of(dataset) if a in block or (a in model and is_numeric(dataset, a)))
    columns, total = pick(dataset, MOST_COLUMNS, bodies)
    named = {a for a in axes_of(dataset) if path_of(dataset, a) in _OF_MODELS}  # also of models that coincide
    models = tuple(a for a in axes_of(dataset) if a in model | named and a not in bodies)
    found, as_block = _lines(dataset, panels, [case.position for case in columns], models)
    lines = found[:MOST_LINES]
    beside = len(columns) > 1
    across = len(columns) if beside else min(PANELS_ACROSS, abreast(), len(panels))
    down = len(panels) if beside else -(-len(panels) // across)
    width = width_or(SINGLE * 1.2 if across == 1 else DOUBLE)
    figure = new_figure(width, 0.85 + down * max(2.3, 0.95 * width / across))
    grid = figure.subplots(
        2 * down,
        across,
        sharex=True,
        sharey="row" if beside else False,
        squeeze=False,
        height_ratios=[1.0, 0.42] * down,
    )
    written = _corners(panels) == "some" and not beside  # panels beside one another have no room for it
    for row in range(down):
        for column in range(across):
            pair = (grid[2 * row, column], grid[2 * row + 1, column])
            number = row if beside else row * across + column
            if number >= len(panels):
                for axes in pair:
                    axes.set_axis_off()
                continue
            case = columns[column if beside else 0]
            _pair(pair, dataset, panels[number], case.position, lines, named=written)
            if row == 0 and beside:
                panel_title(pair[0], case.label, width / across, fontsize=9.0)
            if column == 0 or not beside:
                pair[0].set_ylabel(panels[number].label)
                pair[1].set_ylabel("error [%]" if panels[number].error else "more [%]")
            if row == down - 1 or (not beside and number + across >= len(panels)):
                pair[1].set_xlabel(r"$\theta/\alpha$")
                pair[1].tick_params(labelbottom=True)
    figure.align_ylabels()
    notes = (selection_note(len(columns), total, "columns"), selection_note(len(lines), len(found), "models"))
    headline(figure, title_of(dataset), "; ".join(note for note in notes if note))
    _legend(figure, dataset, panels, lines, as_block, columns=1 if across == 1 else 3, named=written)
    return figure


def _of_models(dataset: xarray.Dataset, panels: list[Panel]) -> list[str]:
    """Variables that the curves of a model are drawn from."""
    return [panel.model for panel in panels] + ["spring_moment"] * ("spring_moment" in dataset.variables)


def _that_change(dataset: xarray.Dataset, names: list[str]) -> set[str]:
    """Axes along which some of the variables are not the same, but for rounding."""
    found = set()
    for name, axis in product(names, axes_of(dataset)):
        if axis in dataset[name].dims:
            values = np.moveaxis(dataset[name].values, dataset[name].dims.index(axis), 0)
            if not np.allclose(values, values[:1], rtol=1e-9, atol=1e-12, equal_nan=True):
                found.add(axis)
    return found


def _lines(
    dataset: xarray.Dataset, panels: list[Panel], columns: list[Position], models: tuple[str, ...]
) -> tuple[list[_Line], list[tuple[str, ...]]]:
    """The models to draw, and the names of those whose curves are the block's in every panel."""
    every = axes_of(dataset)
    lines: list[_Line] = []
    as_block: list[tuple[str, ...]] = []
    for case in pick(dataset, 10_000, models)[0]:
        names = tuple(
            str(dataset[a].values[i]) if not _bare(dataset, a, i) else f"model {dataset[a].values[i]}"
            for a, i in zip(every, case.position, strict=True)
            if a in models
        )
        spots = [_at(column, case.position) for column in columns]
        if all(_as_block(dataset, panel, spot) for panel in panels for spot in spots):
            if (
                "spring_moment" in dataset.variables
                and np.isfinite(values_at(dataset, "spring_moment", spots[0])).all()
            ):
                as_block.append(names)  # a model, not the block itself
            continue
        same = next((line for line in lines if _coincide(dataset, panels, columns, line.position, case.position)), None)
        if same is None:
            lines.append(_Line(case.position, [names]))
        else:
            same.names.append(names)
    return lines, as_block


def _as_block(dataset: xarray.Dataset, panel: Panel, spot: Position) -> bool:
    """Whether a model's curve is the block's."""
    if panel.error:
        return number_at(dataset, panel.error, spot) == 0.0
    return np.array_equal(values_at(dataset, panel.model, spot), values_at(dataset, panel.block, spot))


def _bare(dataset: xarray.Dataset, axis: str, position: int) -> bool:
    return axis == "model" and str(dataset[axis].values[position]).isdigit()


def _at(column: Position, line: Position) -> Position:
    """A case by its places on the axes of columns and on those of lines, each 0 on the others."""
    return tuple(map(max, column, line))


def _coincide(dataset: xarray.Dataset, panels: list[Panel], columns: list[Position], a: Position, b: Position) -> bool:
    return all(
        np.array_equal(values_at(dataset, name, _at(c, a)), values_at(dataset, name, _at(c, b)), equal_nan=True)
        for name in _of_models(dataset, panels)
        for c in columns
    )


def _pair(
    pair: tuple[Axes, Axes],
    dataset: xarray.Dataset,
    panel: Panel,
    column: Position,
    lines: list[_Line],
    *,
    named: bool,
) -> None:
    """A panel of curves and, below it, of their errors; `named`: which corner a line is of is written in its panel."""
    curve, error = pair
    ratio = np.asarray(dataset["theta_over_alpha"].values, dtype=float)
    here = _at(column, lines[0].position) if lines else column
    scale = float(values_at(dataset, panel.scale, here)[panel.at]) if panel.scale else 1.0
    block = values_at(dataset, panel.block, here) / scale
    rises = panel.model == "restoring_moment"
    free = curve.plot(*_from_rest(ratio, block, rises), **_BLOCK)
    if panel.beside:
        other = values_at(dataset, panel.beside, here) / scale
        pivot_side = curve.plot(ratio, other, **_PIVOT_SIDE)
        if named:
            curve.legend([*free, *pivot_side], ["free corner", "pivot-side corner"], loc="best", fontsize=7.0)
    for number, line in enumerate(lines):
        spot = _at(column, line.position)
        own = values_at(dataset, panel.model, spot) / scale
        colour, dashes = COLOURS[number], _DASHES[(number + 1) % len(_DASHES)]
        curve.plot(*_from_rest(ratio, own, rises), color=colour, linewidth=1.0, dashes=dashes or (None, None), zorder=3)
        if rises:
            spring = values_at(dataset, "spring_moment", spot) / scale
            if np.isfinite(spring).all() and not np.array_equal(spring, own):
                curve.plot(*_from_rest(ratio, spring, True), **_SPRING)
        apart = np.round(100.0 * (own - block), 9)  # no axis of 1e-17 for rounding
        error.plot(ratio, apart, color=colour, linewidth=1.0, dashes=dashes or (None, None))
    level = 1.0 if panel.model in ("overturning_moment", "energy_ratio") else 0.0
    curve.axhline(level, color=QUIET, linewidth=0.4, zorder=0)
    error.plot([-0.02, 1.0], [0.0, 0.0], color=QUIET, linewidth=0.4, zorder=0)  # `axhline` is rounded: 0 is 1e-17
    error.margins(y=0.12)
    curve.set_xlim(-0.02 if rises else 0.0, 1.0)


def _from_rest(ratio: Array, values: Array, rises: bool) -> tuple[Array, Array]:
    """A moment grows at rest before the body turns."""
    return (np.concatenate([[0.0], ratio]), np.concatenate([[0.0], values])) if rises else (ratio, values)


def _legend(
    figure: Figure,
    dataset: xarray.Dataset,
    panels: list[Panel],
    lines: list[_Line],
    as_block: list[tuple[str, ...]],
    columns: int,
    *,
    named: bool,
) -> None:
    block = "block, free corner" if _corners(panels) == "all" else "block"
    if panels[0].model == "energy_ratio":
        block = r"impacts with Housner's $\eta$"
    if as_block:
        block += " = " + (words_of(as_block) or _only_model(dataset, panels))
    handles = [Line2D([], [], **_BLOCK, label=block)]
    if _corners(panels) != "none" and not named:
        handles.append(Line2D([], [], **_PIVOT_SIDE, label="block, pivot-side corner"))
    for number, line in enumerate(lines):
        label = words_of(line.names) or _only_model(dataset, panels)
        handle = Line2D([], [], color=COLOURS[number], linewidth=1.0, label=label)
        handle.set_dashes(_DASHES[(number + 1) % len(_DASHES)])
        handles.append(handle)
    if "spring_moment" in dataset.variables and any(_yields(dataset, line) for line in lines):
        handles.append(Line2D([], [], **_SPRING, label="spring alone"))
    legend_below(figure, handles, columns, handlelength=2.6)


def _corners(panels: list[Panel]) -> str:
    """Whether `all`, `some` or `none` of the panels show corners of the block."""
    found = {bool(panel.beside) for panel in panels}
    return "some" if len(found) > 1 else "all" if found == {True} else "none"


def _only_model(dataset: xarray.Dataset, panels: list[Panel]) -> str:
    return str(dataset[panels[0].model].attrs.get("model", "model"))


def _yields(dataset: xarray.Dataset, line: _Line) -> bool:
    spring, own = (values_at(dataset, name, line.position) for name in ("spring_moment", "restoring_moment"))
    return bool(np.isfinite(spring).all() and not np.array_equal(spring, own))


def words_of(names: list[tuple[str, ...]]) -> str:
    """One label for curves that coincide: `models 1, 2; corotational` for (model 1, corotational), (model 2, ...)."""
    parts = [list(dict.fromkeys(column)) for column in zip(*names, strict=True)]
    if len(names) < int(np.prod([len(part) for part in parts])):  # not every combination is there
        return " = ".join(_said([[part] for part in name]) for name in names)
    return _said(parts)


def _said(parts: list[list[str]]) -> str:
    words = []
    for part in parts:
        if len(part) > 1 and all(name.startswith("model ") for name in part):
            words.append("models " + ", ".join(name.removeprefix("model ") for name in part))
        else:
            words.append(", ".join(part))
    return ("; " if any("," in word for word in words) else ", ").join(words).replace("_", " ")
