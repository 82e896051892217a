"""The pieces of planar contact against closed forms: onsets, impacts, slides, flights, jams (contact_tables.py)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from contact_cases import MODES, G, array, body, kernel, piece, run
from contact_tables import (
    CORNER_IMPACTS,
    FLAT_FLIGHTS,
    FRICTIONLESS,
    IMPACT_SEPARATRICES,
    JAMS,
    LANDINGS,
    ONSETS,
    PAINLEVE_FLAT,
    PAINLEVE_LEAST,
    SLIDES_UNDER_A_CONSTANT,
    SLIDES_UNDER_A_SINE,
)
from scipy.optimize import brentq, minimize_scalar

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import workspace as row_of
from rockcli.scene.ground.excitation import LINEAR, WAVES

NEAR = 1e-9


@pytest.mark.parametrize("row", ONSETS)
def test_onset(row):
    b, mu, a_g, a_v, mode, needed, theta_dd, slide_dd, N_over_mg = row
    par, W = array(body(b, mu=mu)), G + a_v
    selection, flows = kernel("selection"), kernel("flows")
    code, s, sigma = selection.on_base(par, 0.0, a_g, W)
    assert MODES[code] == mode
    if needed is not None:
        above, below = (selection.on_base(array(body(b, mu=needed * f)), 0.0, a_g, W)[0] for f in (1 + 1e-9, 1 - 1e-9))
        assert (MODES[above], MODES[below] != "rock") == ("rock", True)
    w = kernel("march").work_space()
    w[row_of.A_G][0], w[row_of.WEIGHT][0] = a_g, W
    c, slip, N = w[row_of.Q], w[row_of.SLIP], w[row_of.NORMAL]
    foot = kernel("state").Foot(s, sigma, 0.0, 0.0, 0.0, 0.0)
    if mode == "slide":
        flows.slide(mu, foot, 4, w)
    elif mode == "rock":
        flows.rock(par, foot, 0.1, 1e-16, 8, 1, w)
    elif mode == "slide_rock":
        flows.slide_rock(par, foot, 0.1, 1e-16, 8, 1, w)
    if theta_dd is not None:
        assert 2 * s * c[2] == pytest.approx(theta_dd, abs=NEAR)
    if slide_dd is not None:
        assert slip[1] == pytest.approx(slide_dd, abs=NEAR)
    if N_over_mg is not None:
        assert N[0] / G == pytest.approx(N_over_mg, abs=NEAR)


@pytest.mark.parametrize("row", LANDINGS)
def test_landing(row):
    b, mu, eta, w, v, w_after, v_after, impulse, change = row
    par = array(body(b, mu=mu, eta=eta))
    found = kernel("impacts").landing(par, at.LEFT, at.RIGHT, w, v)
    assert found == pytest.approx((w_after, v_after, impulse), abs=NEAR)
    energy, foot = kernel("readings").energy_on_edge, kernel("state").Foot
    before = energy(par, foot(-1.0, 0.0, 0.0, -w, v, 0.0))
    assert energy(par, foot(1.0, 0.0, 0.0, found[0], found[1], 0.0)) - before == pytest.approx(change, abs=NEAR)


@pytest.mark.parametrize("row", CORNER_IMPACTS)
def test_corner_impact(row):
    b, mu, e_n, theta, along, across, rate, along_after, across_after, rate_after = row
    par = array(body(b, mu=mu, e_n=e_n))
    c, d = b * math.cos(theta) - math.sin(theta), -b * math.sin(theta) - math.cos(theta)
    found = kernel("impacts").corner(par, c, d, rate, along, across)
    assert found == pytest.approx((rate_after, along_after, across_after), abs=NEAR)


@pytest.mark.parametrize("row", SLIDES_UNDER_A_CONSTANT)
def test_slide_under_a_constant_acceleration(row):
    b, h, mu, a_g, a_v, until, slide, rate, t_rest = row
    up = piece(until, LINEAR, a_v) if a_v else piece(until, LINEAR, 0.0)
    par = body(b, h, mu, t_motion=until)
    found = run(par, piece(until, LINEAR, a_g), up, dt=until, n=2)
    assert (found["SLIDE_END"], found["SLIDE_PEAK"]) == pytest.approx((slide, slide), abs=NEAR)
    assert found.histories["slide_dot"][1] == pytest.approx(rate, abs=NEAR)
    assert found["T_REST"] == pytest.approx(t_rest, abs=NEAR)
    assert (found.modes, found["N_SLIPS"], found["PEAK"]) == (["rest"], 1, 0.0)
    assert abs(found["BALANCE"]) < NEAR


@pytest.mark.parametrize("row", SLIDES_UNDER_A_SINE)
def test_slide_under_a_sine(row):
    b, h, mu, a_p, omega, t_slip, t_stop, at_stop, slide, t_rest = row
    T = 2 * math.pi / omega
    found = run(body(b, h, mu, t_motion=T), piece(T, WAVES, 0.0, a_p, omega, 0.0))
    assert (found["T_SLIP"], found.t[1], found["T_REST"]) == pytest.approx((t_slip, t_stop, t_rest), abs=NEAR)
    assert (found["SLIDE_PEAK"], found["SLIDE_END"]) == pytest.approx((at_stop, slide), abs=NEAR)
    assert abs(found["BALANCE"]) < NEAR


@pytest.mark.parametrize("row", FLAT_FLIGHTS)
def test_flat_flight(row):
    b, h, mu, a_g, a_v, until, t, slide, rate, end, turning = row
    par = body(b, h, mu, t_motion=until)
    dt = t * (1 - 1e-12)
    found = run(par, piece(until, LINEAR, a_g), piece(until, LINEAR, a_v), dt=dt, n=2)
    landed = found.modes.index("flight") if "flight" in found.modes else -1
    assert found.t[landed + 1] == pytest.approx(t, abs=NEAR)
    assert found.histories["slide"][1] == pytest.approx(slide, abs=NEAR)
    assert abs(found["BALANCE"]) < NEAR
    assert found["GAIN"] < 1e-12
    after = kernel("impacts").flat(array(par), -a_g * until, (G + a_v) * -until - G * (t - until))
    assert after[0] == pytest.approx(turning, abs=NEAR)
    assert after[1] - h * after[0] == pytest.approx(rate, abs=NEAR)
    if end is not None:
        assert found["SLIDE_END"] == pytest.approx(end, abs=NEAR)
        assert found["PEAK"] == 0.0
    else:
        assert found.modes[landed + 1] == "rock"


@pytest.mark.parametrize("row", FRICTIONLESS)
def test_without_friction_the_centre_of_mass_falls_straight_down(row):
    b, h, theta_0, t, before, after, second = row
    found = run(body(b, h, 0.0, theta_0=theta_0))
    assert [x[0] for x in found.impacts] == pytest.approx([t, before, after], abs=1e-8)
    assert -found["PEAK_LEFT"] == pytest.approx(second, abs=1e-8)
    assert abs(found["BALANCE"]) < 1e-9


@pytest.mark.parametrize("row", IMPACT_SEPARATRICES)
def test_flat_impact_sticks_or_slides(row):
    b, h, mu, ratio = row
    par, flat = array(body(b, h, mu)), kernel("impacts").flat

    def slip(r):
        turning, x_rate, _ = flat(par, 1.0, -r)
        return x_rate - h * turning

    assert slip(ratio * (1 - 1e-6)) > 0.0
    assert slip(ratio * (1 + 1e-9)) == pytest.approx(0.0, abs=1e-12)
    assert slip(ratio * (1 - 1e-9)) > 1e-12


@pytest.mark.parametrize(("k", "mu", "tan_beta"), PAINLEVE_LEAST)
def test_least_friction_that_jams(k, mu, tan_beta):
    par, stiffness = array(body(0.5, r_g2=1.25 / k)), kernel("selection").stiffness

    def lowest(m):
        return minimize_scalar(lambda x: stiffness(par, at.RIGHT, x, m), bounds=(0.01, 1.5), options={"xatol": 1e-12})

    assert brentq(lambda m: lowest(m).fun, 0.5, 3.0, xtol=1e-13) == pytest.approx(mu, abs=NEAR)
    assert math.tan(lowest(mu).x) == pytest.approx(tan_beta, abs=1e-6)


@pytest.mark.parametrize(("tan_alpha", "mu"), PAINLEVE_FLAT)
def test_least_friction_that_jams_a_flat_slide(tan_alpha, mu):
    par, selection = array(body(tan_alpha)), kernel("selection")
    found = brentq(lambda m: selection.stiffness(par, at.RIGHT, math.atan(tan_alpha), m), 0.5, 9.0, xtol=1e-13)
    assert found == pytest.approx(mu, abs=NEAR)
    above, below = (selection.on_base(array(body(tan_alpha, mu=mu * f)), 0.1, 0.0, G)[0] for f in (1 + 1e-9, 1 - 1e-9))
    assert (above, below) == (selection.JAM, MODES.index("slide_rock"))


@pytest.mark.parametrize(("b", "h", "mu", "ratio", "to_overturn"), JAMS)
def test_jam(b, h, mu, ratio, to_overturn):
    par = array(body(b, h, mu))
    assert kernel("impacts").jam(par, at.RIGHT, 0.0, 0.0, 1.0) == pytest.approx(ratio, abs=NEAR)
    stands, falls = (run(body(b, h, mu, slide_rate_0=to_overturn * f)) for f in (1 - 1e-9, 1 + 1e-9))
    assert (stands["VERDICT"], falls["VERDICT"]) == (0.0, 1.0)
    assert stands["N_JAMS"] == falls["N_JAMS"] == 1
    assert max(abs(stands["BALANCE"]), abs(falls["BALANCE"])) < NEAR


@pytest.mark.parametrize(("b", "mu", "slide_rate"), [(0.4, 1.9, 0.2), (0.35, 1.0, 0.3), (0.5, 1.2, 0.4)])
def test_impacts_that_stop_the_rotation_and_leave_a_slip_end(b, mu, slide_rate):
    """With eta = 0 a body that tripped comes down, slips on, trips again: an accumulation, in geometric ratio.

    Each impact stops the rotation and leaves the base the slip (h - mu b) w of (K11); what that trips the body to
    turns back into the rate of the next.
    """
    found = run(body(b, 1.0, mu, eta=0.0, slide_rate_0=slide_rate), rest_speed=1e-9)
    assert (found["STATUS"], found["VERDICT"]) == (0.0, 0.0)
    rates = np.abs(found.impacts[1])
    ratios = rates[2:6] / rates[1:5]
    np.testing.assert_allclose(ratios, ratios[0], rtol=1e-3)
    times = np.array(found.impacts[0])
    end = times[5] + (times[5] - times[4]) * ratios[-1] / (1.0 - ratios[-1])
    assert found["T_REST"] == pytest.approx(end, rel=1e-4)
    assert abs(found["BALANCE"]) < NEAR
    assert found["N_STEPS"] < 500


def test_impacts_never_gain_energy():
    """Random landings and corner impacts, of asymmetric bodies too, whatever the friction."""
    rng = np.random.default_rng(5)
    impacts, energy_on_edge, foot = kernel("impacts"), kernel("readings").energy_on_edge, kernel("state").Foot
    for _ in range(3000):
        b = tuple(rng.uniform(0.05, 1.2, 2))
        r_g2 = (0.25 * sum(b) ** 2 + 1.0) / 3 * rng.uniform(0.7, 1.3)
        par = array(body(b, mu=rng.uniform(0.0, 2.0), eta=None, r_g2=r_g2, e_n=rng.choice([0.0, rng.uniform()])))
        w, v = rng.uniform(0.01, 2.0), rng.normal() * rng.choice([0.0, 0.3, 2.0])
        before = energy_on_edge(par, foot(-1.0, 0.0, 0.0, -w, v, 0.0))
        w_after, v_after, impulse = impacts.landing(par, at.LEFT, at.RIGHT, w, v)
        assert energy_on_edge(par, foot(1.0, 0.0, 0.0, w_after, v_after, 0.0)) <= before + 1e-12
        assert w_after >= 0.0
        assert impulse >= 0.0
        c, d, rate, along, across = rng.normal(), -rng.uniform(0.2, 1.5), *rng.normal(size=2), -rng.uniform(0.01, 2.0)
        after = impacts.corner(par, c, d, rate, along, across)

        def energy(rate, along, across, c=c, d=d, r_g2=r_g2):
            return (along - d * rate) ** 2 + (across + c * rate) ** 2 + r_g2 * rate**2

        assert energy(*after) <= energy(rate, along, across) * (1 + 1e-12) + 1e-12
        assert after[2] >= -1e-12
