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


def test_what_is_wrong_is_one_sentence(rock, dataset, tmp_path, capsys):
    for words in (("--out", "t.ods"), ("--of", "risks"), ("--columns", "theta"), ("--rows", "0")):
        assert rock("table", dataset, *words) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert rock("table", tmp_path / "none.nc") == 2
    assert not list(tmp_path.glob("t.*"))
