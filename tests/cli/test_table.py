"""`rock table`: a suite as tables, in the terminal and in files."""

from __future__ import annotations

import csv
import json
import math
import re

import pytest

import rockcli

SUITE = """
name: tabled
case:
  block: {height: 3.0, width: 0.6}
  motion: {pulse: {shape: sine, a_p: 2.0, T_p: 0.8}}
over: {axis: T_p, along: a_p, limits: [0.1]}
vary:
  motion.pulse.T_p: [0.6, 1.0, 1.5]
  motion.pulse.a_p: {from: 0.1*g, to: 1.0*g, n: 7}
save: {histories: true, dt_out: 0.1}
plots: none
"""

TENTH = "theta/alpha > 0.1"


@pytest.fixture
def dataset(rock, tmp_path, capsys):
    (tmp_path / "tabled.yaml").write_text(SUITE, encoding="utf-8")
    assert rock("run", "tabled.yaml", "--quiet") == 0
    capsys.readouterr()
    return tmp_path / "results" / "tabled" / "tabled.nc"


def test_the_terminal_shows_g_and_says_what_it_leaves_out(rock, dataset, capsys):
    assert rock("table", dataset, "--rows", 8) == 0
    shown = capsys.readouterr()
    head, *lines = shown.out.splitlines()
    assert head.split("  ")[0] == "T_p [s]"
    assert "a_p [g]" in head
    assert len(lines) == 8
    assert "13 more of 21 rows" in shown.err
    assert "more columns" in shown.err


@pytest.mark.parametrize(("of", "rows"), [("suite", 7), ("fragility", 2), ("stripes", 14), ("cases", 21)])
def test_tables_of_a_suite(rock, dataset, tmp_path, of, rows):
    assert rock("table", dataset, "--of", of, "--out", "t.csv") == 0
    with (tmp_path / "t.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == rows


def test_files_speak_g_as_the_terminal_does_unless_si_is_asked_for(rock, dataset, tmp_path):
    rows = {}
    for name, more in (("g", ()), ("si", ("--si",))):
        assert rock("table", dataset, "--of", "fragility", "--out", f"{name}.csv", *more) == 0
        with (tmp_path / f"{name}.csv").open(encoding="utf-8") as file:
            rows[name] = next(csv.DictReader(file))
    in_g, in_si = float(rows["g"]["fragility_median [g]"]), float(rows["si"]["fragility_median [m s-2]"])
    assert in_si == pytest.approx(9.81 * in_g, rel=1e-12)


def test_one_percentile_is_a_column(rock, dataset, capsys):
    asked = "fragility_percentile_5,fragility_percentile_ci_low_5"
    assert rock("table", dataset, "--of", "fragility", "--columns", asked) == 0
    shown = capsys.readouterr()
    assert re.split(" {2,}", shown.out.split("\n")[0]) == [
        "limit_state",
        "fragility_percentile_5 [g]",
        "fragility_percentile_ci_low_5 [g]",
    ]
    assert shown.err == ""
    assert rock("table", dataset, "--columns", "fragility_percentile_5") == 2
    assert "--of fragility" in capsys.readouterr().err
    assert rock("table", dataset, "--of", "fragility", "--columns", "fragility_percentile_7") == 2
    assert "percentiles are 1, 5, 10" in capsys.readouterr().err


def test_what_is_wrong_is_one_sentence(rock, dataset, tmp_path, capsys):
    for words in (("--out", "t.ods"), ("--of", "risks"), ("--columns", "theta"), ("--rows", "0")):
        assert rock("table", dataset, *words) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert rock("table", tmp_path / "none.nc") == 2
    assert not list(tmp_path.glob("t.*"))


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_selected_rows_are_those_of_the_whole_table(rock, dataset, tmp_path):
    assert rock("table", dataset, "--out", "whole.csv") == 0
    assert rock("table", dataset, "--out", "some.csv", "--select", "a_p=0.4g,0.7g") == 0
    assert rock("table", dataset, "--out", "two.csv", "--select", "a_p=0.4g", "--select", "T_p=0.6,1.5") == 0
    whole = rows_of(tmp_path / "whole.csv")
    some = [row for row in whole if min(abs(float(row["a_p [g]"]) - a) for a in (0.4, 0.7)) < 1e-9]
    assert len(some) == 6
    assert rows_of(tmp_path / "some.csv") == some
    two = [row for row in some if row["T_p [s]"] != "1.0" and row["a_p [g]"].startswith("0.4")]
    told = rows_of(tmp_path / "two.csv")
    assert told == [{head: row[head] for head in told[0]} for row in two]
    # what the suite of all members comes to stands beside no part of them
    assert {head.split("_")[0] for head in whole[0].keys() - told[0].keys()} == {"fragility"}


def test_a_row_of_a_suite_is_selected_and_part_of_its_members_is_no_suite(rock, dataset, tmp_path, capsys):
    for name, more in (("whole", ()), ("part", ("--select", "a_p=0.7g"))):
        assert rock("table", dataset, "--of", "suite", "--out", f"{name}.csv", *more) == 0
    (row,) = rows_of(tmp_path / "part.csv")
    assert row in rows_of(tmp_path / "whole.csv")
    assert float(row["motion_pulse_a_p [g]"]) == pytest.approx(0.7)
    capsys.readouterr()
    assert rock("table", dataset, "--of", "suite", "--select", "T_p=0.6") == 2
    assert "--select leaves a part of T_p: the table 'suite' is over all of it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "labels"),
    [
        ("a,b", ["a,b"]),
        ("model 3, large", ["model 3, large"]),
        ("a , model 3, large,  b", ["model 3, large", "a", "  b"]),
        ("a,a,b, b", ["a,b", "a", "b"]),
    ],
)
def test_a_label_with_commas_is_one(rock, tmp_path, words, labels):
    settings = {name: {"height": 3.0} for name in ("a,b", "model 3, large", "a", "b", "  b")}
    study = {"name": "x", "case": {"block": {"width": 0.6}, "initial": {"theta": 0.1}}, "vary": {"block": settings}}
    (tmp_path / "x.yaml").write_text(json.dumps(study), encoding="utf-8")
    assert rock("run", "x.yaml", "--quiet", "--no-plots", "--set", "save.scalars=[outcome]") == 0
    assert rock("table", "results/x/x.nc", "--select", f"block={words}", "--out", "t.csv") == 0
    assert {row["block"] for row in rows_of(tmp_path / "t.csv")} == set(labels)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("a_p", "expected AXIS=VALUE"),
        ("mass=1", "the axes are T_p, motion_pulse_a_p"),
        ("T_p=0.7", "there are 0.6, 1, 1.5"),
        ("ap=0.7g", "the axes are T_p, motion_pulse_a_p, limit_state; did you mean 'a_p'?"),
        ("limit_sate=0.1", "did you mean 'limit_state'?"),
        ("limit_state=0.2", "limit_state=0.2: there are 0.1, overturned"),
        ("limit_state=overturnd", "there are 0.1, overturned; did you mean 'overturned'?"),
    ],
)
def test_what_cannot_be_selected_is_said(rock, dataset, capsys, words, said):
    assert rock("table", dataset, "--select", words) == 2
    shown = capsys.readouterr().err
    assert said in shown
    assert shown.count("\n") == 1


