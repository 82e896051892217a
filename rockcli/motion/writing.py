"""Records as text in two columns, time and acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["two_columns"]


def two_columns(values: NDArray[np.float64], dt: float, units: str, titles: list[str]) -> str:
    """Time [s] and acceleration [units], every digit kept; the head states the units and the time step."""
    head = "".join(
        f"# {line}\n" for line in [*titles, "time [s], acceleration", f"units: {units}", f"dt: {float(dt)!r}"]
    )
    rows = (f"{float(f'{i * dt:.12g}')!r} {float(value)!r}\n" for i, value in enumerate(values))
    return head + "".join(rows)
