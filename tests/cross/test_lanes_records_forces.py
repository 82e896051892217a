"""Forces, rates and the energy balance of record lanes against the single-body solver at its highest accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from cross.test_lanes_records import LAWS, _lanes_only, own, read, reference, suite
from scenes import SHARED

from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import make_block
from rockcli.scene.laws.damping import housner_eta
from rockcli.scene.response import NO_UPLIFT, ROCKING, overturned
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.certainty import CERTAINTY, perturbed
from rockcli.solvers.event.solver import solve

lanes_only = _lanes_only

FORCES = ("theta_dot_peak", "mu_required", "N_min_over_mg")


def everything(batch: Batch) -> Iterator[dict]:
    """All scalars by lanes and by the single-body solver, of the cases of one outcome, which are nearly all.

    And by how much forces of the latter change when the motion is scaled by 1 +- 1e-12: a body hit a thousand times
    may forget how it began.
    """
    batch = replace(batch, save=Save(False, 0.01, frozenset(SCALARS) - CERTAINTY))
    response = solve(batch)
    assert "lanes" in response.used["method"]
    found, exact = response.scalars, reference(batch)
    same = found["outcome"] == exact["outcome"]
    assert same.mean() > 0.95
    every, changes = np.arange(batch.size), dict.fromkeys(FORCES, 0.0)
    for factor in (1.0 - 1e-12, 1.0 + 1e-12):
        other = reference(perturbed(batch, every, np.full(batch.size, factor)))
        for name in FORCES:
            with np.errstate(invalid="ignore"):
                changes[name] = np.fmax(changes[name], np.abs(other[name] - exact[name]))
    return ({k: np.asarray(v)[same] for k, v in values.items()} for values in (found, exact, changes))


def assert_forces(found: dict, exact: dict, changes: dict, within: float = 10.0) -> None:
    """`within`: of how many of those changes the lanes may be away, whose steps err by more than 1e-12."""
    for name in FORCES:
        one, two = found[name], exact[name]
        np.testing.assert_array_equal(np.isnan(one), np.isnan(two), err_msg=name)
        np.testing.assert_array_equal(np.isinf(one), np.isinf(two), err_msg=name)
        numbers = np.isfinite(two)
        one, two, change = one[numbers], two[numbers], changes[name][numbers]
        assert (np.abs(one - two) <= 1e-9 * np.abs(two) + within * change).all(), name
        assert np.median(change) <= 1e-9, name  # most are well posed
    # what the lanes do not count is of the size of their steps' errors
    assert np.nanmax(np.abs(found["energy_residual"])) <= 1e-9


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_every_law(law):
    values, dt = own("synthetic_rock_m65.AT2")
    scale = np.linspace(0.9, 5.0, 6)
    found, exact, changes = everything(suite(values, dt, scale, [0.6, 3.0], [0.15], model=law[0], geometry=law[1]))
    assert {NO_UPLIFT, ROCKING} <= set(found["outcome"].tolist())
    assert_forces(found, exact, changes)
    # a body that never moves needs what the ground asks for, and one that rocks at least what lifts it
    still = found["outcome"] == NO_UPLIFT
    assert still.any()
    assert (found["theta_dot_peak"][still] == 0.0).all()
    np.testing.assert_allclose(found["mu_required"][still], exact["mu_required"][still], rtol=1e-14)
    np.testing.assert_array_equal(found["N_min_over_mg"][still], 1.0)


@pytest.mark.parametrize("eta", [0.0, 0.5, 1.0])
def test_every_restitution(eta):
    values, dt = own("synthetic_rock_m65.AT2")
    assert_forces(*everything(suite(values, dt, [0.5, 1.05, 2.0, 3.0, 4.5], [1.0, 3.0], [0.15], eta=eta)))


def uneven(batch: Batch, ratio: float, eta: float | None = None) -> Batch:
    """The same bodies with their left edge nearer to the centre of mass, or farther from it."""
    block = batch.block
    body = make_block(h=block.h, b=block.b * [ratio, 1.0], n=batch.size)
    kept = np.clip(housner_eta(body), 0.0, 1.0) if eta is None else np.full((batch.size, 2), eta)
    return replace(batch, block=body, damping=replace(batch.damping, eta=kept))


@pytest.mark.parametrize(("ratio", "eta"), [(0.5, None), (0.93, None), (1.6, 0.8), (0.7, 0.0), (0.8, 1.0)])
def test_two_different_edges(ratio, eta):
    values, dt = own("synthetic_rock_m65.AT2")
    batch = uneven(suite(values, dt, [0.5, 1.05, 2.0, 3.0, 4.5], [1.0, 3.0], [0.15]), ratio, eta)
    found, exact, changes = everything(batch)
    assert_forces(found, exact, changes)
    np.testing.assert_allclose(found["mu_impact"], exact["mu_impact"], rtol=1e-12)
    if eta is None:
        assert overturned(found["outcome"]).any()


def test_two_different_edges_from_a_tilt():
    t = np.arange(400) * 0.02
    values = np.cos(7.0 * t) * np.exp(-0.2 * t) + 0.2 * np.cos(23.0 * t)
    for state in ({"theta_0": 0.05}, {"theta_0": -0.02, "theta_dot_0": 0.15}, {"theta_dot_0": -0.15}):
        tilted = {name: np.full(8, value) for name, value in state.items()}
        assert_forces(*everything(uneven(suite(values, 0.02, [0.2, 0.3, 0.9, 3.0], [1.0, 3.0], [0.2], **tilted), 0.7)))


@pytest.mark.parametrize("start", [{"theta_0": 0.05}, {"theta_0": -0.02, "theta_dot_0": 0.3}, {"theta_dot_0": -0.4}])
def test_from_a_tilt_under_a_motion_that_begins_and_ends_at_once(start):
    """The ground's work has an end at either side: its acceleration is not zero there."""
    t = np.arange(400) * 0.02
    values = np.cos(7.0 * t) * np.exp(-0.2 * t) + 0.2 * np.cos(23.0 * t)
    n = len([0.3, 0.9, 1.5, 3.0]) * 2
    state = {name: np.full(n, value) for name, value in start.items()}
    assert_forces(*everything(suite(values, 0.02, [0.3, 0.9, 1.5, 3.0], [1.0, 3.0], [0.2], **state)))


