"""What a study will cost, before it is solved: processor time and memory, from what its features were measured to cost.

`costs.csv` has the time of a case by feature, as `benchmarks/features.py` measured it over a plain block, told for a
machine of reference (`speed`).  What several features cost together is put together from their ratios to the plain
block.  Other backends than the event-driven one tell their cost themselves (`scene.backends`).
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from rockcli.analysis.measures import peaks
from rockcli.engine.sweep.chunk_result import DTYPES
from rockcli.engine.sweep.chunks import CHUNK
from rockcli.engine.sweep.parts import MOST
from rockcli.engine.sweep.results import LET_GO
from rockcli.scene.auto import highest
from rockcli.scene.backends import BACKENDS, EVENT
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Pulses, Samples
from rockcli.scene.rules import RULES
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.event import pulse_lanes as lane_pulses
from rockcli.solvers.event.unpack import FORCES
from rockcli.storage.on_disk import IN_MEMORY
from rockcli.study.study import Study

KNOWN = Path(__file__).parent / "costs.csv"
"""What features cost."""

PLAIN, OUTCOME, EVERY, FORCED, FALL = (
    "plain block: outcome, peak and impacts", "outcome alone", "every scalar and the certainty (default)", "forces",
    "time of overturning",
)  # fmt: skip
APART_FORCED, ROLLING_FORCED = "asymmetric body, every scalar (default)", "body that rolls, every scalar (default)"
"""Forces of two different edges, and of one that rolls, cost other shares of the rest than those of the plain block."""

UNDER_PULSES, UNDER_RECORD = "pulse", "record"

SAMPLES = 3000
"""Samples of the record under which features are measured."""

STILL = "uncertain inputs"
"""Feature of whose cases under the record none lifts off."""

BATCH = 8e-3
"""A body, or a record, that is built and laid out apart from others, several times in a run, as one with an outline is,
or a file in a table of files; bodies by name that differ in numbers are built together [s]."""

ALONE = 3.0
"""Over the plain block, from which bodies under such a motion are solved one at a time."""

STARTING = 0.9
"""For imports and for loading compiled kernels, on the machine of reference [s]."""

IN_PLAIN_PYTHON = 100.0
"""How much slower the event-driven solver is in plain Python."""

READING = 9e-8
"""A sample of a record that is read and laid out [s]."""

ARRIVING = 2.6e-6
"""A sample of what arrives through floors or isolators, found once for a record and what it goes through [s]."""

CELL, OF_CELL = 1.9e-5, 400.0
"""A cell of a table that is read, checked and told again in the dataset [s], [bytes]."""

LAYING_OUT = 1.2e-8
"""A sample of one of many records that is laid out for its cases [s]."""

REFINED = 38.0
"""Cases that a refined map of n x n pixels solves, over n; under records twice to eight times as many."""

SPECTRUM = 0.02
"""A response spectrum that a rule takes [s]."""

FEMA = "fema356"
"""The rule, and the backend, of that name."""

HISTORY = 1.3e-6
"""An output time of a case whose histories are saved, kept and written [s]."""

STATISTICS, OF_MEMBER = 0.6, 6e-6
"""Statistics over an axis: for imports, and for each case [s]."""

PROGRAM, STATISTICAL = 1.18e8, 7.5e7
"""Memory of a process with all that it has imported and loaded, and with what statistics need beside it [bytes]."""

WORKING, MEMBER = 2200.0, 310.0
"""Memory for a case that is being solved, and for one that statistics are taken of [bytes]."""

HISTORIES = 2.2
"""Memory for histories, over their size: those of the chunks and what is written."""


@cache
def known() -> dict[tuple[str, str], tuple[float, int]]:
    """Seconds a case on the machine of reference by feature and motion, and of how many cases."""
    with KNOWN.open(encoding="utf-8", newline="") as file:
        return {
            (row["feature"], row["motion"]): (1e-6 * float(row["microseconds"]), int(row["cases"]))
            for row in csv.DictReader(file)
        }


def seconds_per_case(batch: Batch, backend: str) -> float:
    """Processor time that a backend needs for a case of a batch, on the machine of reference [s]."""
    row = BACKENDS.get(backend, BACKENDS[EVENT])
    if row.name == EVENT:
        solving = _of_features(batch)
    else:
        cost = row.of_model(highest(batch).model).cost
        solving = cost.case + cost.sample * _samples(batch)
        if cost.step:
            solving += cost.step * _length(batch) / (batch.numerics.dt or cost.dt / float(batch.p.max()))
        if cost.element_step:
            solving += cost.element_step * _element_increments(batch)
    return solving + (_length(batch) / batch.save.dt_out * HISTORY * batch.save.histories)


def seconds_of_reading(batch: Batch) -> float:
    """Processor time for reading and laying out a record like that of a case, on the machine of reference [s]."""
    return READING * _samples(batch)


def seconds_of_tables(study: Study) -> float:
    """Processor time for reading the tables of a study, on the machine of reference [s]."""
    return CELL * _cells(study)


def _cells(study: Study) -> int:
    """Cells of all tables that axes were read from."""
    return sum(axis.size * len(axis.given) for axis in study.axes)


def seconds_of_laying_out(batch: Batch) -> float:
    """The part of reading that is done for the cases of a suite, once for a record [s]; 0 without a suite."""
    return LAYING_OUT * _samples(batch) if batch.excitation.suite is not None else 0.0


def seconds_of_statistics(study: Study) -> float:
    """Processor time for the statistics of a study, on the machine of reference [s]; 0 without."""
    return STATISTICS + OF_MEMBER * study.size if study.over is not None else 0.0


def seconds_of_rules(rules: Sequence[str], batch: Batch) -> float:
    """Time that the rules beside the history need for a case of a batch, typically [s]."""
    spectra = sum(RULES[name].spectral for name in rules) * SPECTRUM
    return spectra + (seconds_per_case(batch, FEMA) if FEMA in rules else 0.0)


def seconds_in_plain_python(batch: Batch) -> float:
    """Time that the event-driven solver of rigid bodies needs for a case with nothing compiled, typically [s]."""
    return lane_pulses.SECONDS if lane_pulses.asked(batch) else IN_PLAIN_PYTHON * seconds_per_case(batch, EVENT)


def share_refined(study: Study) -> float:
    """Share of the cases of a study with `refine` that are solved, typically; 1 without."""
    sizes = [axis.size for axis in study.axes if axis.name in study.refine]
    return min(1.0, REFINED / max(sizes)) if sizes else 1.0


def memory(study: Study, histories: float) -> float:
    """Memory that one process needs to solve a study, its results among it; `histories`: size of those [bytes]."""
    sizes = [np.dtype(DTYPES.get(name, np.float64)).itemsize for name in study.scalars]
    held = sum(size * (study.size if size * study.size <= IN_MEMORY else LET_GO) for size in sizes)
    waiting = (sum(sizes) + np.dtype(np.int64).itemsize) * min(study.size, MOST)
    over = STATISTICAL + MEMBER * study.size if study.over is not None else 0.0
    tables = OF_CELL * _cells(study)
    return PROGRAM + held + waiting + WORKING * min(study.size, CHUNK) + HISTORIES * histories + over + tables


def _of_features(batch: Batch) -> float:
    """A case of the event-driven solver: what its motion and its body cost, and what is saved of it."""
    motion = batch.excitation
    samples = _samples(batch)
    kind = UNDER_RECORD if samples else UNDER_PULSES

    def of(feature: str, which: str = kind) -> float:
        return known()[feature, which][0]

    plain = of(PLAIN)
    found = max((of(name) for name in _features(batch)), default=plain)
    alone = found > ALONE * plain
    scalars = batch.save.scalars
    saved = EVERY if scalars & CERTAINTY else FORCED if scalars & FORCES else None
    if saved is None and scalars & {"t_overturn", "t_end"}:
        saved = FALL
    if scalars & FORCES and batch.block.rolls.any():
        found = max(found, of(ROLLING_FORCED))
    elif scalars & FORCES and not batch.block.symmetric.all():
        found = max(found, of(APART_FORCED))
    elif saved is not None and alone:  # as of bodies that are solved one at a time in any case
        found *= max(of(saved, UNDER_PULSES) / of(FALL, UNDER_PULSES), 1.0)
    elif saved is not None:
        found *= of(saved) / plain
    elif scalars <= {"outcome"}:
        found *= min(of(OUTCOME) / plain, 1.0)
    if motion.suite is not None:
        found *= max(of("suite of records") / plain, 1.0)
    if not samples:
        return found
    still = of(STILL)
    return still + _lifting(batch) * max(found - still, 0.0) * samples / SAMPLES


def _features(batch: Batch) -> list[str]:
    """Features of the table that the cases have, but for what is saved."""
    motion, model = batch.excitation, highest(batch).model
    mu = batch.block.mu[np.isfinite(batch.block.mu)]
    of_two_kinds = isinstance(motion.vertical, Pulses) and isinstance(motion.horizontal, Samples)
    asked = {
        "vertical motion": motion.vertical is not None,
        "vertical pulse": of_two_kinds,
        "asymmetric body": not batch.block.symmetric.all(),
        "body that rolls, ten facets": bool(batch.block.rolls.any()),
        "friction, mu = 0.6": len(mu) and float(mu.min()) >= 0.45,
        "friction, mu = 0.3": len(mu) and float(mu.min()) < 0.45,
        "initial rotation": bool(batch.theta_0.any() or batch.theta_dot_0.any()),
        "duration": bool(np.isfinite(motion.duration).any()),
        "base dashpot": not batch.damping.only_eta,
        "linearized block": model == "linearized",
        "flexible column": model == "flexible",
        **{f"model {number}": model == number for number in "1234"},
    }
    return [name for name, there in asked.items() if there]


def _lifting(batch: Batch) -> float:
    """Share of the cases that leave the ground, or move from the beginning."""
    motion = batch.excitation
    if motion.suite is not None:
        pga = np.abs(motion.suite.factor) * motion.suite.measure("pga")
    else:
        pga, _ = peaks(motion.horizontal, batch.size)
    threshold = batch.g * batch.block.of_weak_edge(batch.block.tan_alpha)
    moves = (batch.theta_0 != 0.0) | (batch.theta_dot_0 != 0.0)
    return float(np.mean(moves | ~(pga < threshold)))


def _samples(batch: Batch) -> float:
    """Samples of the recorded motion of a case, on the average; 0 where there is none."""
    motion = batch.excitation
    if motion.suite is not None:
        return float(np.mean([len(record.values) for record in motion.suite.records]))
    channels = [each for each in (motion.horizontal, motion.vertical) if isinstance(each, Samples)]
    recorded = [len(each.values) for each in channels]
    return float(recorded[0]) if recorded and not isinstance(motion.horizontal, Pulses) else 0.0


def _element_increments(batch: Batch) -> float:
    """Elements times increments of the first case of a full mesh."""
    from rockcli.solvers.calculix.case import elements_along, largest_step

    assert batch.column is not None
    return batch.column.across * elements_along(batch, 0) * _length(batch) / largest_step(batch, 0)


def _length(batch: Batch) -> float:
    """Time that a case covers: its duration, or the motion and 20/p [s]."""
    return float(np.mean(durations_of(batch).report))
