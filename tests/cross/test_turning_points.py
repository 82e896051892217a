"""Turning points that the ends of a step do not show: a swing that begins with rate 0, or two turns in one step.

Against DOP853 with its own location of peaks.
"""

from __future__ import annotations

from typing import Any

import pytest

import rockcli

DOP853 = {"backend": "scipy", "method": "DOP853", "rtol": 1e-12}
PEAK = "theta_peak_over_alpha"


def peak(case: dict[str, Any], solver: dict[str, Any], scalars: list[str]) -> float:
    study = {
        "name": "x",
        "case": {**case, "solver": solver},
        "save": {"histories": False, "scalars": [*scalars, "reason"]},
    }
    found = rockcli.run(study)
    assert found.outcome >= 0, found.reasons.values
    return float(found[PEAK])


@pytest.mark.parametrize("scalars", [["outcome", PEAK], ["outcome", PEAK, "error_estimate"]])  # in lanes, and alone
def test_a_body_let_go_far_out_and_pushed_on(tmp_path, scalars):
    file = tmp_path / "two.txt"
    file.write_text("0.351639451\n-0.825704236\n")
    record = {"file": str(file), "dt": 0.01, "units": "m/s2", "pga_over_g_tan_alpha": 10.205402455431873}
    case = {
        "block": {"R": 0.6513670461674028, "alpha": 0.12766299300311967},
        "motion": {"record": record},
        "initial": {"theta": "-0.1853555073974158*alpha"},
        "model": 2,
        "geometry": "corotational",
        "damping": {"scheme": "restitution", "eta": 0.0},
    }
    found = peak(case, {"accuracy": "reference"} if len(scalars) == 3 else {}, scalars)
    assert found == pytest.approx(peak(case, DOP853, ["outcome", PEAK]), rel=1e-9)
    assert found > 0.1854  # farther than where it was let go


@pytest.mark.parametrize("scalars", [["outcome", PEAK], ["outcome", PEAK, "error_estimate"]])
@pytest.mark.parametrize(
    ("model", "geometry", "eta", "alpha", "amplitude", "omega", "theta"),
    [
        ("linearized", None, 0.7311841688269827, 0.0831025286017879, 1.0011942692150217, 1.71494485781399, -0.0209366),
        (
            "1",
            "negative_stiffness",
            0.9657353843007347,
            0.2645707266411861,
            -1.1160966770069278,
            8.879284853751484,
            0.0,
        ),
        (
            "3",
            "corotational",
            0.5549599483478492,
            0.15235963149026138,
            -1.0119744134374031,
            1.4862361371820185,
            0.0018144,
        ),
    ],
)
def test_a_cosine_that_pushes_at_once(model, geometry, eta, alpha, amplitude, omega, theta, scalars):
    pulse = {"shape": "cosine", "a_p_over_g_tan_alpha": amplitude, "omega_p_over_p": omega}
    case = {
        "block": {"R": 7.3575, "alpha": alpha},
        "motion": {"pulse": pulse},
        "initial": {"theta": theta * alpha},
        "model": model,
        "damping": {"scheme": "restitution", "eta": eta},
    }
    if geometry:
        case["geometry"] = geometry
    assert peak(case, {}, scalars) == pytest.approx(peak(case, DOP853, ["outcome", PEAK]), rel=1e-8)
