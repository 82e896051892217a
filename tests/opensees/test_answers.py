"""What OpenSees answers, against the event-driven solvers and the thesis's flexible columns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import G, array, block, make_batch, make_block, peak, pulse, record, still
from thesis_cases import PULSES, flexible, needs_opensees, rigid

from rockcli.errors import SolverError
from rockcli.scene.body.column import Base, Column
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import NO_UPLIFT, UNRESOLVED
from rockcli.solvers.event import solver as event
from rockcli.solvers.flexible import solve as solve_flexible
from rockcli.solvers.frame.solver import solve as solve_frame
from rockcli.solvers.opensees.solver import solve

pytestmark = needs_opensees

STEPS = Numerics(dt=1e-4, yield_rotation=1e-6)
SHORT = 3.0
"""Seconds: past the peak of the pulses on a body of R = 2 m."""


@pytest.mark.slow
@pytest.mark.parametrize(("R", "shape", "omega_p", "tan_alpha"), PULSES)
def test_model_3_on_the_sources_pulses(R, shape, omega_p, tan_alpha):
    batch = rigid(R, shape, omega_p, tan_alpha, numerics=STEPS)
    ours, exact = solve(batch), event.solve(batch)
    assert peak(ours) == pytest.approx(peak(exact), abs=5e-4)
    assert ours.scalars["outcome"][0] == exact.scalars["outcome"][0]


@pytest.mark.parametrize("scheme", ["restitution", "dashpot", "none"])
def test_model_3_under_a_ricker_pulse(scheme):
    batch = rigid(scheme=scheme, duration=SHORT)
    assert peak(solve(batch)) == pytest.approx(peak(event.solve(batch)), abs=3e-4)


@pytest.mark.parametrize(
    ("model", "geometry", "within"),
    [
        ("1", "corotational", 3e-4),
        ("1", "negative_stiffness", 3e-4),
        ("2", "negative_stiffness", 3e-3),  # driven in rotation: no cos(theta)
        pytest.param("2", "corotational", 3e-3, marks=pytest.mark.slow),
        pytest.param("3", "negative_stiffness", 3e-4, marks=pytest.mark.slow),
        pytest.param("4", "corotational", 3e-4, marks=pytest.mark.slow),
        pytest.param("4", "negative_stiffness", 3e-4, marks=pytest.mark.slow),
    ],
)
def test_the_other_models(model, geometry, within):
    batch = rigid(model=model, geometry=geometry, duration=SHORT)
    assert peak(solve(batch)) == pytest.approx(peak(event.solve(batch)), abs=within)


def test_five_lumped_elements_are_too_heavy_in_rotation():
    batch = rigid(model="4", duration=SHORT)
    lumped = replace(batch, column=Column(array(1.0), array(1.0), array(0.0), 5, "lumped"))
    assert peak(solve(lumped)) / peak(event.solve(batch)) == pytest.approx(1.0 - 0.0274, abs=2e-3)


def test_free_rocking_and_its_histories():
    batch = replace(rigid(histories=True, dt_out=0.01, theta_0=0.1), excitation=still(2.5))
    batch = replace(batch, block=replace(batch.block, top=0.7 * batch.block.top, mass=array(400.0)))
    ours, exact = solve(batch), event.solve(batch)
    assert ours.scalars["t_end"][0] == 2.5
    np.testing.assert_array_equal(ours.time, exact.time)
    theta, reference = ours.histories["theta"], exact.histories["theta"]
    np.testing.assert_allclose(theta, reference, atol=2e-5)
    np.testing.assert_allclose(ours.histories["u_top"], exact.histories["u_top"], atol=1e-4)
    np.testing.assert_allclose(ours.impacts["t_impact"], exact.impacts["t_impact"], atol=1e-4)
    np.testing.assert_allclose(ours.impacts["theta_dot_after"], exact.impacts["theta_dot_after"], rtol=5e-3)
    open_ = np.abs(theta) > 1e-3
    expected = np.sign(theta) * 400.0 * 9.81 * 2.0 * np.sin(batch.block.alpha[0, 0])
    np.testing.assert_allclose(ours.histories["M_base"][open_], expected[open_], rtol=1e-9)


def test_overturning_and_no_uplift():
    over, under = rigid(factor=7.2), rigid(factor=0.95)
    ours, exact = solve(over).scalars, event.solve(over).scalars
    assert ours["outcome"][0] == exact["outcome"][0] == 3
    assert ours["theta_peak"][0] == exact["theta_peak"][0]
    assert ours["t_overturn"][0] == pytest.approx(exact["t_overturn"][0], abs=1e-3)
    assert solve(rigid(factor=7.2, duration=12.0)).scalars["t_end"][0] == 12.0  # it has fallen before
    ours, exact = solve(under).scalars, event.solve(under).scalars
    for name in ("outcome", "theta_peak", "n_impacts", "t_end"):
        assert ours[name][0] == exact[name][0]
    assert np.isnan(ours["t_uplift"][0])


@pytest.mark.parametrize("duration", [0.02, 0.3])
def test_a_fall_after_the_report_is_to_the_side_it_comes_to(duration):
    batch = rigid(scheme="none", theta_0=0.24, theta_dot_0=-0.9)
    batch = replace(batch, excitation=still(duration))
    ours, exact = solve(batch).scalars, event.solve(batch).scalars
    for name in ("outcome", "theta_peak", "n_impacts"):
        assert ours[name][0] == exact[name][0]
    assert exact["outcome"][0] == 3
    assert np.isnan(ours["t_overturn"][0])  # it is yet to come when OpenSees ends
    from_there = replace(batch, theta_dot_0=np.full(1, -0.02))
    ours, exact = solve(from_there).scalars, event.solve(from_there).scalars
    assert ours["t_overturn"][0] == exact["t_overturn"][0] == 0.0


def test_a_body_let_go_just_beyond_its_equilibrium_falls():
    """At 1.016 times its equilibrium its energy is that of the barrier but for 3e-4, and it can only go down."""
    batch = rigid(scheme="none", theta_0=0.206)
    batch = replace(batch, excitation=still(0.02))
    ours, exact = solve(batch), event.solve(batch)
    assert ours.scalars["outcome"][0] == exact.scalars["outcome"][0] == 2, ours.reasons


@pytest.mark.parametrize(("coefficient", "rate"), [(0.02, -0.2), (0.02, -0.3), (0.1, -0.35), (0.1, -0.4)])
def test_a_dashpot_goes_on_after_the_report(coefficient, rate):
    damping = Damping("dashpot", np.ones((1, 2)), array(coefficient))
    batch = replace(rigid(theta_0=0.1, theta_dot_0=rate), excitation=still(0.02), damping=damping)
    ours, exact = solve(batch).scalars, event.solve(batch).scalars
    for name in ("outcome", "theta_peak", "n_impacts"):
        assert ours[name][0] == pytest.approx(exact[name][0])


def test_a_body_on_a_soft_base_falls_from_below_alpha():
    """The equilibrium of a column of R = 3 m on 4.5e6 N/m3 is at about half of alpha."""
    body = block(3.0, 0.2)
    soft = replace(
        make_batch(body, still(0.05), model="flexible", accuracy="draft"),
        base=Base("winkler", array(4.5e6)),
        column=Column(array(1e9), array(2500.0), array(0.02), 4),
        damping=Damping("none", np.ones((1, 2))),
    )
    for part, outcome in ((0.3, 1), (0.62, 2)):
        batch = replace(soft, theta_0=part * body.alpha[:, 0])
        ours, exact = solve(batch).scalars, solve_flexible(batch).scalars
        assert ours["outcome"][0] == exact["outcome"][0] == outcome


def test_what_hht_takes_at_an_impact_to_come_is_not_known():
    hht = Damping("hht", np.ones((1, 2)), alpha_d=array(0.7))
    batch = replace(rigid(model="4", theta_0=0.1, theta_dot_0=-0.35), excitation=still(0.02), damping=hht)
    response = solve(replace(batch, base=Base("winkler", array(1e10), 21)))
    assert response.scalars["outcome"][0] == UNRESOLVED
    assert "give a longer duration" in response.reasons[0]


def test_a_sampled_motion_is_linear_between_samples():
    t = np.arange(100) * 0.02
    motion = record(4.0 * np.sin(6.0 * t) + 2.0 * np.sin(17.0 * t), 0.02, duration=3.0)
    batch = replace(rigid(), excitation=motion)
    ours, exact = solve(batch).scalars, event.solve(batch).scalars
    assert ours["theta_peak_over_alpha"][0] == pytest.approx(exact["theta_peak_over_alpha"][0], abs=1e-3)


@pytest.mark.parametrize(
    ("eta", "zeta", "figure", "expected"),
    [(1.0, 0.0, "60, undamped", 0.685), ("housner", 0.01, "63", 0.6256)],
)
def test_the_sources_flexible_columns(eta, zeta, figure, expected):
    batch = flexible(eta=eta, zeta=zeta)
    found = peak(solve(batch))
    assert found == pytest.approx(expected, rel=0.01)
    assert found == pytest.approx(peak(solve_flexible(batch)), rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("eta", "expected"), [(1.0, 0.6832), ("housner", 0.6428)])
def test_flexible_columns_with_consistent_masses(eta, expected):
    assert peak(solve(flexible(eta=eta, zeta=0.01, elements=20, mass="consistent"))) == pytest.approx(
        expected, rel=3e-3
    )


def test_flexible_histories_have_a_bending_part():
    batch = flexible(
        eta="housner", zeta=0.01, elements=10, mass="consistent", duration=3.0, histories=True, dt_out=0.01
    )
    h, other = solve(batch).histories, solve_flexible(batch).histories
    np.testing.assert_allclose(h["u_top"] - h["u_top_bending"], 50.0 * np.sin(h["theta"]), atol=2e-3)
    largest = np.abs(other["u_top_bending"]).max()
    assert largest > 0.05
    np.testing.assert_allclose(h["u_top_bending"], other["u_top_bending"], atol=0.1 * largest)
    assert set(h) == set(other)
    elsewhere = solve(replace(batch, block=replace(batch.block, top=array(20.0)))).histories
    np.testing.assert_array_equal(elsewhere["u_top_bending"], h["u_top_bending"])


def test_a_column_that_stays_down_bends():
    batch = replace(
        flexible(eta=1.0, zeta=0.01, elements=10, mass="consistent"), excitation=pulse("sine", 0.1, 4.0, duration=2.0)
    )
    ours, other = solve(batch).scalars, solve_flexible(batch).scalars
    assert ours["outcome"][0] == other["outcome"][0] == 0
    assert ours["theta_peak"][0] == ours["theta_dot_peak"][0] == 0.0
    assert ours["u_top_peak"][0] == pytest.approx(other["u_top_peak"][0], rel=0.02)


@pytest.mark.parametrize("fibres", [None, 21])
def test_a_column_let_go_begins_bent_by_its_turned_weight(fibres):
    theta, base = 0.05, None if fibres is None else Base("winkler", array(1e9), fibres)
    batch = make_batch(make_block(h=25.0, b=2.5), still(1.0), eta=1.0, theta_0=theta, histories=True, dt_out=0.01)
    column = Column(array(30e9), array(2500.0), array(0.0), 10, "consistent")
    batch = replace(batch, model="flexible", column=column, base=base, numerics=Numerics(dt=1e-3))
    ours, frame = (answer(batch).histories["u_top_bending"][0] for answer in (solve, solve_frame))
    sag = 2500.0 * 5.0 * G * np.sin(theta) * 50.0**4 / (8.0 * 30e9 * 5.0**3 / 12.0)  # of a cantilever
    assert ours[0] == pytest.approx(sag, rel=0.01)  # and P-Delta
    assert ours[0] == pytest.approx(frame[0], rel=1e-6)
    assert (ours.min(), ours.max()) == pytest.approx((ours[0], frame.max()), rel=0.05)


def test_damping_of_a_column_leaves_its_rocking_alone():
    """Rayleigh damping has the axial force in its stiffness: .6 alpha grew to .66 in four half cycles."""
    body = make_block(h=2.5, b=0.5)
    p, theta = np.sqrt(0.75 * G / np.hypot(2.5, 0.5)), 0.6 * np.arctan(0.2)
    batch = make_batch(body, still(7.0 / p), eta=1.0, theta_0=theta, histories=True, dt_out=0.02)
    E = 2500.0 * (12.3809 * 2.5 / 0.2 * p / 0.1) ** 2  # p T_1 = .1, T_1 by (4.3)
    column = Column(array(E), array(2500.0), array(0.3), 2, "consistent")
    batch = replace(batch, model="flexible", column=column, numerics=Numerics(dt=float(1e-3 / p)))
    ours, other = (answer(batch).histories for answer in (solve, solve_flexible))
    np.testing.assert_allclose(ours["theta"], other["theta"], atol=0.01 * theta)
    # in the first step what the weight has put into the elements is no rate
    np.testing.assert_allclose(ours["u_top"][0, :3], other["u_top"][0, :3], rtol=2e-3)


@pytest.mark.parametrize("alpha_d", [None, 0.7])
def test_zeta_is_that_of_the_clamped_column(alpha_d):
    """On stiff fibres, below uplift: its decay, with the integrator of hht too."""
    body = make_block(h=2.5, b=0.5)
    E = 2500.0 * (12.3809 * 2.5 / 0.2 / 0.2) ** 2  # T_1 = .2 s
    motion = pulse("half_sine", 0.1, 2.0 * np.pi / 0.16, duration=1.0)
    batch = make_batch(body, motion, eta=1.0, histories=True, dt_out=1e-3)
    column, base = Column(array(E), array(2500.0), array(0.05), 3, "consistent"), Base("winkler", array(1e12), 5)
    batch = replace(batch, model="flexible", column=column, base=base, numerics=Numerics(dt=5e-4))
    if alpha_d is not None:
        batch = replace(batch, damping=Damping("hht", np.ones((1, 2)), alpha_d=array(alpha_d)))
    response = solve(batch)
    assert response.scalars["outcome"][0] == 0
    u = np.abs(response.histories["u_top"][0])
    peaks = u[1:-1][(u[1:-1] > u[:-2]) & (u[1:-1] >= u[2:])][-8:]
    assert np.log(peaks[0] / peaks[-1]) / 7.0 / np.pi == pytest.approx(0.05, rel=0.03)


@pytest.mark.parametrize("mass", [np.nan, 4e6])
def test_moment_of_the_base_of_a_column_is_per_unit_mass_or_of_the_mass_given(mass):
    batch = flexible(eta=1.0, zeta=0.01, duration=1.5, histories=True, dt_out=0.01)
    batch = replace(batch, block=replace(batch.block, mass=array(mass)))
    h, other = solve(batch).histories, solve_flexible(batch).histories
    open_ = np.abs(h["theta"][0]) > 1e-3
    assert open_.sum() > 20
    np.testing.assert_allclose(h["M_base"][0, open_], other["M_base"][0, open_], rtol=1e-6)


@pytest.mark.slow
def test_a_winkler_base_as_a_law_and_as_fibres():
    batch = replace(flexible(eta="housner", zeta=0.01, mass="consistent"), base=Base("winkler", array(1e11)))
    law = peak(solve(batch))
    assert law == pytest.approx(peak(solve_flexible(batch)), rel=0.01)
    fibres = replace(batch, base=Base("winkler", array(1e11), 21))
    assert peak(solve(fibres)) == pytest.approx(law, rel=0.03)


def test_hht_on_fibres_loses_energy_at_impacts():
    hht = Damping("hht", np.ones((1, 2)), alpha_d=array(0.7))
    batch = replace(rigid(model="4", theta_0=0.1, histories=True), excitation=still(2.2), damping=hht)
    batch = replace(batch, base=Base("winkler", array(1e10), 21))
    response = solve(batch)
    theta = response.histories["theta"][0]
    assert theta[0] == 0.1
    # first swing back: some of the energy is gone, and not through eta
    back = solve_frame(replace(batch, numerics=Numerics(backend="frame"))).histories["theta"][0].min()
    assert -0.099 < theta.min() == pytest.approx(back, abs=2e-5)
    assert response.used["method"].endswith("HHT")
    assert response.used["alpha_d"] == "0.7"


def test_the_error_estimate_is_another_step():
    batch = rigid(duration=SHORT)
    batch = replace(batch, save=replace(batch.save, scalars=batch.save.scalars | {"error_estimate"}))
    scalars = solve(batch).scalars
    exact = event.solve(rigid(duration=SHORT)).scalars["theta_peak_over_alpha"][0]
    assert 0.0 < scalars["error_estimate"][0] < 1e-3
    assert abs(scalars["theta_peak_over_alpha"][0] - exact) < 3.0 * scalars["error_estimate"][0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"base": Base("winkler", array(1e10), 21)}, "fibres belong under a column of elements"),
        ({"damping": Damping("hht", np.ones((1, 2)))}, "hht needs a yielding base"),
        ({"numerics": Numerics(method="linear")}, "no P-Delta"),
        ({"numerics": Numerics(method="RK45")}, "know the methods"),
        ({"model": "flexible"}, "needs a column"),
    ],
)
def test_what_it_cannot_do_is_said(change, sentence):
    with pytest.raises(SolverError, match=sentence):
        solve(replace(rigid(), **change))


def test_a_column_that_cannot_stand_and_a_soft_spring_are_failed_cases():
    weak = flexible(eta=1.0, zeta=0.0)
    weak = replace(weak, column=replace(weak.column, E=array(1.8e8)))
    assert "buckles under itself" in solve(weak).reasons[0]
    response = solve(rigid(numerics=Numerics(yield_rotation=0.1)))
    assert response.scalars["outcome"][0] == -2
    assert "not small against alpha" in response.reasons[0]


def test_a_vertical_motion_needs_fibres():
    batch = rigid()
    shaken = replace(batch, excitation=replace(batch.excitation, vertical=batch.excitation.horizontal))
    with pytest.raises(SolverError, match="vertical motion needs fibres"):
        solve(shaken)


def test_a_base_of_fibres_uplifts_where_it_hops():
    """Closed form: dropped with A = .8 g, it swings about -(g - A)/omega^2 from -g/omega^2 and is off at v = 0."""
    fall, omega, body = 0.8, 20.0, block(2.0, 0.2)
    motion = replace(still(0.2), vertical=pulse("rectangular", -fall * G, 2.0 * np.pi).horizontal)
    kw = 2500.0 * 2.0 * body.h[0] * omega**2  # of 2 b kw/m
    batch = make_batch(body, motion, eta=1.0, model="4")
    hopping = replace(batch, geometry="corotational", base=Base("winkler", array(kw), 5), numerics=Numerics(dt=2e-4))
    leaves = np.arccos(-(1.0 - fall) / fall) / omega
    assert solve(hopping).scalars["t_uplift"][0] == pytest.approx(leaves, abs=4e-4)


@pytest.mark.parametrize(("fibres", "share"), [(None, 0.05), (21, 0.05), (21, 0.2)])
def test_a_column_let_go_in_full_contact_does_not_uplift(fibres, share):
    # on a base that opens at .3 alpha: the edges stay down, as in the modal solver
    alpha = np.arctan(0.1)
    kw = array(2500.0 * 40.0 * G / (2.0 * 1.0**2) / (0.3 * alpha))
    batch = make_batch(make_block(h=10.0, b=1.0), still(0.5), eta=1.0, model="flexible", theta_0=share * alpha)
    batch = replace(batch, column=Column(array(3e10), array(2500.0), array(0.01), 2, "consistent"))
    on_law, batch = (replace(batch, base=Base("winkler", kw, how)) for how in (None, fibres))
    found = solve(replace(batch, numerics=Numerics(dt=1e-3))).scalars
    assert found["outcome"][0] == solve_flexible(on_law).scalars["outcome"][0] == NO_UPLIFT
    assert np.isnan(found["t_uplift"][0])
    assert found["theta_peak_over_alpha"][0] == 0.0
