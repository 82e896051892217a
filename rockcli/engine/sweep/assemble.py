"""Assembles the contents of a dataset from the gathered results of the solvers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.curves import CONFIDENCE
from rockcli.analysis.threshold_fields import threshold_fields
from rockcli.engine.provenance import attributes
from rockcli.engine.sweep.results import Results
from rockcli.engine.sweep.symbols import EDGES
from rockcli.scene.thresholds import Thresholds
from rockcli.scene.variables import GROUND, HISTORIES, IMPACTS, MOTION, VARIABLES
from rockcli.solvers.common.ground import ground_of_cases
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
from rockcli.study.document.paths import words_of
from rockcli.study.study import SAMPLE, Study


def assemble(study: Study, results: Results, thresholds: Thresholds | None = None) -> Contents:
    """Contents of the dataset of a solved study, nothing derived yet; `thresholds` (n,) are what a search found."""
    axes = tuple(axis.name for axis in study.axes)
    fields = first_fields(study, results)
    fields |= _given(study) | _symbols(results, axes) | _edges(results, axes) | _samples(study)
    if results.histories:
        fields["time"] = time_field(results.time)
        fields |= _motions(results, axes)
    if results.reason_asked or len(results.reason):
        fields["reason"] = variable_field("reason", axes, results.reason.reshape(study.shape))
    if results.solved is not None:
        fields["solved"] = _solved(results, axes, study.shape)
    if "reason" in fields:
        fields["reasons"] = reasons_field(results.reasons)
    if thresholds is not None:
        assert study.search is not None
        fields |= threshold_fields(study.search, thresholds.reshaped(study.shape), axes)
        for name in {"a_p", "omega_p"} & fields.keys() if study.search.axis.path.startswith("motion") else ():
            del fields[name]  # they change along the range
        for name in {"pga", "pgv"} & fields.keys():
            fields[name].attrs["long_name"] += ", at the lowest point of the range searched"
    fields |= _beside_axes(results.histories | _ground(study, results), HISTORIES, axes, study.shape, DIM_TIME)
    fields |= _beside_axes(results.impacts, IMPACTS, axes, study.shape, DIM_IMPACT)
    if "M_base" in fields and results.has_mass:
        unit = {"units": "N m", "long_name": "moment of the base on the body, opposing theta"}
        fields["M_base"] = replace(fields["M_base"], attrs=fields["M_base"].attrs | unit)
    contents = Contents(axes, fields, attributes(study, results))
    return contents


def first_fields(study: Study, results: Results) -> dict[str, Field]:
    """What a dataset begins with, known before the last case is solved but for values: axes, scalars over all of them.

    The values are those of `results`, not a copy.
    """
    fields = axis_fields(study)
    for name in study.scalars:
        if name != "reason":
            values = results.scalars[name].reshape(study.shape)
            comment = {"comment": "-1: no answer"} if name in ("n_impacts", "n_steps", "n_rhs") else {}
            fields[name] = variable_field(name, tuple(axis.name for axis in study.axes), values, **comment)
    return fields


def axis_fields(study: Study) -> dict[str, Field]:
    """The coordinates of the axes, outermost first."""
    return {
        axis.name: axis_field(
            axis.name, axis.path, axis.values, numeric=axis.numeric, unit=axis.unit, words=words_of(axis.path)
        )
        for axis in study.axes
    }


def _given(study: Study) -> dict[str, Field]:
    """What the tables of the axes say, each column over its axis."""
    found = {}
    for axis in study.axes:
        for each in axis.given:
            name = each.name if each.name not in found else f"{each.name}_{axis.name}"
            words = words_of(each.path) if name.startswith("given") else each.path
            numeric = each.values.dtype.kind == "f"
            found[name] = axis_field(axis.name, each.path, each.values, numeric=numeric, unit=each.unit, words=words)
    return found


def _solved(results: Results, axes: tuple[str, ...], shape: tuple[int, ...]) -> Field:
    """Which cases of a refined map were solved, and what those drawn at random tell of the others.

    `wrong_at_most`: upper limit of Clopper and Pearson (1934) of the share of wrong cases among all.
    """
    from scipy.special import betaincinv

    assert results.solved is not None
    drawn, wrong = results.probes
    told: dict[str, Any] = {}
    if drawn:
        limit = betaincinv(wrong + 1, drawn - wrong, CONFIDENCE) if wrong < drawn else 1.0
        unsolved = 1.0 - results.solved.mean() + drawn / results.solved.size  # when they were drawn
        told = {"drawn": drawn, "drawn_wrong": wrong, "wrong_at_most": float(limit * unsolved)}
    return variable_field("solved", axes, results.solved.reshape(shape), **told)


def _samples(study: Study) -> dict[str, Field]:
    """The samples of the uncertain inputs, over their axis."""
    found = {}
    for each in study.uncertain.inputs if study.uncertain is not None else ():
        attrs = {"long_name": words_of(each.path), "path": each.path, "units": each.unit, "comment": each.words}
        found[each.name] = Field((SAMPLE,), each.values, attrs, coordinate=True)
    return found


def _ground(study: Study, results: Results) -> dict[str, NDArray[np.float64]]:
    """a_g and a_v of the cases at the output times, (n, k) [m/s²], as long as each case's are told."""
    found = {name: np.full((study.size, len(results.time)), np.nan) for name in results.shaken}
    told = np.zeros(study.size, dtype=bool)
    for counted in results.shaken.values():
        told |= counted > 0
    for part, batch in study.batches(np.flatnonzero(told)) if told.any() else ():
        for case, both in zip(part, ground_of_cases(batch, range(batch.size), results.time), strict=True):
            for name, values in zip(GROUND, both, strict=True):
                if name in found:
                    length = results.shaken[name][case]
                    found[name][case, :length] = values[:length]
    return found


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


def _symbols(results: Results, axes: tuple[str, ...]) -> dict[str, Field]:
    """The symbols over the axes they depend on; those no case has, or that are axes, are left out."""
    found = {name: results.symbols.over(name, axes) for name in COORDINATES if name not in axes}
    factor = found["uplift_factor"] or ((), np.array(np.nan))  # of none where FEMA-356 asks a spectrum throughout
    found["uplift_factor"] = None if (factor[1] == 1.0).all() else factor
    return {name: variable_field(name, *over) for name, over in found.items() if over is not None}


def _motions(results: Results, axes: tuple[str, ...]) -> dict[str, Field]:
    """The number of each case's ground motion, from 0 in the order of the cases; -1 where a case has none."""
    found = results.symbols.over(MOTION, axes)
    if found is None:
        return {}
    dims, codes = found
    known = dict.fromkeys(codes[~np.isnan(codes)].tolist())
    number = {code: i for i, code in enumerate(known)}
    values = [number.get(code, -1) for code in codes.ravel().tolist()]
    return {MOTION: variable_field(MOTION, dims, np.array(values, dtype=np.int32).reshape(codes.shape))}


def _edges(results: Results, axes: tuple[str, ...]) -> dict[str, Field]:
    """R, alpha, p and eta of either edge where a body is asymmetric, over the axes they depend on."""
    found = {} if results.symmetric else {name: results.symbols.over(name, axes) for name in EDGES}
    return {
        name: replace(variable_field(name, *over), coordinate=True) for name, over in found.items() if over is not None
    }
