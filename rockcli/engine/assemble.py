"""From what the solvers said to the contents of a dataset."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.compare import with_comparison
from rockcli.engine.provenance import attributes
from rockcli.engine.sweep import Results
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.variables import HISTORIES, IMPACTS, LARGE, VARIABLES
from rockcli.storage.contents import (
    COORDINATES,
    DIM_IMPACT,
    DIM_TIME,
    Contents,
    Field,
    axis_field,
    reasons_field,
    time_field,
    variable_field,
)
from rockcli.study.study import Study


def assemble(study: Study, results: Results, thresholds: NDArray[np.float64] | None = None) -> Contents:
    """Contents of the dataset of a solved study, comparison included; `thresholds` (n,) are what a search found."""
    axes = tuple(axis.name for axis in study.axes)
    fields = {
        axis.name: axis_field(axis.name, axis.path, axis.values, numeric=axis.numeric, unit=axis.unit)
        for axis in study.axes
    }
    fields |= _symbols(results, axes, study.shape) | _edges(study, axes)
    if results.histories:
        fields["time"] = time_field(results.time)
    for name in study.scalars:
        values = results.sentences if name == "reason" else results.scalars[name]
        fields[name] = variable_field(name, axes, values.reshape(study.shape))
        if name in ("n_impacts", "n_steps"):
            fields[name].attrs["comment"] = "-1: no answer"
    if "reason" in study.scalars:
        fields["reasons"] = reasons_field(list(results.codes))
    if thresholds is not None:
        assert study.search is not None
        sought = study.search.axis
        words = f"lowest {sought.path} of the range searched at which the case overturns; inf: nowhere, NaN: no answer"
        attrs = {"long_name": words, "units": sought.unit}
        fields[study.search.name] = Field(axes, thresholds.reshape(study.shape), attrs)
        for name in {"a_p", "omega_p"} & fields.keys() if sought.path.startswith("motion") else ():
            del fields[name]  # they change along the range
    fields |= _beside_axes(results.histories, HISTORIES, axes, study.shape, DIM_TIME)
    fields |= _beside_axes(results.impacts, IMPACTS, axes, study.shape, DIM_IMPACT)
    if "M_base" in fields and results.has_mass:
        unit = {"units": "N m", "long_name": "moment of the base on the body, opposing theta"}
        fields["M_base"] = replace(fields["M_base"], attrs=fields["M_base"].attrs | unit)
    return with_comparison(Contents(axes, fields, attributes(study, results)), study.compare_to)


def _beside_axes(
    arrays: dict[str, NDArray[np.float64]],
    order: tuple[str, ...],
    axes: tuple[str, ...],
    shape: tuple[int, ...],
    dim: str,
) -> dict[str, Field]:
    known = [name for name in order if name in arrays] + [name for name in arrays if name not in order]
    return {
        name: variable_field(name, (*axes, dim), arrays[name].reshape(*shape, arrays[name].shape[1]))
        for name in known
        if name in VARIABLES
    }


def _symbols(results: Results, axes: tuple[str, ...], shape: tuple[int, ...]) -> dict[str, Field]:
    """The symbols over the axes they depend on; those no case has are left out."""
    fields = {}
    for name in COORDINATES:
        full = results.symbols.get(name)
        if full is not None and not np.isnan(full).all():
            dims, values = reduce(full.reshape(shape), axes)
            fields[name] = variable_field(name, dims, values)
    return fields


def _edges(study: Study, axes: tuple[str, ...]) -> dict[str, Field]:
    """R, alpha, p and eta of either edge where a body is asymmetric, over the axes they depend on."""
    if study.size > LARGE or not _may_be_asymmetric(study.resolved):
        return {}
    values: dict[str, NDArray[np.float64]] = {}
    symmetric = True
    for indices, batch in study.batches():
        block = batch.block
        symmetric &= bool(block.symmetric.all())
        of_edges = {"R": block.R, "alpha": block.alpha, "p": batch.p, "eta": batch.damping.eta}
        for name, both in of_edges.items():
            for column, side in ((LEFT, "left"), (RIGHT, "right")):
                full = values.setdefault(f"{name}_{side}", np.full(study.size, np.nan))
                full[indices] = both[:, column]
    if symmetric:
        return {}
    reduced = {name: reduce(full.reshape(study.shape), axes) for name, full in values.items()}
    return {
        name: replace(variable_field(name, dims, kept), coordinate=True)
        for name, (dims, kept) in reduced.items()
        if not np.isnan(kept).all()
    }


def _may_be_asymmetric(resolved: dict[str, Any]) -> bool:
    """Whether a study speaks of an outline, of two distances b, or of a file or a setting that may."""
    case = resolved.get("case") or {}
    block = case.get("block") or {}
    varied = " ".join(resolved.get("vary") or {})
    return "outline" in block or isinstance(block.get("b"), list) or "block" in varied or "case" in varied


def reduce(values: NDArray[Any], axes: tuple[str, ...]) -> tuple[tuple[str, ...], NDArray[Any]]:
    """Drop the axes along which values do not change (NaN equals NaN); the dims left and the values over them."""
    kept: list[str] = []
    for axis in axes:
        at = len(kept)
        first = np.take(values, [0], axis=at)
        same = (values == first) | (np.isnan(values) & np.isnan(first))
        if same.all():
            values = first.squeeze(axis=at)
        else:
            kept.append(axis)
    return tuple(kept), np.asarray(values)
