"""What the command says: plurals, warnings, what cannot be drawn, what takes long."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray

import rockcli
from rockcli.cli.progress import Progress
from rockcli.scene.counted import counted
from rockcli.storage.read import open_dataset

Rock = Callable[..., int]

STUDY = """\
name: {name}
case:
  block: {{R: 2.0, tan_alpha: 0.2}}
  motion: {{pulse: {{shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 3*pi}}}}
{more}
"""

CUT = "is shorter than the motion"


def study(folder: Path, name: str = "x", more: str = "") -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(STUDY.format(name=name, more=more))
    return path


def test_one_false_alarm_is_one(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = "a_p: 3, omega_p: 30"  # far above what West's rule lets stand, and too short to overturn anything
    path = tmp_path / "x.yaml"
    path.write_text(STUDY.format(name="x", more="rules: [west]").replace("a_p: 3.6*g*tan_alpha, omega_p: 3*pi", short))
    assert rock("run", path, "--no-plots") == 0
    assert ", 1 false alarm, of 1 (" in capsys.readouterr().out


def test_plurals(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert [counted(n, "study") for n in (0, 1, 2)] == ["0 studies", "1 study", "2 studies"]
    one = study(tmp_path, "one", "save: {histories: false}")
    (tmp_path / "away.yaml").write_text(
        "name: away\ncase:\n  block: {R: 5.0, tan_alpha: 0.2}\n  motion: {record: {file: NO.AT2}}\n"
    )
    assert rock("run", one, tmp_path / "away.yaml", "--skip-missing", "--no-plots") == 0
    told = capsys.readouterr().out
    assert "one: 1 case, solved" in told
    assert "1 study, 1 case, 1 skipped" in told
    failing = "vary: {block.R: [2.0, 3.0]}\nexpect: [{quantity: R, max: 2.5}]"
    assert rock("run", study(tmp_path, "two", failing), "--no-plots") == 1
    assert "1 of 2 points fails, worst" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["run", "check"])
def test_q_is_quiet(command: str, rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path)
    file.write_text(file.read_text().replace("motion: {", "motion: {duration: 1.0, "))
    assert rock(command, file, "-q") == 0
    assert capsys.readouterr() == ("", "")


def test_warnings_are_told_and_kept(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path, more="vary: {motion.duration: [9.0, 1.0]}")
    for command in (["check"], ["run", "--no-plots"], ["run", "--no-plots"], ["run", "--no-plots", "--json"]):
        assert rock(command[0], file, *command[1:]) == 0
        told = capsys.readouterr()
        assert told.err.count(CUT) == 1
        assert told.err.startswith("rock: x: warning: ")
    assert CUT in json.loads(told.out)["studies"][0]["warnings"][0]
    (kept,) = json.loads(open_dataset(tmp_path / "results" / "x" / "x.nc").attrs["warnings"])
    assert CUT in kept
    assert json.loads(rockcli.run(file).attrs["warnings"]) == [kept]


def test_what_cannot_be_drawn(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    xarray.Dataset({"t": ("x", [1.0, 2.0])}).to_netcdf(tmp_path / "foreign.nc")
    assert rock("plot", "foreign.nc") == 2
    assert "foreign.nc: is not a dataset written by `rock run`" in capsys.readouterr().err
    assert rock("plot", ".") == 2
    assert ".: is a folder" in capsys.readouterr().err
    bare = study(tmp_path, more="save: {histories: false, scalars: [outcome]}")
    rockcli.run(bare).drop_vars("alpha").to_netcdf(tmp_path / "bare.nc")  # with alpha its body is drawn
    assert rock("plot", "bare.nc") == 2
    told = capsys.readouterr().err
    assert "nothing in it can be drawn" in told
    assert "holds no histories" in told
    rockcli.run(study(tmp_path)).drop_vars(["alpha", "a_g"]).to_netcdf(tmp_path / "less.nc")
    assert rock("plot", "less.nc") == 2
    assert "nothing in it can be drawn" in capsys.readouterr().err
    rockcli.run(study(tmp_path)).to_netcdf(tmp_path / "own.nc")
    assert rock("plot", "own.nc", "--kind", "phase") == 0


def test_a_note_in_a_terminal_only(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    Progress("x", shown=True).note("compiling")
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", "1")
    line = Progress("x", shown=True)
    line.note("compiling")
    line.close()
    assert re.search("x: .*compiling", capsys.readouterr().err)


def test_compiling_is_announced_once(tmp_path: Path) -> None:
    """Nothing in the cache: before; something there, or nothing to compile: not at all."""
    script = (
        "import sys\nfrom pathlib import Path\nfrom rockcli import kernels\nfrom rockcli.kernels import places\n"
        "places.INSTALLED = Path('nowhere')\nkernels.announce = lambda words: print('compiling')\n"
        "kernels.load(compile_them=False)\nkernels.load(compile_them=sys.argv[1] == 'compiled')\n"
        "kernels.load(compile_them=True)\n"
    )

    def told(wish: str) -> str:
        return subprocess.run(
            [sys.executable, "-c", script, wish],
            capture_output=True,
            text=True,
            check=True,
            env={k: v for k, v in os.environ.items() if k != "ROCK_KERNELS"} | {"ROCK_CACHE_DIR": str(tmp_path)},
        ).stdout

    assert told("compiled") == "compiling\n"
    assert told("later") == "compiling\n"
    (folder,) = tmp_path.iterdir()
    (folder / "march.nbi").write_text("")
    assert told("compiled") == ""


def test_a_long_case_tells_how_far_it_is(capsys, monkeypatch):
    import logging

    from rockcli.cli.progress import Progress

    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", "1")
    logger = logging.getLogger("rockcli")
    before = (logger.level, list(logger.handlers))
    try:
        line = Progress("tower", shown=True)
        line.listen()
        logging.getLogger("rockcli.solvers.calculix.folder").info("t = %.4g s of %.4g s", 1.5, 6.5)
        line.close()
    finally:
        logger.level, logger.handlers = before
    assert re.search(r"tower: .*t = 1\.5 s of 6\.5 s", capsys.readouterr().err)


def test_a_suite_has_its_lines() -> None:
    from rockcli.cli.words import report_text
    from rockcli.engine.summary import RunReport

    told = report_text(RunReport("n", "solved", cases=3, suite=("first words", "second words")))
    assert "  suite     first words\n            second words\n" in told


@pytest.mark.parametrize(
    ("refined", "words"),
    [(57, "57 cases solved (5.7 %), the outcomes"), (998, "998 cases solved (99 %), the outcomes"), (1000, "1000 cases solved (all)\n")],
)  # fmt: skip
def test_how_much_of_a_refined_map_was_solved(refined: int, words: str) -> None:
    from rockcli.cli.words import report_text
    from rockcli.engine.summary import RunReport

    told = report_text(RunReport("n", "solved", cases=1000, refined=refined, outcomes={"rocking": 1000}))
    assert f"  refined   {words}" in told


def test_cases_that_failed_for_want_of_a_program_are_told_so_again(
    rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file is finished; whoever has installed what was lacking is told how to have the cases solved."""
    monkeypatch.setenv("ROCK_OPENSEES_PYTHON", str(tmp_path / "python"))
    file = study(tmp_path, more='vary: {solver: {ours: {}, peer: {backend: opensees}}, model: ["1"]}\nplots: none')
    assert rock("run", file) == 3
    assert "--fresh" not in capsys.readouterr().out
    assert rock("run", file) == 3
    again = capsys.readouterr().out
    assert "up to date" in again
    assert (
        "1 case when this file was made; once the cause is mended, as a program installed, --fresh solves all again"
        in again
    )


