"""Bodies whose centre of mass is not over the middle of the base."""

from __future__ import annotations

import numpy as np
import pytest
from reference import body_of, integrate
from scenes import G, block, make_batch, overturns, pulse, record, rock, still

import rockcli
from rockcli.scene.body.block import housner_eta, make_block
from rockcli.solvers.event import solver as event
from rockcli.solvers.general import solver as general

PEAK = "theta_peak_over_alpha"


def shaking(seed: int, n: int = 400, dt: float = 0.02) -> np.ndarray:
    """A smooth random motion of a few g."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) * dt
    return sum(rng.normal() * np.sin(rng.uniform(1.0, 9.0) * t + rng.uniform(0.0, 6.0)) for _ in range(6))


def test_equal_edges_are_the_symmetric_body_bit_for_bit():
    twice = make_block(h=1.3, b=[0.27, 0.27])
    once = make_block(h=1.3, b=0.27)
    for field in once.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(once, field), getattr(twice, field))
    motion = record(shaking(3), 0.02)
    a, b = (rock(body, motion, histories=True) for body in (once, twice))
    np.testing.assert_array_equal(a.histories["theta"], b.histories["theta"])


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
@pytest.mark.parametrize("b", [[0.2, 0.3], [0.4, 0.22]])
def test_against_an_independent_integration(b, seed):
    body = make_block(h=1.4, b=b)
    values = shaking(seed)
    values *= 1.6 * G * body.tan_alpha.min() / np.abs(values).max()
    eta = housner_eta(body)[0]
    ours = rock(body, record(values, 0.02), histories=True)
    theirs = integrate(body_of(body, eta), values, 0.02)
    assert overturns(ours) == theirs.overturned
    n = min(5, len(theirs.t_impact))
    assert n > 0
    np.testing.assert_allclose(ours.impacts["t_impact"][0, :n], theirs.t_impact[:n], atol=1e-9)
    np.testing.assert_allclose(ours.impacts["theta_dot_before"][0, :n], theirs.w_before[:n], atol=1e-9)
    if not theirs.overturned:
        assert ours.scalars["theta_peak_over_alpha"][0] == pytest.approx(theirs.peak_over_alpha, abs=1e-9)


@pytest.mark.parametrize("backend", ["event", pytest.param("scipy", marks=pytest.mark.slow)])
@pytest.mark.parametrize(("seed", "b"), [(17, [0.4, 0.22]), (36, [0.2, 0.3]), (37, [0.4, 0.22])])
def test_the_larger_ratio_may_be_on_the_side_that_turns_less(seed, b, backend):
    """Each side's peak against an independent integration; the ratio is the larger one, the rotation the larger one."""
    body = make_block(h=1.4, b=b)
    values = shaking(seed)
    values *= 1.6 * G * body.tan_alpha.min() / np.abs(values).max()
    theirs = integrate(body_of(body, housner_eta(body)[0]), values, 0.02)
    solver = event if backend == "event" else general
    found = solver.solve(make_batch(body, record(values, 0.02), accuracy="standard")).scalars
    tolerance = 1e-9 if backend == "event" else 1e-6
    left, right = theirs.peaks[-1], theirs.peaks[1]
    alpha = body.alpha[0]
    assert (left > right) != (left / alpha[0] > right / alpha[1])
    assert found["theta_peak_left"][0] == pytest.approx(left, abs=tolerance)
    assert found["theta_peak_right"][0] == pytest.approx(right, abs=tolerance)
    assert abs(found["theta_peak"][0]) == pytest.approx(max(left, right), abs=tolerance)
    assert np.sign(found["theta_peak"][0]) == (1.0 if right > left else -1.0)
    expected = max(left / alpha[0], right / alpha[1])
    assert found["theta_peak_over_alpha"][0] == pytest.approx(expected, abs=tolerance / alpha.min())


def test_the_side_it_falls_to_is_infinite_and_the_other_is_not():
    body = make_block(h=1.0, b=[0.1, 0.4])
    found = rock(body, still(), theta_0=0.6 * body.alpha[0, 1], eta=1.0).scalars
    assert found["theta_peak_left"][0] == np.inf == found["theta_peak_over_alpha"][0]
    assert found["theta_peak_right"][0] == pytest.approx(0.6 * body.alpha[0, 1], rel=1e-15)


