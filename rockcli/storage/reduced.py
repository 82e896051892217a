"""Values over the axes they change along, and no others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.storage.on_disk import in_blocks

Array = NDArray[np.float64]


def reduce(values: Array, axes: tuple[str, ...]) -> tuple[tuple[str, ...], Array]:
    """Drop the axes along which values do not change (NaN equals NaN); the dims left and the values over them."""
    kept: list[str] = []
    for axis in axes:
        at = len(kept)
        first = np.take(values, [0], axis=at)
        everywhere = np.broadcast_to(first, values.shape)
        if all(same(values[block], everywhere[block]).all() for block in in_blocks(values)):
            values = first.squeeze(axis=at)
        else:
            kept.append(axis)
    return tuple(kept), np.asarray(values)


def same(one: Array, other: Array | float) -> NDArray[np.bool_]:
    """Where two are equal, NaN to NaN too."""
    equal = np.asarray(one == other)
    return equal if equal.all() else np.asarray(equal | (np.isnan(one) & np.isnan(other)))
