"""Fragility: how the probability that a suite exceeds nested limit states grows with intensity.

P(exceed | x) = Phi(ln((x - x_0)/(median - x_0))/beta) above x_0, 0 below: the lognormal curve for x_0 = 0, and no mass
where nothing can move for x_0 at uplift.  With a second intensity y the median is that at a reference y_r and goes
with (y/y_r)^-exponent.  Fitted by maximum likelihood, either all limit states at once with one beta (ordered probit:
curves never cross), or each alone.  Binomial fit: Shinozuka et al. (2000); multiple stripes: Baker
(2015), Earthq. Spectra 31(1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.capacity_fit import Capacities
from rockcli.analysis.fragility.capacity_fit import fit as fit_capacities
from rockcli.analysis.fragility.interval_likelihood import jackknife_covariance
from rockcli.analysis.fragility.misfit import groups_of, misfit, two_sided
from rockcli.analysis.fragility.ordered_probit import Probit, Rows, ordered_probit
from rockcli.scene.variables import PERCENTILES

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FITTED, NONE_EXCEEDS, ALL_EXCEED, SEPARABLE, FALLING, BELOW, NOT_ASKED, COLLINEAR = 0, 1, 2, 3, 4, 5, 6, 7

STATUS: dict[int, str] = {
    FITTED: "fitted",
    NONE_EXCEEDS: "none_exceeds",
    ALL_EXCEED: "all_exceed",
    SEPARABLE: "separable",
    FALLING: "falling",
    BELOW: "below_uplift",
    NOT_ASKED: "not_asked",
    COLLINEAR: "collinear",
}

WHY_NOT: dict[int, str] = {
    NONE_EXCEEDS: "no case exceeds it, so the range is too low",
    ALL_EXCEED: "every case exceeds it wherever anything can move: add lower intensities",
    SEPARABLE: "it goes from none to all within a step of the intensities, or one of them alone has members that "
    "exceed it and members that do not, and beta cannot be told: add some there",
    FALLING: "it is not exceeded more often as the intensity grows",
    BELOW: "it is exceeded where the curve begins or below (begins_at)",
    COLLINEAR: "one of the two intensities is the same for all motions, or follows from the other",
}
"""Why there is no curve."""

LOGNORMAL, ORDINAL, NONE = "lognormal", "ordinal", "none"

CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class Seen:
    """What became of the n members of a suite at k intensities.

    Attributes:
        x: (n, k) intensity; what is not positive, or NaN, is left out.
        low, high: (n, k) lowest and highest category a member may be in: the number of limit states it exceeds.
        weight: (n, k) 0 left out, 1 whole.
        rows: (n,) which members belong together and are not independent; None = each is independent.
        shared: (n,) which sample, drawn for all rows together, a member belongs to; None = there are none.
        second: (n, k) a second intensity, of which only what is positive counts; None = there is none.
    """

    x: Array
    low: Index
    high: Index
    weight: Array
    rows: Index | None = None
    second: Array | None = None
    shared: Index | None = None


@dataclass(frozen=True)
class Scatter:
    """What the scatter of a suite says of a curve.

    ln(median - x_0) is q + least beta, whose two parts are not correlated; q is taken as normal, of standard deviation
    `scale` beta, and beta as chi, as both are of capacities that are all known (Owen 1968).  So the estimates allow

        beta' = unbiased/sqrt(chi2/freedom),
        ln(median - x_0)' = ln(median - x_0) + least (beta' - beta) + scale beta' Z.

    Attributes:
        beta: the estimate; unbiased: freed of its bias; freedom: degrees of freedom that give its variance.
    """

    beta: float
    unbiased: float
    freedom: float
    least: float
    scale: float

    def allowed(self, chance: Array, z: Array) -> tuple[Array, Array]:
        """How far ln(median - x_0) is from its estimate, (k, m), and beta, (k,).

        Args:
            chance: (k,) probabilities of chi2; z: (m,) values of the normal variable Z.
        """
        from scipy.stats import chi2

        beta = self.unbiased / np.sqrt(chi2.ppf(chance, self.freedom) / self.freedom)
        return self.least * (beta - self.beta)[:, None] + self.scale * np.multiply.outer(beta, z), beta


@dataclass(frozen=True, eq=False)
class Curves:
    """Curves of the limit states, (states,) each; NaN where not FITTED.

    Attributes:
        median: in units of the intensity; beta: [1], of ln(x - x_0).
        se_ln_median, se_beta: standard errors of ln(median - x_0) and beta; correlation: of the two estimates.
        status: int8, a key of STATUS.
        begins_at: x_0.
        members: with a row in the fit.
        exponent, se_exponent: of the second intensity and its standard error, NaN without one.
        second_at: the value of the second intensity of which `median` is: the geometric mean of those in the fit.
        misfit_p: bound on the probability that a share lies as far from the curve as the farthest does (`misfit`).
        misfit_at: the intensity of that share, a mean where it is of several.
        jackknife: (states, 4) by the jackknife: variance of ln(median - x_0), covariance with beta, variance of beta,
            of the exponent.
    """

    median: Array
    beta: Array
    se_ln_median: Array
    se_beta: Array
    correlation: Array
    status: NDArray[np.int8]
    begins_at: float
    members: int
    exponent: Array
    se_exponent: Array
    second_at: float
    misfit_p: Array
    misfit_at: Array
    jackknife: Array

    @property
    def _reach(self) -> float:
        from scipy.stats import t

        return float(t.ppf(0.5 + 0.5 * CONFIDENCE, max(self.members - 1, 1)))

    def median_limits(self) -> tuple[Array, Array]:
        """Confidence limits of the median, by Student's t of as many degrees of freedom as members less one."""
        above = self.median - self.begins_at
        spread = np.exp(self._reach * self.se_ln_median)
        return self.begins_at + above / spread, self.begins_at + above * spread

    def beta_limits(self) -> tuple[Array, Array]:
        """The same of beta, which is chi of as many degrees of freedom as give its variance by the jackknife.

        Above it is freed of its bias, sqrt(f/(f + 1)) where all capacities are known.  Below it is not: where some lie
        beyond what was seen there is less of it.
        """
        from scipy.stats import chi2

        freedom, tail = self._freedom(), 0.5 * (1.0 - CONFIDENCE)
        low = self.beta * np.sqrt(freedom / chi2.ppf(1.0 - tail, freedom))
        return low, self.beta * np.sqrt((freedom + 1.0) / chi2.ppf(tail, freedom))

    def _freedom(self) -> Array:
        """Degrees of freedom of beta, (states,): at least one, at most those of as many capacities as members."""
        with np.errstate(divide="ignore"):
            return np.clip(self.beta**2 / (2.0 * self.jackknife[:, 2]), 1.0, max(self.members - 1, 1))

    def exponent_limits(self) -> tuple[Array, Array]:
        """The same of the exponent of the second intensity, by the jackknife."""
        reach = self._reach * np.sqrt(self.jackknife[:, 3])
        return self.exponent - reach, self.exponent + reach

    def percentiles(self, beta_added: float) -> Array:
        """Intensities exceeded with the probabilities PERCENTILES, (states, percentiles)."""
        from scipy.special import ndtri

        z = ndtri(np.array(PERCENTILES) / 100.0)
        total = np.hypot(self.beta, beta_added)
        return self._above(total[:, None] * z)

    def percentile_limits(self, beta_added: float) -> tuple[Array, Array]:
        """Confidence limits of the percentiles.

        Those of `Scatter`, which are of the noncentral t (Owen 1968).  The median keeps its own limits; neither of
        smaller percentiles is above them, neither of larger ones below.
        """
        from scipy.special import ndtri
        from scipy.stats import nct

        low, high = (np.full((len(self.beta), len(PERCENTILES)), np.nan) for _ in range(2))
        z = ndtri(np.array(PERCENTILES) / 100.0)
        for j, of in enumerate(self.scatter()):
            if of is None:
                continue
            total = np.hypot(of.beta, beta_added)
            steep = z * of.beta / total  # derivative by beta
            rest = total * z - steep * of.beta - of.least * of.beta
            for into, tail in ((low, 0.5 * (1.0 - CONFIDENCE)), (high, 0.5 * (1.0 + CONFIDENCE))):
                into[j] = rest + of.unbiased * of.scale * nct.ppf(tail, of.freedom, (steep + of.least) / of.scale)
        low, high = self._above(low), self._above(high)
        (least, most), known = self.median_limits(), np.isfinite(low).all(axis=1)
        half = PERCENTILES.index(50.0)
        low[known, half], high[known, half] = least[known], most[known]
        for limits in (low, high):  # in order, also where those of the median are wider than the others
            limits[:, :half] = np.minimum(limits[:, :half], limits[:, half, None])
            limits[:, half:] = np.maximum(limits[:, half:], limits[:, half, None])
        return low, high

    def scatter(self) -> list[Scatter | None]:
        """What the scatter says of every state, by the variances of the jackknife; None where these are not known."""
        found: list[Scatter | None] = []
        for beta, (v_median, covariance, v_beta), freedom in zip(
            self.beta.tolist(), self.jackknife[:, :3].tolist(), self._freedom().tolist(), strict=True
        ):
            if not (v_median > 0.0 and v_beta > 0.0):
                found.append(None)
                continue
            least = covariance / v_beta
            scale = max(v_median - covariance * least, 1e-9 * v_median) ** 0.5 / beta
            found.append(Scatter(beta, beta * ((freedom + 1.0) / freedom) ** 0.5, freedom, least, scale))
        return found

    def _above(self, ln: Array) -> Array:
        """The intensity that is above x_0 by exp(ln) of what the median is."""
        return np.asarray(self.begins_at + (self.median - self.begins_at)[:, None] * np.exp(ln))


