"""`rock trade`: speed against accuracy on the scenes of a study, with errors of numerics, model and data told apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import zip_longest
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.engine.choose import BACKENDS
from rockcli.engine.cost import seconds_per_case
from rockcli.engine.ladder import (
    ELEMENTS_REFERENCE,
    NUMERICS,
    Pair,
    Rung,
    data,
    model_word,
    models,
    numerical,
    reference,
)
from rockcli.errors import SolverError, StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.models import CONTINUUM, FLEXIBLE
from rockcli.scene.response import FAILED, NO_UPLIFT, Response
from rockcli.study.study import Index, Study

Array = NDArray[np.float64]

SEED = 20260102
"""Of the sample: the same cases every time."""

AT_ONCE, REPEATS = 0.05, 3
"""Time below which a setting is timed again, and how often [s]."""

UNSURE = 0.05
"""Share of what is left of the budget above which a rough guess is not enough."""

COSTLIER = {"dt": 2.0, "rtol": 2.5}
"""How much dearer the next rung of a ladder is expected to be."""


@dataclass(eq=False)
class Answers:
    """Outcome, peak and steps over the sampled cases, (n,) each."""

    outcome: NDArray[np.int8]
    peak: Array
    steps: Array
    seconds: float = 0.0
    cases: int = 0

    @classmethod
    def none(cls, n: int) -> Answers:
        """Nothing yet."""
        return cls(np.full(n, FAILED, dtype=np.int8), np.full(n, np.nan), np.full(n, np.nan))

    def put(self, rows: Index, response: Response) -> None:
        """Take the answers of some cases."""
        self.outcome[rows] = response.scalars["outcome"]
        self.peak[rows] = response.scalars["theta_peak_over_alpha"]
        steps = response.scalars.get("n_steps")
        if steps is not None:
            self.steps[rows] = steps


@dataclass(eq=False)
class Point:
    """A setting measured over the sample.

    Attributes:
        error: peak minus the reference's, (n,), NaN unless both are finite; same: 1, 0, or -1 where either has none.
        on_front: whether no other setting of its part and model is both cheaper and more accurate.
    """

    rung: Rung
    answers: Answers
    error: Array
    same: NDArray[np.int8]
    on_front: bool = False

    @property
    def cost(self) -> float:
        """Time per case [s]."""
        return self.answers.seconds / max(self.answers.cases, 1)

    def quantile(self, share: float) -> float:
        """Of |error|; NaN where no peak can be compared."""
        finite = np.abs(self.error[np.isfinite(self.error)])
        return float(np.quantile(finite, share)) if finite.size else np.nan

    @property
    def wrong(self) -> int:
        """Outcomes that differ."""
        return int(np.sum(self.same == 0))

    @property
    def compared(self) -> int:
        """Outcomes that both have."""
        return int(np.sum(self.same >= 0))


@dataclass(eq=False)
class Trade:
    """What was measured.

    Attributes:
        points: in the order of the ladders; cases: flat indices of the sample; size: cases the study has.
        references: model -> how its reference was found.
        skipped: (setting, why), not measured.
    """

    cases: Index
    size: int
    points: list[Point] = field(default_factory=list)
    references: dict[str, str] = field(default_factory=dict)
    skipped: list[tuple[str, str]] = field(default_factory=list)


Ladder = list[tuple[Rung, Answers]]
"""Rungs, coarse to fine, each with the answers it is held against."""


class _Scene:
    """The sampled cases: batches, each with the rows it fills; the first alone; the models the study solves."""

    def __init__(self, study: Study, sample: int) -> None:
        if study.search is not None:
            raise StudyError("trade: needs cases, and `find` keeps none", file=study.file)
        ours = [axis.path.split(".")[0] in ("solver", "model", "geometry") for axis in study.axes]
        shape = [1 if own else axis.size for own, axis in zip(ours, study.axes, strict=True)]
        total = int(np.prod(shape, dtype=np.int64))
        chosen = np.arange(total)
        if sample < total:
            chosen = np.sort(np.random.default_rng(SEED).choice(total, sample, replace=False))
        at, self.own = _models_of(study, ours)
        places = np.unravel_index(chosen, shape) if shape else ()
        flat = [place + own for place, own in zip(places, at, strict=True)]
        self.cases = np.sort(np.ravel_multi_index(flat, study.shape)) if shape else chosen
        self.batches = [(np.searchsorted(self.cases, part), batch) for part, batch in study.batches(self.cases)]
        self.own += [p for p in dict.fromkeys((b.model, b.geometry) for _, b in self.batches) if p not in self.own]
        _, self.first = next(study.batches(self.cases[:1]))
        if any(batch.model == CONTINUUM or batch.damping.scheme == "fema356" for _, batch in self.batches):
            words = "trade: neither a full mesh nor the scheme fema356 has a ladder of settings"
            raise StudyError(words, file=study.file)

    def solvable(self, pair: Pair) -> list[tuple[Index, Batch]]:
        """Batches that can be solved with a model: a column is not made up."""
        return [(rows, batch) for rows, batch in self.batches if pair[0] != FLEXIBLE or batch.model == FLEXIBLE]


def _models_of(study: Study, ours: list[bool]) -> tuple[tuple[int, ...], list[Pair]]:
    """Where on the axes over model, geometry and solver the cases are taken from, and the models along those axes.

    A deformable model goes first: only its cases know the column.
    """
    along = [axis.size if own else 1 for own, axis in zip(ours, study.axes, strict=True)]
    combos = [tuple(int(i) for i in combo) for combo in np.ndindex(*along)]
    found: dict[Pair, tuple[int, ...]] = {}
    for combo in combos:
        flat = int(np.ravel_multi_index(combo, study.shape)) if combo else 0
        _, batch = next(study.batches(np.array([flat])))
        found.setdefault((batch.model, batch.geometry), combo)
    pairs = sorted((pair for pair in found if pair[0] != CONTINUUM), key=lambda pair: pair[0] != FLEXIBLE)
    return found[pairs[0]] if pairs else combos[0], pairs


def peers() -> frozenset[str]:
    """Backends that can be traded on this machine."""
    from rockcli.solvers.opensees.run import require_opensees

    found = {"event", "frame", "scipy"}
    try:
        require_opensees()
    except SolverError:
        return frozenset(found)
    return frozenset({*found, "opensees"})


def trade(
    study: Study,
    *,
    sample: int = 20,
    budget: float = np.inf,
    backends: frozenset[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Trade:
    """Measure every setting that can solve the study's models, coarse to fine, while the budget lasts.

    References are solved first, whatever they cost.  A setting that is expected to take longer than what is left of the
    budget is skipped, with all finer ones of its family.

    Args:
        study: a checked study; axes over solver, model and geometry are the trade's own and stay at their first point.
        sample: cases at most, drawn once for all.
        budget: time for everything but the references [s].
        backends: those that are measured; None = all there are on this machine.
        progress: called with (settings done, settings in all).

    Raises:
        StudyError: there is nothing to trade.
    """
    with np.errstate(all="ignore"):
        kernels.load(compile_them=True)
        scene = _Scene(study, sample)
        known = peers() if backends is None else backends
        found = Trade(scene.cases, study.size)
        ladders = _ladders(scene, known, found)
        if not ladders:
            raise StudyError("trade: no backend solves this study's model with its damping", file=study.file)
        if "opensees" not in known and backends is None:
            found.skipped.append(("opensees", "OpenSeesPy is not installed"))
        _climb(scene, ladders, found, budget, progress)
    _mark_fronts(found.points)
    return found


def _ladders(scene: _Scene, known: frozenset[str], found: Trade) -> list[Ladder]:
    """Every ladder, each rung with the answers it is held against, which are solved here."""
    solved: dict[tuple[Pair, str], Answers] = {}

    def best(batch: Batch, pair: Pair, elements: int | None = None) -> Answers:
        rung = reference(batch, pair, elements)
        assert rung is not None
        key = (pair, rung.setting)
        if key not in solved:
            solved[key] = _measured(scene, rung, Answers.none(len(scene.cases)))
            what = model_word(pair) + (", elements" if elements else "")
            found.references[what] = f"{rung.family}, {rung.setting}"
        return solved[key]

    ladders: list[Ladder] = []
    for number, pair in enumerate(scene.own):
        for _, batch in scene.solvable(pair)[:1]:
            for rungs in numerical(batch, pair, known):
                answers = best(batch, pair, ELEMENTS_REFERENCE if rungs[0].elements else None)
                ladders.append([(rung, answers) for rung in rungs])
            ladders += [[(rung, best(batch, better))] for rung, better in models(batch, pair) if number == 0]
            ladders += [[(rung, best(batch, pair))] for rung in data(batch, pair)]
    return ladders


def _climb(
    scene: _Scene,
    ladders: list[Ladder],
    found: Trade,
    budget: float,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Rung by rung: first what costs next to nothing, then all other ladders side by side, coarse ends first."""
    total = sum(len(ladder) for ladder in ladders)
    began = perf_counter()
    last: dict[int, float] = {}
    over: set[int] = set()
    points: dict[str, Point] = {}
    for done, (number, (rung, answers)) in enumerate(_order(ladders), start=1):
        left = budget - (perf_counter() - began)
        try:
            expected = 0.0 if number in over else _expected(scene, rung, last.get(number), left)
            if number in over or expected > left:
                over.add(number)
                found.skipped.append((rung.label, "the budget is used up"))
            else:
                measured = _measured(scene, rung, Answers.none(len(scene.cases)))
                last[number] = measured.seconds
                points[rung.label] = _point(rung, measured, answers)
        except SolverError as refused:
            found.skipped.append((rung.label, str(refused)))
        if progress is not None:
            progress(done, total)
    found.points = [points[rung.label] for ladder in ladders for rung, _ in ladder if rung.label in points]


