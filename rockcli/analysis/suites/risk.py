"""Fragility of every body convolved with hazard curves, as variables of its dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.annual_rate import Fragility, Rate, annual_rate
from rockcli.analysis.places import json_point, json_value
from rockcli.scene.ground.hazard import CONSISTENT, HazardCurve
from rockcli.scene.variables import HAZARD, HAZARD_POINT, INTENSITY_BIN, VARIABLES
from rockcli.storage.contents import Contents, Field, text, variable_field
from rockcli.study.study import Over

Array = NDArray[np.float64]

TAIL = 0.01
"""Share of a rate from which a tail outside the hazard curve is told in a warning."""

BINS = 24
"""Bins of the deaggregation, equally wide on a logarithmic axis."""

RATES: tuple[str, ...] = (
    "annual_rate", "annual_rate_ci_low", "annual_rate_ci_high", "annual_rate_above", "annual_rate_below",
)  # fmt: skip

OF_AGE: tuple[str, ...] = ("probability_in_age", "survival", "likelihood_ratio", "hazard_consistent")
"""What an age adds."""

OTHERS: tuple[str, ...] = (
    HAZARD, "hazard_intensity", "hazard_rate",
    INTENSITY_BIN, "intensity_bin_low", "intensity_bin_high", "deaggregation",
)  # fmt: skip

_STEP = 1e-4
"""Steps of ln(median - x_0) and beta by which the rate's derivatives are taken."""


def risk(fragility: Mapping[str, Field], over: Over) -> dict[str, Field]:
    """Annual rates of every body, limit state and hazard curve, from the fields of its fragility curves."""
    if not over.hazard or "fragility_median" not in fragility:
        return {}
    dims = (*fragility["fragility_median"].dims, HAZARD)
    shape = fragility["fragility_median"].values.shape
    unit = fragility["fragility_median"].attrs["units"]
    first = min(curve.intensity[0] for curve in over.hazard)
    last = max(curve.intensity[-1] for curve in over.hazard)
    edges = np.geomspace(first, last, BINS + 1)
    found = {name: np.full((*shape, len(over.hazard)), np.nan) for name in RATES}
    parts = np.full((*shape, len(over.hazard), BINS), np.nan)
    begins = np.broadcast_to(fragility["fragility_begins_at"].values[..., None], shape)
    for at in np.ndindex(*shape):
        estimates = {name: float(fragility[f"fragility_{name}"].values[at]) for name in _ESTIMATES}
        if not np.isfinite(estimates["median"]):
            continue
        for i, hazard in enumerate(over.hazard):
            rate = _rate(estimates, float(begins[at]), hazard, over.beta_added, edges)
            low, high = _limits(estimates, float(begins[at]), hazard, over.beta_added, rate.total)
            told = (rate.total, low, high, rate.above, rate.below)
            for name, value in zip(RATES, told, strict=True):
                found[name][(*at, i)] = value
            parts[(*at, i)] = rate.parts / rate.total if rate.total > 0.0 else np.nan
    fields = _of_curves(over.hazard, unit) | {name: variable_field(name, dims, v) for name, v in found.items()}
    if over.age is not None:
        with np.errstate(under="ignore"):
            survival = np.exp(-found["annual_rate"] * over.age)
            ratio = np.exp(-over.age * (found["annual_rate"] - found["annual_rate"].min(axis=-1, keepdims=True)))
        of_age = {
            "probability_in_age": -np.expm1(-found["annual_rate"] * over.age),
            "survival": survival,
            "likelihood_ratio": ratio,
            "hazard_consistent": np.where(np.isnan(survival), np.nan, survival >= CONSISTENT),
        }
        words = f"; age: {over.age:g} years"
        for name, values in of_age.items():
            fields[name] = variable_field(name, dims, values, long_name=VARIABLES[name].sentence + words)
    for name, values in (
        (INTENSITY_BIN, np.sqrt(edges[1:] * edges[:-1])),
        ("intensity_bin_low", edges[:-1]),
        ("intensity_bin_high", edges[1:]),
    ):
        attrs = {"long_name": VARIABLES[name].sentence, "units": unit}
        fields[name] = Field((INTENSITY_BIN,), values, attrs, coordinate=name == INTENSITY_BIN)
    fields["deaggregation"] = variable_field("deaggregation", (*dims, INTENSITY_BIN), parts)
    return fields


_ESTIMATES = ("median", "beta", "se_ln_median", "se_beta", "correlation", "median_ci_high")


