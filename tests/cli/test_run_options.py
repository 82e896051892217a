"""`rock run --workers --part --dask` and ROCK_KERNELS: what they are told, what they tell."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from rockcli.cli.progress import Progress

Rock = Callable[..., int]

STUDY = """\
name: few
case:
  block: {R: 2.0, tan_alpha: 0.2}
  initial: {theta: 0.1}
vary:
  block.R: [1.0, 2.0, 3.0, 4.0]
save: {histories: false, scalars: [outcome]}
"""


@pytest.fixture
def few(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROCK_KERNELS", "interpreted")
    path = tmp_path / "few.yaml"
    path.write_text(STUDY)
    return path


@pytest.mark.parametrize("part", ["0/2", "3/2", "2", "1/0", "a/b", "-1/2", "1/2/3", ""])
def test_shares_that_cannot_be(part: str, few: Path, rock: Rock, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", few, f"--part={part}") == 2
    assert "expected K/N with K from 1 to N, such as 2/8" in capsys.readouterr().err
    assert not Path("results").exists()


def test_shares_are_not_fresh(few: Path, rock: Rock, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", few, "--part", "1/2", "--fresh") == 2
    assert "--part does not go with --fresh" in capsys.readouterr().err


def test_shares_tell_what_is_missing_and_are_merged(few: Path, rock: Rock, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", few, "--part", "1/2") == 0
    assert re.search(r"few: share 1/2 solved in .*, 2 cases of other shares still missing", capsys.readouterr().out)
    assert rock("run", few, "--part", "2/2", "--json") == 0
    told = json.loads(capsys.readouterr().out)["studies"][0]
    assert (told["status"], told["share"], told["resumed"], told["file"]) == ("share solved", [2, 2], 4, None)
    assert rock("run", few, "--no-plots") == 0
    assert "kept      4 cases of earlier runs" in capsys.readouterr().out


def test_what_was_taken_over_is_told(few: Path, rock: Rock, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", few, "--no-plots") == 0
    few.write_text(STUDY.replace("4.0]", "4.0, 5.0]"))
    assert rock("run", few, "--no-plots", "--workers", "2") == 0
    assert "kept      4 cases of the existing results" in capsys.readouterr().out


def test_workers_are_counted_from_one(few: Path, rock: Rock) -> None:
    assert rock("run", few, "--workers", "0") == 2


def test_kernels_of_an_unknown_kind(
    few: Path, rock: Rock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROCK_KERNELS", "compile")
    assert rock("run", few) == 2
    said = "ROCK_KERNELS is 'compile'; expected interpreted, compiled, ahead, jit or nothing"
    assert said in capsys.readouterr().err
    assert not list(few.parent.rglob("*.nc"))


def test_a_cluster_that_is_not_there(
    few: Path, rock: Rock, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rockcli.engine.sweep.cluster.ANSWERS_WITHIN", 0.3)
    assert rock("run", few, "--dask", "tcp://127.0.0.1:9") == 2
    assert "rock: --dask" in capsys.readouterr().err
    assert not Path("results").exists()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True

    def fresh(self) -> str:
        """What was written since the last look, without what moves the cursor and chooses colours."""
        text = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]|\r", "", self.getvalue())
        self.seek(0)
        self.truncate()
        return text


def test_the_rate_is_that_of_this_run(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    terminal = Terminal()
    monkeypatch.setattr("rockcli.cli.progress.perf_counter", lambda: clock[0])
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    line = Progress("few", shown=True)
    line.note("compiling")
    assert terminal.fresh().rstrip().endswith("compiling")
    clock[0] = 1.0
    line(9000, 10000)  # what earlier runs had
    assert terminal.fresh().rstrip().endswith("9000/10000 cases")
    clock[0] = 2.0
    line(9050, 10000)
    terminal.fresh()
    clock[0] = 4.0
    line(9150, 10000)
    told = terminal.fresh()
    assert "9150/10000 cases, 50/s" in told
    assert "0:00:17" in told  # 850 are left
    line.close()
    assert terminal.getvalue().endswith("\x1b[1A\x1b[2K")  # back to the line of the bar, which is wiped


def test_the_bar_is_drawn_ten_times_a_second_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    terminal = Terminal()
    monkeypatch.setattr("rockcli.cli.progress.perf_counter", lambda: clock[0])
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    line = Progress("many", shown=True)
    for done in range(1, 1000):
        clock[0] += 0.001
        line(done, 1001)
    assert 8 <= terminal.fresh().count("/1001 cases") <= 12
    line.close()


def test_no_line_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    Progress("few", shown=True)(1, 2)
    assert capsys.readouterr().err == ""
