"""From the raw output of the kernels to variables by name."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DONE, FALLS
from rockcli.kernels.formulas import restoring
from rockcli.kernels.rigid import results as to
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT, impulse_ratio
from rockcli.scene.laws.models import MODELS
from rockcli.scene.repeated import repeated
from rockcli.scene.response import NO_UPLIFT, UNRESOLVED
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.certainty import withdraw
from rockcli.solvers.common.found import (
    IMPACTS,
    ON_SEPARATRIX,
    Found,
    barrier,
    broke_off,
    counts,
    found_of,
    note_unstored,
    residual_tilt,
    rigid_top,
)
from rockcli.solvers.common.ground import ground_history

Array = NDArray[np.float64]

COLUMNS: dict[str, int] = {
    name: getattr(to, name.upper()) for name in SCALARS if getattr(to, name.upper(), to.N_OUT) < to.N_OUT
}
"""Scalars that have a column of their name in the results of the kernel, which needs no more to be told."""

FORCES = frozenset({"theta_dot_peak", "mu_required", "N_min_over_mg", "energy_residual"})
"""Scalars that cost a look along every step; NaN when nothing of the kind is wanted."""


class Raw:
    """Raw output of the kernels for a batch: `out` (n, N_OUT), columns as in `kernels.rigid.results`.

    histories (n, 2, k): theta and its rate; impacts (n, 3, j): time, rate before and after.
    """

    def __init__(self, n: int, n_time: int, n_impacts: int, out: Array | None = None) -> None:
        self.out = np.zeros((n, to.N_OUT)) if out is None else out
        self.histories = np.full((n, 2, n_time), np.nan)
        self.impacts = np.full((n, 3, n_impacts), np.nan)

    def put(self, rows: NDArray[np.int64], other: Raw) -> None:
        """Take other runs, as large, in place of those of some cases."""
        for name, values in vars(other).items():
            getattr(self, name)[rows] = values


def scalars_of(
    batch: Batch, run: Raw, slides: NDArray[np.bool_] | bool = False
) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case from the raw output; none where `slides` has another solver answer."""
    out, asked, nothing = run.out, batch.save.scalars, repeated(np.full(1, np.nan), batch.size)
    sides = out[:, [to.PEAK_LEFT, to.PEAK_RIGHT]] if batch.block.rise.any() else None
    found = found_of(out, to, rigid_top(batch, out[:, to.PEAK], sides) if "u_top_peak" in asked else nothing)
    left, right, ratio = _by_side(batch, out, found.largest(out[:, to.PEAK]))
    unseen = found.failed | ~np.isfinite(out[:, to.N_MIN])  # forces and rates were not asked for
    mu_required, N_min = (nothing, nothing) if unseen.all() else standing_extremes(out, found.fell)
    friction = "mu_impact" in asked or bool(np.isfinite(batch.block.mu).any())
    onto, steps = (out[:, to.ONTO_LEFT] > 0, out[:, to.ONTO_RIGHT] > 0), counts(out[:, to.N_STEPS])

    tilted = batch.block.rise != 0.0  # forces are found along and across a level base

    def seen(values: Array) -> Array:
        return values if values is nothing else np.where(unseen, np.nan, values)

    def of_level(values: Array) -> Array:
        return np.where(tilted, np.nan, values) if tilted.any() else values

    scalars = found.scalars(batch)
    scalars |= {
        "theta_peak_left": left,
        "theta_peak_right": right,
        "theta_peak_over_alpha": ratio,
        "theta_dot_peak": seen(found.largest(found.rate)) if "theta_dot_peak" in asked else nothing,
        "mu_required": of_level(seen(mu_required)),
        "mu_impact": of_level(found.unless_failed(_impact_friction(batch, *onto))) if friction else nothing,
        "N_min_over_mg": of_level(seen(N_min)),
        "energy_residual": seen(over(out[:, to.ENERGY], barrier(batch))) if "energy_residual" in asked else nothing,
        "residual_tilt": residual_tilt(batch, found) if "residual_tilt" in asked else nothing,
        "n_steps": steps,
        "n_rhs": steps,  # a step is one expansion
    }
    scalars |= columns_asked(found, out, asked - scalars.keys())
    return scalars, sentences_of(batch, scalars, out, slides)


def columns_asked(found: Found, out: Array, names: frozenset[str]) -> dict[str, Array]:
    """Scalars that are told as they stand in a column."""
    return {name: found.unless_failed(out[:, COLUMNS[name]]) for name in names & COLUMNS.keys()}


def _by_side(batch: Batch, out: Array, peak: Array) -> tuple[Array, Array, Array]:
    """Largest |theta| to the left and to the right, NaN for symmetric bodies, and the larger |theta|/alpha, (n,) each.

    `peak`: the largest |theta|, inf overturned, NaN unknown.
    """
    symmetric, alpha, side = batch.block.symmetric, batch.block.alpha, out[:, to.PEAK_SIDE]
    ratio, nothing = peak / out[:, to.PEAK_ALPHA], np.full(batch.size, np.nan)
    if symmetric.all():
        return nothing, nothing, ratio
    left, right = (
        np.where(symmetric | np.isnan(peak), np.nan, np.where(np.isinf(peak) & (side == sign), np.inf, out[:, column]))
        for sign, column in ((-1.0, to.PEAK_LEFT), (1.0, to.PEAK_RIGHT))
    )
    larger = np.maximum(left / alpha[:, LEFT], right / alpha[:, RIGHT])
    return left, right, np.where(symmetric, ratio, larger)


