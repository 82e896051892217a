"""Which backend solves a batch: a table of lazy imports and what each supports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import cast

import numpy as np

from rockcli.errors import RockError, SolverError, StudyError
from rockcli.scene.auto import AUTO, highest
from rockcli.scene.batch import Batch
from rockcli.scene.models import FLEXIBLE, MODELS
from rockcli.scene.response import Response
from rockcli.study.study import Study

Solver = Callable[[Batch], Response]

FLEXIBLE_DAMPING = frozenset({"none", "restitution"})
"""Damping schemes of the event-driven flexible column, beside the column's own zeta."""


@dataclass(frozen=True)
class Support:
    """What a backend can do: (model, geometry) pairs, damping schemes, and a sentence for people."""

    models: frozenset[tuple[str, str | None]]
    damping: frozenset[str]
    sentence: str


@dataclass(frozen=True)
class Backend:
    """A row: name in the study, `module:function` of its `solve(batch) -> Response`, and its support.

    `automatic`: whether `backend: auto` may take it.  `flexible`: the target for model flexible where it is another.
    """

    name: str
    target: str
    support: Support
    automatic: bool = True
    flexible: str | None = None

    def supports(self, batch: Batch) -> bool:
        """Whether this backend can solve the batch."""
        pair = (batch.model, batch.geometry)
        if batch.model == FLEXIBLE and self.flexible and batch.damping.scheme not in FLEXIBLE_DAMPING:
            return False
        return pair in self.support.models and batch.damping.scheme in self.support.damping

    def of_model(self, model: str) -> Backend:
        """This row with the target that solves a model."""
        return replace(self, target=self.flexible) if model == FLEXIBLE and self.flexible else self

    def load(self) -> Solver:
        """Import the solver."""
        module, name = self.target.split(":")
        return cast(Solver, getattr(import_module(module), name))


_ROWS: tuple[Backend, ...] = (
    Backend(
        "event",
        "rockcli.solvers.event.solver:solve",
        Support(
            models=frozenset({*MODELS, (FLEXIBLE, None)}),
            damping=frozenset({"none", "restitution", "dashpot"}),
            sentence="event-driven Taylor (flexible: modal) steps: impacts, uplift and rest are located",
        ),
        flexible="rockcli.solvers.flexible:solve",
    ),
    Backend(
        "fema356",
        "rockcli.solvers.fema356:solve",
        Support(
            models=frozenset({("rigid", None)}),
            damping=frozenset({"fema356"}),
            sentence="equivalent linear oscillator on a response spectrum: known to be poor, for comparison",
        ),
    ),
    Backend(
        "scipy",
        "rockcli.solvers.general.solver:solve",
        Support(
            models=frozenset(MODELS),
            damping=frozenset({"none", "restitution", "dashpot"}),
            sentence="general ODE methods (RK23, RK45, DOP853, Radau, BDF, LSODA, ode23s), events located or not",
        ),
        automatic=False,
    ),
    Backend(
        "frame",
        "rockcli.solvers.frame.solver:solve",
        Support(
            models=frozenset({*((name, geometry) for name, geometry in MODELS if geometry), (FLEXIBLE, None)}),
            damping=frozenset({"none", "restitution", "dashpot", "hht"}),
            sentence="beam elements on a yielding base stepped in time, as the source did: 3-10 us per step",
        ),
        automatic=False,
    ),
    Backend(
        "opensees",
        "rockcli.solvers.opensees.solver:solve",
        Support(
            models=frozenset({*((name, geometry) for name, geometry in MODELS if geometry), (FLEXIBLE, None)}),
            damping=frozenset({"none", "restitution", "dashpot", "hht"}),
            sentence="OpenSees, one plain script per case (`rock export` writes it) in its own process",
        ),
        automatic=False,
    ),
    Backend(
        "calculix",
        "rockcli.solvers.calculix:solve",
        Support(
            models=frozenset({("continuum", None)}),
            damping=frozenset({"none", "hht"}),
            sentence="full mesh of bricks on a no-tension base, solved by CalculiX (ccx): minutes per case",
        ),
    ),
)

BACKENDS: dict[str, Backend] = {row.name: row for row in _ROWS}
"""In order of preference for `backend: auto`."""


DECIDING = ("model", "geometry", "damping", "solver", "case")
"""Axes along which the backend may change: the first key of their paths."""


def check_backend(study: Study) -> None:
    """`StudyError` if no backend, or not the one asked for, can solve any case of a study.

    Where an axis decides on it, single cases are refused when they are solved.
    """
    if any(axis.path.split(".")[0] in DECIDING for axis in study.axes):
        return
    try:
        _, batch = next(iter(study.batches(np.array([0]))))
    except RockError:
        return  # a bad case never loses the others
    try:
        choose(batch)
    except SolverError as refused:
        raise StudyError(f"case: {refused} (rock show backends: what each solves)", file=study.file) from None


def choose(batch: Batch) -> Backend:
    """Backend of a batch; `SolverError` if the one asked for, or for `auto` every one, cannot solve it.

    That of a batch of model auto is the backend of the highest model that its cases may need.
    """
    asked = batch.numerics.backend
    if batch.model == AUTO and asked in ("auto", "event"):
        batch = highest(batch)
    if asked != "auto" and asked not in BACKENDS:
        raise SolverError(f"there is no backend {asked!r}; there are {', '.join(BACKENDS)}")
    candidates = [row for row in BACKENDS.values() if row.automatic] if asked == "auto" else [BACKENDS[asked]]
    for backend in candidates:
        if backend.supports(batch):
            return backend.of_model(batch.model)
    what = f"model {batch.model!r}" + (f" ({batch.geometry})" if batch.geometry else "")
    who = "no backend" if asked == "auto" else f"backend {asked!r} does not"
    verb = "solves" if asked == "auto" else "solve"
    raise SolverError(f"{who} {verb} {what} with damping {batch.damping.scheme!r}")
