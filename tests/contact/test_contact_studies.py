"""Contact in study files: keys, their errors, results in the dataset."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from contact_cases import body, motion, run
from contact_tables import FRICTIONLESS
from scipy.integrate import solve_ivp

import rockcli
from rockcli.errors import StudyError
from rockcli.scene.response import ROCKING, UNRESOLVED
from rockcli.solvers.contact.answers import SLIPS_STILL

BODY = {"height": 1.216 * 2, "width": 0.8438 * 2, "mu": 0.5}
CASE = {
    "block": {"height": 0.82, "width": 0.1738, "mu": 0.29},
    "motion": {
        "pulse": {"shape": "sine", "a_p": 3.997, "omega_p": 16.974, "cycles": 2},
        "vertical": {"pulse": {"shape": "sine", "a_p": 10.188, "omega_p": 26.47, "cycles": 3}},
    },
    "damping": {"scheme": "restitution"},
}


def solved(**changes):
    case = copy.deepcopy(CASE)
    for path, value in changes.items():
        at = case
        *inside, last = path.split("__")
        for key in inside:
            at = at.setdefault(key, {})
        at[last] = value
    return rockcli.run({"name": "contact", "case": case, "save": {"histories": True, "dt_out": 0.01}})


def test_a_study_solves_what_the_kernel_does():
    ds = solved()
    T = 6 * np.pi / 26.47
    par = body(0.0869, 0.41, 0.29, t_motion=max(T, 4 * np.pi / 16.974))
    alone = run(par, motion(f"sine 3.997 16.974 {4 * np.pi / 16.974!r}"), motion(f"sine 10.188 26.47 {T!r}"))
    assert int(ds.n_flights) == alone["N_FLIGHTS"] > 0
    assert float(ds.slide_peak) == pytest.approx(abs(alone["SLIDE_PEAK"]), abs=1e-7)
    assert float(ds.theta_peak) == pytest.approx(alone["PEAK"] * alone["PEAK_SIDE"], abs=1e-7)
    assert float(ds.t_slip) == pytest.approx(alone["T_SLIP"], abs=1e-9)
    assert float(ds.t_flight) == pytest.approx(alone["T_FLIGHT"], abs=1e-9)
    assert abs(float(ds.energy_residual)) < 1e-9
    assert float(ds.lift.max()) > 0.0
    assert float(abs(ds.slide).max()) == pytest.approx(float(ds.slide_peak), abs=1e-4)
    np.testing.assert_allclose(ds.u_top, ds.slide + 0.82 * np.sin(ds.theta), atol=1e-12)
    assert ds.contact_mode.attrs["flag_meanings"].split()[-1] == "flight"
    assert 0.0 < float(ds.error_estimate) < 1e-3
    assert float(ds.overturn_share) == 0.0


def test_friction_of_two_numbers():
    one = solved(block__mu={"static": 0.29, "kinetic": 0.29})
    for same in (solved(block__mu={"static": 0.29}), solved()):
        assert float(one.slide_peak) == float(same.slide_peak)
    less = solved(block__mu={"static": 0.29, "kinetic": 0.2})
    assert float(less.t_slip) == float(one.t_slip)
    assert float(less.slide_peak) != float(one.slide_peak)
    axis = rockcli.run(
        {
            "name": "axis",
            "case": {**copy.deepcopy(CASE), "block": {**CASE["block"], "mu": {"static": 0.29, "kinetic": 0.1}}},
            "vary": {"block.mu.kinetic": [0.2, 0.29], "initial.slide_rate": [0.0, 0.1], "block.e_n": [0, 0.5]},
            "save": {"histories": False},
        }
    )
    at = axis.sel(slide_rate=0.0, e_n=0.0)
    assert float(at.slide_peak.sel(kinetic=0.2)) == pytest.approx(float(less.slide_peak), abs=1e-12)
    assert len(np.unique(axis.slide_peak)) == 8
    assert axis.slide_rate.attrs["units"] == "m s-1"


@pytest.mark.parametrize("row", FRICTIONLESS)
def test_a_body_let_go_on_ice_falls_straight_down(row):
    b, h, theta_0, t, before, after, second = row
    case = {"block": {"b": b, "h": h, "mu": 0}, "motion": None, "initial": {"theta": theta_0}}
    ds = rockcli.run({"name": "ice", "case": case, "save": {"histories": True, "dt_out": 2e-4}})
    first = [float(ds[name].values.ravel()[0]) for name in ("t_impact", "theta_dot_before", "theta_dot_after")]
    assert first == pytest.approx([t, before, after], abs=1e-8)
    assert -float(abs(ds.theta.where(ds.theta < 0)).max()) == pytest.approx(second, abs=1e-6)
    assert int(ds.outcome) == ROCKING


@pytest.mark.parametrize(("rate", "outcome"), [(0.2, ROCKING), (2.0, UNRESOLVED)])
def test_a_slide_that_is_not_followed_to_its_end_is_told(rate, outcome):
    """Without a loss it rocks on for more than 60/p; as a slide alone it would go rate^2/(2 mu g)."""
    case = {"block": {"b": 0.2, "h": 1.0, "mu": 1e-4}, "initial": {"theta": "0.3*alpha", "slide_rate": rate}}
    damping = {"damping": {"scheme": "restitution", "eta": 1.0}}
    ds = rockcli.run({"name": "ice", "case": case | damping, "save": {"histories": False}})
    assert int(ds.outcome) == outcome
    assert float(ds.slide_peak) < 0.5 * rate**2 / (2.0 * 1e-4 * 9.81)
    reason = str(ds.reasons.values[int(ds.reason)])
    assert reason.startswith(SLIPS_STILL)
    assert ("whether it overturns is not known" in reason) == (outcome == UNRESOLVED)
    assert "chance" not in reason  # no run tells whether it overturns: that is no sign of chaos
    assert float(ds.overturn_share) == (0.5 if outcome == UNRESOLVED else 0.0)
    lossy = rockcli.run({"name": "ice", "case": case, "save": {"histories": False}})  # rests on its base, and slides on
    assert not str(lossy.reasons.values[int(lossy.reason)])


@pytest.mark.parametrize(("duration", "peak"), [(None, np.inf), (3.0, 4.0 * 0.35 * (3.0 - 0.175))])
def test_without_friction_the_ground_moves_away_below(duration, peak):
    pulse = {"shape": "rectangular", "a_p": 4.0, "T_p": 0.7}  # half of it is the pulse
    case = {"block": {"b": 0.2, "h": 1.0, "mu": 0}, "motion": {"pulse": pulse, "duration": duration}}
    ds = rockcli.run({"name": "ice", "case": case, "save": {"histories": True, "dt_out": 0.01}})
    assert float(ds.slide_peak) == pytest.approx(peak, rel=1e-12)
    assert float(ds.slide_residual) == -np.inf
    assert "slides on for ever" in str(ds.reasons.values[int(ds.reason)])
    t = ds.time.values[ds.time <= 3.0]
    away = np.where(t < 0.35, 2.0 * t * t, 1.4 * (t - 0.175))
    np.testing.assert_allclose(ds.slide.values.ravel()[: len(t)], -away, atol=1e-12)


def test_without_friction_a_ground_that_stops_leaves_the_body_where_it_is():
    """The displacement of the ground after one cycle of a sine is a_p T_p²/(2 pi)."""
    case = {"block": {"b": 0.2, "h": 1.0, "mu": 0}, "motion": {"pulse": {"shape": "sine", "a_p": 4.0, "T_p": 0.7}}}
    ds = rockcli.run({"name": "ice", "case": case})
    for found in (ds.slide_peak, -ds.slide_residual):
        assert float(found) == pytest.approx(4.0 * 0.7**2 / (2.0 * np.pi), rel=1e-12)


@pytest.mark.parametrize("mu", [0.03, 1e-3, 1e-6])
def test_a_slide_is_followed_to_its_end(mu):
    case = {"block": {"b": 0.2, "h": 1.0, "mu": mu}, "g": 9.81}
    case["motion"] = {"pulse": {"shape": "rectangular", "a_p": 4.0, "T_p": 0.7}}
    ds = rockcli.run({"name": "slippery", "case": case})
    u, place = (4.0 - mu * 9.81) * 0.35, (4.0 - mu * 9.81) * 0.35**2 / 2.0
    assert float(ds.slide_peak) == pytest.approx(place + u * u / (2.0 * mu * 9.81), rel=1e-12)
    assert float(ds.slide_residual) == -float(ds.slide_peak)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"block__mu": {"static": 0.2, "kinetic": 0.3}}, "case.block.mu.kinetic = 0.3: must not be above static"),
        ({"block__mu": {"kinetic": 0.3}}, "the key 'static' is missing"),
        ({"block__mu": {"static": 0.3, "dynamic": 0.2}}, "unknown key 'dynamic'"),
        ({"block__mu": {"static": "a lot"}}, "case.block.mu.static"),
        ({"block__mu": [0.3, 0.2]}, "a number or an expression is expected, not a list"),
        ({"block__mu": -0.1}, "case.block.mu = -0.1: must not be negative"),
        ({"block__e_n": 1.2}, "case.block.e_n = 1.2: must be between 0 and 1"),
        ({"block__e_n": 0.2, "block__mu": None}, "only where mu is given"),
        ({"initial__slide_rate": 0.2, "block__mu": None}, "needs a mu"),
    ],
)
def test_errors(changes, message):
    with pytest.raises(StudyError) as error:
        solved(**changes)
    assert message in str(error.value)


def test_spring_models_and_dashpots_say_what_they_lack():
    for changes in ({"model": "linearized"}, {"model": "2"}, {"damping": "dashpot"}):
        ds = solved(block__mu=0.22, **changes)
        assert int(ds.outcome) == -1
        assert "forces" in str(ds.reasons.values[int(ds.reason)])


def test_an_asymmetric_body_mirrored_is_its_mirror_image():
    one = solved(block={"h": 0.5, "b": [0.08, 0.14], "mu": 0.25})
    case = copy.deepcopy(CASE)
    case["block"] = {"h": 0.5, "b": [0.14, 0.08], "mu": 0.25}
    case["motion"]["pulse"]["a_p"] = -3.997
    other = rockcli.run({"name": "mirror", "case": case, "save": {"histories": True, "dt_out": 0.01}})
    assert float(one.slide_peak) > 0.0
    assert float(other.slide_residual) == -float(one.slide_residual)
    assert float(other.theta_peak) == -float(one.theta_peak)
    np.testing.assert_array_equal(other.theta, -one.theta)


def test_a_mirrored_push_moves_the_top_as_far():
    """The largest displacement of the top is a maximum on one side and a minimum on the other."""
    case = {"block": {"h": 1.5816, "b": 0.32, "mu": 0.3, "top": 2.9}}
    one, other = (
        rockcli.run({"case": {**case, "initial": {"theta": side * 0.05, "slide_rate": side * 0.02}}})
        for side in (1, -1)
    )
    assert float(one.slide_peak) > 0.0
    for name in ("slide_residual", "theta_peak"):
        assert float(other[name]) == -float(one[name])
    assert float(other.u_top_peak) == pytest.approx(float(one.u_top_peak), rel=1e-13)


def test_the_largest_slide_under_a_duration_is_that_of_the_report():
    """A foot that slips on after the report slides farther than what is reported; its histories end with the report."""
    case = {
        "block": {"h": 0.3, "b": [0.11, 0.08], "r_g": 0.17, "mu": 0.15},
        "initial": {"theta": -0.23, "theta_dot": 0.18, "slide_rate": 0.04},
    }
    whole, short = (
        rockcli.run({"case": {**case, "motion": {"duration": end}}, "save": {"dt_out": 1e-4}}) for end in (1.5, 0.6)
    )
    until = float(np.abs(whole.slide[whole.time <= 0.6]).max())  # its foot holds then, and slips again at 0.85 s
    assert float(whole.slide_peak) > 3.0 * until
    assert float(short.slide_peak) == pytest.approx(until, rel=1e-3)


@pytest.mark.parametrize("curves", [[], ["pushover"]])
def test_a_push_along_the_ground_is_something_that_moves(curves):
    case = {"block": {"height": 1.0, "width": 0.5, "mu": 0.2}, "initial": {"slide_rate": 1.0}}
    dataset = rockcli.run({"name": "push", "case": case, "curves": curves})
    assert float(dataset["slide_peak"]) == pytest.approx(1.0 / (2.0 * 0.2 * 9.81), rel=1e-9)
    assert "nothing moves" not in dataset.attrs["warnings"]


def test_slide_and_normal_force_of_a_body_that_falls_are_those_until_it_passes_its_equilibrium():
    """On its way to the ground the base slides on and is nearly weightless; by (K5, K6), integrated apart."""
    R, alpha, mu, a, g, k = 1.3, np.arctan(0.2), 0.21, 0.5 * 9.81, 9.81, 3.0

    def normal(q, rate):
        beta = alpha - q
        return (g - R * np.cos(beta) * rate**2) / (1.0 + k * np.sin(beta) * (np.sin(beta) - mu * np.cos(beta)))

    def flow(t, y):
        q, rate, speed, _ = y
        N, beta = normal(q, rate), alpha - q
        slip = speed - R * np.cos(beta) * rate  # it slips the way it tilts
        return [rate, k / R * N * (mu * np.cos(beta) - np.sin(beta)), a - mu * N, slip]

    def passes(t, y):
        return y[0] - alpha

    passes.terminal = True
    truth = solve_ivp(flow, (0.0, 5.0), [0.0] * 4, events=passes, rtol=1e-11, atol=1e-13)
    push = {"pulse": {"shape": "rectangular", "a_p": -a, "T_p": 3.0 * truth.t[-1]}}
    found = rockcli.run({"case": {"block": {"R": R, "alpha": float(alpha), "mu": mu}, "motion": push}})
    assert int(found.outcome) == 2
    assert float(found.t_overturn) == pytest.approx(truth.t[-1], rel=1e-9)
    assert float(found.slide_peak) == pytest.approx(truth.y[3, -1], rel=1e-9)
    least = normal(*truth.y[:2]).min()
    assert float(found.N_min_over_mg) == pytest.approx(least / g, rel=1e-9)
    assert np.abs(found.slide).max() > 1.5 * found.slide_peak


def test_the_slide_of_a_body_that_falls_grows_from_nothing_as_friction_gives_way():
    """Just above `mu_required` it is 0, and just below next to nothing, alone and in lanes."""
    case = {
        "block": {"height": 4.0, "width": 0.4, "mu": 0.2},
        "motion": {"record": {"file": "synthetic_pulse_m70.AT2", "pga": "0.6*g"}},
    }
    vary = {"block.mu": [0.15, 0.2, 0.25]}
    alone, lanes = (rockcli.run({"case": case, "vary": vary, "save": {"histories": save}}) for save in (True, False))
    for found in (alone, lanes):
        assert (found.outcome == 3).all()
        assert float(found.slide_peak[0]) > 1e-3 > 1e-4 > float(found.slide_peak[1]) > 0.0 == float(found.slide_peak[2])
        assert np.ptp(found.N_min_over_mg.values) < 1e-3
    np.testing.assert_allclose(lanes.slide_peak, alone.slide_peak, rtol=1e-6)
    np.testing.assert_allclose(lanes.N_min_over_mg, alone.N_min_over_mg, rtol=1e-6)
    before = alone.slide[0].where(alone.time < alone.t_overturn[0])
    assert float(alone.slide_peak[0]) == pytest.approx(float(np.abs(before).max()), rel=0.05)


@pytest.mark.parametrize("histories", [True, False])
@pytest.mark.parametrize("initial", [{"theta": 0.0}, {"theta": 0.05}, {"slide_rate": 0.3}])
def test_nothing_pulls_a_body_down_that_the_ground_leaves_from_one_instant_to_the_next(initial, histories):
    """At 0.1 s a_v jumps from 1.5 g to -1.5 g: from then on it flies."""
    vertical = {"pulse": {"shape": "square_cycle", "a_p": "1.5*g", "T_p": 0.2}}
    motion = {"pulse": {"shape": "rectangular", "a_p": 0.01, "T_p": 0.8}, "vertical": vertical}
    case = {"block": {"h": 1.0, "b": 0.2, "mu": 0.5}, "motion": motion, "initial": initial}
    found = rockcli.run({"case": case, "save": {"histories": histories}})
    assert float(found.t_flight) == pytest.approx(0.1, rel=1e-12)
    assert float(found.N_min_over_mg) == 0.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_largest_slide_of_a_flight_past_upright_is_that_of_the_lower_edge(side):
    """The slide is that of the left edge until theta is zero, then that of the right one; a parabola and a turning."""
    h, b, theta, rate, a, g = 1.0, 0.5, -0.3, 2.0, 0.01, 9.81
    vertical = {"pulse": {"shape": "rectangular", "a_p": -1.5 * g, "T_p": 0.8}}
    motion = {"pulse": {"shape": "rectangular", "a_p": side * a, "T_p": 0.8}, "vertical": vertical}
    initial = {"theta": side * theta, "theta_dot": side * rate}
    found = rockcli.run({"case": {"block": {"h": h, "b": b, "mu": 0.5}, "motion": motion, "initial": initial}})

    t = np.linspace(0.0, (np.arctan(b / h) - theta) / rate, 1_000_001)  # up to its equilibrium
    turned = theta + rate * t
    foot = np.where(turned > 0.0, b, -b)
    edge = foot * np.cos(turned) - h * np.sin(turned)  # from the centre of mass
    speed = rate * (h * np.cos(theta) - b * np.sin(theta))  # of the centre of mass, as the left edge has none
    slide = speed * t - 0.5 * a * t**2 + (edge - edge[0]) - (foot - foot[0])
    assert float(found.t_flight) == 0.0
    assert float(found.t_overturn) == pytest.approx(t[-1], rel=1e-12)
    assert float(found.slide_peak) == pytest.approx(np.abs(slide).max(), rel=1e-9)


def test_a_slide_that_turns_round_just_after_a_bounce_is_among_the_largest():
    """A corner that strikes and does not slip bounces: its slide grows from a rate of zero, and gets less again at once."""
    block = {"R": 1.8, "tan_alpha": 1.07, "mu": 1.5, "e_n": 0.5}
    vertical = {"pulse": {"shape": "sine", "a_p": "1.6*g", "T_p": 0.49}}
    pulse = {"shape": "cosine", "a_p_over_g_tan_alpha": 2.0, "omega_p_over_p": 1.58}
    case = {"block": block, "motion": {"pulse": pulse, "vertical": vertical}}
    found = rockcli.run({"case": case, "save": {"dt_out": 1e-4}})
    assert int(found.outcome) == 3
    told = np.abs(found.slide.where(found.time <= found.t_overturn)).max()
    assert float(found.slide_peak) == pytest.approx(float(told), rel=1e-8)


def test_a_body_that_the_ground_leaves_slowly_does_not_come_down_before_it_falls():
    """The ground begins to fall faster than g: the gap grows with t^3, and no edge meets the ground while it does."""
    pulse = {"shape": "ricker", "a_p": 17.755322367248453, "T_p": 0.26278875577228683}
    falls = {"shape": "sine", "a_p": 11.712963466208224, "T_p": 0.3}
    block = {"h": 0.8518227585724576, "b": [0.2, 0.25], "mu": 0.864609463232837}
    ds = rockcli.run({"case": {"block": block, "motion": {"pulse": pulse, "vertical": {"pulse": falls}}}})
    assert abs(float(ds.energy_residual)) < 1e-9
    # from where it leaves the ground, at the height x(t) of its base above it, x'' = -g - a_v, until that is zero
    flight = np.asarray(ds.time)[np.asarray(ds.lift) > 1e-6]
    start = float(ds.t_flight)
    times = np.linspace(start, 0.35, 20001)
    a_v = -9.81 - falls["a_p"] * np.sin(2.0 * np.pi * times / 0.3) * (times < 0.3)
    speed = np.concatenate([[0.0], np.cumsum(0.5 * (a_v[1:] + a_v[:-1]) * np.diff(times))])
    height = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(times))])
    i = int(np.argmax((height < 0.0) & (times > start + 0.01)))
    down = np.interp(0.0, height[[i, i - 1]], times[[i, i - 1]])
    assert flight.max() == pytest.approx(down, abs=2.0 * float(ds.time[1]))
    assert float(ds.t_impact[np.argmax(np.asarray(ds.t_impact) > start + 1e-4)]) == pytest.approx(down, abs=1e-7)
