"""Axes and batches: coordinates, names, and that a million cases are a few array operations."""

import json
import re

import numpy as np
import pytest

from rockcli.errors import StudyError
from rockcli.study.building.records import MissingRecordError
from rockcli.study.document.expressions import Expression
from rockcli.study.open import open_study

PULSE = {"shape": "ricker", "a_p_over_g_tan_alpha": 1, "omega_p_over_p": 1}


def study_of(vary, folder=None, **more):
    case = {"block": {"R": 5.0, "tan_alpha": 0.2}, "motion": {"pulse": PULSE}, **more.pop("case", {})}
    study = {"name": "a", "case": case, "vary": vary, **more}
    if folder is None:
        return open_study(study)
    import yaml

    (folder / "s.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    return open_study(folder / "s.yaml")


def all_cases(study, get):
    """A quantity of every case, in flat order."""
    values = [None] * study.size
    for indices, batch in study.batches():
        for i, value in zip(indices, get(batch), strict=True):
            values[i] = value
    return values


class TestForms:
    def test_a_list_and_a_range_are_numeric(self):
        study = study_of({"block.R": [1, "2*m", 3.5], "motion.pulse.T_p": {"from": 0.1, "to": 0.7, "n": 7}})
        R, T_p = study.axes
        assert R.values == (1.0, 2.0, 3.5)
        assert R.numeric
        assert R.unit == "m"
        assert R.name == "block_R"  # R is a variable of the dataset
        assert T_p.name == "T_p"
        assert (T_p.values[0], T_p.values[-1], T_p.size) == (0.1, 0.7, 7)
        assert study.shape == (3, 7)
        ((indices, batch),) = study.batches()
        assert (indices == np.arange(21)).all()
        assert batch.block.R[:, 0].tolist() == np.repeat([1.0, 2.0, 3.5], 7).tolist()
        np.testing.assert_allclose(2 * np.pi / batch.excitation.horizontal.omega_p, list(T_p.values) * 3, rtol=1e-15)

    def test_a_logarithmic_range_has_exact_ends(self):
        (axis,) = study_of({"block.R": {"from": 0.3, "to": "70*m", "n": 5, "spacing": "log"}}).axes
        assert (axis.values[0], axis.values[-1]) == (0.3, 70.0)
        assert axis.values[2] == pytest.approx(np.sqrt(21.0), rel=1e-14)

    def test_labels(self):
        study = study_of({"model": ["rigid", "linearized"], "damping": ["none", "restitution"]})
        assert [a.values for a in study.axes] == [("rigid", "linearized"), ("none", "restitution")]
        assert all_cases(study, lambda b: [b.model] * b.size) == ["rigid"] * 2 + ["linearized"] * 2
        assert all_cases(study, lambda b: [b.damping.scheme] * b.size) == ["none", "restitution"] * 2

    def test_numbers_and_words_mixed_are_labels(self):
        study = study_of({"damping.eta": ["housner", 0.9]})
        assert study.axes[0].values == ("housner", "0.9")
        assert all_cases(study, lambda b: b.damping.eta[:, 0])[1] == 0.9

    def test_named_settings_replace_what_stands_there(self):
        study = study_of(
            {"block": {"small": {"h": 1, "b": 0.2}, "large": {"R": 20, "alpha": 0.1}}, "block.mu": [0.5, 0.7]}
        )
        assert study.axes[0].values == ("small", "large")
        assert all_cases(study, lambda b: b.block.h)[:2] == [1.0, 1.0]
        assert all_cases(study, lambda b: b.block.mu) == [0.5, 0.7, 0.5, 0.7]

    def test_settings_of_the_case_are_laid_over_key_by_key(self):
        settings = {
            "a": {"block": {"R": 1, "alpha": 0.3}, "motion.pulse.T_p": 0.5},
            "b": {"block.R": 7, "damping": "none"},
        }
        study = study_of({"case": settings})
        assert study.axes[0].name == "case"
        assert all_cases(study, lambda b: b.block.R[:, 0]) == [1.0, 7.0]
        assert all_cases(study, lambda b: b.block.alpha[:, 0])[0] == 0.3
        assert all_cases(study, lambda b: b.damping.eta[:, 0])[1] == 1.0
        assert all_cases(study, lambda b: b.block.tan_alpha[:, 0])[1] == 0.2

    def test_named_numbers_are_one_batch(self):
        study = study_of({"block.R": {"small": 1, "large": "20*m"}})
        assert study.axes[0].values == ("small", "large")
        ((_, batch),) = study.batches()
        assert batch.block.R[:, 0].tolist() == [1.0, 20.0]

    def test_a_table(self, tmp_path):
        (tmp_path / "t.csv").write_text("name, R, tan_alpha\nfirst, 1, 0.1\n\nsecond, 2*m, 0.3\n")
        study = study_of({"block": "t.csv"}, tmp_path)
        assert study.axes[0].values == ("first", "second")
        ((_, batch),) = study.batches()
        assert batch.block.R[:, 0].tolist() == [1.0, 2.0]
        assert batch.block.tan_alpha[:, 0].tolist() == [0.1, 0.3]
        assert list(study.inputs) == ["t.csv"]
        (tmp_path / "t.csv").write_text("name, block.R, model\nfirst, 1, rigid\nsecond, 2, linearized\n")
        study = study_of({"case": "t.csv"}, tmp_path)
        assert all_cases(study, lambda b: [b.model] * b.size) == ["rigid", "linearized"]

    def test_a_cell_may_be_a_list_in_quotation_marks(self, tmp_path):
        """Statues of which the axis of mass is off the middle of the base, beside others."""
        (tmp_path / "t.csv").write_text(
            'name,h,b,width\nkouros , 0.98 , "[0.17, 24*cm]" ,null\nkore,0.9,null,0.4\n', encoding="utf-8"
        )
        study = study_of({"block": "t.csv"}, tmp_path, case={"block": {"h": 1.0, "b": 0.2}, "initial": {"theta": 0.01}})
        sides = all_cases(study, lambda b: (b.block.tan_alpha * b.block.h[:, None]).tolist())
        assert np.ravel(sides) == pytest.approx([0.17, 0.24, 0.2, 0.2])
        (given,) = (one for one in study.axes[0].given if one.name == "given_b")
        assert given.values.tolist() == ["[0.17, 24*cm]", ""]
        (tmp_path / "t.csv").write_text('name,h,b\nkouros,0.98,"[0.17, 0.2, 0.3]"\n', encoding="utf-8")
        with pytest.raises(StudyError, match=r"t\.csv:2: case\.block\.b: a number, or the two distances"):
            study_of({"block": "t.csv"}, tmp_path)

    def test_cells_of_g_are_numbers_in_the_columns_a_dataset_has(self, tmp_path):
        """0.3*g stands beside 2.5 m/s² as a number where g is one number, and as it is written where it is not."""
        (tmp_path / "t.csv").write_text("name,motion.record.pga,block.mu\na,0.3*g,0.5\nb,2.5,null\nc,0.1*g,g/g\n")
        record = {"file": "synthetic_rock_m65.AT2", "pga": 1.0}
        case = {"block": {"h": 1.0, "b": 0.2}, "motion": {"record": record}}
        for g, more in ((9.81, {}), (1.62, {}), ("5.315*ft/s**2", {}), (9.81, {"g": [1.62, 9.81]}),
                        (9.81, {"block": {"a": {"h": 2.0}}}), ("k", {})):  # fmt: skip
            study = {"name": "x", "let": {"k": 3.7}, "case": case | {"g": g}, "vary": {"case": "t.csv"} | more}
            (tmp_path / "x.yaml").write_text(json.dumps(study))
            pga, mu = open_study(tmp_path / "x.yaml").axes[0].given
            value = 5.315 * 0.3048 if g == "5.315*ft/s**2" else g
            one = "g" not in more and g != "k"
            assert pga.values.tolist() == (
                pytest.approx([0.3 * value, 2.5, 0.1 * value]) if one else ["0.3*g", "2.5", "0.1*g"]
            )
            assert pga.unit == ("m s-2" if one else "1")
            assert (mu.values.dtype.kind == "f") is one

    def test_columns_of_a_table_that_hold_nothing_are_none(self, tmp_path):
        (tmp_path / "t.csv").write_text("name,block.R,,\na,1,,\nb,2,,\n,,,\n")
        study = study_of({"case": "t.csv"}, tmp_path)
        assert all_cases(study, lambda b: b.block.R[:, 0].tolist()) == [1.0, 2.0]

    def test_a_table_may_have_both_of_two_columns_that_say_the_same_where_each_row_has_one(self, tmp_path):
        (tmp_path / "t.csv").write_text("name,height,width,h,r_g\na,2,0.5,null,null\nb,null,0.5,0.9,0.6\n")
        base = {"block": {"height": 1.8, "width": 0.4}, "initial": {"theta": 0.01}}
        study = study_of({"block": "t.csv"}, tmp_path, case=base)
        assert all_cases(study, lambda b: b.block.h.tolist()) == [1.0, 0.9]
        (tmp_path / "t.csv").write_text("name,height,width,h\na,2,0.5,null\nb,2,0.5,0.9\nc,2,0.5,0.9\n")
        with pytest.raises(StudyError, match=r"t\.csv:3: vary.block: height and h say the same .*\(also in line 4\)"):
            study_of({"block": "t.csv"}, tmp_path, case=base)

    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("name,R\n", "a line per point"),
            ("name,R\na,1,2\n", "3 cells"),
            ("name,R\na,\n", "empty"),
            ("name,R,R\na,1,2\n", "repeats"),
            ("name,r\na,1\n", "did you mean 'block.R'"),
            ("name,R,room\na,1,12\n", r"'block.room' is not a path .* of notes begins with # \(# room\)"),
            ("name,R\na,1\na,2\n", r"t\.csv:3: repeats 'a', which names line 2"),
            ("name,R\na,1\nb,2\nb,2\na,3\n", r"t\.csv:4: repeats 'b', .* line 3: [\s\S]*line 5: repeats 'a'"),
            ('name,R,# note\na,1,"two\nlines"\nb,,x\n', r"t\.csv:4: the cell below 'R' is empty"),
            ('name,R,# note\na,1,"x\nb,2,y\nc,3,z\n', r"t\.csv:2: is no CSV text: unexpected end"),
            ('name,R\na,1\nb,"0.2"5\n', r"t\.csv:3: is no CSV text: ',' expected after"),
            ("name,alpha,tan_alpha\na,0.1,0.2\n", "alpha and tan_alpha say the same thing; leave one out$"),
            (
                "name,height,width,h\na,2,0.5,0.9\n",
                "height and h say the same thing.* a centre of mass elsewhere is h: .* r_g .* and top, and without height",
            ),
            ("name,R\na,-\nb,N/A\n", r"t\.csv:2: .* 'R' is -: write a value, or null[\s\S]*line 3: .* is N/A: write"),
            ("name,R,\na,1,x\n", r"t\.csv:1: a column has no head"),
            ("name,R (cm)\na,120\n", r"t\.csv:1: 'R \(cm\)' is no path .* has no unit"),
            ("name,r\na,1\n", r"t\.csv:1: .* did you mean 'block\.R'"),
            ("name,R\na,nan\n", r"t\.csv:2: the cell below 'R' is nan: a finite number"),
            ("name,R\na,1\nb,-Infinity\n", r"t\.csv:3: the cell below 'R' is -Infinity"),
            ("\x00\x01", "line"),
            (
                "name;R;alpha\na;1,5;0,1\n",
                r"t\.csv:1: semicolons separate the cells, commas are expected: write decimals",
            ),
            ("\ufeffname;R\r\n", r"t\.csv:1: semicolons separate the cells"),
            ("name,R\na,1\nb;2\n", r"t\.csv:3: semicolons .* then replace the semicolons by commas"),
            ("name\tR\na\t1\n", r"t\.csv:1: tabs separate the cells, commas are expected"),
            (
                "name,R [cm]\na,120\n",
                r"t\.csv:1: 'R \[cm\]' is no path .* has no unit, which cells may have \(180\*cm\)",
            ),
        ],
    )
    def test_wrong_tables(self, tmp_path, text, words):
        (tmp_path / "t.csv").write_text(text, encoding="utf-8")
        with pytest.raises(StudyError, match=words):
            study_of({"block": "t.csv"}, tmp_path)

    def test_a_workbook_is_to_be_saved_as_csv(self, tmp_path):
        with pytest.raises(StudyError, match=r"vary.case is 'list.XLSX': save its sheet as CSV in UTF-8, commas"):
            study_of({"case": "list.XLSX"}, tmp_path)

    def test_a_wrong_cell_is_told_with_its_line(self, tmp_path):
        rows = [f"body {i},{-0.5 if i in (3, 11, 12) else 0.5},{'0.8 m' if i == 7 else 0.8}" for i in range(2, 15)]
        (tmp_path / "t.csv").write_text("\n".join(["name,block.b,block.h", *rows]) + "\n", encoding="utf-8")
        with pytest.raises(StudyError) as caught:
            study_of({"case": "t.csv"}, tmp_path)
        assert re.search(r"t\.csv:7: case\.block\.h: '0\.8 m' is not an arithmetic expression", str(caught.value))
        rows[5] = "body 7,0.5,0.8"
        (tmp_path / "t.csv").write_text("\n".join(["name,block.b,block.h", *rows]) + "\n", encoding="utf-8")
        with pytest.raises(StudyError) as caught:
            study_of({"case": "t.csv"}, tmp_path)
        assert re.findall(r"t\.csv:(\d+): case\.block\.b = -0\.5", str(caught.value)) == ["3", "11", "12"]

    def test_what_no_symbol_can_be_is_told_with_its_line(self, tmp_path):
        (tmp_path / "t.csv").write_text('name,let.k\na,1\nb,null\nc,null\nd,"[1, 2]"\n', encoding="utf-8")
        words = r"t\.csv:3: let\.k: .* not nothing \(also in line 4\)[\s\S]*line 5: let\.k: .* not a list"
        with pytest.raises(StudyError, match=words):
            study_of({"case": "t.csv"}, tmp_path)

    def test_all_wrong_cells_are_told_at_once(self, tmp_path):
        text = "name,block.h,block.width,block.mu\na,21 cm,0.16,0.5\nb,19*cm,22cm,0.4\nc,0.3,0.1,0.5\n"
        (tmp_path / "t.csv").write_text(text, encoding="utf-8")
        with pytest.raises(StudyError) as caught:  # the axis of an expression reads the first body before the others
            study_of({"case": "t.csv", "motion.pulse.a_p": ["0.2*g"]}, tmp_path)
        assert re.search(
            r"t\.csv:2: case\.block\.h: .* write 21\*cm\n  line 3: case\.block\.width: ", str(caught.value)
        )
        rows = [f"body {i},{i}.5 cm,," for i in range(2, 22)]
        (tmp_path / "t.csv").write_text("\n".join(["name,block.h,block.width,block.mu", *rows]), encoding="utf-8")
        with pytest.raises(StudyError, match=r"'block\.width' is empty: .* null for none") as caught:
            study_of({"case": "t.csv"}, tmp_path)
        assert re.search(r"'block\.mu' is empty.*also in lines 3, 4, 5", str(caught.value))
        (tmp_path / "t.csv").write_text("\n".join(["name,block.h,block.width,block.mu", *rows]).replace(",,", ",1,1"))
        with pytest.raises(StudyError, match=r"line 9: .*\n  and 12 more$"):
            study_of({"case": "t.csv"}, tmp_path)

    def test_a_table_of_a_spreadsheet_in_another_code(self, tmp_path):
        (tmp_path / "t.csv").write_bytes("name,R\na,1*m\nVénus,120*cm\n".encode("cp1252"))
        with pytest.raises(StudyError, match=r"t\.csv:3: is no text in UTF-8: save it as CSV in UTF-8"):
            study_of({"block": "t.csv"}, tmp_path)
        (tmp_path / "t.csv").write_text("name,R\na,1*m\nVénus,120*cm\n", encoding="utf-8-sig")
        study = study_of({"block": "t.csv"}, tmp_path)
        assert study.axes[0].values == ("a", "Vénus")
        assert all_cases(study, lambda b: b.block.R[:, 0].tolist()) == pytest.approx([1.0, 1.2])

    def test_columns_of_notes_are_not_read(self, tmp_path):
        (tmp_path / "t.csv").write_text("name,# room,R,# room,#\na,east wing,1,,x\nb,nan,2,[,\n")
        study = study_of({"block": "t.csv"}, tmp_path)
        assert study.axes[0].values == ("a", "b")
        assert all_cases(study, lambda b: b.block.R[:, 0].tolist()) == [1.0, 2.0]

    def test_a_label_of_a_table_may_have_a_semicolon(self, tmp_path):
        (tmp_path / "t.csv").write_text("name,R\na;b,1\n")
        assert study_of({"block": "t.csv"}, tmp_path).axes[0].values == ("a;b",)

    def test_a_missing_table(self, tmp_path):
        with pytest.raises(StudyError, match=r"t\.csv does not exist"):
            study_of({"block": "t.csv"}, tmp_path)

    def test_records_by_glob(self, tmp_path):
        (tmp_path / "records").mkdir()
        for name in ("b", "a"):
            (tmp_path / "records" / f"{name}.txt").write_text("0.0 0.0\n0.01 0.1\n0.02 0.0\n")
        case = {"motion": {"record": {"file": "a.txt", "units": "g"}}}
        study = study_of({"motion.record.file": "*.txt"}, tmp_path, case=case)
        (axis,) = study.axes
        assert axis.name == "record"
        assert axis.values == ("a.txt", "b.txt")
        assert study.resolved["vary"]["motion.record.file"] == ["a.txt", "b.txt"]
        assert [b.excitation.horizontal.name for _, b in study.batches()] == ["a.txt", "b.txt"]
        with pytest.raises(MissingRecordError, match="no file matches"):
            study_of({"motion.record.file": "*.nothing"}, tmp_path, case=case)

    def test_own_symbols_may_be_varied(self):
        study = study_of({"let.gamma": [1, 2]}, let={"delta": "2*gamma*R"}, case={"initial": {"theta": "0.01*delta"}})
        assert study.axes[0].name == "gamma"
        assert all_cases(study, lambda b: b.theta_0) == [0.1, 0.2]

    def test_pairs_of_edges_and_switches_are_labels(self):
        study = study_of(
            {"block.b": [[0.9, 0.6], [0.7, 0.7]], "solver.events": [True, False]}, case={"block": {"h": 4, "b": 1}}
        )
        assert [axis.values for axis in study.axes] == [("[0.9, 0.6]", "[0.7, 0.7]"), ("true", "false")]
        assert all_cases(study, lambda b: b.block.b.tolist())[::2] == [[0.9, 0.6], [0.7, 0.7]]

    def test_numbers_that_may_also_be_something_else_have_ranges(self):
        case = {"block": {"h": 4, "b": 1}}
        study = study_of(
            {"block.b": {"from": "50*cm", "to": 1, "n": 3}, "damping.eta": {"from": 0.8, "to": 1, "n": 2}}, case=case
        )
        ((_, batch),) = study.batches()
        assert batch.block.b[:, 0].tolist() == [0.5, 0.5, 0.75, 0.75, 1.0, 1.0]
        assert batch.damping.eta[:, 1].tolist() == [0.8, 1.0] * 3

    def test_numbers_of_the_solver_need_a_batch_each(self):
        study = study_of({"solver.rtol": [1e-6, "1e-9"]})
        assert study.axes[0].values == (1e-6, 1e-9)
        assert [b.numerics.rtol for _, b in study.batches()] == [1e-6, 1e-9]

    def test_the_choice_of_a_model_is_a_point_on_an_axis(self):
        study = study_of({"model": ["rigid", "auto"]})
        assert [(b.model, b.tolerance is None) for _, b in study.batches()] == [("rigid", True), ("auto", False)]


