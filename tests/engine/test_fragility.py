"""Fragility curves against statsmodels and scipy, their limits by simulation, and what has no curve."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from half_sines import SUITE
from scenes import SHARED
from scipy import optimize, stats

import rockcli
from rockcli.analysis.fragility.curves import (
    ALL_EXCEED,
    BELOW,
    COLLINEAR,
    FALLING,
    FITTED,
    LOGNORMAL,
    NONE_EXCEEDS,
    ORDINAL,
    SEPARABLE,
    Curves,
    Seen,
    curve_of_capacities,
    curves,
)
from rockcli.analysis.fragility.misfit import LEVEL, two_sided
from rockcli.scene import variables
from rockcli.scene.uncertain import statistics

X = np.linspace(0.5, 8.0, 30)


def seen(category, x=X, weight=None) -> Seen:
    category = np.asarray(category)
    x = np.broadcast_to(np.asarray(x, dtype=float), category.shape)
    return Seen(x, category, category, np.ones(category.shape) if weight is None else np.asarray(weight, dtype=float))


def suite(n=42, medians=(3.0,), beta=0.4, x=X, begins=0.0, seed=7, own=0.1):
    """Categories of members whose capacities are lognormal above `begins`, the same of a member at every intensity."""
    rng = np.random.default_rng(seed)
    common = np.exp(math.sqrt(beta**2 - (own**2 if len(medians) > 1 else 0.0)) * rng.standard_normal((n, 1)))
    part = np.exp(own * rng.standard_normal((n, len(medians)))) if len(medians) > 1 else 1.0
    capacity = np.sort(begins + (np.array(medians) - begins) * common * part, axis=1)
    return (capacity[:, :, None] < np.asarray(x)).sum(axis=1)


def clustered(x, exceeds):
    """Median, beta and the standard errors of ln(median) and beta by statsmodels' probit, clustered by member."""
    sm = pytest.importorskip("statsmodels.api")
    n, k = exceeds.shape
    u = sm.add_constant(np.tile(np.log(x), n))
    model = sm.Probit(exceeds.ravel().astype(float), u)
    group = {"groups": np.repeat(np.arange(n), k), "use_correction": False}
    found = model.fit(disp=0, method="newton", tol=1e-12, cov_type="cluster", cov_kwds=group)
    a, b = found.params
    to_median, to_beta = np.array([-1.0 / b, a / b**2]), np.array([0.0, -1.0 / b**2])
    covariance = found.cov_params() * n / (n - 1)
    return np.exp(-a / b), 1.0 / b, *(math.sqrt(v @ covariance @ v) for v in (to_median, to_beta))


@pytest.mark.parametrize(("median", "beta"), [(3.0, 0.4), (1.2, 0.7), (6.0, 0.2)])
@pytest.mark.parametrize("fit", [LOGNORMAL, ORDINAL])
def test_one_state_is_the_clustered_probit_of_statsmodels(median, beta, fit):
    category = suite(medians=(median,), beta=beta)
    found = curves(seen(category), 1, fit=fit)
    expected = clustered(X, category > 0)
    got = (found.median[0], found.beta[0], found.se_ln_median[0], found.se_beta[0])
    np.testing.assert_allclose(got[:2], expected[:2], rtol=1e-6)
    np.testing.assert_allclose(got[2:], expected[2:], rtol=1e-3)


def crossed(records=15, samples=12, seed=4):
    """Categories of members under `records`, of `samples` that they share, capacities at random by both; rows, samples."""
    draw = np.random.default_rng(seed)
    ln = 0.2 * draw.standard_normal((records, 1)) + 0.4 * draw.standard_normal((1, samples))
    capacity = 3.0 * np.exp(ln + 0.2 * draw.standard_normal((records, samples))).ravel()
    rows, shared = np.repeat(np.arange(records), samples), np.tile(np.arange(samples), records)
    return capacity, (capacity[:, None] < X).astype(np.int64), rows, shared


def test_samples_that_records_share_are_clustered_as_by_statsmodels():
    sm = pytest.importorskip("statsmodels.api")
    _, category, rows, shared = crossed()
    n, k = category.shape
    model = sm.Probit(category.ravel().astype(float), sm.add_constant(np.tile(np.log(X), n)))
    of_both = []
    for groups in (rows, shared, np.arange(n)):
        group = {"groups": np.repeat(groups, k), "use_correction": False}
        found = model.fit(disp=0, method="newton", tol=1e-12, cov_type="cluster", cov_kwds=group)
        j = len(np.unique(groups))
        of_both.append(found.cov_params() * j / (j - 1))
    (a, b), covariance = found.params, of_both[0] + of_both[1] - of_both[2]
    expected = [math.sqrt(v @ covariance @ v) for v in (np.array([-1.0 / b, a / b**2]), np.array([0.0, -1.0 / b**2]))]
    alone = seen(category)
    made = curves(Seen(alone.x, alone.low, alone.high, alone.weight, rows, shared=shared), 1)
    np.testing.assert_allclose([made.se_ln_median[0], made.se_beta[0]], expected, rtol=1e-3)


