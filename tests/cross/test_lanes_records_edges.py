"""Record lanes where an outcome hangs on little: falls that begin inwards, plateaus at the threshold, far turns.

Against the single-body solver and DOP853.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rockcli

LANES = ["outcome", "theta_peak_over_alpha", "n_impacts"]


def found(motion: np.ndarray, folder: Path, case: dict[str, Any], amplitude: float, scalars: list[str]) -> Any:
    file = folder / "motion.txt"
    np.savetxt(file, motion)
    record = {"file": str(file), "dt": 0.01, "units": "m/s2", "pga_over_g_tan_alpha": amplitude}
    save = {"histories": False, "scalars": scalars}
    return rockcli.run({"name": "x", "case": {**case, "motion": {"record": record}}, "save": save})


@pytest.mark.parametrize("scalars", [["outcome"], ["outcome", "n_impacts"], ["outcome", "error_estimate"]])
def test_a_fall_that_begins_inwards_comes_after_an_impact(tmp_path, scalars):
    case = {
        "block": {"R": 1, "tan_alpha": 0.2},
        "damping": {"scheme": "restitution", "eta": 0.9},
        "initial": {"theta": "0.5*alpha", "theta_dot": "-2*p*alpha"},
    }
    assert found(np.array([0.5, -1.0]), tmp_path, case, 1.2, scalars).outcome == 3
    scipy = {**case, "solver": {"backend": "scipy", "method": "DOP853", "rtol": 1e-12}}
    assert found(np.array([0.5, -1.0]), tmp_path, scipy, 1.2, scalars).outcome == 3


@pytest.mark.parametrize("amplitude", [1.0, 1.0 + 1e-12])
@pytest.mark.parametrize("seed", [0, 5])
def test_a_plateau_at_the_threshold_lifts_nothing_far(tmp_path, seed, amplitude):
    noise = np.convolve(np.random.default_rng(seed).normal(size=1500), np.hanning(15), "same")
    motion = np.clip(noise / np.abs(noise).max(), -0.3, 0.3)
    case = {
        "block": {"R": 1.3, "alpha": 0.16},
        "model": 1,
        "geometry": "corotational",
        "damping": {"scheme": "restitution", "eta": 0.9},
    }
    lanes = found(motion, tmp_path, case, amplitude, LANES)
    alone = found(motion, tmp_path, case, amplitude, [*LANES, "error_estimate"])
    assert lanes.outcome == alone.outcome
    # a net moment of 1e-12 of its own for 15 s: p^2 t^2/2 of that
    assert lanes.theta_peak_over_alpha < 1e-9
    assert lanes.n_impacts == alone.n_impacts == 0


@pytest.mark.parametrize("scalars", [LANES, [*LANES, "error_estimate"]])
def test_a_body_that_cannot_overturn_turns_far(tmp_path, scalars):
    case = {
        "block": {"R": 4.133720842825376, "alpha": 1.184148809058445},
        "model": 3,
        "geometry": "corotational",
        "damping": {"scheme": "restitution", "eta": 0.0},
        "initial": {"theta": 1.34224856},
    }
    motion, amplitude = np.ones(300), 8.951563069915878
    ours = found(motion, tmp_path, case, amplitude, scalars)
    exact = {**case, "solver": {"backend": "scipy", "method": "DOP853", "rtol": 1e-12}}
    theirs = found(motion, tmp_path, exact, amplitude, LANES[:2])
    assert ours.outcome == theirs.outcome == 1
    assert theirs.theta_peak_over_alpha > 2.0  # beyond pi/2
    assert float(ours.theta_peak_over_alpha) == pytest.approx(
        float(theirs.theta_peak_over_alpha), rel=1e-6
    )  # driven hard for 3 s
