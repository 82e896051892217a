"""In which keys a study differs from the one whose results a dataset holds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rockcli.errors import StudyError
from rockcli.study.document.loader import load_value

_NUMBERS = ("case", "let", "vary", "save", "refine", "uncertain", "samples", "seed", "sampling")
"""Keys of a study that change its numbers."""

_MOST, _LONGEST = 6, 40
"""Keys told, and characters of either value."""


def differences(old: str, new: Mapping[str, Any], inputs: Mapping[str, str], now: Mapping[str, str]) -> str:
    """The keys that differ, `case.motion.pulse.a_p (3 -> 3.5)`, at most a few; "" where none is found.

    Args:
        old: the resolved study of the dataset, as YAML; new: that of the study.
        inputs: name -> SHA-256 of the files that the dataset was made from; now: of those that the study reads.
    """
    try:
        before = load_value(old, "the study in the dataset")
    except StudyError:
        return ""
    if not isinstance(before, dict):
        return ""
    both = ({"seed": 0, **study} for study in (before, new))  # builds up to 0.2.0 left out a seed of 0
    first, second = (dict(_leaves({key: study.get(key) for key in _NUMBERS}, ())) for study in both)
    found = [
        f"{name} ({' -> '.join(map(_words, _unlike(first.get(name), second.get(name))))})"
        for name in dict.fromkeys([*first, *second])
        if not _same(first.get(name), second.get(name))
    ]
    found += [f"the file {name}" for name in now if name in inputs and inputs[name] != now[name]]
    more = [f"and {len(found) - _MOST} more"] if len(found) > _MOST else []
    return ", ".join([*found[:_MOST], *more])


def _leaves(value: Any, keys: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, (*keys, str(key)))
    elif value is not None:
        yield ".".join(keys), value


def _same(one: Any, other: Any) -> bool:
    """5 and 5.0 are the same, and so are lists of them."""
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other)


def _unlike(one: Any, other: Any) -> tuple[Any, Any]:
    """The two; of long lists of words those that the other does not have, which their beginnings would not show."""
    if not (isinstance(one, list) and isinstance(other, list)) or max(len(str(one)), len(str(other))) <= _LONGEST:
        return one, other
    if not all(isinstance(item, str) for item in [*one, *other]):
        return one, other
    before, now = set(one), set(other)
    only = [item for item in one if item not in now], [item for item in other if item not in before]
    return only if any(only) else (one, other)


def _words(value: Any) -> str:
    text = "nothing" if value in (None, []) else str(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
