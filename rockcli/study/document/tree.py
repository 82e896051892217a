"""The YAML tree of a study file, with the line and column of every value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from rockcli.errors import RecordError, StudyError
from rockcli.scene.likeness import as_read
from rockcli.study.inputs import Inputs

Where = int | str | None
"""A line of the study file, the `--set` that put the value there, or None for a study given as a mapping."""

Keys = tuple[str | int, ...]
"""Path from the top of a study: ("case", "block", "R"), ("vary", "block.R", 2)."""


LONGEST = 2000
"""Characters of an error message: a key may be as long as a file."""

MOST_NAMES = 30
"""Known names listed in a message."""

_COMPARED = 80
"""Characters of a key that are compared with known ones."""


class Map(dict[str, Any]):
    """A mapping that knows where its keys stand.

    `whole` where it is written out from a word (`damping: none`, `motion: null`), which stands for all of it.
    """

    __slots__ = ("where", "whole")

    def __init__(
        self, items: dict[str, Any] | None = None, where: dict[str, Where] | None = None, *, whole: bool = False
    ) -> None:
        super().__init__(items or {})
        self.where: dict[str, Where] = dict(where or {})
        self.whole = whole


class List(list[Any]):
    """A list that knows where its items stand."""

    __slots__ = ("where",)

    def __init__(self, items: Iterable[Any] = (), where: Iterable[Where] = ()) -> None:
        super().__init__(items)
        self.where: list[Where] = list(where)


@dataclass(frozen=True)
class Places:
    """Place in the study file of every point of an axis; `beyond` is that of points that have none of their own."""

    points: tuple[Where, ...] = ()
    beyond: Where = None

    def __call__(self, i: int) -> Where:
        """Place of point i."""
        return self.points[i] if i < len(self.points) else self.beyond


@dataclass(frozen=True)
class Source:
    """Where a study came from, and the files it reads; makes the errors that name file, line and key."""

    file: Path | None
    inputs: Inputs = field(default_factory=Inputs, compare=False)

    @property
    def folder(self) -> Path:
        """The folder that relative files are sought from."""
        return Path() if self.file is None else self.file.parent

    def error(self, tree: Any, keys: Keys, message: str) -> StudyError:
        """`message` about the value at `keys`, which is put in front of it."""
        return self.placed(place(tree, keys), f"{dotted(keys)}{'' if message.startswith(':') else ' '}{message}")

    def placed(self, where: Where, message: str) -> StudyError:
        """An error at a known place."""
        file, line = self._spot(where)
        return StudyError(message if len(message) <= LONGEST else message[:LONGEST] + " ...", file=file, line=line)

    def record_error(self, where: Where, message: str, kind: type[RecordError] = RecordError) -> RecordError:
        """An error about a record, at the place of the study that asks for it."""
        file, line = self._spot(where)
        return kind(message, file=file, line=line)

    def words(self, where: Where) -> str:
        """A place as `study.yaml:5`, from the folder of the study on; "" where there is none."""
        if isinstance(where, str):
            return where.removeprefix(str(self.folder / "_").removesuffix("_"))
        if where is None or self.file is None:
            return ""
        return f"{Path(self.file).name}:{where}"

    def _spot(self, where: Where) -> tuple[str | Path | None, int | None]:
        if isinstance(where, str):
            return where, None
        return self.file, where


def dotted(keys: Keys) -> str:
    """A path as people write it: case.block.b[0]."""
    text = ""
    for key in keys:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text


def place(tree: Any, keys: Keys) -> Where:
    """Place of the value at `keys`, or of the nearest value around it that has one."""
    found: Where = None
    for key in keys:
        if isinstance(tree, Map) and isinstance(key, str) and key in tree:
            found = tree.where.get(key, found)
        elif isinstance(tree, List) and isinstance(key, int) and key < len(tree):
            found = tree.where[key] if key < len(tree.where) and tree.where[key] is not None else found
        else:
            break
        tree = tree[key]
    return found


def value_at(tree: Any, keys: Keys) -> Any:
    """The value at `keys`; None where there is none."""
    for key in keys:
        if isinstance(tree, dict):
            tree = tree.get(key)
        elif isinstance(tree, list) and isinstance(key, int) and key < len(tree):
            tree = tree[key]
        else:
            return None
    return tree


def put_at(tree: Any, keys: tuple[str, ...], value: Any) -> Any:
    """A copy of a tree with another value at `keys`, which are there; parts that do not change are shared."""
    if not keys:
        return value
    copy = Map(tree, tree.where, whole=tree.whole)
    copy[keys[0]] = put_at(tree[keys[0]], keys[1:], value)
    return copy


def meant(key: str, known: Iterable[str]) -> str | None:
    """The known key nearest to what is written, or that begins with it and `_`, as T_p of T; None if none is near."""
    lowered = {name.lower(): name for name in reversed(list(known))}
    word = as_read(key[:_COMPARED])
    alike = [name for name in lowered if as_read(name[:_COMPARED]) == word] if len(key) <= _COMPARED else []
    if alike:
        return lowered[alike[-1]]
    longer = [name for name in lowered if name.startswith(f"{key.lower()}_")]
    if longer and key.lower() not in lowered:
        return lowered[longer[-1]]
    close = get_close_matches(key[:_COMPARED].lower(), lowered, n=1, cutoff=0.55)
    return lowered[close[0]] if close else None


def nearest(key: str, known: Iterable[str]) -> str:
    """A hint with the nearest known key, or all of them: a clause to put at the end of a message."""
    names = list(known)
    close = meant(key, names)
    if close is not None:
        return f"did you mean {close!r}?"
    shown = ", ".join(sorted(names)[:MOST_NAMES]) + (", ..." if len(names) > MOST_NAMES else "")
    return f"known: {shown}" if shown else "nothing is known here"
