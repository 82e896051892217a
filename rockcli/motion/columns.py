"""Numbers in columns of one width, as FORTRAN's and C's formats with exponents print them: all parsed at once.

Nine tenths of the time of reading a record is that of turning words into numbers.  Where every number of a text has its
point, its exponent and its end in the same place of its column, as in the files of PEER, arrays of digits do.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["numbers_in_columns"]

Array = NDArray[np.float64]

EXACT = 22
"""Largest power of ten that is a double without rounding."""

DIGITS = 15
"""A number of so many digits is one, too."""

_BLANK, _SIGN, _DIGIT, _OTHER = 0, 1, 2, 3
_KINDS = dict.fromkeys(b" ", _BLANK) | dict.fromkeys(b"+-", _SIGN) | dict.fromkeys(b"0123456789", _DIGIT)
_KIND = bytes(_KINDS.get(character, _OTHER) for character in range(256))


def numbers_in_columns(text: bytes) -> Array | None:
    """The numbers of a text, as `float` makes them, (k,); None unless they stand in columns of one width.

    Every line has as many characters but the last, which may have fewer columns; the text ends with a line end.  A
    number is mantissa with a point, E and an exponent with a sign, right-aligned.  Mantissa and power of ten are exact,
    so that their product or quotient is rounded once, as it should be; None too where they are not.
    """
    first = text.find(b"\n") + 1
    width = _width(text[: first - 1])
    if not width or first > len(text) or text[-1:] != b"\n":
        return None
    whole = len(text) // first
    rest = text[whole * first :]
    if len(rest) and (len(rest) - 1) % width:
        return None
    lines = np.frombuffer(text, dtype=np.uint8, count=whole * first).reshape(whole, first)
    last = np.frombuffer(rest[:-1], dtype=np.uint8).reshape(-1, width)
    if (lines[:, -1] != ord("\n")).any():
        return None
    cells = np.concatenate([lines[:, :-1].reshape(-1, width), last])
    return _parsed(np.ascontiguousarray(cells.T))


def _width(line: bytes) -> int:
    """Characters of a column, by the first line; 0 where its numbers do not end in equal distances."""
    words = line.split()
    if not words or len(line) % len(words) or not line.endswith(words[-1]):
        return 0
    width = len(line) // len(words)
    return width if [line[i : i + width].split() for i in range(0, len(line), width)] == [[w] for w in words] else 0


def _parsed(cells: NDArray[np.uint8]) -> Array | None:
    """The numbers of cells, (width, k) characters."""
    first = bytes(cells[:, 0])
    point, letter = first.find(b"."), first.upper().find(b"E")
    if not 0 <= point < letter < len(first) - 2:
        return None
    behind, last = slice(point + 1, letter), slice(letter + 2, len(first))
    before = np.frombuffer(cells[:point].tobytes().translate(_KIND), dtype=np.uint8).reshape(point, cells.shape[1])
    fraction, power, sign = cells[behind] - _ZERO, cells[last] - _ZERO, cells[letter + 1]
    down = sign == ord("-")
    if (
        (cells[point] != ord(".")).any()
        or (cells[letter] | 32 != ord("e")).any()
        or not (down | (sign == ord("+"))).all()
        or letter - point == 1
        or letter - 1 > DIGITS
        or max(fraction.max(), power.max()) > 9  # characters before 0 are large here
        or (before == _OTHER).any()
        or (before[1:] < before[:-1]).any()  # blanks, then a sign, then digits
        or ((before == _SIGN).sum(axis=0) > 1).any()
    ):
        return None
    whole = np.where(before == _DIGIT, cells[:point] - _ZERO, 0)
    mantissa = _said(np.concatenate([whole, fraction]))
    exponent = np.where(down, -1.0, 1.0) * _said(power) - len(fraction)
    if (np.abs(exponent) > EXACT).any():
        return None
    ten = _POWERS[np.abs(exponent).astype(np.int64)]
    size = np.where(exponent < 0.0, mantissa / ten, mantissa * ten)
    return np.asarray(np.where((cells[:point] == ord("-")).any(axis=0), -size, size))


def _said(digits: NDArray[np.uint8]) -> Array:
    """Whole numbers of digits, (n, k): (k,).  Two digits are a number below a hundred before they are doubles."""
    if len(digits) % 2:
        digits = np.concatenate([np.zeros_like(digits[:1]), digits])
    pairs = digits[::2] * np.uint8(10) + digits[1::2]
    return np.asarray(_POWERS[2 * len(pairs) - 2 :: -2] @ pairs.astype(np.float64))


_ZERO = np.uint8(48)
_POWERS = np.array([float(10**k) for k in range(EXACT + 1)])
