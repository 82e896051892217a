"""The law of one rotation that solved a case, where its dataset tells it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockcli.plotting.common.case_settings import may_vary, resolved_case
from rockcli.plotting.common.cases import axes_of
from rockcli.plotting.common.labels import path_of
from rockcli.scene.laws.models import DEFAULT_GEOMETRY, MODELS, Model

if TYPE_CHECKING:
    import xarray


def model_of(dataset: xarray.Dataset) -> Model | None:
    """The row of `scene/laws/models.py` of one case; None where it is a column, or where settings may have chosen it.

    Args:
        dataset: of one point on its axes.
    """
    if "model_used" in dataset.variables:
        flags = dataset["model_used"].attrs
        named = dict(zip(np.ravel(flags["flag_values"]).tolist(), flags["flag_meanings"].split(), strict=True))
        used = named.get(int(dataset["model_used"].values), "")
        if used != "not_auto":
            return MODELS.get((used, None))
    case = resolved_case(dataset)
    model, geometry = case.get("model", "rigid"), case.get("geometry", DEFAULT_GEOMETRY)
    name = str(model["name"] if isinstance(model, dict) else model)
    for axis in axes_of(dataset):
        path = path_of(dataset, axis).removeprefix("case.")
        if path == "case" and may_vary(dataset, "model", "geometry"):
            return None
        if path == "model":
            name = str(dataset[axis].values)
        if path == "geometry":
            geometry = str(dataset[axis].values)
    return MODELS.get((name, None)) or MODELS.get((name, geometry))


def may_have_dashpot(dataset: xarray.Dataset) -> bool:
    """Whether some case of the study, or of a table of it, has a dashpot, which takes energy between impacts."""
    tables = (dataset[name].values for name in map(str, dataset.variables) if name.startswith("given_damping"))
    said = (str(dataset.attrs.get(name, "")) for name in ("study", "cases"))
    return any("dashpot" in words for words in said) or any("dashpot" in map(str, np.ravel(t)) for t in tables)
