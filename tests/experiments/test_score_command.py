"""`rock score`: a table of runs in, scores out; what is wrong with the table is one sentence with file and line."""

from __future__ import annotations

import json
import os
import re
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from rockcli.analysis.experiments.baselines import logistic
from rockcli.engine.experiments.runs import read_runs
from rockcli.engine.experiments.score import Options, baselines
from rockcli.errors import StudyError
from rockcli.study.open import NOT_SCORED, open_study
from rockcli.study.scoring import read_score

DT = 0.01
BODY = {"h": 0.3, "b": 0.06}
STUDY = {
    "name": "table",
    "case": {"block": BODY, "motion": {"record": {"units": "m/s2", "dt": DT}}, "damping": {"eta": 0.9}},
}


def motion(period: float, amplitude: float) -> np.ndarray:
    t = DT * np.arange(int(1.5 * period / DT) + 2)
    return amplitude * np.sin(2.0 * np.pi * t / period) * (t <= period)


def table(path: Path, rows: list[dict[str, object]]) -> Path:
    lines = [",".join(rows[0])] + [",".join(str(value) for value in row.values()) for row in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def experiments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Twelve sines of three periods on a block, whose fate the program itself has told, and a column of guesses."""
    import rockcli

    monkeypatch.setattr("rockcli.analysis.experiments.baselines.TREES", 20)
    rows = []
    for period in (0.3, 0.6, 1.0):
        for factor in (1.0, 2.0, 4.0, 8.0):
            name = f"sine_{period:g}.txt"
            np.savetxt(tmp_path / name, motion(period, 1.0))
            study = {
                "case": {
                    "block": BODY,
                    "damping": {"eta": 0.9},
                    "motion": {"record": {"file": str(tmp_path / name), "units": "m/s2", "dt": DT, "scale": factor}},
                },
                "save": {"histories": False},
            }
            fell = int(rockcli.run(study)["outcome"]) >= 2
            guess = 0.8 if factor > 3.0 else 0.1
            rows.append({"record": name, "scale": factor, "outcome": int(fell), "group": f"{period:g}", "guess": guess})
    assert 3 < sum(int(str(row["outcome"])) for row in rows) < 9
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    return table(tmp_path / "runs.csv", rows)


def test_a_study_is_scored_beside_columns_and_baselines(rock, experiments, capsys):
    assert rock("score", "study.yaml", "runs.csv", "--json", "--workers", 1) == 0
    (found,) = json.loads(capsys.readouterr().out)["specimens"]
    assert found["n"] == 12
    assert found["groups"] == 3
    assert found["predictions"]["table"]["accuracy"] == 1.0
    assert found["predictions"]["table"]["kind"] == "study"
    rows = [line.split(",") for line in experiments.read_text().split()[1:]]
    right = np.mean([(float(row[4]) > 0.5) == (row[2] == "1") for row in rows])
    assert found["predictions"]["guess"]["accuracy"] == pytest.approx(right)
    test = found["mcnemar"]["guess"]
    assert test["first_only"] == round(12 * (1.0 - right))
    assert test["p_value"] == min(1.0, 2.0 * 0.5 ** test["first_only"])
    assert found["predictions"]["logistic: pgv"]["kind"] == "baseline"
    assert [row["p"] for row in found["probabilities"]] == [float(row[2]) for row in rows]


@pytest.mark.parametrize("command", [("score", "--json"), ("calibrate", "--out", "found.json")], ids=lambda one: one[0])
@pytest.mark.parametrize("workers", [1, 2])
def test_what_the_machine_refuses_is_no_prediction(rock, experiments, workers, command, monkeypatch, capsys):
    """A run for which there is no memory, or whose process the system kills, was counted as one without an answer."""
    from rockcli.engine.experiments import simulated
    from rockcli.engine.sweep import executors

    here = os.getpid()

    class Greedy:
        def load(self):
            return self

        def __call__(self, batch):
            if os.getpid() != here:
                os.kill(os.getpid(), signal.SIGKILL)
            raise MemoryError("Unable to allocate 3.00 GiB")

    monkeypatch.setattr(executors, "_worth", lambda *_: True)
    monkeypatch.setattr(simulated, "choose", lambda batch: Greedy())
    word, *options = command
    assert rock(word, "study.yaml", "runs.csv", *options, "--workers", workers) == 4
    told = capsys.readouterr()
    assert "the machine refused: " in told.err
    assert ("SIGKILL" if workers > 1 else "3.00 GiB") in told.err
    assert told.out == ""
    assert not Path("found.json").exists()


def test_a_study_says_how_it_is_scored(rock, experiments, tmp_path, capsys, monkeypatch):
    given = "--no-baselines --folds group --seed 3 --predictions guess --against guess --workers 1 --json"
    assert rock("score", "study.yaml", "runs.csv", *given.split()) == 0
    by_options = json.loads(capsys.readouterr().out)["specimens"]
    below = tmp_path / "elsewhere"
    below.mkdir()
    said = {"file": "runs.csv", "folds": "group", "predictions": ["guess"], "against": "guess"}
    said |= {"seed": 3, "baselines": False}
    (tmp_path / "scored.yaml").write_text(yaml.safe_dump(STUDY | {"score": said}))
    monkeypatch.chdir(below)
    assert rock("score", "../scored.yaml", "--workers", 1, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["specimens"] == by_options
    assert found["seed"] == 3
    assert rock("score", "../scored.yaml", "--workers", 1, "--json", "--seed", 4, "--against", "table") == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["seed"], again["specimens"][0]["against"]) == (4, "table")
    with pytest.raises(StudyError, match=r"`score: \{file: RUNS.csv\}` in the study"):
        read_score(tmp_path / "study.yaml")
    assert rock("score", "../study.yaml") == 2
    assert "expected RUNS.csv" in capsys.readouterr().err


def test_score_changes_no_result_and_run_says_that_it_does_not_score(tmp_path):
    study = {"name": "x", "case": {"block": BODY, "initial": {"theta": 0.05}}}
    plain, scored = open_study(study), open_study(study | {"score": {"file": "runs.csv"}})
    assert plain.identity == scored.identity
    assert [one for one in scored.warnings if one not in plain.warnings] == [NOT_SCORED]


def test_baselines_are_fitted_on_other_runs_where_they_are_given(experiments):
    """They do not see what happened in the runs that they predict."""
    runs = read_runs(experiments)
    first = np.arange(runs.size) % 2 == 0
    known, asked = runs.rows(first), runs.rows(~first)
    found, _ = baselines(asked, STUDY, Options(), known)
    pga = [np.log(some.scale)[:, None] for some in (known, asked)]  # every sine has the amplitude 1
    right = logistic(pga[0], known.outcome)(pga[1])
    assert found["logistic: pga"].p == pytest.approx(right, abs=0.01)  # samples miss the peak by up to half a percent
    # turned outcomes of the runs that are predicted change nothing
    turned = replace(asked, outcome=~asked.outcome)
    again, _ = baselines(turned, STUDY, Options(), known)
    assert all((again[name].p == found[name].p).all() for name in found)


def test_uncertain_bodies_give_the_share_that_overturns(rock, experiments, tmp_path, capsys):
    import rockcli

    study = STUDY | {"uncertain": {"block.b": {"uniform": [0.03, 0.12]}}, "samples": 20}
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(study))
    assert rock("score", "study.yaml", "runs.csv", "--json", "--no-baselines", "--workers", 1) == 0
    (found,) = json.loads(capsys.readouterr().out)["specimens"]
    case = {"motion": {"record": {"file": str(tmp_path / "sine_0.6.txt"), "units": "m/s2", "dt": DT, "scale": 4.0}}}
    alone = rockcli.run(study | {"case": STUDY["case"] | case, "save": {"histories": False}})
    assert 0.0 < float(alone["p_overturned"]) < 1.0
    assert found["probabilities"][6]["p"] == pytest.approx(float(alone["p_overturned"]))


def test_a_table_alone_in_the_terminal_and_as_page_and_figure(rock, experiments, capsys):
    options = ("--units", "m/s2", "--dt", DT)
    assert rock("score", "runs.csv", *options, "--out", "scores.html") == 0
    said = capsys.readouterr()
    assert "12 runs in 3 groups" in said.out
    assert "McNemar" in said.out
    page = Path("scores.html").read_text()
    assert "logistic: pga, pgv, squares" in page
    assert "data:image/png" in page
    cells = re.findall(r"(\d\.\d{3}) \[(\d\.\d{3}), (\d\.\d{3})\]", said.out)
    assert len(cells) > 20
    assert all(f"{value} ({low} to {high})" in page for value, low, high in cells)
    assert rock("score", "runs.csv", *options, "--no-baselines", "--out", "reliability.svg") == 0
    drawn = Path("reliability.svg").read_text()
    assert drawn.startswith("<?xml")
    assert "runs</text>" in drawn  # words stay words, as in all other figures
    assert rock("score", "runs.csv", *options, "--no-baselines", "--out", "again.svg") == 0
    assert Path("again.svg").read_text() == drawn


def test_specimens_are_scored_apart(rock, tmp_path, capsys):
    rows = [{"specimen": "ab"[i % 2], "outcome": ("stood", "overturned")[i % 3 == 0], "p": 0.1 * i} for i in range(9)]
    table(tmp_path / "runs.csv", rows)
    assert rock("score", "runs.csv", "--json") == 0
    both = json.loads(capsys.readouterr().out)["specimens"]
    assert [(one["specimen"], one["n"]) for one in both] == [("a", 5), ("b", 4)]
    assert any("no baselines" in note for note in both[0]["notes"])
    assert rock("score", "runs.csv", "--json", "--specimen", "b") == 0
    assert json.loads(capsys.readouterr().out)["specimens"] == both[1:]
    assert rock("score", "runs.csv", "--specimen", "c") == 2


GOOD = "record,outcome,p\na.txt,1,0.5\nb.txt,stood,0.25\n"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("record,p\na.txt,0.5\n", 1, "no column `outcome`"),
        ("outcome,p\n1,0.5\nmaybe,0.5\n", 3, "outcome is 'maybe'"),
        ("outcome,p,p\n1,0.5,1\n", 1, "repeats"),
        ("outcome,p\n1,0.5\n\n1\n", 4, "1 cell, the first has 2"),
        ("outcome,scale\n1,0.5\n1,big\n", 3, "scale is 'big'"),
        ("outcome,scale\n1,0.5\n1,0\n", 3, "scale is '0'; expected a number greater than 0"),
        ("outcome,scale\n1,0.5\n1,-1\n", 3, "scale is '-1'; expected a number greater than 0"),
        ("outcome,Scale\n1,0.5\n1,1\n", 1, "the column 'Scale' would be read as a prediction; did you mean 'scale'"),
        ("outcome,pga [g]\n1,0.5\n1,1\n", 1, "did you mean 'pga'"),
        ("outcome,record\n1,a.txt\n1,\n", 3, "below 'record' is empty"),
        ("outcome,pga\n1,-0.5\n", 2, "greater than 0"),
        ("outcome,p\n", None, "no runs"),
        ("", None, "no runs"),
        ('outcome,p\n1,"0.5\n', 2, "no CSV"),
        ('outcome,p\nmaybe,"0.5\n"\n', 2, "outcome is 'maybe'"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, text, line, words):
    path = tmp_path / "runs.csv"
    path.write_text(text)
    with pytest.raises(StudyError, match=words) as caught:
        read_runs(path)
    assert (caught.value.file, caught.value.line) == (str(path), line)


def test_a_prediction_asked_for_must_be_one(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text(GOOD.replace("0.25", "1.25"))
    assert read_runs(path).unread == ("p",)
    with pytest.raises(StudyError, match=r"p is '1\.25'") as caught:
        read_runs(path, predictions=["p"])
    assert caught.value.line == 3
    with pytest.raises(StudyError, match="no column 'q'"):
        read_runs(path, predictions=["q"])


def test_the_column_that_is_no_prediction_is_named_where_nothing_is_left(rock, tmp_path, capsys):
    path = tmp_path / "runs.csv"
    path.write_text(GOOD.replace("0.25", "1.25"))
    assert rock("score", path, "--no-baselines") == 2
    assert "no baseline (no predictions, as not all their cells are: columns p)" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere.csv",), "no such file"),
        (("study.yaml",), "expected RUNS.csv"),
        (("study.yaml", "runs.csv", "--units", "g"), "without a study"),
        (("runs.csv", "--out", "scores.txt"), "expected .html"),
        (("runs.csv", "--no-baselines", "--against", "nobody"), "no prediction 'nobody'"),
        (("study.yaml", "lost.csv"), "lost.csv:2: the record 'nowhere.txt'"),
        (("pulse.yaml", "runs.csv"), "the motions are the records of the runs"),
        (("scaled.yaml", "runs.csv"), "column `scale`"),
        (("filtered.yaml", "runs.csv"), "follow from the body"),
        (("floor.yaml", "runs.csv"), "follow from the body"),
        (
            ("arrives.yaml", "runs.csv"),
            "floor_pga is one for all: how strong a run's ground is, its column `scale` says",
        ),
    ],
)
def test_bad_input_is_one_error_and_writes_nothing(rock, experiments, tmp_path, capsys, arguments, words):
    (tmp_path / "lost.csv").write_text("record,outcome\nnowhere.txt,1\n")
    pulse = {"motion": {"pulse": {"shape": "sine", "a_p": 1, "omega_p": 3}}}
    (tmp_path / "pulse.yaml").write_text(yaml.safe_dump(STUDY | {"case": STUDY["case"] | pulse}))
    scaled = {"motion": {"record": {"units": "g", "dt": DT, "pga": 3}}}
    (tmp_path / "scaled.yaml").write_text(yaml.safe_dump(STUDY | {"case": STUDY["case"] | scaled}))
    record = {"units": "m/s2", "dt": DT}
    filtered = {"motion": {"record": record | {"highpass": "0.3*p"}}}  # of a block of R = 1 m, that nobody gave
    (tmp_path / "filtered.yaml").write_text(yaml.safe_dump(STUDY | {"case": STUDY["case"] | filtered}))
    floor = {"motion": {"record": record, "through": [{"T": "2/p", "zeta": 0.05}]}}
    (tmp_path / "floor.yaml").write_text(yaml.safe_dump(STUDY | {"case": STUDY["case"] | floor}))
    arrives = {"motion": {"record": record, "through": [{"f": 3, "zeta": 0.05}], "floor_pga": 3}}
    (tmp_path / "arrives.yaml").write_text(yaml.safe_dump(STUDY | {"case": STUDY["case"] | arrives}))
    before = set(tmp_path.iterdir())
    assert rock("score", *arguments) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.out == ""
    assert set(tmp_path.iterdir()) == before
