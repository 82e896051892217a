"""Histories of bodies with a coefficient of friction: those that slide or fly, and the contact of the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.contact.codes import FLIGHT, ROCK, SLIDE, SLIDE_ROCK
from rockcli.kernels.formulas import driving, pull, restoring
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.contact import mode_from_rest
from rockcli.scene.laws.models import MODELS
from rockcli.solvers.common.found import IMPACTS
from rockcli.solvers.common.ground import ground_history
from rockcli.solvers.contact.run import HISTORIES, Raw

Array = NDArray[np.float64]


def histories_of(batch: Batch, raw: Raw) -> tuple[dict[str, Array], dict[str, Array]]:
    """Histories (n, k) and impacts (n, j) by name of cases that the contact kernel solved; NaN where one has ended."""
    found = {name: raw.histories[:, i] for i, name in enumerate(HISTORIES)}
    theta, mode, slide = (found[name] for name in ("theta", "contact_mode", "slide"))
    live = np.isfinite(theta)
    t = np.arange(theta.shape[1], dtype=np.float64) * np.float64(batch.save.dt_out)
    a_g, a_v = ground_history(batch, t, live)
    block, top, W = batch.block, batch.block.top[:, None], batch.g[:, None] + a_v
    mass = block.mass_or_1[:, None]
    mu = block.mu_in_motion[:, None]

    def of_side(both: Array) -> Array:
        return np.where(theta > 0.0, both[:, RIGHT, None], both[:, LEFT, None])

    friction = np.where(mode == SLIDE, -np.sign(found["slide_dot"]) * mu * W, a_g)  # on the body, per unit mass
    tilted = np.sign(theta) * of_side(block.R) * W * np.sin(of_side(block.alpha) - np.abs(theta))
    moment = np.where(np.isin(mode, (ROCK, SLIDE_ROCK)), tilted, -friction * block.h[:, None])
    found |= {
        "u_top": slide + top * np.sin(theta),
        "v_top": found["lift"] - top * (1.0 - np.cos(theta)),
        "M_base": np.where(mode == FLIGHT, 0.0, moment) * mass,
    }
    n_impacts = int(np.isfinite(raw.impacts[:, 0]).any(axis=0).sum())
    impacts = {name: raw.impacts[:, i, :n_impacts] for i, name in enumerate(IMPACTS)}
    return {name: np.where(live, values, np.nan) for name, values in found.items()}, impacts


def held_histories(batch: Batch, histories: dict[str, Array]) -> dict[str, Array]:
    """What friction adds to the histories of pure rocking: no slide, no lift, and the mode of contact, (n, k)."""
    held = np.isfinite(histories["theta"]) & np.isfinite(batch.block.mu)[:, None]
    still = np.where(held, 0.0, np.nan)
    modes = np.where(held, _modes(batch, histories), np.nan)
    return {"slide": still, "slide_dot": still, "lift": still, "contact_mode": modes}


def _modes(batch: Batch, histories: dict[str, Array]) -> Array:
    """Mode of contact of bodies that do not slide: where they would, or would fly, that mode, (n, k)."""
    model, block, g = MODELS[batch.model, batch.geometry], batch.block, batch.g[:, None]
    theta, rate = histories["theta"], histories["theta_dot"]
    t = np.arange(theta.shape[1], dtype=np.float64) * np.float64(batch.save.dt_out)
    a_g, a_v = ground_history(batch, t, np.isfinite(theta))
    law = model.law(block.alpha, block.tan_alpha)
    still = (theta == 0.0) & (rate == 0.0)
    s = np.where(theta != 0.0, np.sign(theta), np.where(rate != 0.0, np.sign(rate), -np.sign(a_g)))

    def of_side(both: Array) -> Array:
        return np.where(s > 0.0, both[:, RIGHT, None], both[:, LEFT, None])

    alpha, R, inertia, r0, rs, rc, fc, fs, rise = (
        of_side(both)
        for both in (block.alpha, block.R, block.inertia, law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold)
    )
    q, v = np.abs(theta), s * rate
    sin_q, cos_q = (q, 1.0) if model.linear else (np.sin(q), np.cos(q))
    moments = restoring(r0, rs, rc, sin_q, cos_q), driving(fc, fs, sin_q, cos_q)
    acc = -(of_side(batch.p) ** 2) * pull(1.0 + a_v / g, moments[0], s * a_g / g, moments[1])
    sin_b, cos_b = np.sin(alpha - q), np.cos(alpha - q)
    T = a_g + s * R * (cos_b * acc + sin_b * v * v)
    N = g + a_v + R * (sin_b * acc - cos_b * v * v)
    mu = block.mu[:, None]
    rocking = np.where(N <= 0.0, FLIGHT, np.where(np.abs(T) > mu * N, SLIDE_ROCK, ROCK))
    return np.where(still, mode_from_rest(rise, inertia, mu, a_g / g, a_v / g), rocking)
