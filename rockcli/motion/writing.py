"""Records as text in two columns, time and acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["two_columns"]


def two_columns(values: NDArray[np.float64], dt: float, units: str, title: str) -> str:
    """Time [s] and acceleration [units], every digit kept; the head states the units."""
    head = f"# {title}\n# time [s], acceleration\n# units: {units}\n"
    rows = (f"{float(f'{i * dt:.12g}')!r} {float(value)!r}\n" for i, value in enumerate(values))
    return head + "".join(rows)
