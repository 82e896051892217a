"""Boundaries between outcomes of a refined map, as curves.

A curve runs half-way between neighbouring pixels of which one is on either side; it is open where it leaves the map or
meets a pixel of neither side, and closed, its last point its first, round an island. Across a band one pixel wide, with
pixels of neither side beside it, it is one point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.response import NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING, overturned
from rockcli.scene.variables import BOUNDARY_POINT
from rockcli.storage.contents import Contents, Field, text
from rockcli.study.study import Study

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

KINDS = ("uplift", "overturning", "overturning_after_impact")
"""Rocks or does not; overturns or does not; overturns after an impact or without."""

KIND, CURVE = "boundary", "boundary_curve"


def with_boundaries(contents: Contents, study: Study) -> Contents:
    """Add the boundary curves of a refined map, point by point: `boundary`, `boundary_curve`, `boundary_<axis>`.

    Points of a curve follow one another; `boundary_curve` counts curves, over all maps of the study, from 0.
    """
    names = {KIND, CURVE, *(f"boundary_{axis}" for axis in contents.axes)}
    fields = {name: item for name, item in contents.fields.items() if name not in names}
    if study.refine:
        fields |= _fields(contents, study.refine)
    return Contents(contents.axes, fields, contents.attrs)


def _fields(contents: Contents, plane: tuple[str, ...]) -> dict[str, Field]:
    axes = contents.axes
    at = tuple(axes.index(name) for name in plane)
    outcome = np.moveaxis(contents.values("outcome"), at, (-2, -1))
    y, x = (contents.values(name) for name in plane)
    others = [name for name in axes if name not in plane]
    columns: dict[str, list[NDArray[np.float64]]] = {name: [] for name in axes}
    kinds: list[Index] = []
    number: list[Index] = []
    for place in np.ndindex(*outcome.shape[:-2]):
        for kind in range(len(KINDS)):
            for rows, cols in curves_of(outcome[place], kind):
                columns[plane[0]].append(_between(y, rows))
                columns[plane[1]].append(_between(x, cols))
                for name, i in zip(others, place, strict=True):
                    columns[name].append(np.full(len(rows), float(i)))
                kinds.append(np.full(len(rows), kind))
                number.append(np.full(len(rows), len(number)))
    flags = {"flag_values": np.arange(len(KINDS), dtype=np.int8), "flag_meanings": " ".join(KINDS)}
    said = "what changes at the curve: whether it rocks, overturns, overturns after an impact"
    found = {
        KIND: Field((BOUNDARY_POINT,), _joined(kinds).astype(np.int8), {"long_name": said, **flags}),
        CURVE: Field((BOUNDARY_POINT,), _joined(number).astype(np.int32), {"long_name": "number of the curve"}),
    }
    for name in axes:
        values, of = _joined(columns[name]), contents.fields[name]
        if name in others:  # the point of the axis whose map it is
            chosen = of.values[values.astype(np.int64)]
            values = text([str(v) for v in chosen]) if of.is_text else chosen
        found[f"boundary_{name}"] = Field((BOUNDARY_POINT,), values, dict(of.attrs))
    return found


def _joined(parts: list[NDArray[np.float64]] | list[Index]) -> Array:
    return np.concatenate(parts).astype(float) if parts else np.empty(0)


def _between(values: Array, places: Array) -> Array:
    """Values of an axis at places on it, half-way between two the mean of them."""
    low = np.floor(places).astype(np.int64)
    return np.asarray(0.5 * (values[low] + values[np.ceil(places).astype(np.int64)]))


def curves_of(outcome: NDArray[np.int8], kind: int) -> list[tuple[Array, Array]]:
    """Curves (rows, columns) of one of `KINDS` over a map (n, m), in pixels, each point half-way between two."""
    if KINDS[kind] == "uplift":
        known, inside = outcome >= NO_UPLIFT, (outcome == ROCKING) | overturned(outcome)
    elif KINDS[kind] == "overturning":
        known, inside = outcome >= NO_UPLIFT, overturned(outcome)
    else:
        known, inside = overturned(outcome), outcome == OVERTURNED_AFTER_IMPACT
    return _chained(_segments(known, inside), outcome.shape[0] * outcome.shape[1], outcome.shape[1])


def _segments(known: Mask, inside: Mask) -> Index:
    """Pairs of crossings, (k, 2): of pixels p and p + 1 the crossing is p, of p and p + m it is n m + p.

    One that no other is beside is a pair with itself.
    """
    n, m = inside.shape
    across = (inside[:, 1:] != inside[:, :-1]) & known[:, 1:] & known[:, :-1]
    down = (inside[1:] != inside[:-1]) & known[1:] & known[:-1]
    sides = (across[:-1], down[:, 1:], across[1:], down[:, :-1])  # top, right, bottom, left of a cell
    row, column = np.nonzero(sides[0] | sides[1] | sides[2] | sides[3])
    p = row * m + column
    names = np.array([p, n * m + p + 1, p + m, n * m + p])
    met = np.array([side[row, column] for side in sides])
    count = met.sum(axis=0)
    # of two or three, those that come first; of four, so that the corner pixels that are inside stay apart
    order = np.argsort(~met, axis=0, kind="stable")
    first = np.take_along_axis(names, order[:2], axis=0)[:, (count == 2) | (count == 3)].T
    four, corner = count == 4, inside[row, column]
    top, right, bottom, left = names
    apart, other = four & corner, four & ~corner
    pairs = [
        first,
        np.column_stack([top, left])[apart], np.column_stack([bottom, right])[apart],
        np.column_stack([top, right])[other], np.column_stack([bottom, left])[other],
    ]  # fmt: skip
    found = np.concatenate(pairs).astype(np.int64)
    every = [k * n * m + np.ravel_multi_index(np.nonzero(met), (n, m)) for k, met in enumerate((across, down))]
    alone = np.setdiff1d(np.concatenate(every), found)
    return np.concatenate([found, np.column_stack([alone, alone])])


def _chained(segments: Index, across: int, m: int) -> list[tuple[Array, Array]]:
    """Curves made of segments that share crossings, open ones first."""
    crossings, ends = np.unique(segments, return_inverse=True)
    beside: list[list[int]] = [[] for _ in crossings]
    for one, other in ends.reshape(-1, 2).tolist():
        beside[one].append(other)
        beside[other].append(one)
    left = [True] * len(beside)
    curves = []
    for begin in [*(i for i, near in enumerate(beside) if len(near) == 1), *range(len(beside))]:
        if not left[begin]:
            continue
        curve, here = [], begin
        while left[here]:
            left[here] = False
            curve.append(here)
            here = next((i for i in beside[here] if left[i]), here)
        if len(beside[begin]) == 2 and begin in beside[curve[-1]] and len(curve) > 2:
            curve.append(begin)
        names = crossings[curve]
        flat, vertical = names % across, names >= across
        curves.append((flat // m + 0.5 * vertical, flat % m + 0.5 * ~vertical))
    return curves
