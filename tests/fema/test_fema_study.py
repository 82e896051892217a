"""The scheme in a study: its file, its keys, its errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockcli
from rockcli.analysis.expect import judge
from rockcli.engine.preview import preview
from rockcli.engine.run import solve
from rockcli.errors import StudyError
from rockcli.plotting.page.facts import facts_of
from rockcli.study.open import open_study

STUDY = Path(__file__).resolve().parents[2] / "studies" / "fema" / "ricker_r5.yaml"
PULSE = {"pulse": {"shape": "ricker", "a_p": "3.6*g*tan_alpha", "omega_p": "2*pi"}}


def study(damping, motion=PULSE, **more):
    case = {"block": {"R": 5.0, "tan_alpha": 0.2}, "motion": motion, "damping": damping, **more}
    return {"name": "fema", "case": case}


def peak(damping, motion=PULSE) -> float:
    return float(rockcli.run(study(damping, motion))["theta_peak_over_alpha"])


def test_the_study_meets_its_expectations():
    opened = open_study(STUDY)
    contents = solve(opened)
    assert [v.text for v in judge(contents, opened.expect) if not v.passed] == []
    assert np.isnan(contents.values("fema_T")[0]).all()
    assert np.isfinite(contents.values("fema_T")[1]).all()


def test_defaults_and_their_long_forms_agree():
    usual = peak("fema356")
    assert usual == peak({"scheme": "fema356", "W_over_Mg": 1, "spectrum": "motion"})
    assert usual == peak({"scheme": "fema356", "spectrum": {"shape": "motion"}})
    assert usual != peak({"scheme": "fema356", "W_over_Mg": 1.2})


def test_the_resolved_study_runs_again():
    first = rockcli.run(study({"scheme": "fema356", "spectrum": "motion", "fixed_base_period": "0.5*s"}))
    import yaml

    again = rockcli.run(yaml.safe_load(first.attrs["study"]))
    assert float(again["theta_peak"]) == float(first["theta_peak"])


def test_it_says_that_it_is_poor():
    dataset = rockcli.run(study("fema356"))
    assert "known to be poor" in dataset.attrs["warnings"]
    assert "known to be poor" in str(dataset["reasons"].values[int(dataset["reason"])])


def test_design_spectrum_needs_no_motion():
    scheme = {"scheme": "fema356", "spectrum": {"shape": "fema356", "S_XS": "0.6*g", "S_X1": "0.2*g"}}
    assert 0.0 < peak(scheme, "none") < 1.0
    scheme["spectrum"]["S_XS"] = "0.5*g"  # S_a(0) = 0.4 S_XS is g tan(alpha), which is not exceeded
    assert peak(scheme, "none") == 0.0


def test_table_in_g_and_in_metres_are_the_same():
    T, S_a = [0.05, 0.5, 1, 2, 4, 8, 16, 32], [0.8, 0.8, 0.4, 0.2, 0.1, 0.05, 0.02, 0.005]
    in_g = {"scheme": "fema356", "spectrum": {"periods": T, "S_a": S_a, "units": "g"}}
    in_metres = {"scheme": "fema356", "spectrum": {"shape": "table", "periods": T, "S_a": [f"{a}*g" for a in S_a]}}
    assert peak(in_g, "none") == pytest.approx(peak(in_metres, "none"), rel=1e-12)
    assert 0.0 < peak(in_g, "none") < 1.0


def test_the_general_spectrum_in_g_is_that_in_metres():
    general = {"shape": "fema356", "S_XS": 0.55, "S_X1": 0.1}
    in_g = {"scheme": "fema356", "spectrum": general | {"units": "g"}}
    in_metres = {"scheme": "fema356", "spectrum": general | {"S_XS": "0.55*g", "S_X1": "0.1*g"}}
    assert peak(in_g, "none") == pytest.approx(peak(in_metres, "none"), rel=1e-12)
    assert peak(in_g, "none") > 0.0


def test_weight_and_spectrum_may_vary():
    more = study({"scheme": "fema356", "spectrum": {"shape": "flat_S_v", "S_v": "S"}}, motion="none")
    more |= {"let": {"S": 0.4}, "vary": {"let.S": [0.3, 0.4], "damping.W_over_Mg": [1.0, 1.5]}}
    phi = rockcli.run(more)["theta_peak_over_alpha"]
    assert phi.dims == ("S", "W_over_Mg")
    assert (np.diff(phi.values, axis=0) > 0.0).all()
    assert (np.diff(phi.values, axis=1) < 0.0).all()


@pytest.mark.parametrize(
    ("damping", "motion", "message"),
    [
        ("fema356", "none", "needs a ground motion, or a design spectrum"),
        ({"scheme": "fema356", "eta": 0.9}, PULSE, "eta: is no key of the damping scheme fema356"),
        ({"scheme": "restitution", "W_over_Mg": 1}, PULSE, "W_over_Mg: is no key"),
        ({"scheme": "fema356", "W_over_Mg": 0}, PULSE, "W_over_Mg = 0: must be greater than 0"),
        ({"scheme": "fema356", "spectrum": "record"}, PULSE, "spectrum must be a mapping"),
        ({"scheme": "fema356", "spectrum": {"S_v": 1}}, PULSE, "needs a shape"),
        ({"scheme": "fema356", "spectrum": {"shape": "flat_Sv", "S_v": 1}}, PULSE, "flat_S_v"),
        ({"scheme": "fema356", "spectrum": {"shape": "flat_S_v"}}, PULSE, "needs S_v"),
        ({"scheme": "fema356", "spectrum": {"shape": "flat_S_v", "S_v": 1, "units": "g"}}, PULSE, "units: is of S_a"),
        ({"scheme": "fema356", "spectrum": {"shape": "flat_S_v", "S_v": 1, "S_a": 1}}, PULSE, "S_a: is no key"),
        ({"scheme": "fema356", "spectrum": {"shape": "constant", "S_a": "0.3*g", "units": "g"}}, PULSE, "leave one out"),
        ({"scheme": "fema356", "spectrum": {"shape": "constant", "S_a": [1, 2]}}, PULSE, "must be a number"),
        ({"scheme": "fema356", "spectrum": {"periods": [1, 2], "S_a": 3}}, PULSE, "must be a list"),
        ({"scheme": "fema356", "spectrum": {"periods": [2, 1], "S_a": [3, 4]}}, PULSE, "must ascend"),
        ({"scheme": "fema356", "spectrum": {"periods": [1, 2], "S_a": [3]}}, PULSE, "as many values"),
        ({"scheme": "fema356", "spectrum": {"periods": [1, 2], "S_a": [3, "x"]}}, PULSE, "x"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(damping, motion, message):
    with pytest.raises(StudyError) as error:
        open_study(study(damping, motion))
    assert message in str(error.value)


def test_other_models_are_not_solved():
    with pytest.raises(StudyError, match=r"solves model '3' .* with damping 'fema356'"):
        rockcli.run(study("fema356", model=3))


def test_uplift_is_told_by_the_threshold_of_the_procedure():
    """(W/Mg) g tan(alpha), and nothing where a spectrum decides; in `rock check`, on the page and in figures."""
    schemes = {"eta": {"scheme": "restitution"}, "one": {"scheme": "fema356"},
               "heavy": {"scheme": "fema356", "W_over_Mg": 1.5},
               "fixed": {"scheme": "fema356", "fixed_base_period": 0.2}}  # fmt: skip
    levels = {"eta": 0.2, "one": 0.2, "heavy": 0.3, "fixed": np.nan}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "T_p": 1.0}}}
    vary = {
        "motion.pulse.a_p": {"from": "0.05*g", "to": "0.45*g", "n": 17},
        "motion.pulse.T_p": [0.5, 0.75, 1, 1.25, 1.5],
    }
    for name, scheme in schemes.items():
        of_one = {"name": "x", "case": case | {"damping": scheme}, "vary": vary, "save": {"histories": False}}
        data = rockcli.run(of_one)
        lines = [one for one in rockcli.plot(data, "map").axes[0].lines if one.get_gid() == "uplift"]
        told = {fact.what: fact for fact in facts_of(data)}.get("lifts from")
        row = [one.value for one in preview(open_study(of_one)).motion if one.key == "uplift_g"]
        if np.isnan(levels[name]):
            assert (lines, told, row) == ([], None, [])
            continue
        still = data["motion_pulse_a_p"].values[(data["outcome"] == 0).all("T_p").values]
        assert levels[name] * 9.81 == pytest.approx(still.max())  # the procedure asks for more than the threshold
        assert lines[0].get_ydata()[0] == pytest.approx(levels[name])
        assert told is not None
        assert told.value == f"{levels[name]:g} g"
        assert ("W/Mg" in told.sentence) is (name == "heavy")
        assert row == pytest.approx([levels[name]])
    every = rockcli.run({"case": case, "vary": {"damping": schemes} | vary, "save": {"histories": False}})
    np.testing.assert_allclose(every["uplift_factor"], [1.0, 1.0, 1.5, np.nan])
    listed = preview(open_study({"name": "x", "case": case, "vary": {"damping": schemes} | vary})).bodies
    assert [one["uplift at [g]"] for one in listed] == pytest.approx([0.2, 0.3, np.nan], nan_ok=True)
