"""The bodies of a study under the motions of a table of runs: what share of each case overturns."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.backends import choose
from rockcli.engine.experiments.runs import Runs
from rockcli.engine.run import check_answers
from rockcli.engine.sweep.chunks import Chunks, Pace
from rockcli.engine.sweep.executors import answers
from rockcli.engine.sweep.sweep import Progress
from rockcli.engine.sweep.work import Team
from rockcli.errors import MachineError, StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.ground.amplitudes import RECORD_SCALINGS
from rockcli.scene.ground.excitation import Samples
from rockcli.scene.response import overturned
from rockcli.study.building.records import MissingRecordError, Records
from rockcli.study.cases.buildable import Unsolved
from rockcli.study.document.loader import load_file, load_mapping
from rockcli.study.document.shorthands import expanded
from rockcli.study.document.tree import Map, Source, value_at
from rockcli.study.identity import as_yaml, plain
from rockcli.study.open import open_study
from rockcli.study.study import Index, Study
from rockcli.version import __version__

Array = NDArray[np.float64]

AMPLITUDE = "run_amplitude"
"""Symbol of `let` by which the motion of every run is multiplied."""

_AXIS = "motion.record"

_BODIES = ("case", "let", "vary", "uncertain", "samples", "seed", "sampling")

_SECONDS = 1e-3
"""Estimated time of a case, until the first are measured [s]."""


def any_body(reading: dict[str, Any]) -> dict[str, Any]:
    """A study for the sake of its ground motions, read with these settings (units, dt); its body does not matter."""
    return {"name": "runs", "case": {"block": {"R": 1.0, "alpha": 0.2}, "motion": {"record": {**reading}}}}


@dataclass(frozen=True, eq=False)
class Simulated:
    """What the bodies of a study do in n runs.

    Attributes:
        share: (n, c, a) share that overturns, 0 or 1 where the outcome is certain; NaN where there is no answer.
        amplitudes: (a,) by which each run's motion was multiplied.
        inputs: path -> (c,) of the axes of the study: numbers, or labels.
        units: path -> unit of its numbers.
        study: the study's name.
        identity: hash of all that makes the bodies, and of how motions are read and multiplied.
    """

    share: Array
    amplitudes: Array
    inputs: dict[str, NDArray[Any]]
    units: dict[str, str]
    study: str
    identity: str


def bodies_of(source: Path | dict[str, Any], runs: Runs, amplitudes: Sequence[float]) -> Study:
    """A study with the first of the runs' motions, and the amplitudes as its outermost axis.

    Args:
        source: a study of one body or of several (axes, uncertain inputs), without a scale of its motion.
        runs: with records.
        amplitudes: factors of the motion.

    Raises:
        StudyError, RecordError: the study or a record is wrong; a run's record is named with its line.
    """
    where, tree = _read(source, runs)
    name, scale = _motions(runs)[0]
    vary = {f"let.{AMPLITUDE}": [float(value) for value in amplitudes]}
    wanted = "[outcome, overturn_share]" if len(amplitudes) == 1 else "[outcome]"
    overrides = [
        ("let", as_yaml({**plain(tree.get("let") or {}), AMPLITUDE: 1.0})),
        ("case.motion.record.file", json.dumps(str(_files(where, runs)[name]))),
        ("case.motion.record.scale", f"{scale!r}*{AMPLITUDE}"),
        ("vary", as_yaml({**vary, **plain(tree.get("vary") or {}, nothing=True)})),
        ("save", f"{{histories: false, scalars: {wanted}}}"),
        ("plots", "none"),
    ]
    overrides += [(name, "[]") for name in ("expect", "curves", "rules") if tree.get(name)]
    overrides += [
        (name, "null") for name in ("over", "compare_to", "hazard", "age", "score") if tree.get(name) is not None
    ]
    study = open_study(source, overrides=overrides)
    check_answers(study)
    return study


def channels_of(source: Path | dict[str, Any], runs: Runs) -> list[Samples]:
    """The motion of every run, as the record settings of a study make it; raises as `bodies_of`."""
    where, tree = _read(source, runs)
    files = _files(where, runs)
    motions = _motions(runs)
    settings = {
        f"run {number}": {"file": str(files[name]), "scale": scale}
        for number, (name, scale) in enumerate(motions, start=1)
    }
    first: dict[str, Any] = next(iter(settings.values()))
    study = open_study(
        _without_bodies(tree),
        overrides=[
            ("case.motion.record.file", json.dumps(first["file"])),
            ("vary", as_yaml({_AXIS: settings})),
            ("save", "{histories: false, scalars: [outcome]}"),
        ],
    )
    found: dict[int, Samples] = {}
    for indices, batch in study.batches():
        for row, index in enumerate(np.asarray(indices).tolist()):
            channel = batch.rows(np.array([row])).excitation.horizontal
            assert isinstance(channel, Samples)
            found[index] = channel
    places = {motion: i for i, motion in enumerate(motions)}
    return [found[places[motion]] for motion in zip(runs.record, runs.scale.tolist(), strict=True)]


def _read(source: Path | dict[str, Any], runs: Runs) -> tuple[Source, Map]:
    """The tree of a study, short forms written out, and where it came from; raises as `bodies_of`."""
    tree = expanded(load_mapping(source) if isinstance(source, dict) else load_file(source))
    where = Source(None if isinstance(source, dict) else source)
    if not isinstance(tree.get("case"), Map):
        raise StudyError("the study has no `case`", file=where.file)
    _check(where, tree, runs)
    return where, tree


def _without_bodies(tree: Map) -> dict[str, Any]:
    """A study that reads the motions of another one, whatever its bodies are."""
    record = plain(value_at(tree, ("case", "motion", "record")) or {})
    made = any_body({key: value for key, value in record.items() if key != "file"})
    through = value_at(tree, ("case", "motion", "through"))
    if through is not None:
        made["case"]["motion"]["through"] = plain(through)
    if "g" in tree["case"]:
        made["case"]["g"] = plain(tree["case"]["g"])
    return {**made, "let": plain(tree.get("let") or {})}


def _check(where: Source, tree: Map, runs: Runs) -> None:
    if not runs.record:
        raise StudyError("has no column `record`: a study needs the ground motion of every run", file=runs.file)
    if value_at(tree, ("case", "motion", "pulse")) is not None:
        raise where.error(tree, ("case", "motion", "pulse"), ": the motions are the records of the runs")
    if isinstance(value_at(tree, ("case", "motion", "record", "file")), list):
        raise where.error(tree, ("case", "motion", "record", "file"), "names two components; a run has one record")
    for key in RECORD_SCALINGS:
        if value_at(tree, ("case", "motion", "record", key)) is not None:
            raise where.error(
                tree, ("case", "motion", "record", key), "is that of each run: give it as column `scale` of the runs"
            )
    if value_at(tree, ("case", "motion", "floor_pga")) is not None:
        own = "how strong a run's ground is, its column `scale` says"
        said = f"is one for all: {own}; `floor_scale` multiplies what arrives"
        raise where.error(tree, ("case", "motion", "floor_pga"), said)
    if AMPLITUDE in (tree.get("let") or {}):
        raise where.error(tree, ("let", AMPLITUDE), "is what runs are multiplied by; choose another name")
    if value_at(tree, ("case", "motion", "vertical")) is not None:
        raise where.error(tree, ("case", "motion", "vertical"), ": a run has one horizontal motion")
    for key in ("vary", "uncertain"):
        for path in tree.get(key) or {}:
            keys = str(path).removeprefix("case.").split(".")
            if keys[0] == "motion" and keys != ["motion", "record", "polarity"]:
                raise where.error(
                    tree, (key, path), "varies the motion, which is that of each run; only its polarity may be varied"
                )


def _check_motion(
    source: Path | dict[str, Any], runs: Runs, first: Samples, bodies: tuple[tuple[Index, Batch], ...]
) -> None:
    """`StudyError` unless the first run shakes every body as it would any other."""
    for _, batch in bodies:
        own = batch.excitation.horizontal
        assert isinstance(own, Samples)
        if own.dt == first.dt and np.array_equal(own.values, first.values):
            continue
        where, tree = _read(source, runs)
        raise where.error(
            tree,
            ("case", "motion"),
            "has a record or floors whose numbers follow from the body or from what is varied; "
            "a run has one motion for all bodies, so give plain numbers",
        )


def _motions(runs: Runs) -> list[tuple[str, float]]:
    """Every record with its scale, once."""
    return list(dict.fromkeys(zip(runs.record, runs.scale.tolist(), strict=True)))


def _files(where: Source, runs: Runs) -> dict[str, Path]:
    """The file of every record, searched for as from the study, and then as from the table."""
    found: dict[str, Path] = {}
    beside = [Records(where), Records(Source(runs.file))]
    for name, line in zip(runs.record, runs.line, strict=True):
        if name in found:
            continue
        for number, records in enumerate(beside):
            try:
                found[name] = records.find(name, line).absolute()
                break
            except MissingRecordError as error:
                if number == len(beside) - 1:
                    raise MissingRecordError(error.message, file=runs.file, line=line) from None
    return found


@dataclass(frozen=True, eq=False)
class Shaking:
    """Solves all bodies under the motions of some runs, wherever it is called (`work.Work`).

    Attributes:
        bodies: (cases, batch) of all bodies and amplitudes, k cases, under the motion of the first run.
        motions: of all runs.
        size: k.
    """

    bodies: tuple[tuple[Index, Batch], ...]
    motions: tuple[Samples, ...]
    size: int

    def __call__(self, cases: Index) -> Array:
        """Share of every case that overturns, (runs, k); NaN where there is no answer."""
        with np.errstate(all="ignore"):  # what is not finite is a result
            return np.stack([self._run(self.motions[i]) for i in cases.tolist()])

    def lost(self, cases: Index, why: str) -> Array:
        """No answer; `MachineError` where that is the machine's fault, which says nothing about a body."""
        if isinstance(why, Unsolved):
            raise MachineError(f"the runs are not all solved, because the machine refused: {why}")
        return np.full((len(cases), self.size), np.nan)

    def _run(self, motion: Samples) -> Array:
        share = np.full(self.size, np.nan)
        for places, batch in self.bodies:
            was = batch.excitation.horizontal
            assert isinstance(was, Samples)
            first = self.motions[0].factor
            factor = np.broadcast_to(was.factor, batch.size) / first * motion.factor
            excitation = replace(batch.excitation, horizontal=replace(motion, factor=factor))
            found = choose(batch).load()(replace(batch, excitation=excitation)).scalars
            outcome = np.asarray(found["outcome"])
            certain = np.where(outcome < 0, np.nan, overturned(outcome).astype(float))
            share[places] = found.get("overturn_share", certain)
        return share


