"""Whole paths of bodies in lanes of pulses: against single bodies at reference accuracy, and an independent DOP853."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cross.test_lanes_pulses import ALPHA, map_of, ricker_in_g, uneven
from reference import Body, body_of, flights
from scenes import G, pulse
from scipy.optimize import brentq

from rockcli import kernels
from rockcli.kernels.rigid import results as to
from rockcli.scene.body.block import Block
from rockcli.scene.ground.pulses import SHAPES
from rockcli.scene.laws.models import MODELS
from rockcli.scene.response import overturned
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event.pack import parameters_of, settings_of
from rockcli.solvers.event.solver import solve

TIMES = ("t_peak", "t_uplift", "t_overturn", "t_end")
SIZES = ("theta_peak", "theta_peak_over_alpha", "theta_dot_peak", "mu_required", "mu_impact", "N_min_over_mg")
FOUND = ("outcome", "n_impacts", "energy_residual", *TIMES, *SIZES)
NONLINEAR = [pair for pair, model in MODELS.items() if not model.linear]


@pytest.fixture(autouse=True, scope="module")
def compiled():
    kernels.load(compile_them=True)


def assert_same(batch) -> None:
    found = solve(batch)
    assert found.used["method"] == lane_pulses.METHOD_ON_PATH
    exact = solve(replace(batch, numerics=replace(batch.numerics, accuracy="reference"))).scalars
    np.testing.assert_array_equal(found.scalars["outcome"], exact["outcome"])
    for name in (*TIMES, *SIZES):
        ours, theirs = found.scalars[name], exact[name]
        np.testing.assert_array_equal(np.isnan(ours), np.isnan(theirs), err_msg=name)
        np.testing.assert_array_equal(np.isinf(ours), np.isinf(theirs), err_msg=name)
        known = np.isfinite(theirs)
        error = np.abs(ours[known] - theirs[known])
        assert np.median(error) < 1e-9, name
        # to the stronger side |a_g| may be largest where a body comes to rest, which is as sharp as the accuracy has it
        at_rest = name == "mu_required" and not batch.block.symmetric.all()
        assert np.quantile(error, 0.99) < (1e-5 if at_rest else 1e-6), name
    assert np.nanmax(np.abs(found.scalars["energy_residual"])) < 1e-8
    # an impact at the very end of the report may fall on either side of it
    assert np.mean(found.scalars["n_impacts"] != exact["n_impacts"]) < 5e-3


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes(shape):
    assert_same(map_of(shape, 6, scalars=FOUND))


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_in_detail(shape):
    assert_same(map_of(shape, 60, scalars=FOUND))


@pytest.mark.parametrize(("model", "geometry"), NONLINEAR)
def test_models(model, geometry):
    assert_same(map_of("ricker", 5, model=model, geometry=geometry, scalars=FOUND))


@pytest.mark.parametrize("eta", [0.0, 0.5, 0.99, 1.0])
def test_restitution(eta):
    assert_same(map_of("sine", 6, eta=eta, scalars=FOUND))


@pytest.mark.slow
@pytest.mark.parametrize("eta", [0.0, 0.3, 0.8, 0.99, 1.0])
def test_restitution_in_detail(eta):
    assert_same(map_of("cosine", 60, eta=eta, scalars=FOUND))


@pytest.mark.parametrize("shape", ["ricker", "sine", "square_cycle", "mavroeidis_papageorgiou"])
@pytest.mark.parametrize("eta", [0.0, 0.6, 0.9])
def test_two_different_edges(shape, eta):
    batch = map_of(shape, 6, eta=eta, scalars=(*FOUND, "theta_peak_left", "theta_peak_right"))
    assert_same(uneven(batch))
    assert_same(uneven(batch, 1.1, 0.7))  # the first half of a pulse is held by the wider side


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_two_different_edges_in_detail(shape):
    assert_same(uneven(map_of(shape, 60, scalars=FOUND)))


def test_what_lanes_do_not_follow_is_solved_alone():
    batch = map_of("ricker", 5, scalars=FOUND)
    other = replace(batch, theta_0=np.full(batch.size, -0.4 * ALPHA))
    found = solve(other).scalars
    exact = solve(replace(other, numerics=replace(other.numerics, accuracy="reference"))).scalars
    np.testing.assert_array_equal(found["outcome"], exact["outcome"])
    np.testing.assert_allclose(found["mu_required"], exact["mu_required"], rtol=1e-6)
    few = solve(map_of("ricker", 5, model="linearized", scalars=FOUND))
    assert few.used["method"] != lane_pulses.METHOD_ON_PATH


def late_extremes(of=lambda batch: batch):
    """Bodies whose forces are extreme within the step in which they pass the equilibrium, and one that rocks."""
    return of(map_of("ricker_antisymmetric", 30, scalars=FOUND)).rows(np.array([109, 191, 192, 223, 224, 255, 302]))


@pytest.mark.parametrize("of", [lambda batch: batch, uneven], ids=["symmetric", "asymmetric"])
def test_extremes_until_they_fall(of):
    assert_same(late_extremes(of))


NOT_TO_THE_GROUND = ("outcome", "n_impacts", "t_peak", "t_uplift", "t_overturn", "theta_peak", "mu_impact")


def assert_same_as_to_the_ground(batch) -> None:
    """Where nothing is asked of the way from the equilibrium to the ground, bodies are not followed there."""
    save = replace(batch.save, scalars=frozenset(NOT_TO_THE_GROUND))
    found, whole = solve(replace(batch, save=save)).scalars, solve(batch).scalars
    for name in NOT_TO_THE_GROUND:
        np.testing.assert_array_equal(found[name], whole[name], err_msg=name)
    assert overturned(whole["outcome"]).any()


@pytest.mark.parametrize("of", [lambda batch: batch, uneven], ids=["symmetric", "asymmetric"])
@pytest.mark.parametrize("shape", SHAPES)
def test_until_they_fall(shape, of):
    assert_same_as_to_the_ground(of(map_of(shape, 30, scalars=FOUND)))


@pytest.mark.parametrize("of", [lambda batch: batch, uneven], ids=["symmetric", "asymmetric"])
@pytest.mark.parametrize("shape", ["ricker", "sine", "square_cycle"])
def test_few_are_handed_over(shape, of):
    batch = of(map_of(shape, 30, scalars=FOUND))
    lanes = kernels.load("lanes.pulses.march", compile_them=True)
    how = settings_of(lanes, batch, batch.numerics.tolerances, lanes.ALL)
    raw = lane_pulses.run(lanes, batch, parameters_of(batch), how, slice(None), path=True)
    lifted = solve(batch).scalars["outcome"] != 0
    assert np.isnan(raw[lifted, to.STATUS]).mean() < 0.02


@pytest.mark.parametrize("shape", ["ricker", "ricker_antisymmetric"])
def test_one_that_never_lifts_needs_the_pga(shape):
    batch = map_of(shape, 5, scalars=("outcome", "mu_required", "N_min_over_mg"))
    a_p = np.linspace(0.1, 0.9, batch.size) * G * np.tan(ALPHA)
    low = replace(batch, excitation=pulse(shape, a_p, batch.excitation.horizontal.omega_p))
    found = solve(low).scalars
    assert np.all(found["outcome"] == 0)
    np.testing.assert_allclose(found["mu_required"], a_p / G, rtol=1e-6)
    np.testing.assert_array_equal(found["N_min_over_mg"], 1.0)


def test_certainty_is_that_of_single_bodies(monkeypatch):
    batch = map_of("ricker", 12, scalars=("outcome", "overturn_share", "error_estimate", "theta_peak"))
    found = solve(batch).scalars
    monkeypatch.setattr(lane_pulses, "path_asked", lambda batch: False)
    alone = solve(batch).scalars
    np.testing.assert_array_equal(found["outcome"], alone["outcome"])
    np.testing.assert_array_equal(found["overturn_share"], alone["overturn_share"])
    stands = np.isfinite(alone["error_estimate"]) & (alone["error_estimate"] > 0.0)
    ratio = found["error_estimate"][stands] / alone["error_estimate"][stands]
    assert np.all((ratio > 0.3) & (ratio < 3.0))


def forces_by_dop853(A: float, W: float, block: Block) -> tuple[float, float, float]:
    """Largest |T|/N, smallest N/(m g) and largest rate of a body on two edges under a Ricker pulse, from rest on.

    Up to the last passage of alpha if it falls; from accelerations by the equation of motion, at 400 times a flight.
    """
    in_g, end, _ = ricker_in_g(A, W)
    body, grid = body_of(block, 0.9), np.linspace(0.0, end, 200_001)
    ground = in_g(grid)
    lifts = (ground > np.tan(body.alpha[-1])) | (ground < -np.tan(body.alpha[1]))
    pieces = [(end + 20.0, lambda t: G * in_g(t))]  # a Ricker pulse fades away by itself
    most, least, fastest, t, falls = 0.0, 1.0, 0.0, 0.0, False
    while t < end and not falls:  # from rest to rest
        stands = (grid >= t) & ~np.logical_or.accumulate(lifts & (grid >= t))
        most = max(most, float(np.abs(ground[stands]).max(initial=0.0)))
        lifted = np.flatnonzero(lifts & (grid >= t))
        if not len(lifted):
            break
        up = lifted[0]
        for sol, s in flights(body, -int(np.sign(ground[up])), (0.0, 0.0), grid[up], pieces, rest=1e-6):
            t, falls = sol.t[-1], bool(sol.t_events[1].size)
            found = forces_on_flight(body, s, sol, falls, in_g)
            most, least, fastest = max(most, found[0]), min(least, found[1]), max(fastest, found[2])
    return most, least, fastest


def forces_on_flight(body: Body, s: int, sol, falls: bool, in_g) -> tuple[float, float, float]:
    """Those of `forces_by_dop853` between two impacts."""
    alpha, R, stop = body.alpha[s], body.R[s], sol.t[-1]
    if falls:  # its last passage of alpha
        stop = brentq(lambda t: s * sol.sol(t)[0] - alpha, sol.t[np.argmin(s * sol.y[0])], stop)
    t = np.linspace(sol.t[0], stop, 400)
    theta, w = sol.sol(t)
    b = s * alpha - theta
    acc = -(body.p[s] ** 2) * (np.sin(b) + in_g(t) * np.cos(b))
    # of the centre of mass at R (sin b, cos b) from the edge, times -s along
    T = in_g(t) + R / G * (np.cos(b) * acc + np.sin(b) * w * w)
    N = 1.0 + R / G * (np.sin(b) * acc - np.cos(b) * w * w)
    return float(np.max(np.abs(T) / N)), float(N.min()), float(np.abs(w).max())


@pytest.mark.parametrize("sides", [(1.0, 1.0), (0.7, 1.1), (1.1, 0.7)])
@pytest.mark.parametrize(("A", "W"), [(1.5, 2.0), (2.5, 4.0), (4.0, 3.0), (3.0, 1.0), (5.5, 6.5)])
def test_forces_are_those_of_an_independent_path(A, W, sides):
    batch = uneven(map_of("ricker", 1, scalars=FOUND), *sides)
    batch = replace(batch, excitation=pulse("ricker", [A * G * np.tan(ALPHA)], [W]))
    found = {name: values[0] for name, values in solve(batch).scalars.items() if name in FOUND}
    most, least, fastest = forces_by_dop853(A, W, batch.block)
    assert found["mu_required"] == pytest.approx(most, rel=2e-4)
    assert found["N_min_over_mg"] == pytest.approx(least, rel=2e-4)
    if not overturned(found["outcome"]):
        assert found["theta_dot_peak"] == pytest.approx(fastest, rel=2e-4)
