"""Fragility of every body of a suite, as variables of its dataset."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.curves import (
    STATUS,
    Curves,
    Scatter,
    Seen,
    curve_of_capacities,
    curves,
    too_weak,
)
from rockcli.analysis.places import json_point, json_value
from rockcli.analysis.suites.intensity import moves_at, unit_of, values_of
from rockcli.analysis.suites.members import Members
from rockcli.analysis.suites.uncertainty import Together, members_together
from rockcli.analysis.threshold_fields import found_by
from rockcli.scene.axis_path import axis_path
from rockcli.scene.ground.amplitudes import AMPLITUDES
from rockcli.scene.variables import LIMIT, PEAK, PERCENTILE, PERCENTILES, VARIABLES
from rockcli.storage.contents import Contents, Field, text, variable_field
from rockcli.study.intensity import bare, period_of
from rockcli.study.study import Limit, Over, Study

log = logging.getLogger(__name__)

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Scatters = dict[tuple[int, ...], Scatter]
"""Of the curves of which it is known, by the place of body and limit state."""

FITTED: tuple[str, ...] = (
    "fragility_median", "fragility_median_ci_low", "fragility_median_ci_high", "fragility_beta",
    "fragility_beta_ci_low", "fragility_beta_ci_high", "fragility_beta_total", "fragility_se_ln_median",
    "fragility_se_beta", "fragility_correlation", "fragility_median_low", "fragility_median_high",
    "fragility_misfit_p", "fragility_misfit_at",
)  # fmt: skip
"""Variables of a curve, one number each."""

_TAILS: tuple[str, ...] = ("fragility_percentile", "fragility_percentile_ci_low", "fragility_percentile_ci_high")

OF_BODY: tuple[str, ...] = (
    "fragility_begins_at", "fragility_begins_at_last", "fragility_lowest", "fragility_highest",
)  # fmt: skip
"""What is the same of all limit states: where members begin to move, and the range of their intensities."""

OTHERS = ("fragility_intensity", *OF_BODY, "fragility_status", *_TAILS, PERCENTILE)

OF_SECOND: tuple[str, ...] = ("fragility_exponent", "fragility_exponent_ci_low", "fragility_exponent_ci_high")
"""What a second intensity adds to a curve."""

_IN_UNITS = ("fragility_median", "fragility_percentile", "fragility_misfit_at")


@dataclass(frozen=True, eq=False)
class _Fitted:
    """What the curves of all bodies come to, over (*bodies, limit states).

    Attributes:
        numbers: by name, one of each curve.
        tails: by name, with the percentiles as last axis.
        status: keys of `STATUS`.
        scatter: of the curves of which it is known.
    """

    numbers: dict[str, Array]
    tails: dict[str, Array]
    status: NDArray[np.int8]
    scatter: Scatters

    @classmethod
    def empty(cls, shape: tuple[int, ...], names: Iterable[str] = FITTED) -> _Fitted:
        """Of no curve yet; `shape` of (*bodies, limit states)."""
        return cls(
            {name: np.full(shape, np.nan) for name in names},
            {name: np.full((*shape, len(PERCENTILES)), np.nan) for name in _TAILS},
            np.zeros(shape, dtype=np.int8),
            {},
        )

    def put(self, at: tuple[int, ...], states: Index, made: Curves, beta_added: float) -> None:
        """Take the curves of a body, the first of `made` as those of its limit states `states`."""
        n = len(states)
        for name, values in _numbers(made, beta_added).items():
            if name in self.numbers:
                self.numbers[name][at][states] = values[:n]
        for name, values in zip(_TAILS, _tails(made, beta_added), strict=True):
            self.tails[name][at][states] = values[:n]
        self.status[at][states] = made.status[:n]
        for state, scatter in zip(states, made.scatter(), strict=False):
            if scatter is not None:
                self.scatter[(*at, int(state))] = scatter


def fragility(contents: Contents, became: Members, study: Study, over: Over) -> tuple[dict[str, Field], Scatters]:
    """Shares that exceed each limit state at every intensity, and the curves through them, with their scatter."""
    axes = contents.axes
    bodies = tuple(axis for axis in axes if axis not in (over.axis, over.along))
    order = [axes.index(axis) for axis in bodies] + [axes.index(over.axis)]
    order += [axes.index(over.along)] if over.along is not None else []

    def of_bodies(values: NDArray[Any]) -> NDArray[Any]:
        """(..., n, k) with the members and the intensities last; of a cloud k = 1."""
        moved = values.transpose(order)
        return moved if over.along is not None else moved[..., None]

    x = values_of(over.told_against, contents, study)
    y = values_of(over.second, contents, study) if over.second else None
    if x is None or (over.second and y is None):
        return {}, {}
    parts = {
        "x": of_bodies(x),
        "stands": of_bodies(np.where(became.divided, 1.0 - np.nan_to_num(became.share), became.answered.astype(float))),
        "falls": of_bodies(np.where(became.divided, became.share, 0.0)),
    }
    if y is not None:
        parts["second"] = of_bodies(np.broadcast_to(y, contents.shape))
    begins, last = _begins(contents, study, over, x, of_bodies)
    limits = [limit for limit in over.limits if limit.quantity in contents.fields]
    labels = [*(limit.label for limit in limits), over.limit_states[-1]]
    shape = parts["x"].shape[:-2]
    fitted = _Fitted.empty((*shape, len(labels)), (*FITTED, *(OF_SECOND if over.second else ())))
    second_at = np.full(shape, np.nan)
    exceeded = []
    together = members_together(study, over)
    for states, of_family in _families(limits):
        top = len(of_family) + 1
        low, high = _categories(contents, became, of_family)
        parts |= {"low": of_bodies(low), "high": of_bodies(high)}
        for at in _told(shape):
            one = {name: values[at] for name, values in parts.items()}
            second_at[at] = _fit_body(fitted, at, states, one, top, together, float(begins[at]), over)
        exceeded.append((states, _shares(parts, top)[: len(states)]))
    unit = unit_of(over.told_against, contents)
    fields = {LIMIT: Field((LIMIT,), text(labels), {"long_name": VARIABLES[LIMIT].sentence}, coordinate=True)}
    if over.told_against not in axes:
        row = variable_field("fragility_intensity", axes, x, units=unit, long_name=over.told_against)
        fields["fragility_intensity"] = row
    if y is not None:
        fields |= _second_fields(contents, over, y, bodies, second_at)
    if over.along is not None:
        shares = np.concatenate([share for _, share in exceeded])
        order_of_states = np.argsort(np.concatenate([states for states, _ in exceeded]))
        fields["p_exceeded"] = _exceeded(contents, shares[order_of_states], bodies, over)
    of_body = dict(zip(OF_BODY, (begins, last, *_range(parts["x"])), strict=True))
    return fields | _fields(bodies, unit, fitted, of_body), fitted.scatter


def _told(shape: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """The places of all bodies, of each of which it is logged when its curves begin: some ten milliseconds."""
    for done, at in enumerate(np.ndindex(*shape)):
        log.info("fragility of body %d of %d", done + 1, int(np.prod(shape)))
        yield at


def _categories(contents: Contents, became: Members, limits: list[Limit]) -> tuple[Index, Index]:
    """The category of every case, at least and at most: the nested limits it exceeds, one more overturned."""
    top = len(limits) + 1
    below = np.zeros(contents.shape, dtype=np.int64)
    for limit in limits:
        below += np.abs(contents.values(limit.quantity)) > limit.value
    low = np.where(became.share == 1.0, top, np.where(became.divided, 0, np.minimum(below, top - 1)))
    return low, np.where(became.divided, top - 1, low)


def _fit_body(
    fitted: _Fitted,
    at: tuple[int, ...],
    states: Index,
    one: dict[str, Array],
    top: int,
    together: Together,
    begins: float,
    over: Over,
) -> float:
    """Fit the curves of the body at `at` into `fitted`; the second intensity that they are told at, NaN without one.

    Args:
        states: its limit states, places among those of the suite.
        one: parts of the body, (n, k) each.
        top: the category of what overturns.
        together: which members belong together.
        begins: where its curves begin.
    """
    made = curves(_seen(one, top, together), top, fit=over.fit, begins_at=begins)
    fitted.put(at, states, made, over.beta_added)
    missing = (one["stands"] == 0.0) & (one["falls"] == 0.0)
    missing &= ~too_weak(one["x"], begins)  # without an answer, but nothing moves there
    for end, category in (("low", top), ("high", 0)):
        median = made.median
        if missing.any():
            counted = _seen(one, top, together, missing, category)
            median = curves(counted, top, fit=over.fit, begins_at=begins).median
        fitted.numbers[f"fragility_median_{end}"][at][states] = median[: len(states)]
    return made.second_at


def _second_fields(
    contents: Contents, over: Over, y: Array, bodies: tuple[str, ...], second_at: Array
) -> dict[str, Field]:
    """The second intensity of the cases, and the one that the curves of every body are told at."""
    unit, name = unit_of(over.second, contents), "fragility_intensity_second"
    cases = np.broadcast_to(y, contents.shape)
    return {
        name: variable_field(name, contents.axes, cases, units=unit, long_name=over.second),
        "fragility_second": variable_field("fragility_second", bodies, second_at, units=unit),
    }


def fragility_of_thresholds(contents: Contents, study: Study, over: Over) -> tuple[dict[str, Field], Scatters]:
    """The curve of overturning through the lowest overturning values that a search found, one of every member.

    What lies outside the range, or in a bracket, enters as the interval that it lies in.
    """
    search = study.search
    if search is None or not over.told_against:
        return {}, {}
    bodies = tuple(axis for axis in contents.axes if axis != over.axis)
    order = [contents.axes.index(axis) for axis in (*bodies, over.axis)]
    found = found_by(contents, search.name)
    per_point = _per_point(contents, study, over)
    if per_point is None:
        return {}, {}
    low, high = (end * per_point for end in found.bounds())
    low = np.where(low > 0.0, low, 0.0)
    begins, last = _begins_of_search(contents, study, over, per_point, order)
    low, high = low.transpose(order), high.transpose(order)
    together, first = members_together(study, over), np.zeros(1, dtype=np.int64)
    fitted = _Fitted.empty((*begins.shape, 1))
    for at in _told(begins.shape):
        made = curve_of_capacities(low[at], high[at], together.rows, float(begins[at]), together.shared)
        fitted.put(at, first, made, over.beta_added)
        for end in ("low", "high"):  # no member is left out
            fitted.numbers[f"fragility_median_{end}"][at] = made.median
    unit = search.axis.unit if over.told_against == search.axis.name else unit_of(over.told_against, contents)
    known = np.where(np.isfinite(found.value), found.value * per_point, np.nan)
    ends = np.multiply.outer(per_point, np.array([search.first, search.axis.values[-1]]))
    of_body = dict(zip(OF_BODY, (begins, last, *_range(ends.transpose([*order, ends.ndim - 1]))), strict=True))
    capacity = {"units": unit, "long_name": f"{over.told_against} from which a member overturns"}
    labels = text([over.limit_states[-1]])
    fields = {
        LIMIT: Field((LIMIT,), labels, {"long_name": VARIABLES[LIMIT].sentence}, coordinate=True),
        "fragility_intensity": variable_field("fragility_intensity", contents.axes, known, **capacity),
    }
    return fields | _fields(bodies, unit, fitted, of_body), fitted.scatter


def _per_point(contents: Contents, study: Study, over: Over) -> Array | None:
    """What the intensity is for one unit of the searched amplitude, over the axes; None where it is not known."""
    assert study.search is not None
    if over.told_against == study.search.axis.name:
        return np.ones(contents.shape)
    first = values_of(over.told_against, contents, study)  # of the cases at the first point
    return None if first is None else np.broadcast_to(first / study.search.first, contents.shape)


def _begins_of_search(
    contents: Contents, study: Study, over: Over, per_point: Array, order: list[int]
) -> tuple[Array, Array]:
    """As `_begins`, of members whose amplitude is searched."""
    assert study.search is not None
    pga = values_of("pga", contents, study)
    if over.begins_at != "uplift" or pga is None:
        none = np.zeros([contents.shape[i] for i in order[:-1]])
        return none, none
    amplitude = study.search.first * moves_at(study, slides=False).reshape(contents.shape) / pga
    needs = (amplitude * per_point).transpose(order)
    lowest, highest = needs.min(axis=-1), needs.max(axis=-1)
    known = np.isfinite(lowest)
    return np.where(known, lowest, 0.0), np.where(known, highest, 0.0)


def _fields(bodies: tuple[str, ...], unit: str, fitted: _Fitted, of_body: dict[str, Array]) -> dict[str, Field]:
    """Curves as variables."""
    fields, dims = {}, (*bodies, LIMIT)
    for name, values in (fitted.numbers | fitted.tails).items():
        attrs: dict[str, Any] = {"units": unit} if name.startswith(_IN_UNITS) else {}
        fields[name] = variable_field(name, (*dims, PERCENTILE) if name in _TAILS else dims, values, **attrs)
    for name, values in of_body.items():
        fields[name] = variable_field(name, bodies, values, units=unit)
    coordinate = {"long_name": VARIABLES[PERCENTILE].sentence, "units": "%"}
    fields[PERCENTILE] = Field((PERCENTILE,), np.array(PERCENTILES), coordinate, coordinate=True)
    flags = {"flag_values": np.array(list(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS.values())}
    fields["fragility_status"] = variable_field("fragility_status", dims, fitted.status, **flags)
    return fields


def _families(limits: list[Limit]) -> Iterator[tuple[Index, list[Limit]]]:
    """Limits of one quantity, which are nested, with their places among the limit states.

    Overturning is the last state of every family and told with the first: that of the rotation, where there is one.
    """
    named = list(dict.fromkeys(limit.quantity for limit in limits)) or [PEAK]
    for quantity in named:
        states = [i for i, limit in enumerate(limits) if limit.quantity == quantity]
        last = [len(limits)] if quantity == named[0] else []
        yield np.array([*states, *last], dtype=np.int64), [limits[i] for i in states]


def _seen(
    one: dict[str, Array],
    top: int,
    together: Together,
    missing: NDArray[np.bool_] | None = None,
    category: int = 0,
) -> Seen:
    """Rows of one body: a member whose runs part is two, the part that overturns and the part that stands.

    `missing` members are put into a `category`; `together`: which members belong together.
    """
    low, high, weight = one["low"].astype(np.int64), one["high"].astype(np.int64), one["stands"]
    if missing is not None:
        low, high = (np.where(missing, category, of) for of in (low, high))
        weight = np.where(missing, 1.0, weight)
    over = np.full(low.shape, top, dtype=np.int64)
    # side by side along the intensities, so that both parts are of the same member
    return Seen(
        np.concatenate([one["x"], one["x"]], axis=1),
        np.concatenate([low, over], axis=1),
        np.concatenate([high, over], axis=1),
        np.concatenate([weight, one["falls"]], axis=1),
        together.rows,
        np.concatenate([one["second"], one["second"]], axis=1) if "second" in one else None,
        together.shared,
    )


def _numbers(made: Curves, beta_added: float) -> dict[str, Array]:
    low, high = made.median_limits()
    beta_low, beta_high = made.beta_limits()
    return {
        "fragility_median": made.median,
        "fragility_median_ci_low": low,
        "fragility_median_ci_high": high,
        "fragility_beta": made.beta,
        "fragility_beta_ci_low": beta_low,
        "fragility_beta_ci_high": beta_high,
        "fragility_beta_total": np.hypot(made.beta, beta_added),
        "fragility_se_ln_median": made.se_ln_median,
        "fragility_se_beta": made.se_beta,
        "fragility_correlation": made.correlation,
        "fragility_misfit_p": made.misfit_p,
        "fragility_misfit_at": made.misfit_at,
        **dict(zip(OF_SECOND, (made.exponent, *made.exponent_limits()), strict=True)),
    }


def _tails(made: Curves, beta_added: float) -> tuple[Array, Array, Array]:
    return made.percentiles(beta_added), *made.percentile_limits(beta_added)


def _range(x: Array) -> tuple[Array, Array]:
    """Lowest and highest intensity of every body, (..., n, k) -> (...); NaN without one."""
    known = x > 0.0
    low, high = np.where(known, x, np.inf).min(axis=(-2, -1)), np.where(known, x, -np.inf).max(axis=(-2, -1))
    return np.where(np.isfinite(low), low, np.nan), np.where(np.isfinite(high), high, np.nan)


def _begins(contents: Contents, study: Study, over: Over, x: Array, of_bodies: Any) -> tuple[Array, Array]:
    """Intensity at which the curves of every body begin, and from which every member can move it.

    The first is the lowest at which a member can lift it, with limits of its slide: can lift it or let it slip; 0 where
    that is not known or not asked for.
    """
    shape = of_bodies(x).shape[:-2]
    name = over.told_against
    grows = bare(name) in ("pga", "pgv", "arias", "cav") or period_of(name) is not None
    if name == over.along:
        grows = axis_path(contents.fields[name].attrs, name).rsplit(".", 1)[-1] in AMPLITUDES
    pga = values_of("pga", contents, study)
    if over.begins_at != "uplift" or not grows or pga is None:  # what grows with the amplitude is known at uplift
        return np.zeros(shape), np.zeros(shape)
    slides = any(limit.quantity != PEAK for limit in over.limits)
    scale = moves_at(study, slides=slides).reshape(contents.shape) / pga
    at_uplift = of_bodies(x * (scale**2 if name == "arias" else scale))
    known = (of_bodies(x) > 0.0) & (of_bodies(pga) > 0.0)  # motions turned round are other ones
    unknown = (np.isnan(at_uplift) & known).any(axis=(-2, -1))
    lowest = np.where(known, at_uplift, np.inf).min(axis=(-2, -1))
    highest = np.where(known, at_uplift, -np.inf).max(axis=(-2, -1))
    unknown = unknown | ~np.isfinite(lowest)
    return np.where(unknown, 0.0, lowest), np.where(unknown, 0.0, highest)


def _shares(parts: dict[str, Array], top: int) -> Array:
    """The share of the members with an answer that exceeds each limit state, (top, ..., k)."""
    stands, falls = parts["stands"], parts["falls"]
    shares = []
    for state in range(1, top + 1):
        exceeds = stands * (parts["low"] >= state) + falls
        known = stands * ((parts["low"] >= state) | (parts["high"] < state)) + falls
        shares.append(exceeds.sum(axis=-2) / known.sum(axis=-2))
    return np.stack(shares)


def _exceeded(contents: Contents, shares: Array, bodies: tuple[str, ...], over: Over) -> Field:
    """The shares (states, bodies, k) over the axes of the dataset."""
    rest = tuple(axis for axis in contents.axes if axis != over.axis)
    here = (*bodies, str(over.along))
    values = shares.transpose([*(1 + here.index(axis) for axis in rest), 0])
    return variable_field("p_exceeded", (*rest, LIMIT), values)


def fragility_rows(contents: Contents) -> Iterator[dict[str, Any]]:
    """The curves of a dataset as plain values, one row per body and limit state; None for what is no number."""
    if "fragility_status" not in contents.fields:
        return
    dims = contents.fields["fragility_status"].dims
    status = contents.values("fragility_status")
    of_body = [name for name in (*OF_BODY, "fragility_second") if name in contents.fields]
    of_curve = [name for name in (*FITTED, *OF_SECOND) if name in contents.fields]
    for at in np.ndindex(*status.shape):
        row = json_point(contents, dims, at)
        row |= {name: json_value(contents.values(name)[at[:-1]]) for name in of_body}
        row |= {name: json_value(contents.values(name)[at]) for name in of_curve}
        for name in (tail for tail in _TAILS if tail in contents.fields):
            for percent, value in zip(PERCENTILES, contents.values(name)[at], strict=True):
                row[f"{name}_{percent:g}"] = json_value(value)
        yield row | {"fragility_status": STATUS[int(status[at])]}
