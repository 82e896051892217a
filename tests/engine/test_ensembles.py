"""`over`: statistics of a suite by hand and by closed form; what is left out is counted and said."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from scenes import G
from scipy import integrate, stats

import rockcli
from rockcli.analysis.fragility.curves import Seen, curves
from rockcli.analysis.suites import words
from rockcli.analysis.suites.intensity import moves_at
from rockcli.analysis.suites.statistics import with_ensembles
from rockcli.engine.run import run_study, solve
from rockcli.engine.summary import report_on
from rockcli.errors import StudyError
from rockcli.motion.measures import measures
from rockcli.scene.response import NO_UPLIFT
from rockcli.scene.uncertain.statistics import fractile
from rockcli.storage.contents import Contents, variable_field
from rockcli.storage.read import from_xarray
from rockcli.study.open import open_study

ALPHA = 0.1
CURVES = {"vary": {"block.R": [1, 2]}, "over": "block.R", "save": {}}
SINES = [1.0, 1.5, 2.0, 3.0, 4.0]


def study(**more):
    base = {
        "name": "suite",
        "case": {
            "block": {"R": 0.75 * G, "alpha": ALPHA},
            "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 1.0}},
            "model": "linearized",
        },
        "over": "omega_p",
        "vary": {
            "motion.pulse.omega_p": SINES,
            "motion.pulse.a_p": {"from": 0.5 * G * ALPHA, "to": 8.0 * G * ALPHA, "n": 16},
        },
        "save": {"histories": False},
    }
    base["over"] = "motion.pulse.omega_p"
    return base | more


@pytest.fixture(scope="module")
def data():
    return rockcli.run(study())


def test_share_that_overturns_is_that_of_the_closed_form(data):
    """A half sine overturns a linear block for good: the shares follow from the thresholds of every member."""
    found = rockcli.run(
        study(
            over=None,
            vary={
                "motion.pulse.omega_p": SINES,
                "motion.pulse.a_p": {"from": 0.5, "to": 9.0, "n": 9, "find": "overturning"},
            },
        )
    )["motion_pulse_a_p_overturning"].values
    a_p = data["motion_pulse_a_p"].values
    expected = (a_p[None, :] >= found[:, None]).mean(axis=0)
    assert 0.0 < expected.mean() < 1.0
    np.testing.assert_array_equal(data["p_overturned"].values, expected)
    np.testing.assert_array_equal(data["n_answered"].values, 5)


def test_without_an_intensity_the_shares_are_told_the_largest_first():
    def told(**vary):
        case = study()["case"] | {"motion": {"pulse": {"shape": "half_sine", "a_p": 2.2 * G * ALPHA, "omega_p": 1.0}}}
        found = rockcli.run(study(case=case, vary={**vary, "motion.pulse.omega_p": SINES}))
        (words,) = [words for words in json.loads(found.attrs["ensemble"])["shown"] if words.startswith("share of")]
        return found["p_overturned"].values, words.removeprefix("share of 5 points of motion_pulse_omega_p that ")

    share, words = told()
    assert words == f"overturns: {float(share):.3g}"
    assert 0.0 < share < 1.0
    share, words = told(**{"block.R": [0.1 * G * 2**k for k in (3, 0, 6, 1, 4, 2, 7, 5)]})
    order = np.argsort(-share, kind="stable")
    assert len(set(share)) > 3
    assert re.findall(r"([0-9.]+) at block_R=", words) == [f"{share[i]:.3g}" for i in order[:6]]
    assert words.endswith("no larger at 2 more: rock table FILE.nc --of suite --sort -p_overturned")


def test_fractiles_count_overturned_as_infinite(data):
    peak = data["theta_peak_over_alpha"].values
    for end, q in (("p16", 0.16), ("p50", 0.5), ("p84", 0.84)):
        got = data[f"theta_peak_over_alpha_{end}"].values
        assert data[f"theta_peak_over_alpha_{end}"].dims == ("motion_pulse_a_p",)
        for column, value in zip(peak.T, got, strict=True):
            ordered = np.sort(column)
            rank = 4.0 * q
            low, high = ordered[int(rank)], ordered[int(np.ceil(rank))]
            expected = low if low == high else np.inf if np.isinf(high) else low + (rank % 1.0) * (high - low)
            assert value == pytest.approx(expected, rel=1e-12)
    assert np.isinf(data["theta_peak_over_alpha_p84"].values[-1])


def test_fractile_of_finite_numbers_is_that_of_numpy():
    values = np.random.default_rng(2).standard_normal((7, 4, 5))
    for q in (0.0, 0.16, 0.5, 0.84, 1.0):
        np.testing.assert_allclose(fractile(values, q, 1), np.quantile(values, q, axis=1), rtol=1e-12, atol=1e-15)
    values[:, 2] = np.nan
    np.testing.assert_allclose(fractile(values, 0.3, 1), np.nanquantile(values, 0.3, axis=1), rtol=1e-12)
    assert np.isnan(fractile(np.full((3, 2), np.nan), 0.5, 0)).all()


def test_the_mean_only_where_it_is_asked_for(data):
    assert "theta_peak_over_alpha_mean" not in data
    asked = rockcli.run(study(over={"axis": "motion.pulse.omega_p", "mean": True}))
    peak = asked["theta_peak_over_alpha"].values
    np.testing.assert_allclose(asked["theta_peak_over_alpha_mean"].values, peak.mean(axis=0), rtol=1e-12)


def handmade(outcome, peak, share=None, begins_at=0) -> tuple[Contents, rockcli.study.study.Study]:
    """The study's dataset with outcomes (5, 16) put in by hand, and shares of runs that overturn."""
    over = {"axis": "motion.pulse.omega_p", "begins_at": begins_at}  # what is put in by hand may move below uplift
    checked = open_study(study(over=over, save={"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]}))
    whole = solve(checked)
    fields = dict(whole.fields)
    axes = whole.axes
    fields["outcome"] = variable_field("outcome", axes, np.asarray(outcome, dtype=np.int8))
    fields["theta_peak_over_alpha"] = variable_field("theta_peak_over_alpha", axes, np.asarray(peak, dtype=float))
    if share is not None:
        fields["overturn_share"] = variable_field("overturn_share", axes, share)
    return with_ensembles(Contents(axes, fields, whole.attrs), checked), checked


def test_motions_to_the_other_side_are_no_lower_intensities():
    """A strong half sine to the left overturns; that a weak one to the right does not is no stable island."""
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "T_p": 1.0}}}
    a_p = {"motion.pulse.a_p": [-8.0, -4.0, -1.0, 1.0, 4.0, 8.0], "motion.pulse.T_p": [0.8, 1.0]}
    data = rockcli.run({"case": case, "vary": a_p, "over": "T_p", "save": {"histories": False}})
    assert data["p_overturned"].values.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    assert not data["safe_island"].any()
    assert not any("island" in warning for warning in data.attrs["warnings"])


