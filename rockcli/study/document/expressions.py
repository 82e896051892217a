"""Arithmetic expressions of the study file: parsed once, evaluated on numbers or arrays, and nothing else.

The grammar is that of `ast` with all but numbers, names, + - * / **, parentheses and a few functions refused; the
program that is left is a short list of steps, so that no expression can loop, look anything up or recurse.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.study.document.tree import nearest

Value = float | NDArray[np.float64]

MAX_LENGTH = 500
MAX_DEPTH = 200

UNITS: dict[str, float] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "ft": 0.3048,
    "inch": 0.0254,
    "s": 1.0,
    "ms": 1e-3,
    "N": 1.0,
    "kN": 1e3,
    "kg": 1.0,
    "t": 1e3,
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": 1e6,
    "GPa": 1e9,
    "deg": float(np.pi / 180.0),
    "rad": 1.0,
    "Hz": 1.0,
}
"""Units in SI; Hz is 1/s, for `f_p`."""

CONSTANTS: dict[str, float] = {"pi": float(np.pi), **UNITS}

SYMBOLS: tuple[str, ...] = ("R", "alpha", "tan_alpha", "b", "h", "p")
"""What the block of a case is called in expressions; `g` beside them is known before the block."""

MEANINGS: dict[str, str] = {
    "g": "acceleration of gravity [m/s²], case.g",
    "R": "distance from the edge to the centre of mass [m]",
    "alpha": "slenderness angle atan(b/h) [rad]",
    "tan_alpha": "tangent of the slenderness angle, b/h [1]",
    "b": "distance from the centre of mass to the edge [m]",
    "h": "height of the centre of mass above the base [m]",
    "p": "frequency parameter sqrt(m g R/I_O) [rad/s]; not in the block itself",
}
"""What the symbols of a case mean; of an asymmetric body they are those of the edge with the smaller alpha."""

FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sqrt": np.sqrt,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "atan": np.arctan,
    "exp": np.exp,
    "log": np.log,
}


class ExpressionError(ValueError):
    """What is wrong with an expression, in words; `index` is the first case concerned, if it is an array's."""

    def __init__(self, message: str, index: int = 0) -> None:
        super().__init__(message)
        self.index = index


def _power(x: Any, y: Any) -> Any:
    # a square is a product everywhere, so that one case and a million cases agree to the last bit
    return x * x if np.ndim(y) == 0 and y == 2.0 else np.power(x, y)


_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: _power,
}

_TOKENS = re.compile(
    r"(?>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?(?![0-9A-Za-z_.])|[A-Za-z_][A-Za-z_0-9]*+|[-+*/() ])*+\Z"
)

_Step = tuple[str, Any]


@dataclass(frozen=True)
class Expression:
    """A parsed expression: its text, the names it needs, and its steps in reverse Polish order."""

    text: str
    names: frozenset[str]
    steps: tuple[_Step, ...]

    def evaluate(self, lookup: Callable[[str], Value]) -> Value:
        """Its value; `lookup` gives the value of a name.

        Raises:
            ExpressionError: the value is not a finite real number.
        """
        stack: list[Any] = []
        with np.errstate(all="ignore"):
            for kind, what in self.steps:
                if kind == "number":
                    stack.append(np.float64(what))
                elif kind == "name":
                    stack.append(np.asarray(lookup(what), dtype=np.float64)[()])
                elif kind == "call":
                    stack.append(what(stack.pop()))
                else:
                    right = stack.pop()
                    stack.append(what(stack.pop(), right))
        result = stack.pop()
        if not np.isfinite(result).all():
            first = int(np.argmin(np.isfinite(result)))
            raise ExpressionError(f"{self.text!r} gives {np.ravel(result)[first]}, not a finite number", first)
        return float(result) if np.ndim(result) == 0 else result


def constant(name: str) -> Value:
    """Value of a unit or of pi, the lookup of an expression outside a case; `ExpressionError` for any other name."""
    if name in CONSTANTS:
        return CONSTANTS[name]
    raise ExpressionError(f"`{name}` is not known here, only numbers, units and pi")


def number_of(value: float | str, lookup: Callable[[str], Value] = constant) -> float:
    """A number as a study says it outside its cases: itself, or an expression of what `lookup` knows.

    Raises:
        ExpressionError: text that is no such expression.
    """
    return float(parse(value).evaluate(lookup)) if isinstance(value, str) else float(value)


