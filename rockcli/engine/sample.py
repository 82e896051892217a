"""The cases that `rock trade` measures, and the models of the study they come from."""

from __future__ import annotations

import numpy as np

from rockcli.engine.ladder import Pair
from rockcli.errors import StudyError
from rockcli.scene.batch import Batch
from rockcli.scene.models import CONTINUUM, DEFORMABLE, FLEXIBLE
from rockcli.study.study import Index, Study

SEED = 20260102
"""Of the sample: the same cases every time."""


class Sample:
    """The sampled cases: batches, each with the rows it fills; the first alone; the models the study solves.

    Raises:
        StudyError: the study searches a range, or asks for the scheme fema356, which has no settings to trade.
    """

    def __init__(self, study: Study, sample: int) -> None:
        if study.search is not None:
            raise StudyError("trade: needs cases, and `find` keeps none", file=study.file)
        ours = [axis.path.split(".")[0] in ("solver", "model", "geometry") for axis in study.axes]
        shape = [1 if own else axis.size for own, axis in zip(ours, study.axes, strict=True)]
        total = int(np.prod(shape, dtype=np.int64))
        chosen = np.arange(total)
        if sample < total:
            chosen = np.sort(np.random.default_rng(SEED).choice(total, sample, replace=False))
        at, self.own, self.along = _models_of(study, ours)
        places = np.unravel_index(chosen, shape) if shape else ()
        flat = [place + own for place, own in zip(places, at, strict=True)]
        self.cases = np.sort(np.ravel_multi_index(flat, study.shape)) if shape else chosen
        self.batches = [(np.searchsorted(self.cases, part), batch) for part, batch in study.batches(self.cases)]
        self.own += [p for p in dict.fromkeys((b.model, b.geometry) for _, b in self.batches) if p not in self.own]
        _, self.first = next(study.batches(self.cases[:1]))
        if any(batch.damping.scheme == "fema356" for _, batch in self.batches):
            raise StudyError("trade: the scheme fema356 has no ladder of settings", file=study.file)

    def solvable(self, pair: Pair) -> list[tuple[Index, Batch]]:
        """Batches that can be solved with a model: a column is not made up."""
        made_up = pair[0] in DEFORMABLE
        return [(rows, batch) for rows, batch in self.batches if not made_up or batch.model in DEFORMABLE]


def _models_of(study: Study, ours: list[bool]) -> tuple[tuple[int, ...], list[Pair], int]:
    """Where on the axes over model, geometry and solver the cases are taken from, and the models along those axes.

    A deformable model goes first: only its cases know the column.  Last, the elements along of the study's full mesh.
    """
    along = [axis.size if own else 1 for own, axis in zip(ours, study.axes, strict=True)]
    combos = [tuple(int(i) for i in combo) for combo in np.ndindex(*along)]
    found: dict[Pair, tuple[int, ...]] = {}
    elements = 0
    for combo in combos:
        flat = int(np.ravel_multi_index(combo, study.shape)) if combo else 0
        _, batch = next(study.batches(np.array([flat])))
        found.setdefault((batch.model, batch.geometry), combo)
        if batch.model == CONTINUUM and batch.column is not None:
            elements = batch.column.elements
    pairs = sorted(found, key=lambda pair: (pair[0] != FLEXIBLE, pair[0] != CONTINUUM))
    return found[pairs[0]], pairs, elements