def test_one_limit_state_of_a_table(rock, dataset, tmp_path, capsys):
    assert rock("table", dataset, "--of", "fragility", "--select", "limit_state=overturned", "--out", "t.csv") == 0
    with (tmp_path / "t.csv").open(encoding="utf-8") as file:
        assert [row["limit_state"] for row in csv.DictReader(file)] == ["overturned"]
    assert rock("table", dataset, "--of", "fragility", "--select", "limit_state=fallen") == 2
    assert "limit_state=fallen: there are" in capsys.readouterr().err


@pytest.mark.parametrize("of", ["cases", "suite"])
def test_a_limit_state_of_a_table_without_them_is_refused(rock, dataset, tmp_path, capsys, of):
    assert rock("table", dataset, "--of", of, "--select", "limit_state=overturned", "--out", "t.csv") == 2
    assert f"select limit_state: the table '{of}' has no such column; --of fragility has" in capsys.readouterr().err
    assert not (tmp_path / "t.csv").exists()


def test_a_printed_table_says_what_a_limit_state_is_of(rock, dataset, tmp_path, capsys):
    asked = ("table", dataset, "--of", "fragility", "--columns", "fragility_median")
    assert rock(*asked) == 0
    assert [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()[1:]] == [TENTH, "overturned"]
    for said in ("0.1", TENTH):
        assert rock(*asked, "--select", f"limit_state={said}") == 0
        assert [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()[1:]] == [TENTH]
    assert rock(*asked, "--out", "labels.csv") == 0
    with (tmp_path / "labels.csv").open(encoding="utf-8") as file:
        assert [row["limit_state"] for row in csv.DictReader(file)] == ["0.1", "overturned"]


