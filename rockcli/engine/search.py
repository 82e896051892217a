"""The lowest value of a searched range at which a case overturns (`find: overturning`)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.sweep import Progress, solve_apart
from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]

RESOLUTION = 1e-6
"""Width of the final bracket, relative to its upper end."""

CHUNK = 65536
"""Cases solved at a time."""

STANDS, FALLS, UNKNOWN = 0, 1, -1


def find_overturning(study: Study, progress: Progress | None = None) -> Array:
    """Value of the searched range at the lowest change from standing to overturned, over the flat cases, (n,).

    The range is scanned at its points and the lowest change bisected until the bracket is narrower than RESOLUTION;
    the upper end is reported, where the case overturns.  inf: it overturns at no scanned point; NaN: it overturns at
    the first one already, or a solution failed or was unresolved on the way.
    """
    assert study.search is not None
    points = np.asarray(study.search.axis.values, dtype=float)
    n, m = study.size, len(points)
    steps = m + int(np.ceil(np.log2(max(np.max(np.abs(np.diff(points))), 1e-300) / (RESOLUTION * _scale(points))))) + 1
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(min(done, steps), steps)

    scanned = np.empty((n, m), dtype=np.int8)
    everyone = np.arange(n)
    for j in range(m):
        scanned[:, j] = _outcomes(study, everyone, np.full(n, points[j]))
        tick()
    change = (scanned[:, :-1] == STANDS) & (scanned[:, 1:] == FALLS)
    has = change.any(axis=1)
    first = np.argmax(change, axis=1)
    found = np.where((scanned == STANDS).all(axis=1), np.inf, np.nan)
    lo, hi = points[first], points[first + 1]
    active = np.flatnonzero(has)
    while len(active):
        active = active[np.abs(hi[active] - lo[active]) > RESOLUTION * np.abs(hi[active])]
        if not len(active):
            break
        middle = 0.5 * (lo[active] + hi[active])
        outcome = _outcomes(study, active, middle)
        hi[active[outcome == FALLS]] = middle[outcome == FALLS]
        lo[active[outcome == STANDS]] = middle[outcome == STANDS]
        lost = active[outcome == UNKNOWN]
        has[lost] = False
        found[lost] = np.nan
        active = active[outcome != UNKNOWN]
        tick()
    found[has] = hi[has]
    return found


def _scale(points: Array) -> float:
    largest = float(np.max(np.abs(points)))
    return largest if largest > 0.0 else 1.0


def _outcomes(study: Study, indices: Index, values: Array) -> NDArray[np.int8]:
    """STANDS, FALLS or UNKNOWN of the cases at their values, (k,)."""
    assert study.search is not None
    outcomes = np.full(len(indices), UNKNOWN, dtype=np.int8)
    for start in range(0, len(indices), CHUNK):
        cases, at = indices[start : start + CHUNK], values[start : start + CHUNK]

        def build(rows: Index, cases: Index = cases, at: Array = at) -> Iterator[tuple[Index, Batch]]:
            assert study.search is not None
            for local, batch in study.search.at(cases[rows], at[rows]):
                yield rows[local], batch

        for rows, batch in build(np.arange(len(cases))):
            for part, response in solve_apart(build, rows, batch):
                if not isinstance(response, str):
                    outcomes[start + part] = _verdict(response.scalars["outcome"])
    return outcomes


def _verdict(outcome: NDArray[np.generic]) -> NDArray[np.int8]:
    flags = np.asarray(outcome, dtype=np.int8)
    falls = flags >= OVERTURNED_WITHOUT_IMPACT
    return np.where(falls, FALLS, np.where(flags >= NO_UPLIFT, STANDS, UNKNOWN)).astype(np.int8)
