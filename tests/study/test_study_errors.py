"""Wrong studies: each is one sentence that names file, line, key and what was expected."""

import json

import pytest

from rockcli.errors import RecordError, StudyError
from rockcli.study.building.records import MissingRecordError
from rockcli.study.open import open_study
from rockcli.study.schema import json_schema

GOOD = """\
name: good
let: {gamma: 5}
case:
  block: {R: 5.0, tan_alpha: 0.2}
  motion: {pulse: {shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 2*pi}}
  model: rigid
  damping: restitution
vary:
  block.tan_alpha: [0.1, 0.2, 0.333]
  model: [rigid, linearized]
expect:
  - {quantity: theta_peak_over_alpha, at: {model: rigid, block.tan_alpha: 0.2}, value: 0.5}
"""


def write(tmp_path, text):
    file = tmp_path / "study.yaml"
    file.write_text(text)
    return file


def test_the_good_one_is_good(tmp_path):
    study = open_study(write(tmp_path, GOOD))
    assert study.shape == (3, 2)


WRONG = [
    # what is replaced, by what, line, words
    ("name: good\n", "", None, ["'name'", "missing"]),
    ("name: good", "name: ../evil", 1, ["name", "digits"]),
    ("name: good", "name: [a]", 1, ["name", "a list"]),
    ("name: good", "nam: good", 1, ["'nam'", "did you mean 'name'"]),
    ("case:", "cas:", 3, ["'cas'", "did you mean 'case'"]),
    ("  model: rigid\n", "  modle: rigid\n", 6, ["case.modle", "did you mean 'model'"]),
    ("model: rigid\n", "model: rigit\n", 6, ["case.model.name", "did you mean 'rigid'"]),
    ("model: rigid\n", "model: [rigid]\n", 6, ["case.model", "mapping"]),
    ("model: rigid\n", "model: rigid\n  column: {elements: 1001}\n", 7, ["case.column.elements", "at most 1000"]),
    ("[rigid, linearized]", "[rigid, 5]", 10, ["expected"]),
    ("[rigid, linearized]", "[rigid, linear]", 10, ["did you mean 'linearized'"]),
    ("[rigid, linearized]", "[rigid, rigid]", 10, ["vary.model", "repeats 'rigid'"]),
    ("[rigid, linearized]", "[]", 10, ["vary.model", "no values"]),
    ("[rigid, linearized]", "5", 10, ["vary.model", "expected a list"]),
    ("[rigid, linearized]", "rigid", 10, ["vary.model", "expected a list"]),
    ("  model: [rigid", "  modell: [rigid", 10, ["'modell'", "did you mean 'model'"]),
    ("block.tan_alpha: [", "block.tanalpha: [", 9, ["did you mean 'block.tan_alpha'"]),
    ("block.tan_alpha: [", "tan_alpha: [", 9, ["did you mean 'block.tan_alpha'"]),
    ("block.tan_alpha: [", "case.block.tan_alpha: [", 9, ["begin inside the case", "'block.tan_alpha'"]),
    ("[0.1, 0.2, 0.333]", "[0.1, -0.2, 0.333]", 9, ["block.tan_alpha = -0.2", "greater than 0"]),
    ("[0.1, 0.2, 0.333]", "\n    - 0.1\n    - 0.2\n    - 0\n", 12, ["block.tan_alpha = 0", "greater than 0"]),
    ("[0.1, 0.2, 0.333]", "[0.1, .nan]", 9, ["finite"]),
    ("[0.1, 0.2, 0.333]", "[0.1, true]", 9, ["True"]),
    ("[0.1, 0.2, 0.333]", "{from: 0.1, to: 0.3}", 9, ["without `n`"]),
    ("[0.1, 0.2, 0.333]", "{from: 0.1, to: 0.3, n: 2.5}", 9, ["vary.block.tan_alpha.n", "whole number"]),
    ("[0.1, 0.2, 0.333]", "{from: 0, to: 0.3, n: 3, spacing: log}", 9, ["greater than 0"]),
    ("[0.1, 0.2, 0.333]", "{from: 0.1, to: 0.3, n: 3, spacing: lin}", 9, ["linear or log"]),
    ("[0.1, 0.2, 0.333]", "{from: 0.1, to: 0.3, n: 9, find: rocking}", 9, ["only `overturning` can be found"]),
    ("[0.1, 0.2, 0.333]", "{from: 0.1, to: 0.1, n: 3}", 9, ["repeats a value"]),
    ("[0.1, 0.2, 0.333]", "['0.5*R', 0.2]\n  block.R: [1, 2]", 9, ["vary.block.tan_alpha", "other expressions"]),
    ("tan_alpha: 0.2}", "tan_alpha: 0.2, h: 3}", 9, ["over-determined", "R, h, tan_alpha"]),
    ("{R: 5.0, tan_alpha: 0.2}", "{tan_alpha: 0.2}", 4, ["case.block", "under-determined", "tan_alpha"]),
    ("{R: 5.0, tan_alpha: 0.2}", "{R: 5.0, r: 3}", 4, ["unknown key 'r'", "did you mean 'R'"]),
    ("{R: 5.0,", "{R: five,", 4, ["case.block.R", "`five` is not known"]),
    ("{R: 5.0,", "{R: true,", 4, ["case.block.R", "number"]),
    ("{R: 5.0,", "{R: [5],", 4, ["case.block.R", "a list"]),
    ("{R: 5.0,", "{R: .inf,", 4, ["case.block.R", "finite"]),
    ("{R: 5.0,", "{R: 1e999,", 4, ["case.block.R", "finite"]),
    ("{R: 5.0,", "{R: 0,", 4, ["case.block.R = 0", "greater than 0"]),
    ("{R: 5.0,", "{R: 5.0*,", 4, ["case.block.R", "not an arithmetic expression"]),
    ("{R: 5.0,", "{R: 5*tan_alpha,", 4, ["case.block.R", "known only once the block is"]),
    ("{R: 5.0,", "{outline: [[0, 0], [1, 0], [0, 1]], R: 5.0,", 4, ["case.block.R", "follows from the outline"]),
    ("{R: 5.0, tan_alpha: 0.2}", "{outline: [[0, 0], [1, 0], [0, 1]]}", 9, ["case.block.tan_alpha", "follows"]),
    ("{R: 5.0,", "{density: 2500, R: 5.0,", 4, ["case.block.density", "belongs to an outline"]),
    ("{R: 5.0,", "{R: nan,", 4, ["case.block.R", "'nan' is no finite number"]),
    ("{R: 5.0, tan_alpha: 0.2}", "5", 4, ["case.block", "must be a mapping with the keys R, h"]),
    ("shape: ricker", "shape: rickr", 5, ["case.motion.pulse.shape", "did you mean 'ricker'"]),
    ("shape: ricker, ", "", 5, ["'shape'", "missing", "case.motion.pulse"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: 3.6*g*tan_alfa", 5, ["case.motion.pulse.a_p", "did you mean 'tan_alpha'"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: 3.6*G", 5, ["`G` is not known", "did you mean 'g'"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: 1/0", 5, ["gives inf"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: sqrt(-1)", 5, ["gives nan"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: 1, A: 3", 5, ["A", "no option of the shape ricker"]),
    ("a_p: 3.6*g*tan_alpha", "a_p: 1, a_p_over_g_tan_alpha: 3", 5, ["say the same thing"]),
    ("a_p: 3.6*g*tan_alpha, ", "", 5, ["no amplitude"]),
    (", omega_p: 2*pi", "", 5, ["no frequency", "omega_p, T_p, f_p"]),
    ("omega_p: 2*pi", "omega_p: 2*Hz", 5, ["Hz is f_p"]),
    ("omega_p: 2*pi", "T_p: 0", 5, ["greater than 0"]),
    ("omega_p: 2*pi", "omega_p: 2*pi, cycles: 3", 5, ["cycles", "no option of the shape ricker"]),
    ("damping: restitution", "damping: restitutio", 7, ["case.damping.scheme", "did you mean 'restitution'"]),
    ("damping: restitution", "damping: {scheme: dashpot, eta: 0.9}", 7, ["case.damping.eta", "dashpot"]),
    ("damping: restitution", "damping: {eta: 1.1}", 7, ["case.damping.eta = 1.1", "between 0 and 1"]),
    ("damping: restitution", "damping: {e: 0.9}", 7, ["unknown key 'e'"]),
    ("damping: restitution", "damping: {eta: 0.9, r_energy: 0.8}", 7, ["say the same thing"]),
    ("damping: restitution", "damping: {scheme: none, eta: 0.9}", 7, ["no key of the damping scheme none"]),
    ("damping: restitution", "initial: {theta: 1.6}", 7, ["case.initial.theta", "pi/2"]),
    ("damping: restitution", "solver: {backend: openses}", 7, ["case.solver.backend", "opensees", "event"]),
    ("damping: restitution", "solver: {rtol: 0}", 7, ["case.solver.rtol", "greater than 0"]),
    ("damping: restitution", "solver: {accuracy: high}", 7, ["draft, standard, reference"]),
    ("damping: restitution", "geometry: corotated", 7, ["negative_stiffness"]),
    ("damping: restitution", "base: {kw: 1e9}", 7, ["case.base.kw", "belongs to base law winkler"]),
    (
        "damping: restitution",
        "base: {law: winkler, kw: 1e9, fibres: 1}",
        7,
        ["case.base.fibres is 1; expected at least 2"],
    ),
    ("damping: restitution", "g: -9.81", 7, ["case.g", "greater than 0"]),
    ("damping: restitution", "g: 0.5*g", 7, ["needs itself"]),
    ("{gamma: 5}", "{gamma: delta}", 2, ["let.gamma", "`delta` is not known"]),
    ("{gamma: 5}", "{gamma: delta, delta: 2*gamma}", 2, ["let.", "needs itself", "gamma"]),
    ("{gamma: 5}", "{m: 5}", 2, ["let.m", "a unit already"]),
    ("{gamma: 5}", "{R: 5}", 2, ["let.R", "a symbol of the case already"]),
    ("{gamma: 5}", "{sin: 5}", 2, ["let.sin", "a function already"]),
    ("{gamma: 5}", "{a-b: 5}", 2, ["let.a-b", "no name for a symbol"]),
    ("{gamma: 5}", "[5]", 2, ["let", "must be a mapping"]),
    ("{gamma: 5}", "{gamma: [5]}", 2, ["let.gamma", "a list"]),
    ("let: {gamma: 5}", "over: record", 2, ["over", "'record'", "no axis of the dataset"]),
    ("let: {gamma: 5}", "refine: true", 2, ["refine", "needs two numeric axes", "there are 1"]),
    ("let: {gamma: 5}", "curves: [pushove]", 2, ["did you mean 'pushover'"]),
    ("let: {gamma: 5}", "plots: [histories, heatmap]", 2, ["plots[1]", "phase, map, ida"]),
    ("let: {gamma: 5}", "plots: histories", 2, ["plots is 'histories'; expected a list"]),
    ("{R: 5.0, tan_alpha: 0.2}", "{parts: []}", 4, ["case.block.parts is a list of 0; expected at least 1"]),
    (
        "let: {gamma: 5}",
        "rules_spectrum: {periods: [1], S_a: [1, 2]}",
        2,
        ["rules_spectrum.periods is a list of 1; expected at least 2"],
    ),
    ("damping: restitution", "damping: {eta: housnr}", 7, ["case.damping.eta", "did you mean 'housner'"]),
    ("damping: restitution", "solver: {events: 3}", 7, ["case.solver.events is 3; expected true or false"]),
    ("let: {gamma: 5}", "save: {scalars: [outcom]}", 2, ["save.scalars", "did you mean 'outcome'"]),
    ("{R: 5.0, ", "{R: 5,0, ", 4, ["unknown key '0'", "decimals have a point, 1.8, and several numbers brackets"]),
    (
        "let: {gamma: 5}",
        "let: {gamma: 5}\nuncertain: {block.R: {normal: 5}}",
        3,
        ["[mean, standard deviation], are expected"],
    ),
    ("let: {gamma: 5}", "let: {gamma: 5}\nuncertain: {block.R: {lognormal: 5}}", 3, ["[median, standard deviation of"]),
    ("let: {gamma: 5}", "let: {gamma: 5}\nplots: map", 3, ["plots is 'map'; expected a list, as [map]"]),
    ("  model: [rigid", "  gamma: [rigid", 10, ["'gamma' is a symbol of `let`; did you mean 'let.gamma'?"]),
    ("{R: 5.0, ", "{R:5.0, ", 4, ["a blank belongs behind the colon: R: 5.0"]),
    (
        "\n  block.tan_alpha: [0.1, 0.2, 0.333]\n  model: [rigid, linearized]",
        " {block.tan_alpha: [0.1], model: [rigid], 0.2}",
        8,
        ["'0.2' has no values: several of one axis stand in brackets"],
    ),
    ("name: good", 'name: "C:\\data"', 1, ["a backslash in double quotes"]),
    ("omega_p: 2*pi", "T: 2*pi", 5, ["case.motion.pulse.T:", "did you mean 'T_p'?"]),
    ("let: {gamma: 5}", "save: {scalars: [pga]}", 2, ["'pga' is in the dataset without being listed", "leave it out"]),
    ("let: {gamma: 5}", "save: {scalars: [a_g]}", 2, ["'a_g' is a history: `histories: true` saves it"]),
    ("let: {gamma: 5}", "save: {dt_out: 0}", 2, ["save.dt_out", "greater than 0"]),
    ("let: {gamma: 5}", "save: {dt_out: 5*p}", 2, ["save.dt_out", "`p` is not known here"]),
    ("let: {gamma: 5}", "save: {histories: sometimes}", 2, ["save.histories", "true, false"]),
    ("let: {gamma: 5}", "save: {histories: {modl: rigid}}", 2, ["save.histories.modl", "did you mean 'model'"]),
    ("let: {gamma: 5}", "compare_to: {model: flexible}", 2, ["compare_to.model", "rigid, linearized"]),
    ("let: {gamma: 5}", "vary: {}", 8, ["duplicate key 'vary'"]),
    ("theta_peak_over_alpha,", "theta_peak_over_alfa,", 12, ["quantity", "did you mean 'theta_peak_over_alpha'"]),
    ("quantity: theta_peak_over_alpha,", "quantity: theta,", 12, ["needs `time`"]),
    ("quantity: theta_peak_over_alpha,", "quantity: t_impact,", 12, ["per impact"]),
    ("block.tan_alpha: 0.2}, v", "block.tan_alpha: 0.25}, v", 12, ["no point of that axis", "0.1, 0.2, 0.333"]),
    (
        "block.tan_alpha: 0.2}, v",
        "block.tan: 0.2}, v",
        12,
        ["expect[0].at.block.tan", "did you mean 'block.tan_alpha'"],
    ),
    ("value: 0.5", "valu: 0.5", 12, ["unknown key 'valu'", "did you mean 'value'"]),
    ("value: 0.5", "is: rocking", 12, ["judges meanings of outcome"]),
    ("value: 0.5", "value: high", 12, ["expected a number"]),
    ("value: 0.5", "value: 0.5, min: 0.4", 12, ["exactly one of"]),
    (", value: 0.5", "", 12, ["says nothing"]),
    ("value: 0.5", "value: 0.5, time: 3", 12, ["no time"]),
    ("value: 0.5", "value: .nan", 12, ["expected a number"]),
    ("value: 0.5", "value: 0.5, rtol: -1", 12, ["rtol", "not negative"]),
]


@pytest.mark.parametrize(("old", "new", "line", "words"), WRONG, ids=[f"{i}-{w[1][:30]}" for i, w in enumerate(WRONG)])
def test_a_wrong_study_is_one_sentence(tmp_path, old, new, line, words):
    assert old in GOOD
    file = write(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(StudyError) as caught:
        open_study(file)
    message = str(caught.value)
    assert message.startswith(str(file))
    assert caught.value.line == line, message
    for word in words:
        assert word in message, message
    assert "\n" not in message
    assert len(message) < 1000


def test_choices_are_listed_once(tmp_path):
    with pytest.raises(StudyError, match=r"expected one of rigid, linearized, 1, 2, 3, 4, flexible, continuum, auto$"):
        open_study(write(tmp_path, GOOD.replace("model: rigid\n", "model: 5\n", 1)))


def test_an_empty_expect_needs_a_list(tmp_path):
    with pytest.raises(StudyError, match=r"expect is nothing; expected a list$"):
        open_study(write(tmp_path, GOOD.split("  - {quantity")[0]))


def test_a_character_that_is_no_text_is_named_with_its_line(tmp_path):
    with pytest.raises(StudyError, match=r"the character '\\x00' is not allowed") as caught:
        open_study(write(tmp_path, GOOD.replace("model: rigid", "model: \0", 1)))
    assert caught.value.line == 6


@pytest.mark.parametrize(
    ("source", "kind"),
    [([], "list"), (["study.yaml"], "list"), (5, "int"), (None, "nothing"), (0.5, "float")],
)
def test_a_study_is_a_file_or_a_mapping(source, kind):
    with pytest.raises(StudyError, match=rf"a study is a file or a mapping, not .*\b{kind}$"):
        open_study(source)


def test_a_mapping_has_no_lines_but_the_same_sentences():
    with pytest.raises(StudyError, match="did you mean 'block'") as caught:
        open_study({"name": "a", "case": {"blok": {"R": 1, "alpha": 0.1}}})
    assert caught.value.file is None


def test_the_axis_point_of_a_bad_case_is_named(tmp_path):
    text = GOOD.replace("{R: 5.0, tan_alpha: 0.2}", "{R: 5.0, h: 0.9*gamma}").replace(
        "block.tan_alpha: [0.1, 0.2, 0.333]", "let.gamma: [1, 5, 6]"
    )
    text = text.split("expect:")[0]
    with pytest.raises(StudyError, match=r"case\.block\.h.*smaller than R.*let\.gamma = 6"):
        open_study(write(tmp_path, text))


class TestOverrides:
    def test_values_are_yaml_and_displace_their_alternatives(self, tmp_path):
        file = write(tmp_path, GOOD)
        sets = [("case.block.R", "1e1"), ("case.motion.pulse.a_p_over_g_tan_alpha", "2"), ("name", "other")]
        study = open_study(file, overrides=sets)
        assert study.name == "other"
        assert study.resolved["case"]["block"]["R"] == 10.0
        assert "a_p" not in study.resolved["case"]["motion"]["pulse"]

    def test_short_forms_are_written_out_before(self, tmp_path):
        study = open_study(write(tmp_path, GOOD), overrides=[("case.damping.eta", "0.9"), ("case.solver.rtol", "1e-9")])
        assert study.resolved["case"]["damping"] == {"scheme": "restitution", "eta": 0.9}
        (_, batch), *_ = study.batches()
        assert (batch.damping.eta == 0.9).all()
        assert batch.numerics.rtol == 1e-9

    def test_axes_may_be_set(self, tmp_path):
        study = open_study(write(tmp_path, GOOD), overrides=[("vary.block.tan_alpha", "[0.2, 0.3]")])
        assert study.axes[0].values == (0.2, 0.3)

    def test_inputs_may_be_made_uncertain(self, tmp_path):
        told = [
            ("uncertain.block.R", "{normal: [10, 1]}"),
            ("uncertain.block.R", "{uniform: [9, 11]}"),
            ("samples", "4"),
        ]
        study = open_study(write(tmp_path, GOOD), overrides=told)
        assert study.uncertain is not None
        (read,) = study.uncertain.inputs
        assert read.path == "block.R"
        assert ((read.values > 9.0) & (read.values < 11.0)).all()
        assert open_study(write(tmp_path, GOOD), overrides=[*told[:1], ("uncertain.block.R", "null")]).uncertain is None

    def test_what_is_varied_is_said_to_have_no_effect(self, tmp_path):
        study = open_study(write(tmp_path, GOOD), overrides=[("case.block.tan_alpha", "0.5")])
        assert "no effect" in study.warnings[0]

    @pytest.mark.parametrize(
        ("path", "value", "words"),
        [
            ("block.R", "2", "did you mean 'case.block.R'"),
            ("case.block.r", "2", "did you mean 'case.block.R'"),
            ("R", "2", "did you mean 'case.block.R'"),
            ("a_p", "2", "did you mean 'case.motion.pulse.a_p'"),
            ("plot", "[]", "did you mean 'plots'"),
            ("case.block.R", "[1", "not YAML"),
            ("case.block.R", "big", "`big` is not known"),
            ("nothing", "2", "not a key of a study"),
            ("save.dtout", "2", "did you mean 'dt_out'"),
            ("uncertain.block.r", "{normal: [10, 1]}", "did you mean 'block.R'"),
            ("", "2", "not a key of a study"),
        ],
    )
    def test_wrong_ones_name_the_option(self, tmp_path, path, value, words):
        with pytest.raises(StudyError) as caught:
            open_study(write(tmp_path, GOOD), overrides=[(path, value)])
        assert words in str(caught.value)
        assert str(caught.value).startswith("--set ")


def test_the_json_schema_describes_every_key():
    schema = json_schema()
    json.dumps(schema)
    for part in (schema, *schema["$defs"].values()):
        for name, key in part.get("properties", {}).items():
            assert key.get("description"), name
    assert "restitution" in json.dumps(schema["$defs"]["CasePart"]["properties"]["damping"])
    assert schema["$defs"]["BlockPart"]["properties"]["R"]["anyOf"][0]["type"] == ["number", "string"]
    assert schema["additionalProperties"] is False


WRONG_TOGETHER = """\
name: together
case:
  block: {height: 2.0, width: 0.5}
  motion:
    record: {file: nowhere.AT2, pga: 1}
  initial: {theta: 3}
  solver: {rtol: 0}
vary:
  block.mu: [0.3, -0.4, 0.5, -0.6]
  motion.record.file:
    - synthetic_rock_m65.AT2
    - lost.AT2
    - gone.AT2
"""


def test_what_is_wrong_in_several_cases_and_pieces_is_told_at_once(tmp_path):
    with pytest.raises(StudyError) as caught:
        open_study(write(tmp_path, WRONG_TOGETHER))
    first, *others = str(caught.value).splitlines()
    assert "study.yaml:6: case.initial.theta = 3: must be between" in first
    begins = [
        "  line 7: case.solver.rtol = 0: must be",
        "  line 9: case.block.mu = -0.4: must",
        "  line 9: case.block.mu = -0.6: must",
        "  line 12: the record 'lost.AT2' was not found",
        "  line 13: the record 'gone.AT2' was not found",
    ]
    assert len(others) == len(begins), others
    assert [other.startswith(begin) for other, begin in zip(others, begins, strict=True)] == [True] * len(begins)


def test_the_same_fault_at_several_lines_is_told_once_with_its_lines(tmp_path):
    """And leaves room for others, however often it is met."""
    wrong = "".join(
        f"    n{i}: {{motion: {{record: {{file: bad.csv, pga: {i}*g*tan_alpha}}}}}}\n" for i in range(1, 11)
    )
    (tmp_path / "bad.csv").write_text("0.0;0.1\n0.1;0.2\n")
    vary = f"vary:\n  case:\n{wrong}    last: {{damping.eta: 3}}\n    least: {{damping.eta: 3}}\n  model: [rigid, 1]\n"
    case = "case:\n  block: {height: 2.0, width: 0.5}\n  motion: {pulse: {shape: sine, a_p: 3, T_p: 1}}\n"
    with pytest.raises(RecordError) as caught:
        open_study(write(tmp_path, f"name: alike\n{case}{vary}"))
    first, *others = str(caught.value).splitlines()
    assert "study.yaml:7: case.motion.record.file: " in first
    assert first.endswith(" (also in lines 8, 9, 10, 11, 12, 13, 14, 15, ...)")
    (other,) = others
    assert other.startswith("  line 17: case.damping.eta = 3: must be between 0 and 1 (at case = last, model = ")
    assert other.endswith(") (also in line 18)")


def test_records_alone_that_are_missing_are_told_at_once_and_may_be_passed_over(tmp_path):
    text = WRONG_TOGETHER.replace("theta: 3", "theta: 0").replace("rtol: 0", "rtol: 1e-9").replace("-0.", "1.")
    with pytest.raises(MissingRecordError, match=r"(?s):12: the record 'lost.AT2'.*Searched.*line 13: .*gone.AT2"):
        open_study(write(tmp_path, text))


def test_wrong_axes_are_told_at_once(tmp_path):
    vary = "vary:\n  case: cab.csv\n  block.wide: [1]\n  block.mu: [1, 1]\n  motion.record.file: 'no/*.AT2'\n"
    with pytest.raises(StudyError) as caught:
        open_study(write(tmp_path, WRONG_TOGETHER.partition("vary:")[0] + vary))
    first, *others = str(caught.value).splitlines()
    assert first.endswith("study.yaml:9: the table " + str(tmp_path / "cab.csv") + " does not exist")
    assert [other.split(":")[0] for other in others] == ["  line 10", "  line 11", "  line 12"]


def test_no_more_is_told_than_is_read(tmp_path):
    names = ", ".join(f"lost{i}.AT2" for i in range(30))
    vary = f"vary:\n  motion.record.file: [{names}]\n"
    with pytest.raises(MissingRecordError) as caught:
        open_study(write(tmp_path, WRONG_TOGETHER.partition("  initial")[0] + vary))
    assert str(caught.value).count("was not found") == 8


def test_clauses_that_say_nothing_are_told_at_once(tmp_path):
    clauses = "expect:\n  - {quantity: theta_pea, max: 1}\n  - {quantity: outcome, is: rockin}\n"
    with pytest.raises(StudyError) as caught:
        open_study(write(tmp_path, GOOD.partition("expect:")[0] + clauses))
    first, other = str(caught.value).splitlines()
    assert ":12: " in first
    assert other.startswith("  line 13: ")
