"""A case solved in lanes gives the same bits whatever its neighbours, its order and its chunk."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from scenes import G, make_batch, pulse

import rockcli
from rockcli import kernels
from rockcli.kernels.lanes.vector import WIDTH, elementary, plain
from rockcli.scene.body.block import make_block
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event.solver import solve

SCALARS = ("outcome", "theta_peak_over_alpha", "n_impacts", "t_peak", "t_uplift")
N = 24


def results(cases: np.ndarray) -> dict[str, np.ndarray]:
    """Some of N cases of different bodies and pulses, in the order given."""
    rng = np.random.default_rng(7)
    A, W, alpha, p = (rng.uniform(lo, hi, N)[cases] for lo, hi in ((0.9, 5.0), (0.8, 6.0), (0.05, 0.4), (0.6, 2.5)))
    eta = rng.uniform(0.5, 1.0, N)[cases]
    R = 0.75 * G / p**2
    b = np.column_stack([R * np.sin(alpha)] * 2)
    body = make_block(h=R * np.cos(alpha), b=b, R=R, alpha=alpha, n=len(cases))
    motion = pulse("ricker", A * G * np.tan(alpha), W * p)
    batch = make_batch(body, motion, eta=np.column_stack([eta, eta]), accuracy="standard", scalars=SCALARS)
    assert lane_pulses.asked(batch)
    found = solve(batch).scalars
    return {name: found[name] for name in SCALARS}


@pytest.fixture(scope="module")
def together() -> dict[str, np.ndarray]:
    found = results(np.arange(N))
    assert len(set(found["outcome"])) >= 3
    return found


def test_shuffled(together):
    order = np.random.default_rng(3).permutation(N)
    for name, values in results(order).items():
        np.testing.assert_array_equal(values, together[name][order])


@pytest.mark.parametrize("chunk", [7])
def test_in_chunks(together, chunk):
    parts = [results(np.arange(i, min(i + chunk, N))) for i in range(0, N, chunk)]
    for name in SCALARS:
        np.testing.assert_array_equal(np.concatenate([part[name] for part in parts]), together[name])


@pytest.mark.parametrize("case", [5])
def test_one_alone(together, case):
    for name, values in results(np.array([case])).items():
        np.testing.assert_array_equal(values, together[name][[case]])


@pytest.mark.parametrize(("length", "begins", "n"), [(40, 0, 800), (40, 13, 777), (7, 6, 50)])
def test_lines_of_a_map_are_taken_side_by_side(length, begins, n):
    """Every row once; rows taken one after the other stand at the same place of as many lines as a vector has lanes."""
    place = (np.arange(n) + begins) % length
    for strength in (place + 1.0, 1.0 / (place + 1.0)):
        order = lane_pulses.in_turn(strength)
        assert sorted(order) == list(range(n))
        first = order[(order + begins) // length < WIDTH]
        np.testing.assert_array_equal(order[: len(first)], first)
        assert (np.diff(place[first]) >= 0).all()


@pytest.mark.parametrize(
    "strength", [[], [2.0], [1.0, 2.0, 3.0], [2.0, 2.0, 2.0], [1, 2, 3, 1, 2, 1, 2, 3], [1, 3, 2, 5, 4, 4, 6]]
)
def test_other_rows_are_taken_as_they_come(strength):
    np.testing.assert_array_equal(lane_pulses.in_turn(np.array(strength)), np.arange(len(strength)))


def test_a_map_shuffled():
    """Lines side by side, and rows as they come, give the same bits."""
    A, W = (x.ravel() for x in np.meshgrid(np.linspace(0.8, 4.0, 30), np.linspace(0.8, 6.0, 20)))
    R, alpha = np.full(len(A), 2.0), 0.2
    order = np.random.default_rng(3).permutation(len(A))
    found = []
    for rows in (np.arange(len(A)), order):
        body = make_block(h=R * np.cos(alpha), b=np.full((len(A), 2), 2.0 * np.sin(alpha)), R=R, alpha=alpha, n=len(A))
        motion = pulse("ricker", A[rows] * G * np.tan(alpha), W[rows] * np.sqrt(0.75 * G / 2.0))
        found.append(solve(make_batch(body, motion, eta=np.full((len(A), 2), 0.9), scalars=SCALARS)).scalars)
    for name in SCALARS:
        np.testing.assert_array_equal(found[0][name][order], found[1][name])


OUTLINE = [[-0.3, 0.02], [-0.15, 0], [0.15, 0], [0.3, 0.02], [0.35, 2], [-0.35, 2]]


@pytest.mark.parametrize("histories", [False, True])
@pytest.mark.parametrize("body", [{"R": 2, "alpha": 0.2}, {"outline": OUTLINE, "density": 2000, "depth": 1}])
def test_what_was_solved_before_changes_no_bit(body, histories):
    """Few cases of all scalars, in a process that has compiled its kernels by then and in one that has not."""
    case = {"block": body, "motion": {"pulse": {"shape": "ricker", "a_p": "0.4*g", "T_p": 1.0}}}
    study = {"case": case, "vary": {"damping.r_energy": [0.8, 0.9]}, "save": {"histories": histories}}
    kernels.forget()
    first = rockcli.run(study)
    kernels.load(compile_them=True)
    then = rockcli.run(study)
    kernels.forget()
    assert then.attrs["solver_settings"] == first.attrs["solver_settings"]
    assert then.attrs["checksum"] == first.attrs["checksum"]


@pytest.mark.slow
def test_compiled_and_interpreted():
    """A small chunk runs as plain Python where a large one is compiled: the numbers are the same to the last bit."""
    program = (
        "import numpy as np, test_lanes_alone as here;"
        "found = here.results(np.arange(8));"
        "print([float(x).hex() for values in found.values() for x in values])"
    )
    said = []
    for way in ("compiled", "interpreted"):
        env = os.environ | {"ROCK_KERNELS": way, "PYTHONPATH": os.pathsep.join(sys.path)}
        ran = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, check=True)
        said.append(ran.stdout)
    assert said[0].count("0x") > 3 * 8  # some of them stand
    assert said[0] == said[1]


def test_fused_multiply_add_rounds_once():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(2, 400))
    c = -a * b + rng.choice([0.0, 1e-17, 1.0], 400) * rng.normal(size=400)  # what is left is mostly rounding
    exact = [float(Fraction(x) * Fraction(y) + Fraction(z)) for x, y, z in zip(a, b, c, strict=True)]
    assert plain.fma(a, b, c).tolist() == exact
    assert np.count_nonzero(a * b + c != exact) > 200
    assert plain.fma(a[0], b[0], c[0]) == exact[0]


def test_polynomials_of_sines_and_exponentials():
    for x in np.linspace(-0.5 * np.pi, 0.5 * np.pi, 501):
        assert elementary.sin_cos(x) == pytest.approx((math.sin(x), math.cos(x)), rel=0, abs=3e-16)
    for x in np.linspace(-1e3, 1e3, 1001):
        assert elementary.sin_cos_of_any(x) == pytest.approx((math.sin(x), math.cos(x)), rel=0, abs=4e-16)
    for x in np.linspace(-50.0, 0.0, 501):
        assert elementary.exp_of_negative(x) == pytest.approx(math.exp(x), rel=0, abs=4e-16)


@pytest.mark.parametrize("initial", [{}, {"theta": "0.3*alpha"}], ids=["stands", "moves"])
@pytest.mark.parametrize("shape", ["ricker", "ricker_antisymmetric", "sine"])
def test_pulses_that_begin_at_once_beside_late_ones(shape, initial):
    """Of a given `t0` short pulses begin later than the report: long ones know nothing of that."""

    def solved(omegas, **solver):
        return rockcli.run(
            {
                "case": {
                    "block": {"R": 2, "tan_alpha": 0.2},
                    "initial": initial,
                    "motion": {
                        "pulse": {"shape": shape, "a_p": 1, "omega_p": 1, "t0": 0.3 if shape != "sine" else 0.0}
                    },
                    "solver": solver,
                },
                "vary": {"motion.pulse.omega_p": omegas, "motion.pulse.a_p": np.linspace(2.2, 12, 12).tolist()},
                "save": {"histories": False, "scalars": list(SCALARS)},
                "plots": "none",
            }
        )

    alone, beside, exact = (
        solved([8.0, 12.0]),
        solved([8.0, 12.0, 60.0]),
        solved([8.0, 12.0, 60.0], accuracy="reference"),
    )
    for name in SCALARS:
        np.testing.assert_array_equal(beside[name].values[:2], alone[name].values, err_msg=name)
    np.testing.assert_array_equal(beside["outcome"].values, exact["outcome"].values)
    np.testing.assert_array_equal(beside["n_impacts"].values, exact["n_impacts"].values)
    np.testing.assert_allclose(beside["theta_peak_over_alpha"].values, exact["theta_peak_over_alpha"].values, rtol=1e-8)
