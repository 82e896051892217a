"""What differs between two datasets at the points they share: outcomes and peaks, or what two searches found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.places import coordinate, place, units_of
from rockcli.errors import StudyError
from rockcli.scene.axis_path import axis_path
from rockcli.scene.response import OUTCOMES, overturned
from rockcli.scene.thresholds import FOUND, IN_RANGE, STATES, Thresholds
from rockcli.scene.units import SI, Units, unit_words
from rockcli.scene.variables import PEAK, SLIDE
from rockcli.storage.contents import Contents
from rockcli.study.document.paths import is_path, resolve
from rockcli.study.study import MATCH

OUTCOME = "outcome"

FLOOR = 1e-9
"""Peaks smaller than this differ by no more than it: theta/alpha, or m of a slide, below which nobody cares."""

_COORDINATES = 5
"""Coordinates of an axis that a message names."""


class NothingToCompareError(StudyError):
    """Neither of two datasets has outcomes, peaks or thresholds, as those of static curves have none."""


@dataclass(frozen=True)
class Difference:
    """Two datasets, point by point.

    Attributes:
        points: points that both have; only_a, only_b: points of one only.
        filled: points that a refined map of the two did not solve, of which outcomes alone are compared.
        outcomes: points with another outcome; peaks: points with the same outcome and a peak, of the rotation or of
            the slide of a body that stands, beyond the tolerance.
        largest: largest relative difference of two finite peaks, NaN if none can be compared.
        median: median of those relative differences.
        worst: (place, words) of the worst points, outcomes first, then peaks by size.
        paired: axes of the first -> axes of the second that were taken for them, as their labels are the same.
        quantity: what is compared as peaks: theta_peak_over_alpha, "" where that is not saved, or the threshold of two
            searches (`<axis>_overturning`), whose states take the place of outcomes.
        changes: {`rocking -> overturned_after_impact`: points}, the most frequent first.
    """

    points: int
    only_a: int
    only_b: int
    filled: int
    outcomes: int
    peaks: int
    largest: float
    median: float
    worst: tuple[tuple[str, str], ...]
    paired: dict[str, str]
    quantity: str
    changes: dict[str, int]

    @property
    def same(self) -> bool:
        """Whether no outcome and no peak differs."""
        return not self.outcomes and not self.peaks


def difference(
    a: Contents, b: Contents, *, rtol: float, atol: float = FLOOR, most: int = 10, si: bool = False
) -> Difference:
    """Compare b with a at the points of the axes that both have.

    Two peaks agree if |b - a| <= atol + rtol max(|a|, |b|), or both are infinite, or neither has an answer.  Two
    thresholds agree also if they are no farther apart than the brackets in which they were found are wide.

    Args:
        a, b: datasets with the same axes, in any order; where its labels are the same, an axis of labels may have
            another name, as the same settings have by name below one key and in a table below another.
        rtol, atol: allowed differences of theta_peak_over_alpha and slide_peak, or of the thresholds.
        most: worst points named.

    Raises:
        StudyError: the axes differ, no point is shared, or neither outcome, nor peak, nor threshold is in both
            (`NothingToCompareError`: nor in one of them).
    """
    paired = _paired(a, b)
    b = _renamed(b, {other: axis for axis, other in paired.items()})
    at_a, at_b = _shared(a, b)
    points = int(np.prod([len(rows) for rows in at_a], dtype=np.int64))
    if not points:
        apart = next(axis for axis, rows in zip(a.axes, at_a, strict=True) if not len(rows))
        raise StudyError(
            f"the datasets have no point in common: {_said(a, apart)} in the first, {_said(b, apart)} in the second; "
            "points are the same where labels are equal and numbers agree to nine digits"
        )
    quantity, flags, (peak_a, slack_a), (peak_b, slack_b) = _compared(a, b, at_a, at_b)
    shape = tuple(len(rows) for rows in at_a)
    other = np.zeros(shape, dtype=bool)
    beyond = np.zeros(shape, dtype=bool)
    relative = np.full(shape, np.nan)
    slides = None
    if flags is not None:
        words_of, flags_a, flags_b = flags
        other = flags_a != flags_b
    if quantity:
        beyond, relative = _apart(peak_a, peak_b, rtol, atol, np.maximum(slack_a, slack_b))
    if flags is not None and SLIDE in a.fields and SLIDE in b.fields:
        stands = ~overturned(flags_a)
        slides = _picked(a, SLIDE, at_a), _picked(b, SLIDE, at_b, a.axes)
        slid, how_far = _apart(*slides, rtol, atol)
        beyond, relative = beyond | (slid & stands), np.fmax(relative, np.where(stands, how_far, np.nan))
    filled = ~(_solved(a, at_a, a.axes) & _solved(b, at_b, a.axes))
    beyond, relative = beyond & ~(other | filled), np.where(filled, np.nan, relative)
    rank = np.where(other, np.inf, np.where(beyond, np.minimum(relative, 1e300), -1.0)).ravel()
    order = np.argsort(-rank, kind="stable")[:most]
    worst: list[tuple[str, str]] = []
    changes: dict[str, int] = {}
    if flags is not None:
        pairs, counts = np.unique(np.stack([flags_a[other], flags_b[other]]), axis=1, return_counts=True)
        for i in np.argsort(-counts, kind="stable"):
            changes[f"{words_of[int(pairs[0, i])]} -> {words_of[int(pairs[1, i])]}"] = int(counts[i])
    shown = SI if si else units_of(a)
    for flat in order[rank[order] >= 0.0]:
        at = np.unravel_index(int(flat), shape)
        words = []
        if flags is not None and other[at]:
            words.append(f"{words_of[int(flags_a[at])]} -> {words_of[int(flags_b[at])]}")
        if quantity:
            words.append(_from_to(a, quantity, float(peak_a[at]), float(peak_b[at]), shown))
        if slides is not None and slid[at]:
            words.append(f"slide {slides[0][at]:.9g} -> {slides[1][at]:.9g} m")
        rows = [rows[i] for rows, i in zip(at_a, at, strict=True)]
        worst.append((place(a, a.axes, rows, shown), ", ".join(words)))
    finite = relative[np.isfinite(relative)]
    return Difference(
        points=points,
        only_a=int(np.prod(a.shape, dtype=np.int64)) - points,
        only_b=int(np.prod(b.shape, dtype=np.int64)) - points,
        filled=int(filled.sum()),
        outcomes=int(other.sum()),
        peaks=int(beyond.sum()),
        largest=float(finite.max()) if finite.size else np.nan,
        median=float(np.median(finite)) if finite.size else np.nan,
        worst=tuple(worst),
        paired=paired,
        quantity=quantity,
        changes=changes,
    )


def _apart(
    x: NDArray[Any], y: NDArray[Any], rtol: float, atol: float, slack: NDArray[Any] | float = 0.0
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Where values do not agree, and relative differences: inf where one alone is finite, NaN where neither is."""
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = np.maximum(np.abs(x), np.abs(y))
        apart = np.abs(y - x)
        agree = (apart <= atol + rtol * scale + slack) | (x == y) | (np.isnan(x) & np.isnan(y))
        relative = np.where(scale <= atol, 0.0, apart / scale)
        return ~agree, np.where(agree | np.isfinite(relative), relative, np.inf)


