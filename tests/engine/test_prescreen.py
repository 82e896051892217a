"""The Laplace-transform pre-screen against the linearized solver, and against the equation itself."""

from __future__ import annotations

import numpy as np
import pytest
from reference import flight, symmetric
from scenes import SHARED, G, overturns, pulse, record, rock, unit_block
from scipy.integrate import quad
from tables import HALF_SINE

import rockcli
from rockcli.analysis.prescreen import Line, critical_level, future_mean, line_of_pulse
from rockcli.motion.reading import read_record
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT

ALPHA = 0.1
BODY = unit_block(ALPHA)  # p = 1


def flips(excitation_at, factor: float) -> bool:
    """Whether the linearized block overturns without impact from this factor on, to 1e-6."""
    outcomes = [
        int(
            rock(BODY, excitation_at(factor * (1.0 + e)), model="linearized", scalars=("outcome",)).scalars["outcome"][
                0
            ]
        )
        for e in (-1e-6, 1e-6)
    ]
    return outcomes[0] != OVERTURNED_WITHOUT_IMPACT and outcomes[1] == OVERTURNED_WITHOUT_IMPACT


def needed(line: Line, *, first: bool = True) -> float:
    return float(G * ALPHA / critical_level(line, np.array([1.0]), first=first)[0])


def test_future_mean_against_quadrature():
    rng = np.random.default_rng(4)
    t = np.cumsum(rng.uniform(0.01, 0.5, 30))
    a = rng.standard_normal(30)
    for p in (0.3, 2.0, 9.0):
        got = future_mean(t, a, np.array([[p]]))[0]
        for i in (0, 7, 28):
            value = quad(
                lambda s, i=i, p=p: p * np.interp(s, t, a) * np.exp(-p * (s - t[i])),
                t[i],
                t[-1],
                points=t[i + 1 : -1],
                limit=200,
            )[0]
            assert got[i] == pytest.approx(value, rel=1e-9, abs=1e-12)


def test_future_mean_of_a_long_record_of_a_small_block():
    """p t beyond what one exponential holds: a constant has the mean of itself until near its end."""
    t = np.linspace(0.0, 200.0, 4001)
    J = future_mean(t, np.ones_like(t), np.array([[12.0]]))[0]
    np.testing.assert_allclose(J, -np.expm1(-12.0 * (200.0 - t)), atol=1e-12)


@pytest.mark.parametrize("shape", ["half_sine", "sine", "cosine", "rectangular", "square_cycle"])
@pytest.mark.parametrize("omega", [1.0, 3.0])
def test_pulses_flip_at_the_prescreen(shape, omega):
    motion = pulse(shape, 1.0, omega)
    factor = needed(line_of_pulse(motion.horizontal, 0))
    assert flips(lambda f: pulse(shape, f, omega), factor)