def simulate(
    source: Path | dict[str, Any],
    runs: Runs,
    amplitudes: Sequence[float],
    *,
    team: Team | None = None,
    progress: Progress | None = None,
) -> Simulated:
    """Solve the bodies of a study under every run's motion times every amplitude.

    An uncertain outcome counts by the share of its ensemble at a single amplitude; of several, those beside tell it.

    Raises:
        StudyError, RecordError: as `bodies_of`; what becomes of a record hangs on the body or on what is varied.
        SolverError: no solver knows the model.
        MachineError: the machine refused what a run needs.
    """
    study = bodies_of(source, runs, amplitudes)
    channels = channels_of(source, runs)
    places: dict[int, int] = {}
    which = [places.setdefault(id(channel), len(places)) for channel in channels]
    distinct = list({id(channel): channel for channel in channels}.values())
    batches = tuple((np.asarray(indices), batch) for indices, batch in study.batches())
    _check_motion(source, runs, channels[0], batches)
    work = Shaking(batches, tuple(distinct), study.size)
    chunks, share, done = Chunks(len(distinct)), np.empty((len(distinct), study.size)), 0
    for cases, answer in answers(work, chunks, Pace(_SECONDS * study.size, len(distinct)), team or Team()):
        share[cases] = answer
        done += len(cases)
        if progress is not None:
            progress(done, len(distinct))
    inputs, units = _inputs(study)
    return Simulated(
        share=np.moveaxis(share.reshape(len(distinct), len(amplitudes), -1), 1, 2)[which],
        amplitudes=np.asarray(amplitudes, dtype=float),
        inputs=inputs,
        units=units,
        study=study.name,
        identity=_identity(source, study, runs, amplitudes),
    )


