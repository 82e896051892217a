"""Boundary curves of refined maps: of made-up outcomes, whose boundaries are known, as data, table and figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rockcli
from rockcli.analysis.boundaries import KINDS, curves_of
from rockcli.plotting import figures
from rockcli.plotting.common.style import save
from rockcli.plotting.kinds.boundaries import smoothed
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, Response

N = 201
UPLIFT, OVERTURNING, AFTER_IMPACT = range(len(KINDS))
STUDY: dict[str, Any] = {
    "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.01}},
    "vary": {
        "block.R": {"from": 1, "to": 2, "n": N},
        "block.mass": [1, 2],
        "initial.theta": {"from": 0.05, "to": 0.15, "n": N},
    },
    "save": {"scalars": ["outcome"]},
    "refine": True,
}


def made_up(batch: Batch) -> Response:
    """No uplift below a line, a disc that overturns, its right half after an impact; a smaller disc for mass 2."""
    y, x = batch.block.R[:, 0] - 1.0, (batch.theta_0 - 0.05) / 0.1
    outcome = np.where(y < 0.1 + 0.05 * x, 0, 1)
    disc = np.hypot(x - 0.5, y - 0.5) < 0.3 / batch.block.mass
    outcome[disc] = np.where(x > 0.5, 3, 2)[disc]
    return Response(
        scalars={"outcome": outcome.astype(np.int8)}, reasons=[""] * batch.size, used={"backend": "made up"}
    )


@pytest.fixture
def dataset(monkeypatch):
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    return rockcli.run(STUDY)


def points(dataset, kind: int, mass: float):
    """x, y in units of the map and the curve of each point."""
    where = (dataset["boundary"].values == kind) & (dataset["boundary_mass"].values == mass)
    x, y = (dataset["boundary_initial_theta"].values - 0.05) / 0.1, dataset["boundary_block_R"].values - 1.0
    return x[where], y[where], dataset["boundary_curve"].values[where]


@pytest.mark.parametrize("mass", [1.0, 2.0])
def test_curves_follow_what_is_known(dataset, mass):
    near = 0.75 / (N - 1)
    x, y, curve = points(dataset, UPLIFT, mass)
    assert len(set(curve)) == 1
    assert np.abs(y - 0.1 - 0.05 * x).max() <= near
    assert (x.min(), x.max()) == pytest.approx((0.0, 1.0))  # from side to side
    x, y, curve = points(dataset, OVERTURNING, mass)
    assert len(set(curve)) == 1
    assert np.abs(np.hypot(x - 0.5, y - 0.5) - 0.3 / mass).max() <= near
    assert (x[0], y[0]) == (x[-1], y[-1])
    area = 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))
    assert area == pytest.approx(np.pi * (0.3 / mass) ** 2, rel=0.01)
    x, y, curve = points(dataset, AFTER_IMPACT, mass)
    assert len(set(curve)) == 1
    assert np.abs(x - 0.5).max() <= near
    assert np.ptp(y) == pytest.approx(0.6 / mass, abs=2.5 / (N - 1))


def test_neighbours_on_a_curve_are_neighbours_on_the_map(dataset):
    x, y, _ = points(dataset, OVERTURNING, 1.0)
    assert np.hypot(np.diff(x), np.diff(y)).max() <= 1.01 / (N - 1)


def test_a_change_along_a_band_one_pixel_wide_is_a_point():
    outcome = np.ones((6, 5), dtype=np.int8)
    outcome[:3, 2], outcome[3:, 2] = 2, 3
    ((rows, cols),) = curves_of(outcome, AFTER_IMPACT)
    assert (rows.tolist(), cols.tolist()) == ([2.5], [2.0])


@pytest.mark.parametrize("known", [1.0, 0.8, 0.5])
def test_every_change_is_on_one_curve(known: float):
    """Of any map: as many points as there are neighbours of which one overturns, each once, saddles too."""
    random = np.random.default_rng(5)
    outcome = random.integers(0, 2, (30, 40)).astype(np.int8) * 2 + 1
    outcome[random.random(outcome.shape) > known] = FAILED
    curves = curves_of(outcome, OVERTURNING)
    met = [tuple(point) for rows, cols in curves for point in zip(rows.tolist(), cols.tolist(), strict=True)]
    closed = sum((rows[0], cols[0]) == (rows[-1], cols[-1]) and len(rows) > 1 for rows, cols in curves)
    changes = sum(int((np.abs(np.diff(outcome, axis=axis)) == 2).sum()) for axis in (0, 1))
    assert len(met) - closed == len(set(met)) == changes
    assert closed > (5 if known == 1.0 else 0)


def test_what_is_not_known_ends_a_curve():
    outcome = np.ones((9, 9), dtype=np.int8)
    outcome[:, 4:] = 2
    outcome[4, 3:6] = -1
    curves = curves_of(outcome, OVERTURNING)
    assert sorted((rows.min(), rows.max()) for rows, _ in curves) == [(0.0, 3.0), (5.0, 8.0)]
    assert curves_of(outcome, UPLIFT) == []


def test_a_table_of_points(dataset):
    frame = rockcli.table(dataset, of="boundaries")
    assert len(frame) == dataset.sizes["boundary_point"]
    assert set(frame["boundary"]) == set(KINDS)
    assert [name.split(" ")[0] for name in frame.columns] == [
        "boundary", "boundary_curve", "boundary_block_R", "boundary_mass", "boundary_initial_theta",
    ]  # fmt: skip


def test_a_figure_of_lines(dataset, tmp_path: Path):
    drawn = figures.figure("boundaries", dataset)
    assert len(drawn.axes[0].lines) == len(set(dataset["boundary_curve"].values))
    save(drawn, tmp_path / "lines.svg")
    assert "after impact" not in figures.why_not("boundaries", dataset)


def test_a_curve_of_one_point_is_drawn_as_a_dot(dataset):
    where = np.arange(dataset.sizes["boundary_point"]) < 1
    drawn = figures.figure("boundaries", dataset.isel(boundary_point=where))
    (dot,) = drawn.axes[0].lines
    assert np.isfinite(dot.get_xydata()).all()
    assert dot.get_linestyle() == "None"


def off_the_disc(x, y, radius: float):
    """How far points are from a disc of `made_up`, in points of the map, and how far their neighbours turn."""
    u, v = (y - 0.05) / 0.1 * (N - 1), (x - 1.0) * (N - 1)
    along = np.unwrap(np.arctan2(np.diff(v), np.diff(u)))
    return np.abs(np.hypot(u - 100.0, v - 100.0) - radius * (N - 1)), np.abs(np.diff(along))


def test_lines_are_drawn_without_the_steps_of_the_map(dataset):
    """Nearer to the disc on the whole than the points between its pixels, and never turning by a corner of them."""
    (axes,) = figures.figure("boundaries", dataset).axes
    mass = (
        dataset["boundary_block_mass"].values if "boundary_block_mass" in dataset else dataset["boundary_mass"].values
    )
    at = (dataset["boundary"].values == OVERTURNING) & (mass == 1.0)
    y, x = (dataset[f"boundary_{name}"].values[at] for name in ("block_R", "initial_theta"))
    raw, corners = off_the_disc(y, x, 0.3)
    line = next(
        one for one in axes.lines if one.get_linestyle() == "-" and one.get_color() == axes.lines[0].get_color()
    )
    shown = dict(zip(("x", "y"), line.get_data(), strict=True))
    smooth, turns = off_the_disc(shown["y"], shown["x"], 0.3)
    assert len(smooth) == len(raw)
    assert smooth.max() < np.sqrt(0.5)  # half the diagonal of a pixel
    assert np.sqrt(np.mean(smooth**2)) < 0.7 * np.sqrt(np.mean(raw**2))
    assert corners.max() > 0.7  # an eighth of a circle
    assert turns.max() < 0.25


def test_the_legend_says_the_units_of_the_other_axes(monkeypatch):
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    vary = STUDY["vary"] | {"block.mass": [100.0, 200.0], "model": ["rigid", "linearized"]}
    drawn = figures.figure("boundaries", rockcli.run(STUDY | {"vary": vary}))
    said = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert [words for words in said if "kg" in words] == [
        f"{mass} kg, {model}" for mass in ("mass = 100", "mass = 200") for model in ("rigid", "linearized")
    ]


def test_no_point_of_a_line_leaves_its_place_by_more_than_is_known():
    rng = np.random.default_rng(0)
    for closed in (False, True):
        line = np.cumsum(rng.integers(-1, 2, (60, 2)), axis=0).astype(float)
        line = np.concatenate([line, line[:1]]) if closed else line
        found = smoothed(line)
        assert np.abs(found - line).max() <= 0.5
        assert (found[0] == found[-1]).all() if closed else (found[[0, -1]] == line[[0, -1]]).all()


def test_islands_of_few_points_are_dots(monkeypatch):
    def speckled(batch: Batch) -> Response:
        x, y = batch.theta_0, batch.block.R[:, 0]
        spot = (np.abs(x - 0.1) < 1e-4) & (np.abs(y - 1.5) < 1e-3)
        outcome = np.where(spot, 3, np.where(y > 1.6, 3, 1)).astype(np.int8)
        return Response(scalars={"outcome": outcome}, reasons=[""] * batch.size, used={"backend": "made up"})

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", speckled)
    vary = {key: values for key, values in STUDY["vary"].items() if key != "block.mass"}
    drawn = figures.figure("boundaries", rockcli.run(STUDY | {"vary": vary}))
    dots = [line.get_xydata() for line in drawn.axes[0].lines if line.get_marker() == "o"]
    np.testing.assert_allclose(dots, [[[0.1, 1.5]]], rtol=1e-12)
    assert "islands of a few points of the map" in [text.get_text() for text in drawn.legends[0].get_texts()]


def test_a_whole_map_has_none(monkeypatch):
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)
    whole = rockcli.run(STUDY | {"refine": False})
    assert "boundary_curve" not in whole.variables
    assert "refine: true" in figures.why_not("boundaries", whole)
