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
from rockcli.engine.trade.record_sampling import has_samples, through_floors
from rockcli.engine.trade.sampled_cases import Sample
from rockcli.engine.trade.settings import (
    DATA,
    ELEMENTS_REFERENCE,
    MODEL,
    NUMERICS,
    Setting,
    data,
    model_word,
    models,
    numerical,
    reference,
)
from rockcli.errors import SolverError, StudyError
from rockcli.scene.backends import BACKENDS, EVENT, Pair
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import DEFORMABLE
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import FAILED, NO_UPLIFT, Response
from rockcli.study.study import Index, Study

AT_ONCE, REPEATS = 0.05, 3
"""Time below which a setting is timed again, and how often [s]."""

UNSURE = 0.05
"""Share of what is left of the budget above which a rough guess is not enough."""

FOR_REFERENCES = 0.25
"""Share of the budget that references may take before fewer cases are sampled."""

TRADED = frozenset(name for name, row in BACKENDS.items() if row.settings)
"""Backends that have settings to trade."""

NO_CCX = "there is no `ccx` in PATH"

COSTLIER = {"dt": 2.0, "rtol": 2.5}
"""How much dearer the next setting of a series is expected to be."""


@dataclass(frozen=True, eq=False)
class Series:
    """Settings, coarse to fine, and the answers they are held against.

    `best` None: those of the finest setting measured of `meshes` with `least` elements across, or of the series itself.
    """

    settings: list[Setting]
    best: Answers | None = None
    meshes: list[Setting] | None = None
    least: int = 0

    @property
    def backend(self) -> str:
        """Of its settings."""
        return self.settings[0].numerics.backend


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

    References are solved first, of fewer cases than asked for where all take more than a share of the budget; that
    of the full mesh is the finest setting the budget allows.  A setting that is expected to take longer than what is
    left of it is skipped, with all finer ones of its family.

    Args:
        study: a checked study; axes over solver, model and geometry are the trade's own and stay at their first point.
        sample: cases at most, drawn once for all.
        budget: time for references and settings together, without the loading of kernels [s].
        backends: those that are measured; None = all there are on this machine.
        progress: called with (settings done, settings in all).

    Raises:
        StudyError: there is nothing to trade.
    """
    with np.errstate(all="ignore"):
        kernels.load(compile_them=True)
        began = perf_counter()
        scene = _affordable(study, sample, budget)
        known = peers() if backends is None else backends
        if scene.rolls or scene.slides:
            known = known & {EVENT}
        found = Trade(scene.cases, study.size, notes=[*scene.notes, *_fewer(scene, study, sample, budget)])
        families = _series_of(scene, known, found)
        if not families:
            why = "no backend solves its model with its damping"
            if meshes.MESH in scene.own and "calculix" not in known:
                why = f"the full mesh needs CalculiX: {NO_CCX}"
            raise StudyError(f"trade: {why}", file=study.file)
        traded = TRADED if backends is None else known
        unable = {name: why for name in BACKENDS if name in traded and (why := _unable(scene, name))}
        found.skipped += unable.items()
        if scene.rolls:
            found.skipped.append((MODEL, "every other model knows but two edges, and the body rolls over vertices"))
        if _through_floors(scene):
            found.skipped.append((DATA, "what arrives through floors is no record, so no error of the data"))
        elif not any(has_samples(batch.excitation) for _, batch in scene.batches):
            found.skipped.append((DATA, "no record, so no error of the data"))
        if "opensees" not in known and backends is None and "opensees" not in unable:
            found.skipped.append(("opensees", "OpenSeesPy is not installed"))
        if "calculix" not in known and backends is None and any(pair[0] in DEFORMABLE for pair in scene.own):
            found.skipped.append(("calculix", NO_CCX))
        _measure_all(scene, families, found, budget, began, progress)
    mark_fronts(found.points)
    return found


def _unable(scene: Sample, name: str) -> str:
    """Which of the study's models a backend does not solve, by the table of backends; "" if it solves each."""
    if name == meshes.HOW.backend and scene.solvable(meshes.MESH):
        return ""  # it has families of its own beside the study's model
    row = BACKENDS[name]
    whys, foreign = [], []
    for pair in scene.own:
        for _, batch in scene.solvable(pair)[:1]:
            if pair not in row.models:
                foreign.append(model_word(pair))
            elif not row.supports(replace(batch, model=pair[0], geometry=pair[1], numerics=Numerics(name))):
                whys.append(f"not for model {model_word(pair)} with damping {batch.damping.scheme}")
    if scene.rolls and name != EVENT:
        whys.append("not for bodies that roll over vertices")
    if scene.slides and name != EVENT:
        whys.append("not for bodies with block.mu, as it solves no sliding")
    if foreign:
        solved = sorted({model for model, _ in row.models})
        whys.append(f"not for model {', '.join(foreign)}, only for {', '.join(solved)}")
    return "; ".join(whys)


