"""Stability maps: outcomes over two numeric axes, with the peak rotation where bodies rock."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgb
from matplotlib.image import PcolorImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from rockcli.plotting.common.boundaries import boundary_handles, draw_boundaries
from rockcli.plotting.common.cases import Array, axes_of, in_order, is_numeric, pick, selection_note
from rockcli.plotting.common.labels import (
    axis_label,
    axis_values,
    deforms,
    has_floors,
    lifts_from,
    lifts_word,
    number_words,
    path_of,
    shown_unit,
    title_of,
    two_edged,
    uplift_label,
    variable_label,
)
from rockcli.plotting.common.style import (
    DOUBLE,
    LIFTS,
    MOST_PANELS,
    OUTCOME_COLOURS,
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
from rockcli.scene.ground.amplitudes import AMPLITUDES, PULSE_FREQUENCIES
from rockcli.scene.response import NO_UPLIFT, OUTCOMES, ROCKING, SLIDING, outcome_words

if TYPE_CHECKING:
    import xarray
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_FEWEST_POINTS = 5
"""Points an axis of a map needs; fewer make better curves."""

_ROCKING = LinearSegmentedColormap.from_list("rocking", ["#DCECF8", "#9CC9E6", "#3C86B8", "#0B4770"]).with_extremes(
    over="#4A1A6B"
)

_LEAST = min(OUTCOMES)

_PALETTE = np.rint([np.multiply(255, to_rgb(OUTCOME_COLOURS[OUTCOMES[f]])) for f in sorted(OUTCOMES)]).astype(np.uint8)
"""Colours of the outcomes from flag _LEAST on, as bytes."""

_SLIDING = "////"
"""Hatch of bodies that slide while they rock, or before they overturn."""

UPLIFT = "uplift"
"""Mark of the line at which a body lifts."""

_ACCELERATIONS = ("a_p", "a_p_over_g_tan_alpha", "pga", "pga_over_g_tan_alpha")

_DECADES = 1e3
"""Largest over smallest value from which those spaced by factors, however uneven, stand on a logarithmic axis."""


def plane(dataset: xarray.Dataset) -> tuple[str, str] | None:
    """The two axes of the map, (x, y): the longest numeric ones, at equal length those of the motion.

    A frequency or period lies on x, an amplitude on y; otherwise the first in `vary` is y, the last x.
    """
    numeric = [a for a in axes_of(dataset) if is_numeric(dataset, a) and dataset.sizes[a] >= _FEWEST_POINTS]
    if len(numeric) < 2:
        return None
    role = {a: path_of(dataset, a).split(".")[-1] for a in numeric}
    of_motion = (*PULSE_FREQUENCIES, *AMPLITUDES)
    chosen = sorted(numeric, key=lambda a: (-dataset.sizes[a], role[a] not in of_motion))[:2]
    first, last = sorted(chosen, key=numeric.index)
    lies = [role[a] in PULSE_FREQUENCIES for a in (first, last)]
    stands = [role[a] in AMPLITUDES for a in (first, last)]
    turned = (lies[0] and not lies[1]) or (stands[1] and not stands[0])
    return (first, last) if turned else (last, first)


def draw(dataset: xarray.Dataset) -> Figure:
    """A panel for each point of the other axes."""
    found = plane(dataset)
    if found is None:
        raise ValueError("a map needs two numeric axes")
    dataset = in_order(dataset, *found)
    others = tuple(axis for axis in axes_of(dataset) if axis not in found)
    shown, total = pick(dataset, MOST_PANELS, others)
    rows, columns = grid_of(len(shown))
    natural = SINGLE * 1.3 if columns == 1 else DOUBLE
    width = width_or(natural)
    figure = new_figure(width, 0.95 + rows * (width / columns) * 0.8)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    peaks = _peaks(dataset)
    norm = Normalize(0.0, 1.0)
    present: set[int] = set()
    bounded: set[str] = set()
    lifts = False
    for axes, case in zip(grid.flat, shown, strict=False):
        present |= _panel(axes, dataset.isel(case.place), found, norm, shaded=peaks is not None)
        bounded |= {*draw_boundaries(axes, dataset.isel(case.place), found)}
        lifts |= _uplift(axes, dataset.isel(case.place), found)
    name_panels(grid, [case.label for case in shown], *(axis_label(dataset, axis) for axis in found))
    used = list(grid.flat)[: len(shown)]
    if peaks is not None and ROCKING in present:
        beyond = "max" if peaks.max() > 1.0 else "neither"
        bar = figure.colorbar(ScalarMappable(norm, _ROCKING), ax=used, shrink=0.9, aspect=28, pad=0.02, extend=beyond)
        bar.set_label("rocking: " + variable_label("theta_peak_over_alpha"))
        bar.outline.set_linewidth(0.4)
    slides = bool(_tilts_and_slides(dataset, dataset["outcome"].dims).any())
    uplift = uplift_label(dataset) if lifts else ""
    _legend(figure, present, bounded, shaded=peaks is not None, slides=slides, uplift=uplift)
    headline(figure, title_of(dataset), selection_note(len(shown), total, "maps"))
    if width < natural:  # a layout takes longer than all else
        fit_panels(figure, grid.flat[0], SHORTEST, rows, at_least=True)
    return figure


def _peaks(dataset: xarray.Dataset) -> Array | None:
    """Finite peaks that shade a map; none of a refined map, which has them beside its boundaries only."""
    if "solved" in dataset or "theta_peak_over_alpha" not in dataset or "outcome" not in dataset:
        return None
    peaks = dataset["theta_peak_over_alpha"].values
    finite = peaks[np.isfinite(peaks)]
    return finite if finite.size else None


def _panel(axes: Axes, dataset: xarray.Dataset, found: tuple[str, str], norm: Normalize, *, shaded: bool) -> set[int]:
    x, y = found
    flags = dataset["outcome"].transpose(y, x).values
    colours = _PALETTE[flags - _LEAST]
    if shaded:
        peak = dataset["theta_peak_over_alpha"].transpose(y, x).values
        rocks = (flags == ROCKING) & np.isfinite(peak)
        colours[rocks] = _ROCKING(norm(peak[rocks]), bytes=True)[:, :3]
    values = [axis_values(dataset, axis) for axis in found]
    logs = [is_log(v) for v in values]
    edges = [_edges(v, log=log) for v, log in zip(values, logs, strict=True)]
    if not any(logs) and all(map(_monotonic, edges)):  # as quadrilaterals a million cells take .8 s more
        axes.add_image(PcolorImage(axes, edges[0], edges[1], colours, in_layout=False))
    else:
        axes.pcolormesh(edges[0], edges[1], colours, shading="flat", rasterized=True)
    both = _tilts_and_slides(dataset, (y, x))
    if both.any():
        axes.contourf(values[0], values[1], both, levels=[0.5, 1.5], colors="none", hatches=[_SLIDING])
    scale_axes(axes, *logs)
    axes.set_xlim(edges[0].min(), edges[0].max())
    axes.set_ylim(edges[1].min(), edges[1].max())
    for spine in axes.spines.values():
        spine.set_visible(True)
    return {int(flag) for flag in np.unique(flags)}


def _uplift(axes: Axes, dataset: xarray.Dataset, found: tuple[str, str]) -> bool:
    """Draw the amplitude at which a rigid body lifts, over an axis of amplitudes; whether it is in the map."""
    x, y = found
    role = path_of(dataset, y).rsplit(".", 1)[-1]
    if role not in _ACCELERATIONS or has_floors(dataset) or deforms(dataset):
        return False
    over = role.endswith("_over_g_tan_alpha")
    if two_edged(dataset):
        levels = _of_two_edges(dataset, x, y, over=over)
    elif over and "tan" in lifts_word(dataset):
        levels = [np.ones(dataset.sizes[x])]
        if "uplift_factor" in dataset.variables:
            levels = [_over(dataset, factor, (x,))] if {*(factor := dataset["uplift_factor"]).dims} <= {x} else []
    elif "alpha" in dataset.variables and {*(lifts := lifts_from(dataset)).dims} <= {x}:
        alpha = dataset["alpha"].values
        shown = alpha / np.tan(alpha) if over else lifts.values / shown_unit(dataset, y)[0]
        levels = [np.broadcast_to(shown, dataset.sizes[x])]
    else:
        return False
    if not two_edged(dataset):  # pulses turned round lift it to the other side
        levels += [-level for level in levels]
    low, high = axes.get_ylim()
    levels = [level for level in levels if ((level > low) & (level < high)).any()]
    at = axis_values(dataset, x)
    order = np.argsort(at)
    along = np.concatenate([axes.get_xlim()[:1], at[order], axes.get_xlim()[1:]])  # to the borders of the outer cells
    for level in levels:
        axes.plot(along, np.pad(level[order], 1, mode="edge"), zorder=5, gid=UPLIFT, **LIFTS)
    return bool(levels)


def _of_two_edges(dataset: xarray.Dataset, x: str, y: str, *, over: bool) -> list[Array]:
    """Amplitudes over x at which a body with two different edges lifts, of either sign that the axis y has."""
    if "pga_uplift" not in dataset.variables:
        return []
    lifts, weaker = (_over(dataset, item, (y, x)) for item in (dataset["pga_uplift"], lifts_from(dataset)))
    levels = lifts / (weaker if over else shown_unit(dataset, y)[0])
    return [sign * levels[rows][0] for sign in (1.0, -1.0) if (rows := sign * dataset[y].values > 0.0).any()]


def _over(dataset: xarray.Dataset, item: xarray.DataArray, axes: tuple[str, ...]) -> Array:
    """The values of an item over some axes, also those on which it does not depend."""
    own = item.transpose(*(axis for axis in axes if axis in item.dims)).values
    index = tuple(slice(None) if axis in item.dims else None for axis in axes)
    return np.broadcast_to(own[index], [dataset.sizes[axis] for axis in axes])


def _tilts_and_slides(dataset: xarray.Dataset, axes: tuple[Hashable, ...]) -> NDArray[np.bool_]:
    """Where a body slides that rocks or overturns, over the axes of the outcome in this order."""
    flags = dataset["outcome"].transpose(*axes).values
    if "slide_peak" not in dataset:
        return np.zeros(flags.shape, dtype=bool)
    slides = dataset["slide_peak"].transpose(*axes).values > 0.0
    return np.asarray(slides & (flags >= ROCKING) & (flags != SLIDING))


def is_log(values: Array) -> bool:
    """Whether positive values are spaced by a factor rather than a difference: the same one, or over three decades."""
    if len(values) < 3 or values.min() <= 0.0:
        return False
    steps, factors = np.diff(values), np.diff(np.log(values))
    wide = values.max() > _DECADES * values.min()
    by_factors = np.std(factors) * abs(np.mean(steps)) < np.std(steps) * abs(np.mean(factors))
    return bool(by_factors and (wide or np.ptp(factors) < 0.3))


def scale_axes(axes: Axes, x_log: bool, y_log: bool = False) -> None:
    """Logarithmic axes with plain numbers on them, or powers of ten."""
    plain: Any = FuncFormatter(lambda value, _: number_words(value))
    for log, axis, set_scale, shared in (
        (x_log, axes.xaxis, axes.set_xscale, axes.get_shared_x_axes()),
        (y_log, axes.yaxis, axes.set_yscale, axes.get_shared_y_axes()),
    ):
        if log:
            set_scale("log")
            every = [getattr(each, f"{axis.axis_name}axis") for each in shared.get_siblings(axes)]
            low = min(each.get_minpos() for each in every)  # what is 0 has no place
            high = max(each.get_data_interval()[1] for each in every)
            decades = np.log10(high / low) if low < high else 0.0  # where nothing is drawn low is inf
            short = decades < 1.0 or not any("times" in number_words(5.0 * end) for end in (low, high))
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if decades < 2.5 and short else (1.0,)))
            axis.set_major_formatter(plain)
            axis.set_minor_formatter(NullFormatter())


def _edges(values: Array, *, log: bool) -> Array:
    """Borders of the cells around the values."""
    v = np.log(values) if log else values
    middle = 0.5 * (v[1:] + v[:-1])
    edges = np.concatenate([[v[0] - (middle[0] - v[0])], middle, [v[-1] + (v[-1] - middle[-1])]])
    return np.asarray(np.exp(edges) if log else edges)


def _monotonic(edges: Array) -> bool:
    """Whether edges of cells only grow or only fall, as an image of cells takes them."""
    steps = np.diff(edges)
    return bool((steps > 0.0).all() or (steps < 0.0).all())


def _legend(figure: Figure, present: set[int], bounded: set[str], *, shaded: bool, slides: bool, uplift: str) -> None:
    flags = [flag for flag in OUTCOMES if flag in present and not (shaded and flag == ROCKING)]
    flags.sort(key=lambda flag: flag < NO_UPLIFT)
    patches = [
        Patch(facecolor=OUTCOME_COLOURS[OUTCOMES[f]], edgecolor="#666666", linewidth=0.4, label=_words(f))
        for f in flags
    ]
    if slides:
        patches.append(
            Patch(facecolor="white", edgecolor="#666666", linewidth=0.4, hatch=_SLIDING, label="also slides")
        )
    handles: list[Artist] = [*patches, *boundary_handles(bounded)]
    if uplift:
        handles.append(Line2D([], [], label=uplift, **LIFTS))
    legend_below(figure, handles, 2 if bounded else 4, handlelength=2.2 if bounded else 1.2)


def _words(flag: int) -> str:
    return outcome_words(OUTCOMES[flag])
