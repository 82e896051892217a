"""`rock trade` where peaks tell nothing, on model auto, and what it prints and hands on."""

from __future__ import annotations

import copy
import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import rockcli
from rockcli.cli.main import app
from rockcli.engine.trade import settings as made_of
from rockcli.engine.trade import trade as measuring
from rockcli.engine.trade.measurements import on_front
from rockcli.engine.trade.sampled_cases import Sample
from rockcli.engine.trade.trade import trade
from rockcli.engine.trade.trade_results import contents_of
from rockcli.errors import StudyError
from rockcli.plotting.figures import figure, why_not
from rockcli.plotting.kinds.work_precision import FRONT
from rockcli.scene.backends import BACKENDS
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, NO_UPLIFT, ROCKING, Response
from rockcli.solvers.general import methods
from rockcli.storage.read import open_dataset, to_xarray
from rockcli.study.open import open_study

EVENT = frozenset({"event"})

BLOCK = {"R": 2.0, "tan_alpha": 0.2}

COLUMN = {
    "block": BLOCK,
    "motion": {"pulse": {"shape": "ricker", "a_p_over_g_tan_alpha": 3.0, "omega_p": "3*pi"}},
    "column": {"E": "5*GPa", "rho": 2500, "zeta": 0.02},
    "damping": "none",
}


def under(amplitude):
    """A block under one sine whose amplitude is this over g tan(alpha)."""
    pulse = {"shape": "sine", "a_p_over_g_tan_alpha": amplitude, "omega_p_over_p": 4}
    return {"name": "fate", "case": {"block": BLOCK, "motion": {"pulse": pulse}}, "save": {"histories": False}}


