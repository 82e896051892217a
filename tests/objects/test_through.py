"""`motion.through`: floors and isolators against independent integrations, and their two limits."""

from __future__ import annotations

import json
from itertools import chain, pairwise
from pathlib import Path

import numpy as np
import pytest
from scenes import G
from scipy.integrate import solve_ivp

import rockcli
from rockcli.errors import StudyError
from rockcli.motion.floors import BETWEEN, RINGS_TO, Chain
from rockcli.motion.reading import read_record
from rockcli.motion.spectrum import forcing
from rockcli.scene.ground.excitation import Samples, acceleration
from rockcli.scene.ground.pulses import make_pulses
from rockcli.study.open import open_study

RECORD = Path(__file__).parents[2] / "records" / "synthetic_rock_m65.AT2"


@pytest.fixture(scope="module")
def ground():
    motion = read_record(RECORD)
    return Samples(motion.acceleration(G), motion.dt, np.ones(1))


def integrated(u, T, zeta, times, kinks=()):
    """Absolute acceleration on top at some times, by DOP853 from kink to kink of the ground u(t)."""
    w, m = 2.0 * np.pi / np.asarray(T), len(T)

    def rates(t, y):
        below, found = u(t), np.empty(2 * m)
        for j in range(m):
            x, v = y[2 * j], y[2 * j + 1]
            above = -(2.0 * zeta[j] * w[j] * v + w[j] ** 2 * x)
            found[2 * j], found[2 * j + 1] = v, above - below
            below = above
        return found

    ends = np.unique(np.concatenate([times, [k for k in kinks if k < times[-1]]]))
    y, at = np.zeros(2 * m), {0.0: np.zeros(2 * m)}
    for a, b in pairwise(ends):
        y = solve_ivp(rates, (a, b), y, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        at[float(b)] = y
    top = np.array([at[float(t)] for t in times])
    return -(2.0 * zeta[-1] * w[-1] * top[:, -1] + w[-1] ** 2 * top[:, -2])


@pytest.mark.parametrize(
    ("T", "zeta"), [([0.3], [0.05]), ([2.5], [0.15]), ([0.3, 2.5], [0.05, 0.15]), ([0.4, 0.4], [0.02, 0.02]), ([0.5], [1.5])]
)  # fmt: skip
def test_of_a_record_it_is_exact(ground, T, zeta):
    times = ground.dt * np.arange(1001)
    want = integrated(lambda t: np.interp(t, times, ground.values[:1001]), T, zeta, times)
    got = Chain(np.array(T), np.array(zeta)).run(forcing(ground), times)
    assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


@pytest.mark.parametrize("shape", ["ricker", "sine", "half_sine"])
def test_of_a_pulse_it_is_that_of_an_integration(shape):
    pulse = make_pulses(
        shape, a_p=np.array([2.0]), omega_p=np.array([7.0]), **({"cycles": np.ones(1)} if shape == "sine" else {})
    )
    times = np.linspace(0.0, 2.0 * float(pulse.end[0]), 101)
    kinks = np.unique(pulse.table[0][:, :2])
    want = integrated(lambda t: float(acceleration(pulse, np.array([t]))[0]), [0.5], [0.05], times, kinks)
    got = Chain(np.array([0.5]), np.array([0.05])).run(forcing(pulse), times)
    assert np.abs(got - want).max() < 1e-8 * np.abs(want).max()


def test_between_samples_it_is_as_straight_as_it_says(ground):
    floor = Chain(np.array([0.3]), np.array([0.05]))
    arrival = floor.arrival(forcing(ground), ground.dt)
    thirds = np.arange(0.5, 6.0, 1.0 / 3.0) + 1000.0
    exact = floor.run(forcing(ground), thirds * arrival.dt)
    line = np.interp(thirds, np.arange(len(arrival.values)), arrival.values)
    assert np.abs(exact - line).max() < BETWEEN * np.abs(arrival.values).max()
    assert arrival.between < BETWEEN
    assert arrival.left < 0.01


@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.8, 1.0])
def test_what_is_left_is_what_comes_after_the_end(zeta):
    """A floor of high damping dies away within its period: that is no ringing at its end."""
    floor = Chain(np.array([1.5]), np.array([zeta]))
    motion = forcing(make_pulses("sine", a_p=np.array([4.0]), omega_p=np.array([10.0]), cycles=np.ones(1)))
    arrival = floor.arrival(motion, 0.005)
    end = (len(arrival.values) - 1) * arrival.dt
    after = floor.run(motion, end + np.arange(0.0, 3.0, 0.005))
    peak = np.abs(arrival.values).max()
    assert arrival.left == pytest.approx(np.abs(after).max() / peak, rel=0.05)
    assert arrival.left <= RINGS_TO * (1.0 + 1e-6)