def test_islands_and_missing_answers():
    outcome = np.ones((5, 16))
    outcome[:, 8:] = 3
    outcome[2, 10:12] = 1  # stands above an overturning one
    outcome[0, 3], outcome[1, 4] = -1, -2
    peak = np.where(outcome >= 2, np.inf, np.where(outcome < 0, np.nan, 0.3))
    contents, checked = handmade(outcome, peak)
    assert contents.values("safe_island").sum() == 2
    assert contents.values("safe_island")[2, 10:12].tolist() == [1, 1]
    assert contents.values("n_safe_islands")[9:13].tolist() == [0, 1, 1, 0]
    assert contents.values("n_answered")[:6].tolist() == [5, 5, 5, 4, 4, 5]
    assert contents.values("p_overturned")[10] == pytest.approx(0.8)
    said = " ".join(json.loads(contents.attrs["warnings"]))
    assert "2 of 80 cases have no answer" in said
    assert "stable islands: on 1 of 5 curves" in said
    assert "no fragility curve for theta/alpha > 0.1: every case exceeds it" in said
    again = with_ensembles(contents, checked)  # nothing piles up
    assert again.attrs == contents.attrs
    assert list(again.fields) == list(contents.fields)


def test_a_median_that_answers_are_missing_of_is_told_with_both_ends():
    """No strong motion has an answer: if bodies remain stable under all of them, the shares fall and have no curve."""
    outcome = np.ones((5, 16))
    outcome[0, 6], outcome[:2, 7] = 3, 3
    outcome[:, 8:] = -1
    peak = np.where(outcome >= 2, np.inf, np.where(outcome < 0, np.nan, 0.3))
    contents, _ = handmade(outcome, peak)
    told, least, most = (contents.values(f"fragility_median{end}")[-1] for end in ("", "_low", "_high"))
    assert least < told
    assert np.isnan(most)
    said = next(one for one in json.loads(contents.attrs["warnings"]) if "have no answer" in one)
    assert f"p_overturned would be 0 or 1, the median of overturning none or {least / G:.4g} g (where most)" in said


def test_a_median_that_only_missing_answers_could_make_is_told():
    """None overturns, so there is no curve; if the bodies without an answer overturned there would be one."""
    outcome = np.ones((5, 16))
    outcome[0, 6], outcome[:2, 7], outcome[:, 8:] = -1, -1, -1
    outcome[0, 8:] = 1
    peak = np.where(outcome < 0, np.nan, 0.3)
    contents, _ = handmade(outcome, peak)
    told, least, most = (contents.values(f"fragility_median{end}")[-1] for end in ("", "_low", "_high"))
    assert np.isnan([told, most]).all()
    said = next(one for one in json.loads(contents.attrs["warnings"]) if "have no answer" in one)
    assert f"the median of overturning none or {least / G:.4g} g" in said


def test_members_count_by_the_share_of_their_runs():
    outcome = np.ones((5, 16))
    outcome[:, 8:] = 3
    outcome[0, 6:10] = -1
    peak = np.where(outcome >= 2, np.inf, np.where(outcome < 0, np.nan, 0.3))
    share = np.where(outcome >= 2, 1.0, 0.0)
    share[0, 6:10] = 0.25, 0.5, 0.75, np.nan  # the last one has no answer at all
    contents, _ = handmade(outcome, peak, share)
    assert contents.values("n_answered")[5:11].tolist() == [5, 5, 5, 5, 4, 5]
    assert contents.values("p_overturned")[5:11] == pytest.approx([0.0, 0.05, 0.1, 0.95, 1.0, 1.0])
    assert contents.values("p_overturned_low")[8:11] == pytest.approx([0.95, 0.8, 1.0])
    assert contents.values("p_overturned_high")[8:11] == pytest.approx([0.95, 1.0, 1.0])
    overturned, above = contents.values("p_exceeded")[..., -1], contents.values("p_exceeded")[..., 0]
    assert overturned[5:11] == pytest.approx([0.0, 0.05, 0.1, 0.95, 1.0, 1.0])
    assert (above >= overturned).all()  # a limit state is exceeded on the way to the next
    # infinite from one half on, else left out
    assert contents.values("theta_peak_over_alpha_p50")[6] == pytest.approx(0.3)
    assert np.isinf(contents.values("theta_peak_over_alpha_p84")[7])
    assert contents.values("safe_island").sum() == 0
    said = " ".join(json.loads(contents.attrs["warnings"]))
    assert "3 of 80 cases overturn in some of their perturbed runs" in said
    assert "1 of 80 cases have no answer" in said
    assert "p_overturned would be 0.8 or 1" in said


def test_the_bracket_is_that_of_the_two_extremes():
    rng = np.random.default_rng(8)
    outcome = np.where(rng.uniform(0.0, 16.0, (5, 1)) < np.arange(16), 3.0, 1.0)
    unknown = rng.random((5, 16)) < 0.2
    found = {}
    for name, value in (("none", -1), ("stood", 1), ("fell", 3)):
        flags = np.where(unknown, value, outcome)
        peak = np.where(flags >= 2, np.inf, np.where(flags < 0, np.nan, 0.05))
        found[name] = handmade(flags, peak)[0]
    for end, name, median in (("low", "stood", "high"), ("high", "fell", "low")):
        np.testing.assert_allclose(found["none"].values(f"p_overturned_{end}"), found[name].values("p_overturned"))
        np.testing.assert_allclose(
            found["none"].values(f"fragility_median_{median}")[-1], found[name].values("fragility_median")[-1]
        )


