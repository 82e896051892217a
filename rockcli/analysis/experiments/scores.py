"""Scores of predictions of an event that happened or not, their bootstrap intervals, and tests between predictions.

A prediction is a probability in [0, 1]; 0 and 1 are those of a program that only says yes or no.  The event is
predicted where the probability is at least 1/2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Bools = NDArray[np.bool_]

NAMES = ("accuracy", "balanced_accuracy", "precision", "recall", "auc", "brier", "log_score")

SENTENCES = {
    "accuracy": "share of the runs predicted rightly",
    "balanced_accuracy": "mean of that share over the runs that overturned and over those that stood",
    "precision": "share of the runs predicted to overturn that did",
    "recall": "share of the runs that overturned that were predicted to",
    "auc": "area below the ROC curve: how often, of a fallen and a standing run, the fallen one has the higher p",
    "brier": "mean square of probability minus outcome",
    "log_score": "mean of -ln of the probability of what happened; infinite where a certainty failed",
}

_LEVEL = 0.95
_BINS = 10

BOOTSTRAP = 2000
"""Samples of the bootstrap."""


@dataclass(frozen=True)
class Score:
    """A number with its interval of 95 %; NaN where there is none, as the precision where nothing is predicted."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Scored:
    """Scores of one prediction.

    Attributes:
        n, events: runs scored, and how many of them overturned.
        scores: by the names of NAMES.
        missed: predicted to stand, and overturned; false: predicted to overturn, and stood.
    """

    n: int
    events: int
    scores: dict[str, Score]
    missed: int
    false: int


def scored(outcome: Bools, p: Array, group: Index, seed: int) -> Scored:
    """Scores with bootstrap intervals.

    Args:
        outcome: (n,) whether the event happened.
        p: (n,) its predicted probability.
        group: (n,) runs of one group are resampled together, as they are not independent.
        seed: of the resampling.
    """
    values = _scores(outcome, p, np.ones((1, len(p))))
    low, high = np.full(len(NAMES), np.nan), np.full(len(NAMES), np.nan)
    members, who = np.unique(group, return_inverse=True)
    if len(members) > 1:
        rng = np.random.default_rng(seed)
        drawn = rng.multinomial(len(members), np.full(len(members), 1.0 / len(members)), size=BOOTSTRAP)
        again = _scores(outcome, p, drawn[:, who.ravel()].astype(float))
        for k, column in enumerate(again.T):
            known = column[~np.isnan(column)]
            if len(known):
                low[k], high[k] = _percentiles(known)
    said = p >= 0.5
    numbers = zip(NAMES, values[0].tolist(), low.tolist(), high.tolist(), strict=True)
    return Scored(
        n=len(p),
        events=int(outcome.sum()),
        scores={name: Score(value, a, b) for name, value, a, b in numbers},
        missed=int((outcome & ~said).sum()),
        false=int((~outcome & said).sum()),
    )


def _percentiles(values: Array) -> tuple[float, float]:
    """Ends of the middle 95 %; order statistics, as values may be infinite."""
    ordered = np.sort(values)
    tail = 0.5 * (1.0 - _LEVEL) * (len(ordered) - 1)
    return float(ordered[int(np.floor(tail))]), float(ordered[int(np.ceil(len(ordered) - 1 - tail))])


def _scores(outcome: Bools, p: Array, weight: Array) -> Array:
    """The scores of NAMES for every row of weights: (rows, n) -> (rows, scores)."""
    y, said = outcome.astype(float), p >= 0.5
    with np.errstate(divide="ignore", invalid="ignore"):
        happened = np.where(outcome, p, 1.0 - p)
        loss = -np.log(happened)
        sure = np.isinf(loss)
        n, events = weight.sum(axis=1), weight @ y
        hits, alarms = weight @ (y * said), weight @ said.astype(float)
        right = weight @ (outcome == said).astype(float)
        stood = n - events
        rejected = stood - (alarms - hits)
        log_score = np.where(weight @ sure.astype(float) > 0.0, np.inf, weight @ np.where(sure, 0.0, loss) / n)
        columns = [
            right / n,
            0.5 * (hits / events + rejected / stood),
            hits / alarms,
            hits / events,
            _auc(outcome, p, weight),
            weight @ (p - y) ** 2 / n,
            log_score,
        ]
    return np.column_stack(columns)


