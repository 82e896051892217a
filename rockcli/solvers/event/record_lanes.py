"""Record maps in lanes: which bodies `kernels.lanes.records.march` takes, and what it is given (docs/lanes.md)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.kernels import handover as carry
from rockcli.kernels.constants import LEFT_TO_MARCH
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import results as results_of_rolling
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.laws.models import MODELS
from rockcli.solvers.common.certainty import CERTAINTY
from rockcli.solvers.event import pulse_lanes
from rockcli.solvers.event.pulse_lanes import FINEST, even
from rockcli.solvers.event.unpack import FORCES

Array = NDArray[np.float64]

METHOD = "Taylor series of order 8 from sample to sample, many bodies in lanes, events located on the polynomial"

WITHIN = pulse_lanes.WITHIN | pulse_lanes.ON_PATH
"""Scalars that the lanes find, or that these bodies have not."""

PATH = frozenset({"t_overturn", "t_end", *FORCES, *CERTAINTY})
"""Scalars that need the path of a fall to its end."""


def asked(batch: Batch) -> bool:
    """Whether what is asked can be found in lanes, whatever the number of cases."""
    motion = batch.excitation
    return (
        (isinstance(motion.horizontal, Samples) or motion.suite is not None)
        and (motion.vertical is None or _lifted_in_lanes(batch))
        and batch.damping.only_eta
        and not batch.save.histories
        and batch.save.scalars <= WITHIN
        and batch.numerics.tolerances.rtol >= FINEST
    )


ENDS = 1e-15
"""Over its largest sample, what the last one of a component may be that is as good as zero."""


def _lifted_in_lanes(batch: Batch) -> bool:
    """Whether lanes take both components of a motion: records of one time step, the shorter ending at zero.

    Not the forces of linear bodies under them.
    """
    horizontal, vertical = batch.excitation.horizontal, batch.excitation.vertical
    if not isinstance(horizontal, Samples) or not isinstance(vertical, Samples) or horizontal.dt != vertical.dt:
        return False
    if MODELS[batch.model, batch.geometry].linear and batch.save.scalars & FORCES:
        return False
    shorter, longer = sorted((horizontal.values, vertical.values), key=len)
    return len(shorter) == len(longer) or bool(abs(shorter[-1]) <= ENDS * np.abs(shorter).max())


FINEST_AGAIN = 1e-15
"""Smallest tolerance at which the lanes solve again those of which two runs have parted, with more steps."""

GRAZING = 1e-9
"""A sample this near the uplift threshold, relative to it, may be part of a plateau on which rounding decides."""

FEW = 100
"""Bodies up to which the samples that they graze are sought one by one: to order 6000 takes as long as for so many."""

LAYOUT = "lanes.records.layout"

AT_ONCE = 1 << 18
"""Samples of a suite laid out at a time, at least: 12 MB, which memory near the processor holds."""


def fit(batch: Batch, rows: Array) -> NDArray[np.bool_]:
    """Which rows (n, N_PAR) of a batch the lanes take, (n,).

    Bodies whose report ends at a given time only without friction.  Not those that a sample grazes, nor those that
    cannot overturn: they turn farther than the sines of the lanes reach.  Of bodies with two different edges, and of
    those under a vertical motion, those without friction; a vertical motion below g.
    """
    alike = even(rows)
    apart = ~alike & np.isnan(batch.block.mu)
    ends = (rows[:, at.HAS_DURATION] == 0.0) | np.isnan(batch.block.mu) & (rows[:, at.T_MOTION] > 0.0)
    taken = (alike | apart) & ends
    if isinstance(batch.excitation.vertical, Samples):
        most = np.abs(batch.excitation.vertical.values).max()
        taken &= np.isnan(batch.block.mu) & (most * np.abs(rows[:, at.FACTOR_V]) < rows[:, at.G])
    for edge in (at.RIGHT, at.LEFT):
        taken &= np.isfinite(rows[:, edge + at.Q_STAR])
    return np.asarray(taken & ~grazed(batch, rows))


def grazed(batch: Batch, rows: Array) -> NDArray[np.bool_]:
    """Whether a sample grazes the uplift about an edge of each row (n, N_PAR) of a batch, (n,)."""
    guards: list[Array] = []
    for edge in (at.RIGHT, at.LEFT):
        with np.errstate(divide="ignore"):
            guard = rows[:, at.G] * rows[:, edge + at.THRESHOLD] / np.abs(rows[:, at.FACTOR_H])
        if not guards or (guard != guards[0]).any():
            guards.append(guard)
    layout = kernels.load(LAYOUT, compile_them=bool(kernels.compiled))
    found = np.zeros(len(rows), dtype=bool)
    for record, cases in _by_record(batch, len(rows)):
        for guard in guards:
            found[cases] |= _grazed(layout, record.values, guard[cases])
    return found


def _grazed(layout: ModuleType, values: Array, guard: Array) -> NDArray[np.bool_]:
    """Whether one of these accelerations is as large as each guard, nearly, (n,)."""
    if len(guard) <= FEW:
        found = np.empty(len(guard))
        layout.graze(np.ascontiguousarray(values), np.ascontiguousarray(guard), GRAZING, found)
        return found > 0.0
    sizes = np.append(np.sort(np.abs(values)), np.inf)
    above = np.searchsorted(sizes[:-1], guard)
    near = np.minimum(sizes[above] - guard, guard - sizes[np.maximum(above - 1, 0)])
    return np.asarray(np.abs(near) <= GRAZING * guard)


def _by_record(
    batch: Batch, n: int, cases: NDArray[np.int64] | None = None
) -> Iterator[tuple[Samples, NDArray[np.int64]]]:
    """The motions of n cases of a batch, all without `cases`, each with their places among these."""
    motion = batch.excitation
    if motion.suite is not None:
        yield from motion.suite.cases(cases)
    else:
        assert isinstance(motion.horizontal, Samples)
        yield motion.horizontal, np.arange(n)


def run(
    lanes: ModuleType,
    batch: Batch,
    rows: Array,
    how: Any,
    starts: Array | None = None,
    *,
    cases: NDArray[np.int64] | None = None,
    path: bool = False,
    bodies: Array | None = None,
    feet: Array | None = None,
    felt: Array | None = None,
) -> Array:
    """Raw results (n, N_OUT) for the rows (n, N_PAR) of some cases of a batch, all without `cases`.

    NaN in STATUS for a body that is left to the single-body kernels, whose `Settings` are `how`.

    Args:
        starts: rows of `kernels.handover` for bodies that stop where their foot may give way: STATUS is GIVES_WAY, and
            `starts` says where.
        path: follow a fall to its end whatever is asked.
        bodies: table of bodies that roll, `kernels.rolling.parameters`; then the rows and the results are longer:
            `kernels.lanes.records.facets`, `kernels.rolling.results`.
        feet: parameters of contact of bodies that have `starts`, (n, N_PAR) of that kernel: they do not stop, and what
            becomes of them is added to the rows of `felt`, its results; STATUS LEFT_TO_MARCH: it is not known.
    """
    width = to.N_OUT if bodies is None else results_of_rolling.N_OUT
    if not len(rows):
        return np.empty((0, width))
    path = path or how.detail == lanes.ALL or bool(batch.save.scalars & PATH)
    found = np.zeros((len(rows), width))
    holds = starts is not None
    if starts is None:
        starts = np.empty((len(rows), 0))
    table = np.empty((0, 0)) if bodies is None else bodies
    # those that friction holds have two equal edges
    alike = np.full(len(rows), holds) if holds or bodies is not None else even(rows)
    vertical = batch.excitation.vertical
    for records, theirs in _some_at_a_time(_by_record(batch, len(rows), cases)):
        heave = None
        if isinstance(vertical, Samples):
            records, beside = _as_long(records[0], vertical)
            heave = laid_out(beside, lanes.BLOCK, path=True)[:4]
        ground = laid_out(records, lanes.BLOCK, path=path, falls=bodies is None)
        if holds:  # those at one place of a motion together: they read the same samples
            theirs = [some[np.argsort(starts[some, carry.T], kind="stable")] for some in theirs]
        every = np.concatenate(theirs)
        spans = _spans(np.repeat(ground.spans, [len(some) for some in theirs], axis=0), rows[every])
        for two_sided in (False, True):  # apart, so that no body depends on others
            of_those = ~alike[every] == two_sided
            if not of_those.any():
                continue
            places = every[of_those]
            out = np.zeros((len(places), width))
            begin = starts[places]
            motions, work = (*ground[:-1], spans[of_those]), lanes.work_space()
            if heave is not None:
                lifting: Any = kernels.load("lanes.records.vertical", compile_them=bool(kernels.compiled))
                lifting.march_vertical(rows[places], how, *motions, two_sided, heave, table, begin, work, out)
            elif feet is None or felt is None:
                lanes.march_lanes(rows[places], table, how, *motions, two_sided, holds, begin, work, out)
            else:
                slipping: Any = kernels.load("lanes.records.slipping", compile_them=bool(kernels.compiled))
                slips, feels = (slipping.work_space_of_slips(), *slipping.work_space_of_feet()), felt[places]
                slipping.march_slipping(
                    rows[places], table, how, *motions, begin, work, out, feet[places], *slips, feels
                )
                felt[places] = feels
            found[places], starts[places] = out, begin
    found[found[:, to.STATUS] == LEFT_TO_MARCH, to.STATUS] = np.nan
    return found


def _as_long(horizontal: Samples, vertical: Samples) -> tuple[list[Samples], list[Samples]]:
    """Both components of a motion, the shorter followed by zeros."""
    length = max(len(horizontal.values), len(vertical.values))
    one, other = (
        replace(each, values=np.pad(each.values, (0, length - len(each.values)))) for each in (horizontal, vertical)
    )
    return [one], [other]


def _spans(motions: Array, rows: Array) -> Array:
    """First and last sample of the motion of each row (n, N_PAR), the time between two, and a sample of zeros: (n, 4).

    A motion that is cut off where the report ends has its last sample there or just after; `motions` (n, 3) go on.
    """
    first, last, dt = motions.T
    given = rows[:, at.HAS_DURATION] == 1.0
    if given.any():
        ends, last = rows[:, at.T_MOTION], last.copy()
        most = last - first
        k = np.clip(np.ceil(ends / dt), 1.0, most)
        k -= (k > 1.0) & ((k - 1.0) * dt >= ends)
        k += (k < most) & (k * dt < ends)
        last[given] = (first + k)[given]
    return np.column_stack([first, last, dt, motions[:, 1] + 1.0])


def _some_at_a_time(
    motions: Iterator[tuple[Samples, NDArray[np.int64]]],
) -> Iterator[tuple[list[Samples], list[NDArray[np.int64]]]]:
    """The motions and their cases, as many as have AT_ONCE samples."""
    records: list[Samples] = []
    cases: list[NDArray[np.int64]] = []
    samples = 0
    for record, some in motions:
        records.append(record)
        cases.append(some)
        samples += len(record.values)
        if samples >= AT_ONCE:
            yield records, cases
            records, cases, samples = [], [], 0
    if records:
        yield records, cases


class Ground(NamedTuple):
    """Sampled motions as the lanes take them, one after the other; see `march_lanes`."""

    values: Array
    slopes: Array
    blocks: Array
    tail: Array
    velocity: Array
    spans: Array


def laid_out(records: list[Samples], block: int, *, path: bool, falls: bool = True) -> Ground:
    """Motions one after the other, each beginning with a block and followed by two samples of zeros or more.

    Without the velocity of the ground where the `path` of a fall is asked for; nor is it told, though there is a row,
    where nobody asks whether what remains of the motion can stop a fall (`falls`).
    """
    lengths = np.array([len(record.values) for record in records])
    firsts = np.concatenate([[0], np.cumsum(-(-(lengths + 2) // block) * block)])
    values, slopes, tail = (np.empty(firsts[-1]) for _ in range(3))
    velocity = np.empty((0, 3)) if path else np.empty((firsts[-1], 3)) if falls else np.zeros((1, 3))
    for record, first, length, end in zip(
        records, firsts[:-1].tolist(), lengths.tolist(), firsts[1:].tolist(), strict=True
    ):
        behind = first + length
        values[first:behind] = record.values
        values[behind:end] = tail[behind:end] = slopes[behind - 1 : end] = 0.0  # the rest is filled below
        if len(velocity) > 1:
            velocity[behind:end] = 0.0
    spans = np.column_stack([firsts[:-1], firsts[:-1] + lengths - 1, [record.dt for record in records]])
    ground = Ground(values, slopes, np.zeros(len(values) // block), tail, velocity, spans.astype(np.float64))
    layout = kernels.load(LAYOUT, compile_them=bool(kernels.compiled))
    layout.lay_out(values, ground.spans, slopes, ground.blocks, tail, velocity)
    return ground
