"""Datasets as xarray sees them: from a file, or from memory with the same content."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rockcli.errors import StudyError, is_file
from rockcli.scene.variables import PEAK
from rockcli.storage.checksum import NAME, checksum, note_opened
from rockcli.storage.contents import AXES, POINTS, Contents, Field
from rockcli.storage.netcdf import no_dataset

if TYPE_CHECKING:
    import xarray


def open_dataset(path: Path) -> xarray.Dataset:
    """Read a dataset file whole; `StudyError` if it cannot be read."""
    import xarray

    if not is_file(path):
        raise StudyError(no_dataset(path) or "is no file", file=path)
    note_opened(path)
    try:
        with xarray.open_dataset(path, engine="netcdf4") as dataset:
            missing = {"axes", "identity"} - set(dataset.attrs)
            if missing:
                raise StudyError("is not a dataset written by `rock run`", file=path)
            return dataset.load()
    except StudyError:
        raise
    except Exception as error:  # the libraries have many words for bytes that mean nothing
        told = getattr(error, "strerror", None) or error
        raise StudyError(no_dataset(path) or f"cannot be read as a dataset: {told}", file=path) from None


def as_accessor(name: str, accessor: type) -> None:
    """Have every xarray.Dataset show a class under a name."""
    import xarray

    if not hasattr(xarray.Dataset, name):
        register: Callable[[str], Callable[[type], type]] = xarray.register_dataset_accessor
        register(name)(accessor)


def _laid_out(dataset: Any) -> xarray.Dataset:
    """A dataset of this program with its dimensions as a file has them, whatever xarray made of it meanwhile.

    Raises:
        StudyError: it is none, or its cases have dimensions that are no axes.
    """
    import xarray

    if not isinstance(dataset, xarray.Dataset):
        raise StudyError(
            f"expected a dataset of rockcli.run or rockcli.open_dataset, not {type(dataset).__name__}; "
            "rockcli.open_dataset(path) reads a file"
        )
    laid: xarray.Dataset = dataset
    if "axes" not in laid.attrs:
        raise StudyError("is not a dataset of `rock run` or rockcli.run: it does not name its axes")
    axes = str(laid.attrs["axes"]).split()
    left = [axis for axis in axes if axis in laid.dims]
    for name in {"outcome", PEAK} & set(laid.variables):
        if others := [str(dim) for dim in laid[name].dims if dim not in left]:
            raise StudyError(
                f"{name!r} is over {', '.join(others)}, which is no axis of the study ({', '.join(axes) or 'none'}): "
                "give the dataset before dimensions were renamed, stacked or added, or select one point of them"
            )
    if "reasons" in laid.variables and not laid["reasons"].dims:  # squeezed, as there was one
        laid = laid.assign_coords(reasons=("reasons", [laid["reasons"].item()], laid["reasons"].attrs))
    return laid.transpose(*left, ...)


def of_a_part(dataset: xarray.Dataset) -> set[str]:
    """The axes of the study that are gone from a dataset, or of which it has another number of points than the study.

    Datasets of earlier builds do not tell how many that were.
    """
    sizes = {axis: str(dataset.sizes.get(axis, "")) for axis in _points(dataset)}
    return {axis for axis, points in _points(dataset).items() if not sizes[axis] or points not in ("", sizes[axis])}


def _points(dataset: xarray.Dataset) -> dict[str, str]:
    """How many points the study has on each axis; "" where that is not told."""
    axes, points = str(dataset.attrs[AXES]).split(), str(dataset.attrs.get(POINTS, "")).split()
    return dict(zip(axes, points if len(points) == len(axes) else [""] * len(axes), strict=True))


def with_axes_left(dataset: xarray.Dataset) -> xarray.Dataset:
    """A dataset, or a part of one whose attributes speak of the axes that are left; raises as `from_xarray`.

    What a suite comes to goes with any of its members and with the axis of its intensity, and what the dataset is
    compared to with an axis.
    """
    dataset = _laid_out(dataset)
    points = {axis: n for axis, n in _points(dataset).items() if axis in dataset.dims}
    fewer, gone = of_a_part(dataset), _points(dataset).keys() - points.keys()
    ensemble = json.loads(dataset.attrs.get("ensemble", "{}"))
    over = ensemble.get("axis", [])
    members = {*(over if isinstance(over, list) else [over])}
    if not gone and not fewer & members:
        return dataset
    attrs = dataset.attrs | {AXES: " ".join(points), POINTS: " ".join(points.values())}
    if fewer & members or ensemble.get("along") in gone:
        del attrs["ensemble"]
        of_suite = [name for name in ensemble["fields"] if name in dataset.variables]
        if not gone & {*members, ensemble.get("along")}:  # what is told of each member stays
            of_suite = [name for name in of_suite if not {*map(str, dataset[name].dims)} & members]
        dataset = dataset.drop_vars(of_suite)
    if gone & set(json.loads(attrs.get("compare_to", "null")) or ()):
        del attrs["compare_to"]
    part = dataset.copy()
    part.attrs = attrs
    return part


def from_xarray(dataset: xarray.Dataset) -> Contents:
    """What a dataset holds, of a part of one the axes that are left.

    Raises:
        StudyError: it is none of this program, its cases have dimensions that are no axes, or an axis has no values.
    """
    dataset = _laid_out(dataset)
    axes = tuple(axis for axis in str(dataset.attrs["axes"]).split() if axis in dataset.dims)
    if bare := [axis for axis in axes if axis not in dataset.variables]:
        raise StudyError(f"has no values of its axis {bare[0]!r}: give the dataset before the coordinate was dropped")
    fields = {
        str(name): Field(tuple(map(str, item.dims)), item.values, dict(item.attrs), coordinate=name in dataset.coords)
        for name, item in dataset.variables.items()
    }
    return Contents(axes, fields, {str(key): value for key, value in dataset.attrs.items()})


def to_xarray(contents: Contents) -> xarray.Dataset:
    """The Dataset that opening the written file would give."""
    return assembled(contents.fields, contents.attrs | {NAME: checksum(contents)} | contents.named_axes)


def assembled(fields: Mapping[str, Field], attrs: Mapping[str, Any]) -> xarray.Dataset:
    """A Dataset of variables and coordinates by name."""
    import xarray

    items = {name: (item.dims, item.values, dict(item.attrs)) for name, item in fields.items()}
    coords = {name: items[name] for name, item in fields.items() if item.coordinate}
    data = {name: value for name, value in items.items() if name not in coords}
    return xarray.Dataset(data, coords, attrs)
