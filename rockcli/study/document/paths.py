"""Paths of axes and of `--set`: what they may point to, and what to call them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache

from rockcli.errors import StudyError
from rockcli.scene.ground.amplitudes import FLOOR_SCALINGS, RECORD_SCALINGS
from rockcli.scene.laws.damping import SCHEMES
from rockcli.scene.variables import BOUNDARY_POINT, HAZARD_POINT, IMPACT, OUTLINE, ROTATION, TIME, VARIABLES
from rockcli.study.document.check import fields_at, is_list_of_parts, is_number, part_at
from rockcli.study.document.tree import meant, nearest
from rockcli.study.schema import PulsePart, RecordPart, StudyPart

Path = tuple[str, ...]

RESERVED = frozenset({*VARIABLES, TIME, IMPACT, ROTATION, HAZARD_POINT, OUTLINE, BOUNDARY_POINT, "reasons"})
"""Names of variables and dimensions in a dataset that no axis may have."""

_OF_INPUTS = ("given_", "note_", "sampled_")
"""Beginnings of names of the columns of tables and of uncertain inputs, which no axis may have either."""

_REST = re.compile(r" [\[(].*|[;,].*|: default.*| wanted\b")
"""Of the sentence of a key what is no part of its name: unit, default, what else it takes."""

_BLOCK = (
    "R",
    "h",
    "b",
    "height",
    "width",
    "alpha",
    "tan_alpha",
    "slenderness",
    "inertia",
    "r_g",
    "top",
    "mass",
    "mu",
    "e_n",
    "depth",
    "direction",
)
_PULSE = tuple(key for key in PulsePart.model_fields if key != "shape")
_DAMPING = tuple(key.name for scheme in SCHEMES.values() for key in scheme.keys if key.number)
_MOTIONS = (("motion",), ("motion", "vertical"))

ARRAYS: frozenset[Path] = frozenset(
    [
        ("case", "g"),
        *(("case", "block", key) for key in _BLOCK),
        *(("case", "block", "mu", key) for key in ("static", "kinetic")),
        *(("case", *motion, "pulse", key) for motion in _MOTIONS for key in _PULSE),
        *(("case", *motion, "record", key) for motion in _MOTIONS for key in (*RECORD_SCALINGS, "polarity")),
        ("case", "motion", "duration"),
        *(("case", "motion", key) for key in FLOOR_SCALINGS),
        ("case", "initial", "theta"),
        ("case", "initial", "theta_dot"),
        ("case", "initial", "slide_rate"),
        *(("case", "damping", key) for key in _DAMPING),
        *(("case", "column", key) for key in ("E", "rho", "zeta")),
        ("case", "base", "kw"),
    ]
)
"""Numbers that may differ from case to case within one batch; all else a case has is shared by a batch."""

UNITS: dict[str, str] = {
    **dict.fromkeys(("R", "h", "b", "height", "width", "r_g", "top", "depth"), "m"),
    **dict.fromkeys(("alpha", "theta", "nu", "yield_rotation", "angle", "direction"), "rad"),
    **dict.fromkeys(("omega_p", "theta_dot"), "rad s-1"),
    **dict.fromkeys(("f_p", "highpass", "lowpass", "freq", "freqmin", "freqmax"), "s-1"),
    **dict.fromkeys(("T_p", "t0", "dt", "duration", "sa_period"), "s"),
    **dict.fromkeys(("g", "a_p", "pga", "sa", "floor_pga"), "m s-2"),
    **dict.fromkeys(("A", "pgv", "slide_rate"), "m s-1"),
    **{"mass": "kg", "E": "Pa", "rho": "kg m-3", "density": "kg m-3", "kw": "N m-3"},
}
"""Units of numeric coordinates by the last part of their path; all others are dimensionless."""


def varies_in_batch(path: Path) -> bool:
    """Whether an axis of numbers at this path needs no batch of its own for every value."""
    return path in ARRAYS or path[0] == "let"


def takes_number(path: Path) -> bool:
    """Whether the schema has a number or an expression at this path."""
    return varies_in_batch(path) or is_number(fields_at(StudyPart, path[:-1]).get(path[-1], ()))


def resolve(text: str) -> Path:
    """The path from the top of a study that an axis means by `block.R`, `let.gamma` or `case`.

    Raises:
        StudyError: the study has no such key, and the nearest one is named; or it is of a part of a list.
    """
    parts = tuple(text.split("."))
    if parts[0] == "let" and len(parts) == 2 and parts[1].isidentifier():
        return parts
    if parts[0] != "case":
        parts = ("case", *parts)
    if parts[1:3] == ("motion", "vertical") and len(parts) == 4 and parts[3] in RecordPart.model_fields:
        parts = (*parts[:3], "record", parts[3])
    for i in range(1, len(parts)):
        known = fields_at(StudyPart, parts[:i])
        if parts[i] not in known:
            raise StudyError(f"{text[:200]!r} is not a path inside the case; {_hint(text)}")
        if i < len(parts) - 1 and is_list_of_parts(known[parts[i]]):
            whole = ".".join(parts[1 : i + 1])
            said = f"{text[:200]!r} is inside the list `{whole}`, which is set as a whole"
            raise StudyError(f"{said}; write a symbol of `let` there and vary that: let.NAME")
    return parts


def is_path(text: str) -> bool:
    """Whether an axis could mean something by a text."""
    try:
        resolve(text)
    except StudyError:
        return False
    return True


def likely(text: str) -> str | None:
    """The path that is probably meant, from the top of a study where the text is; None if none is like it."""
    bare = text.removeprefix("case.")
    last = bare.rsplit(".", 1)[-1]
    same = [path for path in _all_paths() if path.rsplit(".", 1)[-1] == last]
    close = "motion.record.file" if last == "record" else same[0] if same else meant(bare, _all_paths())
    return None if close is None else text.removesuffix(bare) + close


def _hint(text: str) -> str:
    if text.split(".")[0] == "let":
        return "a symbol of `let` is set by itself, as let.NAME"
    close = likely(text)
    return nearest(text, _all_paths()) if close is None else f"did you mean {close!r}?"


@cache
def _all_paths() -> tuple[str, ...]:
    def walk(path: Path) -> Iterator[str]:
        for key, annotation in fields_at(StudyPart, path).items():
            yield ".".join((*path[1:], key))
            if not is_list_of_parts(annotation):
                yield from walk((*path, key))

    return tuple(walk(("case",)))


def dimension_names(paths: list[str]) -> list[str]:
    """Names of the dimensions of axes with these paths, as the user wrote them."""
    plain = [path.removeprefix("case.") for path in paths]
    lasts = ["record" if path in ("motion.record", "motion.record.file") else path.rsplit(".", 1)[-1] for path in plain]
    free = [last not in RESERVED and not last.startswith(_OF_INPUTS) and lasts.count(last) == 1 for last in lasts]
    names = [last if is_free else "" for last, is_free in zip(lasts, free, strict=True)]
    whole = [path.replace(".", "_") for path in plain]
    # an own symbol of `let` may be called what another axis's whole path makes
    return [name if name and name not in whole else path for name, path in zip(names, whole, strict=True)]


def words_of(path: str) -> str:
    """`tangent of the slenderness angle` for `block.tan_alpha`: the beginning of what the schema says of the key.

    What the schema does not know (`case`, `sample`, a name of `let`) is itself, without underscores.
    """
    try:
        keys = resolve(path)
    except StudyError:
        keys = ()
    part = part_at(StudyPart, keys[:-1]) if len(keys) > 1 else None
    field = part.model_fields.get(keys[-1]) if part is not None else None
    if field is None or not field.description:
        return path.rsplit(".", 1)[-1].replace("_", " ")
    words = _REST.sub("", field.description)
    return f"{words}, vertical motion" if "vertical" in keys[:-1] else words
