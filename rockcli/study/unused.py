"""Warnings about what has no use in a study: keys nobody reads, symbols, what axes leave out or override."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from rockcli.scene.backends import AUTOMATIC, BACKENDS, EVENT, automatic
from rockcli.study.cases.variation import Variation
from rockcli.study.document.expressions import ExpressionError, parse
from rockcli.study.document.overlay import (
    Path,
    Setting,
    alternatives,
    form,
    leaves,
    left_beside,
    of_each_form,
    overlaid,
    remaining,
)
from rockcli.study.document.tree import Map, Source, dotted, place, value_at
from rockcli.study.schema import ExpectPart, SolverPart
from rockcli.study.study import Expect

_LABELS = 5
"""Points of an axis that a warning names."""


def unused_solver_keys(solver: SolverPart, model: str, geometry: str | None, scheme: str) -> list[str]:
    """A sentence per key of `solver` that the backend, or the one that `auto` takes, does not read."""
    backend = solver.backend
    taken = automatic(model, geometry, scheme) if backend == AUTOMATIC else BACKENDS[backend]
    chosen = taken or BACKENDS[EVENT]
    row = chosen.of_model(model)
    name = chosen.name if row is chosen else f"{chosen.name} ({model})"
    by = f"backend {name}{', which auto takes' if backend == AUTOMATIC else ''}"
    uses = f"it uses {', '.join(row.reads)}" if row.reads else "it uses none of these keys"
    said = (key for key in SolverPart.model_fields if key != "backend" and key in solver.model_fields_set)
    given = [key for key in said if getattr(solver, key) is not None]
    return [f"solver.{key} is ignored by {by}: {uses}" for key in given if key not in row.reads]


def unused_symbols(study: Map, variations: Iterable[Variation]) -> list[str]:
    """A sentence per symbol of `let` that no expression of the cases needs, directly or through other symbols."""
    let = study.get("let") or {}
    variations = list(variations)
    used = set(names_in(study.get("case")))
    used |= set(names_in(study.get("vary")))
    varied: dict[str, list[Any]] = {name: [text] for name, text in let.items()}
    for variation in variations:
        if variation.path[0] == "let":
            varied.setdefault(variation.path[1], [])
        for point in variation.settings or variation.points():
            for path, value, _ in point:
                if path[0] == "let":
                    varied.setdefault(path[1], []).append(value)
                else:
                    used |= set(names_in(value))
    waiting = [name for name in varied if name in used]
    while waiting:
        for name in names_in(varied[waiting.pop()]):
            if name in varied and name not in used:
                waiting.append(name)
            used.add(name)
    return [f"let.{name} is used nowhere" for name in varied if name not in used]


def unused_tolerances(source: Source, study: Map, clauses: Iterable[Expect]) -> list[str]:
    """A sentence per tolerance of a clause of `expect` that has no `value`, unless it is the default."""
    said = []
    for i, clause in enumerate(clauses):
        for key in ("rtol", "atol"):
            given = clause.check != "value" and getattr(clause, key) != ExpectPart.model_fields[key].default
            if given:
                where = source.words(place(study, ("expect", i)))
                at = f" ({where})" if where else ""
                said.append(f"{dotted(('expect', i, key))} has no effect{at}: it is for `value`, not `{clause.check}`")
    return said


def rules_without_friction(study: Map, variations: Iterable[Variation], rules: Iterable[str]) -> list[str]:
    """A sentence where a rule about sliding is asked for and no case has a friction."""
    if "asce43_sliding" not in rules or _says_friction(value_at(study, ("case", "block"))):
        return []
    for variation in variations:
        for point in variation.points():
            if any("mu" in path or _says_friction(value) for path, value, _ in point):
                return []
    return ["rules: asce43_sliding says nothing without block.mu, which no case has"]


def _says_friction(value: Any) -> bool:
    return isinstance(value, dict) and (value.get("mu") is not None or any(map(_says_friction, value.values())))


def saved_beside_a_search(study: Map, variations: Iterable[Variation]) -> list[str]:
    """A sentence where histories or scalars are asked for beside a search, which has none."""
    if not any(variation.find for variation in variations):
        return []
    save = study.get("save") or {}
    asked = [f"save.{key}" for key in ("histories", "scalars") if save.get(key)]
    return [f"{key} has no effect: a search (`find`) keeps the values it finds alone" for key in asked]


def replaced_records(study: Map, variations: Iterable[Variation]) -> list[str]:
    """A sentence where an axis over whole records drops what the base case says of its record."""
    said = []
    for at in (("case", "motion", "record"), ("case", "motion", "vertical", "record")):
        base = value_at(study, at) or {}
        lost = " and ".join(f"`{key}`" for key, value in base.items() if key != "file" and value is not None)
        for variation in variations:
            # what is set below the record leaves the record; most points of an axis do no more
            reaching = (point for point in variation.points() if any(len(path) <= len(at) for path, _, _ in point))
            records = (value_at(overlaid({}, point), at) for point in reaching)
            if lost and any(isinstance(record, Map) and record.whole for record in records):
                path, key = variation.axis.path, ".".join((*at[1:], "file"))
                said.append(f"the axis {path} replaces the whole record, {lost} with it; {key} changes the file only")
    return said


def alternatives_left_out(study: Map, variations: Sequence[Variation]) -> list[str]:
    """A sentence where the base case says two things of which a case has one, and an axis of one drops the other."""
    said = []
    for at, both in _said_together(study, ()):
        for variation in variations:
            forms = of_each_form(variation.points()).values()
            left = remaining(study, forms) | {path for point in forms for path, _ in leaves(overlaid({}, point))}
            gone = [key for key in both if not any(path[: len(at) + 1] == (*at, key) for path in left)]
            if gone and len(gone) < len(both):
                (key,) = {*both} - {*gone}
                said.append(
                    f"{'.'.join((*at, gone[0]))} has no effect: the axis {variation.axis.path} is of {key}, beside "
                    f"which {gone[0]} cannot stand; leave one of them out of the base case"
                )
    return said


def strengths_left_out(study: Map, variations: Iterable[Variation]) -> list[str]:
    """A sentence where an axis says a factor, and the base case a strength that it might be taken to multiply."""
    said = []
    variations = list(variations)
    for at, factor in _FACTORS:
        base = value_at(study, at) or {}
        strength = next((key for key in base if key in alternatives(factor) and base[key] is not None), None)
        for variation in variations:
            if strength is not None and any(path == (*at, factor) for path in _said(of_each_form(variation.points()))):
                name, whole = (".".join((*at[1:], key)) for key in (strength, factor))
                axis = f"the axis {variation.axis.path}" + (f", of {whole}" if variation.axis.path != whole else "")
                said.append(
                    f"{name} of the base case counts for nothing beside {axis}: its factors are on the motion as is; "
                    f"vary {strength}, or a symbol k of `let` in `{strength}: k*...`"
                )
    return said


def overridden_by_options(said: Map, study: Map, settings: Iterable[Setting]) -> list[str]:
    """A sentence per `--set` that drops what the study file says of a record, or a strength beside a factor.

    `said`: what the file says; `study`: what it comes to, in which nothing of it is left or was set again.
    """
    found = []
    for keys, value, label in settings:
        one = overlaid({}, [(keys, value, label)])
        for at in (("case", "motion", "record"), ("case", "motion", "vertical", "record")):
            record, now = (value_at(tree, at) for tree in (one, study))
            gone = _gone(value_at(said, at), now)
            if gone and len(keys) <= len(at) and isinstance(record, Map) and record.whole:
                keys_lost, file = " and ".join(f"`{key}`" for key in gone), ".".join((*at, "file"))
                found.append(f"{label} replaces the whole record, {keys_lost} with it; {file} changes the file only")
        for of_motion, factor in _FACTORS:
            taken = all(value_at(tree, (*of_motion, factor)) is not None for tree in (one, study))
            lost = _gone(value_at(said, of_motion), value_at(study, of_motion))
            strengths = [key for key in lost if key in alternatives(factor)]
            if taken and strengths and not any(str(label) in sentence for sentence in found):
                name = ".".join((*of_motion[1:], strengths[0]))
                found.append(
                    f"{name} of the study counts for nothing beside {label}: its factor is on the motion as is"
                )
    return found


def _gone(before: Any, now: Any) -> list[str]:
    """Keys of a mapping, but that of the file, of which nothing is left."""
    left = now if isinstance(now, dict) else {}
    said = before.items() if isinstance(before, dict) else ()
    return [key for key, value in said if key != "file" and value is not None and left.get(key) is None]


_FACTORS = (
    (("case", "motion", "record"), "scale"),
    (("case", "motion", "vertical", "record"), "scale"),
    (("case", "motion"), "floor_scale"),
)
"""Where a study says factors on motions, beside which strengths may not stand."""


def _said_together(tree: Map, at: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], tuple[str, str]]]:
    """Mappings of a tree, by their keys, and two keys in them that are alternatives."""
    given = [key for key, value in tree.items() if value is not None]
    for i, key in enumerate(given):
        yield from ((at, (key, other)) for other in given[i + 1 :] if other in alternatives(key))
        if isinstance(tree[key], dict) and (at or key == "case"):
            yield from _said_together(tree[key], (*at, key))


def overridden_axes(variations: Sequence[Variation]) -> list[str]:
    """A sentence per axis of which other axes leave nothing, at all of its points or at some of them.

    And one per key that points of an axis say beside others, as a column of a table, and of which nothing is left; not
    of one number that complete settings have and another axis varies.
    """
    said = []
    forms = [of_each_form(variation.points()) for variation in variations]
    by_path = {variation.axis.path: points for variation, points in zip(variations, forms, strict=True)}
    for i, variation in enumerate(variations):
        found = {each: _left(variations, forms, i, point) for each, point in forms[i].items()}
        lost = {each: by for each, (left, by) in found.items() if by and not left}
        if lost:
            said.append(_nothing_left(variation, len(forms[i]), lost))
        some = [(left, by) for left, by in found.values() if left]
        kept = set().union(*(left for left, _ in some))
        for path, others in sorted({path: axes for _, by in some for path, axes in by.items()}.items()):
            same = any(path == one for axis in others for one in _said(by_path[axis]))
            if path not in kept and not (same and len({repr(value) for value in _values(variation, path)}) == 1):
                said.append(
                    f"{'.'.join(path[path[0] == 'case' :])} of the axis {variation.axis.path} has no effect: it is "
                    f"overridden by {' and '.join(others)}; leave one of the two out"
                )
    return said


def _said(forms: dict[Any, Sequence[Setting]]) -> Iterator[Path]:
    """Paths of all that points say."""
    for point in forms.values():
        yield from (path for path, _ in leaves(overlaid({}, point)))


def _values(variation: Variation, path: Path) -> Iterator[Any]:
    """What the points of an axis say at a path."""
    if path in (variation.columns or ()):
        values = (variation.columns or {})[path]
        yield from values[np.isfinite(values)].tolist()
        return
    for point in variation.points():
        yield from (value for one, value in leaves(overlaid({}, point)) if one == path)


def _nothing_left(variation: Variation, forms: int, lost: dict[Any, dict[Path, list[str]]]) -> str:
    others = " and ".join(dict.fromkeys(axis for by in lost.values() for axes in by.values() for axis in axes))
    whose = f"the axis {variation.axis.path}"
    if len(lost) < forms:
        points = zip(variation.axis.values, variation.settings, strict=True)
        labels = [repr(value) for value, point in points if form(point) in lost]
        more = f" and {len(labels) - _LABELS} more" if len(labels) > _LABELS else ""
        whose = f"{', '.join(labels[:_LABELS])}{more} of {whose}"
    return f"nothing is left of {whose}: all of it is overridden by {others}; leave one of the axes out"


def _left(
    variations: Sequence[Variation], forms: Sequence[dict[Any, Sequence[Setting]]], i: int, point: Sequence[Setting]
) -> tuple[set[Path], dict[Path, list[str]]]:
    """Paths of what a point of axis i says that are left in some case, and by the others the axes that override them.

    Axes behind the one that leaves nothing are not asked.
    """
    every = left = left_beside(point, [()], later=True)
    by: dict[Path, list[str]] = {}
    for j, other in enumerate(variations):
        if j != i and left:
            beside = left_beside(point, forms[j].values(), later=j > i)
            for path in sorted(every - beside):
                by.setdefault(path, []).append(other.axis.path)
            left = left & beside
    return left, by


def names_in(value: Any) -> Iterator[str]:
    """Names in every text of a tree that is an expression."""
    if isinstance(value, dict):
        for item in value.values():
            yield from names_in(item)
    elif isinstance(value, list):
        for item in value:
            yield from names_in(item)
    elif isinstance(value, str):
        try:
            yield from parse(value).names
        except ExpressionError:
            return