def test_medians_hold_the_truth_where_records_share_samples():
    held = np.zeros(2)
    for seed in range(40):
        capacity, category, rows, shared = crossed(seed=seed)
        found = curves(
            Seen(*(getattr(seen(category), of) for of in ("x", "low", "high", "weight")), rows, shared=shared), 1
        )
        searched = curve_of_capacities(capacity, capacity, rows, shared=shared)
        for i, made in enumerate((found, searched)):
            low, high = made.median_limits()
            held[i] += low[0] <= 3.0 <= high[0]
    assert (held > 33).all()


def test_nested_states_are_the_ordered_probit_of_statsmodels():
    ordinal = pytest.importorskip("statsmodels.miscmodels.ordinal_model")
    category = suite(medians=(1.5, 3.0, 3.6), beta=0.4)
    found = curves(seen(category), 3)
    u = np.tile(np.log(X), len(category))[:, None]
    model = ordinal.OrderedModel(category.ravel(), u, distr="probit").fit(method="bfgs", disp=0, gtol=1e-7, maxiter=500)
    slope = float(model.params[0])
    cuts = model.model.transform_threshold_params(model.params[1:])[1:-1]
    np.testing.assert_allclose(found.median, np.exp(cuts / slope), rtol=1e-6)
    np.testing.assert_allclose(found.beta, 1.0 / slope, rtol=1e-6)


def by_scipy(category, weight, x=X):
    """Medians and the one beta of nested states, by a general optimiser on the likelihood as it is written in books."""
    top = category.max()

    def loss(c):
        cuts = np.concatenate([[-np.inf], c[1] + np.concatenate([[0.0], np.cumsum(np.exp(c[2:]))]), [np.inf]])
        eta = np.exp(c[0]) * np.log(x)
        p = stats.norm.cdf(cuts[category + 1] - eta) - stats.norm.cdf(cuts[category] - eta)
        return -(weight * np.log(np.maximum(p, 1e-300))).sum()

    start = np.concatenate([[1.0, 0.0], np.full(top - 1, 0.0)])
    found = optimize.minimize(
        loss, start, method="Nelder-Mead", options={"xatol": 1e-11, "fatol": 1e-13, "maxiter": 20000}
    )
    cuts = found.x[1] + np.concatenate([[0.0], np.cumsum(np.exp(found.x[2:]))])
    return np.exp(cuts / np.exp(found.x[0])), np.exp(-found.x[0])


def test_nested_states_with_members_missing_are_those_of_scipy():
    category = suite(medians=(1.5, 3.0))
    weight = (np.random.default_rng(2).random(category.shape) > 0.1).astype(float)
    found = curves(seen(category, weight=weight), 2)
    medians, beta = by_scipy(category, weight)
    np.testing.assert_allclose(found.median, medians, rtol=1e-6)
    np.testing.assert_allclose(found.beta, beta, rtol=1e-6)


def test_nested_curves_never_cross_where_single_ones_do():
    rng = np.random.default_rng(4)
    crossing = 0
    for seed in range(40):
        category = suite(n=12, medians=(2.0, 2.2, 2.3), beta=0.5, own=0.45, seed=seed)
        x = np.exp(rng.uniform(-6.0, 6.0, 400))
        for fit in (ORDINAL, LOGNORMAL):
            found = curves(seen(category), 3, fit=fit)
            p = stats.norm.cdf(np.log(x[:, None] / found.median) / found.beta)
            crosses = bool((np.diff(p[:, np.isfinite(found.median)], axis=1) > 1e-12).any())
            if fit == ORDINAL:
                assert not crosses
            crossing += crosses
    assert crossing > 20  # so that the assertion above could fail


def test_limits_are_no_finer_than_the_step_within_which_all_exceed_a_state():
    """All members begin to exceed the first state between .3 and .4: no scatter is seen, and more is not known."""
    x = np.broadcast_to([0.1, 0.2, 0.3, 0.4, 0.6, 0.8], (6, 6))
    overturns = np.array([0.4, 0.6, 0.6, 0.8, 0.8, 1.0])  # the intensities from which members overturn
    categories = (x > 0.35).astype(np.int64) + (x >= overturns[:, None])
    made = curves(Seen(x, categories, categories, np.ones(x.shape)), 2)
    low, high = made.median_limits()
    assert made.status.tolist() == [FITTED, FITTED]
    assert low[0] <= 0.3 * (1.0 + 1e-12)
    assert high[0] >= 0.4 * (1.0 - 1e-12)
    assert low[0] < made.median[0] < high[0]


def test_states_that_no_case_tells_apart_share_a_curve():
    category = suite(medians=(1.5, 3.0))
    category = np.where(category == 2, 3, category)  # whoever passes the second limit passes the third
    found = curves(seen(category), 3)
    two = curves(seen(np.minimum(category, 2)), 2)
    assert found.median[1] == found.median[2]
    np.testing.assert_allclose(found.median[:2], two.median, rtol=1e-10)


def test_a_member_divided_in_halves_is_two_of_half_the_weight():
    one, other = suite(medians=(1.5, 3.0), seed=1), suite(medians=(2.0, 4.0), seed=2)
    x = np.broadcast_to(X, one.shape)
    both = np.concatenate([one, other], axis=1)
    halves = Seen(np.concatenate([x, x], axis=1), both, both, np.full(both.shape, 0.5))
    found, whole = curves(halves, 2), curves(seen(np.concatenate([one, other])), 2)
    np.testing.assert_allclose(found.median, whole.median, rtol=1e-9)
    np.testing.assert_allclose(found.beta, whole.beta, rtol=1e-9)


