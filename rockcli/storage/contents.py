"""What a dataset holds, as plain arrays: the form between the solvers and the file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.auto import CANDIDATES
from rockcli.scene.laws.contact import MODES
from rockcli.scene.response import OUTCOMES
from rockcli.scene.variables import OF_SOURCE, VARIABLES

CONVENTIONS = "CF-1.11"

DIM_TIME, DIM_IMPACT, DIM_REASONS = "time", "impact", "reasons"

COORDINATES: tuple[str, ...] = (
    "R",
    "alpha",
    "p",
    "eta",
    "g",
    "uplift_factor",
    "a_p",
    "omega_p",
    "pga",
    "pgv",
    *OF_SOURCE,
)
"""What a plot needs beside the axes, over the axes they depend on."""

OF_TABLES = ("given_", "note_")
"""What names begin with of columns of the table that an axis was read from: settings, and notes for readers."""


AXES, POINTS = "axes", "points"
"""Root attributes of a dataset: names of its axes, and how many points the study has on each."""


@dataclass(frozen=True, eq=False)
class Field:
    """One variable: dimension names, values of that shape, attributes; `coordinate` as xarray means it."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, Any] = field(default_factory=dict)
    coordinate: bool = False

    @property
    def is_text(self) -> bool:
        """Whether the values are strings."""
        return self.values.dtype.kind in "OUT"


@dataclass(frozen=True, eq=False)
class Contents:
    """A whole dataset.

    Attributes:
        axes: names of the dimensions that are axes of the study, outermost first.
        fields: variables and coordinates by name, in the order they are written.
        attrs: root attributes, text.
    """

    axes: tuple[str, ...]
    fields: dict[str, Field]
    attrs: dict[str, str]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points on each axis."""
        return tuple(len(self.fields[name].values) for name in self.axes)

    @property
    def named_axes(self) -> dict[str, str]:
        """The root attributes that say which axes there are."""
        return {AXES: " ".join(self.axes), POINTS: " ".join(map(str, self.shape))}

    @property
    def sizes(self) -> dict[str, int]:
        """Length of every dimension, axes first."""
        sizes = dict(zip(self.axes, self.shape, strict=True))
        for item in self.fields.values():
            sizes.update(zip(item.dims, item.values.shape, strict=True))
        return sizes

    def values(self, name: str) -> NDArray[Any]:
        """Values of a variable; KeyError if the dataset has none of that name."""
        return self.fields[name].values

    def over_axes(self, name: str) -> NDArray[Any]:
        """Values of a variable that depends on some of the axes only, broadcast to all of them; other dims last."""
        item = self.fields[name]
        index = tuple(slice(None) if axis in item.dims else None for axis in self.axes)
        beside = tuple(size for dim, size in zip(item.dims, item.values.shape, strict=True) if dim not in self.axes)
        return np.broadcast_to(item.values[index], (*self.shape, *beside))


def axis_field(
    name: str, path: str, values: Sequence[Any] | NDArray[Any], *, numeric: bool, unit: str, words: str | None = None
) -> Field:
    """Coordinate of an axis of the study, by its path and what that is in words: floats with units, or strings."""
    attrs = {"long_name": words or path, "path": path}
    if numeric:
        return Field((name,), np.asarray(values, dtype=float), attrs | {"units": unit}, coordinate=True)
    return Field((name,), text([str(v) for v in values]), attrs, coordinate=True)


def variable_field(name: str, dims: tuple[str, ...], values: NDArray[Any], **attrs: Any) -> Field:
    """A variable of scene/variables.py with its attributes; `attrs` replace or add."""
    row = VARIABLES[name]
    described: dict[str, Any] = {"long_name": row.sentence}
    if name == "outcome":
        described |= {
            "flag_values": np.array(sorted(OUTCOMES), dtype=np.int8),
            "flag_meanings": " ".join(OUTCOMES[flag] for flag in sorted(OUTCOMES)),
        }
    elif name == "model_used":
        described |= {
            "flag_values": np.array(list(CANDIDATES), dtype=np.int8),
            "flag_meanings": " ".join(CANDIDATES.values()),
        }
    elif name == "contact_mode":
        described |= {"flag_values": np.array(list(MODES), dtype=float), "flag_meanings": " ".join(MODES.values())}
    elif name != "reason":
        described["units"] = row.unit
    return Field(dims, values, described | attrs, coordinate=name in COORDINATES)


def time_field(values: NDArray[np.float64]) -> Field:
    """The output times [s], without a standard name: seconds from the first sample of the motion, not a date."""
    return Field((DIM_TIME,), values, {"long_name": "time from the beginning of the motion", "units": "s"}, True)


def reasons_field(sentences: Sequence[str]) -> Field:
    """The messages that `reason` points to."""
    return Field((DIM_REASONS,), text(sentences), {"long_name": "messages that `reason` points to"}, True)


def text(values: Sequence[str]) -> NDArray[Any]:
    """Strings as netCDF and xarray hold them: an object array."""
    array = np.empty(len(values), dtype=object)
    array[:] = list(values)
    return array


def root_attributes(
    *, title: str, source: str, history: str, references: str, more: Mapping[str, str]
) -> dict[str, str]:
    """Root attributes in a fixed order: what CF asks for, then the program's own."""
    asked = {"Conventions": CONVENTIONS, "title": title, "source": source, "history": history, "references": references}
    return asked | dict(more)
