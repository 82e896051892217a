"""What a dataset says of its study is enough to judge it again."""

from __future__ import annotations

import pytest
import yaml

from rockcli.engine.report_page import verdicts
from rockcli.engine.run import solve
from rockcli.study.open import open_study

BLOCK = {"R": 2.0, "tan_alpha": 0.2}


def study_of(**parts):
    case = {"block": BLOCK, "motion": {"pulse": {"shape": "ricker", "a_p": "3.6*g*tan_alpha", "omega_p": "3*pi"}}}
    return open_study({"name": "read-again", "case": case} | parts)


@pytest.mark.parametrize("g", [9.81, 9.0])
def test_a_point_named_by_an_expression_of_the_case(g):
    case = {"g": g, "block": BLOCK, "motion": {"pulse": {"shape": "ricker", "a_p": 1, "omega_p": "3*pi"}}}
    clause = {"quantity": "outcome", "at": {"motion.pulse.a_p": "0.1*g"}, "is": "no_uplift"}
    study = open_study(
        {"name": "x", "case": case, "vary": {"motion.pulse.a_p": ["0.1*g", "0.7*g"]}, "expect": [clause]}
    )
    (verdict,) = verdicts(solve(study))
    assert verdict.passed
    assert verdict.points == 1
    again = open_study(yaml.safe_load(study.resolved_yaml))
    assert again.expect[0].at == study.expect[0].at == {"motion_pulse_a_p": pytest.approx(0.1 * g)}
    assert again.identity == study.identity


def test_histories_and_curves_are_no_scalars_of_a_case():
    clauses = [
        {"quantity": "theta", "at": {"model": "rigid"}, "time": 1.0, "max": 10},
        {"quantity": "restoring_moment", "rotation": 0.5, "min": 0},
        {"quantity": "outcome", "is": "rocking"},
    ]
    study = study_of(vary={"model": ["rigid", 3]}, curves=["moment_rotation"], expect=clauses, save={"histories": True})
    assert [(v.passed, v.points) for v in verdicts(solve(study))] == [(True, 1), (True, 2), (True, 2)]


def test_limit_states_and_measures_of_a_suite():
    motion = {"record": {"file": "synthetic_rock_m65.AT2", "pga": 1}}
    study = open_study(
        {
            "name": "suite",
            "case": {"block": BLOCK, "motion": motion},
            "vary": {"motion.record.file": "synthetic_*.AT2", "motion.record.pga": ["0.1*g", "0.6*g"]},
            "over": "record",
            "save": {"histories": False},
            "expect": [
                {
                    "quantity": "p_exceeded",
                    "at": {"limit_state": 0.5, "motion.record.pga": "0.1*g"},
                    "value": 0,
                    "atol": 0,
                },
                {"quantity": "theta_peak_over_alpha_p84", "at": {"motion.record.pga": "0.1*g"}, "value": 0, "atol": 0},
            ],
        }
    )
    assert [(v.passed, v.points) for v in verdicts(solve(study))] == [(True, 1), (True, 1)]