def test_rows_are_sorted_by_a_column_and_the_column_is_shown(rock, dataset, capsys):
    assert rock("table", dataset, "--sort", "-t_peak", "--select", "a_p=0.1g,0.25g", "--rows", 4) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    peaks = [line[head.index("t_peak [s]") :].split()[0] for line in lines]
    assert len(peaks) == 4
    assert sorted(map(float, peaks[:3]), reverse=True) == list(map(float, peaks[:3]))
    assert lines[3].split()[2] == "no_uplift"  # has no time of a peak


@pytest.mark.parametrize(("of", "column"), [("suite", "p_overturned"), ("stripes", "p_exceeded"), ("cases", "R")])
def test_every_table_can_be_sorted(rock, dataset, tmp_path, of, column):
    for name, more in (("as_it_is", ()), ("down", ("--sort", f"-{column}"))):
        assert rock("table", dataset, "--of", of, "--out", f"{name}.csv", *more) == 0
    rows, down = rows_of(tmp_path / "as_it_is.csv"), rows_of(tmp_path / "down.csv")
    head = next(head for head in rows[0] if head.split(" ")[0] == column)
    assert down == sorted(rows, key=lambda row: -float(row[head]))


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("-theta_peek", "no column 'theta_peek'; did you mean 'theta_peak'?"),
        ("weight", "no column 'weight'; expected some of T_p, motion_pulse_a_p, R, alpha"),
        ("theta", "column 'theta' is not in this table: it is over T_p, motion_pulse_a_p, time"),
    ],
)
def test_what_cannot_be_sorted_by_is_said(rock, dataset, capsys, column, words):
    assert rock("table", dataset, "--sort", column) == 2
    shown = capsys.readouterr().err
    assert words in shown
    assert shown.count("\n") == 1


def test_percentiles_are_sorted_by_one_of_them(rock, dataset, capsys):
    asked = ("table", dataset, "--of", "fragility", "--columns", "fragility_median", "--sort")
    assert rock(*asked, "-fragility_percentile_5") == 0
    assert [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()[1:]] == ["overturned", TENTH]
    assert rock(*asked, "fragility_percentile_5") == 0
    assert [line.split("  ")[0] for line in capsys.readouterr().out.splitlines()[1:]] == [TENTH, "overturned"]
    assert rock(*asked, "fragility_percentile") == 2
    assert "is several: sort by one of fragility_percentile_1, " in capsys.readouterr().err


def test_curves_alone_have_a_row_of_what_is_known_of_the_body(rock, tmp_path, capsys):
    (tmp_path / "curves.yaml").write_text(
        "name: curves\ncase: {block: {height: 3.0, width: 0.6}}\ncurves: [moment_rotation]\nplots: none\n",
        encoding="utf-8",
    )
    assert rock("run", "curves.yaml", "--quiet") == 0
    capsys.readouterr()
    assert rock("table", "results/curves/curves.nc") == 0
    head, row = capsys.readouterr().out.splitlines()
    assert head.split()[:2] == ["R", "[m]"]
    assert row.split()[0] == "1.52971"


def test_the_dataset_has_the_columns_of_a_table(rock, tmp_path):
    (tmp_path / "bodies.csv").write_text(
        "name,# room,block.height,block.mu,motion.record.file,motion.through,# Raum 2,#room\n"
        "shelf,101,180*cm,null,synthetic_rock_m65.AT2,null,x,I\n"
        "rack,7,2.0,0.5,synthetic_soil_m70.AT2,null,y,II\n"
    )
    record = "motion: {record: {file: synthetic_rock_m65.AT2, pga: 0.4*g}}"
    (tmp_path / "s.yaml").write_text(
        f"name: s\ncase: {{block: {{height: 1, width: 0.4}}, {record}}}\nvary: {{case: bodies.csv}}\n"
    )
    assert rock("run", tmp_path / "s.yaml", "--no-plots") == 0
    with rockcli.open_dataset("results/s/s.nc") as dataset:
        given = {str(n): v.values.tolist() for n, v in dataset.coords.items() if str(n)[:5] in ("given", "note_")}
        assert given == {
            "given_height": [1.8, 2.0],
            "given_mu": [pytest.approx(math.nan, nan_ok=True), 0.5],
            "given_file": ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2"],
            "note_room": ["101", "7"],
            "note_Raum_2": ["x", "y"],
            "note_room_3": ["I", "II"],
        }
        assert dataset.given_height.attrs["path"] == "block.height"
        assert dataset.given_height.attrs["units"] == "m"
    assert rock("table", "results/s/s.nc", "--out", "t.csv") == 0
    head, shelf, *_ = (tmp_path / "t.csv").read_text().splitlines()
    assert head.startswith("case,given_height [m],given_mu,given_file,note_room,note_Raum_2,note_room_3,R [m],")
    assert shelf.split(",")[:6] == ["shelf", "1.8", "", "synthetic_rock_m65.AT2", "101", "x"]