def test_members_without_an_answer_below_uplift_leave_the_bracket_to_the_others():
    """The first two of the intensities, .5 and 1 g alpha, lift no member."""
    fell = np.random.default_rng(8).uniform(2.0, 16.0, (5, 1)) < np.arange(16)
    found = {}
    for name, unknown in (("all", []), ("below", [0, 1]), ("both", [0, 1, 5]), ("above", [5])):
        outcome = np.where(fell, 3.0, 1.0)
        outcome[0, unknown] = -1.0
        peak = np.where(outcome == 3.0, np.inf, np.where(outcome < 0.0, np.nan, 0.05))
        found[name] = handmade(outcome, peak, begins_at="uplift")[0]
    for some, others in (("below", "all"), ("both", "above")):
        for end in ("_low", "", "_high"):
            low = [found[name].values(f"fragility_median{end}")[-1] for name in (some, others)]
            assert np.isfinite(low).all()
            assert low[0] == low[1]
    assert found["above"].values("fragility_median_low")[-1] < found["above"].values("fragility_median_high")[-1]


def test_an_irregular_body_has_one_fragility_with_an_error_estimate_and_without():
    """Three records, a body with one edge twice as far as the other, intensities to where all overturn."""
    values = {}
    for scalars in (["outcome", "theta_peak_over_alpha"], ["outcome", "theta_peak_over_alpha", "error_estimate"]):
        asked = {
            "name": "irregular",
            "case": {"block": {"h": 0.735, "b": [0.09, 0.18]}},
            "over": {"axis": "record", "along": "pga"},
            "vary": {
                "motion.record.file": [f"synthetic_{name}.AT2" for name in ("pulse_m70", "rock_m65", "soil_m70")],
                "motion.record.pga": {"from": "0.13*g", "to": "0.9*g", "n": 12},
            },
            "save": {"histories": False, "scalars": scalars},
        }
        values[len(scalars)] = rockcli.run(asked)
    few, all_ = values.values()
    assert 0.2 < float(few["p_overturned"].mean()) < 0.8
    np.testing.assert_allclose(all_["p_overturned"], few["p_overturned"], atol=0.01)
    np.testing.assert_allclose(all_["p_exceeded"], few["p_exceeded"], atol=0.01)
    assert (all_["n_answered"] == 3).all()


def test_separable_data_have_no_curve():
    outcome = np.where(np.arange(16) < 8, 1, 3) * np.ones((5, 1))
    contents, _ = handmade(outcome, np.where(outcome > 1, np.inf, 0.3))
    assert np.isnan(contents.values("fragility_median")[-1])
    assert (
        "no fragility curve for theta/alpha > 0.5, theta/alpha > 1 or overturning: it goes from none to all within a step "
        "of the intensities" in contents.attrs["warnings"]
    )


def test_a_share_at_one_intensity_alone_is_not_told_to_go_from_none_to_all():
    outcome = np.ones((5, 16))
    outcome[:2, -1] = 3
    contents, _ = handmade(outcome, np.where(outcome > 1, np.inf, 0.3))
    assert np.isnan(contents.values("fragility_median")[-1])
    assert "or one of them alone has members that exceed it and members that do not" in contents.attrs["warnings"]


def test_integrals_of_a_motion_end_with_the_duration():
    """Between two samples too: of 1 m/s² they are pi/(2 g) times the duration, and the duration."""
    level = {"values": np.ones(400), "dt": 0.1, "units": "m/s2"}
    base = {
        "case": {"block": {"R": 8.0, "tan_alpha": 0.15}, "motion": {"record": level, "duration": 1.0}},
        "over": "scale",
        "vary": {"motion.duration": [0.05, 7.0, 7.063, 100.0], "motion.record.scale": [1.0, 2.0]},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }
    data, until = rockcli.run(base), np.array([0.05, 7.0, 7.063, 39.9])
    np.testing.assert_allclose(data["arias"].sel(scale=2.0), 4.0 * np.pi / (2.0 * G) * until, rtol=1e-12)
    np.testing.assert_allclose(data["cav"].sel(scale=2.0), 2.0 * until, rtol=1e-12)
    np.testing.assert_allclose(data["d5_95"], 0.9 * until, rtol=1e-12)


def test_measures_of_the_motion():
    """Unscaled records: the measures in the dataset are those of the files."""
    base = {
        "name": "cloud",
        "case": {"block": {"R": 8.0, "tan_alpha": 0.15}, "motion": {"record": {"file": "synthetic_rock_m65.AT2"}}},
        "over": "record",
        "vary": {"motion.record.file": "synthetic_*.AT2", "motion.record.scale": [1.0, 2.0]},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }
    checked = open_study(base)
    data = rockcli.run(base)
    for indices, batch in checked.batches():
        motion = batch.excitation.horizontal
        for k, factor in zip(indices, motion.factor, strict=True):
            record, scale = np.unravel_index(k, (3, 2))
            expected = measures(motion.values * factor, motion.dt, G)
            for name in ("arias", "cav", "t_mean", "d5_95"):
                item = data[name]
                place = {d: i for d, i in (("record", record), ("scale", scale)) if d in item.dims}
                assert float(item[place]) == pytest.approx(expected[name], rel=1e-12), name
    group = data["p"] * data["pgv"] / (G * 0.15)
    np.testing.assert_allclose(data["p_pgv_over_g_tan_alpha"].transpose(*group.dims), group, rtol=1e-12)
    # three records tell nothing of which measure is the better one
    assert np.isnan(data["demand_spearman"]).all()
    assert np.isnan(data["demand_pearson"]).all()
    said = json.loads(data.attrs["ensemble"])["says"]
    assert said[-1] == "correlations with measures of the motion are left out: fewer than 8 records with an answer"


