"""Reads YAML with the scalars of YAML 1.2, every line kept, and nothing that could do harm.

PyYAML follows YAML 1.1: it reads `1e-3` as a string, `on` as true, `12:30` as 750, `010` as 8, and lets the last
of two equal keys win.  Here the nodes are PyYAML's and the values are not.
"""

from __future__ import annotations

import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from rockcli.errors import StudyError, is_file
from rockcli.study.document.tree import Keys, List, Map, Source, Where, dotted
from rockcli.study.inputs import MAX_BYTES, read_bytes

NAMES = ("name", "title", "references")
"""Keys of a study that are text, also where it reads as a number: `name: 007`."""

MAX_DEPTH = 40
MAX_VALUES = 200_000

TOO_DEEP = f"nested too deeply (at most {MAX_DEPTH} levels)"
TOO_MANY = f"more than {MAX_VALUES} values"

_INT = re.compile(r"[-+]?[0-9]{1,18}\Z")
_HEX = re.compile(r"0(x[0-9a-fA-F]{1,15}|o[0-7]{1,20})\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_SPECIAL = {".inf": np.inf, "+.inf": np.inf, "-.inf": -np.inf, ".nan": np.nan}
_WORDS = {"": None, "~": None, "null": None, "true": True, "false": False}
_CASES = {word for word in _WORDS if word} | {w.capitalize() for w in _WORDS} | {w.upper() for w in _WORDS}


PLAIN, TEXT, COLLECTION = "plain", "text", "collection"
ALLOWED = {PLAIN, TEXT, COLLECTION, *(f"tag:yaml.org,2002:{kind}" for kind in ("str", "seq", "map"))}
"""Tags of nodes: those without a tag of their own, and the harmless ones one may write."""


_NO_BREAK = "\N{NO-BREAK SPACE}"
"""Comes with text from web pages; to YAML it is a letter."""

_INDENTED = (
    "expected <block end>, but found '<block mapping start>'",
    "expected <block end>, but found '<block sequence start>'",
    "expected <block end>, but found '-'",
    "expected <block end>, but found '?'",
    "expected <block end>, but found '<scalar>'",
)
"""What PyYAML says of a line that is indented wrongly."""


class _Nodes(yaml.SafeLoader):
    """PyYAML's nodes; the tags it guesses are not used."""

    def resolve(self, kind: Any, value: Any, implicit: Any) -> str:
        """Tag of a node that has none of its own."""
        return PLAIN if kind is yaml.ScalarNode and implicit[0] else TEXT if kind is yaml.ScalarNode else COLLECTION


def load_file(path: Path) -> Map:
    """Read a study file into a `Map`.

    Raises:
        StudyError: it cannot be read, is no YAML, is empty, is too large or too deep, has a duplicate key.
    """
    if path.suffix.lower() in (".nc", ".nc4") and is_file(path):
        raise StudyError("is a dataset, not a study: `rock table`, `rock plot` and `rock report` read it", path)
    value = load_any(path)
    if value is None:
        raise StudyError("the study is empty; at least `name` and `case` are needed", file=path)
    if not isinstance(value, Map):
        hint = f"; is *{path.suffix} a study?" if path.suffix.lower() not in (".yaml", ".yml") else ""
        raise StudyError(f"a study is a mapping with the keys `name`, `case`, ...{hint}", file=path, line=1)
    return value


def load_any(path: Path) -> Any:
    """Read a YAML file of any form; raises StudyError like `load_file`."""
    data = read_bytes(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        what = f"is no UTF-8 text (byte {error.start})"
        if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
            what = "is UTF-16 text, as some programs on Windows write it: save it as UTF-8"
        raise StudyError(what, file=path, line=line) from None
    return _parse(text, Source(path), None)


def load_value(text: str, label: str, *, named: bool = False) -> Any:
    """Read the value of a `--set`, whose place is `label`; `StudyError` if it is no YAML.  `named`: of one of NAMES."""
    if len(text) > MAX_BYTES:
        raise StudyError("the value is too long", file=label)
    value = _parse(text, Source(None), label)
    return text.strip() if named and type(value) in (int, float) else value


def load_mapping(value: Any) -> Map:
    """A study given as a mapping, copied; `StudyError` for what YAML could not hold."""
    count = [0]
    copied = _plain(value, (), count)
    if not isinstance(copied, Map):
        raise StudyError("a study is a mapping with the keys `name`, `case`, ...")
    return copied


def check_depth(study: Any) -> None:
    """`StudyError` for a mapping that is nested too deeply, as one that holds itself is; numbers do not count."""
    left, count = [(study, 0)], 0
    while left:
        value, depth = left.pop()
        count += 1
        if depth > MAX_DEPTH:
            raise StudyError(TOO_DEEP)
        if count > MAX_VALUES:
            raise StudyError(TOO_MANY)
        inside = value.values() if isinstance(value, dict) else value
        left += [(item, depth + 1) for item in inside if isinstance(item, dict | list | tuple)]


def _parse(text: str, source: Source, label: str | None) -> Any:
    loader = None
    try:
        loader = _Nodes(text)
        node = loader.get_single_node()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark is not None else None
        problem = (error.problem or error.context or "not YAML").strip()
        if "\\t" in problem:
            problem = "a tab where only spaces are allowed: indent with spaces"
        elif problem in _INDENTED:
            problem = "this line is not indented as its neighbours: keys of one mapping begin in the same column"
        elif problem.startswith("mapping values are not allowed"):
            problem = (
                "a key where a value goes: is this line indented too far, does the line before it end too early, or "
                "does a text with `: ` want quotes?"
            )
        elif problem.startswith("found unknown escape character"):
            problem = "a backslash in double quotes: write / in names of files, or put the text into single quotes"
        elif problem.startswith("could not find expected ':'"):
            problem = "a key without `: ` and a value, or a line that is not indented as its neighbours"
        no_break = next((n for n, row in enumerate(text.splitlines()[:line], 1) if f":{_NO_BREAK}" in row), None)
        if no_break is not None:
            line, problem = no_break, "a no-break space behind the colon: type a plain one"
        raise source.placed(label or line, f"not YAML: {problem}") from None
    except yaml.reader.ReaderError as error:
        found = yaml.reader.Reader.NON_PRINTABLE.search(text)
        line = text.count("\n", 0, found.start()) + 1 if found else None
        what = f"the character {found[0]!r} is not allowed" if found else error.reason
        raise source.placed(label or line, f"not YAML: {what}") from None
    except yaml.YAMLError as error:
        raise source.placed(label, f"not YAML: {' '.join(str(error).split())[:200]}") from None
    except RecursionError:
        raise source.placed(label, f"nested too deeply (at most {MAX_DEPTH} levels)") from None
    except (ValueError, OverflowError, IndexError, AttributeError) as error:  # PyYAML on hostile directives
        raise source.placed(label, f"not YAML: {str(error)[:200]}") from None
    finally:
        if loader is not None:
            loader.dispose()
    return None if node is None else _Builder(source, label).value(node, 0)


class _Builder:
    """Turns nodes into values; counts them, so that aliases cannot multiply without end."""

    def __init__(self, source: Source, label: str | None) -> None:
        self.source, self.label, self.count = source, label, 0

    def place(self, node: yaml.Node) -> Where:
        return self.label or node.start_mark.line + 1

    def value(self, node: yaml.Node, depth: int) -> Any:
        self.count += 1
        if depth > MAX_DEPTH:
            raise self.source.placed(self.place(node), f"nested too deeply (at most {MAX_DEPTH} levels)")
        if self.count > MAX_VALUES:
            raise self.source.placed(self.place(node), f"more than {MAX_VALUES} values (repeated by aliases?)")
        if node.tag not in ALLOWED:
            raise self.source.placed(self.place(node), f"the tag {node.tag!r} is not allowed here")
        if isinstance(node, yaml.MappingNode):
            return self.mapping(node, depth)
        if isinstance(node, yaml.ScalarNode) and (why := _unfit(node.value)):
            raise self.source.placed(self.place(node), why)
        if isinstance(node, yaml.SequenceNode):
            return List([self.value(n, depth + 1) for n in node.value], [self.place(n) for n in node.value])
        return scalar(str(node.value)) if node.tag == PLAIN else str(node.value)

    def mapping(self, node: yaml.MappingNode, depth: int) -> Map:
        result = Map()
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise self.source.placed(self.place(key_node), "a key is a word, not a list or a mapping")
            key = key_node.value
            if f":{_NO_BREAK}" in key or key.strip(_NO_BREAK) != key:
                raise self.source.placed(self.place(key_node), f"{key!r} has a no-break space: type a plain one there")
            if why := _unfit(key):
                raise self.source.placed(self.place(key_node), why)
            if key in result:
                first = result.where[key]
                raise self.source.placed(self.place(key_node), f"duplicate key {key!r} (first on line {first})")
            result[key] = self.value(value_node, depth + 1)
            if depth == 0 and key in NAMES and type(result[key]) in (int, float):
                result[key] = str(value_node.value)
            result.where[key] = self.place(key_node)
        return result


def scalar(text: str) -> Any:
    """A plain scalar by the core schema of YAML 1.2: null, bool, int, float or str."""
    if text == "" or text == "~" or text in _CASES:
        return _WORDS[text.lower()]
    if _INT.match(text):
        return int(text)
    if _HEX.match(text):
        return int(text, 0)
    if _FLOAT.match(text):
        return float(text)
    return _SPECIAL.get(text.lower(), text)


def _unfit(text: str) -> str:
    """What no text may hold, also where it is written as an escape: what YAML refuses as it is; "" if all is well."""
    found = yaml.reader.Reader.NON_PRINTABLE.search(text)
    return f"the character {found[0]!a} is not allowed" if found else ""


def _plain(value: Any, keys: Keys, count: list[int]) -> Any:
    """What stands at some keys."""
    count[0] += 1
    if len(keys) > MAX_DEPTH:
        raise StudyError(TOO_DEEP)
    if count[0] > MAX_VALUES:
        raise StudyError(TOO_MANY)
    for text in value if isinstance(value, dict) else (value,):
        if isinstance(text, str) and (why := _unfit(text)):
            raise StudyError(f"{text[:100]!a}: {why}")
    if isinstance(value, dict):
        items = Map({str(key): _plain(item, (*keys, str(key)), count) for key, item in value.items()})
        if len(items) < len(value):
            ((twice, _),) = Counter(map(str, value)).most_common(1)
            raise StudyError(f"{dotted((*keys, twice))}: duplicate key {twice!r}: a number and its text are one")
        return items
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple | range):
        return List([_plain(item, (*keys, i), count) for i, item in enumerate(value)])
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Path):
        return str(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    what = "a complex number" if isinstance(value, complex) else f"a {type(value).__name__}"
    where = f"{dotted(keys)}: " if keys else ""
    raise StudyError(f"{where}a study holds real numbers, text, lists and mappings, not {what}")
