"""Friction and normal force at the edge, from finite differences of the centre of mass."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from scenes import G, block, make_batch, pulse, record, rock, still, with_ground
from scipy.optimize import brentq

from rockcli.scene.body.block import make_block
from rockcli.solvers.event.solver import solve


def forces_by_finite_differences(response, body, dt, g=G):
    """T/m and N/m at output times well inside smooth pieces, from the positions of the centre of mass."""
    theta, a_g, a_v = (response.histories[name][0] for name in ("theta", "a_g", "a_v"))
    right = theta > 0.0
    R = np.where(right, body.R[0, 1], body.R[0, 0])
    alpha = np.where(right, body.alpha[0, 1], body.alpha[0, 0])
    b = np.where(right, body.b[0, 1], -body.b[0, 0])
    s = np.where(right, 1.0, -1.0)
    x = b - s * R * np.sin(alpha - np.abs(theta))
    z = R * np.cos(alpha - np.abs(theta))
    acc = [(u[2:] - 2.0 * u[1:-1] + u[:-2]) / dt**2 for u in (x, z)]
    T, N = a_g[1:-1] + acc[0], g + a_v[1:-1] + acc[1]
    smooth = (np.sign(theta[2:]) == np.sign(theta[1:-1])) & (np.sign(theta[:-2]) == np.sign(theta[1:-1]))
    moving = smooth & (np.abs(theta[1:-1]) > 1e-7)
    return np.abs(T[moving] / N[moving]), N[moving] / g


@pytest.mark.parametrize(("R", "tan_alpha"), [(2.0, 0.2), (0.7, 0.5)])
def test_forces_under_a_pulse(R, tan_alpha):
    body, dt = block(R, tan_alpha), 2e-4
    motion = pulse("ricker", 2.0 * G * tan_alpha, 4.0 * np.sqrt(0.75 * G / R))
    response = with_ground(rock(body, motion, histories=True, dt_out=dt), body, motion)
    mu, N = forces_by_finite_differences(response, body, dt)
    assert response.scalars["mu_required"][0] == pytest.approx(mu.max(), rel=2e-3)
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(N.min(), rel=2e-3)
    assert response.scalars["mu_required"][0] >= mu.max() * (1.0 - 1e-5)


def test_forces_of_an_asymmetric_body_with_vertical_motion():
    body, dt = make_block(h=1.2, b=[0.2, 0.35]), 2e-4
    t = np.arange(0.0, 6.0, 0.02)
    motion = record(1.9 * np.sin(6.0 * t), 0.02, vertical=1.0 * np.sin(7.0 * t))
    response = with_ground(rock(body, motion, histories=True, dt_out=dt), body, motion)
    assert response.scalars["outcome"][0] == 1
    mu, N = forces_by_finite_differences(response, body, dt)
    # differences across a kink of a_g are wrong by its jump: compare away from the extremes of rounding
    assert response.scalars["mu_required"][0] == pytest.approx(mu.max(), rel=5e-3)
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(N.min(), rel=5e-3)


def test_extremes_between_samples_that_are_far_apart():
    # 0.31 s apart, 0.45/p: the rate turns twice between two of them
    body = make_block(h=3.2, b=1.5)
    response = rock(body, record([-15.6, 6.1, -10.4], 0.31), histories=True, dt_out=1e-4)
    rates = np.abs(response.histories["theta_dot"][0])
    assert response.scalars["theta_dot_peak"][0] == pytest.approx(rates.max(), rel=1e-5)


def test_friction_at_rest_is_that_of_the_ground():
    body = block(2.0, 0.3)
    response = rock(body, pulse("sine", 0.2 * G, 7.0))
    assert response.scalars["outcome"][0] == 0
    assert response.scalars["mu_required"][0] == pytest.approx(0.2, rel=1e-4)
    assert response.scalars["N_min_over_mg"][0] == 1.0


@pytest.mark.parametrize("accuracy", ["draft", "standard", "reference"])
def test_normal_force_at_rest_is_least_where_a_vertical_pulse_is(accuracy):
    """A Ricker pulse is least in its side lobes, -2 exp(-3/2) of its peak."""
    ground, up = pulse("ricker", 0.1 * G, 5.0), pulse("ricker", 0.5 * G, 3.0)
    motion = dataclasses.replace(ground, vertical=up.horizontal)
    response = rock(block(2.0, 0.3), motion, accuracy=accuracy)
    assert response.scalars["outcome"][0] == 0
    assert response.scalars["N_min_over_mg"][0] == pytest.approx(1.0 - np.exp(-1.5), abs=1e-10)


def test_friction_at_an_impact():
    """Impulses: horizontal m h w (1 - eta), vertical m b w (1 + eta); Housner's eta gives 3/4 tan(alpha) or so."""
    R, tan_alpha = 2.0, 0.2
    alpha = np.arctan(tan_alpha)
    eta = 1.0 - 1.5 * np.sin(alpha) ** 2
    response = rock(block(R, tan_alpha), pulse("ricker", 3.0 * G * tan_alpha, 5.0))
    expected = (1.0 - eta) / (tan_alpha * (1.0 + eta))
    assert response.scalars["n_impacts"][0] > 0
    assert response.scalars["mu_impact"][0] == pytest.approx(expected, rel=1e-12)
    assert expected == pytest.approx(0.75 * tan_alpha, rel=0.03)


