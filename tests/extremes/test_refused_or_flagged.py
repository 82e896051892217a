"""What cannot be computed is refused (exit 2) or a failed case, each with a sentence: never a silent answer."""

from __future__ import annotations

import re

import numpy as np
import pytest

import rockcli
from rockcli.errors import StudyError

BLOCK = {"R": 1, "alpha": 0.2}
SINE = {"pulse": {"shape": "sine", "a_p": "3*g*tan_alpha", "omega_p": "5*p"}}
MODEL_3 = {
    "block": {"R": 2, "tan_alpha": 0.1},
    "motion": {"duration": 3, "pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.6, "omega_p": "3*pi"}},
    "model": 3,
    "geometry": "corotational",
}
COLUMN = {"block": {"height": 50, "width": 5}, "motion": {"pulse": {"shape": "sine", "T_p": 1.6, "a_p": 4}}}

REFUSED = {
    "too slender": ({"block": {"R": 1, "alpha": 1e-101}}, r"block\.alpha.*at least 1e-100"),
    "lying flat": ({"block": BLOCK, "initial": {"theta": "pi/2"}}, r"initial\.theta.*between -pi/2 and pi/2"),
    "eta below 0": ({"block": BLOCK, "damping": {"eta": -1e-16}}, r"damping\.eta.*between 0 and 1"),
    "eta above 1": ({"block": BLOCK, "damping": {"eta": 1.0 + 2.0**-52}}, r"damping\.eta.*between 0 and 1"),
    "a damper too strong": (
        {"block": BLOCK, "damping": {"scheme": "dashpot", "coefficient": 1e6}},
        r"damping\.coefficient.*base damper.*nothing rocks",
    ),
    "rtol": ({"block": BLOCK, "motion": SINE, "solver": {"rtol": 1e-300}}, r"solver\.rtol.*at least 1e-16"),
    "rtol of scipy": (
        {"block": BLOCK, "motion": SINE, "solver": {"rtol": 1e-15, "backend": "scipy"}},
        r"solver\.rtol.*at least 2\.5e-14",
    ),
    "no time": ({"block": BLOCK, "motion": {**SINE, "duration": 0}}, r"motion\.duration.*greater than 0"),
    "no gravity": ({"g": 0, "block": BLOCK, "motion": SINE}, r"g"),
    "a frequency of 0": (
        {"block": BLOCK, "motion": {"pulse": {"shape": "sine", "a_p": 1, "omega_p": 0}}},
        r"omega_p.*greater than 0",
    ),
    "an amplitude beyond all": (
        {"block": BLOCK, "motion": {"pulse": {"shape": "sine", "a_p": 1e300, "omega_p": 1}}},
        r"a_p.*out of range",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name):
    case, sentence = REFUSED[name]
    with pytest.raises(StudyError, match=sentence):
        rockcli.run({"case": case, "save": {"histories": False}})


FRAME = {"backend": "frame", "yield_rotation": 1e-6}

FAILED = {
    "a step beyond the pulse": ({**MODEL_3, "solver": {**FRAME, "dt": 10}}, "dt = 10 s is too coarse"),
    "a step beyond its detail": ({**MODEL_3, "solver": {**FRAME, "dt": 0.1}}, "dt = 0.1 s is too coarse"),
    "steps without end": ({**MODEL_3, "solver": {**FRAME, "dt": 1e-300}}, r"makes 3e\+300 steps"),
    "a base too soft": ({**MODEL_3, "solver": {**FRAME, "dt": 1e-3, "yield_rotation": 1e-3}}, "is not small against"),
    "a column too soft": ({**COLUMN, "model": "flexible", "column": {"E": 1e5, "rho": 2500}}, "buckles"),
    "a rate beyond all": ({"block": BLOCK, "initial": {"theta_dot": 1e200}}, "ceased to be finite"),
}


@pytest.mark.parametrize("name", FAILED)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_failed_with_a_sentence(name):
    case, sentence = FAILED[name]
    found = rockcli.run({"case": case, "save": {"histories": False}})
    assert int(found["outcome"]) == -2
    assert np.isnan(float(found["theta_peak_over_alpha"]))
    assert re.search(sentence, str(found["reasons"].values[int(found["reason"])]))


def test_an_overdamped_body_comes_to_rest():
    """Its bounces become ever smaller and more; each takes energy, -(2/3) c/I_O of it per second, until none is seen."""
    damping, motion = {"scheme": "dashpot", "coefficient": 5}, {"duration": 3}
    found = rockcli.run({"case": {"block": BLOCK, "motion": motion, "initial": {"theta": 1e-9}, "damping": damping}})
    assert int(found["outcome"]) == 1
    assert float(found["theta"].values[-1]) == 0.0
    # c/I_O = 47/s: from v = 2e-5 to below 1e-6 p sin(alpha) in a tenth of a second or two
    rests = float(found["time"].values[np.flatnonzero(found["theta"].values)[-1]])
    rate, p = 5 * 4 * np.sqrt(9.81) / (4 / 3), np.sqrt(0.75 * 9.81)
    v_0, v_rest = p * np.sqrt(2 * 1e-9 * np.sin(0.2)), 1e-6 * p * np.sin(0.2)
    assert rests == pytest.approx(3.0 / rate * np.log(v_0 / v_rest), rel=0.15)


def test_axes_of_one_name_get_their_whole_paths():
    found = rockcli.run(
        {
            "let": {"initial_theta": 1},
            "case": {"block": BLOCK, "initial": {"theta": "0.01*initial_theta"}},
            "vary": {"let.initial_theta": [1, 2], "initial.theta": [0.05, 0.1]},
            "save": {"histories": False},
        }
    )
    assert found["outcome"].dims == ("let_initial_theta", "initial_theta")
