"""Ensemble statistics (`over`): what a suite does at every point of the other axes.

Members count by the share of their runs that overturn (`overturn_share`); overturned ones count as infinite.  Those
without an answer are left out and counted, with the statistics if all of them overturned or all remained stable.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility import STATUS, Fit, fit
from rockcli.analysis.intensity_correlation import correlations, with_measures
from rockcli.analysis.places import units_of
from rockcli.analysis.suite_words import sentences, warnings
from rockcli.analysis.threshold_fields import found_by, threshold_fields
from rockcli.scene.response import UNRESOLVED, overturned
from rockcli.scene.statistics import fractile
from rockcli.scene.thresholds import BRACKETED
from rockcli.scene.units import SI
from rockcli.scene.variables import LIMIT, PEAK, VARIABLES
from rockcli.storage.contents import Contents, Field, text, variable_field
from rockcli.study.study import Over, Study

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

ATTRIBUTE = "ensemble"
"""Root attribute, JSON: axis, along, limits, the fields that belong to it, its sentences (`says` in SI units, `shown`
with accelerations in g) and its warnings."""

SCALARS: tuple[str, ...] = (PEAK, "theta_dot_peak", "u_top_peak")
"""Scalars whose fractiles are taken."""

_FRACTILES: dict[str, float] = {"p16": 0.16, "p50": 0.5, "p84": 0.84}

_WORDS = {"p16": "16th percentile", "p50": "median", "p84": "84th percentile", "mean": "mean"}


@dataclass(frozen=True, eq=False)
class Members:
    """What became of every case, over the axes.

    Attributes:
        share: of its runs that overturn, 0 or 1 where that is certain, NaN without an answer.
    """

    share: Array

    @property
    def answered(self) -> Mask:
        """Whether there is an answer."""
        return ~np.isnan(self.share)

    @property
    def divided(self) -> Mask:
        """Whether some runs overturn and some do not."""
        return (self.share > 0.0) & (self.share < 1.0)

    def values(self, scalar: Array) -> Array:
        """A scalar of the members, inf where at least half of the runs overturn, NaN where it is not known."""
        return np.where(self.share >= 0.5, np.inf, np.where(self.answered & ~self.divided, scalar, np.nan))


def _fell(became: Members, at: int) -> Array:
    return np.asarray(np.nansum(became.share, axis=at))


def _answered(became: Members, at: int) -> Array:
    return np.asarray(became.answered.sum(axis=at))


STATISTICS: dict[str, Callable[[Members, int], Array]] = {
    "n_answered": _answered,
    "p_overturned": lambda became, at: _fell(became, at) / _answered(became, at),
    "p_overturned_low": lambda became, at: _fell(became, at) / became.share.shape[at],
    "p_overturned_high": lambda became, at: (
        (_fell(became, at) + became.share.shape[at] - _answered(became, at)) / became.share.shape[at]
    ),
}
"""What is told of what became of the members, at every point of the other axes: `of(members, axis of the members)`."""


def with_ensembles(contents: Contents, study: Study) -> Contents:
    """Add the statistics a study asks for, or take away those it does not ask for.

    Statistics have the axes but that of `over`; a fragility curve takes the axis of the intensity too, and has
    `limit_state` instead.
    """
    before = json.loads(contents.attrs.get(ATTRIBUTE, "{}"))
    fields = {name: item for name, item in contents.fields.items() if name not in before.get("fields", ())}
    said = [s for s in json.loads(contents.attrs.get("warnings", "[]")) if s not in before.get("warnings", ())]
    attrs = {name: value for name, value in contents.attrs.items() if name != ATTRIBUTE}
    plain = Contents(contents.axes, fields, attrs | {"warnings": _json(said)})
    if study.over is None:
        return plain
    with np.errstate(all="ignore"):
        added = _thresholds(plain, study, study.over) if study.search else _statistics(plain, study, study.over)
    whole = replace(plain, fields=fields | added)
    more = [s for s in warnings(whole, study) if s not in said]
    about = {
        "axis": study.over.axis,
        "along": study.over.along,
        "limits": list(study.over.limits),
        "fields": list(added),
        "says": sentences(whole, study, SI),
        "shown": sentences(whole, study, units_of(whole)),
        "warnings": more,
    }
    return replace(whole, attrs=attrs | {"warnings": _json([*said, *more]), ATTRIBUTE: _json(about)})


def variables(study: Study) -> set[str]:
    """Names of the statistics a study's dataset will have (of a search, see `Searched.results`)."""
    over = study.over
    if over is None:
        return set()
    found = {"n_answered"}
    if study.search is not None:
        return found | set(study.search.results(over))
    found |= {*STATISTICS, *(f"{name}_{end}" for name in SCALARS if name in study.scalars for end in over.ends)}
    if PEAK in study.scalars:
        found |= {"demand_spearman", "demand_pearson", "n_moving"}
    if over.along is not None:
        found |= {"safe_island", "n_safe_islands", "p_exceeded", "fragility_status", *_FITTED}
    return found | set(VARIABLES).intersection(("p_pgv_over_g_tan_alpha", "arias", "cav", "t_mean", "d5_95"))