def test_a_table_does_not_replace_the_list_that_the_study_was_made_of(rock, tmp_path, capsys):
    listed = "name,block.height\nshelf,1.8\nrack,2.0\n"
    (tmp_path / "bodies.csv").write_text(listed)
    body = "case: {block: {height: 1, width: 0.4}, initial: {theta: 0.05}}"
    (tmp_path / "s.yaml").write_text(f"name: s\n{body}\nvary: {{case: bodies.csv}}\n")
    assert rock("run", tmp_path / "s.yaml", "--no-plots") == 0
    assert rock("table", "results/s/s.nc", "--out", "bodies.csv") == 2
    assert "bodies.csv: is a file that the results were made of" in capsys.readouterr().err
    assert (tmp_path / "bodies.csv").read_text() == listed
    for _ in range(2):  # a table of results is replaced
        assert rock("table", "results/s/s.nc", "--out", "results/bodies.csv") == 0


def test_tables_of_a_suite_have_what_was_said_of_the_bodies(rock, tmp_path, capsys):
    (tmp_path / "list.csv").write_text(
        "name,block.R,block.alpha,# room\nslender,1.0,0.1,101\nstout,2.0,0.2,7\n", encoding="utf-8"
    )
    (tmp_path / "s.yaml").write_text(
        "{name: s, case: {block: {R: 1, alpha: 0.2}, motion: {pulse: {shape: sine, a_p: 1, T_p: 1}}}, over: T_p,"
        " vary: {case: list.csv, motion.pulse.T_p: [0.5, 1, 2], motion.pulse.a_p: [0.5, 2, 4, 8]},"
        " save: {histories: false}, plots: none}",
        encoding="utf-8",
    )
    assert rock("run", str(tmp_path / "s.yaml"), "--out", str(tmp_path / "out")) == 0
    file = str(tmp_path / "out" / "s" / "s.nc")
    for of in ("suite", "fragility", "stripes", "demand"):
        assert rock("table", file, "--of", of, "--out", str(tmp_path / "t.csv")) == 0
        rows = list(csv.DictReader((tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()))
        said = {(row["case"], row["note_room"], row["given_alpha [rad]"]) for row in rows}
        assert said == {("slender", "101", "0.1"), ("stout", "7", "0.2")}
    capsys.readouterr()
    assert rock("table", file, "--of", "fragility") == 0
    assert "note_room" not in capsys.readouterr().out.splitlines()[0]
    assert rock("table", file, "--of", "fragility", "--columns", "note_room,fragility_median") == 0
    assert "note_room" in capsys.readouterr().out.splitlines()[0]


@pytest.mark.parametrize("columns", [60, 80, 120, 1000])
@pytest.mark.parametrize("numbers", [7, 0])
def test_a_narrow_terminal_has_all_columns(monkeypatch, columns, numbers):
    """At 80 columns the first three, axes and outcome, were not printed, and numbers at the end were cut off."""
    from rockcli.cli.tables import table

    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setenv("NO_COLOR", "1")
    head = ["through", "record", "outcome", *(f"a_quantity_of_case_{i} [m/s]" for i in range(7))]
    rows = [
        ["isolator on a floor", f"motion_number_{i}.AT2", "rocking", *(f"{i}.{j}5" for j in range(7))] for i in range(3)
    ]
    told = re.sub(r"\x1b\[[0-9;]*m", "", table(head, rows, right=numbers, keys=2))
    assert max(map(len, told.splitlines())) <= columns
    tables = told.split("\n\n")
    assert (len(tables) == 1) == (columns == 1000)
    for number in range(3):
        for cell in rows[number][3:]:
            assert len(re.findall(rf"(?<!\S){re.escape(cell)}(?!\S)", told)) == 1
    letters = re.sub(r"\s", "", told)
    if numbers:  # heads of numbers are not folded
        assert all(name in told for name in head)
    for one in tables:  # what a row is of stands in each of them
        assert one.lstrip().split()[0] == "through" or not numbers
        assert "record" in one
    assert letters.count("1.35") == 1


def test_a_table_of_one_wide_column_is_printed_whole(monkeypatch):
    from rockcli.cli.tables import table

    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "20")
    told = re.sub(r"\x1b\[[0-9;]*m", "", table(["", "a_quantity_of_a_long_name"], [["x", "1"]], right=1))
    assert "a_quantity_of_a_long_name" in told
