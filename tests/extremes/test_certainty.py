"""How sure an outcome is: right and said to be known, or `unresolved` with the share of runs that overturn.

The truths of the chaotic cases are Taylor series in 60 to 120 digits of the same cases, written apart from the solver:
their peaks agree to 20 digits from one working precision, order and rest rule to the next.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import SHARED, G, array, block, make_batch, pulse, record, rock, still, unit_block

from rockcli.kernels.constants import FALLS, NO_ANSWER, RETURNS, UNDECIDED
from rockcli.motion.reading import read_record
from rockcli.scene.body.block import make_block
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT, ROCKING, UNRESOLVED
from rockcli.solvers.common.certainty import MEMBERS, Judgement, Perturbation, Traces, compare_steps, judge
from rockcli.solvers.event.solver import solve
from rockcli.solvers.general.solver import solve as solve_generally

ESTIMATED = ("outcome", "theta_peak_over_alpha", "t_overturn", "error_estimate", "overturn_share")
ESTIMATED_SET = frozenset(ESTIMATED)

TRAIN_PEAK = 0.94332583344604183416
"""Ten cycles of 1.05 g tan(alpha), omega_p = 2 p, eta = .9, R = 2 m, tan(alpha) = .2: it rocks, by a sine as by a cosine.
A difference of 1e-20 of a_p in the motion grows to 2.9e-8 of the peak."""

DELTA_PEAK = 0.45100319149096580
"""Delta 352 of Imperial Valley 1979 at a PGA of 2 g tan(alpha), R = 5 m, tan(alpha) = .1, Housner's eta: it rocks."""


def train(shape, **how):
    omega_p = 2.0 * np.sqrt(3.0 * G / 8.0)
    return make_batch(block(2.0, 0.2), pulse(shape, 1.05 * G * 0.2, omega_p, cycles=10.0), eta=0.9, **how)


def test_standard_does_not_claim_what_it_cannot_know():
    found = solve(train("sine", accuracy="standard", scalars=ESTIMATED))
    assert found.scalars["outcome"][0] == UNRESOLVED
    assert 0.0 < found.scalars["overturn_share"][0] < 1.0
    assert np.isnan(found.scalars["theta_peak_over_alpha"][0])
    assert f"of {MEMBERS + 1} runs whose motions differ by" in found.reasons[0]


def test_reference_is_right_within_its_estimate():
    found = solve(train("cosine", accuracy="reference", scalars=ESTIMATED)).scalars
    assert found["outcome"][0] == ROCKING
    assert found["overturn_share"][0] == 0.0
    assert abs(found["theta_peak_over_alpha"][0] - TRAIN_PEAK) < found["error_estimate"][0] < 0.1


def test_chaos_after_the_peak_is_no_outcome():
    """Long after peaks of a few hundredths of alpha, on which all agree, some of these bodies overturn."""
    a_p, omega_p = np.linspace(1.045, 1.065, 150) * G * 0.1, 2.0 * np.sqrt(3.0 * G / 8.0)
    slender = make_batch(
        block(2.0, 0.1, n=150), pulse("cosine", a_p, np.full(150, omega_p), cycles=np.full(150, 10.0)), eta=0.9
    )
    standard, reference = (
        solve(replace(slender, numerics=Numerics(accuracy=level), save=replace(slender.save, scalars=ESTIMATED_SET)))
        for level in ("standard", "reference")
    )
    outcomes = standard.scalars["outcome"], reference.scalars["outcome"]
    decided = (outcomes[0] != UNRESOLVED) & (outcomes[1] != UNRESOLVED)
    np.testing.assert_array_equal(outcomes[0][decided], outcomes[1][decided])
    assert decided.mean() > 0.7
    share = standard.scalars["overturn_share"]
    np.testing.assert_array_equal(outcomes[0] == UNRESOLVED, (share > 0.0) & (share < 1.0))
    assert (outcomes[0] == UNRESOLVED).any()


