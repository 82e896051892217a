"""`rock trade`: errors that fall with the tolerance, kinds of error separated, and a dataset that can be drawn again."""

from __future__ import annotations

import copy
import importlib
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import yaml
from reference import integrate, symmetric
from typer.testing import CliRunner

from rockcli.cli.main import app
from rockcli.engine.report_page import write_page
from rockcli.engine.trade import record_sampling as sampling
from rockcli.engine.trade import trade as measuring
from rockcli.engine.trade.measurements import front
from rockcli.engine.trade.sampled_cases import Sample
from rockcli.engine.trade.settings import numerical
from rockcli.engine.trade.trade import trade
from rockcli.engine.trade.trade_results import contents_of, write_trade
from rockcli.errors import StudyError
from rockcli.plotting.figures import default_kinds, figure, why_not
from rockcli.scene.backends import BACKENDS
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.response import NO_UPLIFT
from rockcli.solvers.general import methods
from rockcli.solvers.opensees.script import script_of
from rockcli.storage.read import open_dataset, to_xarray
from rockcli.study.open import open_study

EVENT = frozenset({"event"})

STUDY = {
    "name": "scenes",
    "case": {
        "block": {"R": 2.0, "tan_alpha": 0.2},
        "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.0, "omega_p": "3*pi"}},
        "damping": "none",
    },
    "vary": {"motion.pulse.a_p_over_g_tan_alpha": [1.5, 2.0, 2.5, 3.0, 3.5]},
    "save": {"histories": False},
}


def study(**more):
    return open_study(copy.deepcopy(STUDY) | more)


def medians(found, part, family):
    return [p.quantile(0.5) for p in found.points if (p.setting.part, p.setting.family) == (part, family)]


@pytest.fixture
def two_methods(monkeypatch):
    importlib.import_module("rockcli.solvers.general.solver")  # keeps all of them, whoever imports it first
    few = {name: methods.METHODS[name] for name in ("RK45", "DOP853")}
    monkeypatch.setattr(methods, "METHODS", few)
    monkeypatch.setitem(BACKENDS, "scipy", replace(BACKENDS["scipy"], settings=(1e-3, 1e-6, 1e-9)))


def test_errors_fall_with_the_tolerance(two_methods):
    found = trade(study(), sample=2, backends=frozenset({"event", "scipy"}))
    for family, least in (("event", 1e-13), ("scipy RK45", 1e-6), ("scipy DOP853", 1e-6)):
        errors = medians(found, "numerics", family)
        assert len(errors) >= 3
        assert all(fine < coarse for coarse, fine in pairwise(errors)), (family, errors)
        assert errors[-1] < least
    assert all(p.wrong == 0 and p.compared == 2 for p in found.points if p.setting.part == "numerics")


