"""The lowest value of a searched range at which a case overturns (`find: overturning`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.search.trials import Trials, Tried
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.executors import answers
from rockcli.engine.sweep.sweep import Sweep, outlook
from rockcli.scene.response import NO_UPLIFT, ROCKING, overturned
from rockcli.scene.thresholds import BELOW, BRACKETED, IN_RANGE, NONE, Thresholds
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]
Outcomes = NDArray[np.int8]

RESOLUTION = 1e-6
"""Width of the final bracket, relative to its upper end."""


def find_overturning(study: Study, sweep: Sweep) -> tuple[Thresholds, dict[str, Index]]:
    """The lowest value of the searched range at which each of the flat cases overturns, (n,).

    The range is scanned at its points, from the lowest up whichever way it is written.  Where the case remains stable
    up to a point and overturns at the next, the two are bisected until they are closer than RESOLUTION.  A point
    without an answer, be it of the scan or of the bisection, ends the search: the value lies between the last stable
    point before it and the lowest one known to overturn.

    Beside that, sentence -> cases of which a trial failed.

    Raises:
        StudyError: a solver cannot do what the study asks for.
        OutputError: what is finished cannot be kept.
        MachineError: the machine refused what a trial needs.
    """
    assert study.search is not None
    points = np.sort(np.asarray(study.search.axis.values, dtype=float))
    n, m = study.size, len(points)
    widest = float(np.max(np.diff(points), initial=0.0)) or 1.0
    steps = m + max(int(np.ceil(np.log2(widest / (RESOLUTION * _scale(points))))), 0) + 1
    estimate, compiled = outlook(study, n * m)
    pace = Pace(estimate)
    done = 0.0
    tried = Tried(n, sweep)

    def outcomes_of(trials: Trials) -> Outcomes:
        nonlocal done
        outcomes, known = tried.before(trials)
        done += known.sum() / n
        for rows, answer in answers(trials.work(compiled), Chunks(trials.size, ~known), pace, sweep.team):
            outcomes[answer.cases] = answer.scalars["outcome"]
            tried.keep(trials, answer)
            done += len(rows) / n
            if sweep.progress is not None:
                sweep.progress(min(int(done), steps), steps)
        tried.close(trials)
        return outcomes

    scan = Trials(study, np.arange(n), np.broadcast_to(points[:, None], (m, n)))
    found = thresholds_of(points, outcomes_of(scan).reshape(m, n).T)
    return _bisected(found, lambda cases, values: outcomes_of(Trials(study, cases, values[None]))), tried.failed


def thresholds_of(points: Array, scanned: Outcomes) -> Thresholds:
    """What a scan of ascending points (m,) shows of cases, (n, m)."""
    m = len(points)
    edges = np.concatenate([[-np.inf], points, [np.inf]])
    fall, unknown = _first(overturned(scanned)), _first(scanned < NO_UPLIFT)
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
        rocks_at_lowest=(scanned[:, 0] == ROCKING).astype(np.int8),
    )


def _stands(outcomes: Outcomes) -> NDArray[np.bool_]:
    return np.asarray((outcomes >= NO_UPLIFT) & ~overturned(outcomes))


def _first(where: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Place of the first True of every row, (n,); the length of the row without one."""
    return np.asarray(np.where(where.any(axis=1), np.argmax(where, axis=1), where.shape[1]))


def _bisected(found: Thresholds, outcomes_of: Callable[[Index, Array], Outcomes]) -> Thresholds:
    """The brackets of what lies in the range closed; `outcomes_of(cases, values)` tries a value for each case."""
    state, low, high = found.state.copy(), found.low.copy(), found.high.copy()
    active = np.flatnonzero(state == IN_RANGE)
    while len(active := active[high[active] - low[active] > RESOLUTION * np.abs(high[active])]):
        middle = 0.5 * (low[active] + high[active])
        outcomes = outcomes_of(active, middle)
        falls, unknown = overturned(outcomes), outcomes < NO_UPLIFT
        high[active[falls]] = middle[falls]
        low[active[_stands(outcomes)]] = middle[_stands(outcomes)]
        state[active[unknown]] = BRACKETED
        active = active[~unknown]
    return replace(found, state=state, low=low, high=high)


def _scale(points: Array) -> float:
    largest = float(np.max(np.abs(points)))
    return largest if largest > 0.0 else 1.0
