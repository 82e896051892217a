"""The outline of a body: polygons of the study or of CSV files, with their densities, to a solid."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import StudyError, is_file
from rockcli.scene.body.outline import Given, OutlineError, Solid, solid
from rockcli.scene.counted import counted
from rockcli.study.building.numbers import Numbers
from rockcli.study.document.expressions import UNITS, Value
from rockcli.study.document.tree import Keys, dotted, place
from rockcli.study.document.values import LENGTHS
from rockcli.study.inputs import text_of
from rockcli.study.schema import OUTLINES, BlockPart

Array = NDArray[np.float64]

BLOCK: Keys = ("case", "block")

SAID_BY_OUTLINE = ("R", "h", "b", "height", "width", "alpha", "tan_alpha", "slenderness", "inertia", "plane")
"""Keys of a block that follow from its outline."""

_HEAD = re.compile(r"([xyz])[\s_]*[\[(]?\s*([a-z]*)\s*[\])]?", re.I)
"""The name of a column of an outline, with its unit if it says one."""

_UNITS = re.compile(r"units?\s*[:=]\s*([a-z]+)", re.I)


def has_outline(block: BlockPart) -> bool:
    """Whether a block is given by polygons, or by the surface of which its outline is the projection."""
    return any(getattr(block, key) is not None for key in OUTLINES)


def check_no_mesh(numbers: Numbers, block: BlockPart) -> None:
    """Refuse what belongs to a mesh in a block that has none."""
    for key in ("units", "direction"):
        if getattr(block, key) is not None:
            numbers.fail((*BLOCK, key), "belongs to a mesh")


def build_solid(numbers: Numbers) -> tuple[Solid, bool]:
    """The bodies that the outline or the parts of a block describe, and whether their mass is known.

    Raises:
        StudyError: keys that the outline contradicts, a polygon that is none, a file that cannot be read, parts that
            overlap or of which only some have a density, a body that cannot stand.
    """
    block = numbers.case.block
    for key in SAID_BY_OUTLINE:
        if getattr(block, key) is not None:
            numbers.fail((*BLOCK, key), "follows from the outline; leave one of the two out")
    if (block.r_g is None) != (block.centre is None):
        key, other = ("r_g", "centre") if block.centre is None else ("centre", "r_g")
        numbers.fail((*BLOCK, key), f"follows from the outline; leave it out, or give {other} beside it")
    check_no_mesh(numbers, block)
    several = block.parts is not None
    if several:
        for key in ("outline", "density", "depth"):
            if getattr(block, key) is not None:
                numbers.fail((*BLOCK, key), "is given beside parts, each of which has its own")
    at = [(*BLOCK, "parts", j) for j in range(len(block.parts))] if block.parts is not None else [BLOCK]
    densities = [numbers.positive((*keys, "density")) for keys in at]
    known = [density is not None for density in densities]
    if any(known) and not all(known):
        numbers.fail(at[known.index(False)], "has no density, and other parts have one")
    if all(known) and block.mass is not None:
        numbers.fail((*BLOCK, "mass"), "and density say the same thing; leave one out")
    weights = [
        numbers.array(_or_one(density)) * _or_one(numbers.positive((*keys, "depth")))
        for keys, density in zip(at, densities, strict=True)
    ]
    unit = _or_one(numbers.positive((*BLOCK, "pixel")))
    turned = np.array([1.0, -1.0 if block.z_down else 1.0])
    size = numbers.array(unit)[:, None, None] * turned
    polygons = [np.ascontiguousarray(_polygon(numbers, (*keys, "outline")) * size) for keys in at]
    contacts = None if block.contacts is None else _contacts(numbers) * size
    if contacts is not None and block.stands == "settled":
        numbers.fail((*BLOCK, "stands"), "settled and contacts both say on what it stands; leave one out")
    settle, rolls = block.stands == "settled", block.stands != "toes" and contacts is None
    try:
        body, clockwise = _solid(polygons, weights, contacts, _given(numbers, size), settle=settle, rolls=rolls)
    except OutlineError as error:
        part = 0 if error.part is None and not several else error.part
        numbers.fail((*BLOCK, "parts") if part is None else (*at[part], "outline"), str(error))
    for j in () if block.z_down else clockwise:
        name = dotted((*at[j], "outline"))
        numbers.remarks.append(f"{name}: its points run clockwise; taken the other way round, the body is the same")
    return body, all(known)


def _solid(
    polygons: list[Array],
    weights: list[Array],
    contacts: Array | None,
    given: Given | None,
    *,
    settle: bool,
    rolls: bool,
) -> tuple[Solid, tuple[int, ...]]:
    """`solid`, of one body for all cases where they all have the same: half of what they are made of is checks."""
    said = [*polygons, *weights, *([] if contacts is None else [contacts])]
    said += [] if given is None else [given.centre, given.r_g]
    n = len(weights[0])
    if n == 1 or not all(bool((array == array[:1]).all()) for array in said):
        return solid(polygons, weights, contacts, given, settle=settle, rolls=rolls)
    one, clockwise = solid(
        [points[:1] for points in polygons], [weight[:1] for weight in weights],
        None if contacts is None else contacts[:1],
        None if given is None else Given(given.centre[:1], given.r_g[:1]), settle=settle, rolls=rolls,
    )  # fmt: skip
    every: dict[str, Any] = {}
    for field in fields(one):
        values = getattr(one, field.name)
        every[field.name] = None if values is None else np.broadcast_to(values, (n, *values.shape[1:]))
    return Solid(**every), clockwise


def _or_one(value: Value | None) -> Value:
    return 1.0 if value is None else value


def _polygon(numbers: Numbers, keys: Keys) -> Array:
    """Points of a polygon in every case, (n, k, 2) [m]; a last point that repeats the first is left out."""
    said = numbers.said(keys)
    if isinstance(said, str):
        read = _from_file(numbers, keys, said)
        points = np.broadcast_to(read, (numbers.n, *read.shape))
    else:
        rows = []
        for i in range(len(said)):
            pair = [numbers.value((*keys, i, j)) for j in (0, 1)]
            rows.append(np.stack([numbers.array(0.0 if c is None else c) for c in pair], axis=1))
        points = np.stack(rows, axis=1)
    numbers.require(keys, np.isfinite(points).all(axis=2), "needs finite numbers")
    closed = points.shape[1] > 1 and bool((points[:, 0] == points[:, -1]).all())
    return np.ascontiguousarray(points[:, :-1] if closed else points)


def _given(numbers: Numbers, size: Array) -> Given | None:
    """Centre of mass and radius of gyration of a body for which its outline does not tell them."""
    r_g = numbers.positive((*BLOCK, "r_g"))
    if r_g is None:
        return None
    pair = [numbers.value((*BLOCK, "centre", j)) for j in (0, 1)]
    centre = np.stack([numbers.array(0.0 if c is None else c) for c in pair], axis=1) * size[:, 0]
    return Given(centre, numbers.array(r_g))


def _contacts(numbers: Numbers) -> Array:
    """The two points a body stands on in every case, (n, 2, 2), in the coordinates of its outline."""
    rows = [[numbers.value((*BLOCK, "contacts", i, j)) for j in (0, 1)] for i in (0, 1)]
    pairs = [np.stack([numbers.array(0.0 if c is None else c) for c in row], axis=1) for row in rows]
    points = np.stack(pairs, axis=1)
    numbers.require((*BLOCK, "contacts"), np.isfinite(points).all(axis=2), "needs finite numbers")
    return points


def _from_file(numbers: Numbers, keys: Keys, name: str) -> Array:
    """Points of a CSV file beside the study, (k, 2) [m]: x, z on every line; a first line of words and # lines pass."""
    where = place(numbers.tree, keys)
    path = numbers.source.folder / name
    if not is_file(path):
        raise numbers.source.placed(where, f"{dotted(keys)}: the outline {str(path)[:300]} does not exist")
    lines = text_of(numbers.source.inputs.read(name, path), path).splitlines()
    points: list[list[float]] = []
    heads = 0
    for number, line in enumerate(lines, start=1):
        text, _, comment = map(str.strip, line.partition("#"))
        if not text:
            if not points:
                _check_head(numbers, comment.replace(";", ",").split(","), path, number)
            continue
        cells = [cell.strip() for cell in text.replace(";", ",").split(",")]
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            row = []
        if not row and not points and not heads:
            heads += 1
            _check_head(numbers, cells, path, number)
            continue
        if len(row) != 2 or not np.isfinite(row).all():
            raise StudyError(f"a line of an outline is x, z [m], not {text[:60]!r}", file=path, line=number)
        points.append(row)
    if len(points) < 3:
        raise StudyError(f"the outline has {counted(len(points), 'point')}; a polygon has at least 3", file=path)
    return np.array(points)


def _check_head(numbers: Numbers, cells: Sequence[str], path: Path, line: int) -> None:
    """Refuse names of columns, or `units: cm`, that say other columns than x, z, or another unit than `pixel`."""
    named = [match for cell in cells if (match := _HEAD.fullmatch(cell.strip('" ')))]
    names = [match[1].lower() for match in named]
    if names in (["z", "x"], ["y", "x"]):
        raise StudyError(f"its head names {', '.join(names)}; an outline is x, z", file=path, line=line)
    metres = _or_one(numbers.positive((*BLOCK, "pixel")))
    units = [match[1] for cell in cells if (match := _UNITS.fullmatch(cell))]
    for said in map(str.lower, [*(match[2] for match in named), *units]):
        unit = UNITS["inch" if said == "in" else said] if said in (*LENGTHS, "in") else None
        if unit is not None and not np.allclose(metres, unit, rtol=1e-9):
            do = "leave `pixel` out" if unit == 1.0 else f"give `pixel: {unit:g}`"
            raise StudyError(f"its head says {said}, the study another unit: {do}", file=path, line=line)
