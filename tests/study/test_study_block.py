"""The block: every sufficient pair gives the same body, and what the user gave is kept to the last bit."""

import math

import numpy as np
import pytest

from rockcli.errors import StudyError
from rockcli.study.open import open_study

h, b = 4.0, 0.8
R, tan_alpha, alpha = math.hypot(h, b), b / h, math.atan2(b, h)


def batch_of(block, **case):
    study = open_study({"name": "a", "case": {"block": block, **case}})
    ((_, batch),) = study.batches()
    return batch


PAIRS = [
    {"R": R, "h": h},
    {"R": R, "height": 2 * h},
    {"R": R, "b": b},
    {"R": R, "width": 2 * b},
    {"R": R, "alpha": alpha},
    {"R": R, "tan_alpha": tan_alpha},
    {"R": R, "slenderness": h / b},
    {"h": h, "b": b},
    {"height": 2 * h, "width": 2 * b},
    {"h": h, "width": "160*cm"},
    {"h": h, "alpha": alpha},
    {"h": h, "tan_alpha": tan_alpha},
    {"height": 2 * h, "slenderness": h / b},
    {"b": b, "alpha": alpha},
    {"width": 2 * b, "tan_alpha": tan_alpha},
    {"b": b, "slenderness": h / b},
    {"h": h, "b": [b, b]},
    {"R": R, "b": [b, b]},
]


@pytest.mark.parametrize("pair", PAIRS, ids=["-".join(p) for p in PAIRS])
def test_every_sufficient_pair_is_the_same_body(pair):
    block = batch_of(pair).block
    close = {"rtol": 1e-14, "atol": 0.0}
    np.testing.assert_allclose(block.h, h, **close)
    np.testing.assert_allclose(block.b, b, **close)
    np.testing.assert_allclose(block.R, R, **close)
    np.testing.assert_allclose(block.tan_alpha, tan_alpha, **close)
    np.testing.assert_allclose(block.alpha, alpha, **close)
    np.testing.assert_allclose(block.inertia, 4 / 3, **close)
    np.testing.assert_allclose(block.top, 2 * h, **close)


@pytest.mark.parametrize(
    "sizes",
    [
        {"height": 1.9, "width": 0.5, "h": 0.85},
        {"height": 1.9, "width": 0.6, "depth": 0.5, "plane": "depth", "h": 0.85},
    ],
)
def test_a_centre_of_mass_not_at_half_the_height_is_told_how(sizes):
    with pytest.raises(StudyError, match="h: its height above the base, beside width, r_g"):
        batch_of(sizes)
    batch_of({"h": 0.85, "width": 0.5, "r_g": 0.57, "top": 1.9})


@pytest.mark.parametrize(
    "pair",
    [
        ("R", "h"),
        ("R", "b"),
        ("R", "tan_alpha"),
        ("h", "b"),
        ("b", "slenderness"),
        ("width", "slenderness"),
        ("alpha",),
    ],
)
def test_exactly_two_are_needed(pair):
    values = {"R": R, "h": h, "b": b, "tan_alpha": tan_alpha, "slenderness": h / b, "width": 2 * b, "alpha": alpha}
    given = {key: values[key] for key in pair}
    if len(given) == 1:
        with pytest.raises(StudyError, match="under-determined"):
            batch_of(given)
        return
    batch_of(given)
    for key, value in values.items():
        if key not in given:
            with pytest.raises(StudyError, match=r"over-determined|say the same thing"):
                batch_of({**given, key: value})


@pytest.mark.parametrize("value", [0.1, 0.2, 0.333, 1 / 3, 0.7, 1.4142135])
def test_what_is_given_reaches_the_block_to_the_last_bit(value):
    batch = batch_of(
        {"R": 5.3, "tan_alpha": value},
        motion={"pulse": {"shape": "sine", "a_p": "g*tan_alpha", "omega_p": 1}, "vertical": {"pulse": {
            "shape": "sine", "a_p_over_g_tan_alpha": 1, "omega_p_over_p": 1}}},
    )  # fmt: skip
    assert (batch.block.tan_alpha == value).all()
    assert (batch.block.R == 5.3).all()
    threshold = batch.g[0] * batch.block.tan_alpha[0, 0]
    assert batch.excitation.horizontal.a_p[0] == threshold
    assert batch.excitation.vertical.a_p[0] == threshold
    assert batch.excitation.vertical.omega_p[0] == batch.p[0, 0]
    assert (batch_of({"R": 1, "alpha": value}).block.alpha == value).all()


