"""Lognormal fits against scipy, their standard errors against the jackknife, and what has no fit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scenes import SHARED
from scipy import optimize, stats

import rockcli
from rockcli.analysis.fragility import ALL_EXCEED, FALLING, FITTED, NONE_EXCEEDS, SEPARABLE, fit
from rockcli.scene import statistics

RNG = np.random.default_rng(7)


def by_scipy(x, hits, trials):
    """(median, beta) by maximising the binomial likelihood with a general optimiser."""

    def loss(c):
        z = (np.log(x) - c[0]) * np.exp(-c[1])
        return -(hits * stats.norm.logcdf(z) + (trials - hits) * stats.norm.logsf(z)).sum()

    start = [np.log(np.interp(0.5 * trials.max(), np.maximum.accumulate(hits), x)), -0.5]
    found = optimize.minimize(
        loss, start, method="Nelder-Mead", options={"xatol": 1e-11, "fatol": 1e-14, "maxiter": 10000}
    )
    found = optimize.root(lambda c: optimize.approx_fprime(c, loss, 1e-7), found.x) if not found.success else found
    return np.exp(found.x)


def suite(n=42, median=3.0, beta=0.4, x=None):
    x = np.linspace(0.5, 8.0, 30) if x is None else x
    capacity = median * np.exp(beta * RNG.standard_normal((1, n)))
    exceeds = capacity[..., None] < x
    return x, exceeds, np.ones_like(exceeds)


def test_fit_is_that_of_scipy():
    for median, beta in ((3.0, 0.4), (1.2, 0.7), (6.0, 0.2)):
        x, exceeds, answered = suite(median=median, beta=beta)
        answered = RNG.random(exceeds.shape) > 0.1
        found = fit(x, exceeds, answered)
        expected = by_scipy(x, (exceeds & answered).sum(axis=1)[0], answered.sum(axis=1)[0])
        assert found.status[0] == FITTED
        np.testing.assert_allclose([found.median[0], found.beta[0]], expected, rtol=1e-6)


def test_many_fits_at_once_are_the_single_ones():
    parts = [suite(median=m)[1] for m in (2.0, 3.0, 5.0)]
    x = np.linspace(0.5, 8.0, 30)
    together = fit(x, np.concatenate(parts), np.ones((3, 42, 30), dtype=bool))
    for i, part in enumerate(parts):
        alone = fit(x, part, np.ones_like(part))
        np.testing.assert_allclose(together.median[i], alone.median[0], rtol=1e-12)
        np.testing.assert_allclose(together.se_beta[i], alone.se_beta[0], rtol=1e-9)


def test_the_unit_of_the_intensity_does_not_matter():
    x, exceeds, answered = suite()
    one, other = fit(x, exceeds, answered), fit(9.81 * x, exceeds, answered)
    np.testing.assert_allclose(other.median, 9.81 * one.median, rtol=1e-11)
    for name in ("beta", "se_ln_median", "se_beta", "correlation"):
        np.testing.assert_allclose(getattr(other, name), getattr(one, name), rtol=1e-9)


def test_a_member_divided_in_halves_is_two_of_half_the_weight():
    x, exceeds, answered = suite()
    other = suite(median=4.0)[1]
    halves = fit(x, 0.5 * (exceeds.astype(float) + other), answered)
    whole = fit(x, np.concatenate([exceeds, other], axis=1), np.concatenate([answered, answered], axis=1))
    np.testing.assert_allclose([halves.median[0], halves.beta[0]], [whole.median[0], whole.beta[0]], rtol=1e-9)


def test_standard_errors_are_those_of_the_jackknife():
    """The members are left out one by one, each with its whole curve."""
    x, exceeds, answered = suite(n=200, median=1.5, x=np.linspace(0.4, 15.0, 40))  # far from the middle of the range
    found = fit(x, exceeds, answered)
    left = np.concatenate([np.delete(exceeds, i, axis=1) for i in range(200)])
    each = fit(x, left, np.ones_like(left))
    estimates = np.stack([np.log(each.median), each.beta])
    covariance = 199**2 / 200 * np.cov(estimates, ddof=1)
    np.testing.assert_allclose([found.se_ln_median[0], found.se_beta[0]], np.sqrt(np.diag(covariance)), rtol=0.12)
    assert found.correlation[0] == pytest.approx(covariance[0, 1] / np.sqrt(np.prod(np.diag(covariance))), abs=0.05)


def test_what_has_no_fit_says_why():
    x = np.array([1.0, 2.0, 3.0, 4.0])
    shares = {
        NONE_EXCEEDS: [0, 0, 0, 0],
        ALL_EXCEED: [10, 10, 10, 10],
        SEPARABLE: [0, 0, 10, 10],
        FALLING: [8, 6, 4, 2],
        FITTED: [0, 3, 6, 10],
    }
    exceeds = np.array([[[i < k for k in row] for i in range(10)] for row in shares.values()])
    found = fit(x, exceeds, np.ones_like(exceeds))
    assert found.status.tolist() == list(shares)
    assert np.isfinite(found.median).tolist() == [status == FITTED for status in shares]
    one_mixed = np.array([[[i < k for k in (0, 4, 10, 10)] for i in range(10)]])
    assert fit(x, one_mixed, np.ones_like(one_mixed)).status[0] == SEPARABLE  # ever steeper fits it ever better
    reversed_ = exceeds[2:3, :, ::-1]
    assert fit(x, reversed_, np.ones_like(reversed_)).status[0] == FALLING


def test_no_motion_and_no_answer_are_left_out():
    x, exceeds, answered = suite()
    wider = np.concatenate([[0.0], x])
    grown = np.concatenate([np.zeros((1, 42, 1), dtype=bool), exceeds], axis=2)
    np.testing.assert_array_equal(fit(wider, grown, np.ones_like(grown)).median, fit(x, exceeds, answered).median)
    none = fit(x, exceeds, np.zeros_like(answered))
    assert none.status[0] == NONE_EXCEEDS
    assert np.isnan(none.median[0])


def test_inverse_mills_ratio_by_its_definition_and_by_its_series():
    near = np.linspace(-30.0, 8.0, 400)
    by_definition = [
        math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi) / (0.5 * math.erfc(-z / math.sqrt(2.0))) for z in near
    ]
    np.testing.assert_allclose(statistics.inverse_mills(near), by_definition, rtol=1e-12)
    far = np.linspace(-1e4, -30.0, 50)
    by_series = -far / (1.0 - far**-2 + 3.0 * far**-4 - 15.0 * far**-6)
    np.testing.assert_allclose(statistics.inverse_mills(far), by_series, rtol=1e-9)


def test_ranks_and_correlations():
    a = RNG.integers(0, 6, (5, 20)).astype(float)
    a[0, 3] = np.inf
    b = a * RNG.standard_normal((5, 20))
    np.testing.assert_array_equal(
        statistics.ranks(np.array([3.0, np.nan, 1.0, np.inf, 3.0])), [2.5, np.nan, 1.0, 4.0, 2.5]
    )
    b[0, 3] = 1.0
    for i in range(5):
        assert statistics.spearman(a[i], b[i]) == pytest.approx(stats.spearmanr(a[i], b[i])[0], rel=1e-12)
    assert statistics.pearson(a[1], b[1]) == pytest.approx(stats.pearsonr(a[1], b[1])[0], rel=1e-12)
    a[2, :4] = np.nan
    assert statistics.spearman(a[2], b[2]) == pytest.approx(stats.spearmanr(a[2, 4:], b[2, 4:])[0], rel=1e-12)
    assert np.isnan(statistics.pearson(np.ones(9), np.arange(9.0)))


FAR_FIELD = SHARED / "records/peer/p695_far_field"


@pytest.mark.slow
@pytest.mark.skipif(not FAR_FIELD.is_dir(), reason="the recorded motions are not here")
def test_forty_two_far_field_components(monkeypatch):
    monkeypatch.setenv("ROCK_RECORDS", str(FAR_FIELD))
    data = rockcli.run(
        {
            "name": "far-field",
            "case": {
                "block": {"R": 2.0, "tan_alpha": 0.2},
                "motion": {"record": {"file": "P695FF01_NORTHR_MUL009.AT2"}},
            },
            "over": "record",
            "vary": {
                "motion.record.file": "P695FF*.AT2",
                "motion.record.pga": {"from": "0.1*g", "to": "2*g", "n": 20},
            },
            "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
        }
    )
    x = data["motion_record_pga"].values
    assert data.sizes["record"] == 42
    states = {str(limit): data["theta_peak_over_alpha"].values > limit for limit in (0.1, 0.5, 1)}
    states["overturned"] = data["outcome"].values >= 2
    answered = (data["outcome"].values >= 0).sum(axis=0)
    for label, exceeds in states.items():
        found = data.sel(limit_state=label)
        expected = by_scipy(x, exceeds.sum(axis=0), answered)
        np.testing.assert_allclose([found.fragility_median, found.fragility_beta], expected, rtol=1e-6)
