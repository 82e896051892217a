"""Reuses results when axes of a study have got more points: solved cases are not solved again."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from rockcli.engine.sweep.chunk_result import ChunkResult
from rockcli.scene.variables import GROUND, HISTORIES, IMPACTS
from rockcli.storage import on_disk
from rockcli.storage.contents import Contents
from rockcli.study.study import Index, Study


def reuse_results(study: Study, old: Contents) -> Iterator[ChunkResult] | None:
    """The answers that a dataset has for cases of a study, some at a time; None if it is not of the same numbers.

    It is if case, let, save, version and the kinds of axes are the same, and every point of its axes, with the bytes
    of its record, is among the study's points.
    """
    places = _places(study, old)
    if places is None:
        return None
    size = int(np.prod(old.shape, dtype=np.int64))
    firsts = range(0, size, on_disk.BLOCK)
    return (_answer(study, old, places, np.arange(i, min(i + on_disk.BLOCK, size))) for i in firsts)


def _answer(study: Study, old: Contents, places: list[Any], theirs: Index) -> ChunkResult:
    """The answers of some flat cases of a dataset, as those of the study."""
    points = np.unravel_index(theirs, old.shape)
    mine = np.ravel_multi_index([of[at] for of, at in zip(places, points, strict=True)], study.shape)
    order = np.argsort(mine)
    cases = mine[order].astype(np.int64)

    def rows(name: str) -> Any:
        values = old.values(name)
        return values.reshape(-1, *values.shape[len(places) :])[theirs[order]]

    answer = ChunkResult(cases, {name: rows(name) for name in study.scalars if name != "reason"})
    if "reason" in old.fields:
        codes, sentences = rows("reason"), old.values("reasons")
        answer.sentences = {str(sentences[code]): cases[codes == code] for code in np.unique(codes) if code}
    answer.used = [(int(cases[0]), one) for one in json.loads(old.attrs.get("solver_settings", "[]"))]
    if "time" in old.fields:
        answer.time = old.values("time")
    answer.histories = {name: rows(name) for name in HISTORIES if name in old.fields and name not in GROUND}
    answer.shaken = {name: np.isfinite(rows(name)).sum(axis=1) for name in GROUND if name in old.fields}
    answer.impacts = {name: rows(name) for name in IMPACTS if name in old.fields}
    return answer


def _places(study: Study, old: Contents) -> list[Any] | None:
    """Of every axis, where the points of a dataset stand among those of a study; None if it is not of its kind."""
    theirs = json.loads(old.attrs.get("sweep_id") or old.attrs.get("kinship") or "null")
    mine = json.loads(study.sweep_id or "null")
    if mine is None or theirs is None or not study.axes or study.search is not None or mine["base"] != theirs["base"]:
        return None
    if [(name, path) for name, path, _, _ in mine["axes"]] != [(name, path) for name, path, _, _ in theirs["axes"]]:
        return None
    if {*study.scalars} - old.fields.keys():
        return None
    places = []
    for axis, (_, _, wanted, _), (_, _, given, _) in zip(study.axes, mine["axes"], theirs["axes"], strict=True):
        if (wanted is None) != (given is None):
            return None
        here = {point: i for i, point in enumerate(_apart(axis.values if wanted is None else wanted))}
        there = _apart(old.values(axis.name).tolist() if given is None else given)
        if not here.keys() >= set(there):
            return None
        places.append(np.array([here[point] for point in there]))
    return places


def _apart(points: Iterable[Any]) -> list[tuple[Any, int]]:
    """Points, each with how many like it came before: two of one content, as two equal cabinets, are two places."""
    seen: Counter[Any] = Counter()
    apart = []
    for point in points:
        apart.append((point, seen[point]))
        seen[point] += 1
    return apart
