"""Bodies that roll in the lanes of records: which of them, and what `kernels.lanes.records.march` is given."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.lanes.records import facets as on
from rockcli.kernels.rigid import parameters as rigid
from rockcli.scene.batch import Batch
from rockcli.solvers.event import record_lanes
from rockcli.solvers.event.record_lanes import METHOD
from rockcli.solvers.rolling.pulse_lanes import on_the_stand, stands_free

Array = NDArray[np.float64]


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes, under a horizontal record alone."""
    return batch.excitation.vertical is None and record_lanes.asked(batch)


def method(_: Batch) -> str:
    """What is said of how a batch was solved."""
    return METHOD


def fit(batch: Batch, pars: Array, bodies: Array) -> NDArray[np.bool_]:
    """Which rows (n, N_PAR) the lanes take, (n,): bodies that stand, without friction, whose report ends by itself.

    Not those that a sample grazes, nor those that are held by one of their ends alone.
    """
    if not asked(batch):
        return np.zeros(len(pars), dtype=bool)
    rows = on_the_stand(pars, bodies)
    held = stands_free(batch, pars) & ~record_lanes.grazed(batch, rows)
    for edge in (rigid.LEFT, rigid.RIGHT):
        held &= rows[:, edge + rigid.THRESHOLD] > 0.0
    return held


def run(lanes: ModuleType, batch: Batch, pars: Array, bodies: Array, how: Any, cases: NDArray[np.int64]) -> Array:
    """Raw results for those rows of `pars`, columns as in `kernels.rolling.results`.

    `how`: `Settings` of the single-body kernels.  NaN in STATUS for a body that is left to `kernels.rolling`.
    """
    standing = on_the_stand(pars[cases], bodies)
    rows = np.zeros((len(cases), on.N_ROLLING))
    rows[:, : rigid.N_PAR] = standing[:, : rigid.N_PAR]
    rows[:, on.BODY] = standing[:, rigid.N_PAR]  # the kernel writes the rest of the row
    path = "mu_impact" in batch.save.scalars
    return record_lanes.run(lanes, batch, rows, how, cases=cases, path=path, bodies=bodies)