@pytest.mark.skipif(not SHARED.is_dir(), reason="needs real records beside the checkout")
@pytest.mark.parametrize("accuracy", ["draft", "standard", "reference"])
def test_a_record_whose_end_no_accuracy_reaches(accuracy):
    motion = read_record(SHARED / "records" / "peer" / "RSN169_IMPVALL.H_H-DLT352.AT2")
    values = motion.acceleration(G)
    shaken = record(values, motion.dt, factor=2.0 * G * 0.1 / np.abs(values).max())
    found = solve(make_batch(block(5.0, 0.1), shaken, accuracy=accuracy, scalars=ESTIMATED)).scalars
    if found["outcome"][0] != UNRESOLVED:  # then it has to be right
        assert found["outcome"][0] == ROCKING
        assert abs(found["theta_peak_over_alpha"][0] - DELTA_PEAK) < 10.0 * found["error_estimate"][0]
    else:
        assert found["error_estimate"][0] >= 0.001


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_what_a_coarse_run_leaves_in_doubt_a_finer_one_decides(side):
    """A start 1e-9 beside the separatrix theta_dot = p sqrt(2 (1 - cos alpha)): within the tolerance of the coarse run."""
    alpha = 0.1
    start = np.sqrt(2.0 * (1.0 - np.cos(alpha))) * (1.0 + side * 1e-9)
    still = pulse("rectangular", 0.0, 100.0)
    batch = make_batch(unit_block(alpha), still, theta_dot_0=start, accuracy="standard", scalars=ESTIMATED)
    found = solve(batch).scalars
    assert found["outcome"][0] == (ROCKING if side < 0.0 else OVERTURNED_WITHOUT_IMPACT)
    if side < 0.0:  # energy is kept to the turning point
        top = alpha - np.arccos(np.cos(alpha) + 0.5 * start**2)
        assert abs(found["theta_peak_over_alpha"][0] - top / alpha) < found["error_estimate"][0] < 1e-5


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_motion_within_the_perturbation_of_the_threshold_is_decided(side):
    """Runs a billionth apart part at 1e-10 of the amplitude that just overturns; more accurate ones do not."""

    def under(a_p, **how):
        return make_batch(unit_block(0.2), pulse("ricker", a_p, 3.0), eta=0.9, **how)

    stands, falls = 1.5 * G * 0.2, 6.0 * G * 0.2
    for _ in range(60):
        half = 0.5 * (stands + falls)
        fell = solve(under(half, accuracy="reference", scalars=("outcome",))).scalars["outcome"][0] != ROCKING
        stands, falls = (stands, half) if fell else (half, falls)
    found = solve(under(falls * (1.0 + side * 1e-10), accuracy="standard", scalars=ESTIMATED)).scalars
    assert found["outcome"][0] == (ROCKING if side < 0.0 else OVERTURNED_AFTER_IMPACT)
    assert found["overturn_share"][0] == (0.0 if side < 0.0 else 1.0)


def test_a_body_that_bounces_on_unequal_edges_stands():
    """Let go on still ground its energy only falls: below the barrier of the weak edge it stands, however it bounces."""
    body = make_block(h=1.0, b=np.array([[0.1, 0.5]]), r_g=0.6)
    for accuracy in ("draft", "standard", "reference"):
        found = rock(body, still(), theta_0=-0.05, accuracy=accuracy, scalars=ESTIMATED)
        assert found.scalars["outcome"][0] == ROCKING
        assert found.scalars["overturn_share"][0] == 0.0
        assert found.reasons == [""]


def test_unequal_edges_are_as_certain_as_equal_ones():
    """Random bodies to an edge ratio of five, let go below every barrier: all stand, whatever they do on the way."""
    rng = np.random.default_rng(400)
    n = 200
    b = 0.1 * np.column_stack([np.ones(n), rng.uniform(1.0, 5.0, n)])
    body = make_block(h=rng.uniform(0.3, 1.0, n), b=b, r_g=rng.uniform(0.3, 0.6, n), n=n)
    start = -rng.uniform(0.05, 0.9, n) * body.alpha[:, 0]
    batch = make_batch(body, replace(still(), duration=np.full(n, np.nan)), accuracy="standard", scalars=ESTIMATED)
    found = solve(replace(batch, theta_0=start)).scalars
    np.testing.assert_array_equal(found["outcome"], ROCKING)
    np.testing.assert_array_equal(found["overturn_share"], 0.0)


