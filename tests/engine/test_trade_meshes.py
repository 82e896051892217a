"""`rock trade` and the full mesh: its families, what they are held against, what the budget leaves out."""

from __future__ import annotations

import copy
import shutil

import numpy as np
import pytest

import rockcli
from rockcli.engine.cost import seconds_per_case
from rockcli.engine.trade import meshes, trade
from rockcli.engine.trade.trade_results import contents_of
from rockcli.errors import StudyError
from rockcli.scene.response import ROCKING, Response
from rockcli.solvers.calculix.run import HOW_TO_INSTALL
from rockcli.storage.read import to_xarray
from rockcli.study.open import open_study

BOTH = frozenset({"event", "calculix"})

STUDY = {
    "name": "mesh",
    "case": {
        "block": {"height": 50, "tan_alpha": 0.1},
        "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 5, "T_p": 1.6}, "duration": 3.5},
        "model": "continuum",
        "damping": "none",
        "column": {"E": 30e9, "rho": 2500, "zeta": 0.01, "across": 2},
    },
    "save": {"histories": False},
}

OWN_STEP = 12.3809 * np.sqrt(2500.0 / 30e9) * 25.0 / 0.1 / 180.0
"""A 180th of the clamped period (4.3) [s]."""


def study(**case):
    given = copy.deepcopy(STUDY)
    given["case"] |= case
    return open_study(given)


@pytest.fixture
def made_up(monkeypatch):
    """A mesh whose error is known: 0.1/across^2 + dt above a peak of 0.6; the batches it is asked for.

    On a clock of its own an increment of an element takes 0.25 ms.
    """
    asked, clock = [], [0.0]

    def mesh(batch):
        asked.append(batch)
        along = batch.column.elements or 10 * batch.column.across
        clock[0] += 2.5e-4 * batch.column.across * along * 3.5 / batch.numerics.dt
        peak = np.full(batch.size, 0.6 + 0.1 / batch.column.across**2 + batch.numerics.dt)
        counts = {"n_steps": np.full(batch.size, 10), "n_rhs": np.full(batch.size, 25)}
        rocks = np.full(batch.size, ROCKING, dtype=np.int8)
        return Response({"outcome": rocks, "theta_peak_over_alpha": peak, **counts}, [""] * batch.size)

    monkeypatch.setattr(trade, "perf_counter", lambda: clock[0])
    right = trade._solver
    monkeypatch.setattr(trade, "_solver", lambda setting: mesh if setting.model == "continuum" else right(setting))
    return asked


def points(found, family):
    return [p for p in found.points if p.setting.family == family]


def test_a_ladder_is_held_against_its_finest(made_up):
    given = study()
    found = trade.trade(given, backends=BOTH)
    elements, steps = points(found, "calculix, elements"), points(found, "calculix")
    across = np.array([p.setting.across for p in elements])
    assert across.tolist() == [1, 2, 4, 6, 8]
    np.testing.assert_allclose([p.error[0] for p in elements[:-1]], 0.1 / across[:-1] ** 2 - 0.1 / 64, rtol=1e-9)
    factors = np.array([8.0, 4.0, 2.0, 1.0, 0.5])
    np.testing.assert_allclose([p.error[0] for p in steps[:-1]], (factors[:-1] - 0.5) * OWN_STEP, rtol=1e-6)
    for series in (elements, steps):
        assert np.isnan(series[-1].error[0])
        assert not series[-1].on_front
        assert series[-1].compared == 0
    assert found.references["continuum"] == "calculix, dt x 0.5: the finest measured"
    assert found.references["continuum, elements"] == "calculix, elements, 8 across: the finest measured"
    assert {p.setting.against for p in steps} == {"calculix, dt x 0.5"}
    dataset = to_xarray(contents_of(given, found)).set_index(setting="setting")
    one = dataset.sel(setting="numerics: continuum: calculix, dt x 1")
    assert (one["n_steps"].item(), one["n_rhs"].item()) == (10, 25)


def test_the_mesh_judges_the_models(made_up):
    found = trade.trade(study(), backends=BOTH)
    best = 0.6 + 0.1 / 64 + 2.0 * OWN_STEP
    judged = {p.setting.model: p for p in found.points if p.setting.against == "continuum"}
    assert set(judged) == {"flexible", "rigid"}
    for point in judged.values():
        assert point.error[0] == pytest.approx(point.answers.peak[0] - best, rel=1e-6)


def test_a_column_is_made_a_mesh_without_eta(made_up):
    column = {"E": 30e9, "rho": 2500, "zeta": 0.01}
    found = trade.trade(study(model="flexible", damping="restitution", column=column), backends=BOTH)
    assert not points(found, "calculix")
    assert [p.setting.across for p in points(found, "calculix, elements")] == [1, 2, 4, 6, 8]
    assert {batch.damping.scheme for batch in made_up} == {"none"}
    assert {batch.column.elements for batch in made_up} == {0}  # square ones, not the five of the column
    judged = [p.setting.model for p in found.points if p.setting.against == "continuum"]
    assert judged == ["flexible"]


