"""`rock table`: the cases of a dataset, or what a suite comes to, as a table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rockcli.cli.options import Select, chosen
from rockcli.cli.say import say

if TYPE_CHECKING:
    from rockcli.storage.table import Column, Item, Table

_TOLD = (
    "overturn_share", "theta_peak", "theta_peak_over_alpha", "u_top_peak", "slide_peak", "n_impacts", "t_overturn",
)  # fmt: skip
"""Columns of cases that a terminal shows beside the axes and the outcome, where they say anything."""


def _tables(incomplete: str) -> list[tuple[str, str]]:
    from rockcli.storage.table import TABLES

    return [(name, words) for name, words in TABLES.items() if name.startswith(incomplete)]


def table(
    file: Annotated[Path, typer.Argument(metavar="FILE.nc", help="A dataset written by `rock run`.")],
    columns: Annotated[
        str | None,
        typer.Option("--columns", metavar="A,B", help="Only these variables beside the axes."),
    ] = None,
    of: Annotated[
        str,
        typer.Option(
            "--of",
            metavar="TABLE",
            help="cases, or of a suite: suite, fragility, risk, deaggregation, stripes, demand, inputs; "
            "of a refined map: boundaries.",
            autocompletion=_tables,
        ),
    ] = "cases",
    select: Select = None,
    sort: Annotated[
        str | None,
        typer.Option(
            "--sort", metavar="[-]COLUMN", help="Rows by this column, -COLUMN the largest first; no answer comes last."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.csv|.xlsx|.parquet", help="Write all of it to a file.")
    ] = None,
    degrees: Annotated[bool, typer.Option("--degrees", help="Angles in degrees.")] = False,
    si: Annotated[bool, typer.Option("--si", help="Accelerations in m/s2, not in g.")] = False,
    rows: Annotated[int, typer.Option("--rows", metavar="N", help="Rows printed at most.")] = 60,
) -> None:
    """Print or write a dataset as a table: one row per case, axes first, outcome as a word, heads `name [unit]`.

    Accelerations are in g, as in figures, all else in SI units; heads say which.  Printed with six digits; files have
    every digit.  Histories are in no table.
    """
    import json

    from rockcli.errors import StudyError
    from rockcli.scene.units import SI
    from rockcli.storage.contents import OF_TABLES
    from rockcli.storage.places import check_file, check_not_read
    from rockcli.storage.table import CASES, opened, table_of, units_of
    from rockcli.storage.table_files import write

    if rows < 1:
        raise StudyError(f"--rows {rows}: expected a whole number greater than 0")
    named = None if columns is None else [name.strip() for name in columns.split(",") if name.strip()]
    wanted = chosen(select)
    with opened(file) if not wanted else _selected(file, wanted, of) as (items, attrs):
        try:
            units = SI if si else units_of(items, attrs)
            found = table_of(items, attrs, of=of, columns=named, degrees=degrees, units=units, sort=sort)
            _check_labels(found, of, wanted)
        except StudyError as error:
            raise StudyError(error.message, file=file) from None
        if out is None:
            by = (sort or "").removeprefix("-")
            if named is None and of == CASES:
                always: Sequence[str] = (*found.dims, by)
            else:  # what was said of the bodies is in files, and where it is asked for
                always = [name for name in found.names if named or name == by or not name.startswith(OF_TABLES)]
            _print(found, rows, always=always)
        else:
            check_file(out)
            check_not_read(out, json.loads(str(attrs.get("inputs", "{}"))).values())
            write(found, out)
            say(str(out))


@contextmanager
def _selected(
    file: Path, wanted: dict[str, list[str]], of: str
) -> Iterator[tuple[Mapping[str, Item], Mapping[str, Any]]]:
    """As `opened`, of the cases at some values of axes, and of some limit states or hazard curves."""
    import json

    from rockcli.errors import StudyError
    from rockcli.plotting.common.selection import selected
    from rockcli.scene.variables import HAZARD, LIMIT
    from rockcli.storage.read import open_dataset
    from rockcli.storage.table import BOUNDARIES, CASES, items_of

    try:
        dataset = open_dataset(file)
        of_suite = [dim for dim in (LIMIT, HAZARD) if dim in dataset.dims]
        for dim in of_suite:
            dataset = _of_labels(dataset, dim, wanted[dim]) if dim in wanted else dataset
        part, _ = selected(dataset, {axis: values for axis, values in wanted.items() if axis not in of_suite}, of_suite)
        if of not in (CASES, BOUNDARIES) and "ensemble" in dataset.attrs.keys() - part.attrs.keys():
            over = json.loads(dataset.attrs["ensemble"])["axis"]
            members = ", ".join(over if isinstance(over, list) else [over])
            raise StudyError(f"--select leaves a part of {members}: the table {of!r} is over all of it")
    except StudyError as error:
        raise StudyError(error.message, file=file) from None
    yield items_of(part), part.attrs


def _of_labels(dataset: Any, dim: str, asked: list[str]) -> Any:
    """A dataset at some labels of a dimension, as they are written there or in tables."""
    from rockcli.errors import StudyError
    from rockcli.plotting.common.selection import apart, hint
    from rockcli.scene.limit_states import exceeded_when, in_full
    from rockcli.scene.variables import LIMIT

    there = [str(label) for label in dataset[dim].values]
    words = [{label, exceeded_when(label), in_full(label)} if dim == LIMIT else {label} for label in there]
    known = set().union(*words)
    every = {one for text in asked for one in apart(text, known)}
    if unknown := sorted(every - known):
        raise StudyError(f"{dim}={unknown[0]}: there are {', '.join(there)}{hint(unknown[0], sorted(known))}")
    return dataset.isel({dim: [i for i, each in enumerate(words) if each & every]})


def _check_labels(found: Table, of: str, wanted: Mapping[str, list[str]]) -> None:
    """Refuse to select limit states or hazard curves of a table that has no column of them."""
    from rockcli.errors import StudyError
    from rockcli.scene.variables import HAZARD, LIMIT

    for dim, other in ((LIMIT, "fragility"), (HAZARD, "risk")):
        if dim in wanted and dim not in found.dims:
            raise StudyError(f"select {dim}: the table {of!r} has no such column; --of {other} has")


def _print(table: Table, rows: int, always: Sequence[str]) -> None:
    """The first rows of some columns and of those that say something."""
    from rockcli.cli.tables import table as printed

    block = table.first(rows)
    shown = [column for column in block if column.name in always or _tells(column)] or block
    cells = [_cells(column) for column in shown]
    told = 0
    while told < len(shown) and shown[-1 - told].values.dtype != object:
        told += 1
    keys = sum(column.name in table.dims for column in shown)
    say(printed([column.head for column in shown], zip(*cells, strict=True), right=told, keys=max(keys, 1)))
    left = table.size - len(cells[0])
    if left > 0:
        say(f"rock: {left} more of {table.size} rows: --rows {table.size}, or --out FILE.csv", err=True)
    hidden = [name for name in table.names if name not in {column.name for column in shown}]
    if hidden:
        say(f"rock: more columns (--columns A,B; a file has all): {', '.join(hidden)}", err=True)


def _tells(column: Column) -> bool:
    """Whether a column is among those shown unasked: it has a finite number, and no case is uncertain without it."""
    import numpy as np

    if column.name == "outcome" or column.name.endswith("_overturning"):
        return True
    if column.name == "overturn_share":
        return bool(((column.values > 0.0) & (column.values < 1.0)).any())
    return column.name in _TOLD and bool(np.isfinite(column.values).any())


def _cells(column: Column) -> list[str]:
    """At most six digits; nothing where there is no answer; limit states in full."""
    from rockcli.scene.limit_states import in_full
    from rockcli.scene.variables import LIMIT

    values = column.values.tolist()
    if column.name == LIMIT:
        return [in_full(str(label)) for label in values]
    return [("" if v != v else f"{v:.6g}") if isinstance(v, float) else str(v) for v in values]
