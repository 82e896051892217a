"""What experiments say of a body, and of how well its model does: likelihood averaging over bodies and model errors.

Every body of a study is solved under each run's motion times several amplitudes a.  A real body is taken to do what
the model does under a motion stronger by a factor exp(e), e normal with mean mu (what the model gets wrong in all runs
alike) and standard deviation beta (what it gets wrong in each):

    P(run | body, mu, beta) = L + (1 - 2 L) sum_a share(body, a) P(a's cell | mu, beta)   (docs/experiments.md, X1)

share is that of the model that overturns, the cells part ln a half-way between the amplitudes, and L is the
probability of a run that no model explains.  Prior: all bodies equally likely, mu normal, beta uniform in its
logarithm; mu and beta of each body follow by Bayes' rule on a grid.  Bodies are weighed by their evidence to the power
groups over runs: runs of one ground motion err alike, and which of two bodies that differ by chance in the details of a
motion is right must not hang on them.  A prediction is the mean of P over all of it, its interval that of P.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.experiments.scores import Array, Bools, Index

LAPSE = 0.02
"""L, of a run that came out otherwise for reasons of its own."""

SPREAD = 0.2
"""Prior standard deviation of mu: the amplitude that a model overturns at is known to 20 % beforehand."""

LOCATIONS = np.linspace(-0.45, 0.45, 31)
SCATTERS = np.geomspace(0.04, 0.4, 9)

AMPLITUDES = np.geomspace(0.5, 2.0, 15)
"""Factors of every run's motion; beyond their ends the model does as at the end."""

_BINS = 1000
"""Into which probabilities are sorted for an interval."""

_CHUNK = 20_000_000
"""Probabilities held at a time."""


@dataclass(frozen=True, eq=False)
class Kernel:
    """Weights of the amplitudes for every location and scatter, (a, m b), and the logarithm of their prior, (m b,)."""

    weights: Array
    log_prior: Array


def kernel_of(amplitudes: Array) -> Kernel:
    """The weights of a grid of amplitudes (a,), ascending."""
    from scipy.special import ndtr

    log_a = np.log(amplitudes)
    edges = np.concatenate([[-np.inf], 0.5 * (log_a[1:] + log_a[:-1]), [np.inf]])
    below = ndtr((edges[:, None, None] - LOCATIONS[:, None]) / SCATTERS)
    prior = np.broadcast_to(-0.5 * (LOCATIONS[:, None] / SPREAD) ** 2, below.shape[1:])
    return Kernel(np.diff(below, axis=0).reshape(len(amplitudes), -1), prior.ravel())


def probabilities(share: Array, kernel: Kernel) -> Array:
    """P of overturning of every run, body, location and scatter: share (n, c, a) -> (n, c m b)."""
    known = np.where(np.isnan(share), 0.5, share)
    p = LAPSE + (1.0 - 2.0 * LAPSE) * (known @ kernel.weights)
    return np.asarray(p.reshape(len(share), -1))


def _chunks(share: Array, kernel: Kernel) -> list[slice]:
    rows = max(1, _CHUNK // (share.shape[1] * len(kernel.log_prior)))
    return [slice(i, i + rows) for i in range(0, len(share), rows)]


@dataclass(frozen=True, eq=False)
class Evidence:
    """What runs say: log-likelihood of body, location and scatter for each group, (groups, c m b), and its `runs`."""

    kernel: Kernel
    bodies: int
    log_likelihood: Array
    runs: Index

    def posterior(self, groups: Bools) -> Array:
        """Probability of every body, location and scatter given the runs of some groups (g,), (c m b,)."""
        total = (groups.astype(float) @ self.log_likelihood).reshape(self.bodies, -1) + self.kernel.log_prior
        top = total.max(axis=1, keepdims=True)
        weight = np.exp(total - top)
        known = top + np.log(weight.sum(axis=1, keepdims=True))
        power = float(groups.sum()) / float(self.runs[groups].sum())
        body = np.exp(power * (known - known.max()))
        return np.asarray((body / body.sum() * weight / weight.sum(axis=1, keepdims=True)).ravel())


def evidence(share: Array, outcome: Bools, group: Index, amplitudes: Array) -> Evidence:
    """What runs say.

    Args:
        share: (n, c, a) share of each run, body and amplitude that overturns; NaN counts as 1/2.
        outcome: (n,) whether the body overturned.
        group: (n,) from 0, without gaps.
        amplitudes: (a,).
    """
    kernel = kernel_of(amplitudes)
    total = np.zeros((int(group.max()) + 1, share.shape[1] * len(kernel.log_prior)))
    for rows in _chunks(share, kernel):
        p = probabilities(share[rows], kernel)
        np.add.at(total, group[rows], np.log(np.where(outcome[rows][:, None], p, 1.0 - p)))
    return Evidence(kernel, share.shape[1], total, np.bincount(group))


def predict(share: Array, kernel: Kernel, posterior: Array, which: Index) -> tuple[Array, Array, Array]:
    """Probability of overturning and the ends of its interval of 95 %, which reaches to it at least, (r, n) each.

    Args:
        share: (n, c, a) of the runs to predict.
        kernel: of the amplitudes.
        posterior: (f, c m b), one for each fold.
        which: (r, n) by which of them a run is predicted, of r repetitions.
    """
    out = np.empty((3, *which.shape))
    for rows in _chunks(share, kernel):
        p = probabilities(share[rows], kernel)
        place = np.minimum((p * _BINS).astype(np.int64), _BINS - 1)
        mean = p @ posterior.T
        for j in range(len(p)):
            run = rows.start + j
            for f in np.unique(which[:, run]):
                mass = np.cumsum(np.bincount(place[j], weights=posterior[f], minlength=_BINS))
                low, high = np.searchsorted(mass, [0.025, 0.975])
                ends = min(low / _BINS, mean[j, f]), max((high + 1) / _BINS, mean[j, f])
                out[:, which[:, run] == f, run] = np.array([mean[j, f], ends[0], min(ends[1], 1.0)])[:, None]
    return out[0], out[1], out[2]


@dataclass(frozen=True)
class Summary:
    """A number's distribution: mean, standard deviation, and percentiles."""

    mean: float
    sd: float
    p2_5: float
    p50: float
    p97_5: float


def summary(values: Array, weight: Array) -> Summary:
    """Of values (k,) with probabilities (k,)."""
    order = np.argsort(values, kind="stable")
    mass = np.cumsum(weight[order])
    ends = values[order][np.minimum(np.searchsorted(mass, [0.025, 0.5, 0.975]), len(values) - 1)]
    mean = float(weight @ values)
    sd = float(np.sqrt(weight @ (values - mean) ** 2))
    return Summary(mean, sd, *(float(end) for end in ends))


def marginals(posterior: Array, bodies: int) -> tuple[NDArray[np.float64], Summary, Summary]:
    """Probability of every body, (c,); exp(-mu), what the body withstands over what the model does; beta."""
    table = posterior.reshape(bodies, len(LOCATIONS), len(SCATTERS))
    return (
        table.sum(axis=(1, 2)),
        summary(np.exp(-LOCATIONS), table.sum(axis=(0, 2))),
        summary(SCATTERS, table.sum(axis=(0, 1))),
    )
