"""Fragility of every body convolved with hazard curves, as variables of its dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.annual_rate import Fragility, annual_rate, rates_of
from rockcli.analysis.fragility.curves import CONFIDENCE, Scatter
from rockcli.analysis.places import json_point, json_value
from rockcli.analysis.suites.fragility import Scatters
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

_PARTS = 1000
"""Bins of a hazard curve in which the middle of a rate is looked for."""

_CHANCES = 24
"""Betas that a scatter allows, at the nodes of Gauss's rule on their probability."""

_Z, _FINE = np.linspace(-5.0, 5.0, 11), 400
"""Medians beside each, in standard deviations, and in how many parts the rate is interpolated between them."""


def risk(fragility: Mapping[str, Field], scatter: Scatters, over: Over) -> dict[str, Field]:
    """Annual rates of every body, limit state and hazard curve, from its fragility curves and what their scatter is."""
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
        median, beta = (float(fragility[f"fragility_{name}"].values[at]) for name in ("median", "beta"))
        if not np.isfinite(median):
            continue
        curve = Fragility(median, float(np.hypot(beta, over.beta_added)), float(begins[at]))
        for i, hazard in enumerate(over.hazard):
            rate = annual_rate(curve, hazard, edges)
            low, high = _limits(curve, scatter.get(at), hazard, over.beta_added, rate.total)
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


def _limits(
    curve: Fragility, scatter: Scatter | None, hazard: HazardCurve, added: float, rate: float
) -> tuple[float, float]:
    """95 % limits of a rate: those of the rates of all medians and betas that the scatter of the suite allows.

    At most the rate of the first point of the hazard curve, that of all motions which are counted.
    """
    if scatter is None or not rate > 0.0:
        return np.nan, np.nan
    from scipy.special import ndtr

    nodes, weights = np.polynomial.legendre.leggauss(_CHANCES)
    away, beta = scatter.allowed(0.5 * (1.0 + nodes), _Z)
    above, total = np.log(curve.median - curve.begins_at), np.hypot(beta, added)[:, None]
    rates = rates_of(above + away, np.broadcast_to(total, away.shape), curve.begins_at, hazard)
    told = rates_of(np.array(above), np.array(curve.beta), curve.begins_at, hazard)
    fine = np.linspace(_Z[0], _Z[-1], _FINE + 1)
    middle = 0.5 * (fine[1:] + fine[:-1])
    found = np.concatenate([np.interp(middle, _Z, of) for of in np.log(np.maximum(rates, np.finfo(float).tiny))])
    weight = np.multiply.outer(0.5 * weights, np.diff(ndtr(fine))).ravel()
    order = np.argsort(found)
    part = np.cumsum(weight[order]) / weight.sum()
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.exp(np.interp([tail, 1.0 - tail], part, found[order]))
    return rate * min(float(low / told), 1.0), min(rate * max(float(high / told), 1.0), float(hazard.rate[0]))


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
    """Intensities between which the middle 68 % of a rate come from; `at` of (body, limit state, hazard curve).

    inf for an end that lies beyond the hazard curve, of whose motions no intensity is known.
    """
    x, rate = (contents.values(f"hazard_{name}")[at[-1]] for name in ("intensity", "rate"))
    hazard = HazardCurve("", x[np.isfinite(x)], rate[np.isfinite(rate)])
    median, beta = (float(contents.values(f"fragility_{name}")[at[:-1]]) for name in ("median", "beta_total"))
    curve = Fragility(median, beta, float(contents.values("fragility_begins_at")[at[:-2]]))
    edges = np.geomspace(hazard.intensity[0], hazard.intensity[-1], _PARTS + 1)
    found = annual_rate(curve, hazard, edges)
    below = np.cumsum(np.append(0.0, found.parts))
    below[-1] = max(below[-1] - float(curve(hazard.intensity[-1:])[0] * hazard.rate[-1]), below[-2])
    low, high = np.exp(np.interp((0.16, 0.84), below / found.total, np.log(edges), right=np.inf))
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
