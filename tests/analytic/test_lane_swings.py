"""How long the pulse lanes say that free swings are, against the integral of dq over the rate."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from rockcli.kernels.lanes.pulses.free_rocking import SHORT, swing
from rockcli.kernels.lanes.vector import WIDTH


def exact(v: float, r0: float, rs: float, rc: float, *, linear: bool) -> float:
    """Time of a swing up and down, with q = top (1 - y^2), so that nothing is singular at the top."""

    def stored(q: float) -> float:
        if linear:
            return (r0 + rc) * q + 0.5 * rs * q * q
        return r0 * q + 2.0 * rs * math.sin(0.5 * q) ** 2 + rc * math.sin(q)

    top = brentq(lambda q: stored(q) - 0.5 * v * v, 0.0, v * v / (r0 + rc), xtol=1e-300, rtol=1e-15)

    def slowness(y: float) -> float:
        return 2.0 * top * y / math.sqrt(2.0 * (stored(top) - stored(top * (1.0 - y * y))))

    return 2.0 * quad(slowness, 0.0, 1.0, epsrel=1e-12)[0]


@pytest.mark.parametrize("linear", [False, True])
@pytest.mark.parametrize("r0", [0.0, 0.03])
@pytest.mark.parametrize("alpha", [0.02, 0.3, 1.2])
def test_swings(alpha: float, r0: float, linear: bool) -> None:
    rs, rc = -math.cos(alpha), math.sin(alpha)
    if linear:
        rs, rc = -1.0, alpha
    brim = math.sqrt((r0 + rc) ** 2 / -rs)
    v = brim * np.concatenate([np.geomspace(1e-6, 0.09, 8), [0.0995, 0.1005], np.linspace(0.15, 0.6, 6)])
    assert len(v) == WIDTH
    assert 0.0995**2 < SHORT < 0.1005**2
    with np.errstate(all="ignore"):
        found = swing(v, *(np.full(WIDTH, x) for x in (r0, rs, rc)), linear, np.full(WIDTH, True))
    told = [exact(x, r0, rs, rc, linear=linear) for x in v]
    assert found == pytest.approx(told, rel=2e-11)
    assert found[:8] == pytest.approx(told[:8], rel=2e-12)
