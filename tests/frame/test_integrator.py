"""The integrator itself: spectral radius (truth C17), divided steps, clear failures."""

from __future__ import annotations

import numpy as np
import pytest
from frame.frames import column, framed, ricker
from scenes import peak

from rockcli.errors import SolverError
from rockcli.kernels.frame import layout as at
from rockcli.solvers.frame.base import fibres
from rockcli.solvers.frame.case import case_of
from rockcli.solvers.frame.solver import load, solve


def spectral_radius(alpha_d: float, omega_dt: float) -> float:
    """Of the step kernel itself, on a column of model 2 standing on a spring that does not yield."""
    kernel = load()
    case = case_of(framed(ricker("2", "negative_stiffness"), method="linear"), 0, kernel)
    par, s = case.par.copy(), case.structure
    par[at.BASE], par[at.YIELD_ROTATION], par[at.ALPHA_D], par[at.TOLERANCE] = at.PLASTIC, 1e3, alpha_d, 1e300
    inertia = s.mass[5, 0]
    par[at.BENDING] *= 1e-8  # soft enough for the condition of the problem
    par[at.AXIAL] *= 1e-8
    bending, L = par[at.BENDING], s.length
    # the base node has no mass: spring and column in series, seen from the rotation of the top, which nothing holds
    flexibility = 1.0 / (par[at.YIELD_MOMENT] / 1e3) + L / bending
    h = omega_dt * np.sqrt(inertia * flexibility)
    N = 6
    work, bands, B = np.zeros((at.N_ROWS, N)), np.zeros((at.N_BANDS, N, at.BAND)), np.zeros((3, 6))
    columns = []
    for j in range(3):
        u, v, a = np.zeros(N), np.zeros(N), np.zeros(N)
        state = np.zeros(3)
        state[j] = 1.0
        # amplitudes of the mode: the top turns by 1, its base and its displacement follow statically
        mode = np.zeros(N)
        base = 1.0 / (par[at.YIELD_MOMENT] / 1e3) / flexibility
        mode[2], mode[5] = base, 1.0
        mode[3] = L * 0.5 * (base + 1.0)
        u[:], v[:], a[:] = mode * state[0], mode * state[1] / h, mode * state[2] / h**2
        done = kernel.steps.step(
            par, 1, s.mass, False, s.pull, np.zeros(N), case.fibres, h, 0.0, 0.0, u, v, a, work, bands, B
        )
        assert done > 0
        columns.append([u[5], v[5] * h, a[5] * h**2])
    return float(np.abs(np.linalg.eigvals(np.array(columns).T)).max())


@pytest.mark.parametrize(
    ("alpha_d", "omega_dt", "rho"),
    [
        (0.95, 0.01, 0.999999999943596831),
        (0.95, 0.1, 0.999999439005327318),
        (0.95, 1.0, 0.996489668400043514),
        (0.95, 10.0, 0.913168287395014896),
        (0.95, 1e6, 0.904761904762813435),
        (1.0, 0.1, 1.0),
        (1.0, 1.0, 1.0),
        (1.0, 1e3, 1.0),
        (0.7, 1e6, 0.7 / 1.3),
    ],
)
def test_spectral_radius(alpha_d, omega_dt, rho):
    assert spectral_radius(alpha_d, omega_dt) == pytest.approx(rho, abs=2e-6)


def test_most_dissipation():
    # the roots at infinity meet: a double root, told to the square root of the precision
    assert spectral_radius(2.0 / 3.0, 1e6) == pytest.approx(0.5, abs=1e-3)


def test_a_step_that_fails_is_divided():
    batch = framed(column(n=5, mass="lumped", eta=0.985), dt=1e-2, yield_rotation=1e-10)
    response = solve(batch)
    assert int(response.used["divided_steps"]) > 0
    assert peak(response) == pytest.approx(0.6245, abs=0.02)


def test_what_cannot_be_solved_says_when_and_why():
    response = solve(framed(ricker("4", "corotational"), rtol=1e-22))  # no rotation can be told to 1e-22
    assert response.scalars["outcome"][0] == -2
    assert "did not converge at t = " in response.reasons[0]
    assert np.isnan(response.scalars["theta_peak_over_alpha"][0])


def test_what_the_elements_do_not_know_is_refused():
    with pytest.raises(SolverError, match="method"):
        solve(framed(ricker("3", "corotational"), method="rk4"))
    with pytest.raises(SolverError, match="linear"):
        solve(framed(ricker("3", "corotational"), method="linear"))
    with pytest.raises(SolverError, match="yield_rotation"):
        solve(framed(ricker("3", "corotational"), yield_rotation=1e-3))
    for E in (1e3, 1e8):  # upright it would be in equilibrium
        with pytest.raises(SolverError, match=r"buckles under itself.*1\.8775e\+08 Pa"):
            solve(framed(column(E=E)))


def test_fibres_hold_the_whole_base():
    for place in ("corners", "middles"):
        x, share = fibres(0.5, 1e9, 7, place=place).T
        assert share.sum() == pytest.approx(1e9)
        assert x.sum() == pytest.approx(0.0, abs=1e-12)
    assert fibres(0.5, 1.0, 7)[-1, 0] == 0.5
    assert fibres(0.5, 1.0, 7, place="middles")[-1, 0] == pytest.approx(0.5 * (1.0 - 1.0 / 7.0))


def test_model_in_rest_is_an_equilibrium():
    # a column standing under its weight and a motion below uplift vibrates, no more
    response = solve(framed(column(amplitude=0.05, eta=0.985)))
    assert response.scalars["outcome"][0] == 0
    assert response.scalars["theta_peak"][0] == 0.0
