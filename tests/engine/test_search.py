"""What a search makes of a scan and of a suite: against plain loops, against dense scans, against closed forms."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest
import xarray
from scenes import G

import rockcli
from rockcli.engine.search.search import thresholds_of
from rockcli.scene.response import (
    FAILED,
    NO_UPLIFT,
    OVERTURNED_AFTER_IMPACT,
    OVERTURNED_WITHOUT_IMPACT,
    ROCKING,
    SLIDING,
    UNRESOLVED,
)
from rockcli.scene.thresholds import BELOW, BESIDE, BRACKETED, IN_RANGE, NONE, Thresholds
from rockcli.scene.uncertain.statistics import fractile

A_P = "motion_pulse_a_p_overturning"
ONE_SINE = {"lower": 3.0185998608717963664, "upper": 6.3180705298274460929, "again": 7.168}
"""a_p/(g alpha) of the linearized block, omega_p/p = 5, eta 0.9: the first band, and where the second begins."""


STANDS = (NO_UPLIFT, ROCKING, SLIDING)
FALLS = (OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT)


def by_loop(points: list[float], verdicts: list[int]) -> tuple[int, float, float, int, float, float, int]:
    """State, low, high, islands with their ends, and whether it rocks at first, of a scan read from the lowest up."""
    low, high, state = -np.inf, np.inf, NONE
    for point, verdict in zip(points, verdicts, strict=True):
        if verdict in FALLS:
            high = point
            state = BRACKETED if state == BRACKETED else BELOW if low == -np.inf else IN_RANGE
            break
        if verdict in (FAILED, UNRESOLVED):
            state = BRACKETED
        elif state != BRACKETED:
            low = point
    above = [verdict if point > high else None for point, verdict in zip(points, verdicts, strict=True)]
    stable = [point for point, verdict in zip(points, above, strict=True) if verdict in STANDS]
    islands = sum(a in STANDS and b not in STANDS for a, b in zip(above, [None, *above[:-1]], strict=True))
    return state, low, high, islands, min(stable, default=np.nan), max(stable, default=np.nan), verdicts[0] == ROCKING


def test_every_scan_of_five_points_is_read_as_a_loop_reads_it():
    points = [1.0, 1.5, 2.0, 4.0, 7.0]
    scans = np.stack(np.meshgrid(*[range(FAILED, SLIDING + 1)] * 5, indexing="ij"), axis=-1).reshape(-1, 5)
    found = thresholds_of(np.array(points), scans.astype(np.int8))
    expected = np.array([by_loop(points, scan.tolist()) for scan in scans])
    parts = (
        found.state,
        found.low,
        found.high,
        found.islands,
        found.island_low,
        found.island_high,
        found.rocks_at_lowest,
    )
    np.testing.assert_array_equal(np.column_stack(parts), expected)


def sine(span: dict, **case) -> dict:
    pulse = {"shape": "sine", "a_p": 1.0, "omega_p": "5*p"}
    block = {"R": 2.0, "tan_alpha": 0.2}
    damping = {"scheme": "restitution", "eta": 0.9}
    base = {"block": block, "motion": {"pulse": pulse}, "model": "linearized", "damping": damping}
    return {"name": "sine", "case": base | case, "vary": {"motion.pulse.a_p": span | {"find": "overturning"}}}


def in_units(a: float) -> float:
    """a_p [m/s2] of a_p/(g alpha)."""
    return a * G * float(np.arctan(0.2))


@pytest.mark.parametrize(("start", "end"), [(1.0, 12.0), (12.0, 1.0), (2.5, 6.0), (6.0, 2.5)])
def test_the_lowest_threshold_whichever_side_the_range_is_written_from(start, end):
    found = rockcli.run(sine({"from": in_units(start), "to": in_units(end), "n": 45}))
    assert float(found[A_P]) == pytest.approx(in_units(ONE_SINE["lower"]), rel=1.1e-6)
    assert int(found[f"{A_P}_state"]) == IN_RANGE
    assert float(found[f"{A_P}_low"]) < in_units(ONE_SINE["lower"]) <= float(found[f"{A_P}_high"])
    if 12.0 in (start, end):  # it remains stable between the two bands
        assert int(found[f"{A_P}_islands"]) == 1
        low, high = (float(found[f"{A_P}_island_{side}"]) for side in ("low", "high"))
        assert in_units(ONE_SINE["upper"]) < low <= high < in_units(ONE_SINE["again"])
        assert "lower" not in str(found.attrs)
    else:
        assert int(found[f"{A_P}_islands"]) == 0
        assert np.isnan(found[f"{A_P}_island_low"])


@pytest.mark.parametrize(("start", "end"), [(4.0, 12.0), (12.0, 4.0)])
def test_a_range_whose_lowest_point_overturns_is_above_the_threshold(start, end):
    """4 g alpha lies inside the first band; a scan from there would meet the second one."""
    found = rockcli.run(sine({"from": in_units(start), "to": in_units(end), "n": 33}))
    assert np.isnan(found[A_P])
    assert int(found[f"{A_P}_state"]) == BELOW
    assert float(found[f"{A_P}_low"]) == -np.inf
    assert float(found[f"{A_P}_high"]) == pytest.approx(in_units(4.0), rel=1e-12)
    assert int(found[f"{A_P}_islands"]) == 1
    assert found[f"{A_P}_state"].attrs["flag_meanings"].split()[BELOW] == "below_range"


def test_a_range_below_the_threshold_has_none():
    found = rockcli.run(sine({"from": in_units(0.5), "to": in_units(3.0), "n": 6}))
    assert float(found[A_P]) == np.inf == float(found[f"{A_P}_high"])
    assert int(found[f"{A_P}_state"]) == NONE
    assert float(found[f"{A_P}_low"]) == pytest.approx(in_units(3.0), rel=1e-12)


def random_scenes() -> Iterator[tuple[str, dict, bool]]:
    """Name, case with the ends of its range, and whether that is written from above: two edges, friction, neither.

    Linearized bodies with friction have no answer where they would slide.
    """
    rng = np.random.default_rng(11)
    shapes = ["ricker", "sine", "cosine", "half_sine", "ricker_antisymmetric"]
    for i in range(12):
        h = float(rng.uniform(0.5, 3.0))
        b = [float(h * x) for x in rng.uniform(0.12, 0.35, 2)]
        block: dict = {"h": h, "b": b if i % 3 == 0 else b[0]}
        if i % 3 == 1:
            block["mu"] = float(b[0] / h * rng.uniform(1.05, 1.6))
        p = np.sqrt(0.75 * G / np.hypot(h, min(b)))
        pulse = {"shape": shapes[i % 5], "a_p": 1.0, "omega_p": float(p * rng.uniform(2.0, 6.0))}
        level = G * min(b) / h
        model = "linearized" if i % 6 == 1 else "rigid"
        case = {"block": block, "motion": {"pulse": pulse}, "model": model}
        kind = ("two edges", "friction", "plain")[i % 3]
        yield (
            f"{i} {kind}",
            case | {"low": float(level * rng.uniform(0.8, 2.5)), "high": float(level * 9.0)},
            i % 2 == 1,
        )


SCENES = {name: (case, turned) for name, case, turned in random_scenes()}


@cache
def searched(name: str) -> tuple[dict, dict, xarray.Dataset]:
    """The case of a random scene, its range, and what a search along it finds."""
    case, turned = SCENES[name]
    case = dict(case)
    low, high = case.pop("low"), case.pop("high")
    span = {"from": high if turned else low, "to": low if turned else high, "n": 60}
    study = {"name": "s", "case": case, "vary": {"motion.pulse.a_p": span | {"find": "overturning"}}}
    return case, span, rockcli.run(study)


@pytest.mark.parametrize("name", SCENES)
def test_against_a_dense_scan(name):
    """The same values as an axis: the state, bracket and islands as a loop reads them; the value flips the outcome."""
    case, span, found = searched(name)
    save = {"histories": False, "scalars": ["outcome"]}
    scan = rockcli.run({"name": "s", "case": case, "vary": {"motion.pulse.a_p": span}, "save": save})
    values = scan["motion_pulse_a_p"].values
    order = np.argsort(values)
    flags = scan["outcome"].values[order].tolist()
    state, low, high, *beside = by_loop(values[order].tolist(), flags)
    assert int(found[f"{A_P}_state"]) == state
    np.testing.assert_array_equal([float(found[f"{A_P}_{part}"]) for part in BESIDE], beside)
    if state != IN_RANGE:
        assert (float(found[f"{A_P}_low"]), float(found[f"{A_P}_high"])) == (low, high)
        assert float(found[A_P]) == np.inf if state == NONE else np.isnan(found[A_P])
        return
    ends = [float(found[f"{A_P}_low"]), float(found[A_P])]
    assert low <= ends[0] < ends[1] <= high
    assert ends[1] - ends[0] <= 1e-6 * ends[1]
    flags = rockcli.run({"name": "s", "case": case, "vary": {"motion.pulse.a_p": ends}, "save": save})["outcome"].values
    assert flags[0] in (0, 1, 4)
    assert flags[1] in (2, 3)


def test_the_random_scenes_show_what_they_are_for():
    """Thresholds with two edges, friction and neither; points without an answer under friction; islands."""
    found = {(name.split()[1], int(searched(name)[2][f"{A_P}_state"])) for name in SCENES}
    assert {("two", IN_RANGE), ("plain", IN_RANGE), ("friction", IN_RANGE), ("friction", BRACKETED)} <= found
    assert any(int(searched(name)[2][f"{A_P}_islands"]) for name in SCENES)


def test_a_point_without_an_answer_in_the_bisection_ends_it(monkeypatch):
    """The scan is answered, but a value inside the last bracket is not."""
    from rockcli.engine.search import search

    right, calls = search.answers, []

    def forgetful(*given):
        calls.append(given)
        for rows, answer in right(*given):
            if len(calls) >= 4:
                answer.scalars["outcome"][...] = UNRESOLVED
            yield rows, answer

    monkeypatch.setattr(search, "answers", forgetful)
    found = rockcli.run(sine({"from": in_units(1.0), "to": in_units(6.0), "n": 6}))
    assert int(found[f"{A_P}_state"]) == BRACKETED
    assert np.isnan(found[A_P])
    low, high = (float(found[f"{A_P}_{side}"]) for side in ("low", "high"))
    assert low < in_units(ONE_SINE["lower"]) <= high
    assert high - low < in_units(1.0)


class TestSuites:
    """Fractiles of members that lie in the range, above it, below it, or are only bracketed."""

    @pytest.mark.parametrize("seed", range(40))
    def test_the_true_fractile_lies_in_the_bracket_and_is_found_where_it_can_be(self, seed):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(1, 12))
        truth = rng.uniform(0.0, 10.0, n)
        first, last = sorted(rng.uniform(0.0, 10.0, 2))
        state = np.where(truth <= first, BELOW, np.where(truth > last, NONE, IN_RANGE))
        low = np.where(state == BELOW, -np.inf, np.where(state == NONE, last, truth))
        high = np.where(state == BELOW, first, np.where(state == NONE, np.inf, truth))
        lost = rng.random(n) < 0.2
        state = np.where(lost, BRACKETED, state)
        low, high = np.where(lost, truth - rng.uniform(0.0, 2.0, n), low), np.where(lost, truth + 1.0, high)
        members = Thresholds(state.astype(np.int8), low, high)
        for q in (0.16, 0.5, 0.84):
            exact = float(fractile(truth, q, 0))
            found = members.reduced(lambda values, q=q: fractile(values, q, 0))
            assert found.low <= exact <= found.high
            if found.state == IN_RANGE:
                assert float(found.value) == exact
            # every other set of values the members may have: the fractile is known if and only if all agree
            others = [np.where(state == IN_RANGE, high, np.where(up, np.minimum(high, 99.0), np.maximum(low, -99.0)))
                      for up in (True, False)]  # fmt: skip
            assert (found.state == IN_RANGE) == (fractile(others[0], q, 0) == fractile(others[1], q, 0))

    def test_what_is_censored_and_why(self):
        def fractiles(state, low, high):
            members = Thresholds(np.array(state, dtype=np.int8), np.array(low, float), np.array(high, float))
            return [members.reduced(lambda values, q=q: fractile(values, q, 0)) for q in (0.16, 0.5, 0.84)]

        inf, nan = np.inf, np.nan
        p16, p50, p84 = fractiles([BELOW, BELOW, IN_RANGE, NONE, NONE], [-inf, -inf, 3, 9, 9], [1, 1, 3, inf, inf])
        assert (p16.state, p50.state, p84.state) == (BELOW, IN_RANGE, NONE)
        np.testing.assert_array_equal([p16.value, p50.value, p84.value], [nan, 3.0, inf])
        assert (p16.low, p16.high) == (-inf, 1.0)
        assert (p84.low, p84.high) == (9.0, inf)
        p16, p50, p84 = fractiles([IN_RANGE, IN_RANGE, BRACKETED, NONE], [2, 3, 5, 9], [2, 3, 7, inf])
        assert (p16.state, p50.state, p84.state) == (IN_RANGE, BRACKETED, NONE)
        assert (p50.low, p50.high) == (4.0, 5.0)
        p16, p50, p84 = fractiles([BELOW, NONE], [-inf, 9], [1, inf])  # between below and above: nothing is known
        assert p50.state == BRACKETED
        assert np.isnan(p50.value)
        assert (p50.low, p50.high) == (-inf, inf)

    def test_a_range_that_begins_too_high_gives_the_same_fractiles_or_says_that_it_cannot(self):
        """Half sines of nine frequencies, whose thresholds are known and which have no islands."""
        omegas = np.linspace(1.0, 6.0, 9).tolist()

        def suite(start):
            case = {
                "block": {"R": 0.75 * G, "alpha": 0.1},
                "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 1.0}},
                "model": "linearized",
            }
            span = {"from": start, "to": 4.5, "n": 30, "find": "overturning"}
            vary = {"motion.pulse.omega_p": omegas, "motion.pulse.a_p": span}
            return rockcli.run({"name": "s", "case": case, "over": "motion.pulse.omega_p", "vary": vary})

        low, high = suite(0.5), suite(1.6)
        assert (low[f"{A_P}_state"] == BELOW).sum() == 0 < (high[f"{A_P}_state"] == BELOW).sum()
        exact = low[A_P].values
        assert int(high["n_answered"]) == 9
        for end, q in (("p16", 0.16), ("p50", 0.5), ("p84", 0.84)):
            assert float(low[f"{A_P}_{end}"]) == pytest.approx(float(fractile(exact, q, 0)), rel=1e-12)
            if int(high[f"{A_P}_state_{end}"]) == IN_RANGE:
                assert float(high[f"{A_P}_{end}"]) == pytest.approx(float(low[f"{A_P}_{end}"]), rel=2e-6)
            else:
                assert np.isnan(high[f"{A_P}_{end}"])
                assert float(low[f"{A_P}_{end}"]) <= float(high[f"{A_P}_high_{end}"])
        states = [int(high[f"{A_P}_state_{end}"]) for end in ("p16", "p50", "p84")]
        assert states == [BELOW, IN_RANGE, IN_RANGE]
        said = json.loads(high.attrs["ensemble"])["says"]
        assert any("16th percentile: censored: at most " in line for line in said)

    def test_a_member_without_an_answer_is_not_dropped(self):
        """Of three blocks one needs more friction than it has: the others' median is not that of the suite."""
        case = {
            "block": {"R": 2.0, "tan_alpha": 0.2, "mu": 0.9},
            "motion": {"pulse": {"shape": "sine", "a_p": 1.0, "omega_p": "4*p"}},
            "model": "linearized",
        }
        span = {"from": 1.0, "to": 12.0, "n": 30, "find": "overturning"}
        study = {
            "name": "s",
            "case": case,
            "over": {"axis": "block.mu", "mean": True},
            "vary": {"block.mu": [0.21, 0.8, 0.9], "motion.pulse.a_p": span},
        }
        found = rockcli.run(study)
        assert found[f"{A_P}_state"].values.tolist() == [BRACKETED, IN_RANGE, IN_RANGE]
        assert int(found["n_answered"]) == 2
        alone = float(found[A_P][1])
        assert float(found[A_P][2]) == alone
        assert int(found[f"{A_P}_state_p84"]) in (IN_RANGE, BRACKETED)
        assert float(found[f"{A_P}_low_p50"]) <= alone <= float(found[f"{A_P}_high_p50"])
        assert int(found[f"{A_P}_state_mean"]) == BRACKETED
        assert np.isnan(found[f"{A_P}_mean"])
        (warning,) = (w for w in json.loads(found.attrs["warnings"]) if "without an answer" in w)
        assert warning.startswith("1 of 3 searches")


