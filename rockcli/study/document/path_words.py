"""What a path of a study is in words, as the axes of plots say it."""

from __future__ import annotations

import re

from rockcli.errors import StudyError
from rockcli.study.document.check import part_at
from rockcli.study.document.paths import resolve
from rockcli.study.schema import StudyPart

_REST = re.compile(r" [\[(].*|[;,].*|: default.*| wanted\b")
"""Of the sentence of a key what is no part of its name: unit, default, what else it takes."""


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