@pytest.mark.parametrize("n", [7, 8])
def test_correlations_need_eight_records(tmp_path, n):
    """The ranks are those of as many numbers."""
    noise = np.random.default_rng(5)
    for i in range(n):
        values = noise.normal(size=800) * np.sin(np.pi * np.arange(800) / 800.0) * (0.8 + 0.1 * i)
        (tmp_path / f"noise_{i}.txt").write_text("# units: m/s2\n" + "".join(f"{a:.9e}\n" for a in values))
    record = {"file": str(tmp_path / "noise_0.txt"), "dt": 0.02}
    data = rockcli.run(
        {
            "name": "cloud",
            "case": {"block": {"R": 8.0, "tan_alpha": 0.05}, "motion": {"record": record}},
            "over": "record",
            "vary": {"motion.record.file": str(tmp_path / "noise_*.txt")},
            "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
        }
    )
    got = data["demand_spearman"].sel(measure="pgv")
    if n < 8:
        assert np.isnan(got)
        return
    rank = [stats.rankdata(data[name].values) for name in ("theta_peak_over_alpha", "pgv")]
    assert float(got) == pytest.approx(np.corrcoef(*rank)[0, 1], rel=1e-12)
    assert "rank correlation of the peak" in data.attrs["ensemble"]
    assert "left out" not in data.attrs["ensemble"]


def test_expectations_on_statistics(tmp_path):
    clauses = [
        {"quantity": "p_overturned", "at": {"motion.pulse.a_p": 8.0 * G * ALPHA}, "value": 1},
        {"quantity": "fragility_beta", "at": {"limit_state": "overturned"}, "min": 0.0},
        {"quantity": "demand_spearman", "at": {"measure": "pgv"}, "max": 1.0},
    ]
    from rockcli.engine.run import run_study

    report = run_study(open_study(study(expect=clauses[:2])), tmp_path, plots=False)
    open_study(study(expect=clauses))
    assert [v.passed for v in report.verdicts] == [True, True]
    assert [v.points for v in report.verdicts] == [1, 1]
    assert any(line.startswith("overturning: median") for line in report.suite)
    with pytest.raises(StudyError, match="no axis"):
        open_study(study(expect=[clauses[0] | {"at": {"motion.pulse.omega_p": 1.0}}]))
    with pytest.raises(StudyError, match="limit_state"):
        open_study(study(expect=[clauses[1] | {"at": {"limit_state": "2"}}]))


def test_only_words_change_when_over_does(tmp_path):
    """`over` does not identify results: a finished study gets its statistics without being solved again."""
    from rockcli.engine.run import run_study
    from rockcli.storage import netcdf

    first = run_study(open_study(study(over=None)), tmp_path, plots=False)
    assert first.suite == ()
    second = run_study(open_study(study()), tmp_path, plots=False)
    assert second.status == "up to date"
    assert second.suite
    fresh = run_study(open_study(study()), tmp_path / "fresh", plots=False)
    one, other = netcdf.read(second.file), netcdf.read(fresh.file)
    assert set(one.fields) == set(other.fields)
    for name in one.fields:
        if name != "wall_time":
            np.testing.assert_array_equal(one.values(name), other.values(name))
    third = run_study(open_study(study(over=None)), tmp_path, plots=False)
    assert not {"p_overturned", "limit_state", "arias"} & set(netcdf.read(third.file).fields)


def test_a_search_over_a_suite():
    vary = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": {"from": 0.5, "to": 2.0, "n": 7, "find": "overturning"}}
    data = rockcli.run(study(vary=vary))
    found = data["motion_pulse_a_p_overturning"].values
    assert np.isinf(found).any()
    np.testing.assert_array_equal(data["motion_pulse_a_p_overturning_p50"].values, np.median(found))
    assert int(data["n_answered"]) == 5


@pytest.mark.parametrize(
    ("over", "words"),
    [
        ("record", "no axis"),
        ({"axis": "motion.pulse.omega_p", "along": "motion.pulse.omega_p"}, "must be another axis"),
        ({"axis": "motion.pulse.omega_p", "limits": [0.1, -1]}, "greater than 0"),
        ({"axis": "motion.pulse.omega_p", "limits": [0.1, 0.5, "1/10"]}, r"limits\[2\] is .*theta/alpha > 0.1 twice"),
        ({"axis": "motion.pulse.omega_p", "limit": [0.1]}, "did you mean 'limits'"),
        ({"axis": "motion.pulse.omega_p", "intensity": "sa(0)"}, "sa"),
        ({"axis": "motion.pulse.omega_p", "intensity": "pgd"}, "expected pga, pgv"),
        ({"axis": "motion.pulse.omega_p", "beta_added": -0.1}, "expected a number >= 0"),
        ({"axis": "motion.pulse.omega_p", "fit": "probit"}, "fit"),
        (3, "over"),
    ],
)
def test_wrong_ensembles(over, words):
    with pytest.raises(StudyError, match=words):
        open_study(study(over=over))


def test_two_intensities_need_a_word():
    vary = study()["vary"] | {"motion.pulse.a_p_over_g_tan_alpha": [1, 2]}
    del vary["motion.pulse.a_p"]
    vary["motion.vertical.pulse.a_p"] = [0.1, 0.2]
    data = study(vary=vary)
    data["case"]["motion"]["vertical"] = {"pulse": {"shape": "sine", "a_p": 0.1, "omega_p": 3.0}}
    with pytest.raises(StudyError, match="along"):
        open_study(data)
    with pytest.raises(StudyError, match="outcome or theta_peak_over_alpha"):
        open_study(study(case={"block": {"R": 1, "alpha": 0.2}}, curves=["pushover"], **CURVES))


def test_fragility_against_other_intensities_and_of_a_cloud():
    """PGV of a half sine of frequency omega is 2 a_p/omega: the suite told against it is the suite against that."""
    against = rockcli.run(study(over={"axis": "motion.pulse.omega_p", "intensity": "pgv", "begins_at": 0}))
    a_p, omega = against["motion_pulse_a_p"].values, against["motion_pulse_omega_p"].values
    np.testing.assert_allclose(against["fragility_intensity"].values, 2.0 * a_p / omega[:, None], rtol=1e-6)
    assert against["fragility_median"].attrs["units"] == "m s-1"
    peak = against["theta_peak_over_alpha"].values
    category = sum((peak > limit).astype(int) for limit in (0.1, 0.5, 1.0)) + np.isinf(peak)
    x = 2.0 * a_p / omega[:, None]
    expected = curves(Seen(x, category, category, np.ones(x.shape)), 4)
    np.testing.assert_allclose(against["fragility_median"].values, expected.median, rtol=1e-5)
    # every pulse at its one intensity: a cloud
    cases = {f"case {i}": {"omega_p": w, "a_p": a * G * ALPHA} for i, (w, a) in enumerate(CLOUD)}
    cloud = study(over={"axis": "motion.pulse", "intensity": "pga", "begins_at": 0}, vary={"motion.pulse": cases})
    found = rockcli.run(cloud)
    assert "p_exceeded" not in found
    peak = found["theta_peak_over_alpha"].values
    category = (sum((peak > limit).astype(int) for limit in (0.1, 0.5, 1.0)) + np.isinf(peak))[:, None]
    x = np.array([[a * G * ALPHA] for _, a in CLOUD])
    expected = curves(Seen(x, category, category, np.ones(x.shape)), 4)
    np.testing.assert_allclose(found["fragility_median"].values, expected.median, rtol=1e-9)


