"""A body on a floor: the floor's acceleration history is its record."""

from __future__ import annotations

import numpy as np
import pytest
from reference import body_of, integrate
from scipy.signal import lsim

import rockcli
from rockcli.scene.body.block import housner_eta
from rockcli.study.open import open_study


def test_on_the_floor_of_a_building(tmp_path):
    """A floor of 1.1 s and 5 % under two sine cycles; its absolute acceleration against an independent integration."""
    dt, omega, zeta = 0.01, 2 * np.pi / 1.1, 0.05
    t = np.arange(500) * dt
    ground = 0.85 * np.sin(omega * t) * (t < 2 * 1.1)
    system = ([2 * zeta * omega, omega**2], [1, 2 * zeta * omega, omega**2])  # absolute over ground acceleration
    floor = lsim(system, ground, t)[1]
    (tmp_path / "floor.csv").write_text(
        "# units: m/s2\n" + "".join(f"{x:.2f},{a!r}\n" for x, a in zip(t, floor.tolist(), strict=True))
    )
    (tmp_path / "s.yaml").write_text(
        "name: floor\ncase: {block: {height: 1.8, width: 0.6}, motion: {record: {file: floor.csv}}}\n"
    )
    found = rockcli.run(tmp_path / "s.yaml")
    ((_, batch),) = open_study(tmp_path / "s.yaml").batches()
    np.testing.assert_array_equal(batch.excitation.horizontal.values, floor)
    theirs = integrate(body_of(batch.block, housner_eta(batch.block)[0]), floor, dt)
    assert np.abs(ground).max() < 9.81 * batch.block.tan_alpha.min() < np.abs(floor).max()
    assert not theirs.overturned
    assert float(found.theta_peak_over_alpha) == pytest.approx(theirs.peak_over_alpha, abs=1e-8)
    assert theirs.peak_over_alpha > 0.05
