"""Animations of a body in motion: its shape, the part shown, the files, and what cannot be animated."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image
from plotting.column_datasets import ALPHA, LENGTH, R, columns
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.engine.animate import animate
from rockcli.errors import StudyError
from rockcli.plotting.common.shape import Body, body_of, friction_marks, motion_of, outline
from rockcli.plotting.kinds.animate import LONGEST, _Stage, scenes

BODY = Body(0.3, 0.5, 4.0)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return written(columns(), tmp_path)


def written(dataset: xarray.Dataset, folder: Path) -> Path:
    path = folder / "columns.nc"
    dataset.to_netcdf(path, engine="netcdf4")
    return path


@pytest.mark.parametrize("theta", [-0.5 * np.pi, -1.0, -0.05, 0.0, 0.05, 1.0, 0.5 * np.pi])
@pytest.mark.parametrize("w_top", [0.0, 0.01, -0.4, 1.5, 30.0])
def test_a_body_never_goes_below_the_ground_and_keeps_its_edge_on_it(theta, w_top):
    points = outline(BODY, theta, w_top)
    assert points[:, 1].min() >= -1e-8 * BODY.height
    edge = BODY.right if theta > 0.0 else -BODY.left
    assert np.hypot(points[:, 0] - edge, points[:, 1]).min() < 1e-9


def test_a_rigid_body_keeps_its_size_and_its_top_is_where_the_solver_says():
    points = outline(BODY, 0.3)
    sides = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    np.testing.assert_allclose(sorted(sides), [0.8, 0.8, 4.0, 4.0], rtol=1e-12)
    corner = points[np.argmin(np.abs(points[:, 0] - points[:, 0].max()))]
    np.testing.assert_allclose(corner, [0.5 + 4.0 * np.sin(0.3), 4.0 * np.cos(0.3)], rtol=1e-12)


def test_the_top_of_a_column_moves_by_its_bending():
    """The middle of the top lies where rotation and u_top_bending put it."""
    body, w_top = Body(0.4, 0.4, 4.0), 0.02
    points = outline(body, 0.05, w_top)
    top = 0.5 * (points[len(points) // 2 - 1] + points[len(points) // 2])
    rigid = outline(body, 0.05)
    moved = top - 0.5 * (rigid[1] + rigid[2])
    np.testing.assert_allclose(moved, [w_top * np.cos(0.05), -w_top * np.sin(0.05)], atol=1e-12)


def test_size_and_bending_come_from_the_dataset():
    body = body_of(columns(), (1,))
    assert body == Body(R * np.sin(ALPHA), R * np.sin(ALPHA), LENGTH)
    motion = motion_of(columns(), (1,))
    np.testing.assert_allclose(motion.w_top[50] * np.cos(motion.theta[50]), 0.05)
    assert motion.bends
    assert not motion_of(columns(), (0,)).bends
    assert motion_of(columns(), (2,)).theta[-1] == -0.5 * np.pi


def test_a_sliding_body_leaves_the_track_of_its_edges():
    """A block that slides flat scratches two tracks as long as its slide goes; what friction holds scratches none."""
    case = {
        "block": {"height": 2.0, "width": 0.8, "mu": 0.2},
        "motion": {"pulse": {"shape": "sine", "a_p": 6.0, "T_p": 0.6}},
    }
    vary = {"block.mu": [0.2, 0.41, 1.0]}
    dataset = rockcli.run({"name": "tracks", "case": case, "vary": vary, "save": {"histories": True}})
    flat, held = (motion_of(dataset, (i,)) for i in (0, 2))
    track, when = friction_marks(BODY, flat)
    reach = [flat.slide.min(), flat.slide.max()]
    assert np.ptp(reach) > 0.05
    near_left = track[:, 0] < 0.5 * (BODY.right - BODY.left) + np.mean(reach)
    for edge, made in ((-BODY.left, track[near_left]), (BODY.right, track[~near_left])):
        np.testing.assert_allclose([made.min() - edge, made.max() - edge], reach, atol=1e-6)  # begins within a sample
    moving = flat.time[1:][np.diff(flat.slide) != 0.0]
    np.testing.assert_allclose([when.min(), when.max()], [moving.min(), moving.max()], atol=0.006)
    assert len(friction_marks(BODY, held)[0]) == 0
    # where it slides tilted, only the edge it stands on scratches
    both = motion_of(dataset, (1,))
    track, when = friction_marks(BODY, both)
    tilted = np.isin(when, both.time[1:][both.mode[:-1] == 3])
    assert tilted.any()
    side = np.sign(both.theta[np.searchsorted(both.time, when[tilted]) - 1])
    assert ((track[tilted].mean(axis=1) > 0.1) == (side > 0.0)).all()


def test_a_gif_has_its_pictures_and_its_speed(file: Path, tmp_path: Path):
    out = tmp_path / "film.gif"
    animation = animate(file, out, at={"model": "flexible"}, start=0.0, end=1.0, fps=10, magnify=30)
    with Image.open(out) as image:
        assert image.n_frames == animation.pictures == 11
        assert image.info["duration"] == 100
        assert image.info["loop"] == 0
        first = np.asarray(image.convert("RGB")).astype(int)
        assert (first[2, 2] == 255).all()
        image.seek(5)
        other = np.asarray(image.convert("RGB")).astype(int)
    assert (np.abs(first - other).max(axis=2) > 60).sum() > 300
    assert out.stat().st_size < 1_000_000
    assert list(tmp_path.glob(".*")) == []


def test_the_ground_is_shown_whole_where_a_body_overturns():
    """Rotations beyond the fall are cut off, the acceleration that made it is not."""
    pulse = {"shape": "sine", "a_p": 5 * 9.81, "T_p": 0.5}
    case = {"block": {"R": 1.0, "tan_alpha": 0.6}, "motion": {"pulse": pulse}}
    dataset = rockcli.run({"name": "fall", "case": case, "save": {"histories": True}})
    stage = _Stage(dataset, (), scenes(dataset, (), step=0.04), "")
    _, ground, rotation = stage.figure.axes
    assert ground.get_ylim() == pytest.approx((-6.0, 6.0), rel=1e-3)
    assert rotation.get_ylim()[0] > -1.5


def test_speed_stretches_the_animation(file: Path, tmp_path: Path):
    animation = animate(file, tmp_path / "film.gif", case=2, start=0.5, end=1.0, fps=5, speed=0.25)
    assert animation.pictures == 11


def test_the_response_is_shown_and_no_more_than_is_watched():
    long = columns(ends=60.0)
    shown = scenes(long, (0,), step=0.1)
    assert shown.times[0] == 0.0
    assert shown.times[-1] <= 30.0
    slow = scenes(long, (0,), step=0.1, speed=0.5)
    assert slow.times[-1] - slow.times[0] == pytest.approx(0.5 * LONGEST)
    assert "--start" in slow.note
    fall = scenes(long, (2,), step=0.02, speed=0.1)
    known = np.isfinite(long["theta"].values[2])
    assert fall.times[-1] == pytest.approx(long["time"].values[known][-1])
    assert scenes(long, (0,), step=0.1, start=0.0, end=50.0).times[-1] == pytest.approx(50.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--out", "film.avi"], "a .gif or an .mp4"),
        (["--at", "model=concrete"], "rigid, flexible, fallen"),
        (["--select", "model=concrete"], "rigid, flexible, fallen"),
        (["--at", "colour=red"], "the axes are model"),
        (["--at", "model"], "AXIS=VALUE"),
        (["--case", "4"], "1 to 3"),
        (["--case", "1", "--at", "model=rigid"], "one of them"),
        (["--speed", "0"], "--speed"),
        (["--fps", "100"], "up to 50"),
        (["--magnify", "nan"], "--magnify"),
        (["--case", "1", "--magnify", "5"], "does not bend"),
        (["--start", "3", "--end", "2"], "cannot show 3 s to 2 s"),
        (["--start", "0", "--end", "90"], "goes from 0 to"),
        (["--start", "0", "--end", "3.9", "--speed", "1e-3"], "frames"),
    ],
    ids=lambda x: " ".join(x) if isinstance(x, list) else "",
)
def test_what_cannot_be_animated(options, words, file: Path, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["animate", str(file), *options])
    assert isinstance(result.exception, StudyError)
    assert result.exception.exit_code == 2
    assert words in str(result.exception)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["columns.nc"]


def test_no_histories_no_animation(tmp_path: Path):
    file = written(columns().drop_dims("time"), tmp_path)
    with pytest.raises(StudyError, match=r"no histories \(save"):
        animate(file)


def test_a_case_without_an_answer_is_no_animation(tmp_path: Path):
    dataset = columns()
    dataset["theta"][0] = np.nan
    with pytest.raises(StudyError, match="no history to show"):
        animate(written(dataset, tmp_path), case=1)


def test_the_command_says_what_it_wrote_and_what_it_left_out(file: Path):
    result = CliRunner().invoke(app, ["animate", str(file), "--end", "0.5", "--fps", "10"])
    assert result.exit_code == 0
    assert str(file.parent / "animation.gif") in result.output
    assert "model (rigid, flexible, fallen)" in result.output


def test_what_chooses_a_case_is_told_as_it_is_taken(tmp_path: Path):
    vary = {"motion.pulse.a_p": ["0.3*g", "0.4*g"]}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "T_p": 0.8}}}
    path = tmp_path / "two.nc"
    rockcli.run({"name": "two", "case": case, "vary": vary}).to_netcdf(path, engine="netcdf4")
    told = CliRunner().invoke(app, ["animate", str(path), "--fps", "2"])
    assert "--at chooses: motion_pulse_a_p (0.3g, 0.4g)" in told.stderr
    # as figures and tables take it: the name of the axis, its path, or the end of that
    for said in ("motion_pulse_a_p", "motion.pulse.a_p", "a_p"):
        film = animate(path, tmp_path / "film.gif", at={said: "0.4g"}, fps=2, end=1.0)
        assert film.case.endswith("= 0.4 g"), said
    with pytest.raises(StudyError, match="--at a_p: motion_pulse_a_p is chosen twice"):
        animate(path, at={"motion.pulse.a_p": "0.3g", "a_p": "0.4g"})
    chosen = CliRunner().invoke(app, ["animate", str(path), "--fps", "2", "--at", "motion_pulse_a_p=0.4g"])
    assert chosen.exit_code == 0
    assert "chooses" not in chosen.stderr


def test_mp4_needs_ffmpeg(file: Path, tmp_path: Path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))
    with pytest.raises(StudyError, match="needs ffmpeg"):
        animate(file, tmp_path / "film.mp4")


@pytest.mark.skipif(os.name != "posix", reason="a shell script stands for ffmpeg")
@pytest.mark.parametrize("works", [True, False])
def test_ffmpeg_is_given_every_picture(works: bool, file: Path, tmp_path: Path, monkeypatch):
    """A program that keeps what it is given, or one that fails."""
    folder = tmp_path / "bin"
    folder.mkdir()
    script = 'eval "out=\\${$#}"\ncat > "$out"\n' if works else "echo no such codec >&2\nexit 1\n"
    (folder / "ffmpeg").write_text(f"#!/bin/sh\n{script}")
    (folder / "ffmpeg").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    out = tmp_path / "film.mp4"
    if works:
        animation = animate(file, out, end=0.5, fps=10)
        assert out.stat().st_size == animation.pictures * 640 * 560 * 3
    else:
        with pytest.raises(StudyError, match="no such codec"):
            animate(file, out, end=0.5, fps=10)
        assert not out.exists()
