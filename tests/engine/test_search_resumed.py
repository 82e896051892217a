"""A search that is ended goes on where it was; a trial that fails is told, and one of the machine is tried again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from swept import assert_same, stop_after, study

from rockcli.engine.run import run_study, solve
from rockcli.engine.search import search
from rockcli.engine.summary import UP_TO_DATE
from rockcli.engine.sweep import parts, sweep
from rockcli.errors import MachineError
from rockcli.scene.batch import Batch
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_AFTER_IMPACT, ROCKING, Response
from rockcli.storage import netcdf
from rockcli.study.study import Study

FOUND = "initial_theta_overturning"


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Values tried; a case overturns from 0.1 R/3 on."""
    tried: list[float] = []

    def solver(batch: Batch) -> Response:
        tried.extend(batch.theta_0.tolist())
        falls = batch.theta_0 > 0.1 * batch.block.R[:, 0] / 3.0
        outcome = np.where(falls, OVERTURNED_AFTER_IMPACT, np.where(batch.theta_0 > 0.01, ROCKING, NO_UPLIFT))
        return Response(scalars={"outcome": outcome.astype(np.int8)}, reasons=[""] * batch.size)

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    monkeypatch.setattr(parts, "EVERY", -1.0)
    monkeypatch.setattr(search, "Pace", lambda estimate: sweep.Pace(estimate, 5))
    return tried


def searched(**more: Any) -> Study:
    vary = {"block.R": [1.0, 1.5, 2.0, 2.5], "initial.theta": {"from": 0.005, "to": 0.2, "n": 9, "find": "overturning"}}
    return study(vary=vary, save={}, **more)


@pytest.mark.parametrize("chunks", [1, 4, 8, 12])
def test_a_search_goes_on(chunks: int, solved: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solve(searched())
    every = len(solved)
    solved.clear()
    with monkeypatch.context() as once:
        stop_after(once, chunks, KeyboardInterrupt)
        with pytest.raises(KeyboardInterrupt):
            run_study(searched(), tmp_path, plots=False)
    first = len(solved)
    report = run_study(searched(), tmp_path, plots=False)
    assert (report.resumed, len(solved)) == (first, every)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))
    assert [file.name for file in (tmp_path / "swept").iterdir()] == ["swept.nc"]
    assert run_study(searched(), tmp_path, plots=False).status == UP_TO_DATE
    np.testing.assert_allclose(whole.values(FOUND), 0.1 * np.array([1.0, 1.5, 2.0, 2.5]) / 3.0, rtol=2e-6)


def test_damaged_trials_are_solved_again_and_told(
    solved: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = solve(searched())
    with monkeypatch.context() as once:
        once.setattr(netcdf.Writer, "finish", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            run_study(searched(), tmp_path, plots=False)
    part = min((tmp_path / "swept").rglob("*.npz"))
    part.write_bytes(part.read_bytes()[:200])
    report = run_study(searched(), tmp_path, plots=False)
    assert "some results kept by earlier runs were damaged and were solved again" in report.warnings
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))


def spoilt(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    """Break trials of one case, above the first points of the scan."""
    from rockcli.solvers.event import solver as event

    right = event.solve

    def solver(batch: Batch) -> Response:
        if ((batch.block.R[:, 0] == 2.0) & (batch.theta_0 > 0.04)).any():
            raise error
        return right(batch)

    monkeypatch.setattr(event, "solve", solver)


def test_a_trial_that_fails_is_told(solved: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solve(searched()).values(FOUND)
    spoilt(monkeypatch, FloatingPointError("overflow"))
    for report in (run_study(searched(), tmp_path, plots=False), run_study(searched(), tmp_path, plots=False)):
        assert (report.failed, report.exit_code) == (1, 3)
        assert report.reasons == {"the solver broke: FloatingPointError: overflow": 1}
    found = netcdf.read(tmp_path / "swept" / "swept.nc").values(FOUND)
    np.testing.assert_array_equal(np.isnan(found), [False, False, True, False])
    np.testing.assert_array_equal(np.delete(found, 2), np.delete(whole, 2))


def test_a_failure_that_was_kept_is_told(solved: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as once:
        spoilt(once, FloatingPointError("overflow"))
        once.setattr(netcdf.Writer, "finish", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            run_study(searched(), tmp_path, plots=False)
    solved.clear()
    report = run_study(searched(), tmp_path, plots=False)
    assert not solved
    assert report.failed == 1


def test_what_the_machine_refuses_is_tried_again(
    solved: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = solve(searched())
    with monkeypatch.context() as once:
        spoilt(once, MemoryError("no more"))
        with pytest.raises(MachineError, match=r"7 of 36 cases are not solved.*no more; run again"):
            run_study(searched(), tmp_path, plots=False)
    report = run_study(searched(), tmp_path, plots=False)
    assert (report.resumed, report.failed) == (29, 0)
    assert_same(whole, netcdf.read(tmp_path / "swept" / "swept.nc"))
