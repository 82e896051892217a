"""Names of files that axes fill in: `{where}_{record}.csv` under the axes `where` and `record`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from rockcli.study.document.tree import List, Map, put_at, value_at

LABELS = "labels"
"""Where axes that are only names stand in the tree of a study."""

PLACES = (("case", "motion", "record"), ("case", "motion", "vertical", "record"))

_NAME = re.compile(r"\{([A-Za-z_]\w*)\}")


def names_in(value: Any) -> set[str]:
    """Names in braces in the names of files, anywhere in a tree."""
    if isinstance(value, dict):
        return set().union(*(names_in(item) for item in value.values()))
    if isinstance(value, list):
        return set().union(*(names_in(item) for item in value))
    return set(_NAME.findall(value)) if isinstance(value, str) else set()


def filled_in(study: Map, labels: Mapping[str, str]) -> Map:
    """The study with the labels of axes in the names of its records; what is no axis stays as it is."""
    for keys in PLACES:
        record = value_at(study, keys)
        if not isinstance(record, Map) or not names_in(said := record.get("file")):
            continue
        new = (
            List([_with(name, labels) for name in said], said.where) if isinstance(said, List) else _with(said, labels)
        )
        study = put_at(study, (*keys, "file"), new)
    return study


def _with(name: Any, labels: Mapping[str, str]) -> Any:
    return _NAME.sub(lambda found: labels.get(found[1]) or found[0], name) if isinstance(name, str) else name
