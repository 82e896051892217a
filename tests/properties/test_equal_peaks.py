"""Peaks of an undamped body are equal once the motion has ended: `t_peak` and the side are those of the first of them."""

from __future__ import annotations

import numpy as np
import pytest

import rockcli

END = 0.5
"""End of the pulse [s]."""


def undamped(solver, block, amplitudes, **save):
    case = {
        "block": block,
        "damping": "none",
        "motion": {"pulse": {"shape": "sine", "a_p": 3, "T_p": END}},
        "solver": solver,
    }
    return rockcli.run({"name": "u", "case": case, "vary": {"motion.pulse.a_p": amplitudes}, "save": save})


@pytest.mark.parametrize(
    "solver",
    [
        {},
        {"accuracy": "draft"},
        {"rtol": 1e-5},
        {"backend": "scipy"},
        {"backend": "scipy", "accuracy": "draft"},
        pytest.param({"backend": "scipy", "method": "Radau", "rtol": 1e-6}, marks=pytest.mark.slow),
    ],
    ids=str,
)
@pytest.mark.parametrize(
    "block", [{"R": 1.0, "tan_alpha": 0.2}, {"h": 1.0, "b": [0.2, 0.23]}], ids=["equal", "unequal"]
)
def test_the_earliest_of_equal_peaks(solver, block):
    told = undamped(solver, block, np.linspace(2.5, 4.5, 6).tolist(), histories=True, dt_out=0.1)
    rocks = 0
    for case in (told.isel(motion_pulse_a_p=i) for i in range(6)):
        if int(case.outcome) != 1:
            continue
        rocks += 1
        after = case.t_impact.values[case.t_impact.values > END]
        assert len(after) > 3
        # a peak of either side has been passed by the third impact after the pulse: what comes later is no higher
        assert float(case.t_peak) < after[2]
    assert rocks > 3


def test_the_same_side_without_histories():
    block, amplitudes = {"R": 1.0, "tan_alpha": 0.2}, np.linspace(2.2, 4.5, 12).tolist()
    for accuracy in ("draft", "standard"):
        alone, lanes = (
            undamped({"accuracy": accuracy}, block, amplitudes, histories=whether) for whether in (True, False)
        )
        rocks = (alone.outcome == 1).values
        assert rocks.sum() > 6
        np.testing.assert_allclose(alone.t_peak.values[rocks], lanes.t_peak.values[rocks], rtol=1e-4)
        assert (np.sign(alone.theta_peak) == np.sign(lanes.theta_peak)).values[rocks].all()