def test_a_member_known_to_stand_is_no_more_than_that():
    """Rows in the range 0 ... top-1 tell the highest state alone: they are the probit of two categories."""
    category = suite(medians=(1.5, 3.0))
    fell = (category == 2).astype(np.int64)
    ranged = Seen(np.broadcast_to(X, category.shape), 2 * fell, fell + 1, np.ones(category.shape))
    exact = seen(suite(medians=(1.5, 3.0)))
    joined = Seen(*(np.concatenate([getattr(a, f) for a in (exact, ranged)]) for f in ("x", "low", "high", "weight")))
    found = curves(joined, 2)

    def loss(c):
        eta, t = np.exp(c[0]) * np.log(X), (c[1], c[1] + np.exp(c[2]))
        cuts = np.array([-np.inf, *t, np.inf])
        p = stats.norm.cdf(cuts[category + 1] - eta) - stats.norm.cdf(cuts[category] - eta)
        q = np.where(fell, stats.norm.sf(t[1] - eta), stats.norm.cdf(t[1] - eta))
        return -(np.log(np.maximum(p, 1e-300)) + np.log(np.maximum(q, 1e-300))).sum()

    best = optimize.minimize(
        loss, [1.0, 0.5, 0.0], method="Nelder-Mead", options={"xatol": 1e-11, "fatol": 1e-13, "maxiter": 9000}
    )
    cuts = best.x[1] + np.array([0.0, np.exp(best.x[2])])
    np.testing.assert_allclose(found.median, np.exp(cuts * np.exp(-best.x[0])), rtol=1e-6)


def test_curves_that_begin_at_uplift_are_those_of_the_intensity_above_it():
    category = suite(medians=(2.0, 3.0), beta=0.6, begins=1.0)
    found = curves(seen(category), 2, begins_at=1.0)
    above = X > 1.0
    moved = curves(seen(category[:, above], X[above] - 1.0), 2)
    np.testing.assert_allclose(found.median, 1.0 + moved.median, rtol=1e-12)
    np.testing.assert_allclose(found.percentiles(0.0), 1.0 + moved.percentiles(0.0), rtol=1e-12)
    assert (found.percentiles(0.3) > 1.0).all()
    low, high = found.median_limits()
    assert (low > 1.0).all()
    assert (high > found.median).all()
    early = curves(seen(suite(medians=(0.8, 3.0), beta=0.2)), 2, begins_at=1.0)
    assert early.status[0] == BELOW


def test_percentiles_and_added_uncertainty():
    found = curves(seen(suite()), 1)
    p = stats.norm.cdf(np.log(found.percentiles(0.0)[0] / found.median[0]) / found.beta[0])
    np.testing.assert_allclose(p, [0.01, 0.05, 0.1, 0.16, 0.5, 0.84, 0.95], rtol=1e-12)
    total = math.hypot(found.beta[0], 0.3)
    np.testing.assert_allclose(found.percentiles(0.3)[0, 0], found.median[0] * math.exp(-2.3263478740408408 * total))


def test_the_unit_of_the_intensity_does_not_matter():
    category = suite(medians=(1.5, 3.0))
    one, other = curves(seen(category), 2), curves(seen(category, 9.81 * X), 2)
    np.testing.assert_allclose(other.median, 9.81 * one.median, rtol=1e-10)
    for name in ("beta", "se_ln_median", "se_beta", "correlation"):
        np.testing.assert_allclose(getattr(other, name), getattr(one, name), rtol=1e-7)


@pytest.mark.slow
def test_standard_errors_are_those_of_the_jackknife():
    """The members are left out one by one, each with its whole curve."""
    x = np.linspace(0.4, 15.0, 40)  # the median is far from the middle of the range
    category = suite(n=200, medians=(1.5, 2.5), x=x)
    found = curves(seen(category, x), 2)
    each = [curves(seen(np.delete(category, i, axis=0), x), 2) for i in range(200)]
    estimates = np.array([[np.log(one.median[1]), one.beta[1]] for one in each]).T
    covariance = 199**2 / 200 * np.cov(estimates, ddof=1)
    np.testing.assert_allclose([found.se_ln_median[1], found.se_beta[1]], np.sqrt(np.diag(covariance)), rtol=0.12)
    assert found.correlation[1] == pytest.approx(covariance[0, 1] / np.sqrt(np.prod(np.diag(covariance))), abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("n", "begins"), [(42, 1.0), (100, 0.0)])
def test_the_limits_of_the_median_hold_it_in_95_of_100_suites(n, begins):
    """Of 2000 synthetic suites of three states each, so that the share is known to 0.5 %."""
    medians, held = np.array([2.0, 3.0, 4.0]), np.zeros(3)
    for seed in range(2000):
        category = suite(n=n, medians=medians, beta=0.5, begins=begins, seed=seed, own=1e-6)
        low, high = curves(seen(category), 3, begins_at=begins).median_limits()
        held += (low <= medians) & (medians <= high)
    assert ((held >= 1880) & (held <= 1920)).all(), held / 2000