CLOUD = [(w, a) for w in (1.0, 2.0, 4.0) for a in (1.2, 1.6, 2.1, 2.9, 4.0, 5.5, 8.0)]


def test_the_spectral_acceleration_of_a_stiff_oscillator_is_the_peak():
    found = rockcli.run(study(over={"axis": "motion.pulse.omega_p", "intensity": "sa(0.001)"}))
    plain = rockcli.run(study())
    np.testing.assert_allclose(found["fragility_median"].values, plain["fragility_median"].values, rtol=2e-3)
    np.testing.assert_allclose(found["fragility_begins_at"].values, G * ALPHA, rtol=2e-3)
    np.testing.assert_allclose(plain["fragility_begins_at"].values, G * ALPHA, rtol=1e-12)


SLIDES = {"block": {"R": 1.0, "tan_alpha": 0.4, "mu": 0.45}}


def sliding_study(**changes):
    """Blocks that slide far, rock, and overturn: friction little above tan(alpha)."""
    limits = [1, {"slide_peak": 0.02}, {"slide_residual": "1*cm"}, {"slide_peak": "5*mm"}]
    plain = study(over={"axis": "motion.pulse.omega_p", "limits": limits})
    pulse = {"shape": "sine", "a_p": 1.0, "omega_p": 1.0}
    case = {"block": SLIDES["block"] | changes.pop("block", {}), "motion": {"pulse": pulse}}
    vary = {"motion.pulse.omega_p": [2.0, 3.0, 4.5, 6.0, 8.0, 11.0, 15.0],
            "motion.pulse.a_p": {"from": "0.3*g", "to": "1.6*g", "n": 12}}  # fmt: skip
    scalars = ["outcome", "theta_peak_over_alpha", "slide_peak", "slide_residual"]
    return plain | {"case": case, "vary": vary, "save": {"histories": False, "scalars": scalars}} | changes


def test_a_slide_that_is_told_as_rarer_than_its_overturning_is_named():
    """Two fits to nearly the same shares may differ either way, and a reader may not take the part for more."""
    vary = {"block.R": [0.5, 1.0, 1.5], **sliding_study()["vary"]}
    data = rockcli.run(sliding_study(over={"axis": "motion.pulse.omega_p", "limits": [{"slide_peak": 0.5}]}, vary=vary))
    assert not any("which it includes" in one for one in json.loads(data.attrs["warnings"]))
    assert not list(words._rarer_than_its_part(from_xarray(data)))
    data["fragility_median"][:, 0] = data["fragility_median"][:, 1] * [0.97, 1.02, 1.03]
    (said,) = words._rarer_than_its_part(from_xarray(data))
    assert said.startswith(
        "slide_peak > 0.5 m or overturned is told as less probable than overturning, which it includes: median of 2 of 3 "
        "bodies by 3 % at most: "
    )


def test_a_slide_that_overturns_rarer_in_its_tail_or_under_a_hazard_is_named():
    """Two curves that cross below their medians: the smaller percentile or the rate may be the other way round."""
    vary = {"block.R": [0.5, 1.0, 1.5], **sliding_study()["vary"]}
    hazard = {"intensity": ["0.3*g", "1*g"], "rate": [1e-2, 1e-4]}
    curves = {"axis": "motion.pulse.omega_p", "limits": [{"slide_peak": 0.5}]}
    data = rockcli.run(sliding_study(over=curves, vary=vary, hazard=hazard))
    assert not list(words._rarer_than_its_part(from_xarray(data)))
    data["fragility_percentile"][0, 0, 0] = 1.02 * data["fragility_percentile"][0, 1, 0]
    data["annual_rate"][1, 0] = data["annual_rate"][1, 1] / 1.1
    (said,) = words._rarer_than_its_part(from_xarray(data))
    assert (
        "includes: 1 % value of 1 of 3 bodies by 2 % at most, annual rate of 1 of 3 bodies by 10 % at most: two" in said
    )


@pytest.mark.parametrize("mu", [0.2, 0.45])
def test_fractiles_of_the_slide(mu):
    """Of seven members the median is the fourth; one that overturns slides without end."""
    data = rockcli.run(sliding_study(block={"mu": mu}))
    fell = np.isin(data["outcome"].values, (2, 3))
    assert fell.any() == (mu > 0.4)
    fourth = np.sort(np.where(fell, np.inf, data["slide_peak"].values), axis=0)[3]
    np.testing.assert_array_equal(data["slide_peak_p50"].values, fourth)
    assert len(np.unique(fourth)) > 1