def test_equal_edges_are_the_symmetric_body_bit_for_bit():
    for extra in ({}, {"inertia": 1.5}, {"r_g": 2.0}, {"top": 3.0}):
        one = batch_of({"h": 4.3, "b": 0.77, **extra}).block
        two = batch_of({"h": 4.3, "b": [0.77, 0.77], **extra}).block
        for name in ("h", "b", "R", "alpha", "tan_alpha", "inertia", "top"):
            assert (getattr(one, name) == getattr(two, name)).all(), name


def test_an_asymmetric_body_speaks_of_its_weak_edge():
    batch = batch_of(
        {"h": 4, "b": [0.9, 0.6]},
        motion={"pulse": {"shape": "sine", "a_p": "g*tan_alpha", "omega_p": "2*p"}},
        initial={"theta": "0.5*alpha"},
    )
    assert batch.block.tan_alpha.tolist() == [[0.9 / 4, 0.6 / 4]]
    assert batch.excitation.horizontal.a_p[0] == 9.81 * (0.6 / 4)
    assert batch.excitation.horizontal.omega_p[0] == 2 * batch.p[0, 1]
    assert batch.theta_0[0] == 0.5 * batch.block.alpha[0, 1]


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"h": 4, "b": [0.9, 0.6], "inertia": 1.4}, "give r_g"),
        ({"h": 4, "b": 1, "inertia": 1.4, "r_g": 2}, "say the same thing"),
        ({"h": 4, "b": 1, "inertia": 0.9}, "at least 1"),
        ({"R": 4, "b": [0.9, 0.6]}, "needs h or height"),
        ({"tan_alpha": 0.2, "b": [0.9, 0.6]}, "needs h or height"),
        ({"h": 4, "b": [0.9]}, "left, right"),
        ({"h": 4, "b": [0.9, -1]}, "greater than 0"),
        ({"R": 4, "h": 4}, "smaller than R"),
        ({"R": 4, "width": 9}, "smaller than R"),
        ({"R": 4, "alpha": 1.6}, "below pi/2"),
        ({"R": 4, "alpha": 10}, "radians"),
        ({"h": 1e308, "b": 1e308}, "no body of finite size"),
        ({"R": 1e200, "alpha": 0.2}, "no body of finite size"),
        ({"R": 1e-320, "tan_alpha": 1e-10}, "no body of finite size"),
        ({"R": 4, "tan_alpha": 0.2, "mass": 0}, "greater than 0"),
        ({"R": 4, "tan_alpha": 0.2, "r_g": "p"}, "known only once the block is"),
        ({}, "has no size"),
    ],
)
def test_what_is_no_body(block, words):
    with pytest.raises(StudyError, match=words):
        batch_of(block)


def test_secondary_keys_may_speak_of_the_shape():
    block = batch_of(
        {"R": 5, "tan_alpha": 0.2, "r_g": "R/sqrt(3)", "top": "1.5*h", "mu": "tan_alpha", "mass": "2*t"}
    ).block
    np.testing.assert_allclose(block.inertia, 4 / 3, rtol=1e-15)
    assert block.top[0] == 1.5 * block.h[0]
    assert block.mu[0] == 0.2
    assert block.mass[0] == 2000.0


class TestDamping:
    def test_schemes(self):
        block = {"R": 2, "alpha": 0.3}
        assert (batch_of(block, damping="none").damping.eta == 1.0).all()
        np.testing.assert_allclose(batch_of(block).damping.eta, 1 - 1.5 * math.sin(0.3) ** 2, rtol=1e-15)
        assert (batch_of(block, damping={"eta": 0.9}).damping.eta == 0.9).all()
        assert (batch_of(block, damping={"eta": "housner"}).damping.eta == batch_of(block).damping.eta).all()
        assert (batch_of(block, damping={"r_energy": 0.81}).damping.eta == math.sqrt(0.81)).all()

    def test_a_negative_eta_is_clamped(self):  # and said: test_study_plausibility.py
        assert (batch_of({"R": 2, "tan_alpha": 1.5}).damping.eta == 0.0).all()
        assert (batch_of({"R": 2, "tan_alpha": 1.41}).damping.eta > 0.0).all()
