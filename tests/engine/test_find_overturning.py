"""`find: overturning`: thresholds by scan and bisection, against closed forms (tables.py)."""

from __future__ import annotations

import numpy as np
import pytest
from tables import HALF_SINE, RECTANGULAR

import rockcli
from rockcli.errors import StudyError
from rockcli.study.open import open_study

G = 9.81


def study(**more):
    case = {
        "block": {"R": 0.75 * G, "alpha": 0.1},
        "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 5.0}},
        "model": "linearized",
        "damping": {"scheme": "restitution", "eta": 0.9},
    }
    base = {"name": "find", "case": case}
    base["vary"] = {
        "motion.pulse.omega_p": [row["Omega"] for row in HALF_SINE],
        "motion.pulse.a_p": {"from": 0.5 * G * 0.1, "to": 12.0 * G * 0.1, "n": 24, "find": "overturning"},
    }
    return base | more


def test_half_sine_thresholds():
    found = rockcli.run(study())["motion_pulse_a_p_overturning"]
    assert found.dims == ("motion_pulse_omega_p",)
    expected = np.array([row["A"] for row in HALF_SINE]) * G * 0.1
    np.testing.assert_allclose(found.values, expected, rtol=1.1e-6)
    assert np.all(found.values >= expected * (1.0 - 1e-12))  # the upper end of the bracket, where it overturns


def test_without_another_axis_it_is_a_number():
    row = RECTANGULAR[1]
    data = study()
    data["case"]["motion"]["pulse"] = {"shape": "rectangular", "a_p": 1.0, "omega_p": np.pi / row["p_t1"]}
    del data["vary"]["motion.pulse.omega_p"]
    found = rockcli.run(data)["motion_pulse_a_p_overturning"]
    assert found.dims == ()
    assert float(found) == pytest.approx(row["A"] * G * 0.1, rel=1.1e-6)


def test_none_and_already():
    data = study()
    data["vary"]["motion.pulse.a_p"] |= {"to": 0.9 * G * 0.1}
    assert np.all(np.isinf(rockcli.run(data)["motion_pulse_a_p_overturning"].values))
    data["vary"]["motion.pulse.a_p"] |= {"from": 11.9 * G * 0.1, "to": 12.0 * G * 0.1, "n": 2}
    assert np.all(np.isnan(rockcli.run(data)["motion_pulse_a_p_overturning"].values))


def test_an_expectation_on_the_threshold():
    expect = [{"quantity": "motion_pulse_a_p_overturning", "min": 0.9}]
    assert open_study(study(expect=expect)).search is not None
    with pytest.raises(StudyError, match="motion_pulse_a_p_overturned"):
        open_study(study(expect=[{"quantity": "motion_pulse_a_p_overturned", "min": 0.9}]))


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"motion.pulse.a_p": {"from": 1, "to": 2, "n": 3, "find": "rocking"}}, "overturning"),
        (
            {
                "motion.pulse.a_p": {"from": 1, "to": 2, "n": 3, "find": "overturning"},
                "motion.pulse.omega_p": {"from": 1, "to": 2, "n": 3, "find": "overturning"},
            },
            "second range",
        ),
    ],
)
def test_wrong_searches(entry, words):
    with pytest.raises(StudyError, match=words):
        open_study(study(vary=entry))


def test_the_search_is_part_of_what_identifies_results():
    plain = study()
    del plain["vary"]["motion.pulse.a_p"]["find"]
    assert open_study(plain).identity != open_study(study()).identity
