"""The schema for editors, by a validator of JSON Schema alone: wrong studies are caught, none of the project's is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from rockcli.errors import RecordError, StudyError
from rockcli.study.document.loader import load_file
from rockcli.study.document.paths import resolve
from rockcli.study.editor_schema import DIALECT, EXPRESSION, IDENTIFIER, editor_schema
from rockcli.study.open import open_study

jsonschema = pytest.importorskip("jsonschema", reason="a validator of JSON Schema: pip install -e '.[dev]'")

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = editor_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)

GOOD = """\
name: good
case:
  block: {R: 5.0, tan_alpha: 0.2}
  motion: {pulse: {shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 2*pi}}
  damping: restitution
expect:
  - {quantity: outcome, is: rocking}
"""

VARIED = GOOD + "vary:\n  motion.pulse.a_p: [1, 2, 3*m/s**2]\n"

RECORD = GOOD.replace(
    "{pulse: {shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 2*pi}}", "{record: {file: a.csv, units: g}}"
)

KINDS = {
    "unknown key": (GOOD, "damping:", "dampin:"),
    "missing name": (GOOD, "name: good\n", ""),
    "wrong type": (GOOD, "{R: 5.0,", "{R: [5.0],"),
    "unknown word": (GOOD, "damping: restitution", "damping: restitutio"),
    "pulse and record": (GOOD, "{pulse:", "{record: a.csv, pulse:"),
    "two amplitudes": (GOOD, "a_p: 3.6*g*tan_alpha", "a_p: 3, a_p_over_g_tan_alpha: 2"),
    "no frequency": (GOOD, ", omega_p: 2*pi", ""),
    "option of another pulse": (GOOD, "omega_p: 2*pi", "omega_p: 2*pi, cycles: 3"),
    "key of another damping scheme": (GOOD, "damping: restitution", "damping: {scheme: dashpot, eta: 0.9}"),
    "block over-determined": (GOOD, "{R: 5.0, tan_alpha: 0.2}", "{R: 5.0, h: 3, tan_alpha: 0.2}"),
    "block under-determined": (GOOD, "{R: 5.0, tan_alpha: 0.2}", "{R: 5.0}"),
    "angle in degrees": (GOOD, "tan_alpha: 0.2}", "alpha: 11}"),
    "negative size": (GOOD, "R: 5.0", "R: -5.0"),
    "no expression": (GOOD, "2*pi", "2 pi"),
    "unknown path of an axis": (VARIED, "motion.pulse.a_p:", "motion.puls.a_p:"),
    "unfinished range": (VARIED, "[1, 2, 3*m/s**2]", "{from: 1, to: 3}"),
    "unknown quantity": (GOOD, "quantity: outcome, is: rocking", "quantity: theta_peak_over_alfa, max: 1"),
    "unknown outcome": (GOOD, "is: rocking", "is: toppled"),
    "unknown unit of a record": (RECORD, "units: g", "units: furlong/s2"),
    "two checks in a clause": (GOOD, "is: rocking", "is: rocking, max: 2"),
    "unknown symbol": (GOOD, "3.6*g*tan_alpha", "3.6*g*tan_alfa"),
    "no such point": (VARIED, "is: rocking", "is: rocking, at: {a_p: 7}"),
}
"""What is wrong: a good study, what is replaced, and by what."""

LEFT_TO_CHECK = {"unknown symbol", "no such point"}
"""What only a case can tell."""


def plain(tree):
    """Ordinary mappings and lists, as a validator knows them."""
    if isinstance(tree, dict):
        return {key: plain(item) for key, item in tree.items()}
    return [plain(item) for item in tree] if isinstance(tree, list) else tree


def loaded(file, text):
    file.write_text(text, encoding="utf-8")
    return plain(load_file(file))


def complaint(study):
    found = jsonschema.exceptions.best_match(VALIDATOR.iter_errors(study))
    return None if found is None else f"{list(found.absolute_path)}: {found.message[:200]}"


def test_it_is_a_schema_and_says_which():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert (SCHEMA["$schema"], SCHEMA["$id"]) == (DIALECT, IDENTIFIER)
    assert not [part for part in SCHEMA["$defs"].values() if "title" in part]


@pytest.mark.parametrize("kind", KINDS)
def test_kinds_of_wrong_study(kind, tmp_path):
    good, old, new = KINDS[kind]
    assert old in good
    assert complaint(loaded(tmp_path / "good.yaml", good)) is None
    file = tmp_path / "wrong.yaml"
    wrong = loaded(file, good.replace(old, new, 1))
    (tmp_path / "a.csv").write_text("".join(f"{i / 10}, {i % 3}\n" for i in range(50)), encoding="utf-8")
    with pytest.raises((RecordError, StudyError)):
        open_study(file)
    assert (complaint(wrong) is None) == (kind in LEFT_TO_CHECK)


PULSE = {"shape": "sine", "a_p": 3.0, "T_p": 1.0}
SHAPELESS = {"a_p": 3.0, "T_p": 1.0}
SIZES = {"height": 3.0, "width": 0.6}
FILELESS = {"pga": 3.0}
GIVEN_BY_AXES = {
    "shape": ({"block": SIZES, "motion": {"pulse": SHAPELESS}}, {"motion.pulse.shape": ["sine", "ricker"]}),
    "pulse": ({"block": SIZES, "motion": {"pulse": SHAPELESS}}, {"motion.pulse": {"a": {"shape": "sine"}}}),
    "file": ({"block": SIZES, "motion": {"record": FILELESS}}, {"motion.record.file": "synthetic_*.AT2"}),
    "block": ({"motion": {"pulse": PULSE}}, {"block": {"one": SIZES, "two": {"height": 2.0, "width": 0.5}}}),
    "sizes": ({"motion": {"pulse": PULSE}}, {"block.height": [2.0, 3.0], "block.width": [0.5, 0.6]}),
    "case": ({"motion": {"pulse": PULSE}}, {"case": {"one": {"block": SIZES}}}),
    "friction": (
        {"block": SIZES | {"mu": {"kinetic": 0.3}}, "motion": {"pulse": PULSE}},
        {"block.mu.static": [0.4, 0.5]},
    ),
}
"""A case that lacks a key it needs, and an axis that gives it."""


@pytest.mark.parametrize("kind", GIVEN_BY_AXES)
def test_what_an_axis_gives_need_not_stand_in_the_case(kind):
    case, vary = GIVEN_BY_AXES[kind]
    study = {"name": "good", "case": case, "vary": vary}
    open_study(study)
    assert complaint(study) is None
    for wrong in ({"name": "wrong", "case": case}, study | {"vary": {"motion.duration": [5.0, 9.0]}}):
        with pytest.raises(StudyError, match=r"is missing|under-determined"):
            open_study(wrong)
        assert "is a required property" in str(complaint(wrong))


def test_every_study_of_the_project_is_valid():
    studies = sorted((ROOT / "studies").rglob("*.yaml"))
    found = {study.name: said for study in studies if (said := complaint(plain(load_file(study))))}
    assert len(studies) > 100
    assert not found


def test_every_study_of_the_pages_is_valid(tmp_path):
    found, count = {}, 0
    for page in sorted((ROOT / "docs").rglob("*.md")):
        for block in re.findall(r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.M):
            if block.lstrip().startswith("name:"):
                count += 1
                if said := complaint(loaded(tmp_path / "a.yaml", block)):
                    found[f"{page.name}: {block[:40]}"] = said
    assert count > 20
    assert not found


def test_what_is_listed_for_axes_are_paths():
    vary = SCHEMA["properties"]["vary"]["properties"]
    assert {"block.tan_alpha", "motion.record.pga", "motion.vertical.scale", "model", "case"} <= vary.keys()
    for path in vary:
        resolve(path)


@pytest.mark.parametrize(
    "text", ["2*pi", "3.6*g*tan_alpha", "1e-3", "-0.5*alpha", "sqrt(2)*(R + b)/3", "30*GPa", "2 * p"]
)
def test_expressions(text):
    assert re.search(EXPRESSION, text)


@pytest.mark.parametrize("text", ["2pi", "10 deg", "3 (4)", "5*", "9,81", "2^3", ""])
def test_no_expressions(text):
    assert not re.search(EXPRESSION, text)
