"""Size of the histories of a study, and the limit on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rockcli.errors import StudyError
from rockcli.scene.auto import highest
from rockcli.scene.batch import Batch
from rockcli.scene.counted import counted
from rockcli.scene.laws.models import FLEXIBLE
from rockcli.solvers.common.duration import durations_of
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Study

HISTORIES_AT_MOST = 2 * 1024**3
"""Bytes that the histories of all cases may take together."""

CHUNK_AT_MOST = HISTORIES_AT_MOST // 8
"""Bytes of histories solved at a time; a solver needs several times as many while it works."""

_LOOKED_AT = 4096
"""Cases built at a time to find the longest history."""

_COARSEST = 0.1
"""Output spacing above which none is proposed [s]."""


@dataclass(frozen=True)
class Size:
    """The longest history [s], its number of output times, the number of variables; bytes for all cases together."""

    longest: float
    points: float
    variables: int
    bytes: float


def histories_size(study: Study, enough: float = np.inf) -> Size:
    """Size of the histories of all cases, which share the times of the longest; no farther than `enough` bytes."""
    size = Size(0.0, 0.0, 7, 0.0)
    if not study.histories:
        return size
    for start in range(0, study.size, _LOOKED_AT):
        cases = np.arange(start, min(start + _LOOKED_AT, study.size))
        for _, batch in buildable(study.batches, cases):
            if batch.save.histories:
                longest = max(size.longest, _longest(batch))
                sliding = 4 if np.isfinite(batch.block.mu).any() else 0
                variables = max(size.variables, 8 if highest(batch).model == FLEXIBLE else 7 + sliding)
                points = longest / study.dt_out + 1.0
                size = Size(longest, points, variables, study.size * points * variables * 8.0)
            if size.bytes > enough:
                return size
    return size


def check_histories(study: Study) -> None:
    """`StudyError` if the histories would not fit."""
    with np.errstate(all="ignore"):
        size = histories_size(study, HISTORIES_AT_MOST)
    if not size.bytes <= HISTORIES_AT_MOST:
        cases = counted(study.size, "case")
        raise StudyError(
            f"histories would take {size.bytes / 1e9:.3g} GB ({cases} x {size.points:.4g} output times x "
            f"{size.variables} variables); at most {HISTORIES_AT_MOST / 1e9:.3g} GB are allowed: "
            + _remedy(study, size),
            file=study.file,
        )


def cases_at_a_time(study: Study, most: int) -> int:
    """Cases whose histories may be solved together."""
    size = histories_size(study)
    return int(np.clip(CHUNK_AT_MOST / max(size.bytes / study.size, 1.0), 1, most))


def _longest(batch: Batch) -> float:
    """Longest time [s] that the cases of a batch may be reported for."""
    return float(np.max(durations_of(batch).report))


def _remedy(study: Study, size: Size) -> str:
    points = HISTORIES_AT_MOST // (study.size * size.variables * 8)
    fits = size.longest / max(points - 1, 1)
    ways = ["set save.histories: false"]
    if fits <= _COARSEST:
        digits = 10.0 ** (np.floor(np.log10(fits)) - 1.0)
        fits = np.ceil(fits / digits) * digits
        ways.insert(0, f"set save.dt_out to {fits:.2g} s or more (it is {study.dt_out:.3g} s)")
    if study.axes:
        ways.append("save those of some cases only (save.histories: {axis: value})")
    return ", or ".join(ways)