def test_half_sine_thresholds_of_the_literature():
    for row in HALF_SINE:
        line = line_of_pulse(pulse("half_sine", 1.0, row["Omega"]).horizontal, 0)
        assert needed(line) == pytest.approx(row["A"] * G * ALPHA, rel=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_an_uneven_push_flips_at_the_prescreen_unless_the_block_comes_back(seed):
    """A sampled motion that pushes one way until it is over."""
    a = (1.0 + 0.3 * np.random.default_rng(seed).uniform(-1.0, 1.0, 60)) * np.hanning(60)
    factor = needed(Line(0.05 * np.arange(60), a))
    assert flips(lambda f: record(a, 0.05, factor=f), factor) != comes_back(a, 0.05, factor * (1.0 + 1e-6))


def test_worst_excursion_is_that_of_the_larger_pulse_alone():
    """A weak shake long before a strong one: the block rests in between."""
    t = 0.01 * np.arange(1600)
    strong = np.where((t >= 12.0) & (t <= 14.0), np.sin(0.5 * np.pi * (t - 12.0)), 0.0)
    weak = np.where((t >= 1.0) & (t <= 1.2), 0.9 * np.sin(5.0 * np.pi * (t - 1.0)), 0.0)
    alone, both = Line(t, strong), Line(t, weak + strong)
    assert needed(both, first=False) == pytest.approx(needed(alone), rel=1e-12)
    assert flips(lambda f: record(strong, 0.01, factor=f), needed(both, first=False))
    assert needed(both) > needed(alone)


RECORDS = sorted((SHARED / "records/peer/p695_far_field").glob("*.AT2"))


def comes_back(a: np.ndarray, dt: float, factor: float) -> bool:
    """Whether the forced linear block returns to theta = 0 after its first uplift, by general integration."""
    t, f = dt * np.arange(len(a)), factor * a / G
    i = int(np.argmax(np.abs(f) > ALPHA))
    side = int(np.sign(f[i]))
    t_u = t[i - 1] + dt * (ALPHA - side * f[i - 1]) / (side * (f[i] - f[i - 1]))
    how = {"linear": True, "fallen": 50.0 * ALPHA, "rtol": 1e-11, "atol": 1e-13, "max_step": dt}
    ground = lambda now: np.interp(now, t, f, right=0.0)  # noqa: E731
    found = flight(symmetric(ALPHA, 1.0, 1.0), -side, np.zeros(2), (t_u, t[-1] + 40.0), ground, **how)
    return bool(len(found.t_events[0]))


@pytest.mark.slow
@pytest.mark.skipif(not RECORDS, reason="the recorded motions are not here")
@pytest.mark.parametrize("path", RECORDS[::6], ids=lambda p: p.stem[-12:])
def test_recorded_excursions_flip_at_the_prescreen_unless_the_block_comes_back(path):
    """Cut just before its worst excursion, a record has it for its first uplift."""
    motion = read_record(path)
    a, dt = motion.acceleration(G), motion.dt
    level = critical_level(Line(dt * np.arange(len(a)), a), np.array([1.0]), first=False)[0]
    rises = np.flatnonzero((np.abs(a[1:]) >= level * (1 - 1e-9)) & (np.maximum(a[:-1] * np.sign(a[1:]), 0.0) < level))
    tails = [np.r_[np.clip(a[i], -0.99 * level, 0.99 * level), a[i + 1 :]] for i in rises]
    levels = [critical_level(Line(dt * np.arange(len(x)), x), np.array([1.0]))[0] for x in tails]
    tail, factor = tails[int(np.argmax(levels))], G * ALPHA / max(levels)
    assert max(levels) >= 0.9 * level  # the straight line to the clipped value is steeper or flatter than the record's
    assert flips(lambda f: record(tail, dt, factor=f), factor) != comes_back(tail, dt, factor * (1.0 + 1e-6))


def test_the_search_writes_both_and_they_agree_with_it():
    data = rockcli.run(
        {
            "name": "x",
            "case": {
                "block": {"R": 0.75 * G, "alpha": ALPHA},
                "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 5.0}},
                "model": "linearized",
                "damping": "none",
            },
            "vary": {
                "motion.pulse.omega_p": [1.0, 2.0, 4.0],
                "motion.pulse.a_p": {"from": 0.5, "to": 12.0, "n": 24, "find": "overturning"},
            },
        }
    )
    found = data["motion_pulse_a_p_overturning"].values
    for end in ("prescreen", "prescreen_worst"):
        np.testing.assert_allclose(data[f"motion_pulse_a_p_overturning_{end}"].values, found, rtol=1.1e-6)
    assert overturns(rock(BODY, pulse("half_sine", found[0], 1.0), model="linearized"))


def test_it_says_nothing_of_bodies_that_roll():
    rolls = {"outline": [[-0.1, 0], [0.1, 0], [0.3, 0.1], [0.2, 2], [-0.2, 2], [-0.3, 0.1]]}
    made = {"motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 5.0}}}
    search = {"motion.pulse.a_p": {"from": 0.5, "to": 12.0, "n": 5, "find": "overturning"}}
    for block, told in ((rolls, False), (rolls | {"stands": "toes"}, True)):
        data = rockcli.run({"case": made | {"block": block}, "vary": search})
        assert np.isfinite(data["motion_pulse_a_p_overturning_prescreen"].values).all() == told