def _series_of(scene: Sample, known: frozenset[str], found: Trade) -> list[Series]:
    """Every series, each setting with the answers it is held against, which are solved here."""
    solved: dict[tuple[Pair, str], Answers] = {}

    def best(batch: Batch, pair: Pair, elements: int | None = None) -> Answers:
        setting = reference(batch, pair, elements)
        assert setting is not None
        key = (pair, setting.step)
        if key not in solved:
            solved[key] = _measured(scene, setting, Answers.none(len(scene.cases)))
            what = model_word(pair) + (", elements" if elements else "")
            found.references[what] = f"{setting.family}, {setting.step}"
        return solved[key]

    families: list[Series] = []
    for number, pair in enumerate(scene.own):
        for _, batch in scene.solvable(pair)[:1]:
            for settings in numerical(batch, pair, known):
                families.append(
                    Series(settings, best(batch, pair, ELEMENTS_REFERENCE if settings[0].elements else None))
                )
            simpler = models(batch, pair) if number == 0 and not scene.rolls else ()
            families += [Series([setting], best(batch, better)) for setting, better in simpler]
            if not _through_floors(scene):
                families += [Series([setting], best(batch, pair)) for setting in data(batch, pair)]
    return families + (_of_meshes(scene, found) if "calculix" in known else [])


def _through_floors(scene: Sample) -> bool:
    return any(through_floors(batch.excitation) for _, batch in scene.batches)


def _of_meshes(scene: Sample, found: Trade) -> list[Series]:
    """Families of the full mesh, and the models it judges; none where there is no column to make it from."""
    for _, batch in scene.solvable(meshes.MESH)[:1]:
        if not BACKENDS["calculix"].supports(Setting(NUMERICS, "", "", *meshes.MESH, meshes.HOW).of(batch)):
            continue
        if why := meshes.refusal(batch):
            found.skipped.append(("calculix", why))
            continue
        elements, steps = meshes.families(batch, scene.along)
        least = steps[0].across or 0
        judged = [Series([setting], meshes=elements, least=least) for setting in meshes.judged(batch, scene.own[0])]
        asked = meshes.MESH in scene.own  # else it is only there to judge other models
        return [Series(elements), *([Series(steps)] if asked else []), *judged]
    return []


def _measure_all(
    scene: Sample,
    families: list[Series],
    found: Trade,
    budget: float,
    began: float,
    progress: Callable[[int, int], None] | None,
) -> None:
    """Setting by setting: first what costs next to nothing, then all other families side by side (see `_order`).

    What costs next to nothing has the budget for itself; for all others it is running since `began`.
    """
    total = sum(len(series.settings) for series in families)
    referred = perf_counter()
    pace: dict[str, float] = {}
    last: dict[int, tuple[Setting, float]] = {}
    over: set[int] = set()
    answers: dict[str, Answers] = {}
    for done, (number, setting) in enumerate(_order(families), start=1):
        backend = setting.numerics.backend
        left = budget - (perf_counter() - (referred if backend == "event" else began))
        try:
            expected = np.inf if left <= 0.0 else 0.0
            if left > 0.0 and number not in over:
                expected = _expected(scene, setting, last.get(number), left, pace)
                left = budget - (perf_counter() - (referred if backend == "event" else began))
            if number in over or expected > left:
                over.add(number)
                found.skipped.append((setting.label, "the budget is used up"))
            else:
                solving = perf_counter()
                measured = _measured(scene, setting, Answers.none(len(scene.cases)))
                if number not in last and backend != "event":
                    guess = _guess(scene, setting)
                    pace[backend] = max(pace.get(backend, 0.0), (perf_counter() - solving) / guess)
                last[number] = setting, measured.seconds
                answers[setting.label] = measured
                if (measured.outcome < NO_UPLIFT).all():  # it has no error, so no table shows it
                    why = "no sampled case has an outcome"
                    found.skipped.append((setting.label, f"{why}: {measured.why}" if measured.why else why))
        except SolverError as refused:
            found.skipped.append((setting.label, str(refused)))
        if progress is not None:
            progress(done, total)
    for series in families:
        found.points += _points(series, answers, found)


def _points(series: Series, answers: dict[str, Answers], found: Trade) -> list[Point]:
    """The settings of a series that were measured, with their errors."""
    settings = [setting for setting in series.settings if setting.label in answers]
    if series.best is not None:
        _tell(found, series.settings[0], series.best)
        return [point_of(setting, answers[setting.label], series.best) for setting in settings]
    candidates = [r for r in series.meshes or series.settings if r.label in answers and (r.across or 0) >= series.least]
    if not candidates:
        found.skipped[:0] = [(setting.label, "no mesh as fine as the study's was measured") for setting in settings]
        return []
    finest = max(reversed(candidates), key=lambda setting: int(np.sum(answers[setting.label].outcome != FAILED)))
    best = answers[finest.label]
    if series.meshes is None:
        _tell(found, finest, best)
        words = f"{finest.family}, {finest.step}"
        found.references[finest.family.replace("calculix", model_word(meshes.MESH))] = f"{words}: the finest measured"
        return [point_of(replace(r, against=words), answers[r.label], best if r != finest else None) for r in settings]
    return [point_of(setting, answers[setting.label], best) for setting in settings]


