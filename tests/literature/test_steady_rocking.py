"""Steady rocking under a harmonic acceleration: the closed forms of two studies against an integration of half a cycle.

The formulas are those in the heads of studies/literature/{spanos_koh,hogan}_*.yaml, of the linearized block in units of p
and alpha.  Half a cycle maps the phase of the ground at an impact and the velocity after it onto those at the next one.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rockcli

STUDIES = Path(__file__).resolve().parents[2] / "studies" / "literature"


@pytest.fixture(scope="module")
def fifty_cycles():
    return rockcli.run(STUDIES / "spanos_koh_1984.yaml")


def steady(Omega, A, eta):
    """Phase of the ground at an impact and the velocity u after it: the larger root."""
    t, k = np.tanh(0.5 * np.pi / Omega), A / (1.0 + Omega**2)
    x, y = 0.5 * t * (1.0 - eta) / eta, 0.5 * (1.0 + eta) / eta
    u = np.roots([x**2 + (y / Omega) ** 2, -2.0 * y * t / Omega**2, (t / Omega) ** 2 - k**2]).max()
    return np.arctan2((y * u - t) / Omega, x * u), u


def limits(Omega, eta):
    """Amplitudes below which there is no steady state, and above which it is unstable."""
    t, C = np.tanh(0.5 * np.pi / Omega), np.cosh(np.pi / Omega)
    first = (1.0 + Omega**2) * t**2 * (1.0 - eta) / np.hypot(t * (1.0 - eta) * Omega, 1.0 + eta)
    rest = 0.5 * ((1.0 + C) * (1.0 + eta) - (C - 1.0) * (1.0 - eta) * (eta - Omega**2 * (1.0 - eta)))
    u = (1.0 + C) * t * eta * (1.0 + eta) / (eta * C - 2.0 - eta**2 + rest)
    x, y = 0.5 * t * u * (1.0 - eta) / eta, 0.5 * u * (1.0 + eta) / eta - t
    return first, (1.0 + Omega**2) * np.hypot(x, y / Omega)


def half_cycle(Omega, A, eta, phase, u):
    """Phase and velocity after the next impact, and the largest rotation on the way."""

    def impact(t, y):
        return y[0]

    impact.terminal, impact.direction = True, -1.0

    def top(t, y):
        return y[1]

    top.direction = -1.0
    found = solve_ivp(
        lambda t, y: (y[1], y[0] - 1.0 + A * np.cos(Omega * t + phase)),
        (0.0, 9.0),
        (0.0, u),
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
        events=(impact, top),
    )
    t, (_, before) = found.t_events[0][-1], found.y_events[0][-1]
    return np.array([phase + Omega * t - np.pi, -eta * before]), found.y_events[1][:, 0].max()


def multipliers(Omega, A, eta):
    """How a small deviation of phase and velocity grows in half a cycle."""
    state, step = np.array(steady(Omega, A, eta)), 1e-5
    sides = [
        (half_cycle(Omega, A, eta, *(state + d))[0], half_cycle(Omega, A, eta, *(state - d))[0])
        for d in step * np.eye(2)
    ]
    return np.sort_complex(np.linalg.eigvals(np.column_stack([(a - b) / (2.0 * step) for a, b in sides])))


@pytest.mark.parametrize(("Omega", "A", "eta"), [(1.5, 0.3, 0.8), (3.0, 1.0, 0.9), (5.0, 4.0, 0.925), (8.0, 10.0, 0.9)])
def test_the_steady_state_returns_to_itself(Omega, A, eta, fifty_cycles):
    state = np.array(steady(Omega, A, eta))
    after, peak = half_cycle(Omega, A, eta, *state)
    np.testing.assert_allclose(after, state, atol=1e-10)
    case = f"Omega {Omega:g}, A {A:g}".replace("0.", ".")
    found = fifty_cycles.sel(case=case)
    assert float(found["theta_peak_over_alpha"]) == pytest.approx(peak, rel=1e-9)
    assert float(found["theta_dot_peak"]) == pytest.approx(0.1 * state[1] / eta, rel=1e-9)


def test_limits_of_the_steady_state():
    Omega, eta = 3.0, 0.9
    first, second = limits(Omega, eta)
    assert (first, second) == pytest.approx((0.1211540103, 5.2544013797), rel=1e-9)  # as in the study
    # where it begins the two roots are one, which a deviation neither leaves nor comes back to
    assert np.abs(multipliers(Omega, first * (1.0 + 1e-10), eta)).max() == pytest.approx(1.0, abs=1e-4)
    # where it ends a deviation turns round at every impact and keeps its size
    np.testing.assert_allclose(multipliers(Omega, second, eta), (-1.0, -(eta**2)), atol=1e-7)
