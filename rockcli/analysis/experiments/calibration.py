"""What experiments say of a body, and of how well its model does: likelihood averaging over bodies and model errors.

Every body of a study is solved under each run's motion times several amplitudes a.  A real body is taken to do what
the model does under a motion stronger by a factor exp(e), e normal with mean mu (what the model gets wrong in all runs
alike) and standard deviation beta (what it gets wrong in each):

    P(run | body, mu, beta) = L + (1 - 2 L) sum_a share(body, a) P(a's cell | mu, beta)   (docs/experiments.md, X1)

share is that of the model that overturns, the cells part ln a half-way between the amplitudes, and L is the
probability of a run that no model explains.  Prior: all bodies equally likely, mu normal, beta uniform in its
logarithm.  Bodies are weighed by their evidence to the power groups over runs: runs of one ground motion err alike, and
which of two bodies that differ by chance in the details of a motion is right must not hang on them.

Chance in the details of a motion makes each body's capacity scatter, their mean much less.  So runs are predicted by
the mean over the bodies of the logarithm of the capacity, whose own mu and beta follow by Bayes' rule on a grid (X2).
Where runs name the session in which a body was set up, mu may wander from one session to the next (X3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rockcli.analysis.experiments.scores import Array, Bools, Index

LAPSE = 0.02
"""L, of a run that came out otherwise for reasons of its own."""

SPREAD = 0.4
"""Prior standard deviation of mu: the amplitude that a model overturns at is known to 40 % beforehand."""

LOCATIONS = np.linspace(-1.0, 1.0, 67)
SCATTERS = np.geomspace(0.04, 0.4, 33)

_COARSE = SCATTERS[::4]
"""Those for which every body is weighed: its evidence is a sum over all of them."""

WALKS = np.geomspace(0.05, 0.4, 4)
"""Standard deviations of the change of mu from a session to the next, equally likely beforehand."""

AMPLITUDES = np.geomspace(0.4, 2.5, 16)
"""Factors of every run's motion; beyond their ends the model does as at the end."""

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
    below = ndtr((edges[:, None, None] - LOCATIONS[:, None]) / _COARSE)
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
        power = float(groups.sum()) / max(float(self.runs[groups].sum()), 1.0)
        body = np.exp(power * (known - known.max()))
        return np.asarray((body / body.sum() * weight / weight.sum(axis=1, keepdims=True)).ravel())

    def weights(self, groups: Bools) -> Array:
        """Probability of every body given the runs of some groups (g,), (c,)."""
        return np.asarray(self.posterior(groups).reshape(self.bodies, -1).sum(axis=1))


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


@dataclass(frozen=True)
class Summary:
    """A number's distribution: mean, standard deviation, and percentiles."""

    mean: float
    sd: float
    p2_5: float
    p50: float
    p97_5: float


def summary(values: Array, weight: Array, *, grid: bool = False) -> Summary:
    """Of values (k,) with probabilities (k,); percentiles are some of them, of points of a `grid` between them."""
    order, tails = np.argsort(values, kind="stable"), [0.025, 0.5, 0.975]
    mass = np.cumsum(weight[order])
    ends = values[order][np.minimum(np.searchsorted(mass, tails), len(values) - 1)]
    if grid:
        ends = np.interp(tails, mass - 0.5 * weight[order], values[order])
    mean = float(weight @ values)
    sd = float(np.sqrt(weight @ (values - mean) ** 2))
    return Summary(mean, sd, *(float(end) for end in ends))


def capacities(share: Array, amplitudes: Array) -> Array:
    """Logarithm of the amplitude at which each body overturns, (n, c): where below it as much falls as above it stands.

    Args:
        share: (n, c, a), NaN counts as 1/2.
        amplitudes: (a,), ascending.
    """
    log_a = np.log(amplitudes)
    inner = 0.5 * (log_a[1:] + log_a[:-1])
    edges = np.concatenate([[2.0 * log_a[0] - inner[0]], inner, [2.0 * log_a[-1] - inner[-1]]])
    return np.asarray(edges[0] + (1.0 - np.where(np.isnan(share), 0.5, share)) @ np.diff(edges))


