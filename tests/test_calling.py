"""docs/calling.md holds: its study, written as JSON, goes through its commands, and what they give is read without Python's help."""

from __future__ import annotations

import csv
import json
import re
import shlex
import textwrap
from pathlib import Path

import pytest
from typer.testing import CliRunner

from rockcli.cli.main import app

PAGE = (Path(__file__).resolve().parents[1] / "docs" / "calling.md").read_text(encoding="utf-8")


def block(kind: str) -> str:
    (found,) = re.findall(rf"^ *```{kind}\n(.*?)^ *```", PAGE, re.DOTALL | re.M)
    return textwrap.dedent(found)


def test_the_commands_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = json.loads(block("json"))
    Path("cabinet.json").write_text(json.dumps(study), encoding="utf-8")
    for line in block("sh").splitlines():
        command, _, target = line.partition(" > ")
        ran = CliRunner().invoke(app, shlex.split(command)[1:])
        assert ran.exit_code == 0, ran.output
        if target:
            Path(target).write_text(ran.stdout, encoding="utf-8")
    (checked,) = json.loads(Path("check.json").read_text(encoding="utf-8"))
    (solved,) = json.loads(Path("summary.json").read_text(encoding="utf-8"))["studies"]
    amplitudes = study["vary"]["motion.pulse.a_p"]
    assert checked["cases"] == solved["cases"] == len(amplitudes)
    with Path("cases.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["motion_pulse_a_p [m s-2]"]) for row in rows] == pytest.approx(
        [9.81 * float(text.removesuffix("*g")) for text in amplitudes]
    )
    assert [row["outcome"] for row in rows].count("rocking") == solved["outcomes"]["rocking"]


def test_the_file_names_of_the_examples_agree():
    assert "jsonencode" in block("matlab")
    assert "rock run cabinet.json --json --quiet --no-plots --out results" in block("matlab")
    assert "rock run cabinet.json --json --quiet --no-plots --out results" in block("sh")
