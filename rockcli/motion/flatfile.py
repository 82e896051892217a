"""What the PEER database says of the records it hands out: `_SearchResults.csv` in their folder."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from rockcli.errors import RecordError

NAME = "_SearchResults.csv"

COLUMNS = {
    "magnitude": r"Magnitude",
    "r_rup": r"(?:Rrup|ClstD) \(km\)",
    "r_jb": r"Rjb \(km\)",
    "vs30": r"Vs30 \(m/s\w*\)",
    "pulse_period": r"(?:Tp|Tp-Pulse|Pulse Period) \(s\w*\)",
}
"""Key -> title of its column; distances in km as the file has them, m/s, s."""

_FILES = re.compile(r"(?:Horizontal|Vertical)\S*\s+Acc\.? Filename", re.I)
_NUMBER = re.compile(r"Record Sequence Number", re.I)


def metadata_of(path: Path, header: Mapping[str, Any]) -> dict[str, float]:
    """What a record's own header says, by the keys of COLUMNS, and the table beside it, which goes before."""
    own = {key: value for key in COLUMNS if (value := _positive(header.get(key, ""))) is not None}
    return own | metadata_beside(path)


def metadata_beside(path: Path) -> dict[str, float]:
    """What the table beside a record says of it, by the keys of COLUMNS; what is unknown is left out.

    A record is found by its file name, one that was renamed by the number in it (RSN811_...).

    Raises:
        RecordError: the table is damaged, has none of the titles of the database's, or a record twice with different
            values.
    """
    table = os.path.join(os.path.dirname(path), NAME)  # many times faster than a `Path`: it is sought for every record
    try:
        here = os.stat(table)
    except OSError:
        return {}
    try:
        by_file, by_number = _read(Path(table), here.st_ino, here.st_size, here.st_mtime_ns, here.st_ctime_ns)
    except csv.Error as error:
        raise RecordError(f"cannot be read as the table of the PEER database: {error}; correct it", table) from error
    number = re.match(r"RSN(\d+)_", path.name, re.I)
    return by_file.get(path.name.casefold()) or (by_number.get(int(number[1]), {}) if number else {})


@lru_cache(maxsize=64)
def _read(table: Path, *unchanged: int) -> tuple[dict[str, dict[str, float]], dict[int, dict[str, float]]]:
    by_file: dict[str, dict[str, float]] = {}
    by_number: dict[int, dict[str, float]] = {}
    columns: dict[str, int] = {}
    files: list[int] = []
    numbered = None
    with table.open(newline="", encoding="latin-1") as lines:
        rows = csv.reader(lines, skipinitialspace=True)
        for cells in ([cell.strip() for cell in row] for row in rows):
            if not columns:
                titles = [i for i, cell in enumerate(cells) if _NUMBER.fullmatch(cell)]
                if titles and any(_FILES.fullmatch(cell) for cell in cells):
                    numbered = titles[0]
                    files = [i for i, cell in enumerate(cells) if _FILES.fullmatch(cell)]
                    columns = {
                        key: i for i, cell in enumerate(cells) for key, title in COLUMNS.items()
                        if re.fullmatch(title, cell, re.I)
                    }  # fmt: skip
                continue
            if len(cells) <= max([*files, *columns.values()]):
                break  # the table has ended
            said = {key: value for key, i in columns.items() if (value := _positive(cells[i])) is not None}
            for i in files:
                by_file[cells[i].replace("\\", "/").rsplit("/", 1)[-1].casefold()] = said
            number = "" if numbered is None else cells[numbered]
            if number.isdigit() and by_number.setdefault(int(number), said) != said:
                twice = f"record {number} stands here again, with other values; leave one out"
                raise RecordError(twice, table, rows.line_num)
    if not columns and table.stat().st_size:
        raise RecordError(
            "is not the table of the PEER database as it comes: no line has the titles `Record Sequence Number` and "
            "`... Acc. Filename` with commas between; put the original there, or rename it",
            table,
        )
    by_file.pop("", None)
    return by_file, by_number


def _positive(cell: str | float) -> float | None:
    """A number the database knows; it writes -999 or - for one it does not."""
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if 0.0 <= value < 1e6 else None