def test_an_error_is_the_distance_to_an_independent_solution(two_methods):
    """Free rocking of the undamped block, integrated here through its impacts, against RK45's error in the trade."""
    given = study(
        case={"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.1, "theta_dot": 0.1}, "damping": "none"},
        vary={},
    )
    found = trade(given, backends=frozenset({"scipy"}))
    body = symmetric(np.arctan(0.2), np.sqrt(3.0 * 9.81 / 8.0), 1.0)
    truth = integrate(body, np.zeros(2), 1.0, theta_0=0.1, rate_0=0.1).peak_over_alpha
    assert len(found.points) > 3
    for point in found.points:
        assert point.error[0] == pytest.approx(point.answers.peak[0] - truth, rel=1e-6, abs=1e-12)


def test_models_with_the_same_equations_have_the_same_error():
    found = trade(study(), backends=EVENT)
    error = {(p.setting.model, p.setting.geometry): p for p in found.points if p.setting.part == "model"}
    same = [error[str(number), "negative_stiffness"] for number in (1, 2, 3, 4)]
    assert all((p.error == same[0].error).all() for p in same)
    assert 0.0 < error["1", "corotational"].quantile(0.5) < error["linearized", None].quantile(0.5)
    assert all(p.setting.against == "rigid" for p in error.values())


def under(tmp_path, values, **more):
    """A block under a record of these accelerations, 50 samples a second."""
    lines = [f"{0.02 * i:.2f} {value:.17g}" for i, value in enumerate(values)]
    (tmp_path / "motion.txt").write_text("\n".join(lines) + "\n")
    made = copy.deepcopy(STUDY) | {"vary": {}} | more
    made["case"]["motion"] = {"record": {"file": "motion.txt", "units": "m/s^2"}}
    path = tmp_path / "sampled.yaml"
    path.write_text(yaml.safe_dump(made))
    return open_study(path)


def halved(found):
    return next(p for p in found.points if p.setting.sampling == "every 2nd sample")


def test_a_record_linear_between_its_even_samples_loses_nothing_when_halved(tmp_path):
    even = 9.81 * 0.2 * np.array([0.0, 1.3, -1.4, 1.2, -1.2, 1.1, 0.0])
    values = np.interp(np.arange(61) / 10.0, np.arange(7), even)
    point = halved(trade(under(tmp_path, values), backends=EVENT))
    assert point.answers.peak[0] > 0.01
    assert abs(point.error[0]) < 1e-10


def test_a_spike_on_an_odd_sample_is_the_whole_error_when_halved(tmp_path):
    values = np.zeros(41)
    values[21] = 25.0
    given = under(tmp_path, values)
    point = halved(trade(given, backends=EVENT))
    truth = next(p for p in trade(given, backends=EVENT).points if p.setting.step == "rtol 1e-14").answers.peak[0]
    assert truth > 0.05
    assert point.answers.outcome[0] == NO_UPLIFT
    assert point.error[0] == pytest.approx(-truth, rel=1e-9)
    assert (point.wrong, point.compared) == (1, 1)


@pytest.mark.parametrize("of_record", [True, False], ids=["record", "pulse"])
def test_what_arrives_through_floors_is_not_halved_for_the_record(tmp_path, of_record):
    """Its samples are eight times as close: half of them told a hundredth of what the record leaves open."""
    given = under(tmp_path, 4.0 * np.sin(np.arange(61) / 5.0))
    record = {"record": {"file": str(tmp_path / "motion.txt"), "units": "m/s2"}}
    motion = (record if of_record else STUDY["case"]["motion"]) | {"through": [{"T": 0.3, "zeta": 0.05}]}
    found = trade(study(case=STUDY["case"] | {"motion": motion}, vary={}), backends=EVENT)
    assert not [point for point in found.points if point.setting.sampling]
    assert dict(found.skipped)["data"].startswith("what arrives through floors is no record")
    assert halved(trade(given, backends=EVENT)).answers.peak[0] > 0.0


def test_scripts_of_opensees_under_a_record_have_plain_numbers(tmp_path):
    """A step of numpy made every case fail: its repr is `np.float64(...)`, and scripts know no `np`."""
    pair = ("3", "corotational")
    batch = Sample(under(tmp_path, 4.0 * np.sin(np.arange(61) / 5.0)), 1).first(pair)
    ((coarsest, *_),) = numerical(batch, pair, frozenset({"opensees"}))
    text = script_of(coarsest.of(batch), 0).files["case.py"]
    assert re.search(r"^DT = \d+\.\d+", text, re.MULTILINE), text
    assert "np." not in text


@pytest.mark.parametrize("n", [64, 75])
def test_what_is_below_the_limit_is_filled_in_exactly(n):
    t = np.arange(2 * n - 1) / 2.0
    wave = np.sin(2.0 * np.pi * 9.0 * t / n + 0.3) + 0.5 * np.cos(2.0 * np.pi * 20.0 * t / n)
    filled = sampling.band_limited(Samples(wave[::2], 0.02, np.ones(1)))
    assert filled.dt == 0.01
    np.testing.assert_allclose(filled.values, wave, atol=1e-13)


def test_front():
    points = [(1.0, 5.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (4.0, 1.0)]
    assert front(points) == [True, True, False, False, True, True]


def test_a_short_budget_keeps_references_and_what_is_cheap_and_says_the_rest(two_methods):
    found = trade(study(), sample=2, budget=1e-6, backends=frozenset({"event", "scipy"}))
    assert found.references == {"rigid": "event, rtol 1e-16"}
    skipped = dict(found.skipped)
    assert skipped["numerics: rigid: scipy RK45, rtol 1e-09"] == "the budget is used up"
    assert not medians(found, "numerics", "scipy RK45")


def test_a_setting_that_cannot_fit_is_not_tried_out(two_methods, monkeypatch):
    """Once the budget is gone no case is solved, not even to estimate; and what one setting took corrects the guess of others."""
    clock = [0.0]
    monkeypatch.setattr(measuring, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(measuring, "_guess", lambda scene, setting: 1.0)
    solved = []

    def slow(setting):
        solver = BACKENDS[setting.numerics.backend].of_model(setting.model).load()

        def solve(batch):
            solved.append(setting.numerics.backend)
            clock[0] += 10.0 if setting.numerics.backend == "scipy" else 0.0
            return solver(batch)

        return solve

    monkeypatch.setattr(measuring, "_solver", slow)
    found = trade(study(), sample=1, budget=25.0, backends=frozenset({"event", "scipy"}))
    assert solved.count("scipy") == 2  # one setting, and a case of the next: 10 s do not fit the 5 s left
    assert clock[0] <= 1.3 * 25.0
    assert "the budget is used up" in dict(found.skipped).values()


def test_fewer_cases_where_references_would_take_the_budget(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(measuring, "perf_counter", lambda: clock[0])

    def slow(setting):
        solver = BACKENDS[setting.numerics.backend].of_model(setting.model).load()

        def solve(batch):
            clock[0] += batch.size
            return solver(batch)

        return solve

    monkeypatch.setattr(measuring, "_solver", slow)
    found = trade(study(), sample=5, budget=12.0, backends=EVENT)
    assert len(found.cases) == 3
    assert any("3 instead of 5 cases are measured" in note for note in found.notes)


def test_the_sample_is_drawn_once_for_all_and_models_are_not_drawn():
    given = study(vary=STUDY["vary"] | {"model": ["rigid", 3], "solver.accuracy": ["draft", "standard"]})
    one, two = trade(given, sample=3, backends=EVENT), trade(given, sample=3, backends=EVENT)
    assert len(one.cases) == 3
    assert one.cases.tolist() == two.cases.tolist()
    assert set(one.references) == {"rigid", "3 negative_stiffness"}
    whole = trade(given, sample=100, backends=EVENT)
    assert len(whole.cases) == 5


def test_what_cannot_be_traded_is_refused():
    with pytest.raises(StudyError, match="trade: needs cases"):
        trade(
            study(
                vary={"motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 9, "n": 4, "find": "overturning"}}, save={}
            )
        )
    poor = copy.deepcopy(STUDY["case"]) | {"damping": "fema356"}
    with pytest.raises(StudyError, match="series of settings"):
        trade(study(case=poor))


def test_contents_and_picture():
    found = trade(study(), sample=3, backends=EVENT)
    dataset = to_xarray(contents_of(study(), found))
    assert dataset["error_theta_peak_over_alpha"].dims == ("setting", "case")
    assert dataset["case"].values[0].startswith("a_p_over_g_tan_alpha=")
    front_rows = dataset.isel(setting=np.flatnonzero(dataset["on_front"].values == 1))
    assert set(front_rows["part"].values) == {"numerics", "model"}
    assert default_kinds(dataset) == ("work_precision",)
    drawn = figure("work_precision", dataset)
    assert [axes.get_title() for axes in drawn.axes] == ["numerics", "numerics", "models, at accuracy standard"]
    lines = {line.get_label(): line for line in drawn.axes[0].get_lines()}
    assert {"event", "Pareto front"} <= set(lines)
    np.testing.assert_array_equal(
        lines["event"].get_xdata(), [p.cost for p in found.points if p.setting.part == "numerics"]
    )
    (again,) = (line for line in drawn.axes[1].get_lines() if line.get_label() == "event")
    np.testing.assert_array_equal(again.get_xdata(), np.median(dataset["n_rhs"][dataset["part"] == "numerics"], axis=1))
    older = figure("work_precision", dataset.drop_vars("n_rhs"))
    assert len(older.axes) == 2
    assert "measured by `rock trade`" in why_not("work_precision", dataset.drop_vars("on_front"))


def test_a_trade_has_a_page_of_its_own(tmp_path, two_methods):
    """The clauses of its study speak of the study's points, of which it has none."""
    clause = {"quantity": "outcome", "at": {"motion.pulse.a_p_over_g_tan_alpha": 2}, "is": "rocking"}
    given = study(vary={"motion.pulse.a_p_over_g_tan_alpha": [2, 2.5]}, expect=[clause])
    path = write_trade(given, trade(given, sample=2, backends=frozenset({"event"})), tmp_path)
    page = write_page(path).read_text(encoding="utf-8")
    assert "Expected:" not in page
    assert "error against cost" in page


def test_the_command(tmp_path, two_methods, monkeypatch):
    monkeypatch.setattr("rockcli.engine.trade.trade.peers", lambda: EVENT)
    path = tmp_path / "scenes.yaml"
    path.write_text(yaml.safe_dump(STUDY))
    told = CliRunner().invoke(app, ["trade", str(path), "--out", str(tmp_path), "--sample", "2", "--budget", "5 s"])
    assert told.exit_code == 0, told.output
    assert "scenes: 2 of 5 cases" in told.output
    assert "reference rigid: event, rtol 1e-16" in told.output
    assert "error of the model, against a better one" in told.output
    assert (tmp_path / "scenes-trade" / "work_precision.png").stat().st_size > 10_000
    dataset = open_dataset(tmp_path / "scenes-trade" / "scenes-trade.nc")
    assert dataset.attrs["sample"] == "2 of 5 cases"
    assert sorted(p.name for p in (tmp_path / "scenes-trade").iterdir()) == ["scenes-trade.nc", "work_precision.png"]


@pytest.mark.parametrize("budget", ["soon", "0s", "-3 s", "5 days"])
def test_a_budget_that_is_no_time(tmp_path, budget):
    path = tmp_path / "scenes.yaml"
    path.write_text(yaml.safe_dump(STUDY))
    with pytest.raises(StudyError, match="expected a time such as 60s"):
        CliRunner().invoke(app, ["trade", str(path), f"--budget={budget}"], catch_exceptions=False)


@pytest.mark.slow
def test_the_flexible_column_converges_in_time_and_space_and_is_the_better_model():
    case = copy.deepcopy(STUDY["case"]) | {"model": "flexible", "column": {"E": "5*GPa", "rho": 2500, "zeta": 0.02}}
    found = trade(study(case=case), sample=2, backends=EVENT)
    assert set(found.references) == {"flexible", "flexible, elements", "rigid"}
    steps, elements = medians(found, "numerics", "event"), medians(found, "numerics", "event, elements")
    assert len(steps) == len(elements) == 5
    assert steps[-1] < 1e-2 * steps[0]
    assert elements[-1] < 0.1 * elements[0]
    rigid = next(p for p in found.points if p.setting.part == "model" and p.setting.model == "rigid")
    assert rigid.setting.against == "flexible"
    assert rigid.quantile(0.5) > elements[-1]
