"""What people write by mistake, and what they are told."""

import pytest

from rockcli.errors import RecordError, StudyError
from rockcli.study.building.records import MissingRecordError
from rockcli.study.document.expressions import ExpressionError, parse
from rockcli.study.document.tree import nearest
from rockcli.study.open import open_study

BLOCK = {"R": 2, "tan_alpha": 0.2}
SINE = {"pulse": {"shape": "sine", "a_p": 4, "T_p": 1}}


def opened(case=None, **more):
    return open_study({"name": "x", "case": {"block": BLOCK, **(case or {})}, **more})


def told(case=None, **more):
    with pytest.raises((StudyError, RecordError)) as caught:
        opened(case, **more)
    return str(caught.value)


class TestExpressions:
    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("3*g*", "ends with an operator"),
            ("3*g^2", r"write \*\* for \^"),
            ("2pi/0.5", r"write 2\*pi"),
            ("10 mm", r"write 10\*mm"),
            ("2(3+1)", r"products need a \*"),
            ("2,1", "decimals with a point"),
            ("3*(g", r"lacks 1 \)"),
            ("3*g)", r"lacks 1 \("),
            ("3..2", "numbers, names"),
            ("20%", "write 0.2$"),
            ("2.5 %", "write 0.025$"),
            ("10\N{DEGREE SIGN}", r"write 10\*deg"),
            ("5e-1 g", r"write 5e-1\*g"),
            ("0.45 +- 0.05", "off by under `uncertain`"),
            ("45*cm +/- 5*cm", "off by under `uncertain`"),
            ("0.45\N{PLUS-MINUS SIGN}0.05", "off by under `uncertain`"),
        ],
    )
    def test_slips(self, text, words):
        with pytest.raises(ExpressionError, match=words):
            parse(text)

    def test_a_long_list_of_names_says_that_it_goes_on(self):
        names = [f"name_{i:02d}" for i in range(31)]
        assert nearest("?", names).endswith(", ...")
        assert nearest("?", names[:30]).endswith("name_29")


class TestKeys:
    def test_a_number_as_damping(self):
        assert "case.damping is 0.8; for that coefficient of restitution write {eta: 0.8}" in told({"damping": 0.8})

    def test_a_key_of_the_case_at_the_top(self):
        assert "did you mean case.motion?" in told(motion=SINE)

    def test_an_unknown_axis_points_to_case(self):
        assert "several keys at once go under the axis `case`" in told(vary={"variant": {"a": {"model": 3}}})

    def test_a_symbol_of_let_in_an_axis_of_the_block(self):
        assert "`k` is a symbol of `let`" in told(let={"k": 2}, vary={"block.R": ["k*1", 2]})


class TestTables:
    def table(self, folder, head):
        (folder / "t.csv").write_text(f"{head}\n1.8,0.4\n2.2,0.5\n")
        study = folder / "s.yaml"
        study.write_text(
            "name: x\ncase: {block: {height: 2, width: 0.5}, initial: {theta: 0.1}}\nvary: {case: t.csv}\n"
        )
        return study

    def test_a_table_needs_labels_first(self, tmp_path):
        study = self.table(tmp_path, "block.height,block.width")
        with pytest.raises(StudyError, match=r"'block.height' is a path.*\(name,block.height,\.\.\.\)") as caught:
            open_study(study)
        assert (caught.value.file, caught.value.line) == (str(tmp_path / "t.csv"), 1)

    @pytest.mark.parametrize("head", ["name,block.height", ",block.height"])
    def test_with_labels_it_is_read(self, head, tmp_path):
        assert open_study(self.table(tmp_path, head)).axes[0].values == ("1.8", "2.2")

    def test_below_an_axis(self, tmp_path):
        study = self.table(tmp_path, "height,width")
        study.write_text(study.read_text().replace("{case: t.csv}", "{block: t.csv}"))
        with pytest.raises(StudyError, match="'height' is a path"):
            open_study(study)


