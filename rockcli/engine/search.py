"""The lowest value of a searched range at which a case overturns (`find: overturning`)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.engine.agenda import Agenda, Pace
from rockcli.engine.apart import build_apart, solve_apart
from rockcli.engine.executors import Team, answers
from rockcli.engine.sweep import Progress, outlook
from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, ROCKING, overturned
from rockcli.scene.thresholds import BELOW, BESIDE, BRACKETED, IN_RANGE, NONE, PARTS, SENTENCES, STATES, Thresholds
from rockcli.storage.contents import Contents, Field
from rockcli.study.study import Index, Searched, Study

Array = NDArray[np.float64]
Verdicts = NDArray[np.int8]

RESOLUTION = 1e-6
"""Width of the final bracket, relative to its upper end."""

AT_REST, ROCKS, FALLS, UNKNOWN = 0, 1, 2, -1
"""What a trial comes to; AT_REST: no uplift, or sliding."""


def find_overturning(study: Study, progress: Progress | None = None, team: Team | None = None) -> Thresholds:
    """The lowest value of the searched range at which each of the flat cases overturns, (n,).

    The range is scanned at its points, from the lowest up whichever way it is written.  Where the case remains stable
    up to a point and overturns at the next, the two are bisected until they are closer than RESOLUTION.  A point
    without an answer, be it of the scan or of the bisection, ends the search: the value lies between the last stable
    point before it and the lowest one known to overturn.
    """
    assert study.search is not None
    points = np.sort(np.asarray(study.search.axis.values, dtype=float))
    n, m = study.size, len(points)
    widest = float(np.max(np.diff(points), initial=0.0)) or 1.0
    steps = m + max(int(np.ceil(np.log2(widest / (RESOLUTION * _scale(points))))), 0) + 1
    estimate, compiled = outlook(study, n * m)
    pace = Pace(estimate)
    done = 0.0

    def verdicts_of(trials: Trials) -> Verdicts:
        nonlocal done
        found = np.full(trials.size, UNKNOWN, dtype=np.int8)
        for rows, verdicts in answers(trials, Agenda(trials.size), pace, team or Team()):
            found[rows] = verdicts
            done += len(rows) / n
            if progress is not None:
                progress(min(int(done), steps), steps)
        return found

    scan = Trials(study, np.arange(n), np.broadcast_to(points[:, None], (m, n)), compiled)
    found = thresholds_of(points, verdicts_of(scan).reshape(m, n).T)
    return _bisected(found, lambda cases, values: verdicts_of(Trials(study, cases, values[None], compiled)))


def thresholds_of(points: Array, scanned: Verdicts) -> Thresholds:
    """What a scan of ascending points (m,) shows of cases, (n, m)."""
    m = len(points)
    edges = np.concatenate([[-np.inf], points, [np.inf]])
    fall, unknown = _first(scanned == FALLS), _first(scanned == UNKNOWN)
    state = np.select([unknown < fall, fall == m, fall == 0], [BRACKETED, NONE, BELOW], IN_RANGE)
    above = np.arange(m) > fall[:, None]
    stable = _stands(scanned) & above
    begins = stable & ~np.pad(stable, ((0, 0), (1, 0)))[:, :-1]
    some = stable.any(axis=1)
    first, last = np.argmax(stable, axis=1), m - 1 - np.argmax(stable[:, ::-1], axis=1)
    return Thresholds(
        state.astype(np.int8),
        low=edges[np.minimum(fall, unknown)],
        high=edges[fall + 1],
        islands=begins.sum(axis=1),
        island_low=np.where(some, points[first], np.nan),
        island_high=np.where(some, points[last], np.nan),
        rocks_at_lowest=(scanned[:, 0] == ROCKS).astype(np.int8),
    )


def _stands(verdicts: Verdicts) -> NDArray[np.bool_]:
    return np.asarray((verdicts == AT_REST) | (verdicts == ROCKS))


def _first(where: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Place of the first True of every row, (n,); the length of the row without one."""
    return np.asarray(np.where(where.any(axis=1), np.argmax(where, axis=1), where.shape[1]))


def _bisected(found: Thresholds, verdicts_of: Callable[[Index, Array], Verdicts]) -> Thresholds:
    """The brackets of what lies in the range closed; `verdicts_of(cases, values)` tries a value for each case."""
    state, low, high = found.state.copy(), found.low.copy(), found.high.copy()
    active = np.flatnonzero(state == IN_RANGE)
    while len(active := active[high[active] - low[active] > RESOLUTION * np.abs(high[active])]):
        middle = 0.5 * (low[active] + high[active])
        verdicts = verdicts_of(active, middle)
        high[active[verdicts == FALLS]] = middle[verdicts == FALLS]
        low[active[_stands(verdicts)]] = middle[_stands(verdicts)]
        state[active[verdicts == UNKNOWN]] = BRACKETED
        active = active[verdicts != UNKNOWN]
    return replace(found, state=state, low=low, high=high)


def threshold_fields(
    search: Searched, found: Thresholds, dims: tuple[str, ...], *, end: str = "", before: str = ""
) -> dict[str, Field]:
    """What a search found, or a statistic of it, as variables over `dims`.

    Args:
        search: what was searched.
        found: arrays over `dims`.
        dims: names of the axes.
        end: end of the names of a statistic, such as `p50`; before: the words for it.
    """
    fields = {}
    for part in ("", *PARTS, *(() if found.islands is None else BESIDE)):
        attrs: dict[str, Any] = {"long_name": before + SENTENCES[part].format(search.axis.path)}
        if part == "state":
            attrs |= {"flag_values": np.array(list(STATES), dtype=np.int8), "flag_meanings": " ".join(STATES.values())}
        else:
            attrs["units"] = "1" if part in ("islands", "rocks_at_lowest") else search.axis.unit
        name = "_".join(filter(None, (search.name, part, end)))
        fields[name] = Field(dims, getattr(found, part or "value"), attrs)
    return fields


def found_by(contents: Contents, name: str, end: str = "") -> Thresholds:
    """What a search found for every case, or a statistic of it, from the variable of that name and those beside it."""
    return Thresholds.read(name, lambda one: contents.values(one) if one in contents.fields else None, end)


@dataclass(frozen=True, eq=False)
class Trials:
    """Cases (k,) of a study, each at m values of the searched range, (m, k): row r is case r % k at its value r // k.

    `executors.Work`: the answer of some rows is AT_REST, ROCKS, FALLS or UNKNOWN for each.
    """

    study: Study
    cases: Index
    values: Array
    compiled: bool

    @property
    def size(self) -> int:
        """Number of rows."""
        return self.values.size

    def __call__(self, cases: Index) -> Verdicts:
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

    def lost(self, cases: Index, why: str) -> Verdicts:
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


def _verdict(outcome: NDArray[np.generic]) -> Verdicts:
    flags = np.asarray(outcome, dtype=np.int8)
    verdicts = np.select([flags < NO_UPLIFT, overturned(flags), flags == ROCKING], [UNKNOWN, FALLS, ROCKS], AT_REST)
    return verdicts.astype(np.int8)
