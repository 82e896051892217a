"""Rules of thumb and code checks against hand calculations, independent spectra and the solver itself."""

from __future__ import annotations

import numpy as np
import pytest
from reference import oscillator
from scipy.optimize import brentq

from rockcli.analysis.rules import misled
from rockcli.engine.run import check_answers, solve
from rockcli.engine.summary import report_on
from rockcli.errors import StudyError
from rockcli.motion.spectrum import Array, Forcing, displacement_spectrum
from rockcli.scene import rules
from rockcli.storage.contents import Contents
from rockcli.study.open import open_study

G = 9.81


def study(**more: object) -> dict[str, object]:
    return {
        "name": "ruled",
        "case": {
            "block": {"R": 2.0, "tan_alpha": 0.2},
            "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 3.0, "f_p": 2.0}},
        },
        "save": {"histories": False},
        "rules": ["west", "ishiyama", "housner", "asce43"],
    } | more


def solved(**more: object) -> Contents:
    return solve(open_study(study(**more)))


@pytest.mark.parametrize(("start", "end"), [(1.5, 6.0), (6.0, 1.5)])
def test_of_a_search_rules_and_pga_are_those_of_the_lowest_point(start: float, end: float) -> None:
    span = {"from": start, "to": end, "n": 4, "find": "overturning"}
    found = solved(vary={"motion.pulse.a_p_over_g_tan_alpha": span}, rules=["west"])
    assert float(found.values("west_ratio")) == pytest.approx(1.5, rel=1e-12)
    assert float(found.values("pga")) == pytest.approx(1.5 * 0.2 * G, rel=1e-12)
    for name, attribute in (("west_ratio", "comment"), ("pga", "long_name")):
        assert "at the lowest point of the range searched" in found.fields[name].attrs[attribute]


def test_the_standard_s_own_example() -> None:
    # b = .3 m, h = 1.5 m, theta_0 = .05: .350 g, .914 Hz, 1.9 %
    S_a, f = rules.asce43_capacity(np.array([0.05]), 1.5, 0.2, 4.0 / 3.0, G)
    assert S_a[0] / G == pytest.approx(0.350, abs=5e-4)
    assert f[0] == pytest.approx(0.914, abs=5e-4)
    assert rules.asce43_damping(0.2, 4.0 / 3.0) == pytest.approx(0.019, abs=5e-4)


def test_capacity_starts_at_uplift_and_the_oscillator_has_the_block_s_energy() -> None:
    S_a, f = rules.asce43_capacity(np.array([1e-9]), 1.0, 0.3, 4.0 / 3.0, G)
    assert S_a[0] == pytest.approx(2.0 * 0.3 * G, rel=1e-6)  # so in the standard: a linear spring of equal energy
    theta = np.array([0.1])
    S_a, f = rules.asce43_capacity(theta, 1.0, 0.3, 4.0 / 3.0, G)
    R, alpha = np.hypot(1.0, 0.3), np.arctan(0.3)
    I_O = 4.0 / 3.0 * R**2
    lifted = G * R * (np.cos(alpha - theta) - np.cos(alpha))
    assert 0.5 * I_O * (2.0 * np.pi * f * theta) ** 2 == pytest.approx(lifted, rel=1e-12)


@pytest.mark.parametrize("tan_alpha", [0.1, 0.3])
def test_the_impulsive_velocity_overturns(tan_alpha: float) -> None:
    # a rectangular pulse so short and strong that it is a velocity step
    R, alpha = 2.0, np.arctan(tan_alpha)
    V = float(rules.impulsive_velocity(np.array(R), np.array(alpha), np.array(4.0 / 3.0), np.array(G)))
    short = 1e-5
    body = {"R": R, "tan_alpha": tan_alpha}
    for factor, falls in ((0.999, False), (1.001, True)):
        pulse = {"shape": "rectangular", "a_p": factor * V / short, "T_p": 2.0 * short}
        contents = solved(case={"block": body, "motion": {"pulse": pulse}}, rules=["ishiyama"])
        assert (int(contents.values("outcome")) >= 2) is falls
        assert float(contents.values("ishiyama_ratio")) == pytest.approx(factor / rules.ISHIYAMA_FACTOR, rel=1e-6)


