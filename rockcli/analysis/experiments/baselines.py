"""Predictions that know the ground motion and nothing of the body: what a simulation must beat to be worth its cost.

Each is fitted on some runs and predicts others.  Logistic regression on logarithms of intensities, and a random
forest where scikit-learn is installed.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.experiments.scores import Array, Bools

Fit = Callable[[Array, Bools], Callable[[Array], Array]]
"""(runs, measures) and outcomes -> a function from (runs, measures) to probabilities."""

PENALTY = 1e-2
"""Of the squares of the standardized slopes: next to nothing, but a maximum exists where a line parts all runs."""

_ITERATIONS = 100

TREES = 500


def logistic(x: Array, outcome: Bools) -> Callable[[Array], Array]:
    """Logistic regression on standardized columns (n, d), by Newton's method, penalty PENALTY/2 |slopes|²."""
    from scipy.special import expit

    centre, spread = x.mean(axis=0), x.std(axis=0)
    spread = np.where(spread > 0.0, spread, 1.0)

    def design(values: Array) -> Array:
        return np.column_stack([np.ones(len(values)), (values - centre) / spread])

    a, y = design(x), outcome.astype(float)
    if outcome.all() or not outcome.any():  # nothing to tell apart: Laplace's rule
        share = (y.sum() + 1.0) / (len(y) + 2.0)
        return lambda values: np.full(len(values), share)
    penalty = PENALTY * np.eye(a.shape[1])
    penalty[0, 0] = 0.0
    w = np.zeros(a.shape[1])

    def loss(w: Array) -> float:
        return float(np.logaddexp(0.0, np.where(outcome, -1.0, 1.0) * (a @ w)).sum() + 0.5 * w @ penalty @ w)

    best = loss(w)
    for _ in range(_ITERATIONS):
        p = expit(a @ w)
        step = np.linalg.solve((a.T * (p * (1.0 - p))) @ a + penalty, a.T @ (y - p) - penalty @ w)
        size = 1.0
        while (trial := loss(w + size * step)) > best and size > 1e-10:
            size *= 0.5
        w, best = w + size * step, trial
        if np.abs(size * step).max() <= 1e-10 * (1.0 + np.abs(w).max()):
            break
    return lambda values: np.asarray(expit(design(values) @ w))


def with_squares(x: Array, outcome: Bools) -> Callable[[Array], Array]:
    """Logistic regression on the columns and their squares."""
    fitted = logistic(np.column_stack([x, x * x]), outcome)
    return lambda values: fitted(np.column_stack([values, values * values]))


def has_forest() -> bool:
    """Whether scikit-learn is installed."""
    return find_spec("sklearn") is not None


def forest(x: Array, outcome: Bools) -> Callable[[Array], Array]:
    """A random forest of TREES trees, scikit-learn's defaults otherwise (Breiman 2001); needs scikit-learn."""
    from sklearn.ensemble import RandomForestClassifier

    fitted = RandomForestClassifier(n_estimators=TREES, random_state=0, n_jobs=1).fit(x, outcome)
    return lambda values: np.asarray(fitted.predict_proba(values) @ fitted.classes_.astype(float))


def cross_validated(fit: Fit, x: Array, outcome: Bools, folds: NDArray[np.int64]) -> Array:
    """Probability of every run by a fit on the runs of all other folds, for every row of `folds` (r, n): (r, n)."""
    p = np.zeros(folds.shape)
    for row, fold in zip(p, folds, strict=True):
        for number in np.unique(fold):
            out = fold == number
            row[out] = fit(x[~out], outcome[~out])(x[out])
    return p
