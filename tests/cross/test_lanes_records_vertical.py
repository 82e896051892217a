"""Records with a vertical component in lanes: against the single-body solver, DOP853, closed forms, and themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cross.test_lanes_records import (
    LAWS,
    SCALARS,
    _lanes_only,
    assert_known_early,
    assert_same,
    differences,
    own,
    reference,
    same_bits_apart,
    suite,
)
from cross.test_lanes_records_duration import ANYWHERE, lasting
from cross.test_lanes_records_forces import assert_forces, everything, uneven
from reference import body_of, integrate
from scenes import G

from rockcli.scene.batch import Batch, Save
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.laws.models import MODELS
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT, ROCKING
from rockcli.solvers.common.certainty import perturbed
from rockcli.solvers.event import solver as event
from rockcli.solvers.event.solver import solve

assert _lanes_only  # a fixture of every test here too

SHARES = (0.02, -0.3, 0.45, 0.0, -0.7, 0.97, 0.2)
"""Largest vertical acceleration over g, case by case."""

CURVED = [key for key in LAWS if not MODELS[key].linear]


def lifted(batch: Batch, shares=SHARES, values=None, dt=None) -> Batch:
    """The same cases with a vertical component, by default another record, longer than the horizontal one."""
    if values is None:
        values, dt = own("synthetic_soil_m70.AT2")
        if batch.excitation.horizontal.dt != dt:  # as many samples as the horizontal one has
            values = np.roll(values, 150)[: len(batch.excitation.horizontal.values)]
            dt = batch.excitation.horizontal.dt
    vertical = Samples(values, dt, np.resize(shares, batch.size) * G / np.abs(values).max())
    return replace(batch, excitation=replace(batch.excitation, vertical=vertical))


@pytest.mark.parametrize("law", LAWS, ids=str)
@pytest.mark.parametrize("file", ["synthetic_pulse_m70.AT2", "synthetic_rock_m65.AT2"])
def test_every_law(law, file):
    values, dt = own(file)
    plain = suite(values, dt, np.linspace(0.6, 5.0, 12), [0.6, 3.0], [0.1, 0.25], model=law[0], geometry=law[1])
    found = assert_same(lifted(plain), most=1e-5)  # where it is hit some 300 times
    assert {0, 1} <= set(found["outcome"].tolist())
    still = solve(plain).scalars
    both = np.isfinite(still["theta_peak_over_alpha"]) & np.isfinite(found["theta_peak_over_alpha"])
    assert np.max(np.abs(still["theta_peak"][both] - found["theta_peak"][both])) > 1e-3


@pytest.mark.parametrize("eta", [0.0, 0.5, 0.99])
def test_every_restitution(eta):
    values, dt = own("synthetic_rock_m65.AT2")
    assert_same(lifted(suite(values, dt, [0.7, 1.05, 2.0, 3.0, 4.5], [1.0, 3.0], [0.15], eta=eta)), most=1e-5)


@pytest.mark.parametrize("ratio", [0.6, 1.5])
def test_two_different_edges_from_rest_and_from_a_tilt(ratio):
    values, dt = own()
    start = {"theta_0": np.linspace(-0.04, 0.06, 16), "theta_dot_0": np.linspace(0.2, -0.2, 16)}
    for state in ({}, start):
        batch = suite(values, dt, np.linspace(0.7, 4.0, 8), [0.6, 2.0], [0.2], **state)
        assert_same(lifted(uneven(batch, ratio)), most=1e-5)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_a_fall_is_known_before_it_ends(law):
    values, dt = own()
    batch = suite(values, dt, np.linspace(1.5, 6.0, 19), [0.5, 3.0], [0.1, 0.25], model=law[0], geometry=law[1])
    assert_known_early(lifted(batch))


@pytest.mark.parametrize("law", CURVED, ids=str)
def test_forces(law):
    values, dt = own("synthetic_rock_m65.AT2")
    batch = suite(values, dt, np.linspace(0.5, 5.0, 7), [0.6, 3.0], [0.15], model=law[0], geometry=law[1])
    found, exact, changes = everything(lifted(batch, [0.1, -0.3, 0.6]))
    assert_forces(found, exact, changes)
    still = found["outcome"] == 0
    assert still.any()
    np.testing.assert_allclose(found["mu_required"][still], exact["mu_required"][still], rtol=1e-13)
    np.testing.assert_allclose(found["N_min_over_mg"][still], exact["N_min_over_mg"][still], rtol=1e-13)
    assert (found["N_min_over_mg"][still] < 1.0).all()


@pytest.mark.parametrize("ratio", [1.0, 0.7])
def test_forces_of_reports_that_end(ratio):
    values, dt = own("synthetic_rock_m65.AT2")
    start = {"theta_0": np.linspace(-0.03, 0.05, 20), "theta_dot_0": np.linspace(0.1, -0.2, 20)}
    for state in ({}, start):
        batch = uneven(suite(values, dt, np.linspace(0.8, 5.0, 10), [0.6, 3.0], [0.15], **state), ratio)
        assert_forces(*everything(lasting(lifted(batch, [0.1, -0.3, 0.5]), ANYWHERE)))


def test_reports_that_end():
    values, dt = own()
    for law in (("rigid", None), ("linearized", None)):
        batch = suite(values, dt, np.linspace(0.7, 5.0, 10), [0.6, 3.0], [0.1, 0.25], model=law[0])
        found = assert_same(lasting(lifted(batch), [*ANYWHERE, 1.3, 1.4]), most=1e-6)
        assert {0, 1} <= set(found["outcome"].tolist())


def test_a_vertical_motion_of_zeros_changes_nothing():
    values, dt = own()
    for law in (("rigid", None), ("linearized", None), ("3", "corotational")):
        batch = suite(values, dt, np.linspace(0.9, 5.0, 12), [0.6, 3.0], [0.15], model=law[0], geometry=law[1])
        one = solve(batch).scalars
        for nothing in (
            lifted(batch, [0.5], np.append(np.zeros(len(values) - 1), 1e-300), dt),
            lifted(batch, [0.0], values, dt),
        ):
            two = solve(nothing).scalars
            for name in ("outcome", "theta_peak", "n_impacts", "t_uplift"):
                np.testing.assert_allclose(two[name], one[name], rtol=1e-9, err_msg=name)


def test_gravity_as_a_constant():
    """Under a constant a_v the body rocks as one with that much more gravity."""
    values, dt = own()
    batch = suite(values, dt, np.linspace(1.5, 4.0, 12), [0.6, 2.0], [0.2], eta=0.9)
    values = np.append(values[:-1], 0.0)
    horizontal = replace(batch.excitation.horizontal, values=values)
    batch = lasting(replace(batch, excitation=replace(batch.excitation, horizontal=horizontal)), [1.0])
    for share in (0.4, -0.4):
        one = solve(lifted(batch, [share], np.ones(len(values)), dt)).scalars
        two = solve(replace(batch, g=batch.g * (1.0 + share))).scalars
        np.testing.assert_array_equal(one["outcome"], two["outcome"])
        np.testing.assert_allclose(one["theta_peak"], two["theta_peak"], rtol=1e-8)
        np.testing.assert_allclose(one["t_uplift"], two["t_uplift"], rtol=1e-12)


def test_uplift_by_the_vertical_motion():
    """A ground that alone lifts nothing, far from where the weight falls away: the root of the two straight lines."""
    dt, n = 0.01, 1000
    horizontal, vertical = np.full(n, 0.2 * G * 0.9), np.zeros(n)
    horizontal[0] = horizontal[-1] = 0.0
    for k, depth in ((100, 0.15), (127, 0.3), (128, 0.2), (640, 0.101), (997, 0.9)):
        up = vertical.copy()
        up[k] = -depth * G
        batch = suite(horizontal, dt, [0.9], [0.6, 2.0], [0.2])
        found = solve(lifted(batch, [depth], up / depth, dt)).scalars
        # 0.9 = 1 - depth (x - (k - 1)) where it lifts
        np.testing.assert_allclose(found["t_uplift"], dt * (k - 1 + 0.1 / depth), rtol=1e-12)
        assert (found["outcome"] >= ROCKING).all()
        assert np.isnan(solve(lifted(batch, [-0.5], up / depth, dt)).scalars["t_uplift"]).all()


def test_neighbours_order_and_chunks_do_not_matter():
    values, dt = own()
    batch = lifted(suite(values, dt, np.linspace(0.9, 5.0, 40), np.geomspace(0.4, 6.0, 5), [0.1, 0.2, 0.3]))
    same_bits_apart(batch, (*SCALARS, "n_steps", "mu_impact"))


def test_both_polarities_mirror():
    values, dt = own()
    batch = lifted(suite(values, dt, [1.5, 2.5, 3.5], [0.8, 2.0], [0.2]))
    other = replace(batch.excitation.horizontal, factor=-batch.excitation.horizontal.factor)
    back = solve(replace(batch, excitation=replace(batch.excitation, horizontal=other))).scalars
    there = solve(batch).scalars
    np.testing.assert_array_equal(there["theta_peak"], -back["theta_peak"])
    np.testing.assert_array_equal(there["outcome"], back["outcome"])


def test_who_is_solved_one_by_one(monkeypatch):
    """Other time steps, a component that ends early and not at zero, pulses, forces of linear bodies; above g, `mu`."""
    alone = []
    march_rows = event._march_rows

    def noted(kernel, batch, rows, *rest, **more):
        alone.append(len(rows))
        march_rows(kernel, batch, rows, *rest, **more)

    monkeypatch.setattr(event, "_march_rows", noted)
    values, dt = own()
    batch = suite(values, dt, [1.5, 2.5, 3.5], [0.8, 2.0], [0.2])
    for other in (lifted(batch), lifted(batch, SHARES, values[:2000] * np.linspace(1.0, 0.0, 2000), dt)):
        assert "lanes" in solve(other).used["method"]
    assert not alone
    coarse, early = lifted(batch, SHARES, values, 2.0 * dt), lifted(batch, SHARES, values[:900], dt)
    linear = replace(lifted(batch), model="linearized", save=Save(False, 0.01, frozenset({"outcome", "mu_required"})))
    for other in (coarse, early, linear):
        assert "lanes" not in solve(other).used["method"]
    alone.clear()
    heavy = lifted(batch, [0.5, 1.01, 0.999, -1.2, 0.1, 0.2])
    wrong, error, _, _ = differences(heavy)
    assert not wrong.any()
    assert error.max() <= 1e-7
    assert alone[0] == 2
    alone.clear()
    slippery = replace(batch.block, mu=np.array([np.nan, 0.9, np.nan, 5.0, 0.1, np.nan]))
    found = solve(replace(lifted(batch), block=slippery)).scalars
    assert alone[0] == 3
    sticks = np.isnan(slippery.mu) | (slippery.mu == 5.0)
    np.testing.assert_array_equal(found["outcome"][sticks], solve(lifted(batch)).scalars["outcome"][sticks])


@pytest.mark.parametrize("longer", [pytest.param(True, marks=pytest.mark.slow), False])
def test_against_an_independent_integrator(longer):
    values, dt = own()
    if not longer:
        values = np.append(values[500:1400] * np.hanning(900), 0.0)
    up = own("synthetic_soil_m70.AT2")[0][: len(values) if longer else 1200]
    batch = suite(values, dt, [1.3, 2.2, 3.0], [0.8], [0.12, 0.25])
    batch = lifted(batch, [0.3, -0.6, 0.9], up, dt)
    found = solve(batch).scalars
    n = max(len(values), len(up))
    overturned = 0
    for i in range(batch.size):
        across = np.pad(values, (0, n - len(values))) * batch.excitation.horizontal.factor[i]
        along = np.pad(up, (0, n - len(up))) * batch.excitation.vertical.factor[i]
        theirs = integrate(body_of(batch.block, batch.damping.eta[i], case=i), across, dt, vertical=along)
        assert theirs.overturned == (found["outcome"][i] >= OVERTURNED_WITHOUT_IMPACT)
        overturned += theirs.overturned
        if not theirs.overturned:
            assert found["theta_peak_over_alpha"][i] == pytest.approx(theirs.peak_over_alpha, abs=2e-8)
    assert 0 < overturned < batch.size


@pytest.mark.parametrize("seed", range(3))
def test_random_cases(seed):
    """All laws, edges, restitutions, starts and durations: what differs, the motion scaled by 1 +- 1e-10 changes too."""
    rng = np.random.default_rng(seed)
    errors, n = [], 48
    for law in [key for key in MODELS if key[0] != "flexible"]:
        for file in ("synthetic_pulse_m70.AT2", "synthetic_rock_m65.AT2"):
            values, dt = own(file)
            scale, start = np.linspace(0.6, 5.0, 12) * rng.uniform(0.95, 1.05), {}
            if rng.random() < 0.3:
                start = {"theta_0": rng.uniform(-0.1, 0.1, n), "theta_dot_0": rng.uniform(-0.3, 0.3, n)}
            eta = None if rng.random() < 0.5 else rng.uniform(0.0, 0.95)
            batch = suite(values, dt, scale, [0.6, 3.0], [0.12, 0.25], model=law[0], geometry=law[1], eta=eta, **start)
            if rng.random() < 0.4:
                batch = uneven(batch, rng.uniform(0.6, 1.4))
            batch = lifted(batch, rng.uniform(-0.995, 0.995, n))
            if rng.random() < 0.4:
                batch = lasting(batch, np.where(rng.random(n) < 0.7, rng.uniform(0.02, 1.3, n), np.nan))
            wrong, error, _, exact = differences(batch)
            for factor in (1.0 - 1e-10, 1.0 + 1e-10):
                rows = np.flatnonzero(wrong)
                if len(rows):
                    other = reference(perturbed(batch, rows, np.full(len(rows), factor)))
                    wrong[rows] = other["outcome"] == exact["outcome"][rows]
            assert not wrong.any()
            errors.append(error)
    error = np.concatenate(errors)
    assert len(error) > 400
    assert np.median(error) <= 1e-13
    assert np.quantile(error, 0.9) <= 1e-10


def test_certainty():
    """The second run of the estimate goes in lanes too, and it bounds the error."""
    values, dt = own()
    plain = suite(values, dt, np.linspace(1.0, 4.0, 25), [0.7, 2.0], [0.12, 0.25])
    batch = lifted(plain)
    batch = replace(batch, save=Save(False, 0.01, frozenset({*SCALARS, "error_estimate", "overturn_share"})))
    response = solve(batch)
    assert "lanes" in response.used["method"]
    found, exact = response.scalars, reference(lifted(plain))
    sure = np.isfinite(found["theta_peak_over_alpha"]) & (found["outcome"] >= 0)
    assert sure.sum() >= 20
    error = np.abs(found["theta_peak_over_alpha"][sure] - exact["theta_peak_over_alpha"][sure])
    assert (error <= np.maximum(found["error_estimate"][sure], 1e-12)).mean() > 0.98
    known = found["outcome"] >= 0
    np.testing.assert_array_equal(found["outcome"][known], exact["outcome"][known])