def _order(ladders: list[Ladder]) -> Iterator[tuple[int, tuple[Rung, Answers]]]:
    """(number of the ladder, rung) in the order they are climbed."""
    cheap = [number for number, ladder in enumerate(ladders) if ladder[0][0].numerics.backend == "event"]
    for number in cheap:
        for item in ladders[number]:
            yield number, item
    for step in zip_longest(*(ladder for number, ladder in enumerate(ladders) if number not in cheap)):
        others = (number for number in range(len(ladders)) if number not in cheap)
        yield from ((number, item) for number, item in zip(others, step, strict=True) if item is not None)


def _expected(scene: _Scene, rung: Rung, before: float | None, left: float) -> float:
    """Time a rung is likely to take [s]: from the rung before; of a first one a guess, and a case if it matters."""
    if rung.numerics.backend == "event":
        return 0.0
    guess = seconds_per_case(rung.of(scene.first), rung.numerics.backend) * len(scene.cases)
    if before is None and guess < UNSURE * left:
        return guess
    if before is not None:
        return before * COSTLIER["dt" if rung.factor else "rtol"]
    seconds = 0.0
    for _ in range(2):  # the first also imports and compiles
        began = perf_counter()
        _solver(rung)(rung.of(scene.first))
        seconds = perf_counter() - began
        if seconds * len(scene.cases) < left:
            break
    return seconds * len(scene.cases)


