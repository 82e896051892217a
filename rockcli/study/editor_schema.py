"""The JSON Schema of a study for editors and validators: the form of `schema.py`, and what else can be said of it.

Keys that say the same thing exclude one another, numbers have ranges, words are listed, the paths of `vary` complete.
What only a case can tell (an expression that nothing defines, a point on no axis) is left to `rock check`.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator
from itertools import combinations
from typing import Any

from rockcli.motion.units import UNIT_NAMES
from rockcli.scene.ground.amplitudes import PULSE_AMPLITUDES, PULSE_FREQUENCIES
from rockcli.scene.ground.pulses import SHAPES
from rockcli.scene.laws.damping import SCHEMES
from rockcli.scene.thresholds import FOUND
from rockcli.scene.variables import IMPACT, ROTATION, TIME, VARIABLES
from rockcli.study.document.expressions import CONSTANTS, FUNCTIONS, SYMBOLS
from rockcli.study.document.overlay import ALTERNATIVES, KINDS, SIZES
from rockcli.study.document.values import NUMBER_SCHEMA
from rockcli.study.expect import CHECKS, MEANINGS
from rockcli.study.schema import OUTLINES, json_schema

Schema = dict[str, Any]

DIALECT = "https://json-schema.org/draft/2020-12/schema"

IDENTIFIER = "urn:rockcli:study"

EXPRESSION = (
    r"^(?!.*[0-9)]\s+[A-Za-z0-9_(])"  # no sign between two values: 10 deg
    r"(?!.*(^|[^A-Za-z0-9_.])[0-9.]+[A-DF-Za-df-z_])"  # 2pi
    r"(?!.*[*/+-]\s*$)[A-Za-z0-9_.+*/() \t-]+%?\s*$"
)
"""Of the text of an expression."""

POSITIVE: dict[str, tuple[str, ...]] = {
    "BlockPart": (
        *("R", "h", "b", "height", "width", "alpha", "tan_alpha", "slenderness"),
        *("r_g", "top", "mass", "mu", "density", "depth", "pixel"),
    ),
    "SolidPart": ("density", "depth"),
    "PulsePart": ("omega_p", "T_p", "f_p", "omega_p_over_p", "cycles"),
    "OscillatorPart": ("T", "f"),
    "ColumnPart": ("E", "rho"),
    "BasePart": ("kw",),
    "CasePart": ("g",),
    "SolverPart": ("rtol", "dt", "yield_rotation"),
    "SavePart": ("dt_out",),
}
"""Keys of numbers above zero."""

RANGES: dict[tuple[str, str], Schema] = {
    ("BlockPart", "alpha"): {"exclusiveMaximum": 0.5 * math.pi},
    ("BlockPart", "inertia"): {"minimum": 1},
    ("BlockPart", "e_n"): {"minimum": 0, "maximum": 1},
    ("ColumnPart", "zeta"): {"minimum": 0},
    ("DampingPart", "eta"): {"minimum": 0, "maximum": 1},
    ("DampingPart", "r_energy"): {"minimum": 0, "maximum": 1},
    ("InitialPart", "theta"): {"exclusiveMinimum": -0.5 * math.pi, "exclusiveMaximum": 0.5 * math.pi},
    ("ModelPart", "tolerance"): {"exclusiveMinimum": 0, "maximum": 1},
    ("SolverPart", "rtol"): {"exclusiveMaximum": 1},
    ("ExpectPart", "rtol"): {"minimum": 0},
    ("ExpectPart", "atol"): {"minimum": 0},
    ("RecordPart", "polarity"): {"enum": [1, -1, "1", "-1"]},
}
"""Other ranges of numbers."""

ONE_POINT: Schema = {
    "anyOf": [
        {"type": "array", "minItems": 1, "uniqueItems": True},
        {"$ref": "#/$defs/Range"},
        {"$ref": "#/$defs/Settings"},
        {"type": "string"},
    ]
}
"""Forms of an entry of `vary`."""


def editor_schema() -> Schema:
    """The schema, a tree of its own, for JSON Schema 2020-12."""
    schema: Schema = json.loads(json.dumps(json_schema()))
    _without_titles(schema)
    parts = {**schema["$defs"], "StudyPart": schema}
    for name, part in parts.items():
        _exclude(part)
        for key in POSITIVE.get(name, ()):
            _restrict(part["properties"][key], {"exclusiveMinimum": 0})
    for (name, key), words in RANGES.items():
        _restrict(parts[name]["properties"][key], words)
    for node in _numbers(schema):
        node["pattern"] = EXPRESSION
    _block(parts["BlockPart"])
    _kinds(parts)
    _expectations(parts["ExpectPart"])
    parts["RecordPart"]["properties"]["units"]["anyOf"] = [{"type": "string", "pattern": _units()}, {"type": "null"}]
    taken = "|".join(sorted({*SYMBOLS, "g", *FUNCTIONS, *CONSTANTS}))
    schema["properties"]["let"]["propertyNames"] = {"pattern": rf"^(?!({taken})$)[A-Za-z_][A-Za-z0-9_]*$"}
    for key in ("name", "title", "references"):  # what reads as a number is text there too
        schema["properties"][key]["type"] = ["string", "number"]
    schema["properties"]["name"]["pattern"] = r"^[A-Za-z0-9_-]{1,100}$"
    _axes(schema)
    _need(schema)
    _complete(schema)
    return {"$schema": DIALECT, "$id": IDENTIFIER, "title": "Study of rocking bodies", **schema}


def _without_titles(schema: Schema) -> None:
    """Names of classes and keys made into words say nothing to a reader."""
    for part in (schema, *schema["$defs"].values()):
        part.pop("title", None)
        for described in part.get("properties", {}).values():
            described.pop("title", None)


def _given(*keys: str) -> Schema:
    """That at least one of some keys is there and says something."""
    said = [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in keys]
    return said[0] if len(said) == 1 else {"anyOf": said}


def _add(part: Schema, rules: Iterable[Schema]) -> None:
    part.setdefault("allOf", []).extend(rules)


def _never(*together: Schema) -> Schema:
    return {"not": {"allOf": list(together)}}


def _exclude(part: Schema) -> None:
    """Keys of one mapping that say the same thing in different ways."""
    known = part.get("properties", {}).keys()
    rules = []
    for group in ALTERNATIVES:
        here = sorted(group & known)
        rules += [_never(_given(a), _given(b)) for a, b in combinations(here, 2)]
    if rules:
        _add(part, rules)


def _forms(node: Schema) -> Iterator[Schema]:
    """The forms of a value, one or several."""
    yield from node.get("anyOf", [node])


def _is_number(form: Schema) -> bool:
    return bool(form.get("type") == NUMBER_SCHEMA["type"])


def _restrict(node: Schema, words: Schema) -> None:
    """Limit the numbers that a key takes; an expression is text, which ranges leave alone."""
    for form in _forms(node):
        if _is_number(form):
            form.update(words)
        for item in form.get("anyOf", ()):
            _restrict(item, words)
        if "items" in form:
            _restrict(form["items"], words)


def _numbers(tree: Any) -> Iterator[Schema]:
    """Every place that takes a number or an expression."""
    if isinstance(tree, dict):
        if _is_number(tree) and "enum" not in tree:
            yield tree
        for item in tree.values():
            yield from _numbers(item)
    elif isinstance(tree, list):
        for item in tree:
            yield from _numbers(item)


def _block(part: Schema) -> None:
    """Two sizes are enough, and an outline or a mesh says all of them."""
    sizes = [_given(*sorted(group)) for group in SIZES]
    shapes = _given(*OUTLINES)
    _add(part, (_never(*three) for three in combinations(sizes, 3)))
    _add(part, (_never(shapes, size) for size in sizes))
    _add(part, [_never(_given(key), {"not": shapes}) for key in ("density", "pixel", "contacts", "parts")])
    _add(part, [_never(_given(key), {"not": _given("mesh")}) for key in ("units", "direction")])


def _kinds(parts: dict[str, Schema]) -> None:
    """What belongs to some kinds alone: options of pulses, keys of damping schemes and of the base."""
    for part, word, kinds, otherwise in (
        ("PulsePart", "shape", {name: shape.options for name, shape in SHAPES.items()}, None),
        ("DampingPart", "scheme", {n: tuple(k.name for k in s.keys) for n, s in SCHEMES.items()}, "restitution"),
        ("BasePart", "law", KINDS["law"], "rigid"),
    ):
        every = {key for keys in kinds.values() for key in keys}
        for name, keys in kinds.items():
            if alien := sorted(every - set(keys)):
                this: Schema = {"required": [word], "properties": {word: {"const": name}}}
                if name == otherwise:
                    this = {"anyOf": [this, {"not": {"required": [word]}}]}
                _add(parts[part], [_never(this, _given(*alien))])


def _expectations(part: Schema) -> None:
    judged = [name for name, row in VARIABLES.items() if row.over != IMPACT]
    part["properties"]["quantity"] = {
        "description": part["properties"]["quantity"]["description"],
        "anyOf": [{"enum": judged}, {"type": "string", "pattern": rf"{FOUND}|_(p16|p50|p84|mean)$"}],
    }
    meaning = {"enum": list(MEANINGS)}
    for key in ("is", "is_not"):
        described = part["properties"][key]["description"]
        several = {"type": "array", "items": meaning, "minItems": 1}
        part["properties"][key] = {"description": described, "anyOf": [meaning, several, {"type": "null"}]}
    for key, over in (("time", TIME), ("rotation", ROTATION)):
        those = [name for name in judged if VARIABLES[name].over == over]
        _add(part, [{"if": _given(key), "then": {"properties": {"quantity": {"enum": those}}}}])
        if over == TIME:
            _add(part, [{"if": {"properties": {"quantity": {"enum": those}}}, "then": _given(key)}])
    outcome = {"properties": {"quantity": {"const": "outcome"}}}
    _add(part, [{"oneOf": [_given(key) for key in CHECKS]}])
    _add(part, [{"if": _given("is", "is_not"), "then": outcome}])


def _units() -> str:
    """Of the units of acceleration, however they are written."""
    said = []
    for name in sorted(UNIT_NAMES, key=len, reverse=True):
        letters = "".join(f"[{c}{c.upper()}]" if c.isalpha() else re.escape(c) for c in name)
        said.append(letters.replace("2", r"(\*\*|\^)?[2²]"))
    return rf"^\s*({'|'.join(said)})\s*$"


def _axes(schema: Schema) -> None:
    """`vary` and `uncertain` by path, so that an editor completes them; values of a key are those of that key."""
    number = {**NUMBER_SCHEMA, "pattern": EXPRESSION}
    schema["$defs"]["Range"] = {
        "type": "object",
        "description": "a range, both ends included",
        "properties": {
            "from": number,
            "to": number,
            "n": {"type": "integer", "minimum": 1},
            "spacing": {"enum": ["linear", "log"]},
            "find": {"enum": ["overturning", None]},
        },
        "required": ["from", "to", "n"],
        "additionalProperties": False,
    }
    schema["$defs"]["Settings"] = {
        "type": "object",
        "description": "named settings {label: value}",
        "minProperties": 1,
        "not": _given("from", "to", "n"),
    }
    known = dict(_paths(schema, "CasePart", ""))
    varied = {path: _axis(schema, node) for path, node in known.items()}
    lasts = "|".join(sorted({path.rsplit(".", 1)[-1] for path in known if "." in path} - {*known, "file", "component"}))
    names = {r"^let\.[A-Za-z_][A-Za-z0-9_]*$": ONE_POINT, rf"^(?!({lasts})$)[A-Za-z_][A-Za-z0-9_]*$": ONE_POINT}
    vary = schema["properties"]["vary"]
    vary |= {"properties": {"case": ONE_POINT, **varied}, "patternProperties": names, "additionalProperties": False}
    uncertain = schema["properties"]["uncertain"]
    distribution = {"$ref": "#/$defs/DistributionPart"}
    numeric = {path: distribution for path, node in known.items() if any(map(_is_number, _forms(node)))}
    others = {r"^let\.[A-Za-z_][A-Za-z0-9_]*$": distribution}
    uncertain |= {"properties": numeric, "patternProperties": others, "additionalProperties": False}


def _axis(schema: Schema, node: Schema) -> Schema:
    """An entry of `vary` for a key: points are what the key takes, where part of a mapping is as good as all of it."""
    described = {"description": node["description"]} if "description" in node else {}
    value = {word: item for word, item in node.items() if word not in ("default", "description")}
    if not value or any(_has_rules(schema["$defs"][part]) for part in re.findall(r"#/\$defs/(\w+)", json.dumps(value))):
        return {**ONE_POINT, **described}
    forms = [
        {"type": "array", "minItems": 1, "uniqueItems": True, "items": value},
        {"$ref": "#/$defs/Range"},
        {"allOf": [{"$ref": "#/$defs/Settings"}, {"additionalProperties": {"anyOf": [value, {"type": "null"}]}}]},
        {"type": "string", "pattern": r"\.[A-Za-z0-9]+$|[*?\[]"},
    ]
    return {"anyOf": forms, **described}


def _has_rules(part: Schema) -> bool:
    """Whether a mapping has keys that need others, or exclude them: one laid over another need not hold to it."""
    return "required" in part or "allOf" in part


def _paths(schema: Schema, part: str, before: str) -> Iterator[tuple[str, Schema]]:
    for key, node in schema["$defs"][part]["properties"].items():
        yield before + key, node
        for inner in _parts(node):
            if key == "vertical" and inner == "RecordPart":  # its own keys may stand for those of a record
                yield from ((f"{before}{key}.{k}", n) for k, n in schema["$defs"][inner]["properties"].items())
            else:
                yield from _paths(schema, inner, f"{before}{key}.")


def _parts(node: Schema) -> list[str]:
    """The parts that a value may be as a whole, which paths lead into."""
    return list(dict.fromkeys(re.findall(r'"#/\$defs/(\w+Part)"', json.dumps(_outside_lists(node)))))


def _outside_lists(node: Any) -> Any:
    """A node without what stands in lists, which no path leads into."""
    if isinstance(node, dict):
        return {word: _outside_lists(item) for word, item in node.items() if word != "items"}
    return [_outside_lists(item) for item in node] if isinstance(node, list) else node


def _places(schema: Schema, part: str, *at: str, alone: bool = True) -> Iterator[tuple[str, tuple[str, ...], bool]]:
    """Every part of a case, where it stands, and whether no other may stand there."""
    yield part, at, alone
    for key, node in schema["$defs"][part]["properties"].items():
        inner = _parts(node)
        for each in inner:
            yield from _places(schema, each, *at, key, alone=len(inner) == 1)


def _need(schema: Schema) -> None:
    """Keys that a mapping of the case cannot do without stand in it, or an axis gives them."""
    parts = schema["$defs"]
    places = list(_places(schema, "CasePart"))
    for part, at, alone in places:
        this: Schema = {"type": "object"}
        if not alone:
            this |= {"propertyNames": {"enum": sorted(parts[part]["properties"])}, "minProperties": 1}
        for key in parts[part].get("required", ()):
            above = "|".join(["case", *(re.escape(".".join(at[:n])) for n in range(1, len(at) + 1))])
            given = rf"^({above}|{re.escape('.'.join((*at, key)))}(\..*)?)$"
            axes = {word: {"propertyNames": {"not": {"pattern": given}}} for word in ("vary", "uncertain")}
            rule: Schema = {"if": this, "then": {"required": [key]}}
            for word in reversed(("case", *at)):
                rule = {"properties": {word: rule}}
            _add(schema, [{"if": {"properties": axes}, "then": rule}])
    for part, _, _ in places:
        parts[part].pop("required", None)


def _complete(schema: Schema) -> None:
    """A case that no axis changes is whole: its body has two sizes or a shape, its pulses amplitude and frequency."""
    sizes = [_given(*sorted(group)) for group in SIZES]
    body = {"anyOf": [_given(*OUTLINES), *({"allOf": list(pair)} for pair in combinations(sizes, 2))]}
    pulse = {"if": {"type": "object"}, "then": {"allOf": [_given(*PULSE_AMPLITUDES), _given(*PULSE_FREQUENCIES)]}}
    motion = {"if": {"type": "object"}, "then": {"properties": {"pulse": pulse}}}
    whole = {"properties": {"case": {"properties": {"block": body, "motion": motion}}}}
    _add(schema, [{"if": {"not": _given("vary", "uncertain")}, "then": whole}])