def test_limit_states_of_the_slide():
    """Each quantity is a family of its own, fitted with overturning as its last state; overturning stays the rotation's."""
    data = rockcli.run(sliding_study())
    states = ["1", "slide_peak > 0.005 m", "slide_peak > 0.02 m", "slide_residual > 0.01 m", "overturned"]
    assert list(data["limit_state"].values) == states
    fell = np.isin(data["outcome"].values, (2, 3))
    peak, residual = data["slide_peak"].values, np.abs(data["slide_residual"].values)
    families = {
        ("1", "overturned"): [data["theta_peak_over_alpha"].values > 1.0, fell],
        ("slide_peak > 0.005 m", "slide_peak > 0.02 m"): [(peak > 0.005) | fell, (peak > 0.02) | fell, fell],
        ("slide_residual > 0.01 m",): [(residual > 0.01) | fell, fell],
    }
    begins = float(data["fragility_begins_at"])
    assert begins == pytest.approx(0.4 * G, rel=1e-12)  # it lifts before it slips
    x = np.broadcast_to(data["motion_pulse_a_p"].values, fell.shape)
    assert fell.any()
    for labels, exceeds in families.items():
        category = sum(one.astype(int) for one in exceeds)
        expected = curves(Seen(x, category, category, np.ones(x.shape)), len(exceeds), begins_at=begins)
        for i, label in enumerate(labels):
            one = data.sel(limit_state=label)
            np.testing.assert_array_equal(one["p_exceeded"].values, exceeds[i].mean(axis=0))
            assert float(one["fragility_median"]) == pytest.approx(expected.median[i], rel=1e-12)
            assert np.isfinite(expected.median[i])
    told = ["1", *(f"{label} or overturned" for label in states[1:-1]), "overturned"]
    assert rockcli.table(data, of="fragility")["limit_state"].tolist() == told


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_curves_of_uneven_bodies_begin_where_the_motion_lifts_an_edge(sign):
    """Half sines push one way alone: a_g > 0 lifts the body about its left edge, at g tan(alpha) of that edge."""
    t = np.arange(100) * 0.01
    records = [
        {"values": sign * 0.1 * np.sin(np.pi * t / T) * (t < T), "dt": 0.01, "units": "g"} for T in (0.3, 0.4, 0.5, 0.6)
    ]
    pulse = {"shape": "half_sine", "T_p": 1.0, "a_p": 1.0}
    stripes = {"from": 0.06 * G, "to": 1.21 * G, "n": 47}
    body = {"block": {"h": 1.0, "b": [0.3, 0.2], "r_g": 0.6}}
    over = {"over": {"axis": "record", "limits": [0.1]}, "save": {"histories": False}}
    data = rockcli.run(
        {"case": body | {"motion": {"record": records[0]}}}
        | over
        | {"vary": {"motion.record": records, "motion.record.pga": stripes}}
    )
    begins = (0.3 if sign > 0.0 else 0.2) * G
    assert float(data["fragility_begins_at"]) == pytest.approx(begins, rel=1e-12)
    assert float(data["fragility_begins_at_last"]) == pytest.approx(begins, rel=1e-12)
    lifts = data["pga"].values[(data["outcome"].values != 0).any(axis=0)]
    assert begins < lifts.min() <= begins + 0.025 * G * (1.0 + 1e-9)
    if sign > 0.0:
        pulses = rockcli.run(
            {"case": body | {"motion": {"pulse": pulse}}}
            | over
            | {"over": {"axis": "T_p", "limits": [0.1]}}
            | {"vary": {"motion.pulse.T_p": [0.6, 0.8, 1.0], "motion.pulse.a_p": stripes}}
        )
        assert float(pulses["fragility_begins_at"]) == pytest.approx(begins, rel=1e-12)


def test_curves_of_model_auto_begin_where_those_of_the_model_it_takes_do():
    vary = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": {"from": 0.5 * G * ALPHA, "to": 6.0 * G * ALPHA, "n": 9}}
    case = {
        "block": {"R": 0.75 * G, "alpha": ALPHA},
        "motion": {"pulse": {"shape": "half_sine", "a_p": 1, "omega_p": 1}},
    }
    auto, rigid = (rockcli.run(study(vary=vary, case=case | {"model": model})) for model in ("auto", "rigid"))
    assert float(auto["fragility_begins_at"]) == pytest.approx(G * np.tan(ALPHA), rel=1e-12)
    for name in ("fragility_begins_at", "fragility_median", "fragility_beta"):
        np.testing.assert_array_equal(auto[name], rigid[name])
    column = {"E": 30e9, "rho": 2500}
    found = rockcli.run(study(vary=vary, case=case | {"model": "auto", "column": column}))
    assert float(found["fragility_begins_at"]) == 0.0  # its vibrations may lift it


@pytest.mark.parametrize(
    ("scheme", "begins"),
    [
        ({}, 1.0),
        ({"W_over_Mg": 0.8}, 0.8),
        ({"fixed_base_period": 0.3}, np.nan),  # S_a(0.3 s), not the PGA, is held against the threshold
        ({"spectrum": {"shape": "constant", "S_a": 0.3 * G}}, np.nan),
    ],
)
def test_curves_of_fema356_begin_at_its_own_threshold(scheme, begins):
    """The procedure lets a body rock above (W/Mg) g tan(alpha) of the PGA."""
    amplitudes = [0.7 * G * np.tan(ALPHA), 0.81 * G * np.tan(ALPHA), 0.99 * G * np.tan(ALPHA), 1.01 * G * np.tan(ALPHA)]
    motion = {"pulse": {"shape": "sine", "a_p": 1.0, "omega_p": 6.0}}
    case = {"block": {"R": 0.75 * G, "alpha": ALPHA}, "motion": motion, "damping": {"scheme": "fema356", **scheme}}
    asked = study(case=case, vary={"motion.pulse.a_p": amplitudes})
    del asked["over"]
    at = moves_at(open_study(asked), slides=False)
    np.testing.assert_allclose(at, begins * G * np.tan(ALPHA), rtol=1e-12)
    if np.isfinite(begins):
        np.testing.assert_array_equal(rockcli.run(asked)["outcome"].values != NO_UPLIFT, np.array(amplitudes) > at)


def test_curves_of_slides_begin_where_friction_gives_way():
    low = sliding_study(block={"mu": 0.3})
    data = rockcli.run(low | {"over": low["over"] | {"limits": [{"slide_peak": 0.05}, {"slide_peak": 0.5}]}})
    assert float(data["fragility_begins_at"]) == pytest.approx(0.3 * G, rel=1e-12)
    assert not np.isin(data["outcome"].values, (2, 3)).any()  # mu < tan(alpha): it cannot tip
    medians = data["fragility_median"].values
    assert medians[0] < medians[1]
    assert np.isnan(medians[2])
    # a rigid block on a plane under one sine slides farther the longer the sine: by 1/omega^2 at one amplitude
    slide = data["slide_peak"].values[:, -1] * data["motion_pulse_omega_p"].values ** 2
    np.testing.assert_allclose(slide, slide[0], rtol=1e-9)


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ([{"slide_peak": 0.0}], "greater than 0"),
        ([{"slide_peak": 0.1, "slide_residual": 0.1}], "expected {slide_peak: m} or"),
        ([{"slide": 0.1}], "slide_peak"),
        ([{"slide_peak": 0.1}, {"slide_peak": 0.1}], "limit state slide_peak > 0.1 m twice"),
    ],
)
def test_wrong_limits_of_the_slide(limits, words):
    wrong = sliding_study()
    with pytest.raises(StudyError, match=words):
        open_study(wrong | {"over": wrong["over"] | {"limits": limits}})


