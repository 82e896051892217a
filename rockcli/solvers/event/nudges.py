"""How the second run of an event-driven solver differs from the first (`solvers.common.certainty`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rockcli.scene.numerics import Accuracy
from rockcli.solvers.common.certainty import MEMBERS, Nudge

FINER, FINEST = 1e-3, 1e-16
"""Where two runs part, they are solved again with this many times the tolerance, down to the finest."""

NUDGE, NUDGE_OF_FINER, LARGEST_NUDGE, LEAST_NUDGE = 1e3, 10.0, 1e-5, 1e-15
"""The motion of the second run is less by this many times the tolerance, of that beside the more accurate run by so
many, at most and at least so much."""

SAFETY, FLOOR = 200.0, 5.0
"""The error is estimated as that of a motion known to this many times the tolerance, and so many tolerances more."""


def finer_than(level: Accuracy) -> Accuracy:
    """The tolerances of the more accurate run."""
    return replace(level, rtol=max(level.rtol * FINER, FINEST))


def nudges(level: Accuracy, finer: Accuracy) -> tuple[Nudge, Nudge, float]:
    """Those of the first comparison and of the more accurate one, and the reach of an ensemble."""
    first, second = _nudge(level.rtol, NUDGE, LARGEST_NUDGE), _nudge(finer.rtol, NUDGE_OF_FINER)
    return first, second, max(second.size, MEMBERS * 2.0**-53)


def _nudge(rtol: float, times: float, most: float = np.inf) -> Nudge:
    known = max(rtol, FINEST)
    size = max(min(times * known, most), rtol, LEAST_NUDGE)
    return Nudge(size, SAFETY * known / size, FLOOR * known)
