"""Recorded motions against an independent solver (reference.py)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reference import body_of, integrate
from scenes import SHARED, G, block, record, rock

from rockcli.scene.body.block import housner_eta
from rockcli.scene.response import OVERTURNED_WITHOUT_IMPACT

OWN = Path(__file__).resolve().parents[2] / "records"
BLOCKS = [(0.8, 0.22), (4.0, 0.13)]
"""R [m], tan(alpha)."""


def _read(path: Path):
    import obspy

    trace = obspy.read(str(path))[0]
    return trace.data * G, trace.stats.delta


def _shared_records() -> list[Path]:
    folder = SHARED / "records" / "peer"
    return sorted(folder.glob("*.AT2"))[:40:2] + sorted((folder / "p695_far_field").glob("*.AT2"))[::4]


def compare(path: Path, R: float, tan_alpha: float, times: float) -> tuple[float, bool]:
    """(error of peak theta/alpha, outcomes agree) for a record scaled to `times` g tan(alpha)."""
    values, dt = _read(path)
    values = values * (times * G * tan_alpha / np.abs(values).max())
    body = block(R, tan_alpha)
    eta = housner_eta(body)[0]
    ours = rock(body, record(values, dt), eta=eta)
    theirs = integrate(body_of(body, eta), values, dt)
    assert ours.scalars["outcome"][0] >= 0, ours.reasons
    fell = ours.scalars["outcome"][0] >= OVERTURNED_WITHOUT_IMPACT
    error = 0.0 if fell else abs(ours.scalars["theta_peak_over_alpha"][0] - theirs.peak_over_alpha)
    return float(error), bool(fell == theirs.overturned)


@pytest.mark.parametrize(
    "R_tan_alpha",
    [pytest.param(block, marks=pytest.mark.slow if block == (4.0, 0.13) else ()) for block in BLOCKS],
    ids=str,
)
def test_synthetic_records(R_tan_alpha):
    paths = sorted(OWN.glob("*.AT2"))
    assert paths
    for path, times in zip(paths, (1.5, 2.5, 3.5), strict=False):
        error, agree = compare(path, *R_tan_alpha, times)
        assert agree
        assert error <= 1e-9


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="no folder of real records beside the checkout")
def test_thirty_real_records():
    """Two blocks in turn, scaled to 1 ... 4 g tan(alpha): median error <= 1e-9, no wrong outcome."""
    paths = _shared_records()[:30]
    assert len(paths) == 30
    errors, agreements = [], []
    for i, path in enumerate(paths):
        error, agree = compare(path, *BLOCKS[i % 2], 1.0 + 3.0 * i / 29.0)
        errors.append(error)
        agreements.append(agree)
    print(f"\nmedian {np.median(errors):.1e}, p90 {np.quantile(errors, 0.9):.1e}, wrong {agreements.count(False)}")
    assert all(agreements)
    assert np.median(errors) <= 1e-9
