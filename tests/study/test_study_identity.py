"""What changes numbers identifies results; what does not, does not."""

import copy

import pytest
import yaml

from rockcli.study.differences import differences
from rockcli.study.document.loader import load_value
from rockcli.study.open import open_study

BASE = {
    "name": "base",
    "case": {
        "block": {"R": 5, "tan_alpha": 0.2},
        "motion": {"pulse": {"shape": "ricker", "a_p": "3.6*g*tan_alpha", "omega_p": "gamma"}},
    },
    "let": {"gamma": "2*pi"},
    "vary": {"block.R": [1, 2, 3], "model": ["rigid", "linearized"]},
}


def changed(**paths):
    study = copy.deepcopy(BASE)
    for path, value in paths.items():
        *head, last = path.split("__")
        at = study
        for key in head:
            at = at.setdefault(key.replace("_o_", "."), {})
        at[last.replace("_o_", ".")] = value
    return open_study(study).identity


IDENTITY = open_study(BASE).identity


@pytest.mark.parametrize(
    "change",
    [
        {"title": "other"},
        {"references": "nowhere"},
        {"name": "other"},
        {"plots": ["histories"]},
        {"expect": [{"quantity": "n_impacts", "min": 0}]},
        {"compare_to": {"model": "rigid"}},
        {"case__g": 9.81},
        {"case__block__R": 5.0},
        {"case__damping": "restitution"},
        {"case__damping": {"scheme": "restitution"}},
        {"case__model": "rigid"},
        {"case__initial": {"theta": 0}},
        {"vary__block_o_R": [1.0, "2*m", 3]},
        {"vary__block_o_R": {"from": 1, "to": 3, "n": 3}},
        {"save": {"histories": True}},
    ],
    ids=str,
)
def test_what_changes_no_number_changes_nothing(change):
    assert changed(**change) == IDENTITY


@pytest.mark.parametrize(
    "change",
    [
        {"case__g": 9.8},
        {"case__block__tan_alpha": 0.21},
        {"case__damping": "none"},
        {"case__damping": {"eta": 0.9}},
        {"case__solver": {"accuracy": "draft"}},
        {"case__motion__duration": 3},
        {"let__gamma": 6},
        {"let__delta": 6},
        {"vary__block_o_R": [1, 2, 3.1]},
        {"vary__block_o_R": [3, 2, 1]},
        {"vary__model": ["linearized", "rigid"]},
        {"vary__damping": ["none"]},
        {"save": {"dt_out": 0.001}},
        {"save": {"histories": False}},
        {"save": {"scalars": ["outcome"]}},
    ],
    ids=str,
)
def test_what_changes_numbers_changes_the_identity(change):
    assert changed(**change) != IDENTITY


def test_the_order_of_axes_counts_and_that_of_keys_does_not():
    study = copy.deepcopy(BASE)
    study["vary"] = dict(reversed(study["vary"].items()))
    assert open_study(study).identity != IDENTITY
    study = copy.deepcopy(BASE)
    study["case"] = dict(reversed(study["case"].items()))
    assert open_study(study).identity == IDENTITY


def test_a_null_inside_a_setting_counts():
    """`{mu: null}` takes the friction of the base case away, `{}` leaves it there."""
    one, other = (
        open_study(
            {
                "name": "one",
                "case": {"block": {"R": 2, "tan_alpha": 0.2, "mu": 0.15}, "initial": {"theta": 0.1}},
                "vary": {"block": {"a": first, "b": {"mu": 0.3}, "as it is": {"top": 3}}},
            }
        )
        for first in ({"mu": None}, {})
    )
    (_, without), (_, left) = next(one.batches()), next(other.batches())
    assert without.block.mu[0] != left.block.mu[0] == 0.15
    assert one.identity != other.identity
    assert one.sweep_id != other.sweep_id


def test_the_version_of_the_program_counts(monkeypatch):
    monkeypatch.setattr("rockcli.version.__version__", "99.0")
    assert open_study(BASE).identity != IDENTITY


def test_the_bytes_of_a_record_count(tmp_path):
    study = {
        "name": "a",
        "case": {"block": {"R": 5, "tan_alpha": 0.2}, "motion": {"record": {"file": "q.txt", "units": "g"}}},
    }
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(study))
    (tmp_path / "q.txt").write_text("0.0 0.0\n0.01 0.1\n0.02 0.0\n")
    first = open_study(tmp_path / "s.yaml")
    (tmp_path / "q.txt").write_text("0.0 0.0\n0.01 0.2\n0.02 0.0\n")
    second = open_study(tmp_path / "s.yaml")
    assert first.identity != second.identity
    assert first.inputs.keys() == second.inputs.keys() == {"q.txt"}


def test_the_resolved_study_runs_again(tmp_path):
    given = copy.deepcopy(BASE)
    given |= {"title": "on: yes, 12:30", "expect": [{"quantity": "outcome", "is": "rocking", "at": {"model": "rigid"}}]}
    given["vary"]["case"] = {"1e-3": {"block.mu": 0.5}, "on": {"block.mu": 0.6}}
    study = open_study(given)
    (tmp_path / "again.yaml").write_text(study.resolved_yaml)
    again = open_study(tmp_path / "again.yaml")
    assert again.identity == study.identity
    assert again.resolved_yaml == study.resolved_yaml
    assert again.expect == tuple(type(e)(**{**vars(e), "line": again.expect[0].line}) for e in study.expect)
    assert again.axes == study.axes
    assert load_value(study.resolved_yaml, "x") == study.resolved


def test_the_resolved_study_says_the_seed_that_is_the_default():
    """A seed of 0 is equal to a key that is off, and was left out; datasets from before do not differ in it."""
    uncertain = {"block.tan_alpha": {"normal": [0.2, 0.01]}}
    study = open_study({"name": "x", "case": BASE["case"], "let": BASE["let"], "uncertain": uncertain})
    assert (study.resolved["seed"], study.resolved["samples"]) == (0, 200)
    before = study.resolved_yaml.replace("seed: 0\n", "")
    assert before != study.resolved_yaml
    assert differences(before, study.resolved, {}, {}) == ""
    assert differences(before, study.resolved | {"seed": 1}, {}, {}) == "seed (0 -> 1)"


@pytest.mark.parametrize(
    "vary",
    [
        {"case": {"still": {"motion": None}, "moved": {"block.mu": 0.5}}},
        {"motion": {"still": None, "moved": {"pulse": {"shape": "sine", "a_p": 3, "T_p": 1}}}},
    ],
    ids=["settings", "named"],
)
def test_a_setting_of_nothing_runs_again(vary, tmp_path):
    study = open_study(copy.deepcopy(BASE) | {"vary": vary})
    (tmp_path / "again.yaml").write_text(study.resolved_yaml)
    again = open_study(tmp_path / "again.yaml")
    assert (again.identity, again.axes) == (study.identity, study.axes)
    assert [batch.excitation.horizontal is None for _, batch in again.batches()] == [True, False]


def test_defaults_and_short_forms_are_written_out():
    case = open_study(
        {"name": "a", "case": {"block": {"R": 1, "alpha": 0.2}, "damping": "none", "model": "rigid"}}
    ).resolved["case"]
    assert case["g"] == 9.81
    assert case["damping"] == {"scheme": "none"}
    assert case["solver"]["accuracy"] == "standard"
