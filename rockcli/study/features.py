"""Model and geometry of a case as the study asks for them, and which models have static curves."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rockcli.scene.auto import AUTO
from rockcli.scene.laws.models import DEFAULT_GEOMETRY, DEFORMABLE, MODELS
from rockcli.study.document.tree import Map, Source
from rockcli.study.schema import CasePart


def check_curves(source: Source, study: Map, models: Iterable[tuple[str, str | None]]) -> None:
    """Refuse static curves (`curves`) of a model that has no law of its own."""
    for pair in models:
        if study.get("curves") and pair not in MODELS:
            raise source.error(study, ("curves",), f": model {pair[0]} has no static curves")


def model_and_geometry(source: Source, study: Map, case: CasePart) -> tuple[str, str | None]:
    """The model of a case and its geometry, both of which this version solves."""
    model, geometry = case.model.name, case.geometry
    if model == AUTO:
        return model, None  # a geometry given beside it is that of the models it is compared with
    if case.model.tolerance is not None:
        raise source.error(study, ("case", "model", "tolerance"), "belongs to model auto")
    if model in DEFORMABLE:
        return model, None  # corotational, whatever the models it is compared with are
    geometries = [pair[1] for pair in MODELS if pair[0] == model]
    if geometries == [None]:
        return model, None  # a geometry given beside it is that of the models it is compared with
    chosen = DEFAULT_GEOMETRY if geometry is None else geometry
    if chosen not in geometries:
        raise source.error(
            study, ("case", "geometry"), f": model {model} is available as {_list(str(g) for g in geometries)}"
        )
    return model, chosen


def _list(names: Any) -> str:
    return ", ".join(names)