def test_one_of_a_kind_is_told_as_one(rock, tmp_path, capsys):
    block, pulse = {"R": 2.0, "tan_alpha": 0.2}, {"shape": "half_sine", "a_p": 3, "T_p": 1}
    one = {"case": {"block": block, "motion": {"pulse": pulse, "duration": 1.2}, "solver": {"accuracy": "draft"}}}
    drawn = rockcli.run(one | {"audit": True})
    assert '"the case again, draft -> standard: 0 other outcomes, 0 peaks' in drawn.attrs["audit"]
    words = " ".join(text.get_text() for text in rockcli.plot(drawn, "histories").texts)
    assert ", 1 impact" in words
    assert "1 impacts" not in words
    (tmp_path / "a.csv").write_text("1,2\n")
    (tmp_path / "a.yaml").write_text("name: a\ncase: {block: {outline: a.csv}}\n")
    with pytest.raises(rockcli.StudyError, match="has 1 point; a polygon has at least 3"):
        rockcli.check(tmp_path / "a.yaml")
    falls = {"block": block, "motion": {"pulse": pulse, "vertical": {"pulse": pulse | {"a_p": -12}}}}
    told = rockcli.run({"case": falls}).attrs["warnings"]
    assert "falls away faster than g (g + a_v < 0), first at t = " in told
    assert rock("records", "info", "synthetic_rock_m65.AT2", "--rotd") == 2
    assert "--rotd needs pairs of components, not 1 file" in capsys.readouterr().err
