"""The column on a no-tension elastic base (docs/flexible.md, F6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flexible.columns import RHO, column_batch, ricker, rock_column, scalar, sine
from frame.frames import framed
from scenes import G, peak, pulse, record

from rockcli.solvers.flexible import solve
from rockcli.solvers.frame.solver import solve as solve_frame


def test_stiff_base_tends_to_the_rigid_one():
    rigid = peak(rock_column(sine(), n=20))
    distance = [abs(peak(rock_column(sine(), n=20, kw=kw)) - rigid) for kw in (1e9, 1e10, 1e12)]
    assert distance[0] > distance[1] > distance[2]
    assert distance[2] < 2e-3


def test_energy_closes_on_an_elastic_base():
    for kw in (1e10, 1e11):
        response = rock_column(sine(), kw=kw, zeta=0.0, eta=1.0, n=20, accuracy="reference")
        assert abs(scalar(response, "energy_residual")) < 1e-5
    response = rock_column(sine(), kw=1e11, E=3e16, zeta=0.0, eta=1.0, n=5)
    assert abs(scalar(response, "energy_residual")) < 1e-6


def test_peak_does_not_depend_on_step_or_mesh():
    usual = peak(rock_column(sine(), kw=1e11, n=20))
    assert peak(rock_column(sine(), kw=1e11, n=20, accuracy="reference")) == pytest.approx(usual, rel=1e-4)
    assert peak(rock_column(sine(), kw=1e11, n=40)) == pytest.approx(usual, rel=5e-3)


def test_edge_opens_at_a_third_of_the_moment():
    """Slow load on a nearly rigid column: the edge opens at a_g = g tan(alpha)/3, all but at once on a rigid base."""
    t = np.linspace(0.0, 100.0, 1001)
    ramp = record(0.5 * G * 0.1 * t / 100.0, 0.1, duration=100.0)
    response = rock_column(ramp, kw=1e11, E=1e13, zeta=0.05, n=5)
    assert scalar(response, "t_uplift") == pytest.approx(100.0 / 1.5, rel=2e-3)
    assert scalar(rock_column(ramp, E=1e13, zeta=0.05, n=5), "outcome") == 0


def test_moment_law():
    """M = (2/3) kw b^3 theta up to theta_1 = m g/(2 kw b^2), then m g [b - sqrt(2 m g/(kw theta))/3]."""
    kw, b, m = 1e10, 2.5, 2500.0 * 250.0
    response = rock_column(sine(), kw=kw, histories=True, dt_out=0.002)
    theta, moment = response.histories["theta"][0], response.histories["M_base"][0] * m
    q = np.abs(theta)
    small = q < m * G / (2.0 * kw * b**2)
    expected = np.where(
        small, 2.0 / 3.0 * kw * b**3 * q, m * G * (b - np.sqrt(2.0 * m * G / (kw * np.maximum(q, 1e-12))) / 3.0)
    )
    live = np.isfinite(theta)
    np.testing.assert_allclose(np.abs(moment)[live], expected[live], rtol=1e-9, atol=1e-9 * m * G * b)
    assert (small & live).any()
    assert (~small & live).any()


def test_a_body_that_never_opens_loses_nothing_by_eta():
    motion = pulse("sine", 0.1 * G * 0.1, 2.0 * np.pi / 1.6)
    damped, free = (rock_column(motion, kw=1e9, zeta=0.0, eta=eta, histories=True) for eta in (0.5, 1.0))
    assert scalar(damped, "outcome") == scalar(free, "outcome") == 0
    assert scalar(free, "theta_peak") == scalar(free, "theta_dot_peak") == 0.0  # peaks are those of what has lifted
    assert scalar(damped, "n_impacts") == 0
    np.testing.assert_array_equal(damped.histories["theta"], free.histories["theta"])


def test_too_soft_a_base_is_refused():
    response = rock_column(sine(), kw=1e6)
    assert scalar(response, "outcome") == -2
    assert "soft" in response.reasons[0]


def test_partial_uplift_overturns_earlier_under_a_long_pulse():
    """T_p 4 s: 2.50 g tan(alpha) overturns on kw = 1e12 N/m³, not on the all-or-nothing base."""
    assert scalar(rock_column(ricker(2.5, 4.0), kw=1e12), "outcome") == 3
    assert scalar(rock_column(ricker(2.5, 4.0)), "outcome") == 1


@pytest.mark.parametrize("a_v", [-0.4 * G, 0.4 * G])
def test_edge_opens_at_a_third_of_the_moment_of_the_weight_there_is(a_v):
    t = np.linspace(0.0, 100.0, 1001)
    ramp = record(0.5 * G * 0.1 * t / 100.0, 0.1, duration=100.0, vertical=np.full_like(t, a_v))
    response = rock_column(ramp, kw=1e11, E=1e13, zeta=0.05, n=5)
    assert scalar(response, "t_uplift") == pytest.approx(100.0 / 1.5 * (1.0 + a_v / G), rel=2e-3)


def shaken_up_and_down(a_v: float, *, soft: float = 0.05, **how):
    """A column of 10 x 1 m whose base opens at soft alpha at rest."""
    motion = pulse("sine", 0.7, 4.0, cycles=2.0)
    motion = replace(motion, vertical=pulse("sine", a_v, 3.0, cycles=2.0).horizontal)
    kw = RHO * 10.0 * G / (2.0 * 0.5**2) / (soft * np.arctan(0.1))
    return column_batch(motion, h=5.0, E=4e9, n=3, kw=kw, **how)


@pytest.mark.parametrize("soft", [0.02, 0.05])
def test_vertical_motion_changes_the_weight_not_the_stiffness(soft):
    # the frame takes the law as a spring, without phases
    batch = shaken_up_and_down(-7.0, soft=soft, zeta=0.05)
    assert peak(solve(batch)) == pytest.approx(peak(solve_frame(framed(batch))), rel=4e-3)


@pytest.mark.parametrize("a_v", [-12.0, -7.0, 7.0, 12.0])
def test_energy_closes_where_the_weight_changes(a_v):
    response = solve(shaken_up_and_down(a_v, zeta=0.0, eta=1.0, accuracy="reference"))
    assert abs(scalar(response, "energy_residual")) < 1e-5


def test_a_base_kept_shut_by_more_than_its_weight_loses_nothing_by_eta():
    # twice the weight: the swing is beyond where the base would open at rest, and short of where it does
    heavy = record(np.full(401, G), 0.01).horizontal
    sway = replace(pulse("sine", 0.3, 4.0, cycles=2.0, duration=3.9), vertical=heavy)
    kw = RHO * 10.0 * G / (2.0 * 0.5**2) / (0.1 * np.arctan(0.1))
    response = rock_column(sway, h=5.0, E=4e9, n=3, kw=kw, zeta=0.05, eta=0.5, histories=True)
    alpha = np.arctan(0.1)
    assert 0.1 * alpha < np.nanmax(np.abs(response.histories["theta"][0])) < 0.2 * alpha
    assert scalar(response, "n_impacts") == 0
