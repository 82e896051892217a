"""The Rosenbrock pair: its order, its answer on a linear problem, its stability.

By `solve_ivp` itself, as it is a method of it that is tested here, and no body.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rockcli.solvers.general.ode23s import E32, D, Hermite, Ode23s


def steps_of(fun, y0, t_end, h):
    """Fixed steps: a tolerance that accepts everything and a largest step."""
    solver = Ode23s(fun, 0.0, y0, t_end, first_step=h, max_step=h, rtol=1e3, atol=1e3)
    while solver.status == "running":
        solver.step()
    return solver.y


def test_coefficients():
    assert pytest.approx(1.0 / (2.0 + np.sqrt(2.0))) == D
    assert pytest.approx(6.0 + np.sqrt(2.0)) == E32


def test_order_two_on_a_smooth_problem():
    """y' = -2 t y^2 + cos t sin y: halving the step quarters the error."""

    def fun(t, y):
        return [-2.0 * t * y[0] ** 2 + np.cos(t) * np.sin(y[1]), y[0] - 0.3 * y[1] ** 3]

    exact = solve_ivp(fun, (0.0, 2.0), [1.0, 0.5], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    h = 2.0 / 2 ** np.arange(4, 9)
    errors = [np.abs(steps_of(fun, [1.0, 0.5], 2.0, x) - exact).max() for x in h]
    order = np.polyfit(np.log(h), np.log(errors), 1)[0]
    assert 1.9 < order < 2.15


def test_one_step_on_a_linear_problem():
    """On y' = l y a step multiplies by (1 + (1 - 2d) z)/(1 - d z)^2, z = h l; at infinity by 0 (L-stable)."""
    for z in (-0.1, -1.0, -10.0, -1e6):
        y = steps_of(lambda t, y, z=z: z * y, [1.0], 1.0, 1.0)
        assert y[0] == pytest.approx((1.0 + (1.0 - 2.0 * D) * z) / (1.0 - D * z) ** 2, rel=1e-6)


def test_oscillator_and_dense_output():
    sol = solve_ivp(
        lambda t, y: [y[1], -y[0]], (0.0, 6.0), [1.0, 0.0], method=Ode23s, rtol=1e-6, atol=1e-9, dense_output=True
    )
    t = np.linspace(0.0, 6.0, 101)
    np.testing.assert_allclose(sol.sol(t)[0], np.cos(t), atol=2e-4)
    assert sol.success
    assert sol.njev >= len(sol.t) - 1


def test_stiff_problem_in_few_steps():
    """y' = -1e6 (y - cos t): steps follow the solution, not the fast decay."""
    sol = solve_ivp(lambda t, y: -1e6 * (y - np.cos(t)), (0.0, 1.0), [0.0], method=Ode23s)
    assert len(sol.t) < 100
    np.testing.assert_allclose(sol.y[0, -1], np.cos(1.0), atol=1e-4)


def test_hermite_repeats_a_cubic():
    def f(t):
        return np.array([1.0 + t - 2.0 * t**2 + 3.0 * t**3])

    def slope(t):
        return np.array([1.0 - 4.0 * t + 9.0 * t**2])

    dense = Hermite(0.5, 2.0, f(0.5), f(2.0), slope(0.5), slope(2.0))
    np.testing.assert_allclose(dense(1.3), f(1.3), rtol=1e-14)


def test_a_solution_that_runs_away_fails_with_a_sentence():
    with np.errstate(all="ignore"):
        sol = solve_ivp(lambda t, y: y**2, (0.0, 2.0), [1.0], method=Ode23s, rtol=1e-6, atol=1e-9)
    assert not sol.success
    assert "step size" in sol.message


def test_nonsense_is_refused():
    with pytest.raises(ValueError, match="greater than 0"):
        Ode23s(lambda t, y: y, 0.0, [1.0], 1.0, rtol=0.0)
