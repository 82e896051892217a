"""Reading what CalculiX writes, and the motion of the body from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_cases import mesh_batch
from scenes import still

from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.solvers.calculix.body import find_impacts, motion_of, rotation
from rockcli.solvers.calculix.case import prepare
from rockcli.solvers.calculix.results import Displacements, UnreadableError, progress
from rockcli.solvers.calculix.verdict import Body, falls_at, judge

BLOCK = """
 total internal energy for set SOLID and time  0.1000000E+00

        2.084045E+01

 displacements (vx,vy,vz) for set WATCHED and time  {t:.7E}

         1 -4.106745E-08 -2.451508E-07  0.000000E+00
         2  1.005369E-08 -2.030920E-07  0.000000E+00
"""


def test_blocks_are_read_as_they_are_written(tmp_path):
    path = tmp_path / "rocking.dat"
    text = "".join(BLOCK.format(t=t) for t in (0.5, 1.0, 1.25, 1.5))
    seen = Displacements(path, nodes=2, start=1.0)
    assert seen.read_on() == 0
    known = []
    for cut in range(0, len(text) + 37, 37):
        path.write_text(text[:cut])
        known.append(seen.read_on())
    assert known == sorted(known)
    t, u = seen.arrays()
    np.testing.assert_allclose(t, [0.0, 0.25, 0.5])
    np.testing.assert_allclose(u[1], [[-4.106745e-08, -2.451508e-07, 0.0], [1.005369e-08, -2.03092e-07, 0.0]])


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("-2.030920E-07", "surprise", "a number is expected"),
        ("         2  1.005369E-08", "  2", "three displacements"),
        ("-2.030920E-07", "NaN", "not finite"),
        ("displacements", "nothing", "no displacements"),
    ],
)
def test_garbage_is_told(tmp_path, old, new, sentence):
    path = tmp_path / "rocking.dat"
    path.write_text(BLOCK.format(t=1.5).replace(old, new))
    seen = Displacements(path, nodes=2, start=1.0)

    def read() -> None:
        seen.read_on()
        seen.arrays()

    with pytest.raises(UnreadableError, match=sentence):
        read()


def test_time_that_runs_backwards_is_told(tmp_path):
    path = tmp_path / "rocking.dat"
    path.write_text("".join(BLOCK.format(t=t) for t in (1.0, 2.0, 1.5)))
    seen = Displacements(path, nodes=2, start=1.0)
    seen.read_on()
    with pytest.raises(UnreadableError, match="time does not increase"):
        seen.arrays()


def test_progress(tmp_path):
    path = tmp_path / "rocking.sta"
    assert progress(path, 1.0) == (0.0, 0, 0)
    path.write_text(
        "SUMMARY OF JOB INFORMATION\n  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME\n"
        "     1          6     1     2  0.100000E+01  0.100000E+01  0.875000E-01\n"
        "     2          1     1     2  0.100200E+01  0.200000E-02  0.200000E-02\n"
        "     2          2     1U    4  0.130000E+01  0.300000E+00  0.298000E+00\n"
        "     2          2     2     2  0.125000E+01  0.250000E+00  0.248000E+00\n"
        "torn lin"
    )
    assert progress(path, 1.0) == (pytest.approx(0.25), 2, 2 + 4 + 2)  # of the dynamic step, the failed attempt too
    assert progress(path, 1.0, until=0.002) == (pytest.approx(0.002), 1, 2)  # attempts at the next increment are not


def rigid_turn(deck, theta):
    """Displacements of the watched nodes when the body turns rigidly about its corner by theta (k,)."""
    watched = deck.mesh.nodes[[*deck.mesh.base, *deck.mesh.top]]
    half = 0.5 * deck.mesh.share.sum()
    u = np.zeros((len(theta), len(watched), 3))
    for j, q in enumerate(theta):
        pivot = np.array([half if q >= 0.0 else -half, 0.0, 0.0])
        arm = watched - pivot
        cos, sin = np.cos(q), np.sin(q)
        u[j, :, 0] = arm[:, 0] * cos + arm[:, 1] * sin - arm[:, 0]
        u[j, :, 1] = -arm[:, 0] * sin + arm[:, 1] * cos - arm[:, 1]
    return u


def test_a_rigid_turn_is_read_back():
    deck = prepare(mesh_batch(still(1.0)), 0).deck
    theta = np.array([0.0, 1e-6, 0.07, -0.09, 1.2, -1.4])
    motion = motion_of(deck, np.arange(6.0), rigid_turn(deck, theta))
    np.testing.assert_allclose(motion.theta, theta, atol=1e-14)
    np.testing.assert_allclose(motion.u_top, 50.0 * np.sin(theta), atol=1e-12)
    np.testing.assert_allclose(motion.v_top, -50.0 * (1.0 - np.cos(theta)), atol=1e-12)
    np.testing.assert_allclose(motion.u_bend, 0.0, atol=1e-12)


def test_an_open_base_does_not_pull():
    deck = prepare(mesh_batch(still(1.0)), 0).deck
    u = rigid_turn(deck, np.array([0.05, -0.05]))
    u[:, :, 1] -= 1e-5  # sinks: the pivot alone is in contact, the others are open
    motion = motion_of(deck, np.arange(2.0), u)
    expected = deck.kw * deck.mesh.depth * deck.mesh.share[0] * 1e-5
    np.testing.assert_allclose(motion.N, expected, rtol=1e-9)
    np.testing.assert_allclose(motion.M, [2.5 * expected, -2.5 * expected], rtol=1e-9)
    np.testing.assert_allclose(motion.T, 0.0, atol=1e-6 * expected)


def test_the_base_holds_the_body_against_sliding():
    deck = prepare(mesh_batch(still(1.0)), 0).deck
    u = np.zeros((1, len(deck.mesh.base) + 2, 3))
    u[:, :, 1] = -1e-5
    u[:, :, 0] = 3e-6  # drags to the right: the base pushes to the left
    motion = motion_of(deck, np.zeros(1), u)
    assert motion.T[0] == pytest.approx(-0.3 * motion.N[0], rel=1e-9)


def test_rotation_is_that_of_the_nearest_line():
    x = np.array([-1.0, 0.0, 1.0])
    base = np.zeros((1, 3, 3))
    base[0, :, 1] = [0.2, 0.1, 0.0]  # the left corner rises: clockwise
    assert rotation(x, base)[0] == pytest.approx(np.arctan(0.1))


def test_one_landing_per_excursion():
    t = np.linspace(0.0, 4.0, 4001)
    theta = np.where(t < 1.0, 0.0, np.sin(np.pi * (t - 1.0)))
    near = (t > 1.99) & (t < 2.01)
    theta[near] = 1e-4 * np.sin(2000.0 * t[near])  # the base trembles when it lands
    found = find_impacts(t, theta, np.ones(len(t)), 1e-3)
    assert found.opened == pytest.approx(1.0, abs=2e-3)
    assert len(found.t) == 2
    np.testing.assert_allclose(found.t, [2.0, 3.0], atol=0.011)
    assert found.before[0] < 0.0 < found.before[1]
    assert found.after[0] < 0.0


def test_a_body_that_only_trembles_has_not_rocked():
    t = np.linspace(0.0, 1.0, 101)
    found = find_impacts(t, 5e-4 * np.sin(40.0 * t), np.ones(len(t)), 1e-3)
    assert np.isnan(found.opened)
    assert len(found.t) == 0


def test_a_body_that_turns_with_a_soft_base_has_not_rocked_until_an_edge_opens():
    deck = prepare(mesh_batch(still(1.0)), 0).deck
    t = np.linspace(0.0, 4.0, 401)
    sunk, theta = 0.01, 0.005 * t * np.sin(2.0 * np.pi * t)
    u = np.zeros((len(t), len(deck.mesh.base) + 2, 3))
    u[:, :-2, 1] = -sunk - theta[:, None] * deck.mesh.x_base
    motion = motion_of(deck, t, u)
    b = np.abs(deck.mesh.x_base).max()
    opens = t[np.argmax(b * np.abs(theta) > sunk)]
    assert opens > t[np.argmax(np.abs(theta) > 1e-3)] + 0.1
    found = find_impacts(t, motion.theta, motion.lift, 1e-3)
    assert found.opened == pytest.approx(opens, abs=0.01)
    assert found.t[0] == pytest.approx(np.ceil(2.0 * opens) / 2.0, abs=0.01)
    assert np.isnan(find_impacts(t, motion.theta, motion.lift - b, 1e-3).opened)


BODY = Body(alpha=0.1, p=1.0, period=0.2, motion_end=1.0, theta_star=0.1, barrier=1.0 - np.cos(0.1))


@pytest.mark.parametrize(
    ("theta", "rate", "verdict"),
    [
        (0.0, 0.0, RETURNS),
        (0.05, -0.02, RETURNS),
        (0.08, 0.1, UNDECIDED),
        (0.13, 0.1, FALLS),
        (0.11, 0.08, FALLS),
        (0.02, -0.2, UNDECIDED),
    ],
)
def test_verdict_after_the_motion(theta, rate, verdict):
    t = np.linspace(0.0, 2.0, 401)
    assert judge(BODY, t, theta + rate * (t - 2.0)) == verdict


def test_a_body_on_a_soft_base_returns_from_less():
    """Its equilibrium is at .07 rad, with .9 of the barrier of a rigid block."""
    soft = replace(BODY, theta_star=0.07, barrier=0.9 * BODY.barrier)
    t = np.linspace(0.0, 2.0, 401)
    for theta, verdict in ((0.05, RETURNS), (0.065, UNDECIDED), (0.075, UNDECIDED)):
        assert judge(BODY, t, np.full(401, theta)) == RETURNS
        assert judge(soft, t, np.full(401, theta)) == verdict


def test_no_verdict_while_the_motion_lasts():
    t = np.linspace(0.0, 0.9, 91)
    assert falls_at(BODY, t, np.linspace(0.0, 0.3, 91)) is None
    assert judge(BODY, t, np.zeros(91)) == UNDECIDED
    assert falls_at(BODY, t, np.linspace(0.0, 1.6, 91)) == 89


def test_a_fall_is_told_at_its_first_increment():
    t = np.linspace(0.0, 2.0, 401)
    theta = 0.02 * (t / 0.2)  # passes 1.25 alpha at 1.25 s, after the motion
    assert falls_at(BODY, t, theta) == 251
    assert falls_at(BODY, t, theta[::-1]) is None  # inward
    assert falls_at(BODY, t, np.where(t < 1.5, theta, -theta)) == 251
