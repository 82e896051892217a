"""Numerical extremes of the rigid block: each right, or flagged, or refused."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import G, array, overturns, pulse, record, repeated, rock, still, unit_block, with_ground

from rockcli.scene.body.block import housner_eta
from rockcli.scene.ground.excitation import Excitation
from rockcli.scene.response import UNRESOLVED


def test_slender_block_quarter_period():
    response = rock(unit_block(1e-3), still(), theta_0=0.5e-3, eta=1.0 - 1.49999950000006667e-6, histories=True)
    assert response.impacts["t_impact"][0, 0] == pytest.approx(1.31695793554448083, rel=1e-9)
    assert 1.0 - housner_eta(unit_block(1e-3))[0, 0] == pytest.approx(1.49999950000006667e-6, rel=1e-9)


@pytest.mark.slow
def test_slender_block_needs_four_million_impacts():
    """alpha = 1e-3, Housner's eta: 4 278 226 impacts until the amplitude is 1e-6 alpha; rest at p t = 1 296 572.78."""
    alpha, eta = 1e-3, 0.9999985000005
    response = rock(
        unit_block(alpha),
        still(duration=1.3e6),
        model="linearized",
        theta_0=0.5 * alpha,
        eta=eta,
        scalars=("n_impacts",),
    )
    # impacts faster than 1e-6 p alpha: v = v_0 eta^n, v_0 = sqrt(1 - 0.5^2)
    v_0 = np.sqrt(0.75)
    expected = np.ceil(np.log(1e-6 / v_0) / np.log(eta))
    assert response.scalars["n_impacts"][0] == pytest.approx(expected, abs=2)


def test_stocky_block_has_a_negative_housner_eta():
    body = unit_block(1.2)
    assert housner_eta(body)[0, 0] == pytest.approx(-0.303045286655934125, rel=1e-12)
    response = rock(body, still(), theta_0=0.6, eta=0.0, histories=True, dt_out=0.01)
    assert response.impacts["t_impact"][0, 0] == pytest.approx(1.37489529215034597, rel=1e-9)
    assert response.scalars["n_impacts"][0] == 1
    after = response.time > 1.3749
    assert np.all(response.histories["theta"][0, after] == 0.0)


@pytest.mark.parametrize("R", [1e-3, 1.0, 1e4])
def test_size_does_not_matter(R):
    alpha = 0.2
    p = np.sqrt(0.75 * G / R)
    motion = pulse("sine", 2.5 * G * np.tan(alpha), 5.0 * p)
    response = rock(unit_block(alpha, p), motion, histories=True, dt_out=0.01 / p)
    assert not overturns(response)
    assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(0.847348255743593616, rel=1e-9)
    assert p * response.scalars["t_peak"][0] == pytest.approx(3.76789305506654041, rel=1e-9)
    t = [1.19966658401664266, 6.33573283288742307, 9.65434882932230257, 12.3657175237784685, 14.703214043391407]
    w = [0.205559002454120019, -0.197319067795020142, 0.185636939488007977, -0.174646442878360537, 0.164306630427048269]
    np.testing.assert_allclose(p * response.impacts["t_impact"][0, :5], t, rtol=1e-9)
    np.testing.assert_allclose(response.impacts["theta_dot_before"][0, :5] / p, w, rtol=1e-9)


@pytest.mark.parametrize(("Omega", "A"), [(0.01, 1.0000499987500625), (0.1, 1.00498756211208903)])
def test_very_long_sine(Omega, A):
    for factor, outcome in ((1.0 - 1e-9, 3), (1.0 + 1e-9, 2)):
        motion = pulse("sine", A * factor * G * 0.1, Omega)
        response = rock(unit_block(0.1), motion, model="linearized", eta=0.9)
        # just below the threshold it still falls, but with impacts, or survives
        assert (response.scalars["outcome"][0] == 2) == (outcome == 2)


@pytest.mark.parametrize(
    ("A", "outcome", "n"),
    [(1.0049850, 1, None), (1.0049870, 3, 13), (1.0049875, 3, 1), (1.0049876, 2, 0)],
)
def test_slow_sine_about_its_threshold(A, outcome, n):
    """|theta| > alpha, even 2 alpha, during forcing is not overturning: the outcome is decided after it."""
    response = rock(unit_block(0.1), pulse("sine", A * G * 0.1, 0.1), model="linearized", eta=0.9)
    assert response.scalars["outcome"][0] == outcome
    if n is not None:
        assert response.scalars["n_impacts"][0] == n
    else:
        assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(3.867217332689e-01, rel=1e-4)


