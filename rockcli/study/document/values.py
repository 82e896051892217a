"""Types of the values of a study file: numbers, names, lists, each with the sentence for what does not fit."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema

from rockcli.scene.laws.damping import HOUSNER
from rockcli.scene.variables import IMPACT, SCALARS, TIME, VARIABLES
from rockcli.study.document.expressions import ExpressionError, parse
from rockcli.study.document.tree import nearest

WEAKEST = "weakest"
"""The direction of the least barrier."""

ONE_NUMBER = "a number or an expression is expected"

LENGTHS = ("m", "cm", "mm", "ft", "inch")
"""Units that a mesh may be in."""


def number_or_expression(value: Any) -> Any:
    """A finite number or the text of an expression."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"{ONE_NUMBER}, not {describe(value)}")
    if isinstance(value, str):
        try:
            parse(value)
        except ExpressionError as error:
            raise ValueError(str(error)) from None
    elif not is_finite(value):
        raise ValueError(f"a finite number is expected, not {value}")
    return value


def is_finite(value: float) -> bool:
    """Whether a number is finite as a float."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def reads_as_number(value: Any) -> bool:
    """Whether a number or a text is one as Python reads it; an expression is not."""
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return True


def describe(value: Any) -> str:
    """A value as an error message shows it."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    if value is None:
        return "nothing"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _edges(value: Any) -> Any:
    if isinstance(value, list):
        if len(value) != 2:
            raise ValueError("a number, or the two distances [left, right], is expected")
        return [number_or_expression(item) for item in value]
    return number_or_expression(value)


def _number_or(word: str) -> BeforeValidator:
    return BeforeValidator(lambda value: value if value == word else number_or_expression(value))


def _row(names: str) -> BeforeValidator:
    """That a value is as many numbers as there are names."""
    n = len(names.split(","))

    def numbers(value: Any) -> Any:
        if not isinstance(value, list) or len(value) != n:
            short = n == 2 and isinstance(value, list) and len(repr(value)) < 60
            shown = repr(list(value)) if short else describe(value)
            raise ValueError(f"{'two' if n == 2 else n} numbers, [{names}], are expected, not {shown}")
        return [number_or_expression(item) for item in value]

    return BeforeValidator(numbers)


def _axes(value: Any) -> Any:
    names = value if isinstance(value, list) else [value]
    if not names or not all(isinstance(name, str) for name in names):
        raise ValueError(f"the name of an axis, or a list of names, is expected, not {describe(value)}")
    return value


def _files(value: Any) -> Any:
    names = value if isinstance(value, list) and len(value) > 1 else [value]
    for name in names:
        if not isinstance(name, str) or not name.strip():
            raise ValueError(f"a file name is expected, not {describe(name)}")
    return value


def _outline(value: Any) -> Any:
    if isinstance(value, str) and value.strip().lower().endswith(".csv"):
        return value
    if not isinstance(value, list):
        raise ValueError(f"points [[x, z], ...] or FILE.csv are expected, not {describe(value)}")
    if len(value) < 3:
        raise ValueError(f"at least 3 points [x, z] are expected, not {len(value)}")
    for i, point in enumerate(value):
        if not isinstance(point, list) or len(point) != 2:
            shown = list(point) if isinstance(point, list) else point
            raise ValueError(f"point {i + 1} is {describe(repr(shown))}; two numbers, [x, z], are expected")
        for number in point:
            number_or_expression(number)
    return value


