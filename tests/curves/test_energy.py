"""Energy kept per cycle: the base dashpot in closed form, impacts as eta^4."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import block

from rockcli.scene.body.block import housner_eta, make_block
from rockcli.scene.laws.damping import Damping
from rockcli.scene.laws.energy import energy_ratio, energy_ratio_of_impacts

G = np.array([9.81])
ONES = np.ones((1, 2))


def dashpot(tan_alpha: float, phi, R: float = 2.0) -> np.ndarray:
    damping = Damping("dashpot", ONES, np.array([0.02]))
    return energy_ratio(damping, block(R, tan_alpha), G, np.atleast_1d(np.asarray(phi, float)))[0]


@pytest.mark.parametrize(
    ("phi", "ratio"), [(0.1, 0.979500787190401849), (0.5, 0.952860421057191115), (0.9, 0.938254571323326494)]
)
@pytest.mark.parametrize("R", [0.1, 2.0, 50.0])
def test_dashpot_at_three_amplitudes(phi, ratio, R):
    assert dashpot(0.1, phi, R)[0] == pytest.approx(ratio, rel=1e-10)


def test_share_of_the_impact_loss_at_small_amplitudes():
    """11 / 35 / 50 % of what impacts take, at .01 / .1 / .2 alpha."""
    eta4 = energy_ratio_of_impacts(block(2.0, 0.1))[0]
    share = (1.0 - dashpot(0.1, [0.01, 0.1, 0.2])) / (1.0 - eta4)
    np.testing.assert_allclose(share, [0.11, 0.35, 0.50], atol=0.006)


def test_it_meets_the_impacts_at_one_amplitude_or_never():
    phi = np.linspace(0.01, 0.999, 400)
    eta4 = energy_ratio_of_impacts(block(2.0, 0.1))[0]
    crossing = phi[np.argmax(dashpot(0.1, phi) < eta4)]
    assert crossing == pytest.approx(0.76, abs=0.01)
    assert np.all(dashpot(0.2, phi) > energy_ratio_of_impacts(block(2.0, 0.2))[0])


def test_ends_of_the_curve():
    ends = dashpot(0.2, [0.0, 1e-9, 1.0 - 1e-12, 1.0])
    assert ends[0] == 1.0
    assert ends[1] == pytest.approx(1.0, abs=1e-4)
    assert ends[3] == pytest.approx(ends[2], abs=1e-5)
    assert np.all(np.diff(dashpot(0.2, np.linspace(0.0, 1.0, 200))) < 0.0)


def test_impacts_do_not_know_the_amplitude():
    body = make_block(h=1.0, b=[0.2, 0.3])
    eta = housner_eta(body)
    kept = energy_ratio(Damping("restitution", eta), body, G, np.linspace(0.0, 1.0, 5))
    np.testing.assert_allclose(kept, (eta[0, 0] * eta[0, 1]) ** 2, rtol=1e-14)
    assert np.all(energy_ratio(Damping("none", ONES), body, G, np.array([0.3])) == 1.0)
