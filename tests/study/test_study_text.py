"""Texts of a study: names that read as numbers, and characters that neither files nor terminals can hold."""

import pytest

from rockcli.errors import StudyError
from rockcli.study.open import open_study

CASE = "case:\n  block: {R: 2, tan_alpha: 0.2}\n  initial: {theta: 0.05}\n"
UNFIT = [r"\ud800", r"\udcff", r"\0", r"\e", r"\x07", r"\x7f", r"\x9b", r"\ufffe"]


def opened(folder, text, overrides=()):
    file = folder / "s.yaml"
    file.write_text(text)
    return open_study(file, overrides=overrides)


class TestNames:
    @pytest.mark.parametrize("name", ["007", "1e3", "0x10", "2024", "1_000", "-3"])
    def test_a_name_stays_as_it_is_written(self, tmp_path, name):
        study = opened(tmp_path, f"name: {name}\ntitle: {name}\n{CASE}")
        assert (study.name, study.title) == (name, name)
        again = opened(tmp_path, study.resolved_yaml)
        assert (again.name, again.title) == (name, name)

    def test_set_too(self, tmp_path):
        study = opened(tmp_path, f"name: x\n{CASE}", [("name", "007"), ("title", "1.50"), ("references", "1e3")])
        assert (study.name, study.title, study.references) == ("007", "1.50", "1e3")

    def test_what_is_no_name_is_refused_still(self, tmp_path):
        for said in ("1.5", "true", "[1]", "{a: 1}"):
            with pytest.raises(StudyError, match="name"):
                opened(tmp_path, f"name: {said}\n{CASE}")


class TestCharacters:
    @pytest.mark.parametrize("written", UNFIT)
    @pytest.mark.parametrize(
        "line",
        [
            'title: "a%sb"',
            'references: "a%sb"',
            'vary: {initial.theta: {"a%sb": 0.05, c: 0.06}}',
            'vary: {case: {"a%sb": {model: rigid}}}',
            'vary: {motion.record.file: ["a%sb.AT2"]}',
            'expect: [{quantity: outcome, is: rocking, references: "a%sb"}]',
        ],
    )
    def test_what_no_text_may_hold_is_refused_where_it_stands(self, tmp_path, line, written):
        with pytest.raises(StudyError, match=r"s\.yaml:2: the character .* is not allowed"):
            opened(tmp_path, f"name: x\n{line % written}\n{CASE}")

    @pytest.mark.parametrize("character", ["\ud800", "\x00", "\x1b", "\ufffe"])
    def test_in_a_mapping_and_in_set(self, character):
        study = {"name": "x", "case": {"block": {"R": 2, "tan_alpha": 0.2}, "initial": {"theta": 0.05}}}
        for more in ({"title": f"a{character}"}, {"vary": {"case": {f"a{character}": {"model": "rigid"}}}}):
            with pytest.raises(StudyError, match="is not allowed"):
                open_study({**study, **more})
        with pytest.raises(StudyError, match="is not allowed"):
            open_study(study, overrides=[("title", f"'a{character}'")])

    @pytest.mark.parametrize("end", [r"\n", r"\r", r"\u2028", r"\t"])
    def test_a_label_is_one_line(self, tmp_path, end):
        with pytest.raises(StudyError, match=r"s\.yaml:2: vary\.initial\.theta has the label"):
            opened(tmp_path, f'name: x\nvary: {{initial.theta: {{"a{end}b": 0.05, c: 0.06}}}}\n{CASE}')

    def test_in_a_table_too(self, tmp_path):
        (tmp_path / "t.csv").write_text('name,initial.theta\n"a\nb",0.05\n')
        with pytest.raises(StudyError, match="is no character of a label"):
            opened(tmp_path, f"name: x\nvary: {{case: t.csv}}\n{CASE}")

    def test_a_record_whose_name_no_text_can_hold(self, tmp_path):
        name = b"a\xff.txt"
        try:
            (tmp_path / name.decode("utf-8", "surrogateescape")).write_text("0 0\n0.01 1\n0.02 0\n")
        except OSError:
            pytest.skip("the file system takes no such name")
        with pytest.raises(StudyError, match="is no character of a label"):
            opened(tmp_path, f'name: x\nvary: {{motion.record.file: "a*.txt"}}\n{CASE}')

    def test_titles_in_several_lines_and_other_alphabets_are_well(self, tmp_path):
        title = "Σχήμα 5\n倾覆 \N{NO-BREAK SPACE}α"
        study = opened(tmp_path, f"name: x\ntitle: |-\n  {title.replace(chr(10), chr(10) + '  ')}\n{CASE}")
        assert study.title == title


