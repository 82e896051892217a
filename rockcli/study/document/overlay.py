"""Lays settings (of an axis, a named setting, `--set`) over a case and merges them: one rule, `laid`.

A mapping is laid over what stands at its place key by key, at every level; anything else (a number, a word, a list)
takes the place of what stands there, a word also of the mapping that it is short for.  null takes a key away.
A key overrides those that it cannot stand beside (`displaced`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from rockcli.scene.ground.amplitudes import FLOOR_SCALINGS, PULSE_AMPLITUDES, PULSE_FREQUENCIES, RECORD_SCALINGS
from rockcli.scene.ground.pulses import SHAPES
from rockcli.scene.laws.damping import SCHEMES
from rockcli.study.document.shorthands import expanded
from rockcli.study.document.tree import Map, Where
from rockcli.study.schema import OUTLINES

Path = tuple[str, ...]

Setting = tuple[Path, Any, Where]
"""A value to put at a path of a study, and where it comes from."""

ALTERNATIVES: tuple[frozenset[str], ...] = (
    frozenset({"pulse", "record"}),
    frozenset(PULSE_AMPLITUDES),
    frozenset(PULSE_FREQUENCIES),
    frozenset(RECORD_SCALINGS),
    frozenset(FLOOR_SCALINGS),
    frozenset({"eta", "r_energy", "loss"}),
    frozenset({"alpha", "tan_alpha", "slenderness"}),
    frozenset({"h", "height"}),
    frozenset({"b", "width"}),
    frozenset({"inertia", "r_g"}),
    frozenset(OUTLINES),
)
"""Keys of one mapping that say the same thing in different ways."""

SIZES: tuple[frozenset[str], ...] = (
    frozenset({"R"}),
    frozenset({"h", "height"}),
    frozenset({"b", "width"}),
    frozenset({"alpha", "tan_alpha", "slenderness"}),
)
"""Sizes of a body, two of which say all of them."""

_FILES = frozenset({"file", "record", "outline", "mesh"})
"""Keys whose words are names of files."""

_ALL_SIZES = frozenset().union(*SIZES)
_OF_OUTLINE = frozenset({"pixel", "z_down", "contacts", "centre"})
_OF_MESH = frozenset({"units", "direction"})

KINDS: dict[str, dict[str, tuple[str, ...]]] = {
    "scheme": {name: tuple(key.name for key in scheme.keys) for name, scheme in SCHEMES.items()},
    "law": {"rigid": (), "winkler": ("kw", "fibres")},
    "shape": {name: shape.options for name, shape in SHAPES.items()},
}
"""A key that names a kind -> what only some kinds take beside it."""


def alternatives(key: str) -> frozenset[str]:
    """The other keys of the same mapping that a key stands for."""
    return next((group - {key} for group in ALTERNATIVES if key in group), frozenset())


def sizes_of(block: dict[str, Any]) -> list[frozenset[str]]:
    """Which sizes of a body a mapping says."""
    said = {key for key, value in block.items() if value is not None}
    return [size for size in SIZES if said & size]


def displaced(over: dict[str, Any]) -> set[str]:
    """Keys that go where a mapping is laid over them, unless it says them itself.

    These are the alternatives of its keys; other sizes, plane and outline of a body of which it gives two sizes; sizes,
    inertia and plane of a body of which it gives the outline; and what the kind that it names does not take.
    """
    said = {key for key, value in over.items() if not _is_nothing(value)}
    gone = {other for key in said for other in alternatives(key)}
    if len(sizes_of(over)) >= 2:
        gone |= _ALL_SIZES | {*OUTLINES} | {"density", "depth"} | _OF_OUTLINE | _OF_MESH | {"stands"}
        gone |= set() if "depth" in said else {"plane"}
    if said & {*OUTLINES}:
        gone |= _ALL_SIZES | {"inertia", "r_g", "centre", "plane"}
    if "mesh" in said:
        gone |= _OF_OUTLINE | {"depth"}
    elif said & {*OUTLINES}:
        gone |= _OF_MESH
    if "parts" in said:
        gone |= {"density", "depth"}
    for key in said & KINDS.keys():
        takes = KINDS[key].get(str(over[key]))
        gone |= set() if takes is None else {k for keys in KINDS[key].values() for k in keys} - set(takes)
    return gone - over.keys()


def _is_nothing(value: Any) -> bool:
    """Whether a value takes away alone: null, or a mapping of nulls, as cells of a table are."""
    if isinstance(value, Map) and value and not value.whole:
        return all(map(_is_nothing, value.values()))
    return value is None


def laid(tree: dict[str, Any], over: Map) -> Map:
    """A copy of `tree` with a mapping laid over it; parts that do not change are shared.

    Both are studies, or the same mapping of two studies, with the short forms written out.
    """
    return _laid(tree, over, symbols=False)


def _laid(tree: dict[str, Any], over: Map, *, symbols: bool) -> Map:
    gone = set() if symbols else displaced(over)  # own symbols stand for nothing but themselves
    copy = Map({key: value for key, value in tree.items() if key not in gone}, getattr(tree, "where", None))
    copy.whole = getattr(tree, "whole", False)
    for key, value in over.items():
        if value is None:  # `null` takes a key away: what stands there by default counts
            copy.pop(key, None)
            copy.where[key] = over.where.get(key)  # of what is said of it
        elif isinstance(value, Map) and not value.whole:
            below = copy.get(key)
            if not isinstance(below, dict):
                if _is_nothing(value):
                    continue
                below, copy.where[key] = {}, over.where.get(key)
            copy[key] = _laid(below, value, symbols=key == "let")
        else:
            copy[key], copy.where[key] = value, over.where.get(key)
    return copy


def overlaid(study: dict[str, Any], *points: Sequence[Setting]) -> Map:
    """A study with the settings of several points (one of each axis) laid over it, shorter paths first.

    Settings of one point inside one mapping are one mapping: `block.h` and `block.b` are two sizes of a body.
    """
    return _together(study, [piece for point in points for piece in _pieces(point)])


_Piece = tuple[int, Map]
"""Length of a path, and a study that has only what is set there."""


def _pieces(point: Sequence[Setting]) -> list[_Piece]:
    inside: dict[Path, Map] = {}
    for path, value, where in point:
        mapping = inside.setdefault(path[:-1], Map())
        mapping[path[-1]], mapping.where[path[-1]] = value, where
    return [(len(path), expanded(_at(path, mapping))) for path, mapping in inside.items()]


def _together(study: dict[str, Any], pieces: Iterable[_Piece]) -> Map:
    result = Map(study, getattr(study, "where", None))
    for _, piece in sorted(pieces, key=lambda p: p[0]):
        result = laid(result, piece)
    return result


def _at(path: Path, mapping: Map) -> Map:
    """A mapping that stands at a path."""
    where = next(iter(mapping.where.values()), None)
    for key in reversed(path):
        mapping = Map({key: mapping}, {key: where})
    return mapping


def leaves(tree: Any, at: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Path and value of all that a tree says: neither mappings nor nothing."""
    if isinstance(tree, dict):
        for key, item in tree.items():
            yield from leaves(item, (*at, key))
    elif tree is not None:
        yield at, tree


