"""Where the ground falls away faster than gravity below bodies that their model holds on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import PIECE_WIDTH, Channel, Samples, acceleration
from rockcli.scene.laws.models import CONTINUUM, DEFORMABLE

Array = NDArray[np.float64]

_POINTS = 400
"""Times of a piece of a pulse at which it is looked at."""


@dataclass(eq=False)
class FallingGround:
    """Cases in which g + a_v is negative while nothing but the model holds the body on its base, and the first time."""

    looked_at: int = 0
    cases: int = 0
    first: float = np.inf

    def look(self, batch: Batch) -> None:
        """Take note of a batch."""
        self.looked_at += batch.size
        vertical = batch.excitation.vertical
        leaves_it = batch.base is not None or batch.model == CONTINUUM or batch.damping.scheme == "fema356"
        if vertical is None or leaves_it:
            return
        held = ~np.isfinite(batch.block.mu) | (batch.model in DEFORMABLE)
        begins = _begins(vertical, batch.g)
        falls = held & ~(begins > np.where(np.isnan(batch.excitation.duration), np.inf, batch.excitation.duration))
        falls &= np.isfinite(begins)
        self.cases += int(falls.sum())
        self.first = min(self.first, float(np.min(begins, where=falls, initial=np.inf)))

    def sentences(self, size: int) -> list[str]:
        """What there is to say in a study of `size` cases."""
        if not self.cases:
            return []
        of = f"{size} cases" if self.looked_at == size else f"{self.looked_at} cases looked at"
        where = f" in {self.cases} of {of}" if size > 1 else ""
        return [
            f"the ground falls away faster than g (g + a_v < 0){where}, first at t = {self.first:.4g} s: the "
            "body would leave it, but the model holds it on its base (with a `mu` a rigid block flies)"
        ]


def _begins(vertical: Channel, g: Array) -> Array:
    """When g + a_v first is negative in each case, (n,) [s], of a record at its samples; inf where it never is."""
    begins = np.full(len(g), np.inf)
    if isinstance(vertical, Samples):
        lowest = np.maximum.accumulate(-vertical.values)
        with np.errstate(divide="ignore"):
            i = np.searchsorted(lowest, g / vertical.factor, side="right")
        return np.where(i < len(lowest), i * vertical.dt, begins)
    for case in np.flatnonzero(vertical.table[:, :, PIECE_WIDTH - 1].max(axis=1) > g):
        pieces = vertical.table[case]
        t = np.unique(np.linspace(pieces[:, 0], pieces[:, 1], _POINTS))
        beyond = g[case] + acceleration(vertical, t, int(case)) < 0.0
        if beyond.any():
            begins[case] = t[np.argmax(beyond)]
    return begins
