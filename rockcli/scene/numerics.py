"""How well: solver settings, and what the named accuracies expand to."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Accuracy:
    """Tolerances of the event-driven solver.

    Attributes:
        rtol: truncation allowed per step, relative to alpha.
        rest_speed: impacts slower than this fraction of p sin(alpha) may end in rest.
    """

    rtol: float
    rest_speed: float


ACCURACIES: dict[str, Accuracy] = {
    "draft": Accuracy(rtol=1e-8, rest_speed=1e-6),
    "standard": Accuracy(rtol=1e-12, rest_speed=1e-6),
    "reference": Accuracy(rtol=1e-16, rest_speed=1e-7),
}


@dataclass(frozen=True)
class Numerics:
    """Solver settings of a batch.  `None` = what the backend and the accuracy level say."""

    backend: str = "auto"
    accuracy: str = "standard"
    rtol: float | None = None
    method: str | None = None
    events: bool | None = None
    dt: float | None = None
    yield_rotation: float | None = None

    @property
    def tolerances(self) -> Accuracy:
        """The accuracy level, with `rtol` in place of its tolerance where given."""
        level = ACCURACIES[self.accuracy]
        return level if self.rtol is None else Accuracy(rtol=self.rtol, rest_speed=level.rest_speed)
