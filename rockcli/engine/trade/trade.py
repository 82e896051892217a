"""`rock trade`: speed against accuracy on the cases of a study; errors of numerics, model and data apart."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import zip_longest
from time import perf_counter

import numpy as np

from rockcli import kernels
from rockcli.engine.cost import seconds_per_case
from rockcli.engine.trade import meshes
from rockcli.engine.trade.measurements import Answers, Point, Trade, mark_fronts, point_of
from rockcli.engine.trade.record_sampling import has_samples
from rockcli.engine.trade.sampled_cases import Sample
from rockcli.engine.trade.settings import (
    DATA,
    ELEMENTS_REFERENCE,
    NUMERICS,
    Rung,
    data,
    model_word,
    models,
    numerical,
    reference,
)
from rockcli.errors import SolverError, StudyError
from rockcli.scene.backends import BACKENDS, Pair
from rockcli.scene.batch import Batch
from rockcli.scene.models import DEFORMABLE
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, NO_UPLIFT, Response
from rockcli.study.study import Index, Study

AT_ONCE, REPEATS = 0.05, 3
"""Time below which a setting is timed again, and how often [s]."""

UNSURE = 0.05
"""Share of what is left of the budget above which a rough guess is not enough."""

TRADED = frozenset(name for name, row in BACKENDS.items() if row.ladder)
"""Backends that have settings to trade."""

NO_CCX = "there is no `ccx` in PATH"

COSTLIER = {"dt": 2.0, "rtol": 2.5}
"""How much dearer the next rung of a ladder is expected to be."""


@dataclass(frozen=True, eq=False)
class Ladder:
    """Rungs, coarse to fine, and the answers they are held against.

    `best` None: those of the finest rung measured of `meshes` with `least` elements across, or of the ladder itself.
    """

    rungs: list[Rung]
    best: Answers | None = None
    meshes: list[Rung] | None = None
    least: int = 0

    @property
    def backend(self) -> str:
        """Of its rungs."""
        return self.rungs[0].numerics.backend


def peers() -> frozenset[str]:
    """Backends that can be traded on this machine."""
    found = set()
    for name in TRADED:
        with contextlib.suppress(SolverError):
            BACKENDS[name].require()
            found.add(name)
    return frozenset(found)


def trade(
    study: Study,
    *,
    sample: int = 20,
    budget: float = np.inf,
    backends: frozenset[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Trade:
    """Measure every setting that can solve the study's models, coarse to fine, while the budget lasts.

    References are solved first, whatever they cost; that of the full mesh is the finest setting the budget allows.
    A setting that is expected to take longer than what is left of the budget is skipped, with all finer ones of its
    family.

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
        scene = Sample(study, sample)
        known = peers() if backends is None else backends
        found = Trade(scene.cases, study.size, notes=list(scene.notes))
        ladders = _ladders(scene, known, found)
        if not ladders:
            why = "no backend solves its model with its damping"
            if meshes.MESH in scene.own and "calculix" not in known:
                why = f"the full mesh needs CalculiX: {NO_CCX}"
            raise StudyError(f"trade: {why}", file=study.file)
        traded = TRADED if backends is None else known
        unable = {name: why for name in BACKENDS if name in traded and (why := _unable(scene, name))}
        found.skipped += unable.items()
        if not any(has_samples(batch.excitation) for _, batch in scene.batches):
            found.skipped.append((DATA, "no record, so no error of the data"))
        if "opensees" not in known and backends is None and "opensees" not in unable:
            found.skipped.append(("opensees", "OpenSeesPy is not installed"))
        if "calculix" not in known and backends is None and any(pair[0] in DEFORMABLE for pair in scene.own):
            found.skipped.append(("calculix", NO_CCX))
        _climb(scene, ladders, found, budget, progress)
    mark_fronts(found.points)
    return found


def _unable(scene: Sample, name: str) -> str:
    """Which of the study's models a backend does not solve, by the table of backends; "" if it solves each."""
    if name == meshes.HOW.backend and scene.solvable(meshes.MESH):
        return ""  # it has ladders of its own beside the study's model
    row = BACKENDS[name]
    whys, foreign = [], []
    for pair in scene.own:
        for _, batch in scene.solvable(pair)[:1]:
            if pair not in row.models:
                foreign.append(model_word(pair))
            elif not row.supports(replace(batch, model=pair[0], geometry=pair[1], numerics=Numerics(name))):
                whys.append(f"not for model {model_word(pair)} with damping {batch.damping.scheme}")
    if foreign:
        solved = sorted({model for model, _ in row.models})
        whys.append(f"not for model {', '.join(foreign)}, only for {', '.join(solved)}")
    return "; ".join(whys)


def _ladders(scene: Sample, known: frozenset[str], found: Trade) -> list[Ladder]:
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
                ladders.append(Ladder(rungs, best(batch, pair, ELEMENTS_REFERENCE if rungs[0].elements else None)))
            ladders += [Ladder([rung], best(batch, better)) for rung, better in models(batch, pair) if number == 0]
            ladders += [Ladder([rung], best(batch, pair)) for rung in data(batch, pair)]
    return ladders + (_of_meshes(scene, found) if "calculix" in known else [])


def _of_meshes(scene: Sample, found: Trade) -> list[Ladder]:
    """Ladders of the full mesh, and the models it judges; none where there is no column to make it from."""
    for _, batch in scene.solvable(meshes.MESH)[:1]:
        if not BACKENDS["calculix"].supports(Rung(NUMERICS, "", "", *meshes.MESH, meshes.HOW).of(batch)):
            continue
        if why := meshes.refusal(batch):
            found.skipped.append(("calculix", why))
            continue
        elements, steps = meshes.ladders(batch, scene.along)
        least = steps[0].across or 0
        judged = [Ladder([rung], meshes=elements, least=least) for rung in meshes.judged(batch, scene.own[0])]
        asked = meshes.MESH in scene.own  # else it is only there to judge other models
        return [Ladder(elements), *([Ladder(steps)] if asked else []), *judged]
    return []


