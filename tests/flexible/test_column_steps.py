"""What happens inside a step of the column is not lost: peaks of the rate, openings that arm eta (docs/flexible.md)."""

from __future__ import annotations

import numpy as np
import pytest
from flexible.columns import rock_column, scalar, sine
from scenes import peak


@pytest.mark.parametrize("accuracy", ["standard", "reference"])
@pytest.mark.parametrize(("n", "zeta"), [(1, 0.0), (5, 0.0), (5, 0.01), (20, 0.01)])
def test_largest_rate_is_that_of_a_dense_history(n, zeta, accuracy):
    """Vibrations far shorter than a step: it is the largest of 120 000 values of the same solution, or a little more."""
    motion = sine(duration=12.0)
    dense = rock_column(motion, n=n, zeta=zeta, accuracy=accuracy, histories=True, dt_out=1e-4)
    largest = float(np.nanmax(np.abs(dense.histories["theta_dot"])))
    assert scalar(dense, "theta_dot_peak") == pytest.approx(largest, rel=2e-5 if zeta > 0.0 else 2e-3)
    assert scalar(rock_column(motion, n=n, zeta=zeta, accuracy=accuracy), "theta_dot_peak") == scalar(
        dense, "theta_dot_peak"
    )


@pytest.mark.parametrize("E", [1e9, 3e9])
def test_landings_do_not_depend_on_the_step(E):
    """A soft undamped column opens by more than 1e-3 alpha and is back within a step: that arms eta all the same."""
    usual, shorter = (rock_column(sine(), E=E, zeta=0.0, n=5, dt=dt) for dt in (None, 2e-3))
    assert scalar(usual, "n_impacts") > 20
    assert scalar(usual, "n_impacts") == scalar(shorter, "n_impacts")
    assert peak(usual) == pytest.approx(peak(shorter), rel=1e-6)