def curves(seen: Seen, states: int, *, fit: str = ORDINAL, begins_at: float = 0.0) -> Curves:
    """Fit the curves of nested limit states 1 ... states.

    Args:
        seen: what became of the members.
        states: number of limit states.
        fit: ORDINAL one beta for all, so that they never cross; LOGNORMAL each alone; NONE no curve.
        begins_at: intensity at and below which nothing can exceed any.
    """
    use = (seen.weight > 0.0) & (seen.x > 0.0)
    if seen.second is not None:
        use &= seen.second > 0.0
    early = use & too_weak(seen.x, begins_at)
    beneath = np.array([bool((early & (seen.low > j)).any()) for j in range(states)])
    use &= ~early
    rows_of = np.arange(seen.x.shape[0]) if seen.rows is None else seen.rows
    who = np.broadcast_to(rows_of[:, None], seen.x.shape)
    u, second_at = np.log(seen.x[use] - begins_at)[:, None], np.nan
    if seen.second is not None and use.any():
        y = np.log(seen.second[use])
        mean = np.average(y, weights=seen.weight[use])
        u, second_at = np.column_stack([u, y - mean]), float(np.exp(mean))
    shared = None if seen.shared is None else np.broadcast_to(seen.shared[:, None], seen.x.shape)[use]
    rows = Rows(u, seen.low[use], seen.high[use], seen.weight[use], who[use], shared)
    status = np.array([_status(rows, j) for j in range(states)], dtype=np.int8)
    status[beneath] = BELOW
    if u.shape[1] == 2 and np.linalg.matrix_rank(u - u.mean(axis=0), tol=1e-9 * len(u) ** 0.5) < 2:
        status[:] = COLLINEAR
    found = _blank(states, status, begins_at, len(np.unique(rows.member)), second_at)
    if fit == NONE:
        status[:] = NOT_ASKED
    elif fit == ORDINAL:
        _ordinal(rows, found)
    else:
        _each_alone(rows, found)
    _judge(rows, found)
    return replace(found, median=begins_at + found.median)


