"""Studies whose cases and answers are made by hand, to test the engine without a solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scenes import make_batch, still

from rockcli.engine.sweep import isolate_failures as apart
from rockcli.engine.sweep import sweep
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import make_block
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import ROCKING, Response
from rockcli.scene.variables import SCALARS
from rockcli.study.study import Axis, Expect, Index, Study

Solver = Callable[[Batch], Response]


@dataclass(frozen=True)
class Cases:
    """Case i starts at theta_0 = i, which tells a hand-made solver which case it has; at most `most` at a time."""

    histories: bool
    most: int = 1000

    def batches(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        for start in range(0, len(indices), self.most):
            part = np.asarray(indices)[start : start + self.most]
            n = len(part)
            block = make_block(h=np.full(n, 2.0), b=np.full(n, 0.4), n=n)
            how = {"accuracy": Numerics().accuracy, "histories": self.histories, "dt_out": 0.5, "scalars": SCALARS}
            batch = make_batch(block, still(np.full(n, np.nan)), eta=1.0, theta_0=part.astype(float), **how)
            yield part, replace(batch, damping=Damping("none", np.ones((n, 2))))


MODEL = Axis("model", "model", ("rigid", "linearized"), numeric=False)
SLENDER = Axis("tan_alpha", "block.tan_alpha", (0.1, 0.2, 0.3), numeric=True)


def make_study(*axes: Axis, histories: bool = False, most: int = 1000, **more: Any) -> Study:
    values: dict[str, Any] = {
        "name": "made",
        "title": "Made by hand",
        "references": "",
        "file": None,
        "compare_to": None,
        "expect": (),
        "plots": (),
        "dt_out": 0.5,
        "scalars": SCALARS,
        "resolved": {"case": {}},
        "resolved_yaml": "name: made\n",
        "identity": "abc",
    }
    return Study(axes=axes, cases=Cases(histories, most), histories=histories, **(values | more))


def clause(quantity: str, check: str, target: Any, **more: Any) -> Expect:
    return Expect(quantity, more.pop("at", {}), check, target, **more)


def answer(batch: Batch, **scalars: Any) -> Response:
    """All cases rock, with the peaks given; reasons empty."""
    n = batch.size
    values = {
        "outcome": np.full(n, ROCKING, dtype=np.int8),
        "theta_peak_over_alpha": 0.01 * batch.theta_0,
        "n_impacts": np.full(n, 3),
    }
    return Response(scalars=values | scalars, reasons=[""] * n, used={"backend": "hand"})


@dataclass(frozen=True)
class Hand:
    """Stands where a backend would."""

    solver: Solver
    name: str = "by hand"

    def load(self) -> Solver:
        return self.solver


def solve_by(monkeypatch: pytest.MonkeyPatch, solver: Solver) -> None:
    """Make every batch be solved by `solver`."""
    for module in (apart, sweep):
        monkeypatch.setattr(module, "choose", lambda batch: Hand(solver))
