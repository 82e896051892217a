"""What the pulse lanes know of a bell beforehand: its Taylor coefficients, when it lifts a body, what is still to come."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.hermite_e import HermiteE
from scenes import G, make_batch, pulse
from scipy.integrate import quad
from scipy.optimize import brentq

import rockcli
from rockcli.scene.body.block import make_block
from rockcli.scene.ground.excitation import acceleration
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event.solver import solve

SIGNS = {2: -1.0, 3: -1.0}
"""The bells are these times the derivatives of exp(-y^2/2) of order 2 and 3."""


def derivative(m: int, y: np.ndarray) -> np.ndarray:
    """The m-th derivative of exp(-y^2/2)."""
    return (-1.0) ** m * HermiteE.basis(m)(y) * np.exp(-0.5 * y * y)


def plain(program: str) -> object:
    """What a program that uses the lanes as plain Python prints."""
    head = "import json, numpy as np; from rockcli.kernels.lanes.pulses import ground, state as s;"
    env = os.environ | {"ROCK_KERNELS": "interpreted"}
    ran = subprocess.run([sys.executable, "-c", head + program], env=env, capture_output=True, text=True, check=True)
    return json.loads(ran.stdout)


def test_coefficients():
    y, w = np.linspace(-4.0, 4.0, 16), 1.3
    for m, (even, odd) in {2: (0.7, 0.0), 3: (0.0, 0.7)}.items():
        found = plain(
            "state = np.zeros(s.STRIDE);"
            f"put = lambda field, x: state.__setitem__(slice(field * 16, field * 16 + 16), x);"
            f"y = np.linspace(-4.0, 4.0, 16); put(s.KIND, s.BELL); put(s.C1, {w}); put(s.T, y / {w});"
            f"put(s.C2, {even}); put(s.C4, {-even}); put(s.C3, {-3.0 * odd}); put(s.C5, {odd});"
            "ground.to_come(state, 0, y / 1.3); ground.expand(state, 0);"
            "a = s.series_of_a(0); print(json.dumps(state[a : a + (s.ORDER + 1) * 16].tolist()))"
        )
        found = np.reshape(found, (-1, 16))
        assert len(found) == 19
        for k in range(len(found)):
            exact = 0.7 * SIGNS[m] * w**k * derivative(m + k, y) / math.factorial(k)
            assert found[k] == pytest.approx(exact, rel=0, abs=1e-14 * max(1.0, np.abs(exact).max()))


def test_what_is_still_to_come():
    places = np.linspace(-5.0, 5.0, 16)
    for m, (even, odd) in {2: (-0.7, 0.0), 3: (0.0, 0.7)}.items():
        plus, minus = plain(
            f"plus, minus = ground.rest_of_bell(np.full(16, {even}), np.full(16, {odd}), y := np.linspace(-5.0, 5.0, 16),"
            " np.exp(-0.5 * y * y)); print(json.dumps([plus.tolist(), minus.tolist()]))"
        )
        sign = SIGNS[m] * (even + odd)
        zeros = [-math.sqrt(3.0), -1.0, 0.0, 1.0, math.sqrt(3.0)]
        for y, up, down in zip(places, plus, minus, strict=True):
            breaks = [y, *(z for z in zeros if z > y), 12.0]
            parts = [
                quad(lambda x, m=m: sign * float(derivative(m, x)), a, b, epsabs=1e-14)[0] for a, b in pairwise(breaks)
            ]
            assert up == pytest.approx(sum(x for x in parts if x > 0.0), rel=0, abs=1e-13)
            assert down == pytest.approx(-sum(x for x in parts if x < 0.0), rel=0, abs=1e-13)


@pytest.mark.parametrize("shape", ["ricker", "ricker_antisymmetric"])
def test_first_uplift(shape):
    # amplitudes around those at which the first, lower lobe begins to lift the body
    lobe = {"ricker": 2.0 * math.exp(-1.5), "ricker_antisymmetric": 1.0}[shape]
    A = np.concatenate([np.geomspace(1.001, 50.0, 8), np.array([1.0 - 1e-6, 1.0 + 1e-6, 0.9, 1.1]) / lobe])
    n, alpha = A.size, 0.2
    R = 0.75 * G
    body = make_block(h=R * np.cos(alpha), b=np.full((n, 2), R * np.sin(alpha)), R=R, alpha=alpha, n=n)
    motion = pulse(shape, A * G * np.tan(alpha), np.full(n, 3.0))
    batch = make_batch(body, motion, eta=np.full((n, 2), 0.9), accuracy="standard", scalars=("outcome", "t_uplift"))
    assert lane_pulses.asked(batch)
    found = solve(batch).scalars["t_uplift"]
    t = np.linspace(0.0, float(motion.horizontal.end[0]), 200_001)
    for case in range(n):
        a = np.abs(acceleration(motion.horizontal, t, case)) - G * np.tan(alpha)
        if not np.any(a >= 0.0):
            assert np.isnan(found[case])
            continue
        first = int(np.argmax(a >= 0.0))

        def lifts(x, case=case):
            return abs(acceleration(motion.horizontal, np.array([x]), case)[0]) - G * np.tan(alpha)

        exact = brentq(lifts, t[first - 1], t[first], xtol=1e-15)
        assert found[case] == pytest.approx(exact, rel=1e-10)


def test_another_bell_is_left_to_the_single_body_kernels():
    A, alpha = np.array([1.5, 3.0, 8.0, 0.5]), 0.2
    R = 0.75 * G
    body = make_block(h=R * np.cos(alpha), b=np.full((4, 2), R * np.sin(alpha)), R=R, alpha=alpha, n=4)
    ricker = pulse("ricker", A * G * np.tan(alpha), np.full(4, 3.0))
    table = ricker.horizontal.table.copy()
    table[:, :, 7] = 0.0  # a_p exp(-y^2/2), cut where it is 1e-17
    motion = replace(ricker, horizontal=replace(ricker.horizontal, table=table))
    scalars = ("outcome", "theta_peak_over_alpha", "t_uplift")
    batch = make_batch(body, motion, eta=np.full((4, 2), 0.9), accuracy="standard", scalars=scalars)
    assert lane_pulses.asked(batch)
    found = solve(batch).scalars
    exact = solve(replace(batch, numerics=replace(batch.numerics, accuracy="reference"))).scalars
    np.testing.assert_array_equal(found["outcome"], exact["outcome"])
    assert set(exact["outcome"]) == {0, 1, 2}
    w, t0 = table[:3, 0, 4], table[:3, 0, 3]
    assert found["t_uplift"][:3] == pytest.approx(t0 - np.sqrt(2.0 * np.log(A[:3])) / w, rel=1e-12)
    assert found["theta_peak_over_alpha"] == pytest.approx(exact["theta_peak_over_alpha"], rel=1e-9)


@pytest.mark.parametrize("save", [{}, {"scalars": ["outcome", "theta_peak_over_alpha"]}], ids=["alone", "in lanes"])
def test_a_body_that_moves_sees_the_bell_come_whatever_the_tolerance(save):
    study = {
        "case": {
            "block": {"R": 2, "tan_alpha": 0.2},
            "initial": {"theta": "0.5*alpha"},
            "motion": {"pulse": {"shape": "ricker", "a_p": "6*g*tan_alpha", "omega_p_over_p": 10}},
        },
        "vary": {
            "motion.pulse.omega_p_over_p": np.geomspace(1.0, 60.0, 24).tolist(),
            "initial.theta": ["0.3*alpha", "0.6*alpha", "0.95*alpha"],
        },
        "save": {"histories": False, **save},
        "plots": "none",
    }
    found, exact = (rockcli.run({**study, "case": {**study["case"], "solver": how}}) for how in (LOOSE, REFERENCE))
    np.testing.assert_array_equal(found["outcome"].values, exact["outcome"].values)
    peaks = [each["theta_peak_over_alpha"].values for each in (found, exact)]
    rocks = np.isfinite(peaks[1])
    assert 20 < np.count_nonzero(rocks) < rocks.size
    np.testing.assert_allclose(peaks[0][rocks], peaks[1][rocks], atol=2e-3)


LOOSE, REFERENCE = {"rtol": 1e-6}, {"accuracy": "reference"}