def test_one_member_has_a_curve_and_no_limits():
    """It stands again above an intensity that overturned it; that of the others there would be nobody knows."""
    alone = curves(seen([[0, 0, 1, 0, 1, 1]], np.arange(1.0, 7.0)), 1)
    assert alone.status[0] == FITTED
    pair = curves(seen([[0, 0, 1, 0, 1, 1], [0, 1, 0, 1, 1, 1]], np.arange(1.0, 7.0)), 1)
    for found, told in ((alone, False), (pair, True)):
        limits = [*found.median_limits(), *found.beta_limits(), found.se_ln_median, found.se_beta]
        assert (np.isfinite(limits) == told).all()


def test_what_has_no_fit_says_why():
    x = np.array([1.0, 2.0, 3.0, 4.0])
    shares = {
        NONE_EXCEEDS: [0, 0, 0, 0],
        ALL_EXCEED: [10, 10, 10, 10],
        SEPARABLE: [0, 0, 10, 10],
        FALLING: [8, 6, 4, 2],
        FITTED: [0, 3, 6, 10],
    }
    for fit in (ORDINAL, LOGNORMAL):
        for status, row in shares.items():
            found = curves(seen([[int(i < k) for k in row] for i in range(10)], x), 1, fit=fit)
            assert found.status[0] == status
            assert np.isfinite(found.median[0]) == (status == FITTED)
        one_mixed = curves(seen([[int(i < k) for k in (0, 4, 10, 10)] for i in range(10)], x), 1, fit=fit)
        assert one_mixed.status[0] == SEPARABLE  # ever steeper fits it ever better
        for seed in range(20):  # half of the members at every intensity, whichever side rounding falls on
            levels = np.sort(np.random.default_rng(seed).uniform(1.0, 15.0, 6))
            assert curves(seen([[0] * 6, [1] * 6], levels), 1, fit=fit).status[0] == FALLING
    # with another state that tells the slope, it has a curve of that slope
    both = [[int(i < k) + int(i < m) for k, m in zip((1, 4, 10, 10), (0, 0, 7, 9), strict=True)] for i in range(10)]
    assert (curves(seen(both, x), 2).status == FITTED).all()
    nothing: Curves = curves(seen(suite()), 1, fit="none")
    assert np.isnan(nothing.median[0])


def test_no_motion_and_no_answer_are_left_out():
    category = suite()
    wider = np.concatenate([np.zeros((42, 1), dtype=int), category], axis=1)
    grown = curves(seen(wider, np.concatenate([[0.0], X])), 1)
    np.testing.assert_array_equal(grown.median, curves(seen(category), 1).median)
    none = curves(seen(category, weight=np.zeros(category.shape)), 1)
    assert none.status[0] == NONE_EXCEEDS
    assert np.isnan(none.median[0])


def test_ranks_and_correlations():
    rng = np.random.default_rng(7)
    a = rng.integers(0, 6, (5, 20)).astype(float)
    a[0, 3] = np.inf
    b = a * rng.standard_normal((5, 20))
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


def two_intensities(n=60, seed=5, exponent=0.8):
    """Capacities of members in x that go with y^-exponent; y is a member's own."""
    rng = np.random.default_rng(seed)
    y = np.exp(0.5 * rng.standard_normal((n, 1)))
    capacity = 3.0 * y**-exponent * np.exp(0.35 * rng.standard_normal((n, 1)))
    return (capacity < X).astype(int), np.broadcast_to(y, (n, len(X)))


def test_a_divided_member_counts_once_in_the_mean_of_the_second_intensity():
    """The part that stands and the part that overturns are two rows of one case."""
    draw = np.random.default_rng(1)
    x, y = np.exp(draw.standard_normal((2, 40, 1)))
    fell = (x * y**0.5 * np.exp(0.3 * draw.standard_normal((40, 1))) > 1.0).astype(np.int64)
    stands = np.where(np.arange(40) < 8, 0.6, 1.0)[:, None]
    both = [np.concatenate(pair, axis=1) for pair in ((x, x), (fell, 1 - fell), (stands, 1.0 - stands), (y, y))]
    made = curves(Seen(both[0], both[1], both[1], both[2], second=both[3]), 1)
    assert made.second_at == pytest.approx(stats.gmean(y.ravel()), rel=1e-12)


