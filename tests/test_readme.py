"""README's two commands are those that continuous integration runs; its studies are well-formed."""

from __future__ import annotations

import re
from pathlib import Path

from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.study.open import open_study

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", README, flags=re.DOTALL)


def test_continuous_integration_runs_the_commands_of_the_readme():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    commands = [line for block in blocks("sh") for line in block.splitlines() if line.strip()]
    assert len(commands) == 2
    for command in commands:
        assert command in script


def test_the_first_study_is_the_example(tmp_path):
    shown = tmp_path / "shown.yaml"
    shown.write_text(blocks("yaml")[0])
    study, example = open_study(shown), open_study(ROOT / "studies" / "examples" / "first_rock.yaml")
    assert study.identity == example.identity


def test_the_session_is_a_real_one(tmp_path, monkeypatch):
    """The console block is what the command prints, but for the time it takes."""
    (session,) = blocks("console")
    command, _, shown = session.partition("\n")
    assert command.startswith("$ rock run ")
    words = command.split()[2:]
    words[1] = str(ROOT / words[1])
    monkeypatch.chdir(tmp_path)
    ran = CliRunner().invoke(app, [*words, "--workers", "1"])
    assert ran.exit_code == 0

    def timeless(text: str) -> str:
        return re.sub(r"solved in .*", "solved", text.strip())

    assert timeless(ran.stdout) == timeless(shown)


def test_the_readme_is_short():
    assert len(README.splitlines()) < 200


def test_the_citation_names_this_version():
    assert f"\nversion: {rockcli.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