def test_in_a_study_the_sides_are_saved_for_asymmetric_bodies_only():
    motion = {"pulse": {"shape": "ricker", "a_p": "1.5*g*tan_alpha", "omega_p": 6}}
    case = {"block": {"h": 1.4, "b": [0.4, 0.22]}, "motion": motion}
    found = rockcli.run({"name": "sides", "case": case, "save": {"histories": True, "dt_out": 0.002}})
    theta = found["theta"].values
    for side, sign in (("left", -1.0), ("right", 1.0)):
        assert float(found[f"theta_peak_{side}"]) == pytest.approx(np.nanmax(sign * theta), rel=1e-3)
        assert found[f"theta_peak_{side}"].attrs["units"] == "rad"
    ratios = [float(found[f"theta_peak_{side}"] / found[f"alpha_{side}"]) for side in ("left", "right")]
    assert float(found["theta_peak_over_alpha"]) == max(ratios)
    alone = rockcli.run({"name": "sides", "case": case | {"block": {"h": 1.4, "b": 0.4}}})
    assert "theta_peak_left" not in alone


def test_the_worst_direction_and_limit_states_go_by_the_ratio():
    """Turned by half a turn the body of two edges answers with its other side: the worst angle is that of the ratio."""
    case = {
        "block": {"h": 1.4, "b": [0.4, 0.22]},
        "motion": {
            "record": {"file": ["synthetic_soil_m70.AT2", "synthetic_soil_m70.AT2"], "angle": 0, "pga": "0.25*g"}
        },
    }
    vary = {"motion.record.angle": [0, "pi"]}
    save = {"histories": False, "scalars": ["outcome", "theta_peak", "theta_peak_left", "theta_peak_right", PEAK]}
    found = rockcli.run({"name": "turned", "case": case, "vary": vary, "save": save})
    assert float(abs(found["theta_peak"]).max()) < np.inf
    ratios = found["theta_peak_over_alpha"].values
    assert float(found["angle_worst"]) == found["angle"].values[np.argmax(ratios)]
    largest = np.maximum(
        found["theta_peak_left"] / found["alpha_left"], found["theta_peak_right"] / found["alpha_right"]
    )
    np.testing.assert_array_equal(ratios, largest.values)
    # the motion mirrored is the body mirrored
    mirrored = rockcli.run({"name": "m", "case": case | {"block": {"h": 1.4, "b": [0.22, 0.4]}}, "save": save})
    assert float(mirrored["theta_peak_left"]) == pytest.approx(float(found["theta_peak_right"][1]), rel=1e-9)
    assert float(mirrored["theta_peak_over_alpha"]) == pytest.approx(ratios[1], rel=1e-9)


def test_impact_keeps_angular_momentum_about_the_new_edge():
    """Impulse at the new edge only: H about it is the same just before and just after."""
    h, b = 1.4, np.array([0.2, 0.35])
    body = make_block(h=h, b=b)
    I_cm = (body.inertia[0] - 1.0) * body.R[0] ** 2
    np.testing.assert_allclose(I_cm[0], I_cm[1], rtol=1e-14)
    for new in (0, 1):
        old = 1 - new
        x_old, x_new = (-b[0], b[1])[old], (-b[0], b[1])[new]
        # clockwise rate w about the old edge: velocity of the centre of mass relative to it
        w = 1.0
        velocity = w * np.array([h, -(0.0 - x_old)])
        arm = np.array([0.0 - x_new, h])
        H_before = I_cm[0] * w + (arm[1] * velocity[0] - arm[0] * velocity[1])
        H_after = (I_cm[0] + h**2 + b[new] ** 2) * housner_eta(body)[0, new]
        assert H_after == pytest.approx(H_before, rel=1e-13)


def test_free_rocking_falls_to_the_weak_side_after_an_impact():
    """Below the barrier of its own side but above that of the other: it returns, lands, and falls there."""
    body = make_block(h=1.0, b=[0.1, 0.4])
    alpha = body.alpha[0, 1]
    response = rock(body, still(), theta_0=0.6 * alpha, eta=1.0, histories=True)
    assert overturns(response)
    assert response.scalars["n_impacts"][0] == 1
    assert response.scalars["theta_peak"][0] == -np.inf
    lossy = rock(body, still(), theta_0=0.6 * alpha, eta=0.1)
    assert not overturns(lossy)


def test_each_side_has_its_own_threshold():
    body = make_block(h=1.0, b=[0.1, 0.2])
    assert rock(body, pulse("half_sine", 0.11 * G, 3.0)).scalars["outcome"][0] == 1  # turns about the left edge
    assert rock(body, pulse("half_sine", -0.11 * G, 3.0)).scalars["outcome"][0] == 0


def test_radius_of_gyration_of_a_rectangle_gives_the_rectangle():
    once, given = block(2.0, 0.2), make_block(h=1.5, b=0.3, r_g=np.sqrt((1.5**2 + 0.3**2) / 3.0))
    np.testing.assert_allclose(given.inertia, once.inertia, rtol=1e-14)
