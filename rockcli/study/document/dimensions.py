"""Dimensions of expressions: what a number with units is of, and whether the key that it stands at is of that."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rockcli.scene.units import written
from rockcli.study.document.expressions import UNITS, ExpressionError, Value, constant, number_of, parse
from rockcli.study.document.paths import UNITS as UNITS_OF_KEYS
from rockcli.study.document.tree import Keys, Map, Source

Dimension = tuple[float, ...]
"""Exponents of what `_BASE` names."""

_BASE = ("rad", "kg", "m", "s")

_NUMBER: Dimension = (0.0, 0.0, 0.0, 0.0)

_MADE_OF = {"N": "kg m s-2", "Pa": "kg m-1 s-2", "Hz": "s-1", "g": "m s-2", "R": "m", "b": "m", "h": "m", "p": "s-1"}
"""Units and symbols in terms of the base; alpha is a number, as it multiplies others."""

_ALIKE = {
    **dict.fromkeys(("cm", "mm", "ft", "inch"), "m"),
    **{"ms": "s", "kN": "N", "t": "kg", "kPa": "Pa", "MPa": "Pa", "GPa": "Pa", "deg": "rad"},
}

OF_KEYS: dict[str, str] = {
    **UNITS_OF_KEYS,
    **dict.fromkeys(("T", "window", "periods", "fixed_base_period", "dt_out", "time"), "s"),
    **dict.fromkeys(("f", "bandpass"), "s-1"),
    **dict.fromkeys(("S_a", "S_XS", "S_X1"), "m s-2"),
    **{"S_v": "m s-1", "pixel": "m", "slide_peak": "m", "slide_residual": "m"},
    **dict.fromkeys(
        ("tan_alpha", "slenderness", "inertia", "mu", "static", "kinetic", "e_n", "scale", "polarity"), "1"
    ),
    **dict.fromkeys(("a_p_over_g_tan_alpha", "pga_over_g_tan_alpha", "omega_p_over_p", "floor_scale", "cycles"), "1"),
    **dict.fromkeys(("gamma", "fraction", "taper", "zeta", "tolerance", "rtol", "rotation", "beta_added"), "1"),
    **dict.fromkeys(("eta", "r_energy", "loss", "coefficient", "alpha_d", "W_over_Mg"), "1"),
}
"""Units of numbers by the last key above them; what is not listed takes any."""


def check_unit(text: str, keys: Keys, let: Map | None = None) -> None:
    """Refuse an expression whose units make another kind of number than the one wanted at `keys`.

    A number without a unit is in SI units, whatever is wanted; a symbol of `let` is what its own expression is of.

    Raises:
        ExpressionError: naming what it is of and what is expected, or it is none.
    """
    last = next((key for key in reversed(keys) if isinstance(key, str)), "")
    if last in OF_KEYS and keys[0] != "let":
        check_of_unit(text, OF_KEYS[last], let)


def stated_number(
    source: Source, study: Map, keys: Keys, value: float | str, lookup: Callable[[str], Value] = constant
) -> float:
    """`number_of` a value that stands at `keys`, where a `StudyError` says what is wrong with it or with its unit."""
    try:
        number = number_of(value, lookup)
        if isinstance(value, str):
            check_unit(value, keys)
    except ExpressionError as error:
        raise source.error(study, keys, f": {error}") from None
    return number


def check_of_unit(text: str, unit: str, let: Map | None = None) -> None:
    """Refuse an expression whose units are not those of `unit`, one of a dataset; raises ExpressionError."""
    found = _dimension(text, Map() if let is None else let, ())
    if found is None or found == _NUMBER:
        return
    if not {"", *_BASE, *_MADE_OF}.issuperset(map(_bare, unit.split())):  # years, the intensity of a suite
        return
    wanted, (angle, mass, length, _) = _of_unit(unit), found
    # beside a mass or a length an angle is a factor; alone, or over a time, it is what the number is of
    first = 0 if angle and not mass and not length else 1
    if found[first:] != wanted[first:]:
        base = " ".join(f"{b}{'' if n == 1 else f'{n:g}'}" for b, n in zip(_BASE, found, strict=True) if n)
        said = next((name for name in ("N", "Pa") if _of_unit(name) == found), base)
        expected = "a number without a unit" if unit == "1" else f"a number of {written(unit)}"
        raise ExpressionError(f"{text.strip()!r} is in {written(said)}; expected {expected}")


@cache
def _of_unit(unit: str) -> Dimension:
    """The dimension of a unit as datasets write it: `rad s-1`, `N m-3`, `1`."""
    total = np.zeros(len(_BASE))
    for word in unit.split() if unit != "1" else ():
        name = _bare(word)
        alike, times = _ALIKE.get(name, name), float(word[len(name) :] or 1)
        total += times * np.array(_of_unit(_MADE_OF[alike]) if alike in _MADE_OF else np.array(_BASE) == alike)
    return tuple(total.tolist())


def _bare(word: str) -> str:
    """A unit without its exponent."""
    return word.rstrip("-0123456789")


def _dimension(text: str, let: Map, busy: tuple[str, ...]) -> Dimension | None:
    """What an expression is of, None where that is not known: a symbol or a power of a number may have a unit.

    Raises:
        ExpressionError: it adds numbers of different units.
    """
    stack: list[tuple[Dimension | None, float | None]] = []  # with the value of a number, which may be an exponent
    for kind, what in parse(text).steps:
        if kind == "number":
            stack.append((_NUMBER, what))
        elif kind == "name":
            stack.append((_of_name(what, let, busy), None))
        elif kind == "call":
            of, value = stack.pop()
            power = {np.negative: 1.0, np.sqrt: 0.5}.get(what, 0.0)
            found = None if of is None and power else tuple(power * n for n in of or _NUMBER)
            stack.append((found, -value if value is not None and what is np.negative else None))
        else:
            (y, power_of), (x, _) = stack.pop(), stack.pop()
            stack.append((_applied(text, what, x, y, power_of), None))
    return stack.pop()[0]


def _of_name(name: str, let: Map, busy: tuple[str, ...]) -> Dimension | None:
    if name in UNITS or name in _MADE_OF:
        return _of_unit(name)
    if name not in let:
        return _NUMBER
    said = let[name]
    return _dimension(said, let, (*busy, name)) if isinstance(said, str) and name not in busy else None


def _applied(
    text: str, what: Callable[..., Any], x: Dimension | None, y: Dimension | None, power: float | None
) -> Dimension | None:
    if what in (np.add, np.subtract):
        kinds = {of for of in (x, y) if of is not None and any(of)}
        if len(kinds) > 1:
            raise ExpressionError(f"{text.strip()!r} adds numbers of different units")
        return kinds.pop() if kinds else x if x == y else None
    if what in (np.multiply, np.divide):
        sign = 1.0 if what is np.multiply else -1.0
        return None if x is None or y is None else tuple(a + sign * b for a, b in zip(x, y, strict=True))
    return None if x is None or x == _NUMBER or power is None else tuple(n * power for n in x)
