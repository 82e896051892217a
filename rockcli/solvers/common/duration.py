"""How long a case lasts: when its motion ends, when its report ends, and how many output times that makes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DUE
from rockcli.scene.batch import Batch
from rockcli.scene.constants import FREE_ROCKING

Array = NDArray[np.float64]


class Duration(NamedTuple):
    """Of one case.

    Attributes:
        motion: end of the last component of the ground motion, cut off where the report ends [s].
        report: end of the report: the study's duration, else FREE_ROCKING/p after the motion [s].
        given: whether the study gives a duration.
    """

    motion: float
    report: float
    given: bool


class Durations(NamedTuple):
    """Of the cases of a batch, (n,) each; see `Duration`."""

    motion: Array
    report: Array
    given: NDArray[np.bool_]

    def of(self, case: int) -> Duration:
        """Those of one case."""
        return Duration(float(self.motion[case]), float(self.report[case]), bool(self.given[case]))


def durations_of(batch: Batch) -> Durations:
    """When motion and report of every case end; 1/p is that of the slower edge."""
    end = np.zeros(batch.size)
    for channel in (batch.excitation.horizontal, batch.excitation.vertical, batch.excitation.suite):
        if channel is not None:
            end = np.maximum(end, channel.end)
    duration = batch.excitation.duration
    given = np.isfinite(duration)
    end = np.where(given, np.minimum(end, duration), end)
    return Durations(end, np.where(given, duration, end + FREE_ROCKING / np.minimum(*batch.p.T)), given)


def output_times(dt_out: float, stop: float) -> int:
    """How many times i dt_out there are up to `stop` [s], the first 0."""
    return int(np.floor(stop / dt_out * (1.0 + DUE))) + 1
