"""What a study says of its results is matched to its axes before anything is solved."""

import numpy as np
import pytest
import yaml

from rockcli.errors import StudyError
from rockcli.study.open import open_study
from rockcli.study.reopen import clauses_of


def expect_of(*clauses, **more):
    case = {"block": {"R": 5.0, "tan_alpha": 0.2}}
    vary = {
        "block.tan_alpha": {"from": 0.1, "to": 0.7, "n": 7},
        "model": ["rigid", "linearized"],
        "damping": {"a/one.AT2": "none", "two": "restitution"},
    }
    return open_study({"name": "a", "case": case, "vary": vary, "expect": list(clauses), **more})


@pytest.mark.parametrize(
    ("at", "matched"),
    [
        ({}, {}),
        ({"block.tan_alpha": 0.3}, {"tan_alpha": 0.1 + 2 * 0.1}),
        ({"tan_alpha": "0.1*3"}, {"tan_alpha": 0.3}),
        ({"case.block.tan_alpha": 0.3 * (1 + 5e-10)}, {"tan_alpha": 0.3}),
        ({"model": "rigid"}, {"model": "rigid"}),
        ({"damping": "a/one.AT2", "model": "linearized"}, {"damping": "a/one.AT2", "model": "linearized"}),
    ],
)
def test_points_are_matched_to_coordinates(at, matched):
    study = expect_of({"quantity": "theta_peak", "at": at, "value": 0.1})
    (clause,) = study.expect
    assert clause.at == pytest.approx(matched, rel=1e-12) if "tan_alpha" in matched else clause.at == matched
    for name, value in clause.at.items():
        assert value in next(axis.values for axis in study.axes if axis.name == name)


@pytest.mark.parametrize(
    ("at", "words"),
    [
        ({"block.tan_alpha": 0.3 * (1 + 1e-8)}, "no point of that axis"),
        ({"block.tan_alpha": "rigid"}, "no point of that axis"),
        ({"model": 0.3}, "no point of that axis; it has rigid, linearized"),
        ({"R": 5}, "is on no axis"),
        ({"modell": "rigid"}, "did you mean 'model'"),
        ({"damping": "one.AT2"}, "no point of that axis; it has a/one.AT2, two"),
        ({"damping": "b/one.AT2"}, "no point of that axis"),
        ({"damping": "b/two"}, "no point of that axis"),
    ],
)
def test_no_match_is_an_error(at, words):
    with pytest.raises(StudyError, match=words):
        expect_of({"quantity": "theta_peak", "at": at, "value": 0.1})


@pytest.mark.parametrize("said", ["q.txt", "a/q.txt"])
def test_a_record_is_named_by_its_label_or_as_in_the_study(said, tmp_path):
    for name in ("a/q.txt", "a/r.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("0 0\n0.01 3\n0.02 0\n")
    given = {
        "name": "s",
        "case": {"block": {"R": 5.0, "tan_alpha": 0.2}, "motion": {"record": {"units": "m/s2"}}},
        "vary": {"motion.record.file": "a/*.txt"},
        "expect": [{"quantity": "outcome", "is": "rocking", "at": {"record": said}}],
    }
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
    study = open_study(tmp_path / "s.yaml")
    axes = [(axis.name, axis.path, np.array(axis.values, dtype=object)) for axis in study.axes]
    for (clause,) in (study.expect, clauses_of(study.resolved_yaml, axes, ())):  # as opened, and from the dataset
        assert clause.at == {"record": "q.txt"}
    given["expect"][0]["at"]["record"] = f"b/{said}"
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(given))
    with pytest.raises(StudyError, match=r"no point of that axis; it has q\.txt, r\.txt"):
        open_study(tmp_path / "s.yaml")


@pytest.mark.parametrize(
    ("meaning", "flags"),
    [
        ("rocking", (1,)),
        ("overturned", (2, 3)),
        (["no_uplift", "overturned"], (0, 2, 3)),
        (["overturned_after_impact", "overturned"], (3, 2)),
        ("failed", (-2,)),
    ],
)
def test_meanings(meaning, flags):
    (clause,) = expect_of({"quantity": "outcome", "is": meaning}).expect
    assert (clause.check, clause.target) == ("is", flags)
    (clause,) = expect_of({"quantity": "outcome", "is_not": meaning}).expect
    assert (clause.check, clause.target) == ("is_not", flags)


@pytest.mark.parametrize("meaning", ["fell", ["rocking", 5], [], 3, {"a": 1}])
def test_unknown_meanings(meaning):
    with pytest.raises(StudyError, match=r"outcome|known|empty|did you mean|is 3|mapping"):
        expect_of({"quantity": "outcome", "is": meaning})


