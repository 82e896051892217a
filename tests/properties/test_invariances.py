"""What may not change the answer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scenes import G, overturns, pulse, record, rock, still, unit_block

from rockcli.scene.response import ROCKING, UNRESOLVED

slenderness = st.floats(0.02, 0.6)
amplitude = st.floats(0.5, 6.0)
frequency = st.floats(0.3, 12.0)
shapes = st.sampled_from(
    ["sine", "cosine", "half_sine", "rectangular", "square_cycle", "ricker", "ricker_antisymmetric"]
)

FEW = settings(max_examples=25, deadline=None, derandomize=True)


def response_to(alpha, shape, A, Omega, *, p=1.0, sign=1.0, **how):
    return rock(unit_block(alpha, p), pulse(shape, sign * A * G * np.tan(alpha), Omega * p), **how)


@FEW
@given(slenderness, shapes, amplitude, frequency)
def test_mirror_symmetry_bit_for_bit(alpha, shape, A, Omega):
    right = response_to(alpha, shape, A, Omega, histories=True)
    left = response_to(alpha, shape, A, Omega, sign=-1.0, histories=True)
    np.testing.assert_array_equal(right.histories["theta"], -left.histories["theta"])
    for name in ("outcome", "n_impacts", "t_end", "mu_required", "theta_peak_over_alpha", "energy_residual"):
        np.testing.assert_array_equal(right.scalars[name], left.scalars[name])


@FEW
@given(slenderness, shapes, amplitude, frequency, st.sampled_from([1e-2, 0.3, 40.0]))
def test_size_invariance(alpha, shape, A, Omega, p):
    one, other = response_to(alpha, shape, A, Omega), response_to(alpha, shape, A, Omega, p=p)
    assert overturns(one) == overturns(other)
    if not overturns(one):
        peaks = one.scalars["theta_peak_over_alpha"][0], other.scalars["theta_peak_over_alpha"][0]
        assert peaks[1] == pytest.approx(peaks[0], rel=1e-8, abs=1e-12)


@FEW
@given(slenderness, shapes, amplitude, frequency, st.floats(0.0, 3.0))
def test_a_longer_lead_changes_nothing(alpha, shape, A, Omega, extra):
    T_p = 2.0 * np.pi / Omega
    lead = 2.0 * T_p if shape.startswith("ricker") else 0.0
    body, a_p = unit_block(alpha), A * G * np.tan(alpha)
    one = rock(body, pulse(shape, a_p, Omega))
    other = rock(body, pulse(shape, a_p, Omega, t0=lead + extra))
    assert overturns(one) == overturns(other)
    if one.scalars["outcome"][0] == 1:
        assert other.scalars["theta_peak_over_alpha"][0] == pytest.approx(
            one.scalars["theta_peak_over_alpha"][0], rel=1e-8, abs=1e-12
        )
        assert other.scalars["t_uplift"][0] - extra == pytest.approx(one.scalars["t_uplift"][0], abs=1e-9)


@FEW
@given(slenderness, st.floats(1.2, 3.0), st.integers(0, 10**6), st.integers(1, 40))
def test_zeros_before_and_after_a_record_change_nothing(alpha, A, seed, zeros):
    rng = np.random.default_rng(seed)
    values = np.convolve(rng.normal(size=150), np.ones(5) / 5.0, mode="same")
    values[0] = values[-1] = 0.0
    values *= A * G * np.tan(alpha) / np.abs(values).max()
    padded = np.concatenate([np.zeros(zeros), values, np.zeros(zeros)])
    asked = {"scalars": ("outcome", "theta_peak_over_alpha", "error_estimate")}
    one, other = (rock(unit_block(alpha), record(motion, 0.05), **asked).scalars for motion in (values, padded))
    assume(UNRESOLVED not in (one["outcome"][0], other["outcome"][0]))
    assert one["outcome"][0] == other["outcome"][0]
    if one["outcome"][0] == ROCKING:
        known = one["error_estimate"][0] + other["error_estimate"][0] + 1e-12
        assume(known < 1e-3)  # some come to rest after hundreds of impacts, which makes much of rounding
        assert abs(other["theta_peak_over_alpha"][0] - one["theta_peak_over_alpha"][0]) <= known


@FEW
@given(slenderness, st.floats(0.05, 0.95), st.floats(0.5, 30.0))
def test_time_reversal_of_undamped_rocking(alpha, phi, T):
    """eta = 1: run forward, turn the rate round, run back: the start again."""
    there = rock(unit_block(alpha), still(duration=T), theta_0=phi * alpha, eta=1.0, histories=True, dt_out=T / 64)
    theta, rate = there.histories["theta"][0, 64], there.histories["theta_dot"][0, 64]
    back = rock(
        unit_block(alpha), still(duration=T), theta_0=theta, theta_dot_0=-rate, eta=1.0, histories=True, dt_out=T / 64
    )
    assert back.histories["theta"][0, 64] == pytest.approx(phi * alpha, abs=1e-8 * alpha)


@FEW
@given(slenderness, shapes, amplitude, frequency)
def test_accuracy_levels_agree_within_their_tolerances(alpha, shape, A, Omega):
    fine = response_to(alpha, shape, A, Omega)
    if fine.scalars["outcome"][0] != 1:
        return
    for accuracy, tolerance in (("standard", 1e-7), ("draft", 1e-4)):
        rough = response_to(alpha, shape, A, Omega, accuracy=accuracy)
        if rough.scalars["outcome"][0] == 1:
            difference = rough.scalars["theta_peak_over_alpha"][0] - fine.scalars["theta_peak_over_alpha"][0]
            assert abs(difference) < tolerance


@pytest.mark.parametrize("kernels", ["interpreted", "compiled"])
def test_histories_have_no_gap_and_obey_the_energy(kernels, monkeypatch):
    monkeypatch.setenv("ROCK_KERNELS", kernels)
    response = response_to(0.2, "ricker", 2.8, 4.0, histories=True, dt_out=0.01)
    theta, t = response.histories["theta"][0], response.time
    live = np.isfinite(theta)
    assert live.all() or not live[np.argmin(live) :].any()
    assert t[live][-1] == pytest.approx(response.scalars["t_end"][0], abs=0.01)
    assert np.max(np.abs(np.diff(theta[live]))) < 0.02
    assert abs(response.scalars["energy_residual"][0]) < 1e-9
