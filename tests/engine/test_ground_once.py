"""Accelerations of the ground follow from the motion: no chunk carries them, and the dataset has them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rockcli.engine.run import solve
from rockcli.engine.sweep import sweep
from rockcli.engine.sweep.chunk_result import ChunkResult
from rockcli.engine.sweep.reuse_results import reuse_results
from rockcli.engine.sweep.sweep import Solving
from rockcli.solvers.common import ground
from rockcli.study.open import open_study
from rockcli.study.study import Study

SCALES = [0.05, 0.5, 3.0, 8.0]
DT_OUT = 0.013


def study(backend: str = "event", duration: float | None = 5.0) -> Study:
    """A block of 2 m under one record, up to a scale at which it overturns."""
    record = {"file": "synthetic_pulse_m70.AT2", "scale": 1.0}
    motion: dict[str, Any] = {"record": record} | ({} if duration is None else {"duration": duration})
    case = {"block": {"R": 2.0, "tan_alpha": 0.2}, "motion": motion, "solver": {"backend": backend}}
    if backend == "fema356":
        case["damping"] = {"scheme": "fema356"}
    vary = {"motion.record.scale": SCALES, "block.R": [1.0, 2.0]}
    return open_study({"name": "x", "case": case, "vary": vary, "save": {"histories": True, "dt_out": DT_OUT}})


@pytest.fixture(autouse=True)
def _records(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROCK_RECORDS", str(Path(__file__).parents[2] / "records"))


@pytest.mark.parametrize(
    ("backend", "duration"),
    [
        ("event", None),
        ("event", 5.0),
        ("fema356", None),
        ("fema356", 5.0),
        ("scipy", 5.0),
        pytest.param("scipy", None, marks=pytest.mark.slow),
    ],
)
def test_the_ground_of_every_case_is_its_record_as_long_as_it_is_told(backend: str, duration: float | None) -> None:
    of = study(backend, duration)
    told = []
    for case in range(of.size):
        ((_, batch),) = of.batches(np.array([case]))
        told.append(sweep.choose(batch).load()(batch))
    contents = solve(of)
    time, a_g = contents.values("time"), contents.values("a_g").reshape(of.size, -1)
    ((_, batch),) = of.batches(np.array([0]))
    values, dt = batch.excitation.horizontal.values, batch.excitation.horizontal.dt
    for case, response in enumerate(told):
        expected = np.interp(time, dt * np.arange(len(values)), values, right=0.0) * SCALES[case // 2]
        if duration is not None:
            expected[time > duration] = 0.0
        length = len(response.time)
        assert {"a_g", "a_v"}.isdisjoint(response.histories)
        live = np.isfinite(response.histories["theta"][0])
        if response.shaken is not None:
            live = np.arange(length) < response.shaken["a_g"][0]
        assert live.any()
        assert np.isfinite(a_g[case]).tolist() == live.tolist() + [False] * (len(time) - length)
        np.testing.assert_allclose(a_g[case, :length][live], expected[:length][live], rtol=1e-9, atol=1e-9)
    assert ("a_v" in contents.fields) == (backend != "fema356")


def test_chunks_carry_no_ground_and_a_record_is_interpolated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    of = study()
    answer: ChunkResult = Solving(of)(np.arange(of.size))
    assert "theta" in answer.histories
    assert {"a_g", "a_v"}.isdisjoint(answer.histories)
    assert answer.shaken["a_g"].tolist() == np.isfinite(answer.histories["theta"]).sum(axis=1).tolist()
    seen, unscaled = [], ground.unscaled
    monkeypatch.setattr(ground, "unscaled", lambda *given: seen.append(1) or unscaled(*given))
    solve(of)
    assert len(seen) == 2  # by the solver, and for the dataset


def test_what_is_reused_has_the_same_ground() -> None:
    whole = solve(study())
    known = reuse_results(study(), whole)
    assert known is not None
    again = solve(study(), sweep=sweep.Sweep(sweep.Team(), known=known))
    for name in ("theta", "a_g", "a_v"):
        np.testing.assert_array_equal(again.values(name), whole.values(name))