def members(contents: Contents) -> Members:
    """What became of every case, by its share, its outcome, or its peak, whichever is saved."""
    if "outcome" in contents.fields:
        flags = contents.values("outcome")
        share = np.where(flags > UNRESOLVED, overturned(flags).astype(float), np.nan)
    elif "overturn_share" in contents.fields:
        share = np.full(contents.shape, np.nan)
    else:
        peak = contents.values(PEAK)
        share = np.where(np.isnan(peak), np.nan, np.isposinf(peak).astype(float))
    if "overturn_share" in contents.fields:
        known = contents.values("overturn_share")
        share = np.where(np.isnan(known), share, known)
    return Members(share)


def _statistics(contents: Contents, study: Study, over: Over) -> dict[str, Field]:
    axes, at = contents.axes, contents.axes.index(over.axis)
    rest = tuple(axis for axis in axes if axis != over.axis)
    became = members(contents)
    added = {name: variable_field(name, rest, of(became, at)) for name, of in STATISTICS.items()}
    for name in SCALARS:
        if name in contents.fields:
            values = became.values(contents.values(name))
            for end, reduce in _reductions(at, over).items():
                added[f"{name}_{end}"] = variable_field(f"{name}_{end}", rest, reduce(values))
    if over.along is not None:
        added |= _islands(contents, became, over, rest) | _fragility(contents, became, over, rest)
    measured = with_measures(contents.fields, contents, study)
    if PEAK in contents.fields:
        whole = replace(contents, fields=contents.fields | measured)
        response = became.values(contents.values(PEAK))
        measured |= correlations(response, whole, over.axis)
    return added | measured


def _reductions(at: int, over: Over) -> dict[str, Callable[[Array], Array]]:
    """What takes fractiles along an axis by the ends of their names, and the mean where it is asked for."""
    found: dict[str, Callable[[Array], Array]] = {end: partial(fractile, q=q, axis=at) for end, q in _FRACTILES.items()}
    return found | ({"mean": partial(_mean, axis=at)} if over.mean else {})


def _mean(values: Array, axis: int) -> Array:
    known = ~np.isnan(values)
    return np.asarray(np.where(known, values, 0.0).sum(axis=axis) / known.sum(axis=axis))


def _thresholds(contents: Contents, study: Study, over: Over) -> dict[str, Field]:
    """Fractiles of what a search found, of all its members: what lies outside the range has its rank all the same."""
    assert study.search is not None
    sought = study.search
    at = contents.axes.index(over.axis)
    rest = tuple(axis for axis in contents.axes if axis != over.axis)
    found = found_by(contents, sought.name)
    added = {"n_answered": variable_field("n_answered", rest, (found.state != BRACKETED).sum(axis=at))}
    for end, reduce in _reductions(at, over).items():
        words = f"{_WORDS[end]} over the suite of: "
        added |= threshold_fields(sought, found.reduced(reduce), rest, end=end, before=words)
        for name in sought.prescreens:
            one = contents.fields[name]
            attrs = one.attrs | {"long_name": words + one.attrs["long_name"]}
            added[f"{name}_{end}"] = Field(rest, reduce(one.values), attrs)
    return added