def test_a_body_on_a_floor_is_that_of_one_integration_of_both():
    """Floor and block as one system by DOP853, from sample to sample and impact to impact."""
    motion = read_record(RECORD.with_name("synthetic_soil_m70.AT2"))
    a, dt = 0.7 * motion.acceleration(G)[700:1500], motion.dt
    h, b, w, zeta = 1.3, 0.2, 2.0 * np.pi / 0.3, 0.05
    R, alpha = np.hypot(h, b), np.arctan2(b, h)
    p2, eta = 0.75 * G / R, 1.0 - 1.5 * np.sin(alpha) ** 2

    def top(y):
        return -(2.0 * zeta * w * y[1] + w * w * y[0])

    def rates(t, y):
        above = top(y)
        q = side * y[2]
        back = p2 * (np.sin(alpha - q) + side * above / G * np.cos(alpha - q)) if side else 0.0
        return [y[1], above - np.interp(t, times, a), y[3], -side * back]

    def lands(t, y):
        return side * y[2] if side else abs(top(y)) - G * np.tan(alpha)

    lands.terminal = True
    times, y, side, peak = dt * np.arange(len(a)), np.zeros(4), 0.0, 0.0
    for t, end in pairwise(times):
        while t < end:
            lands.direction = -1.0 if side else 1.0
            events = [lands, lambda t, y: y[3]]
            run = solve_ivp(rates, (t, end), y, method="DOP853", rtol=1e-11, atol=1e-14, events=events, max_step=dt / 2)
            peak = max([peak, *(abs(float(turn[2])) for turn in run.y_events[1])])
            t, y = run.t[-1], run.y[:, -1]
            if run.status == 1 and side:
                side, y[2], y[3] = -side, 0.0, eta * y[3]
            elif run.status == 1:
                side = -np.sign(top(y))
    case = {"block": {"h": h, "b": b}, "motion": {"record": {"values": a, "dt": dt, "units": "m/s2"}}}
    case["motion"] |= {"through": [{"T": 0.3, "zeta": zeta}], "duration": float(times[-1])}
    found = rockcli.run(study(case=case))
    assert float(found.theta_peak_over_alpha) == pytest.approx(peak / alpha, abs=1e-7)


def test_short_periods_are_the_ground_and_long_ones_rest_in_space(ground):
    moving = forcing(ground)
    times = ground.dt * np.arange(len(ground.values))
    peak = np.abs(ground.values).max()
    off = [
        np.abs(Chain(np.array([T]), np.array([0.05])).run(moving, times) - ground.values).max() / peak
        for T in (4e-3, 1e-3)
    ]
    assert off[1] < off[0] < 0.05
    assert off[1] < 0.01
    still = [np.abs(Chain(np.array([T]), np.array([0.05])).run(moving, times)).max() / peak for T in (1e2, 1e3, 1e4)]
    assert still[1] == pytest.approx(0.1 * still[0], rel=0.3)  # (2 zeta omega) times the velocity of the ground
    assert still[2] == pytest.approx(0.1 * still[1], rel=0.1)
    assert still[2] < 1e-5


def study(**more):
    base = {
        "name": "through",
        "case": {
            "block": {"h": 0.9, "b": 0.2},
            "motion": {"record": {"file": RECORD.name, "pga": "0.6*g"}},
        },
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }
    return base | more


