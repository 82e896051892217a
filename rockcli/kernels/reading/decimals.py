"""Decimal numbers apart by blanks, parsed in one pass over the bytes of a text, as Python's `float` does.

Digits that make a whole number up to 2^53, times or over a power of ten up to 1e22: both are doubles without rounding,
so that their product or quotient is rounded once, as it should be (Clinger 1990).  Anything else is left to the caller.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rockcli.kernels.ahead import CHARACTERS, VECTOR
from rockcli.kernels.jit import entry

UNUSUAL = -1
"""What `parse` says of a text that holds anything else, or more numbers than there is room for."""

_TAB, _LINE_FEED, _RETURN, _BLANK, _PLUS, _MINUS, _POINT, _ZERO, _LOWER, _E = (ord(c) for c in "\t\n\r +-.0 e")
"""`_LOWER` is the bit that a small letter has and a capital has not."""

_WHOLE = 2**53
_LONGEST = 18
"""Digits that a whole number of 64 bits takes in any case."""

_EXPONENT = 4
"""Digits of an exponent that is looked at."""

LARGEST = 22
"""Power of ten that is a double without rounding."""

_ONE = np.uint64(1)
"""Places in the text are unsigned: compiled code then need not ask whether they are counted from the end."""


@entry(CHARACTERS, VECTOR, VECTOR, gives=int)
def parse(text: Any, powers: Any, values: Any) -> int:
    """The numbers of a text into `values`.

    Args:
        text: its characters, the last of them a line feed; powers: 1, 10, ... 1e22; values: room for the numbers.

    Returns:
        how many there are, or UNUSUAL: nothing in `values` counts then.
    """
    end, at, count = np.uint64(len(text)), np.uint64(0), 0
    while True:
        # blanks and signs in one loop, so that a processor foresees its end in columns where some numbers have a sign
        signs = 0
        while at < end and text[at] < _POINT:
            c = text[at]
            sign = c in (_MINUS, _PLUS)
            blank = c in (_BLANK, _LINE_FEED, _TAB)
            if not (sign or blank or (c == _RETURN and text[at + _ONE] == _LINE_FEED)):
                return UNUSUAL
            signs += sign
            at += _ONE
        if at >= end:
            return count if signs == 0 else UNUSUAL
        negative, signed = False, False
        if at > np.uint64(0):
            c = text[at - _ONE]
            negative = c == _MINUS
            signed = negative or c == _PLUS
        if signs != signed or count >= len(values):
            return UNUSUAL
        whole: Any = 0
        first = at
        while True:
            digit = np.int64(text[at]) - _ZERO
            if digit < 0 or digit > 9:
                break
            whole = whole * 10 + digit
            at += _ONE
        digits: Any = np.int64(at - first)
        exponent: Any = 0
        if text[at] == _POINT:
            at += _ONE
            first = at
            while True:
                digit = np.int64(text[at]) - _ZERO
                if digit < 0 or digit > 9:
                    break
                whole = whole * 10 + digit
                at += _ONE
            exponent = -np.int64(at - first)
            digits -= exponent
        if digits == 0 or digits > _LONGEST or whole > _WHOLE:
            return UNUSUAL
        if text[at] | _LOWER == _E:
            at += _ONE
            c = text[at]
            down = c == _MINUS
            if down or c == _PLUS:
                at += _ONE
            power: Any = 0
            first = at
            while True:
                digit = np.int64(text[at]) - _ZERO
                if digit < 0 or digit > 9:
                    break
                power = power * 10 + digit
                at += _ONE
            if at == first or np.int64(at - first) > _EXPONENT:
                return UNUSUAL
            exponent += -power if down else power
        if text[at] > _BLANK or exponent < -LARGEST or exponent > LARGEST:
            return UNUSUAL
        size = float(whole)
        if exponent < 0:
            size /= powers[-exponent]
        else:
            size *= powers[exponent]
        values[count] = -size if negative else size
        count += 1
