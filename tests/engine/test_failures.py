"""A case that failed is told whatever is saved, and again whenever the results are looked at."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swept import STUDY, made_up, study, write_study

from rockcli.cli import main as command
from rockcli.engine.run import run_study, solve
from rockcli.engine.summary import UP_TO_DATE
from rockcli.engine.sweep import parts, sweep
from rockcli.scene.response import FAILED
from rockcli.storage import netcdf
from rockcli.study.open import open_study

UNLUCKY = 6
"""Cases of the study that fail: one of its ten angles, by two models and three sizes."""


@pytest.fixture(autouse=True)
def made_up_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rockcli.solvers.event.solver.solve", made_up)


def saving(*names: str, **more: Any) -> Any:
    return study(save={"histories": False, "scalars": list(names)}, **more)


@pytest.mark.parametrize("names", [("theta_peak_over_alpha",), ("n_impacts",), ("outcome",), ("reason",)])
def test_failures_are_counted_and_explained_whatever_is_saved(names: tuple[str, ...], tmp_path: Path) -> None:
    first = run_study(saving(*names), tmp_path, plots=False)
    again = run_study(saving(*names), tmp_path, plots=False)
    assert again.status == UP_TO_DATE
    for report in (first, again):
        assert (report.failed, report.exit_code) == (UNLUCKY, 3)
        assert report.outcomes["failed"] == UNLUCKY
        assert report.reasons["number 56 is unlucky"] == UNLUCKY
    found = netcdf.read(tmp_path / "swept" / "swept.nc")
    failed = found.values("outcome") == FAILED
    assert (found.values("reason")[failed] > 0).all()
    if "reason" not in names:
        assert (found.values("reason")[~failed] == 0).all()
        assert found.values("reasons").tolist() == ["", "number 56 is unlucky"]


def test_where_nothing_fails_no_reasons_are_added(tmp_path: Path) -> None:
    fine = saving("theta_peak_over_alpha", vary=STUDY["vary"] | {"initial.theta": [0.001, 0.002]})
    report = run_study(fine, tmp_path, plots=False)
    assert (report.failed, report.exit_code) == (0, 0)
    found = netcdf.read(tmp_path / "swept" / "swept.nc")
    assert "reason" not in found.fields
    assert "outcome" in found.fields


def test_failures_survive_parts_and_more_points(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "EVERY", -1.0)
    monkeypatch.setattr(sweep, "CHUNK", 7)
    one = saving("theta_peak_over_alpha")
    for k in (1, 2):
        run_study(one, tmp_path, plots=False, share=(k, 2))
    merged = run_study(one, tmp_path, plots=False)
    assert (merged.resumed, merged.failed, merged.reasons) == (60, UNLUCKY, {"number 56 is unlucky": UNLUCKY})
    more = saving("theta_peak_over_alpha", vary=STUDY["vary"] | {"block.R": [1.0, 2.0, 3.0, 4.0]})
    longer = run_study(more, tmp_path, plots=False)
    assert (longer.taken_over, longer.failed) == (60, UNLUCKY + 2)
    assert longer.reasons == {"number 56 is unlucky": UNLUCKY + 2}


def test_the_command_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write_study(tmp_path, save={"histories": False, "scalars": ["theta_peak_over_alpha"]})
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["rock", "run", "swept.yaml", "--no-plots"])
    for _ in range(2):
        with pytest.raises(SystemExit) as left:
            command.main()
        assert left.value.code == 3
        said = capsys.readouterr().out
        assert "6 failed" in said
        assert "number 56 is unlucky (6 cases)" in said


HOLE: dict[str, Any] = {
    "name": "hole",
    "let": {"x": 0, "y": 0},
    "case": {
        # the one case in the middle has no slenderness; of so many, corners and edges are built before solving
        "block": {"R": 2, "tan_alpha": "0.2 - 0.5*exp(-((x - 0.5)**2 + (y - 0.5)**2)*20000)"},
        "motion": {"pulse": {"shape": "sine", "a_p_over_g_tan_alpha": 2, "omega_p_over_p": 4}},
        "model": "linearized",
    },
    "vary": {"let.x": {"from": 0, "to": 1, "n": 11}, "let.y": {"from": 0, "to": 1, "n": 11}},
    "rules": ["west"],
}
SEARCHED = {"from": 1, "to": 12, "n": 4, "find": "overturning"}


def test_one_case_that_cannot_be_built_loses_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    monkeypatch.setattr("rockcli.study.cases.cases.PROBED", 50)
    given = HOLE | {"save": {"scalars": ["theta_peak_over_alpha"]}, "expect": [{"quantity": "a_p", "min": 0}]}
    found = solve(open_study(given))
    failed = found.values("outcome") == FAILED
    assert np.argwhere(failed).tolist() == [[5, 5]]
    assert "case.block.tan_alpha: must be greater than 0" in found.values("reasons")[1]
    np.testing.assert_array_equal(np.isnan(found.values("west_ratio")), failed)


def test_many_cases_in_a_row_that_cannot_be_built_lose_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of one row of four, no end of any column, the friction is below zero from a value of another axis on."""
    monkeypatch.undo()
    monkeypatch.setattr("rockcli.study.cases.cases.PROBED", 50)
    rows = {"a": (1.0, 3.0), "b": (2.0, 1.5), "c": (1.0, 1.0), "d": (3.0, 3.0)}
    given = {
        "name": "row",
        "let": {"k": 1, "j": 1, "q": 1},
        "case": {"block": {"R": 2.0, "tan_alpha": 0.2, "mu": "0.3 - (k - j)*q"}, "initial": {"theta": 0.01}},
        "vary": {
            "case": {name: {"let.k": k, "let.j": j} for name, (k, j) in rows.items()},
            "let.q": {"from": 0.1, "to": 0.9, "n": 2000},
        },
        "save": {"histories": False, "scalars": ["outcome"]},
    }
    opened = open_study(given)
    failed = solve(opened).values("outcome") == FAILED
    assert not failed[[0, 2, 3]].any()
    np.testing.assert_array_equal(failed[1], np.array(opened.axes[1].values) > 0.6)


def test_one_case_that_cannot_be_built_does_not_lose_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    monkeypatch.setattr("rockcli.study.cases.cases.PROBED", 50)
    given = HOLE | {"vary": HOLE["vary"] | {"motion.pulse.a_p_over_g_tan_alpha": SEARCHED}}
    found = solve(open_study(given))
    for name in ("a_p_over_g_tan_alpha_overturning", "a_p_over_g_tan_alpha_overturning_prescreen"):
        assert np.argwhere(np.isnan(found.values(name))).tolist() == [[5, 5]]