def _parts(scene: _Scene, rung: Rung) -> list[tuple[Index, Batch]]:
    return scene.solvable((rung.model, rung.geometry))


def _solver(rung: Rung) -> Callable[[Batch], Response]:
    return BACKENDS[rung.numerics.backend].of_model(rung.model).load()


def _measured(scene: _Scene, rung: Rung, answers: Answers) -> Answers:
    """Solve the sample with a setting; the time is the least of a few runs where one takes next to nothing."""
    solver = _solver(rung)
    for run in range(REPEATS):
        spent, cases = 0.0, 0
        for rows, batch in _parts(scene, rung):
            given = rung.of(batch)
            began = perf_counter()
            response = solver(given)
            spent += perf_counter() - began
            cases += batch.size
            answers.put(rows, response)
        answers.seconds = min(spent, answers.seconds) if answers.cases else spent
        answers.cases = cases
        if spent > AT_ONCE and (run or rung.numerics.backend != "event"):
            break  # the event-driven solvers load kernels the first time
    return answers


def _point(rung: Rung, found: Answers, best: Answers) -> Point:
    error = found.peak - best.peak
    decided = (found.outcome >= NO_UPLIFT) & (best.outcome >= NO_UPLIFT)
    same = np.where(decided, found.outcome == best.outcome, -1).astype(np.int8)
    return Point(rung, found, np.where(np.isfinite(error), error, np.nan), same)


def _mark_fronts(points: list[Point]) -> None:
    """Pareto front of cost and median error, for each model of each part, among settings with no failed case."""
    groups: dict[tuple[str, Pair | None, str], list[Point]] = {}
    for point in points:
        if np.isfinite(point.quantile(0.5)) and not np.isin(point.answers.outcome, (FAILED,)).any():
            pair = (point.rung.model, point.rung.geometry) if point.rung.part == NUMERICS else None
            # elements are an error of space, told against another reference
            kind = "elements" if point.rung.elements else ""
            groups.setdefault((point.rung.part, pair, kind), []).append(point)
    for group in groups.values():
        for point, kept in zip(group, front([(p.cost, p.quantile(0.5)) for p in group]), strict=True):
            point.on_front = kept


def front(points: list[tuple[float, float]]) -> list[bool]:
    """Whether no other point is at least as good in both numbers and better in one."""
    return [not any(o[0] <= p[0] and o[1] <= p[1] and o != p for o in points) for p in points]
