"""`audit`: what a tighter run does not confirm is found, counted and named; what it confirms costs nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import rockcli.solvers.event.solver as event
from rockcli.analysis.expect import judge
from rockcli.cli.main import app
from rockcli.engine.audit import NOT_AUDITED, check_audit, tighter
from rockcli.engine.run import check_answers, run_study, solve
from rockcli.errors import StudyError
from rockcli.scene.auto import CANDIDATES
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT
from rockcli.study.open import open_study

BLOCK = {"R": 2.0, "tan_alpha": 0.2}
STUDY = {
    "name": "audited",
    "case": {
        "block": BLOCK,
        "motion": {"pulse": {"shape": "ricker", "a_p": "g*tan_alpha", "omega_p": "3*pi"}},
    },
    "vary": {"motion.pulse.a_p_over_g_tan_alpha": [1.2, 2.0, 2.8, 3.6]},
    "save": {"histories": False, "scalars": ["outcome", "theta_peak_over_alpha", "error_estimate"]},
    "audit": True,
}
STUDY["case"]["motion"]["pulse"].pop("a_p")
STUDY["case"]["motion"]["pulse"]["a_p_over_g_tan_alpha"] = 2.0


def study(**more):
    return open_study(STUDY | more)


def spoiled(monkeypatch, spoil):
    """Let the event solver answer wrongly at accuracy standard."""
    right = event.solve

    def wrong(batch):
        return spoil(right, batch) if batch.numerics.accuracy == "standard" else right(batch)

    monkeypatch.setattr(event, "solve", wrong)


def test_a_sound_sweep_is_confirmed():
    found = solve(study())
    assert found.values("audit_same_outcome").tolist() == [1, 1, 1, 1]
    assert np.nanmax(found.values("audit_error")) < 1e-9
    assert int(found.values("audit_disagreements")) == 0
    assert "all 4 cases again, standard -> reference: 0 other outcomes" in found.attrs["audit"]


def test_a_kernel_with_a_wrong_restitution_is_found(monkeypatch):
    def slack(right, batch):
        return right(replace(batch, damping=replace(batch.damping, eta=batch.damping.eta * 0.99)))

    spoiled(monkeypatch, slack)
    found = solve(study())
    error = found.values("audit_error")
    assert (error[1:] > 1e-5).all()
    assert int(found.values("audit_disagreements")) >= 3
    worst = int(np.nanargmax(error))
    at = found.values("a_p_over_g_tan_alpha")[worst]
    assert f"a_p_over_g_tan_alpha={at:g}: peak off by" in found.attrs["audit"]


def test_a_wrong_outcome_is_found_and_judged(monkeypatch):
    def falls(right, batch):
        response = right(batch)
        response.scalars["outcome"][1] = OVERTURNED_AFTER_IMPACT
        return response

    spoiled(monkeypatch, falls)
    clause = {"quantity": "audit_disagreements", "max": 0}
    given = study(expect=[clause])
    found = solve(given)
    assert found.values("audit_same_outcome").tolist() == [1, 0, 1, 1]
    assert "a_p_over_g_tan_alpha=2: overturned_after_impact -> rocking" in found.attrs["audit"]
    assert not judge(found, given.expect)[0].passed


def test_a_share_is_the_same_sample_every_time():
    given = study(audit=0.5)
    one, two = solve(given), solve(given)
    same = one.values("audit_same_outcome")
    assert (same != NOT_AUDITED).sum() == 2
    assert same.tobytes() == two.values("audit_same_outcome").tobytes()
    assert np.isnan(one.values("audit_error")[same == NOT_AUDITED]).all()
    assert "2 of 4 cases again (a sample, the same every time)" in one.attrs["audit"]


def test_an_audit_changes_no_identity_and_comes_and_goes_without_solving(tmp_path, monkeypatch):
    plain = open_study({key: value for key, value in STUDY.items() if key != "audit"})
    assert plain.identity == study().identity
    assert not run_study(plain, tmp_path, plots=False).audit
    levels = []
    right = event.solve

    def listened(batch):
        levels.append(batch.numerics.accuracy)
        return right(batch)

    monkeypatch.setattr(event, "solve", listened)
    audited = run_study(study(), tmp_path, plots=False)
    assert (audited.status, set(levels)) == ("up to date", {"reference"})
    levels.clear()
    again = run_study(study(title="other words"), tmp_path, plots=False)
    assert again.audit == audited.audit
    assert not levels
    assert not run_study(plain, tmp_path, plots=False).audit


@pytest.mark.parametrize(
    ("solver", "name", "value"),
    [
        ({"accuracy": "draft"}, "accuracy", "standard"),
        ({"rtol": 1e-6}, "rtol", 1e-8),
        ({"backend": "scipy", "rtol": 1e-13}, "rtol", 2.5e-14),
    ],
)
def test_what_is_tighter(solver, name, value):
    _, batch = next(iter(open_study(STUDY | {"case": STUDY["case"] | {"solver": solver}}).batches()))
    found = tighter(batch)
    assert found is not None
    expected = value if isinstance(value, str) else pytest.approx(value, rel=1e-12)
    assert getattr(found, name) == expected


def test_time_steps_and_yield_rotation_are_halved_together():
    case = STUDY["case"] | {"model": 1, "solver": {"backend": "frame", "dt": 1e-4, "yield_rotation": 1e-6}}
    _, batch = next(iter(open_study(STUDY | {"case": case}).batches()))
    found = tighter(batch)
    assert found is not None
    assert (found.dt, found.yield_rotation) == (5e-5, 5e-7)


def test_columns_that_model_auto_takes_are_audited_where_rtol_is_given():
    """They take no rtol: a finer one alone would solve them again to the same bits, and confirm anything."""
    case = {
        "block": {"height": 10.0, "width": 2.0},
        "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 1.5, "omega_p_over_p": 4.0}},
        "model": "auto",
        "column": {"E": 3e9, "rho": 2500.0, "zeta": 0.01},
        "solver": {"rtol": 1e-6},
    }
    found = solve(study(case=case, vary={}, save={}))
    assert CANDIDATES[int(found.values("model_used"))] == "flexible"
    assert "rtol 1e-06 -> 1e-08 with standard -> reference" in found.attrs["audit"]
    assert 0.0 < float(found.values("audit_error")) < 1e-6


def test_what_refine_filled_in_is_not_audited():
    """A pixel that was filled in wrongly is no other outcome of a solver, and need not be solved for an audit."""
    values = {"from": 1.0, "to": 10.0, "n": 100}
    vary = {"motion.pulse.a_p_over_g_tan_alpha": values, "block.R": values}
    found = solve(study(vary=vary, refine=True, save={}))
    solved = found.values("solved") == 1
    assert 0 < solved.sum() < solved.size
    np.testing.assert_array_equal(found.values("audit_same_outcome"), np.where(solved, 1, NOT_AUDITED))
    assert f"all {solved.sum()} cases again" in found.attrs["audit"]


def test_nothing_is_tighter_than_reference_and_that_is_said():
    found = solve(study(case=STUDY["case"] | {"solver": {"accuracy": "reference"}}))
    assert (found.values("audit_same_outcome") == NOT_AUDITED).all()
    assert "no tighter setting for 4" in found.attrs["audit"]


def test_what_cannot_be_audited_is_refused_before_solving():
    with pytest.raises(StudyError, match=r"audit: compares outcomes, and this study is one of static curves"):
        check_audit(study(case={"block": BLOCK}, vary={}, save={}, curves=["moment_rotation"]))
    searched = {"motion.pulse.a_p_over_g_tan_alpha": {"from": 1, "to": 9, "n": 5, "find": "overturning"}}
    with pytest.raises(StudyError, match="audit: compares cases"):
        check_answers(open_study({k: v for k, v in STUDY.items() if k != "save"} | {"vary": searched}))
    with pytest.raises(StudyError, match="a share of the cases, above 0 and up to 1, is expected, not"):
        study(audit=2)


def test_the_option_of_the_command(tmp_path):
    path = tmp_path / "audited.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in STUDY.items() if key != "audit"}))
    told = CliRunner().invoke(
        app, ["run", str(path), "--out", str(tmp_path), "--audit", "--no-plots", "--workers", "1"]
    )
    assert told.exit_code == 0, told.output
    assert "  audit     all 4 cases again, standard -> reference: 0 other outcomes" in told.output


@pytest.mark.parametrize(
    ("model", "solver"),
    [
        ("rigid", {"accuracy": "draft"}),
        ("rigid", {"rtol": 1e-6}),
        ("rigid", {"backend": "scipy", "method": "RK45", "rtol": 1e-5}),
        pytest.param(3, {"backend": "frame", "dt": 5e-4, "yield_rotation": 4e-6}, marks=pytest.mark.slow),
    ],
    ids=["event draft", "event 1e-6", "scipy", "frame"],
)
def test_the_error_a_run_states_is_of_the_size_of_its_error(model, solver):
    """Against the event solver at reference, over four amplitudes: not hidden, and not cried out."""
    more = {"save": STUDY["save"], "audit": False}
    given = solve(study(case=STUDY["case"] | {"model": model, "solver": solver}, **more))
    best = solve(study(case=STUDY["case"] | {"model": model, "solver": {"accuracy": "reference"}}, **more))
    error = np.abs(given.values("theta_peak_over_alpha") - best.values("theta_peak_over_alpha"))
    stated = given.values("error_estimate")
    assert np.isfinite(stated).all()
    assert (error <= 10.0 * stated + 1e-13).all(), (error, stated)
    assert np.median(stated) <= 3e3 * np.median(error) + 1e-13


def test_a_procedure_without_settings_states_no_error_and_is_not_audited():
    found = solve(study(case=STUDY["case"] | {"damping": "fema356"}))
    assert np.isnan(found.values("error_estimate")).all()
    assert "no tighter setting for 4" in found.attrs["audit"]