def says_its_unit(value: object) -> bool:
    """Whether a value is an expression that names a unit, or g."""
    try:
        return isinstance(value, str) and bool(parse(value).names & {"g", *UNITS})
    except ExpressionError:
        return False


@lru_cache(maxsize=4096)
def parse(text: str) -> Expression:
    """Parse an expression.

    Raises:
        ExpressionError: it is not arithmetic.
    """
    shown = text if len(text) <= 60 else text[:57] + "..."
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{shown!r} is longer than {MAX_LENGTH} characters")
    text = text.strip()
    if not text:
        raise ExpressionError("is empty: a number or an arithmetic expression is expected")
    if _PLUS_MINUS.search(text):  # 0.45 +- 0.05 would be 0.4
        raise ExpressionError(
            f"{shown!r} is not arithmetic: write the value alone, and what it may be off by under `uncertain`: "
            "{normal: [mean, standard deviation]}"
        )
    if not _TOKENS.match(text):
        allowed = "numbers, names, + - * / **, ( ) and functions are allowed"
        raise ExpressionError(f"{shown!r} is not arithmetic: {_slip(text) or allowed}")
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        slip = _slip(text) or "products need a *: 10*mm"
        raise ExpressionError(f"{shown!r} is not an arithmetic expression: {slip}") from None
    steps: list[_Step] = []
    names: set[str] = set()
    _translate(tree, steps, names, 0)
    return Expression(text, frozenset(names), tuple(steps))


_SHARE = re.compile(r"([0-9]+\.?[0-9]*|\.[0-9]+)\s*%")
_DEGREES = re.compile(r"(-?[0-9.]+)\s*\N{DEGREE SIGN}")
_COMMA = re.compile(r"[0-9],[0-9]")
_PRODUCT = re.compile(r"(?<![\w.])((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*([A-Za-z_]\w*|\()")
_PLUS_MINUS = re.compile(r"\N{PLUS-MINUS SIGN}|\+\s*/\s*-|(?<![eE])\+-\s*[0-9.]+(\s*\*\s*[A-Za-z]+)?\s*$")


def _slip(text: str) -> str | None:
    """What was probably meant by text that is no expression; None if nobody knows."""
    if (share := _SHARE.fullmatch(text)) is not None:
        return f"a share is a number: write {float(share[1]) / 100:g}"
    if (angle := _DEGREES.fullmatch(text)) is not None:
        return f"write {angle[1]}*deg"
    if "^" in text:
        return "write ** for ^"
    if _COMMA.search(text):
        return "write decimals with a point"
    if text[-1] in "+-*/":
        return "it ends with an operator"
    if (product := _PRODUCT.search(text)) is not None:
        number, factor = product.groups()
        return f"products need a *: write {number}*{'(...)' if factor == '(' else factor[:40]}"
    if (opened := text.count("(") - text.count(")")) != 0:
        return f"it lacks {abs(opened)} {')' if opened > 0 else '('}"
    return None


def _translate(node: ast.AST, steps: list[_Step], names: set[str], depth: int) -> None:
    if depth > MAX_DEPTH:
        raise ExpressionError(f"is nested too deeply (at most {MAX_DEPTH} levels)")
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        try:
            steps.append(("number", float(node.value)))
        except OverflowError:
            raise ExpressionError("holds a number that is too large") from None
    elif isinstance(node, ast.Name):
        if node.id in FUNCTIONS:
            raise ExpressionError(f"uses the function `{node.id}` without an argument")
        names.add(node.id)
        steps.append(("name", node.id))
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        _translate(node.left, steps, names, depth + 1)
        _translate(node.right, steps, names, depth + 1)
        steps.append(("apply", _OPERATORS[type(node.op)]))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        _translate(node.operand, steps, names, depth + 1)
        if isinstance(node.op, ast.USub):
            steps.append(("call", np.negative))
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        if node.func.id not in FUNCTIONS:
            raise ExpressionError(f"calls the unknown function `{node.func.id}`; {nearest(node.func.id, FUNCTIONS)}")
        if len(node.args) != 1 or node.keywords or isinstance(node.args[0], ast.Starred):
            raise ExpressionError(f"`{node.func.id}` takes one argument")
        _translate(node.args[0], steps, names, depth + 1)
        steps.append(("call", FUNCTIONS[node.func.id]))
    elif isinstance(node, ast.Call):
        raise ExpressionError("is not arithmetic: products need a *, also before a parenthesis")
    else:
        raise ExpressionError("is not arithmetic: numbers, names, + - * / **, ( ) and functions are allowed")
