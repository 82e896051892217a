"""Tables as files: CSV, an Excel workbook, Parquet; written in blocks, whole or not at all."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import numpy as np

from rockcli.errors import StudyError
from rockcli.storage.atomic import replacing
from rockcli.storage.places import reason
from rockcli.storage.table import BLOCK, Column, Table, frame

Block = list[Column]
Writer = Callable[[Path, Block], AbstractContextManager[Callable[[Block], None]]]

_XLSX_ROWS = 1_048_575
"""Rows of an Excel sheet below its head."""


def write(table: Table, path: Path) -> None:
    """Write a table to a file of the format that its name ends in.

    Raises:
        StudyError: the ending is none of a table, the sheet would be too long, or a library is not installed.
        OutputError: it cannot be written.
    """
    writer = _FORMATS.get(path.suffix.lower())
    if writer is None:
        raise StudyError(f"expected a name that ends in {', '.join(_FORMATS)}", file=path)
    if (library := _NEEDS.get(path.suffix.lower())) and find_spec(library) is None:
        words = f"needs {library}, which is not installed: pip install 'rockcli[tables]', or write .csv"
        raise StudyError(words, file=path)
    if writer is _xlsx and table.size > _XLSX_ROWS:
        raise StudyError(f"{table.size} rows: an Excel sheet has {_XLSX_ROWS}; write .csv or .parquet", file=path)
    blocks = table.blocks(BLOCK)
    first = next(blocks)
    with replacing(path) as scratch, writer(scratch, first) as add:
        add(first)
        for block in blocks:
            add(block)


@contextmanager
def _csv(path: Path, first: Block) -> Iterator[Callable[[Block], None]]:
    """Numbers to the last bit; no answer is an empty cell, overturned `inf`."""
    with path.open("w", encoding="utf-8", newline="") as file:
        frame(first).iloc[:0].to_csv(file, index=False, lineterminator="\n")

        def add(block: Block) -> None:
            frame(block).to_csv(file, index=False, header=False, lineterminator="\n")

        yield add


@contextmanager
def _xlsx(path: Path, first: Block) -> Iterator[Callable[[Block], None]]:
    """A sheet; infinity, which Excel has no number for, is the word `inf`."""
    from openpyxl import Workbook
    from openpyxl.cell import WriteOnlyCell

    book = Workbook(write_only=True)
    sheet = book.create_sheet("table")
    sheet.freeze_panes = "A2"

    def plain(value: Any) -> Any:
        if not (isinstance(value, str) and value.startswith(("=", "#"))):
            return value
        cell = WriteOnlyCell(sheet, value)
        cell.data_type = "s"  # by itself it would be a formula, or an error such as #N/A
        return cell

    def add(block: Block) -> None:
        for row in zip(*(_cells(column) for column in block), strict=True):
            sheet.append([plain(value) for value in row])

    packed = io.BytesIO()
    with _temporary_refused(sheet):
        sheet.append([column.head for column in first])
        yield add
        book.save(packed)  # an archive that cannot be written complains once more when it is collected
    path.write_bytes(packed.getvalue())


@contextmanager
def _temporary_refused(sheet: Any) -> Iterator[None]:
    """Say what is wrong where the system refuses the temporary file of a sheet: lxml, if there, names the error alone.

    Raises:
        OSError: in words.
    """
    try:
        yield
    except Exception as error:
        number = getattr(errno, str(error).removeprefix("IO_"), None)  # as IO_ENOSPC
        if not isinstance(number, int):
            raise
        with suppress(Exception):
            sheet.close()  # which complains once more, else when it is collected
        why = f"{reason(OSError(number, os.strerror(number)))} in {gettempdir()}, where its sheet is put together"
        raise OSError(why) from None


def _cells(column: Column) -> list[Any]:
    values = column.values
    cells = values.astype(object)
    if values.dtype.kind != "f":
        return list(cells)
    cells[np.isnan(values)] = None
    cells[np.isposinf(values)] = "inf"
    cells[np.isneginf(values)] = "-inf"
    return list(cells)


@contextmanager
def _parquet(path: Path, first: Block) -> Iterator[Callable[[Block], None]]:
    """Words as plain strings, so that every block has the same schema."""
    import pyarrow
    from pyarrow.parquet import ParquetWriter

    def arrow(block: Block) -> Any:
        text = pyarrow.string()
        arrays = [pyarrow.array(c.values, type=text if c.values.dtype == object else None) for c in block]
        return pyarrow.Table.from_arrays(arrays, names=[column.head for column in block])

    with ParquetWriter(path, arrow(first).schema) as writer:
        yield lambda block: writer.write_table(arrow(block))


_FORMATS: dict[str, Writer] = {".csv": _csv, ".xlsx": _xlsx, ".parquet": _parquet}
_NEEDS = {".xlsx": "openpyxl", ".parquet": "pyarrow"}
