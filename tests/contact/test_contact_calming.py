"""Bodies with friction of which only free swings are left: counted and timed as if each had been followed to its rest."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contact_cases import body, motion, run

from rockcli.kernels.constants import RETURNS
from rockcli.kernels.contact import results as to

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
