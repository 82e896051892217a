"""Bodies with friction of which only free swings are left: counted and timed as if each had been followed to its rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from contact_cases import body, motion, run
from scenes import G, make_batch, pulse

from rockcli.kernels.constants import RETURNS
from rockcli.kernels.contact import results as to
from rockcli.scene.batch import Save
from rockcli.scene.body.block import LEFT, RIGHT, make_block
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import ROCKING
from rockcli.solvers.event.solver import solve

OF_THE_WAY = {to.N_STEPS, to.N_EVENTS, to.T_REST, to.T_END, to.BALANCE, to.STRUCK_LATER}


def drawn(rng):
    """A body and a motion under which most rock and some slip."""
    h, slender = rng.uniform(0.5, 3.0), rng.uniform(0.1, 0.5)
    left, right = h * slender, h * slender * (1.0 if rng.random() < 0.5 else rng.uniform(1.0, 1.4))
    T = 10.0 ** rng.uniform(-0.5, 0.5)
    a_p = 9.81 * slender * rng.uniform(1.05, 3.0)
    eta = None if rng.random() < 0.5 else rng.uniform(0.6, 0.95)
    par = body((left, right), h, mu=slender * rng.uniform(1.02, 2.5), eta=eta, t_motion=T)
    return par, motion(f"sine {a_p!r} {2.0 * math.pi / T!r} {T!r}")


@pytest.mark.parametrize("seed", range(4))
def test_as_followed_to_the_rest(seed):
    rng = np.random.default_rng(seed)
    left_out = came_back = 0
    for _ in range(15):
        par, sine = drawn(rng)
        followed, found = (run(par, sine, watched=watched) for watched in (True, False))
        for i in range(to.N_OUT):
            if i not in OF_THE_WAY:
                assert found.out[i] == pytest.approx(followed.out[i], rel=1e-9, abs=1e-12, nan_ok=True), i
        assert found["T_END"] == pytest.approx(followed["T_END"], rel=1e-10)
        assert abs(found["BALANCE"] - followed["BALANCE"]) < 1e-9
        assert np.allclose(found.impacts, followed.impacts, rtol=1e-8, atol=1e-9)
        came_back += followed["VERDICT"] == RETURNS and followed["PEAK"] > 0.0
        left_out += found["N_STEPS"] < 0.7 * followed["N_STEPS"]
    assert left_out >= 0.5 * came_back > 1


@pytest.mark.parametrize(
    ("b", "h", "mu", "eta", "T", "a_p", "what"),
    [
        ((0.36948156, 0.54574708), 2.33480673, 0.38434076, 0.96151355, 1.18442415, 1.88192497, "N_MIN"),
        ((0.74245831, 1.05868842), 1.97575147, 0.45180530, None, 1.45434623, 4.80671062, "TOP_PEAK"),
    ],
    ids=["presses_less", "top_goes_farther"],
)
def test_swings_that_show_more_are_followed(b, h, mu, eta, T, a_p, what):
    """On the other edge a lower swing presses less; about the place where the base has slid to the top goes farther."""
    par = body(b, h, mu=mu, eta=eta, t_motion=T, top=0.05 * h)
    sine = motion(f"sine {a_p!r} {2.0 * math.pi / T!r} {T!r}")
    followed, found = (run(par, sine, watched=watched)[what] for watched in (True, False))
    assert found == pytest.approx(followed, rel=1e-9)


@pytest.mark.parametrize(("shape", "seed"), [("sine", 2), ("ricker", 19)])
def test_impacts_count_by_the_edge_turned_about_before(shape, seed):
    """Of bodies with two different edges, all above 1e-6 p alpha of that edge, and no other."""
    rng, n = np.random.default_rng(seed), 200
    h = 10.0 ** rng.uniform(-0.3, 0.5, n)
    block = make_block(h=h, b=h[:, None] * rng.uniform(0.08, 0.5, (n, 2)), n=n)
    slender, p = block.tan_alpha.min(axis=1), block.p(np.full(n, G))
    block = replace(block, mu=slender * rng.uniform(0.9, 2.5, n))
    a_p, omega_p = rng.uniform(1.2, 4.0, n) * G * slender, 2.0 * p.min(axis=1) * 10.0 ** rng.uniform(-0.3, 0.8, n)
    batch = make_batch(
        block, pulse(shape, a_p, omega_p), accuracy="standard", scalars=("outcome", "n_impacts", "n_slips")
    )
    found, exact = (solve(replace(batch, numerics=Numerics(accuracy=x))).scalars for x in ("standard", "reference"))
    same = (found["outcome"] == ROCKING) & (exact["outcome"] == ROCKING)
    assert (found["n_slips"][same] > 0).sum() > 50
    np.testing.assert_array_equal(found["n_impacts"][same], exact["n_impacts"][same])

    hits = solve(replace(batch.rows(np.arange(0, n, 10)), save=Save(True, 0.01, frozenset({"n_impacts"})))).impacts
    rate, limit = hits["theta_dot_before"], 1e-6 * p[::10] * block.alpha[::10]
    of_the_edge = np.where(rate < 0.0, limit[:, [RIGHT]], limit[:, [LEFT]])
    assert (np.abs(rate) / of_the_edge)[np.isfinite(rate)].min() > 1.0 - 1e-9
