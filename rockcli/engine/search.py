"""The lowest value of a searched range at which a case overturns (`find: overturning`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.engine.agenda import Agenda, Pace
from rockcli.engine.apart import build_apart, solve_apart
from rockcli.engine.executors import Team, answers
from rockcli.engine.sweep import Progress, outlook
from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]

RESOLUTION = 1e-6
"""Width of the final bracket, relative to its upper end."""

STANDS, FALLS, UNKNOWN = 0, 1, -1


def find_overturning(study: Study, progress: Progress | None = None, team: Team | None = None) -> Array:
    """Value of the searched range at the lowest change from standing to overturned, over the flat cases, (n,).

    The range is scanned at its points and the lowest change bisected until the bracket is narrower than RESOLUTION;
    the upper end is reported, where the case overturns.  inf: it overturns at no scanned point; NaN: it overturns at
    the first one already, or a solution failed or was unresolved on the way.
    """
    assert study.search is not None
    points = np.asarray(study.search.axis.values, dtype=float)
    n, m = study.size, len(points)
    steps = m + int(np.ceil(np.log2(max(np.max(np.abs(np.diff(points))), 1e-300) / (RESOLUTION * _scale(points))))) + 1
    estimate, compiled = outlook(study, n * m)
    pace = Pace(estimate)
    done = 0.0

    def outcomes(trials: Trials) -> NDArray[np.int8]:
        nonlocal done
        found = np.full(trials.size, UNKNOWN, dtype=np.int8)
        for rows, verdicts in answers(trials, Agenda(trials.size), pace, team or Team()):
            found[rows] = verdicts
            done += len(rows) / n
            if progress is not None:
                progress(min(int(done), steps), steps)
        return found

    everyone = np.arange(n)
    scanned = outcomes(Trials(study, everyone, np.broadcast_to(points[:, None], (m, n)), compiled)).reshape(m, n).T
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
        outcome = outcomes(Trials(study, active, middle[None], compiled))
        hi[active[outcome == FALLS]] = middle[outcome == FALLS]
        lo[active[outcome == STANDS]] = middle[outcome == STANDS]
        lost = active[outcome == UNKNOWN]
        has[lost] = False
        found[lost] = np.nan
        active = active[outcome != UNKNOWN]
    found[has] = hi[has]
    return found


@dataclass(frozen=True, eq=False)
class Trials:
    """Cases (k,) of a study, each at m values of the searched range, (m, k): row r is case r % k at its value r // k.

    `executors.Work`: the answer of some rows is STANDS, FALLS or UNKNOWN for each.
    """

    study: Study
    cases: Index
    values: Array
    compiled: bool

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.values.size

    def __call__(self, cases: Index) -> NDArray[np.int8]:
        """What becomes of some rows.

        Raises:
            StudyError: a solver cannot do what the study asks for.
        """
        if self.compiled:
            kernels.load(compile_them=True)
        found = self.lost(cases, "")
        with np.errstate(all="ignore"):
            for rows, batch in build_apart(self._built, cases):
                if not isinstance(batch, str):
                    for part, response in solve_apart(self._built, rows, batch):
                        if not isinstance(response, str):
                            found[np.searchsorted(cases, part)] = _verdict(response.scalars["outcome"])
        return found

    def lost(self, cases: Index, why: str) -> NDArray[np.int8]:
        """UNKNOWN."""
        return np.full(len(cases), UNKNOWN, dtype=np.int8)

    def _built(self, rows: Index) -> Iterator[tuple[Index, Batch]]:
        assert self.study.search is not None
        k = len(self.cases)
        for local, batch in self.study.search.at(self.cases[rows % k], self.values[rows // k, rows % k]):
            yield rows[local], batch


def _scale(points: Array) -> float:
    largest = float(np.max(np.abs(points)))
    return largest if largest > 0.0 else 1.0


def _verdict(outcome: NDArray[np.generic]) -> NDArray[np.int8]:
    flags = np.asarray(outcome, dtype=np.int8)
    falls = flags >= OVERTURNED_WITHOUT_IMPACT
    return np.where(falls, FALLS, np.where(flags >= NO_UPLIFT, STANDS, UNKNOWN)).astype(np.int8)
