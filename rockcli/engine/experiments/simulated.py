"""The bodies of a study under the motions of a table of runs: what share of each case overturns."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.experiments.runs import Runs
from rockcli.engine.run import check_answers
from rockcli.engine.sweep.assemble import assemble
from rockcli.engine.sweep.sweep import Progress, Sweep, solve_cases
from rockcli.engine.sweep.work import Team
from rockcli.errors import StudyError
from rockcli.scene.excitation import Samples
from rockcli.storage.contents import Contents
from rockcli.study.building.records import MissingRecordError, Records
from rockcli.study.document.loader import load_file, load_mapping
from rockcli.study.document.shorthands import expanded
from rockcli.study.document.tree import Map, Source, value_at
from rockcli.study.identity import as_yaml, plain
from rockcli.study.open import open_study
from rockcli.study.study import Study
from rockcli.version import __version__

Array = NDArray[np.float64]

AMPLITUDE = "run_amplitude"
"""Symbol of `let` by which the motion of every run is multiplied."""

_AXIS = "motion.record"

_BODIES = ("case", "let", "vary", "uncertain", "samples", "seed", "sampling")

_SCALES = ("scale", "pga", "pgv", "pga_over_g_tan_alpha")


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


def study_of(source: Path | dict[str, Any], runs: Runs, amplitudes: Sequence[float], *, bodies: bool = True) -> Study:
    """A study with the motions of runs, each once, as its outermost axis, and the amplitudes as the next.

    Args:
        source: a study of one rigid body or of several (axes, uncertain inputs), without a scale of its motion.
        runs: with records.
        amplitudes: factors of every motion.
        bodies: keep the axes of the study.

    Raises:
        StudyError, RecordError: the study or a record is wrong; a run's record is named with its line.
    """
    tree = expanded(load_mapping(source) if isinstance(source, dict) else load_file(source))
    where = Source(None if isinstance(source, dict) else source)
    _check(where, tree, runs)
    files = _files(where, runs)
    settings = {
        f"run {number}": {"file": str(files[name]), "scale": f"{scale!r}*{AMPLITUDE}"}
        for number, (name, scale) in enumerate(_motions(runs), start=1)
    }
    first: dict[str, Any] = next(iter(settings.values()))
    vary = plain(tree.get("vary") or {}, nothing=True)
    if not bodies:
        source = _without_bodies(tree)
        tree, vary = Map(source), {}
    motions = {_AXIS: settings, f"let.{AMPLITUDE}": [float(value) for value in amplitudes]}
    overrides = [
        ("let", as_yaml({**plain(tree.get("let") or {}), AMPLITUDE: 1.0})),
        ("case.motion.record.file", as_yaml(first["file"])),
        ("case.motion.record.scale", as_yaml(first["scale"])),
        ("vary", as_yaml({**motions, **vary})),
        ("save", "{histories: false, scalars: [outcome, overturn_share]}"),
        ("plots", "none"),
    ]
    for name in ("expect", "curves", "rules"):
        if tree.get(name):
            overrides.append((name, "[]"))
    for name in ("over", "compare_to", "hazard", "age"):
        if tree.get(name) is not None:
            overrides.append((name, "null"))
    study = open_study(source, overrides=overrides)
    check_answers(study)
    return study


def _without_bodies(tree: Map) -> dict[str, Any]:
    """A study that reads the motions of another one, whatever its bodies are."""
    record = plain(value_at(tree, ("case", "motion", "record")) or {})
    made = any_body({key: value for key, value in record.items() if key != "file"})
    gravity = {"g": tree["case"]["g"]} if "g" in tree["case"] else {}
    return {**made, "case": {**made["case"], **gravity}, "let": plain(tree.get("let") or {})}


def _check(where: Source, tree: Map, runs: Runs) -> None:
    if not runs.record:
        raise StudyError("has no column `record`: a study needs the ground motion of every run", file=runs.file)
    if value_at(tree, ("case", "motion", "pulse")) is not None:
        raise where.error(tree, ("case", "motion", "pulse"), ": the motions are the records of the runs")
    if isinstance(value_at(tree, ("case", "motion", "record", "file")), list):
        raise where.error(tree, ("case", "motion", "record", "file"), "names two components; a run has one record")
    for key in _SCALES:
        if value_at(tree, ("case", "motion", "record", key)) is not None:
            raise where.error(
                tree, ("case", "motion", "record", key), "is that of each run: give it as column `scale` of the runs"
            )
    if AMPLITUDE in (tree.get("let") or {}):
        raise where.error(tree, ("let", AMPLITUDE), "is what runs are multiplied by; choose another name")
    for path in tree.get("vary") or {}:
        keys = str(path).removeprefix("case.").split(".")
        if keys[:2] == ["motion", "record"] and (len(keys) == 2 or keys[2] in (*_SCALES, "file")):
            raise where.error(tree, ("vary", path), "is an axis of motions: they are the records of the runs")


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


def simulate(
    source: Path | dict[str, Any],
    runs: Runs,
    amplitudes: Sequence[float],
    *,
    team: Team | None = None,
    progress: Progress | None = None,
) -> Simulated:
    """Solve the bodies of a study under every run's motion times every amplitude; raises as `study_of`."""
    study = study_of(source, runs, amplitudes)
    with np.errstate(all="ignore"):  # what is not finite is a result
        contents = assemble(study, solve_cases(study, sweep=Sweep(team or Team(), progress=progress)))
    places = {motion: i for i, motion in enumerate(_motions(runs))}
    which = [places[motion] for motion in zip(runs.record, runs.scale.tolist(), strict=True)]
    share = np.asarray(contents.values("overturn_share"), dtype=float)
    first, second = (_axis(study, path) for path in (_AXIS, f"let.{AMPLITUDE}"))
    share = np.moveaxis(share, (first, second), (0, -1))
    inputs, units = _inputs(study, contents)
    return Simulated(
        share=share.reshape(len(places), -1, len(amplitudes))[which],
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


def _axis(study: Study, path: str) -> int:
    return next(i for i, axis in enumerate(study.axes) if axis.path.removeprefix("case.") == path)


def _inputs(study: Study, contents: Contents) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
    """What makes the bodies of a study differ, one value per body."""
    own = [axis for axis in study.axes if axis.path.removeprefix("case.") not in (_AXIS, f"let.{AMPLITUDE}")]
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
        values = np.asarray(contents.values(axis.name))
        inputs[axis.path], units[axis.path] = spread(values, number), axis.unit if axis.numeric else ""
    return inputs, units


def motions_of(source: Path | dict[str, Any], runs: Runs) -> Iterator[tuple[Array, float]]:
    """Acceleration (k,) [m/s²] and dt [s] of every run's motion, as a study with this record setting processes it."""
    study = study_of(source, runs, [1.0], bodies=False)
    found: dict[int, tuple[Array, float]] = {}
    for indices, batch in study.batches():
        channel = batch.excitation.horizontal
        assert isinstance(channel, Samples)
        for row, index in enumerate(np.asarray(indices).tolist()):
            found[index] = channel.values * float(np.broadcast_to(channel.factor, batch.size)[row]), channel.dt
    places = {motion: i for i, motion in enumerate(_motions(runs))}
    for motion in zip(runs.record, runs.scale.tolist(), strict=True):
        yield found[places[motion]]
