"""From the trajectories of a batch to its histories and impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.solvers.event.unpack import Raw
from rockcli.solvers.event.unpack import histories_of as named
from rockcli.solvers.general.trajectory import Trajectory

Array = NDArray[np.float64]


def histories_of(batch: Batch, trajectories: list[Trajectory]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories by name (n, k), impacts by name (n, j), and the output times (k,) [s]; NaN-padded."""
    raw = Raw(batch.size, max(len(d.theta) for d in trajectories), max(len(d.impacts) for d in trajectories))
    for i, trajectory in enumerate(trajectories):
        raw.histories[i, 0, : trajectory.written] = trajectory.theta[: trajectory.written]
        raw.histories[i, 1, : trajectory.written] = trajectory.rate[: trajectory.written]
        for k, impact in enumerate(trajectory.impacts):
            raw.impacts[i, :, k] = impact
    return named(batch, raw)
