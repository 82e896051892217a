"""Sliding and rocking with friction against OpenSees: corners on penalty contacts, stepped in time, no event known.

The peer's ground is soft (`stiffness`), its friction elastic before it slips, and corners rebound from it; so
the two are compared up to the first impact, and must draw together as the ground gets stiffer and the steps shorter.
"""

from __future__ import annotations

import numpy as np
import pytest

import rockcli

openseespy = pytest.importorskip("openseespy.opensees", exc_type=ImportError)

G, H, B, M = 9.81, 1.0, 0.4, 1.0
T_P = 0.4
GROUNDS = ((1e7, 1e-4), (1e9, 1e-5))
"""Stiffness of the contacts over the mass [1/s^2] and time step [s]: the ground gives by m g/(2 k) at rest."""


def corners(mu: float, a_p: float, t_end: float, stiffness: float, dt: float) -> np.ndarray:
    """(k, 4): time, rotation to the right, slide of the left and of the right corner, every millisecond."""
    ops = openseespy
    centre, left, right = 1, 2, 3
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(centre, 0.0, H)
    ops.mass(centre, M, M, M * (H**2 + B**2) / 3.0)
    ops.geomTransf("Corotational", 1)
    for corner, x in ((left, -B), (right, B)):
        ground = 10 + corner
        ops.node(corner, x, 0.0)
        ops.mass(corner, 1e-6 * M, 1e-6 * M, 1e-8 * M)
        ops.node(ground, x, 0.0)
        ops.fix(ground, 1, 1, 1)
        ops.element("elasticBeamColumn", corner, centre, corner, 1.0, 1e3 * stiffness, 1.0, 1)
        ops.element("zeroLengthContact2D", 20 + corner, corner, ground, stiffness, stiffness, mu, "-normal", 0.0, 1.0)

    def analysis(kind: str, *integrator: object) -> None:
        ops.constraints("Plain")
        ops.numberer("Plain")
        ops.system("FullGeneral")
        ops.test("NormDispIncr", 1e-12, 50, 0)
        ops.algorithm("Newton")
        ops.integrator(*integrator)
        ops.analysis(kind)

    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(centre, 0.0, -M * G, 0.0)
    analysis("Static", "LoadControl", 0.1)
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    t = np.arange(0.0, t_end + dt, dt)
    a_g = np.where(t < T_P, a_p * np.sin(2.0 * np.pi * t / T_P), 0.0)
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *map(float, -M * a_g))
    ops.pattern("Plain", 2, 2)
    ops.load(centre, 1.0, 0.0, 0.0)
    analysis("Transient", "HHT", 0.9)
    found = []
    for _ in range(int(t_end / 1e-3)):
        assert ops.analyze(round(1e-3 / dt), dt) == 0
        found.append([ops.getTime(), -ops.nodeDisp(centre, 3), ops.nodeDisp(left, 1), ops.nodeDisp(right, 1)])
    ops.wipe()
    return np.array(found)


@pytest.mark.parametrize(
    ("mu", "a_p", "modes"),
    [
        (0.2, 6.0, {0, 1}),  # slides flat
        (0.45, 10.0, {0, 2, 3}),  # rocks, slides while it rocks, rocks again
        pytest.param(0.5, 15.0, {0, 2, 3}, marks=pytest.mark.slow),  # the same, farther
    ],
)
def test_sliding_and_slide_rock_as_opensees_has_them(mu, a_p, modes):
    case = {
        "block": {"h": H, "b": B, "mu": mu},
        "motion": {"pulse": {"shape": "sine", "a_p": a_p, "T_p": T_P}},
        "g": G,
    }
    ours = rockcli.run({"name": "friction", "case": case, "save": {"histories": True, "dt_out": 1e-3}})
    impact = ours["t_impact"].values[0] if int(ours.n_impacts) else T_P
    before = ours["time"].values < impact - 2e-3
    assert set(ours["contact_mode"].values[before].astype(int)) == modes
    theta, slide = (ours[name].values[before] for name in ("theta", "slide"))
    assert np.abs(slide).max() > 0.02
    apart = []
    for ground in GROUNDS:
        found = corners(mu, a_p, impact - 2e-3, *ground)
        at = np.searchsorted(ours["time"].values[before], found[:, 0] - 5e-4)
        inside = at < before.sum()
        found, at = found[inside], at[inside]
        np.testing.assert_allclose(found[:, 0], ours["time"].values[at], atol=1e-9)
        foot = np.where(found[:, 1] < 0.0, found[:, 2], found[:, 3])
        largest = max(np.abs(theta).max(), np.abs(slide).max())
        apart.append(max(np.abs(found[:, 1] - theta[at]).max(), np.abs(foot - slide[at]).max()) / largest)
    assert apart[1] < 4e-3
    assert apart[1] < apart[0] / 3.0