def test_two_intensities_are_the_clustered_probit_of_two_regressors_of_statsmodels():
    sm = pytest.importorskip("statsmodels.api")
    category, y = two_intensities()
    n, k = category.shape
    found = curves(replace(seen(category), second=y), 1)
    u = sm.add_constant(np.column_stack([np.tile(np.log(X), n), np.log(y).ravel()]))
    group = {"groups": np.repeat(np.arange(n), k), "use_correction": False}
    model = sm.Probit(category.ravel().astype(float), u)
    fitted = model.fit(disp=0, method="newton", tol=1e-12, cov_type="cluster", cov_kwds=group)
    a, s1, s2 = fitted.params
    at = np.log(found.second_at)
    assert found.second_at == pytest.approx(np.exp(np.log(y).mean()), rel=1e-12)
    np.testing.assert_allclose(found.median[0], np.exp(-(a + s2 * at) / s1), rtol=1e-6)
    np.testing.assert_allclose([found.beta[0], found.exponent[0]], [1.0 / s1, s2 / s1], rtol=1e-6)
    covariance = fitted.cov_params() * n / (n - 1)
    gradients = {
        "se_ln_median": [-1.0 / s1, (a + s2 * at) / s1**2, -at / s1],
        "se_beta": [0.0, -1.0 / s1**2, 0.0],
        "se_exponent": [0.0, -s2 / s1**2, 1.0 / s1],
    }
    for name, gradient in gradients.items():
        expected = math.sqrt(np.array(gradient) @ covariance @ np.array(gradient))
        assert getattr(found, name)[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_a_second_intensity_that_matters_narrows_the_curve():
    """The scatter that y explains is no scatter of the curve; of the exponent 95 % limits hold the true one."""
    held = 0
    for seed in range(200):
        category, y = two_intensities(seed=seed)
        alone, both = curves(seen(category), 1), curves(replace(seen(category), second=y), 1)
        assert both.beta[0] < alone.beta[0]
        low, high = both.exponent_limits()
        held += int(low[0] <= 0.8 <= high[0])
    assert 184 <= held <= 197  # 190 expected, 2 sigma = 6


def test_medians_are_told_at_the_mean_of_the_second_intensity_over_what_is_fitted():
    """Of a cloud what lies below uplift is in no fit, nor in the mean."""
    rng = np.random.default_rng(3)
    x, y = (np.exp(0.6 * rng.standard_normal((80, 1))) for _ in range(2))
    exceeds = (x * y * np.exp(0.3 * rng.standard_normal(x.shape)) > 1.5).astype(int) * (x > 0.8)
    found = curves(replace(seen(exceeds, x), second=y), 1, begins_at=0.8)
    assert found.second_at == pytest.approx(stats.gmean(y[x > 0.8]), rel=1e-12)
    assert found.second_at != pytest.approx(stats.gmean(y[:, 0]), rel=1e-3)


def test_two_intensities_that_are_one_have_no_curve():
    category, y = two_intensities()
    for second in (np.ones(y.shape), np.broadcast_to(X**2, y.shape)):
        assert curves(replace(seen(category), second=second), 1).status[0] == COLLINEAR
    no_second = curves(
        replace(seen(category), second=np.where(y > 1.0, y, np.nan)), 1
    )  # left out where it is not known
    kept = (y > 1.0)[:, 0]
    few = curves(replace(seen(category[kept]), second=y[kept]), 1)
    assert no_second.median[0] == pytest.approx(few.median[0], rel=1e-10)


def test_capacities_that_are_known_are_a_lognormal_sample():
    """Median and its limits are those of the mean of logarithms by Student, whatever the curve begins at."""
    rng = np.random.default_rng(4)
    for begins in (0.0, 1.5):
        u = 0.3 + 0.5 * rng.standard_normal(25)
        x = begins + np.exp(u)
        found = curve_of_capacities(x, x, np.arange(25), begins)
        np.testing.assert_allclose(np.log(found.median[0] - begins), u.mean(), rtol=1e-10)
        np.testing.assert_allclose(found.beta[0], u.std(), rtol=1e-9)
        low, high = stats.t.interval(0.95, 24, u.mean(), u.std(ddof=1) / 5.0)
        np.testing.assert_allclose(np.ravel(found.median_limits()), begins + np.exp([low, high]), rtol=1e-9)


def test_capacities_that_are_censored_are_those_of_scipy():
    rng = np.random.default_rng(9)
    x = np.exp(0.3 + 0.5 * rng.standard_normal(60))
    low, high = x.copy(), x.copy()
    low[x < 0.8], high[x < 0.8] = 0.0, 0.8  # below the range
    high[x > 2.2], low[x > 2.2] = np.inf, 2.2  # above it
    between = (x > 1.0) & (x < 1.2)
    low[between], high[between] = 1.0, 1.2
    found = curve_of_capacities(low, high, np.arange(60))
    exact = low == high

    def loss(c):
        beta = np.exp(c[1])
        z = [(np.log(np.maximum(end, 1e-300)) - c[0]) / beta for end in (low, high)]
        p = stats.norm.cdf(z[1][~exact]) - stats.norm.cdf(z[0][~exact])
        return -(stats.norm.logpdf(z[1][exact]) - c[1]).sum() - np.log(p).sum()

    best = optimize.minimize(
        loss, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-11, "fatol": 1e-13, "maxiter": 9000}
    )
    np.testing.assert_allclose([np.log(found.median[0]), found.beta[0]], [best.x[0], np.exp(best.x[1])], rtol=1e-7)


def test_limits_of_censored_capacities_hold_the_median():
    """A third above the range: of 1000 suites 95 % +- 1.4 % (2 sigma) hold it."""
    held = 0
    for seed in range(1000):
        x = np.exp(0.5 * np.random.default_rng(seed).standard_normal(42))
        low, high = np.where(x > 1.25, 1.25, x), np.where(x > 1.25, np.inf, x)
        below, above = curve_of_capacities(low, high, np.arange(42)).median_limits()
        held += int(below[0] <= 1.0 <= above[0])
    assert 936 <= held <= 964, held


