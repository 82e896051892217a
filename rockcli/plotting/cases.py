"""Which cases of a dataset a figure shows, and what each is called."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.labels import coordinate_label
from rockcli.scene.response import OUTCOMES

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shown:
    """One case in a figure: its position on the axes, its name, and the position of what it is compared with."""

    position: tuple[int, ...]
    label: str
    reference: tuple[int, ...] | None = None


def axes_of(dataset: xarray.Dataset) -> tuple[str, ...]:
    """Names of the dimensions that are axes of the study."""
    return tuple(str(dataset.attrs.get("axes", "")).split())


def is_numeric(dataset: xarray.Dataset, axis: str) -> bool:
    """Whether an axis has numbers for coordinates."""
    return bool(dataset[axis].dtype.kind == "f")


def values_at(dataset: xarray.Dataset, name: str, position: tuple[int, ...]) -> Array:
    """Values of a variable or coordinate for one case: a number, or (time,) or (impact,)."""
    item = dataset[name]
    chosen = {axis: i for axis, i in zip(axes_of(dataset), position, strict=True) if axis in item.dims}
    return np.asarray(item.isel(chosen).values, dtype=float)


def number_at(dataset: xarray.Dataset, name: str, position: tuple[int, ...]) -> float:
    """A number of one case; NaN if the dataset has no such variable."""
    return float(values_at(dataset, name, position)) if name in dataset.variables else np.nan


def outcome_at(dataset: xarray.Dataset, position: tuple[int, ...]) -> str:
    """Meaning of a case's outcome, "" if it was not saved."""
    return OUTCOMES[int(number_at(dataset, "outcome", position))] if "outcome" in dataset.variables else ""


def pick(dataset: xarray.Dataset, most: int, axes: tuple[str, ...] | None = None) -> tuple[list[Shown], int]:
    """Cases to show, at most `most` spread evenly, and how many there are.

    Where the study compares (`compare_to`), the reference is not a case of its own but goes with each.
    `axes` restricts the positions to some of the axes (the others stay at 0); references are then not given.
    """
    every = axes_of(dataset)
    names = every if axes is None else axes
    reference = reference_on_axes(dataset) if axes is None else {}
    sizes = [int(dataset.sizes[a]) if a in names else 1 for a in every]
    positions = [tuple(int(i) for i in position) for position in np.ndindex(*sizes)]
    if reference:
        positions = [p for p in positions if _referred(every, p, reference) != p] or positions
    total = len(positions)
    if total > most:
        positions = [positions[int(i)] for i in np.unique(np.linspace(0, total - 1, most).round())]
    shown = []
    for position in positions:
        parts = [coordinate_label(dataset, a, i) for a, i, n in zip(every, position, sizes, strict=True) if n > 1]
        other = _referred(every, position, reference) if reference else None
        shown.append(Shown(position, ", ".join(parts), None if other == position else other))
    return shown, total


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
