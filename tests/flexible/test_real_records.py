"""The 50 x 5 m column under recorded motions: it runs, converges with the mesh and the step, and differs from the block."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from flexible.columns import rock_column, scalar
from scenes import SHARED, G, make_batch, peak, record

from rockcli.scene.body.block import make_block
from rockcli.scene.ground.excitation import Excitation
from rockcli.scene.response import ROCKING
from rockcli.solvers.event.solver import solve as solve_rigid

TAN_ALPHA = 0.1
OWN = Path(__file__).resolve().parents[2] / "records"
PEER = SHARED / "records" / "peer"

MESHES = {5: 3e-3, 10: 1e-3, 20: 3e-4}
"""Elements, and how far the peak may be from that of 40, over it."""


@dataclass(frozen=True)
class Shaking:
    """A record scaled to `times` g tan(alpha); theta_peak/alpha of the flexible column, n = 40, and of E = infinity."""

    path: Path
    times: float
    flexible: float
    rigid: float


SYNTHETIC = [
    Shaking(OWN / "synthetic_pulse_m70.AT2", 5.0, 0.35837, 0.43485),
    Shaking(OWN / "synthetic_rock_m65.AT2", 5.0, 0.07878, 0.11115),
    Shaking(OWN / "synthetic_soil_m70.AT2", 5.0, 0.17083, 0.22793),
]
REAL = [
    Shaking(PEER / "RSN729_SUPER.B_B-IVW360.AT2", 3.5, 0.31584, 0.45126),
    Shaking(PEER / "RSN1120_KOBE_TAK000.AT2", 5.0, 0.21999, 0.21157),
    Shaking(PEER / "RSN1045_NORTHR_WPI046.AT2", 5.0, 0.36782, 0.47815),
]
WILDLIFE, TAKATORI, SOIL = REAL[0], REAL[1], SYNTHETIC[2]

beside = pytest.mark.skipif(not PEER.is_dir(), reason="no folder of real records beside the checkout")
PULSE = SYNTHETIC[0]
_SLOW = pytest.mark.slow
EVERY = [pytest.param(s, id=s.path.stem, marks=[] if s is PULSE else [_SLOW]) for s in SYNTHETIC]
EVERY += [pytest.param(s, id=s.path.stem, marks=[beside] if s is WILDLIFE else [beside, _SLOW]) for s in REAL]


@cache
def motion(shaking: Shaking) -> Excitation:
    import obspy

    trace = obspy.read(str(shaking.path))[0]
    values = trace.data.astype(float)
    return record(values * (shaking.times * G * TAN_ALPHA / np.abs(values).max()), float(trace.stats.delta))


def stiff(shaking: Shaking) -> float:
    """Peak of the law at E = infinity, (2.10)."""
    body = make_block(h=25.0, b=2.5, tan_alpha=TAN_ALPHA, alpha=np.arctan(TAN_ALPHA))
    batch = replace(make_batch(body, motion(shaking), model="3"), geometry="corotational")
    return float(solve_rigid(batch).scalars["theta_peak_over_alpha"][0])


@pytest.mark.parametrize("shaking", EVERY)
def test_peak_converges_with_the_mesh(shaking):
    fine = rock_column(motion(shaking), n=40)
    assert scalar(fine, "outcome") == ROCKING
    assert scalar(fine, "n_impacts") >= 10
    assert peak(fine) == pytest.approx(shaking.flexible, rel=2e-4)
    away = [abs(peak(rock_column(motion(shaking), n=n)) / peak(fine) - 1.0) for n in MESHES]
    assert all(error <= bound for error, bound in zip(away, MESHES.values(), strict=True)), away
    assert away[-1] <= away[0]


@pytest.mark.parametrize("shaking", EVERY)
def test_peak_converges_with_the_step(shaking):
    """At every accuracy a step is a sample of the record, or a part of it: halves and fifths change nothing."""
    delta = motion(shaking).horizontal.dt
    usual = peak(rock_column(motion(shaking)))
    for accuracy in ("draft", "reference"):
        assert peak(rock_column(motion(shaking), accuracy=accuracy)) == pytest.approx(usual, rel=1e-6)
    for parts in (2, 5):
        assert peak(rock_column(motion(shaking), dt=delta / parts)) == pytest.approx(usual, rel=1e-5)


@pytest.mark.parametrize("shaking", EVERY)
def test_rigid_beside_flexible(shaking):
    """Flexibility makes the peak smaller, but for Takatori."""
    assert stiff(shaking) == pytest.approx(shaking.rigid, rel=1e-3)
    assert (shaking.flexible < shaking.rigid) == (shaking is not TAKATORI)


@pytest.mark.parametrize("shaking", [SOIL, pytest.param(TAKATORI, marks=beside)], ids=lambda s: s.path.stem)
def test_stiff_column_is_model_3(shaking):
    """Where no swing is below 1e-3 alpha, or few are: those lose nothing, see docs/flexible.md."""
    assert peak(rock_column(motion(shaking), E=1e20, zeta=0.0, n=5)) == pytest.approx(shaking.rigid, rel=1e-3)


@pytest.mark.slow
@beside
def test_a_long_motion_that_almost_overturns_is_sensitive():
    """Wildlife at 5 g tan(alpha): meshes agree for 30 s, then one thousandth of the motion decides over the rest."""
    strong = replace(WILDLIFE, times=5.0)
    swings = [
        rock_column(motion(strong), n=n, histories=True).histories["theta"][0, :6000] / np.arctan(TAN_ALPHA)
        for n in (10, 20, 40)
    ]
    away = [float(np.abs(swing - swings[-1]).max()) for swing in swings[:-1]]
    assert away[1] < 5e-3
    assert away[1] < 0.5 * away[0]
    stronger = replace(WILDLIFE, times=5.0 * 1.001)
    assert abs(peak(rock_column(motion(stronger), n=20)) - peak(rock_column(motion(strong), n=20))) > 0.05