def test_capacities_without_a_curve_say_why():
    n = np.arange(3)
    full = np.full(3, np.inf)
    assert curve_of_capacities(np.full(3, 2.0), full, n).status[0] == NONE_EXCEEDS
    assert curve_of_capacities(np.zeros(3), np.ones(3), n).status[0] == ALL_EXCEED
    assert curve_of_capacities(np.full(3, 2.0), np.full(3, 2.0), n).status[0] == SEPARABLE
    assert curve_of_capacities(np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 3.0]), n, 1.5).status[0] == BELOW


FAR_FIELD = SHARED / "records/peer/p695_far_field"


@pytest.mark.slow
@pytest.mark.skipif(not FAR_FIELD.is_dir(), reason="the recorded motions are not here")
def test_forty_two_far_field_components(monkeypatch):
    monkeypatch.setenv("ROCK_RECORDS", str(FAR_FIELD))

    def far_field(**over):
        return {
            "name": "far-field",
            "case": {
                "block": {"R": 2.0, "tan_alpha": 0.2},
                "motion": {"record": {"file": "P695FF01_NORTHR_MUL009.AT2"}},
            },
            "over": {"axis": "record", **over},
            "vary": {
                "motion.record.file": "P695FF*.AT2",
                "motion.record.pga": {"from": "0.1*g", "to": "2*g", "n": 20},
            },
            "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
        }

    data = rockcli.run(far_field())
    assert data.sizes["record"] == 42
    assert (data["fragility_status"] == FITTED).all()
    assert data["fragility_begins_at"].values == pytest.approx(0.2 * 9.81, rel=1e-12)
    assert (np.diff(data["fragility_median"].values) >= 0.0).all()
    assert np.ptp(data["fragility_beta"].values) == 0.0  # with ordered medians: the curves never cross
    assert (data["fragility_percentile"] > data["fragility_begins_at"]).all()
    # one by one against statsmodels, on the intensity above uplift
    x = data["motion_record_pga"].values
    above = x > 0.2 * 9.81 * (1.0 + 1e-9)
    alone = rockcli.run(far_field(fit="lognormal"))
    states = {str(limit): data["theta_peak_over_alpha"].values > limit for limit in (0.1, 0.5, 1)}
    states["overturned"] = data["outcome"].values >= 2
    assert (data["outcome"].values >= 0).all()
    for label, exceeds in states.items():
        assert not exceeds[:, ~above].any()
        found = alone.sel(limit_state=label)
        expected = clustered(x[above] - 0.2 * 9.81, exceeds[:, above])
        assert float(found.fragility_median) - 0.2 * 9.81 == pytest.approx(expected[0], rel=1e-6)
        got = [float(found.fragility_beta), float(found.fragility_se_ln_median), float(found.fragility_se_beta)]
        np.testing.assert_allclose(got, expected[1:], rtol=1e-3)


def second_intensity(n: int, seed: int):
    """Members whose capacity goes with the power -.8 of a second intensity, at every intensity of X."""
    rng = np.random.default_rng(seed)
    y = np.exp(0.5 * rng.standard_normal((n, 1)))
    category = (3.0 * np.exp(0.5 * rng.standard_normal((n, 1))) * y**-0.8 < X).astype(int)
    return category, np.broadcast_to(y, category.shape)


def test_the_exponent_has_the_scatter_of_fits_without_one_member_after_another():
    """The jackknife by fitting again n times is an independent way to the covariance by one Newton step."""
    category, y = second_intensity(42, 3)

    def of(kept) -> Curves:
        one = category[kept]
        return curves(Seen(np.broadcast_to(X, one.shape), one, one, np.ones(one.shape), second=y[kept]), 1)

    n = len(category)
    left = np.array([of(np.arange(n) != i).exponent[0] for i in range(n)])
    by_hand = math.sqrt((n - 1) / n * ((left - left.mean()) ** 2).sum())
    np.testing.assert_allclose(of(np.arange(n)).jackknife[0, 3] ** 0.5, by_hand, rtol=0.05)


@pytest.mark.parametrize(("n", "begins"), [(12, 1.0), pytest.param(42, 0.0, marks=pytest.mark.slow)])
def test_limits_hold_small_percentiles_as_often_as_they_say(n, begins):
    true = begins + (3.0 - begins) * np.exp(0.5 * stats.norm.ppf([0.01, 0.05]))
    suites, held = 250, np.zeros(2)
    for seed in range(suites):
        category = suite(n=n, medians=(3.0,), beta=0.5, begins=begins, seed=seed)
        low, high = curves(seen(category), 1, begins_at=begins).percentile_limits(0.0)
        held += (low[0, :2] <= true) & (high[0, :2] >= true)
    # 95 % of 250 within 4 standard errors; the delta method holds 86 to 92 %
    assert (held >= stats.binom.ppf(stats.norm.cdf(-2.5), suites, 0.95)).all()
    assert (held < suites).all()


