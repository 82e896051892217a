"""FEMA-356 [3.4]: its formulas, its roots, and how far off it is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scenes import G, array, block, make_batch, pulse, record, rock, still

from rockcli.motion.reading import read_record
from rockcli.motion.spectrum import displacement_spectrum, forcing
from rockcli.scene.ground.spectra import DesignSpectrum
from rockcli.scene.laws.damping import Damping, Fema356
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING, UNRESOLVED
from rockcli.solvers import fema356
from rockcli.solvers.fema356 import damping_ratio, rocking_period

RECORDS = Path(__file__).resolve().parents[2] / "records"
CRITICAL_S_V, CRITICAL_PHI = 0.6020423798, 0.5770293
"""Largest S_v/(p h alpha) of a flat velocity spectrum with a solution, and its amplitude: the maximum of
(pi/2) phi/arcosh(1/(1 - phi))."""


def fema(body, motion, *, w=1.0, fixed=np.nan, spectrum=None, **how):
    batch = make_batch(body, motion, **how)
    n = batch.size
    scheme = Fema356(np.full(n, w), np.full(n, fixed), spectrum)
    return fema356.solve(replace(batch, damping=Damping("fema356", np.ones((n, 2)), fema356=scheme)))


def design(shape: str, **values) -> DesignSpectrum:
    return DesignSpectrum(shape, {key: np.atleast_1d(np.asarray(v, float))[None] if isinstance(v, list) else array(v)
                                  for key, v in values.items()})  # fmt: skip


def one(response, name: str) -> float:
    return float(response.scalars[name][0])


# -- formulas -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tan_alpha", "r", "beta"),
    [
        (0.1, 0.970517596314086854, 0.00594059405940594059),
        (0.333, 0.722958935082802329, 0.0598920324172802143),
    ],
)
def test_damping(tan_alpha, r, beta):
    assert damping_ratio(4.0 / 3.0, np.arctan(tan_alpha)) == pytest.approx((r, beta), rel=1e-11)


def test_damping_is_a_fraction_of_what_impacts_take():
    # decay of free rocking over two impacts from theta_0 = 0.5 alpha: 1.4 % and 13 %
    for tan_alpha, equivalent in ((0.1, 0.0139024366531663345), (0.333, 0.130476668372315445)):
        assert 0.4 < damping_ratio(4.0 / 3.0, np.arctan(tan_alpha))[1] / equivalent < 0.5


def test_period():
    phi = np.array([1e-12, 0.3, 0.999])
    np.testing.assert_allclose(rocking_period(phi, 2.0)[1:], 2.0 * np.arccosh(1.0 / (1.0 - phi[1:])), rtol=1e-13)
    assert rocking_period(phi, 2.0)[0] == pytest.approx(2.0 * np.sqrt(2e-12), rel=1e-9)


# -- roots --------------------------------------------------------------------------------------------------


def flat(ratio: float, tan_alpha: float = 0.2, **how):
    """A 2 m block on a flat velocity spectrum S_v = ratio p h alpha."""
    body = block(2.0, tan_alpha)
    p = np.sqrt(0.75 * G / 2.0)
    S_v = ratio * p * body.h[0] * np.arctan(tan_alpha)
    return fema(body, still(), spectrum=design("flat_S_v", S_v=S_v), **how)


def listed(response) -> list[float]:
    words = response.reasons[0].split("solve it, ")[1].split(";")[0]
    return [float(word) for word in words.split(", ")]


@pytest.mark.parametrize("ratio", [0.59, 0.602, CRITICAL_S_V * (1.0 - 1e-6), CRITICAL_S_V * (1.0 - 1e-8)])
def test_flat_velocity_spectrum_has_two_solutions_below_its_critical_value(ratio):
    response = flat(ratio)
    phi = np.array(listed(response))
    assert one(response, "outcome") == ROCKING
    assert one(response, "fema_n_roots") == 2
    assert phi[0] <= CRITICAL_PHI <= phi[1]
    np.testing.assert_allclose(0.5 * np.pi * phi / np.arccosh(1.0 / (1.0 - phi)), ratio, rtol=1e-6)
    assert one(response, "theta_peak_over_alpha") == pytest.approx(phi[0], rel=1e-5)


def test_flat_velocity_spectrum_above_its_critical_value_overturns():
    response = flat(CRITICAL_S_V * (1.0 + 1e-8))
    assert one(response, "outcome") == OVERTURNED_AFTER_IMPACT
    assert one(response, "fema_n_roots") == 0
    assert one(response, "n_impacts") == -1
    assert np.isinf(one(response, "theta_peak_over_alpha"))
    assert "no solution: overturning predicted" in response.reasons[0]


def test_root_to_twelve_digits():
    # S_v at which phi is the smaller solution
    phi = 0.25
    ratio = 0.5 * np.pi * phi / np.arccosh(1.0 / (1.0 - phi))
    assert one(flat(ratio), "theta_peak_over_alpha") == pytest.approx(phi, rel=1e-11)


@cache
def synthetic(name: str):
    motion = read_record(RECORDS / f"{name}.AT2")
    return motion.acceleration(G), motion.dt


def test_several_solutions_on_a_record():
    body, motion = block(5.0, 0.2), record(*synthetic("synthetic_rock_m65"))
    response = fema(body, motion, scalars=("outcome",))
    phi = np.array(listed(response))
    assert one(response, "fema_n_roots") == len(phi) == 3
    assert one(response, "theta_peak_over_alpha") == pytest.approx(phi[0], rel=1e-5)
    p = np.sqrt(0.75 * G / 5.0)
    S_d = displacement_spectrum(forcing(motion.horizontal), rocking_period(phi, p), one(response, "fema_beta"))
    np.testing.assert_allclose(S_d, phi * np.arctan(0.2) * body.h, rtol=2e-5)  # six digits are listed


# -- the rocking potential, weight and mass ------------------------------------------------------------------


@pytest.mark.parametrize(("factor", "outcome"), [(0.99, NO_UPLIFT), (1.0, NO_UPLIFT), (1.01, ROCKING)])
def test_rocking_potential_on_the_peak_ground_acceleration(factor, outcome):
    response = fema(block(2.0, 0.2), pulse("ricker", factor * G * 0.2, 3.0 * np.pi))
    assert one(response, "outcome") == outcome
    if outcome == NO_UPLIFT:
        assert one(response, "theta_peak") == one(response, "fema_delta") == one(response, "n_impacts") == 0.0
        assert "rocking is not indicated" in response.reasons[0]


def test_just_above_the_threshold_it_leaps():
    # delta grows with S_d from the smallest amplitude on: there is no small solution; the block hardly stirs
    body, motion = block(2.0, 0.2), pulse("ricker", 1.01 * G * 0.2, 3.0 * np.pi)
    assert one(fema(body, motion), "theta_peak_over_alpha") == pytest.approx(0.149, abs=1e-3)
    assert one(rock(body, motion), "theta_peak_over_alpha") < 1e-3


def test_rocking_potential_on_the_fixed_base_period():
    # amplified at the period of the pulse, isolated far above it
    motion = pulse("sine", 0.9 * G * 0.2, 3.0 * np.pi)
    assert one(fema(block(2.0, 0.2), motion), "outcome") == NO_UPLIFT
    assert one(fema(block(2.0, 0.2), motion, fixed=0.66), "outcome") == ROCKING
    strong = pulse("sine", 1.5 * G * 0.2, 3.0 * np.pi)
    response = fema(block(2.0, 0.2), strong, fixed=10.0)
    assert one(response, "outcome") == NO_UPLIFT
    assert "S_a(10 s)" in response.reasons[0]


def test_weight_over_mass_acts_like_gravity():
    motion = pulse("ricker", 0.9 * G, 2.0 * np.pi)
    heavy, strong = fema(block(5.0, 0.2), motion, w=1.7), fema(block(5.0, 0.2), motion, g=1.7 * G)
    for name in ("theta_peak", "fema_T", "fema_beta", "fema_delta"):
        assert one(heavy, name) == pytest.approx(one(strong, name), rel=1e-10)
    assert one(fema(block(5.0, 0.2), motion, w=4.6), "outcome") == NO_UPLIFT


def test_nothing_to_go_by_is_an_error():
    with pytest.raises(fema356.SolverError, match="needs a ground motion"):
        fema(block(2.0, 0.2), still())
    with pytest.raises(fema356.SolverError, match="restitution"):
        fema356.solve(make_batch(block(2.0, 0.2), still()))


# -- what comes back -------------------------------------------------------------------------------------------


def test_amplitudes_and_history_belong_together():
    body = block(5.0, 0.2)
    response = fema(body, pulse("ricker", 3.6 * G * 0.2, 2.0 * np.pi), histories=True, dt_out=0.001)
    delta, theta = one(response, "fema_delta"), one(response, "theta_peak")
    assert one(response, "fema_u_top") == one(response, "u_top_peak") == pytest.approx(2.0 * delta, rel=1e-14)
    assert abs(theta) == pytest.approx(delta / (5.0 * np.cos(np.arctan(0.2))), rel=1e-13)
    assert theta < 0.0  # a positive pulse throws the block to the left
    histories = response.histories
    near = round(one(response, "t_peak") / 0.001)
    assert histories["theta"][0, near] == pytest.approx(theta, rel=1e-5)
    assert np.nanmax(np.abs(histories["theta"])) <= abs(theta) * (1.0 + 1e-9)
    np.testing.assert_allclose(histories["u_top"][0], 2.0 * body.h * histories["theta"][0], rtol=1e-12)
    gradient = np.gradient(histories["theta"][0], 0.001, edge_order=2)
    np.testing.assert_allclose(histories["theta_dot"][0], gradient, atol=1e-5)
    assert response.time[-1] == pytest.approx(one(response, "t_end"), abs=0.001)


def test_no_history_without_a_solution_or_a_motion():
    falling = fema(block(2.0, 0.1), pulse("ricker", 30.0, np.pi), histories=True)
    assert one(falling, "outcome") == OVERTURNED_AFTER_IMPACT
    assert np.isnan(falling.histories["theta"]).all()
    assert falling.shaken["a_g"][0] == len(falling.time)
    quiet = fema(block(2.0, 0.2), pulse("ricker", 1.0, np.pi), histories=True)
    assert (quiet.histories["theta"][np.isfinite(quiet.histories["theta"])] == 0.0).all()
    assert np.isnan(flat(0.5, histories=True).histories["theta"]).all()


def test_duration_cuts_the_motion_and_the_history():
    motion = pulse("ricker", 3.6 * G * 0.2, 2.0 * np.pi, duration=3.0)
    response = fema(block(5.0, 0.2), motion, histories=True)
    assert one(response, "t_end") == 3.0
    assert response.time[-1] <= 3.0
    assert response.shaken["a_g"][0] == len(response.time) > 500
    # cut at its peak the pulse leaves the ground moving, and the oscillator with it
    cut = fema(block(5.0, 0.2), pulse("ricker", 3.6 * G * 0.2, 2.0 * np.pi, duration=2.1))
    assert one(cut, "outcome") == OVERTURNED_AFTER_IMPACT
    assert np.isnan(one(cut, "t_end"))


def test_cases_of_a_batch_do_not_see_one_another():
    both = fema(block(5.0, 0.2), pulse("ricker", 3.6 * G * 0.2, 2.0 * np.pi))
    body = block(5.0, 0.2)
    two = replace(body, **{name: np.repeat(getattr(body, name), 2, axis=0) for name in vars(body)})
    batch = fema(two, pulse("ricker", np.array([3.6, 1.8]) * G * 0.2, np.full(2, 2.0 * np.pi)))
    assert batch.scalars["theta_peak"][0] == one(both, "theta_peak")
    assert batch.scalars["theta_peak_over_alpha"][1] < 0.35


# -- design spectra --------------------------------------------------------------------------------------------


def test_general_spectrum_of_the_code():
    spectrum = design("fema356", S_XS=10.0, S_X1=6.0)
    T = np.array([0.0, 0.06, 0.12, 0.3, 0.6, 1.0, 2.0])
    np.testing.assert_allclose(spectrum.S_a(T, 0.05), [4.0, 7.0, 10.0, 10.0, 10.0, 6.0, 3.0], rtol=1e-13)
    np.testing.assert_allclose(spectrum.S_a(T[3:], 0.20), [10.0 / 1.8, 10.0 / 1.8, 4.0, 2.0], rtol=1e-13)
    assert spectrum.S_a(array(1.0), 0.005)[0] == pytest.approx(7.5)  # below 2 %: B_1 = 0.8


def test_constant_spectrum():
    # delta = S_a T^2/4 pi^2 with S_a = c g tan(alpha): phi/arcosh(1/(1-phi))^2 falls from 1/2 to 0
    phi = 0.6
    S_a = (
        phi
        * np.arctan(0.2)
        * block(2.0, 0.2).h[0]
        * (2.0 * np.pi / rocking_period(array(phi), np.sqrt(0.375 * G))) ** 2
    )
    response = fema(block(2.0, 0.2), still(), spectrum=design("constant", S_a=S_a))
    assert S_a[0] < 0.2 * G  # so little does not lift the block, says the first step
    assert one(response, "outcome") == NO_UPLIFT
    assert (
        one(fema(block(2.0, 0.2), still(), spectrum=design("constant", S_a=2.0)), "outcome") == OVERTURNED_AFTER_IMPACT
    )


def test_table_is_not_extended():
    S_v = 0.5 * np.sqrt(0.375 * G) * block(2.0, 0.2).h[0] * np.arctan(0.2)
    T = np.geomspace(0.01, 20.0, 4000)
    whole = fema(block(2.0, 0.2), still(), spectrum=design("table", periods=list(T), S_a=list(2.0 * np.pi * S_v / T)))
    assert one(whole, "theta_peak_over_alpha") == pytest.approx(one(flat(0.5), "theta_peak_over_alpha"), rel=1e-4)
    short = 0.5 * one(whole, "fema_T") > T
    cut = design("table", periods=list(T[short]), S_a=list(2.0 * np.pi * S_v / T[short]))
    response = fema(block(2.0, 0.2), still(), spectrum=cut)
    assert one(response, "outcome") == UNRESOLVED
    assert np.isnan(one(response, "theta_peak_over_alpha"))


# -- how far off it is -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("tan_alpha", "truth", "estimate"),
    [(0.1, 0.583777, 0.350750), (0.2, 0.553693, 0.350365), (0.333, 0.498163, 0.351219)],
)
def test_ricker_on_the_five_metre_block(tan_alpha, truth, estimate):
    body, motion = block(5.0, tan_alpha), pulse("ricker", 3.6 * G * tan_alpha, 2.0 * np.pi)
    assert one(rock(body, motion), "theta_peak_over_alpha") == pytest.approx(truth, abs=1e-6)
    assert one(fema(body, motion), "theta_peak_over_alpha") == pytest.approx(estimate, abs=1e-6)


@pytest.mark.parametrize(
    ("shape", "cases", "least", "most"),
    [
        ("ricker", ((2.0, 3.0), (5.0, 2.0), (10.0, 1.4)), -0.44, -0.29),
        ("sine", ((2.0, 4.44), (5.0, 2.66), (10.0, 1.905)), 0.11, 0.66),
    ],
)
def test_errors_on_the_pulses_of_the_source(shape, cases, least, most):
    errors = []
    for R, omega in cases:
        for tan_alpha in (0.1, 0.2, 0.333):
            body, motion = block(R, tan_alpha), pulse(shape, 3.6 * G * tan_alpha, omega * np.pi)
            truth = one(rock(body, motion, accuracy="standard"), "theta_peak_over_alpha")
            errors.append(one(fema(body, motion), "theta_peak_over_alpha") / truth - 1.0)
    assert least < min(errors) < least + 0.02
    assert most - 0.02 < max(errors) < most


def test_it_can_miss_an_overturning():
    body, motion = block(2.0, 0.1), record(*synthetic("synthetic_rock_m65"))
    assert one(rock(body, motion, accuracy="standard"), "outcome") == OVERTURNED_AFTER_IMPACT
    assert one(fema(body, motion), "theta_peak_over_alpha") == pytest.approx(0.666, abs=1e-3)
