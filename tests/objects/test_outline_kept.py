"""The outline of a body in its dataset, and how it is drawn."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import PathPatch
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.plotting import figures
from rockcli.plotting.common.shape import body_of, outline, path_of
from rockcli.storage.read import open_dataset

PLATE = [[3.0, 1.0], [3.9, 1.0], [3.9, 1.1], [3.0, 1.1]]
SHAFT = [[3.3, 1.1], [3.5, 1.1], [3.45, 2.4], [3.35, 2.4]]
HEAD = [[3.25, 2.4], [3.6, 2.4], [3.6, 2.7]]
PARTS = [
    {"outline": PLATE, "density": 7850, "depth": 0.9},
    {"outline": SHAFT, "density": 2700, "depth": 0.2},
    {"outline": HEAD, "density": 2700, "depth": 0.3},
]
FREE = {"initial": {"theta": "-0.6*alpha"}}


def run(block, vary=None, case=FREE):
    study = {"name": "a", "case": {"block": block, **case}}
    return rockcli.run(study | ({"vary": vary} if vary else {}))


def kept(dataset):
    return np.column_stack([dataset.outline_x.values, dataset.outline_z.values])


def triangles(polygon):
    """Area and centroid of a polygon that every point sees from the first one, triangle by triangle."""
    a, rest = np.array(polygon[0]), np.array(polygon)
    corners = list(pairwise(rest[1:]))
    areas = np.array([0.5 * np.linalg.det(np.column_stack([b - a, c - a])) for b, c in corners])
    centres = np.array([(a + b + c) / 3 for b, c in corners])
    return areas.sum(), areas @ centres / areas.sum()


@pytest.fixture(scope="module")
def statue():
    return run({"parts": PARTS, "mu": 2.0})


def test_it_is_kept_about_the_centre_of_mass_and_above_the_base(statue):
    areas, centres = zip(*(triangles(part["outline"]) for part in PARTS), strict=True)
    masses = np.array(areas) * [part["density"] * part["depth"] for part in PARTS]
    centre = masses @ np.array(centres) / masses.sum()
    expected = np.vstack([PLATE, [[np.nan] * 2], SHAFT, [[np.nan] * 2], HEAD]) - [centre[0], 1.0]
    assert statue.outline_x.dims == statue.outline_z.dims == ("outline_point",)
    np.testing.assert_allclose(kept(statue), expected, rtol=0.0, atol=1e-12)
    assert {statue[name].attrs["units"] for name in ("outline_x", "outline_z")} == {"m"}
    corner = np.hypot(expected[0, 0], centre[1] - 1.0)
    np.testing.assert_allclose(statue.R_left, corner, rtol=1e-12)


def test_it_extends_over_the_axes_that_change_the_body_alone():
    square, triangle = [[0, 0], [1, 0], [1, 2], [0, 2]], [[0, 0], [1, 0], [0.5, 2]]
    motion = {"motion": {"pulse": {"shape": "sine", "a_p": 3, "T_p": 1}}}
    found = run(
        {"outline": square, "mu": 0.6},
        {
            "motion.pulse.a_p": [1, 2, 3],
            "block.outline": {"square": square, "triangle": triangle},
            "block.mu": [0.7, 2],
        },
        motion,
    )
    assert found.outline_z.dims == ("outline", "outline_point")
    np.testing.assert_array_equal(found.outline_z, [[0, 0, 2, 2], [0, 0, 2, np.nan]])
    np.testing.assert_allclose(found.outline_x, [[-0.5, 0.5, 0.5, -0.5], [-0.5, 0.5, 0.0, np.nan]], atol=1e-15)


def test_points_may_depend_on_symbols():
    study = {
        "name": "a",
        "let": {"w": 1, "i": 0.1},
        "case": {"block": {"outline": [[0, 0], ["w", 0], ["w", 2], [0, 2]]}, "initial": {"theta": "i"}},
        "vary": {"let.i": [0.01, 0.02], "let.w": [0.5, 1.0, 0.8]},
    }
    found = rockcli.run(study)
    assert found.outline_x.dims == ("w", "outline_point")
    np.testing.assert_allclose(np.ptp(found.outline_x.values, axis=1), [0.5, 1.0, 0.8], rtol=1e-15)


def test_blocks_by_their_sizes_have_none():
    found = run({"h": 1, "b": [0.2, 0.3]}, {"block.h": [1, 2]})
    assert "outline_x" not in found.variables
    assert figures.why_not("body", found) == ""  # a rectangle
    both = run({"h": 1, "b": 0.3}, {"case": {"block": {"block": {"b": 0.3}}, "body": {"block": {"outline": PLATE}}}})
    assert np.isnan(both.outline_x[0]).all()
    assert body_of(both, (0,)).points is None
    assert len(body_of(both, (1,)).points) == 4


@pytest.mark.parametrize("theta", [-1.2, -0.1, 0.0, 0.2, 1.5])
def test_the_body_drawn_turns_about_its_edge_as_a_whole(statue, theta):
    body = body_of(statue, ())
    rest, turned = outline(body, 0.0), outline(body, theta)
    np.testing.assert_allclose(rest, kept(statue), rtol=0.0, atol=1e-15)
    edge = np.array([np.nanmin(rest[:4, 0]) if theta <= 0.0 else np.nanmax(rest[:4, 0]), 0.0])
    arms = (rest - edge) @ np.array([1.0, 1.0j])
    now = (turned - edge) @ np.array([1.0, 1.0j])
    np.testing.assert_allclose(now, arms * np.exp(-1j * theta), rtol=0.0, atol=1e-14)
    assert [len(polygon) for polygon in path_of(turned).to_polygons()] == [5, 5, 4]


def test_a_body_is_drawn_with_its_centre_edges_and_angles(statue):
    assert figures.default_kinds(statue)[0] == "body"
    (axes,) = figures.figure("body", statue).axes
    (patch,) = [patch for patch in axes.patches if isinstance(patch, PathPatch)]
    assert len(patch.get_path().to_polygons(closed_only=False)) == 3
    drawn = [line.get_xydata() for line in axes.lines]
    b, h = float(statue.R_left * np.sin(statue.alpha_left)), float(statue.R_left * np.cos(statue.alpha_left))
    assert any(len(points) == 1 and np.allclose(points, [[0.0, h]]) for points in drawn)
    assert any(np.allclose(points, [[-b, 0.0], [0.0, h]]) for points in drawn if len(points) == 2)
    words = " ".join(text.get_text() for text in axes.texts)
    for side in ("left", "right"):
        assert f"{np.degrees(float(statue[f'alpha_{side}'])):.3g}\N{DEGREE SIGN}" in words


def test_a_panel_per_body_not_per_case():
    found = run({"outline": PLATE}, {"initial.theta": [0.1, 0.2], "block.top": [1, 2], "let.x": [1]} | SIZES, SHEARED)
    drawn = figures.figure("body", found)
    assert [axes.get_title() for axes in drawn.axes if axes.axison] == ["a", "b", "c"]


SIZES = {"block.outline": {name: [[0, 0], [w, 0], [w, 3], [0, 3]] for name, w in (("a", 1), ("b", 0.8), ("c", 0.5))}}
SHEARED = {"initial": {"theta": 0.1}}


def test_files_reports_and_old_datasets(tmp_path: Path):
    study = {"name": "a", "case": {"block": {"outline": SHAFT}, **FREE}, "save": {"histories": True}, "plots": []}
    file = tmp_path / "a.yaml"
    file.write_text(json.dumps(study), encoding="utf-8")
    runner = CliRunner()
    for _ in range(2):  # a finished study keeps it
        done = runner.invoke(app, ["run", str(file), "--out", str(tmp_path)])
        assert done.exit_code == 0, done.output
        path = tmp_path / "a" / "a.nc"
        assert len(open_dataset(path).outline_x) == 4
    assert runner.invoke(app, ["report", str(path)]).exit_code == 0
    assert "<h2>The body</h2>" in path.with_suffix(".html").read_text(encoding="utf-8")
    old = open_dataset(path).drop_vars(["outline_x", "outline_z"])
    assert "body" not in figures.default_kinds(old)
    np.testing.assert_allclose(np.ptp(outline(body_of(old, ()), 0.0)[:, 0]), 0.2, rtol=1e-12)


def test_on_a_tilted_support_it_turns_about_contacts_at_their_own_heights():
    stone = [[0, 0], [1, 0.1], [1.1, 1.5], [-0.1, 1.4]]
    found = run({"outline": stone, "contacts": [[0.1, 0.01], [0.9, 0.09]]})
    body, rest = body_of(found, ()), outline(body_of(found, ()), 0.0)
    np.testing.assert_allclose(np.diff(rest, axis=0), np.diff(stone, axis=0), rtol=0.0, atol=1e-12)
    for theta, contact in ((-0.3, (0.1, 0.01)), (0.3, (0.9, 0.09))):
        before, after = (np.hypot(*(points - rest[0] - contact).T) for points in (rest, outline(body, theta)))
        np.testing.assert_allclose(after, before, rtol=1e-12)
    (axes,) = figures.figure("body", found).axes
    ends = [line.get_xydata()[0] - rest[0] for line in axes.lines if len(line.get_xdata()) == 1]
    for contact in ((0.1, 0.01), (0.9, 0.09)):
        assert any(np.allclose(end, contact) for end in ends)


@pytest.mark.parametrize(
    ("block", "high"),
    [
        ({"h": 0.85, "width": 0.5, "top": 1.9}, 1.9),
        ({"h": 1.2, "width": 0.5, "top": 1.9}, 1.9),
        ({"h": 0.85, "width": 0.5}, 1.7),
        ({"h": 0.85, "width": 0.5, "top": 0.6}, 1.7),  # a shelf that is reported
    ],
)
def test_a_rectangle_is_as_high_as_its_top(block, high):
    found = rockcli.run({"name": "x", "case": {"block": block}, "plots": []})
    rest = outline(body_of(found, ()), 0.0)
    np.testing.assert_allclose([rest[:, 1].min(), np.ptp(rest[:, 0]), rest[:, 1].max()], [0.0, 0.5, high], atol=1e-12)
    settings = {"as it is": {}, "higher": {"block.top": 2.9}, "none": {"block.top": None}}
    told = rockcli.run({"name": "x", "case": {"block": block}, "vary": {"case": settings}, "plots": []})
    assert outline(body_of(told, (1,)), 0.0)[:, 1].max() == pytest.approx(2.0 * block["h"])  # not that of another
    varied = rockcli.run({"name": "x", "case": {"block": block}, "vary": {"block.top": [2.5, 3.0]}, "plots": []})
    assert outline(body_of(varied, (1,)), 0.0)[:, 1].max() == pytest.approx(3.0)