class TestRanges:
    """A mapping with a key of a range is a range, whatever else it has."""

    @pytest.mark.parametrize(
        ("entry", "words"),
        [
            ({"from": 1, "to": 2, "num": 5}, r"vary\.block\.R\.num: unknown key of a range .*did you mean 'n'"),
            ({"from": 1, "to": 2, "n": 5, "spacin": "log"}, "did you mean 'spacing'"),
            ({"start": 1, "stop": 2, "n": 5}, r"vary\.block\.R\.start: .*did you mean 'from'"),
            ({"from": 1, "stop": 2, "n": 5}, "did you mean 'to'"),
            ({"From": 1, "to": 2, "n": 5}, "did you mean 'from'"),
            ({"n": 5}, "without `from`"),
            ({"from": 1}, "without `to`"),
            ({"from": 1, "to": 2}, "without `n`"),
            ({"spacing": "log"}, "without `from`"),
            ({"from": "abc", "to": 2, "n": 3}, r"vary\.block\.R\.from is 'abc'"),
        ],
    )
    def test_misspelt_or_incomplete(self, entry, words):
        with pytest.raises(StudyError, match=words):
            study_of({"block.R": entry})

    def test_a_value_that_is_no_number_is_named(self):
        with pytest.raises(StudyError, match=r"vary\.block\.R\[1\] is 'abc'; expected numbers"):
            study_of({"block.R": [1, "abc"]})

    @pytest.mark.parametrize("entry", [[1, 2, 1 + 5e-10], {"from": 1, "to": 1 + 1e-9, "n": 3}])
    def test_values_that_cannot_be_distinguished(self, entry):
        with pytest.raises(StudyError, match=r"cannot be distinguished, 1\.0 and 1\.0000000005"):
            study_of({"block.R": entry})

    def test_values_a_little_apart_are_told_apart(self):
        assert study_of({"block.R": [1, 1 + 2e-9]}).size == 2


