"""Input files of a study and their hashes: opened through one door, listed for the identity of results."""

from __future__ import annotations

import csv
import hashlib
import io
import re
from dataclasses import dataclass, field
from pathlib import Path

from rockcli.errors import StudyError

MAX_BYTES = 1_000_000
"""Largest study."""

MAX_TABLE = 50_000_000
"""Largest table or outline."""

_BEHIND_QUOTES = re.compile(r'"[ \t]+(?=[,\r\n]|\Z)')


@dataclass(eq=False)
class Inputs:
    """What has been read for one study.

    A name means one file throughout a study, and is as the study has it, with its folder; so two files of one base name
    are two, and a study means the same wherever its folder is put.

    Attributes:
        hashes: name -> SHA-256 of the bytes.
    """

    hashes: dict[str, str] = field(default_factory=dict)
    _kept: dict[str, bytes] = field(default_factory=dict)

    def read(self, name: str, path: Path, most: int = MAX_TABLE) -> bytes:
        """The bytes of a file, read once however many cases need it.

        Raises:
            StudyError: it cannot be read.
        """
        if name not in self._kept:
            data = read_bytes(path, most)
            self.note(name, path, hashlib.sha256(data).hexdigest())
            self._kept[name] = data
        return self._kept[name]

    def read_beside(self, path: Path) -> bytes:
        """The bytes of a small file on which no result of a case depends, so that it is not on the list.

        What it says must be in the dataset itself.  Raises StudyError as `read` does.
        """
        return read_bytes(path)

    def note(self, name: str, path: Path, sha256: str) -> None:
        """Put a file that was read on the list.

        Raises:
            StudyError: it is there with other bytes.
        """
        if self.hashes.setdefault(name, sha256) != sha256:
            raise StudyError("was changed while the study was running; run again", file=path)


def text_of(data: bytes, path: Path) -> str:
    """The text of a file of comma-separated values; raises StudyError where it is not in UTF-8, with the line."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise StudyError("is no text in UTF-8: save it as CSV in UTF-8", file=path, line=line) from None


def csv_rows(data: bytes, path: Path) -> list[tuple[int, list[str]]]:
    """The rows of a CSV file that hold anything: the line each begins in, and its cells without blanks around them.

    Cells in quotation marks may go over several lines.

    Raises:
        StudyError: it is no text in UTF-8, or more stands in a cell behind its quotation marks, or they do not end.
    """
    text = _BEHIND_QUOTES.sub('"', text_of(data, path))
    reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True, strict=True)
    rows, begins = [], 1
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells):
                rows.append((begins, cells))
            begins = reader.line_num + 1
    except csv.Error as error:
        raise StudyError(f"is no CSV text: {error}", file=path, line=begins) from None
    return rows


def read_bytes(path: Path, most: int = MAX_BYTES, what: str = "a study file") -> bytes:
    """The bytes of a file, at most so many; raises StudyError, of a folder that it is not `what`."""
    try:
        if path.is_dir():
            raise StudyError(f"is a folder, not {what}", file=path)
        with path.open("rb") as stream:
            data = stream.read(most + 1)
    except FileNotFoundError:
        raise StudyError("there is no such file", file=path) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise StudyError(f"cannot be read: {reason}", file=path) from None
    if len(data) > most:
        raise StudyError(f"is larger than {most / 1e6:g} MB", file=path)
    return data
