"""What a dataset tells of its case beside its variables: the settings of the resolved study it carries."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray


def case_settings(dataset: xarray.Dataset) -> dict[str, str]:
    """Path inside the case -> value, as text, of every single value of the resolved base case.

    The resolved study is written by this program, one key in a line, two blanks deeper for each level.
    """
    found: dict[str, str] = {}
    path: list[str] = []
    inside = False
    for line in str(dataset.attrs.get("study", "")).splitlines():
        if not line.startswith(" "):
            inside = line == "case:"
        elif inside:
            key, _, value = line.strip().partition(":")
            depth = (len(line) - len(line.lstrip())) // 2
            path = [*path[: depth - 1], key]
            if value:
                found[".".join(path)] = value.strip().strip("'\"")
    return found