class TestNames:
    @pytest.mark.parametrize(
        ("paths", "names"),
        [
            (["initial.theta"], ["initial_theta"]),
            (["motion.pulse.a_p", "block.tan_alpha"], ["motion_pulse_a_p", "tan_alpha"]),
            (["damping.eta"], ["damping_eta"]),
            (["solver.dt", "let.dt"], ["solver_dt", "let_dt"]),
            (["let.time", "let.impact"], ["let_time", "let_impact"]),
            (["let.outline_point"], ["let_outline_point"]),
            (["let.given_mu", "let.sampled_width"], ["let_given_mu", "let_sampled_width"]),
            (["let.boundary_point", "let.hazard_point"], ["let_boundary_point", "let_hazard_point"]),
        ],
    )
    def test_dimensions(self, paths, names):
        study = study_of({path: [0.1, 0.2] for path in paths})
        assert [axis.name for axis in study.axes] == names
        assert [axis.path for axis in study.axes] == paths


class TestAlternatives:
    def test_a_varied_key_displaces_its_alternatives(self):
        study = study_of({"motion.pulse.a_p": [1, 2], "motion.pulse.f_p": [1], "block.alpha": [0.1]})
        assert all_cases(study, lambda b: b.excitation.horizontal.a_p) == [1.0, 2.0]
        assert all_cases(study, lambda b: b.block.alpha[:, 0]) == [0.1, 0.1]

    def test_two_axes_that_say_the_same_thing_are_an_error(self):
        with pytest.raises(StudyError, match="say the same thing"):
            study_of({"motion.pulse.a_p": [1, 2], "motion.pulse.a_p_over_g_tan_alpha": [1, 2]})

    @pytest.mark.parametrize(
        "keys",
        [
            ("block.alpha", "block.tan_alpha"),
            ("motion.pulse.a_p", "motion.pulse.a_p_over_g_tan_alpha"),
            ("motion.record.pga", "motion.record.scale"),
            ("motion.pulse", "motion.record"),
            ("block.R", "case.block.R"),
        ],
    )
    def test_a_setting_that_says_something_twice_is_an_error(self, keys):
        with pytest.raises(StudyError, match=rf"vary\.case\.x: {keys[0]} and {keys[1]} say the same thing"):
            study_of({"case": {"w": {"block.R": 3}, "x": {"damping": "none", **dict.fromkeys(keys, 0.1)}}})

    def test_shorter_paths_first(self):
        study = study_of({"block.R": [1, 2], "block": {"x": {"R": 9, "alpha": 0.3}, "y": {"R": 9, "alpha": 0.4}}})
        assert all_cases(study, lambda b: b.block.R[:, 0]) == [1.0, 1.0, 2.0, 2.0]
        assert all_cases(study, lambda b: b.block.alpha[:, 0]) == [0.3, 0.4, 0.3, 0.4]


