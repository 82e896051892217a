"""From a batch to the parameter vectors of the kernels (`kernels.rigid.parameters`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.damping import dashpot_rate
from rockcli.scene.models import MODELS, Law
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.ground import factors_of

Array = NDArray[np.float64]

BLOCK = 2048
"""Rows written at a time."""


def parameters_of(batch: Batch) -> Array:
    """One row per case in the layout of `kernels.rigid.parameters`."""
    model = MODELS[batch.model, batch.geometry]
    block, p = batch.block, batch.p
    law = model.law(block.alpha, block.tan_alpha)
    edges = (
        p**2, block.alpha, law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold, law.q_star,
        _slope(law, model.linear), batch.damping.eta, _damper(batch), block.R,
    )  # fmt: skip
    lasts = durations_of(batch)
    columns = (
        batch.g, *(x[:, LEFT] for x in edges), *(x[:, RIGHT] for x in edges), batch.theta_0, batch.theta_dot_0,
        lasts.motion, lasts.report, lasts.given,
        factors_of(batch.excitation.suite or batch.excitation.horizontal, batch.size),
        factors_of(batch.excitation.vertical, batch.size),
    )  # fmt: skip
    rows = np.empty((batch.size, len(columns)))
    for begin in range(0, batch.size, BLOCK):  # column by column in rows that stay in the cache
        part = rows[begin : begin + BLOCK]
        for column, values in enumerate(columns):
            part[:, column] = values[begin : begin + BLOCK]
    return rows


def _damper(batch: Batch) -> Array:
    """c / I_O of the base damper about each edge, (n, 2) [1/s]."""
    block, coefficient = batch.block, batch.damping.coefficient
    if coefficient is None:
        return np.zeros_like(block.alpha)
    return dashpot_rate(coefficient[:, None], block.alpha, block.R, block.inertia, batch.g[:, None])


def _slope(law: Law, linear: bool) -> Array:
    """|d(restoring law)/dq| at q_star, where the law vanishes."""
    if linear:
        return -law.rs
    q = np.where(np.isfinite(law.q_star), law.q_star, 0.0)
    return np.asarray(law.rc * np.sin(q) - law.rs * np.cos(q))