def spectral_displacement(f: float, zeta: float, a_p: float) -> float:
    """Of one sine cycle of 2 Hz, by integration."""
    return oscillator([(0.5, lambda t: a_p * np.sin(4.0 * np.pi * t))], 1.0 / f, zeta, rtol=1e-7, atol=1e-10)


def test_asce43_meets_an_integrated_spectrum() -> None:
    contents = solved(rules=["asce43"])
    alpha, a_p, h = np.arctan(0.2), 3.0 * 0.2 * G, 2.0 * np.cos(np.arctan(0.2))
    beta = rules.asce43_damping(0.2, 4.0 / 3.0)

    def excess(theta: float) -> float:
        S_a, f = rules.asce43_capacity(np.array([theta]), h, 0.2, 4.0 / 3.0, G)
        return (2.0 * np.pi * f[0]) ** 2 * spectral_displacement(f[0], beta, a_p) - S_a[0]

    found = float(contents.values("asce43_theta_over_alpha"))
    assert 0.0 < found < 1.0
    assert brentq(excess, 0.5 * found * alpha, min(2.0 * found, 1.0) * alpha, rtol=1e-6) == pytest.approx(
        found * alpha, rel=3e-3
    )


def test_housner_of_an_integrated_spectrum() -> None:
    contents = solved(rules=["housner"])
    periods = np.linspace(0.1, 2.5, 25)
    each = np.array([2.0 * np.pi / T * spectral_displacement(1.0 / T, 0.05, 3.0 * 0.2 * G) for T in periods])
    S_v = np.mean(0.5 * (each[1:] + each[:-1]))
    p = np.sqrt(0.75 * G / 2.0)
    assert float(contents.values("housner_ratio")) == pytest.approx(p * S_v / (G * np.arctan(0.2)), rel=0.01)


def test_no_uplift_and_falling_for_certain() -> None:
    vary = {"motion.pulse.a_p_over_g_tan_alpha": [0.9, 3.0, 60.0]}
    contents = solved(vary=vary)
    assert contents.values("west_ratio") == pytest.approx([0.9, 3.0, 60.0])
    theta = contents.values("asce43_theta_over_alpha")
    assert theta[0] == 0.0
    assert theta[2] == np.inf
    assert list(contents.values("outcome") >= 2) == [False, False, True]


def test_how_often_a_rule_misleads_is_counted_and_said() -> None:
    from rockcli.cli.words import report_text

    vary = {"motion.pulse.a_p_over_g_tan_alpha": [0.9, 3.0, 60.0]}
    opened = open_study(study(vary=vary))
    contents = solve(opened)
    counted = {m.name: m for m in misled(contents)}
    assert (counted["west"].cases, counted["west"].unconservative, counted["west"].false_alarms) == (3, 0, 1)
    report = report_on(opened, contents, status="solved")
    assert "west: 0 unconservative" in report_text(report)
    row = report.as_dict()["rules"][0]
    assert (row["unconservative"], row["false_alarms"]) == (row["unsafe"], row["wary"]) == (0, 1)


def test_free_rocking_has_no_rule_and_too_many_cases_are_refused() -> None:
    free = {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.05}}
    contents = solved(case=free)
    assert np.isnan(contents.values("asce43_theta_over_alpha"))
    assert misled(contents)[0].cases == 0
    many = study(vary={"motion.pulse.f_p": {"from": 0.1, "to": 1.0, "n": 30_000}})
    with pytest.raises(StudyError, match="at most 20000 cases"):
        check_answers(open_study(many))


def test_rules_can_be_expected_and_are_redrawn_without_solving() -> None:
    with_rules, without = open_study(study()), open_study(study(rules=[]))
    assert with_rules.identity == without.identity
    clause = {"quantity": "west_ratio", "value": 3.0}
    report = report_on(open_study(study(expect=[clause])), solved(), status="solved")
    assert report.verdicts[0].passed


def test_fema356_is_that_of_the_damping_scheme() -> None:
    # the thesis's block of R = 5 m, tan(alpha) 0.1 under a Ricker pulse: theta/alpha .3508 by its own procedure
    case = {
        "block": {"R": 5.0, "tan_alpha": 0.1},
        "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.6, "omega_p": "2*pi"}},
    }
    asked = solved(case=case, rules=["fema356"]).values("fema356_theta_over_alpha")
    assert float(asked) == pytest.approx(0.3508, abs=1e-4)
    falls = solved(vary={"motion.pulse.a_p_over_g_tan_alpha": [0.9, 60.0]}, rules=["fema356"])
    assert falls.values("fema356_theta_over_alpha").tolist() == [0.0, np.inf]


