"""The outlines of a study's bodies, kept in its dataset so that figures and animations can draw them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.variables import OUTLINE
from rockcli.storage.contents import Contents, variable_field
from rockcli.storage.reduced import reduce
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Study

Array = NDArray[np.float64]

NAMES = ("outline_x", "outline_z")

MOST_BODIES = 20_000
"""Points, on the axes that may change the body, up to which its outlines are kept."""

MOST_NUMBERS = 2_000_000
"""Numbers in all outlines together up to which they are kept."""

NOT_OF_THE_BODY = frozenset({"motion", "initial", "model", "geometry", "column", "base", "damping", "solver"})
"""Parts of a case that its body does not depend on."""


def with_outlines(contents: Contents, study: Study) -> Contents:
    """Add `outline_x` and `outline_z` over the axes that change the body and `outline_point`, where bodies have any.

    They are left out where there would be too many (`MOST_BODIES`, `MOST_NUMBERS`).

    Raises:
        StudyError, RecordError: a case cannot be built.
    """
    fields = {name: item for name, item in contents.fields.items() if name not in NAMES}
    found = _outlines(study)
    if found is not None:
        dims, points = found
        for column, name in enumerate(NAMES):
            fields[name] = variable_field(name, (*dims, OUTLINE), points[..., column])
    return Contents(contents.axes, fields, contents.attrs)


def _outlines(study: Study) -> tuple[tuple[str, ...], Array] | None:
    """Names of the axes that change the body, and its outlines over them, (*axes, points, 2)."""
    paths = [axis.path.removeprefix("case.").split(".")[0] for axis in study.axes]
    block = study.resolved.get("case", {}).get("block") or {}
    if block.keys().isdisjoint(("outline", "parts")) and not {"block", "case"} & set(paths):
        return None
    may = [i for i, path in enumerate(paths) if path not in NOT_OF_THE_BODY]
    shape = tuple(study.shape[i] for i in may)
    if (size := int(np.prod(shape, dtype=np.int64))) > MOST_BODIES:
        return None
    at = np.zeros((len(paths), size), dtype=np.int64)
    at[may] = np.array(np.unravel_index(np.arange(size), shape)) if may else 0
    cases = np.atleast_1d(np.ravel_multi_index(tuple(at), study.shape)) if paths else np.zeros(1, dtype=np.int64)
    distinct: dict[bytes, tuple[int, Array]] = {}
    which = np.full(size, -1.0)
    for part, batch in buildable(study.batches, np.asarray(cases, dtype=np.int64)):
        if batch.block.outline is None:
            continue
        for case, points in zip(np.searchsorted(cases, part).tolist(), batch.block.outline, strict=True):
            which[case] = distinct.setdefault(points.tobytes(), (len(distinct), points))[0]
        if sum(points.size for _, points in distinct.values()) > MOST_NUMBERS:
            return None
    if not distinct:
        return None
    dims, codes = reduce(which.reshape(shape), tuple(study.axes[i].name for i in may))
    longest = max(len(points) for _, points in distinct.values())
    table = np.full((len(distinct) + 1, longest, 2), np.nan)  # its last row, -1: a body of no outline
    for row, points in distinct.values():
        table[row, : len(points)] = points
    chosen = table[codes.astype(np.int64)]
    return None if chosen.size > MOST_NUMBERS else (dims, chosen)