_Flags = tuple[Mapping[int, str], NDArray[Any], NDArray[Any]]
"""Words of flags, and those of two datasets."""

_Peaks = tuple[NDArray[Any], NDArray[Any] | float]
"""Values of a dataset, and how far each may be off by itself."""


def _compared(
    a: Contents, b: Contents, at_a: list[NDArray[np.int64]], at_b: list[NDArray[np.int64]]
) -> tuple[str, _Flags | None, _Peaks, _Peaks]:
    """What is compared as peaks ("": nothing), flags, and the values of both; flags None where not both have them."""
    nothing: _Peaks = (np.empty(0), 0.0)
    flags: _Flags | None = None
    if OUTCOME in a.fields and OUTCOME in b.fields:
        flags = OUTCOMES, _picked(a, OUTCOME, at_a), _picked(b, OUTCOME, at_b, a.axes)
    if PEAK in a.fields and PEAK in b.fields:
        return PEAK, flags, (_picked(a, PEAK, at_a), 0.0), (_picked(b, PEAK, at_b, a.axes), 0.0)
    if flags is not None:
        return "", flags, nothing, nothing
    found = [[name for name in x.fields if name.endswith(FOUND)] for x in (a, b)]
    both = [name for name in found[0] if name in found[1]]
    if not both:
        of_one = any(found) or any(name in x.fields for name in (OUTCOME, PEAK) for x in (a, b))
        raise (StudyError if of_one else NothingToCompareError)(
            f"neither {OUTCOME} nor {PEAK} is in both datasets, nor what a search found ({_or_none(found[0])} in the "
            f"first, {_or_none(found[1])} in the second)"
        )
    of_a, of_b = (_thresholds(x, both[0], at, a.axes) for x, at in ((a, at_a), (b, at_b)))
    flags = STATES, of_a.state, of_b.state
    return both[0], flags, (of_a.value, _width(of_a)), (of_b.value, _width(of_b))


def _or_none(names: list[str]) -> str:
    return ", ".join(names) or "none"


def _thresholds(contents: Contents, name: str, at: list[NDArray[np.int64]], order: tuple[str, ...]) -> Thresholds:
    return Thresholds.read(name, lambda one: _picked(contents, one, at, order) if one in contents.fields else None)


def _width(found: Thresholds) -> NDArray[np.float64]:
    with np.errstate(invalid="ignore"):
        return np.where(found.state == IN_RANGE, found.high - found.low, 0.0)


