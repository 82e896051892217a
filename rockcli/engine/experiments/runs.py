"""RUNS.csv: experiments, a line each: what shook the body, whether it overturned, and what others predicted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.experiments.scores import Index, numbered
from rockcli.errors import StudyError
from rockcli.scene.counted import counted
from rockcli.scene.response import OUTCOMES, overturned
from rockcli.study.inputs import MAX_TABLE, csv_rows, read_bytes

Array = NDArray[np.float64]

RESULT, RECORD, SCALE, GROUP, SPECIMEN, RUN = "outcome", "record", "scale", "group", "specimen", "run"
SESSION = "session"

MEASURES = ("pga", "pgv")
"""Columns that stand in for those of the record in the baselines."""

FELL = {"1", "true", "yes", "overturned", "overturn", "overturns", "fallen", "fell", "toppled"} | {
    name for flag, name in OUTCOMES.items() if overturned(flag)
}
STOOD = {"0", "false", "no", "stood", "standing", "stable", "upright", "survived"} | {
    name for flag, name in OUTCOMES.items() if flag >= 0 and not overturned(flag)
}

_KNOWN = {RESULT, RECORD, SCALE, GROUP, SPECIMEN, SESSION, RUN, *MEASURES}


@dataclass(frozen=True, eq=False)
class Runs:
    """Experiments, n of them.

    Attributes:
        file: of the table.
        line: of each run in it, (n,).
        outcome: whether the body overturned, (n,).
        record: name of the file of each motion; () where the table has no such column.
        scale: what the motion is multiplied by, (n,).
        group: label of the runs that are not independent of each other; () where the table has no such column.
        specimen: which body; () where the table has no such column.
        session: in which it was set up as it stood, a date or a number; () where the table has no such column.
        measures: pga and pgv where the table has them, (n,) each, in any unit.
        predictions: column -> probabilities, (n,); NaN where the cell is empty.
        unread: columns that are no predictions.
        grouped_by: column of `labels`.
    """

    file: Path
    line: tuple[int, ...]
    outcome: NDArray[np.bool_]
    record: tuple[str, ...]
    scale: Array
    group: tuple[str, ...]
    specimen: tuple[str, ...]
    measures: dict[str, Array]
    predictions: dict[str, Array]
    unread: tuple[str, ...] = ()
    session: tuple[str, ...] = ()
    grouped_by: str = GROUP

    @property
    def size(self) -> int:
        """Number of runs."""
        return len(self.outcome)

    @property
    def labels(self) -> tuple[str, ...]:
        """Group of every run; without the column its record, without that its line."""
        return self.group or self.record or tuple(f"line {line}" for line in self.line)

    @property
    def groups(self) -> Index:
        """The groups as numbers, (n,)."""
        return numbered(self.labels)

    def of(self, specimen: str) -> Runs:
        """The runs of one specimen."""
        return self.rows(np.array([label == specimen for label in self.specimen]))

    def rows(self, kept: NDArray[np.bool_]) -> Runs:
        """Some of the runs."""

        def some(values: tuple[str, ...]) -> tuple[str, ...]:
            return tuple(value for value, keep in zip(values, kept, strict=True) if keep) if values else ()

        return replace(
            self,
            line=tuple(line for line, keep in zip(self.line, kept, strict=True) if keep),
            outcome=self.outcome[kept],
            record=some(self.record),
            scale=self.scale[kept],
            group=some(self.group),
            specimen=some(self.specimen),
            session=some(self.session),
            measures={name: values[kept] for name, values in self.measures.items()},
            predictions={name: values[kept] for name, values in self.predictions.items()},
        )


def read_runs(path: Path, *, group: str = GROUP, predictions: Sequence[str] | None = None) -> Runs:
    """Read a table of experiments; lines that begin with # are comments.

    Args:
        path: a CSV file in UTF-8; its first line names the columns.
        group: the column of the groups.
        predictions: columns to read as predictions; None = all others whose cells are probabilities or outcomes.

    Raises:
        StudyError: naming file and line: no such file, no `outcome`, a cell that is not what its column holds.
    """
    head_line, head, rows = _cells(path)

    def fail(message: str, line: int) -> StudyError:
        return StudyError(message, file=path, line=line)

    if RESULT not in head:
        raise fail(f"has no column `{RESULT}`; it has {', '.join(head)}", head_line)
    wanted = [group] if group != GROUP else []
    for name in (*wanted, *(predictions or ())):
        if name not in head:
            raise fail(f"has no column {name!r}; it has {', '.join(head)}", head_line)
    for name in head:
        plain = name.partition("[")[0].partition("(")[0].strip().lower()
        if plain in _KNOWN - {*head} and name not in (group, *(predictions or ())):
            raise fail(f"the column {name!r} would be read as a prediction; did you mean {plain!r}?", head_line)
    column = {name: [cells[k] for _, cells in rows] for k, name in enumerate(head)}
    lines = tuple(line for line, _ in rows)

    def numbers(name: str, *, above: float = -math.inf) -> Array:
        out = np.empty(len(rows))
        for i, (cell, line) in enumerate(zip(column[name], lines, strict=True)):
            value = _number(cell)
            if value is None or not math.isfinite(value) or not value > above:
                least = "" if above == -math.inf else f" greater than {above:g}"
                raise fail(f"{name} is {cell[:50]!r}; expected a number{least}", line)
            out[i] = value
        return out

    def texts(name: str) -> tuple[str, ...]:
        for cell, line in zip(column.get(name, ()), lines, strict=name in column):
            if not cell:
                raise fail(f"the cell below {name!r} is empty", line)
        return tuple(column.get(name, ()))

    outcome = np.empty(len(rows), dtype=bool)
    for i, (cell, line) in enumerate(zip(column[RESULT], lines, strict=True)):
        said = _outcome(cell)
        if said is None:
            raise fail(f"{RESULT} is {cell[:50]!r}; expected 0 or 1, or overturned or stood", line)
        outcome[i] = said
    scale = numbers(SCALE, above=0.0) if SCALE in head else np.ones(len(rows))
    reserved = _KNOWN | {group}
    read: dict[str, Array] = {}
    unread = []
    for name in predictions if predictions is not None else [name for name in head if name not in reserved]:
        values, wrong = _probabilities(column[name])
        if wrong is None:
            read[name] = values
        elif predictions is not None:
            cell, line = column[name][wrong], lines[wrong]
            raise fail(f"{name} is {cell[:50]!r}; expected a probability from 0 to 1, or an outcome", line)
        else:
            unread.append(name)
    return Runs(
        file=path,
        line=lines,
        outcome=outcome,
        record=texts(RECORD),
        scale=scale,
        group=texts(group),
        specimen=texts(SPECIMEN),
        session=texts(SESSION),
        measures={name: numbers(name, above=0.0) for name in MEASURES if name in head},
        predictions=read,
        unread=tuple(unread),
        grouped_by=next((name for name in (group, RECORD) if name in head), "line"),
    )


def _cells(path: Path) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Line and names of the head, and line and cells of every row."""
    rows = [
        row for row in csv_rows(read_bytes(path, MAX_TABLE, "a table of runs"), path) if not row[1][0].startswith("#")
    ]
    if len(rows) < 2:
        raise StudyError("has no runs: expected a line of names, as `record,outcome`, and a line per run", file=path)
    line, head = rows[0]
    if not all(head) or len(set(head)) < len(head):
        raise StudyError("a name in the first line is empty or repeats", file=path, line=line)
    for number, cells in rows[1:]:
        if len(cells) != len(head):
            raise StudyError(
                f"the line has {counted(len(cells), 'cell')}, the first has {len(head)}", file=path, line=number
            )
    return line, head, rows[1:]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _outcome(cell: str) -> bool | None:
    word = cell.lower().replace(" ", "_")
    if word in FELL or _number(cell) == 1.0:
        return True
    return False if word in STOOD or _number(cell) == 0.0 else None


def _probabilities(cells: Sequence[str]) -> tuple[Array, int | None]:
    """A column as probabilities, NaN where it is empty; and the place of a cell that is none."""
    values = np.full(len(cells), np.nan)
    for i, cell in enumerate(cells):
        if not cell:
            continue
        value, said = _number(cell), _outcome(cell)
        if said is not None:
            values[i] = float(said)
        elif value is not None and 0.0 <= value <= 1.0:
            values[i] = value
        else:
            return values, i
    return values, None if not np.isnan(values).all() else 0
