"""What people mistype or mistake is answered with what to do."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

STUDY = """
name: mine
case:
  block: {height: 1.8, width: 0.5}
  motion: {pulse: {shape: sine, a_p: 3, T_p: 1}}
plots: none
"""


def test_changed_keys_are_named_and_what_to_type(rock, tmp_path, capsys):
    path = tmp_path / "mine.yaml"
    path.write_text(STUDY)
    assert rock("run", path, "-q") == 0
    path.write_text(STUDY.replace("a_p: 3", "a_p: 3.5").replace("1.8", "1.9"))
    assert rock("run", path, "-q") == 2
    said = capsys.readouterr().err
    assert "case.block.height (1.8 -> 1.9), case.motion.pulse.a_p (3 -> 3.5)" in said
    assert f"rock run {path} --fresh" in said
    path.write_text(STUDY + "vary: {block.width: [0.4, 0.6]}\n")
    assert rock("run", path, "-q") == 2
    assert "vary.block.width (nothing -> [0.4, 0.6])" in capsys.readouterr().err


def test_of_long_lists_of_words_what_changed_is_named(rock, tmp_path, capsys):
    path, saved = tmp_path / "mine.yaml", "outcome, theta_peak, theta_peak_over_alpha, n_impacts"
    path.write_text(STUDY + f"save: {{scalars: [{saved}]}}\n")
    assert rock("run", path, "-q") == 0
    path.write_text(STUDY + f"save: {{scalars: [{saved.replace('n_impacts', 't_peak')}]}}\n")
    assert rock("run", path, "-q") == 2
    assert "save.scalars (['n_impacts'] -> ['t_peak'])" in capsys.readouterr().err
    path.write_text(STUDY + f"save: {{scalars: [{saved}, t_peak]}}\n")
    assert rock("run", path, "-q") == 2
    assert "save.scalars (nothing -> ['t_peak'])" in capsys.readouterr().err


def test_a_changed_file_is_named(rock, tmp_path, capsys):
    record = tmp_path / "motion.csv"
    record.write_text("# units: m/s2\n" + "".join(f"{0.02 * i:.2f},{(-1) ** i}\n" for i in range(20)))
    study = tmp_path / "mine.yaml"
    study.write_text(STUDY.replace("pulse: {shape: sine, a_p: 3, T_p: 1}", "record: {file: motion.csv, units: m/s2}"))
    assert rock("run", study, "-q") == 0
    record.write_text(record.read_text().replace("0.02,-1", "0.02,-2"))
    assert rock("run", study, "-q") == 2
    assert "the file motion.csv" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["plot", "report", "table", "animate"])
def test_a_study_given_for_a_dataset(rock, tmp_path, capsys, command):
    (tmp_path / "mine.yaml").write_text(STUDY)
    assert rock(command, "mine.yaml") == 2
    said = capsys.readouterr().err
    assert "is a study, not a dataset" in said
    assert "rock run mine.yaml" in said


def test_a_dataset_given_for_a_study(rock, tmp_path, capsys):
    (tmp_path / "mine.yaml").write_text(STUDY)
    assert rock("run", "mine.yaml", "-q") == 0
    assert rock("check", "results/mine/mine.nc") == 2
    assert "is a dataset, not a study" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("name: a\ncase:\n  block: {R: 1, tan_alpha: .2}\n    motion: null\n", 4, "indented"),
        ("name: a\ncase:\n  block: {R: 1, tan_alpha: .2}\n motion: null\n", 4, "indented"),
        ("name: a\n  case: 1\n", 2, "indented too far"),
        ("name: a\ntitle: one: two\n", 2, "quotes"),
    ],
)
def test_lines_that_are_indented_wrongly(rock, tmp_path, capsys, text, line, words):
    (tmp_path / "mine.yaml").write_text(text)
    assert rock("check", "mine.yaml") == 2
    said = capsys.readouterr().err
    assert f"mine.yaml:{line}: not YAML" in said
    assert words in said
    assert "block mapping" not in said


def test_clauses_that_are_met_are_counted(rock, tmp_path, capsys):
    clauses = "".join(f"  - {{quantity: theta_peak_over_alpha, max: {10 + i}}}\n" for i in range(7))
    (tmp_path / "mine.yaml").write_text(STUDY + "expect:\n" + clauses)
    assert rock("run", "mine.yaml") == 0
    said = capsys.readouterr().out
    assert "7 of 7 met (-v lists them)" in said
    assert "ok    " not in said
    assert rock("run", "mine.yaml", "-v") == 0
    assert capsys.readouterr().out.count("ok    ") == 7
    (tmp_path / "mine.yaml").write_text(STUDY + "expect:\n" + clauses + "  - {quantity: outcome, is: no_uplift}\n")
    assert rock("run", "mine.yaml") == 1
    said = capsys.readouterr().out
    assert "7 of 8 met" in said
    assert said.count("FAIL  ") == 1
    assert "ok    " not in said


def test_check_lists_every_body_and_how_it_begins(rock, tmp_path, capsys):
    bodies = (
        "vary: {block: {tall: {height: 2, width: 0.4, mu: 0.5}, low: {height: 1, width: 0.8, mu: 0.3}}, a_p: [2, 3]}\n"
    )
    (tmp_path / "mine.yaml").write_text(STUDY + bodies.replace("a_p", "motion.pulse.a_p"))
    assert rock("check", "mine.yaml") == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    tall, low = (next(line for line in lines if line and line[0] == f"block={name}") for name in ("tall", "low"))
    assert (tall[1], tall[-1], tall[-2]) == ("2", "rock", "0.2")
    assert (low[1], low[-1], low[-2]) == ("2", "slide", "0.8")
    assert rock("check", "mine.yaml", "--json") == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert [row["body"] for row in found["bodies"]] == ["block=tall", "block=low"]
    assert [row["h [m]"] for row in found["bodies"]] == [1.0, 0.5]


def test_check_names_a_body_that_stands_at_several_points(rock, tmp_path, capsys):
    """Two inverters of one size, on two floors, are one body: its name was empty."""
    names = ["MCC", *(f"INV-{i}" for i in range(5))]
    for several, said in ((2, "INV-0 and INV-1"), (3, "INV-0, INV-1 and INV-2"), (5, "INV-0, INV-1, INV-2 and 2 more")):
        cells = [f"{name}: {{height: {2 if name == 'MCC' else 1}, width: 0.4}}" for name in names[: 1 + several]]
        (tmp_path / "mine.yaml").write_text(STUDY + f"vary: {{block: {{{', '.join(cells)}}}}}\n")
        assert rock("check", "mine.yaml", "--json") == 0
        (found,) = json.loads(capsys.readouterr().out)
        assert [(row["body"], row["cases"]) for row in found["bodies"]] == [
            ("block=MCC", 1),
            (f"block={said}", several),
        ]


def test_check_lists_every_body_of_a_large_study(rock, tmp_path, capsys):
    bodies = ", ".join(f"b{i}: {{height: {2 + i}, width: 0.4}}" for i in range(5))
    wide = "motion.pulse.a_p: {from: 1, to: 9, n: 100}, motion.pulse.T_p: {from: 0.1, to: 2, n: 50}"
    (tmp_path / "mine.yaml").write_text(STUDY + f"vary: {{block: {{{bodies}}}, {wide}}}\nsave: {{histories: false}}\n")
    assert rock("check", "mine.yaml", "--json") == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert [(row["body"], row["cases"]) for row in found["bodies"]] == [(f"block=b{i}", 5000) for i in range(5)]
    assert [row["h [m]"] for row in found["bodies"]] == [1.0, 1.5, 2.0, 2.5, 3.0]


def test_check_proposes_refine_for_a_wide_map_and_doubts_it_for_a_narrow_one(rock, tmp_path, capsys):
    size = "vary: {motion.pulse.a_p: {from: 1, to: 9, n: N}, motion.pulse.T_p: {from: 0.1, to: 2, n: N}}\nsave: {histories: false}\n"
    flexible = STUDY.replace("motion:", "model: flexible\n  column: {E: 30e9, rho: 2400}\n  motion:")
    (tmp_path / "mine.yaml").write_text(flexible + size.replace("N", "300"))
    assert rock("check", "mine.yaml") == 0
    assert "`refine: true` would solve only" in capsys.readouterr().err
    for points in (99, 100):
        (tmp_path / "mine.yaml").write_text(STUDY + "refine: true\n" + size.replace("N", str(points)))
        assert rock("check", "mine.yaml") == 0
        doubted = "solves all of a map of fewer than 100 points" in capsys.readouterr().err
        assert rock("run", "mine.yaml", "--json", "--fresh", "--no-plots") == 0
        (found,) = json.loads(capsys.readouterr().out)["studies"]
        assert doubted == (found["refined"] == points**2)


@pytest.mark.parametrize(("height", "doubted"), [(180, True), (0.002, True), (18, False), (0.05, False)])
def test_sizes_that_are_hardly_meant(rock, tmp_path, capsys, height, doubted):
    (tmp_path / "mine.yaml").write_text(STUDY.replace("1.8, width: 0.5", f"{height}, width: {0.3 * height}"))
    assert rock("check", "mine.yaml") == 0
    assert ("in metres?" in capsys.readouterr().err) == doubted


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("rock ch", "check"),
        ("rock new st", "statue"),
        ("rock table --of fr", "fragility"),
        ("rock plot --kind ri", "risk"),
        ("rock show va", "variables"),
    ],
)
def test_the_shell_completes_commands_and_kinds(typed, expected):
    program = "import sys; sys.argv = ['rock']; from rockcli.cli.main import main; main()"
    asked = {"_ROCK_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    said = subprocess.run(
        [sys.executable, "-c", program], env=os.environ | asked, capture_output=True, text=True, check=False
    )
    assert expected in said.stdout.split(), said.stderr


def test_all_that_is_wrong_with_the_keys_of_a_study_is_told_at_once(rock, tmp_path, capsys):
    wrong = STUDY.replace("width", "widht").replace("shape: sine", "shape: sin").replace("plots: none", "plots: [foo]")
    (tmp_path / "mine.yaml").write_text(wrong + "vray: {}\n")
    assert rock("check", "mine.yaml") == 2
    first, *others = capsys.readouterr().err.splitlines()
    assert first.startswith("rock: mine.yaml:7: vray: unknown key 'vray'")
    assert [line.split(":")[0].strip() for line in others] == ["line 6", "line 4", "line 5"]
    told = "\n".join(others)
    assert "plots[0] is 'foo'" in told
    assert "did you mean 'width'" in told
    assert "did you mean 'sine'" in told


def test_many_complaints_are_counted(rock, tmp_path, capsys):
    (tmp_path / "mine.yaml").write_text(STUDY + "".join(f"wrong_{i}: 1\n" for i in range(14)))
    assert rock("check", "mine.yaml") == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 9
    assert lines[-1] == "  and 6 more"


def test_the_same_complaint_about_several_studies_is_told_once(rock, tmp_path, capsys):
    for name in ("one", "other", "third"):
        (tmp_path / f"{name}.yaml").write_text(STUDY.replace("mine", name).replace("width: 0.5", "width: -1"))
    assert rock("check", "one.yaml", "other.yaml", "third.yaml") == 2
    first, also = capsys.readouterr().err.splitlines()
    assert first == "rock: one.yaml:4: case.block.width = -1: must be greater than 0"
    assert also == "  also in other.yaml:4, third.yaml:4"
    (tmp_path / "other.yaml").write_text(STUDY.replace("height", "hight"))
    assert rock("check", ".") == 2
    first, also, other = capsys.readouterr().err.splitlines()
    assert first.startswith("rock: one.yaml:4: case.block.width = -1")
    assert also == "  also in third.yaml:4"
    assert other.startswith("rock: other.yaml:4: case.block.hight: unknown key")
    assert rock("check", ".", "--set", "case.blok.R=2") == 2
    first, *others = capsys.readouterr().err.splitlines()
    assert first.startswith("rock: --set case.blok.R=2: 'case.blok.R' is not a path")
    assert first.endswith("did you mean 'case.block.R'?")  # as --set takes it, not as an axis does
    assert others == ["  in one.yaml, other.yaml, third.yaml"]


def test_the_file_that_is_probably_meant_is_named(rock, tmp_path, capsys):
    (tmp_path / "mine.yaml").write_text(STUDY)
    for said in ("mine", "mine.yml"):
        assert rock("run", said) == 2
        assert capsys.readouterr().err == f"rock: {said}: no such file or folder; did you mean mine.yaml?\n"
    assert rock("run", "yours") == 2
    assert capsys.readouterr().err == "rock: yours: no such file or folder\n"


def test_the_word_that_is_probably_meant_is_named(rock, tmp_path, capsys):
    (tmp_path / "mine.yaml").write_text(STUDY)
    assert rock("run", "mine.yaml", "-q", "--no-plots") == 0
    dataset = "results/mine/mine.nc"
    for words, meant in (
        (("show", "model"), "models"),
        (("table", dataset, "--of", "fragilty"), "fragility"),
        (("plot", dataset, "--kind", "history"), "histories"),
    ):
        assert rock(*words) == 2
        assert capsys.readouterr().err.rstrip().endswith(f"; did you mean {meant!r}?")


@pytest.mark.parametrize("words", [(), ("run",), ("records",), ("records", "info")])
def test_help_is_also_asked_for_by_its_letter(rock, capsys, words):
    assert rock(*words, "-h") == 0
    by_letter = capsys.readouterr().out
    assert rock(*words, "--help") == 0
    assert by_letter == capsys.readouterr().out


def test_names_of_a_table_with_other_zeros_are_known(rock, tmp_path, capsys):
    """CAB-3 is CAB-03, in a study as in --select, and CAB-1 no CAB-10."""
    names = [f"CAB-{i:02d}" for i in (10, 1, 2, 3)]
    (tmp_path / "list.csv").write_text(
        "name,block.height\n" + "".join(f"{name},{2 + i}\n" for i, name in enumerate(names))
    )
    base = "name: x\ncase: {block: {height: 2, width: 0.5}, initial: {theta: 0.05}}\nvary: {case: list.csv}\n"
    clause = "expect: [{quantity: outcome, at: {case: CAB-3}, is: rocking}]\n"
    for said, meant in ((clause, "CAB-03"), ("compare_to: {case: cab-1}\n", "CAB-01")):
        (tmp_path / "x.yaml").write_text(base + said)
        assert rock("check", "x.yaml") == 2
        assert capsys.readouterr().err.rstrip().endswith(f"; did you mean {meant!r}?")
    (tmp_path / "x.yaml").write_text(base)
    assert rock("run", "x.yaml", "--no-plots", "--quiet") == 0
    assert rock("table", "results/x/x.nc", "--select", "case=CAB-1") == 2
    assert capsys.readouterr().err.rstrip().endswith("; did you mean 'CAB-01'?")
