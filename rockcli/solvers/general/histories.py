"""From the diaries of a batch to its histories and impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.solvers.event.unpack import Raw
from rockcli.solvers.event.unpack import histories_of as named
from rockcli.solvers.general.diary import Diary

Array = NDArray[np.float64]


def histories_of(batch: Batch, diaries: list[Diary]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories by name (n, k), impacts by name (n, j), and the output times (k,) [s]; NaN-padded."""
    raw = Raw(batch.size, max(len(d.theta) for d in diaries), max(len(d.impacts) for d in diaries))
    for i, diary in enumerate(diaries):
        raw.histories[i, 0, : diary.written] = diary.theta[: diary.written]
        raw.histories[i, 1, : diary.written] = diary.rate[: diary.written]
        for k, impact in enumerate(diary.impacts):
            raw.impacts[i, :, k] = impact
    return named(batch, raw)