def too_weak(x: Array, begins_at: float) -> NDArray[np.bool_]:
    """Whether intensities are where nothing can exceed a limit state: at or below x_0, but for rounding."""
    return np.asarray(x <= begins_at * (1.0 + 1e-9))


def curve_of_capacities(
    low: Array, high: Array, member: Index, begins_at: float = 0.0, shared: Index | None = None
) -> Curves:
    """The curve of one limit state from the capacities of members: the intensities from which they exceed it.

    Args:
        low, high: (n,) each is above `low` and at most `high`, the same where it is known; NaN is left out.
        member: (n,) which belong together.
        begins_at: intensity at and below which nothing can exceed it.
        shared: (n,) as of `Seen`.
    """
    use = ~(np.isnan(low) | np.isnan(high))
    low, high, member = low[use], high[use], member[use]
    shared = None if shared is None else shared[use]
    status = FITTED
    if not np.isfinite(high).any():
        status = NONE_EXCEEDS
    elif (low <= begins_at).all():
        status = ALL_EXCEED
    elif (high <= begins_at * (1.0 + 1e-9)).any():
        status = BELOW
    found = _blank(1, np.array([status], dtype=np.int8), begins_at, len(np.unique(member)), np.nan)
    if status != FITTED:
        return found
    with np.errstate(divide="ignore"):
        ends = [np.log(np.maximum(end - begins_at, 0.0)) for end in (low, high)]
    fitted = fit_capacities(Capacities(ends[0], ends[1], member, shared))
    if fitted is None:
        found.status[0] = SEPARABLE
        return found
    (a, b), covariance = fitted
    # a probit of slope a and cut b
    probit = Probit(np.array([a]), np.array([b]), covariance, np.zeros_like(covariance))
    _put(found, np.array([0]), np.array([0]), probit)
    _judge_capacities(ends[0], ends[1], member, found)
    return replace(found, median=begins_at + found.median)


