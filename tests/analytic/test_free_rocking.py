"""Free rocking against closed forms (tables.py)."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import rock, still, unit_block
from tables import DECAY, QUARTER_LINEAR, QUARTER_NONLINEAR, REST_LINEAR, REST_NONLINEAR


@pytest.mark.parametrize("row", QUARTER_LINEAR, ids=str)
def test_quarter_period_linear(row):
    alpha = 0.1
    response = rock(
        unit_block(alpha), still(), model="linearized", theta_0=row["phi0"] * alpha, eta=0.9, histories=True
    )
    # the rounding of theta_0 itself moves the time by eps/(1 - phi0) near the equilibrium
    conditioning = 2.3e-16 / (1.0 - row["phi0"])
    assert response.impacts["t_impact"][0, 0] == pytest.approx(row["pT4"], rel=1e-12, abs=conditioning)


@pytest.mark.parametrize("p", [0.03, 1.0, 80.0])
@pytest.mark.parametrize("row", QUARTER_NONLINEAR, ids=str)
def test_quarter_period_nonlinear(row, p):
    response = rock(unit_block(row["alpha"], p), still(), theta_0=row["phi0"] * row["alpha"], eta=0.9, histories=True)
    assert p * response.impacts["t_impact"][0, 0] == pytest.approx(row["pT4"], rel=1e-11)
    assert -response.impacts["theta_dot_before"][0, 0] / p == pytest.approx(row["w_over_p"], rel=1e-11)


@pytest.mark.parametrize("model", ["rigid", "linearized"])
@pytest.mark.parametrize("row", DECAY, ids=lambda r: f"alpha={r['alpha']:.3g}")
def test_amplitude_decay(row, model):
    alpha = row["alpha"]
    expected = row["nonlinear" if model == "rigid" else "linear"]
    response = rock(
        unit_block(alpha),
        still(duration=60.0),
        model=model,
        eta=row["eta"],
        theta_0=row["phi0"] * alpha,
        histories=True,
    )
    rate = np.abs(response.impacts["theta_dot_before"][0])
    # the amplitude after impact n from the rate just before impact n + 1, by the energy
    for n, phi in zip(row["n"], expected, strict=True):
        if model == "rigid":
            theta = alpha - np.arccos(np.cos(alpha) + 0.5 * rate[n] ** 2)
        else:
            theta = alpha - np.sqrt(alpha**2 - rate[n] ** 2)
        assert theta / alpha == pytest.approx(phi, rel=1e-9)
    np.testing.assert_allclose(rate[1:30] / rate[:29], row["eta"], rtol=1e-12)


@pytest.mark.parametrize("row", REST_LINEAR[:5], ids=str)
def test_time_to_rest_linear(row):
    """The body is at rest after infinitely many impacts in finite time."""
    response = rock(
        unit_block(0.1),
        still(),
        model="linearized",
        eta=row["eta"],
        theta_0=row["phi0"] * 0.1,
        scalars=("t_end", "n_impacts"),
    )
    if row["pT"] < 20.0:
        assert response.scalars["t_end"][0] == pytest.approx(row["pT"], rel=1e-10)
    else:  # the report ends 20/p after the motion's end
        assert response.scalars["t_end"][0] == pytest.approx(20.0)


@pytest.mark.parametrize("row", REST_LINEAR, ids=str)
def test_rest_found_in_a_longer_motion(row, monkeypatch):
    """With a silent motion of sufficient length the time to rest shows in the last counted impacts."""
    from rockcli.solvers.event import solver as event

    monkeypatch.setattr(event, "MAX_IMPACTS_STORED", 40_000)  # eta = .999: every impact, not the first thousand
    response = rock(
        unit_block(0.1),
        still(duration=row["pT"] * 1.01),
        model="linearized",
        eta=row["eta"],
        theta_0=row["phi0"] * 0.1,
        histories=True,
        dt_out=row["pT"] / 1000.0,
    )
    theta = response.histories["theta"][0]
    assert np.all(theta[1001:] == 0.0)
    t = response.impacts["t_impact"][0]
    assert len(t) == response.scalars["n_impacts"][0]
    v = abs(response.impacts["theta_dot_before"][0, -1]) / 0.1
    tail = 2.0 * row["eta"] * v / (1.0 - row["eta"])
    assert t[-1] + tail == pytest.approx(row["pT"], rel=1e-10)


@pytest.mark.parametrize("row", REST_NONLINEAR, ids=str)
def test_time_to_rest_nonlinear(row):
    response = rock(unit_block(row["alpha"]), still(), eta=row["eta"], theta_0=row["phi0"] * row["alpha"])
    assert response.scalars["t_end"][0] == pytest.approx(row["pT"], rel=1e-9)


def test_undamped_free_rocking_never_rests():
    response = rock(unit_block(0.2), still(), eta=1.0, theta_0=0.1, histories=True)
    assert response.scalars["t_end"][0] == pytest.approx(20.0)
    rate = np.abs(response.impacts["theta_dot_before"][0])
    np.testing.assert_allclose(rate, rate[0], rtol=1e-13)


def test_initial_rate_is_in_the_sense_of_theta():
    up = rock(unit_block(0.2), still(), theta_dot_0=0.05, histories=True)
    down = rock(unit_block(0.2), still(), theta_dot_0=-0.05, histories=True)
    assert up.scalars["theta_peak"][0] > 0.0
    np.testing.assert_array_equal(up.histories["theta"], -down.histories["theta"])
    # energy: v^2/2 = cos(alpha - theta) - cos(alpha)
    peak = 0.2 - np.arccos(np.cos(0.2) + 0.5 * 0.05**2)
    assert up.scalars["theta_peak"][0] == pytest.approx(peak, rel=1e-11)
