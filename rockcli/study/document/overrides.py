"""`--set PATH=VALUE`: values laid over a study before it is checked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rockcli.errors import StudyError
from rockcli.study.cases.variation import Variation
from rockcli.study.document.check import fields_at
from rockcli.study.document.loader import NAMES, load_value
from rockcli.study.document.overlay import Setting, leaves, overlaid, remaining, sizes_of
from rockcli.study.document.paths import likely, resolve
from rockcli.study.document.tree import Map, meant, nearest, value_at
from rockcli.study.schema import OUTLINES, StudyPart

_OF_BODY = ("case", "block")


def settings_of(overrides: Sequence[tuple[str, str]]) -> list[Setting]:
    """Every (path, text of a YAML value) as a setting.

    Raises:
        StudyError: a path that a study does not have, or a value that is no YAML.
    """
    found: list[Setting] = []
    for path, text in overrides:
        label = _label(path, text)
        keys = _keys(path, label)
        value = load_value(text, label, named=keys[0] in NAMES)
        if isinstance(value, Map):
            value.whole = keys[0] != "case"  # axes, symbols and what is saved are set as a whole
        found.append((keys, value, label))
    return found


def apply_overrides(study: Map, settings: Sequence[Setting]) -> Map:
    """The study with every override laid over it in order; sizes that only together say a body together."""
    for setting in settings:
        study = overlaid(study, [setting])
    block = value_at(study, _OF_BODY)
    if isinstance(block, Map) and (len(sizes_of(block)) > 2 or any(block.get(key) is not None for key in OUTLINES)):
        own = {path[-1]: (path, value, where) for path, value, where in settings if path[:-1] == _OF_BODY}
        left = Map({key: value for key, (_, value, _) in own.items() if block.get(key) is value})
        if len(sizes_of(left)) == 2:
            study = overlaid(study, [own[key] for key in left])
    return study


def without_effect(study: Map, variations: Iterable[Variation], overrides: Sequence[tuple[str, str]]) -> list[str]:
    """A sentence per override of the case of which nothing is left under the axes of the study."""
    said = []
    for path, text in overrides:
        if path.split(".")[0] not in ("case", "let"):
            continue
        label = _label(path, text)
        keys = _keys(path, label)
        below = {(*keys, *leaf) for leaf, _ in leaves(value_at(study, keys))}
        for variation in variations:
            if below and not below & remaining(study, variation.points()):
                said.append(f"{label} has no effect: the study varies {variation.axis.path}")
                break
    return said


def _label(path: str, text: str) -> str:
    return f"--set {path}={text if len(text) <= 40 else text[:37] + '...'}"


def _keys(path: str, label: str) -> tuple[str, ...]:
    parts = tuple(path.split("."))
    try:
        if parts[0] in ("vary", "uncertain") and len(parts) > 1:
            return (parts[0], ".".join(parts[1:]))
        if parts[0] in ("case", "let") and len(parts) > 1:
            return resolve(path)
        if parts[0] not in StudyPart.model_fields:
            raise StudyError(f"{parts[0][:100]!r} is not a key of a study; {_hint(path)}")
    except StudyError as error:
        raise StudyError(error.message, file=label) from None
    for i in range(1, len(parts)):
        known = fields_at(StudyPart, parts[:i])
        if known and parts[i] not in known:
            raise StudyError(f"{path[:200]!r} is not a path of a study; {nearest(parts[i], known)}", file=label)
        if not known and value_at({}, parts) is None and parts[0] in ("name", "title", "references", "expect", "plots"):
            raise StudyError(f"{parts[0]!r} is set as a whole", file=label)
    return parts


def _hint(path: str) -> str:
    try:
        return f"did you mean {'.'.join(resolve(path))!r}?"
    except StudyError:
        top, inside = path.split(".")[0], likely(f"case.{path}")
        known = meant(top, StudyPart.model_fields) is not None or inside is None
        return nearest(top, StudyPart.model_fields) if known else f"did you mean {inside!r}?"
