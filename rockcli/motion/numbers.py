"""Parses numbers of record files: FORTRAN exponents, columns that touch, text behind.

Nothing here guesses: whatever is not a finite decimal number is an error that names file and line.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.errors import RecordError

Array = NDArray[np.float64]

_PLAIN = re.compile(r"[0-9.eE+\-\s]*")
_OF_NUMBERS = b"0123456789.eE+- \t\n\v\f\r"
_POWERS = np.array([float(10**k) for k in range(23)])
_LETTER_D = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
_NO_LETTER = re.compile(r"(\d\.\d*|\.\d+)([+-]\d{3})(?![\d.])")
_GLUED = re.compile(r"(?<=[\d.])(?=[+-])")


@dataclass(frozen=True, eq=False)
class Numbers:
    """The numbers of a text.

    Attributes:
        values: in reading order, (k,).
        printed: the same as printed, line by line, apart by blanks.
        text_after: lines without numbers behind the last number.
    """

    values: Array
    printed: bytes
    text_after: tuple[str, ...] = ()

    @cached_property
    def tokens(self) -> list[str]:
        """Each number as it is printed."""
        return self.printed.decode("ascii").split()

    @property
    def per_line(self) -> NDArray[np.int64]:
        """How many stand on each line that has any, (lines,)."""
        return np.array([n for line in self.printed.split(b"\n") if (n := len(line.split()))], dtype=np.int64)

    @property
    def last(self) -> str:
        """The last number as it is printed, without its sign."""
        return self.tokens[-1].lstrip("+-") if self.tokens else ""

    @property
    def shortest(self) -> int:
        """The least length of the others, without signs: a number cut by the end of the file is shorter than they."""
        return min((len(token) - (token[0] in "+-") for token in self.tokens[:-1]), default=0)


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
    text = "\n".join(lines) + "\n"
    found = _read_at_once(text.encode(), expected) if text.isascii() else None
    return found or _read_line_by_line(lines, first, file, expected)


def read_text(text: bytes, first: int, file: str, expected: int | None = None) -> Numbers:
    """`read_numbers` of a text of any number of lines."""
    return _read_at_once(text, expected) or _read_line_by_line(
        text.decode("latin-1").split("\n"), first, file, expected
    )


def _read_at_once(text: bytes, expected: int | None) -> Numbers | None:
    """The numbers of a text that holds nothing but finite ones as `float` takes them; None of others."""
    values = _parsed(text, expected)
    if values is not None:
        return Numbers(values, text)
    if text.translate(None, _OF_NUMBERS):
        return None
    try:
        values = np.array([*map(float, text.split())])
    except ValueError:
        return None
    return Numbers(values, text) if np.isfinite(values).all() else None


def _parsed(text: bytes, expected: int | None) -> Array | None:
    """The same by the compiled kernel, many times faster; None where it is not loaded or leaves a text to `float`."""
    kernel = kernels.in_use_ahead("reading.decimals")
    if kernel is None or not text.endswith(b"\n"):
        return None
    values = np.empty(len(text) // 2 if expected is None else min(expected, len(text) // 2))
    count = kernel.parse(np.frombuffer(text, dtype=np.uint8), _POWERS, values)
    if count == kernel.UNUSUAL:
        return None
    return values if count == len(values) else values[:count].copy()


def _read_line_by_line(lines: list[str], first: int, file: str, expected: int | None) -> Numbers:
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
    after = tuple(what for _, what in text)
    return Numbers(numbers, "\n".join(" ".join(row) for row in rows).encode(), after)


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
    line = _NO_LETTER.sub(r"\1E\2", line)
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
