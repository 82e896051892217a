"""Overturning thresholds: the outcome flips at (1 -/+ 1e-7) of the closed forms (tables.py)."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, block, overturns, pulse, rock, still, unit_block
from tables import BANDS, HALF_SINE, ONE_SINE, ONE_SINE_ONE_IMPACT, RECTANGULAR, SQUARE_CYCLE

import rockcli
from rockcli.scene.response import NO_UPLIFT, ROCKING

EPSILON = 1e-7


def outcomes(A: float, shape: str, omega_p: float, *, model: str, eta, alpha: float = 0.1) -> tuple[int, int]:
    """Outcome flags just below and just above amplitude A (over g alpha if linear, over g tan(alpha) if not)."""
    unit = G * (alpha if model == "linearized" else np.tan(alpha))
    found = []
    for factor in (1.0 - EPSILON, 1.0 + EPSILON):
        response = rock(unit_block(alpha), pulse(shape, A * factor * unit, omega_p), model=model, eta=eta)
        overturns(response)  # a resolved outcome
        found.append(int(response.scalars["outcome"][0]))
    return found[0], found[1]


@pytest.mark.parametrize("row", RECTANGULAR, ids=str)
def test_rectangular_pulse(row):
    below, above = outcomes(row["A"], "rectangular", np.pi / row["p_t1"], model="linearized", eta=0.9)
    assert (below, above) == (1, 2)


@pytest.mark.parametrize("row", HALF_SINE, ids=str)
def test_half_sine(row):
    assert outcomes(row["A"], "half_sine", row["Omega"], model="linearized", eta=0.9) == (1, 2)


@pytest.mark.parametrize("row", ONE_SINE, ids=str)
def test_one_sine_without_impact(row):
    below, above = outcomes(row["A"], "sine", row["Omega"], model="linearized", eta=0.9)
    assert (below != 2, above) == (True, 2)


@pytest.mark.parametrize(
    ("Omega", "eta", "A", "flags"),
    [
        (row["Omega"], row["eta"], row[side], flags)
        for row in ONE_SINE_ONE_IMPACT
        for side, flags in (("lower", (1, 3)), ("upper", (3, 1)))
        if row[side] is not None  # without an upper edge the band ends in overturning without impact
    ],
)
def test_one_sine_one_impact(Omega, eta, A, flags):
    assert outcomes(A, "sine", Omega, model="linearized", eta=eta) == flags


@pytest.mark.parametrize("row", SQUARE_CYCLE, ids=str)
def test_one_square_cycle(row):
    omega_p = np.pi / row["p_t_half"]
    below, above = outcomes(row["A"], "square_cycle", omega_p, model="linearized", eta=row["eta"])
    assert (below != 2, above) == (True, 2)
    for root in row["roots"]:
        flags = outcomes(root, "square_cycle", omega_p, model="linearized", eta=row["eta"])
        assert sorted(flags) == [1, 3]


@pytest.mark.parametrize(
    ("row", "transition"),
    [(row, transition) for row in BANDS for transition in row["transitions"]],
    ids=lambda x: str(x) if isinstance(x, tuple) else f"{x['shape']}-{x['alpha']}-{x['Omega']:g}",
)
def test_nonlinear_bands(row, transition):
    A, before, after = transition
    alpha = row["alpha"] if row["alpha"] is not None else float(np.arctan(row["tan_alpha"]))
    below, above = outcomes(A, row["shape"], row["Omega"], model="rigid", eta="housner", alpha=alpha)
    assert (below >= 2) == (before != "s")
    if before == "s":
        assert above >= 2
        if after in ("o0", "o1"):
            assert above == {"o0": 2, "o1": 3}[after]
    elif after == "s":
        assert above == 1
    elif (before, after) == ("o1", "o0"):  # the band ends here; a thin band of survival may come before o0
        assert (below, above != 3) == (3, True)


def test_ricker_beyond_its_bands_survives():
    """Omega = 8: nothing overturns up to the largest amplitude scanned."""
    for A in (2.0, 4.0, 5.0):
        assert not overturns(rock(unit_block(np.arctan(0.2)), pulse("ricker", A * G * 0.2, 8.0)))


def test_velocity_jump_of_ishiyama():
    """Ishiyama 1982 (EESD 10:635): the ground-velocity jump that overturns, nonlinear and exact."""
    R, ta = 1.0, 0.1
    alpha = np.arctan(ta)
    v_0 = 0.3621123791694383
    theta_dot_0 = 0.270236463231759064
    assert np.sqrt(8.0 / 3.0 * G * R * (1.0 - np.cos(alpha))) / np.cos(alpha) == pytest.approx(v_0, rel=1e-11)
    assert 0.75 * v_0 * np.cos(alpha) / R == pytest.approx(theta_dot_0, rel=1e-11)
    body = block(R, ta)
    assert not overturns(rock(body, still(), theta_dot_0=theta_dot_0 * (1.0 - 1e-10)))
    assert overturns(rock(body, still(), theta_dot_0=theta_dot_0 * (1.0 + 1e-10)))


def test_double_impulse():
    """Nabeshima et al. 2016: a second jump right after the first impact, V = v_0/(1 + eta)."""
    R, ta, V = 1.0, 0.1, 0.182410724668894106
    alpha = np.arctan(ta)
    eta = 1.0 - 1.5 * np.sin(alpha) ** 2
    jump = 0.75 * V * np.cos(alpha) / R
    first = rock(block(R, ta), still(), theta_dot_0=jump, histories=True)
    rate = -first.impacts["theta_dot_after"][0, 0]
    assert rate == pytest.approx(eta * jump, rel=1e-11)
    # the second jump is in the sense of the motion onto the other edge
    for factor, falls in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        rates = jump * factor * (1.0 + eta)
        assert overturns(rock(block(R, ta), still(), theta_dot_0=-rates)) is falls


@pytest.mark.parametrize("rolls", [False, True], ids=["block", "rolling"])
@pytest.mark.parametrize("b", [0.577, 0.59, 0.603])
def test_a_ground_that_stays_at_uplift_to_rounding_ends_in_an_answer(rolls, b):
    """A few roundings about g tan(alpha) lift a body next to nothing, or not at all, as long as the ground stays there."""
    outline = [[-b, 0.0], [b, 0.0], [1.2 * b, 1.0], [b, 2.0], [-b, 2.0], [-1.2 * b, 1.0]]
    amplitudes = sorted({-G * b * (1.0 + k * 1.1e-16) for k in range(-4, 9)})
    study = {
        "case": {
            "block": {"outline": outline} if rolls else {"h": 1.0, "b": b},
            "motion": {"pulse": {"shape": "rectangular", "a_p": 1.0, "omega_p": 2.0}},
        },
        "vary": {"case": {f"case {k}": {"motion.pulse.a_p": a_p} for k, a_p in enumerate(amplitudes)}},
        "save": {"histories": False},
    }
    rocked = rockcli.run(study)
    assert set(rocked.outcome.values.tolist()) == {NO_UPLIFT, ROCKING}
    assert float(rocked.theta_peak_over_alpha.max()) < 1e-12
    assert int(rocked.n_steps.max()) < 20_000
    assert (np.isnan(rocked.t_uplift) == (rocked.outcome == NO_UPLIFT)).all()
    still_ones = rocked.where(rocked.outcome == NO_UPLIFT)
    assert float(np.abs(still_ones.theta_peak).max()) == 0.0
    assert np.isnan(still_ones.t_peak).all()


@pytest.mark.parametrize("rolls", [False, True], ids=["block", "rolling"])
def test_what_does_not_rise_by_a_rounding_has_no_peak(rolls):
    """Records scaled to uplift, where rounding decides: one of no uplift has no rotation, not one of 1e-49 either."""
    outline = [["-half", 0.0], ["half", 0.0], ["1.2*half", 1.0], ["half", 3.0], ["-half", 3.0], ["-1.2*half", 1.0]]
    study = {
        "case": {
            "block": {"outline": outline} if rolls else {"h": 1.5, "b": "half"},
            "motion": {"record": {"file": "synthetic_rock_m65.AT2", "pga_over_g_tan_alpha": 1.0}},
        },
        "let": {"half": 0.3},
        "vary": {
            "motion.record.file": [f"synthetic_{name}.AT2" for name in ("rock_m65", "pulse_m70", "soil_m70")],
            "let.half": {"from": 0.25, "to": 0.4, "n": 12},
        },
        "save": {"histories": False},
    }
    found = rockcli.run(study)
    standing = found.where(found.outcome == NO_UPLIFT)
    assert int((found.outcome == NO_UPLIFT).sum()) > 3
    assert float(np.abs(standing.theta_peak).max()) == 0.0
    assert np.isnan(standing.t_peak).all()