def test_numbers():
    clauses = expect_of(
        {"quantity": "theta_peak_over_alpha", "value": ".5", "rtol": "1e-3", "atol": 1e-9, "references": "Fig. 1"},
        {"quantity": "theta_peak_over_alpha", "value": float("inf")},
        {"quantity": "n_impacts", "min": 3},
        {"quantity": "theta", "time": "250*ms", "max": "2*deg"},
    ).expect
    assert (clauses[0].target, clauses[0].rtol, clauses[0].atol, clauses[0].references) == (0.5, 1e-3, 1e-9, "Fig. 1")
    assert (clauses[0].rtol, clauses[1].rtol) == (1e-3, 1e-6)
    assert clauses[1].target == float("inf")
    assert (clauses[2].check, clauses[2].target) == ("min", 3.0)
    assert (clauses[3].time, clauses[3].check) == (0.25, "max")


def test_an_axis_may_be_named_by_the_end_of_its_path():
    pulse = {"shape": "sine", "a_p": 3, "T_p": 1}
    more = {"case": {"block": {"R": 5.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse, "vertical": {"pulse": pulse}}}}
    vary = {"motion.pulse.a_p": ["0.3*g", "0.5*g"], "motion.vertical.pulse.a_p": [1, 2], "motion.pulse.T_p": [1, 2]}
    clause = {"quantity": "pga", "at": {"pulse.T_p": 1}, "min": 0}
    assert expect_of(clause, **more, vary={"motion.pulse.T_p": [1, 2]}).expect[0].at == {"T_p": 1}
    one = expect_of(clause | {"at": {"a_p": "0.5*g"}}, **more, vary={"motion.pulse.a_p": vary["motion.pulse.a_p"]})
    assert list(one.expect[0].at.values()) == pytest.approx([0.5 * 9.81])
    with pytest.raises(StudyError, match=r"at\.a_p is on no axis"):  # two end so
        expect_of(clause | {"at": {"a_p": 1}}, **more, vary=vary)


def test_what_is_expected_may_be_an_expression_of_every_case():
    study = expect_of({"quantity": "pga", "max": "0.3*g"}, {"quantity": "theta_peak", "value": "R/m*0.02", "rtol": 0.1})
    assert [clause.target for clause in study.expect] == pytest.approx([0.3 * 9.81, 0.1], rel=1e-12)
    again = clauses_of(study.resolved_yaml, [(a.name, a.path, np.array(a.values)) for a in study.axes], ())
    assert [clause.target for clause in again] == [clause.target for clause in study.expect]
    for wrong in ("0.3*gg", "tan_alpha*2"):
        with pytest.raises(StudyError, match=r"expect\[0\]\.max is .*; expected a number \("):
            expect_of({"quantity": "pga", "max": wrong})


def test_an_exact_match_goes_before_a_near_one():
    values = [1.0, 1.0 + 1.5e-9]
    case = {"block": {"R": 5.0, "tan_alpha": 0.2}}
    for i, said in enumerate((*values, 1.0 + 0.9e-9)):
        clause = {"quantity": "theta_peak", "at": {"block.R": said}, "value": 0.1}
        study = open_study({"name": "a", "case": case, "vary": {"block.R": values}, "expect": [clause]})
        assert study.expect[0].at == {"block_R": values[min(i, 1)]}


class TestHistoriesThatAreNotSaved:
    @staticmethod
    def study(at, save):
        clause = {"quantity": "theta", "at": at, "time": 1, "max": 1}
        case = {"block": {"R": 2.0, "tan_alpha": 0.2}}
        vary = {"block.R": [1, 2], "model": ["rigid", "linearized"]}
        return open_study({"name": "a", "case": case, "vary": vary, "save": save, "expect": [clause]})

    @pytest.mark.parametrize("at", [{"block.R": 1}, {"block.R": 1, "model": "rigid"}, {}, {"model": "rigid"}])
    def test_are_not_judged(self, at):
        words = r"expect\[0\] needs the history of theta at block\.R = 1; save\.histories keeps block\.R = 2 only"
        with pytest.raises(StudyError, match=words):
            self.study(at, {"histories": {"block.R": 2}})

    def test_nor_if_there_are_none(self):
        with pytest.raises(StudyError, match="no histories are saved"):
            self.study({}, {"histories": False})

    def test_those_saved_are(self):
        assert len(self.study({"block.R": 2}, {"histories": {"block.R": 2}}).expect) == 1
        assert len(self.study({}, {"histories": True}).expect) == 1


def test_compare_to():
    assert expect_of(compare_to={"model": "rigid"}).compare_to == {"model": "rigid"}
    assert expect_of().compare_to is None
    with pytest.raises(StudyError, match=r"compare_to\.model"):
        expect_of(compare_to={"model": "3"})
