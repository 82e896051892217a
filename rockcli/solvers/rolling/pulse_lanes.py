"""Bodies that roll in the lanes of pulses: which of them, and what `kernels.lanes.pulses.march` is given."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels.rigid import parameters as rigid
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.scene.batch import Batch
from rockcli.solvers.event import pulse_lanes
from rockcli.solvers.event.pulse_lanes import METHOD, METHOD_ON_PATH, in_lanes, path_asked

Array = NDArray[np.float64]


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes, whatever the number of cases."""
    return pulse_lanes.asked(batch) or (bool(kernels.compiled) and path_asked(batch))


def method(batch: Batch) -> str:
    """What is said of how a batch was solved."""
    return METHOD_ON_PATH if path_asked(batch) else METHOD


def fit(batch: Batch, pars: Array, bodies: Array) -> NDArray[np.bool_]:
    """Which rows (n, N_PAR) the lanes take, (n,): bodies that stand, without friction, whose report ends by itself."""
    if not asked(batch):
        return np.zeros(len(pars), dtype=bool)
    return stands_free(batch, pars)


def stands_free(batch: Batch, pars: Array) -> NDArray[np.bool_]:
    """Which rows (n, N_PAR) are of bodies that stand, without friction, whose report ends by itself, (n,)."""
    stands = (pars[:, at.THETA_0] == 0.0) & (pars[:, at.THETA_DOT_0] == 0.0)
    return np.asarray(stands & (pars[:, at.HAS_DURATION] == 0.0) & np.isnan(batch.block.mu))


def run(lanes: ModuleType, batch: Batch, pars: Array, bodies: Array, how: Any, cases: NDArray[np.int64]) -> Array:
    """Raw results for those rows of `pars`, columns as in `kernels.rolling.results`.

    `how`: `Settings` of the single-body kernels.  NaN in STATUS for a body that is left to `kernels.rolling`.
    """
    rows = on_the_stand(pars[cases], bodies)
    path = path_asked(batch)
    found = in_lanes(lanes, batch, rows, how, cases, bodies, path=path)
    never = np.isnan(found[:, to.T_UPLIFT])
    found[never, also.FACET] = bodies[rows[never, rigid.N_PAR].astype(int), at.STANDING]
    return found


def on_the_stand(pars: Array, bodies: Array) -> Array:
    """Rows of `kernels.rigid.parameters` of the facet on which each body stands, and the row of the body."""
    body = pars[:, at.BODY].astype(int) if len(bodies) > 1 else np.zeros(1, dtype=int)
    rows = np.zeros((len(pars), rigid.N_PAR + 1))
    rows[:, rigid.G], rows[:, rigid.N_PAR] = pars[:, at.G], pars[:, at.BODY]
    for name in ("THETA_0", "THETA_DOT_0", "T_MOTION", "T_STOP", "HAS_DURATION", "FACTOR_H", "FACTOR_V"):
        rows[:, getattr(rigid, name)] = pars[:, getattr(at, name)]
    first = at.FIRST + bodies[body, at.STANDING].astype(int) * at.FACET
    for edge, place in ((rigid.LEFT, at.LEFT), (rigid.RIGHT, at.RIGHT)):
        sine, cosine, alpha, p2, radius, eta = (
            bodies[body, first + place + column] for column in (at.SIN, at.COS, at.ALPHA, at.P2, at.RADIUS, at.ETA)
        )
        for column, values in (
            (rigid.P2, pars[:, at.G] * p2), (rigid.ALPHA, alpha), (rigid.RS, -cosine), (rigid.RC, sine),
            (rigid.FC, cosine), (rigid.FS, sine), (rigid.THRESHOLD, sine / cosine), (rigid.Q_STAR, alpha),
            (rigid.SLOPE, 1.0), (rigid.ETA, eta), (rigid.RADIUS, radius),
        ):  # fmt: skip
            rows[:, edge + column] = values
    return rows
