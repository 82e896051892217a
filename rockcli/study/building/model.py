"""Model and geometry of a case as the study asks for them."""

from __future__ import annotations

from rockcli.scene.auto import AUTO
from rockcli.scene.laws.models import DEFAULT_GEOMETRY, DEFORMABLE, MODELS
from rockcli.study.document.tree import Map, Source
from rockcli.study.schema import CasePart


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
        known = ", ".join(map(str, geometries))
        raise source.error(study, ("case", "geometry"), f": model {model} is available as {known}")
    return model, chosen
