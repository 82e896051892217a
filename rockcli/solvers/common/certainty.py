"""How sure an outcome is: a second run whose motion differs by less than the solver promises to see, and, where the two
part, an ensemble of such runs.

Runs are compared by where their trajectories go, never by how often they bounce before they rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DONE, FALLS, NO_ANSWER, RETURNS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.ground.excitation import Channel, Excitation, scaled
from rockcli.scene.response import NO_UPLIFT, UNRESOLVED, overturned
from rockcli.scene.variables import SCALARS_AUTO, SCALARS_FEMA, SCALARS_FLEXIBLE, SCALARS_SLIDING

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Index = NDArray[np.int64]
Scalars = dict[str, NDArray[Any]]

CERTAINTY = frozenset({"error_estimate", "overturn_share"})
"""Scalars that take a second run."""

KEPT = frozenset(
    {
        "outcome", "t_uplift", "t_end", "n_impacts", "mu_required", "mu_impact", "N_min_over_mg", "energy_residual",
        "error_estimate", "overturn_share", "wall_time", "n_steps", "n_rhs", "reason",
        *SCALARS_FLEXIBLE, *SCALARS_FEMA, *SCALARS_SLIDING, *SCALARS_AUTO,
    }
)  # fmt: skip
"""Scalars that tell of the run, not of what became of the body: they stay where its outcome is not known."""

HORIZON = 1e-2
"""Two runs have parted where their peaks theta/alpha, or what their impacts carry, are this far apart: a motion that
multiplies a difference so has forgotten its start."""

LATER = 0.1
"""Falls, and impacts on the average, are the same ones if they are no more than this far apart, in units of 1/p: near a
boundary a time is known less well than a peak."""

MEMBERS = 20
"""Runs of an ensemble, beside the one that is reported."""

SPREAD = 1.5
"""The error of a peak is taken as this many times the largest distance to a member of the ensemble."""


@dataclass(frozen=True)
class Perturbation:
    """How a second run differs, and what it tells.

    Attributes:
        size: the motion is less by this share of it, more than the errors of the solver and far less than anybody knows
            a motion.
        weight, floor: the error of theta_peak/alpha is estimated as the difference of the two times `weight`, and
            `floor` more where it is not 0 by itself.
    """

    size: float
    weight: float
    floor: float = 0.0


@dataclass(frozen=True, eq=False)
class Traces:
    """What is compared of the runs of n cases, (n,) each.

    Attributes:
        verdict: RETURNS, FALLS, UNDECIDED or NO_ANSWER.
        fall: time of the last outward passage of the equilibrium, in units of 1/p.
        peak: largest |theta|/alpha.
        swings, when: what the impacts carry, the sum of (v/p alpha)^2, and their mean time so weighted in units of 1/p;
            0 where a solver does not tell.
    """

    verdict: NDArray[np.int8]
    fall: Array
    peak: Array
    swings: Array
    when: Array

    @classmethod
    def of(cls, batch: Batch, scalars: Scalars) -> Traces:
        """From scalars of a solver that does not add up impacts."""
        outcome, nothing = scalars["outcome"], np.zeros(batch.size)
        verdict = np.select([overturned(outcome), outcome >= NO_UPLIFT], [FALLS, RETURNS], NO_ANSWER)
        fall = scalars["t_overturn"] * batch.p.min(axis=1)
        return cls(verdict.astype(np.int8), fall, scalars["theta_peak_over_alpha"], nothing, nothing)

    @classmethod
    def of_kernel(cls, batch: Batch, out: Array, to: ModuleType) -> Traces:
        """From the results (n, N_OUT) of a kernel whose columns are those of the module `to`."""
        p, alpha = batch.p.min(axis=1), batch.block.alpha
        verdict = np.where(out[:, to.STATUS] == DONE, out[:, to.VERDICT], NO_ANSWER).astype(np.int8)
        sides = np.maximum(out[:, to.PEAK_LEFT] / alpha[:, LEFT], out[:, to.PEAK_RIGHT] / alpha[:, RIGHT])
        swings = out[:, to.SWINGS]
        when = np.divide(out[:, to.SWINGS_T] * p, swings, out=np.zeros_like(swings), where=swings > 0.0)
        return cls(verdict, out[:, to.T_OVERTURN] * p, sides, swings, when)

    def rows(self, at: Index | Mask) -> Traces:
        """Those of some of the cases."""
        return Traces(self.verdict[at], self.fall[at], self.peak[at], self.swings[at], self.when[at])

    @property
    def share(self) -> Array:
        """Of one run: 1 falls, 0 stands, 1/2 undecided, NaN no answer, (n,)."""
        return np.select(
            [self.verdict == FALLS, self.verdict == RETURNS, self.verdict == UNDECIDED], [1.0, 0.0, 0.5], np.nan
        )

    def apart(self, other: Traces) -> Array:
        """|difference of the peaks|, (n,): 0 where both fall, inf where one does, NaN where either has no answer."""
        one, two = (np.where(run.verdict == FALLS, np.inf, run.peak) for run in (self, other))
        with np.errstate(invalid="ignore"):
            apart = np.where(one == two, 0.0, np.abs(one - two))
        return np.where((self.verdict == NO_ANSWER) | (other.verdict == NO_ANSWER), np.nan, apart)

    def parted(self, other: Traces) -> Mask:
        """Where two runs have gone different ways, (n,); False where either has no answer."""
        answered = (self.verdict != NO_ANSWER) & (other.verdict != NO_ANSWER)
        undecided = (self.verdict == UNDECIDED) | (other.verdict == UNDECIDED)
        fell = self.verdict == FALLS
        swings = np.maximum(self.swings, other.swings)
        swung = HORIZON * np.minimum(swings, 1.0)
        with np.errstate(invalid="ignore"):
            later = np.abs(self.fall - other.fall) > LATER
            elsewhere = (
                (self.apart(other) > HORIZON)
                | (np.abs(self.swings - other.swings) > swung)
                | (swings * np.abs(self.when - other.when) > LATER * np.minimum(swings, 1.0))
            )
        return np.asarray(answered & (undecided | np.where(fell & (other.verdict == FALLS), later, elsewhere)))


@dataclass(frozen=True, eq=False)
class Judgement:
    """What further runs show of n cases.

    Attributes:
        share: of the runs that fall, (n,), NaN without an answer.
        error: estimate of that of theta_peak/alpha, (n,).
        when_unknown: where all runs fall, but not at one time, (n,).
        said: a sentence for each, "" where there is nothing to say.
    """

    share: Array
    error: Array
    when_unknown: Mask
    said: list[str]

    def enter(self, scalars: Scalars, reasons: list[str]) -> None:
        """Put it into the scalars; make cases `unresolved` of which some runs fall and some do not."""
        refused = scalars["outcome"] < UNRESOLVED
        refused |= (scalars["outcome"] == UNRESOLVED) & ~_between(self.share)  # for another reason
        scalars["overturn_share"] = np.where(refused, np.nan, self.share)
        scalars["error_estimate"] = np.where(refused, np.nan, self.error)
        scalars["t_overturn"] = np.where(self.when_unknown, np.nan, scalars["t_overturn"])
        for i, said in enumerate(self.said):
            if said:
                reasons[i] = "; ".join(filter(None, [reasons[i], said]))
        withdraw(scalars, _between(self.share) & ~refused)


Again = Callable[[Index, Array, bool], Traces]
"""Runs of some cases, (k,), their motion multiplied by factors, (k,); True: of those that are compared last, or of an
ensemble, with what accuracy there is."""


def judge(
    first: Traces,
    again: Again,
    perturbation: Perturbation,
    refine: Callable[[Index], Traces],
    finer: Perturbation | None,
    reach: float,
) -> Judgement:
    """Judge runs of n cases by further ones.

    Where a second run parts from the first one, `refine` has the answers replaced by those of a more accurate run;
    where that parts from a perturbed run too, an ensemble decides.

    Args:
        first: the runs as they are.
        again, refine: what runs them again; perturbation, finer: how; None: there is nothing more accurate.
        reach: largest relative difference of the motions of an ensemble.
    """
    n = len(first.verdict)
    found = Judgement(first.share, np.full(n, np.nan), np.zeros(n, dtype=bool), [""] * n)
    rows = np.flatnonzero(first.verdict != NO_ANSWER)
    runs = first.rows(rows)
    if not len(rows):
        return found
    parted = _compared(found, rows, runs, again, perturbation, fine=False)
    rows, runs = rows[parted], runs.rows(parted)
    if len(rows) and finer is not None:
        runs = refine(rows)
        found.share[rows] = runs.share
        parted = _compared(found, rows, runs, again, finer, fine=True)
        rows, runs = rows[parted], runs.rows(parted)
    if len(rows):
        _ensemble(found, rows, runs, again, reach)
    return found


def _compared(
    found: Judgement, rows: Index, runs: Traces, again: Again, perturbation: Perturbation, *, fine: bool
) -> Mask:
    """Error estimates of some cases from a perturbed run; in which of them the two part."""
    other = again(rows, np.full(len(rows), 1.0 - perturbation.size), fine)
    found.error[rows] = runs.apart(other) * perturbation.weight + np.where(runs.peak > 0.0, perturbation.floor, 0.0)
    return runs.parted(other)


def _ensemble(found: Judgement, rows: Index, runs: Traces, again: Again, reach: float) -> None:
    """Share and error of some cases from runs whose motions differ by no more than `reach`."""
    steps = np.delete(np.linspace(-1.0, 1.0, MEMBERS + 1), MEMBERS // 2)
    members = again(np.repeat(rows, MEMBERS), np.tile(1.0 + reach * steps, len(rows)), True)
    shares = np.column_stack([members.share.reshape(-1, MEMBERS), runs.share])
    peaks, falls = (x.reshape(-1, MEMBERS) for x in (members.peak, members.fall))
    for i, row in enumerate(rows):
        share = found.share[row] = float(np.nanmean(shares[i]))
        what = f"{MEMBERS + 1} runs whose motions differ by {reach:.0e}"
        undecided = int((shares[i] == 0.5).sum())
        if undecided == MEMBERS + 1:  # no sign of chaos: the solver cannot tell, and says why
            found.error[row] = np.inf
        elif 0.0 < share < 1.0:
            found.error[row] = np.inf
            half = f", the {undecided} of them that are undecided counted half" if undecided else ""
            told = f"{share:.0%} of {what} overturn{half}"
            found.said[row] = f"{told}: chaotic or on a boundary, its outcome would be chance"
        elif share == 1.0:
            found.error[row], found.when_unknown[row] = 0.0, True
            early, late = (float(f(np.append(falls[i], runs.fall[i]))) for f in (np.nanmin, np.nanmax))
            found.said[row] = f"all of {what} overturn, p t from {early:.4g} to {late:.4g}: when is chance"
        else:
            apart = float(np.nanmax(np.abs(peaks[i] - runs.peak[i])))
            found.error[row] = max(float(found.error[row]), SPREAD * apart)
            found.said[row] = f"none of {what} overturns, but they diverge: peaks theta/alpha differ by {apart:.2g}"


def perturbed(batch: Batch, rows: Index, factors: Array) -> Batch:
    """Cases of a batch with their motion, and their initial state, multiplied by factors, (k,) each."""
    some = batch.rows(rows)

    def times(channel: Channel | None) -> Channel | None:
        return None if channel is None else scaled(channel, factors)

    motion = some.excitation
    return replace(
        some,
        excitation=Excitation(
            times(motion.horizontal),
            times(motion.vertical),
            motion.duration,
            None if motion.suite is None else replace(motion.suite, factor=motion.suite.factor * factors),
        ),
        theta_0=some.theta_0 * factors,
        theta_dot_0=some.theta_dot_0 * factors,
        slide_rate_0=None if some.slide_rate_0 is None else some.slide_rate_0 * factors,
    )


def compare_steps(batch: Batch, scalars: Scalars, other: Scalars, reasons: list[str]) -> None:
    """Judge runs by others of another step, of a solver whose errors are those of its steps, with no sign of chaos.

    A case of which one overturns and the other does not is `unresolved`: half of its runs do.
    """
    one, two = (Traces.of(batch, run) for run in (scalars, other))
    apart = one.apart(two)
    share = np.where(np.isnan(two.share), one.share, 0.5 * (one.share + two.share))
    said = "two steps disagree on the outcome: it is too close to a boundary, chaotic, or too coarse"
    sentences = [said if between else "" for between in _between(share)]
    Judgement(share, apart, np.zeros(batch.size, dtype=bool), sentences).enter(scalars, reasons)


def _between(share: Array) -> Mask:
    return np.asarray((share > 0.0) & (share < 1.0))


def withdraw(scalars: Scalars, which: Mask) -> None:
    """Make cases `unresolved`: what they came to is not known, and no scalar that is not in `KEPT`."""
    if not which.any():
        return
    scalars["outcome"][which] = UNRESOLVED
    for name in scalars.keys() - KEPT:
        scalars[name] = np.where(which, np.nan, scalars[name])
