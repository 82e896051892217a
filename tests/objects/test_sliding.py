"""Sliding: closed forms, an independent integration, Shenton's regions, and bodies that rock or fly besides."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scenes import G, block, make_batch, pulse, record, still
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import rockcli
from rockcli.kernels.contact.codes import FLIGHT, REST, ROCK, SLIDE, SLIDE_ROCK
from rockcli.scene.body.block import make_block
from rockcli.scene.laws.contact import mode_from_rest
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT, ROCKING, SLIDING, UNRESOLVED
from rockcli.scene.variables import SCALARS, SCALARS_SLIDING
from rockcli.solvers.event.solver import solve


def slid(motion, mu, *, tan_alpha=1.0, n=1, **how):
    body = block(1.0, tan_alpha)
    given = {f.name: getattr(body, f.name) for f in dataclasses.fields(body)}
    columns = {name: np.repeat(values, n, axis=0) for name, values in given.items() if values is not None}
    columns["mu"] = np.broadcast_to(np.asarray(mu, float), (n,)).copy()
    return solve(make_batch(type(body)(**columns), motion, **how))


def closed_form(a_p, omega, mu, g=G):
    """Peak, end and stops of a body under one cycle a_p sin(omega t): velocities and paths written out, roots by Brent."""
    T = 2 * np.pi / omega
    t, u, w, peak, stops = np.arcsin(mu * g / a_p) / omega, 0.0, 0.0, 0.0, []
    d = -1.0  # the ground goes first
    while True:
        t0, u0, w0 = t, u, w

        def rate(x, t0=t0, w0=w0, d=d):
            return w0 + a_p / omega * (np.cos(omega * x) - np.cos(omega * t0)) - d * mu * g * (x - t0)

        def place(x, t0=t0, u0=u0, w0=w0, d=d):
            y = x - t0
            wave = (np.sin(omega * x) - np.sin(omega * t0)) / omega - y * np.cos(omega * t0)
            return u0 + w0 * y + a_p / omega * wave - 0.5 * d * mu * g * y * y

        look = np.linspace(t0, T, 20001)[1:]
        back = np.flatnonzero(d * rate(look[1:]) <= 0.0)
        if not len(back):  # it still slides as the ground stops
            u, w = place(T), rate(T)
            u += w * abs(w) / (2 * mu * g)
            return max(peak, abs(u)), u, [*stops, T + abs(w) / (mu * g)]
        t = brentq(rate, look[back[0]], look[back[0] + 1], xtol=1e-15)
        u, w = place(t), 0.0
        peak = max(peak, abs(u))
        stops.append(t)
        a = a_p * np.sin(omega * t)
        if abs(a) <= mu * g:  # it sticks, and breaks loose again in the second half if at all
            again = (np.pi + np.arcsin(mu * g / a_p)) / omega
            if t > again:
                return peak, u, stops
            t, d = again, 1.0
        else:
            d = -np.sign(a)


@pytest.mark.parametrize(("a_p", "mu"), [(6.0, 0.3), (3.5, 0.3), (9.0, 0.05), (4.0, 0.39)])
def test_one_cycle_of_a_sine(a_p, mu):
    omega = 7.0
    peak, end, stops = closed_form(a_p, omega, mu)
    ours = slid(pulse("sine", a_p, omega), mu)
    assert ours.scalars["outcome"][0] == SLIDING
    assert ours.scalars["slide_peak"][0] == pytest.approx(peak, abs=1e-12)
    assert ours.scalars["slide_residual"][0] == pytest.approx(end, abs=1e-12)
    assert ours.scalars["t_end"][0] == pytest.approx(max(stops[-1], 2 * np.pi / omega), abs=1e-12)
    assert ours.scalars["mu_required"][0] == mu
    assert ours.reasons == ["slides and does not rock: mu is not above tan(alpha)"]


def test_a_rectangular_pulse_is_newmark_s_block():
    """Constant a_g for t_1: u = a_g (a_g - mu g) t_1^2/(2 mu g) against the ground."""
    a_g, mu, omega = 5.0, 0.2, 10.0
    t_1 = np.pi / omega
    ours = slid(pulse("rectangular", a_g, omega), mu)
    assert ours.scalars["slide_residual"][0] == pytest.approx(-a_g * (a_g - mu * G) * t_1**2 / (2 * mu * G), rel=1e-13)
    assert ours.scalars["t_end"][0] == pytest.approx(a_g * t_1 / (mu * G), rel=1e-13)


def reference(values, up, dt, mu):
    """Displacement at the samples: DOP853 restarted at every sample, stop and start; friction written in sgn(u').

    Not tests/reference.py, which knows bodies that turn and none that slides.
    """
    u = w = 0.0
    d = 0.0
    places = [0.0]
    for i in range(len(values) - 1):
        t, end = i * dt, (i + 1) * dt

        def a(x, i=i):
            return values[i] + (values[i + 1] - values[i]) * (x / dt - i)

        def N(x, i=i):
            return G + up[i] + (up[i + 1] - up[i]) * (x / dt - i)

        while t < end - 1e-13:
            if d == 0.0:

                def over(x):
                    return abs(a(x)) - mu * N(x)

                look = np.linspace(t, end, 65)
                out = [x for x in look if over(x) > 1e-13]
                if not out:
                    t = end
                    continue
                before = max([x for x in look if x < out[0]], default=t)
                t = out[0] if over(before) > 0 or before == out[0] else brentq(over, before, out[0], xtol=1e-15)
                d = -np.sign(a(t))

            def stop(x, y, d=d, t=t):
                return y[1] * d if x > t + 1e-12 else 1.0

            stop.terminal, stop.direction = True, -1

            def rhs(x, y, d=d):
                return [y[1], -a(x) - d * mu * N(x)]

            found = solve_ivp(rhs, (t, end), [u, w], method="DOP853", rtol=1e-12, atol=1e-15, events=stop)
            t, (u, w) = found.t[-1], found.y[:, -1]
            if len(found.t_events[0]):
                w = 0.0
                d = 0.0
        places.append(u)
    return np.array(places)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_record_with_vertical_motion_against_an_independent_integration(seed):
    rng = np.random.default_rng(seed)
    dt, mu = 0.05, 0.15
    t = np.arange(80) * dt
    fade = np.minimum(1.0, (t[-1] - t) / 0.5)
    values, up = (
        s * fade * sum(rng.normal() * np.sin(rng.uniform(2, 12) * t + rng.uniform(0, 6)) for _ in range(4))
        for s in (2, 1)
    )
    ours = slid(record(values, dt, vertical=up), mu, histories=True, dt_out=dt)
    theirs = reference(values, up, dt, mu)
    n = len(theirs)
    np.testing.assert_allclose(ours.histories["slide"][0, : n - 1], theirs[: n - 1], atol=2e-10)
    assert np.abs(theirs).max() > 0.05
    assert ours.scalars["slide_peak"][0] >= np.abs(theirs).max() - 1e-10
    assert ours.scalars["N_min_over_mg"][0] == pytest.approx(1 + up.min() / G, rel=1e-12)


def test_histories_of_a_slide():
    omega, a_p, mu = 7.0, 6.0, 0.3
    motion = pulse("sine", a_p, omega)
    ours = slid(motion, mu, histories=True, dt_out=0.001)
    u, rate, mode = (ours.histories[name][0] for name in ("slide", "slide_dot", "contact_mode"))
    np.testing.assert_allclose(np.gradient(u, 0.001)[5:-5], rate[5:-5], atol=2e-2)
    np.testing.assert_array_equal(ours.histories["u_top"][0], u)
    assert ours.scalars["u_top_peak"][0] == ours.scalars["slide_peak"][0] >= np.abs(u).max() > 0.0
    assert set(np.unique(mode)) == {REST, SLIDE}
    assert (mode[ours.time < np.arcsin(mu * G / a_p) / omega] == REST).all()
    np.testing.assert_array_equal(ours.histories["theta"][0], 0.0)
    # the base moment is friction times h, never more than mu m g h
    h = block(1.0, 1.0).h[0]
    assert np.abs(ours.histories["M_base"][0]).max() == pytest.approx(mu * G * h, rel=1e-12)


def test_sliding_and_rocking_side_by_side():
    """Cases of one batch: three coefficients of friction, the sliding ones as alone, the others as without mu."""
    motion = pulse("half_sine", np.full(3, 0.45 * G), np.full(3, 6.0))
    both = slid(motion, [0.1, 0.25, 0.9], n=3, tan_alpha=0.3, histories=True)
    alone = slid(pulse("half_sine", 0.45 * G, 6.0), 0.25, tan_alpha=0.3, histories=True)
    free = slid(pulse("half_sine", 0.45 * G, 6.0), np.nan, tan_alpha=0.3, histories=True)
    np.testing.assert_array_equal(both.scalars["outcome"], [SLIDING, SLIDING, ROCKING])
    assert both.scalars["slide_peak"][1] == alone.scalars["slide_peak"][0] > 0.0
    assert both.scalars["slide_peak"][2] == 0.0
    assert both.scalars["theta_peak"][2] == free.scalars["theta_peak"][0]
    k = len(free.time)
    np.testing.assert_array_equal(both.histories["theta"][2, :k], free.histories["theta"][0])
    assert set(np.unique(both.histories["contact_mode"][2, :k])) <= {REST, ROCK}
    assert np.isnan(free.scalars["slide_peak"][0])
    assert "contact_mode" not in free.histories


def test_the_report_lasts_as_long_as_asked():
    motion = pulse("rectangular", 5.0, 10.0, duration=0.5)
    ours = slid(motion, 0.2, histories=True, dt_out=0.01)
    t_1, decel = np.pi / 10.0, 0.2 * G
    w = (5.0 - decel) * t_1
    at_half = 0.5 * w * t_1 + w * (0.5 - t_1) - 0.5 * decel * (0.5 - t_1) ** 2
    assert ours.scalars["t_end"][0] == 0.5
    assert ours.scalars["slide_peak"][0] < -ours.scalars["slide_residual"][0]
    assert -ours.histories["slide"][0, 50] == pytest.approx(at_half, rel=1e-12)
    assert ours.scalars["slide_peak"][0] == pytest.approx(at_half, rel=1e-12)


class TestShenton:
    """Initiation from rest: the regions of mu and a_g."""

    def test_the_regions(self):
        t = 0.4
        assert mode_from_rest(t, 4 / 3, 0.3, 0.29) == REST
        assert mode_from_rest(t, 4 / 3, 0.3, 0.31) == SLIDE
        assert mode_from_rest(t, 4 / 3, 0.3, 5.0) == SLIDE
        assert mode_from_rest(t, 4 / 3, 0.9, 0.39) == REST
        assert mode_from_rest(t, 4 / 3, 0.9, 0.41) == ROCK
        assert mode_from_rest(t, 4 / 3, 0.45, 3.0) == SLIDE_ROCK
        assert mode_from_rest(t, 4 / 3, 0.9, 0.41, -1.0) == FLIGHT

    def test_the_friction_a_rectangle_needs_to_rock(self):
        """mu = [a (1 + 4 r^2) + 3 r]/[3 a r + (4 + r^2)], r = b/h: Shenton's critical value, written out from T and N."""
        for r in (0.1, 0.4, 0.8):
            for a in (1.01 * r, 1.0, 3.0):
                critical = (a * (1 + 4 * r * r) + 3 * r) / (3 * a * r + 4 + r * r)
                assert mode_from_rest(r, 4 / 3, critical * (1 + 1e-9), a) == ROCK
                assert mode_from_rest(r, 4 / 3, critical * (1 - 1e-9), a) == (SLIDE_ROCK if critical > r else SLIDE)

    @pytest.mark.parametrize("up", [0.0, 0.3, -0.3])
    def test_the_solver_agrees_under_a_sudden_constant_acceleration(self, up):
        r = 0.4
        body = make_block(h=1.0, b=r)
        for mu in (0.2, 0.39, 0.41, 0.5, 0.7, 0.95):
            for a in (0.1, 0.3, 0.45, 0.9, 1.6):
                expected = mode_from_rest(r, 4 / 3, mu, a, up)
                columns = {f.name: getattr(body, f.name) for f in dataclasses.fields(body)} | {"mu": np.array([mu])}
                n = 3
                motion = record(np.full(n, -a * G), 2e-3, vertical=np.full(n, up * G), duration=4e-3)
                ours = solve(make_batch(type(body)(**columns), motion, histories=True, dt_out=1e-3))
                outcome = ours.scalars["outcome"][0]
                assert ours.histories["contact_mode"][0, 2] == expected
                assert (outcome == ROCKING) == (expected in (ROCK, SLIDE_ROCK))
                assert (outcome == NO_UPLIFT) == (expected == REST)
                assert (outcome == SLIDING) == (expected == SLIDE)
                assert (ours.scalars["slide_peak"][0] > 0.0) == (expected in (SLIDE, SLIDE_ROCK))


class TestMoreThanSliding:
    """Bodies that rock and slide, or fly: how the answers of pure rocking give way (tests/contact for the physics)."""

    def test_friction_that_suffices_changes_no_bit_and_less_lets_it_slide(self):
        motion = pulse("ricker", 2.0 * G * 0.2, 8.0)
        free = slid(motion, np.nan, tan_alpha=0.2)
        needed = float(free.scalars["mu_required"][0])
        assert needed > 0.2
        stands = slid(motion, needed * 1.001, tan_alpha=0.2)
        for name, values in free.scalars.items():
            if name not in (*SCALARS_SLIDING, "wall_time"):
                np.testing.assert_array_equal(stands.scalars[name], values, err_msg=name)
        assert stands.scalars["slide_peak"][0] == stands.scalars["n_slips"][0] == 0.0
        slips = slid(motion, needed * 0.999, tan_alpha=0.2, histories=True, dt_out=1e-4)
        assert slips.scalars["outcome"][0] == ROCKING
        assert slips.reasons[0] == ""
        assert 0.0 < slips.scalars["slide_peak"][0] < 1e-3
        assert slips.scalars["theta_peak"][0] == pytest.approx(free.scalars["theta_peak"][0], rel=0.02)
        assert slips.scalars["mu_required"][0] == needed
        assert {ROCK, SLIDE_ROCK} <= set(slips.histories["contact_mode"][0])
        assert slips.scalars["n_slips"][0] >= 1.0

    def test_a_slide_fades_as_friction_grows_to_what_is_needed(self):
        motion = pulse("ricker", 2.0 * G * 0.2, 8.0)
        free = slid(motion, np.nan, tan_alpha=0.2).scalars
        needed = float(free["mu_required"][0])
        far, near = (slid(motion, needed - d, tan_alpha=0.2).scalars for d in (1e-4, 1e-6))
        assert 0.0 < near["slide_peak"][0] < 0.1 * far["slide_peak"][0]
        assert abs(near["theta_peak"][0] - free["theta_peak"][0]) < 0.1 * abs(
            far["theta_peak"][0] - free["theta_peak"][0]
        )

    def test_an_impact_may_need_more_friction_than_the_rest(self):
        motion = pulse("ricker", 1.6 * G * 0.2, 8.0)
        free = slid(motion, np.nan, tan_alpha=0.2, eta=0.4).scalars
        assert free["mu_impact"][0] > free["mu_required"][0]
        mu = 0.5 * float(free["mu_impact"][0] + free["mu_required"][0])
        ours = slid(motion, mu, tan_alpha=0.2, eta=0.4)
        assert ours.scalars["outcome"][0] == ROCKING
        assert ours.scalars["t_slip"][0] > free["t_uplift"][0]
        assert ours.scalars["slide_peak"][0] > 0.0

    def test_a_body_thrown_up_comes_down_again(self):
        n = 200
        up = -1.2 * G * np.sin(np.arange(n) * 0.05)
        ours = slid(record(np.full(n, 2.0), 0.01, vertical=up), 0.5, histories=True, dt_out=0.01)
        assert ours.scalars["outcome"][0] == SLIDING  # it flies flat
        assert ours.scalars["n_flights"][0] >= 1.0
        assert "comes down from flight flat" in ours.reasons[0]
        flies = ours.histories["contact_mode"][0] == FLIGHT
        assert (ours.histories["lift"][0][flies][1:] > 0.0).any()
        assert (ours.histories["lift"][0][~flies & np.isfinite(ours.histories["lift"][0])] == 0.0).all()
        assert ours.scalars["N_min_over_mg"][0] <= 0.0

    @pytest.mark.parametrize(("a_p", "outcome"), [(-0.5 * G, SLIDING), (0.5 * G, ROCKING)])
    def test_over_one_edge_it_slides_and_over_the_other_it_rocks(self, a_p, outcome):
        body = make_block(h=1.0, b=[0.2, 0.6])
        columns = {f.name: getattr(body, f.name) for f in dataclasses.fields(body)} | {"mu": np.array([0.4])}
        ours = solve(make_batch(type(body)(**columns), pulse("half_sine", a_p, 20.0)))
        assert ours.scalars["outcome"][0] == outcome

    @pytest.mark.parametrize("mu", [0.25, 0.2])
    def test_from_a_tilt_it_rocks_as_long_as_friction_suffices(self, mu):
        """Free rocking needs about 3/4 tan(alpha), less than uplift from rest does."""
        ours = slid(pulse("half_sine", 0.1 * G, 6.0), mu, tan_alpha=0.3, theta_0=0.01)
        assert ours.scalars["outcome"][0] == ROCKING
        assert 0.2 < ours.scalars["mu_required"][0] < 0.25
        assert (ours.scalars["slide_peak"][0] > 0.0) == (mu == 0.2)

    def test_the_linearized_block_keeps_no_answer_and_says_why(self):
        motion = pulse("ricker", 2.0 * G * 0.2, 8.0)
        ours = slid(motion, 0.21, tan_alpha=0.2, model="linearized")
        assert ours.scalars["outcome"][0] == UNRESOLVED
        assert "this model has no forces for" in ours.reasons[0]

    def test_kinetic_friction_lets_it_slide_farther(self):
        body, motion = make_block(h=1.0, b=0.6), pulse("sine", 6.0, 7.0)
        one, other = (
            solve(make_batch(dataclasses.replace(body, mu=np.array([0.3]), mu_kinetic=np.array([k])), motion)).scalars
            for k in (0.3, 0.2)
        )
        assert other["slide_peak"][0] > one["slide_peak"][0] > 0.0
        assert other["t_slip"][0] == one["t_slip"][0]

    def test_a_push_on_a_still_ground(self):
        """u^2/(2 mu g) until it stops; tall enough, it trips instead."""
        batch = make_batch(dataclasses.replace(make_block(h=1.0, b=0.6), mu=np.array([0.3])), still())
        pushed = solve(dataclasses.replace(batch, slide_rate_0=np.array([0.8]))).scalars
        assert pushed["slide_residual"][0] == pytest.approx(0.8**2 / (2 * 0.3 * G), rel=1e-12)
        assert pushed["outcome"][0] == SLIDING
        batch = make_batch(dataclasses.replace(make_block(h=1.0, b=0.1), mu=np.array([0.6])), still())
        tripped = solve(dataclasses.replace(batch, slide_rate_0=np.array([3.0]))).scalars
        assert tripped["outcome"][0] == OVERTURNED_WITHOUT_IMPACT
        assert np.isnan(tripped["slide_residual"][0])

    def test_whether_it_overturns_may_hang_on_the_edge_it_lands_on(self):
        """A block dropped flat beside a push: the runs that land on one edge or the other first are told of."""
        n, dt = 100, 0.01
        t = np.arange(n) * dt
        values, up = 9.0 * (t < 0.3), -3.0 * G * (t < 0.3)
        body = dataclasses.replace(make_block(h=1.0, b=0.25), mu=np.array([0.9]))
        found = solve(make_batch(body, record(values, dt, vertical=up), scalars=SCALARS))
        share = found.scalars["overturn_share"][0]
        assert "comes down from flight flat" in found.reasons[0]
        assert (found.scalars["outcome"][0] == UNRESOLVED) == (0.0 < share < 1.0)


def test_in_a_study(tmp_path):
    found = rockcli.run(
        {
            "name": "slides",
            "case": {
                "block": {"height": 1.0, "width": 0.8, "mu": 0.3},
                "motion": {"pulse": {"shape": "sine", "a_p": 6.0, "omega_p": 7.0}},
            },
            "vary": {"block.mu": [0.05, 0.3]},
            "expect": [{"quantity": "slide_peak", "min": 0.01}],
        }
    )
    for mu in (0.05, 0.3):
        peak, end, _ = closed_form(6.0, 7.0, mu)
        assert float(found.slide_peak.sel(mu=mu)) == pytest.approx(peak, abs=1e-12)
        assert float(found.slide_residual.sel(mu=mu)) == pytest.approx(end, abs=1e-12)
    assert found.contact_mode.attrs["flag_meanings"].split() == ["rest", "slide", "rock", "slide_rock", "flight"]


@pytest.mark.parametrize("model", ["rigid", "linearized"])
@pytest.mark.parametrize("histories", [True, False])
def test_a_body_that_overturns_has_no_slide_in_the_end(model, histories):
    """Whether its base slips on the way or not."""
    case = {
        "block": {"h": 2.0, "b": 0.4, "mu": 5.0},
        "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 2.5, "T_p": 2.0}},
        "model": model,
    }
    vary = {"block.mu": [0.25, 5.0], "motion.pulse.a_p_over_g_tan_alpha": [1.02, 2.5]}
    found = rockcli.run({"name": "a", "case": case, "vary": vary, "save": {"histories": histories}, "plots": []})
    fell = found.outcome.values == OVERTURNED_WITHOUT_IMPACT
    assert fell.tolist() == [[False, True], [False, True]]
    assert (np.isnan(found.slide_residual.values) == fell).all()
    assert (found.slide_peak.values >= 0.0).all()


class TestFrictionOfTanAlpha:
    """mu = tan(alpha) to rounding: the body slides with the normal force at its edge."""

    @pytest.mark.parametrize(("h", "b", "mu"), [(1.0, 0.3, 0.3), (0.9, 0.27, 0.3), (1.1, 0.77, 0.7), (0.3, 0.03, 0.1)])
    def test_it_slides_as_the_closed_form_says(self, h, b, mu):
        a_p, omega = 2.0 * mu * G, 7.0
        body = dataclasses.replace(make_block(h=h, b=b), mu=np.array([mu]))
        found = solve(make_batch(body, pulse("sine", a_p, omega))).scalars
        peak, end, _ = closed_form(a_p, omega, mu)
        assert found["outcome"][0] == SLIDING
        assert found["slide_peak"][0] == pytest.approx(peak, abs=1e-12)
        assert found["slide_residual"][0] == pytest.approx(end, abs=1e-12)

    def test_rocking_begins_just_above(self):
        """Shenton's plane: from a mu above tan(alpha) by a millionth on, the edge needs more friction than there is."""
        body = make_block(h=1.0, b=0.3)
        for mu, outcome in ((0.3 * (1.0 - 1e-6), SLIDING), (0.3, SLIDING), (0.3 * (1.0 + 1e-6), ROCKING)):
            given = dataclasses.replace(body, mu=np.array([mu]))
            assert solve(make_batch(given, pulse("sine", 0.6 * G, 7.0))).scalars["outcome"][0] == outcome
        assert mode_from_rest(0.3, 4 / 3, 0.3, 0.31) == SLIDE
        assert mode_from_rest(0.3, 4 / 3, 0.3, 0.29) == REST

    def test_below_the_threshold_it_stays(self):
        body = dataclasses.replace(make_block(h=1.0, b=0.3), mu=np.array([0.3]))
        found = solve(make_batch(body, pulse("sine", 0.3 * G, 7.0))).scalars
        assert found["outcome"][0] == NO_UPLIFT
        assert found["slide_peak"][0] == 0.0

    def test_an_asymmetric_body_slides_if_mu_is_tan_alpha_of_its_weak_edge(self):
        body = dataclasses.replace(make_block(h=1.0, b=[0.3, 0.5]), mu=np.array([0.3]))
        found = solve(make_batch(body, pulse("sine", 0.6 * G, 7.0), scalars=SCALARS)).scalars
        assert found["outcome"][0] == SLIDING
        assert found["theta_peak_left"][0] == 0.0 == found["theta_peak_right"][0] == found["theta_peak_over_alpha"][0]
        assert found["overturn_share"][0] == 0.0


STUDY = {
    "name": "cabinets",
    "case": {
        "block": {"height": 1.0, "width": 0.5, "mu": 0.2},
        "motion": {"pulse": {"shape": "sine", "a_p": 6.0, "omega_p": 7.0}},
    },
    "vary": {"block.mu": [0.05, 0.2, 0.8]},
    "save": {"histories": True, "dt_out": 0.01},
}


class TestSeen:
    """Whoever slides is seen to: in the summary, the expectations, the search, the table and the figures."""

    def test_summary_and_report(self, tmp_path):
        from rockcli.cli.words import report_text
        from rockcli.engine.run import run_study
        from rockcli.study.open import open_study

        expect = [{"quantity": "outcome", "at": {"mu": 0.05}, "is": "sliding"}]
        report = run_study(open_study(STUDY | {"expect": expect}), tmp_path, plots=False)
        assert report.outcomes == {"sliding": 2, "rocking": 1}
        assert report.unmet == 0
        peak, _, _ = closed_form(6.0, 7.0, 0.05)
        assert report.slide == pytest.approx(peak, abs=1e-12)
        assert report.slide_at == "mu=0.05"
        assert f"slide     |displacement| = {peak:.6g} m at mu=0.05" in report_text(report)
        data = rockcli.run(STUDY)
        assert data["outcome"].attrs["flag_meanings"].split()[-1] == "sliding"

    def test_where_nothing_rocks_the_peak_has_no_place(self, tmp_path):
        from rockcli.cli.words import report_text
        from rockcli.engine.run import run_study
        from rockcli.study.open import open_study

        study = STUDY | {"vary": {"block.mu": [0.05, 0.2]}}
        told = report_text(run_study(open_study(study), tmp_path, plots=False))
        assert "  peak      |theta|/alpha = 0\n" in told
        assert "`rock check` says which do" in rockcli.run(study).attrs["warnings"]
        assert "  peak      |theta|/alpha = 0\n" in f"{rockcli.run(study).rock}\n"

    def test_one_that_no_friction_stops_is_told_beside_the_largest_that_stop(self, tmp_path):
        from rockcli.cli.words import report_text
        from rockcli.engine.run import run_study
        from rockcli.plotting.page.facts import facts_of
        from rockcli.study.open import open_study

        case = STUDY["case"] | {"motion": {"pulse": {"shape": "half_sine", "a_p": 6.0, "omega_p": 7.0}}}
        study = STUDY | {"case": case, "vary": {"block.mu": [0, 0.05, 0.2]}}
        report = run_study(open_study(study), tmp_path, plots=False)
        found = rockcli.run(study)
        most = float(found["slide_peak"].sel(mu=0.05))
        assert np.isinf(found["slide_peak"].values).tolist() == [True, False, False]
        assert (report.slide, report.slides_on) == (most, 1)
        told = f"|displacement| = {most:.6g} m at mu=0.05 (largest of those that stop; 1 case never)"
        assert told in report_text(report)
        assert "slides on 1 for ever" in f"{found.rock}"
        (fact,) = (fact for fact in facts_of(found) if fact.what == "largest slide")
        assert fact.value == f"{most:.3g} m"
        assert fact.sentence.endswith("in 1 of 3 cases no friction stops it")

    def test_it_stands_in_a_search_and_in_a_suite(self):
        vary = {"block.mu": [0.2, 0.9], "motion.pulse.a_p": {"from": 6.0, "to": 30.0, "n": 9, "find": "overturning"}}
        data = rockcli.run({"name": "s", "case": STUDY["case"], "vary": vary})
        assert data["motion_pulse_a_p_overturning_state"].values[0] == 1  # none in the range
        assert np.isinf(data["motion_pulse_a_p_overturning"].values[0])
        del vary["motion.pulse.a_p"]
        suite = rockcli.run({"name": "s", "case": STUDY["case"], "vary": vary, "over": "block.mu"})
        assert float(suite["p_overturned"]) == 0.0
        assert int(suite["n_answered"]) == 2

    def test_table_and_page(self):
        from rockcli.plotting.common.table import case_table
        from rockcli.plotting.page.page import page

        data = rockcli.run(STUDY)
        header, rows, _ = case_table(data)
        assert [row[header.index("outcome")] for row in rows] == ["sliding", "sliding", "rocking"]
        slides = [float(row[header.index("slide_peak [m]")]) for row in rows]
        np.testing.assert_allclose(slides, data["slide_peak"].values, rtol=1e-5)
        assert "2 sliding" in page(data, ())

    def test_histories_have_a_panel_of_the_slide(self):
        from rockcli.plotting import figures

        data = rockcli.run(STUDY)
        figure = figures.figure("histories", data)
        (panel,) = (axes for axes in figure.axes if axes.get_ylabel() == "sliding $u$ [m]")
        drawn = [line.get_ydata() for line in panel.lines if len(line.get_xdata()) == data.sizes["time"]]
        for line, expected in zip(drawn, data["slide"].values, strict=True):
            np.testing.assert_array_equal(line, expected)
        labels = [text.get_text() for text in figure.legends[0].get_texts()]
        assert sum("(sliding)" in label for label in labels) == 2
        # where nothing turns there is no panel of rotations; where nothing slides none of slides
        for mu, present in (([0.05, 0.2], "sliding"), ([0.8, 0.9], "theta")):
            only = figures.figure("histories", rockcli.run(STUDY | {"vary": {"block.mu": mu}}))
            named = [axes.get_ylabel() for axes in only.axes]
            assert any("sliding" in name for name in named) == (present == "sliding")
            assert any("theta" in name for name in named) == (present == "theta")

    def test_maps_and_curves_tell_it_from_rest(self):
        from matplotlib.colors import to_rgb

        from rockcli.plotting import figures
        from rockcli.plotting.common.style import OUTCOME_COLOURS

        assert len(set(OUTCOME_COLOURS.values())) == len(OUTCOME_COLOURS) == 7
        vary = {"block.mu": np.linspace(0.1, 0.4, 5).tolist(), "motion.pulse.a_p": np.linspace(0.5, 6.0, 5).tolist()}
        data = rockcli.run({"name": "map", "case": STUDY["case"], "vary": vary, "save": {"histories": False}})
        expected = data["motion_pulse_a_p"].values[None, :] > data["mu"].values[:, None] * G
        np.testing.assert_array_equal(data["outcome"].values == SLIDING, expected)
        figure = figures.figure("map", data)
        colours = np.asarray(figure.axes[0].images[0].get_array())
        turned = expected.T if figure.axes[0].get_ylabel().startswith("$a_p$") else expected
        sliding = 255.0 * np.array(to_rgb(OUTCOME_COLOURS["sliding"]))
        np.testing.assert_allclose(colours[turned], np.tile(sliding, (turned.sum(), 1)), atol=0.5)
        assert "sliding" in [text.get_text() for text in figure.legends[0].get_texts()]
        curve = figures.figure("map", rockcli.run(STUDY | {"save": {"histories": False}}))
        assert [label.get_text() for label in curve.axes[0].get_yticklabels()] == ["sliding"]

    def test_an_animation_moves_the_body_along_the_ground(self):
        from rockcli.plotting.kinds.animate import _Stage, scenes

        data = rockcli.run(STUDY)
        shown = scenes(data, (0,), step=0.1)
        stage = _Stage(data, (0,), shown, "")
        moved = [outline[:, 0].mean() - stage.outlines[0][:, 0].mean() for outline in stage.outlines]
        slide = np.interp(shown.times, data["time"].values, np.nan_to_num(data["slide"].values[0]))
        np.testing.assert_allclose(np.array(moved) + slide[0], slide, atol=1e-12)
