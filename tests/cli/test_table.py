"""`rock table`: a suite as tables, in the terminal and in files."""

from __future__ import annotations

import csv

import pytest

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
    assert shown.out.split("\n")[0].split("  ") == [
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