@pytest.mark.skipif(not SHARED.is_dir(), reason="needs real records beside the checkout")
def test_what_overturns_at_an_unknown_time_overturns():
    """A long record at many times what uplifts a slender body: every run overturns, not every run in the same swing."""
    motion = read_record(SHARED / "records" / "peer" / "RSN169_IMPVALL.H_H-DLT352.AT2")
    values = motion.acceleration(G)
    n = 60
    factor = np.linspace(3.0, 9.0, n) * G * 0.1 / np.abs(values).max()
    shaken = record(values, motion.dt, factor=factor)
    found = solve(make_batch(block(5.0, 0.1, n=n), shaken, accuracy="draft", scalars=ESTIMATED))
    late = np.array(["when is chance" in reason for reason in found.reasons])
    assert late.any()
    assert (found.scalars["outcome"][late] == OVERTURNED_AFTER_IMPACT).all()
    assert (found.scalars["overturn_share"][late] == 1.0).all()
    assert np.isnan(found.scalars["t_overturn"][late]).all()


def test_on_a_separatrix_half_of_the_runs_overturn():
    start = np.sqrt(2.0 * (1.0 - np.cos(0.1)))
    found = rock(unit_block(0.1), still(), theta_dot_0=start, accuracy="standard", scalars=ESTIMATED).scalars
    assert found["outcome"][0] == UNRESOLVED
    assert found["overturn_share"][0] == pytest.approx(0.5, abs=0.3)


def traces(verdict, *, fall=0.0, peak=0.5, swings=1.0, when=1.0):
    """Of one case or several."""
    verdict = np.atleast_1d(np.asarray(verdict, dtype=np.int8))
    return Traces(verdict, *(np.broadcast_to(array(x), verdict.shape) for x in (fall, peak, swings, when)))


class TestTwoRuns:
    """Where two runs have gone different ways, on answers made up."""

    def test_a_difference_that_has_not_grown(self):
        one = traces(RETURNS)
        assert not one.parted(traces(RETURNS, peak=0.505, swings=1.005, when=1.05))[0]

    @pytest.mark.parametrize("other", [{"peak": 0.52}, {"swings": 1.02}, {"when": 1.2}])
    def test_one_that_has(self, other):
        assert traces(RETURNS).parted(traces(RETURNS, **other))[0]

    def test_small_swings_part_by_small_differences(self):
        one = traces(RETURNS, peak=0.01, swings=0.02)
        assert one.parted(traces(RETURNS, peak=0.01, swings=0.0215))[0]
        assert not one.parted(traces(RETURNS, peak=0.01, swings=0.0201))[0]

    def test_falls(self):
        assert not traces(FALLS, fall=7.0).parted(traces(FALLS, fall=7.09, swings=9.0))[0]
        assert traces(FALLS, fall=7.0).parted(traces(FALLS, fall=9.5))[0]
        assert traces(FALLS).parted(traces(RETURNS))[0]
        assert traces(UNDECIDED).parted(traces(RETURNS))[0]

    def test_no_answer_says_nothing(self):
        assert not traces(NO_ANSWER).parted(traces(RETURNS))[0]
        assert np.isnan(traces(NO_ANSWER).apart(traces(RETURNS))[0])

    def test_distance_of_peaks(self):
        one, other = traces([RETURNS, FALLS, FALLS], peak=0.5), traces([RETURNS, FALLS, RETURNS], peak=0.25)
        np.testing.assert_array_equal(one.apart(other), [0.25, 0.0, np.inf])


