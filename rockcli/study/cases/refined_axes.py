"""`refine`: the two axes of a map whose boundary between outcomes is traced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rockcli.study.document.tree import Map, Source
from rockcli.study.schema import StudyPart
from rockcli.study.study import Axis, Over

RECORDS = (
    "refine under a recorded motion: the boundary of overturning is fractal there; islands smaller than the coarse "
    "grid may be missed, and the summary says how many pixels may be wrong at most"
)
"""What is to be said where a map of a recorded motion is refined."""


def read_refine(
    source: Source,
    study: Map,
    part: StudyPart,
    axes: Sequence[Axis],
    scalars: Sequence[str],
    *,
    searches: bool,
    over: Over | None,
) -> tuple[str, ...]:
    """Names of the two axes to be refined, as they stand in `vary`; () where the study does not ask for it.

    They are the two numeric axes of most points, at equal length the inner ones.

    Raises:
        StudyError: there are no two numeric axes, one of them is not in order, or the study asks for what needs every
            case to be solved: histories, ensemble statistics, a search.
    """
    if not part.refine:
        return ()
    key = "over" if part.over is not None else "uncertain"  # samples are told over where `over` is not said
    for asked, why in (
        (searches, "`find` does not make a map; leave out one of the two"),
        (over is not None, f"`{key}` takes statistics of cases, of which `refine` leaves most out; drop one of them"),
        (part.save.histories, "no histories are saved of a refined map; drop save.histories"),
        ("outcome" not in scalars, "needs outcomes, and this study is one of static curves"),
    ):
        if asked:
            raise source.error(study, ("refine",), f": {why}")
    numeric = [axis for axis in axes if axis.numeric and axis.size >= 2]
    if len(numeric) < 2:
        raise source.error(study, ("refine",), f"needs two numeric axes (`vary`); there are {len(numeric)}")
    chosen = sorted(numeric, key=lambda axis: (-axis.size, -numeric.index(axis)))[:2]
    for axis in chosen:
        steps = np.diff(np.asarray(axis.values, dtype=float))
        if not (steps > 0.0).all() and not (steps < 0.0).all():
            raise source.error(study, ("vary", axis.path), "is not ascending or descending; `refine` needs it")
    return tuple(axis.name for axis in axes if axis in chosen)