def test_a_given_friction_that_is_exceeded_lets_the_body_slide():
    body = block(2.0, 0.2)
    motion = pulse("ricker", 2.0 * G * 0.2, 8.0)
    assert rock(body, motion).scalars["outcome"][0] == 1
    needed = float(rock(body, motion).scalars["mu_required"][0])
    for mu, slides in ((needed * 0.99, True), (needed * 1.01, False)):
        given = type(body)(**{**{f: getattr(body, f) for f in body.__dataclass_fields__}, "mu": np.array([mu])})
        response = solve(make_batch(given, motion))
        assert bool(response.scalars["slide_peak"][0] > 0.0) is slides
        assert bool(response.scalars["n_slips"][0] > 0) is slides


def onset(tan_alpha: float, a: float) -> float:
    """|T|/N of a rectangle as a sudden ground acceleration a [g] begins to turn it, from T and N written out."""
    psi = (a - tan_alpha) / (4.0 / 3.0 * (1.0 + tan_alpha**2))  # angular acceleration times h/g
    return (a - psi) / (1.0 + tan_alpha * psi)


def test_friction_that_overturning_takes_ends_at_the_last_passage_of_the_equilibrium():
    """Zhang and Makris (2001): p 2.14, alpha .25, one cosine; about 2 tan(alpha) at 6 alpha g.  It is largest at uplift."""
    p, alpha = 2.14, 0.25
    t = np.tan(alpha)
    body = block(0.75 * G / p**2, t)
    a_of_2_5 = brentq(lambda a: onset(t, a) - 2.5 * t, 2.0 * t, 20.0 * t)
    for a, omega in ((4.0 * alpha, 3.0), (6.0 * alpha, 3.0), (a_of_2_5, 2.5)):
        found = rock(body, pulse("cosine", a * G, omega * p), eta=0.9).scalars
        assert found["outcome"][0] >= 2
        assert found["mu_required"][0] == pytest.approx(onset(t, a), rel=1e-9)
    assert onset(t, 6.0 * alpha) == pytest.approx(2.0 * t, rel=3e-3)
    assert found["mu_required"][0] == pytest.approx(2.5 * t, rel=1e-9)


@pytest.mark.parametrize(
    ("motion", "edges"),
    [
        (pulse("ricker", 6.0, 3.0), 0.2),  # overturns after an impact
        (pulse("half_sine", 5.0, 4.0), 0.2),  # without one
        (record(3.5 * np.sin(5.0 * np.arange(0.0, 6.0, 0.02)), 0.02), [0.2, 0.3]),
    ],
)
def test_forces_of_a_body_that_overturns_end_at_the_last_passage(motion, edges):
    """Finite differences of the centre of mass up to t_overturn; on the way to the ground it needs more."""
    body, dt = make_block(h=1.2, b=edges), 1e-4
    response = with_ground(rock(body, motion, histories=True, dt_out=dt), body, motion)
    found = response.scalars
    assert found["outcome"][0] >= 2
    passed = float(found["t_overturn"][0])
    until = {name: values[:, response.time <= passed] for name, values in response.histories.items()}
    mu, N = forces_by_finite_differences(SimpleNamespace(histories=until), body, dt)
    assert found["mu_required"][0] == pytest.approx(mu.max(), rel=5e-3)
    assert found["N_min_over_mg"][0] == pytest.approx(N.min(), rel=5e-3)
    later = {name: values[:, response.time > passed] for name, values in response.histories.items()}
    mu_later, N_later = forces_by_finite_differences(SimpleNamespace(histories=later), body, dt)
    assert N_later.min() < N.min()
    assert mu_later.max() > mu.max()


def test_a_body_that_passes_the_equilibrium_after_the_report_counts_the_whole_report():
    """A short duration: the fall is decided beyond it, and nothing of the fall is in the forces."""
    body = block(2.0, 0.2)
    whole = rock(body, pulse("half_sine", 5.0, 4.0)).scalars
    passed = float(whole["t_overturn"][0])
    cut = rock(body, pulse("half_sine", 5.0, 4.0, duration=0.9 * passed)).scalars
    assert cut["outcome"][0] >= 2
    assert cut["t_overturn"][0] > cut["t_end"][0]
    assert cut["mu_required"][0] == pytest.approx(whole["mu_required"][0], rel=1e-12)
    smooth = dataclasses.replace(body, mu=0.9 * cut["mu_required"])
    assert rock(smooth, pulse("half_sine", 5.0, 4.0, duration=0.9 * passed)).scalars["n_slips"][0] > 0


def test_a_body_let_go_beyond_the_equilibrium_never_stood():
    found = rock(block(2.0, 0.2), still(), theta_0=0.25).scalars
    assert found["outcome"][0] == 2
    assert np.isnan(found["mu_required"][0])
    assert np.isnan(found["N_min_over_mg"][0])
