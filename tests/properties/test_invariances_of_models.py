"""What may not change the answer, over models, motions and backends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flexible.columns import column_batch, rock_column, sine
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import G, array, make_batch, overturns, peak, pulse, record, repeated, rock, still, unit_block

from rockcli.scene.body.block import make_block
from rockcli.scene.laws.damping import Damping
from rockcli.solvers.event.solver import solve
from rockcli.solvers.flexible import solve as solve_flexible
from rockcli.solvers.frame.solver import solve as solve_frame
from rockcli.solvers.general.solver import solve as solve_generally

FEW = settings(max_examples=20, deadline=None, derandomize=True)

LAWS = [("rigid", None), ("linearized", None)] + [
    (model, geometry) for model in "1234" for geometry in ("negative_stiffness", "corotational")
]

SCALARS = ("outcome", "n_impacts", "t_end", "mu_required", "theta_peak_over_alpha", "t_uplift", "energy_residual")


def shaking(seed: int, n: int = 200) -> np.ndarray:
    """A random motion that begins and ends with zero, largest value 1."""
    rng = np.random.default_rng(seed)
    values = np.convolve(rng.normal(size=n), np.ones(7) / 7.0, mode="same")
    values[0] = values[-1] = 0.0
    return values / np.abs(values).max()


def mirrored(batch):
    """The batch seen from behind: the horizontal motion and the initial state with the other sign."""
    horizontal = batch.excitation.horizontal
    turned = replace(horizontal, factor=-horizontal.factor)
    return replace(
        batch,
        excitation=replace(batch.excitation, horizontal=turned),
        theta_0=-batch.theta_0,
        theta_dot_0=-batch.theta_dot_0,
    )


def assert_mirrored(right, left):
    np.testing.assert_array_equal(right.histories["theta"], -left.histories["theta"])
    np.testing.assert_array_equal(right.histories["theta_dot"], -left.histories["theta_dot"])
    for name in SCALARS:
        if name in right.scalars:
            np.testing.assert_array_equal(right.scalars[name], left.scalars[name], err_msg=name)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: "-".join(filter(None, law)))
@pytest.mark.parametrize("scheme", ["restitution", "dashpot"])
def test_mirror_symmetry_of_every_law_bit_for_bit(law, scheme):
    motion = record(1.9 * G * np.tan(0.2) * shaking(3), 0.03, vertical=0.2 * G * shaking(4))
    batch = make_batch(unit_block(0.2), motion, model=law[0], histories=True, dt_out=0.02, theta_0=0.01)
    batch = replace(batch, geometry=law[1])
    if scheme == "dashpot":
        batch = replace(batch, damping=Damping("dashpot", np.ones((1, 2)), coefficient=array(0.05)))
    right, left = solve(batch), solve(mirrored(batch))
    assert right.scalars["n_impacts"][0] > 2
    assert_mirrored(right, left)


@pytest.mark.parametrize("backend", ["general", "frame", "flexible"])
def test_mirror_symmetry_of_other_backends_bit_for_bit(backend):
    if backend == "flexible":
        motion = record(1.6 * G * 0.1 * shaking(3), 0.1, duration=25.0)
        batch = column_batch(motion, histories=True)
        solver = solve_flexible
    else:
        motion = record(1.9 * G * np.tan(0.2) * shaking(3), 0.03, duration=7.0)
        batch = make_batch(unit_block(0.2), motion, model="3", histories=True, dt_out=0.02, accuracy="standard")
        batch = replace(batch, geometry="corotational")
        solver = solve_generally if backend == "general" else solve_frame
        if backend == "frame":
            batch = replace(batch, numerics=replace(batch.numerics, dt=2e-3, yield_rotation=1e-8))
    right, left = solver(batch), solver(mirrored(batch))
    assert right.scalars["n_impacts"][0] > 1
    assert_mirrored(right, left)


def test_an_asymmetric_body_and_its_mirror_image():
    """Edges changed over and the motion turned round: the same motion to the other side."""
    motion = record(2.2 * shaking(5), 0.03)
    one = make_batch(make_block(h=1.0, b=np.array([[0.2, 0.3]]), r_g=0.6), motion, histories=True, dt_out=0.02)
    other = make_batch(make_block(h=1.0, b=np.array([[0.3, 0.2]]), r_g=0.6), motion, histories=True, dt_out=0.02)
    right, left = solve(one), solve(mirrored(other))
    assert right.scalars["n_impacts"][0] > 2
    assert_mirrored(right, left)


@pytest.mark.parametrize("shape", ["sine", "ricker"])
def test_histories_over_p_t_do_not_know_the_size(shape):
    """theta/alpha against p t for R over seven decades, within 1e-9."""
    alpha, dt = 0.2, 0.01
    histories = []
    for R in np.geomspace(1e-3, 1e4, 8):
        p = np.sqrt(0.75 * G / R)
        motion = pulse(shape, 2.5 * G * np.tan(alpha), 5.0 * p)
        response = rock(unit_block(alpha, p), motion, histories=True, dt_out=dt / p)
        histories.append(response.histories["theta"][0, :2000] / alpha)
        assert response.impacts["t_impact"].size >= 5
    for other in histories[1:]:
        np.testing.assert_allclose(other, histories[0], rtol=0.0, atol=1e-9)


@FEW
@given(st.floats(0.05, 0.5), st.floats(1.2, 4.0), st.floats(1.0, 8.0), st.floats(0.05, 30.0))
def test_gravity_is_a_scale(alpha, A, Omega, g):
    """On another planet: theta/alpha against p t stays, p being that of its g."""
    body = unit_block(alpha)
    p = np.sqrt(g / G)  # of the same body there
    here = rock(body, pulse("sine", A * G * np.tan(alpha), Omega))
    there = rock(body, pulse("sine", A * g * np.tan(alpha), Omega * p), g=g)
    assert overturns(here) == overturns(there)
    if not overturns(here):
        for name, scale in (("theta_peak_over_alpha", 1.0), ("t_uplift", p), ("mu_required", 1.0)):
            assert scale * there.scalars[name][0] == pytest.approx(here.scalars[name][0], rel=1e-8)


@pytest.mark.parametrize("mass", [1e-6, 1.0, 1e9])
def test_mass_only_scales_the_moment(mass):
    body = unit_block(0.2)
    heavy = type(body)(**{**{f: getattr(body, f) for f in body.__dataclass_fields__}, "mass": array(mass)})
    motion = pulse("ricker", 2.8 * G * np.tan(0.2), 4.0)
    one, other = (rock(b, motion, histories=True, dt_out=0.01) for b in (body, heavy))
    for name in ("theta", "theta_dot", "u_top"):
        np.testing.assert_array_equal(one.histories[name], other.histories[name])
    np.testing.assert_allclose(other.histories["M_base"], mass * one.histories["M_base"], rtol=1e-15)


@FEW
@given(st.floats(0.05, 0.5), st.integers(0, 10**6), st.floats(1.1, 1.8))
def test_forced_rocking_without_loss_runs_backwards(alpha, seed, A):
    """eta = 1: forward under a motion, then from the end state with the rate turned round under the motion reversed."""
    dt, n = 0.04, 150
    values = A * G * np.tan(alpha) * shaking(seed, n)
    end = (n - 1) * dt
    motion, reverse = (record(v, dt, duration=end) for v in (values, values[::-1]))
    how = {"eta": 1.0, "histories": True, "dt_out": dt}
    there = rock(unit_block(alpha), motion, theta_0=0.3 * alpha, **how)
    theta, rate = there.histories["theta"][0], there.histories["theta_dot"][0]
    if len(theta) < n or overturns(there):
        return
    back = rock(unit_block(alpha), reverse, theta_0=theta[n - 1], theta_dot_0=-rate[n - 1], **how)
    growth = np.exp(min(end, 14.0))  # what rounding becomes near the unstable equilibrium
    assert back.histories["theta"][0, n - 1] == pytest.approx(0.3 * alpha, abs=1e-13 * growth * alpha)


MAP = [(0.1, "sine", 2.0), (0.2, "ricker", 4.0), (0.3, "cosine", 3.0), (0.2, "square_cycle", 3.0)]


def outcomes(body, shape, A, Omega, accuracy):
    many = repeated(body, len(A))
    motion = pulse(shape, A * G * body.tan_alpha[0, 0], np.full(len(A), Omega))
    return rock(many, motion, accuracy=accuracy, scalars=("outcome",)).scalars["outcome"]


@pytest.mark.parametrize(("alpha", "shape", "Omega"), MAP)
def test_refinement_changes_no_outcome_away_from_a_boundary(alpha, shape, Omega, monkeypatch):
    """Farther than 1 % in amplitude from any change of outcome, all accuracies say the same."""
    monkeypatch.setenv("ROCK_KERNELS", "compiled")
    A = np.geomspace(1.1, 12.0, 1000)  # a step is 0.24 %
    exact = outcomes(unit_block(alpha), shape, A, Omega, "reference") >= 2
    changes = np.flatnonzero(exact[1:] != exact[:-1])
    assert len(changes) >= 1
    far = np.all(np.abs(np.log(A[:, None] / A[changes])) > 0.01 + 0.0024, axis=1)
    assert far.sum() > 500
    for accuracy in ("standard", "draft"):
        found = outcomes(unit_block(alpha), shape, A, Omega, accuracy)
        np.testing.assert_array_equal(found[far] >= 2, exact[far])
        assert np.all(found[far] >= 0)


def test_mass_invariance_of_the_column():
    """E, rho and the masses they stand for scale together: nothing else changes."""
    one, other = (rock_column(sine(), E=E, rho=rho) for E, rho in ((30e9, 2500.0), (30e5, 0.25)))
    assert peak(other) == pytest.approx(peak(one), rel=1e-8)


def test_a_body_left_alone_stays():
    """No motion, no initial state: nothing, in every law, whatever the accuracy."""
    for model, geometry in LAWS:
        batch = replace(make_batch(unit_block(0.2), still(5.0), model=model, histories=True), geometry=geometry)
        response = solve(batch)
        assert response.scalars["outcome"][0] == 0
        assert not response.histories["theta"].any()
