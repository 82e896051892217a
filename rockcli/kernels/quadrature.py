"""Ten points of Gauss and Legendre, where times and work are integrated."""

from __future__ import annotations

import numpy as np

POINTS = 10
NODES, WEIGHTS = (
    (np.polynomial.legendre.leggauss(POINTS)[0] + 1.0) / 2.0,
    np.polynomial.legendre.leggauss(POINTS)[1] / 2.0,
)
"""On [0, 1]."""

LOW = 0.7
"""Rate of a free swing at take-off over that which reaches the equilibrium, up to which its time is good to 1e-11."""
