"""The axes of a study: from the entries of `vary` to coordinates and what each puts into a case."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from pathlib import PurePosixPath
from typing import Any, NamedTuple, TypeGuard
from unicodedata import category

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import StudyError
from rockcli.scene.laws.damping import HOUSNER
from rockcli.study.building.body import HEIGHT, UNEVEN
from rockcli.study.building.matching import WILDCARDS
from rockcli.study.building.numbers import in_words
from rockcli.study.building.records import MissingRecordError, Records
from rockcli.study.cases.file_names import LABELS, names_in
from rockcli.study.cases.table import NOTE, Table, given_by, read_table
from rockcli.study.cases.variation import Variation, is_record, numbers_of
from rockcli.study.document.complaints import Complaints
from rockcli.study.document.dimensions import check_unit
from rockcli.study.document.expressions import CONSTANTS, Expression, ExpressionError, constant, parse
from rockcli.study.document.overlay import Setting, leaves, same_twice
from rockcli.study.document.paths import UNITS, Path, dimension_names, is_path, resolve, takes_number, varies_in_batch
from rockcli.study.document.tree import List, Map, Places, Source, Where, meant, nearest, place, put_at, value_at
from rockcli.study.document.values import WEAKEST, describe, is_finite, number_or_expression
from rockcli.study.schema import CasePart, StudyPart
from rockcli.study.study import MATCH, Axis, Given

MAX_POINTS = 10_000_000
MAX_CASES = 2**40

UNFIT = ("Cc", "Cs", "Zl", "Zp")
"""Categories of characters that no label may hold: control characters, lone surrogates, ends of lines."""

RANGE = ("from", "to", "n", "spacing", "find")

RANGE_DEFAULTS: dict[str, Any] = {"spacing": "linear", "find": None}

RANGE_FORM = "{from, to, n, spacing: linear | log}"

IN_OTHER_WORDS = {
    **dict.fromkeys(("start", "begin", "first", "min"), "from"),
    **dict.fromkeys(("stop", "end", "last", "max"), "to"),
    **dict.fromkeys(("num", "number", "count", "points"), "n"),
    **dict.fromkeys(("scale", "step", "space"), "spacing"),
}
"""What other programs call the keys of a range."""

_SHEETS = (".xlsx", ".xlsm", ".xls", ".ods")
"""Endings of what a list of bodies may be kept in, and which is not read."""

_SYMBOL_PATHS = (("case", "block"), ("case", "g"))
"""What the symbols of expressions come from, beside `let`."""

Evaluate = Callable[[str], float]


class _NeedsCase(Exception):  # noqa: N818 (no error: a sign that an axis has to wait for the others)
    """An expression of an axis speaks of the case."""


def read_axes(
    source: Source, study: Map, part: StudyPart, records: Records, evaluator: Callable[[list[Variation]], Evaluate]
) -> list[Variation]:
    """The axes of a study, outermost first.

    `evaluator(axes)` gives a function that evaluates an expression which is the same at all points of these axes
    and raises ExpressionError if it is not.

    Raises:
        StudyError: an unknown path, an entry that is none of the forms, no points, points that repeat.
    """
    vary = part.vary
    complaints = Complaints()
    read: dict[str, _Reader] = {}
    done: dict[str, Variation] = {}
    for text in vary:
        with complaints.gathered(), suppress(_NeedsCase):
            read[text] = _Reader(source, study, text, records)
            done[text] = read[text].read()
    complaints.tell(MissingRecordError)
    waiting = {text: reader for text, reader in read.items() if text not in done}
    first = [text for text, reader in waiting.items() if reader.of_symbols]
    for some in (first, [text for text in waiting if text not in first]):  # what the others may speak of comes first
        evaluate = evaluator(list(done.values())) if some else None
        for text in some:
            waiting[text].evaluate = evaluate
            done[text] = waiting[text].read()
    variations = [done[text] for text in vary]
    names = dimension_names(list(vary))
    for name in sorted(names_in(study["case"]) - set(names)):
        raise source.error(
            study, ("case",), f"has a file name with {{{name}}}, which is no axis; {nearest(name, names)}"
        )
    _check_apart(source, study, variations, names)
    total = float(np.prod([float(v.size) for v in variations]))
    if total > MAX_CASES:
        raise source.error(study, ("vary",), f"makes {total:.3g} cases, more than {MAX_CASES:.3g}")
    variations = [replace(v, axis=replace(v.axis, name=n)) for v, n in zip(variations, names, strict=True)]
    filled = names_in(study) | names_in([value for v in variations for point in v.points() for _, value, _ in point])
    variations = [
        replace(v, columns=None, first_but_for_record=None) if v.settings and v.axis.name in filled else v
        for v in variations
    ]
    g = _constant_g(study, variations)
    return variations if g is None else [_with_g(v, g, alone=v.axis.name in filled) for v in variations]


def _constant_g(study: Map, variations: list[Variation]) -> float | None:
    """The g of all cases, where it is one number."""
    if value_at(study, ("uncertain", "g")) is not None or any(map(_says_g, variations)):
        return None
    said = study["case"].get("g")
    try:
        return float(parse(str(CasePart.model_fields["g"].default if said is None else said)).evaluate(constant))
    except ExpressionError:
        return None


def _with_g(variation: Variation, g: float, *, alone: bool) -> Variation:
    """An axis with what its points and the columns of its table say in terms of g as numbers.

    `alone`: whether its points need a batch each in any case.
    """
    given = tuple(_numbers_with(given, g) or given for given in variation.axis.given)
    told = replace(variation, axis=replace(variation.axis, given=given))
    texts = any(
        isinstance(value, str) and varies_in_batch(path)
        for point in variation.settings
        for path, value, _ in numbers_of(point)
    )
    if alone or variation.axis.numeric or not texts:
        return told
    found = columns_of(variation.settings, partial(as_number, lookup=_lookup(g)))
    return replace(
        told, columns=found.columns, first_alike=found.first_alike, first_but_for_record=found.first_but_for_record
    )


def _lookup(g: float) -> Callable[[str], float]:
    """The lookup of an expression in terms of units and g."""
    return lambda name: g if name == "g" else float(constant(name))


def _says_g(variation: Variation) -> bool:
    """Whether an axis, or a setting of one of its points, changes g."""
    points = variation.settings or variation.points()
    return any(
        path[:2] == ("case", "g") or (path == ("case",) and isinstance(value, Map) and "g" in value)
        for point in points
        for path, value, _ in point
    )


def _numbers_with(given: Given, g: float) -> Given | None:
    """A column of texts, some of them expressions of g, as numbers; None if it is none of them."""
    inside = tuple(given.path.split("."))
    path: Path = inside if inside[0] == "let" else ("case", *inside)
    if given.values.dtype.kind == "f" or given.name.startswith("note_") or not varies_in_batch(path):
        return None

    try:
        said = [parse(str(text)) if text else None for text in given.values]
        if any(one is not None and not one.names <= CONSTANTS.keys() | {"g"} for one in said):
            return None
        values = [np.nan if one is None else float(one.evaluate(_lookup(g))) for one in said]
    except ExpressionError:
        return None
    return Given(given.name, given.path, np.array(values), UNITS.get(path[-1], "1"))


class Columns(NamedTuple):
    """What of a `Variation` its points say in numbers; `words`: whether they say more, words and mappings."""

    columns: dict[Path, NDArray[np.float64]] | None
    first_alike: NDArray[np.int64] | None
    first_but_for_record: NDArray[np.int64] | None
    words: bool


def columns_of(settings: Sequence[tuple[Setting, ...]], number_of: Callable[[Path, Any], Any]) -> Columns:
    """The numbers of the points of an axis as columns, where some points differ in no more, or in a record beside."""
    rows: list[dict[Path, float]] = []
    first: dict[Any, int] = {}
    first_but_for_record: dict[Any, int] = {}
    alike = np.empty((2, len(settings)), dtype=np.int64)
    words = False
    for i, point in enumerate(settings):
        numbers, others, records = {}, [], []
        for path, value, _ in numbers_of(point):
            number = number_of(path, value)
            if varies_in_batch(path) and type(number) in (int, float) and is_finite(number):
                numbers[path] = float(number)
            elif is_record(path, value):
                records.append((path, value))
            else:
                others.append((path, repr(value)))
        rows.append(numbers)
        form = tuple(sorted(numbers)), tuple(sorted(others)), tuple(path for path, _ in records)
        alike[:, i] = first.setdefault((form, tuple(records)), i), first_but_for_record.setdefault(form, i)
        words = words or bool(others or records) or any(isinstance(value, Map) for _, value, _ in point)
    if 1 < len(first_but_for_record) == len(settings):
        return Columns(None, None, None, words)
    but_for_record = alike[1] if len(first_but_for_record) < len(first) else None
    paths = list(dict.fromkeys(path for i in first.values() for path in rows[i]))
    if not paths:
        return Columns(None, None, but_for_record, words)
    columns = {path: np.full(len(rows), np.nan) for path in paths}
    for i, row in enumerate(rows):
        for path, number in row.items():
            columns[path][i] = number
    return Columns(columns, None if len(first) == 1 else alike[0], but_for_record, words)


def as_number(path: Path, value: Any, lookup: Callable[[str], Any] = constant) -> Any:
    """A constant expression as its number, so that named numbers stay columns."""
    if isinstance(value, str) and varies_in_batch(path):
        try:
            check_unit(value, path)
            return parse(value).evaluate(lookup)
        except ExpressionError:  # a case tells it
            return value
    return value


def _why_it_cannot_wait(let: Map | None, text: str) -> str:
    why = "expected numbers or expressions of numbers, units and a constant g: other expressions depend on it"
    own = [] if let is None else sorted(parse(text).names & let.keys())
    if own:
        why += f" (`{own[0]}` is a symbol of `let`, which axes of the block, of g and of let cannot use)"
    return why


def _is_table(entry: Any) -> TypeGuard[str]:
    """Whether an entry of `vary` names a table."""
    return isinstance(entry, str) and entry.lower().endswith(".csv") and not set(entry) & WILDCARDS


def _check_apart(source: Source, study: Map, variations: list[Variation], names: list[str]) -> None:
    """Refuse axes of one name, and axes that set the same thing."""
    for name, variation in zip(names, variations, strict=True):
        if names.count(name) > 1:
            keys = ("vary", variation.axis.path)
            raise source.error(study, keys, f"has the same dimension name as another axis, {name!r}")
    if (twice := same_twice([v.path for v in variations])) is not None:
        other, axis = (variations[i].axis.path for i in twice)
        raise source.error(study, ("vary", axis), f"and the axis {other} say the same thing in two ways")


class _Reader:
    """Reads one entry of `vary`."""

    def __init__(self, source: Source, study: Map, text: str, records: Records) -> None:
        self.source, self.study, self.text, self.records = source, study, text, records
        self.evaluate: Evaluate | None = None
        try:
            if text.startswith("case."):
                raise StudyError(f"paths of axes begin inside the case: {text.removeprefix('case.')!r}")
            self.path = (LABELS, text) if not is_path(text) and text in self.in_braces() else resolve(text)
        except StudyError as error:
            if value_at(study, ("let", text)) is not None:
                message = f"vary: {text!r} is a symbol of `let`; did you mean 'let.{text}'?"
                raise source.placed(place(study, ("vary", text)), message) from None
            if study["vary"][text] is None and "did you mean" not in error.message:
                message = f"vary: {text!r} has no values: several of one axis stand in brackets, PATH: [1, 2]"
                raise source.placed(place(study, ("vary", text)), message) from None
            if (name := meant(text, self.in_braces() - study["vary"].keys())) is not None:
                known = "is not a path inside the case, and no file name has it in braces"
                message = f"vary: {text!r} {known}; did you mean {name!r}?"
                raise source.placed(place(study, ("vary", text)), message) from None
            several = (
                ""
                if "." in text or "did you mean" in error.message
                else "; settings that change several keys at once go under the axis `case`"
            )
            raise source.placed(place(study, ("vary", text)), f"vary: {error.message}{several}") from None

    def in_braces(self) -> set[str]:
        """Names in braces in the names of files, those in the cells of tables too."""
        cells = []
        for text, entry in self.study["vary"].items():
            if _is_table(entry):
                with suppress(StudyError):  # its own axis tells what is wrong with it
                    cells.append(read_table(entry, self.source, place(self.study, ("vary", text))).rows)
        return names_in([self.study["case"], self.study["vary"], cells])

    @property
    def of_symbols(self) -> bool:
        """Whether expressions of other axes and of the case may speak of what the axis changes."""
        return self.path[:2] in _SYMBOL_PATHS or self.path[0] == "let" or self.path == ("case",)

    @property
    def fills_in(self) -> bool:
        """Whether names of files in the study may have its labels filled in, so that each point has its own."""
        return bool({*dimension_names([self.text]), self.text.replace(".", "_")} & names_in(self.study))

    def of_g_alone(self, expression: Expression) -> bool:
        """Whether an expression speaks of nothing of the case but g, which is a number there."""
        given = self.study["case"].get("g")
        constant_g = not isinstance(given, str) or parse(given).names <= CONSTANTS.keys()
        return expression.names <= CONSTANTS.keys() | {"g"} and constant_g and self.path != ("case", "g")

    def fail(self, message: str, *more: str | int) -> StudyError:
        return self.source.error(self.study, ("vary", self.text, *more), message)

    def read(self) -> Variation:
        entry = self.study["vary"][self.text]
        if self.path[0] == LABELS:
            return self.of_names(entry)
        if isinstance(entry, List):
            return self.listed(entry)
        if isinstance(entry, Map):
            return self.range(entry) if entry.keys() & set(RANGE) else self.named(entry)
        if _is_table(entry):
            return self.table(entry)
        if isinstance(entry, str) and self.is_file:
            return self.matched(entry)
        if isinstance(entry, str) and entry.lower().endswith(_SHEETS):
            raise self.fail(f"is {describe(entry)}: save its sheet as CSV in UTF-8, commas between the cells")
        expected = (
            "a list, a range {from, to, n, spacing}, named settings {label: value}, a CSV file or a glob of records"
        )
        raise self.fail(f"is {describe(entry)}; expected {expected}")

    def of_names(self, entry: Any) -> Variation:
        """An axis that is only names, which stand in names of files; of a glob what its `*` stands for."""
        line = place(self.study, ("vary", self.text))
        if isinstance(entry, str) and entry.count("*") == 1:
            before, after = entry.split("*")
            names = self.records.match(f"vary.{self.text}", entry, line)
            entry = List([name[len(before) : len(name) - len(after)] for name in names], [line] * len(names))
        if not isinstance(entry, List) or not all(isinstance(name, str | int) for name in entry):
            expected = "a list of names, as it fills in the name of a file, or a glob with one `*`"
            raise self.fail(f"is {describe(entry)}; expected {expected}")
        where = Places(tuple(entry.where))
        settings: list[tuple[Setting, ...]] = [((self.path, str(name), where(i)),) for i, name in enumerate(entry)]
        return self.labelled([str(name) for name in entry], settings, where)

    @property
    def is_file(self) -> bool:
        return self.path[-1] in ("file", "record")

    def listed(self, values: List) -> Variation:
        if not values:
            raise self.fail("has no values")
        if len(values) > MAX_POINTS:
            raise self.fail(f"has more than {MAX_POINTS} values")
        where = Places(tuple(values.where))
        numbers = self.numbers(values)
        if numbers is not None:
            return self.numeric(numbers, where)
        settings = [self.put(v, where(i), i) for i, v in enumerate(values)]
        texts = [v if isinstance(v, str) else json.dumps(v, default=str) for v in values]
        if self.is_file and all(isinstance(v, str | list) for v in values):
            both = [[v] if isinstance(v, str) else [str(name) for name in v] for v in values]
            names = [" + ".join(PurePosixPath(name).name for name in pair) for pair in both]
            if len(set(names)) == len(names):
                return self.labelled(names, settings, where, files=tuple(texts))
        return self.labelled(texts, settings, where)

    def numbers(self, values: List) -> NDArray[np.float64] | None:
        """The values as numbers; None if they are not all numbers or constant expressions."""
        if self.path == ("case", "model"):
            return None
        found = []
        for i, value in enumerate(values):
            number = self.number(value, i)
            if number is None:
                return None
            found.append(number)
        return np.array(found)

    def number(self, value: Any, *more: str | int) -> float | None:
        """One value as a number; None if it is none."""
        if isinstance(value, str) and takes_number(self.path) and value not in (HOUSNER, WEAKEST):
            value = self.evaluated(value, *more)
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        if not is_finite(value):
            raise self.fail(f"is {value}: a finite number is expected", *more)
        return float(value)

    def evaluated(self, text: str, *more: str | int) -> float:
        """The value of an expression, the same in all cases.

        Raises:
            StudyError: it is no expression, or differs from case to case.
            _NeedsCase: it speaks of the case, and the other axes have not been read yet.
        """
        try:
            expression = parse(text)
            if expression.names <= CONSTANTS.keys():
                value = float(expression.evaluate(constant))
                check_unit(text, self.path)
                return value
            if self.of_symbols and not self.of_g_alone(expression):
                raise self.fail(f"is {describe(text)}; {_why_it_cannot_wait(self.study.get('let'), text)}", *more)
            if self.evaluate is None:
                raise _NeedsCase
            value = self.evaluate(text)
            check_unit(text, self.path, self.study.get("let"))
            return value
        except ExpressionError as error:
            raise self.fail(f": {in_words(self.path, text, str(error))}", *more) from None

    def numeric(self, values: NDArray[np.float64], where: Callable[[int], Where]) -> Variation:
        unit = UNITS.get(self.path[-1], "1") if self.path[0] != "let" else "1"
        axis = Axis(self.text, self.text, tuple(values.tolist()), True, unit)
        ordered = np.sort(values)
        gaps = np.diff(ordered)
        if (gaps == 0.0).any():
            raise self.fail("repeats a value")
        close = gaps <= MATCH * np.maximum(np.abs(ordered[1:]), np.abs(ordered[:-1]))
        if close.any():
            a, b = (repr(float(ordered[int(np.argmax(close)) + k])) for k in (0, 1))
            raise self.fail(f"has two values that cannot be distinguished, {a} and {b} (they are matched to {MATCH:g})")
        in_batch = varies_in_batch(self.path)
        settings = () if in_batch else tuple(self.put(v, where(i), i) for i, v in enumerate(axis.values))
        return Variation(axis, self.path, settings, {self.path: values} if in_batch else None, where)

    def labelled(
        self,
        labels: list[str],
        settings: list[tuple[Setting, ...]],
        where: Callable[[int], Where],
        table: str | None = None,
        files: tuple[str, ...] = (),
        given: tuple[Given, ...] = (),
    ) -> Variation:
        if not labels:
            raise self.fail("has no values")
        if len(set(labels)) < len(labels):
            twice = next(label for label in labels if labels.count(label) > 1)
            raise self.fail(f"repeats {twice!r}")
        for label in labels:
            if odd := [character for character in label if category(character) in UNFIT]:
                raise self.fail(
                    f"has the label {label[:100]!a}: {odd[0]!a} is no character of a label, which is a line"
                )
        axis = Axis(self.text, self.text, tuple(labels), False, files=files, given=given)
        if self.fills_in:
            return Variation(axis, self.path, tuple(settings), None, where, table)
        columns, first_alike, first_but_for_record, words = columns_of(settings, as_number)
        kept = () if columns and first_alike is None and not words else tuple(settings)
        return Variation(axis, self.path, kept, columns, where, table, None, False, first_alike, first_but_for_record)

    def put(self, value: Any, where: Where, *more: str | int) -> tuple[Setting, ...]:
        """What one point puts into a case."""
        if self.path != ("case",) and not (isinstance(value, Map) and any("." in key for key in value)):
            return ((self.path, self.checked(self.path, value, *more), where),)
        if not isinstance(value, Map):
            raise self.fail(f"is {describe(value)}; expected a mapping of keys of the case", *more)
        paths = [self.below(key, *more) for key in value]
        point = tuple(
            (path, self.checked(path, item, *more, key), value.where.get(key, where))
            for path, (key, item) in zip(paths, value.items(), strict=True)
        )
        said = [
            (key, leaf, path) for key, (path, item, _) in zip(value, point, strict=True) for leaf, _ in leaves(item)
        ]
        self.once([".".join((key, *leaf)) for key, leaf, _ in said], [(*path, *leaf) for _, leaf, path in said], *more)
        return point

    def checked(self, path: Path, value: Any, *more: str | int) -> Any:
        """A value, if it is none of a symbol of `let`, or one that a symbol can have."""
        if path[0] == "let":
            try:
                number_or_expression(value)
            except ValueError as error:
                raise self.fail(f": {error}", *more) from None
        return value

    def once(self, names: list[str], paths: list[Path], *more: str | int) -> None:
        """Refuse keys of one point that say the same thing twice."""
        if (twice := same_twice(paths, inside=True)) is not None:
            first, last = (names[i] for i in twice)
            heights = {paths[i][-2:] for i in twice} == {("block", key) for key in HEIGHT}
            why = f": {UNEVEN}" if heights else ""
            what = "say the same thing" if same_twice(paths) == twice else "exclude each other"
            raise self.fail(f": {first} and {last} {what}; leave one out{why}", *more)

    def below(self, key: str, *more: str | int) -> Path:
        """The path of a key written below the axis' own."""
        text = key if self.path == ("case",) else ".".join((*self.path[1:], key))
        try:
            return resolve(text)
        except StudyError as error:
            raise self.fail(f": {error.message}", *more) from None

    def range(self, entry: Map) -> Variation:
        find, spacing = ((RANGE_DEFAULTS | entry)[key] for key in ("find", "spacing"))
        if find not in (None, "overturning"):
            raise self.fail(f"is {describe(find)}; only `overturning` can be found", "find")
        ends = []
        for key in entry:
            if key not in RANGE:
                said = next(name for name in RANGE if name in entry)
                other = IN_OTHER_WORDS.get(key.lower())
                hint = nearest(key, RANGE) if other is None else f"did you mean {other!r}?"
                raise self.fail(f": unknown key of a range {RANGE_FORM}, which `{said}` makes it; {hint}", key)
        for key in ("from", "to", "n"):
            if entry.get(key) is None:
                raise self.fail(f"is a range without `{key}`; expected {RANGE_FORM}")
        for key in ("from", "to"):
            number = self.number(entry[key], key)
            if number is None or not takes_number(self.path):
                raise self.fail("must be a number or an expression, on a key that takes one", key)
            ends.append(number)
        n = entry["n"]
        if type(n) is not int or not 2 <= n <= MAX_POINTS:
            raise self.fail(f"is {describe(n)}; expected a whole number from 2 to {MAX_POINTS}", "n")
        if spacing not in ("linear", "log"):
            raise self.fail(
                f"is {describe(spacing)}; expected linear or log; {nearest(str(spacing), ('linear', 'log'))}", "spacing"
            )
        if spacing == "log" and not min(ends) > 0.0:
            raise self.fail("spacing: log needs ends greater than 0")
        first, last = ends
        values = np.linspace(first, last, n) if spacing == "linear" else np.geomspace(first, last, n)
        values[0], values[-1] = first, last
        line = place(self.study, ("vary", self.text))
        variation = self.numeric(values, Places(beyond=line))
        if find and variation.columns is None:
            raise self.fail(
                "cannot be searched: only a number of the block, the motion or the initial state can", "find"
            )
        return replace(variation, find=find)

    def named(self, entry: Map) -> Variation:
        if not entry:
            raise self.fail("has no values")
        entry = self.globbed(entry)
        places = [entry.where.get(label) for label in entry]
        settings = [self.put(v, places[i], label) for i, (label, v) in enumerate(entry.items())]
        settings = [tuple((p, as_number(p, v), w) for p, v, w in point) for point in settings]
        return self.labelled(list(entry), settings, Places(tuple(places)))

    def globbed(self, entry: Map) -> Map:
        """The entry with a point for every file that the glob of a setting matches, `label file`."""
        whole = Map()
        for label, value in entry.items():
            where = entry.where.get(label)
            keys = self.glob_of(value)
            if keys is None:
                whole[label], whole.where[label] = value, where
                continue
            pattern = value_at(value, keys)
            for name in self.records.match(f"vary.{self.text}.{label}", pattern, where):
                point = f"{label} {PurePosixPath(name).name}"
                whole[point], whole.where[point] = put_at(value, keys, name), where
        return whole

    def glob_of(self, value: Any) -> Path | None:
        """Where in a setting the file of the record is a glob; None where it is none."""
        for keys, said in leaves(value):
            path = ".".join((*self.path, *keys)).split(".")
            of_record = path[-3:] == ["motion", "record", "file"] or path[-2:] == ["motion", "record"]
            if of_record and isinstance(said, str) and set(said) & WILDCARDS:
                return keys
        return None

    def matched(self, pattern: str) -> Variation:
        line = place(self.study, ("vary", self.text))
        names = self.records.match(f"vary.{self.text}", pattern, line)
        return self.listed(List(names, [line] * len(names)))

    def table(self, name: str) -> Variation:
        line = place(self.study, ("vary", self.text))
        table = read_table(name, self.source, line)
        self.labels_first(table, self.source.folder / name)
        paths = [self.of_column(column, self.source.folder / name, table.line) for column in table.columns]
        self.check_rows(table, paths, self.source.folder / name)
        where: list[Where] = [f"{self.source.folder / name}:{i}" for i in table.lines]
        settings = [
            tuple((path, as_number(path, value), at) for path, value in zip(paths, row, strict=True))
            for at, row in zip(where, table.rows, strict=True)
        ]
        return self.labelled(table.labels, settings, Places(tuple(where), line), name, given=given_by(table, settings))

    def check_rows(self, table: Table, paths: list[Path], file: FilePath) -> None:
        """Refuse, all at once, cells of a row that say the same thing, and words where a number is expected."""
        if len(set(paths)) < len(paths):
            self.once(table.columns, paths)
        complaints = Complaints()
        for line, row in zip(table.lines, table.rows, strict=True):
            said = [i for i, value in enumerate(row) if value is not None]
            try:
                self.once([table.columns[i] for i in said], [paths[i] for i in said])
            except StudyError as error:
                complaints.note(StudyError(error.message, file, line))
            for path, value in zip(paths, row, strict=True):
                if path[0] == "let" or (isinstance(value, str) and varies_in_batch(path)):
                    try:
                        number_or_expression(value)
                    except ValueError as error:
                        complaints.note(StudyError(f"{'.'.join(path)}: {error}", file, line))
        complaints.tell()

    def of_column(self, head: str, file: FilePath, line: int) -> Path:
        """The path over a column of a table, whose heads stand in a line of a file."""
        try:
            return self.below(head)
        except StudyError as error:
            notes = f"the head of a column of notes begins with {NOTE} ({NOTE} {head})"
            raise StudyError(f"{error.message}; {notes}", file, line) from None

    def labels_first(self, table: Table, file: FilePath) -> None:
        """Refuse a table whose first column is no labels, but a path like the others."""
        if is_path(table.head if self.path == ("case",) else ".".join((*self.path, table.head))):
            raise StudyError(
                f"the first column names the points, and {table.head!r} is a path inside the case: put a column of "
                f"labels before it (name,{table.head},...)",
                file=file,
                line=table.line,
            )