def _from_to(contents: Contents, quantity: str, before: float, after: float, units: Units) -> str:
    """`peak 0.5 -> 0.6`, or a threshold in the units it is shown in."""
    if quantity == PEAK:
        return f"peak {before:.9g} -> {after:.9g}"
    attrs = contents.fields[quantity].attrs
    divisor, unit = units.of(str(attrs.get("units", "1")), axis_path(attrs, ""))
    return f"{quantity} {before / divisor:.9g} -> {after / divisor:.9g}{unit_words(unit)}"


def _paired(a: Contents, b: Contents) -> dict[str, str]:
    """Axes that only a has -> axes that only b has, by their labels.

    Raises:
        StudyError: an axis has none, or several; or one of numbers, which both have, is of another key in each.
    """
    for axis in a.axes:
        keys = [_key(x, axis) for x in (a, b) if axis in x.axes and x.values(axis).dtype.kind == "f"]
        if len({*keys}) == 2 and not any(key.startswith("let.") for key in keys):  # a symbol may stand for any key
            raise StudyError(f"the axis {axis} is {keys[0]} in the first and {keys[1]} in the second dataset")
    only_a, only_b = ([axis for axis in x.axes if axis not in y.axes] for x, y in ((a, b), (b, a)))
    alike = {axis: [other for other in only_b if _same_labels(a.values(axis), b.values(other))] for axis in only_a}
    pairs = {axis: others[0] for axis, others in alike.items() if len(others) == 1}
    if len({*pairs.values()}) == len(only_a) == len(only_b):
        return pairs
    one, two = (", ".join(_said(x, axis) for axis in only) or "none" for x, only in ((a, only_a), (b, only_b)))
    raise StudyError(
        f"the datasets have other axes: {one} in the first, {two} in the second; have both studies vary the same keys, "
        "or give settings by name and settings of a table the same labels"
    )


def _key(contents: Contents, axis: str) -> str:
    """What an axis varies, however the study writes it."""
    path = axis_path(contents.fields[axis].attrs, axis)
    return ".".join(resolve(path)) if is_path(path) else path


def _same_labels(x: NDArray[Any], y: NDArray[Any]) -> bool:
    return x.dtype.kind != "f" and y.dtype.kind != "f" and set(x) == set(y)


def _renamed(contents: Contents, names: dict[str, str]) -> Contents:
    """The outcomes and peaks of a dataset, some of its axes called otherwise."""
    axes = tuple(names.get(axis, axis) for axis in contents.axes)
    fields = {
        names.get(name, name): replace(item, dims=tuple(names.get(dim, dim) for dim in item.dims))
        for name, item in contents.fields.items()
        if name in (*contents.axes, OUTCOME, PEAK, SLIDE, "solved") or FOUND in name
    }
    return Contents(axes, fields, contents.attrs)


def _said(contents: Contents, axis: str) -> str:
    """`block ('low', 'high')`: an axis with its first coordinates."""
    values = contents.values(axis)
    words = [
        repr(v) if isinstance(v, str) else coordinate(contents, axis, v, units_of(contents))
        for v in values[:_COORDINATES]
    ]
    return f"{axis} ({', '.join(words)}{', ...' if len(values) > _COORDINATES else ''})"


def _shared(a: Contents, b: Contents) -> tuple[list[NDArray[np.int64]], list[NDArray[np.int64]]]:
    """For every axis of a: places in a and in b of the coordinates that both have."""
    places = [_common(a.values(axis), b.values(axis)) for axis in a.axes]
    return [p[0] for p in places], [p[1] for p in places]


def _common(x: NDArray[Any], y: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    if (x.dtype.kind == "f") != (y.dtype.kind == "f"):
        nothing = np.empty(0, dtype=np.int64)
        return nothing, nothing
    if x.dtype.kind == "f":
        order = np.argsort(y)
        after = np.searchsorted(y[order], x)
        near = np.stack([order[np.clip(after - 1, 0, len(y) - 1)], order[np.clip(after, 0, len(y) - 1)]])
        best = np.where(np.abs(y[near[0]] - x) <= np.abs(y[near[1]] - x), near[0], near[1])
        matched = np.abs(y[best] - x) <= MATCH * np.maximum(np.abs(x), np.abs(y[best]))
    else:
        place = {label: i for i, label in enumerate(y)}
        best = np.array([place.get(label, -1) for label in x], dtype=np.int64)
        matched = best >= 0
    rows = np.flatnonzero(matched)
    return rows, best[rows]


def _solved(contents: Contents, at: list[NDArray[np.int64]], order: tuple[str, ...]) -> NDArray[np.bool_]:
    """Which of the shared points were solved; a refined map fills in the outcomes of the others."""
    if "solved" not in contents.fields:
        return np.ones([len(rows) for rows in at], dtype=bool)
    return np.asarray(_picked(contents, "solved", at, order) != 0)


def _picked(
    contents: Contents, name: str, at: list[NDArray[np.int64]], order: tuple[str, ...] | None = None
) -> NDArray[Any]:
    """Values at the shared points, the axes in the order given."""
    values = contents.over_axes(name)
    if order is not None:
        values = values.transpose([contents.axes.index(axis) for axis in order])
    return values[np.ix_(*at)] if at else values