def test_limits_of_the_slide_need_it_saved():
    with pytest.raises(StudyError, match="needs slide_residual, which bodies with a mu have, among the saved"):
        open_study(sliding_study(save={"histories": False, "scalars": ["outcome", "slide_peak"]}))


def test_a_large_study_saves_what_limits_of_the_slide_need():
    many = {"save": {"histories": False}, "uncertain": {"block.mu": {"uniform": [0.3, 0.6]}}, "samples": 200}
    checked = open_study(sliding_study(**many))
    assert checked.size > 10_000
    assert {"slide_peak", "slide_residual"} <= set(checked.scalars)
    assert "u_top_peak" not in checked.scalars


def test_the_summary_has_the_numbers():
    checked = open_study(study())
    rows = report_on(checked, solve(checked), status="solved").as_dict()["fragility"]
    data = rockcli.run(study())
    assert [row["limit_state"] for row in rows] == ["0.1", "0.5", "1", "overturned"]
    for row in rows:
        one = data.sel(limit_state=row["limit_state"])
        assert row["fragility_median"] == float(one["fragility_median"])
        assert row["fragility_percentile_5"] == float(one["fragility_percentile"].sel(percentile=5))
        assert row["fragility_status"] == "fitted"


def test_fragility_of_two_intensities_is_the_fit_of_their_values():
    """PGA and PGV/PGA of pulses of several periods: by hand from the dataset's own columns."""
    over = {"axis": "motion.pulse.omega_p", "along": "a_p", "intensity": ["pga", "pgv_over_pga"], "limits": []}
    sines = {  # of a body that may remain stable above what overturned it, so that the outcomes overlap
        "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": {"pulse": {"shape": "sine", "a_p": 1, "omega_p": 3}}},
        "vary": {
            "motion.pulse.omega_p": {"from": 2, "to": 10, "n": 10},
            "motion.pulse.a_p": {"from": "0.2*g", "to": "4*g", "n": 24},
        },
    }
    found = rockcli.run(study(over=over, **sines))
    x, y = found["fragility_intensity"].values, found["fragility_intensity_second"].values
    np.testing.assert_allclose(y, np.broadcast_to(found["pgv"].values / found["pga"].values, y.shape), rtol=1e-12)
    category = (found["outcome"].values >= 2).astype(int)
    begins = float(found["fragility_begins_at"])
    assert begins == pytest.approx(0.2 * G, rel=1e-12)
    by_hand = curves(Seen(x, category, category, np.ones(x.shape), second=y), 1, begins_at=begins)
    for name, values in (("median", by_hand.median), ("exponent", by_hand.exponent), ("beta", by_hand.beta)):
        np.testing.assert_allclose(found[f"fragility_{name}"].values, values, rtol=1e-9)
    assert float(found["fragility_second"]) == pytest.approx(by_hand.second_at, rel=1e-12)
    assert float(found["fragility_exponent"][0]) > 0.0  # the longer the pulse the weaker it may be
    assert "at pgv_over_pga" in " ".join(json.loads(found.attrs["ensemble"])["says"])
    assert "fragility_second [s]" in rockcli.table(found, of="fragility").columns
    slides = over | {"limits": [{"slide_peak": 0.01}]}
    sines["case"]["block"]["mu"] = 0.3
    said = json.loads(rockcli.run(study(over=slides, **sines)).attrs["ensemble"])["says"]
    assert sum("what it is above uplift or slip goes with its power" in sentence for sentence in said) == 2
    with pytest.raises(StudyError, match="twice"):
        rockcli.run(study(over=over | {"intensity": ["pga", "pga"]}))
    with pytest.raises(StudyError, match="is of one intensity"):
        rockcli.run(study(over=over, hazard={"intensity": [1, 2], "rate": [0.1, 0.01]}))


def test_records_are_what_is_independent_wherever_their_axis_stands(tmp_path):
    """Directions of a record are no new records: limits do not depend on the order of the axes, and those of copies of
    every record in other directions are those of the records."""
    rng = np.random.default_rng(3)
    t = np.arange(0.0, 5.0, 0.02)
    pairs = []
    for i in range(8):
        pair = []
        for k in range(2):
            a = np.sin(2.0 * np.pi * rng.uniform(0.5, 1.5) * t + rng.uniform(0.0, 6.0)) * np.exp(
                -(((t - 2.5) / 1.2) ** 2)
            )
            np.savetxt(tmp_path / f"{i}{k}.csv", a)
            pair.append(str(tmp_path / f"{i}{k}.csv"))
        pairs.append(pair)
    record = {"file": pairs[0], "angle": 0.0, "units": "m/s2", "dt": 0.02}
    case = {"block": {"R": 1.0, "alpha": 0.2}, "motion": {"record": record}}
    scale = {"motion.record.scale": [2.0, 3.0, 4.0, 6.0, 9.0]}
    found = []
    for angles in ([0.0, np.pi], [0.0, 0.3, 0.9, 1.4]):
        axes = {"motion.record.file": pairs, "motion.record.angle": angles}
        for order in (axes, dict(reversed(axes.items()))):
            over = {"axis": [*order], "along": "scale", "limits": [0.5]}
            found.append(rockcli.run({"name": "s", "case": case, "vary": {**order, **scale}, "over": over}))
    alone = rockcli.run({"name": "s", "case": case, "vary": {"motion.record.file": pairs, **scale},
                         "over": {"axis": "record", "along": "scale", "limits": [0.5]}})  # fmt: skip
    assert (alone["fragility_status"].values == 0).all()
    for name in ("fragility_median_ci_low", "fragility_median_ci_high", "fragility_percentile_ci_low"):
        for one, other in (found[:2], found[2:], (alone, found[0])):  # turned by pi a symmetric body does the same
            np.testing.assert_allclose(one[name].values, other[name].values, rtol=1e-6)


