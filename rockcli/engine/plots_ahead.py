"""Tells which plots of a study its dataset cannot show, before anything is solved."""

from __future__ import annotations

import numpy as np

from rockcli.analysis.expect import names_ahead
from rockcli.engine.provenance import as_json
from rockcli.engine.sweep.assemble import axis_fields
from rockcli.engine.sweep.symbols_of_cases import describe_cases
from rockcli.errors import StudyError
from rockcli.scene.variables import LARGE, PEAK, TIME
from rockcli.storage.contents import Contents, Field
from rockcli.storage.lazy import lazily
from rockcli.study.study import Study

_OF_CASES = {"motion": "pga", "bending": "u_top_bending", "barriers": "barrier"}
"""What a plot needs that only some motions or bodies have."""


def check_plots(study: Study) -> None:
    """`StudyError` if a plot asked for cannot be drawn, whatever comes of the cases, or selects what is not there."""
    doubtful = [(kind, look) for kind, look in study.plots or () if look.select or not _surely(kind, study)]
    if not doubtful:  # spares the libraries of figures
        return
    from rockcli.plotting.import_matplotlib import import_lean

    import_lean()
    from rockcli.plotting.common.selection import selected
    from rockcli.plotting.figures import why_not

    dataset = lazily(_ahead(study, {kind for kind, _ in doubtful}))
    for kind, look in doubtful:
        try:
            part, _ = selected(dataset, look.select)
            complaint = why_not(kind, part)
        except StudyError as error:
            complaint = error.message
        if complaint:
            raise StudyError(f"plots: {kind}: {complaint}", file=study.file, line=look.line)


def _surely(kind: str, study: Study) -> bool:
    """Whether the usual kinds can be drawn, as the study alone tells."""
    if kind in ("histories", "phase"):
        return study.histories
    if kind in ("map", "curve"):
        return PEAK in study.scalars and any(axis.numeric and axis.size > 1 for axis in study.axes)
    return kind == "body" or (kind == "curves" and bool(study.curves))


def _ahead(study: Study, kinds: set[str]) -> Contents:
    """The dataset by its axes and names; a 1 stands for what is not known yet."""
    asked = {name for kind, name in _OF_CASES.items() if kind in kinds}
    names = names_ahead(study, asked) | ({TIME} if study.histories else set())
    names |= {"boundary_curve"} if study.refine else set()
    fields = {name: _number(1.0) for name in names - {"p"}}
    if "a_g" in fields and "motion" in kinds and "pga" not in names and study.size <= LARGE:
        fields["a_g"] = _number(0.0)
    if "spectrum" in kinds:
        fields["p"] = _p(study)
    over = study.over
    attrs = {"case": as_json(study.case)}
    if over is not None:
        from rockcli.analysis.suites.statistics import variables

        members = over.axes[0] if len(over.axes) == 1 else over.axes
        about = {"axis": members, "along": over.along, "told_against": over.told_against}
        attrs["ensemble"] = as_json(about | {"fields": sorted(variables(study))})
    axes = axis_fields(study)
    return Contents(tuple(axes), fields | axes, attrs)


def _number(value: float) -> Field:
    return Field((), np.array(value))


def _p(study: Study) -> Field:
    """p over the axes that change it; of more than LARGE cases over the longest numeric axis beside a suite."""
    if study.size <= LARGE:
        found = describe_cases(study).symbols.over("p", tuple(axis.name for axis in study.axes))
        return _number(np.nan) if found is None else Field(*found)
    members = study.over.axes if study.over is not None else ()
    sizes = [axis for axis in study.axes if axis.numeric and axis.name not in members]
    longest = max(sizes, key=lambda axis: axis.size, default=None)
    return _number(1.0) if longest is None else Field((longest.name,), np.ones(longest.size))