def _tell(found: Trade, setting: Setting, best: Answers) -> None:
    """Note what all cases of the sample do under a model of the study, if peaks tell nothing then."""
    note = f"model {model_word((setting.model, setting.geometry))}: {best.why_no_peaks}"
    if setting.part == NUMERICS and best.why_no_peaks and note not in found.notes:
        found.notes.append(note)


def _order(families: list[Series]) -> Iterator[tuple[int, Setting]]:
    """(number of the series, setting) in the order they are measured.

    `event`, which costs next to nothing; of every other family its first setting before any has a second one.
    """
    numbered = list(enumerate(families))
    for number, series in numbered:
        if series.backend == "event":
            yield from ((number, setting) for setting in series.settings)
    others = [(number, series) for number, series in numbered if series.backend != "event"]
    yield from ((number, series.settings[0]) for number, series in others)
    for late in (False, True):
        own = [(number, series.settings[1:]) for number, series in others if BACKENDS[series.backend].slow == late]
        for step in zip_longest(*(settings for _, settings in own)):
            yield from (
                (number, setting) for (number, _), setting in zip(own, step, strict=True) if setting is not None
            )


def _affordable(study: Study, sample: int, budget: float) -> Sample:
    """The sampled cases: as many as asked for, fewer where their references would take more than their share."""
    scene = Sample(study, sample)
    seconds = 0.0
    for pair in scene.own:
        for _, batch in scene.solvable(pair)[:1]:
            setting = reference(batch, pair)
            if setting is not None and len(scene.cases) > 1:
                one = setting.of(scene.first(pair))
                _solver(setting)(one)  # loads and compiles
                began = perf_counter()
                _solver(setting)(one)
                seconds += perf_counter() - began
    fit = max(1.0, FOR_REFERENCES * budget / seconds) if seconds else np.inf
    return scene if len(scene.cases) <= fit else Sample(study, int(fit))


def _fewer(scene: Sample, study: Study, sample: int, budget: float) -> list[str]:
    """A note where the budget allows fewer cases than asked for."""
    asked = len(Sample(study, sample).cases)
    if len(scene.cases) == asked:
        return []
    return [f"{len(scene.cases)} instead of {asked} cases are measured: more do not fit a budget of {budget:g} s"]


def _guess(scene: Sample, setting: Setting) -> float:
    """Roughly the time of a setting, from what its kind takes on some machine [s]."""
    cases = sum(batch.size for _, batch in _parts(scene, setting))
    one = setting.of(scene.first((setting.model, setting.geometry)))
    return seconds_per_case(one, setting.numerics.backend) * cases


def _expected(
    scene: Sample, setting: Setting, before: tuple[Setting, float] | None, left: float, pace: dict[str, float]
) -> float:
    """Time a setting is likely to take [s]: from the one before; of a first one a guess, and a case if it matters.

    Args:
        pace: of every backend the largest time measured over what was guessed: other work on the machine counts too.
    """
    if setting.numerics.backend == "event":
        return 0.0
    if setting.numerics.backend == "calculix":  # the cost goes with elements and increments
        guess = _guess(scene, setting)
        return guess if before is None else before[1] * guess / _guess(scene, before[0])
    if before is not None:
        return before[1] * COSTLIER["dt" if setting.factor else "rtol"]
    guess = _guess(scene, setting) * pace.get(setting.numerics.backend, 1.0)
    if guess < UNSURE * left or guess > left:
        return guess
    cases = sum(batch.size for _, batch in _parts(scene, setting))
    first = setting.of(scene.first((setting.model, setting.geometry)))
    seconds = 0.0
    for _ in range(2):  # the first also imports and compiles
        began = perf_counter()
        _solver(setting)(first)
        seconds = perf_counter() - began
        if seconds * cases < left:
            break
    return seconds * cases


def _parts(scene: Sample, setting: Setting) -> list[tuple[Index, Batch]]:
    return scene.solvable((setting.model, setting.geometry))


def _solver(setting: Setting) -> Callable[[Batch], Response]:
    return BACKENDS[setting.numerics.backend].of_model(setting.model).load()


def _measured(scene: Sample, setting: Setting, answers: Answers) -> Answers:
    """Solve the sample with a setting; the time is the least of a few runs where one takes next to nothing."""
    solver = _solver(setting)
    for run in range(1 if BACKENDS[setting.numerics.backend].slow else REPEATS):
        spent, cases = 0.0, 0
        for rows, batch in _parts(scene, setting):
            given = setting.of(batch)
            began = perf_counter()
            response = solver(given)
            spent += perf_counter() - began
            cases += batch.size
            answers.put(rows, response)
        answers.seconds = min(spent, answers.seconds) if answers.cases else spent
        answers.cases = cases
        if spent > AT_ONCE and (run or setting.numerics.backend != "event"):
            break  # the event-driven solvers load kernels the first time
    return answers
