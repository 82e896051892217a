"""Damping: what is lost at impacts or between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Damping:
    """A damping scheme of a batch.

    Attributes:
        scheme: `none` or `restitution` (event-based damping, [3.2, 3.5]).
        eta: ratio of angular velocities just after / just before an impact, (n, 2); column j when the body
            lands on edge j (0 left, 1 right).  Ones where nothing is lost.
    """

    scheme: str
    eta: Array
