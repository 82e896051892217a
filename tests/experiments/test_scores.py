"""Scores of predictions: against pairs counted by hand, binomial tests, and scikit-learn where it is installed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binomtest

from rockcli.analysis.experiments.baselines import PENALTY, cross_validated, forest, has_forest, logistic, with_squares
from rockcli.analysis.experiments.scores import BOOTSTRAP, NAMES, divide_groups, mcnemar, reliability, scored

RNG = np.random.default_rng(20)
OUTCOME = RNG.random(90) < 0.4
P = np.round(0.25 * OUTCOME + 0.7 * RNG.random(90), 1)  # rounded, so that some are equal
GROUP = RNG.integers(0, 17, 90)


def test_scores_by_their_definitions():
    found = scored(OUTCOME, P, GROUP, 0)
    said = P >= 0.5
    assert found.n == 90
    assert found.events == OUTCOME.sum()
    assert found.missed == sum(y and not s for y, s in zip(OUTCOME, said, strict=True))
    assert found.false == sum(s and not y for y, s in zip(OUTCOME, said, strict=True))
    pairs = [(a > b) + 0.5 * (a == b) for a in P[OUTCOME] for b in P[~OUTCOME]]
    right = {
        "accuracy": np.mean(said == OUTCOME),
        "balanced_accuracy": 0.5 * (np.mean(said[OUTCOME]) + np.mean(~said[~OUTCOME])),
        "precision": np.mean(OUTCOME[said]),
        "recall": np.mean(said[OUTCOME]),
        "auc": np.mean(pairs),
        "brier": np.mean((P - OUTCOME) ** 2),
    }
    for name, value in right.items():
        assert found.scores[name].value == pytest.approx(value, rel=1e-12), name


def test_a_certainty_that_fails_has_an_infinite_log_score():
    found = scored(np.array([True, False, True]), np.array([0.0, 0.2, 0.9]), np.arange(3), 0)
    assert found.scores["log_score"].value == math.inf
    found = scored(np.array([True, False]), np.array([0.25, 0.5]), np.arange(2), 0)
    assert found.scores["log_score"].value == pytest.approx(-0.5 * (math.log(0.25) + math.log(0.5)))


def test_scores_of_scikit_learn():
    metrics = pytest.importorskip("sklearn.metrics")
    p = np.clip(P, 0.01, 0.99)
    found = {name: score.value for name, score in scored(OUTCOME, p, GROUP, 0).scores.items()}
    said = p >= 0.5
    assert found == pytest.approx(
        {
            "accuracy": metrics.accuracy_score(OUTCOME, said),
            "balanced_accuracy": metrics.balanced_accuracy_score(OUTCOME, said),
            "precision": metrics.precision_score(OUTCOME, said),
            "recall": metrics.recall_score(OUTCOME, said),
            "auc": metrics.roc_auc_score(OUTCOME, p),
            "brier": metrics.brier_score_loss(OUTCOME, p),
            "log_score": metrics.log_loss(OUTCOME, p),
        },
        rel=1e-12,
    )


def test_the_bootstrap_takes_whole_groups():
    """Runs copied tenfold within their groups say no more than one of each: the intervals stay."""
    once = scored(OUTCOME, P, GROUP, 3).scores
    many = scored(np.tile(OUTCOME, 10), np.tile(P, 10), np.tile(GROUP, 10), 3).scores
    alone = scored(np.tile(OUTCOME, 10), np.tile(P, 10), np.arange(900), 3).scores
    for name in NAMES[:6]:
        assert (many[name].low, many[name].high) == pytest.approx((once[name].low, once[name].high))
        assert alone[name].high - alone[name].low < 0.5 * (once[name].high - once[name].low)


def test_the_interval_of_a_share_of_independent_runs():
    """Of the accuracy of independent runs the bootstrap is the binomial law divided by n: its quantiles are known."""
    from scipy.stats import binom

    outcome, p = np.arange(200) < 50, np.full(200, 0.9)
    found = scored(outcome, p, np.arange(200), 0).scores["accuracy"]
    error = 3.0 * math.sqrt(0.025 * 0.975 / BOOTSTRAP)
    for end, q in ((found.low, 0.025), (found.high, 0.975)):
        assert binom.ppf(q - error, 200, 0.25) <= round(200 * end) <= binom.ppf(q + error, 200, 0.25)


def test_the_interval_of_auc_is_that_of_its_variance():
    """Of independent runs, by the shares of the other outcome that each run has right (DeLong et al. 1988)."""
    rng = np.random.default_rng(4)
    outcome = rng.random(600) < 0.3
    p = np.clip(0.4 + 0.15 * outcome + 0.15 * rng.standard_normal(600), 0.0, 1.0)
    right = (p[outcome][:, None] > p[~outcome]) + 0.5 * (p[outcome][:, None] == p[~outcome])
    error = math.sqrt(sum(right.mean(axis=k).var(ddof=1) / right.shape[1 - k] for k in (0, 1)))
    found = scored(outcome, p, np.arange(600), 0).scores["auc"]
    assert (found.low, found.high) == pytest.approx(
        (found.value - 1.96 * error, found.value + 1.96 * error), abs=0.15 * error
    )


def test_what_has_no_value_is_nan():
    found = scored(np.zeros(4, dtype=bool), np.full(4, 0.1), np.arange(4), 0).scores
    assert found["accuracy"].value == 1.0
    assert all(math.isnan(found[name].value) for name in ("balanced_accuracy", "precision", "recall", "auc"))


def test_mcnemar_is_the_sign_test_of_the_runs_that_differ():
    first = np.where(RNG.random(90) < 0.9, OUTCOME, ~OUTCOME).astype(float)
    second = np.where(RNG.random(90) < 0.7, OUTCOME, ~OUTCOME).astype(float)
    found = mcnemar(OUTCOME, first, second)
    only_first = int(((first == OUTCOME) & (second != OUTCOME)).sum())
    only_second = int(((first != OUTCOME) & (second == OUTCOME)).sum())
    assert (found.first_only, found.second_only) == (only_first, only_second)
    assert found.p_value == pytest.approx(binomtest(only_first, only_first + only_second).pvalue, rel=1e-9)
    assert mcnemar(OUTCOME, first, first).p_value == 1.0
    assert mcnemar(OUTCOME, np.where(first, 0.5, 0.499), second) == found  # a half says that it happens


def test_reliability_has_the_limits_of_clopper_and_pearson():
    for each in (bins := reliability(OUTCOME, P)):
        inside = np.abs(np.minimum(np.floor(P * 10 + 1e-9), 9) - min(math.floor(each.p * 10 + 1e-9), 9)) == 0
        assert each.n == inside.sum()
        exact = binomtest(int(OUTCOME[inside].sum()), each.n).proportion_ci(0.95, method="exact")
        assert (each.low, each.high) == pytest.approx((exact.low, exact.high))
    assert sum(each.n for each in bins) == 90


def test_folds_keep_groups_together_and_are_of_a_size():
    found = divide_groups(GROUP, 5, 1)
    assert all(len(set(found[group == GROUP])) == 1 for group in set(GROUP))
    sizes = np.bincount(found)
    assert len(sizes) == 5
    assert sizes.max() - sizes.min() <= np.bincount(GROUP).max()
    assert (divide_groups(GROUP, 5, 1) == found).all()
    assert (divide_groups(GROUP, 5, 2) != found).any()
    assert len(set(divide_groups(GROUP, 0, 1))) == len(set(GROUP))


def test_logistic_regression_of_scikit_learn():
    linear_model = pytest.importorskip("sklearn.linear_model")
    x = np.column_stack([P + 0.3 * RNG.standard_normal(90), RNG.standard_normal(90)]) * [3.0, 0.1] + [5.0, 2.0]
    for fit, columns in ((logistic, x), (with_squares, np.column_stack([x, x * x]))):
        standard = (columns - columns.mean(axis=0)) / columns.std(axis=0)
        other = linear_model.LogisticRegression(C=1.0 / PENALTY, tol=1e-12, max_iter=10_000).fit(standard, OUTCOME)
        assert fit(x, OUTCOME)(x) == pytest.approx(other.predict_proba(standard)[:, 1], abs=1e-5)


def test_a_line_that_parts_all_runs_and_runs_that_are_all_alike():
    x = np.arange(20.0)[:, None]
    p = logistic(x, x[:, 0] > 9.5)(x)
    assert ((p > 0.5) == (x[:, 0] > 9.5)).all()
    assert np.isfinite(p).all()
    assert logistic(x, np.ones(20, dtype=bool))(x) == pytest.approx(np.full(20, 21.0 / 22.0))


def test_no_run_is_predicted_by_a_fit_that_knew_its_group():
    fold = divide_groups(GROUP, 5, 0)
    x = np.column_stack([GROUP, np.arange(90)]).astype(float)

    def remembers(known: np.ndarray, _: np.ndarray):
        return lambda rows: np.isin(rows[:, 0], known[:, 0]).astype(float)

    assert (cross_validated(remembers, x, OUTCOME, fold[None]) == 0.0).all()


@pytest.mark.skipif(not has_forest(), reason="scikit-learn is not installed")
def test_the_forest_learns_a_box():
    x = RNG.random((300, 2))
    outcome = (np.abs(x - 0.5) < 0.3).all(axis=1)
    fitted = forest(x[:200], outcome[:200])
    p = fitted(x[200:])
    assert ((p > 0.5) == outcome[200:]).mean() > 0.85
    assert (fitted(x[200:]) == p).all()