@dataclass(frozen=True, eq=False)
class Errors:
    """What runs say of mu and beta of an ensemble of bodies.

    Attributes:
        weight: probability of mu in every session and beta, (sessions, m, b).
        walk: probability of each of WALKS; (1,) where there is one session.
    """

    weight: Array
    walk: Array

    def summaries(self) -> tuple[Summary, Summary]:
        """exp(-mu), what the body withstands over what the model does, over all sessions; beta."""
        table = self.weight.mean(axis=0)
        capacity = summary(np.exp(-LOCATIONS), table.sum(axis=1), grid=True)
        return capacity, summary(SCATTERS, table.sum(axis=0), grid=True)


def likely(log_capacity: Array) -> Array:
    """P of overturning at the capacities of an ensemble (n,), for every mu and beta, (n, m, b) (X2)."""
    from scipy.special import ndtr

    below = ndtr((LOCATIONS[:, None] - log_capacity[:, None, None]) / SCATTERS)
    return np.asarray(LAPSE + (1.0 - 2.0 * LAPSE) * below)


def errors(log_capacity: Array, outcome: Bools, session: Index, sessions: int) -> Errors:
    """Mu in every session and beta, by Bayes' rule on the grid; sessions follow one another in their order (X3).

    Args:
        log_capacity: (n,) of the ensemble in each run.
        outcome: (n,) whether the body overturned.
        session: (n,) of each run, from 0; not all need have runs.
        sessions: how many there are.
    """
    p = likely(log_capacity)
    seen = np.zeros((sessions, *p.shape[1:]))
    np.add.at(seen, session, np.log(np.where(outcome[:, None, None], p, 1.0 - p)))
    first = np.exp(-0.5 * (LOCATIONS / SPREAD) ** 2)
    first = np.broadcast_to((first / first.sum())[:, None], seen.shape[1:])
    found, evidences = [], []
    for walk in WALKS if sessions > 1 else WALKS[:1]:
        weight, log_evidence = _smoothed(seen, first, float(walk))
        found.append(weight)
        evidences.append(log_evidence)
    log_weight = np.array(evidences)  # of walk and beta, (w, b)
    joint = np.exp(log_weight - log_weight.max())
    joint /= joint.sum()
    return Errors(np.einsum("wb,wsmb->smb", joint, np.array(found)), joint.sum(axis=1))


def _smoothed(seen: Array, first: Array, walk: float) -> tuple[Array, Array]:
    """Mu of every session given beta and the runs of all, (s, m, b), and the logarithm of their evidence, (b,).

    Forward and backward over the sessions of a hidden Markov chain (Rabiner 1989).
    """
    step = np.exp(-0.5 * ((LOCATIONS[:, None] - LOCATIONS) / walk) ** 2)
    step /= step.sum(axis=1, keepdims=True)
    top = seen.max(axis=1, keepdims=True)
    own = np.exp(seen - top)
    log_evidence = top[:, 0].sum(axis=0)
    before, after = np.empty_like(own), np.empty_like(own)
    now = first
    for k, each in enumerate(own):
        before[k] = now
        total = (now * each).sum(axis=0)
        log_evidence = log_evidence + np.log(total)
        now = step.T @ (now * each / total)
    now = np.ones_like(first)
    for k in range(len(own) - 1, -1, -1):
        after[k] = now
        now = step @ (now * own[k])
        now = now / now.max(axis=0)
    weight = before * own * after
    return weight / weight.sum(axis=1, keepdims=True), log_evidence


def predict(log_capacity: Array, found: Errors, session: Index) -> Array:
    """Probability of overturning and the ends of its interval of 95 %, which holds the probability, (3, n).

    Args:
        log_capacity: (n,) of the ensemble in each run.
        found: of runs that are known.
        session: (n,) of each run, as in `errors`.
    """
    p = likely(log_capacity).reshape(len(log_capacity), -1)
    weight = found.weight[session].reshape(p.shape)
    mean = (p * weight).sum(axis=1)
    order = np.argsort(p, axis=1)
    mass = np.cumsum(np.take_along_axis(weight, order, axis=1), axis=1)
    ends = []
    for tail in (0.025, 0.975):
        at = np.minimum((mass < tail).sum(axis=1), p.shape[1] - 1)
        ends.append(np.take_along_axis(p, order, axis=1)[np.arange(len(p)), at])
    return np.array([mean, np.minimum(ends[0], mean), np.maximum(ends[1], mean)])
