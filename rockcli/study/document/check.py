"""Checks a study against the schema: unknown keys, wrong types, missing values, one message each."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar, get_args, get_origin

from pydantic import BaseModel, ValidationError

from rockcli.errors import StudyError
from rockcli.study.document.complaints import MOST, short
from rockcli.study.document.tree import Keys, Map, Source, Where, dotted, meant, nearest, place, value_at
from rockcli.study.document.values import ONE_NUMBER, Number, describe, reads_as_number
from rockcli.study.schema import CasePart, Part, StudyPart

P = TypeVar("P", bound=Part)

EXPECTED = {
    "list_": "a list",
    "int_": "a whole number",
    "bool_": "true or false",
    "string_type": "text",
    "string_too_long": "at most {max_length} characters",
    "greater_than_equal": "at least {ge}",
    "less_than_equal": "at most {le}",
}
"""What was expected instead, by the beginning of the kind of pydantic's error."""

_BOUNDS = {
    "too_short": "{actual_length}; expected at least {min_length}",
    "too_long": "{actual_length}; expected at most {max_length}",
}
"""The same of lists, by the kind."""


def check_study(source: Source, study: Map) -> StudyPart:
    """The whole study, validated; all that is wrong with its keys is raised as one StudyError."""
    part = _checked(source, study, StudyPart, ())
    assert part is not None
    return part


def check_with_base(source: Source, study: Map) -> StudyPart:
    """The study, and its case, of which what is missing may come from the axes; raises as `check_study`."""
    alone = Map({**study, "case": {"block": {}}}, study.where)
    part, complaints = _validated(alone, StudyPart, (), complete=True)
    complaints += _validated(study, CasePart, ("case",), complete=False)[1]
    if complaints or part is None:
        raise _error(source, complaints)
    return part


def check_case(source: Source, study: Map) -> CasePart:
    """The case of a study, validated; raises as `check_study`."""
    if not isinstance(study.get("case"), Map):
        raise source.error(study, ("case",), "must be a mapping")
    part = _checked(source, study, CasePart, ("case",))
    assert part is not None
    return part


def said_at(part: Part, keys: Keys) -> Any:
    """The value at `keys` inside a validated part, its default where the study says nothing."""
    found: Any = part
    for key in keys:
        if found is None:
            return None
        found = getattr(found, key) if isinstance(key, str) else found[key]
    return found


def _checked(source: Source, study: Map, part: type[P], at: Keys) -> P | None:
    found, complaints = _validated(study, part, at, complete=True)
    if complaints:
        raise _error(source, complaints)
    return found


_OF_ONE_EDGE = {("block", name) for name in ("alpha", "tan_alpha", "slenderness", "width")}
"""Keys of a body whose two edges are alike."""

Complaint = tuple[Where, str]
"""Where something is wrong, and what."""


def _validated(study: Map, part: type[P], at: Keys, *, complete: bool) -> tuple[P | None, list[Complaint]]:
    """A validated part, or what is wrong with it: unknown keys first, of every value the first thing."""
    try:
        return part.model_validate(value_at(study, at)), []
    except ValidationError as error:
        details: list[dict[str, Any]] = [
            dict(d) for d in error.errors(include_url=False) if complete or d["type"] != "missing"
        ]
    details.sort(key=lambda d: d["type"] != "extra_forbidden")
    told: list[Keys] = []
    misspelt: set[Keys] = set()
    complaints = []
    for detail in details:
        keys = _followed(value_at(study, at), detail["loc"])
        if detail["type"] == "extra_forbidden":
            misspelt.add(keys[:-1])
        if detail["type"] == "missing":
            if keys in misspelt:  # what is missing is written wrongly there
                continue
            keys = (*keys, str(detail["loc"][-1]))
        if not any(keys[: len(one)] == one or one[: len(keys)] == keys for one in told):  # other forms of one value
            told.append(keys)
            complaints.append(_sentence(study, part, at, detail))
    return None, complaints


def _error(source: Source, complaints: list[Complaint]) -> StudyError:
    """All of them as one error, the first at its place."""
    (where, first), *others = complaints
    lines = [f"\n  {_at(at)}{short(sentence)}" for at, sentence in others[: MOST - 1]]
    if len(others) >= MOST:
        lines.append(f"\n  and {len(others) - MOST + 1} more")
    return source.placed(where, first + "".join(lines))


def _of_several(study: Map, keys: Keys, said: str) -> str:
    """A hint where one number is expected and a list of them stands in the case."""
    if keys[:1] != ("case",) or not isinstance(value_at(study, keys), list) or not said.startswith(ONE_NUMBER):
        return ""
    edges = "two different edges are `h` and `b: [left, right]`; " if keys[1:] in _OF_ONE_EDGE else ""
    return f"; {edges}several cases are an axis, `vary: {{{dotted(keys[1:])}: [...]}}`"


def _slip(key: str) -> str:
    """What was meant by a key without a value: the second of 1,8, or a key and its value in one word."""
    if reads_as_number(key):
        return "decimals have a point, 1.8, and several numbers brackets, [1, 8]"
    before, colon, after = key.partition(":")
    return f"a blank belongs behind the colon: {before}: {after}" if colon and before and after else ""


def _at(where: Where) -> str:
    return "" if where is None else f"line {where}: " if isinstance(where, int) else f"{where}: "


