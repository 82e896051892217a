"""Models 1-4, both geometries, three dampings: against an independent integration of (2.4)-(2.10)."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import SHARED, G, block, make_batch, pulse, record
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rockcli.motion.reading import read_record
from rockcli.scene.laws.damping import Damping
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT
from rockcli.solvers.event.solver import solve

R, G_ = 2.0, G


def restoring(model: str, geometry: str, alpha: float, theta: float, s: float) -> float:
    """Restoring moment over m g R, as the thesis prints it: (2.4)-(2.7), (2.9), (2.10)."""
    if geometry == "negative_stiffness":
        return np.sin(alpha * s - theta)
    if model in ("1", "4"):
        return np.sin(alpha) * s - np.sin(theta)
    return np.sin(alpha) * s - np.cos(alpha) * np.sin(theta)


def independent(model, geometry, alpha, eta, c, a_of_t, breaks, *, until):
    """Peak |theta| and whether it passes pi/2, in theta itself, DOP853 restarted at breaks and impacts.

    Not tests/reference.py, which knows the law of the block alone, not those of the springs, and no damper.
    """
    p2 = 0.75 * G_ / R
    damper = c * 3.0 / (4.0 * R**2)  # c/(m) over I_O/m
    threshold = G_ * np.tan(alpha)
    peak, s, y = 0.0, 0.0, np.zeros(2)
    edges = [*breaks, until]
    for t0, t1 in itertools.pairwise(edges):
        a = a_of_t(t0, t1)
        t = t0
        while t < t1 - 1e-15:
            if s == 0.0:
                grid = np.linspace(t, t1, 201)
                over = [np.abs(a(x)) - threshold for x in grid]
                k = next((i for i, x in enumerate(over) if x > 0.0), None)
                if k is None:
                    break
                t = t if k == 0 else brentq(lambda x: abs(a(x)) - threshold, grid[k - 1], grid[k], xtol=1e-15)
                s = -np.sign(a(grid[k]))
                y = np.array([0.0, 0.0])

            def rhs(x, u, s=s, a=a):
                drive = a(x) / G_ * np.cos(alpha) * np.cos(u[0])
                return [u[1], -p2 * (restoring(model, geometry, alpha, u[0], s) + drive) - damper * u[1]]

            def base(x, u, s=s):
                return s * u[0]

            base.terminal, base.direction = True, -1
            sol = solve_ivp(
                rhs,
                (t, t1),
                y,
                method="DOP853",
                rtol=2.3e-14,
                atol=1e-17,
                events=base,
                dense_output=True,
                max_step=0.02,
            )
            rates = s * sol.y[1]
            for i in np.flatnonzero((rates[:-1] > 0.0) & (rates[1:] <= 0.0)):
                x = brentq(lambda x: sol.sol(x)[1], sol.t[i], sol.t[i + 1], xtol=1e-15)
                peak = max(peak, abs(float(sol.sol(x)[0])))
            if np.abs(sol.y[0]).max() > 0.5 * np.pi:
                return np.inf
            if not len(sol.t_events[0]):
                y = sol.y[:, -1]
                break
            t, w = sol.t_events[0][0], sol.y_events[0][0][1]
            y, s = np.array([0.0, eta * w]), -s
            if abs(y[1]) < 1e-9 and np.abs(a(t)) < threshold:
                s = 0.0
    return peak


SCHEMES = ["none", "restitution", "dashpot"]
MODELS_1_4 = [(m, g) for m in "1234" for g in ("negative_stiffness", "corotational")]


def ours(model, geometry, tan_alpha, scheme, motion):
    body = block(R, tan_alpha)
    eta = {"restitution": "housner"}.get(scheme, 1.0)
    batch = make_batch(body, motion, eta=eta)
    coefficient = np.array([0.02]) if scheme == "dashpot" else None
    damping = Damping(scheme, batch.damping.eta, coefficient)
    return solve(replace(batch, model=model, geometry=geometry, damping=damping)), float(batch.damping.eta[0, 0])


def damper_of(scheme, alpha):
    """c/m of (3.3)."""
    return 0.02 * (alpha / 0.1) ** 2 * np.sqrt(G_) * R**1.5 if scheme == "dashpot" else 0.0


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("model", "geometry"), MODELS_1_4)
@pytest.mark.parametrize("tan_alpha", [0.1, 0.333])
def test_under_a_ricker_pulse(model, geometry, scheme, tan_alpha):
    alpha, omega_p = np.arctan(tan_alpha), 3.0 * np.pi
    a_p, T_p = 3.6 * G_ * tan_alpha, 2.0 / 3.0
    response, eta = ours(model, geometry, tan_alpha, scheme, pulse("ricker", a_p, omega_p))

    def a_of_t(t0, t1):
        def a(t):
            x = 0.5 * (omega_p * (t - 2.0 * T_p)) ** 2
            return a_p * (1.0 - x) * np.exp(-0.5 * x) if t < 4.0 * T_p else 0.0

        return a if t0 < 4.0 * T_p else (lambda t: 0.0)

    breaks = [0.0, 0.5 * T_p, T_p, 1.5 * T_p, 2.0 * T_p, 2.5 * T_p, 3.0 * T_p, 4.0 * T_p]
    peak = independent(model, geometry, alpha, eta, damper_of(scheme, alpha), a_of_t, breaks, until=5.0)
    assert response.scalars["outcome"][0] == 1
    assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(peak / alpha, abs=1e-9)


def linear(values, dt):
    """The acceleration on a piece between two samples, linear; zero after the last."""

    def a_of_t(t0, t1):
        i = round(t0 / dt)
        if i >= len(values) - 1:
            return lambda t: 0.0
        return lambda t: values[i] + (values[i + 1] - values[i]) * (t - i * dt) / dt

    return a_of_t


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(
    ("model", "geometry"), [("1", "corotational"), ("3", "corotational"), ("3", "negative_stiffness")]
)
def test_under_a_sampled_motion(model, geometry, scheme):
    tan_alpha, dt = 0.2, 0.02
    rng = np.random.default_rng(7)
    t = np.arange(150) * dt
    values = sum(rng.normal() * np.sin(rng.uniform(3.0, 15.0) * t + rng.uniform(0.0, 6.0)) for _ in range(5))
    values *= 1.6 * G_ * tan_alpha / np.abs(values).max()
    alpha = np.arctan(tan_alpha)
    response, eta = ours(model, geometry, tan_alpha, scheme, record(values, dt))

    breaks = [i * dt for i in range(len(values))]
    peak = independent(model, geometry, alpha, eta, damper_of(scheme, alpha), linear(values, dt), breaks, until=6.0)
    assert response.scalars["outcome"][0] == 1
    assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(peak / alpha, abs=1e-9)


def test_models_of_one_law_give_one_answer():
    motion = pulse("ricker", 2.0 * G_ * 0.2, 7.0)
    for one, other in (("1", "4"), ("2", "3")):
        for geometry in ("negative_stiffness", "corotational"):
            a, b = (ours(m, geometry, 0.2, "restitution", motion)[0] for m in (one, other))
            np.testing.assert_array_equal(a.scalars["theta_peak"], b.scalars["theta_peak"])


@pytest.mark.parametrize(("model", "critical"), [("1", 0.0996686524911620), ("3", 0.100167421161559796)])
def test_critical_rotation(model, critical):
    """Zero of the restoring moment: alpha for (2.9), asin(tan alpha) for (2.10)."""
    for factor, falls in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        batch = make_batch(block(R, 0.1), pulse("half_sine", 0.0, 1.0), theta_0=critical * factor)
        response = solve(replace(batch, model=model, geometry="corotational"))
        assert bool(response.scalars["outcome"][0] >= OVERTURNED_WITHOUT_IMPACT) is falls


def test_model_3_cannot_overturn_above_45_degrees():
    batch = make_batch(block(R, 1.2), pulse("half_sine", 30.0 * G_, 2.0), eta=0.9)
    response = solve(replace(batch, model="3", geometry="corotational"))
    assert response.scalars["outcome"][0] == 1
    assert np.isfinite(response.scalars["theta_peak"][0])
    rigid = solve(batch)
    assert rigid.scalars["outcome"][0] >= OVERTURNED_WITHOUT_IMPACT


@pytest.mark.parametrize(
    ("phi", "ratio"), [(0.1, 0.979500787190401849), (0.5, 0.952860421057191115), (0.9, 0.938254571323326494)]
)
def test_dashpot_energy_ratio_per_cycle(phi, ratio):
    """(3.3) on the linearized block, tan(alpha) = 0.1: loss per cycle depends on amplitude (eta^4 = 0.9419)."""
    body = block(R, 0.1)
    alpha = float(body.alpha[0, 0])
    batch = make_batch(body, pulse("half_sine", 0.0, 1.0), theta_0=phi * alpha, eta=1.0, histories=True, dt_out=1e-4)
    batch = replace(batch, model="linearized", damping=Damping("dashpot", batch.damping.eta, np.array([0.02])))
    response = solve(batch)
    theta, rate = response.histories["theta"][0], response.histories["theta_dot"][0]
    turns = np.flatnonzero((rate[:-1] < 0.0) & (rate[1:] >= 0.0))  # negative peaks
    turns_up = np.flatnonzero((rate[:-1] > 0.0) & (rate[1:] <= 0.0))
    assert len(turns) > 0
    i = turns_up[0] if turns_up[0] > 0 else turns_up[1]
    fine = theta[i - 2 : i + 3].max() / alpha  # amplitude after one cycle
    energy = 1.0 - (1.0 - fine) ** 2
    start = 1.0 - (1.0 - phi) ** 2
    assert energy / start == pytest.approx(ratio, rel=2e-5)
    assert abs(response.scalars["energy_residual"][0]) < 1e-9


RECORDS = Path(__file__).resolve().parents[2] / "records"
REAL = SHARED / "records" / "peer"
FILES = [RECORDS / "synthetic_rock_m65.AT2", RECORDS / "synthetic_pulse_m70.AT2"] + (
    [REAL / "RSN1106_KOBE_KJM000.AT2", REAL / "RSN729_SUPER.B_B-IVW360.AT2"] if REAL.is_dir() else []
)


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(
    ("model", "geometry"), [("1", "corotational"), ("3", "corotational"), ("4", "negative_stiffness")]
)
@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_under_a_record(path, model, geometry, scheme):
    """Fifteen seconds about the strongest shaking, scaled to 1.8 g tan(alpha); the three distinct laws of models 1-4."""
    tan_alpha = 0.2
    motion = read_record(path)
    values, dt = np.asarray(motion.acceleration(G_)), motion.dt
    strongest = int(np.argmax(np.abs(values)))
    first = max(0, strongest - int(6.0 / dt))
    values = values[first : first + int(15.0 / dt)]
    values = values * (1.8 * G_ * tan_alpha / np.abs(values).max())
    response, eta = ours(model, geometry, tan_alpha, scheme, record(values, dt))

    alpha = np.arctan(tan_alpha)
    breaks = [i * dt for i in range(len(values))]
    peak = independent(
        model, geometry, alpha, eta, damper_of(scheme, alpha), linear(values, dt), breaks, until=breaks[-1] + 4.0
    )
    if np.isinf(peak):
        assert response.scalars["outcome"][0] >= OVERTURNED_WITHOUT_IMPACT
    else:
        assert response.scalars["outcome"][0] == 1
        assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(peak / alpha, abs=1e-9)
