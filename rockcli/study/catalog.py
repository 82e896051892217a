"""The catalogue of records that studies name but the project may not ship: what they are and how to get them."""

from __future__ import annotations

from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

from rockcli.errors import StudyError
from rockcli.study.document.loader import load_any


def how_to_obtain(name: str) -> list[str]:
    """What the record of that name or pattern is and how to get it; none if not in the catalogue."""
    wanted = Path(name).name.casefold()
    for entry in _entries():
        names = [str(n).casefold() for n in entry.get("file_names") or ()]
        if any(fnmatchcase(name, wanted) for name in names) or Path(wanted).stem in (
            str(entry.get("id", "")).casefold(),
            *(Path(n).stem for n in names),
        ):
            what = ", ".join(str(entry[key]) for key in ("event", "station", "component") if entry.get(key))
            parts = [
                f"It is {what}" if what else "",
                f"Known as {', '.join(str(n) for n in entry.get('file_names') or ())}",
                f"How to get it: {_sentence(entry.get('how_to_obtain'))}",
                _sentence(entry.get("note")),
            ]
            return [part[0].upper() + part[1:].rstrip(".") for part in parts if part]
    return []


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
