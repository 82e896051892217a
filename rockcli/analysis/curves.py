"""Static curves of a study's cases (`curves`: moment-rotation, pushover, ...), as variables of its dataset."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.laws.curves import (
    CRITICAL,
    ENERGY,
    KINDS,
    POINTS,
    critical_ratio,
    curves_of,
    errors_of,
    variables_of,
)
from rockcli.scene.laws.energy import energy_ratio, energy_ratio_of_impacts
from rockcli.scene.laws.models import MODELS
from rockcli.scene.variables import CASE, ROTATION, VARIABLES
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Study

Array = NDArray[np.float64]


def with_curves(contents: Contents, study: Study) -> Contents:
    """Add the static curves a study asks for, or take away those it does not ask for.

    Curves have the dimensions (axes, rotation), the errors that sum them up (axes); `theta_over_alpha` goes with
    `rotation`.  Nothing is solved: body, model and geometry are all that counts.

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    every = set(variables_of(tuple(KINDS)))
    fields = {name: item for name, item in contents.fields.items() if name not in every}
    if study.curves:
        ratio = np.linspace(0.0, 1.0, POINTS)
        coordinate = variable_field("theta_over_alpha", (ROTATION,), ratio)
        fields["theta_over_alpha"] = replace(coordinate, coordinate=True)
        axes = tuple(axis.name for axis in study.axes)
        values, models, schemes = _evaluate(study, ratio)
        said: dict[str, Any] = {"model": models[0]} if len(models) == 1 else {}
        for name in variables_of(study.curves)[1:]:
            beside = () if VARIABLES[name].over == CASE else (ROTATION,)
            shape = study.shape + values[name].shape[1:]
            words = {"model": schemes[0]} if name == "energy_ratio" and len(schemes) == 1 else said
            fields[name] = variable_field(name, axes + beside, values[name].reshape(shape), **words)
    return Contents(contents.axes, fields, contents.attrs)


def _evaluate(study: Study, ratio: Array) -> tuple[dict[str, Array], list[str], list[str]]:
    """Every curve and error over the flat cases, the models met, in words, and the damping schemes."""
    values: dict[str, Array] = {}
    models: list[str] = []
    schemes: list[str] = []
    for indices, batch in buildable(study.batches, np.arange(study.size)):
        model = MODELS[(batch.model, batch.geometry)]
        found: dict[str, Array] = {}
        for kind in study.curves:
            if kind == ENERGY:
                found["energy_ratio"] = energy_ratio(batch.damping, batch.block, batch.g, ratio)
                kept = energy_ratio_of_impacts(batch.block)
                found["energy_ratio_block"] = np.repeat(kept[:, None], len(ratio), axis=1)
            else:
                found |= curves_of(kind, model, batch.block, ratio) | errors_of(kind, model, batch.block)
        if "moment_rotation" in study.curves:
            found[CRITICAL] = critical_ratio(model, batch.block)
        for name, part in found.items():
            values.setdefault(name, np.full((study.size, *part.shape[1:]), np.nan))[indices] = part
        words = model_words(batch.model, batch.geometry)
        if words not in models:
            models.append(words)
        if batch.damping.scheme not in schemes:
            schemes.append(batch.damping.scheme)
    return values, models, schemes


def model_words(name: str, geometry: str | None) -> str:
    """A model for a legend: `model 3, negative stiffness`."""
    return f"model {name}, {geometry.replace('_', ' ')}" if geometry else name
