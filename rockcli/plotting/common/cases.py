"""Which cases of a dataset a figure shows, and what each is called."""

from __future__ import annotations

import json
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.common.labels import coordinate_label
from rockcli.scene.response import OUTCOMES, overturned
from rockcli.scene.thresholds import Thresholds
from rockcli.scene.variables import PEAK

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]
T = TypeVar("T")


@dataclass(frozen=True)
class Shown:
    """One case in a figure.

    Attributes:
        position: on all axes.
        place: {axis: position} on those it was picked on, as `isel` takes it.
        label: its name; reference: the position of what it is compared with.
    """

    position: tuple[int, ...]
    place: dict[str, int]
    label: str
    reference: tuple[int, ...] | None = None


def axes_of(dataset: xarray.Dataset) -> tuple[str, ...]:
    """Names of the dimensions that are axes of the study."""
    return tuple(str(dataset.attrs.get("axes", "")).split())


def is_numeric(dataset: xarray.Dataset, axis: str) -> bool:
    """Whether an axis has numbers for coordinates."""
    return bool(dataset[axis].dtype.kind == "f")


def in_order(dataset: xarray.Dataset, *axes: str) -> xarray.Dataset:
    """The same with the points of these axes of numbers in ascending order, as lines and cells are drawn between them.

    An axis that only falls stays as it is.
    """
    for axis in axes:
        values = dataset[axis].values
        if not (np.diff(values) < 0.0).all():
            order = np.argsort(values, kind="stable")
            dataset = dataset if (np.diff(order) > 0).all() else dataset.isel({axis: order})
    return dataset


def isolated(y: Array) -> NDArray[np.intp]:
    """Values between two that are none: a line does not show them."""
    known = np.concatenate([[False], np.isfinite(y), [False]])
    return np.flatnonzero(known[1:-1] & ~known[:-2] & ~known[2:])


def values_at(dataset: xarray.Dataset, name: str, position: tuple[int, ...]) -> Array:
    """Values of a variable or coordinate for one case: a number, or (time,) or (impact,)."""
    return values_of(dataset[name], axes_of(dataset), position)


def values_of(item: xarray.DataArray, axes: tuple[str, ...], position: tuple[int, ...]) -> Array:
    """Values of an array for one case: a number, or (time,) or (impact,)."""
    chosen = {axis: i for axis, i in zip(axes, position, strict=True) if axis in item.dims}
    return np.asarray(item.isel(chosen).values, dtype=float)


def number_at(dataset: xarray.Dataset, name: str, position: tuple[int, ...]) -> float:
    """A number of one case; NaN if the dataset has no such variable."""
    return float(values_at(dataset, name, position)) if name in dataset.variables else np.nan


def thresholds_in(dataset: xarray.Dataset, name: str) -> Thresholds:
    """What a search found for every case: the variable of that name and those beside it."""
    return Thresholds.read(name, lambda one: dataset[one].values if one in dataset.variables else None)


def outcome_at(dataset: xarray.Dataset, position: tuple[int, ...]) -> str:
    """Meaning of a case's outcome, "" if it was not saved, or is masked (`dataset.where`)."""
    flag = number_at(dataset, "outcome", position)
    return "" if np.isnan(flag) else OUTCOMES[int(flag)]


def has_overturned(dataset: xarray.Dataset, position: tuple[int, ...]) -> bool:
    """Whether a case overturned, with or without an impact before."""
    return bool(overturned(number_at(dataset, "outcome", position)))


def positions_on(dataset: xarray.Dataset, names: Collection[str]) -> list[tuple[int, ...]]:
    """Every position on the axes of some names, in C order; on the others it is 0."""
    return list(np.ndindex(*(int(dataset.sizes[axis]) if axis in names else 1 for axis in axes_of(dataset))))


def pick(
    dataset: xarray.Dataset, most: int, axes: tuple[str, ...] | None = None, first: Array | None = None
) -> tuple[list[Shown], int]:
    """Cases to show, at most `most`, and how many there are: spread evenly, of cases with no order over their peaks.

    Where the study compares (`compare_to`), the reference is not a case of its own but goes with each.
    Cases whose histories are identical although a label differs are one; those whose histories were not saved are left
    out.
    `axes` restricts the positions to some of the axes (the others stay at 0); references are then not given, and points
    of the innermost axis stay together.  `first` is a number for each of these, in their order: those of the least are
    shown instead of evenly spread ones.
    """
    every = axes_of(dataset)
    names = every if axes is None else axes
    reference = reference_on_axes(dataset) if axes is None else {}
    positions = positions_on(dataset, names)
    if axes is None:
        positions = [p for p in positions if followed(dataset, p)] or positions
    if reference:
        positions = [p for p in positions if _referred(every, p, reference) != p] or positions
    groups = [[p] for p in positions] if axes is not None else _alike(dataset, positions, reference)
    shown = []
    long = [axis for axis in every if axis in names and dataset.sizes[axis] > 1]
    some = (
        _spread_over_peaks(dataset, groups, most)
        if axes is None
        else _by_rows(groups, int(dataset.sizes[long[-1]]) if long else 1, most, first)
    )
    for group in some:
        other = _referred(every, group[0], reference) if reference else None
        if other is not None and not followed(dataset, other):
            other = None
        words = group_label(dataset, group, long)
        place = {axis: i for axis, i in zip(every, group[0], strict=True) if axis in names}
        shown.append(Shown(group[0], place, words, None if other == group[0] else other))
    return shown, len(groups)


