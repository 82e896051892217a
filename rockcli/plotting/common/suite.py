"""What a dataset says of its ensemble, and the panels its figures have."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common.cases import Array, Shown, axes_of, is_numeric, pick, selection_note
from rockcli.plotting.common.labels import axis_symbol
from rockcli.plotting.common.style import MOST_PANELS

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class Suite:
    """Axis of the ensemble, and of the intensity (None: there is none); `told_against`: what fragility is over."""

    axis: str
    along: str | None
    told_against: str


def suite_of(dataset: xarray.Dataset) -> Suite | None:
    """The ensemble of a dataset; None if the study asks for none."""
    about = json.loads(dataset.attrs.get("ensemble", "null"))
    if about is None:
        return None
    axis = about["axis"] if isinstance(about["axis"], str) else _BETWEEN.join(about["axis"])
    return Suite(axis, about["along"], about.get("told_against") or about["along"] or "")


def suite_axes(dataset: xarray.Dataset) -> tuple[str, ...]:
    """Names of the axes of the members and of the intensity; () if the study asks for no statistics."""
    about = json.loads(dataset.attrs.get("ensemble", "null")) or {"axis": [], "along": None}
    members = [about["axis"]] if isinstance(about["axis"], str) else about["axis"]
    return tuple(filter(None, (*members, about["along"])))


NAMED = ("record", "sample")
"""Axes whose points have a word of their own."""

_BEYOND = 1e300
"""More than any intensity."""

_BETWEEN = "-"
"""Between the names of axes that are laid end to end: no name of an axis has it."""


def end_to_end(dataset: xarray.Dataset) -> xarray.Dataset:
    """The dataset with the axes of its ensemble as one, where there are several."""
    about = json.loads(dataset.attrs.get("ensemble", "null"))
    if about is None or isinstance(about["axis"], str):
        return dataset
    name = _BETWEEN.join(about["axis"])
    size = {axis: int(dataset.sizes[axis]) for axis in about["axis"]}
    axes = [axis for axis in axes_of(dataset) if axis not in size]
    at = axes_of(dataset).index(about["axis"][0])
    row = dataset.drop_vars(about["axis"]).stack({name: about["axis"]}, create_index=False)
    words = " x ".join(_members(axis, n) for axis, n in size.items())
    attrs = {"axes": " ".join([*axes[:at], name, *axes[at:]]), "ensemble": json.dumps(about | {"axis": name})}
    return row.assign_attrs(attrs | {"members": words})


def without_intensity(dataset: xarray.Dataset) -> str:
    """Why there is nothing to draw along an intensity; "" if there is."""
    suite = suite_of(dataset)
    if suite is None:
        return "the study takes no statistics over an axis (over: record)"
    if suite.along is None:
        return "no amplitude of the motion is varied (vary: motion.record.pga, ...; or over: {axis, along})"
    return ""


def panels(
    dataset: xarray.Dataset,
    suite: Suite,
    *,
    along: bool = False,
    most: int = MOST_PANELS,
    least: tuple[xarray.DataArray, str] | None = None,
    what: str = "panels",
) -> tuple[list[Shown], str]:
    """Points of the axes left by the ensemble and the intensity, and what says which they are.

    `along`: of the intensity too.  Of more than `most` those where `least` is least, with the words for them; without
    it, of bodies with names the ones that overturn most easily; with the other points of the innermost axis where
    there is room.  The words, which call them `what`, are "" where all are shown.
    """
    others = tuple(axis for axis in axes_of(dataset) if axis != suite.axis and (along or axis != suite.along))
    chosen, order = "", None
    if least is not None:
        measure, chosen = least
        order = measure.transpose(*others).values.ravel()
    elif not along and (order := _ease(dataset, suite, others)) is not None:
        chosen = "those that overturn most easily"
    shown, total = pick(dataset, most, others, order)
    note = selection_note(len(shown), total, what)
    if order is not None and len(shown) < total:
        sizes = [int(dataset.sizes[axis]) for axis in others]
        at = [np.ravel_multi_index([case.place[axis] for axis in others], sizes) for case in shown]
        if order[at].max() > np.delete(order, at).min():  # whole rows of the innermost axis were taken
            chosen += " and their alternatives"
    return shown, f"{note}, {chosen}" if note and chosen else note


def _ease(dataset: xarray.Dataset, suite: Suite, others: tuple[str, ...]) -> Array | None:
    """Medians of overturning of all bodies, flat: 0 of one that always does, inf of one that never does.

    Of one without a curve that is the lowest intensity at which half of the members overturn, or more than all medians
    where that is not known.  None where bodies are numbers on axes, which evenly spread ones show, or have no curve.
    """
    if "fragility_median" not in dataset or all(is_numeric(dataset, axis) for axis in others):
        return None
    medians, status = (
        dataset[f"fragility_{name}"].isel(limit_state=-1).transpose(*others) for name in ("median", "status")
    )
    flags = str(status.attrs["flag_meanings"]).split()
    always, never = (status.values == flags.index(flag) for flag in ("all_exceed", "none_exceeds"))
    half: Array = np.full(medians.shape, _BEYOND)
    if suite.along is not None and suite.told_against == suite.along:
        levels = dataset[suite.along].where(dataset["p_overturned"] >= 0.5, _BEYOND)
        half = levels.min(suite.along).transpose(*others).values
    known = np.where(np.isfinite(medians.values), medians.values, half)
    ease = np.where(always, 0.0, np.where(never, np.inf, known)).ravel()
    return ease if (ease < _BEYOND).any() else None


def medians_beyond(dataset: xarray.Dataset) -> xarray.DataArray:
    """Whether the median of each curve lies beyond the intensities of the suite, so that it is extrapolated."""
    median = dataset["fragility_median"]
    if "fragility_lowest" not in dataset.variables:  # as of earlier versions
        return median > np.inf
    return (median < dataset["fragility_lowest"]) | (median > dataset["fragility_highest"])


def left_out_words(dataset: xarray.Dataset, suite: Suite, shown: list[Shown]) -> str:
    """How many cases of those shown have no answer, and so no part in shares and curves; "" where all have one."""
    if "n_answered" not in dataset.variables or "outcome" not in dataset.variables:  # a search counts them as brackets
        return ""
    answered = dataset["n_answered"]
    parts = [answered.isel({a: i for a, i in case.place.items() if a in answered.dims}) for case in shown]
    every = int(dataset.sizes[suite.axis]) * sum(part.size for part in parts)
    missing = every - sum(int(part.sum()) for part in parts)
    return f"{missing} of {every} cases without an answer left out" if missing else ""


def members_word(dataset: xarray.Dataset, suite: Suite) -> str:
    """`42 records`."""
    n = int(dataset.sizes[suite.axis])
    if dataset.attrs.get("members"):
        return str(dataset.attrs["members"])
    return _members(suite.axis, n) if suite.axis in NAMED else f"{n} {_values(n)} of {axis_symbol(dataset, suite.axis)}"


def _members(axis: str, n: int) -> str:
    if axis in NAMED:
        return f"{n} {axis}" if n == 1 else f"{n} {axis}s"
    return f"{n} {_values(n)} of {axis.replace('_', ' ')}"


def _values(n: int) -> str:
    return "value" if n == 1 else "values"
