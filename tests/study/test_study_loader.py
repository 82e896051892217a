"""YAML as the study file means it: scalars of YAML 1.2, no duplicate keys, every line kept, nothing harmful."""

import math
import time
from pathlib import Path

import numpy as np
import pytest

from rockcli.errors import StudyError
from rockcli.study.document.loader import load_file, load_mapping, load_value
from rockcli.study.document.tree import place
from rockcli.study.open import open_study


def load(tmp_path: Path, text: str | bytes):
    file = tmp_path / "study.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_file(file)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("0.5e3", 500.0),
        ("1.", 1.0),
        (".5", 0.5),
        ("-2.5E+2", -250.0),
        ("010", 10),
        ("0x1F", 31),
        ("0o17", 15),
        ("12:30", "12:30"),
        ("1_000", "1_000"),
        ("on", "on"),
        ("yes", "yes"),
        ("No", "No"),
        ("true", True),
        ("False", False),
        ("2001-12-14", "2001-12-14"),
        ("=", "="),
        ("<<", "<<"),
        ("~", None),
        ("", None),
        ("'1e-3'", "1e-3"),
        ('"true"', "true"),
        ("2*pi", "2*pi"),
        ("!!str 5", "5"),
        ("99999999999999999999", 1e20),
        (".inf", math.inf),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text, value):
    loaded = load_value(text, "--set x")
    assert loaded == value
    assert type(loaded) is type(value)


def test_nan_is_read():
    assert math.isnan(load_value(".nan", "x"))


def test_keys_are_words_whatever_they_look_like(tmp_path):
    assert load(tmp_path, "{1: a, on: b, null: c, 2.50: d, true: e}") == {
        "1": "a",
        "on": "b",
        "null": "c",
        "2.50": "d",
        "true": "e",
    }


def test_every_key_and_item_knows_its_line(tmp_path):
    tree = load(tmp_path, "a:\n  b: 1\n  c:\n    - 5\n    - {d: 6}\n")
    assert place(tree, ("a", "b")) == 2
    assert place(tree, ("a", "c", 0)) == 4
    assert place(tree, ("a", "c", 1, "d")) == 5
    assert place(tree, ("a", "nothing")) == 1


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a: 1\nb: 2\na: 3\n", 3, "duplicate key 'a' (first on line 1)"),
        ("a: {b: 1, b: 2}\n", 1, "duplicate key 'b'"),
        ("a:\n\tb: 1\n", 2, "tab"),
        ("a: [1, 2\nb: 3\n", 2, "not YAML"),
        ("a: b: c\n", 1, "not YAML"),
        ("a: *nothing\n", 1, "undefined alias"),
        ("a: 1\n---\nb: 2\n", 2, "not YAML"),
        ("? [1, 2]\n: 3\n", 1, "a key is a word"),
        ("a: !!python/object/apply:os.system ['ls']\n", 1, "the tag"),
        ("a: !!float x\n", 1, "the tag"),
        ("- 1\n- 2\n", 1, "a study is a mapping"),
        ("just text\n", 1, "a study is a mapping"),
        ("", None, "empty"),
        ("# nothing\n", None, "empty"),
        ("a: &x [*x]\n", 1, "nested too deeply"),
        ("%YAML 9.9\n---\na: 1\n", 1, "not YAML"),
        (b"a: 1\nb: \xff\xfe\n", 2, "no UTF-8 text"),
        ("name: a\n".encode("utf-16"), 1, "UTF-16 text"),
        ("a:\n  b:\xa02\n  c: 3\n", 2, "no-break space"),
        ("a:\n  c: 3\n  b:\xa02\n", 3, "no-break space"),
        ("a: {b:\xa02, c: 3}\n", 1, "no-break space"),
        ("a:\n\xa0\xa0b: 2\n", 2, "no-break space"),
        (b"\x00\x01\x02\x89HDF\r\n", None, ""),
        ("a: 1\x00\n", None, "not YAML"),
    ],
)
def test_what_is_no_study_is_one_clear_error(tmp_path, text, line, words):
    with pytest.raises(StudyError) as caught:
        load(tmp_path, text)
    assert words in str(caught.value)
    assert caught.value.file.endswith("study.yaml")
    if line is not None:
        assert caught.value.line == line