def followed(dataset: xarray.Dataset, position: tuple[int, ...]) -> bool:
    """Whether the history of a case was saved, or would have been but that it failed."""
    if "theta" not in dataset.variables or outcome_at(dataset, position) == "failed":
        return True
    return bool(np.isfinite(values_at(dataset, "theta", position)).any())


def _spread_over_peaks(
    dataset: xarray.Dataset, groups: list[list[tuple[int, ...]]], most: int
) -> list[list[tuple[int, ...]]]:
    """Some of the cases, in their order: along one axis of numbers evenly, else from the least to the largest peak.

    Of the latter the largest of those that come back is always one.
    """
    long = [axis for axis in axes_of(dataset) if dataset.sizes[axis] > 1]
    ordered = len(long) == 1 and is_numeric(dataset, long[0])
    if len(groups) <= most or ordered or PEAK not in dataset.variables:
        return spread(groups, most)
    peaks = np.array([number_at(dataset, PEAK, group[0]) for group in groups])
    by_peak = np.argsort(np.nan_to_num(peaks, nan=-1.0, posinf=np.inf), kind="stable")
    chosen = spread(by_peak.tolist(), most)
    back = by_peak[np.isfinite(peaks[by_peak])]
    lower = [k for k, i in enumerate(chosen) if np.isfinite(peaks[i])]
    if lower and back[-1] not in chosen:
        chosen[lower[-1]] = int(back[-1])
    return [groups[i] for i in sorted(chosen)]


def _by_rows(items: list[T], row: int, most: int, first: Array | None) -> list[T]:
    """At most `most` of items, evenly or those of the least of `first`, in their order.

    In whole rows of the innermost axis where they fit, a body's alternatives.
    """
    row = row if 1 < row <= most < len(items) else 1
    rows = [items[i : i + row] for i in range(0, len(items), row)]
    if first is not None:
        least = np.argsort(first.reshape(-1, row).min(axis=1), kind="stable")[: most // row]
        return [item for i in sorted(least.tolist()) for item in rows[i]]
    return [item for some in spread(rows, most // row) for item in some]


def spread(items: list[T], most: int) -> list[T]:
    """At most `most` of some items, evenly."""
    if len(items) <= most:
        return items
    return [items[int(i)] for i in np.unique(np.linspace(0, len(items) - 1, most).round())]


def _alike(
    dataset: xarray.Dataset, positions: list[tuple[int, ...]], reference: dict[str, int]
) -> list[list[tuple[int, ...]]]:
    """Positions in groups that move alike, and so do their references; numbers on axes are never put together."""
    every = axes_of(dataset)
    groups: dict[object, list[tuple[int, ...]]] = {}
    for position in positions:
        key: object = position
        if "theta" in dataset.variables and np.isfinite(values_at(dataset, "theta", position)).any():
            numbers = tuple(i for a, i in zip(every, position, strict=True) if is_numeric(dataset, a))
            key = (numbers, same_key(dataset, position), same_key(dataset, _referred(every, position, reference)))
        groups.setdefault(key, []).append(position)
    return list(groups.values())


def same_key(dataset: xarray.Dataset, position: tuple[int, ...]) -> tuple[bytes, ...]:
    """What is equal for two cases whose body, motion and response are."""
    names = (
        "theta",
        "theta_dot",
        "slide",
        "a_g",
        "a_v",
        "alpha",
        "p",
        "alpha_left",
        "alpha_right",
        "outline_x",
        "outline_z",
    )
    return tuple(values_at(dataset, name, position).tobytes() for name in names if name in dataset.variables)


def group_label(dataset: xarray.Dataset, group: list[tuple[int, ...]], axes: list[str]) -> str:
    """Name of cases shown as one: an axis all of whose points are there is not mentioned."""
    every = axes_of(dataset)
    columns = {a: list(dict.fromkeys(i)) for a, i in zip(every, zip(*group, strict=True), strict=True)} if every else {}
    if len(group) < int(np.prod([len(column) for column in columns.values()])):  # not every combination is there
        at = next(number for number, axis in enumerate(every) if len(columns[axis]) > 1)
        apart = [[position for position in group if position[at] == i] for i in columns[every[at]]]
        return " = ".join(group_label(dataset, part, axes) for part in apart)
    parts = []
    for axis in axes:
        column = columns[axis]
        if len(column) == 1 or len(column) < int(dataset.sizes[axis]):
            parts.append(" = ".join(coordinate_label(dataset, axis, i) for i in column))
    return ", ".join(parts)


def reference_words(dataset: xarray.Dataset) -> str:
    """What cases are compared with, "" if nothing."""
    return ", ".join(coordinate_label(dataset, axis, i) for axis, i in reference_on_axes(dataset).items())


def selection_note(shown: int, total: int, what: str = "cases") -> str:
    """Says that a figure does not show everything."""
    return f"{shown} of {total} {what} shown" if shown < total else ""


def reference_on_axes(dataset: xarray.Dataset) -> dict[str, int]:
    """Axis -> position of the reference."""
    found = {}
    for axis, value in (json.loads(dataset.attrs.get("compare_to", "null")) or {}).items():
        values = dataset[axis].values
        near = np.isclose(values, float(value), rtol=1e-9) if is_numeric(dataset, axis) else values == str(value)
        if near.any():
            found[axis] = int(np.argmax(near))
    return found


def _referred(axes: tuple[str, ...], position: tuple[int, ...], reference: dict[str, int]) -> tuple[int, ...]:
    return tuple(reference.get(axis, i) for axis, i in zip(axes, position, strict=True))