def test_standing_bodies_need_what_they_needed_before_they_fell():
    values, dt = own()
    found, exact, changes = everything(suite(values, dt, np.linspace(2.0, 8.0, 12), [0.5, 2.0], [0.1, 0.25]))
    assert overturned(found["outcome"]).sum() >= 10
    assert_forces(found, exact, changes)


def test_certainty_by_lanes_is_that_of_single_bodies():
    """Two runs in lanes: where these part, single bodies tell, as they do of every case at `reference`."""
    values, dt = own()
    batch = suite(values, dt, np.linspace(1.0, 6.0, 20), [0.5, 3.0], [0.1, 0.25])
    batch = replace(batch, save=Save(False, 0.01, frozenset(SCALARS)))
    response = solve(batch)
    assert "lanes" in response.used["method"]
    found, exact = response.scalars, reference(batch)
    known = (found["outcome"] >= NO_UPLIFT) & (exact["outcome"] >= NO_UPLIFT)
    assert known.mean() > 0.98
    np.testing.assert_array_equal(found["outcome"][known], exact["outcome"][known])
    rocks = known & (found["outcome"] == ROCKING)
    error = np.abs(found["theta_peak_over_alpha"][rocks] - exact["theta_peak_over_alpha"][rocks])
    assert np.mean(error <= found["error_estimate"][rocks]) >= 0.98
    assert np.isfinite(found["overturn_share"]).all()


@pytest.mark.skipif(not SHARED.is_dir(), reason="no folder of real records beside the checkout")
def test_recorded_motions():
    paths = sorted((SHARED / "records" / "peer").glob("*.AT2"))[::8][:6]
    assert len(paths) == 6
    for path in paths:
        values, dt = read(path)
        batch = suite(values, dt, np.geomspace(0.8, 8.0, 8), [0.5, 1.5, 5.0], [0.1, 0.3])
        assert_forces(*everything(batch), within=100.0)  # a body hit 164 times by one is 36 of them away
        assert_forces(*everything(uneven(batch, 0.8)), within=100.0)
