"""PGA and PGV of the motion used: closed forms, and fine integration of what `duration` cuts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rockcli
from rockcli.analysis.measures import peaks, peaks_of_both_signs
from rockcli.scene.ground.excitation import Pulses, Samples, acceleration
from rockcli.scene.ground.pulses import SHAPES, make_pulses

A, W = 7.0, 3.0 * np.pi
T = 2.0 * np.pi / W
EXACT = 1e-12


def pulse(shape: str, a_p: float = A, omega_p: float = W, **options: float) -> Pulses:
    more = {name: np.array([value]) for name, value in options.items()}
    return make_pulses(shape, a_p=np.array([a_p]), omega_p=np.array([omega_p]), **more)


def measured(channel: Pulses | Samples, until: float = np.nan) -> tuple[float, float]:
    pga, pgv = peaks(channel, 1, np.array([until]))
    return float(pga[0]), float(pgv[0])


@pytest.mark.parametrize(
    ("shape", "options", "pgv"),
    [
        ("sine", {}, 2.0 * A / W),
        ("sine", {"cycles": 0.5}, 2.0 * A / W),
        ("sine", {"cycles": 7.3}, 2.0 * A / W),
        ("sine", {"cycles": 1e9}, 2.0 * A / W),
        ("sine", {"t0": 100.0}, 2.0 * A / W),
        ("sine", {"cycles": 0.25}, A / W),
        ("cosine", {}, A / W),
        ("half_sine", {}, 2.0 * A / W),
        ("rectangular", {}, 0.5 * A * T),
        ("square_cycle", {}, 0.5 * A * T),
        # v = (a_p/w) w tau exp(-(w tau)^2/4) is greatest at w tau = sqrt 2
        ("ricker", {}, A / W * np.sqrt(2.0) * np.exp(-0.5)),
        ("ricker_antisymmetric", {}, None),
        ("mavroeidis_papageorgiou", {"gamma": 2.3, "nu": 0.7}, None),
        ("mavroeidis_papageorgiou", {"gamma": 1.0 + 1e-9}, None),
    ],
)
def test_closed_forms(shape: str, options: dict[str, float], pgv: float | None) -> None:
    for scale, rate in ((1.0, 1.0), (1e-30, 1e-6), (1e20, 1e9)):
        motion = pulse(shape, A * scale, W * rate, **{k: v / rate if k == "t0" else v for k, v in options.items()})
        pga, found = measured(motion)
        assert pga == pytest.approx(A * scale, rel=EXACT)
        if pgv is not None:
            assert found == pytest.approx(pgv * scale / rate, rel=EXACT)


@pytest.mark.parametrize("until", [0.1, 0.4, 0.9, 1.35, 1.6, 9.0])
@pytest.mark.parametrize(
    ("shape", "options"),
    [
        ("ricker", {}),
        ("ricker", {"t0": 0.3}),
        ("ricker_antisymmetric", {}),
        ("sine", {"cycles": 2.2}),
        ("cosine", {"t0": 0.2}),
        ("mavroeidis_papageorgiou", {"gamma": 3.1, "nu": 0.7}),
        ("mavroeidis_papageorgiou", {"gamma": 1.5, "nu": 1.6, "t0": 0.1}),
    ],
)
def test_cut_pulses_against_fine_integration(shape: str, options: dict[str, float], until: float) -> None:
    motion = pulse(shape, **options)
    pieces = motion.table[0]
    largest = fastest = v = 0.0
    for begin, end in pieces[:, :2]:
        end = min(end, until)
        if end <= begin:
            continue
        t = np.linspace(begin, end, 400_001)
        t[-1] = np.nextafter(end, begin)
        a = acceleration(motion, t)
        path = v + np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (a[1:] + a[:-1]))])
        largest, fastest, v = max(largest, np.abs(a).max()), max(fastest, np.abs(path).max()), path[-1]
    pga, pgv = measured(motion, until)
    assert pga == pytest.approx(largest, rel=1e-9, abs=1e-12)
    assert pgv == pytest.approx(fastest, rel=1e-9, abs=1e-12)


def test_many_cases_are_measured_as_one_by_one() -> None:
    rng = np.random.default_rng(1)
    a_p, omega_p, until = rng.uniform(1, 9, 60), rng.uniform(1, 20, 60), rng.uniform(0.1, 9, 60)
    until[::3] = np.nan
    for shape, options in (("ricker", {}), ("mavroeidis_papageorgiou", {"gamma": 2.0, "nu": 0.3})):
        more = {name: np.full(60, value) for name, value in options.items()}
        many = peaks(make_pulses(shape, a_p=a_p, omega_p=omega_p, **more), 60, until)
        for i in range(60):
            one = measured(pulse(shape, a_p[i], omega_p[i], **options), until[i])
            assert (many[0][i], many[1][i]) == pytest.approx(one, rel=1e-9)


def test_a_cut_record() -> None:
    rng = np.random.default_rng(2)
    values, dt = rng.standard_normal(40), 0.05
    record = Samples(values, dt, np.array([-2.0]), measures={"pga": 5.0, "pgv": 6.0})
    assert measured(record) == (10.0, 12.0)
    assert measured(record, 39 * dt) == (10.0, 12.0)
    for until in (0.02, 0.05, 0.777, 1.3, 1.949):
        knots = np.arange(40) * dt
        t = np.unique(np.concatenate([np.linspace(0.0, until, 1_000_001), knots[knots < until]]))
        a = np.interp(t, knots, values)
        v = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (a[1:] + a[:-1]))])
        assert measured(record, until) == pytest.approx((2 * np.abs(a).max(), 2 * np.abs(v).max()), rel=1e-9)


def test_the_dataset_has_those_of_the_motion_used() -> None:
    motion: dict[str, Any] = {"pulse": {"shape": "sine", "a_p": 3.0, "omega_p": 2.0}, "duration": 0.4}
    study = {"name": "cut", "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": motion}}
    found = rockcli.run(study)
    assert float(found["pga"]) == pytest.approx(3.0 * np.sin(0.8), rel=EXACT)
    assert float(found["pgv"]) == pytest.approx(1.5 * (1.0 - np.cos(0.8)), rel=EXACT)


def test_largest_accelerations_of_both_signs():
    """Of records up to a time between samples and turned round, and of every pulse, against many points of it."""
    values = np.array([0.0, 1.0, -2.0, 0.5, 3.0, 0.0])
    record = Samples(values, 0.1, np.array([1.0, -2.0, 1.0, 3.0]), "record", (), {})
    found = peaks_of_both_signs(record, 4, np.array([np.nan, 0.15, 0.35, 9.0]))
    np.testing.assert_allclose(found, [[3.0, 2.0], [1.0, 2.0], [1.75, 2.0], [9.0, 6.0]], rtol=1e-12)
    options = {"mavroeidis_papageorgiou": {"gamma": np.array([1.6, 2.5]), "nu": np.array([0.7, 2.0])}}
    until = np.array([np.nan, 1.3])
    for shape in SHAPES:
        pulses = make_pulses(shape, a_p=np.array([2.0, 3.0]), omega_p=np.array([4.0, 7.0]), **options.get(shape, {}))
        found = peaks_of_both_signs(pulses, 2, until)
        for i in range(2):
            t = np.linspace(0.0, np.nanmin([pulses.end[i], until[i]]) * (1.0 - 1e-12), 200_001)
            a = acceleration(pulses, t, i)
            np.testing.assert_allclose(found[i], [max(a.max(), 0.0), max(-a.min(), 0.0)], rtol=1e-7, atol=1e-9)