class _Mark:
    """Stands for a value of a study, to see whether it is still there when something has been laid over."""

    def __init__(self, path: Path) -> None:
        self.path = path


def remaining(study: dict[str, Any], points: Iterable[Sequence[Setting]]) -> set[Path]:
    """Paths of what a study says that is left in the cases of at least one point of an axis."""
    marked = _marked(study)
    return {path for point in of_each_form(points).values() for path in _marks(overlaid(marked, point))}


def left_beside(point: Sequence[Setting], points: Iterable[Sequence[Setting]], *, later: bool) -> set[Path]:
    """Paths of what a point of an axis says that is left beside at least one point of another axis.

    `later`: whether the other axis stands after it in the study.
    """
    own = [(length, _marked(piece)) for length, piece in _pieces(point)]
    others = map(_pieces, points)
    return {path for of in others for path in _marks(_together({}, [*own, *of] if later else [*of, *own]))}


def of_each_form(points: Iterable[Sequence[Setting]]) -> dict[Any, Sequence[Setting]]:
    """The first point of each form; points of one form, which differ in numbers and names of files, leave the same."""
    found: dict[Any, Sequence[Setting]] = {}
    for point in points:
        found.setdefault(form(point), point)
    return found


def form(point: Sequence[Setting]) -> Any:
    """What a point says without its numbers and names of files."""
    return tuple((path, _form(path[-1], value)) for path, value, _ in point)


def _form(key: str, value: Any) -> Any:
    if isinstance(value, dict):
        return tuple((name, _form(name, item)) for name, item in value.items())
    return value if isinstance(value, str) and key not in _FILES else type(value)


def _marks(tree: Map) -> set[Path]:
    return {value.path for _, value in leaves(tree) if isinstance(value, _Mark)}


def _marked(tree: dict[str, Any], at: Path = ()) -> Map:
    return Map(
        {
            key: _marked(item, (*at, key)) if isinstance(item, dict) else None if item is None else _Mark((*at, key))
            for key, item in tree.items()
        }
    )


def same_twice(paths: Sequence[Path], *, inside: bool = False) -> tuple[int, int] | None:
    """Places of the first two paths that are equal or say the same thing in two ways; None if there are none.

    `inside`: or that lie inside two keys that cannot stand together, as those of a pulse and of a record.
    """
    for j, path in enumerate(paths):
        for i, other in enumerate(paths[:j]):
            k = next((k for k, (a, b) in enumerate(zip(path, other, strict=False)) if a != b), None)
            if k is None:
                if path == other:
                    return i, j
            elif path[0] != "let" and other[k] in alternatives(path[k]) and (inside or path[:-1] == other[:-1]):
                return i, j
    return None
