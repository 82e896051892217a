"""sgn(theta) handed to a solver as it stands, and the thesis's Fig. 3."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import G, block, make_batch, pulse, still

from rockcli.errors import SolverError
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import NO_UPLIFT, ROCKING
from rockcli.solvers.event import solver as event
from rockcli.solvers.general.solver import solve

STEPWISE = {"backend": "scipy", "events": False}


def fig_3_errors(**how) -> list[float]:
    """sup |theta - theta_exact|/alpha of the four bodies up to 10/p after the pulse, before either overturns."""
    errors = []
    for shape, omega_p in (("ricker", 3.0 * np.pi), ("sine", 4.44 * np.pi)):
        for tan_alpha in (0.1, 0.333):
            body = block(2.0, tan_alpha)
            batch = make_batch(body, pulse(shape, 3.6 * G * tan_alpha, omega_p), eta=1.0, histories=True)
            exact = event.solve(batch)
            ours = solve(replace(batch, numerics=Numerics(backend="scipy", accuracy="draft", **how)))
            n = min(len(exact.time), len(ours.time))
            gap = np.abs(ours.histories["theta"][0, :n] - exact.histories["theta"][0, :n]) / body.alpha[0, 0]
            until = batch.excitation.horizontal.end[0] + 10.0 / batch.p[0, 0]
            until = np.fmin(until, ours.scalars["t_overturn"][0])
            errors.append(float(np.nanmax(gap[exact.time[:n] < until])))
    return errors


def test_fig_3_rk45_without_events_is_far_off():
    errors = fig_3_errors(method="RK45", events=False)
    assert all(0.07 <= error <= 1.0 for error in errors), errors


def test_fig_3_ode23s_without_events_is_near():
    errors = fig_3_errors(method="ode23s", events=False)
    assert max(errors) <= 0.07, errors


def test_fig_3_rk45_with_events_is_nearer():
    errors = fig_3_errors(method="RK45")
    assert max(errors) <= 0.02, errors


def test_naive_converges_slowly_to_the_truth():
    body = block(2.0, 0.2)
    batch = make_batch(body, pulse("sine", 3.6 * G * 0.2, 4.44 * np.pi), eta=1.0)
    exact = event.solve(batch).scalars
    ours = solve(replace(batch, numerics=Numerics(method="DOP853", rtol=1e-10, **STEPWISE))).scalars
    assert ours["outcome"] == exact["outcome"]
    np.testing.assert_allclose(ours["theta_peak_over_alpha"], exact["theta_peak_over_alpha"], rtol=1e-4)
    np.testing.assert_allclose(ours["t_uplift"], exact["t_uplift"], rtol=1e-9)
    assert ours["n_impacts"] == exact["n_impacts"]


def test_naive_stands_below_the_threshold_and_starts_where_it_is_put():
    body = block(2.0, 0.2)
    quiet = solve(make_batch_naive(body, pulse("sine", 0.99 * G * 0.2, 6.0)))
    assert quiet.scalars["outcome"][0] == NO_UPLIFT
    assert (quiet.histories["theta"] == 0.0).all()
    moved = solve(make_batch_naive(body, still(), theta_0=0.1))
    assert moved.scalars["outcome"][0] == ROCKING
    assert moved.histories["theta"][0, 0] == pytest.approx(0.1)


def make_batch_naive(body, excitation, **more):
    return replace(
        make_batch(body, excitation, eta=1.0, histories=True, **more), numerics=Numerics(method="RK45", **STEPWISE)
    )


def test_restitution_without_events_is_refused():
    batch = make_batch(block(2.0, 0.2), still(), theta_0=0.1)
    with pytest.raises(SolverError, match="restitution needs located impacts"):
        solve(replace(batch, numerics=Numerics(**STEPWISE)))


def test_unknown_method_is_refused_with_the_list():
    batch = make_batch(block(2.0, 0.2), still(), theta_0=0.1)
    with pytest.raises(SolverError, match=r"no method 'ode45'; it has RK23, RK45"):
        solve(replace(batch, numerics=Numerics(backend="scipy", method="ode45")))
