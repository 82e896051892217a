"""From what a solver found to the scalars that all solvers have in common, their sentences, and the impacts by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DONE, FALLS, OUT_OF_STEPS, UNDECIDED
from rockcli.kernels.formulas import potential
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT
from rockcli.scene.laws.models import MODELS
from rockcli.scene.response import (
    FAILED,
    MAX_IMPACTS_STORED,
    NO_UPLIFT,
    OVERTURNED_AFTER_IMPACT,
    OVERTURNED_WITHOUT_IMPACT,
    ROCKING,
    UNRESOLVED,
)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

IMPACTS = ("t_impact", "theta_dot_before", "theta_dot_after")
"""Variables of an impact."""


READ_BY_SOLVERS = frozenset({"outcome", "n_impacts", "t_overturn", "theta_peak_over_alpha"})
"""Scalars that are made whatever is asked for: solvers look at them."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a solver found of n cases, (n,) each; numbers may be anything where they mean nothing.

    Attributes:
        moved: whether the body has left the ground; fell: whether it overturns; undecided: the solver cannot tell;
            failed: there is no answer.
        n_impacts: counted impacts; struck_later: whether one came beyond the report, before the body falls.
        peak, side: largest |theta| and its sign; rate: largest |theta'|; top: largest displacement of the top.
        t_peak, t_uplift, t_overturn: times [s]; t_end: when it has fallen or rests [s], but for a given duration.
    """

    moved: Mask
    fell: Mask
    undecided: Mask
    failed: Mask
    n_impacts: NDArray[np.int64]
    peak: Array
    side: Array
    rate: Array
    top: Array
    t_peak: Array
    t_uplift: Array
    t_overturn: Array
    t_end: Array
    struck_later: Mask | bool = False

    @cached_property
    def outcome(self) -> NDArray[np.int8]:
        """Flags as in scene/response.py."""
        fallen = np.where((self.n_impacts > 0) | self.struck_later, OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT)
        outcome = np.where(self.fell, fallen, np.where(self.moved, ROCKING, NO_UPLIFT))
        outcome = np.where(self.failed, FAILED, np.where(self.undecided, UNRESOLVED, outcome))
        return np.asarray(outcome, dtype=np.int8)

    def largest(self, values: Array) -> Array:
        """The largest of something: infinite for a body that overturns, NaN where the outcome is not known."""
        return np.where(self.outcome < 0, np.nan, np.where(self.fell, np.inf, values))

    def unless_failed(self, values: Array) -> Array:
        """Values of cases that have an answer."""
        return np.where(self.failed, np.nan, values)

    @cached_property
    def theta_peak(self) -> Array:
        """Largest |theta| with its sign."""
        peak = self.largest(self.peak)
        return np.where(peak == 0.0, 0.0, np.copysign(peak, self.side))

    def scalars(self, batch: Batch) -> dict[str, NDArray[Any]]:
        """By name those that are asked for, and what solvers read; theta_peak over alpha of the left edge."""
        duration = batch.excitation.duration
        each: dict[str, Callable[[], NDArray[Any]]] = {
            "outcome": lambda: self.outcome,
            "theta_peak": lambda: self.theta_peak,
            "theta_peak_over_alpha": lambda: self.largest(self.peak) / batch.block.alpha[:, LEFT],
            "theta_dot_peak": lambda: self.largest(self.rate),
            "u_top_peak": lambda: self.largest(self.top),
            "t_peak": lambda: np.where(self.fell | ~self.moved | (self.outcome < 0), np.nan, self.t_peak),
            "t_uplift": lambda: self.unless_failed(self.t_uplift),
            "t_overturn": lambda: np.where(self.fell & ~self.failed, self.t_overturn, np.nan),
            "t_end": lambda: self.unless_failed(np.where(np.isfinite(duration), duration, self.t_end)),
            "n_impacts": lambda: self.n_impacts,
        }
        return {name: find() for name, find in each.items() if name in READ_BY_SOLVERS | batch.save.scalars}


def found_of(out: Array, to: ModuleType, top: Array) -> Found:
    """What the kernel of a rigid body found of cases, from its results (n, N_OUT) at the places of `to`, and `top`."""
    verdict = out[:, to.VERDICT]
    return Found(
        moved=np.isfinite(out[:, to.T_UPLIFT]),
        fell=verdict == FALLS,
        undecided=verdict == UNDECIDED,
        failed=out[:, to.STATUS] != DONE,
        n_impacts=counts(out[:, to.N_IMPACTS]),
        peak=out[:, to.PEAK],
        side=out[:, to.PEAK_SIDE],
        rate=out[:, to.RATE_PEAK],
        top=top,
        t_peak=out[:, to.T_PEAK],
        t_uplift=out[:, to.T_UPLIFT],
        t_overturn=out[:, to.T_OVERTURN],
        t_end=out[:, to.T_END],
        struck_later=out[:, to.STRUCK_LATER] > 0.0,
    )


def residual_tilt(batch: Batch, found: Found) -> Array:
    """Rotation in which bodies on two edges come to rest, (n,) [rad]: 0; NaN of one that falls or rocks for ever."""
    left, right = batch.damping.eta.T  # numpy is slow over an axis of two
    rocks_on = found.moved & (left == 1.0) & (right == 1.0) & batch.damping.only_eta
    return np.where((found.outcome < NO_UPLIFT) | found.fell | rocks_on, np.nan, 0.0)


def from_beyond(t_overturn: Array) -> Array:
    """Times of last outward passages of the equilibrium, (n,) [s]: what falls without one (NaN) began beyond it."""
    return np.where(np.isnan(t_overturn), 0.0, t_overturn)


def last_outward(t: Array, theta: Array, q: float) -> float:
    """Time of the last outward passage of |theta| = q, linear between times t (k,) of rotations theta (k,) [s].

    0 where it has been beyond from the start, NaN where the passage is yet to come in the end.
    """
    beyond = np.abs(theta) - q
    if beyond[-1] < 0.0:
        return np.nan
    at = np.flatnonzero((beyond[:-1] < 0.0) & (beyond[1:] >= 0.0))
    if not len(at):
        return 0.0
    j = int(at[-1])
    return float(t[j] - beyond[j] * (t[j + 1] - t[j]) / (beyond[j + 1] - beyond[j]))


def rigid_top(batch: Batch, peak: Array, sides: Array | None = None) -> Array:
    """Largest displacement of the top of bodies that do not bend, (n,) [m].

    Args:
        peak: their largest |theta|, (n,).
        sides: those to the left and to the right, (n, 2), which count where the support is tilted.
    """
    block = batch.block
    level = np.asarray(block.top * np.sin(np.minimum(peak, 0.5 * np.pi)))
    if sides is None or not block.rise.any():
        return level
    either = (block.tops * np.sin(np.minimum(sides, 0.5 * np.pi))).max(axis=1)
    return np.where(block.rise == 0.0, level, either)


def barrier(batch: Batch) -> Array:
    """Energy from upright to the unstable equilibrium of the weak edge, over m g, (n,) [m]."""
    model = MODELS[batch.model, batch.geometry]
    law = model.law(batch.block.alpha, batch.block.tan_alpha)
    q = np.minimum(law.q_star, np.pi)
    if model.linear:
        energy = q * (law.r0 + 0.5 * law.rs * q)
    else:
        energy = potential(law.r0, law.rc, q, 2.0 * law.rs * np.sin(0.5 * q) ** 2, np.sin(q))
    return batch.block.of_weak_edge(batch.block.R * energy)


ON_SEPARATRIX = "on the separatrix to machine precision: double precision does not decide whether it overturns"


def broke_off(status: float, steps: float, t: float | None = None) -> str:
    """Why a run of a kernel broke off after `steps` at `t` [s] if known, by its STATUS; "" if it came to its end."""
    if status == OUT_OF_STEPS:
        return f"gave up after {steps:.0f} steps" + ("" if t is None else f" at t = {t:.6g} s")
    finite = "the solution ceased to be finite: check the motion and the body for extreme numbers"
    return "" if status == DONE else finite


def counts(values: Array) -> NDArray[np.int64]:
    """Whole numbers that a kernel counted in floating point."""
    return np.rint(values).astype(np.int64)


def note_unstored(batch: Batch, n_impacts: NDArray[np.int64], reasons: list[str]) -> None:
    """Say of which cases not all impacts are stored."""
    if batch.save.histories:
        for i in np.flatnonzero(n_impacts > MAX_IMPACTS_STORED):
            said = f"of its impacts the first {MAX_IMPACTS_STORED} are stored"
            reasons[i] = "; ".join(filter(None, [reasons[i], said]))


def impacts_of(each: Sequence[Array]) -> dict[str, Array]:
    """Impacts by name, (n, j), NaN-padded, from those of every case, (j_i, 3)."""
    most = min(max([0, *(len(rows) for rows in each)]), MAX_IMPACTS_STORED)
    stored = np.full((3, len(each), most), np.nan)
    for i, rows in enumerate(each):
        kept = rows[:most]
        stored[:, i, : len(kept)] = kept.T
    return dict(zip(IMPACTS, stored, strict=True))
