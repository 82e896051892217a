"""Top displacement does not depend on size: its limit for a large rectangle has no R.

With theta much smaller than alpha, u = 2 h theta obeys u'' = -(3/2) cos(alpha) (s g sin(alpha) + a_g cos(alpha)).  A
rectangular pulse of length T then gives a peak of A T^2/2 (1 + A/D): A the acceleration of u during it, D after it.
"""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, block, pulse, rock

TAN_ALPHA, LENGTH = 0.2, 0.5


def top(R: float, over: float) -> float:
    body = block(R, TAN_ALPHA)
    return float(rock(body, pulse("rectangular", over * G * TAN_ALPHA, np.pi / LENGTH)).scalars["u_top_peak"][0])


def limit(over: float) -> float:
    alpha = np.arctan(TAN_ALPHA)
    D = 1.5 * G * np.cos(alpha) * np.sin(alpha)
    A = (over - 1.0) * D
    return 0.5 * A * LENGTH**2 * (1.0 + A / D)


@pytest.mark.parametrize("over", [1.2, 2.0, 3.0])
def test_peak_of_a_large_block_is_the_limit_and_errors_fall_with_size(over):
    errors = [abs(top(R, over) / limit(over) - 1.0) for R in (1e2, 1e3, 1e4)]
    assert errors[-1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(10.0, rel=0.15)
