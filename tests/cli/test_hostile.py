"""What people do to a program: wrong units, odd files, searches reported, axes named by half."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SEARCH = """\
name: search
case:
  block: {R: 2.0, tan_alpha: 0.2}
  motion: {pulse: {shape: sine, a_p_over_g_tan_alpha: 1, omega_p_over_p: 4}}
vary:
  motion.pulse.omega_p_over_p: [2, 3]
  motion.pulse.a_p_over_g_tan_alpha: {from: 1, to: 12, n: 12, find: overturning}
"""

BODY = ("--alpha", "0.25", "--p", "3")


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("0 11.5\n0.1 11.2\n0.2 10.1\n0.3 9\n", BODY, "rotations up to 11.5 rad, beyond pi/2: --degrees"),
        ("0 0\n0.1 0\n0.2 0\n0.3 0\n", BODY, "all rotations are 0"),
        ("0 0.2\n0.1 0.3\n0.2 0.6\n0.3 1.5\n", BODY, "beyond alpha = 0.25 rad"),
        ("0 0.2\n0.1 0.19\n0.2 0.17\n", BODY, "3 unknowns need more than 3 rows"),
        ("0.0;0.2x\n0.1;0.19\n0.2;0.17\n0.3;0.1\n", BODY, "data.txt:1: expected numbers"),
        ("0,0;0,2\n0,1;0,19\n0,2;0,17\n", BODY, "data.txt:1: commas stand in the numbers"),
        (
            "11\n9\n7\n6\n",
            ("--alpha", "0.25"),
            "amplitude 1 is 11 rad: expected between 0 and alpha = 0.25 rad; --degrees",
        ),
        ("0.2\n0.15\n0\n0.1\n", ("--alpha", "0.25"), "amplitude 3 is 0 rad"),
        ("0.2\n0.15\n0.12\n", ("--alpha", "0.25", "--fit", "alpha"), "3 unknowns need more than 3 amplitudes"),
    ],
)
def test_data_that_cannot_be_fitted_are_refused(rock, capsys, text, options, words):
    Path("data.txt").write_text(text)
    assert rock("identify", "data.txt", *options) == 2
    said = capsys.readouterr().err
    assert words in said
    assert "data.txt" in said
    assert "this is a bug" not in said


def test_a_mark_before_the_first_number_loses_no_row(rock, capsys):
    # what a spreadsheet saves: a byte order mark, semicolons and Windows line ends
    Path("data.csv").write_bytes(b"\xef\xbb\xbf0.2;\r\n0.15\r\n0.118\r\n0.095\r\n")
    assert rock("identify", "data.csv", "--alpha", "0.25", "--json") == 0
    assert json.loads(capsys.readouterr().out)["points"] == 4


def test_what_the_data_do_not_tell_is_said_and_the_json_stays_json(rock, capsys):
    # four rows before the first landing: nothing of eta
    Path("data.txt").write_text("0 0.2\n0.01 0.19998\n0.02 0.19991\n0.03 0.1998\n")
    assert rock("identify", "data.txt", *BODY, "--json") == 0
    said = capsys.readouterr()
    eta = json.loads(said.out, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))["parameters"]["eta"]
    assert eta["low"] is None
    assert "the data do not determine all of eta" in said.err


def test_amplitudes_that_grow_are_no_free_rocking(rock, capsys):
    Path("data.txt").write_text("0.05\n0.1\n0.15\n0.2\n")
    assert rock("identify", "data.txt", "--alpha", "0.25") == 0
    assert "of the motion unexplained" in capsys.readouterr().err


def test_the_report_of_a_search_shows_what_was_found(rock):
    import xarray

    Path("search.yaml").write_text(SEARCH)
    assert rock("run", "search.yaml", "--no-plots", "--quiet") == 0
    assert rock("report", "results/search/search.nc") == 0
    page = Path("results/search/search.html").read_text(encoding="utf-8").replace("<wbr>", "")
    with xarray.open_dataset("results/search/search.nc") as dataset:
        found = dataset["a_p_over_g_tan_alpha_overturning"].values
    assert "<th>a_p_over_g_tan_alpha_overturning</th>" in page
    for value in found:
        assert f"<td>{value:.6g}</td>" in page


@pytest.mark.parametrize(("axis", "code"), [("R", 0), ("block.R", 0), ("b", 2)])
def test_over_takes_the_last_part_of_a_path(rock, capsys, axis, code):
    Path("sizes.yaml").write_text(
        f"name: sizes\ncase: {{block: {{R: 2, tan_alpha: 0.2}}, initial: {{theta: 0.02}}}}\n"
        f"vary: {{block.R: [1, 2]}}\nover: {axis}\n"
    )
    assert rock("check", "sizes.yaml") == code
    assert ("no axis of the dataset" in capsys.readouterr().err) == (code == 2)