SPECTRUM = {"periods": [0.02, 0.1, 0.2, 0.5, 1.0, 2.0, 8.0], "S_a": [0.4, 0.9, 1.2, 1.0, 0.4, 0.1, 0.01], "units": "g"}


def test_sliding_under_a_velocity_is_what_friction_takes_of_it() -> None:
    """On a spectrum of constant velocity V the standard's distance is V²/c_s, the way to rest from V at mu g."""
    V, mu = 0.8, 0.25
    T = np.geomspace(0.05, 50.0, 4000)
    found = rules.asce43_slide(T, 2.0 * np.pi * V / T, 2.0 * mu * G)
    assert found == pytest.approx(V**2 / (2.0 * mu * G), rel=1e-5)
    assert rules.asce43_slide(T, 0.1 * np.ones(4000), 2.0 * mu * G) == 0.0
    assert np.isnan(rules.asce43_slide(T, 9.0 * np.ones(4000), 2.0 * mu * G))
    assert rules.asce43_friction(np.array(0.5), np.array(0.5 * G), np.array(G)) == pytest.approx(0.4)


def test_sliding_on_the_spectrum_of_the_motion() -> None:
    motion = {
        "pulse": {"shape": "sine", "a_p": "0.6*g", "f_p": 2.0},
        "vertical": {"pulse": {"shape": "sine", "a_p": "0.3*g", "f_p": 5.0}},
    }
    case = {"block": {"R": 2.0, "tan_alpha": 0.4, "mu": 0.2}, "motion": motion}
    contents = solved(case=case, vary={"block.mu": [0.2, 0.3, 0.7]}, rules=["asce43_sliding"])
    found = contents.values("asce43_slide")
    assert contents.fields["asce43_slide"].attrs["units"] == "m"
    assert contents.fields["asce43_slide"].attrs["edition"] == "ASCE/SEI 43-05"
    assert found[2] == 0.0  # 0.7 (1 - 0.4 0.3) is above 0.6
    # by an integrated oscillator at the frequency it says
    for mu, slide in zip([0.2, 0.3], found[:2], strict=True):
        c_s = 2.0 * mu * (1.0 - 0.4 * 0.3) * G
        f = np.sqrt(c_s / slide) / (2.0 * np.pi)
        S_a = (2.0 * np.pi * f) ** 2 * spectral_displacement(f, 0.1, 0.6 * G)
        assert S_a == pytest.approx(c_s, rel=0.01)
    (counted,) = misled(contents)
    slid = contents.values("slide_peak")
    assert (slid[:2] > 0.0).all()
    assert slid[2] == 0.0  # it rocks
    assert (slid < found).tolist() == [True, True, False]
    assert (counted.cases, counted.unconservative, counted.false_alarms) == (3, 0, 0)
    weak = {"periods": [0.02, 1.0, 8.0], "S_a": [0.01, 0.01, 0.001], "units": "g"}
    (counted,) = misled(
        solved(case=case, vary={"block.mu": [0.2, 0.3, 0.7]}, rules=["asce43_sliding"], rules_spectrum=weak)
    )
    assert (counted.cases, counted.unconservative, counted.false_alarms) == (3, 2, 0)  # no slide by the rule
    assert np.isnan(solved(rules=["asce43_sliding"]).values("asce43_slide"))  # no friction is given