def of(case):
    return open_study({"name": "body", "case": copy.deepcopy(case), "save": {"histories": False}})


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Trades a mapping by the command, with two general methods beside `event`; stdout and stderr."""
    monkeypatch.setattr("rockcli.engine.trade.trade.peers", lambda: frozenset({"event", "scipy"}))
    monkeypatch.setattr(methods, "METHODS", {name: methods.METHODS[name] for name in ("RK45", "DOP853")})
    monkeypatch.setitem(BACKENDS, "scipy", replace(BACKENDS["scipy"], settings=(1e-3, 1e-6)))

    def run(made, *options):
        path = tmp_path / f"{made['name']}.yaml"
        path.write_text(yaml.safe_dump(made))
        told = CliRunner().invoke(app, ["trade", str(path), "--out", str(tmp_path), *options], catch_exceptions=False)
        assert told.exit_code == 0
        return told.stdout, told.stderr

    return run


def rows_below(printed, head):
    """Lines of the table under a head, without its names."""
    lines = printed.splitlines()
    start = next(i for i, line in enumerate(lines) if line.strip().startswith(head)) + 2
    end = next(i for i in range(start, len(lines)) if not lines[i].startswith("    "))
    return lines[start:end]


def test_a_body_that_never_moves_has_a_table_and_no_plot(command, tmp_path):
    printed, complaint = command(under(0.5))
    assert "note      model rigid: no sampled case uplifts" in printed
    assert all("0.0e+00  0.0e+00  0 of 1" in row for row in rows_below(printed, "error of the numerics"))
    others = rows_below(printed, "the most accurate of every other family")
    named = {row.split(",")[0].split()[-1] for row in others}  # of equal errors the quickest, whichever that is
    assert len(named) == len(others) == 2
    assert named < {"event", "RK45", "DOP853"}
    assert "nothing to draw, every error is 0: model rigid: no sampled case uplifts" in complaint
    assert "bug" not in complaint
    assert not (tmp_path / "fate-trade" / "work_precision.png").exists()


def test_a_body_that_always_overturns_is_traded_by_outcomes(command):
    printed, complaint = command(under(60.0))
    why = "every sampled case overturns, so no peak can be compared, only outcomes"
    assert f"note      model rigid: {why}" in printed
    assert why in complaint
    (cheapest,) = rows_below(printed, "error of the numerics")
    assert "event, rtol" in cheapest
    assert "0 of 1" in cheapest
    assert len(rows_below(printed, "the most accurate of every other family")) == 2


def test_where_some_cases_overturn_nothing_is_noted():
    made = under(1.5) | {"vary": {"motion.pulse.a_p_over_g_tan_alpha": [0.5, 1.5, 60.0]}}
    assert trade(open_study(made), backends=EVENT).notes == []


def test_settings_without_right_hand_sides_are_drawn_over_time_only():
    given = open_study(under(1.5))
    dataset = to_xarray(contents_of(given, trade(given, backends=EVENT)))
    numerics = np.flatnonzero(dataset["part"].values == "numerics")
    dataset["n_rhs"][numerics[:2]] = 0
    drawn = figure("work_precision", dataset)
    upper, lower = (
        next(line for line in axes.get_lines() if line.get_label() == "event")
        for axes in drawn.axes
        if axes.get_title() == "numerics"
    )
    assert len(upper.get_xdata()) == len(numerics)
    assert len(lower.get_xdata()) == len(numerics) - 2
    words = " ".join(text.get_text() for text in drawn.findobj(lambda one: hasattr(one, "get_text")))
    assert "2 without a number of right-hand sides" in " ".join(words.split())
    dataset["n_rhs"][:] = 0
    assert why_not("work_precision", dataset) == ""
    assert len(figure("work_precision", dataset).axes) == 2


def test_model_auto_is_traded_as_its_highest_model():
    found = trade(of(COLUMN | {"model": "auto"}), backends=EVENT)
    column = trade(of(COLUMN | {"model": "flexible"}), backends=EVENT)
    assert found.references == column.references
    assert [p.setting.label for p in found.points] == [p.setting.label for p in column.points]
    for one, other in zip(found.points, column.points, strict=True):
        np.testing.assert_array_equal(one.error, other.error)
    assert "numerics: flexible: event, elements, 1 element" in [p.setting.label for p in found.points]
    assert found.notes == ["model auto: measured as flexible, the highest model that its data allow"]
    assert column.notes == []


@pytest.mark.parametrize(
    ("changed", "own", "name"),
    [
        ({}, "flexible", "flexible"),
        ({"base": {"law": "winkler", "kw": 1e9}}, "flexible", "flexible on winkler"),
        ({"column": None}, "rigid", "rigid"),
    ],
)
def test_what_model_auto_stands_for(changed, own, name):
    case = {key: value for key, value in (COLUMN | {"model": "auto"} | changed).items() if value is not None}
    sample = Sample(of(case), 1)
    assert sample.own == [(own, None)]
    assert sample.notes == [f"model auto: measured as {name}, the highest model that its data allow"]


def test_along_an_axis_of_models_auto_is_no_model_of_its_own():
    case = {key: value for key, value in COLUMN.items() if key != "column"}
    made = {"name": "both", "case": case, "vary": {"model": ["linearized", "auto"]}, "save": {"histories": False}}
    sample = Sample(open_study(made), 1)
    assert sample.own == [("linearized", None), ("rigid", None)]
    assert len(sample.notes) == 1


@pytest.mark.parametrize("names", [("auto", "auto"), ("rigid", "flexible")])
def test_a_column_in_some_cases_only(names, monkeypatch):
    """The full mesh, which nothing is measured of here, has its time estimated from a case that has a column."""
    foretold = measuring._expected

    def never_a_mesh(scene, setting, before, left, pace):
        seconds = foretold(scene, setting, before, left, pace)
        return np.inf if setting.numerics.backend == "calculix" and seconds > 0.0 else seconds

    monkeypatch.setattr(measuring, "_expected", never_a_mesh)
    body = {key: value for key, value in COLUMN.items() if key != "column"}
    kinds = {"stiff": {"model": names[0]}, "soft": {"model": names[1], "column": COLUMN["column"]}}
    given = open_study({"name": "mixed", "case": body, "vary": {"case": kinds}, "save": {"histories": False}})
    assert Sample(given, 2).own == [("flexible", None), ("rigid", None)]
    found = trade(given, backends=EVENT | {"calculix"}, budget=600.0)
    assert ("numerics: continuum: calculix, elements, 8 across", "the budget is used up") in found.skipped
    (judged,) = [p for p in found.points if p.setting.part == "model" and p.setting.model == "rigid"]
    assert judged.compared == 1
    assert np.isfinite(judged.error).tolist() == [False, True]
    assert {p.setting.model for p in on_front(found.points) if p.setting.part == "numerics"} == {"flexible", "rigid"}
    expected = ["model auto: measured as flexible or rigid, the highest model that its data allow"]
    assert found.notes == (expected if "auto" in names else [])


def test_partial_uplift_judges_the_column_on_a_rigid_base():
    case = COLUMN | {"model": "flexible", "base": {"law": "winkler", "kw": 1e9}}
    scene = Sample(of(case), 1)
    (setting,) = [
        setting for setting, _ in made_of.models(scene.first(scene.own[0]), scene.own[0]) if setting.rigid_base
    ]
    assert setting.label == "model: flexible on a rigid base: event, standard"
    found = trade(of(case), backends=EVENT)
    (point,) = [p for p in found.points if p.setting.rigid_base]
    fine = {"solver": {"accuracy": "reference"}}
    rigid = rockcli.run({"case": COLUMN | {"model": "flexible"}, "save": {"histories": False}})
    sprung = rockcli.run({"case": case | fine, "save": {"histories": False}})
    apart = float(rigid["theta_peak_over_alpha"]) - float(sprung["theta_peak_over_alpha"])
    assert abs(apart) > 0.01
    assert point.error[0] == pytest.approx(apart, rel=1e-4)


@pytest.mark.parametrize("damping", ["dashpot", {"scheme": "hht", "alpha_d": 0.8}])
def test_no_column_on_a_rigid_base_is_judged_under_a_damping_it_does_not_know(damping):
    """It was solved as if nothing damped it."""
    case = COLUMN | {"model": "flexible", "base": {"law": "winkler", "kw": 1e9}, "damping": damping}
    scene = Sample(of(case), 1)
    assert "flexible" not in {setting.model for setting, _ in made_of.models(scene.first(scene.own[0]), scene.own[0])}


def test_skipped_settings_of_a_family_share_a_line(command, monkeypatch):
    monkeypatch.setattr(
        "rockcli.engine.trade.trade._expected",
        lambda _, setting, *__: np.inf if setting.numerics.backend == "scipy" else 0.0,
    )
    printed, _ = command(under(1.5), "--no-plots")
    skipped = [line.split(maxsplit=1)[1] for line in printed.splitlines() if line.startswith("  skipped")]
    assert skipped == [
        "frame, opensees: not for model rigid, only for 1, 2, 3, 4, flexible",
        "calculix: not for model rigid, only for continuum",
        "data: no record, so no error of the data",
        "numerics: rigid: scipy RK45: rtol 0.001, rtol 1e-06: the budget is used up",
        "numerics: rigid: scipy DOP853: rtol 0.001, rtol 1e-06: the budget is used up",
    ]


def test_a_backend_is_missed_only_where_it_would_solve_the_model(monkeypatch):
    monkeypatch.setattr("rockcli.engine.trade.trade.peers", lambda: EVENT)
    case = {key: value for key, value in COLUMN.items() if key != "column"}
    skipped = dict(trade(of(case | {"model": 1, "geometry": "corotational"})).skipped)
    assert skipped["opensees"] == "OpenSeesPy is not installed"
    assert "frame" not in skipped
    assert skipped["calculix"] == "not for model 1 corotational, only for continuum"
    assert dict(trade(of(case)).skipped)["opensees"] == "not for model rigid, only for 1, 2, 3, 4, flexible"


def test_a_body_that_rolls_is_held_against_nothing_that_knows_but_two_edges():
    """Every row of a model was that of the block that rolls, under another name, and of `scipy` that of its base."""
    outline = [[-0.25, 0.2], [-0.1, 0], [0.1, 0], [0.25, 0.2], [0.15, 0.7], [-0.15, 0.7]]
    pulse = {"shape": "sine", "a_p": "1.2*g*tan_alpha", "T_p": 0.3}
    found = trade(of({"block": {"outline": outline}, "motion": {"pulse": pulse}}))
    assert {(p.setting.part, p.setting.family) for p in found.points} == {("numerics", "event")}
    skipped = dict(found.skipped)
    assert skipped["scipy"] == "not for bodies that roll over vertices"
    assert skipped["model"].startswith("every other model knows but two edges")


def test_what_solves_no_sliding_is_not_held_against_what_does():
    """Of a block that slides `scipy` overturned another one, and was told a wrong outcome at every tolerance."""
    pulse = {"shape": "sine", "a_p": "0.9*g", "T_p": 0.5}
    case = {"block": {"h": 0.5, "b": 0.2, "mu": {"static": 0.45, "kinetic": 0.4}}, "motion": {"pulse": pulse}}
    found = trade(of(case))
    assert {p.setting.family for p in found.points} == {"event"}
    assert dict(found.skipped)["scipy"] == "not for bodies with block.mu, as it solves no sliding"


def test_a_damping_that_a_backend_does_not_know_is_said():
    scene = Sample(of(COLUMN | {"model": "flexible", "damping": "dashpot"}), 1)
    assert measuring._unable(scene, "event") == "not for model flexible with damping dashpot"
    assert measuring._unable(scene, "frame") == ""


def test_a_setting_that_solves_no_case_is_said(monkeypatch):
    def fails(batch):
        return Response(
            {
                "outcome": np.full(batch.size, FAILED, dtype=np.int8),
                "theta_peak_over_alpha": np.full(batch.size, np.nan),
            },
            ["no"] * batch.size,
        )

    right = measuring._solver
    monkeypatch.setattr(
        measuring, "_solver", lambda setting: fails if setting.numerics.rtol == 1e-4 else right(setting)
    )
    label = "numerics: rigid: event, rtol 0.0001"
    assert [left for left in trade(open_study(under(1.5)), backends=EVENT).skipped if "numerics" in left[0]] == [
        (label, "no sampled case has an outcome: no")
    ]


def test_every_family_has_its_first_setting_before_any_has_a_second():
    def made(backend, family, size):
        how = Numerics(backend)
        return measuring.Series([made_of.Setting("numerics", family, str(i), "1", None, how) for i in range(size)])

    families = [
        made("calculix", "mesh", 2),
        made("frame", "frame", 3),
        made("event", "event", 2),
        made("scipy", "a", 2),
    ]
    order = [f"{setting.family} {setting.step}" for _, setting in measuring._order(families)]
    first = ["event 0", "event 1", "mesh 0", "frame 0", "a 0"]
    assert order == [*first, "frame 1", "a 1", "frame 2", "mesh 1"]
    assert all(
        families[number].settings[int(setting.step)] is setting for number, setting in measuring._order(families)
    )


def test_errors_against_different_references_have_tables_and_fronts_of_their_own(command, tmp_path):
    printed, _ = command({"name": "column", "case": COLUMN | {"model": "flexible"}, "save": {"histories": False}})
    heads = [line.strip() for line in printed.splitlines() if "error of the numerics" in line]
    best = "error of the numerics, against event, dt/16 of draft"
    assert heads == [f"{best}: Pareto front", f"{best}, 20 elements: Pareto front"]
    steps, elements = (rows_below(printed, head) for head in heads)
    assert steps
    assert elements
    assert all("event, dt x" in row for row in steps)
    assert all("event, elements, " in row for row in elements)
    dataset = open_dataset(tmp_path / "column-trade" / "column-trade.nc")
    drawn = [line for line in figure("work_precision", dataset).axes[0].get_lines() if line.get_label() == FRONT]
    assert sorted(len(line.get_xdata()) for line in drawn) == sorted([len(steps), len(elements)])


def test_a_budget_for_nothing_at_all_is_refused(command, monkeypatch):
    monkeypatch.setattr("rockcli.engine.trade.trade._expected", lambda *_: np.inf)
    with pytest.raises(StudyError, match=r"no setting was measured: .*rtol 1e-14: the budget is used up"):
        command(under(1.5))


def test_the_summary_as_json(command, tmp_path):
    printed, _ = command(under(1.5), "--json", "--no-plots")
    told = json.loads(printed)
    assert told["file"] == str(tmp_path / "fate-trade" / "fate-trade.nc")
    assert told["sample"] == {"cases": 1, "of": 1}
    assert told["references"] == {"rigid": "event, rtol 1e-16"}
    assert (told["plots"], told["notes"]) == ([], [])
    assert [left["setting"] for left in told["skipped"]] == ["frame", "opensees", "calculix", "data"]
    assert told["skipped"][-1]["why"] == "no record, so no error of the data"
    (coarse,) = [p for p in told["points"] if (p["family"], p["setting"]) == ("scipy RK45", "rtol 0.001")]
    (fine,) = [p for p in told["points"] if (p["family"], p["setting"]) == ("scipy RK45", "rtol 1e-06")]
    assert coarse["median"] == coarse["p90"] > fine["median"] > 0.0
    assert (coarse["part"], coarse["model"], coarse["wrong"], coarse["compared"]) == ("numerics", "rigid", 0, 1)
    assert 0 < coarse["n_steps"] < coarse["n_rhs"] < fine["n_rhs"]
    assert coarse["seconds"] > 0.0
    assert {p["on_front"] for p in told["points"]} == {True, False}


def test_where_there_is_no_number_json_has_null(command):
    printed, _ = command(under(60.0), "--json", "--no-plots")
    assert {(p["median"], p["wrong"], p["compared"]) for p in json.loads(printed)["points"]} == {(None, 0, 1)}


def test_the_scenes_do_what_they_are_meant_to():
    """Closed form: nothing moves below g tan(alpha); above it the block uplifts."""
    for amplitude, outcome in ((0.5, NO_UPLIFT), (1.5, ROCKING)):
        assert int(rockcli.run(under(amplitude))["outcome"]) == outcome
