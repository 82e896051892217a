"""What two accuracies say of an outcome: right and said to be known, or `unresolved` with the reason in words.

The truths of the chaotic cases are Taylor series in 60 to 120 digits of the same cases, written apart from the solver:
their peaks agree to 20 digits from one working precision, order and rest rule to the next.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import SHARED, G, array, block, make_batch, pulse, record, unit_block

from rockcli.motion.reading import read_record
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT, ROCKING, UNRESOLVED
from rockcli.solvers.agreement import compare_accuracies, disagreement, horizon_of, parted_later
from rockcli.solvers.event import solve
from rockcli.solvers.general.solver import solve as solve_generally

ESTIMATED = ("outcome", "theta_peak_over_alpha", "error_estimate")
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
    assert np.isnan(found.scalars["theta_peak_over_alpha"][0])
    assert "two accuracies" in found.reasons[0]


def test_reference_is_right_within_its_estimate():
    found = solve(train("cosine", accuracy="reference", scalars=ESTIMATED)).scalars
    assert found["outcome"][0] == ROCKING
    assert abs(found["theta_peak_over_alpha"][0] - TRAIN_PEAK) < found["error_estimate"][0] < 0.01


def test_reference_knows_a_peak_and_not_what_comes_after_it():
    """The sine's: its peak is known to .003, and yet two runs go different ways after it."""
    found = solve(train("sine", accuracy="reference", scalars=ESTIMATED))
    assert found.scalars["outcome"][0] == UNRESOLVED
    assert "impacts: chaotic" in found.reasons[0]


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
    assert any("impacts: chaotic" in reason for reason in standard.reasons)


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
    assert found["error_estimate"][0] < 1e-6


class TestRule:
    """The comparison itself, on answers made up."""

    def compared(self, one, two, horizon=0.01):
        batch = make_batch(unit_block(0.1), pulse("sine", array([1.0]), array([1.0])))  # p = 1
        names = ("outcome", "theta_peak_over_alpha", "t_overturn")
        ours, other = ({name: array(x) for name, x in zip(names, run, strict=True)} for run in (one, two))
        unasked = ("theta_peak", "theta_dot_peak", "u_top_peak", "t_peak")
        ours |= {name: array(1.0) for name in unasked}
        reasons = [""]
        compare_accuracies(batch, ours, other, reasons, horizon)
        return ours["outcome"][0], ours["error_estimate"][0], reasons[0]

    def test_peaks_that_agree(self):
        assert self.compared((1, 0.5, np.nan), (1, 0.5 + 2.0**-8, np.nan)) == (ROCKING, 2.0**-8, "")

    def test_peaks_that_have_parted(self):
        outcome, apart, reason = self.compared((1, 0.5, np.nan), (1, 0.25, np.nan))
        assert (outcome, apart) == (UNRESOLVED, 0.25)
        assert "differ by 0.25 in peak theta/alpha: chaotic" in reason

    def test_one_alone_overturns(self):
        outcome, apart, reason = self.compared((1, 0.5, np.nan), (3, np.inf, 7.0), horizon=np.inf)
        assert (outcome, apart) == (UNRESOLVED, np.inf)
        assert "disagree on the outcome" in reason

    def test_the_same_fall(self):
        found = self.compared((3, np.inf, 7.0), (3, np.inf, 7.0625))
        assert found == (OVERTURNED_AFTER_IMPACT, 0.0, "")

    def test_falls_in_different_swings(self):
        outcome, apart, reason = self.compared((3, np.inf, 7.0), (3, np.inf, 9.5))
        assert (outcome, apart) == (UNRESOLVED, np.inf)
        assert "overturn at 7 and 9.5 s: chaotic" in reason

    def test_without_a_horizon_only_the_outcomes_count(self):
        assert self.compared((1, 0.5, np.nan), (1, 0.25, np.nan), np.inf) == (ROCKING, 0.25, "")
        assert self.compared((3, np.inf, 7.0), (3, np.inf, 9.5), np.inf) == (OVERTURNED_AFTER_IMPACT, 0.0, "")

    def test_no_answer_says_nothing(self):
        batch = make_batch(unit_block(0.1), pulse("sine", array([1.0]), array([1.0])))
        ours = {"outcome": array(1), "theta_peak_over_alpha": array(0.5), "t_overturn": array(np.nan)}
        other = {"outcome": array(-2), "theta_peak_over_alpha": array(np.nan), "t_overturn": array(np.nan)}
        assert np.isnan(disagreement(batch, ours, other, 0.01)[0])

    @pytest.mark.parametrize(
        ("outcomes", "impacts", "apart"),
        [
            ((1, 1), (10, 12), False), ((1, 1), (10, 13), True),  # two more may be the last bounces
            ((1, 1), (1000, 1018), False), ((1, 1), (1030, 1000), True),
            ((1, 3), (10, 500), False), ((1, -2), (10, 0), False),
        ],
    )  # fmt: skip
    def test_other_impacts(self, outcomes, impacts, apart):
        one, two = ({"outcome": array(o), "n_impacts": array(n)} for o, n in zip(outcomes, impacts, strict=True))
        assert parted_later(one, two)[0] == apart

    def test_a_loose_tolerance_is_no_chaos(self):
        assert horizon_of(1e-3) == 1.0
        assert horizon_of(1e-9) == 0.01


def test_a_general_method_says_it_too():
    batch = replace(train("sine", scalars=ESTIMATED), numerics=Numerics(backend="scipy", accuracy="standard"))
    found = solve_generally(batch)
    assert found.scalars["outcome"][0] == UNRESOLVED
    assert "two accuracies" in found.reasons[0]
