"""Measures of motions with closed forms, and of a polygon integrated finely."""

from __future__ import annotations

import numpy as np
import pytest

from rockcli.motion.measures import (
    arias,
    cav,
    displacement,
    mean_period,
    measures,
    pga,
    pgd,
    pgv,
    significant_duration,
    velocity,
)


def test_constant_acceleration() -> None:
    a, dt = np.full(11, 2.0), 0.1
    assert pga(-a) == 2.0
    assert pgv(a, dt) == pytest.approx(2.0, rel=1e-14)
    assert pgd(a, dt) == pytest.approx(1.0, rel=1e-14)
    assert cav(a, dt) == pytest.approx(2.0, rel=1e-14)
    assert arias(a, dt, g=9.81) == pytest.approx(np.pi / (2 * 9.81) * 4.0, rel=1e-14)
    assert significant_duration(a, dt) == pytest.approx(0.9, rel=1e-12)


def test_one_long_step_through_zero() -> None:
    # a = 1 - t on [0, 2]: v peaks at t = 1 with 1/2, returns to 0; d = t^2/2 - t^3/6 -> 2/3
    a = np.array([1.0, -1.0])
    assert pgv(a, 2.0) == pytest.approx(0.5, rel=1e-15)
    assert velocity(a, 2.0).tolist() == [0.0, 0.0]
    assert displacement(a, 2.0)[-1] == pytest.approx(2.0 / 3.0, rel=1e-15)
    assert cav(a, 2.0) == pytest.approx(1.0, rel=1e-15)
    assert arias(a, 2.0, g=1.0) == pytest.approx(np.pi / 2.0 * 2.0 / 3.0, rel=1e-15)


def test_displacement_peaks_between_samples() -> None:
    # a = 1 - t on [0, 3], then back: v = t - t^2/2 passes zero at t = 2, inside the step, where d = 2/3 is greatest
    assert pgd(np.array([1.0, -2.0]), 3.0) == pytest.approx(2.0 / 3.0, rel=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_against_fine_integration(seed: int) -> None:
    rng = np.random.default_rng(seed)
    coarse, dt, fine = rng.standard_normal(40), 0.05, 2000
    t = np.linspace(0.0, 39 * dt, 39 * fine + 1)
    a = np.interp(t, np.arange(40) * dt, coarse)
    step = t[1]
    v = np.concatenate(([0.0], np.cumsum(0.5 * step * (a[:-1] + a[1:]))))
    d = np.concatenate(([0.0], np.cumsum(0.5 * step * (v[:-1] + v[1:]))))
    assert pgv(coarse, dt) == pytest.approx(np.abs(v).max(), rel=1e-6)
    assert pgd(coarse, dt) == pytest.approx(np.abs(d).max(), rel=1e-6)
    assert cav(coarse, dt) == pytest.approx(0.5 * step * np.sum(np.abs(a[:-1]) + np.abs(a[1:])), rel=1e-6)
    assert arias(coarse, dt) == pytest.approx(np.pi / 19.62 * step * np.sum(a * a), rel=1e-3)
    husid = np.concatenate(([0.0], np.cumsum(0.5 * step * (a[:-1] ** 2 + a[1:] ** 2))))
    grown = np.interp([0.05 * husid[-1], 0.95 * husid[-1]], husid, t)
    assert significant_duration(coarse, dt) == pytest.approx(grown[1] - grown[0], rel=1e-6)


def test_significant_duration_within_one_step() -> None:
    # a = 1 - t on [0, 1]: the integral of its square is (1 - (1 - t)^3)/3
    expected = 0.95 ** (1.0 / 3.0) - 0.05 ** (1.0 / 3.0)
    assert significant_duration(np.array([1.0, 0.0]), 1.0) == pytest.approx(expected, rel=1e-14)
    assert significant_duration(np.array([0.0, 1.0]), 1.0) == pytest.approx(expected, rel=1e-14)
    assert significant_duration(np.array([0.0, 0.0, 1.0, 0.0, 0.0]), 1.0) == pytest.approx(
        2.0 - 2.0 * 0.1 ** (1.0 / 3.0), rel=1e-14
    )


def test_mean_period_of_a_sine() -> None:
    t = 0.01 * np.arange(2000)
    assert mean_period(np.sin(2.0 * np.pi * 2.0 * t), 0.01) == pytest.approx(0.5, rel=1e-10)


def test_mean_period_counts_twenty_hertz_at_every_length() -> None:
    """Half of the power at 20 Hz, half at 10 Hz: whole cycles of both, of which 4440 samples make 20.000000000000004 Hz."""
    for n in (4400, 4440, 4480):
        t = 0.005 * np.arange(n)
        assert mean_period(np.sin(40.0 * np.pi * t) + np.sin(20.0 * np.pi * t), 0.005) == pytest.approx(0.075, rel=1e-9)


def test_mean_period_of_steps_of_nanoseconds_is_that_of_an_impulse() -> None:
    """All frequencies from .25 to 20 Hz, .05 Hz apart, have the same amplitude."""
    f = np.arange(5, 401) / 20.0
    for dt in (1e-9, 1e-6, 4e-6):
        assert mean_period(np.array([0.0, 1.0, 2.0, 1.0]), dt) == pytest.approx(np.mean(1.0 / f), rel=1e-5)


def test_mean_period_does_not_know_where_a_short_record_ends() -> None:
    a, dt = np.array([0.0, 3.0, 1.0, -2.0, 0.0]), 0.1
    longer = [mean_period(np.concatenate([a, np.zeros(more)]), dt) for more in (0, 20, 100, 195)]
    assert longer == pytest.approx([longer[0]] * 4, rel=1e-12)
    f = np.linspace(0.25, 5.0, 20_001)  # up to the highest frequency of the samples
    power = np.abs(np.exp(-2j * np.pi * np.outer(f, dt * np.arange(5))) @ a) ** 2
    assert longer[0] == pytest.approx(float(np.sum(power / f) / np.sum(power)), rel=2e-2)


def test_nothing_moves() -> None:
    found = measures(np.zeros(9), 0.1)
    assert np.isnan(found.pop("t_mean"))
    assert set(found.values()) == {0.0}