BANDS = [
    (0.3, A, before, after)
    for A, before, after in (
        (1.030552684016653, "s", 17),
        (1.0308581080966626, 17, "s"),
        (1.031568699478813, "s", 13),
        (1.0440306193890878, 1, 0),
    )
] + [(0.1, 1.0049862026582221, "s", 0)]


@pytest.mark.parametrize(("Omega", "A", "before", "after"), BANDS)
def test_low_frequency_bands(Omega, A, before, after):
    for factor, label in ((1.0 - 1e-6, before), (1.0 + 1e-6, after)):
        motion = pulse("sine", A * factor * G * 0.1, Omega)
        response = rock(unit_block(0.1), motion, model="linearized", eta=0.9)
        assert overturns(response) == (label != "s")


@pytest.mark.parametrize(
    ("Omega", "A", "peak", "t"),
    [
        (100.0, 100.0, 0.0610318192960593692, [0.36222549631660397, 1.01235598414243263]),
        (1000.0, 1000.0, 0.00626394550502586131, [0.112375451848547093, 0.314524077929864879]),
        (1000.0, 100000.0, 0.628302323986656774, [1.6411025901968784, 4.05344599951680083]),
        (10000.0, 10000.0, 0.000628122654780158721, [0.0354581698048246085, 0.0992781391209042038]),
    ],
)
def test_very_short_pulse(Omega, A, peak, t):
    motion = pulse("sine", A * G * 0.1, Omega)
    response = rock(unit_block(0.1), motion, model="linearized", eta=0.9, histories=True)
    assert not overturns(response)
    assert response.scalars["theta_peak_over_alpha"][0] == pytest.approx(peak, rel=1e-8)
    np.testing.assert_allclose(response.impacts["t_impact"][0, :2], t, rtol=1e-8)


@pytest.mark.parametrize("epsilon", [1e-12, 1e-15])
def test_amplitude_a_hair_above_uplift(epsilon):
    a_p = G * np.tan(0.1) * (1.0 + epsilon)
    epsilon = a_p / (G * np.tan(0.1)) - 1.0  # as rounded
    motion = pulse("sine", a_p, 2.0)
    response = rock(unit_block(0.1), motion, histories=True)
    assert not overturns(response)
    assert 0.0 <= response.scalars["theta_peak_over_alpha"][0] <= 5.0 * epsilon**2 / 4.0
    assert np.all(np.abs(response.histories["theta"][0]) < 1e-22)
    if epsilon > 1e-13:  # a hop of 4.5 eps^2/Omega^2
        assert response.scalars["outcome"][0] == 1


@pytest.mark.parametrize("factor", [1.0, 1.0 - 2.0**-53])
@pytest.mark.parametrize("shape", ["sine", "ricker", "cosine", "half_sine", "rectangular", "square_cycle"])
def test_amplitude_at_uplift_moves_nothing(factor, shape):
    body = unit_block(0.1)
    motion = pulse(shape, G * body.tan_alpha[0, 0] * factor, 2.0)
    response = rock(body, motion, histories=True)
    assert response.scalars["outcome"][0] == 0
    assert response.scalars["theta_peak"][0] == 0.0
    assert np.all(response.histories["theta"] == 0.0)
    assert np.isnan(response.scalars["t_uplift"][0])


def test_start_on_the_separatrix_is_unresolved():
    response = rock(unit_block(0.2), still(), theta_0=0.2, histories=True)
    assert response.scalars["outcome"][0] == UNRESOLVED
    assert "separatrix" in response.reasons[0]
    t, theta = response.time, response.histories["theta"][0]
    assert np.all(np.abs(theta - 0.2) <= 0.2 * np.finfo(float).eps * np.exp(t))


def test_start_a_billionth_below_the_separatrix():
    response = rock(unit_block(0.2), still(duration=25.0), theta_0=0.2 * (1.0 - 1e-9), eta=0.9, histories=True)
    assert response.scalars["outcome"][0] == 1
    assert response.impacts["t_impact"][0, 0] == pytest.approx(21.4172468372927744, abs=8.9e-7)


def test_start_a_billionth_above_the_separatrix():
    assert overturns(rock(unit_block(0.2), still(), theta_0=0.2 * (1.0 + 1e-9)))