class TestRecords:
    def test_a_missing_record_says_line_by_line_what_to_do(self, tmp_path, monkeypatch):
        monkeypatch.setenv("ROCK_RECORDS", str(tmp_path / "away"))
        with pytest.raises(MissingRecordError) as caught:
            opened({"motion": {"record": "RSN811_LOMAP_WAH090.AT2"}})
        lines = caught.value.message.splitlines()
        assert all(line.strip()[0].isupper() for line in lines[1:])
        assert f"{tmp_path / 'away'} (of ROCK_RECORDS; there is no such folder)" in lines[1]
        assert any(line.startswith("  How to get it: PEER") for line in lines)

    def test_units_and_time_step_are_asked_for_together(self, tmp_path):
        (tmp_path / "q.txt").write_text("1 2 3\n4 5 6\n")
        assert "`units:`" in (said := told({"motion": {"record": str(tmp_path / "q.txt")}}))
        assert "`dt:`" in said
        (tmp_path / "q.txt").write_text("0 1\n0.01 2\n0.02 3\n")
        assert "`dt:`" not in told({"motion": {"record": str(tmp_path / "q.txt")}})

    def test_a_pattern_is_an_axis(self):
        assert "motion.record.file" in told({"motion": {"record": "r3/*.AT2"}})
        assert told(vary={"record": "r3/*.AT2"}).endswith("did you mean 'motion.record.file'?")

    def test_an_axis_over_whole_records_says_what_it_drops(self, tmp_path):
        (tmp_path / "q.txt").write_text("# units: m/s2\n0 0\n0.01 3\n0.02 0\n")
        record = str(tmp_path / "q.txt")
        study = opened({"motion": {"record": {"file": record, "pga": 3}}}, vary={"motion.record": [record]})
        assert any("replaces the whole record, `pga` with it" in sentence for sentence in study.warnings)


class TestCoordinates:
    CASE = {"motion": {"pulse": {"shape": "sine", "a_p": 4, "T_p": 1}}}  # noqa: RUF012
    VARY = {"motion.pulse.a_p": ["0.3*g", "0.5*g"]}  # noqa: RUF012

    def test_expressions_of_the_case(self):
        study = opened(
            self.CASE,
            vary=self.VARY,
            compare_to={"motion.pulse.a_p": "0.3*g"},
            save={"histories": {"motion.pulse.a_p": "2.5*g*tan_alpha"}},
            expect=[{"quantity": "outcome", "at": {"motion_pulse_a_p": "490.5*cm/s**2"}, "is": "rocking"}],
        )
        assert study.compare_to == {"motion_pulse_a_p": pytest.approx(0.3 * 9.81)}
        assert study.histories_at == {"motion_pulse_a_p": pytest.approx(0.5 * 9.81)}
        assert study.expect[0].at == {"motion_pulse_a_p": pytest.approx(0.5 * 9.81)}

    def test_what_differs_from_case_to_case_is_refused(self):
        vary = {**self.VARY, "block.tan_alpha": [0.1, 0.2]}
        assert "differs from case to case" in told(self.CASE, vary=vary, compare_to={"motion.pulse.a_p": "g*tan_alpha"})

    def test_an_unknown_name_is_told_with_the_points(self):
        said = told(self.CASE, vary=self.VARY, compare_to={"motion.pulse.a_p": "0.3*q"})
        assert "`q` is not known" in said
        assert "it has 2.943, 4.905" in said


class TestAListForANumber:
    @pytest.mark.parametrize("key", ["alpha", "tan_alpha", "slenderness"])
    def test_two_edges_have_a_form_of_their_own(self, key):
        said = told({"block": {"R": 2, key: [0.1, 0.2]}, "initial": {"theta": 0.05}})
        assert (
            f"case.block.{key}: a number or an expression is expected, not a list; two different edges are `h`" in said
        )
        assert f"`b: [left, right]`; several cases are an axis, `vary: {{block.{key}: [...]}}`" in said

    def test_several_values_are_an_axis(self):
        said = told({"motion": {"pulse": {"shape": "sine", "a_p": [3, 4], "T_p": 1}}})
        assert "not a list; several cases are an axis, `vary: {motion.pulse.a_p: [...]}`" in said
        assert "edges" not in said
        assert "axis" not in told({"initial": {"theta": {"a": 1}}})