def test_limits_of_a_percentile_of_known_capacities_are_those_of_a_normal_sample():
    """Tolerance limits of Owen (1968) on the logarithms, up to the scatter of the variance of beta."""
    u = np.random.default_rng(5).standard_normal(400) * 0.4 + 1.0
    found = curve_of_capacities(np.exp(u), np.exp(u), np.arange(400))
    low, high = found.percentile_limits(0.0)
    z, n = stats.norm.ppf(0.05), len(u)
    exact = np.exp(u.mean() + u.std(ddof=1) * stats.nct.ppf([0.025, 0.975], n - 1, z * n**0.5) / n**0.5)
    width = np.log(exact[1] / exact[0])
    assert abs(np.log(low[0, 1] / exact[0])) < 0.03 * width
    assert abs(np.log(high[0, 1] / exact[1])) < 0.03 * width


@pytest.mark.parametrize("n", [5, 12])
def test_limits_of_beta_hold_it_as_often_as_they_say(n):
    suites, held = 250, 0
    for seed in range(suites):
        low, high = curves(seen(suite(n=n, medians=(3.0,), beta=0.5, seed=seed)), 1).beta_limits()
        held += low[0] <= 0.5 <= high[0]
    # 95 % of 250 within 2.5 standard errors; Student's t on the logarithm holds 87 %
    assert stats.binom.ppf(stats.norm.cdf(-2.5), suites, 0.95) <= held < suites


def test_limits_of_beta_of_known_capacities_are_those_of_a_normal_sample():
    """By chi-square of the variance, up to the scatter of its own variance; below without the bias of the maximum."""
    u = np.random.default_rng(5).standard_normal(400) * 0.4 + 1.0
    low, high = curve_of_capacities(np.exp(u), np.exp(u), np.arange(400)).beta_limits()
    least, most = u.std(ddof=1) * np.sqrt(399.0 / stats.chi2.ppf([0.975, 0.025], 399))
    assert abs(low[0] - least) < 0.03 * (most - least)
    assert abs(high[0] - most) < 0.03 * (most - least)


@pytest.mark.parametrize("n", [3, 5, 6, 8, 12])
def test_the_median_bounds_the_limits_of_percentiles(n):
    half = variables.PERCENTILES.index(50.0)
    seldom = 0
    for seed in range(20):
        found = curves(seen(suite(n=n, medians=(3.0,), beta=0.5, seed=seed)), 1)
        (low,), (high,) = found.percentile_limits(0.2)
        if found.status[0] != FITTED or np.isnan(low).any():
            continue
        (least,), (most,) = found.median_limits()
        assert (low[half], high[half]) == (least, most)
        # what more motions exceed is no lower: neither are its limits
        assert (high[:half] <= most).all()
        assert (low[:half] <= least).all()
        assert (low[half:] >= least).all()
        assert (high[half:] >= most).all()
        seldom += high[0] == most
    assert seldom < 15


def test_added_uncertainty_moves_percentiles_with_their_limits():
    found = curves(seen(suite()), 1)
    for added in (0.0, 0.4):
        middle, (low, high) = found.percentiles(added), found.percentile_limits(added)
        assert ((low < middle) & (middle < high)).all()
    assert found.percentile_limits(0.4)[0][0, 0] < found.percentile_limits(0.0)[0][0, 0]


def test_a_share_is_judged_by_the_binomial_distribution_of_scipy():
    for n, hits, p in ((42, 3, 0.3), (42, 20, 0.3), (12, 0, 0.2), (12, 12, 0.7), (100, 50, 0.5)):
        tails = stats.binom.cdf(hits, n, p), stats.binom.sf(hits - 1, n, p)
        found = two_sided(np.array([hits / n]), np.array([float(n)]), np.array([p]))
        np.testing.assert_allclose(found[0], min(1.0, 2.0 * min(tails)), rtol=1e-9)


def test_a_curve_that_misses_its_suite_is_told_and_no_other():
    """Capacities of two kinds are no lognormal; those of a lognormal are missed in fewer than one of a hundred."""
    told = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        of_two = np.where(rng.random(60) < 0.4, 1.0, 5.0) * np.exp(0.1 * rng.standard_normal(60))
        found = curves(seen((of_two[:, None] < X).astype(int)), 1)
        told += bool(found.misfit_p[0] < LEVEL)
        assert 1.0 < found.misfit_at[0] < 5.0
        assert curves(seen(suite(seed=seed)), 1).misfit_p[0] >= LEVEL
    assert told > 54


def test_a_searched_curve_that_misses_its_capacities_is_told():
    rng = np.random.default_rng(1)
    of_two = np.where(rng.random(100) < 0.4, 1.0, 5.0) * np.exp(0.1 * rng.standard_normal(100))
    alike = np.exp(0.4 * rng.standard_normal(100))
    for capacity, misses in ((of_two, True), (alike, False)):
        assert (curve_of_capacities(capacity, capacity, np.arange(100)).misfit_p[0] < LEVEL) == misses


def test_a_cloud_is_judged_in_groups():
    rng = np.random.default_rng(2)
    x = np.exp(1.0 + 0.7 * rng.standard_normal((400, 1)))
    of_two = np.where(rng.random((400, 1)) < 0.4, 1.0, 7.0) * np.exp(0.1 * rng.standard_normal((400, 1)))
    alike = 3.0 * np.exp(0.5 * rng.standard_normal((400, 1)))
    for capacity, misses in ((of_two, True), (alike, False)):
        assert (curves(seen((capacity < x).astype(int), x=x), 1).misfit_p[0] < LEVEL) == misses