@pytest.mark.slow
def test_energy_over_a_hundred_thousand_periods():
    """eta = 1: 2e5 impacts, p t = 526 937.68; the last one on time and the energy kept to 1e-9."""
    end = 526937.680234847317
    response = rock(
        unit_block(0.1), still(duration=end), theta_0=0.05, eta=1.0, scalars=("n_impacts", "energy_residual")
    )
    assert response.scalars["n_impacts"][0] == 200000
    assert abs(response.scalars["energy_residual"][0]) < 1e-9
    # half a period more or less would add or drop an impact: the time of impact 200 000 is 526936.36289
    shorter = rock(
        unit_block(0.1), still(duration=526936.36289064673 - 1e-5), theta_0=0.05, eta=1.0, scalars=("n_impacts",)
    )
    assert shorter.scalars["n_impacts"][0] == 199999


def test_perfectly_plastic_impact():
    body = unit_block(0.2)
    response = rock(body, still(), theta_0=0.1, eta=0.0, histories=True)
    assert response.impacts["t_impact"][0, 0] == pytest.approx(1.31850439757969462, rel=1e-10)
    assert response.scalars["n_impacts"][0] == 1
    # then forced: it lifts off again only above g tan(alpha), and each impact stops it
    values = np.concatenate([np.zeros(200), G * np.tan(0.2) * 1.2 * np.sin(np.linspace(0.0, 12.0, 300))])
    response = with_ground(
        rock(body, record(values, 0.01), theta_0=0.1, eta=0.0, histories=True), body, record(values, 0.01)
    )
    theta, a_g = response.histories["theta"][0], response.histories["a_g"][0]
    starts = np.flatnonzero((theta[1:] != 0.0) & (theta[:-1] == 0.0))
    assert len(starts) >= 2
    assert np.all(np.abs(a_g[starts + 1]) >= G * np.tan(0.2))
    assert np.all(response.impacts["theta_dot_after"][0] == 0.0)


@pytest.mark.parametrize(
    ("phi", "falls", "tau"),
    [
        (0.4, False, 2.29243166956117769),
        (0.499999, False, 13.8155105579632741),
        (0.500001, True, None),
        (0.6, True, None),
    ],
)
def test_record_with_an_offset(phi, falls, tau):
    """A constant 0.5 g alpha moves the unstable equilibrium from alpha to alpha/2."""
    alpha = 0.1
    motion = record(np.full(3001, -0.5 * G * alpha), 0.01)
    response = rock(unit_block(alpha), motion, model="linearized", theta_0=phi * alpha, eta=0.9, histories=True)
    assert overturns(response) is falls
    if not falls:
        # tau_impact is stated for the first impact: phi0 = 0.4 with f = 0.5
        assert response.impacts["t_impact"][0, 0] == pytest.approx(tau, rel=1e-8)


def test_no_uplift_under_an_offset_below_the_threshold():
    motion = record(np.full(101, 0.999 * G * 0.1), 0.01)
    assert rock(unit_block(0.1), motion, model="linearized").scalars["outcome"][0] == 0


def test_zero_record():
    response = rock(unit_block(0.1), record(np.zeros(50), 0.02), histories=True)
    assert response.scalars["outcome"][0] == 0
    assert response.scalars["n_impacts"][0] == 0
    assert np.all(response.histories["theta"] == 0.0)


@pytest.mark.parametrize(("accuracy", "rel"), [("draft", 1e-8), ("standard", 1e-10), ("reference", 1e-13)])
def test_impact_exactly_on_a_sample_is_one_impact(accuracy, rel):
    phi = 0.535078007591018333
    motion = record(np.zeros(8), 0.2)
    response = rock(
        unit_block(0.1), motion, model="linearized", theta_0=phi * 0.1, eta=0.0, histories=True, accuracy=accuracy
    )
    assert response.scalars["n_impacts"][0] == 1
    assert response.impacts["t_impact"][0, 0] == pytest.approx(1.4, rel=rel)
    assert response.impacts["theta_dot_before"][0, 0] / 0.1 == pytest.approx(-0.885351648202262508, rel=rel)