@pytest.mark.parametrize(("low", "intensity"), [(0.0, None), (-0.1 * G, None), (0.0, "pgv")])
def test_fragility_of_a_range_from_zero_is_that_of_one_above_it(low, intensity):
    """At an amplitude of 0 no motion says where it lifts a body, and turned round it is another one."""
    pulse = {"shape": "sine", "a_p": 1.0, "T_p": 1.0}
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}
    over = {"axis": "T_p"} | ({} if intensity is None else {"intensity": intensity})
    found = {}
    for begin in (low, 0.05 * G):
        span = {"from": begin, "to": 5.0 * G, "n": 60, "find": "overturning"}
        vary = {"motion.pulse.T_p": {"from": 0.5, "to": 2.0, "n": 12}, "motion.pulse.a_p": span}
        found[begin] = rockcli.run({"case": case, "vary": vary, "over": over})
        warned = "begins below 0, and the lowest value" in found[begin].attrs["warnings"]
        assert warned is (begin < 0.0)
    one, other = found.values()
    np.testing.assert_allclose(one[A_P], other[A_P], rtol=3e-6)
    for name in ("fragility_begins_at", "fragility_intensity", "fragility_percentile"):
        np.testing.assert_allclose(one[name], other[name], rtol=3e-6)
    if intensity is None:
        assert float(one["fragility_begins_at"]) == pytest.approx(0.2 * G)


def test_a_motion_turned_round_is_searched_along_a_symbol():
    """About two edges of .3 and .2: the lowest amplitude to one side is that of the mirrored body to the other."""
    found = []
    for edges, a_p in (([0.3, 0.2], "-k"), ([0.2, 0.3], "k"), ([0.3, 0.2], "k")):
        motion = {"pulse": {"shape": "half_sine", "a_p": a_p, "T_p": 1.0}}
        vary = {"let.k": {"from": 0.0, "to": 2.0 * G, "n": 21, "find": "overturning"}}
        case = {"block": {"h": 1.0, "b": edges}, "motion": motion}
        found.append(float(rockcli.run({"let": {"k": 1}, "case": case, "vary": vary})["k_overturning"]))
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert abs(found[0] / found[2] - 1.0) > 0.05