def test_a_study_of_both_has_all_ladders(made_up):
    given = copy.deepcopy(STUDY)
    del given["case"]["column"]["across"]
    found = trade.trade(open_study(given | {"vary": {"model": ["continuum", "flexible"]}}), backends=BOTH)
    assert len(points(found, "calculix")) == len(points(found, "calculix, elements")) == 5
    assert len(points(found, "event, elements")) == 5
    assert {(p.setting.model, p.setting.against) for p in found.points if p.setting.model in ("flexible", "rigid")} >= {
        ("flexible", "continuum"),
        ("rigid", "flexible"),
    }
    assert {batch.column.elements for batch in made_up} == {0}


def test_elements_along_go_with_those_across(made_up):
    column = {"E": 30e9, "rho": 2500, "zeta": 0.01, "across": 2, "elements": 10}
    trade.trade(study(column=column), backends=BOTH)
    assert {(b.column.across, b.column.elements) for b in made_up} == {(1, 5), (2, 10), (4, 20), (6, 30), (8, 40)}


def test_a_budget_too_small_for_a_mesh_of_the_study_s_own_leaves_its_verdict_out(made_up):
    found = trade.trade(study(column=STUDY["case"]["column"] | {"across": 6}), backends=BOTH, budget=20.0)
    measured = [p.setting.across for p in points(found, "calculix, elements")]
    assert measured == [1, 2]  # 0.9 + 3.5 s, and 8 s for a coarse step between them: 14 s more are too many
    assert len(points(found, "calculix")) == 1
    assert found.skipped[0] == ("model: rigid: event, against continuum", "no mesh as fine as the study's was measured")
    assert ("numerics: continuum: calculix, elements, 8 across", "the budget is used up") in found.skipped
    assert not [p for p in found.points if p.setting.against == "continuum"]


def test_the_cost_foretold_goes_with_elements_and_increments():
    _, batch = next(study().batches(np.array([0])))
    elements, steps = meshes.families(batch, 0)
    cost = [seconds_per_case(setting.of(batch), "calculix") for setting in elements]
    np.testing.assert_allclose(np.array(cost) / cost[0], np.array([1, 2, 4, 6, 8]) ** 2)
    coarse, fine = (seconds_per_case(setting.of(batch), "calculix") for setting in (steps[0], steps[-1]))
    assert fine == pytest.approx(16.0 * coarse)
    assert 2.0 < seconds_per_case(steps[2].of(batch), "calculix") < 20.0  # 40 elements, 350 increments


def test_what_is_no_mesh_is_said(made_up):
    found = trade.trade(study(column=STUDY["case"]["column"] | {"E": 1e8}), backends=BOTH)
    (said,) = [why for what, why in found.skipped if what == "calculix"]
    assert "buckles under its own weight" in said
    assert not made_up


def test_a_missing_program_is_said(monkeypatch):
    monkeypatch.setattr(trade, "peers", lambda: frozenset({"event"}))
    found = trade.trade(study())
    assert ("calculix", "there is no `ccx` in PATH") in found.skipped
    with pytest.raises(StudyError, match="the full mesh needs CalculiX: there is no `ccx` in PATH"):
        trade.trade(study(damping={"scheme": "hht", "alpha_d": 0.8}))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason=HOW_TO_INSTALL)
def test_calculix_itself(monkeypatch):
    """Two meshes and two steps: peaks are those of the backend alone, and the column is nearer to the mesh than the block."""
    monkeypatch.setattr(meshes, "ACROSS", (1, 2))
    monkeypatch.setattr(meshes, "STEPS", (8.0, 4.0))
    column = STUDY["case"]["column"] | {"elements": 10}
    found = trade.trade(study(column=column), backends=BOTH, budget=300.0)
    assert [what for what, _ in found.skipped] == ["event", "data"]  # not of a mesh, and no record
    coarse, fine = points(found, "calculix")
    case = copy.deepcopy(STUDY["case"]) | {"column": column}
    alone = [
        float(rockcli.run({"case": case | {"solver": {"dt": factor * OWN_STEP}}, "save": {"histories": False}})[name])
        for factor, name in ((8.0, "theta_peak_over_alpha"), (4.0, "theta_peak_over_alpha"), (4.0, "n_rhs"))
    ]
    assert coarse.error[0] == pytest.approx(alone[0] - alone[1], rel=1e-3)
    assert fine.answers.rhs[0] == pytest.approx(alone[2], rel=0.01)
    assert all((p.answers.rhs > p.answers.steps).all() for p in found.points if p.setting.model == "continuum")
    error = {p.setting.model: abs(p.error[0]) for p in found.points if p.setting.against == "continuum"}
    assert error["flexible"] < 0.02 < error["rigid"]
