"""`rock new`: every study to begin with is commented, checks without a word and runs."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rockcli.cli.new import KINDS
from rockcli.study.open import open_study


def test_there_is_a_file_for_every_kind_and_no_other():
    folder = Path(__file__).resolve().parents[2] / "rockcli" / "cli" / "templates"
    assert {path.stem for path in folder.iterdir()} == set(KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_a_study_to_begin_with_is_commented_and_runs_as_it_is(rock, tmp_path, capsys, kind):
    assert rock("new", kind) == 0
    assert f"rock run {kind}.yaml" in capsys.readouterr().out
    path = tmp_path / f"{kind}.yaml"
    text = path.read_text(encoding="utf-8")
    assert text.startswith("#")
    assert f"rock run {kind}.yaml" in text
    assert open_study(path).size <= 4000
    assert rock("run", path, "--no-plots", "--workers", 1) == 0
    said = capsys.readouterr()
    assert " failed" not in said.out
    assert (tmp_path / "results" / kind / f"{kind}.nc").is_file()


def test_the_first_kind_is_a_block_and_nothing_is_replaced(rock, tmp_path, capsys):
    assert rock("new") == 0
    before = (tmp_path / "block.yaml").read_bytes()
    assert rock("new", "block") == 2
    assert "is there already" in capsys.readouterr().err
    assert (tmp_path / "block.yaml").read_bytes() == before
    assert rock("new", "--out", "mine.yml") == 0
    assert "rock run mine.yml" in (tmp_path / "mine.yml").read_text(encoding="utf-8")


def test_what_is_no_kind_is_told_with_those_there_are(rock, tmp_path, capsys):
    assert rock("new", "staute") == 2
    assert "statue: a statue" in capsys.readouterr().err
    assert rock("new", "map", "--out", "map.txt") == 2
    assert not list(tmp_path.iterdir())


def test_examples_are_those_of_the_sources_and_run(rock, tmp_path, capsys):
    root = Path(__file__).resolve().parents[2]
    assert rock("new", "examples") == 0
    assert "cd examples, rock run studies/examples/first_rock.yaml" in capsys.readouterr().out
    written = {
        path.relative_to(tmp_path / "examples").as_posix(): path for path in (tmp_path / "examples").rglob("*.*")
    }
    for name, path in written.items():
        assert path.is_dir() or path.read_bytes() == (root / name).read_bytes()
    assert {"studies/examples/record.yaml", "studies/tutorials/statue.yaml", "records/synthetic_rock_m65.AT2"} <= set(
        written
    )
    assert rock("run", tmp_path / "examples" / "studies" / "examples", "--no-plots", "--workers", 1) == 0
    assert rock("check", tmp_path / "examples", "--quiet") == 0  # nothing there but studies ends in .yaml
    assert rock("new", "examples") == 2
    assert "is there already" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot be asked for without ending it")
def test_what_a_killed_one_left_goes(rock, tmp_path):
    killed = "import os, shutil; shutil.copytree = lambda *_, **__: os.kill(os.getpid(), 9)\n"
    killed += "from rockcli.cli.main import app; app(['new', 'examples'])"
    assert subprocess.run([sys.executable, "-c", killed], cwd=tmp_path, check=False).returncode == -9
    (left,) = tmp_path.iterdir()
    stay = [f".rock-new.{os.getppid()}.abc", ".rock-new.mine", ".rock-abcdefgh"]
    for name in stay:
        (tmp_path / name).mkdir()
    assert rock("new", "examples") == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*stay, "examples"])
    assert not left.exists()


def test_a_statue_measured_by_hand_needs_no_records_of_its_own(rock, tmp_path):
    import numpy as np
    import xarray as xr

    assert rock("new", "statue") == 0
    assert rock("run", "statue.yaml", "--no-plots", "--workers", 1) == 0
    with xr.open_dataset(tmp_path / "results" / "statue" / "statue.nc") as found:
        # nothing lifts below g tan(alpha) = 0.25 g, and the pad slips from 0.2 g
        assert np.isclose(np.tan(found.alpha), 0.25, rtol=1e-12).all()
        words = dict(zip(found.outcome.flag_values, found.outcome.flag_meanings.split(), strict=True))
        outcomes = {
            (str(mu), round(float(pga) / 9.81, 6)): {
                words[int(v)] for v in found.outcome.sel(mu=mu, motion_record_pga=pga)
            }
            for mu in found.mu.values
            for pga in found.motion_record_pga.values
        }
    assert outcomes["as it stands", 0.2] == outcomes["on a pad", 0.2] == {"no_uplift"}
    assert outcomes["as it stands", 0.3] == {"rocking"}
    assert "overturned_after_impact" in outcomes["as it stands", 0.4]
    assert outcomes["on a pad", 0.3] == outcomes["on a pad", 0.4] == {"sliding"}


def test_the_wheel_carries_what_examples_need():
    import tomllib

    from rockcli.cli.new import SHIPPED

    root = Path(__file__).resolve().parents[2]
    hatch = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["hatch"]["build"]["targets"]
    included = hatch["wheel"]["force-include"]
    assert {f"rockcli/shipped/{name}" for name in SHIPPED} == {to for to in included.values() if "shipped" in to}
    assert {name for name, to in included.items() if "shipped" in to} == set(SHIPPED)
