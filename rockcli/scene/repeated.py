"""Arrays over cases of which one row stands for all: kept as that row (stride 0), and computed with once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray


def repeated(row: NDArray[Any], n: int) -> NDArray[Any]:
    """One row (1, ...) for n cases, (n, ...), read-only and without a copy."""
    return np.broadcast_to(row, (n, *row.shape[1:]))


def is_repeated(values: NDArray[Any]) -> bool:
    """Whether an array over cases, (n, ...), is kept as one row."""
    return len(values) > 0 and values.strides[0] == 0


def once(compute: Callable[..., NDArray[Any]], *arrays: NDArray[Any]) -> NDArray[Any]:
    """What `compute` makes of arrays over cases row by row, (n, ...); of rows that are all repeated, of one of them."""
    if arrays and all(map(is_repeated, arrays)):
        return repeated(compute(*(values[:1] for values in arrays)), len(arrays[0]))
    return compute(*arrays)