def _label(value: Any) -> Any:
    """A name: what YAML reads as a number or a truth value is meant as text."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(f"a name is expected, not {describe(value)}")
    return str(value)


def _scalars(value: Any) -> Any:
    if value == "all":
        return value
    if not isinstance(value, list) or not value:
        raise ValueError(f"`all` or a list of scalars is expected, not {describe(value)}")
    for name in value:
        if name not in SCALARS:
            raise ValueError(f"{describe(name)} is {_why_no_scalar(str(name))}")
    return value


def _why_no_scalar(name: str) -> str:
    if name not in VARIABLES:
        return f"no scalar; {nearest(name, SCALARS)}"
    if VARIABLES[name].over in (TIME, IMPACT):
        return "a history: `histories: true` saves it"
    return "in the dataset without being listed, where there is one: leave it out"


def _histories(value: Any) -> Any:
    if not isinstance(value, bool | dict):
        raise ValueError(f"true, false or {{axis: value}} is expected, not {describe(value)}")
    return value


def _audit(value: Any) -> Any:
    if isinstance(value, bool):
        return value
    if not isinstance(value, int | float) or not 0.0 < value <= 1.0:
        expected = "true, false or a share of the cases, above 0 and up to 1,"
        raise ValueError(f"{expected} is expected, not {describe(value)}")
    return float(value)


NUMBER_SCHEMA: dict[str, Any] = {"type": ["number", "string"]}


def _numbers_schema(n: int) -> dict[str, Any]:
    return {"type": "array", "items": NUMBER_SCHEMA, "minItems": n, "maxItems": n}


PAIR_SCHEMA = _numbers_schema(2)
Number = Annotated[Any, BeforeValidator(number_or_expression), WithJsonSchema(NUMBER_SCHEMA)]
Pair = Annotated[Any, _row("from, to"), WithJsonSchema(PAIR_SCHEMA)]
MeanAndSpread = Annotated[Any, _row("mean, standard deviation"), WithJsonSchema(PAIR_SCHEMA)]
MedianAndSpread = Annotated[Any, _row("median, standard deviation of the logarithm"), WithJsonSchema(PAIR_SCHEMA)]
Span = Annotated[Any, _row("lowest, highest"), WithJsonSchema(PAIR_SCHEMA)]
Point = Annotated[Any, _row("x, z"), WithJsonSchema(PAIR_SCHEMA)]
Site = Annotated[Any, _row("longitude, latitude"), WithJsonSchema(PAIR_SCHEMA)]
Triple = Annotated[Any, _row("lowest, most likely, highest"), WithJsonSchema(_numbers_schema(3))]
Quadruple = Annotated[Any, _row("a, b, lowest, highest"), WithJsonSchema(_numbers_schema(4))]
Axes = Annotated[
    Any,
    BeforeValidator(_axes),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]}),
]
Edges = Annotated[Any, BeforeValidator(_edges), WithJsonSchema({"anyOf": [NUMBER_SCHEMA, PAIR_SCHEMA]})]
Outline = Annotated[
    Any,
    BeforeValidator(_outline),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": PAIR_SCHEMA, "minItems": 3}]}),
]
Series = Annotated[
    Any,
    BeforeValidator(
        lambda value: (
            [number_or_expression(v) for v in value] if isinstance(value, list) else number_or_expression(value)
        )
    ),
    WithJsonSchema({"anyOf": [NUMBER_SCHEMA, {"type": "array", "items": NUMBER_SCHEMA, "minItems": 1}]}),
]
Eta = Annotated[Any, _number_or(HOUSNER), WithJsonSchema({"anyOf": [{"const": HOUSNER}, NUMBER_SCHEMA]})]
Direction = Annotated[Any, _number_or(WEAKEST), WithJsonSchema({"anyOf": [{"const": WEAKEST}, NUMBER_SCHEMA]})]
Label = Annotated[str, BeforeValidator(_label)]
Text = Annotated[str, Field(max_length=10_000)]
Files = Annotated[
    Any,
    BeforeValidator(_files),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 2}]}),
]

Audit = Annotated[
    Any,
    BeforeValidator(_audit),
    WithJsonSchema({"anyOf": [{"type": "boolean"}, {"type": "number", "exclusiveMinimum": 0, "maximum": 1}]}),
]
Histories = Annotated[Any, BeforeValidator(_histories), WithJsonSchema({"type": ["boolean", "object"]})]
Scalars = Annotated[
    Any,
    BeforeValidator(_scalars),
    WithJsonSchema({"anyOf": [{"const": "all"}, {"type": "array", "items": {"enum": list(SCALARS)}, "minItems": 1}]}),
]
Meaning = Annotated[
    Any, WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]})
]
