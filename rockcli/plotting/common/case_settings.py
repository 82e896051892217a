"""What a dataset tells of its case beside its variables: the resolved case it carries, as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rockcli.scene.axis_path import axis_path

if TYPE_CHECKING:
    import xarray


DATASET = "dataset"
"""Axis along which datasets that are drawn together are told apart."""


def resolved_case(dataset: xarray.Dataset) -> dict[str, Any]:
    """The base case with every default written out; empty for a dataset that carries none.

    Of several datasets that are drawn together what is the same in all.
    """
    cases = resolved_cases(dataset)
    return cases[0] if len(cases) == 1 else _common(cases)


def resolved_cases(dataset: xarray.Dataset) -> list[dict[str, Any]]:
    """The base case, or those of datasets that are drawn together, in their order."""
    if "cases" not in dataset.attrs:
        return [dict(json.loads(dataset.attrs.get("case", "{}")))]
    cases = json.loads(dataset.attrs["cases"])
    return [cases[str(label)] for label in np.ravel(dataset[DATASET].values)]


def varied(dataset: xarray.Dataset) -> list[str]:
    """Paths inside the case that axes, settings of their points, tables and samples change.

    Of datasets of earlier versions, which tell neither settings nor tables, those of their axes.
    """
    if "varied" in dataset.attrs:
        return list(json.loads(dataset.attrs["varied"]))
    return [axis_path(dataset[name].attrs, name) for name in str(dataset.attrs.get("axes", "")).split()]


def may_vary(dataset: xarray.Dataset, *keys: str) -> bool:
    """Whether one of these keys of the case, or a key below it, differs between cases, or may: settings can be any."""
    paths = varied(dataset)
    return "case" in paths or any(f"{path}.".startswith(f"{key}.") for path in paths for key in keys)


def every_case(dataset: xarray.Dataset) -> list[dict[str, Any]]:
    """The base cases of all datasets that are drawn together, also of those that a part of them leaves out."""
    return list(json.loads(dataset.attrs["cases"]).values()) if "cases" in dataset.attrs else resolved_cases(dataset)


def _common(trees: list[dict[str, Any]]) -> dict[str, Any]:
    """What several trees have in common."""
    found: dict[str, Any] = {}
    for key, value in trees[0].items():
        below = [other for tree in trees if isinstance(other := tree.get(key), dict)]
        if len(below) == len(trees):
            found[key] = _common(below)
        elif all(key in tree and tree[key] == value for tree in trees):
            found[key] = value
    return found


def case_settings(dataset: xarray.Dataset) -> dict[str, str]:
    """Path inside the case -> value, as text, of every single value of the resolved base case."""
    return dict(_leaves(resolved_case(dataset), ""))


def _leaves(tree: Mapping[str, Any], above: str) -> Iterator[tuple[str, str]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", str(value)
