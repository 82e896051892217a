"""Fragility convolved with hazard curves: closed forms, quadrature of scipy, tails, files, and what is refused."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scenes import G
from scipy import integrate, stats

import rockcli
from rockcli.analysis.fragility.annual_rate import Fragility, annual_rate, rates_of
from rockcli.analysis.fragility.curves import Scatter, curve_of_capacities
from rockcli.analysis.suites import words
from rockcli.analysis.suites.risk import _limits, central
from rockcli.engine.run import run_study
from rockcli.errors import StudyError
from rockcli.scene.ground.hazard import HazardCurve
from rockcli.scene.variables import UNIT_OF_INTENSITY, VARIABLES
from rockcli.storage.read import from_xarray
from rockcli.study.open import open_study
from rockcli.study.study import Over


def power_law(k=2.5, at=3.0, rate=1e-3, low=1e-8, high=1e5, n=14) -> HazardCurve:
    x = np.geomspace(low, high, n)
    return HazardCurve("power", x, rate * (x / at) ** -k)


BENT = HazardCurve("bent", np.array([0.05, 0.1, 0.3, 1.0, 3.0]), np.array([0.1, 2e-2, 1e-3, 2e-5, 1e-8]))


@pytest.mark.parametrize("k", [1.0, 2.5, 4.0])
@pytest.mark.parametrize("beta", [0.02, 0.2, 0.6, 1.1])
@pytest.mark.parametrize("median", [0.7, 3.0, 20.0])
def test_a_lognormal_curve_and_a_power_law_have_a_closed_form(k, beta, median):
    found = annual_rate(Fragility(median, beta), power_law(k))
    expected = 1e-3 * (median / 3.0) ** -k * math.exp(0.5 * (k * beta) ** 2)
    assert found.total == pytest.approx(expected, rel=1e-6)
    assert found.above < 1e-6 * found.total
    assert found.below < 1e-6 * found.total


@pytest.mark.parametrize(
    ("median", "beta", "begins"), [(0.5, 0.4, 0.2), (0.5, 0.9, 0.2), (1.0, 0.3, 0.0), (0.12, 0.05, 0.1)]
)
def test_curves_that_begin_at_uplift_are_those_of_scipys_quadrature(median, beta, begins):
    """The density of the capacity times the hazard curve, integrated by parts: another form of the same integral."""
    dist = stats.lognorm(beta, loc=begins, scale=median - begins)
    first, last = BENT.intensity[0], BENT.intensity[-1]
    breaks = BENT.intensity[1:-1]
    parts = [
        integrate.quad(lambda x: dist.pdf(x) * np.exp(np.interp(np.log(x), np.log(BENT.intensity), np.log(BENT.rate))), a, b,
                       epsabs=0.0, epsrel=1e-11, limit=400, points=[c for c in (begins, median) if a < c < b] or None)[0]
        for a, b in zip([first, *breaks], [*breaks, last], strict=True)
    ]  # fmt: skip
    expected = dist.cdf(first) * BENT.rate[0] + sum(parts)
    found = annual_rate(Fragility(median, beta, begins), BENT)
    assert found.total == pytest.approx(expected, rel=1e-8)
    assert found.above == pytest.approx(dist.sf(last) * BENT.rate[-1], rel=1e-9)
    if begins >= first:
        assert found.below == 0.0


def test_tails_are_those_of_the_power_law_that_goes_on():
    """Cut off below and above, the rate and its tails bracket the whole."""
    curve, whole = Fragility(3.0, 0.6), power_law()
    cut = power_law(low=2.0, high=5.0, n=2)
    found, expected = annual_rate(curve, cut), annual_rate(curve, whole).total
    assert found.total < expected < found.total + found.above + found.below
    beneath = integrate.quad(lambda x: stats.norm.cdf(np.log(x / 3.0) / 0.6) * 2.5 * 1e-3 / 3.0 * (x / 3.0) ** -3.5, 0.0, 2.0,
                             epsabs=0.0, epsrel=1e-10)[0]  # fmt: skip
    assert found.below == pytest.approx(beneath, rel=1e-7)


@pytest.mark.parametrize("beta", [15.0, 25.0, 1e3])
def test_a_curve_that_hardly_grows_has_a_rate(beta):
    """Its beginning underflows to zero; the rate is the probability at the last point and the density before it."""
    with np.errstate(all="ignore"):  # as where statistics are worked out
        found = annual_rate(Fragility(3.0, beta), BENT)
    dist = stats.norm(math.log(3.0), beta)
    u, log_rate = np.log(BENT.intensity), np.log(BENT.rate)
    parts = [integrate.quad(lambda v: dist.pdf(v) * np.exp(np.interp(v, u, log_rate)), a, b)[0] for a, b in pairwise(u)]
    assert found.total == pytest.approx(dist.cdf(u[0]) * BENT.rate[0] + sum(parts), rel=1e-8)
    assert found.below > found.total


def test_the_parts_of_a_rate_are_those_between_their_edges():
    curve = Fragility(0.5, 0.4, 0.2)
    edges = np.geomspace(0.04, 4.0, 13)
    found = annual_rate(curve, BENT, edges)
    assert found.parts.sum() == pytest.approx(found.total, rel=1e-14)
    x = np.unique(np.concatenate([np.geomspace(0.05, 3.0, 400_001), edges[(edges > 0.05) & (edges < 3.0)]]))
    p = 0.5 * (curve(x[1:]) + curve(x[:-1]))
    at = np.searchsorted(edges, np.sqrt(x[1:] * x[:-1]), side="right") - 1
    expected = np.bincount(at, -np.diff(BENT(x)) * p, minlength=12)
    expected[np.searchsorted(edges, 3.0) - 1] += curve(np.array([3.0]))[0] * BENT.rate[-1]
    np.testing.assert_allclose(found.parts, expected, rtol=1e-5, atol=1e-16)


SINES = [1.0, 1.5, 2.0, 3.0, 4.0]


def study(**more):
    return {
        "name": "risk",
        "case": {
            "block": {"R": 0.75 * G, "alpha": 0.1},
            "motion": {"pulse": {"shape": "half_sine", "a_p": 1.0, "omega_p": 1.0}},
        },
        "over": {"axis": "motion.pulse.omega_p", "along": "a_p", "limits": [0.5]},
        "hazard": [
            {"label": "one", "intensity": ["0.02*g", "0.1*g", "0.5*g", "2*g"], "rate": [1e-1, 1e-2, 2e-4, 1e-6]},
            {"intensity": ["0.02*g", "2*g"], "rate": [1e-2, 1e-6]},
        ],
        "age": 500,
        "vary": {
            "motion.pulse.omega_p": SINES,
            "motion.pulse.a_p": {"from": 0.5 * G * 0.1, "to": 8.0 * G * 0.1, "n": 16},
        },
        "save": {"histories": False},
    } | more


@pytest.fixture(scope="module")
def data():
    return rockcli.run(study())


def test_the_dataset_has_rates_survival_and_where_they_come_from(data):
    assert data["annual_rate"].dims == ("limit_state", "hazard")
    assert data["hazard"].values.tolist() == ["one", "hazard 2"]
    for i, hazard in enumerate(
        [HazardCurve("", np.array([0.02, 0.1, 0.5, 2.0]) * G, np.array([1e-1, 1e-2, 2e-4, 1e-6])),
         HazardCurve("", np.array([0.02, 2.0]) * G, np.array([1e-2, 1e-6]))]
    ):  # fmt: skip
        for j in range(2):
            curve = Fragility(
                *(float(data[f"fragility_{name}"][j]) for name in ("median", "beta")),
                float(data["fragility_begins_at"]),
            )
            assert float(data["annual_rate"][j, i]) == pytest.approx(annual_rate(curve, hazard).total, rel=1e-12)
    rate = data["annual_rate"]
    assert (rate.sel(limit_state="0.5") > rate.sel(limit_state="overturned")).all()
    assert (data["annual_rate_ci_low"] < rate).all()
    assert (rate < data["annual_rate_ci_high"]).all()
    np.testing.assert_allclose(data["survival"], np.exp(-500.0 * rate), rtol=1e-12)
    np.testing.assert_allclose(data["probability_in_age"] + data["survival"], 1.0, rtol=1e-12)
    np.testing.assert_allclose(data["likelihood_ratio"], data["survival"] / data["survival"].max("hazard"), rtol=1e-12)
    np.testing.assert_array_equal(data["hazard_consistent"], data["survival"] >= 0.05)
    np.testing.assert_allclose(data["deaggregation"].sum("intensity_bin"), 1.0, rtol=1e-12)


@pytest.mark.slow
def test_intensities_are_in_units_of_what_the_fragility_is_told_against(data):
    those = {name for name, row in VARIABLES.items() if row.unit == UNIT_OF_INTENSITY} & set(data.variables)
    assert {"fragility_median", "fragility_percentile", "hazard_intensity", "intensity_bin"} < those
    assert {data[name].attrs["units"] for name in those} == {"m s-2"}
    assert not [name for name, item in data.variables.items() if "intensity" in item.attrs.get("units", "")]


@pytest.mark.parametrize(("beta", "begins_at", "freedom"), [(0.4, 0.0, 11.0), (0.7, 0.0, 41.0), (0.9, 0.25 * G, 4.0)])
def test_limits_of_a_rate_are_those_of_curves_drawn_from_what_the_scatter_allows(beta, begins_at, freedom):
    hazard = HazardCurve("", np.array([0.02, 0.1, 0.5, 2.0]) * G, np.array([1e-1, 1e-2, 2e-4, 1e-6]))
    scatter = Scatter(beta, beta * math.sqrt((freedom + 1.0) / freedom), freedom, 0.1, 1.0 / math.sqrt(freedom + 1.0))
    curve, added = Fragility(0.6 * G, math.hypot(beta, 0.2), begins_at), 0.2
    draw = np.random.default_rng(3)
    betas = scatter.unbiased / np.sqrt(draw.chisquare(freedom, 20000) / freedom)
    ln = np.log(0.6 * G - begins_at) + 0.1 * (betas - beta) + scatter.scale * betas * draw.standard_normal(20000)
    drawn = rates_of(ln, np.hypot(betas, added), begins_at, hazard)
    some = [annual_rate(Fragility(begins_at + math.exp(ln[i]), math.hypot(betas[i], added), begins_at), hazard).total
            for i in range(50)]  # fmt: skip
    np.testing.assert_allclose(drawn[:50], some, rtol=0.02)
    low, high = _limits(curve, scatter, hazard, added, annual_rate(curve, hazard).total)
    assert np.mean(drawn < low) == pytest.approx(0.025, abs=0.004)
    assert np.mean(drawn > high) == pytest.approx(0.025, abs=0.004) or high == hazard.rate[0]


def test_limits_of_rates_hold_them_above_as_often_as_they_say():
    """Of twelve capacities; by the delta method one rate in seven lies above its upper limit."""
    draw, x = np.random.default_rng(5), np.geomspace(0.01, 20.0, 8)
    hazard = HazardCurve("", x, 1e-3 * (x / 0.6) ** -3.0)
    truth, above, below, suites = annual_rate(Fragility(0.6, 0.7), hazard).total, 0, 0, 200
    for _ in range(suites):
        capacity = 0.6 * np.exp(0.7 * draw.standard_normal(12))
        made = curve_of_capacities(capacity, capacity, np.arange(12))
        curve = Fragility(float(made.median[0]), float(made.beta[0]))
        low, high = _limits(curve, made.scatter()[0], hazard, 0.0, annual_rate(curve, hazard).total)
        above, below = above + (truth > high), below + (truth < low)
    assert above < 0.06 * suites
    assert below < 0.06 * suites


def test_uncertainty_that_is_added_counts(data):
    more = rockcli.run(study(over={"axis": "motion.pulse.omega_p", "along": "a_p", "limits": [0.5], "beta_added": 0.4}))
    assert (more["annual_rate"].sel(limit_state="overturned") > data["annual_rate"].sel(limit_state="overturned")).all()
    total = float(more["fragility_beta_total"].sel(limit_state="overturned"))
    assert f" ({total:.4g} with beta_added), 5 % at" in more.attrs["ensemble"]


def test_what_beta_added_leaves_to_small_percentiles_is_told():
    """Near the intensity at which a curve begins it moves them by a fraction of what it does from zero."""
    over = {"axis": "motion.pulse.omega_p", "along": "a_p"}
    low, said = {}, {}
    for begins in ("uplift", 0):
        for added in (0.0, 0.4):
            data = rockcli.run(study(over={**over, "begins_at": begins, "beta_added": added}))
            low[begins, added] = np.log(float(data["fragility_percentile"][-1, 0]))
            said[begins, added] = "small percentiles hardly feel it" in data.attrs["warnings"]
    moved = {begins: low[begins, 0.0] - low[begins, 0.4] for begins in ("uplift", 0)}
    assert 0.0 < moved["uplift"] < 0.2 * moved[0]
    assert said == {("uplift", 0.0): False, ("uplift", 0.4): True, (0, 0.0): False, (0, 0.4): False}


def test_a_direction_is_drawn_anew():
    over = Over(("sample",), None, (), mean=False, inputs=("block.direction",), hazard=(BENT,), age=1.0)
    assert not list(words._drawn_anew(over))
    told = " ".join(words._drawn_anew(replace(over, inputs=("block.direction", "block.h"))))
    assert "takes block.h as" in told
    assert "over:" not in told  # there is nothing else to take statistics over


def test_a_body_that_is_not_well_known_is_not_drawn_anew(data):
    """The mean survival of bodies is above that under their mean rate (Jensen): a warning where they are mixed."""
    more = {"uncertain": {"block.tan_alpha": {"normal": [0.2, 0.03]}}, "samples": 20, "age": 3000}
    axes = {"axis": ["motion.pulse.omega_p", "sample"], "along": "a_p", "limits": [0.5]}
    mixed = rockcli.run(study(over=axes, **more))
    each = rockcli.run(study(over=axes | {"axis": "motion.pulse.omega_p"}, **more))
    told = ["drawn anew" in one.attrs["warnings"] for one in (mixed, each)]
    assert told == [True, False]
    advised = re.search(r"`over: (\w+)` tells the survival of every sample", mixed.attrs["warnings"])
    assert advised is not None
    np.testing.assert_array_equal(rockcli.run(study(over=axes | {"axis": advised[1]}, **more)).survival, each.survival)
    one = each.sel(limit_state="overturned")
    assert (one.survival.mean("sample") > np.exp(-3000 * one.annual_rate.mean("sample"))).all()
    says = [said for said in json.loads(each.attrs["ensemble"])["says"] if "mean of the 20 samples" in said]
    for said, of in zip(says, one.survival.transpose("hazard", "sample").values, strict=True):
        numbers = re.search(r"survives with (\S+) on the mean of the 20 samples, (\S+) to (\S+) by sample", said)
        assert [float(x) for x in numbers.groups()] == pytest.approx([of.mean(), of.min(), of.max()], rel=5e-3)
        assert ("is consistent with" in said) == (of.mean() >= 0.05)
    assert not any("of the 20 samples" in said for said in json.loads(mixed.attrs["ensemble"])["says"])


def test_samples_without_a_curve_leave_a_verdict_on_their_body_open():
    """Of amplitudes too low for most samples the weakest alone have curves, and their mean is far below that of all."""
    wide = {"from": 0.5, "to": 30.0, "n": 60}
    told = {}
    for name, amplitudes in (("few", wide | {"to": 1.8, "n": 10}), ("all", wide)):
        data = rockcli.run(
            study(
                vary={"motion.pulse.omega_p": SINES, "motion.pulse.a_p": amplitudes},
                over={"axis": "motion.pulse.omega_p", "along": "a_p"},
                uncertain={"block.tan_alpha": {"normal": [0.2, 0.05], "truncate": [0.05, 0.4]}},
                samples=20,
                age=4000,
            )
        )
        (said,) = (one for one in json.loads(data.attrs["ensemble"])["says"] if "under one" in one and "mean of" in one)
        survival = data["survival"].sel(limit_state="overturned", hazard="one").values
        told[name] = said, survival[np.isfinite(survival)]
    (few, known), (every, of_all) = told["few"], told["all"]
    assert 0 < len(known) < len(of_all) == 20
    assert known.mean() < 0.05 < of_all.mean()
    assert "is consistent with one" in every
    assert f"the {len(known)} of 20 samples that have a curve" in few
    assert "is open: see fragility_status" in few
    ends = [float(x) for x in re.search(r"with the others the mean is (\S+) to (\S+),", few).groups()]
    assert ends == pytest.approx([known.sum() / 20, (known.sum() + 20 - len(known)) / 20], rel=5e-3)
    assert ends[0] <= of_all.mean() <= ends[1]


def test_a_dataset_runs_again_without_its_files(data):
    assert "hazard" in data.attrs["study"]
    import yaml

    again = rockcli.run(yaml.safe_load(data.attrs["study"]))
    np.testing.assert_array_equal(again["annual_rate"], data["annual_rate"])


def test_tables_have_a_row_per_limit_state_and_curve(data):
    table = rockcli.table(data, of="risk")
    assert len(table) == 4
    assert list(table.columns[:3]) == ["limit_state", "hazard", "annual_rate [year-1]"]
    assert len(rockcli.table(data, of="deaggregation")) == 4 * data.sizes["intensity_bin"]


@pytest.mark.slow
def test_a_body_without_a_rate_says_why(tmp_path):
    """One that nothing overturns and one that all motions do within a step have no rate alike."""
    amplitudes = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": [1.01 * G * 0.1, 90.0 * G * 0.1]}
    over = {"axis": "motion.pulse.omega_p", "along": "a_p"}
    sizes = {"large": {"block.R": 1e6}, "small": {"block.R": 0.1}}
    data = rockcli.run(study(over=over, vary={"case": sizes, **amplitudes}))
    table = rockcli.table(data, of="risk")
    table = table[table["hazard"] == "one"]
    assert table["annual_rate [year-1]"].isna().all()
    assert dict(zip(table["case"], table["fragility_status"], strict=True)) == {
        "large": "none_exceeds",
        "small": "separable",
    }
    rockcli.report(data, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<td>none (none exceeds)</td>" in page
    assert "none (separable): it goes from none to all within a step" in page


def test_of_many_bodies_the_worst_are_told():
    """Smaller bodies overturn more easily: of eight, in whatever order, the two largest are left to the table."""
    sizes = [3.0, 0.5, 2.0, 1.0, 4.0, 0.7, 1.5, 5.0]
    bodies = {f"R{R:g}": {"block.R": R * G} for R in sizes}
    amplitudes = {"motion.pulse.omega_p": SINES, "motion.pulse.a_p": {"from": 0.5, "to": 20, "n": 24}}
    over = {"axis": "motion.pulse.omega_p", "along": "a_p"}
    data = rockcli.run(study(over=over, vary={"case": bodies, **amplitudes}))
    says = json.loads(data.attrs["ensemble"])["says"]
    for said in ("median motion_pulse_a_p", "annual rate under one"):
        told = dict.fromkeys(one.partition(":")[0] for one in says if said in one)
        assert list(told) == [f"case=R{R:g}" for R in sorted(sizes)[:6]]
    assert sum("and 2 more bodies" in one and "--sort" in one for one in says) == 2


def test_a_survival_just_below_one_is_not_told_as_one():
    weak = [{"label": "weak", "intensity": ["0.02*g", "2*g"], "rate": [1e-5, 1e-9]}]
    data = rockcli.run(study(hazard=weak))
    (said,) = [one for one in json.loads(data.attrs["ensemble"])["says"] if "survives with" in one]
    told = float(re.search(r"survives with ([0-9.]+)", said)[1])
    falls = 1.0 - float(data["survival"].sel(limit_state="overturned").squeeze())
    assert 1e-6 < falls < 4e-4
    assert told < 1.0
    assert told == pytest.approx(1.0 - falls, abs=0.5 * falls)


def test_a_probability_far_below_rounding_of_one_is_told():
    """-expm1(-rate age) has its digits where the survival is 1.0 to the last bit."""
    rare = [{"label": "rare", "intensity": ["0.02*g", "2*g"], "rate": [1e-15, 1e-19]}]
    data = rockcli.run(study(hazard=rare, age=1))
    (said,) = [one for one in json.loads(data.attrs["ensemble"])["says"] if "survives with" in one]
    rate = float(data["annual_rate"].sel(limit_state="overturned").squeeze())
    assert 0.0 < rate < 1e-16
    assert float(re.search(r"overturns with probability (\S+),", said)[1]) == pytest.approx(rate, rel=5e-3)


def test_survival_has_limits_and_says_where_they_leave_a_contradiction_open(data):
    """exp(-rate age) at the limits of the rate; 5 % lies beside, below or above them as the age grows."""
    low, rate, high = (
        float(data[f"annual_rate{end}"].sel(limit_state="overturned", hazard="one"))
        for end in ("_ci_low", "", "_ci_high")
    )
    least = -np.log(0.05)  # rate times age at which 5 % survive
    for age, known in (
        (0.5 * least / high, "is consistent with one (likelihood"),
        (least / np.sqrt(rate * high), "is consistent with one, though not at the lower limit (likelihood"),
        (least / np.sqrt(rate * low), "contradicts one at 5 %, though not at the upper limit (likelihood"),
        (2.0 * least / low, "contradicts one at 5 % (likelihood"),
    ):
        says = json.loads(rockcli.run(study(age=float(age))).attrs["ensemble"])["says"]
        (said,) = (one for one in says if "years under one" in one)
        assert known in said
        ends = re.search(r"survives with \S+ \(95 % (\S+) to (\S+)\);", said)
        assert [float(end) for end in ends.groups()] == pytest.approx(
            [np.exp(-high * age), np.exp(-low * age)], rel=5e-3
        )


def test_the_middle_of_a_rate_is_told_to_its_digits():
    """Bins of the deaggregation are too wide for it: those of a curve over five decades are of a factor 1.65."""
    wide = [{"label": "wide", "intensity": ["1e-4*g", "0.05*g", "20*g"], "rate": [1.0, 1e-2, 1e-9]}]
    data = rockcli.run(study(hazard=wide))
    median, beta = (float(data[f"fragility_{name}"].sel(limit_state="overturned")) for name in ("median", "beta"))
    curve = Fragility(median, beta, float(data["fragility_begins_at"]))
    x = np.geomspace(1e-4 * G, 20.0 * G, 200001)
    rate = np.exp(np.interp(np.log(x), np.log(np.array([1e-4, 0.05, 20.0]) * G), np.log([1.0, 1e-2, 1e-9])))
    p = curve(x)
    below = np.cumsum(0.5 * (p[1:] + p[:-1]) * -np.diff(rate))
    expected = np.interp([0.16, 0.84], below / below[-1], x[1:])
    np.testing.assert_allclose(central(from_xarray(data), (1, 0)), expected, rtol=1e-3)


@pytest.mark.parametrize(("last", "said"), [(6e-4, "; 84 % of it from"), (0.0999, "more than 84 % of it from beyond")])
def test_where_a_rate_comes_from_beyond_its_hazard_curve_no_end_is_told(last, said):
    """Motions beyond the last point count as if at it, but are no reason to say that they are not stronger."""
    short = [{"label": "short", "intensity": ["0.02*g", "0.25*g"], "rate": [0.1, last]}]
    data = rockcli.run(study(hazard=short))
    median, beta = (float(data[f"fragility_{name}"].sel(limit_state="overturned")) for name in ("median", "beta"))
    curve = Fragility(median, beta, float(data["fragility_begins_at"]))
    x = np.geomspace(0.02 * G, 0.25 * G, 200001)
    part = 0.5 * (curve(x[1:]) + curve(x[:-1])) * -np.diff(np.geomspace(0.1, last, len(x)))
    beyond = float(curve(x[-1:])[0]) * last
    share = part.sum() / (part.sum() + beyond)
    low, high = central(from_xarray(data), (1, 0))
    assert np.isinf(high)
    assert np.isinf(low) == (share < 0.16)
    if share > 0.16:
        assert low == pytest.approx(np.interp(0.16, np.cumsum(part) / (part.sum() + beyond), x[1:]), rel=1e-3)
    assert said in data.attrs["ensemble"]


def test_no_body_falls_more_often_than_the_ground_moves():
    """The upper limit of a rate, of five motions that scatter, is hardly below that of all motions together."""
    flat = [{"label": "flat", "intensity": ["0.15*g", "2*g"], "rate": [2e-4, 1e-4]}]
    data = rockcli.run(study(hazard=flat)).isel(hazard=0)
    assert (data["annual_rate"] < data["annual_rate_ci_high"]).all()
    assert (data["annual_rate_ci_high"] <= 2e-4).all()
    assert (data["annual_rate_ci_high"] > 1.9e-4).any()


def test_a_clause_may_name_a_hazard_curve(tmp_path):
    clause = {"quantity": "survival", "at": {"limit_state": "overturned", "hazard": "one"}, "min": 0.0, "max": 1.0}
    del clause["max"]
    assert rockcli.run(study(expect=[clause]))["survival"].size
    with pytest.raises(StudyError, match="hazard"):
        rockcli.run(study(expect=[clause | {"at": {"hazard": "three"}}]))


def test_a_clause_that_names_both_reads_that_limit_state_under_that_curve(tmp_path):
    wanted = study(over={"axis": "motion.pulse.omega_p", "along": "a_p", "limits": [0.2, 0.5]})
    rates = rockcli.run(wanted)["annual_rate"]
    clauses = [
        {"quantity": "annual_rate", "at": {"limit_state": state, "hazard": hazard}, "value": value, "rtol": 1e-12}
        for state in rates["limit_state"].values
        for hazard in rates["hazard"].values
        if (value := float(rates.sel(limit_state=state, hazard=hazard)))
    ]
    report = run_study(open_study(wanted | {"expect": clauses}), tmp_path, plots=False)
    assert [verdict.passed for verdict in report.verdicts] == [True] * 6


def test_tails_outside_the_curve_are_a_warning():
    short = {"label": "short", "intensity": ["0.11*g", "0.15*g"], "rate": [1e-2, 3e-3]}
    data = rockcli.run(study(hazard=short))
    said = " ".join(json.loads(data.attrs["warnings"]))
    assert "hazard short ends where bodies may remain stable" in said
    assert (data["annual_rate_above"].sel(limit_state="overturned") > 0.0).all()


def test_a_curve_that_ends_below_the_fragility_is_no_rate_of_zero_alone(tmp_path):
    """Intensities in g taken for m/s2: no motion of the curve moves a body, and those beyond its end may."""
    low = {"label": "low", "intensity": [0.05, 0.2, 0.8], "rate": [2e-2, 1e-3, 1e-5]}
    report = run_study(open_study(study(hazard=low, age=50)), tmp_path, plots=False)
    assert (rockcli.open_dataset(str(report.file))["annual_rate"] == 0.0).all()
    told = " ".join([*report.suite, *report.warnings])
    assert "nan" not in told
    assert "inf" not in told
    assert "can add up to 1e-05 a year to a rate of 0 (annual_rate_above): are its units right?" in told


def test_no_curve_is_consistent_without_a_doubt_with_what_it_does_not_tell():
    """A curve that ends where bodies begin to fall allows any age; with the rate of its last point it may not."""
    low = {"label": "low", "intensity": ["0.05*g", "0.1*g"], "rate": [2e-2, 1e-3]}
    for age, doubt in ((500.0, False), (2900.0, False), (3100.0, True)):  # 5 % at rate times age of 2.996
        says = json.loads(rockcli.run(study(hazard=low, age=age)).attrs["ensemble"])["says"]
        (said,) = (one for one in says if "years under low" in one)
        assert "is consistent with low" in said
        assert ("though not with what motions beyond its end can add, 0.001 a year" in said) == doubt


def test_a_curve_that_begins_too_late_is_a_warning():
    late = {"label": "late", "intensity": ["0.15*g", "0.3*g"], "rate": [1e-2, 1e-3]}
    said = " ".join(json.loads(rockcli.run(study(hazard=late)).attrs["warnings"]))
    assert "hazard late begins where a limit state is exceeded already" in said


OPENQUAKE = """\
#,,,,,"generated_by='OpenQuake engine 3.18.0', start_date='2023-10-03T06:09:08', checksum=2107362341, kind='mean', investigation_time=50.0, imt='{imt}'"
lon,lat,depth,poe-0.0100000,poe-0.1000000,poe-0.5000000,poe-2.0000000,poe-3.0000000
10.00000,45.00000,0.00000,1.000000E+00,3.354511E-01,1.500000E-02,1.000000E-03,0.000000E+00
10.50000,45.00000,0.00000,9.000000E-01,2.354511E-01,1.000000E-02,1.000000E-04,1.000000E-06
"""


def of_file(tmp_path, text, **more):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    base = study(hazard={"file": str(tmp_path / "curve.csv"), **more})
    base["over"] = base["over"] | {"intensity": "pga"}
    return rockcli.run(base)


def test_the_curves_openquake_exports(tmp_path):
    data = of_file(tmp_path, OPENQUAKE.format(imt="PGA"), site=[10, 45], label="mean")
    np.testing.assert_allclose(data["hazard_intensity"][0], np.array([0.1, 0.5, 2.0]) * G, rtol=1e-12)
    np.testing.assert_allclose(
        data["hazard_rate"][0], -np.log(1.0 - np.array([3.354511e-1, 1.5e-2, 1e-3])) / 50.0, rtol=1e-12
    )
    said = " ".join(json.loads(data.attrs["warnings"]))
    assert "1 point of probability 1" in said
    assert "1 point of rate 0" in said
    other = of_file(tmp_path, OPENQUAKE.format(imt="PGA"), site=[10.5, 45])
    assert other["hazard"].values.tolist() == ["curve"]
    assert other.sizes["hazard_point"] == 5


def test_a_table_of_intensity_and_rate(tmp_path):
    data = of_file(tmp_path, "# made up\npga [g],rate\n0.02,0.1\n0.1,0.01\n0.5,2e-4\n2,1e-6\n")
    np.testing.assert_allclose(data["hazard_intensity"][0], np.array([0.02, 0.1, 0.5, 2.0]) * G, rtol=1e-12)
    plain = of_file(tmp_path, "intensity,rate\n0.2,0.1\n1,0.01\n20,1e-6\n")  # SI units, as everywhere
    np.testing.assert_allclose(plain["hazard_intensity"][0], [0.2, 1.0, 20.0])
    ground = of_file(tmp_path, "ground_pga [g],rate\n0.02,0.1\n0.1,0.01\n0.5,2e-4\n2,1e-6\n")  # as `over` calls it
    np.testing.assert_array_equal(ground["hazard_intensity"], data["hazard_intensity"])


@pytest.mark.parametrize(
    ("against", "text", "unit"),
    [
        ("arias", "arias [m/s],rate\n0.1,0.01\n0.5,0.001\n", 1.0),
        ("arias", OPENQUAKE.format(imt="IA"), 1.0),
        ("cav", "cav [cm/s],rate\n0.1,0.01\n0.5,0.001\n", 0.01),
        ("cav", "cav [g s],rate\n0.1,0.01\n0.5,0.001\n", G),
        ("cav", OPENQUAKE.format(imt="CAV"), G),
        ("floor_pga", "intensity [g],rate\n0.1,0.01\n0.5,0.001\n", G),
    ],
)
def test_units_of_a_hazard_curve(tmp_path, against, text, unit):
    """OpenQuake's imt module: IA in m/s, CAV in g s."""
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    site = {"site": [10.0, 45.0]} if text.startswith("#") else {}
    along = "floor_pga" if against == "floor_pga" else "record.scale"
    motion = {"record": {"file": "synthetic_rock_m65.AT2"}}
    if against == "floor_pga":
        motion |= {"through": [{"T": 0.3, "zeta": 0.05}], "floor_pga": 1.0}
    dataset = rockcli.run(
        {
            "name": "units",
            "case": {"block": {"R": 1.0, "tan_alpha": 0.2}, "motion": motion},
            "vary": {"motion.record.file": "synthetic_*.AT2", f"motion.{along}": [1.0, 3.0, 6.0, 12.0]},
            "over": {"axis": "record"} | ({} if against == "floor_pga" else {"intensity": against}),
            "hazard": {"file": str(tmp_path / "curve.csv"), **site},
            "save": {"histories": False},
        }
    )
    used = dataset["hazard_intensity"].values[0]
    expected = [0.1, 0.5, 2.0] if site else [0.1, 0.5]
    assert used[:3] == pytest.approx(np.array(expected) * unit, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "more", "words"),
    [
        (OPENQUAKE.format(imt="PGA"), {}, "holds 2 sites"),
        (OPENQUAKE.format(imt="PGA"), {"site": [11, 45]}, "has no site 11, 45; the nearest is 10.5"),
        (OPENQUAKE.format(imt="SA(0.3)"), {"site": [10, 45]}, r"is a hazard curve of SA\(0.3\), the fragility is told against pga"),
        (OPENQUAKE.replace("investigation_time", "time"), {"site": [10, 45]}, "investigation_time"),
        ("pga [g],rate\n0.1,0.01\n", {}, "a line per point"),
        ("0.1,0.01\n0.2,0.001\n0.3,1e-4\n", {}, "the first line names the columns"),
        ("pgv [m/s],rate\n0.1,0.01\n0.2,0.001\n", {}, "is a hazard curve of pgv"),
        ("pga [km],rate\n0.1,0.01\n0.2,0.001\n", {}, "no unit of pga"),
        ("pga [g],rate\n0.1,0.01\n0.2,0.001\n", {"units": "cm/s2"}, "in g, `units` says cm/s2"),
        ("pga [g],rate\n0.1,0.01\n0.2,0.02\n", {}, "csv:3: .*never grow"),
        ("pga [g],rate\n# a note\n0.1,0.01\n\n0.2,-0.02\n", {}, "csv:5: .*not negative"),
        ('"pga\n[g]",rate\n0,0.01\n0.2,0.02\n', {}, "csv:3: .*greater than 0"),
        ("pga [g],rate\n0.1,0.01\n0.2,nan\n", {}, "csv:3: .*not finite"),
        ("pga [g],rate\n0.2,0.01\n0.1,0.001\n", {}, "csv:3: .*ascend"),
        ("pga [g],rate\n0.1,0.01\n0.2,abc\n", {}, "'abc' is no number"),
        ("pga [g],return period\n0.1,100\n0.2,1000\n", {}, "expected rate"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_hazard_curve_is_refused(tmp_path, text, more, words):
    with pytest.raises(StudyError, match=words):
        of_file(tmp_path, text, **more)


def test_a_file_that_is_not_there_is_told_with_its_place(tmp_path):
    file = tmp_path / "s.yaml"
    base = study(hazard=["none.csv"])
    file.write_text(json.dumps(base | {"over": base["over"] | {"intensity": "pga"}}, indent=1))
    line = next(i for i, each in enumerate(file.read_text().splitlines(), start=1) if "none.csv" in each)
    with pytest.raises(StudyError, match=r"hazard\[0\]: there is no such file, .*none\.csv") as caught:
        rockcli.run(file)
    assert (caught.value.file, caught.value.line) == (str(file), line)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"over": None}, "hazard needs fragility curves"),
        ({"over": {"axis": "motion.pulse.omega_p", "fit": "none"}}, "hazard needs fragility curves"),
        ({"hazard": None}, "age belongs to `hazard`"),
        ({"hazard": {"intensity": [1, 2]}}, "expected FILE.csv, or"),
        ({"hazard": {"intensity": [1, 2], "rate": [0.1]}}, "2 intensities and 1 rates"),
        ({"hazard": {"intensity": [1, 2], "rate": [0.1, 0]}}, "fewer than two points"),
        ({"hazard": [{"label": "a", "intensity": [1, 2], "rate": [0.1, 0.01]}] * 2}, "second curve named 'a'"),
        ({"hazard": "nowhere.csv"}, "no such file"),
        (
            {"hazard": {"intensity": [1, 2], "rate": [0.1, 0.01], "site": [1, 2]}},
            "site chooses among the sites of a file",
        ),
        ({"hazard": {"intensity": ["0.1*g", 2], "rate": [0.1, 0.01], "units": "g"}}, "'0.1\\*g' says its unit"),
        ({"age": -3}, "age is -3"),
    ],
)
def test_what_is_wrong_with_a_study_of_risk_is_one_sentence(more, words):
    asked = {name: value for name, value in study(**more).items() if value is not None}
    with pytest.raises(StudyError, match=words):
        rockcli.run(asked)
