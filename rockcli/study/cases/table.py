"""A CSV file of settings: labels in the first column, a path below the axis over each of the others."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rockcli.errors import StudyError, is_file
from rockcli.scene.counted import counted
from rockcli.study.document.complaints import Complaints
from rockcli.study.document.loader import scalar
from rockcli.study.document.overlay import Setting
from rockcli.study.document.paths import UNITS
from rockcli.study.document.tree import Source, Where
from rockcli.study.inputs import csv_rows
from rockcli.study.study import Given

NOTE = "#"
"""Begins the head of a column that is for readers: rooms, numbers of an inventory."""

_NOTHING = frozenset({"-", "--", "\u2013", "\u2014", "?", "n/a", "n.a."})
"""What people write into a cell to say that nothing is known; none is an expression."""

_OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}


@dataclass(frozen=True)
class Table:
    """The head of the first column and its line, labels, paths of the columns, values row by row, and their lines.

    `notes`: the head of every column for readers and what it says.
    """

    head: str
    line: int
    labels: list[str]
    columns: list[str]
    rows: list[list[Any]]
    lines: list[int]
    notes: list[tuple[str, list[str]]]


def read_table(name: str, source: Source, where: Where) -> Table:
    """Read a CSV file beside the study.

    Raises:
        StudyError: it cannot be read, has no rows or columns, other separators than commas, or a row of another length
            or with an empty cell.
    """
    path = source.folder / name
    if not is_file(path):
        raise source.placed(where, f"the table {path} does not exist")
    rows = csv_rows(source.inputs.read(name, path), path)
    if rows and len(rows[0][1]) == 1:
        _check_separators(path, *rows[0])
    if len(rows) < 2 or len(rows[0][1]) < 2:
        raise StudyError("a table has a line of paths, the first naming the labels, and a line per point", file=path)
    for i, row in rows[1:]:
        if len(row) != len(rows[0][1]):
            _check_separators(path, i, row)
            raise StudyError(
                f"the line has {counted(len(row), 'cell')}, the first has {len(rows[0][1])}", file=path, line=i
            )
    rows = _without_blank_columns(rows)
    notes = [
        (head.removeprefix(NOTE).strip(), [row[k] for _, row in rows[1:]])
        for k, head in enumerate(rows[0][1])
        if k and head.startswith(NOTE)
    ]
    read = [k for k, head in enumerate(rows[0][1]) if k == 0 or not head.startswith(NOTE)]
    rows = [(i, [row[k] for k in read]) for i, row in rows]
    header = rows[0][1]
    columns = header[1:]
    if not all(columns):
        raise StudyError("a column has no head: name its path, or take its cells away", file=path, line=rows[0][0])
    if len(set(columns)) < len(columns):
        twice = next(column for column in columns if columns.count(column) > 1)
        raise StudyError(f"the path {twice!r} repeats", file=path, line=rows[0][0])
    if united := next((column for column in columns if column.endswith(("]", ")"))), None):
        raise StudyError(
            f"{united!r} is no path inside the case: the head of a column has no unit, which cells may have (180*cm)",
            file=path,
            line=rows[0][0],
        )
    _check_cells(path, header, rows[1:])
    body = [row for _, row in rows[1:]]
    values = [[_value(cell) for cell in row[1:]] for row in body]
    return Table(header[0], rows[0][0], [row[0] for row in body], columns, values, [i for i, _ in rows[1:]], notes)


def _value(cell: str) -> Any:
    """A cell: a scalar, or in square brackets a list of them, as the two sides of a base (`[0.2, 0.35]`)."""
    if cell.startswith("[") and cell.endswith("]"):
        return [scalar(part.strip()) for part in cell[1:-1].split(",")]
    return scalar(cell)


def _without_blank_columns(rows: list[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """Rows without columns that hold nothing, not even a head, as spreadsheets write them."""
    kept = [k for k, column in enumerate(zip(*(row for _, row in rows), strict=True)) if k == 0 or any(column)]
    return [(i, [row[k] for k in kept]) for i, row in rows]


def _check_cells(path: Path, header: list[str], rows: list[tuple[int, list[str]]]) -> None:
    """Refuse cells that are empty or a number that is none, and names that repeat: all at once, as lists have many."""
    complaints = Complaints()
    first: dict[str, int] = {}
    for i, row in rows:
        if row[0] and first.setdefault(row[0], i) != i:
            wrong = f"repeats {row[0]!r}, which names line {first[row[0]]}: every point has a name of its own"
            complaints.note(StudyError(wrong, file=path, line=i))
        for k, (column, cell) in enumerate(zip(header, row, strict=True)):
            if not cell or (k and cell.lower() in _NOTHING):
                none = "or null for none, also where the base case has one"
                mend = f"write a value, {none}" if k else "it names the point"
                what = f"is {cell}" if cell else "is empty"
                complaints.note(StudyError(f"the cell below {column!r} {what}: {mend}", file=path, line=i))
            elif k and _is_no_finite_number(cell):
                wrong = f"the cell below {column!r} is {cell}: a finite number is expected"
                complaints.note(StudyError(wrong, file=path, line=i))
    complaints.tell()


def _check_separators(path: Path, line: int, cells: list[str]) -> None:
    """Refuse a line in which something else than commas stands between the cells."""
    for mark, words in _OTHER_SEPARATORS.items():
        if any(mark in cell for cell in cells):
            mend = f"write decimals with a point, then replace the {words} by commas"
            raise StudyError(f"{words} separate the cells, commas are expected: {mend}", file=path, line=line)


def _is_no_finite_number(cell: str) -> bool:
    """Whether a cell is what programs print for a number that is none, or one too large."""
    try:
        return not math.isfinite(float(cell))
    except ValueError:
        return False


def _as_written(value: Any) -> str:
    """A value as its cell has it; "" for none."""
    if isinstance(value, list):
        return f"[{', '.join(map(str, value))}]"
    return "" if value is None else str(value)


def given_by(table: Table, settings: Sequence[tuple[Setting, ...]]) -> tuple[Given, ...]:
    """The columns of a table as datasets carry them: those of settings, one of each point, and those of notes."""
    paths = [path for path, _, _ in settings[0]] if settings else []
    lasts = [path[-1] for path in paths]
    found = []
    for k, path in enumerate(paths):
        inside = path[1:] if path[0] == "case" else path
        name = inside[-1] if lasts.count(path[-1]) == 1 else "_".join(inside)
        values = [point[k][1] for point in settings]
        if all(value is None for value in values):
            continue
        numbers = all(value is None or type(value) in (int, float) for value in values)
        said = np.array(values, dtype=float) if numbers else np.array([_as_written(v) for v in values])
        found.append(Given(f"given_{name}", ".".join(inside), said, UNITS.get(path[-1], "1") if numbers else "1"))
    for k, (head, cells) in enumerate(table.notes, start=1):
        name = "note_" + (re.sub(r"\W+", "_", head).strip("_") or str(k))
        taken = name in (each.name for each in found)
        found.append(Given(f"{name}_{k}" if taken else name, head, np.array(cells)))
    return tuple(found)
