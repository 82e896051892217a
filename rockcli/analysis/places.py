"""Coordinates of a dataset in words: where on its axes something is."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.axis_path import axis_path
from rockcli.scene.units import SI, Units, g_of
from rockcli.storage.contents import Contents


def units_of(contents: Contents) -> Units:
    """How the numbers of a dataset are shown to people: accelerations in g of its case."""
    paths = (axis_path(contents.fields[axis].attrs, axis) for axis in contents.axes)
    return Units(g_of(json.loads(contents.attrs.get("case", "{}")), set(paths)))


def coordinate(contents: Contents, dim: str, value: Any, units: Units = SI) -> str:
    """A coordinate value: a label, or at most six digits and, for people, the unit."""
    if isinstance(value, str):
        return value
    attrs = contents.fields[dim].attrs if dim in contents.fields else {}
    return units.coordinate(float(value), str(attrs.get("units", "1")), axis_path(attrs, ""))


def coordinates(contents: Contents, dim: str, units: Units) -> NDArray[np.str_]:
    """All coordinate values of a dimension in words."""
    return np.array([coordinate(contents, dim, value, units) for value in contents.values(dim)], dtype=str)


def place(contents: Contents, dims: Iterable[str], at: Iterable[Any], units: Units) -> str:
    """`block_R=2 m, motion_record_pga=0.2 g`: the point at some positions on some dimensions."""
    pairs = zip(dims, at, strict=True)
    return ", ".join(f"{dim}={coordinate(contents, dim, contents.values(dim)[int(i)], units)}" for dim, i in pairs)


def json_point(contents: Contents, dims: Iterable[str], at: Iterable[int]) -> dict[str, Any]:
    """The coordinates of a point by dimension, as JSON has them."""
    return {dim: json_value(contents.values(dim)[i]) for dim, i in zip(dims, at, strict=True)}


def json_value(value: Any) -> Any:
    """A label as it is, a number as JSON has it: None for what is not finite."""
    if isinstance(value, str):
        return value
    return float(value) if np.isfinite(value) else None
