"""The motion of the ground: as the kernels take it, and at the output times."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DUE
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import PIECE_WIDTH, Channel, Pulses, Samples, Suite, acceleration, unscaled

Array = NDArray[np.float64]


def channel_of(kernel: ModuleType, channel: Channel | None, n: int, cases: Any = slice(None)) -> tuple[Any, Array]:
    """A component of the motion of a batch of n cases as a kernel module wants it: its `Channel`, and (k, m) numbers.

    Of pulses k is the number of `cases`, else 1.
    """
    if isinstance(channel, Samples):
        tail = np.maximum.accumulate(np.abs(channel.values)[::-1])[::-1]
        data = np.concatenate([channel.values, tail])[None, :]
        return kernel.Channel(SAMPLES, channel.dt, len(channel.values) - 1), data
    if isinstance(channel, Pulses):
        pieces = channel.table.shape[1]
        data = np.ascontiguousarray(channel.table.reshape(n, pieces * PIECE_WIDTH)[cases])
        return kernel.Channel(PULSES, 1.0, pieces), data
    return kernel.Channel(NOTHING, 1.0, 0), np.zeros((1, 1))


def factors_of(channel: Channel | Suite | None, n: int) -> Array:
    """What the n cases multiply the numbers of a channel with, (n,)."""
    return np.broadcast_to(channel.factor, n) if isinstance(channel, Samples | Suite) else np.ones(n)


def ground_of_case(batch: Batch, case: int, t: Array) -> tuple[Array, Array]:
    """Horizontal and vertical acceleration of one case at times t (k,) [s], zero after its duration: (k,) [m/s²]."""
    return next(ground_of_cases(batch, (case,), t))


def ground_of_cases(batch: Batch, cases: Iterable[int], t: Array) -> Iterator[tuple[Array, Array]]:
    """Yield `ground_of_case` of some cases; a recorded motion is interpolated once for all of them."""
    channels = (batch.excitation.horizontal, batch.excitation.vertical)
    recorded = [unscaled(channel, t) if isinstance(channel, Samples) else None for channel in channels]
    for case in cases:
        over = t > batch.excitation.duration[case] * (1.0 + DUE)
        a_g, a_v = (
            np.where(over, 0.0, shape * channel.factor[case])
            if isinstance(channel, Samples) and shape is not None
            else np.where(over, 0.0, acceleration(channel, t, case))
            for channel, shape in zip(channels, recorded, strict=True)
        )
        yield a_g, a_v


def ground_history(batch: Batch, t: Array, live: NDArray[np.bool_]) -> Array:
    """a_g and a_v of all cases at times t (k,) [s], NaN where `live` (n, k) is not so: (2, n, k) [m/s²]."""
    shaken = list(ground_of_cases(batch, range(batch.size), t))
    return np.where(live, np.array(shaken).transpose(1, 0, 2), np.nan)