def standing_extremes(out: Array, fell: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Largest friction and smallest normal force of the report, (n,).

    Of a body that falls they end at its last outward passage of the equilibrium.
    What it needs on its way to the ground says nothing about how it got there.  NaN for one that falls from beyond the
    equilibrium at once: it never stood.
    """
    passed = fell & (out[:, to.T_OVERTURN] <= out[:, to.T_END])
    never = passed & (out[:, to.T_OVERTURN] == 0.0)
    both = ((to.MU, to.MU_STANDING), (to.N_MIN, to.N_STANDING))
    mu, normal = (np.where(never, np.nan, np.where(passed, out[:, up_to], out[:, all_])) for all_, up_to in both)
    return mu, normal


def over(energy: Array, barrier: Array) -> Array:
    """energy/barrier; of a body too slender for its barrier to be a number, 0."""
    return np.asarray(np.divide(energy, barrier, out=np.zeros_like(energy), where=barrier > 0.0))


def friction_and_normal(batch: Batch, out: Array) -> tuple[Array, Array]:
    """Largest friction, impacts included, and smallest normal force over m g of a raw output with forces, (n,) each.

    NaN for a case that the kernels did not solve.
    """
    mu, least = standing_extremes(out, out[:, to.VERDICT] == FALLS)
    needs = np.maximum(mu, _impact_friction(batch, out[:, to.ONTO_LEFT] > 0, out[:, to.ONTO_RIGHT] > 0))
    solved = out[:, to.STATUS] == DONE
    return np.where(solved, needs, np.nan), np.where(solved, least, np.nan)


def _impact_friction(batch: Batch, onto_left: NDArray[np.bool_], onto_right: NDArray[np.bool_]) -> Array:
    """Largest ratio of the impulses at the impacts that there were, (n,)."""
    happened = np.column_stack([onto_left, onto_right])
    return np.asarray(np.max(np.where(happened, impulse_ratio(batch.block, batch.damping.eta), 0.0), axis=1))


UNSOLVED = "which this model has no forces for"
"""Of a body that would slide."""


def sentences_of(
    batch: Batch,
    scalars: dict[str, NDArray[Any]],
    out: Array,
    elsewhere: NDArray[np.bool_] | bool = False,
    unsolved: str = UNSOLVED,
) -> list[str]:
    """A sentence a case; what friction or the ground cannot give is withdrawn from the scalars.

    `elsewhere`: solved cases that another solver answers, of which nothing is said, (n,).
    """
    status = out[:, to.STATUS]
    reasons = [""] * batch.size
    outcome, mu = scalars["outcome"], batch.block.mu
    needs = np.fmax(scalars["mu_required"], scalars["mu_impact"])
    with np.errstate(invalid="ignore"):
        slides = needs > mu  # False where no mu is given
        lifts = scalars["N_min_over_mg"] <= 0.0
    # with a mu the question is what the body does; without, it cannot slide, and lifting is a remark
    refused = (slides | (lifts & np.isfinite(mu))) & (outcome >= NO_UPLIFT)
    withdraw(scalars, refused)
    for i in np.flatnonzero(((outcome < 0) | slides | lifts) & ~(elsewhere & (status == DONE))):
        said = []
        if status[i] != DONE:
            said.append(broke_off(status[i], out[i, to.N_STEPS], out[i, to.T_END]))
        elif outcome[i] == UNRESOLVED and not refused[i]:
            said.append(ON_SEPARATRIX)
        if slides[i]:
            words = "at an impact" if scalars["mu_impact"][i] > mu[i] else "while it rocks or before"
            said.append(f"needs mu = {needs[i]:.3g}: it would slide {words}, {unsolved}")
        if lifts[i]:
            said.append("the normal force vanishes: the body would leave the ground, which is not simulated")
        reasons[i] = "; ".join(said)
    note_unstored(batch, scalars["n_impacts"], reasons)
    return reasons


def histories_of(batch: Batch, run: Raw) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    written = np.isfinite(run.histories[:, 0]).any(axis=0)
    n_time = int(np.flatnonzero(written)[-1]) + 1 if written.any() else 1
    theta, rate = run.histories[:, 0, :n_time], run.histories[:, 1, :n_time]
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    a_g, a_v = ground_history(batch, t, np.isfinite(theta))

    block, q = batch.block, np.abs(theta)
    tops = block.tops
    top = np.where(theta > 0.0, tops[:, RIGHT, None], tops[:, LEFT, None])
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "u_top": top * np.sin(theta),
        "v_top": -top * (1.0 - np.cos(theta)),
        "M_base": _base_moment(batch, theta, q, a_g, a_v),
    }
    n_impacts = int(np.isfinite(run.impacts[:, 0]).any(axis=0).sum())
    return histories, {name: run.impacts[:, j, :n_impacts] for j, name in enumerate(IMPACTS)}, t


def _base_moment(batch: Batch, theta: Array, q: Array, a_g: Array, a_v: Array) -> Array:
    """Moment of the base opposing theta, (n, k): restoring moment while rocking, -m a_g h at rest.

    A rigid-plastic spring gives m g R sin(alpha) alone: the rest of the restoring moment is that of the weight.
    """
    model = MODELS[batch.model, batch.geometry]
    block = batch.block
    law = model.law(block.alpha, block.tan_alpha)

    def of_side(both: Array) -> Array:
        return np.where(theta > 0.0, both[:, RIGHT, None], both[:, LEFT, None])

    r0, rs, rc, R = (of_side(x) for x in (law.r0, law.rs, law.rc, block.R))
    sine, cosine = (q, 1.0) if model.linear else (np.sin(q), np.cos(q))
    shape = r0 if model.geometry == "corotational" else restoring(r0, rs, rc, sine, cosine)
    rocking = np.sign(theta) * R * (batch.g[:, None] + a_v) * shape
    moment = np.where(theta == 0.0, -a_g * block.h[:, None], rocking)
    return np.asarray(moment * block.mass_or_1[:, None])