def test_fragility_against_arias_intensity_begins_at_uplift(tmp_path):
    """Arias intensity grows with the square of the amplitude: that of the record scaled to a PGA of g tan(alpha)."""
    files, arias = [], []
    t = np.arange(0.0, 6.0, 0.01)
    for f in (0.5, 0.7, 0.9, 1.2):
        a = np.sin(2.0 * np.pi * f * t) * np.exp(-(((t - 3.0) / 1.5) ** 2))
        a /= np.abs(a).max()
        files.append(str(tmp_path / f"{f}.csv"))
        np.savetxt(files[-1], a)
        arias.append(np.pi / (2.0 * G) * integrate.simpson(np.interp(np.arange(0.0, 5.9901, 1e-4), t, a) ** 2, dx=1e-4))
    case = {"block": {"R": 5.0, "alpha": ALPHA}, "motion": {"record": {"file": files[0], "units": "m/s2", "dt": 0.01}}}
    vary = {"motion.record.file": files, "motion.record.pga": {"from": 1.0, "to": 20.0, "n": 12}}
    found = rockcli.run({"name": "s", "case": case, "vary": vary, "over": {"axis": "record", "intensity": "arias"}})
    begins = min(arias) * (G * np.tan(ALPHA)) ** 2
    assert float(found["fragility_begins_at"]) == pytest.approx(begins, rel=1e-6)
    assert (found["fragility_percentile"] > begins).all()


def test_fragility_of_a_search_against_cav(tmp_path):
    """CAV grows with the amplitude: that of a record of one m/s² times its lowest overturning PGA; of pulses none."""
    files, cav = [], []
    t = np.arange(0.0, 6.0, 0.01)
    for i, f in enumerate((0.5, 0.7, 0.9, 1.2)):
        a = np.sin(2.0 * np.pi * f * t) * np.exp(-(((t - 3.0) / 1.5) ** 2))
        a /= np.abs(a).max()
        np.savetxt(tmp_path / f"{i}.csv", a)
        files.append(str(tmp_path / f"{i}.csv"))
        fine = np.interp(np.linspace(0.0, t[-1], 100 * len(t)), t, a)
        cav.append(np.abs(fine).mean() * t[-1])
    case = {"block": {"R": 1.0, "alpha": ALPHA}, "motion": {"record": {"file": files[0], "units": "m/s2", "dt": 0.01}}}
    pga = {"from": 1.0, "to": 30.0, "n": 20, "find": "overturning"}
    vary = {"motion.record.file": files, "motion.record.pga": pga}
    found = rockcli.run({"name": "s", "case": case, "vary": vary, "over": {"axis": "record", "intensity": "cav"}})
    capacity = found["motion_record_pga_overturning"].values * np.array(cav)
    np.testing.assert_allclose(found["fragility_intensity"].values, capacity, rtol=1e-4)
    begins = G * np.tan(ALPHA) * min(cav)
    u = np.log(capacity - begins)
    assert float(found["fragility_median"][0]) == pytest.approx(begins + np.exp(u.mean()), rel=1e-3)
    vary = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": {"from": 0.5, "to": 9.0, "n": 9, "find": "overturning"}}
    none = rockcli.run(study(vary=vary, over={"axis": "motion.pulse.omega_p", "intensity": "cav"}))
    assert "fragility_median" not in none
    assert "the intensity cav is not known of these motions" in none.attrs["warnings"]


def test_fragility_of_a_search_is_the_sample_of_its_thresholds():
    """One lowest overturning value of every member: mean and scatter of their logarithms above uplift."""
    vary = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": {"from": 0.5, "to": 9.0, "n": 9, "find": "overturning"}}
    found = rockcli.run(study(vary=vary))
    u = np.log(found["motion_pulse_a_p_overturning"].values - G * ALPHA)
    assert float(found["fragility_begins_at"]) == pytest.approx(G * ALPHA, rel=1e-12)
    assert found["limit_state"].values.tolist() == ["overturned"]
    assert float(found["fragility_median"][0]) == pytest.approx(G * ALPHA + np.exp(u.mean()), rel=1e-9)
    assert float(found["fragility_beta"][0]) == pytest.approx(u.std(), rel=1e-9)
    told = rockcli.run(study(vary=vary, over={"axis": "motion.pulse.omega_p", "intensity": "pgv"}))
    factor = told["pgv"].values / 0.5  # PGV for one m/s² of the amplitude, of every member
    np.testing.assert_allclose(
        told["fragility_intensity"].values, told["motion_pulse_a_p_overturning"].values * factor, rtol=1e-9
    )
    assert float(told["fragility_begins_at"]) == pytest.approx((G * ALPHA * factor).min(), rel=1e-9)
    hazard = {"intensity": [0.2, 20], "rate": [0.1, 1e-6]}
    risk = rockcli.run(study(vary=vary, hazard=hazard))
    assert float(risk["annual_rate"][0, 0]) > 0.0
    short = {**vary, "motion.pulse.a_p": {"from": 0.5, "to": 1.8, "n": 5, "find": "overturning"}}
    censored = rockcli.run(study(vary=short))  # some overturn nowhere in the range: they still count
    assert np.isinf(censored["motion_pulse_a_p_overturning"].values).any()
    with pytest.raises(StudyError, match="of a search is one of pga"):
        rockcli.run(study(vary=vary, over={"axis": "motion.pulse.omega_p", "intensity": "pgv_over_pga"}))


def test_how_far_the_curves_of_many_bodies_and_the_figures_are_is_logged(tmp_path, caplog):
    """After the last case a terminal showed nothing new for as long as that took: 15 s of 500 bodies."""
    caplog.set_level("INFO", "rockcli")
    plan = study() | {"vary": {"block.R": [3, 4, 5], **study()["vary"]}, "plots": ["fragility"]}
    run_study(open_study(plan), tmp_path)
    told = [f"fragility of body {i} of 3" for i in (1, 2, 3)] + ["drawing fragility.png"]
    assert [record.getMessage() for record in caplog.records if record.name.startswith("rockcli")] == told