def test_a_given_floor_spectrum_takes_the_place_of_the_motion() -> None:
    """Rocking and sliding by hand on the table, without any motion; rules that do not take it have no answer."""
    g = G
    free = {"block": {"h": 1.5, "b": 0.3, "mu": 0.1}, "initial": {"theta": 0.02}}
    contents = solved(case=free, rules=["west", "asce43", "asce43_sliding"], rules_spectrum=SPECTRUM)
    assert np.isnan(contents.values("west_ratio"))
    assert all(rule.cases == 0 for rule in misled(contents))  # no history is of the motion that the spectrum is of
    T, S_a = np.array(SPECTRUM["periods"]), g * np.array(SPECTRUM["S_a"])
    # sliding: 2 mu g = 0.2 g at two thirds of the way from 1 to 2 s
    assert contents.values("asce43_slide") == pytest.approx(0.2 * g * (5.0 / 3.0 / (2.0 * np.pi)) ** 2, rel=1e-9)
    # rocking: capacity and demand meet where it says
    theta = float(contents.values("asce43_theta_over_alpha")) * np.arctan(0.2)
    capacity, f = rules.asce43_capacity(np.array([theta]), 1.5, 0.2, 4.0 / 3.0, g)
    assert np.interp(1.0 / f, T, S_a) == pytest.approx(capacity, rel=2e-3)
    for name in ("asce43_slide", "asce43_theta_over_alpha"):
        assert "given by the study" in contents.fields[name].attrs["spectrum"]
    with_it, without = (open_study(study(**more)) for more in ({"rules_spectrum": SPECTRUM}, {}))
    assert with_it.identity == without.identity


def test_a_given_floor_spectrum_in_g_is_in_that_of_the_case() -> None:
    """2 mu g = 0.2 g at two thirds of the way from 1 to 2 s, whatever g is."""
    free = {"block": {"h": 1.5, "b": 0.3, "mu": 0.1}, "initial": {"theta": 0.02}}
    more = {"rules": ["asce43", "asce43_sliding"], "rules_spectrum": SPECTRUM}
    contents = solved(case=free, vary={"g": [1.62, G]}, **more)
    by_hand = 0.2 * np.array([1.62, G]) * (5.0 / 3.0 / (2.0 * np.pi)) ** 2
    assert contents.values("asce43_slide") == pytest.approx(by_hand, rel=1e-9)
    in_si = {"units": "m/s²", "S_a": [1.62 * value for value in SPECTRUM["S_a"]]}
    same = solved(case=free | {"g": 1.62}, **more | {"rules_spectrum": SPECTRUM | in_si})
    theta = "asce43_theta_over_alpha"
    assert contents.values(theta)[0] == pytest.approx(same.values(theta), rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"periods": [0.1, 0.2]}, "7 values for 2 periods"),
        ({"periods": [0.1] * 7}, "must ascend"),
        ({"S_a": [0.0] * 7}, "above zero"),
        ({"S_v": 1.0}, "S_v"),
        ({"S_a": ["0.4*m/s**2"] * 7, "units": "g"}, "leave one out"),
    ],
)
def test_wrong_floor_spectra(changes: dict[str, object], words: str) -> None:
    with pytest.raises(StudyError, match=words):
        open_study(study(rules_spectrum=SPECTRUM | changes))


def test_a_body_that_rolls_comes_back_where_a_rule_of_its_base_predicts_overturning() -> None:
    wide = [[-0.25, 0.03], [-0.05, 0.0], [0.05, 0.0], [0.25, 0.03], [0.2, 0.7], [-0.2, 0.7]]
    pulse = {"shape": "ricker", "a_p": "0.3*g", "T_p": 0.6}
    for stands, said in (("outline", 1), ("toes", 0)):
        case = {"block": {"outline": wide, "stands": stands}, "motion": {"pulse": pulse}}
        opened = open_study(study(case=case, rules=["fema356"]))
        assert len([one for one in opened.warnings if "rules know two edges" in one]) == said
    contents = solved(case=case | {"block": {"outline": wide}}, rules=["fema356"])
    assert np.isinf(contents.values("fema356_theta_over_alpha"))
    assert contents.values("outcome") == 1


def test_a_floor_spectrum_that_no_rule_reads_is_refused() -> None:
    with pytest.raises(StudyError, match="read by none of the rules"):
        open_study(study(rules=["west"], rules_spectrum=SPECTRUM))


def test_the_edition_is_in_the_dataset_and_in_the_summary() -> None:
    from rockcli.cli.words import report_text

    opened = open_study(study(rules=["asce43", "west"]))
    contents = solve(opened)
    assert contents.fields["asce43_theta_over_alpha"].attrs["edition"] == "ASCE/SEI 43-05"
    assert "(ASCE/SEI 43-05)" in report_text(report_on(opened, contents, status="solved"))