def _blank(states: int, status: NDArray[np.int8], begins_at: float, members: int, second_at: float) -> Curves:
    a, b, c, d, e, f, g, h, i = (np.full(states, np.nan) for _ in range(9))
    return Curves(a, b, c, d, e, status, begins_at, members, f, g, second_at, h, i, np.full((states, 4), np.nan))


def _judge(rows: Rows, into: Curves) -> None:
    """Hold every curve against the shares that exceed its state."""
    from scipy.special import ndtr

    for j in np.flatnonzero(into.status == FITTED):
        known = (rows.low > j) | (rows.high <= j)
        u = rows.u[known]
        along = u[:, 0] - np.log(into.median[j])  # of the median still above x_0
        if u.shape[1] == 2:
            along = along + into.exponent[j] * u[:, 1]
        p = ndtr(along / into.beta[j])
        group = groups_of(u[:, 0] if u.shape[1] == 1 else along, p)
        exceeds = (rows.low[known] > j).astype(float)
        into.misfit_p[j], at = misfit(p, exceeds, rows.weight[known], rows.member[known], group)
        into.misfit_at[j] = into.begins_at + float(np.exp(u[group == at, 0].mean()))


def _judge_capacities(low: Array, high: Array, member: Index, into: Curves) -> None:
    """Hold a curve through capacities, ln(x - x_0), against the shares below it at every tenth of it that is known."""
    from scipy.special import ndtri

    if into.status[0] != FITTED:
        return
    p = np.arange(0.1, 0.95, 0.1)
    u = np.log(into.median[0]) + into.beta[0] * ndtri(p)
    known = np.array([not ((low < at) & (high > at)).any() for at in u])
    if not known.any():
        return
    share = (high <= u[known, None]).mean(axis=1)
    found = two_sided(share, np.full(known.sum(), float(len(np.unique(member)))), p[known])
    into.misfit_p[0] = min(1.0, known.sum() * float(found.min()))
    into.misfit_at[0] = into.begins_at + float(np.exp(u[known][int(np.argmin(found))]))


def _each_alone(rows: Rows, into: Curves) -> None:
    """A probit of every limit state; rows that may lie on both sides of it are left out."""
    for j in np.flatnonzero(into.status == FITTED):
        known = (rows.low > j) | (rows.high <= j)
        above = (rows.low[known] > j).astype(np.int64)
        shared = None if rows.shared is None else rows.shared[known]
        alone = Rows(rows.u[known], above, above, rows.weight[known], rows.member[known], shared)
        _put(into, np.array([j]), np.array([0]), ordered_probit(alone, 1))


def _ordinal(rows: Rows, into: Curves) -> None:
    """All limit states that some exceed and some do not, with one slope; those without a row between are one."""
    if not (into.status == FITTED).any():  # a maximum needs one at least of which the shares overlap
        return
    there = np.flatnonzero(np.isin(into.status, (FITTED, SEPARABLE, FALLING)))
    exact = rows.low == rows.high
    cut = [int(there[0])]  # the first of every group of states that no row tells apart
    group = [0]
    for j in there[1:]:
        between = exact & (rows.low > cut[-1]) & (rows.low <= j)
        if between.any():
            cut.append(int(j))
        group.append(len(cut) - 1)
    alone = [int(j) for j in there if into.status[j] == SEPARABLE]
    # categories counted by the groups they lie above
    low, high = (np.searchsorted(cut, of, side="left").astype(np.int64) for of in (rows.low, rows.high))
    grouped = Rows(rows.u, low, high, rows.weight, rows.member, rows.shared)
    _put(into, there, np.array(group), ordered_probit(grouped, len(cut)))
    if rows.u.shape[1] == 1:
        for j in alone:
            _no_finer_than_seen(rows, into, j)