def _sentence(study: Map, part: type[Part], at: Keys, detail: dict[str, Any]) -> tuple[Any, str]:
    kind = detail["type"]
    keys = at + _followed(value_at(study, at), detail["loc"])
    where = place(study, keys)
    name = "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in keys).lstrip(".")
    value = describe(value_at(study, keys))
    if kind == "extra_forbidden":
        known = fields_at(part, keys[len(at) : -1])
        if len(keys) == 1 and keys[0] in CasePart.model_fields:
            return where, f"{name}: unknown key {name!r} at this level; did you mean case.{name}?"
        slip = _slip(str(keys[-1])) if value_at(study, keys) is None else ""
        return where, f"{name}: unknown key {str(keys[-1])!r}; {slip or nearest(str(keys[-1]), known)}"
    if kind == "missing":
        missing = detail["loc"][-1]
        inside = f" in {name}" if name else ""
        return where, f"the key {missing!r} is missing{inside}"
    if kind == "literal_error" and keys[-2:] == ("damping", "scheme") and reads_as_number(value_at(study, keys)):
        said = value_at(study, keys)
        return where, f"{dotted(keys[:-1])} is {said}; for that coefficient of restitution write {{eta: {said}}}"
    if kind == "literal_error":
        expected = detail["ctx"]["expected"]
        choices = [word.strip("'") for word in expected.replace(" or ", ", ").split(", ")]
        close = meant(value.strip("'"), choices)
        hint = "" if close is None else f"; did you mean {close!r}?"
        return where, f"{name} is {value}; expected one of {', '.join(choices)}{hint}"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        keys_of_it = ", ".join(fields_at(part, keys[len(at) :]))
        with_keys = f" with the keys {keys_of_it}" if keys_of_it else ""
        return where, f"{name} must be a mapping{with_keys}, not {value}"
    if kind == "string_pattern_mismatch" and detail["loc"][-1] == "[key]":  # of labels and limits of a plot
        return where, f"{name}: unknown key {str(keys[-1])!r}; known: x, y, and y1, y2, ... for the rows of panels"
    if kind == "string_pattern_mismatch":
        return where, f"{name} is {value}; only letters, digits, - and _ are allowed, at most 100 of them"
    if kind == "value_error":
        return where, f"{name}: {detail['ctx']['error']}{_of_several(study, keys, str(detail['ctx']['error']))}"
    if kind in _BOUNDS:
        return where, f"{name} is a list of {_BOUNDS[kind].format(**detail['ctx'])}"
    for begin, expected in EXPECTED.items():
        if kind.startswith(begin):
            one = value_at(study, keys)
            inside = "{...}" if isinstance(one, dict) else str(one) if isinstance(one, int | float | str) else ""
            as_one = f", as [{inside}]" if begin == "list_" and 0 < len(inside) < 60 else ""
            return where, f"{name} is {value}; expected {expected.format(**detail.get('ctx', {}))}{as_one}"
    message = detail["msg"].replace("Input should", "it should")
    return where, f"{name} is {value}: {message[0].lower()}{message[1:]}"


def _followed(tree: Any, loc: tuple[str | int, ...]) -> Keys:
    """The part of pydantic's location that exists in the study."""
    keys: list[str | int] = []
    for item in loc:
        if isinstance(tree, dict):
            inside = item in tree
        else:
            inside = isinstance(tree, list) and isinstance(item, int) and item < len(tree)
        if not inside:
            continue  # a name of pydantic's own for one of several forms
        tree = tree[item]
        keys.append(item)
    return tuple(keys)


def part_at(part: type[BaseModel], keys: Keys) -> type[BaseModel] | None:
    """The mapping at `keys` inside a part; None where anything may stand."""
    named = False  # at a mapping whose keys are the study's own, as of `uncertain`
    for key in keys:
        if isinstance(key, int) or named:
            named = False
            continue
        field = part.model_fields.get(key)
        inner = next(_parts((field.annotation, *field.metadata)), None) if field else None
        if field is None or inner is None:
            return None
        part, named = inner, get_origin(field.annotation) is dict
    return None if named else part


def fields_at(part: type[BaseModel], keys: Keys) -> dict[str, Any]:
    """Known keys of the mapping at `keys` inside a part -> their annotations; empty where anything may stand."""
    inner = part_at(part, keys)
    if inner is None:
        return {}
    return {field.alias or name: (field.annotation, field.metadata) for name, field in inner.model_fields.items()}


def is_number(annotation: Any) -> bool:
    """Whether a key takes a number or an expression (an annotation as `fields_at` gives it)."""
    marks = get_args(Number)[1:]
    if isinstance(annotation, tuple | list):
        return any(is_number(item) for item in annotation)
    return annotation in marks or any(is_number(item) for item in get_args(annotation))


def is_list_of_parts(annotation: Any) -> bool:
    """Whether a key takes a list of mappings (an annotation as `fields_at` gives it)."""
    if isinstance(annotation, tuple | list):
        return any(is_list_of_parts(item) for item in annotation)
    if get_origin(annotation) is list:
        return next(_parts(annotation), None) is not None
    return any(is_list_of_parts(item) for item in get_args(annotation))


def _parts(annotation: Any) -> Iterator[type[Part]]:
    if isinstance(annotation, type) and issubclass(annotation, Part):
        yield annotation
    elif isinstance(annotation, tuple):
        for item in annotation:
            yield from _parts(item)
    else:
        for item in get_args(annotation):
            yield from _parts(item)
