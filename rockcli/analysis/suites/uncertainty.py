"""What samples of uncertain inputs say: the probability of overturning with its own error, and which input matters.

Standard errors count independent rows.  Points of a Latin hypercube or a scrambled Sobol sequence count as random ones,
which is conservative: n points of a Latin hypercube never vary more than n - 1 random ones (Owen 1997, SIAM J. Numer.
Anal. 34(5)).  Points of Saltelli's design that share inputs are one row.  Over several records these are the rows, and
what the samples, which all records share, add to their scatter is added (Cameron, Gelbach and Miller 2011).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.curves import CONFIDENCE
from rockcli.analysis.places import json_point, json_value
from rockcli.analysis.suites.members import Members
from rockcli.scene.uncertain.samples import SALTELLI, base_points
from rockcli.scene.uncertain.statistics import spearman
from rockcli.scene.variables import INPUT, PEAK
from rockcli.storage.contents import Contents, Field, text, variable_field
from rockcli.study.study import SAMPLE, Over, Study, Uncertain

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PROBABILITY = ("p_overturned_se", "p_overturned_ci_low", "p_overturned_ci_high")

RANKS = "input_spearman"

SOBOL = ("sobol_first", "sobol_first_se", "sobol_total", "sobol_total_se")
"""Indices of overturning; those of the peak end in `_peak`."""

NAMES = (*PROBABILITY, RANKS, *SOBOL, *(f"{name}_peak" for name in SOBOL), INPUT)


ROUNDING = 1e-12
"""Standard error of rows that are all alike, or of one: nothing is told from it."""


@dataclass(frozen=True, eq=False)
class Probability:
    """A probability with its standard error and confidence limits, at every point."""

    value: Array
    se: Array
    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class Together:
    """Which members of an ensemble belong together and are not independent, (n,) each, from 0.

    Attributes:
        rows: the row of every member.
        shared: the sample of every member, drawn for all rows together; None without, or where samples are the rows.
    """

    rows: Index
    shared: Index | None = None


def probability(share: Array, rows: Index, shared: Index | None = None) -> Probability:
    """The mean of shares along the last axis, NaN left out, with the error of a mean of independent rows.

    Where rows share samples its square is the sum of that of rows and of samples less that of both at once, and neither
    of the first two is above it.

    Limits by Clopper and Pearson (1934) for as many members as would have this error, and for fewer where there are few
    rows to tell it from: times the square of Student's t of the members over that of the rows (Korn and Graubard 1998).
    Where no row differs from another, for as many as there are rows.

    Args:
        share: (..., n) in [0, 1], NaN without an answer.
        rows, shared: (n,) which members are not independent, as of `Together`.
    """
    from scipy.special import betaincinv, stdtrit

    known = ~np.isnan(share)
    n = known.sum(axis=-1)
    p = np.where(known, share, 0.0).sum(axis=-1) / n
    away = np.where(known, share - p[..., None], 0.0)
    square, there = _scatter(away, known, rows)
    if shared is not None:
        of_samples, samples = _scatter(away, known, shared)
        of_both, _ = _scatter(away, known, rows * (int(shared.max()) + 1) + shared)
        square = np.maximum(square + of_samples - of_both, np.maximum(square, of_samples))
        there = np.minimum(there, samples)
    se, tail = np.sqrt(square) / n, 0.5 * (1.0 - CONFIDENCE)
    few = stdtrit(np.maximum(n - 1.0, 1.0), tail) / stdtrit(np.maximum(there - 1.0, 1.0), tail)
    told = se > ROUNDING
    many = np.where(told, p * (1.0 - p) * (few / np.where(told, se, 1.0)) ** 2, there)
    hits = p * many
    low = np.where(p > 0.0, betaincinv(np.maximum(hits, 1e-300), many - hits + 1.0, tail), 0.0)
    high = np.where(p < 1.0, betaincinv(hits + 1.0, np.maximum(many - hits, 1e-300), 1.0 - tail), 1.0)
    empty = n == 0
    return Probability(*(np.where(empty, np.nan, values) for values in (p, se, low, high)))


def _scatter(away: Array, known: NDArray[np.bool_], rows: Index) -> tuple[Array, Array]:
    """Sum of the squares of what j rows are away from the mean, times j/(j - 1), and how many rows have an answer."""
    j = int(rows.max()) + 1
    of_rows, answers = (np.zeros((j, *away.shape[:-1])) for _ in range(2))
    np.add.at(of_rows, rows, np.moveaxis(away, -1, 0))
    np.add.at(answers, rows, np.moveaxis(known.astype(float), -1, 0))
    return j / max(j - 1, 1) * (of_rows**2).sum(axis=0), (answers > 0.0).sum(axis=0).astype(float)


def sobol_indices(f: Array) -> tuple[Array, Array, Array, Array]:
    """First-order and total indices of the inputs, each with its standard error, (..., d); NaN where nothing varies.

    Args:
        f: (..., d + 2, rows) response at the blocks A, B, AB_1 ... AB_d; rows with a NaN are left out.

    First order by Saltelli et al. (2010, table 2 b), total by Jansen (1999); errors to first order in the means.
    """
    whole = np.asarray(~np.isnan(f).any(axis=-2))
    n = whole.sum(axis=-1)[..., None]

    def mean(values: Array) -> Array:
        return np.asarray(np.where(whole[..., None, :], values, 0.0).sum(axis=-1) / n)

    a, b, ab = f[..., :1, :], f[..., 1:2, :], f[..., 2:, :]
    centre = mean(0.5 * (a + b))[..., None]
    spread = 0.5 * ((a - centre) ** 2 + (b - centre) ** 2)
    variance = mean(spread)
    found = []
    for product in ((b - centre) * (ab - a), 0.5 * (a - ab) ** 2):
        index = np.where(variance > 0.0, mean(product) / variance, np.nan)
        influence = product - index[..., None] * spread
        se = np.sqrt(mean(influence**2) / np.maximum(n - 1, 1)) / variance
        found += [index, np.where(variance > 0.0, se, np.nan)]
    return found[0], found[1], found[2], found[3]


def with_samples(contents: Contents, became: Members, study: Study, over: Over) -> dict[str, Field]:
    """What is added to the statistics of an ensemble with samples, at every point of the other axes.

    `contents` have the axes of the ensemble laid end to end.
    """
    uncertain = study.uncertain
    if uncertain is None or SAMPLE not in over.axes:
        return {}
    place = contents.axes.index(over.axis)
    rest = tuple(axis for axis in contents.axes if axis != over.axis)
    sizes = tuple(next(axis.size for axis in study.axes if axis.name == name) for name in over.axes)
    which = np.unravel_index(np.arange(int(np.prod(sizes))), sizes)[over.axes.index(SAMPLE)]
    share = np.moveaxis(became.share, place, -1)
    together = members_together(study, over)
    found = probability(share, together.rows, together.shared)
    added = {
        name: variable_field(name, rest, values)
        for name, values in zip(PROBABILITY, (found.se, found.low, found.high), strict=True)
    }
    paths = [each.path for each in uncertain.inputs]
    added[INPUT] = Field((INPUT,), text(paths), {"long_name": "uncertain input"}, coordinate=True)
    response = share
    if PEAK in contents.fields:
        response = np.moveaxis(became.values(contents.values(PEAK)), place, -1)
    by_rank = [spearman(np.broadcast_to(each.values[which], response.shape), response) for each in uncertain.inputs]
    added[RANKS] = variable_field(RANKS, (*rest, INPUT), np.stack(by_rank, axis=-1))
    if uncertain.sampling == SALTELLI:
        for end, values in (("", share), ("_peak", np.where(np.isinf(response), np.nan, response))):
            some = np.asarray(np.isinf(response).any(axis=-1) & bool(end))
            blocks = _blocks(values, uncertain, over, sizes)
            for name, index in zip(SOBOL, sobol_indices(blocks), strict=True):
                kept = np.where(some[..., None], np.nan, index)
                added[name + end] = variable_field(name + end, (*rest, INPUT), kept)
        if PEAK not in contents.fields:
            added = {name: item for name, item in added.items() if not name.endswith("_peak")}
    return added


def members_together(study: Study, over: Over) -> Together:
    """Which members of an ensemble are not independent.

    Of several axes a row is a record, whatever else is made of it (directions, signs), without records a point of the
    first axis that has several points and is not that of samples, and samples are shared by all rows; else of samples
    each is a row.  Points of Saltelli's design that share inputs are one sample.
    """
    axes = [next(axis for axis in study.axes if axis.name == name) for name in over.axes]
    sizes = tuple(axis.size for axis in axes)
    places = np.unravel_index(np.arange(int(np.prod(sizes))), sizes)
    samples = None
    if SAMPLE in over.axes:
        samples, n = np.asarray(places[over.axes.index(SAMPLE)]), sizes[over.axes.index(SAMPLE)]
        if study.uncertain is not None:
            samples = samples % base_points(study.uncertain.sampling, n, len(study.uncertain.inputs))
    several = [i for i, axis in enumerate(axes) if axis.name != SAMPLE and axis.size > 1]
    if several:
        of_records = (i for i in several if axes[i].path.rsplit(".", 1)[-1] in ("file", "record"))
        rows = np.asarray(places[next(of_records, several[0])])
        return Together(rows, None if samples is None or samples.max() == 0 else samples)
    return Together(np.asarray(places[-1]) if samples is None else samples)


def _blocks(values: Array, uncertain: Uncertain, over: Over, sizes: tuple[int, ...]) -> Array:
    """Responses of Saltelli's blocks, (..., d + 2, rows): of several records their mean."""
    at = over.axes.index(SAMPLE)
    apart = np.moveaxis(values.reshape(*values.shape[:-1], *sizes), values.ndim - 1 + at, -1)
    whole = apart.mean(axis=tuple(range(values.ndim - 1, apart.ndim - 1)))
    return np.asarray(whole.reshape(*whole.shape[:-1], len(uncertain.inputs) + 2, -1))


def sample_rows(contents: Contents) -> Iterator[dict[str, Any]]:
    """What is known of the probability at every point, as plain values; None for what is no number."""
    if "p_overturned_se" not in contents.fields:
        return
    dims = contents.fields["p_overturned_se"].dims
    names = ("n_answered", "p_overturned", *PROBABILITY)
    inputs = [str(path) for path in contents.values(INPUT)]
    for at in np.ndindex(*contents.values("p_overturned_se").shape):
        row = json_point(contents, dims, at) | {name: json_value(contents.values(name)[at]) for name in names}
        for name in (RANKS, *SOBOL, *(f"{name}_peak" for name in SOBOL)):
            if name in contents.fields:
                row[name] = dict(zip(inputs, map(json_value, contents.values(name)[at]), strict=True))
        yield row