class TestSymbols:
    """Values of an axis over a symbol of `let`, one after the other wrong."""

    @pytest.mark.parametrize(
        ("entry", "key", "expected"),
        [
            ("[1, true]", r"\[1\]", "a number or an expression is expected, not True"),
            ("[{a: 1}, 2]", r"\[0\]", "not a mapping"),
            ("{a: 1, b: }", r"\.b", "not nothing"),
            ("{a: 1, b: [1, 2]}", r"\.b", "not a list"),
            ('{a: 1, b: "2*"}', r"\.b", "no arithmetic expression|not an arithmetic expression"),
            ("{a: 1, b: two words}", r"\.b", "not an arithmetic expression"),
        ],
    )
    @pytest.mark.parametrize("use", ["0.05*k", "0.05"])
    def test_are_numbers_or_expressions(self, tmp_path, entry, key, expected, use):
        text = f"name: x\nlet: {{k: 1}}\nvary: {{let.k: {entry}}}\n{CASE.replace('0.05', use)}"
        with pytest.raises(StudyError, match=rf"s\.yaml:3: vary\.let\.k{key}.*({expected})"):
            opened(tmp_path, text)

    @pytest.mark.parametrize("value", ["true", "{a: 1}", "", "[1]", "two words"])
    def test_in_a_setting_of_several_things(self, tmp_path, value):
        with pytest.raises(StudyError, match=r"vary\.case\.a\.let\.k"):
            opened(tmp_path, f"name: x\nlet: {{k: 1}}\nvary: {{case: {{a: {{let.k: {value}}}}}}}\n{CASE}")

    def test_in_a_table(self, tmp_path):
        (tmp_path / "t.csv").write_text("name,let.k\na,1\nb,true\n")
        with pytest.raises(StudyError, match="a number or an expression is expected, not True"):
            opened(tmp_path, f"name: x\nlet: {{k: 1}}\nvary: {{case: t.csv}}\n{CASE.replace('0.05', '0.05*k')}")

    def test_what_can_be_a_symbol_is_one(self, tmp_path):
        text = f"name: x\nlet: {{k: 1}}\nvary: {{let.k: {{a: 1, b: 2*0.5, c: 1e-1}}}}\n{CASE.replace('0.05', '0.05*k')}"
        ((_, batch),) = opened(tmp_path, text).batches()
        assert batch.theta_0 == pytest.approx([0.05, 0.05, 0.005])


class TestSetWithoutEffect:
    """`--set` of what an axis displaces is said to do nothing."""

    @staticmethod
    def said(path, vary, case=None):
        base = {"block": {"R": 2, "tan_alpha": 0.2}, "initial": {"theta": 0.01}, **(case or {})}
        study = open_study({"name": "x", "case": base, "vary": vary}, overrides=[(path, "0.3")])
        return [sentence for sentence in study.warnings if "no effect" in sentence]

    @pytest.mark.parametrize(
        ("vary", "axis"),
        [
            ({"block.tan_alpha": [0.1, 0.2]}, "block.tan_alpha"),
            ({"block.alpha": [0.1, 0.2]}, "block.alpha"),
            ({"block.slenderness": {"from": 4, "to": 6, "n": 3}}, "block.slenderness"),
            ({"case": {"a": {"block": {"h": 1, "b": 0.2}}, "b": {"block.h": 2, "block.b": 0.2}}}, "case"),
            ({"block": {"a": {"alpha": 0.1}, "b": {"slenderness": 5}}}, "block"),
        ],
    )
    def test_is_said(self, vary, axis):
        (sentence,) = self.said("case.block.tan_alpha", vary)
        assert sentence == f"--set case.block.tan_alpha=0.3 has no effect: the study varies {axis}"

    @pytest.mark.parametrize(
        "vary",
        [
            {"block.R": [1, 2]},
            {"block": {"a": {"alpha": 0.1}, "b": {"R": 3}}},
            {"initial.theta": [0.01, 0.02]},
        ],
    )
    def test_what_has_one_is_not(self, vary):
        assert self.said("case.block.tan_alpha", vary) == []
