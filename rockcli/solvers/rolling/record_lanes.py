"""Bodies that roll in the lanes of records: which of them, and what `kernels.lanes.records.march` is given."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.lanes.records import facets as on
from rockcli.kernels.rigid import parameters as rigid
from rockcli.kernels.rolling import parameters as at
from rockcli.scene.batch import Batch
from rockcli.solvers.event import record_lanes
from rockcli.solvers.event.record_lanes import METHOD as METHOD
from rockcli.solvers.event.unpack import FORCES
from rockcli.solvers.rolling.pulse_lanes import on_the_stand, stands_free

Array = NDArray[np.float64]

NOT_TOLD = frozenset({*FORCES, "mu_impact"})
"""Scalars that the lanes of records find of bodies on two edges, but not of these."""


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes, whatever the number of cases."""
    return record_lanes.asked(batch) and not batch.save.scalars & NOT_TOLD


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
    body = standing[:, rigid.N_PAR].astype(int)
    facet = bodies[body, at.STANDING]
    first = at.FIRST + facet.astype(int) * at.FACET
    for column, values in (
        (on.BODY, body), (on.FACET, facet), (on.TILT, bodies[body, first + at.TILT]),
        (on.EXTENT_LEFT, bodies[body, first + at.LEFT + at.EXTENT]),
        (on.EXTENT_RIGHT, bodies[body, first + at.RIGHT + at.EXTENT]),
        (on.FALL_LEFT, bodies[body, at.FALL_LEFT]), (on.FALL_RIGHT, bodies[body, at.FALL_RIGHT]),
        (on.SCALE, bodies[body, at.SCALE]),
    ):  # fmt: skip
        rows[:, column] = values
    return record_lanes.run(lanes, batch, rows, how, cases=cases, bodies=bodies)
