"""How the second run of an event-driven solver differs from the first (`solvers.common.certainty`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rockcli.scene.numerics import Accuracy
from rockcli.solvers.common.certainty import MEMBERS, Perturbation

FINER, FINEST = 1e-3, 1e-16
"""Where two runs part, they are solved again with this many times the tolerance, down to the finest."""

PERTURBATION, PERTURBATION_OF_FINER, LARGEST_PERTURBATION, LEAST_PERTURBATION = 1e3, 10.0, 1e-5, 1e-15
"""The motion of the second run is less by this many times the tolerance, of that beside the more accurate run by so
many, at most and at least so much."""

SAFETY, FLOOR = 200.0, 5.0
"""The error is estimated as that of a motion known to this many times the tolerance, and so many tolerances more."""


def finer_than(level: Accuracy) -> Accuracy:
    """The tolerances of the more accurate run."""
    return replace(level, rtol=max(level.rtol * FINER, FINEST))


def perturbations(level: Accuracy, finer: Accuracy) -> tuple[Perturbation, Perturbation, float]:
    """Those of the first comparison and of the more accurate one, and the reach of an ensemble."""
    first = _perturbation(level.rtol, PERTURBATION, LARGEST_PERTURBATION)
    second = _perturbation(finer.rtol, PERTURBATION_OF_FINER)
    return first, second, max(second.size, MEMBERS * 2.0**-53)


def _perturbation(rtol: float, times: float, most: float = np.inf) -> Perturbation:
    known = max(rtol, FINEST)
    size = max(min(times * known, most), rtol, LEAST_PERTURBATION)
    return Perturbation(size, SAFETY * known / size, FLOOR * known)
