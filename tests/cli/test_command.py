"""The command from the outside: exit codes, streams, files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml

from rockcli.cli.progress import duration
from rockcli.storage.read import open_dataset
from rockcli.study.open import open_study

STUDY = """\
name: {name}
title: A Ricker pulse
case:
  block: {{R: 5.0, tan_alpha: 0.2}}
  motion: {{pulse: {{shape: ricker, a_p: 3.6*g*tan_alpha, omega_p: 2*pi}}}}
save: {{histories: true, dt_out: 0.02}}
{more}
"""

MET = "expect: [{quantity: theta_peak_over_alpha, value: 0.553693, rtol: 1.0e-5}]"
UNMET = "expect: [{quantity: theta_peak_over_alpha, max: 0.1}]"

Rock = Callable[..., int]


def study(folder: Path, name: str = "ricker", more: str = "") -> Path:
    path = folder / f"{name}.yaml"
    path.write_text(STUDY.format(name=name, more=more))
    return path


def test_a_run_leaves_dataset_and_plots(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path, more=MET)
    assert rock("run", file) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "1 rocking" in told.out
    assert "0.553693" in told.out
    assert "1 of 1 met" in told.out
    folder = tmp_path / "results" / "ricker"
    assert sorted(path.name for path in folder.iterdir()) == ["histories.png", "phase.png", "ricker.nc"]
    found = open_dataset(folder / "ricker.nc")
    assert float(found["theta_peak_over_alpha"]) == pytest.approx(0.553693, rel=1e-5)
    assert found["theta"].dims == ("time",)
    assert rock("run", file, "--no-plots") == 0
    assert "up to date" in capsys.readouterr().out


@pytest.mark.parametrize("none", ["none", "[]"])
def test_no_plots_where_the_study_asks_for_none(rock: Rock, tmp_path: Path, none: str) -> None:
    assert rock("run", study(tmp_path, more=f"plots: {none}")) == 0
    folder = tmp_path / "results" / "ricker"
    assert [path.name for path in folder.iterdir()] == ["ricker.nc"]
    again = open_study(yaml.safe_load(open_dataset(folder / "ricker.nc").attrs["study"]))
    assert again.plots == ()
    assert rock("plot", folder / "ricker.nc") == 0  # whoever asks for plots has them
    assert (folder / "histories.png").is_file()


def test_the_time_of_solving_is_not_that_of_drawing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from rockcli.engine import draw, run

    drawing = 5.0
    clock = iter(range(1000))
    monkeypatch.setattr(run, "perf_counter", lambda: float(next(clock)))

    def slow(*_: object) -> tuple[tuple[Path, ...], tuple[str, ...]]:
        for _ in range(int(drawing)):
            next(clock)
        return (), ()

    monkeypatch.setattr(draw, "draw", slow)
    report = run.run_study(open_study(study(tmp_path)), tmp_path)
    assert report.seconds < drawing


def test_exit_codes(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", study(tmp_path, "good", MET), "--no-plots") == 0
    assert rock("run", study(tmp_path, "unmet", UNMET), "--no-plots") == 1
    assert "1 of 1 points" not in capsys.readouterr().out
    assert rock("run", study(tmp_path, "wrong", "nonsense: 1"), "--no-plots") == 2
    assert "nonsense" in capsys.readouterr().err
    assert rock("run", tmp_path / "absent.yaml") == 2
    assert rock("run", "--no-such-option") == 2
    assert rock("show", "nothing") == 2


def test_the_format_of_figures_is_checked_before_anything_is_solved(rock: Rock, tmp_path: Path, capsys):
    file = study(tmp_path)
    for command in ("run", "trade"):
        assert rock(command, file, "--out", tmp_path / command, "--format", "bmp") == 2
        assert "--format bmp: expected png, pdf, svg" in capsys.readouterr().err
        assert not (tmp_path / command).exists()


def test_all_studies_are_checked_before_any_is_solved(rock: Rock, tmp_path: Path) -> None:
    study(tmp_path, "a-good", MET)
    study(tmp_path, "b-wrong", "expect: [{quantity: n_steppes, max: 1}]")
    assert rock("run", tmp_path, "--no-plots") == 2
    assert not (tmp_path / "results").exists()


def test_two_studies_of_one_name_are_refused(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = study(tmp_path, "same")
    second = tmp_path / "other.yaml"
    second.write_text(first.read_text())
    assert rock("run", first, second, "--no-plots") == 2
    assert "has the name of" in capsys.readouterr().err


def test_other_results_are_refused_unless_fresh(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path)
    assert rock("run", file, "--no-plots") == 0
    changed = ("run", file, "--no-plots", "--set", "case.block.R=2")
    assert rock(*changed) == 2
    assert "--fresh" in capsys.readouterr().err
    assert rock(*changed, "--fresh") == 0
    assert float(open_dataset(tmp_path / "results" / "ricker" / "ricker.nc")["R"]) == 2.0
    assert rock("run", file, "--set", "case.block.R") == 2


def test_a_broken_solver_is_exit_code_3(rock: Rock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(batch: object) -> None:
        raise FloatingPointError("overflow")

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", breaks)
    assert rock("run", study(tmp_path, "lost", UNMET), "--no-plots") == 3
    found = open_dataset(tmp_path / "results" / "lost" / "lost.nc")
    assert int(found["outcome"]) == -2
    assert "overflow" in str(found["reasons"].values[int(found["reason"])])


def test_a_bug_is_exit_code_4(
    rock: Rock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def breaks(*_: object, **__: object) -> None:
        raise RuntimeError("unforeseen")

    monkeypatch.setattr("rockcli.engine.run.run_study", breaks)
    assert rock("run", study(tmp_path)) == 4
    told = capsys.readouterr().err
    assert "this is a bug" in told
    assert "Traceback" not in told
    monkeypatch.setenv("ROCK_DEBUG", "1")
    assert rock("run", study(tmp_path)) == 4
    assert "Traceback" in capsys.readouterr().err


def test_a_library_that_the_system_does_not_load_is_no_bug(
    rock: Rock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    said = "libx.so: failed to map segment from shared object"

    def refused(*_: object, **__: object) -> None:
        raise ImportError(said)

    monkeypatch.setattr("rockcli.engine.run.run_study", refused)
    assert rock("run", study(tmp_path)) == 4
    assert capsys.readouterr().err.strip() == f"rock: a library cannot be loaded: {said}"


def test_an_interrupt_is_exit_code_130(rock: Rock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(batch: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", interrupted)
    assert rock("run", study(tmp_path), "--no-plots") == 130
    assert list((tmp_path / "results" / "ricker").iterdir()) == []


def test_a_missing_record_is_skipped_on_demand(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(tmp_path, "here", MET)
    (tmp_path / "away.yaml").write_text(
        "name: away\ncase:\n  block: {R: 5.0, tan_alpha: 0.2}\n  motion: {record: {file: NOWHERE.AT2}}\n"
    )
    assert rock("run", tmp_path, "--no-plots") == 2
    assert "NOWHERE.AT2" in capsys.readouterr().err
    assert rock("run", tmp_path, "--no-plots", "--skip-missing", "--junit", "out/verdicts.xml") == 0
    told = capsys.readouterr()
    assert "skipped away" in told.err
    assert "1 skipped" in told.out
    root = ET.parse(tmp_path / "out" / "verdicts.xml").getroot()
    suites = {suite.get("name"): suite for suite in root}
    for count in ("tests", "failures", "errors", "skipped"):
        assert int(root.get(count, -1)) == sum(int(suite.get(count, -1)) for suite in suites.values()) >= 0
    assert root.get("skipped") == "1"
    assert suites["away"].get("skipped") == "1"
    assert suites["here"].get("failures") == "0"
    assert rock("run", tmp_path / "away.yaml", "--skip-missing") == 0
    assert "0 studies, 0 cases, 1 skipped" in capsys.readouterr().out


def test_json_and_junit_tell_the_same(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path, "unmet", UNMET)
    assert rock("run", file, "--no-plots", "--json", "--junit", "v.xml") == 1
    told = json.loads(capsys.readouterr().out)
    assert told["exit_code"] == 1
    (only,) = told["studies"]
    assert (only["name"], only["cases"], only["outcomes"]) == ("unmet", 1, {"rocking": 1})
    assert only["expect"][0]["passed"] is False
    suite = ET.parse(tmp_path / "v.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("failures")) == ("2", "1")
    assert "0.5536" in suite[1][0].get("message", "")


def test_a_share_judges_nothing(rock: Rock, tmp_path: Path) -> None:
    file = study(tmp_path, "unmet", f"{UNMET}\nvary: {{block.R: [2.0, 5.0]}}")
    assert rock("run", file, "--part", "1/2", "--junit", "v.xml") == 0
    suite = ET.parse(tmp_path / "v.xml").getroot()[0]
    assert [suite.get(count) for count in ("tests", "failures", "skipped")] == ["1", "0", "1"]
    assert "share 1/2" in suite[0][0].get("message", "")


def test_quiet_is_quiet(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("run", study(tmp_path), "--quiet", "--no-plots") == 0
    assert capsys.readouterr() == ("", "")


def test_check_solves_nothing(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path, more="vary: {block.R: [2.0, 5.0]}")
    assert rock("check", file) == 0
    told = capsys.readouterr().out
    assert "2 = 2 block_R" in told
    assert "PGA over g tan alpha 3.6" in " ".join(told.split())
    assert not (tmp_path / "results").exists()


def test_plot_needs_the_file_only(rock: Rock, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = study(tmp_path)
    assert rock("run", file, "--no-plots") == 0
    file.unlink()
    dataset = tmp_path / "results" / "ricker" / "ricker.nc"
    moved = dataset.rename(tmp_path / "old.nc")
    capsys.readouterr()
    assert rock("plot", moved, "--kind", "phase", "--format", "svg") == 0
    assert capsys.readouterr().out.strip().endswith("phase.svg")
    assert (tmp_path / "phase.svg").read_bytes().startswith(b"<?xml")
    assert rock("plot", moved, "--kind", "map") == 2
    assert "no numeric axis" in capsys.readouterr().err
    assert rock("plot", tmp_path / "absent.nc") == 2


@pytest.mark.parametrize("topic", ["models", "backends", "variables", "pulses", "plots", "schema"])
def test_show(rock: Rock, topic: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("show", topic) == 0
    told = capsys.readouterr().out
    word = {"models": "linearized", "backends": "event", "variables": "N_min_over_mg", "pulses": "ricker"}
    assert word.get(topic, "map" if topic == "plots" else "properties") in told


def test_verify_agrees(rock: Rock, capsys: pytest.CaptureFixture[str]) -> None:
    assert rock("verify", "--json") == 0
    rows = json.loads(capsys.readouterr().out)
    assert len(rows) >= 10
    assert all(row["passed"] and row["tolerance"] <= 1e-6 for row in rows)


def test_verify_fails_for_a_spoilt_program(
    rock: Rock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rockcli.engine.verify.P", 1.0001 * 1.2130543681465)
    assert rock("verify") == 1
    assert "FAIL" in capsys.readouterr().out


def test_help_and_a_pulse_import_only_what_they_need(tmp_path: Path) -> None:
    """Heavy libraries would make every start slow."""
    script = (
        "import sys\nfrom rockcli.cli.main import main\ntry:\n    main()\nexcept SystemExit:\n    pass\n"
        "heavy = {'numpy', 'xarray', 'matplotlib', 'obspy', 'scipy', 'numba', 'rich', 'pydantic', 'netCDF4', 'asyncio'}\n"
        "print('LOADED', *sorted(heavy & set(sys.modules)))\n"
    )

    def loaded(*args: object) -> set[str]:
        done = subprocess.run(
            [sys.executable, "-c", script, *map(str, args)],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
            env=os.environ,
        )
        return set(done.stdout.splitlines()[-1].split()[1:])

    assert loaded("--help") == set()
    assert loaded("run", study(tmp_path), "--no-plots") <= {"numpy", "pydantic", "netCDF4"}


def test_durations_in_words() -> None:
    assert [duration(s) for s in (0.412, 12.3, 200.0, 7500.0)] == ["0.41 s", "12 s", "3 min 20 s", "2 h 5 min"]


def test_two_runs_differ_in_dates_and_wall_time_only(rock: Rock, tmp_path: Path) -> None:
    file = study(tmp_path, more="vary: {block.R: [2.0, 5.0], model: [rigid, linearized]}\ncompare_to: {model: rigid}")
    for out in ("one", "two"):
        assert rock("run", file, "--no-plots", "--out", out) == 0
    first, second = (open_dataset(tmp_path / out / "ricker" / "ricker.nc") for out in ("one", "two"))
    for dataset in (first, second):
        for name in ("history", "date_created"):
            assert dataset.attrs.pop(name)
    assert first.drop_vars("wall_time").identical(second.drop_vars("wall_time"))
    assert set(first["R"].dims) == {"block_R"}
    assert first["alpha"].dims == ()
    assert first["pgv"].dims == ()


def test_python_gets_what_the_file_holds(rock: Rock, tmp_path: Path) -> None:
    import rockcli

    file = study(tmp_path)
    assert rock("run", file, "--no-plots") == 0
    written, returned = open_dataset(tmp_path / "results" / "ricker" / "ricker.nc"), rockcli.run(file)
    for dataset in (written, returned):
        for name in ("history", "date_created"):
            del dataset.attrs[name]
    assert returned.drop_vars("wall_time").identical(written.drop_vars("wall_time"))