def _climb(
    scene: Sample,
    ladders: list[Ladder],
    found: Trade,
    budget: float,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Rung by rung: first what costs next to nothing, then all other ladders side by side (see `_order`)."""
    total = sum(len(ladder.rungs) for ladder in ladders)
    began = perf_counter()
    last: dict[int, tuple[Rung, float]] = {}
    over: set[int] = set()
    answers: dict[str, Answers] = {}
    for done, (number, rung) in enumerate(_order(ladders), start=1):
        left = budget - (perf_counter() - began)
        try:
            expected = 0.0 if number in over else _expected(scene, rung, last.get(number), left)
            if number in over or expected > left:
                over.add(number)
                found.skipped.append((rung.label, "the budget is used up"))
            else:
                measured = _measured(scene, rung, Answers.none(len(scene.cases)))
                last[number] = rung, measured.seconds
                answers[rung.label] = measured
                if (measured.outcome < NO_UPLIFT).all():  # it has no error, so no table shows it
                    found.skipped.append((rung.label, "no sampled case has an outcome"))
        except SolverError as refused:
            found.skipped.append((rung.label, str(refused)))
        if progress is not None:
            progress(done, total)
    for ladder in ladders:
        found.points += _points(ladder, answers, found)


def _points(ladder: Ladder, answers: dict[str, Answers], found: Trade) -> list[Point]:
    """The rungs of a ladder that were measured, with their errors."""
    rungs = [rung for rung in ladder.rungs if rung.label in answers]
    if ladder.best is not None:
        _tell(found, ladder.rungs[0], ladder.best)
        return [point_of(rung, answers[rung.label], ladder.best) for rung in rungs]
    candidates = [r for r in ladder.meshes or ladder.rungs if r.label in answers and (r.across or 0) >= ladder.least]
    if not candidates:
        found.skipped[:0] = [(rung.label, "no mesh as fine as the study's was measured") for rung in rungs]
        return []
    finest = max(reversed(candidates), key=lambda rung: int(np.sum(answers[rung.label].outcome != FAILED)))
    best = answers[finest.label]
    if ladder.meshes is None:
        _tell(found, finest, best)
        words = f"{finest.family}, {finest.setting}"
        found.references[finest.family.replace("calculix", model_word(meshes.MESH))] = f"{words}: the finest measured"
        return [point_of(replace(r, against=words), answers[r.label], best if r != finest else None) for r in rungs]
    return [point_of(rung, answers[rung.label], best) for rung in rungs]


def _tell(found: Trade, rung: Rung, best: Answers) -> None:
    """Note what all cases of the sample do under a model of the study, if peaks tell nothing then."""
    note = f"model {model_word((rung.model, rung.geometry))}: {best.fate}"
    if rung.part == NUMERICS and best.fate and note not in found.notes:
        found.notes.append(note)


def _order(ladders: list[Ladder]) -> Iterator[tuple[int, Rung]]:
    """(number of the ladder, rung) in the order they are climbed.

    `event`, which costs next to nothing; of every other family its first rung before any has a second one.
    """
    numbered = list(enumerate(ladders))
    for number, ladder in numbered:
        if ladder.backend == "event":
            yield from ((number, rung) for rung in ladder.rungs)
    others = [(number, ladder) for number, ladder in numbered if ladder.backend != "event"]
    yield from ((number, ladder.rungs[0]) for number, ladder in others)
    for late in (False, True):
        own = [(number, ladder.rungs[1:]) for number, ladder in others if BACKENDS[ladder.backend].slow == late]
        for step in zip_longest(*(rungs for _, rungs in own)):
            yield from ((number, rung) for (number, _), rung in zip(own, step, strict=True) if rung is not None)


def _expected(scene: Sample, rung: Rung, before: tuple[Rung, float] | None, left: float) -> float:
    """Time a rung is likely to take [s]: from the rung before; of a first one a guess, and a case if it matters."""
    if rung.numerics.backend == "event":
        return 0.0

    first = scene.first((rung.model, rung.geometry))
    cases = sum(batch.size for _, batch in _parts(scene, rung))

    def guessed(rung: Rung) -> float:
        return seconds_per_case(rung.of(first), rung.numerics.backend) * cases

    guess = guessed(rung)
    if rung.numerics.backend == "calculix":  # the cost goes with elements and increments
        return guess if before is None else before[1] * guess / guessed(before[0])
    if before is None and guess < UNSURE * left:
        return guess
    if before is not None:
        return before[1] * COSTLIER["dt" if rung.factor else "rtol"]
    seconds = 0.0
    for _ in range(2):  # the first also imports and compiles
        began = perf_counter()
        _solver(rung)(rung.of(first))
        seconds = perf_counter() - began
        if seconds * cases < left:
            break
    return seconds * cases


def _parts(scene: Sample, rung: Rung) -> list[tuple[Index, Batch]]:
    return scene.solvable((rung.model, rung.geometry))


def _solver(rung: Rung) -> Callable[[Batch], Response]:
    return BACKENDS[rung.numerics.backend].of_model(rung.model).load()


def _measured(scene: Sample, rung: Rung, answers: Answers) -> Answers:
    """Solve the sample with a setting; the time is the least of a few runs where one takes next to nothing."""
    solver = _solver(rung)
    for run in range(1 if BACKENDS[rung.numerics.backend].slow else REPEATS):
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
