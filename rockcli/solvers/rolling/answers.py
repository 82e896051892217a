"""From the raw output of the kernel of rolling bodies to variables by name, and a sentence a case."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import DONE, RETURNS
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import results as also
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.body.lower_outline import Facets, rolled
from rockcli.scene.response import NO_UPLIFT
from rockcli.solvers.common.found import IMPACTS, counts, found_of
from rockcli.solvers.common.ground import ground_history
from rockcli.solvers.event.unpack import Raw, columns_asked, over, sentences_of, standing_extremes

Array = NDArray[np.float64]

UNSOLVED_ROLLING = (
    "which is not solved for a body that rolls over several vertices (block.stands: toes leaves it its two edges)"
)
"""Of a body that rolls and would slide."""


def answer(batch: Batch, facets: Facets, run: Raw) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case from the raw output."""
    out = run.out
    left, right = out[:, to.PEAK_LEFT], out[:, to.PEAK_RIGHT]
    found = found_of(out, to, _top_peak(batch, left, right))
    scalars = found.scalars(batch)
    side, alpha = out[:, to.PEAK_SIDE], batch.block.alpha
    both = [
        np.where(scalars["outcome"] < 0, np.nan, np.where(found.fell & (side == sign), np.inf, peak))
        for sign, peak in ((-1.0, left), (1.0, right))
    ]
    mu_required, N_min = standing_extremes(out, found.fell)
    unseen = found.failed | ~np.isfinite(out[:, to.N_MIN])

    def seen(values: Array) -> Array:
        return np.where(unseen, np.nan, values)

    scalars |= {
        "theta_peak_left": both[0],
        "theta_peak_right": both[1],
        "theta_peak_over_alpha": np.maximum(both[0] / alpha[:, LEFT], both[1] / alpha[:, RIGHT]),
        "theta_dot_peak": seen(found.largest(found.rate)),
        "mu_required": seen(mu_required),
        "mu_impact": found.unless_failed(out[:, also.MU_IMPACT]),
        "N_min_over_mg": seen(N_min),
        "energy_residual": seen(over(out[:, to.ENERGY], facets.barrier.min(axis=1))),
        "residual_tilt": _residual_tilt(batch, facets, out),
        "n_steps": counts(out[:, to.N_STEPS]),
        "n_rhs": counts(out[:, to.N_STEPS]),
    }
    scalars |= columns_asked(found, out, batch.save.scalars - scalars.keys())
    reasons = sentences_of(batch, scalars, out, unsolved=UNSOLVED_ROLLING)
    with np.errstate(invalid="ignore"):
        elsewhere = np.flatnonzero((np.abs(scalars["residual_tilt"]) > 0.0) & (scalars["outcome"] >= NO_UPLIFT))
    for i in elsewhere:
        tilt = scalars["residual_tilt"][i]
        said = f"comes to rest on another facet, turned by {tilt:.4g} rad ({np.rad2deg(tilt):.3g} deg)"
        reasons[i] = "; ".join(filter(None, [reasons[i], said]))
    return scalars, reasons


def _top_peak(batch: Batch, left: Array, right: Array) -> Array:
    """Largest displacement of the top by that to either side, (n,) [m]; NaN where nobody asks."""
    if "u_top_peak" not in batch.save.scalars:
        return np.full(batch.size, np.nan)
    either = np.maximum(top_of(batch, right[:, None])[0][:, 0], -top_of(batch, -left[:, None])[0][:, 0])
    return either + 0.0  # -0 of a body that does not move


def _residual_tilt(batch: Batch, facets: Facets, out: Array) -> Array:
    """theta of the facet on which a body comes to rest, (n,) [rad]; NaN where it falls, or nothing makes it rest."""
    facet = counts(out[:, also.FACET])
    tilt = np.broadcast_to(facets.tilt, (batch.size, facets.tilt.shape[1]))
    found = np.take_along_axis(tilt, np.maximum(facet, 0)[:, None], axis=1)[:, 0]
    loss = batch.damping.loss
    assert loss is not None
    rests = (out[:, to.VERDICT] == RETURNS) & (facet >= 0) & (out[:, to.STATUS] == DONE)
    return np.where(rests & ((loss > 0.0) | np.isnan(out[:, to.T_UPLIFT])), found, np.nan)


def top_of(batch: Batch, theta: Array) -> tuple[Array, Array]:
    """Displacement of the point at the height `top` above the centre of mass, along and up, (n, k) [m]."""
    vertices, h = batch.block.vertices, batch.block.h[:, None]
    assert vertices is not None
    x, z, _ = rolled(vertices, theta)
    above = batch.block.top[:, None] - h
    return x + above * np.sin(theta), z - h - above * (1.0 - np.cos(theta))


def histories_of(batch: Batch, facets: Facets, run: Raw) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    written = np.isfinite(run.histories[:, 0]).any(axis=0)
    n_time = int(np.flatnonzero(written)[-1]) + 1 if written.any() else 1
    theta, rate = run.histories[:, 0, :n_time], run.histories[:, 1, :n_time]
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    a_g, a_v = ground_history(batch, t, np.isfinite(theta))
    u_top, v_top = top_of(batch, theta)
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "u_top": u_top,
        "v_top": v_top,
        "M_base": _base_moment(batch, facets, theta, rate, a_g, a_v),
    }
    n_impacts = int(np.isfinite(run.impacts[:, 0]).any(axis=0).sum())
    return histories, {name: run.impacts[:, j, :n_impacts] for j, name in enumerate(IMPACTS)}, t


def _base_moment(batch: Batch, facets: Facets, theta: Array, rate: Array, a_g: Array, a_v: Array) -> Array:
    """Moment of the ground about the vertex in contact, towards theta = 0; about the foot of a body at rest, (n, k)."""
    vertices = batch.block.vertices
    assert vertices is not None
    _, height, vertex = rolled(vertices, theta)
    x, z = (np.take_along_axis(vertices[:, :, i], vertex, axis=1) for i in (0, 1))
    arm = x * np.cos(theta) + z * np.sin(theta)  # of the weight, to the right
    resting = (rate == 0.0) & (theta[:, :, None] == facets.tilt[:, None, :]).any(axis=2)
    moment = np.where(resting, -a_g * height, (batch.g[:, None] + a_v) * arm)
    return np.asarray(moment * batch.block.mass_or_1[:, None])
