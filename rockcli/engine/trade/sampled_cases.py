"""The cases that `rock trade` measures, and the models of the study they come from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from rockcli.errors import StudyError
from rockcli.scene.auto import AUTO, CANDIDATES, candidate_of_reference, highest
from rockcli.scene.backends import BACKENDS, Pair
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import CONTINUUM, DEFORMABLE, FLEXIBLE
from rockcli.study.study import Index, Study

SEED = 20260102
"""Of the sample: the same cases every time."""


class Sample:
    """The sampled cases: batches, each with the rows it fills; the models the study solves.

    A case of model auto is one of the highest model its data allow, and `notes` say so.

    Raises:
        StudyError: the study searches a range, or asks for a damping scheme whose backends have no settings to trade.
    """

    def __init__(self, study: Study, sample: int) -> None:
        if study.search is not None:
            raise StudyError("trade: needs cases; a search (`find`) keeps none", file=study.file)
        self._highest: set[int] = set()
        ours = [axis.path.split(".")[0] in ("solver", "model", "geometry") for axis in study.axes]
        shape = [1 if own else axis.size for own, axis in zip(ours, study.axes, strict=True)]
        total = int(np.prod(shape, dtype=np.int64))
        chosen = np.arange(total)
        if sample < total:
            chosen = np.sort(np.random.default_rng(SEED).choice(total, sample, replace=False))
        found, self.along = self._models_of(study, ours)
        places = np.unravel_index(chosen, shape) if shape else ()
        flat = [place + own for place, own in zip(places, found[_ordered(found)[0]], strict=True)]
        self.cases = np.sort(np.ravel_multi_index(flat, study.shape)) if shape else chosen
        self.batches = [(np.searchsorted(self.cases, part), batch) for part, batch in self._taken(study, self.cases)]
        self.own = _ordered([*found, *((batch.model, batch.geometry) for _, batch in self.batches)])
        for scheme in (batch.damping.scheme for _, batch in self.batches):
            if not any(row.settings and scheme in row.damping for row in BACKENDS.values()):
                raise StudyError(f"trade: the scheme {scheme} has no series of settings to measure", file=study.file)

    @property
    def notes(self) -> list[str]:
        """What model auto is traded as."""
        names = " or ".join(CANDIDATES[setting].replace("_", " on ") for setting in sorted(self._highest, reverse=True))
        return [f"model auto: measured as {names}, the highest model that its data allow"] if names else []

    @property
    def rolls(self) -> bool:
        """Whether a body rolls over vertices beside its two edges, which `event` alone solves, as model rigid."""
        return any(bool(batch.block.rolls.any()) for _, batch in self.batches)

    @property
    def slides(self) -> bool:
        """Whether friction is given of a rigid body, which `event` alone takes notice of."""
        return ("rigid", None) in self.own and any(bool(np.isfinite(b.block.mu).any()) for _, b in self.batches)

    def solvable(self, pair: Pair) -> list[tuple[Index, Batch]]:
        """Batches that can be solved with a model: a column is not made up."""
        made_up = pair[0] in DEFORMABLE
        return [(rows, batch) for rows, batch in self.batches if not made_up or batch.model in DEFORMABLE]

    def first(self, pair: Pair) -> Batch:
        """The first case, alone, of those that can be solved with a model."""
        return self.solvable(pair)[0][1].rows(np.zeros(1, dtype=np.int64))

    def _taken(self, study: Study, indices: Index) -> Iterator[tuple[Index, Batch]]:
        """Batches of some cases, those of model auto with the highest model."""
        for rows, batch in study.batches(indices):
            if batch.model == AUTO:
                self._highest.add(candidate_of_reference(batch))
            yield rows, highest(batch)

    def _models_of(self, study: Study, ours: list[bool]) -> tuple[dict[Pair, tuple[int, ...]], int]:
        """The models along the axes over model, geometry and solver, and where on those axes each is first.

        Last, the elements along of the study's full mesh.
        """
        along = [axis.size if own else 1 for own, axis in zip(ours, study.axes, strict=True)]
        combos = [tuple(int(i) for i in combo) for combo in np.ndindex(*along)]
        found: dict[Pair, tuple[int, ...]] = {}
        elements = 0
        for combo in combos:
            flat = int(np.ravel_multi_index(combo, study.shape)) if combo else 0
            _, batch = next(self._taken(study, np.array([flat])))
            found.setdefault((batch.model, batch.geometry), combo)
            if batch.model == CONTINUUM and batch.column is not None:
                elements = batch.column.elements
        return found, elements


def _ordered(pairs: Iterable[Pair]) -> list[Pair]:
    """Each once, deformable models first: only their cases know the column."""
    return sorted(dict.fromkeys(pairs), key=lambda pair: (pair[0] != FLEXIBLE, pair[0] != CONTINUUM))
