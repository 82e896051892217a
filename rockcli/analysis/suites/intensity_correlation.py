"""How well measures of the ground motion tell the response: correlations over the suite.

Response and measure are compared over the ensemble axis at every point of the other axes.  Spearman's rank
correlation counts overturned cases as the largest; Pearson's, of the logarithms, leaves out those that overturn or do
not move, which have no logarithm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rockcli.motion.measures import arias, cav, measures, significant_duration
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.uncertain.statistics import pearson, spearman
from rockcli.scene.variables import MEASURE, MEASURES
from rockcli.storage.contents import Contents, Field, text, variable_field
from rockcli.storage.reduced import reduce
from rockcli.study.cases.buildable import by_motion
from rockcli.study.study import Study

Array = NDArray[np.float64]

LEAST = 8
"""Members with an answer below which correlations are left out."""

GROUP = "p_pgv_over_g_tan_alpha"

OF_RECORDS: dict[str, int] = {"pga": 1, "pgv": 1, "arias": 2, "cav": 1, "t_mean": 0, "d5_95": 0}
"""Measures of a record, and the power of its scale factor that each grows with."""


def with_measures(fields: dict[str, Field], contents: Contents, study: Study) -> dict[str, Field]:
    """The measures of the records used that are not among the fields, over the axes they depend on.

    Of pulses there are pga and pgv only, which the dataset has.
    """
    axes = contents.axes
    of_records, g = _of_records(study)
    found = {
        name: _coordinate(name, flat.reshape(contents.shape), axes)
        for name, flat in of_records.items()
        if name not in fields and not np.isnan(flat).all()
    }
    whole = Contents(axes, fields | found, contents.attrs)
    if {"pgv", "p", "alpha"} <= whole.fields.keys():
        p, alpha, pgv = (whole.over_axes(name) for name in ("p", "alpha", "pgv"))
        found[GROUP] = _coordinate(GROUP, p * pgv / (g.reshape(contents.shape) * np.tan(alpha)), axes)
    return found


def _coordinate(name: str, values: Array, axes: tuple[str, ...]) -> Field:
    dims, kept = reduce(values, axes)
    return replace(variable_field(name, dims, kept), coordinate=True)


def _of_records(study: Study) -> tuple[dict[str, Array], Array]:
    """Measures of the motion of every case that has a record, (n,) each, NaN for the others; and g of every case."""
    values = {name: np.full(study.size, np.nan) for name in OF_RECORDS}
    g = np.full(study.size, np.nan)
    known: dict[tuple[bytes, float, float], dict[str, float]] = {}
    for indices, batch in by_motion(study.suites, np.arange(study.size)):
        g[indices] = batch.g
        motion = batch.excitation.horizontal
        if not isinstance(motion, Samples):
            continue
        raw, end = motion.values.tobytes(), motion.end
        duration = np.where(np.isnan(batch.excitation.duration), np.inf, batch.excitation.duration)
        cut = np.minimum(duration, end)
        for until in np.unique(cut):
            rows = cut == until
            key = (raw, motion.dt, float(until))
            if key not in known:
                known[key] = _until(motion.values, motion.dt, float(until))
            size = np.abs(np.broadcast_to(motion.factor, rows.shape)[rows])
            for name, power in OF_RECORDS.items():
                per_g = batch.g[rows] if name == "arias" else 1.0
                values[name][indices[rows]] = known[key][name] * size**power / per_g
    return values, g


def _until(a: Array, dt: float, until: float) -> dict[str, float]:
    """Measures of a motion up to a time, in g of 1 m/s²; the mean period is that of the samples before it."""
    last = min(int(np.floor(until / dt + 1e-9)), len(a) - 1)
    found = measures(a[: last + 1], dt, 1.0)
    rest = until - last * dt
    if last < len(a) - 1 and rest > 0.0:
        ends = np.array([a[last], a[last] + (a[last + 1] - a[last]) * rest / dt])
        found["arias"] += arias(ends, rest, 1.0)
        found["cav"] += cav(ends, rest)
        found["d5_95"] = significant_duration(np.append(a[: last + 1], ends[1]), np.append(np.full(last, dt), rest))
    return found


def correlations(response: Array, whole: Contents, axis: str) -> dict[str, Field]:
    """Correlations of a response over the axes with every measure that differs along the ensemble axis."""
    place = whole.axes.index(axis)
    y = np.moveaxis(response, place, -1)
    moving = np.where(np.isfinite(y) & (y > 0.0), y, np.nan)
    names, by_rank, by_log = [], [], []
    for name in MEASURES:
        if name not in whole.fields or axis not in whole.fields[name].dims:
            continue
        x = np.moveaxis(whole.over_axes(name), place, -1)
        differs = np.ptp(x, axis=-1, keepdims=True) > 1e-9 * np.abs(x).max(axis=-1, keepdims=True)
        if not differs.any():  # what the records were scaled to
            continue
        x = np.where(differs, x, np.nan)
        names.append(name)
        by_rank.append(_of_enough(spearman, x, y))
        with np.errstate(divide="ignore", invalid="ignore"):
            by_log.append(_of_enough(pearson, np.log(np.where(x > 0.0, x, np.nan)), np.log(moving)))
    if not names:
        return {}
    rest = tuple(name for name in whole.axes if name != axis)
    dims = (*rest, MEASURE)
    measure = Field((MEASURE,), text(names), {"long_name": "measure of the ground motion"}, coordinate=True)
    return {
        MEASURE: measure,
        "demand_spearman": variable_field("demand_spearman", dims, np.stack(by_rank, axis=-1)),
        "demand_pearson": variable_field("demand_pearson", dims, np.stack(by_log, axis=-1)),
        "n_moving": variable_field("n_moving", rest, (~np.isnan(moving)).sum(axis=-1)),
    }


def _of_enough(correlation: Callable[[Array, Array], Array], x: Array, y: Array) -> Array:
    pairs = (~(np.isnan(x) | np.isnan(y))).sum(axis=-1)
    return np.where(pairs >= LEAST, correlation(x, y), np.nan)