def _identity(source: Path | dict[str, Any], study: Study, runs: Runs, amplitudes: Sequence[float]) -> str:
    """What tells whether two tables of runs were solved with the same bodies."""
    tree = expanded(load_mapping(source) if isinstance(source, dict) else load_file(source))
    said = {key: plain(tree[key]) for key in _BODIES if key in tree}
    records = {Path(name).name for name in runs.record}
    inputs = {name: digest for name, digest in study.inputs.items() if Path(name).name not in records}
    content = [as_yaml(said), inputs, [float(value) for value in amplitudes], __version__]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _inputs(study: Study) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
    """What makes the bodies of a study differ, one value per body."""
    own = [axis for axis in study.axes if axis.path != f"let.{AMPLITUDE}"]
    shape = tuple(axis.size for axis in own)
    inputs: dict[str, NDArray[Any]] = {}
    units: dict[str, str] = {}

    def spread(values: NDArray[Any], number: int) -> NDArray[Any]:
        along = values.reshape([-1 if i == number else 1 for i in range(len(shape))])
        return np.broadcast_to(along, shape).ravel()

    for number, axis in enumerate(own):
        if study.uncertain is not None and axis.name == "sample":
            for each in study.uncertain.inputs:
                inputs[each.path], units[each.path] = spread(np.asarray(each.values), number), each.unit
            continue
        values = np.array(axis.values)
        inputs[axis.path], units[axis.path] = spread(values, number), axis.unit if axis.numeric else ""
    return inputs, units