@pytest.mark.parametrize("how", ["rule", "damping"])
def test_the_cost_of_fema356_is_estimated(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tenths of a second a case, as it takes: not milliseconds."""
    from rockcli.engine import preview as module

    monkeypatch.setattr(module, "slowness", lambda: 1.0)  # as on the machine of reference, whatever this one is
    preview = module.preview
    plain = study(rules=[], vary={"block.R": {"from": 1.0, "to": 2.0, "n": 100}})
    case = {**plain["case"], "damping": "fema356"}  # type: ignore[dict-item]
    asked = plain | ({"rules": ["fema356"]} if how == "rule" else {"case": case})
    assert preview(open_study(plain)).seconds < 2.0
    assert 10.0 < preview(open_study(asked)).seconds < 60.0


def test_asce43_of_a_pulse_that_is_short_against_the_body() -> None:
    # spectrum of a half sine of .025 s by integration; the body's oscillator has periods beyond 16 T_p
    T_p, a_p, h, alpha = 0.05, 30.0 * 0.2 * G, 2.0 * np.cos(np.arctan(0.2)), np.arctan(0.2)
    pulse = {"shape": "half_sine", "a_p": a_p, "T_p": T_p}
    contents = solved(case={"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": pulse}}, rules=["asce43"])
    beta = rules.asce43_damping(0.2, 4.0 / 3.0)
    pieces = [(0.5 * T_p, lambda t: a_p * np.sin(2.0 * np.pi / T_p * t))]

    def excess(theta: float) -> float:
        S_a, f = rules.asce43_capacity(np.array([theta]), h, 0.2, 4.0 / 3.0, G)
        S_d = oscillator(pieces, 1.0 / f[0], beta, rtol=1e-8, atol=1e-11)
        return (2.0 * np.pi * f[0]) ** 2 * S_d - S_a[0]

    expected = brentq(excess, 0.1 * alpha, 0.99 * alpha, rtol=1e-6) / alpha
    assert float(contents.values("asce43_theta_over_alpha")) == pytest.approx(expected, rel=3e-3)  # .535; it was inf


def test_a_given_floor_spectrum_says_nothing_beyond_its_last_period() -> None:
    free = {"block": {"R": 6.0, "tan_alpha": 0.2}}  # 5.7 s at alpha
    periods, S_a = [0.02, 0.1, 0.2, 0.5, 1.0, 1.5, 8.0], [0.4, 0.9, 1.2, 1.2, 0.6, 0.4, 0.014]
    known, unknown = (
        solved(case=free, rules=["asce43"], rules_spectrum={"periods": periods[:n], "S_a": S_a[:n], "units": "g"})
        for n in (7, 6)
    )
    assert float(known.values("asce43_theta_over_alpha")) == pytest.approx(0.393, abs=1e-3)
    assert np.isnan(unknown.values("asce43_theta_over_alpha"))


def test_the_spectrum_of_a_record_is_worked_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies of which each names its records, as cabinets on their floors, share those of one floor."""
    worked_out: list[float] = []

    def counted(force: Forcing, periods: Array, zeta: float) -> Array:
        worked_out.append(zeta)
        return displacement_spectrum(force, periods, zeta)

    monkeypatch.setattr("rockcli.motion.spectrum.displacement_spectrum", counted)
    files = {name: f"synthetic_{name}.AT2" for name in ("rock_m65", "soil_m70")}
    bodies = {
        f"{h} on {name}": {"block.h": h, "motion.record.file": file} for h in (0.8, 1.0) for name, file in files.items()
    }
    case = {"block": {"h": 1.0, "width": 0.4, "mu": 0.3}, "motion": {"record": {"file": files["rock_m65"], "pga": 5.0}}}
    vary = {"motion.record.pga": ["0.5*g", "0.7*g"]}
    one = {"case": case, "rules": ["asce43_sliding"]}
    every = solved(vary={"case": bodies} | vary, **one).values("asce43_slide")
    assert len(worked_out) == len(files)
    for i, (name, body) in enumerate(bodies.items()):
        alone = solved(vary={"case": {name: body}} | vary, **one).values("asce43_slide")
        np.testing.assert_allclose(alone[0], every[i], rtol=1e-12)
    assert np.unique(every).size == 4