class TestJudgement:
    """Bodies that overturn where their motion is larger than a threshold, the peak of the others that of the motion."""

    def judged(self, threshold, finer=None):
        def runs(rows, factors, fine=True):
            return traces(np.where(factors > threshold, FALLS, RETURNS), peak=factors, swings=0.0, when=0.0)

        def refine(rows):
            return runs(rows, np.ones(len(rows)))

        return judge(refine([0]), runs, Perturbation(1e-3, 0.1), refine, finer, 1e-3)

    def test_far_from_the_threshold(self):
        for threshold, share in ((1.1, 0.0), (0.9, 1.0)):
            found = self.judged(threshold)
            assert (found.share[0], found.said) == (share, [""])
            assert found.error[0] == pytest.approx(1e-4 if share == 0.0 else 0.0)

    @pytest.mark.parametrize("beyond", [0.05, 0.35, 0.95])
    def test_the_share_is_that_of_the_motions_beyond_the_threshold(self, beyond):
        found = self.judged(1.0 - beyond * 1e-3)
        steps = np.linspace(-1.0, 1.0, MEMBERS + 1)
        assert found.share[0] == pytest.approx(np.mean(steps > -beyond))
        assert f"{found.share[0]:.0%} of 21 runs" in found.said[0]

    @pytest.mark.parametrize(
        ("undecided", "said"),
        [
            (MEMBERS + 1, ""),  # why the solver cannot tell it says itself
            (8, "19% of 21 runs whose motions differ by 1e-03 overturn, the 8 of them that are undecided counted half"),
        ],
    )
    def test_runs_that_come_to_no_decision_are_no_sign_of_chaos(self, undecided, said):
        def runs(rows, factors, fine=True):
            return traces(np.where(np.arange(len(factors)) < undecided - 1, UNDECIDED, RETURNS))

        found = judge(traces(UNDECIDED), runs, Perturbation(1e-3, 0.1), None, None, 1e-3)
        assert found.share[0] == pytest.approx(0.5 * undecided / (MEMBERS + 1))
        assert found.said[0].partition(":")[0] == said
        assert found.error[0] == np.inf

    def test_a_more_accurate_run_decides(self):
        found = self.judged(1.0 - 0.5e-3, finer=Perturbation(1e-6, 0.1))
        assert (found.share[0], found.said) == (1.0, [""])

    def test_only_what_is_between_is_withdrawn(self):
        scalars = {"outcome": array([3, 1, 1, -2, -1]).astype(np.int8), "t_overturn": array([7.0, *[np.nan] * 4])}
        share = array([1.0, 0.25, 0.0, np.nan, 0.0])  # the last was refused for its friction
        late = np.array([True, *[False] * 4])
        Judgement(share, np.zeros(5), late, [""] * 5).enter(scalars, [""] * 5)
        np.testing.assert_array_equal(scalars["outcome"], [3, -1, 1, -2, -1])
        np.testing.assert_array_equal(scalars["overturn_share"], [1.0, 0.25, 0.0, np.nan, np.nan])
        assert np.isnan(scalars["t_overturn"]).all()


def test_two_steps_that_disagree_are_half_of_the_runs_each():
    batch = make_batch(block(2.0, 0.1, n=2), pulse("sine", [1.0, 1.0], [1.0, 1.0]))
    ours, other = (
        {"outcome": array(o).astype(np.int8), "theta_peak_over_alpha": array(p), "t_overturn": array([np.nan] * 2)}
        for o, p in (([1, 1], [0.5, 0.5]), ([1, 3], [0.25, np.inf]))
    )
    reasons = ["", ""]
    compare_steps(batch, ours, other, reasons)
    np.testing.assert_array_equal(ours["outcome"], [ROCKING, UNRESOLVED])
    np.testing.assert_array_equal(ours["overturn_share"], [0.0, 0.5])
    np.testing.assert_array_equal(ours["error_estimate"], [0.25, np.inf])
    assert reasons[0] == ""
    assert "two steps disagree on the outcome" in reasons[1]


@pytest.mark.slow
def test_a_general_method_says_it_too():
    batch = replace(train("sine", scalars=ESTIMATED), numerics=Numerics(backend="scipy", accuracy="standard"))
    found = solve_generally(batch)
    assert found.scalars["outcome"][0] == UNRESOLVED
    assert 0.0 < found.scalars["overturn_share"][0] < 1.0
    assert "runs whose motions differ by" in found.reasons[0]
