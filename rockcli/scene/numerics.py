"""Accuracy and other solver settings: tolerances, steps, and what a named accuracy means to every backend."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Accuracy:
    """A level of accuracy.

    Attributes:
        rtol: of the event-driven solver, truncation allowed per step relative to alpha.
        rest_speed: impacts slower than this fraction of p sin(alpha), the lesser of the two edges, may end in rest.
        ode_rtol: of the general ODE methods.
        penalty_step: time step of the backends on a yielding base, over that of `standard`.
        wave_step: the same of the deformable bodies: the flexible column and the full mesh.
        perturbation: change of the motion, relative, that tells whether the outcome of a flexible column under a pulse
            is certain.
        tighter: the level an audit solves again at; "" = there is none.
    """

    rtol: float
    rest_speed: float
    ode_rtol: float
    penalty_step: float
    wave_step: float
    perturbation: float
    tighter: str = ""


ACCURACIES: dict[str, Accuracy] = {
    "draft": Accuracy(
        1e-8, 1e-6, ode_rtol=1e-3, penalty_step=4.0, wave_step=2.0, perturbation=1e-6, tighter="standard"
    ),
    "standard": Accuracy(
        1e-12, 1e-6, ode_rtol=1e-8, penalty_step=1.0, wave_step=1.0, perturbation=1e-7, tighter="reference"
    ),
    "reference": Accuracy(1e-16, 1e-7, ode_rtol=1e-12, penalty_step=0.25, wave_step=0.5, perturbation=1e-8),
}
"""From coarse to fine."""

STANDARD = "standard"


@dataclass(frozen=True)
class Numerics:
    """Solver settings of a batch.  `None` = what the backend and the accuracy level say."""

    backend: str = "auto"
    accuracy: str = STANDARD
    rtol: float | None = None
    method: str | None = None
    events: bool | None = None
    dt: float | None = None
    yield_rotation: float | None = None

    @property
    def level(self) -> Accuracy:
        """What the accuracy means to every backend."""
        return ACCURACIES[self.accuracy]

    @property
    def tolerances(self) -> Accuracy:
        """The accuracy level, with `rtol` in place of its tolerance where given."""
        return self.level if self.rtol is None else replace(self.level, rtol=self.rtol)