def _rate(e: Mapping[str, float], begins: float, hazard: HazardCurve, added: float, edges: Array | None = None) -> Rate:
    return annual_rate(Fragility(e["median"], float(np.hypot(e["beta"], added)), begins), hazard, edges)


def _limits(
    e: Mapping[str, float], begins: float, hazard: HazardCurve, added: float, rate: float
) -> tuple[float, float]:
    """95 % limits of a rate by the delta method on its logarithm, with the covariance of median and beta.

    At most the rate of the first point of the hazard curve, that of all motions which are counted.
    """
    if not rate > 0.0:
        return np.nan, np.nan

    def log_rate(shift: float, wider: float) -> float:
        median = begins + (e["median"] - begins) * float(np.exp(shift))
        moved = {**e, "median": median, "beta": e["beta"] + wider}
        return float(np.log(_rate(moved, begins, hazard, added).total))

    step = _STEP * e["beta"]
    of_median = (log_rate(step, 0.0) - log_rate(-step, 0.0)) / (2.0 * step)
    of_beta = (log_rate(0.0, step) - log_rate(0.0, -step)) / (2.0 * step)
    a, b = of_median * e["se_ln_median"], of_beta * e["se_beta"]
    spread = float(np.sqrt(max(a * a + b * b + 2.0 * e["correlation"] * a * b, 0.0)))
    # the quantile of the limits of the median, which knows how many members there are
    reach = float(np.log((e["median_ci_high"] - begins) / (e["median"] - begins)) / e["se_ln_median"])
    return rate * float(np.exp(-reach * spread)), min(rate * float(np.exp(reach * spread)), float(hazard.rate[0]))


def _of_curves(curves: tuple[HazardCurve, ...], unit: str) -> dict[str, Field]:
    """The curves themselves, so that a dataset shows what its rates come from; padded with NaN."""
    most = max(len(curve.rate) for curve in curves)
    points = {name: np.full((len(curves), most), np.nan) for name in ("intensity", "rate")}
    for i, curve in enumerate(curves):
        points["intensity"][i, : len(curve.rate)] = curve.intensity
        points["rate"][i, : len(curve.rate)] = curve.rate
    dims = (HAZARD, HAZARD_POINT)
    labels = text([curve.label for curve in curves])
    return {
        HAZARD: Field((HAZARD,), labels, {"long_name": VARIABLES[HAZARD].sentence}, coordinate=True),
        "hazard_intensity": variable_field("hazard_intensity", dims, points["intensity"], units=unit),
        "hazard_rate": variable_field("hazard_rate", dims, points["rate"]),
    }


def risk_rows(contents: Contents) -> Iterator[dict[str, Any]]:
    """The rates of a dataset as plain values, a row per body, limit state and hazard curve; None for no number."""
    if "annual_rate" not in contents.fields:
        return
    dims = contents.fields["annual_rate"].dims
    names = [name for name in (*RATES, *OF_AGE) if name in contents.fields]
    for at in np.ndindex(*contents.values("annual_rate").shape):
        yield json_point(contents, dims, at) | {name: json_value(contents.values(name)[at]) for name in names}


def central(contents: Contents, at: tuple[int, ...]) -> tuple[float, float]:
    """Intensities between which the middle 68 % of a rate come from; `at` of (body, limit state, hazard curve)."""
    edges = np.append(contents.values("intensity_bin_low"), contents.values("intensity_bin_high")[-1])
    reached = np.concatenate([[0.0], np.cumsum(contents.values("deaggregation")[at])])
    low, high = np.exp(np.interp((0.16, 0.84), reached, np.log(edges)))
    return float(low), float(high)


def largest_tail(contents: Contents) -> Iterator[tuple[str, str, float, float]]:
    """Hazard curves whose tails matter: (curve, `above` or `below`, what it adds, that rate), most beside the rate."""
    if "annual_rate" not in contents.fields:
        return
    rate = contents.values("annual_rate")
    for i, label in enumerate(contents.values(HAZARD)):
        for end in ("above", "below"):
            told, more = rate[..., i].ravel(), contents.values(f"annual_rate_{end}")[..., i].ravel()
            with np.errstate(all="ignore"):
                share = more / told
            if not np.isnan(share).all() and np.nanmax(share) > TAIL:
                most = int(np.nanargmax(share))
                yield str(label), end, float(more[most]), float(told[most])
