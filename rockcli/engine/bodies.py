"""The distinct bodies of a study's cases, each with where it stands on the axes: for `rock check`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.uplift import factor_of
from rockcli.scene.auto import highest
from rockcli.scene.batch import Batch
from rockcli.scene.laws.contact import slides_first
from rockcli.scene.laws.models import DEFORMABLE, MODELS
from rockcli.study.study import Axis, Study
from rockcli.study.unused import names_in

_POINTS = 3
"""Points of an axis that are named of a body that stands at several."""

_DIGITS = 12
"""Digits to which two bodies are the same."""


UPLIFT = "uplift at [g]"
"""The column of the acceleration of the ground at which bodies lift."""


def uplift_words(*, deforms: bool, vertical: bool) -> str:
    """What that acceleration is said to be where bodies deform, or some motion is vertical too."""
    whose = " of a rigid body" if deforms else ""
    return f"uplift{whose}{' without vertical motion' if vertical else ''} at [g]"


class Bodies:
    """Collects the bodies of batches of cases."""

    def __init__(self, study: Study, most: int) -> None:
        self._study = study
        self._most = most
        self._times = 1
        self._of_motion = {axis.name for axis in study.axes if _is_of_motion(axis, study)}
        self._deforms = self._vertical = False
        self._found: dict[tuple[float, ...], tuple[dict[str, float | str], list[NDArray[np.int64]]]] = {}

    def add(self, indices: NDArray[np.int64], batch: Batch) -> None:
        """Look at the cases `indices` of the study, which a batch holds."""
        self._deforms |= highest(batch).model in DEFORMABLE
        self._vertical |= batch.excitation.vertical is not None
        numbers = np.column_stack(list(_numbers(batch).values()))
        rounded = np.array([[float(f"{x:.{_DIGITS}g}") for x in row] for row in numbers[:1]])
        if len(numbers) > 1:
            with np.errstate(all="ignore"):
                scale = 10.0 ** (_DIGITS - np.ceil(np.log10(np.abs(numbers))))
                rounded = np.where(np.isfinite(scale), np.round(numbers * scale) / scale, numbers)
        distinct, at = np.unique(np.nan_to_num(rounded, nan=-1.0), axis=0, return_inverse=True)
        for k in range(len(distinct)):
            cases = np.flatnonzero(at.ravel() == k)
            row = dict(zip(_numbers(batch), numbers[cases[0]].tolist(), strict=True))
            begins = {} if np.isnan(row["mu"]) else {"begins to": _begins(batch, int(cases[0]))}
            entry = self._found.setdefault(tuple(distinct[k].tolist()), (row | begins, []))
            entry[1].append(np.asarray(indices)[cases])

    def add_under_one_motion(self) -> None:
        """Look at the cases under the first motion alone, `most` at most, and count them as often as there are motions.

        Those of a large study in their own order would be of its first bodies only.
        """
        sizes = [1 if axis.name in self._of_motion else axis.size for axis in self._study.axes]
        count = min(int(np.prod(sizes, dtype=np.int64)), self._most)
        places = np.unravel_index(np.arange(count), sizes)
        self._times = self._study.size // int(np.prod(sizes, dtype=np.int64))
        for indices, batch in self._study.batches(np.ravel_multi_index(places, self._study.shape)):
            self.add(indices, batch)

    @property
    def uplift(self) -> str:
        """What the column UPLIFT is said to be."""
        return uplift_words(deforms=self._deforms, vertical=self._vertical)

    def rows(self) -> Iterator[dict[str, float | str]]:
        """A row for each body, in the order of the cases."""
        entries = [(np.sort(np.concatenate(cases)), row) for row, cases in self._found.values()]
        entries.sort(key=lambda entry: int(entry[0][0]))
        shape = self._study.shape or (1,)
        where = [np.unravel_index(cases, shape) for cases, _ in entries]
        words = any("begins to" in row for _, row in entries)
        for (cases, row), places in zip(entries, where, strict=True):
            name = {"body": self._name(places)}
            last = {"begins to": row.get("begins to", "")} if words else {}
            yield {
                **name,
                "cases": float(len(cases) * self._times),
                **{k: v for k, v in row.items() if k != "begins to"},
                **last,
            }

    def _name(self, places: tuple[NDArray[np.int64], ...]) -> str:
        """`case=rack-01`: the axes of which this body stands at some points only, and the first of these."""
        named = []
        for axis, at in zip(self._study.axes, places, strict=False):
            points = np.unique(at).tolist()
            if len(points) < axis.size and axis.name not in self._of_motion:
                values = [axis.values[i] for i in points[:_POINTS]]
                words = [f"{value:.6g}" if isinstance(value, float) else str(value) for value in values]
                words += [f"{len(points) - _POINTS} more"] if len(points) > _POINTS else []
                *others, last = words
                named.append(f"{axis.name}={', '.join(others)}{' and ' if others else ''}{last}")
        return ", ".join(named)


def _is_of_motion(axis: Axis, study: Study) -> bool:
    """Whether an axis leaves the body as it is: one of the motion, or of a symbol that only the motion speaks of."""
    if not axis.path.startswith("let."):
        return axis.path.startswith("motion")
    let = study.resolved.get("let") or {}
    said = [study.resolved["case"], *(study.resolved.get(key) or {} for key in ("vary", "uncertain"))]
    speak = [value for part in said for key, value in part.items() if not key.startswith("motion")]
    speak += [each.values.tolist() for one in study.axes for each in one.given if not each.path.startswith("motion")]
    found, waiting = set[str](), set(names_in(speak))
    while waiting:  # what a symbol is made of is spoken of too
        found |= waiting
        waiting = {name for one in waiting for name in names_in(let.get(one))} - found
    return axis.path.removeprefix("let.") not in found


def _numbers(batch: Batch) -> dict[str, NDArray[np.float64]]:
    """What tells bodies apart, (n,) each, of an asymmetric one about its weaker edge."""
    block, pair = batch.block, (batch.model, batch.geometry)
    alpha, tan_alpha = block.of_weak_edge(block.alpha), block.of_weak_edge(block.tan_alpha)
    threshold = (MODELS[pair].law(alpha, tan_alpha).threshold if pair in MODELS else tan_alpha) * factor_of(batch)
    found = {
        "h [m]": block.h,
        "b [m]": block.of_weak_edge(block.b),
        "alpha [deg]": np.degrees(alpha),
        "p [rad/s]": block.of_weak_edge(batch.p) if np.ndim(batch.p) == 2 else batch.p,
        "mu": block.mu,
        UPLIFT: threshold,
    }
    return {name: np.broadcast_to(np.asarray(values, dtype=float), (batch.size,)) for name, values in found.items()}


def _begins(batch: Batch, i: int) -> str:
    slides = slides_first(float(batch.block.mu[i]), batch.block.tan_alpha[i])
    return "slide" if slides.all() else "rock" if not slides.any() else "slide or rock, by direction"
