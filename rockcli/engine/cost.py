"""Cost estimate: how long a batch will take, to an order of magnitude: by backend, model and motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rockcli.scene.auto import highest
from rockcli.scene.backends import BACKENDS, EVENT
from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Samples
from rockcli.scene.rules import RULES
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event import record_lanes as lane_records
from rockcli.study.study import Study

STARTING = 0.4
"""Seconds for imports and for loading compiled kernels."""

LANE, LANE_OUTCOME, LANE_SAMPLE = 5e-6, 2e-6, 5e-9
"""A case of the event-driven solver in lanes: pulses with peaks, with the outcome alone; a sample of a record [s]."""

PLAIN = 100.0
"""How much slower the event-driven solver is in plain Python."""

REFINED = 30.0
"""Cases that a refined map of n x n pixels solves, over n."""

SPECTRUM = 0.02
"""A response spectrum that a rule takes [s]."""

FEMA = "fema356"
"""The rule, and the backend, of that name."""

HISTORY = 2e-7
"""An output time of a case whose histories are saved [s]."""


def seconds_per_case(batch: Batch, backend: str) -> float:
    """Time that a backend needs for a case of a batch, typically [s]."""
    motion = batch.excitation.horizontal
    samples = len(motion.values) if isinstance(motion, Samples) else 0
    return _solving(batch, backend, samples) + (_length(batch) / batch.save.dt_out * HISTORY * batch.save.histories)


def seconds_of_rules(rules: Sequence[str], batch: Batch) -> float:
    """Time that the rules beside the history need for a case of a batch, typically [s]."""
    spectra = sum(RULES[name].spectral for name in rules) * SPECTRUM
    return spectra + (seconds_per_case(batch, FEMA) if FEMA in rules else 0.0)


def seconds_in_plain_python(batch: Batch) -> float:
    """Time that the event-driven solver of rigid bodies needs for a case with nothing compiled, typically [s]."""
    return lane_pulses.SECONDS if lane_pulses.asked(batch) else PLAIN * seconds_per_case(batch, EVENT)


def share_refined(study: Study) -> float:
    """Share of the cases of a study with `refine` that are solved, typically; 1 without."""
    sizes = [axis.size for axis in study.axes if axis.name in study.refine]
    return min(1.0, REFINED / max(sizes)) if sizes else 1.0


def _solving(batch: Batch, backend: str, samples: int) -> float:
    row = BACKENDS.get(backend, BACKENDS[EVENT]).of_model(highest(batch).model)
    if row.target == BACKENDS[EVENT].target:
        if lane_pulses.asked(batch):
            return LANE_OUTCOME if batch.save.scalars <= {"outcome"} else LANE
        if lane_records.asked(batch):
            return LANE + LANE_SAMPLE * samples
    cost = row.cost
    seconds = cost.case + cost.sample * samples
    if cost.step:
        seconds += cost.step * _length(batch) / (batch.numerics.dt or cost.dt / float(batch.p.max()))
    if cost.element_step:
        seconds += cost.element_step * _element_increments(batch)
    return seconds


def _element_increments(batch: Batch) -> float:
    """Elements times increments of the first case of a full mesh."""
    from rockcli.solvers.calculix.case import elements_along, largest_step

    assert batch.column is not None
    return batch.column.across * elements_along(batch, 0) * _length(batch) / largest_step(batch, 0)


def _length(batch: Batch) -> float:
    """Time that a case covers: its duration, or the motion and 20/p [s]."""
    return float(np.mean(durations_of(batch).report))
