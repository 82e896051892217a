"""Reads back from a dataset what its study said: the clauses of `expect`, from the resolved study it carries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from rockcli.scene.looks import Look
from rockcli.scene.variables import VARIABLES
from rockcli.study.document.loader import load_value
from rockcli.study.document.tree import Source
from rockcli.study.expect import read_expect
from rockcli.study.plots import looks_of
from rockcli.study.schema import PLOTS, StudyPart
from rockcli.study.study import Axis, Expect


def plots_of(resolved: str) -> list[tuple[str, Look]]:
    """The plots that a resolved study lists, each as it is wanted; none where it lists none."""
    study = load_value(resolved, "the study in the dataset") if resolved else {}
    said = study.get("plots") if isinstance(study, dict) else None
    if not isinstance(said, list):
        return []
    known = [one for one in said if (one if isinstance(one, str) else one.get("kind")) in PLOTS]
    return list(
        looks_of(StudyPart.model_validate({"name": "plots", "case": {"block": {}}, "plots": known}).plots or [])
    )


def clauses_of(
    resolved: str, axes: Sequence[tuple[str, str, NDArray[Any]]], found: tuple[str, ...]
) -> tuple[Expect, ...]:
    """The clauses of a resolved study.

    Args:
        resolved: the study as YAML, as datasets carry it.
        axes: (name, path, coordinate values) of the dimensions a clause may name.
        found: names of the fields of the dataset.
    """
    study = load_value(resolved, "the study in the dataset")
    points = study.get("vary", {})
    known = [
        Axis(
            name,
            path,
            tuple(v.tolist()),
            v.dtype.kind == "f",
            files=tuple(points[path]) if isinstance(points.get(path), list) else (),
        )
        for name, path, v in axes
    ]
    named_by_the_study = tuple(name for name in found if name not in VARIABLES)
    return read_expect(Source(file=None), study, known, found=named_by_the_study)