class TestExpressionsOnAxes:
    def test_the_same_in_all_cases_is_a_coordinate(self):
        study = study_of({"motion.pulse.omega_p": ["2*p", "4*p"], "block.tan_alpha": [0.1, 0.2]})
        p = np.sqrt(3 * 9.81 / 20)
        assert study.axes[0].values == pytest.approx((2 * p, 4 * p), rel=1e-15)

    def test_a_range_may_have_such_ends(self):
        (axis,) = study_of({"motion.pulse.omega_p": {"from": "0.5*p", "to": "2*p", "n": 3}}).axes
        assert axis.values[2] == pytest.approx(2 * np.sqrt(3 * 9.81 / 20), rel=1e-15)

    def test_a_symbol_may_be_told_in_a_g_that_is_one_number(self):
        case = {"g": "1.62*m/s**2", "motion": {"pulse": {"shape": "sine", "a_p": "1.5*a", "T_p": 1}}}
        for entry in (["0.1*g", "0.3*g"], {"from": "0.1*g", "to": "0.3*g", "n": 2}):
            study = study_of({"let.a": entry, "block.R": [1.0, 2.0]}, let={"a": 1}, case=case)
            assert study.axes[0].values == pytest.approx((0.162, 0.486), rel=1e-15)
            a_p = all_cases(study, lambda b: b.excitation.horizontal.a_p)
            assert a_p == pytest.approx([0.243, 0.243, 0.729, 0.729], rel=1e-15)

    def test_other_axes_see_a_symbol_that_is_told_in_g(self):
        study = study_of({"motion.pulse.omega_p": ["2*a/m*s", "3"], "let.a": ["0.5*g"]}, let={"a": 1})
        assert study.axes[0].values == pytest.approx((9.81, 3.0), rel=1e-15)

    @pytest.mark.parametrize(
        ("vary", "case", "words"),
        [
            ({"let.a": ["0.1*g"], "g": [9.81, 1.62]}, {}, r"'0.1\*g' differs from case to case"),
            (
                {"let.a": ["0.1*g"], "case": {"moon": {"g": 1.62}, "earth": {}}},
                {},
                r"'0.1\*g' differs from case to case",
            ),
            ({"let.a": ["0.1*g"]}, {"g": "9.81*a"}, "units and a constant g: other expressions depend on it"),
            ({"let.a": [1, "0.1*g*tan_alpha"]}, {}, r"vary.let.a\[1\] is '0.1\*g\*tan_alpha'; expected numbers"),
            ({"g": ["0.5*g"]}, {}, "other expressions depend on it"),
        ],
    )
    def test_symbols_that_cannot_be_told_so(self, vary, case, words):
        with pytest.raises(StudyError, match=words):
            study_of(vary, let={"a": 1}, case=case)

    @pytest.mark.parametrize("other", ["block.R", "g", "let.x"])
    def test_different_ones_point_to_the_dimensionless_keys(self, other):
        vary = {"motion.pulse.omega_p": ["2*p*x", "4*p*x"], other: [1, 2]}
        with pytest.raises(StudyError, match=r"differs from case to case.*omega_p_over_p"):
            study_of(vary, let={"x": 1})