def _no_finer_than_seen(rows: Rows, into: Curves, j: int) -> None:
    """Widen the limits of a median to the step within which all members begin to exceed the state.

    Members that answer alike have no scatter there, and the covariance of their sums would be next to nothing.
    """
    if into.status[j] != FITTED:
        return
    ends = rows.u[rows.high <= j, 0].max(), rows.u[rows.low > j, 0].min()
    se = max(abs(float(np.log(into.median[j])) - end) for end in ends) / into._reach
    if se > into.se_ln_median[j]:
        into.correlation[j] *= into.se_ln_median[j] / se
        into.se_ln_median[j] = se
        into.jackknife[j, 0] = max(into.jackknife[j, 0], se**2)


def _put(into: Curves, states: Index, cuts: Index, found: Probit | None) -> None:
    """Put what was found into the arrays of `into`: (slope, cut) -> (ln median, beta)."""
    if found is None:
        into.status[states] = SEPARABLE
        return
    slope = float(found.slopes[0])
    if not slope > 0.0:
        into.status[states] = FALLING
        return
    into.status[states] = FITTED
    for state, cut in zip(states, cuts, strict=True):
        t = float(found.cuts[cut])
        pick = [0, len(found.slopes) + int(cut)]
        jacobian = np.array([[-t / slope**2, 1.0 / slope], [-1.0 / slope**2, 0.0]])
        moved = jacobian @ found.covariance[np.ix_(pick, pick)] @ jacobian.T
        se = np.sqrt(np.maximum(np.diagonal(moved), 0.0))
        into.median[state], into.beta[state] = np.exp(t / slope), 1.0 / slope
        into.se_ln_median[state], into.se_beta[state] = se
        spread = moved
        if found.without is not None:
            spread = jackknife_covariance(_moves(found, pick, jacobian))
            spread = spread + jacobian @ found.of_shared[np.ix_(pick, pick)] @ jacobian.T
        into.jackknife[state, :3] = spread[0, 0], spread[0, 1], spread[1, 1]
        into.correlation[state] = moved[0, 1] / (se[0] * se[1]) if se.all() else np.nan
        if len(found.slopes) == 2:
            other = float(found.slopes[1])
            gradient = np.array([-other / slope**2, 1.0 / slope])
            into.exponent[state] = other / slope
            into.se_exponent[state] = np.sqrt(max(gradient @ found.covariance[:2, :2] @ gradient, 0.0))
            into.jackknife[state, 3] = into.se_exponent[state] ** 2
            if found.without is not None:
                along = (found.without[:, :2] - found.slopes) @ gradient
                of_shared = float(gradient @ found.of_shared[:2, :2] @ gradient)
                into.jackknife[state, 3] = float(jackknife_covariance(along[:, None])[0, 0]) + of_shared


def _moves(found: Probit, pick: list[int], jacobian: Array) -> Array:
    """How ln(median - x_0) and beta of a state move without each member, (members, 2).

    By their derivatives for a step, in slope and cut, from the estimate; where they were fitted, as they are.
    """
    assert found.without is not None
    assert found.fitted is not None
    without, estimate = found.without[:, pick], np.concatenate([found.slopes, found.cuts])[pick]
    moves = (without - estimate) @ jacobian.T
    fitted = found.fitted & (without[:, 0] > 0.0)
    slope, cut = without[fitted].T
    moves[fitted] = np.column_stack([cut / slope, 1.0 / slope]) - np.array([estimate[1], 1.0]) / estimate[0]
    return np.asarray(moves)


def _status(rows: Rows, j: int) -> int:
    """Whether a finite maximum exists for one state: some row that does not exceed lies above some that does."""
    hit, miss = rows.low > j, rows.high <= j
    if not hit.any():
        return NONE_EXCEEDS
    if not miss.any():
        return ALL_EXCEED
    x = rows.u[:, 0]
    if x[hit].min() >= x[miss].max():
        return SEPARABLE
    return FALLING if x[hit].max() <= x[miss].min() else FITTED
