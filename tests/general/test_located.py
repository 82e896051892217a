"""General methods with located events against the event-driven solver, which shares no step with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import G, array, block, make_batch, pulse, record, still

from rockcli.scene.body.block import make_block
from rockcli.scene.laws.damping import Damping
from rockcli.scene.laws.models import MODELS
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING
from rockcli.solvers.event import solver as event
from rockcli.solvers.general.methods import METHODS
from rockcli.solvers.general.solver import solve

SCALARS = ("theta_peak", "theta_peak_over_alpha", "u_top_peak", "t_uplift", "t_overturn", "t_end")

CASES = [
    # shape, R [m], tan(alpha), a_p/(g tan alpha), omega_p [rad/s]: rocking, overturning with and without impacts
    ("ricker", 2.0, 0.2, 3.6, 3.0 * np.pi),
    ("ricker", 5.0, 0.2, 6.0, 3.0),
    ("sine", 2.0, 0.333, 2.5, 3.0 * np.pi),
    ("square_cycle", 1.0, 0.25, 1.5, 4.0 * np.pi),
]

REFERENCE = Numerics(backend="scipy", method="DOP853", accuracy="reference", rtol=1e-12)


def with_damping(batch, scheme: str):
    if scheme == "restitution":
        return batch
    coefficient = array(0.02) if scheme == "dashpot" else None
    return replace(batch, damping=Damping(scheme, np.ones_like(batch.damping.eta), coefficient))


def assert_agree(batch, numerics=REFERENCE, atol=1e-9):
    exact, ours = event.solve(batch), solve(replace(batch, numerics=numerics))
    for name in ("outcome", "n_impacts"):
        np.testing.assert_array_equal(ours.scalars[name], exact.scalars[name], err_msg=f"{name} {ours.reasons}")
    for name in SCALARS:
        np.testing.assert_allclose(ours.scalars[name], exact.scalars[name], rtol=1e-9, atol=atol, err_msg=name)
    np.testing.assert_allclose(ours.histories["theta"], exact.histories["theta"], rtol=0.0, atol=atol)
    for name, values in exact.impacts.items():
        np.testing.assert_allclose(ours.impacts[name], values, rtol=0.0, atol=10.0 * atol, err_msg=name)
    return ours


@pytest.mark.parametrize("scheme", ["none", "restitution", "dashpot"])
@pytest.mark.parametrize("pair", MODELS, ids=str)
def test_every_model_and_damping_agrees_to_1e_9(pair, scheme):
    for shape, R, tan_alpha, times, omega_p in CASES:
        batch = make_batch(
            block(R, tan_alpha), pulse(shape, times * G * tan_alpha, omega_p), histories=True, dt_out=0.01
        )
        assert_agree(with_damping(replace(batch, model=pair[0], geometry=pair[1]), scheme))


def test_free_rocking_and_duration():
    body = block(1.0, 0.2)
    assert_agree(make_batch(body, still(), theta_0=0.12, histories=True))
    assert_agree(make_batch(body, still(duration=1.3), theta_0=-0.05, theta_dot_0=0.2, histories=True))
    cut = pulse("ricker", 3.0 * G * 0.2, 2.0 * np.pi, duration=2.1)
    assert_agree(make_batch(body, cut, histories=True))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("events", [True, False])
def test_a_report_that_ends_beyond_the_equilibrium_as_the_body_comes_back_with_speed_falls_to_the_other_side(
    side, events
):
    body = block(2.0, 0.2)
    alpha = float(body.alpha[0, 0])
    batch = make_batch(body, still(duration=0.02), theta_0=side * 1.2 * alpha, theta_dot_0=-side * 0.9, eta=1.0)
    exact = event.solve(batch).scalars
    ours = solve(replace(batch, numerics=replace(REFERENCE, events=events))).scalars
    assert ours["outcome"][0] == exact["outcome"][0] == OVERTURNED_AFTER_IMPACT
    assert ours["theta_peak"][0] == exact["theta_peak"][0] == -side * np.inf
    assert ours["t_overturn"][0] == pytest.approx(exact["t_overturn"][0], rel=1e-6)


def test_asymmetric_body_with_vertical_motion_on_a_record():
    t = np.arange(0.0, 4.0, 0.02)
    body = make_block(h=2.0, b=[[0.3, 0.4]])
    values = 3.0 * np.sin(7.0 * t) * np.exp(-0.3 * t) + 0.5 * np.sin(17.0 * t)
    motion = record(values, 0.02, vertical=2.0 * np.cos(9.0 * t))
    ours = assert_agree(make_batch(body, motion, histories=True, eta=0.9))
    assert ours.scalars["n_impacts"][0] > 3


def test_no_uplift_at_the_threshold():
    body = block(2.0, 0.2)
    ours = assert_agree(make_batch(body, pulse("sine", G * 0.2, 6.0), histories=True))
    assert ours.scalars["outcome"][0] == NO_UPLIFT
    assert solve(make_batch(body, pulse("sine", 1.001 * G * 0.2, 6.0))).scalars["outcome"][0] == ROCKING


def test_cases_of_a_batch_are_solved_one_by_one():
    R, tan_alpha = array([2.0, 2.0, 0.5]), array([0.2, 0.1, 0.3])
    alpha = np.arctan(tan_alpha)
    body = make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha, n=3)
    motion = pulse("ricker", 3.6 * G * tan_alpha, array([9.0, 4.0, 0.7]))
    assert_agree(make_batch(body, motion, histories=True, dt_out=0.02))


@pytest.mark.parametrize("cut", [0.15, 0.25])
@pytest.mark.parametrize("scheme", ["restitution", "dashpot"])
def test_a_report_that_ends_while_the_body_is_pushed_has_its_fastest_rate_at_the_end(cut, scheme):
    batch = with_damping(
        make_batch(block(2.0, 0.2), pulse("half_sine", -6.0, 2.0 * np.pi, duration=cut), histories=True), scheme
    )
    exact, ours = event.solve(batch), assert_agree(batch)
    np.testing.assert_allclose(ours.scalars["theta_dot_peak"], exact.scalars["theta_dot_peak"], rtol=1e-9)
    if scheme == "dashpot":
        plain = solve(replace(batch, numerics=replace(REFERENCE, events=False)))
        np.testing.assert_allclose(plain.scalars["theta_dot_peak"], exact.scalars["theta_dot_peak"], rtol=1e-6)


@pytest.mark.parametrize("name", METHODS)
def test_error_falls_with_the_tolerance(name):
    """Over eight swings of an undamped body, from the default tolerance down."""
    body = block(2.0, 0.2)
    batch = make_batch(body, pulse("sine", 3.6 * G * 0.2, 4.44 * np.pi), eta=1.0, histories=True, dt_out=0.02)
    exact = event.solve(batch).histories["theta"] / body.alpha[0, 0]
    tolerances = (1e-3, 1e-5) if METHODS[name].order <= 3 or METHODS[name].multistep else (1e-3, 1e-5, 1e-8)
    errors = []
    for rtol in tolerances:
        ours = solve(replace(batch, numerics=Numerics(backend="scipy", method=name, rtol=rtol)))
        errors.append(float(np.max(np.abs(ours.histories["theta"] / body.alpha[0, 0] - exact))))
        assert ours.used["method"].startswith(name)
    assert errors[-1] < 0.5 * errors[0], errors
    assert errors[-1] < 1e4 * tolerances[-1], errors


def test_dashpot_by_an_implicit_method():
    body = block(2.0, 0.2)
    batch = with_damping(make_batch(body, pulse("ricker", 3.0 * G * 0.2, 9.0), histories=True, dt_out=0.05), "dashpot")
    assert_agree(batch, Numerics(backend="scipy", method="Radau", rtol=1e-9), atol=1e-6)


def test_short_bounces_are_not_lost():
    """A loose tolerance takes steps longer than a bounce; still every impact is found."""
    random = np.random.default_rng(3)
    for _ in range(12):
        alpha_ratio, eta = random.uniform(1e-4, 0.02), random.uniform(0.6, 0.95)
        body = block(float(random.uniform(0.5, 5.0)), float(random.uniform(0.05, 0.4)))
        alpha = body.alpha[0, 0]
        batch = make_batch(body, still(), theta_0=float(alpha_ratio * alpha), eta=eta)
        exact = event.solve(batch).scalars["n_impacts"][0]
        for method in ("RK45", "DOP853"):
            ours = solve(replace(batch, numerics=Numerics(backend="scipy", method=method, rtol=1e-5)))
            assert ours.scalars["outcome"][0] == ROCKING
            assert abs(int(ours.scalars["n_impacts"][0]) - int(exact)) <= 1, (method, alpha_ratio, eta)


def test_error_estimate_bounds_the_error():
    body = block(2.0, 0.2)
    scalars = ("outcome", "theta_peak_over_alpha", "error_estimate")
    batch = make_batch(body, pulse("ricker", 3.6 * G * 0.2, 9.0), scalars=scalars)
    exact = event.solve(replace(batch, save=replace(batch.save, scalars=frozenset(scalars[:2]))))
    ours = solve(replace(batch, numerics=Numerics(backend="scipy", method="RK45", rtol=1e-4)))
    error = abs(ours.scalars["theta_peak_over_alpha"][0] - exact.scalars["theta_peak_over_alpha"][0])
    assert 0.0 < error < 3.0 * ours.scalars["error_estimate"][0] < 1e-2


def test_a_case_that_cannot_be_solved_is_a_failed_case(monkeypatch):
    monkeypatch.setattr("rockcli.solvers.general.methods.MAX_STEPS", 20)
    ours = solve(make_batch(block(2.0, 0.2), pulse("ricker", 3.6 * G * 0.2, 9.0), histories=True))
    assert ours.scalars["outcome"][0] == FAILED
    assert "gave up after 20 steps at t = " in ours.reasons[0]
    assert np.isnan(ours.scalars["theta_peak"][0])


def test_overturning_after_impact_is_told_from_rocking_near_the_boundary():
    found = {2.5: ROCKING, 2.6: OVERTURNED_AFTER_IMPACT, 11.3: OVERTURNED_AFTER_IMPACT, 11.4: ROCKING}
    for times, outcome in found.items():
        motion = pulse("ricker", times * G * 0.2, 5.0)
        ours = assert_agree(make_batch(block(2.0, 0.2), motion, histories=True, dt_out=0.02))
        assert ours.scalars["outcome"][0] == outcome
