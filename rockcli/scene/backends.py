"""The backends, one row each: all that the program knows of one outside its own solver.

The schema of the study, `rock show backends`, the choice of a backend, warnings about keys that nobody reads, the
expected cost, audits and `rock trade` read these rows, and so do the tests.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, cast

from rockcli.scene.constants import METHODS
from rockcli.scene.laws.models import CONTINUUM, FLEXIBLE, MODELS

if TYPE_CHECKING:
    from rockcli.scene.batch import Batch
    from rockcli.scene.response import Response

Pair = tuple[str, str | None]
"""Model and geometry."""

EVENT = "event"
"""The backend that every other one is held against, where it solves the model."""


@dataclass(frozen=True)
class Cost:
    """Time that a case takes, typically [s]: what it takes at least, and what is added for each unit of work.

    Attributes:
        case: imports of its own, a process, a first step.
        sample: of a recorded motion.
        step: of equal length, which is `dt` over p by itself.
        element_step: one element in one increment of a full mesh.
    """

    case: float = 0.0
    sample: float = 0.0
    step: float = 0.0
    dt: float = 1e-4
    element_step: float = 0.0


@dataclass(frozen=True)
class Backend:
    """A row.

    Attributes:
        name: in the study.
        target: `module:function` of its `solve(batch) -> Response`, imported when it is needed.
        models, damping: what it solves: every one of these models with every one of these schemes.
        sentence: how it works, for people.
        reads: keys of `solver` that it takes notice of.
        automatic: whether `backend: auto` may take it.
        least_rtol: smallest tolerance that it can keep to.
        settings: of `rock trade`, coarse to fine: its rtol or, if `stepping`, what its time step is multiplied
            with.  Without any it has no settings, and an audit has nothing tighter to offer.
        stepping: whether steps of equal length are what makes it accurate, and not a tolerance.
        slow: minutes per case: no audit takes it, and `rock trade` solves its finer settings last.
        needs: `module:function` that raises `SolverError` on a machine that lacks what it is made of.
        cost: what it takes.
        flexible: the row that holds for model flexible where that is solved in another way.
        fibres: whether its base may be of fibres.
        refuses: why it does not solve a batch of these models and schemes; "" if it does.
    """

    name: str
    target: str
    models: frozenset[Pair]
    damping: frozenset[str]
    sentence: str
    reads: tuple[str, ...] = ("accuracy",)
    automatic: bool = True
    least_rtol: float = 1e-16
    settings: tuple[float, ...] = ()
    stepping: bool = False
    slow: bool = False
    needs: str = ""
    cost: Cost = Cost(0.02, 5e-5)
    flexible: Backend | None = None
    fibres: bool = False
    refuses: Callable[[Batch], str] = lambda batch: ""

    def of_model(self, model: str) -> Backend:
        """The row that holds for a model."""
        return self.flexible if model == FLEXIBLE and self.flexible is not None else self

    def solves(self, model: str, geometry: str | None, scheme: str) -> bool:
        """Whether a model is solved under a damping scheme."""
        row = self.of_model(model)
        return (model, geometry) in row.models and scheme in row.damping

    def supports(self, batch: Batch) -> bool:
        """Whether a batch is solved."""
        return self.solves(batch.model, batch.geometry, batch.damping.scheme)

    def load(self) -> Callable[[Batch], Response]:
        """Import the solver."""
        return cast("Callable[[Batch], Response]", _imported(self.target))

    def require(self) -> None:
        """Raise `SolverError` if this machine lacks what the backend is made of."""
        if self.needs:
            _imported(self.needs)()


def _imported(target: str) -> Callable[..., object]:
    module, name = target.split(":")
    return cast("Callable[..., object]", getattr(import_module(module), name))


def unfit_base(batch: Batch) -> str:
    """Why the base does not go with the model and the damping of beam elements; "" if it does."""
    base, hht = batch.base, batch.damping.scheme == "hht"
    if base is None or base.law == "rigid":
        return "damping hht needs a yielding base: base: {law: winkler, kw: ...}" if hht else ""
    if batch.geometry == "negative_stiffness":
        return "a Winkler base carries the weight: it needs geometry: corotational"
    if (hht or base.fibres is not None) and batch.model not in ("4", "flexible"):
        return f"fibres belong under a column of elements, model 4 or flexible, not model {batch.model}"
    return ""


def unfit_beams(batch: Batch) -> str:
    """Why beam elements do not solve a batch; "" if they do."""
    method = batch.numerics.method
    if method not in METHODS:
        return f"beam elements know the methods corotational and linear, not {method!r}"
    if method == "linear" and batch.geometry != "negative_stiffness":
        return "method linear has no P-Delta: it needs geometry: negative_stiffness and a rigid base"
    return unfit_base(batch)


def _unfit_method(batch: Batch) -> str:
    """Why the general ODE methods do not solve a batch; "" if they do."""
    return cast("str", _imported("rockcli.solvers.general.solver:unfit")(batch))


_RIGID = frozenset({"none", "restitution", "dashpot"})
_BEAMS = frozenset({*(pair for pair in MODELS if pair[1]), (FLEXIBLE, None)})
_OF_BEAMS = ("accuracy", "rtol", "method", "dt", "yield_rotation")
_STEPS = (16.0, 8.0, 4.0, 2.0, 1.0)
"""Over the time step of accuracy `standard`, and over a yield rotation of 1e-6 rad."""

_ROWS: tuple[Backend, ...] = (
    Backend(
        EVENT,
        "rockcli.solvers.event.solver:solve",
        models=frozenset({*MODELS, (FLEXIBLE, None)}),
        damping=_RIGID,
        sentence="event-driven Taylor (flexible: modal) steps: impacts, uplift and rest are located",
        reads=("accuracy", "rtol"),
        settings=(1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14),
        cost=Cost(1e-4, 1.2e-7),
        flexible=Backend(
            EVENT,
            "rockcli.solvers.flexible:solve",
            models=frozenset({(FLEXIBLE, None)}),
            damping=frozenset({"none", "restitution"}),  # beside the column's own zeta
            sentence="event-driven modal steps",
            reads=("accuracy", "dt"),
            settings=(4.0, 2.0, 1.0, 0.5, 0.25),  # over the step of accuracy `draft`
            stepping=True,
            cost=Cost(0.05, 1e-4),
        ),
    ),
    Backend(
        "frame",
        "rockcli.solvers.frame.solver:solve",
        models=_BEAMS,
        damping=_RIGID | {"hht"},
        sentence="beam elements on a yielding base stepped in time, as the thesis did: 3-10 us per step",
        reads=_OF_BEAMS,
        automatic=False,
        settings=_STEPS,
        stepping=True,
        cost=Cost(step=5e-6),
        fibres=True,
        refuses=unfit_beams,
    ),
    Backend(
        "opensees",
        "rockcli.solvers.opensees.solver:solve",
        models=_BEAMS,
        damping=_RIGID | {"hht"},
        sentence="OpenSees, one plain script per case (`rock export` writes it) in its own process",
        reads=_OF_BEAMS,
        automatic=False,
        settings=_STEPS,
        stepping=True,
        needs="rockcli.solvers.opensees.run:require_opensees",
        cost=Cost(0.3, step=2.5e-5, dt=2e-4),
        fibres=True,
        refuses=unfit_beams,
    ),
    Backend(
        "scipy",
        "rockcli.solvers.general.solver:solve",
        models=frozenset(MODELS),
        damping=_RIGID,
        sentence="general ODE methods (RK23, RK45, DOP853, Radau, BDF, LSODA, ode23s), events located or not",
        reads=("accuracy", "rtol", "method", "events"),
        automatic=False,
        least_rtol=2.5e-14,
        settings=(1e-3, 1e-5, 1e-7, 1e-9, 1e-11),
        refuses=_unfit_method,
    ),
    Backend(
        "calculix",
        "rockcli.solvers.calculix:solve",
        models=frozenset({(CONTINUUM, None)}),
        damping=frozenset({"none", "hht"}),
        sentence="full mesh of bricks on a no-tension base, solved by CalculiX (ccx): minutes per case",
        reads=("accuracy", "dt"),
        settings=(8.0, 4.0, 2.0, 1.0, 0.5),
        stepping=True,
        slow=True,
        needs="rockcli.solvers.calculix.run:program",
        cost=Cost(element_step=2.5e-4),
    ),
    Backend(
        "fema356",
        "rockcli.solvers.fema356:solve",
        models=frozenset({("rigid", None)}),
        damping=frozenset({"fema356"}),
        sentence="equivalent linear oscillator on a response spectrum: known to be poor, for comparison",
        reads=(),
        cost=Cost(0.18, 1.3e-4),
    ),
)

BACKENDS: dict[str, Backend] = {row.name: row for row in _ROWS}
"""In order of preference for `backend: auto`."""

AUTOMATIC = "auto"
"""What a study asks for that leaves the backend to the program."""

BACKEND_NAMES: tuple[str, ...] = (AUTOMATIC, *BACKENDS)


def automatic(model: str, geometry: str | None, scheme: str) -> Backend | None:
    """The backend that `auto` takes; None where there is none."""
    rows = (row for row in BACKENDS.values() if row.automatic)
    return next((row for row in rows if row.solves(model, geometry, scheme)), None)
