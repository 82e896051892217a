"""A study as the rest of the program sees it: axes, batches of cases, and what to do with the results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.ground.hazard import HazardCurve
from rockcli.scene.ground.spectra import FloorSpectrum
from rockcli.scene.limit_states import OVERTURNED, limit_label
from rockcli.scene.looks import Look
from rockcli.scene.variables import PEAK
from rockcli.study.document.tree import Where

Index = NDArray[np.int64]


MATCH = 1e-9
"""Coordinates are the same if they differ by no more than this, relatively."""


@dataclass(frozen=True, eq=False)
class Given:
    """A column of the table that an axis was read from.

    Attributes:
        name: in the dataset, `given_mu` of the path block.mu, `note_room` of a column for readers (# room).
        path: inside the case; the head of a column for readers.
        values: a number (NaN: none) or a text ("": none) for every point, (n,).
        unit: of numbers.
    """

    name: str
    path: str
    values: NDArray[Any]
    unit: str = "1"


BASES = ("base", "base.law", "base.fibres")
"""Paths of axes over bases of which a backend may solve one and not another."""


@dataclass(frozen=True)
class Axis:
    """One dimension of the dataset.

    Attributes:
        name: dimension name: the last part of `path` (the whole path with `_` where that collides;
            `record` for motion.record.file and record settings).
        path: path inside the case, `let....`, or `case`.
        values: the coordinate: floats (numeric axis) or strings (labels, models, record file names).
        numeric: whether the coordinate is numeric.
        unit: unit of a numeric coordinate, "1" if dimensionless or unknown.
        files: the points as the study names them, where labels are names of files without their folders.
        given: the columns of the table that it was read from.
    """

    name: str
    path: str
    values: tuple[Any, ...]
    numeric: bool
    unit: str = "1"
    files: tuple[str, ...] = ()
    given: tuple[Given, ...] = ()

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.values)


OF_RECORDS = ("motion.record", "motion.record.file")
"""Paths of an axis that may name a record at each point."""

OF_DIRECTIONS = "motion.record.angle"
"""Path of an axis of directions of two components."""

SAMPLE = "sample"
"""The axis of the samples of uncertain inputs."""


@dataclass(frozen=True, eq=False)
class Input:
    """An uncertain input.

    Attributes:
        name: of its samples in the dataset.
        path: inside the case, or `let....`.
        unit: "1" if dimensionless or unknown.
        words: its distribution.
        values: of every sample, (n,).
    """

    name: str
    path: str
    unit: str
    words: str
    values: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Uncertain:
    """Uncertain inputs in the order of their paths, and the design they are from (`scene/uncertain/samples.py`)."""

    inputs: tuple[Input, ...]
    sampling: str
    seed: int


@dataclass(frozen=True)
class Expect:
    """One clause of `expect`.

    Attributes:
        quantity: a variable of the dataset.
        at: {axis name: coordinate value} already matched to the axes; an absent axis = every point.
        check: `value`, `min`, `max`, `is` or `is_not`.
        target: the number, or for is / is_not the tuple of outcome flags meant.
        rtol, atol: for `value`.
        time: for a history, the time [s] at which it is read.
        rotation: for a static curve, theta/alpha at which it is read; None = every rotation.
        references: where the number comes from.
        line: line in the study file.
    """

    quantity: str
    at: dict[str, Any]
    check: str
    target: float | tuple[int, ...]
    rtol: float = 1e-6
    atol: float = 0.0
    time: float | None = None
    rotation: float | None = None
    references: str = ""
    line: int | None = None


@dataclass(frozen=True, order=True)
class Limit:
    """A limit state: the absolute value of a scalar exceeds `value`, or the body overturns.

    Attributes:
        value: in the scalar's unit.
        quantity: theta_peak_over_alpha, slide_peak or slide_residual.
    """

    value: float
    quantity: str = PEAK

    @property
    def label(self) -> str:
        """Its name on the axis of the limit states."""
        return limit_label(self.quantity, self.value)


@dataclass(frozen=True)
class Over:
    """Ensemble statistics.

    Attributes:
        axes: names of the axes they are taken over, side by side.
        along: name of the axis of the intensity; None = there is none.
        limits: limit states by quantity, each ascending; overturning is one more.
        mean: whether the mean is wanted beside the fractiles.
        intensity: what fragility is told against; "" = the axis of the intensity.
        second: a second intensity that fragility is told against; "" = there is none.
        fit: `ordinal` one beta for all limit states, `lognormal` each alone, `none`.
        begins_at: `uplift` where curves begin where the body can first move, else `0`.
        beta_added: uncertainty beside that of the suite, in quadrature, in percentiles and curves.
        inputs: paths of the uncertain inputs whose samples are among the members.
        hazard: curves that fragility is convolved with.
        age: years for which the probability of exceedance is told; None = it is not.
    """

    axes: tuple[str, ...]
    along: str | None
    limits: tuple[Limit, ...]
    mean: bool
    intensity: str = ""
    fit: str = "ordinal"
    begins_at: str = "uplift"
    beta_added: float = 0.0
    inputs: tuple[str, ...] = ()
    hazard: tuple[HazardCurve, ...] = ()
    age: float | None = None
    second: str = ""

    @property
    def axis(self) -> str:
        """Name of the axis, or of the one that several make when they are laid end to end."""
        return ", ".join(self.axes)

    @property
    def told_against(self) -> str:
        """Name of the intensity of the fragility curves; "" = there are none."""
        return self.intensity or self.along or ""

    @property
    def ends(self) -> tuple[str, ...]:
        """Ends of the names of the statistics of a scalar."""
        return ("p16", "p50", "p84", "mean") if self.mean else ("p16", "p50", "p84")

    @property
    def limit_states(self) -> tuple[str, ...]:
        """Labels: the limits, and overturning."""
        return (*(limit.label for limit in self.limits), OVERTURNED)


class CaseSource(Protocol):
    """Builds the cases of a study on demand, so that a sweep never holds them all."""

    def batches(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """Yield (flat indices, batch) for the flat case indices (C order over the axes), grouped by tags."""
        ...


class Searched(CaseSource, Protocol):
    """A range searched for overturning; as a source of cases, those at the point `first`.

    Attributes:
        axis: the scanned points, ascending; not a dimension of the dataset.
        name: of the result in the dataset, `<axis>_overturning`.
    """

    @property
    def axis(self) -> Axis:
        """The scanned points."""
        ...

    @property
    def name(self) -> str:
        """Of the result."""
        ...

    @property
    def first(self) -> float:
        """The lowest scanned point above zero, as no motion has an amplitude of zero; without one the lowest."""
        ...

    @property
    def prescreens(self) -> tuple[str, ...]:
        """Names of the pre-screens beside the value found; none where no amplitude of the motion is searched."""
        ...

    def results(self, over: Over | None) -> tuple[str, ...]:
        """Names of what the search gives: the value found, what stands beside it, and its statistics."""
        ...

    def at(self, indices: Index, values: NDArray[np.float64]) -> Iterator[tuple[Index, Batch]]:
        """Yield (positions, batch) for flat case indices (k,), each with its own value (k,)."""
        ...


@dataclass(frozen=True)
class Study:
    """A checked study.

    Attributes:
        name, title, references: as in the file.
        file: the study file, None for a study given as a mapping.
        axes: outermost first.
        cases: builds batches.
        compare_to: {axis name: coordinate value} of the reference, or None.
        expect: clauses in file order.
        plots: kinds of plot asked for, and how each is wanted; None = the defaults.
        histories: whether histories are saved; dt_out: output spacing [s]; scalars: names in contract order.
        histories_at: {axis name: coordinate value} of the only cases whose histories are saved; None = all.
        curves: kinds of static curve asked for.
        rules: rules of thumb and code checks asked for; rules_spectrum: a floor response spectrum for those that
            take one; None: the motion's own.
        search: the range searched for overturning (`find`), which adds no dimension; None = none.
        over: ensemble statistics asked for; None = none.
        uncertain: inputs of which the axis `sample` has samples; None = none.
        refine: the two axes of which the outcome boundary is traced, as in `axes`; () = every case is solved.
        audit: share of the cases that are solved again more accurately; True = all up to a limit, False = none.
        resolved: the resolved study as a plain mapping (re-runnable when dumped as YAML).
        resolved_yaml: the same as YAML text.
        identity: SHA-256 hex of what changes numbers (case, let, vary, save, bytes of files, program version).
        sweep_id: what tells whether results of another study are among these (see `identity.sweep_id`), JSON.
        inputs: name of every file read, as in the study -> SHA-256 of its bytes.
        processing: record name -> what was done to it, sentences in order, with the effect on PGA and PGV.
        warnings: sentences about the study as a whole.
        g: what the expression that the case has for g comes to, where that is one number in all cases [m/s²].
        varied: paths inside the case that axes, settings of their points, tables, samples and a search change, sorted.
        places: where the file says what decides on the backend, by key (`solver.method`, `vary.base[1]`), of those that
            it says.
    """

    name: str
    title: str
    references: str
    file: Path | None
    axes: tuple[Axis, ...]
    cases: CaseSource
    compare_to: dict[str, Any] | None
    expect: tuple[Expect, ...]
    plots: tuple[tuple[str, Look], ...] | None
    histories: bool
    dt_out: float
    scalars: tuple[str, ...]
    resolved: dict[str, Any]
    resolved_yaml: str
    identity: str
    inputs: dict[str, str] = field(default_factory=dict)
    processing: dict[str, tuple[str, ...]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    histories_at: dict[str, Any] | None = None
    curves: tuple[str, ...] = ()
    rules: tuple[str, ...] = ()
    rules_spectrum: FloorSpectrum | None = None
    search: Searched | None = None
    sweep_id: str = ""
    over: Over | None = None
    uncertain: Uncertain | None = None
    refine: tuple[str, ...] = ()
    audit: float | bool = False
    g: float | None = None
    varied: tuple[str, ...] = ()
    places: dict[str, Where] = field(default_factory=dict)

    @property
    def case(self) -> dict[str, Any]:
        """The resolved case, as datasets carry it: with g as a number where it is one."""
        return {**self.resolved["case"], **({} if self.g is None else {"g": self.g})}

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points of each axis; () without axes."""
        return tuple(axis.size for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of cases."""
        return int(np.prod(self.shape, dtype=np.int64))

    def batches(self, indices: Index | None = None) -> Iterator[tuple[Index, Batch]]:
        """Yield (flat indices, batch) for all cases, or for the flat indices given."""
        return self.cases.batches(np.arange(self.size) if indices is None else indices)

    def suites(self, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """`batches`, but cases of many records in one (`Excitation.suite`) where the source of cases can."""
        suites: Callable[[Index], Iterator[tuple[Index, Batch]]] = getattr(self.cases, "suites", self.cases.batches)
        return suites(indices)
