"""Glob patterns of files (`records/*.AT2`) in a study, searched no farther than somebody would wait for."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from fnmatch import filter, fnmatchcase
from itertools import takewhile
from pathlib import Path

WILDCARDS = frozenset("*?[")

MOST = 200_000
"""Files and folders looked at for one pattern; a second or two."""


class TooManyFiles(Exception):  # noqa: N818 (the caller says what is wrong, and where)
    """There is more below a folder than is looked through."""


def walk(folder: Path) -> Iterator[tuple[list[str], list[str], list[str]]]:
    """Yield (names of the folders on the way, folders there, files there) from a folder down, also through links.

    Folders taken off the list are not entered, nor is a link to a folder that it stands in.

    Raises:
        TooManyFiles: there are more than MOST files and folders.
    """
    looked_at = 0
    pending: list[tuple[list[str], frozenset[tuple[int, int]]]] = [([], frozenset())]
    while pending:
        way, above = pending.pop()
        place = os.path.join(folder, *way)
        try:
            here = os.stat(place)
            with os.scandir(place) as scanned:
                entries = [(entry.name, entry.is_dir()) for entry in scanned]
        except OSError:
            continue
        if (here.st_dev, here.st_ino) in above:
            continue
        looked_at += len(entries)
        if looked_at > MOST:
            raise TooManyFiles
        folders = [name for name, is_folder in entries if is_folder]
        yield way, folders, [name for name, is_folder in entries if not is_folder]
        around = above | {(here.st_dev, here.st_ino)}
        pending += [([*way, name], around) for name in folders]


def matched(pattern: str, folder: Path) -> list[str]:
    """Names of the files below a folder that a pattern means, sorted, as one would write them in its place.

    `*`, `?` and `[...]` stand for parts of a name, `**` for any folders; none of them for hidden ones.

    Raises:
        TooManyFiles: see `walk`.
    """
    if not WILDCARDS & set(pattern):
        return [pattern] if (folder / pattern).is_file() else []
    parts = re.sub(r"(?<![^/])(\*\*/)+", "**/", re.sub("/+", "/", pattern)).split("/")
    fixed = list(takewhile(lambda part: not WILDCARDS & set(part), parts[:-1]))
    rest = parts[len(fixed) :]
    begin = "".join(f"{part}/" for part in fixed)
    found = []
    for way, folders, files in walk(folder / begin):
        if "**" not in rest and len(way) == len(rest) - 1:
            folders.clear()
        if not any(part.startswith(".") for part in rest):
            folders[:] = [name for name in folders if not name.startswith(".")]
        likely = files if rest[-1] == "**" else filter(files, rest[-1])
        found += [begin + "/".join([*way, name]) for name in likely if _means(rest, [*way, name])]
    return sorted(found)


def _means(parts: list[str], names: list[str]) -> bool:
    """Whether the parts of a pattern mean the names of a path."""
    if not parts or not names:
        return not names and set(parts) <= {"**"}
    (part, *others), (name, *below) = parts, names
    shown = part.startswith(".") or not name.startswith(".")
    if part == "**":
        return _means(others, names) or (shown and _means(parts, below))
    return shown and fnmatchcase(name, part) and _means(others, below)
