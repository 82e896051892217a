"""`uncertain`: probabilities against closed forms, indices against known ones, the same samples whoever solves them."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from scenes import G
from scipy import integrate, stats

import rockcli
from rockcli.analysis.suites.uncertainty import probability, sobol_indices
from rockcli.engine.run import run_study, solve
from rockcli.engine.summary import SOLVED, report_on
from rockcli.errors import StudyError
from rockcli.scene.uncertain.distributions import Distribution
from rockcli.scene.uncertain.samples import unit_points
from rockcli.storage import netcdf
from rockcli.study.open import open_study

ALPHA = 0.2


def study(**more):
    base = {
        "name": "free",
        "case": {"block": {"R": 2.0, "alpha": ALPHA}, "initial": {"theta_dot": 0.5}, "damping": "none"},
        "uncertain": {"block.R": {"lognormal": [2.0, 0.3]}, "initial.theta_dot": {"normal": [0.5, 0.1]}},
        "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha"]},
    }
    return base | more


def limit(R):
    """Rate that carries a block over, from its energy: theta_dot^2 = 2 p^2 (1 - cos alpha), p^2 = 3 g/(4 R)."""
    return np.sqrt(1.5 * G / R * (1.0 - np.cos(ALPHA)))


def truth():
    """Probability that the rate is above the limit, over both inputs."""

    def density(z):
        c = limit(2.0 * np.exp(0.3 * z))
        return stats.norm.pdf(z) * (stats.norm.sf((c - 0.5) / 0.1) + stats.norm.cdf((-c - 0.5) / 0.1))

    return integrate.quad(density, -10.0, 10.0, epsabs=1e-13)[0]


def away(seed, sampling, n):
    """Standard errors between estimate and truth."""
    found = rockcli.run(study(seed=seed, sampling=sampling, samples=n))
    return (float(found.p_overturned) - truth()) / float(found.p_overturned_se)


def test_samples_over_another_axis_say_how_many_points_it_has():
    found = rockcli.run(study(samples=8, vary={"block.mass": [1.0, 2.0, 3.0]}, over=["mass", "sample"]))
    said = json.loads(found.attrs["ensemble"])["says"]
    assert said[0] == "8 Latin hypercube samples, seed 0, over 3 points of mass"


@pytest.mark.parametrize(
    ("sampling", "n"), [("latin_hypercube", 200), ("random", 200), ("sobol", 256), ("saltelli", 256)]
)
def test_probability_is_within_its_error_of_the_closed_form(sampling, n):
    assert max(abs(away(seed, sampling, n)) for seed in range(8)) < 4.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sampling", "n"), [("latin_hypercube", 500), ("random", 500), ("sobol", 512), ("saltelli", 512)]
)
def test_probability_is_within_four_errors_in_a_hundred_seeds_of_a_hundred(sampling, n):
    found = np.array([away(seed, sampling, n) for seed in range(100)])
    assert np.abs(found).max() < 4.0
    assert found.std() < (1.25 if sampling == "random" else 1.0)  # the others are conservative
    assert abs(found.mean()) < 0.5


def test_every_sample_overturns_as_its_energy_says():
    found = rockcli.run(study(samples=300))
    rate, R = found.sampled_theta_dot.values, found.sampled_R.values
    assert (found.R.values == R).all()
    assert found.sampled_theta_dot.attrs["units"] == "rad s-1"
    assert found.sampled_R.attrs == {
        "long_name": "distance from the edge to the centre of mass",
        "path": "block.R",
        "units": "m",
        "comment": "lognormal, median 2, beta 0.3",
    }
    assert (np.isin(found.outcome.values, (2, 3)) == (np.abs(rate) > limit(R))).all()
    assert float(found.p_overturned) == np.mean(np.abs(rate) > limit(R))


def test_samples_do_not_depend_on_shares_or_on_the_order_of_the_inputs(tmp_path):
    whole = open_study(study(samples=60))
    turned = open_study(study(samples=60, uncertain=dict(reversed(study()["uncertain"].items()))))
    assert turned.identity == whole.identity
    for k in (2, 1):
        run_study(whole, tmp_path, share=(k, 2), plots=False)
    merged = netcdf.read(run_study(turned, tmp_path, plots=False).file)
    alone = solve(whole)
    for name in ("outcome", "theta_peak_over_alpha", "sampled_R", "p_overturned", "input_spearman"):
        assert np.array_equal(merged.values(name), alone.values(name)), name


def test_seed_number_and_sampling_make_other_results_and_the_resolved_study_the_same():
    first = open_study(study())
    others = [open_study(study(**more)) for more in ({"seed": 1}, {"samples": 201}, {"sampling": "random"})]
    assert len({first.identity, *(other.identity for other in others)}) == 4
    assert len({first.sweep_id, *(other.sweep_id for other in others)}) == 4
    assert open_study(first.resolved).identity == first.identity
    assert first.resolved["samples"] == 200
    assert "samples" not in open_study(study(uncertain={})).resolved


@pytest.mark.parametrize(
    ("made", "numbers", "reference"),
    [
        ("normal", (2.0, 0.5), stats.norm(2.0, 0.5)),
        ("lognormal", (0.5, 0.3), stats.lognorm(0.3, scale=0.5)),
        ("uniform", (1.0, 3.0), stats.uniform(1.0, 2.0)),
        ("triangular", (0.0, 1.0, 4.0), stats.triang(0.25, 0.0, 4.0)),
        ("beta", (2.0, 3.0, 1.0, 5.0), stats.beta(2.0, 3.0, 1.0, 4.0)),
    ],
)
def test_distributions_are_what_their_numbers_say(made, numbers, reference):
    u = np.linspace(0.001, 0.999, 41)
    assert np.allclose(reference.cdf(Distribution(made, numbers).at(u)), u, atol=1e-12)
    a, b = reference.ppf(0.3), reference.ppf(0.8)
    cut = Distribution(made, numbers, (a, b))
    assert np.allclose(reference.cdf(cut.at(u)), 0.3 + 0.5 * u, atol=1e-12)
    assert cut.mass == pytest.approx(0.5)


def test_a_far_tail_keeps_its_digits():
    cut = Distribution("normal", (0.0, 1.0), (6.0, 9.0))
    u = np.array([0.1, 0.5, 0.9])
    assert np.allclose(cut.at(u), stats.truncnorm(6.0, 9.0).ppf(u), rtol=1e-12)


def test_designs_fill_every_stratum():
    points = unit_points("latin_hypercube", 50, 3, 7)
    assert (np.sort(np.floor(points * 50), axis=0) == np.arange(50)[:, None]).all()
    blocks = unit_points("saltelli", 5 * 64, 3, 7).reshape(5, 64, 3)
    for i in range(3):
        assert (blocks[2 + i][:, i] == blocks[1][:, i]).all()
        assert (np.delete(blocks[2 + i], i, axis=1) == np.delete(blocks[0], i, axis=1)).all()


def test_sobol_indices_of_the_function_of_ishigami():
    """Closed forms for sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 (Saltelli et al. 2000)."""
    x = 2.0 * np.pi * unit_points("saltelli", 5 * 4096, 3, 0) - np.pi
    f = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    first, first_se, total, total_se = sobol_indices(f.reshape(5, 4096))
    v2, v13 = 49.0 / 8.0, 8.0 * 0.01 * np.pi**8 / 225.0
    v1 = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2
    whole = v1 + v2 + v13
    assert (np.abs(first - np.array([v1, v2, 0.0]) / whole) < 4.0 * first_se).all()
    assert (np.abs(total - np.array([v1 + v13, v2, v13]) / whole) < 4.0 * total_se).all()
    assert (first_se < 0.03).all()
    assert (total_se < 0.03).all()


def test_indices_of_an_input_that_alone_decides():
    """Overturning by the rate alone: the first-order and the total index of the rate are 1, those of mass 0."""
    inputs = {"initial.theta_dot": {"normal": [0.5, 0.1]}, "block.mass": {"uniform": [1.0, 2.0]}}
    found = rockcli.run(study(uncertain=inputs, sampling="saltelli", samples=4 * 256))
    rate, mass = found.sel(input="initial.theta_dot"), found.sel(input="block.mass")
    assert float(rate.sobol_total) == pytest.approx(1.0, abs=4.0 * float(rate.sobol_total_se))
    assert float(rate.sobol_first) == pytest.approx(1.0, abs=4.0 * float(rate.sobol_first_se))
    assert float(mass.sobol_total) == 0.0
    assert float(mass.sobol_first) == 0.0
    assert np.isnan(rate.sobol_total_peak)  # some overturn: the peak has no variance


def test_limits_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(3)
    for p, n in ((0.02, 100), (0.3, 50), (0.9, 200)):
        share = (rng.random((4000, n)) < p).astype(float)
        found = probability(share, np.arange(n))
        covered = ((found.low <= p) & (p <= found.high)).mean()
        assert 0.945 < covered <= 1.0, (p, covered)
        assert np.mean(found.se**2) == pytest.approx(p * (1.0 - p) / n, rel=0.03)
    none = probability(np.zeros((1, 50)), np.arange(50))
    assert float(none.high[0]) == pytest.approx(stats.binomtest(0, 50).proportion_ci(0.95).high)


@pytest.mark.parametrize(("records", "samples"), [(8, 1), (40, 1), (8, 25), (40, 5)])
def test_limits_are_those_of_as_many_members_as_have_the_error(records, samples):
    """Korn and Graubard 1998: p (1 - p)/se^2 members, times (t of all members over t of the records)^2."""
    hit = np.arange(records) % 4 == 0
    told = probability(np.repeat(hit, samples)[None].astype(float), np.repeat(np.arange(records), samples))
    n, p, se = records * samples, hit.mean(), hit.std(ddof=1) / np.sqrt(records)
    assert told.se[0] == pytest.approx(se)
    members = p * (1.0 - p) / se**2 * (stats.t.ppf(0.975, n - 1) / stats.t.ppf(0.975, records - 1)) ** 2
    assert told.low[0] == pytest.approx(stats.beta.ppf(0.025, p * members, members * (1.0 - p) + 1.0))
    assert told.high[0] == pytest.approx(stats.beta.ppf(0.975, p * members + 1.0, members * (1.0 - p)))


@pytest.mark.parametrize(("records", "p"), [(3, 0.2), (3, 0.5), (5, 0.5), (20, 0.2)])
def test_limits_hold_the_truth_over_few_records_too(records, p):
    """Of records whose own probabilities scatter by a beta distribution, of which samples are drawn."""
    draw, samples = np.random.default_rng(5), 180 // records
    of_records = draw.beta(2.0 * p, 2.0 * (1.0 - p), (4000, records, 1))
    fell = draw.random((4000, records, samples)) < of_records
    told = probability(fell.reshape(4000, -1).astype(float), np.repeat(np.arange(records), samples))
    assert np.mean((told.low <= p) & (p <= told.high)) > 0.92


@pytest.mark.parametrize("records", [1, 2, 3, 7])
@pytest.mark.parametrize("samples", [3, 7, 20])
def test_limits_of_records_that_are_all_alike_are_those_of_so_many(records, samples):
    """As many samples of each overturn: rounding is not an error that anything is told from."""
    for hits in range(1, samples):
        share = np.tile(np.arange(samples) < hits, records)[None].astype(float)
        told, p = probability(share, np.repeat(np.arange(records), samples)), hits / samples
        assert told.low[0] < p < told.high[0]
        assert told.low[0] == pytest.approx(stats.beta.ppf(0.025, p * records, records * (1.0 - p) + 1.0), abs=1e-12)
        assert told.high[0] == pytest.approx(stats.beta.ppf(0.975, p * records + 1.0, records * (1.0 - p)), abs=1e-12)


def test_samples_of_one_record_are_not_independent():
    """Two records, one of which always overturns: as uncertain as two coins, however many samples."""
    share = np.repeat([0.0, 1.0], 500)[None]
    assert probability(share, np.repeat([0, 1], 500)).se[0] == pytest.approx(0.5)
    assert probability(share, np.arange(1000)).se[0] == pytest.approx(0.5 / np.sqrt(999.0))


def test_samples_that_records_share_are_not_as_many_as_both():
    """Records that all answer alike: the share is known as well as from the samples of one."""
    hit = np.arange(16) % 4 == 0
    share, rows, samples = (
        np.tile(hit, 20)[None].astype(float),
        np.repeat(np.arange(20), 16),
        np.tile(np.arange(16), 20),
    )
    # squares of samples, and of all members, which are 20 times as many
    expected = np.sqrt(hit.std(ddof=1) ** 2 / 16 - 0.25 * 0.75 / 319)
    assert probability(share, rows).se[0] < 1e-12
    assert probability(share, rows, samples).se[0] == pytest.approx(max(expected, hit.std(ddof=1) / 4.0))


@pytest.mark.parametrize(
    ("records", "samples", "of_records", "of_samples"), [(20, 20, 1, 1), (42, 16, 0.1, 1), (20, 200, 0.3, 1)]
)
def test_limits_hold_the_truth_where_records_share_samples(records, samples, of_records, of_samples):
    draw, many = np.random.default_rng(1), 800
    away = (
        0.4
        + of_records * draw.standard_normal((many, records, 1))
        + of_samples * draw.standard_normal((many, 1, samples))
    )
    fell = away + 0.3 * draw.standard_normal((many, records, samples)) > 0.0
    p = stats.norm.cdf(0.4 / np.sqrt(of_records**2 + of_samples**2 + 0.3**2))
    rows, shared = np.repeat(np.arange(records), samples), np.tile(np.arange(samples), records)
    told = probability(fell.reshape(many, -1).astype(float), rows, shared)
    assert 0.94 < np.mean((told.low <= p) & (p <= told.high)) < 0.99
    assert np.sqrt(np.mean(told.se**2)) == pytest.approx(told.value.std(), rel=0.1)


def test_what_is_made_of_one_record_and_sample_is_told_once():
    """Two directions of every record that answer alike leave the error as it is with one."""
    draw = np.random.default_rng(2)
    fell = (
        draw.standard_normal((12, 1)) + draw.standard_normal((1, 10)) + draw.standard_normal((12, 10)) > 0.0
    ).ravel()
    rows, shared = np.repeat(np.arange(12), 10), np.tile(np.arange(10), 12)
    one = probability(fell[None].astype(float), rows, shared)
    two = probability(np.tile(fell, 2)[None].astype(float), np.tile(rows, 2), np.tile(shared, 2))
    assert two.se[0] == pytest.approx(one.se[0])


def test_a_suite_with_samples_clusters_by_both():
    """Of three masses, which change nothing, a share has the error that its samples give."""
    alone, over = (
        study(samples=40, sampling="random"),
        {"vary": {"block.mass": [1.0, 2.0, 3.0]}, "over": ["mass", "sample"]},
    )
    assert float(rockcli.run(alone | over).p_overturned_se) == pytest.approx(float(rockcli.run(alone).p_overturned_se))


def test_records_and_samples_are_one_ensemble():
    inputs = {"block.b": {"normal": [0.3, 0.02]}}
    files = ["synthetic_rock_m65.AT2", "synthetic_soil_m70.AT2"]
    case = {"block": {"h": 1.5, "b": 0.3}, "motion": {"record": {"file": files[0], "pga": "0.5*g"}}}
    vary = {"motion.record.file": files, "motion.record.pga": ["0.4*g", "0.8*g"]}
    more = {"case": case, "vary": vary, "uncertain": inputs, "samples": 12}
    found = rockcli.run(study(**more, over=["record", "sample"]))
    assert found.attrs["axes"] == "record sample motion_record_pga"
    fell = np.isin(found.outcome.values, (2, 3))
    assert found.p_overturned.dims == ("motion_record_pga",)
    assert np.array_equal(found.p_overturned.values, fell.mean(axis=(0, 1)))
    means = fell.mean(axis=1)
    assert np.allclose(found.p_overturned_se.values, means.std(axis=0, ddof=1) / np.sqrt(2.0))
    apart = rockcli.run(study(**more, over="record"))
    assert np.array_equal(apart.p_overturned.values, fell.mean(axis=0).T)
    assert "p_overturned_se" not in apart
    assert json.loads(found.attrs["ensemble"])["axis"] == ["record", "sample"]
    table = rockcli.table(found, of="inputs")
    assert list(table.columns) == ["motion_record_pga [m s-2]", "input", "input_spearman"]


def test_numbers_for_programs_and_words_for_people():
    opened = open_study(study(samples=64, sampling="sobol"))
    report = report_on(opened, solve(opened), status=SOLVED).as_dict()
    (row,) = report["samples"]
    assert row.keys() == {
        "n_answered", "p_overturned", "p_overturned_se", "p_overturned_ci_low", "p_overturned_ci_high", "input_spearman"
    }  # fmt: skip
    assert row["input_spearman"].keys() == {"block.R", "initial.theta_dot"}
    assert report["suite"][0] == "64 scrambled Sobol points, seed 0"
    assert "standard error" in report["suite"][1]
    assert "Spearman" in report["suite"][2]


def test_sobol_indices_are_told_with_their_standard_errors():
    opened = open_study(study(samples=256, sampling="saltelli"))
    solved = solve(opened)
    told = next(line for line in report_on(opened, solved, status=SOLVED).as_dict()["suite"] if "Sobol indices" in line)
    assert "(± standard error)" in told
    for i, path in enumerate(solved.values("input")):
        numbers = [
            f"{solved.values(f'sobol_{order}')[i]:.2f} ± {solved.values(f'sobol_{order}_se')[i]:.2g}"
            for order in ("first", "total")
        ]
        assert f"{path} {' / '.join(numbers)}" in told


@pytest.mark.parametrize(
    ("scheme", "key", "low", "high"), [("dashpot", "coefficient", 0.01, 0.2), ("fema356", "W_over_Mg", 0.9, 1.1)]
)
def test_numbers_of_the_damping_may_be_uncertain(scheme, key, low, high):
    case = {"block": {"R": 2.0, "alpha": ALPHA}, "motion": {"pulse": {"shape": "sine", "a_p": 2.2, "T_p": 1.0}}}
    inputs = {f"damping.{key}": {"uniform": [low, high]}}
    damping = {"scheme": scheme, key: low}
    found = rockcli.run({"name": scheme, "case": case | {"damping": damping}, "uncertain": inputs, "samples": 6})
    drawn, peaks = found[f"sampled_{key}"].values, found.theta_peak_over_alpha.values
    assert len(set(drawn)) == len(set(peaks)) == 6
    for number, peak in zip(drawn, peaks, strict=True):
        alone = rockcli.run({"case": case | {"damping": damping | {key: float(number)}}})
        assert float(alone.theta_peak_over_alpha) == pytest.approx(float(peak), rel=1e-12)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"uncertain": {"block.RR": {"normal": [2, 1]}}}, "'block.RR' is not a path"),
        ({"uncertain": {"solver.rtol": {"uniform": [1e-8, 1e-6]}}}, "cannot be uncertain; only a number"),
        ({"uncertain": {"block.pixel": {"uniform": [0.9, 1.1]}}}, "cannot be uncertain; write a symbol of `let` there"),
        ({"uncertain": {"block.R": {"normal": [2, 0.1], "uniform": [1, 2]}}}, "has normal and uniform; exactly one"),
        ({"uncertain": {"block.R": {}}}, "has no distribution"),
        ({"uncertain": {"block.R": {"normal": [2, -0.1]}}}, "needs sd > 0"),
        ({"uncertain": {"block.R": {"lognormal": [-2, 0.1]}}}, "needs median > 0"),
        ({"uncertain": {"block.R": {"uniform": [2, 1]}}}, "needs a < b"),
        ({"uncertain": {"block.R": {"triangular": [1, 2]}}}, "3 numbers"),
        ({"uncertain": {"block.R": {"gaussian": [1, 2]}}}, "unknown key 'gaussian'; known: beta, lognormal, normal"),
        ({"uncertain": {"block.R": {"norml": [1, 2]}}}, "unknown key 'norml'; did you mean 'normal'?"),
        ({"uncertain": {"block.R": {"normal": [2, 0.1], "truncate": [9, 10]}}}, "leaves nothing of normal"),
        ({"uncertain": {"block.R": {"normal": [2, 0.1], "truncate": [3, 1]}}}, "the first must be below the second"),
        ({"sampling": "sobol"}, "128 or 256"),
        ({"sampling": "saltelli"}, "128 or 256"),
        ({"uncertain": {}, "samples": 10}, "belongs to `uncertain"),
        ({"vary": {"block.R": [1, 2]}}, "is what the axis block.R varies"),
        ({"uncertain": {"block.alpha": {"uniform": [0.1, 0.2]}, "block.tan_alpha": {"uniform": [0.1, 0.2]}}}, "same thing"),
        ({"over": ["sample", "block.R"], "vary": {"block.R": [1, 2]}, "uncertain": {"g": {"uniform": [9, 10]}}, "samples": 1}, "at least 2"),
        ({"uncertain": {"initial.theta": {"normal": [0, 1.0]}}}, "must be between -pi/2 and pi/2"),
        ({"refine": True}, "takes statistics"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(more, words):
    with pytest.raises(StudyError, match=re.escape(words)):
        open_study(study(**more))


def test_axes_that_are_no_neighbours_are_no_ensemble():
    vary = {"block.alpha": [0.1, 0.2], "block.mass": [1, 2], "block.mu": [0.5, 1.0]}
    with pytest.raises(StudyError, match="side by side"):
        open_study(study(uncertain={}, vary=vary, over=["block.alpha", "block.mu"]))


def test_inputs_are_numbers_or_expressions_that_no_case_changes():
    found = open_study(study(uncertain={"block.R": {"uniform": ["10*R*tan_alpha/10/tan_alpha", "3*m"]}}))
    assert found.uncertain.inputs[0].words == "uniform, a 2, b 3"
    with pytest.raises(StudyError, match="differs from case to case"):
        open_study(study(vary={"block.alpha": [0.1, 0.2]}, uncertain={"block.R": {"uniform": ["10*alpha", 4]}}))


def test_the_lowest_overturning_value_of_a_range_has_percentiles_over_samples(tmp_path):
    """The rate that overturns is that of the energy of every sample; its median is theirs."""
    searched = {"initial.theta_dot": {"from": 0.2, "to": 1.0, "n": 9, "find": "overturning"}}
    opened = open_study(study(uncertain={"block.R": {"lognormal": [2.0, 0.3]}}, vary=searched, samples=21, save={}))
    found = netcdf.read(run_study(opened, tmp_path).file)
    want = limit(found.values("sampled_R"))
    assert found.values("initial_theta_dot_overturning") == pytest.approx(want, rel=1e-5)
    assert float(found.values("initial_theta_dot_overturning_p50")) == pytest.approx(np.median(want), rel=1e-5)
