"""The exact oscillator and the response spectrum against closed forms and an independent integration."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from reference import oscillator
from scenes import array, record

from rockcli.motion import measures, spectrum
from rockcli.motion.spectrum import displacement_spectrum, forcing, history, peaks
from rockcli.scene.ground.excitation import Samples, acceleration
from rockcli.scene.ground.pulses import make_pulses

RANDOM = np.random.default_rng(1).normal(size=40)
DT = 0.02


def rough(factor: float = 2.0) -> Samples:
    return record(np.concatenate([[0.0], RANDOM]), DT, factor=factor).horizontal


def wave(shape: str, **options):
    return make_pulses(shape, a_p=array(3.0), omega_p=array(5.0), **{k: array(v) for k, v in options.items()})


def integrated(channel, cuts, T: float, zeta: float) -> float:
    """Largest |x| of the oscillator by DOP853 under a motion that is smooth between the cuts."""

    def between(t_a, t_b):
        return lambda t: acceleration(channel, np.clip([t], t_a + 1e-13, t_b - 1e-13))[0]

    return oscillator([(t_b, between(t_a, t_b)) for t_a, t_b in pairwise(cuts)], T, zeta)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.4])
@pytest.mark.parametrize("T", [0.025, 0.3, 2.0, 30.0])
def test_record_against_an_independent_integration(T, zeta):
    channel = rough()
    expected = integrated(channel, DT * np.arange(41), T, zeta)
    assert displacement_spectrum(forcing(channel), array(T), zeta)[0] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("T", [0.2, 1.0, 5.0])
@pytest.mark.parametrize(
    ("shape", "options"),
    [
        ("sine", {"cycles": 1.25}),
        ("square_cycle", {}),
        ("ricker", {}),
        ("ricker_antisymmetric", {}),
        ("mavroeidis_papageorgiou", {"gamma": 2.0, "nu": 0.3}),
    ],
)
def test_pulse_against_an_independent_integration(shape, options, T):
    channel = wave(shape, **options)
    cuts = np.unique(channel.table[0][:, :2])
    expected = integrated(channel, cuts, T, 0.03)
    assert displacement_spectrum(forcing(channel), array(T), 0.03)[0] == pytest.approx(expected, rel=1e-8)


def test_rectangular_pulse_in_closed_form():
    # of duration d, undamped: S_d omega^2/a_p = 2 if d > T/2, else 2 sin(pi d/T)
    channel = wave("rectangular")
    d = np.pi / 5.0
    T = np.geomspace(0.05, 50.0, 200)
    expected = np.where(d > 0.5 * T, 2.0, 2.0 * np.sin(np.minimum(np.pi * d / T, 0.5 * np.pi)))
    S_d = displacement_spectrum(forcing(channel), T, 0.0)
    np.testing.assert_allclose(S_d * (2.0 * np.pi / T) ** 2 / 3.0, expected, rtol=1e-11)


def test_short_periods_give_the_peak_ground_acceleration():
    channel = rough()
    T = array([1e-4, 1e-3])
    S_a = displacement_spectrum(forcing(channel), T, 0.05) * (2.0 * np.pi / T) ** 2
    pga = 2.0 * measures.pga(channel.values)
    np.testing.assert_array_less(np.abs(S_a / pga - 1.0), [1e-3, 1e-2])


def test_long_periods_give_the_peak_ground_displacement():
    a = np.concatenate([RANDOM, -RANDOM, -RANDOM, RANDOM])  # ends at rest, near where it began
    channel = record(np.concatenate([[0.0], a, [0.0]]), DT).horizontal
    S_d = displacement_spectrum(forcing(channel), array([1e4, 1e6]), 0.05)
    np.testing.assert_array_less(np.abs(S_d / measures.pgd(channel.values, DT) - 1.0), [1e-2, 1e-4])


@pytest.mark.slow
def test_below_half_a_step_the_error_is_below_one_per_cent():
    channel = record(np.concatenate([[0.0], RANDOM[:12]]), DT).horizontal
    T = np.array([DT / 2.5, DT / 5.0, DT / 11.0])
    expected = [integrated(channel, DT * np.arange(13), float(t), 0.0) for t in T]
    ratio = displacement_spectrum(forcing(channel), T, 0.0) / expected
    assert (ratio <= 1.0 + 1e-9).all()
    assert (ratio > 0.99).all()


def test_the_same_motion_in_shorter_steps_has_the_same_spectrum():
    values = np.concatenate([[0.0], RANDOM])
    finer = np.interp(np.arange(4 * 40 + 1) / 4.0, np.arange(41), values)
    T = np.geomspace(0.03, 20.0, 50)
    coarse = displacement_spectrum(forcing(record(values, DT).horizontal), T, 0.05)
    fine = displacement_spectrum(forcing(record(finer, DT / 4.0).horizontal), T, 0.05)
    np.testing.assert_allclose(coarse, fine, rtol=1e-11)


def test_holding_less_at_a_time_changes_nothing(monkeypatch):
    T = np.geomspace(0.01, 20.0, 70)
    whole = peaks(forcing(rough()), T, 0.05)
    monkeypatch.setattr(spectrum, "_ENTRIES", 500)
    parts = peaks(forcing(rough()), T, 0.05)
    np.testing.assert_allclose(parts, whole, rtol=1e-12)


@pytest.mark.parametrize("T", [0.04, 0.7, 9.0])
def test_history_passes_through_the_peak(T):
    motion = forcing(rough())
    x, t = peaks(motion, array(T), 0.1)
    at, rate = history(motion, T, 0.1, np.array([0.0, t[0]]))
    assert at[0] == rate[0] == 0.0
    assert at[1] == pytest.approx(x[0], rel=1e-10)
    assert abs(rate[1]) < 1e-8 * abs(x[0]) * 2.0 * np.pi / T
    everywhere, _ = history(motion, T, 0.1, np.linspace(0.0, 3.0, 5001))
    assert np.max(np.abs(everywhere)) <= abs(x[0]) * (1.0 + 1e-12)
    assert peaks(forcing(rough(-2.0)), array(T), 0.1)[0][0] == -x[0]


@pytest.mark.parametrize("until", [0.5, 0.513])
def test_cut_off_motion(until):
    channel = rough()
    part = forcing(channel, until=until)
    assert part[-1].end == pytest.approx(until, rel=1e-14)
    cuts = np.append(DT * np.arange(int(until / DT + 1e-9) + 1), until)
    expected = integrated(channel, np.unique(np.round(cuts, 12)), 0.6, 0.02)
    assert displacement_spectrum(part, array(0.6), 0.02)[0] == pytest.approx(expected, rel=1e-8)


def test_damping_ratio_outside_its_range():
    for zeta in (-0.1, 1.0):
        with pytest.raises(ValueError, match="damping ratio"):
            displacement_spectrum(forcing(rough()), array(1.0), zeta)
