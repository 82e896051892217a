"""The catalogue of records that studies name but the project may not ship: what they are and how to get them."""

from __future__ import annotations

from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

from rockcli.errors import StudyError
from rockcli.study.document.loader import load_any


def how_to_obtain(name: str) -> list[str]:
    """What the record of that name is and how to get it; none of a name that is not in the catalogue, or of several."""
    wanted = Path(name).name.casefold()
    matching = [entry for entry in _entries() if _is_called(entry, wanted)]
    if len(matching) != 1:
        return []
    (entry,) = matching
    what = ", ".join(str(entry[key]) for key in ("event", "station", "component") if entry.get(key))
    parts = [
        f"It is {what}" if what else "",
        f"Known as {', '.join(str(n) for n in entry.get('file_names') or ())}",
        f"How to get it: {_sentence(entry.get('how_to_obtain'))}",
        _sentence(entry.get("note")),
    ]
    return [part[0].upper() + part[1:].rstrip(".") for part in parts if part]


def _is_called(entry: dict[str, Any], wanted: str) -> bool:
    names = [str(name).casefold() for name in entry.get("file_names") or ()]
    stems = (str(entry.get("id", "")).casefold(), *(Path(name).stem for name in names))
    return any(fnmatchcase(name, wanted) for name in names) or Path(wanted).stem in stems


def _sentence(value: Any) -> str:
    if isinstance(value, list):
        value = "; ".join(str(item) for item in value)
    return " ".join(str(value).split()) if value else ""


@cache
def _entries() -> tuple[dict[str, Any], ...]:
    here = Path(__file__)
    for path in (here.with_name("catalog.yaml"), here.parents[2] / "records" / "catalog.yaml"):
        if path.is_file():
            try:
                loaded = load_any(path)
            except StudyError:
                return ()
            return tuple(entry for entry in loaded or () if isinstance(entry, dict))
    return ()
