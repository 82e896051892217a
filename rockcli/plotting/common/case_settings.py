"""What a dataset tells of its case beside its variables: the resolved case it carries, as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray


def resolved_case(dataset: xarray.Dataset) -> dict[str, Any]:
    """The base case with every default written out; empty for a dataset that carries none."""
    return dict(json.loads(dataset.attrs.get("case", "{}")))


def case_settings(dataset: xarray.Dataset) -> dict[str, str]:
    """Path inside the case -> value, as text, of every single value of the resolved base case."""
    return dict(_leaves(resolved_case(dataset), ""))


def _leaves(tree: Mapping[str, Any], above: str) -> Iterator[tuple[str, str]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", str(value)
