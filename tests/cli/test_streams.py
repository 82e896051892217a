"""Readers that go away, streams that take nothing, and errors that are not theirs."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rockcli.cli import show
from rockcli.storage import netcdf

ROCK = [sys.executable, "-m", "rockcli.cli.main"]

STUDY = """\
name: {name}
case:
  block: {{R: 2.0, tan_alpha: 0.2}}
  initial: {{theta: 0.05}}
save: {{histories: false}}
expect:
  - {{quantity: outcome, is: {outcome}}}
"""


def read_by_nobody(folder: Path, *args: str, both: bool = False) -> tuple[int, str]:
    """Exit code and stderr of `rock ARGS... | true`, or of `rock ARGS... 2>&1 | true`."""
    reading, writing = os.pipe()
    os.close(reading)
    try:
        found = subprocess.run(
            [*ROCK, *args],
            cwd=folder,
            stdout=writing,
            stderr=writing if both else subprocess.PIPE,
            text=True,
            check=False,
            env=os.environ | {"ROCK_KERNELS": "interpreted"},
        )
    finally:
        os.close(writing)
    return found.returncode, found.stderr or ""


@pytest.mark.parametrize("closed", [(1,), (2,), (0, 1, 2)])
@pytest.mark.parametrize("command", [("run", "--no-plots"), ("check",)], ids=["run", "check"])
def test_streams_that_were_closed_before_take_nothing(
    command: tuple[str, ...], closed: tuple[int, ...], tmp_path: Path
) -> None:
    """As `rock ... >&-` has it, or a daemon that closes all before it starts a program."""
    (tmp_path / "a.yaml").write_text(STUDY.format(name="a", outcome="rocking"))
    where = " ".join(f"{number}>&-" for number in closed)
    found = subprocess.run(
        ["sh", "-c", f'"$@" {where}', "sh", *ROCK, *command, "a.yaml"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"ROCK_KERNELS": "interpreted"},
    )
    assert (found.returncode, found.stderr) == (0, "")
    assert bool(found.stdout) == (closed == (2,))
    assert (tmp_path / "results" / "a" / "a.nc").is_file() == (command[0] == "run")


@pytest.mark.parametrize(("outcome", "code"), [("rocking", 0), ("overturned", 1)])
@pytest.mark.parametrize("options", [(), ("--json",)])
def test_all_studies_are_solved_and_decide_the_exit_code(
    outcome: str, code: int, options: tuple[str, ...], tmp_path: Path
) -> None:
    for name, wanted in (("a", "rocking"), ("b", "rocking"), ("c", outcome)):
        (tmp_path / f"{name}.yaml").write_text(STUDY.format(name=name, outcome=wanted))
    command = ["run", "a.yaml", "b.yaml", "c.yaml", "--no-plots", "--junit", "v.xml", *options]
    assert read_by_nobody(tmp_path, *command) == (code, "")
    assert all(netcdf.identity(tmp_path / "results" / name / f"{name}.nc") for name in "abc")
    assert f'name="c" tests="2" failures="{code}"' in (tmp_path / "v.xml").read_text()


def test_also_where_nobody_reads_the_errors(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(STUDY.format(name="a", outcome="overturned") + "let: {unused: 1}\n")
    assert read_by_nobody(tmp_path, "run", "a.yaml", "--no-plots", both=True)[0] == 1
    assert netcdf.identity(tmp_path / "results" / "a" / "a.nc")


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-8"])
def test_what_an_encoding_lacks_is_printed_by_its_number(encoding: str, tmp_path: Path) -> None:
    (tmp_path / "x.yaml").write_text(
        "name: x\ncase: {block: {R: 2.0, tan_alpha: 0.2}, initial: {theta: 0.1}}\n"
        "save: {histories: false}\nvary: {case: {µ α: {}, b: {block.R: 1.0}}}\n",
        encoding="utf-8",
    )
    here = {"cwd": tmp_path, "env": os.environ | {"PYTHONIOENCODING": encoding}, "capture_output": True}
    command = [sys.executable, "-m", "rockcli"]
    assert subprocess.run([*command, "run", "x.yaml", "--no-plots"], check=False, **here).returncode == 0  # type: ignore[call-overload]
    shown = subprocess.run([*command, "table", "results/x/x.nc"], check=False, **here)  # type: ignore[call-overload]
    assert shown.returncode == 0, shown.stderr
    assert ("µ α" if encoding == "utf-8" else "µ \\u03b1") in shown.stdout.decode(encoding)


def test_what_is_only_shown_is_no_failure(tmp_path: Path) -> None:
    assert read_by_nobody(tmp_path, "show", "variables") == (0, "")


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (OSError(12, "Cannot allocate memory"), "rock: Cannot allocate memory\n"),
        (OSError(28, "No space left on device"), "rock: no space left on the device\n"),
        (OSError(5, "Input/output error", "/dev/sda"), "rock: /dev/sda: Input/output error\n"),
    ],
)
def test_an_error_of_the_system_is_not_blamed_on_standard_output(error, told, rock, monkeypatch, capsys):
    def refuse() -> str:
        raise error

    monkeypatch.setitem(show._TOPICS, "models", refuse)
    assert rock("show", "models") == 4
    found = capsys.readouterr()
    assert found.err == told
    print("still there")
    assert capsys.readouterr().out == "still there\n"


class TestJunit:
    @pytest.fixture
    def made(self, rock, tmp_path):
        for name in "ab":
            (tmp_path / f"{name}.yaml").write_text(STUDY.format(name=name, outcome="rocking"))
        assert rock("run", "a.yaml", "--no-plots", "--quiet") == 0
        (tmp_path / "notes.txt").write_text("mine")
        (tmp_path / "link.xml").symlink_to("a.yaml")
        return tmp_path

    @pytest.mark.parametrize(
        "place",
        [
            "a.yaml",
            "b.yaml",
            "link.xml",
            "notes.txt",
            "results/a/a.nc",
            "results/b/b.nc",
            "results/../results/b/b.nc",
        ],
    )
    def test_replaces_nothing_but_junit(self, place, made, rock, capsys, monkeypatch):
        before = {path: path.read_bytes() for path in made.rglob("*") if path.is_file()}
        with monkeypatch.context() as unsolved:
            unsolved.setattr("rockcli.engine.run.run_study", None)  # nothing is to be solved
            assert rock("run", "b.yaml", "--no-plots", "--junit", place) == 2
        said = capsys.readouterr().err
        assert re.search(f"{re.escape(str(place))}: (is|exists)", said)
        assert "--junit" in said
        assert {path: path.read_bytes() for path in made.rglob("*") if path.is_file()} == before

    def test_nor_what_the_run_itself_makes(self, made, rock, capsys):
        assert rock("run", "b.yaml", "--format", "svg", "--junit", "results/b/histories.svg", "--set", "save={}") == 4
        assert "is not a JUnit file" in capsys.readouterr().err
        assert "<svg" in Path("results/b/histories.svg").read_text()
        assert netcdf.identity(Path("results/b/b.nc"))

    def test_its_own_are_renewed(self, made, rock, capsys):
        Path("v.xml").touch()
        for name in "ab":
            assert rock("run", f"{name}.yaml", "--no-plots", "--junit", "v.xml", "--json") == 0
            assert json.loads(capsys.readouterr().out)["exit_code"] == 0
            assert f'<testsuite name="{name}"' in Path("v.xml").read_text()