def _auc(outcome: Bools, p: Array, weight: Array) -> Array:
    """Of all pairs of an event and a non-event the share in which the event has the higher p; equal ones count half."""
    _, place = np.unique(p, return_inverse=True)
    order = np.argsort(place.ravel(), kind="stable")
    starts = np.flatnonzero(np.diff(place.ravel()[order], prepend=-1))
    fallen, stood = (
        np.add.reduceat((weight * which)[:, order], starts, axis=1) for which in (outcome.astype(float), ~outcome)
    )
    below = np.cumsum(stood, axis=1) - stood
    pairs = fallen.sum(axis=1) * stood.sum(axis=1)
    return np.asarray((fallen * (below + 0.5 * stood)).sum(axis=1) / pairs)


@dataclass(frozen=True)
class McNemar:
    """Two predictions on the same runs.

    Attributes:
        n: runs that both predict.
        first_only, second_only: runs that only the one has right.
        p_value: that they are as good as each other: two-sided, exact (binomial).
    """

    n: int
    first_only: int
    second_only: int
    p_value: float

    def cells(self) -> list[str]:
        """The numbers as tables have them."""
        return [str(self.n), str(self.first_only), str(self.second_only), f"{self.p_value:.2g}"]


def mcnemar(outcome: Bools, first: Array, second: Array) -> McNemar:
    """McNemar's exact test of two predictions, (n,) each (McNemar 1947, *Psychometrika* 12: 153-157)."""
    from scipy.stats import binom

    right_first, right_second = ((p >= 0.5) == outcome for p in (first, second))
    b, c = int((right_first & ~right_second).sum()), int((right_second & ~right_first).sum())
    return McNemar(len(outcome), b, c, float(min(1.0, 2.0 * binom.cdf(min(b, c), b + c, 0.5))))


@dataclass(frozen=True)
class Bin:
    """Runs of similar probability: how many, their mean probability, the share that overturned and its 95 % limits."""

    n: int
    p: float
    share: float
    low: float
    high: float


def reliability(outcome: Bools, p: Array) -> tuple[Bin, ...]:
    """Ten bins of equal width, those that are not empty; limits of the share by Clopper and Pearson (1934)."""
    from scipy.stats import beta

    which = np.minimum((p * _BINS).astype(int), _BINS - 1)
    tail = 0.5 * (1.0 - _LEVEL)
    found = []
    for number in range(_BINS):
        inside = which == number
        if n := int(inside.sum()):
            k = int(outcome[inside].sum())
            low = float(beta.ppf(tail, k, n - k + 1)) if k else 0.0
            high = float(beta.ppf(1.0 - tail, k + 1, n - k)) if k < n else 1.0
            found.append(Bin(n, float(p[inside].mean()), k / n, low, high))
    return tuple(found)


def divide_groups(group: Index, count: int, seed: int) -> Index:
    """The fold of every run, (n,): all runs of a group are in one fold; the folds hold about as many runs each.

    Groups come in an order drawn by `seed`, each into the fold that has the fewest runs so far.  `count` 0, or as
    many as there are groups: each group is a fold.
    """
    members, who = np.unique(group, return_inverse=True)
    who = who.ravel()
    if count == 0 or count >= len(members):
        return who.astype(np.int64)
    sizes = np.bincount(who)
    held = np.zeros(count)
    fold = np.zeros(len(members), dtype=np.int64)
    for member in np.random.default_rng(seed).permutation(len(members)):
        fold[member] = int(np.argmin(held))
        held[fold[member]] += sizes[member]
    return fold[who]


def numbered(labels: Sequence[str]) -> Index:
    """Labels as whole numbers, in the order in which they first come."""
    places: dict[str, int] = {}
    return np.array([places.setdefault(label, len(places)) for label in labels], dtype=np.int64)