NAMED = {
    "fixed": None,
    "stiff": [{"T": "1*ms", "zeta": 0.05}],
    "far": [{"T": 1e4, "zeta": 0.05}],
    "floor": [{"f": 3, "zeta": 0.05}],
}


def test_a_body_on_a_stiff_floor_is_one_on_the_ground_and_on_a_soft_one_it_rests(monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    found = rockcli.run(study(vary={"motion.through": NAMED}))
    peak = {name: float(found.theta_peak_over_alpha.sel(through=name)) for name in NAMED}
    assert peak["stiff"] == pytest.approx(peak["fixed"], rel=0.02)
    assert peak["far"] == 0.0
    assert found.pga.sel(through="fixed") == pytest.approx(0.6 * G)
    said = json.loads(found.attrs["processing"])
    assert any(
        "T = 0.333333 s, zeta = 0.05" in sentence and "with its mean over each" in sentence
        for sentence in chain(*said.values())
    )


def test_what_arrives_is_scaled_by_its_own_words(monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    motion = {"record": {"file": RECORD.name}, "through": NAMED["floor"]}
    case = study()["case"]
    of = lambda **more: rockcli.run(study(case=case | {"motion": motion | more}))  # noqa: E731
    assert float(of(floor_pga="0.5*g").pga) == pytest.approx(0.5 * G, rel=1e-12)
    assert float(of(floor_scale=3).pga) == pytest.approx(3.0 * float(of().pga), rel=1e-12)


def test_of_a_record_that_is_zero_throughout_nothing_arrives():
    still = {"values": np.zeros(50), "dt": 0.01, "units": "g"}
    found = rockcli.run(
        study(case={"block": {"h": 0.9, "b": 0.2}, "motion": {"record": still, "through": NAMED["floor"]}})
    )
    assert (found.outcome, found.pga) == (0, 0.0)


def test_a_vertical_record_takes_the_factor_of_what_arrives(monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    case = study()["case"]

    def of(record, **more):
        motion = {
            "record": {"file": RECORD.name} | record,
            "through": NAMED["floor"],
            "vertical": "synthetic_soil_m70.AT2",
        }
        return rockcli.run(study(case=case | {"motion": motion | more}, save={"histories": True}))

    ground, above = of({"scale": 2}), of({}, floor_scale=2)
    for name in ("a_g", "a_v", "theta"):  # the floor is linear
        np.testing.assert_array_equal(above[name], ground[name])
    wanted = of({}, floor_pga=float(ground.pga))
    np.testing.assert_allclose(wanted.a_v, ground.a_v, rtol=1e-12)
    both = of({"scale": 2}, floor_scale=0.5)
    np.testing.assert_array_equal(both.a_v, of({}).a_v)
    said = json.loads(wanted.attrs["processing"])[RECORD.name][-1]
    assert said.startswith("scaled by 2 for floor_pga: ")


def test_pulses_of_many_periods_go_through_one_by_one():
    pulse = {"shape": "ricker", "a_p": "0.5*g", "T_p": 0.5}
    case = {"block": {"h": 0.9, "b": 0.2}, "motion": {"pulse": pulse, "through": NAMED["floor"]}}
    vary = {"motion.pulse.T_p": [0.3, 0.6], "motion.pulse.a_p": ["-0.4*g", "0.4*g", "0.8*g"]}
    found = rockcli.run(study(case=case, vary=vary))
    assert np.allclose(found.pga[:, 0], found.pga[:, 1], rtol=1e-14)
    assert np.allclose(found.pga[:, 2], 2.0 * found.pga[:, 1], rtol=1e-14)
    alone = rockcli.run(
        study(case=case | {"motion": {"pulse": pulse | {"T_p": 0.6, "a_p": "0.8*g"}, "through": NAMED["floor"]}})
    )
    assert float(alone.theta_peak_over_alpha) == float(found.theta_peak_over_alpha[1, 2])
    uncertain = {"let.T": {"uniform": [0.2, 0.5]}}
    through = [{"T": "T", "zeta": 0.05}]
    many = rockcli.run(
        study(
            case=case | {"motion": {"pulse": pulse, "through": through}}, let={"T": 0.3}, uncertain=uncertain, samples=4
        )
    )
    assert len(np.unique(many.pga)) == 4


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ({"through": [{"zeta": 0.05}]}, "neither T nor f"),
        ({"through": [{"T": 1, "f": 1, "zeta": 0.05}]}, "say the same thing"),
        ({"through": [{"T": 1}]}, "no zeta"),
        ({"through": [{"T": -1, "zeta": 0.05}]}, "greater than 0"),
        ({"through": [{"T": 1, "zeta": -0.05}]}, "between 0 and 10"),
        ({"through": [{"T": 1, "zeta": 0.05}], "floor_pga": 1}, "leave one out"),
        ({"floor_scale": 2}, "needs `through"),
        ({"through": [{"T": 1, "zeta": 0.05}], "floor_pga": 1, "floor_scale": 1}, "say the same thing"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_floor_is_said(motion, words, monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    case = study()["case"]
    with pytest.raises(StudyError, match=words):
        open_study(study(case=case | {"motion": case["motion"] | motion}))
    with pytest.raises(StudyError, match="needs a motion of the ground"):
        open_study(study(case={"block": case["block"], "motion": {"through": NAMED["floor"]}}))


@pytest.mark.parametrize("path", ["motion.through.0.T", "motion.through.T"])
def test_one_of_several_floors_is_varied_by_a_symbol(path, monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    for axes in ({"vary": {path: [0.3, 0.4]}}, {"uncertain": {path: {"uniform": [0.3, 0.4]}}}):
        with pytest.raises(StudyError, match=r"inside the list `motion.through`, .* a symbol of `let`"):
            open_study(study(**axes))


@pytest.mark.parametrize("said", [{"t0": 1e9, "T_p": 1.0}, {"t0": 1e30, "T_p": 1.0}, {"T_p": 1e-6}])
def test_more_samples_than_memory_holds_are_refused(said):
    pulse = {"shape": "sine", "a_p": "0.5*g"} | said
    case = {"block": {"R": 2, "alpha": 0.2}, "motion": {"pulse": pulse, "through": [{"T": 0.3, "zeta": 0.05}]}}
    with pytest.raises(StudyError, match=r"case.motion.through: would make .* samples .* at most 1e\+07 are allowed"):
        open_study({"name": "much", "case": case})


@pytest.mark.slow
def test_of_very_many_floors_the_history_tells_some():
    pulse = {"shape": "ricker", "a_p": "0.5*g", "T_p": 0.5}
    case = {"block": {"h": 0.9, "b": 0.2}, "motion": {"pulse": pulse, "through": [{"T": "T", "zeta": 0.05}]}}
    opened = open_study(study(case=case, let={"T": 0.3}, uncertain={"let.T": {"uniform": [0.2, 0.5]}}, samples=30))
    assert len(opened.processing) == 21
    assert opened.processing["ricker pulse (...)"] == ("used in more than 20 ways",)
    (said,) = opened.processing["ricker pulse"]  # nothing of a file, which a pulse has not
    assert said.startswith("through T = ")


def floor_suite(over):
    return {
        "name": "floor-suite",
        "case": {
            "block": {"h": 1.0, "b": 0.25},
            "motion": {"record": {"file": "synthetic_rock_m65.AT2", "pga": 0.1}, "through": [{"f": 4, "zeta": 0.05}]},
        },
        "over": {"axis": "record", "along": "pga"} | over,
        "vary": {
            "motion.record.file": ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2"],
            "motion.record.pga": {"from": "0.1*g", "to": "0.4*g", "n": 4},
        },
        "save": {"histories": False},
    }


def test_an_intensity_of_what_arrives_is_said_not_to_be_the_grounds():
    study = floor_suite({"intensity": "sa(1)"})
    said = "is that of the motion that arrives"
    assert any("the intensity sa(1) " + said in one for one in json.loads(rockcli.run(study).attrs["warnings"]))
    study["over"] = {"axis": "record", "along": "pga"}
    assert not any(said in one for one in json.loads(rockcli.run(study).attrs["warnings"]))
    del study["case"]["motion"]["through"]
    study["over"]["intensity"] = "sa(1)"
    assert not any(said in one for one in json.loads(rockcli.run(study).attrs["warnings"]))


@pytest.mark.parametrize("name", ["pgv", *(pytest.param(name, marks=pytest.mark.slow) for name in ("sa(1)", "pga"))])
def test_an_intensity_of_the_ground_is_that_of_the_same_motion_without_floors(name):
    found = rockcli.run(floor_suite({"intensity": f"ground_{name}"}))
    assert not any("motion that arrives" in one for one in json.loads(found.attrs["warnings"]))
    plain = floor_suite({"intensity": name})
    del plain["case"]["motion"]["through"]
    want = rockcli.run(plain)
    told = want[name] if name in want else want["fragility_intensity"]
    there = found["fragility_intensity"]
    np.testing.assert_allclose(there.values, told.broadcast_like(there).values, rtol=1e-12)
    assert found["fragility_intensity"].attrs["units"] == told.attrs["units"]
    arrives = rockcli.run(floor_suite({"intensity": name}))
    above = arrives[name] if name in arrives else arrives["fragility_intensity"]
    assert (np.abs(above.broadcast_like(there).values / there.values - 1.0) > 0.01).all()


def test_the_ground_of_a_pulse_and_of_what_is_scaled_itself():
    pulse = {"shape": "ricker", "a_p": 1.0, "T_p": 0.5}
    motion = {"pulse": pulse, "through": [{"T": 0.3, "zeta": 0.05}]}
    study = {
        "name": "pulses",
        "case": {"block": {"h": 0.9, "b": 0.2}, "motion": motion},
        "over": {"axis": "T_p", "along": "a_p", "intensity": "ground_pga"},
        "vary": {"motion.pulse.T_p": [0.4, 0.7], "motion.pulse.a_p": [1.0, 2.0, 3.0]},
        "save": {"histories": False},
    }
    found = rockcli.run(study)
    np.testing.assert_allclose(found["fragility_intensity"].values, [[1.0, 2.0, 3.0]] * 2, rtol=1e-12)
    motion["floor_scale"] = 2.0
    assert (np.diff(rockcli.run(study)["pga"].values / found["pga"].values) == 0.0).all()
    np.testing.assert_allclose(rockcli.run(study)["fragility_intensity"].values, [[2.0, 4.0, 6.0]] * 2, rtol=1e-12)


@pytest.mark.parametrize(
    "below",
    [{"record": {"file": RECORD.name, "pga": 1.0}}, {"pulse": {"shape": "ricker", "a_p": 1.0, "T_p": 0.5}}],
)
def test_some_of_the_cases_keep_the_ground_that_is_theirs(below, monkeypatch):
    monkeypatch.chdir(RECORD.parent)
    path = "record.pga" if "record" in below else "pulse.a_p"
    case = {"block": {"h": 0.9, "b": 0.2}, "motion": below | {"through": NAMED["floor"]}}
    opened = open_study(study(case=case, vary={f"motion.{path}": [1.0, 2.0, 3.0]}))
    ((_, batch),) = opened.batches(np.arange(3))
    some, few = batch.excitation.horizontal, batch.rows(np.array([2, 0])).excitation.horizontal
    t = np.array([0.4, 0.5, 0.6])
    for one, three in ((few, some), (few.ground, some.ground)):
        np.testing.assert_array_equal(acceleration(one, t, 0), acceleration(three, t, 2))
        np.testing.assert_array_equal(acceleration(one, t, 1), acceleration(three, t, 0))


def test_a_hazard_curve_of_the_ground_goes_with_an_intensity_of_the_ground():
    curve = {"label": "site", "intensity": ["0.01*g", "0.3*g", "3*g"], "rate": [0.1, 1e-3, 1e-6]}
    study = floor_suite({"intensity": "ground_sa(1)"}) | {"hazard": [curve]}
    assert open_study(study).over.hazard[0].intensity[1] == pytest.approx(0.3 * G)
    with pytest.raises(StudyError, match=r"ground_pga, ground_pgv, ground_sa\(T\)"):
        open_study(floor_suite({"intensity": "ground_arias"}))
