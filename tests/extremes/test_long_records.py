"""An hour of motion at 200 Hz."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, record, rock, unit_block

DT, BURSTS, EVERY = 0.005, 40, 18_000


@pytest.mark.slow
def test_an_hour_of_equal_bursts(monkeypatch):
    """Between two bursts the body comes to rest: forty of them do what one does, forty times."""
    monkeypatch.setenv("ROCK_KERNELS", "compiled")
    alpha = 0.2
    rng = np.random.default_rng(7)
    burst = np.convolve(rng.normal(size=2000), np.ones(41) / 41.0, mode="same") * np.hanning(2000)
    burst *= 2.0 * G * np.tan(alpha) / np.abs(burst).max()
    quiet = np.zeros(EVERY)
    quiet[: len(burst)] = burst
    one = rock(unit_block(alpha), record(quiet, DT), histories=True, dt_out=0.01)
    hour = rock(unit_block(alpha), record(np.tile(quiet, BURSTS), DT), histories=True, dt_out=0.01)
    assert hour.time[-1] == pytest.approx(BURSTS * EVERY * DT, abs=2.0 * DT)
    n = int(one.scalars["n_impacts"][0])
    assert n > 5
    assert hour.scalars["n_impacts"][0] == BURSTS * n
    assert hour.scalars["theta_peak"][0] == pytest.approx(one.scalars["theta_peak"][0], rel=1e-9)
    period = EVERY * DT
    first, last = (
        hour.impacts["t_impact"][0, i * n : (i + 1) * n] - i * period for i in (0, 3)
    )  # a thousand are stored
    np.testing.assert_allclose(last, first, rtol=0.0, atol=1e-8)
