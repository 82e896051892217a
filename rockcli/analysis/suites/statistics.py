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

from rockcli.analysis.places import units_of
from rockcli.analysis.suites.fragility import FITTED, OF_SECOND, OTHERS, fragility, fragility_of_thresholds
from rockcli.analysis.suites.intensity_correlation import correlations, with_measures
from rockcli.analysis.suites.members import Members, members_of
from rockcli.analysis.suites.risk import OF_AGE, RATES, risk
from rockcli.analysis.suites.risk import OTHERS as RISK
from rockcli.analysis.suites.side_by_side import end_to_end, laid_out
from rockcli.analysis.suites.uncertainty import NAMES, with_samples
from rockcli.analysis.suites.words import sentences, warnings
from rockcli.analysis.threshold_fields import found_by, threshold_fields
from rockcli.scene.thresholds import BRACKETED
from rockcli.scene.uncertain.statistics import fractile
from rockcli.scene.units import SI
from rockcli.scene.variables import PEAK, VARIABLES
from rockcli.storage.contents import Contents, Field, variable_field
from rockcli.study.study import Over, Study

Array = NDArray[np.float64]

ATTRIBUTE = "ensemble"
"""Root attribute, JSON: axis, along, limits, the fields that belong to it, its sentences (`says` in SI units, `shown`
with accelerations in g) and its warnings."""

RANKED: tuple[str, ...] = (PEAK, "theta_dot_peak", "u_top_peak", "slide_peak")
"""Scalars whose fractiles are taken."""

_FRACTILES: dict[str, float] = {"p16": 0.16, "p50": 0.5, "p84": 0.84}

_WORDS = {"p16": "16th percentile", "p50": "median", "p84": "84th percentile", "mean": "mean"}


def _fell(became: Members, at: int) -> Array:
    return np.asarray(np.nansum(became.share, axis=at))


def _answered(became: Members, at: int) -> Array:
    return np.asarray(became.answered.sum(axis=at))


@dataclass(frozen=True)
class Statistic:
    """A row: `of(members, axis of the members)` at every point of the other axes.

    `needs`: scalars that it reads in `members.scalars`; a study that does not save them has no such statistic.
    """

    of: Callable[[Members, int], Array]
    needs: tuple[str, ...] = ()


STATISTICS: dict[str, Statistic] = {
    "n_answered": Statistic(_answered),
    "p_overturned": Statistic(lambda became, at: _fell(became, at) / _answered(became, at)),
    "p_overturned_low": Statistic(lambda became, at: _fell(became, at) / became.share.shape[at]),
    "p_overturned_high": Statistic(
        lambda became, at: (_fell(became, at) + became.share.shape[at] - _answered(became, at)) / became.share.shape[at]
    ),
}
"""What is told of the members of a suite, by the name of the variable."""


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
    row = end_to_end(plain, study.over)
    with np.errstate(all="ignore"):
        found = _thresholds(row, study, study.over) if study.search else _statistics(row, study, study.over)
    whole = replace(row, fields=row.fields | found)
    added = laid_out(found, plain, study.over)
    more = [s for s in warnings(whole, study) if s not in said]
    about = {
        "axis": study.over.axis if len(study.over.axes) == 1 else list(study.over.axes),
        "along": study.over.along,
        "told_against": study.over.told_against,
        "second": study.over.second,
        "limits": list(study.over.limit_states[:-1]),
        "age": study.over.age,
        "fields": list(added),
        "says": sentences(whole, study, SI),
        "shown": sentences(whole, study, units_of(whole)),
        "warnings": more,
    }
    return replace(
        plain, fields=fields | added, attrs=attrs | {"warnings": _json([*said, *more]), ATTRIBUTE: _json(about)}
    )


def variables(study: Study) -> set[str]:
    """Names of the statistics a study's dataset will have (of a search, see `Searched.results`)."""
    over = study.over
    if over is None:
        return set()
    found = {"n_answered"}
    if study.search is not None:
        found |= set(study.search.results(over)) | ({*FITTED, *OTHERS} if over.told_against else set())
        return found | ({*RATES, *RISK, *(OF_AGE if over.age is not None else ())} if over.hazard else set())
    found |= {name for name, row in STATISTICS.items() if {*row.needs} <= {*study.scalars}}
    found |= {*(f"{name}_{end}" for name in RANKED if name in study.scalars for end in over.ends)}
    if PEAK in study.scalars:
        found |= {"demand_spearman", "demand_pearson", "n_moving"}
    if over.along is not None:
        found |= {"safe_island", "n_safe_islands", "p_exceeded"}
    if over.told_against:
        found |= {*FITTED, *OTHERS}
        found |= {*OF_SECOND, "fragility_second", "fragility_intensity_second"} if over.second else set()
    if over.inputs:
        found |= {*NAMES}
    if over.hazard:
        found |= {*RATES, *RISK, *(OF_AGE if over.age is not None else ())}
    return found | set(VARIABLES).intersection(("p_pgv_over_g_tan_alpha", "arias", "cav", "t_mean", "d5_95"))


def _statistics(contents: Contents, study: Study, over: Over) -> dict[str, Field]:
    axes, at = contents.axes, contents.axes.index(over.axis)
    rest = tuple(axis for axis in axes if axis != over.axis)
    became = members_of(contents)
    rows = {name: row for name, row in STATISTICS.items() if became.scalars.keys() >= {*row.needs}}
    added = {name: variable_field(name, rest, row.of(became, at)) for name, row in rows.items()}
    for name in RANKED:
        if name in contents.fields:
            values = became.values(contents.values(name))
            for end, reduce in _reductions(at, over).items():
                added[f"{name}_{end}"] = variable_field(f"{name}_{end}", rest, reduce(values))
    if over.along is not None:
        added |= _islands(contents, became, over, rest)
    measured = with_measures(contents.fields, contents, study)
    if over.told_against:
        curves, scatter = fragility(replace(contents, fields=contents.fields | measured), became, study, over)
        added |= curves | risk(curves, scatter, over)
    if PEAK in contents.fields:
        whole = replace(contents, fields=contents.fields | measured)
        response = became.values(contents.values(PEAK))
        measured |= correlations(response, whole, over.axis)
    return added | measured | with_samples(contents, became, study, over)


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
    measured = with_measures(contents.fields, contents, study) if over.told_against == "cav" else {}
    curves, scatter = fragility_of_thresholds(replace(contents, fields=contents.fields | measured), study, over)
    return added | curves | risk(curves, scatter, over)


def _islands(contents: Contents, became: Members, over: Over, rest: tuple[str, ...]) -> dict[str, Field]:
    """Cases that surely stand although the same member surely overturned at a lower intensity, of the same sign."""
    assert over.along is not None
    at, intensity = contents.axes.index(over.along), contents.values(over.along)
    order = np.lexsort((np.abs(intensity), intensity < 0.0))
    sides = np.split(np.take(became.share == 1.0, order, axis=at), [int((intensity >= 0.0).sum())], axis=at)
    before = np.concatenate([np.logical_or.accumulate(fell, axis=at) for fell in sides], axis=at)
    stands = np.take(became.share == 0.0, order, axis=at)
    island = np.take(before & stands, np.argsort(order), axis=at)
    count = island.sum(axis=contents.axes.index(over.axis))
    return {
        "safe_island": variable_field("safe_island", contents.axes, island.astype(np.int8)),
        "n_safe_islands": variable_field("n_safe_islands", rest, count),
    }


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