def _islands(contents: Contents, became: Members, over: Over, rest: tuple[str, ...]) -> dict[str, Field]:
    """Cases that surely stand although the same member surely overturned at a lower intensity."""
    assert over.along is not None
    at = contents.axes.index(over.along)
    order = np.argsort(contents.values(over.along))
    fell = np.take(became.share == 1.0, order, axis=at)
    before = np.logical_or.accumulate(fell, axis=at)
    stands = np.take(became.share == 0.0, order, axis=at)
    island = np.take(before & stands, np.argsort(order), axis=at)
    count = island.sum(axis=contents.axes.index(over.axis))
    return {
        "safe_island": variable_field("safe_island", contents.axes, island.astype(np.int8)),
        "n_safe_islands": variable_field("n_safe_islands", rest, count),
    }


_FITTED: tuple[str, ...] = (
    "fragility_median", "fragility_beta", "fragility_se_ln_median", "fragility_se_beta", "fragility_correlation",
    "fragility_median_low", "fragility_median_high",
)  # fmt: skip


def _fragility(contents: Contents, became: Members, over: Over, rest: tuple[str, ...]) -> dict[str, Field]:
    """Shares that exceed each limit state at every intensity, and the curves through them."""
    assert over.along is not None
    peak = contents.fields.get(PEAK)
    share = np.nan_to_num(became.share)
    # of a divided member the peak where it stands is not known: below overturning it counts by the runs that overturn
    states = [np.where(became.divided, 1.0, peak.values > limit) for limit in over.limits] if peak is not None else []
    known = np.where(became.divided, share, became.answered)
    weights = [known] * len(states) + [became.answered.astype(float)]
    states = [*states, share]
    labels = over.limit_states[-len(states) :]
    order = (*(contents.axes.index(a) for a in rest if a != over.along), contents.axes.index(over.axis))
    order = (*order, contents.axes.index(over.along))
    exceeds, weight = (np.stack([one.transpose(order) for one in of], axis=-3) for of in (states, weights))
    missing = np.broadcast_to(~became.answered.transpose(order)[..., None, :, :], exceeds.shape)
    shape = exceeds.shape[:-2]
    n, k = exceeds.shape[-2:]

    intensity = contents.values(over.along)

    def curves(exceeds: Array, weight: Array) -> Fit:
        return fit(intensity, exceeds.reshape(-1, n, k), weight.reshape(-1, n, k))

    fits = curves(exceeds, weight)
    # NaN where all that is missing leaves no curve
    low, high = (curves(np.where(missing, all_, exceeds), np.where(missing, 1.0, weight)) for all_ in (1.0, 0.0))
    fitted = vars(fits) | {"median_low": low.median, "median_high": high.median}
    share = (exceeds * weight).sum(axis=-2) / weight.sum(axis=-2)  # (others, limit, k)
    dims = (*(axis for axis in rest if axis != over.along), LIMIT)
    place = rest.index(over.along)
    added = {
        LIMIT: Field((LIMIT,), text(labels), {"long_name": VARIABLES[LIMIT].sentence}, coordinate=True),
        "p_exceeded": variable_field("p_exceeded", (*rest, LIMIT), np.moveaxis(share, -1, place)),
    }
    unit = contents.fields[over.along].attrs.get("units", "1")
    for name in _FITTED:
        values = fitted[name.removeprefix("fragility_")].reshape(shape)
        more: dict[str, Any] = {"units": unit} if name.startswith("fragility_median") else {}
        added[name] = variable_field(name, dims, values, **more)
    flags = {"flag_values": np.array(list(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS.values())}
    added["fragility_status"] = variable_field("fragility_status", dims, fits.status.reshape(shape), **flags)
    return added


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