@pytest.mark.parametrize("seed", range(6))
def test_few_members_between_two_states_do_not_widen_limits(seed):
    """Without one of them two states are one: the limits are those of fits without one member after another."""
    x = np.linspace(1.0, 8.0, 8)
    capacity = np.exp(np.random.default_rng(seed).normal(np.log(3.0), 0.4, 20))[:, None]
    falls = capacity * np.where(np.arange(20) == np.argsort(capacity[:, 0])[9], 1.6, 1.0)[:, None]
    category = (x > capacity).astype(int) + (x > falls)
    assert 0 < len(np.unique(np.nonzero(category == 1)[0])) <= 2
    found = curves(seen(category, x), 2)
    each = [curves(seen(np.delete(category, i, axis=0), x), 2) for i in range(20)]
    for state in (0, 1):
        left = np.array([[np.log(one.median[state]), one.beta[state]] for one in each]) - np.array(
            [np.log(found.median[state]), found.beta[state]]
        )
        by_hand = left.T @ left * 19 / 20
        np.testing.assert_allclose(found.jackknife[state, [0, 2]], np.diag(by_hand), rtol=0.25)
    low, high = found.median_limits()
    of_half = found.percentile_limits(0.0)
    place = variables.PERCENTILES.index(50.0)
    width = np.log(of_half[1][:, place] / of_half[0][:, place]) / np.log(high / low)
    assert ((width > 0.8) & (width < 1.25)).all()


@pytest.mark.parametrize(("stiff", "slides"), [({"R": 2.0, "mu": 0.1}, True), ({"R": 2000.0, "mu": 0.8}, False)])
def test_a_search_of_bodies_that_slide_says_why_none_overturns(stiff: dict, slides: bool) -> None:
    """They never do: a wider range, which the sentence asked for alone, finds nothing either."""
    amplitudes = {"from": "0.1*g", "to": "2*g", "n": 20, "find": "overturning"}
    bodies = {"small": {"tan_alpha": 0.2, "R": 2.0, "mu": 0.8}, "other": {"tan_alpha": 0.2} | stiff}
    data = rockcli.run(SUITE | {"vary": SUITE["vary"] | {"motion.pulse.a_p": amplitudes, "block": bodies}})
    said = [one for one in json.loads(data.attrs["warnings"]) if "no case exceeds it" in one]
    assert [one.endswith(", or bodies slide and do not rock") for one in said] == [slides]


@pytest.mark.parametrize("n", [12, 96])
def test_a_search_with_stable_islands_says_that_lower_bands_may_be_missed(n: int) -> None:
    """Few points step over bands of overturning, and all that comes of them is told too high."""
    scan = {"from": "0.2*g", "to": "2*g", "n": n, "find": "overturning"}
    pulse = {"shape": "sine", "a_p": 1.0, "omega_p": 1.0, "cycles": 3}
    case = {"block": SUITE["case"]["block"], "motion": {"pulse": pulse}}
    vary = {"motion.pulse.omega_p": np.linspace(4.0, 9.0, 12).tolist(), "motion.pulse.a_p": scan}
    data = rockcli.run(SUITE | {"case": case, "vary": vary})
    (islands,) = (data[name] for name in data.variables if str(name).endswith("_islands"))
    said = [one for one in json.loads(data.attrs["warnings"]) if "lower ones may be missed" in one]
    assert int((islands > 0).sum()) > 0
    assert [one.split(" cases")[0] for one in said] == [f"{int((islands > 0).sum())} of 12"]
    assert f"the {n} points" in said[0]


def test_curves_of_amplitudes_with_a_sign_are_of_the_positive_ones() -> None:
    """Pulses turned round are other motions: the curve over the others is that of a suite without them."""
    case = {"block": {"h": 1.0, "b": [0.3, 0.2]}, "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "T_p": 1.0}}}
    vary = {"motion.pulse.T_p": {"from": 0.4, "to": 1.2, "n": 9}}
    amplitudes = np.linspace(0.5, 9.0, 9)
    positive, both = (
        rockcli.run({"case": case, "vary": vary | {"motion.pulse.a_p": list(map(float, a))}, "over": "T_p"})
        for a in (amplitudes, np.concatenate([-amplitudes, amplitudes]))
    )
    for name in ("begins_at", "median", "beta", "median_ci_low"):
        np.testing.assert_allclose(both[f"fragility_{name}"], positive[f"fragility_{name}"], rtol=1e-12)
    assert float(both["fragility_begins_at"]) == pytest.approx(0.3 * 9.81)
    (said,) = (s for s in json.loads(both.attrs["warnings"]) if "alone" in s)
    assert "of positive motion_pulse_a_p alone: 9 of its 18 values are negative" in said
    assert not [s for s in json.loads(positive.attrs["warnings"]) if "alone" in s]
    titles = [rockcli.plot(of, "fragility").get_suptitle() for of in (both, positive)]
    assert ["positive $a_p$ alone" in title for title in titles] == [True, False]
