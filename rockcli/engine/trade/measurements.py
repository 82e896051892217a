"""What `rock trade` measured: answers of a setting over the sample, their error, and the settings on the front."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.trade.settings import NUMERICS, Setting
from rockcli.scene.backends import Pair
from rockcli.scene.response import FAILED, NO_UPLIFT, SLIDING, Response, overturned
from rockcli.study.study import Index

Array = NDArray[np.float64]


@dataclass(eq=False)
class Answers:
    """Outcome, peak, steps and right-hand sides over the sampled cases, (n,) each; `why`: what the first says."""

    outcome: NDArray[np.int8]
    peak: Array
    steps: Array
    rhs: Array
    seconds: float = 0.0
    cases: int = 0
    why: str = ""

    @classmethod
    def none(cls, n: int) -> Answers:
        """Nothing yet."""
        return cls(np.full(n, FAILED, dtype=np.int8), np.full(n, np.nan), np.full(n, np.nan), np.full(n, np.nan))

    def put(self, rows: Index, response: Response) -> None:
        """Take the answers of some cases."""
        self.outcome[rows] = response.scalars["outcome"]
        self.why = self.why or next(filter(None, response.reasons), "")
        self.peak[rows] = response.scalars["theta_peak_over_alpha"]
        for values, name in ((self.steps, "n_steps"), (self.rhs, "n_rhs")):
            if name in response.scalars:
                counted = response.scalars[name].astype(np.float64)
                values[rows] = np.where(counted < 0.0, np.nan, counted)

    @property
    def complete(self) -> bool:
        """Whether no case that was asked for failed; cases without a column are not asked for a deformable model."""
        return int(np.sum(self.outcome != FAILED)) == self.cases

    @property
    def why_no_peaks(self) -> str:
        """What all cases do, if it leaves peaks with nothing to tell; "" otherwise."""
        solved = self.outcome[self.outcome != FAILED]
        if self.complete and overturned(solved).all():
            return "every sampled case overturns, so no peak can be compared, only outcomes"
        return "no sampled case uplifts" if self.complete and np.isin(solved, (NO_UPLIFT, SLIDING)).all() else ""


@dataclass(eq=False)
class Point:
    """A setting measured over the sample.

    Attributes:
        error: peak minus the reference's, (n,), NaN unless both are finite; same: 1, 0, or -1 where either has none.
        on_front: whether no other setting of its part and model is both cheaper and more accurate.
    """

    setting: Setting
    answers: Answers
    error: Array
    same: NDArray[np.int8]
    on_front: bool = False

    @property
    def cost(self) -> float:
        """Time per case [s]."""
        return self.answers.seconds / max(self.answers.cases, 1)

    def quantile(self, share: float) -> float:
        """Of |error|; NaN where no peak can be compared."""
        finite = np.abs(self.error[np.isfinite(self.error)])
        return float(np.quantile(finite, share)) if finite.size else np.nan

    @property
    def wrong(self) -> int:
        """Outcomes that differ."""
        return int(np.sum(self.same == 0))

    @property
    def compared(self) -> int:
        """Outcomes that both have."""
        return int(np.sum(self.same >= 0))

    @property
    def wrong_share(self) -> float:
        """Share of the outcomes compared that differ; NaN where none is."""
        return self.wrong / self.compared if self.compared else np.nan


@dataclass(eq=False)
class Trade:
    """What was measured.

    Attributes:
        points: in the order of the families; cases: flat indices of the sample; size: cases the study has.
        references: model -> how its reference was found.
        skipped: (setting, backend or kind of error, why there is no error of it).
        notes: sentences about the sample: what model auto was taken as, why no peak tells anything.
    """

    cases: Index
    size: int
    points: list[Point] = field(default_factory=list)
    references: dict[str, str] = field(default_factory=dict)
    skipped: list[tuple[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def point_of(setting: Setting, found: Answers, best: Answers | None) -> Point:
    """A setting with its error; `best` None: it is the reference itself, with nothing to be held against."""
    if best is None:
        best = Answers.none(len(found.peak))
    both = np.isfinite(found.peak) & np.isfinite(best.peak)
    error = np.subtract(found.peak, best.peak, out=np.full(len(both), np.nan), where=both)
    decided = (found.outcome >= NO_UPLIFT) & (best.outcome >= NO_UPLIFT)
    return Point(setting, found, error, np.where(decided, found.outcome == best.outcome, -1).astype(np.int8))


def middle(counts: Array) -> float:
    """The median of those that are known, NaN where none is."""
    known = counts[np.isfinite(counts)]
    return float(np.median(known)) if known.size else np.nan


def mark_fronts(points: list[Point]) -> None:
    """Pareto front of cost and error, for each model of each part, among settings with no failed case.

    Errors against different references, as those of steps and of elements, are not compared.
    """
    groups: dict[tuple[str, Pair | None, str], list[Point]] = {}
    for point in points:
        if point.answers.complete:
            pair = (point.setting.model, point.setting.geometry) if point.setting.part == NUMERICS else None
            groups.setdefault((point.setting.part, pair, point.setting.against), []).append(point)
    for group in groups.values():
        known = _known(group)
        for (point, _), kept in zip(known, front([(p.cost, error) for p, error in known]), strict=True):
            point.on_front = kept


def _known(points: list[Point]) -> list[tuple[Point, float]]:
    """Points with their median errors; where no point has one, with the share of outcomes that are wrong."""
    medians = [(p, error) for p in points if np.isfinite(error := p.quantile(0.5))]
    return medians or [(p, share) for p in points if np.isfinite(share := p.wrong_share)]


def front(points: list[tuple[float, float]]) -> list[bool]:
    """Whether no other point is at least as good in both numbers and better in one."""
    return [not any(o[0] <= p[0] and o[1] <= p[1] and o != p for o in points) for p in points]


def by_reference(points: list[Point]) -> dict[str, list[Point]]:
    """Reference -> points whose errors are against it."""
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(point.setting.against, []).append(point)
    return groups


def on_front(points: list[Point]) -> list[Point]:
    """Points on their fronts, cheapest first within each model."""
    chosen = [p for p in points if p.on_front]
    names = list(dict.fromkeys((p.setting.model, p.setting.geometry) for p in points))
    return sorted(chosen, key=lambda p: (names.index((p.setting.model, p.setting.geometry)), p.cost))


def best_of_others(points: list[Point]) -> list[Point]:
    """The most accurate point of every family, of each model, that has none on the front."""
    families: dict[tuple[Pair, str], list[Point]] = {}
    for p in points:
        families.setdefault(((p.setting.model, p.setting.geometry), p.setting.family), []).append(p)
    others = [_known(own) for own in families.values() if not any(p.on_front for p in own)]
    return [min(known, key=lambda one: (one[1], one[0].cost))[0] for known in others if known]
