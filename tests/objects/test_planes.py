"""Both planes of a rectangle as an axis: each is the study written by hand."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray

import rockcli
from rockcli.errors import StudyError
from rockcli.study.open import open_study

SIDES = {"width": 0.9, "depth": 0.45}
CABINET = {"height": 1.9, **SIDES, "mass": 80.0}
MOTION = {"pulse": {"shape": "ricker", "a_p": "1.6*g*tan_alpha", "T_p": 0.8}}


def run(block, motion=MOTION, vary=None):
    study = {"name": "a", "case": {"block": block, "motion": motion}, "save": {"histories": True}}
    return rockcli.run(study | ({"vary": vary} if vary else {}))


def same(one: xarray.Dataset, other: xarray.Dataset) -> None:
    assert set(one.data_vars) == set(other.data_vars)
    for name in set(one.data_vars) - {"wall_time", "time"}:
        known = one[name].values, other[name].values
        if known[0].shape != known[1].shape:  # histories of an axis are as long as the longest
            longer, shorter = sorted(known, key=np.size, reverse=True)
            assert np.isnan(longer[len(shorter) :]).all()
            known = longer[: len(shorter)], shorter
        np.testing.assert_array_equal(*known, err_msg=name)


@pytest.mark.parametrize("extra", [{}, {"mu": 0.8}, {"top": 1.0}])
def test_each_plane_is_the_study_written_by_hand(extra):
    both = run(CABINET | extra, vary={"block.plane": ["width", "depth"]})
    assert list(both["plane"].values) == ["width", "depth"]
    for side, size in SIDES.items():
        by_hand = run({"height": 1.9, "width": size, "mass": 80.0, **extra})
        same(both.sel(plane=side, drop=True), by_hand)
        np.testing.assert_allclose(both.alpha.sel(plane=side), np.arctan(size / 1.9), rtol=1e-15)
    assert 0.0 < both.theta_peak_over_alpha.sel(plane="width") < 1.0


def test_a_table_of_cabinets_in_both_planes(tmp_path: Path):
    rows = [("a", 1.9, 0.9, 0.45), ("b", 2.2, 0.5, 0.6), ("c", 1.2, 0.4, 0.4)]
    with (tmp_path / "cabinets.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([("name", "block.height", "block.width", "block.depth"), *rows])
    (tmp_path / "a.yaml").write_text(
        "name: a\ncase: {block: {height: 1, width: 1, depth: 1, plane: width}, initial: {theta: 0.1*alpha}}\n"
        "vary: {case: cabinets.csv, block.plane: [width, depth]}\n",
        encoding="utf-8",
    )
    found = rockcli.run(tmp_path / "a.yaml")
    expected = [[np.arctan(width / height), np.arctan(depth / height)] for _, height, width, depth in rows]
    np.testing.assert_allclose(found.alpha.transpose("case", "plane"), expected, rtol=1e-15)


def test_a_depth_may_vary_in_the_plane_it_is_seen_in():
    found = run(CABINET, vary={"block.depth": [0.4, 0.5, 0.6], "block.plane": ["width", "depth"]})
    expected = [[np.arctan(0.9 / 1.9), np.arctan(depth / 1.9)] for depth in (0.4, 0.5, 0.6)]
    np.testing.assert_allclose(found.alpha.broadcast_like(found.outcome), expected, rtol=1e-15)


def test_new_sizes_and_outlines_take_the_place_of_a_plane():
    square = [[0, 0], [1, 0], [1, 2], [0, 2]]
    settings = {
        "as it is": {"block.mass": 80},
        "sizes": {"block": {"height": 2, "width": 0.7}},
        "three": {"block": {"height": 2, "width": 0.7, "depth": 0.3}},
        "outline": {"block": {"outline": square}},
    }
    found = run({"height": 1.9, **SIDES, "plane": "depth"}, {}, {"case": settings})
    np.testing.assert_allclose(np.tan(found.alpha), [0.45 / 1.9, 0.35, 0.15, 0.5], rtol=1e-14)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"height": 2, "width": 1, "depth": 1}, "block.depth: belongs to an outline, or to a rectangle with a plane"),
        ({"height": 2, "width": 1, "plane": "depth"}, "height (or h), width and depth are needed"),
        ({"R": 2, "width": 1, "depth": 1, "plane": "depth"}, "height (or h), width and depth are needed"),
        ({"h": 2, "b": 1, "depth": 1, "plane": "width"}, "height (or h), width and depth are needed"),
        ({**CABINET, "plane": "depth", "r_g": 0.5}, "block.r_g: is not the same in both planes"),
        ({**CABINET, "plane": "width", "depth": 0}, "block.depth"),
        ({**CABINET, "plane": "side"}, "block.plane"),
        ({"outline": [[0, 0], [1, 0], [1, 2]], "plane": "width"}, "block.plane: follows from the outline"),
    ],
)
def test_what_is_no_plane_of_a_rectangle(block, words):
    with pytest.raises(StudyError) as told:
        open_study({"name": "a", "case": {"block": block}})
    assert words in str(told.value)