class TestBatches:
    def test_a_million_cases_are_one_batch_of_few_evaluations(self, monkeypatch):
        n = 1000
        study = study_of(
            {
                "motion.pulse.a_p_over_g_tan_alpha": {"from": 0.1, "to": 10, "n": n},
                "let.ratio": {"from": 0.1, "to": 20, "n": n, "spacing": "log"},
            },
            let={"ratio": 1},
            case={"motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 1, "omega_p": "ratio*p"}}},
        )
        calls = []
        evaluate = Expression.evaluate
        monkeypatch.setattr(Expression, "evaluate", lambda self, f: calls.append(self.text) or evaluate(self, f))
        ((indices, batch),) = study.batches()
        assert calls == ["ratio*p"]
        assert batch.size == len(indices) == n * n
        a_p = batch.excitation.horizontal.a_p.reshape(n, n)
        assert (a_p[:, 0] == a_p[:, -1]).all()
        assert a_p[-1, 0] == pytest.approx(10 * 9.81 * 0.2, rel=1e-15)
        np.testing.assert_allclose(
            batch.excitation.horizontal.omega_p.reshape(n, n)[7] / batch.p[0, 0], study.axes[1].values
        )

    def test_opening_a_large_study_builds_only_its_edges(self):
        n = 1000
        study = study_of({"block.R": {"from": 1, "to": 9, "n": n}, "block.tan_alpha": {"from": 0.1, "to": 1, "n": n}})
        assert len(study.cases.probe()) < 3 * n

    def test_a_bad_corner_of_a_large_study_is_found(self):
        vary = {"block.R": {"from": 5, "to": 1, "n": 1000}, "block.h": {"from": 0.5, "to": 2, "n": 1000}}
        with pytest.raises(StudyError, match=r"smaller than R.*block\.R = 1.*block\.h = 2"):
            open_study({"name": "a", "case": {"block": {"R": 5, "h": 1}}, "vary": vary})

    def test_any_choice_of_cases_is_the_same_as_all(self):
        vary = {"model": ["rigid", "linearized"], "block.R": [1, 2, 3], "damping": ["none", "restitution"]}
        study = study_of(vary)
        whole = {int(i): (b.model, b.damping.scheme, b.block.R[k, 0], b.excitation.horizontal.omega_p[k])
                 for indices, b in study.batches() for k, i in enumerate(indices)}  # fmt: skip
        assert sorted(whole) == list(range(12))
        chosen = np.array([11, 3, 0, 7])
        parts = list(study.batches(chosen))
        assert sorted(np.concatenate([i for i, _ in parts]).tolist()) == sorted(chosen.tolist())
        for indices, b in parts:
            for k, i in enumerate(indices):
                assert whole[int(i)] == (b.model, b.damping.scheme, b.block.R[k, 0], b.excitation.horizontal.omega_p[k])
        assert list(study.batches(np.array([], dtype=np.int64))) == []

    def test_too_many_cases(self):
        many = {"from": 1, "to": 2, "n": 1_000_000}
        with pytest.raises(StudyError, match="more than"):
            study_of({"block.R": many, "block.tan_alpha": many, "g": many})


class TestSave:
    def test_defaults(self):
        small, large = study_of({}), study_of({"block.R": {"from": 1, "to": 9, "n": 101}})
        assert small.histories
        assert not large.histories
        assert small.scalars == large.scalars
        huge = study_of({"block.R": {"from": 1, "to": 9, "n": 100_001}})
        assert huge.scalars == ("outcome", "theta_peak_over_alpha", "n_impacts")
        ((_, batch),) = small.batches()
        assert batch.save.scalars == frozenset(small.scalars)

    def test_dt_out(self):
        pulse = {"motion": {"pulse": {"shape": "sine", "a_p": 1, "T_p": 0.5}}}
        assert study_of({}, case=pulse).dt_out == pytest.approx(0.0025)
        assert study_of({"motion.pulse.T_p": [0.2, 3]}, case=pulse).dt_out == pytest.approx(0.001)
        assert study_of({"motion.pulse.T_p": [3, 4]}, case=pulse).dt_out == 0.005
        assert study_of({}, case=pulse, save={"dt_out": "10*ms"}).dt_out == 0.01

    def test_asked_for(self):
        study = study_of({"block.R": [1, 2]}, save={"histories": {"block.R": 2}, "scalars": ["n_impacts", "outcome"]})
        assert study.histories
        assert study.histories_at == {"block_R": 2.0}
        assert study.scalars == ("outcome", "n_impacts")
        assert {int(i): b.save.histories for indices, b in study.batches() for i in indices} == {0: False, 1: True}


def test_a_tolerance_in_per_cent() -> None:
    from rockcli.study.open import open_study

    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "T_p": 1.0}}}
    told = [
        open_study({"name": "p", "case": case | {"model": {"name": "auto", "tolerance": words}}})
        for words in ("2 %", "2%", 0.02)
    ]
    assert len({study.identity for study in told}) == 1
    assert [next(iter(study.batches()))[1].tolerance.tolist() for study in told] == [[0.02]] * 3


