"""Whatever stands in a file, it is a study or one clear error, never a traceback."""

import contextlib
import copy
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rockcli.errors import RecordError, StudyError
from rockcli.study.document.expressions import ExpressionError, constant, parse
from rockcli.study.open import open_study
from rockcli.study.study import Study

FAST = settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

TEXT = """\
name: fuzz
let: {gamma: 5}
case:
  g: 9.81
  block:  {h: 5.0, b: [1, 0.9], r_g: 3, top: 10}
  motion:
    pulse: {shape: sine, a_p: 3.6*g*tan_alpha, omega_p: 2*pi, cycles: 2, t0: 0.1}
    duration: 10
  initial: {theta: 0.1*alpha}
  model: rigid
  damping: {eta: 0.9}
  solver: {accuracy: draft, rtol: 1e-9}
vary:
  block.h: [4, 5, 6]
  motion.pulse.T_p: {from: 0.1, to: 2, n: 3, spacing: log}
  model: [rigid, linearized]
  case: {a: {let: 3}, b: {g: 3}}
compare_to: {model: rigid}
save: {histories: true, dt_out: 0.005, scalars: [outcome]}
plots: [histories]
expect:
  - {quantity: outcome, at: {block.h: 5}, is: [no_uplift, rocking]}
"""

TREE = {
    "name": "fuzz",
    "let": {"gamma": 5},
    "case": {
        "g": 9.81,
        "block": {"h": 5.0, "b": [1, 0.9], "r_g": 3, "top": 10},
        "motion": {
            "pulse": {"shape": "sine", "a_p": "3.6*g*tan_alpha", "omega_p": "2*pi", "cycles": 2},
            "duration": 10,
        },
        "initial": {"theta": "0.1*alpha"},
        "model": "rigid",
        "damping": {"eta": 0.9},
        "solver": {"accuracy": "draft", "rtol": 1e-9},
    },
    "vary": {
        "block.h": [4, 5, 6],
        "motion.pulse.T_p": {"from": 0.1, "to": 2, "n": 3, "spacing": "log"},
        "model": ["rigid", "linearized"],
        "case": {"a": {"block.mu": 0.3}, "b": {"g": 3}},
    },
    "compare_to": {"model": "rigid"},
    "save": {"histories": True, "dt_out": 0.005, "scalars": ["outcome"]},
    "plots": ["histories"],
    "expect": [{"quantity": "outcome", "at": {"block.h": 5}, "is": ["no_uplift", "rocking"]}],
}

WORDS = st.sampled_from(
    [
        "R",
        "h",
        "b",
        "alpha",
        "tan_alpha",
        "block",
        "motion",
        "pulse",
        "record",
        "vertical",
        "file",
        "a_p",
        "T_p",
        "eta",
        "model",
        "case",
        "let",
        "vary",
        "none",
        "housner",
        "rigid",
        "3",
        "from",
        "to",
        "n",
        "find",
        "value",
        "min",
        "is",
        "at",
        "*.txt",
        "x.csv",
        ".",
        "..",
        "/dev/null",
        "/",
    ]
)
ODD = st.sampled_from([-1, 0, 1e308, 1e-308, 10**400, "2*pi", "R", "p", "gamma", "1/0", "(", "9**9**9", "a.b"])
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | WORDS | st.text(max_size=8) | ODD
VALUES = st.recursive(
    SCALARS,
    lambda v: st.lists(v, max_size=3) | st.dictionaries(WORDS | st.text(max_size=5), v, max_size=3),
    max_leaves=6,
)


def survives(source, overrides=()):
    said = "a study"
    try:
        study = open_study(source, overrides=overrides)
        for _ in study.batches():
            pass
        assert isinstance(study, Study)
    except (StudyError, RecordError) as error:
        said = str(error)
    assert 0 < len(said) < 5000


def test_the_trees_are_good_to_begin_with():
    assert open_study(TREE).size == 36


@FAST
@given(data=st.binary(max_size=200) | st.text(max_size=200).map(lambda t: t.encode("utf-8", "surrogatepass")))
def test_any_bytes(data, tmp_path):
    file = tmp_path / "study.yaml"
    file.write_bytes(data)
    survives(file)


@FAST
@given(data=st.data())
def test_a_study_with_a_few_characters_changed(data, tmp_path):
    text = TEXT
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        gone = data.draw(st.integers(0, 12))
        put = data.draw(st.text("[]{}:,-&*!|>'\"%@`#?~ \n\t.019eRphgb_", max_size=4) | st.text(max_size=2))
        text = text[:at] + put + text[at + gone :]
    file = tmp_path / "study.yaml"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    survives(file)


def nodes(tree, path=()):
    yield path
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield from nodes(value, (*path, key))


@settings(FAST, max_examples=500)
@given(data=st.data())
def test_a_study_with_parts_exchanged(data):
    tree = copy.deepcopy(TREE)
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from([p for p in nodes(tree) if p]))
        at = tree
        for key in path[:-1]:
            at = at[key]
        if isinstance(at, dict) and data.draw(st.booleans()):
            at[data.draw(WORDS)] = at.pop(path[-1])
        else:
            at[path[-1]] = data.draw(VALUES)
    survives(tree)


@FAST
@given(path=st.lists(WORDS, max_size=4).map(".".join) | st.text(max_size=10), value=st.text(max_size=10) | WORDS)
def test_any_override(path, value):
    survives(TREE, [(path, value)])


@settings(FAST, max_examples=300)
@given(text=st.text("0123456789.e+-*/() Rpg_sincoqrt,'[]{}:=<>%@!~^&|\\\n\"", max_size=40) | st.text(max_size=40))
def test_any_expression(text):
    with contextlib.suppress(ExpressionError):
        parse(text).evaluate(constant)


def test_files_that_are_no_studies():
    files = sorted((Path(__file__).parents[2] / "records").glob("*.AT2"))
    for file in files:
        with pytest.raises(StudyError):
            open_study(file)
