"""Beyond the horizon of chaos: what can be compared is statistics (docs/extremes.md).

Harmonic ground motion, Omega = 14, on the linearized block; figures of an independent event-driven map, 200 000 impacts.
"""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, pulse, rock, unit_block

from rockcli.solvers.event import solver as event

ALPHA, OMEGA = 0.1, 14.0

CHAOS = [
    # A, eta, Lyapunov exponent per p t, mean and standard deviation of the speed after impact, quantiles, mean gap
    (48.37323115355224, 0.4, 1.07210, 0.85362, 0.46164, (0.18139, 0.48087, 0.79218, 1.22178, 1.65167), 0.78646),
    (63.5904024934078, 0.5, 0.99435, 1.12683, 0.57605, (0.29203, 0.67047, 1.05931, 1.52709, 2.17025), 0.60312),
    (94.02474517311892, 0.6, 0.98074, 1.55266, 0.71318, (0.48535, 1.00771, 1.47349, 2.02893, 2.86642), 0.56685),
]

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


def shaken(A, eta, start, duration, **how):
    motion = pulse("cosine", -A * G * ALPHA, OMEGA, t0=-0.3 / OMEGA, cycles=1e5, duration=duration)
    return rock(
        unit_block(ALPHA), motion, model="linearized", eta=eta, theta_dot_0=start * ALPHA, histories=True, **how
    )


def speeds(response, skip=1000):
    """Speeds after impact over p alpha, and their times; the first impacts still remember the start."""
    found = np.abs(response.impacts["theta_dot_after"][0, skip:]) / ALPHA
    return found, response.impacts["t_impact"][0, skip:]


def ks_distance(one, other):
    """Largest distance of two empirical distribution functions."""
    both = np.sort(np.concatenate([one, other]))
    cdf = [np.searchsorted(np.sort(x), both, side="right") / len(x) for x in (one, other)]
    return float(np.max(np.abs(cdf[0] - cdf[1])))


@pytest.fixture
def many_impacts(monkeypatch):
    monkeypatch.setattr(event, "MAX_IMPACTS_STORED", 60000)
    monkeypatch.setenv("ROCK_KERNELS", "compiled")


@pytest.mark.slow
@pytest.mark.parametrize(("A", "eta", "lyapunov", "mean", "std", "quantiles", "gap"), CHAOS)
def test_chaotic_rocking_has_the_right_statistics(A, eta, lyapunov, mean, std, quantiles, gap, many_impacts):
    speed, times = speeds(shaken(A, eta, 0.3, 40000.0, dt_out=100.0))
    assert len(speed) > 45000
    assert speed.mean() == pytest.approx(mean, rel=0.03)
    assert speed.std() == pytest.approx(std, rel=0.03)
    assert np.diff(times).mean() == pytest.approx(gap, rel=0.03)
    np.testing.assert_allclose(np.quantile(speed, QUANTILES), quantiles, rtol=0.05)


@pytest.mark.parametrize("row", [0, 2])
def test_two_histories_lost_to_chaos_keep_their_distribution(row, many_impacts):
    """A start moved by 1e-12: the histories part at p t of about 23, the distributions of impact speeds do not."""
    A, eta = CHAOS[row][:2]
    one, other = (speeds(shaken(A, eta, start, 4000.0, dt_out=10.0), 100) for start in (0.3, 0.3 * (1.0 + 1e-12)))
    n = min(len(one[0]), len(other[0]))
    assert n > 4500
    late = slice(n // 2, n)
    assert np.max(np.abs(one[0][late] - other[0][late])) > 0.1  # nothing is left of the agreement
    assert ks_distance(one[0], other[0]) < 0.04  # 1.6 sqrt(2/n), n independent speeds: .034
    # a wrong eta is seen at once
    wrong, _ = speeds(shaken(A, eta + 0.05, 0.3, 4000.0, dt_out=10.0), 100)
    assert ks_distance(one[0], wrong) > 0.06


@pytest.mark.parametrize("row", [0, 1, 2])
def test_horizon_of_comparison(row, monkeypatch):
    """1e-12 grows to 1e-2 within p t = ln(1e10)/lambda on average over starts."""
    monkeypatch.setenv("ROCK_KERNELS", "compiled")
    A, eta, lyapunov = CHAOS[row][:3]
    horizons = []
    for start in np.linspace(0.2, 0.9, 12):
        one, other = (
            shaken(A, eta, x, 60.0, dt_out=0.02).histories["theta"][0] / ALPHA for x in (start, start * (1.0 + 1e-12))
        )
        apart = np.abs(one - other)
        first, last = np.flatnonzero(apart > 1e-10)[0], np.flatnonzero(apart > 1e-2)[0]
        horizons.append(0.02 * (last - first))
    assert np.log(1e8) / np.mean(horizons) == pytest.approx(lyapunov, rel=0.25)