def test_a_no_break_space_inside_a_name_is_a_letter(tmp_path):
    assert load(tmp_path, "vase\xa03: a\n") == {"vase\xa03": "a"}


def test_a_byte_order_mark_is_no_part_of_the_first_key(tmp_path):
    assert load(tmp_path, b"\xef\xbb\xbfname: a\n") == {"name": "a"}


@pytest.mark.parametrize(
    "text",
    [
        "a: " + "[" * 100_000,
        "a: " + "[" * 200 + "]" * 200,
        "a: " + "{b: " * 5_000,
        "\n".join("  " * i + "a:" for i in range(300)),
        "a: &a [x,x,x,x,x,x,x,x,x]\n"
        + "\n".join(f"{c}: &{c} [{','.join([f'*{p}'] * 9)}]" for p, c in zip("abcdefgh", "bcdefghi", strict=True)),
        "a: " + "x" * 1_100_000,
        "- " * 3_000 + "a",
    ],
    ids=["open", "flow", "braces", "blocks", "aliases", "large", "dashes"],
)
def test_bombs_are_refused_quickly(tmp_path, text):
    start = time.monotonic()
    with pytest.raises(StudyError):
        load(tmp_path, text)
    assert time.monotonic() - start < 20.0  # not a benchmark: a bomb would take for ever


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(StudyError, match="no such file"):
        load_file(tmp_path / "none.yaml")
    with pytest.raises(StudyError, match="is a folder"):
        load_file(tmp_path)
    with pytest.raises(StudyError):
        load_file(Path("nul\0.yaml"))


def test_a_mapping_is_copied_and_made_plain():
    given = {"a": (1, 2), "b": np.float64(0.5), "c": np.array([1.0, 2.0]), "d": Path("x.AT2"), 5: True}
    loaded = load_mapping(given)
    assert loaded == {"a": [1, 2], "b": 0.5, "c": [1.0, 2.0], "d": "x.AT2", "5": True}
    assert type(loaded["b"]) is float
    with pytest.raises(StudyError, match="not a set"):
        load_mapping({"a": {1, 2}})
    for twice in ({1.5: "one", "1.5": "other"}, {0.1: "one", np.float32(0.1): "other"}):
        with pytest.raises(StudyError, match=rf"vary\.block\.{next(iter(twice))}: duplicate key"):
            load_mapping({"vary": {"block": twice}})
    loop: dict = {}
    loop["a"] = loop
    with pytest.raises(StudyError, match="nested too deeply"):
        load_mapping(loop)


def test_a_study_that_holds_itself_is_refused():
    block = {"R": 2, "tan_alpha": 0.2}
    case: dict = {"block": block}
    case |= {"motion": case, "initial": case}
    rows: list = [1]
    rows.append(rows)
    record = {"record": {"values": rows, "dt": 0.1, "units": "g"}}
    for study in ({"case": case}, {"case": {"block": block, "motion": record}}, {"vary": {"block.R": rows}}):
        with pytest.raises(StudyError, match="nested too deeply"):
            open_study({"name": "x", "case": {"block": block}} | study)


def test_what_a_study_cannot_hold_is_named_with_its_key():
    for value in (1j, 2 + 0j, np.complex128(2)):
        with pytest.raises(StudyError, match=r"case\.block\.R: a study holds real numbers, .*, not a complex number"):
            open_study({"name": "x", "case": {"block": {"R": value, "tan_alpha": 0.2}}})
    with pytest.raises(StudyError, match=r"vary\.block\.R\[1\]: a study holds .* not a set"):
        open_study({"name": "x", "case": {"block": {"R": 1, "tan_alpha": 0.2}}, "vary": {"block.R": [1, {2}]}})
