"""The ground's acceleration at the output times."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.excitation import acceleration

Array = NDArray[np.float64]


def ground_of_case(batch: Batch, case: int, t: Array) -> tuple[Array, Array]:
    """Horizontal and vertical acceleration of one case at times t (k,) [s], zero after its duration: (k,) [m/s^2]."""
    over = t > batch.excitation.duration[case]
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    a_g, a_v = (np.where(over, 0.0, acceleration(channel, t, case)) for channel in channels)
    return a_g, a_v


def ground_history(batch: Batch, t: Array, live: NDArray[np.bool_], cases: Iterable[int] | None = None) -> Array:
    """a_g and a_v of all, or some, cases at times t (k,) [s], NaN where `live` (n, k) is not so: (2, n, k) [m/s^2]."""
    rows = range(batch.size) if cases is None else cases
    shaken = [ground_of_case(batch, int(case), t) for case in rows]
    return np.where(live, np.array(shaken).transpose(1, 0, 2), np.nan)