def test_impact_exactly_at_the_pulse_end():
    tau_e, alpha = 0.722717193587915446, 0.1
    motion = pulse("rectangular", 0.4 * G * alpha, np.pi / tau_e)  # f = -0.4
    response = rock(unit_block(alpha), motion, model="linearized", theta_0=0.3 * alpha, eta=0.9, histories=True)
    assert response.impacts["theta_dot_before"][0, 0] / alpha == pytest.approx(-0.866025403784438647, rel=1e-9)
    assert response.impacts["theta_dot_after"][0, 0] / alpha == pytest.approx(-0.779422863405994782, rel=1e-9)
    assert response.scalars["theta_peak"][0] / alpha == pytest.approx(-0.373501795692916611, rel=1e-9)
    assert response.scalars["t_peak"][0] == pytest.approx(1.76661564215494861, rel=1e-7)


DELAYED = [
    (1e-3, 3.11087387899291655, None),
    (1e-6, 6.56438648827040417, None),
    (1e-9, 10.0182637625978463, None),
    (1e-12, 13.4721414017237511, None),
    (-1e-3, 6.59997227171986526, 0.939044577381248629),
    (-1e-6, 13.5086568089531457, 0.998071716019312192),
    (-1e-9, 20.416413016576786, 0.999939022284187248),
    (-1e-12, 27.3241682964875639, 0.999998071715314468),
]


@pytest.mark.parametrize(("delta", "tau", "peak"), DELAYED)
def test_delayed_overturning(delta, tau, peak):
    """The time to fall grows with ln(1/delta): the outcome may not be read off theta at some end."""
    A = 1.58197670686932642 * (1.0 + delta)
    motion = pulse("rectangular", A * G * 0.1, np.pi)
    response = rock(unit_block(0.1), motion, model="linearized", eta=0.9, histories=peak is not None)
    assert overturns(response) is (peak is None)
    if peak is None:
        assert response.scalars["t_overturn"][0] - 1.0 == pytest.approx(tau, rel=1e-4)
    else:
        assert 1.0 - response.scalars["theta_peak_over_alpha"][0] == pytest.approx(1.0 - peak, rel=1e-4)
        if tau < 20.0:
            assert response.impacts["t_impact"][0, 0] - 1.0 == pytest.approx(tau, rel=1e-4)


@pytest.mark.parametrize(
    ("Omega", "A", "peak"),
    [(1.0, 1.417836423607555, 1.782536292706), (3.0, 3.652588647043753, 1.524683814785)],
)
def test_beyond_alpha_and_back(Omega, A, peak):
    alpha = 0.2
    motion = pulse("sine", A * (1.0 - 1e-6) * G * np.tan(alpha), Omega)
    motion = Excitation(motion.horizontal, None, array(60.0))
    response = rock(unit_block(alpha), motion, eta=0.9, histories=True)
    assert not overturns(response)
    first = np.nanmax(np.abs(response.histories["theta"][0])) / alpha
    assert max(first, response.scalars["theta_peak_over_alpha"][0]) == pytest.approx(peak, rel=1e-5)
    assert response.scalars["n_impacts"][0] > 100  # 175 down to 1e-8


def test_many_amplitudes_in_one_batch_are_those_of_single_cases():
    body = unit_block(0.2)
    amplitudes = np.linspace(0.5, 4.0, 7) * G * np.tan(0.2)
    many = repeated(body, 7)
    together = rock(many, pulse("ricker", amplitudes, np.full(7, 3.0)))
    for i, a_p in enumerate(amplitudes):
        alone = rock(body, pulse("ricker", array(a_p), 3.0))
        for name in ("outcome", "theta_peak", "n_impacts", "mu_required", "t_end"):
            np.testing.assert_array_equal(together.scalars[name][i], alone.scalars[name][0])


COARSE = [
    (2, 2.88163646692383986),
    (3, 2.51542063097616271),
    (4, 2.41325393627070675),
    (6, 2.3466468468490686),
    (8, 2.32408912285667759),
    (16, 2.3012989334721318),
    (32, 2.29571268114262407),
    (64, 2.29433372021261152),
]


@pytest.mark.parametrize(("n", "A"), COARSE)
def test_coarsely_sampled_half_sine(n, A):
    """Omega = 3: a half sine of n intervals overturns at its own amplitude; the error is the record's, not the solver's."""
    dt = np.pi / 3.0 / n
    shape = np.sin(np.pi * np.arange(n + 1) / n)
    shape[-1] = 0.0
    for factor, falls in ((1.0 - 1e-8, False), (1.0 + 1e-8, True)):
        motion = record(shape * A * factor * G * 0.1, dt)
        assert overturns(rock(unit_block(0.1), motion, model="linearized", eta=0.9)) is falls
