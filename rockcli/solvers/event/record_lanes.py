"""Record maps in lanes: which bodies `kernels.lanes.records.march` takes, and what it is given (docs/sweeps.md)."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import LEFT_TO_MARCH
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Samples
from rockcli.scene.variables import (
    SCALARS_ASYMMETRIC,
    SCALARS_AUTO,
    SCALARS_FEMA,
    SCALARS_FLEXIBLE,
    SCALARS_SLIDING,
)
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.event.pulse_lanes import FINEST
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]

METHOD = "Taylor series of order 8 from sample to sample, many bodies in lanes, events located on the polynomial"

WITHIN = frozenset(
    {
        "outcome", "theta_peak", "theta_peak_over_alpha", "u_top_peak", "t_peak", "t_uplift", "t_overturn", "t_end",
        "n_impacts", "mu_impact", "wall_time", "n_steps", "n_rhs", "reason", *FORCES, *CERTAINTY,
        *SCALARS_FLEXIBLE, *SCALARS_FEMA, *SCALARS_SLIDING, *SCALARS_ASYMMETRIC, *SCALARS_AUTO,
    }
)  # fmt: skip
"""Scalars that the lanes find, or that these bodies have not."""

PATH = frozenset({"t_overturn", "t_end", *FORCES, *CERTAINTY})
"""Scalars that need the path of a fall to its end."""


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes, whatever the number of cases."""
    motion = batch.excitation
    return (
        isinstance(motion.horizontal, Samples)
        and motion.vertical is None
        and batch.damping.only_eta
        and not batch.save.histories
        and batch.save.scalars <= WITHIN
        and batch.numerics.tolerances.rtol >= FINEST
    )


FINEST_AGAIN = 1e-15
"""Smallest tolerance at which the lanes solve again those of which two runs have parted, with more steps."""

GRAZING = 1e-9
"""A sample this near the uplift threshold, relative to it, may be part of a plateau on which rounding decides."""


def fit(batch: Batch, rows: Array) -> NDArray[np.bool_]:
    """Which rows (n, N_PAR) of symmetric bodies the lanes take, (n,).

    Not those that a sample grazes, nor those that cannot overturn: they turn farther than the sines of the lanes reach.
    """
    channel = batch.excitation.horizontal
    assert isinstance(channel, Samples)
    with np.errstate(divide="ignore"):
        guard = rows[:, at.G] * rows[:, at.RIGHT + at.THRESHOLD] / np.abs(rows[:, at.FACTOR_H])
    sizes = np.append(np.unique(np.abs(channel.values)), np.inf)
    above = np.searchsorted(sizes[:-1], guard)
    near = np.minimum(sizes[above] - guard, guard - sizes[np.maximum(above - 1, 0)])
    return np.asarray(np.isfinite(rows[:, at.RIGHT + at.Q_STAR]) & ~(np.abs(near) <= GRAZING * guard))


def run(lanes: ModuleType, batch: Batch, rows: Array, how: Any) -> Array:
    """Raw results (n, N_OUT) for the rows (n, N_PAR) of some cases of a batch of symmetric bodies.

    NaN in STATUS for a body that is left to the single-body kernels, whose `Settings` are `how`.
    """
    channel = batch.excitation.horizontal
    assert isinstance(channel, Samples)
    values = np.concatenate([channel.values, np.zeros(2)])
    slopes = np.concatenate([np.diff(channel.values) / channel.dt, np.zeros(3)])
    size = np.abs(channel.values)
    tail = np.ascontiguousarray(np.maximum.accumulate(size[::-1])[::-1])
    blocks = np.maximum.reduceat(size, np.arange(0, len(size), lanes.BLOCK))
    path = how.detail == lanes.ALL or bool(batch.save.scalars & PATH)
    velocity = np.empty((0, 3)) if path else velocity_of(channel.values, channel.dt)
    found = np.zeros((len(rows), to.N_OUT))
    lanes.march_lanes(rows, how, values, slopes, blocks, tail, velocity, channel.dt, lanes.work_space(), found)
    found[found[:, to.STATUS] == LEFT_TO_MARCH, to.STATUS] = np.nan
    return found


def velocity_of(values: Array, dt: float) -> Array:
    """The ground's velocity at each sample, and its largest and least from that sample on, (n, 3) [m/s].

    values (n,): a_g [m/s²], linear between samples, so that a velocity may be extreme inside one.  The bounds are
    widened by far more than rounding.
    """
    now = np.concatenate([[0.0], np.cumsum(0.5 * dt * (values[1:] + values[:-1]))])
    turns = np.append(values[1:] * values[:-1] < 0.0, False)
    slope = np.append(np.diff(values) / dt, 0.0)
    between = now - np.divide(0.5 * values**2, slope, out=np.zeros(len(values)), where=turns)
    slack = 1e-9 * np.ptp(between)
    most = np.maximum.accumulate(np.maximum(now, between)[::-1])[::-1] + slack
    least = np.minimum.accumulate(np.minimum(now, between)[::-1])[::-1] - slack
    return np.column_stack([now, most, least])
