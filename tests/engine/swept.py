"""A study of 60 cases and a solver whose answers are made up from the numbers of a case, to look at a sweep alone."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from rockcli.engine.run import solve
from rockcli.engine.sweep.chunk_result import ChunkResult
from rockcli.engine.sweep.parts import Parts
from rockcli.engine.sweep.sweep import Sweep
from rockcli.engine.sweep.work import Team
from rockcli.scene.batch import Batch
from rockcli.scene.response import FAILED, Response
from rockcli.storage.contents import Contents
from rockcli.study.open import open_study
from rockcli.study.study import Study

STUDY: dict[str, Any] = {
    "name": "swept",
    "case": {"block": {"R": 2.0, "tan_alpha": 0.2}, "initial": {"theta": 0.01}},
    "vary": {
        "model": ["rigid", "linearized"],
        "block.R": [1.0, 2.0, 3.0],
        "initial.theta": {"from": 0.001, "to": 0.1, "n": 10},
    },
    "save": {
        "histories": False,
        "scalars": ["outcome", "theta_peak_over_alpha", "n_impacts", "wall_time", "reason"],
    },
}
CASES = 60


def made_up(batch: Batch) -> Response:
    """An answer per case that depends on all its numbers and on nothing else; some fail, each with its own words."""
    size = batch.theta_0 * batch.block.R[:, 0] + (batch.model == "rigid")
    rank = np.rint(batch.theta_0 * 1e3).astype(np.int64)
    outcome = np.where(rank % 7 == 0, FAILED, rank % 4).astype(np.int8)
    scalars: dict[str, Any] = {
        "outcome": outcome,
        "theta_peak_over_alpha": np.sqrt(size),
        "n_impacts": rank,
        "wall_time": np.random.default_rng().random(batch.size),
    }
    reasons = [f"number {r} is unlucky" if r % 7 == 0 else "even" if r % 2 == 0 else "" for r in rank.tolist()]
    return Response(scalars=scalars, reasons=reasons, used={"backend": "made up", "model": batch.model})


def counting(monkeypatch: pytest.MonkeyPatch, answer: Callable[[Batch], Response] = made_up) -> list[int]:
    """Have made-up answers in place of the event-driven solver; sizes of the batches, as they are solved."""
    sizes: list[int] = []

    def solver(batch: Batch) -> Response:
        sizes.append(batch.size)
        return answer(batch)

    monkeypatch.setattr("rockcli.solvers.event.solver.solve", solver)
    return sizes


def stop_after(monkeypatch: pytest.MonkeyPatch, chunks: int, error: type[BaseException]) -> None:
    """Break off a run after some chunks."""
    keep, seen = Parts.keep, []

    def kept(self: Parts, answer: ChunkResult) -> None:
        keep(self, answer)
        seen.append(answer)
        if len(seen) == chunks:
            raise error

    monkeypatch.setattr(Parts, "keep", kept)


def study(**more: Any) -> Study:
    return open_study(STUDY | more)


def write_study(folder: Path, **more: Any) -> Path:
    path = folder / "swept.yaml"
    path.write_text(yaml.safe_dump(STUDY | more, sort_keys=False))
    return path


def solved(given: Study, workers: int = 1, **more: Any) -> Contents:
    return solve(given, sweep=Sweep(Team(workers), **more))


def assert_same(one: Contents, other: Contents) -> None:
    """Bit for bit, but for dates and the time it took."""
    assert one.axes == other.axes
    assert list(one.fields) == list(other.fields)
    for name, item in one.fields.items():
        found = other.fields[name]
        assert (found.dims, found.values.dtype, found.coordinate) == (item.dims, item.values.dtype, item.coordinate)
        assert {k: str(v) for k, v in found.attrs.items()} == {k: str(v) for k, v in item.attrs.items()}
        if item.is_text:
            assert found.values.tolist() == item.values.tolist()
        elif name != "wall_time":
            assert found.values.tobytes() == item.values.tobytes(), name
    for name, words in one.attrs.items():
        if name == "solver_settings":  # a process that has compiled its kernels before stays with them
            words, others = (re.sub("compiled|interpreted", "", text) for text in (words, other.attrs[name]))
            assert words == others
        else:
            assert name in ("history", "date_created") or other.attrs[name] == words, name