BODIES = {"one": {"R": 1, "tan_alpha": 0.2}, "two": {"tan_alpha": 0.3, "R": "2*m"}, "three": {"R": 3, "tan_alpha": 0.4}}


class TestBodiesByName:
    """Named mappings that say the same numbers are one batch, as a table of columns is."""

    def test_one_batch(self):
        study = study_of({"block": BODIES, "motion.pulse.omega_p_over_p": [1, 2]})
        ((indices, batch),) = study.batches()
        assert (indices == np.arange(6)).all()
        assert batch.block.R[:, 0].tolist() == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
        np.testing.assert_allclose(np.tan(batch.block.alpha[:, 0]), np.repeat([0.2, 0.3, 0.4], 2), rtol=1e-15)

    @pytest.mark.parametrize(
        "two",
        [{"R": 2, "tan_alpha": 0.3, "mu": 0.5}, {"h": 2, "b": [0.3, 0.4]}, {"R": 2, "tan_alpha": 0.3, "top": "0.1*R"}],
    )
    def test_other_keys_a_list_or_an_expression_have_a_batch_of_their_own(self, two):
        study = study_of({"block": BODIES | {"two": two}})
        batches = {tuple(indices.tolist()): batch for indices, batch in study.batches()}
        assert set(batches) == {(0, 2), (1,)}
        assert batches[0, 2].block.R[:, 0].tolist() == [1.0, 3.0]

    def test_rows_of_a_table_with_the_same_words_are_one_batch(self, tmp_path):
        """Each row was one: 50 000 rows of two models took 118 s of processor time, for 4."""
        rows = [(f"b{i}", 1 + i, ("rigid", "linearized")[i % 2], ("0.1", "R/(20*m)", "null")[i % 3]) for i in range(24)]
        lines = [",".join(map(str, row)) for row in [("body", "block.R", "model", "initial.theta"), *rows]]
        (tmp_path / "t.csv").write_text("\n".join(lines) + "\n")
        study = study_of({"case": str(tmp_path / "t.csv"), "initial.theta_dot": [0.0, 0.1]})
        found = list(study.batches())
        assert len(found) == 6
        for indices, batch in found:
            R = 1.0 + indices // 2
            assert {batch.model} == {rows[i // 2][2] for i in indices}
            np.testing.assert_array_equal(batch.block.R[:, 0], R)
            says = {"0.1": np.full_like(R, 0.1), "R/(20*m)": R / 20.0, "null": np.zeros_like(R)}
            (word,) = {rows[i // 2][3] for i in indices}
            np.testing.assert_allclose(batch.theta_0, says[word], rtol=1e-15)

    @pytest.mark.parametrize(("more", "batches"), [({}, 1), ({"g": [9.81, 1.62]}, 3)])
    def test_strengths_in_g_are_numbers_where_g_is_one(self, more, batches):
        pulse = {"shape": "sine", "omega_p": 6, "a_p": 1}
        named = {f"b{i}": {"motion.pulse.a_p": f"{i}*g", "model": "rigid"} for i in (1, 2, 3)}
        study = study_of({"case": named, **more}, case={"motion": {"pulse": pulse}})
        assert len(list(study.batches())) == batches
        a_p = all_cases(study, lambda batch: batch.excitation.horizontal.a_p)
        gs = more.get("g", [9.81])
        np.testing.assert_allclose(a_p, [i * g for i in (1, 2, 3) for g in gs], rtol=1e-15)

    def test_a_large_study_of_words_alone_is_looked_at_whole(self, monkeypatch):
        """More than 20 000 rows of words, and no axis of numbers, ended with "this is a bug in rock"."""
        monkeypatch.setattr("rockcli.study.cases.cases.PROBED", 2)
        assert study_of({"model": ["rigid", 1, 2]}).size == 3

    def test_of_a_large_table_the_extremes_of_each_batch_are_looked_at(self, tmp_path, monkeypatch):
        monkeypatch.setattr("rockcli.study.cases.cases.PROBED", 2)
        rows = "".join(f"b{i},{R},{('rigid', 'linearized')[i % 2]}\n" for i, R in enumerate([1, 2, 3, 4, 5, -6, 7]))
        (tmp_path / "t.csv").write_text("body,block.R,model\n" + rows)
        with pytest.raises(StudyError, match=r"t.csv:7: case.block.R = -6: must be greater than 0 \(at case = b5"):
            study_of({"case": str(tmp_path / "t.csv")})

    @pytest.mark.parametrize("more", [{}, {"model": "rigid"}], ids=["numbers", "words"])
    def test_names_that_fill_in_files_have_a_batch_of_their_own(self, tmp_path, more):
        for name in ("a", "b", "c"):
            (tmp_path / f"{name}.csv").write_text(f"0.0,0.0\n0.1,{len(name)}.0\n0.2,0.0\n")
        record = {"file": str(tmp_path / "{case}.csv"), "units": "m/s2"}
        named = {name: {"block.R": R} | more for R, name in enumerate("abc", 1)}
        study = study_of({"case": named}, case={"motion": {"record": record}})
        assert len(list(study.batches())) == 3
        assert sorted(name.rsplit("/", 1)[-1] for name in study.inputs) == ["a.csv", "b.csv", "c.csv"]

    def test_what_the_base_case_says_beside_them_stays_and_other_sizes_go(self):
        study = study_of({"block": BODIES}, case={"block": {"h": 1, "b": 0.2, "mu": 0.7}})
        ((_, batch),) = study.batches()
        assert batch.block.mu.tolist() == [0.7] * 3
        assert batch.block.R[:, 0].tolist() == [1.0, 2.0, 3.0]

    def test_an_axis_inside_a_named_mapping_is_laid_over_it_whatever_the_order(self):
        named = {"a": {"theta": 0.01, "theta_dot": 0.1}, "b": {"theta": 0.02, "theta_dot": 0.2}}
        for vary in ({"initial": named, "initial.theta": [0.03]}, {"initial.theta": [0.03], "initial": named}):
            ((_, batch),) = study_of(vary).batches()
            assert batch.theta_0.tolist() == [0.03, 0.03]
            assert batch.theta_dot_0.tolist() == [0.1, 0.2]

    def test_an_error_names_the_line_of_the_number(self, tmp_path):
        bodies = BODIES | {"two": {"R": 2, "tan_alpha": -0.3}}
        with pytest.raises(StudyError, match=r"tan_alpha = -0\.3: must be greater than 0 \(at block = two\)") as error:
            study_of({"block": bodies}, tmp_path)
        lines = (tmp_path / "s.yaml").read_text().splitlines()
        assert lines[error.value.line - 1].split() == ["tan_alpha:", "-0.3"]
