"""Part of a dataset by values on its axes, and several datasets as one."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.errors import StudyError
from rockcli.plotting.common.case_settings import DATASET, resolved_case, varied
from rockcli.plotting.common.cases import Array, axes_of, is_numeric
from rockcli.plotting.common.labels import coordinate_label, lifts_from, path_of, shown_unit
from rockcli.scene.likeness import as_read
from rockcli.scene.variables import IMPACT, MOTION, TIME

if TYPE_CHECKING:
    import xarray

_NEAR = 1e-6
"""Relative difference up to which a number that was typed is the one of the axis."""

_MOST_NAMED = 20

_LONGEST = 80
"""Characters of a label that is not there by which the one meant is looked for."""

_MANY = 10**6
"""More ground motions than a dataset with histories has."""


def selected(
    dataset: xarray.Dataset, chosen: Mapping[str, Any], beside: Sequence[str] = ()
) -> tuple[xarray.Dataset, str]:
    """The cases at some values of axes, and what they are called; the axes stay, with one point where one is chosen.

    Args:
        dataset: of `rock run`.
        chosen: {axis, by its name, its path or the end of that: a value or a list of values}; numbers in SI units, or
            as `0.4g` and `10deg`; text may be several with commas between.
        beside: what else may be said where it is read, for the error about an unknown axis.

    Raises:
        StudyError: there is no such axis or value.
    """
    words = []
    for said, values in chosen.items():
        axis = axis_called(dataset, said, beside)
        many = np.asarray(values).tolist() if hasattr(values, "__array__") else values
        labels = set() if is_numeric(dataset, axis) else {str(label) for label in dataset[axis].values}
        given = many if isinstance(many, list | tuple) else [many]
        every = [one for value in given for one in (apart(value, labels) if isinstance(value, str) else [value])]
        places = list(dict.fromkeys(place_on(dataset, axis, value) for value in every))
        if dataset.sizes[axis] > 1:
            words.append(" and ".join(coordinate_label(dataset, axis, place) for place in places))
        dataset = _at(dataset, axis, places)
    return dataset, ", ".join(words)


def apart(text: str, labels: Collection[str]) -> list[str]:
    """What stands between the commas of a text; a label that has some itself is one."""
    pieces, found = text.split(","), []
    while pieces:
        joined = [",".join(pieces[:n]) for n in range(len(pieces), 0, -1)]
        whole = next((each for each in joined if each in labels or each.strip() in labels), pieces[0])
        pieces = pieces[whole.count(",") + 1 :]
        found.append(whole if whole in labels else whole.strip())
    return found


def axis_called(dataset: xarray.Dataset, said: str, beside: Sequence[str] = ()) -> str:
    """The axis of a name, a path in the study, or the end of one.

    Raises:
        StudyError: there is none, or several are called so.
    """
    axes = axes_of(dataset)
    found = [axis for axis in axes if said in (axis, path_of(dataset, axis))]
    found = found or [axis for axis in axes if path_of(dataset, axis).endswith(f".{said}")]
    if len(found) != 1:
        there = f"the axes are {', '.join([*axes, *beside])}" if axes else "there is one case only"
        ends = [path_of(dataset, axis).rsplit(".", 1)[-1] for axis in axes]
        raise StudyError(f"select {said}: {there}{hint(said, [*axes, *beside, *ends])}")
    return found[0]


def place_on(dataset: xarray.Dataset, axis: str, value: Any) -> int:
    """Where on an axis a value stands.

    A number to six digits, of accelerations also as `0.4g`, of angles as `10deg`; a label as written.

    Raises:
        StudyError: it does not.
    """
    values = dataset[axis].values
    if is_numeric(dataset, axis):
        try:
            number = _number(str(value), dataset, axis)
        except ValueError:
            raise StudyError(f"{axis}={value}: expected a number") from None
        found = np.isclose(values, number, rtol=_NEAR, atol=0.0)
    else:
        found = np.array([str(v) == str(value) for v in values])
    if not found.any():
        more, labels = ", ..." if len(values) > _MOST_NAMED else "", choices(dataset, axis, _MOST_NAMED)
        near = "" if is_numeric(dataset, axis) else hint(str(value), [str(v) for v in values])
        raise StudyError(f"{axis}={value}: there are {', '.join(labels)}{more}{near}")
    return int(np.argmax(found))


def choices(dataset: xarray.Dataset, axis: str, most: int) -> list[str]:
    """The first values of an axis as they may be said: accelerations in g, all other numbers in SI units."""
    if not is_numeric(dataset, axis):
        return [str(value) for value in dataset[axis].values[:most].tolist()]
    divisor, unit = shown_unit(dataset, axis)
    in_g = unit == "g"
    values = dataset[axis].values[:most] / (divisor if in_g else 1.0)
    return [f"{value:.9g}{'g' if in_g else ''}" for value in values.tolist()]


def hint(said: str, labels: Sequence[str]) -> str:
    """Which label is meant, for the end of an error: one read alike, that contains what is said, or is spelled so."""
    lowered = {label.lower(): label for label in reversed(labels)}
    word = said[:_LONGEST].lower()
    close = [low for low in reversed(lowered) if as_read(low) == as_read(word)]
    close += [low for low in reversed(lowered) if word in low] or get_close_matches(word, lowered, n=1)
    return f"; did you mean {lowered[close[0]]!r}?" if close else ""


def _number(words: str, dataset: xarray.Dataset, axis: str) -> float:
    divisor, unit = shown_unit(dataset, axis)
    word, factor = ("deg", np.pi / 180.0) if unit == "rad" else (unit, divisor)
    if word in ("deg", "g") and words.strip().endswith(word):
        return float(words.strip().removesuffix(word).rstrip(" *")) * factor
    return float(words)


def _at(dataset: xarray.Dataset, axis: str, places: list[int]) -> xarray.Dataset:
    """Some points of an axis; what is told of the whole axis is told no more."""
    part = dataset.isel({axis: places})
    attrs = dict(dataset.attrs)
    over = json.loads(attrs.get("ensemble", "null")) or {}
    members = np.atleast_1d(over.get("axis", [])).tolist()
    if len(places) < dataset.sizes[axis] and axis in members:
        attrs.pop("ensemble")
        part = part.drop_vars([n for n in over["fields"] if n in part.variables and not {*part[n].dims} & {*members}])
    along = f"boundary_{axis}"
    if along in dataset.variables and "boundary_point" in dataset[along].dims:
        part = part.isel(boundary_point=np.flatnonzero(np.isin(dataset[along].values, part[axis].values)))
    return part.assign_attrs(attrs) if attrs == dataset.attrs else _with(part, attrs)


def _with(dataset: xarray.Dataset, attrs: dict[Any, Any]) -> xarray.Dataset:
    bare = dataset.copy()
    bare.attrs = attrs
    return bare


def overlaid(datasets: Sequence[xarray.Dataset], names: Sequence[str]) -> xarray.Dataset:
    """Several datasets as one with an axis `dataset`, for figures that lay cases over one another or side by side.

    Histories are drawn as lines between their samples, so that those of different times are taken at the times of all
    without changing a line.

    Raises:
        StudyError: their axes differ.
    """
    datasets = _all_of_two_edges(datasets)
    first = datasets[0]
    for other, name in zip(datasets[1:], names[1:], strict=True):
        _check_alike(first, other, name)
    labels = list(names) if len(set(names)) == len(names) else [f"{name} ({i})" for i, name in enumerate(names, 1)]
    axes = axes_of(first)
    wanted = [str(name) for name in first.variables if str(name) not in {*axes, TIME}]
    names_of_all = [name for name in wanted if all(_is_of_cases(each, name, axes) for each in datasets)]
    times = [each[TIME].values for each in datasets if TIME in each.variables]
    time: Array = np.unique(np.concatenate(times)) if times else np.empty(0)
    impacts = max(int(each.sizes.get(IMPACT, 0)) for each in datasets)
    items: dict[str, Any] = {}
    for name in names_of_all:
        dims = tuple(dim for dim in (*axes, TIME, IMPACT) if any(dim in each[name].dims for each in datasets))
        rows = [_values(each, name, dims, time, impacts) for each in datasets]
        if name == MOTION:
            rows = [row + _MANY * _first_alike(datasets, i) for i, row in enumerate(rows)]
        # what the body and the motion are is told once; what became of them for each, as figures look for it
        same = name in first.coords and all(np.array_equal(rows[0], row, equal_nan=True) for row in rows[1:])
        items[name] = (
            (dims, rows[0], first[name].attrs) if same else ((DATASET, *dims), np.stack(rows), first[name].attrs)
        )
    coords: dict[str, Any] = {DATASET: (DATASET, np.array(labels, dtype=object), {"path": DATASET})}
    coords |= {axis: (axis, first[axis].values, first[axis].attrs) for axis in axes}
    coords |= {TIME: (TIME, time)} if len(time) else {}
    coords |= {name: items.pop(name) for name in names_of_all if name in first.coords}
    titles = dict.fromkeys(str(each.attrs.get("title", "")) for each in datasets)
    attrs = {"axes": " ".join([DATASET, *axes]), "title": " / ".join(filter(None, titles))}
    attrs["cases"] = json.dumps(dict(zip(labels, map(resolved_case, datasets), strict=True)))
    attrs["varied"] = json.dumps(sorted({path for each in datasets for path in varied(each)}))
    return first.__class__(items, coords, attrs)


def _all_of_two_edges(datasets: Sequence[xarray.Dataset]) -> list[xarray.Dataset]:
    """The datasets, all with what some have of two edges, and of where FEMA-356 has bodies lift."""
    some = {str(name) for each in datasets for name in each.coords}
    found = []
    for each in datasets:
        own = [name for name in ("R", "alpha", "p", "eta") if name in each.variables]
        known = {f"{name}_{side}": each[name] for name in own for side in ("left", "right")}
        known |= {"pga_uplift": lifts_from(each)} if "alpha" in own else {}
        lacks = {name: value for name, value in known.items() if name in some - set(map(str, each.variables))}
        if "uplift_factor" in some and "uplift_factor" not in each.variables:
            lacks["uplift_factor"] = 1.0  # type: ignore[assignment]
        found.append(each.assign_coords(lacks) if lacks else each)
    return found


def _first_alike(datasets: Sequence[xarray.Dataset], i: int) -> int:
    """The first dataset whose ground moves as that of the i-th."""
    return next(
        j
        for j in range(i + 1)
        if j == i
        or all(
            datasets[j].get(n) is not None and datasets[i][n].equals(datasets[j][n])
            for n in ("a_g", "a_v")
            if n in datasets[i]
        )
    )


def _is_of_cases(dataset: xarray.Dataset, name: str, axes: tuple[str, ...]) -> bool:
    """Whether a dataset has a variable of that name that is of numbers, of the cases or their histories."""
    if name not in dataset.variables:
        return False
    item = dataset[name]
    return item.dtype.kind in "fiu" and {str(dim) for dim in item.dims} <= {*axes, TIME, IMPACT}


def _values(dataset: xarray.Dataset, name: str, dims: tuple[str, ...], time: Array, impacts: int) -> Array:
    """The values of a dataset over dimensions, some of which are of others: histories at the times of all.

    Impacts are as many as in the dataset that has most.
    """
    own = tuple(dim for dim in dims if dim in dataset[name].dims)
    values = np.asarray(dataset[name].transpose(*own).values)
    if TIME in own:
        when = dataset[TIME].values
        values = np.apply_along_axis(lambda y: np.interp(time, when, y, right=np.nan), own.index(TIME), values)
    elif IMPACT in own:
        missing = [(0, impacts - n if dim == IMPACT else 0) for dim, n in zip(own, values.shape, strict=True)]
        values = np.pad(values.astype(float), missing, constant_values=np.nan)
    for at, dim in enumerate(dims):
        if dim not in own:
            values = np.repeat(np.expand_dims(values, at), int(dataset.sizes[dim]), axis=at)
    return values


def _check_alike(first: xarray.Dataset, other: xarray.Dataset, name: str) -> None:
    axes = axes_of(first)
    if axes_of(other) != axes:
        one, two = (", ".join(found) or "none" for found in (axes, axes_of(other)))
        raise StudyError(f"{name}: its axes ({two}) are not those of the first ({one}); draw it by itself")
    for axis in axes:
        a, b = first[axis].values, other[axis].values
        same = len(a) == len(b) and (np.allclose(a, b, rtol=1e-9) if is_numeric(first, axis) else (a == b).all())
        if not same:
            mend = f"--select {axis}=VALUE leaves those of both"
            raise StudyError(f"{name}: its values of {axis} are not those of the first; {mend}")
