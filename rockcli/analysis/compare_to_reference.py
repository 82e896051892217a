"""Errors of every point of a study against its reference point (`compare_to`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.response import FAILED, UNRESOLVED
from rockcli.storage.contents import DIM_TIME, Contents, variable_field
from rockcli.study.study import Study

Array = NDArray[np.float64]

NEEDED_BY: dict[str, str] = {
    "error_theta_peak_over_alpha": "theta_peak_over_alpha",
    "error_history": "theta",
    "same_outcome": "outcome",
}
"""Error -> the variable without which there is none."""

ERRORS: tuple[str, ...] = tuple(NEEDED_BY)


def with_comparison(contents: Contents, study: Study) -> Contents:
    """Add the errors against the points at `compare_to` ({axis: coordinate value}), or take them away without one.

    An axis not named is matched.  A difference of two overturned cases is NaN: neither has a peak.
    Errors whose variables were not saved are absent.
    """
    reference = study.compare_to
    fields = {name: item for name, item in contents.fields.items() if name not in ERRORS}
    plain = Contents(contents.axes, fields, contents.attrs)
    if reference is None:
        return plain
    peak, outcome = "theta_peak_over_alpha", "outcome"
    axes = contents.axes
    if peak in fields:
        with np.errstate(invalid="ignore"):
            difference = fields[peak].values - at_reference(plain, peak, reference)
        fields["error_theta_peak_over_alpha"] = variable_field("error_theta_peak_over_alpha", axes, difference)
    if "theta" in fields and "alpha" in fields:
        fields["error_history"] = variable_field("error_history", axes, _history_error(plain, reference))
    if outcome in fields:
        flags = fields[outcome].values
        decided = ~np.isin(flags, (FAILED, UNRESOLVED))
        same = ((flags == at_reference(plain, outcome, reference)) & decided).astype(np.int8)
        fields["same_outcome"] = variable_field("same_outcome", axes, same)
    return Contents(axes, fields, contents.attrs)


def at_reference(contents: Contents, name: str, reference: dict[str, Any]) -> NDArray[Any]:
    """A variable at the reference, with axes of length 1 where it is fixed, to broadcast against the whole."""
    return _at(contents, contents.values(name), reference)


def _at(contents: Contents, values: NDArray[Any], reference: dict[str, Any]) -> NDArray[Any]:
    for number, axis in enumerate(contents.axes):
        if axis in reference:
            position = locate(contents, axis, reference[axis])
            values = np.take(values, [position], axis=number)
    return values


def locate(contents: Contents, axis: str, value: Any) -> int:
    """Position of a coordinate value on an axis: floats to 1e-9 relative, else equal; KeyError if it is not there."""
    coordinate = contents.values(axis)
    if coordinate.dtype.kind == "f":
        near = np.flatnonzero(np.isclose(coordinate, float(value), rtol=1e-9, atol=0.0))
    else:
        near = np.flatnonzero(coordinate == str(value))
    if not len(near):
        raise KeyError(f"{value!r} is not on the axis {axis!r}")
    return int(near[0])


def _history_error(contents: Contents, reference: dict[str, Any]) -> Array:
    """sup |theta - theta_ref|/alpha on the output times before either overturns and that both have; NaN if none."""
    theta = contents.values("theta")
    time = contents.values(DIM_TIME)
    gap = np.abs(theta - at_reference(contents, "theta", reference))
    until = _overturning(contents)
    both = np.fmin(until, _at(contents, until, reference))
    gap = np.where(time >= both[..., None], np.nan, gap)  # a NaN limit compares false: nothing is cut
    sup = np.fmax.reduce(gap, axis=-1, initial=np.nan)
    return np.asarray(sup / contents.over_axes("alpha"))


def _overturning(contents: Contents) -> Array:
    """Time from which a case only overturns, over the axes; NaN for one that does not.

    Without `t_overturn`, the first output time after the last within alpha of a history that ends outside.
    """
    if "t_overturn" in contents.fields:
        return contents.values("t_overturn")
    theta, time = np.abs(contents.values("theta")), contents.values(DIM_TIME)
    inside = theta <= contents.over_axes("alpha")[..., None]
    steps = np.arange(len(time))
    last_inside = np.where(inside, steps, -1).max(axis=-1, initial=-1)
    last = np.where(np.isnan(theta), -1, steps).max(axis=-1, initial=-1)
    return np.asarray(np.where(last > last_inside, time[np.minimum(last_inside + 1, len(time) - 1)], np.nan))
