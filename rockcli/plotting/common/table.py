"""The cases of a dataset as a table of words: every case of a small study, the summary of a large one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common.cases import axes_of, is_numeric, number_at, outcome_at, thresholds_in
from rockcli.plotting.common.labels import shown_unit, unit_in_brackets
from rockcli.scene.thresholds import BESIDE, BRACKETED, FOUND, IN_RANGE, STATES
from rockcli.scene.variables import COUNTS

if TYPE_CHECKING:
    import xarray

MOST = 60
"""Cases listed one by one."""

_SYMBOLS = ("R", "alpha", "p", "eta")
_COLUMNS = (
    "theta_peak_over_alpha", "t_peak", "t_overturn", "n_impacts", "slide_peak", "mu_required", "error_estimate",
)  # fmt: skip
_SUMMED_UP = (
    "theta_peak_over_alpha", "theta_dot_peak", "u_top_peak", "slide_peak", "n_impacts", "t_end", "error_estimate",
)  # fmt: skip

Table = tuple[list[str], list[list[str]], str]
"""Header, rows and a note below."""


def case_table(dataset: xarray.Dataset) -> Table:
    """Every case if there are at most MOST, else quantiles of what was saved over those that stand."""
    axes = axes_of(dataset)
    shape = tuple(int(dataset.sizes[axis]) for axis in axes)
    if int(np.prod(shape, dtype=np.int64)) > MOST:
        return _summary(dataset)
    symbols = [name for name in _SYMBOLS if name in dataset.variables and name not in axes]
    columns = [*_thresholds(dataset), *(name for name in _COLUMNS if name in dataset.variables)]
    names = (*axes, *symbols, *columns)
    head = {name: name + unit_in_brackets(shown_unit(dataset, name)[1]) for name in names}
    header = [*(head[n] for n in axes), *(head[n] for n in symbols), "outcome", *(head[n] for n in columns)]
    rows = []
    for position in np.ndindex(*shape):
        at = [_coordinate(dataset, axis, i) for axis, i in zip(axes, position, strict=True)]
        numbers = [_shown(dataset, name, position) for name in (*symbols, *columns)]
        outcome = outcome_at(dataset, position).replace("_", " ")
        rows.append([*at, *numbers[: len(symbols)], outcome, *numbers[len(symbols) :]])
    told = [j for j in range(len(header)) if any(row[j] for row in rows)]
    return [header[j] for j in told], [[row[j] for j in told] for row in rows], ""


def _summary(dataset: xarray.Dataset) -> Table:
    header = ["", "smallest", "16th percentile", "median", "84th percentile", "largest", "no finite value"]
    rows = []
    refined = "solved" in dataset.variables
    found = [name for name in _thresholds(dataset) if name.endswith(FOUND) or "prescreen" in name]
    for name in (*found, *(name for name in _SUMMED_UP if name in dataset.variables)):
        divisor, unit = shown_unit(dataset, name)
        values = np.asarray(dataset[name].values, dtype=float).ravel() / divisor
        if refined:
            values = values[np.asarray(dataset["solved"].values, dtype=bool).ravel()]
        finite = values[np.isfinite(values) & ~((values < 0.0) & (name in COUNTS))]  # -1: not counted
        if finite.size:
            spread = np.percentile(finite, [0, 16, 50, 84, 100])
            rows.append(
                [name + unit_in_brackets(unit), *(_word(float(x)) for x in spread), str(values.size - finite.size)]
            )
    which = "solved cases" if refined else "cases"
    return header, rows, f"over the {which} with a finite value: overturned cases have no peak"


def _thresholds(dataset: xarray.Dataset) -> list[str]:
    """What a search found for every case: the lowest overturning values, and what stands beside them."""
    axes = set(axes_of(dataset))
    named = [str(name) for name in dataset.data_vars if set(dataset[name].dims) == axes]
    columns = []
    for name in (name for name in named if name.endswith(FOUND)):
        found = thresholds_in(dataset, name)
        parts = ["state"] if (found.state != IN_RANGE).any() else []
        parts += ["low", "high"] if (found.state == BRACKETED).any() else []
        parts += BESIDE[:3] if found.islands is not None and found.islands.any() else ()
        columns += [name, *(f"{name}_{part}" for part in parts), *(n for n in named if n.startswith(f"{name}_prescr"))]
    return columns


def _shown(dataset: xarray.Dataset, name: str, position: tuple[int, ...]) -> str:
    value = number_at(dataset, name, position) / shown_unit(dataset, name)[0]
    return STATES[int(value)].replace("_", " ") if name.endswith(f"{FOUND}_state") else _word(value)


def _coordinate(dataset: xarray.Dataset, axis: str, i: int) -> str:
    value = dataset[axis].values[i]
    return _word(float(value) / shown_unit(dataset, axis)[0]) if is_numeric(dataset, axis) else str(value)


def _word(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.6g}"
