"""The lower convex outline: vertices, facets, barriers and rests against plain geometry."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from rockcli.errors import StudyError
from rockcli.scene.body.lower_outline import facets_of, lower_hull, settling_turn
from rockcli.study.open import open_study


def body(block):
    study = {"name": "a", "case": {"block": block, "initial": {"theta": 0.01}}}
    ((_, batch),) = open_study(study).batches()
    return batch.block


def ngon(k, R=1.0, turn=0.0):
    """A regular polygon on a side, counterclockwise."""
    angle = 2 * np.pi * (np.arange(k) + 0.5) / k - np.pi / 2 + turn
    return np.column_stack([R * np.cos(angle), R * np.sin(angle)])


def height(points, theta):
    """Of the origin above the lowest of the points, turned clockwise by theta (k,)."""
    theta = np.atleast_1d(theta)[:, None]
    return -(points[:, 1] * np.cos(theta) - points[:, 0] * np.sin(theta)).min(axis=1)


@pytest.mark.parametrize("seed", range(20))
def test_the_hull_is_the_lower_part_of_the_convex_hull(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(40, 2)) * [1.0, rng.uniform(0.3, 3.0)]
    ours = lower_hull(points)
    hull = ConvexHull(points)
    lower = {tuple(points[i]) for simplex in hull.simplices[hull.equations[:, 1] < -1e-9] for i in simplex}
    assert {tuple(p) for p in ours} == lower
    assert (np.diff(ours[:, 0]) > 0.0).all()


def test_points_on_a_side_and_steep_sides_are_no_vertices():
    points = np.array([[0, 0], [0.5, 1e-12], [1, 0], [1 + 1e-12, 2], [-1e-12, 2], [0.3, 1]])
    np.testing.assert_array_equal(lower_hull(points), [[0, 0], [1, 0]])


@pytest.mark.parametrize("seed", range(12))
def test_facets_are_where_the_centre_is_lowest_and_highest(seed):
    rng = np.random.default_rng(100 + seed)
    points = rng.normal(size=(30, 2))
    points -= points.mean(axis=0)
    vertices = lower_hull(points)
    facets = facets_of(vertices[None])
    theta = np.linspace(-np.pi / 2, np.pi / 2, 400001)
    h = height(vertices, theta)
    np.testing.assert_allclose(height(vertices, facets.tilt[0]), facets.height[0], rtol=1e-13)
    lows = theta[1:-1][(h[1:-1] < h[:-2]) & (h[1:-1] < h[2:])]
    np.testing.assert_allclose(facets.tilt[0][facets.stable[0]], lows, atol=2e-5)
    highs = theta[1:-1][(h[1:-1] > h[:-2]) & (h[1:-1] >= h[2:])]
    stand = facets.tilt[0, facets.standing[0]]
    right, left = highs[highs > stand], highs[highs < stand]
    ends, tops = [], []
    for tip, quarter, at_quarter in ((left[::-1], -np.pi / 2, h[0]), (right, np.pi / 2, h[-1])):
        wall = not len(tip) or at_quarter > height(vertices, tip)[-1]
        ends.append(quarter if wall else tip[-1])
        tops.append(max([*(height(vertices, tip) if len(tip) else []), *([at_quarter] if wall else [])]))
    np.testing.assert_allclose(facets.fall[0], ends, atol=2e-5)
    np.testing.assert_allclose(facets.barrier[0] + facets.height[0, facets.standing[0]], tops, rtol=1e-9)


def test_a_regular_polygon():
    facets = facets_of(lower_hull(ngon(12, 0.8))[None])
    np.testing.assert_allclose(np.rad2deg(facets.tilt[0]), [-60, -30, 0, 30, 60], atol=1e-10)
    np.testing.assert_allclose(facets.height[0], 0.8 * np.cos(np.pi / 12), rtol=1e-14)
    np.testing.assert_allclose(np.rad2deg(facets.alpha[0]), 15.0, rtol=1e-12)
    np.testing.assert_allclose(np.rad2deg(facets.extent[0]), 30.0, rtol=1e-12)
    np.testing.assert_allclose(np.rad2deg(facets.fall[0]), [-75, 75], rtol=1e-12)
    np.testing.assert_allclose(facets.barrier[0], 0.8 * (1 - np.cos(np.pi / 12)), rtol=1e-12)
    assert facets.standing[0] == 2


def test_bodies_of_two_vertices_have_no_others():
    for outline in ([[0, 0], [1, 0], [1, 2], [0, 2]], [[0, 0], [1, 0], [0.8, 2], [0.1, 2]]):
        assert body({"outline": outline}).vertices is None


def test_an_outline_that_is_wider_above_its_base_rolls():
    block = body({"outline": [[-0.4, 0], [0.4, 0], [0.6, 1], [-0.6, 1]]})
    assert block.rolls.all()
    np.testing.assert_allclose(
        block.vertices[0] + [0, block.h[0]], [[-0.6, 1], [-0.4, 0], [0.4, 0], [0.6, 1]], atol=1e-15
    )
    assert body({"outline": [[-0.4, 0], [0.4, 0], [0.6, 1], [-0.6, 1]], "stands": "toes"}).vertices is None


@pytest.mark.parametrize("turn", [-0.2, 0.1, 0.3])
def test_a_body_let_go_settles_on_the_facet_below_it(turn):
    points = np.array([[-0.5, 0], [0.4, 0], [0.7, 0.5], [0.5, 2.0], [-0.4, 1.9]])
    flat = body({"outline": points.tolist()})
    c, s = np.cos(turn), np.sin(turn)
    tilted = points @ np.array([[c, -s], [s, c]])
    ours = body({"outline": tilted.tolist(), "stands": "settled"})
    for name in ("h", "b", "alpha", "inertia", "top"):
        np.testing.assert_allclose(getattr(ours, name), getattr(flat, name), rtol=1e-12)
    np.testing.assert_allclose(ours.vertices, flat.vertices, atol=1e-14)


def test_a_needle_settles_nowhere():
    assert np.isnan(settling_turn(np.array([[-1.0, -1.0], [0.2, -1.0], [2.0, 3.0]]), np.array([2.5, 3.5])))


def test_a_given_centre_and_radius_of_gyration():
    outline = [[-0.5, 0], [0.4, 0], [0.7, 0.5], [0.5, 2.0], [-0.4, 1.9]]
    block = body({"outline": outline, "centre": [0.05, 0.6], "r_g": 0.55})
    np.testing.assert_allclose([block.h[0], *block.b[0]], [0.6, 0.55, 0.35], rtol=1e-14)
    np.testing.assert_allclose(block.r_g2, 0.55**2, rtol=1e-14)
    np.testing.assert_allclose(block.vertices[0], np.array([[-0.5, 0], [0.4, 0], [0.7, 0.5]]) - [0.05, 0.6], atol=1e-15)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (
            {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "centre": [0.5, 0.5]},
            r"case\.block\.centre: .* give r_g beside",
        ),
        ({"R": 1, "tan_alpha": 0.2, "stands": "toes"}, r"case\.block\.stands: belongs to an outline"),
        ({"R": 1, "tan_alpha": 0.2, "centre": [0, 1]}, r"case\.block\.centre: belongs to an outline"),
        ({"height": 180, "width": 40, "pixel": 0.01}, r"case\.block\.pixel: belongs to an outline"),
        ({"R": 1, "tan_alpha": 0.2, "z_down": True}, r"case\.block\.z_down: belongs to an outline"),
        ({"R": 1, "tan_alpha": 0.2, "contacts": [[0, 0], [1, 0]]}, r"case\.block\.contacts: belongs to an outline"),
        (
            {"outline": [[0, 0], [1, 0], [1, 1], [0, 1]], "stands": "settled", "contacts": [[0, 0], [1, 0]]},
            "both say on what it stands",
        ),
    ],
)
def test_what_contradicts_is_refused(block, words):
    with pytest.raises(StudyError, match=words):
        body(block)
