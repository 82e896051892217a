"""Parses numbers of record files: FORTRAN exponents, columns that touch, text behind.

Nothing here guesses: whatever is not a finite decimal number is an error that names file and line.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError

Array = NDArray[np.float64]

_PLAIN = re.compile(r"[0-9.eE+\-\s]*")
_LETTER_D = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
_NO_LETTER = re.compile(r"(?<=[\d.])([+-]\d{3})(?![\d.])")
_GLUED = re.compile(r"(?<=[\d.])(?=[+-])")


@dataclass(frozen=True, eq=False)
class Numbers:
    """The numbers of a text.

    Attributes:
        values: in reading order, (k,).
        per_line: how many stand on each line that has any, (lines,).
        last: the last number as it is printed, with its neighbours' shortest length in `shortest`
            (both without signs): a number cut by the end of the file is shorter than all others.
        shortest: see `last`.
        text_after: lines without numbers behind the last number.
    """

    values: Array
    per_line: NDArray[np.int64]
    last: str
    shortest: int
    text_after: tuple[str, ...]


def read_numbers(lines: list[str], first: int, file: str, expected: int | None = None) -> Numbers:
    """All numbers on the lines, which hold nothing else but, at the end, lines of text.

    Args:
        lines: the lines to read.
        first: number of the first of them in its file, counted from 1, for messages.
        file: the file's name, for messages.
        expected: how many numbers there should be, if known: behind that many, lines that are not
            numbers throughout are text.

    Raises:
        RecordError: a word among numbers, numbers behind text, or a number that is not finite.
    """
    values: list[float] = []
    rows: list[list[str]] = []
    numbers_of_lines: list[int] = []
    text: list[tuple[int, str]] = []
    count = 0
    for number, line in enumerate(lines, first):
        words = line.split()
        if not words:
            continue
        tokens, found = words, _floats(line, words)
        if found is None:
            tokens, found = _mended(words)
        if found is None:
            if count != expected and _has_number(words):
                _refuse_word(words, file, number)
            text.append((number, line.strip()))
            continue
        if text:
            where, what = text[0]
            raise RecordError(
                f"{_shown(what)} is between the numbers, which continue on line {number}; remove what is not a number",
                file,
                where,
            )
        rows.append(tokens)
        values += found
        numbers_of_lines.append(number)
        count += len(tokens)
    numbers = np.array(values)
    _refuse_infinite(numbers, rows, numbers_of_lines, file)
    *others, last = chain.from_iterable(rows) if rows else ("",)
    return Numbers(
        values=numbers,
        per_line=np.array([len(row) for row in rows], dtype=np.int64),
        last=last.lstrip("+-"),
        shortest=min((len(token) - (token[0] in "+-") for token in others), default=0),
        text_after=tuple(what for _, what in text),
    )


def _floats(line: str, words: list[str]) -> list[float] | None:
    """The words of a line as numbers, or None if one is none; of what these characters spell `float` takes no other."""
    if not _PLAIN.fullmatch(line):
        return None
    try:
        return [*map(float, words)]
    except ValueError:
        return None


def _mended(words: list[str]) -> tuple[list[str], list[float] | None]:
    """The numbers of a line with FORTRAN's exponents and touching columns, or None if it is no such line."""
    line = _LETTER_D.sub("E", " ".join(words))
    if not _PLAIN.fullmatch(line):
        return words, None
    line = _NO_LETTER.sub(r"E\1", line)
    tokens = _GLUED.sub(" ", line).split()
    return tokens, _floats(line, tokens)


def _has_number(words: list[str]) -> bool:
    return any(_is_number(word) for word in words)


def _is_number(word: str) -> bool:
    return _mended([word])[1] is not None


def _refuse_word(words: list[str], file: str, line: int) -> None:
    word = next(word for word in words if not _is_number(word))
    raise RecordError(f"{_shown(word)} is not a number; correct it or get the file anew", file, line)


def _refuse_infinite(values: Array, rows: list[list[str]], lines: list[int], file: str) -> None:
    if np.isfinite(values).all():
        return
    for row, line in zip(rows, lines, strict=True):
        for token in row:
            if not np.isfinite(float(token)):
                raise RecordError(f"{_shown(token)} is too large to be an acceleration", file, line)


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")
