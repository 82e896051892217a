"""A number with units is what its key is of: a frequency is no time, an angle no length."""

import pytest
import yaml

from rockcli.errors import StudyError
from rockcli.study.document.dimensions import OF_KEYS, check_unit
from rockcli.study.document.expressions import ExpressionError
from rockcli.study.document.paths import ARRAYS
from rockcli.study.open import open_study

GOOD = {
    "name": "x",
    "let": {"f": "2*Hz", "k": 2},
    "case": {
        "block": {"R": "2*m", "tan_alpha": "tan(11*deg)", "mu": 0.5},
        "motion": {"pulse": {"shape": "sine", "a_p": "0.5*g", "T_p": "1/f"}, "duration": "20/p"},
    },
    "vary": {"motion.pulse.a_p": ["0.3*g", "4*m/s**2"]},
}


def test_every_number_of_a_case_is_of_a_unit():
    assert {path[-1] for path in ARRAYS} <= OF_KEYS.keys()


@pytest.mark.parametrize(
    ("key", "text"),
    [
        *(("h", text) for text in ("1 + 20*cm", "0.5*R", "k*m", "0.9", "2*(3*ft)", "sin(30*deg)*m", "sqrt(4*m**2)")),
        *(("R", text) for text in ("0.75*g/2.14**2*s**2", "0.75*g/2.14**2", "0.75*g*(k*s/(2*pi))**2", "g*s/p")),
        *(("a_p", text) for text in ("3.6*g*tan_alpha", "3*g*10*deg", "300*cm/s**2", "g*R/m*20", "k*f", "R*p**2")),
        *(("omega_p", text) for text in ("3*pi", "4*p", "180*deg/s", "2*pi*f", "sqrt(g/R)")),
        *(("T_p", text) for text in ("1/f", "2*pi/p", "-(-3*s)", "500*ms", "1/(2*Hz)")),
        ("E", "30*GPa"), ("E", "3e10*N/m**2"), ("kw", "100*MPa/m"), ("density", "2.5*t/m**3"), ("mu", "tan(30*deg)"),
        ("scale", "0.4*g/(0.3*g)"), ("theta", "5*deg"), ("theta", "0.5*alpha + 1*deg"), ("unknown", "3*kg"),
    ],
)  # fmt: skip
def test_right_units_are_taken(key, text):
    check_unit(text, ("case", key), GOOD["let"])


@pytest.mark.parametrize(
    ("key", "text", "said"),
    [
        ("T_p", "2*Hz", "'2*Hz' is in Hz; expected a number of s"),
        ("T_p", "f", "'f' is in Hz; expected a number of s"),
        ("T_p", "0.3*g", "is in m/s²; expected a number of s"),
        ("h", "10*deg", "is in rad; expected a number of m"),
        ("h", "3*kN", "is in N; expected"),
        ("h", "1*m + 2*s", "adds numbers of different units"),
        ("tan_alpha", "10*deg", "is in rad; expected a number without a unit"),
        ("omega_p", "180*deg", "is in rad; expected a number of rad/s"),
        ("f_p", "3*rad/s", "is in rad/s; expected a number of Hz"),
        ("pga", "300*cm", "is in m; expected a number of m/s²"),
        ("scale", "0.4*g", "is in m/s²; expected a number without a unit"),
        ("density", "2.5*t", "is in kg; expected a number of kg/m³"),
        ("E", "30*kN/m", "is in kg s-2; expected a number of Pa"),
    ],
)
def test_wrong_units_are_told_with_what_is_expected(key, text, said):
    with pytest.raises(ExpressionError) as caught:
        check_unit(text, ("case", key), GOOD["let"])
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("keys", "value", "said"),
    [
        (("case", "motion", "pulse", "T_p"), "2*Hz", "x.yaml:9: case.motion.pulse.T_p: '2*Hz' is in Hz; expected"),
        (("case", "block", "R"), "10*deg", "case.block.R: '10*deg' is in rad; expected a number of m"),
        (("vary", "motion.pulse.a_p"), ["0.3*g", "4*m/s"], "vary.motion.pulse.a_p[1]: '4*m/s' is in m/s; expected"),
        (("vary", "motion.pulse.a_p"), {"from": "0.1*g", "to": "2*m", "n": 3}, "vary.motion.pulse.a_p.to: '2*m' is in"),
        (("vary", "motion.pulse.a_p"), {"a": "2*m", "b": 3.0}, "case.motion.pulse.a_p: '2*m' is in m; expected"),
        (("vary", "block.mu"), {"a": {"static": "3*m"}}, "case.block.mu.static: '3*m' is in m; expected"),
        (("uncertain",), {"block.R": {"uniform": ["1*s", 2]}}, "uncertain.block.R.uniform[0]: '1*s' is in s; expected"),
        (("save",), {"dt_out": "3*mm"}, "save.dt_out: '3*mm' is in m; expected a number of s"),
        (("expect",), [{"quantity": "u_top_peak", "max": "3*deg"}], "expect[0].max is '3*deg'; expected a number ("),
        (("expect",), [{"quantity": "theta", "time": "3*Hz", "max": 1}], "expect[0].time: '3*Hz' is in Hz; expected"),
        (("over",), {"axis": "a_p", "limits": [{"slide_peak": "3*s"}]}, "over.limits[0].slide_peak: '3*s' is in s;"),
    ],
)
def test_a_study_with_a_wrong_unit_is_refused_with_its_place(tmp_path, keys, value, said):
    study = yaml.safe_load(yaml.safe_dump(GOOD))
    open_study(study)
    inside = study
    for key in keys[:-1]:
        inside = inside[key]
    inside[keys[-1]] = value
    if keys == ("uncertain",):
        study["samples"] = 8
    file = tmp_path / "x.yaml"
    file.write_text(yaml.safe_dump(study))
    with pytest.raises(StudyError) as caught:
        open_study(file)
    assert said in str(caught.value)
