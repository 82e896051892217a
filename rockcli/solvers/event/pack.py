"""From a batch to the parameter vectors of the kernels (`kernels.rigid.parameters`), and to their settings."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.scene.laws.models import MODELS
from rockcli.scene.numerics import Accuracy
from rockcli.scene.repeated import is_repeated, once, repeated
from rockcli.solvers.common.duration import durations_of
from rockcli.solvers.common.ground import factors_of

Array = NDArray[np.float64]

MAX_STEPS = {True: 20_000_000, False: 30_000}
"""Steps a case may take, compiled or not; a case that needs more uncompiled is solved again compiled."""

BLOCK = 2048
"""Rows written at a time."""


def parameters_of(batch: Batch) -> Array:
    """One row per case in the layout of `kernels.rigid.parameters`."""
    model = MODELS[batch.model, batch.geometry]
    block, shape = batch.block, batch.p.shape
    alpha, tan_alpha = _once(block.alpha, block.tan_alpha)
    law = model.law(alpha, tan_alpha)
    of_law = (law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold, law.q_star, model.slope(law))
    apart = (
        _once(each)[0] for each in (once(np.square, batch.p), block.alpha, batch.damping.eta, _damper(batch), block.R)
    )
    p2, alpha, eta, damper, R = apart
    edges = [np.broadcast_to(each, shape) for each in (p2, alpha, *of_law, eta, damper, R)]
    lasts = durations_of(batch)
    columns = (
        batch.g, *(x[:, LEFT] for x in edges), *(x[:, RIGHT] for x in edges), batch.theta_0, batch.theta_dot_0,
        lasts.motion, lasts.report, lasts.given,
        factors_of(batch.excitation.suite or batch.excitation.horizontal, batch.size),
        factors_of(batch.excitation.vertical, batch.size),
    )  # fmt: skip
    first = np.array([values[0] for values in columns])
    several = [(column, values) for column, values in enumerate(columns) if values.strides != (0,)]
    rows = np.empty((batch.size, len(columns)))
    for begin in range(0, batch.size, BLOCK):  # column by column in rows that stay in the cache
        part = rows[begin : begin + BLOCK]
        part[:] = first
        for column, values in several:
            part[:, column] = values[begin : begin + BLOCK]
    return rows


def _once(*values: Array) -> tuple[Array, ...]:
    """Values (n, 2), or the first row of each where all rows of all are alike, (1, 2)."""
    if all(map(is_repeated, values)):
        return tuple(each[:1] for each in values)
    flat = [each.reshape(-1) for each in values]  # numpy is slow over an axis of two
    alike = all(bool((each[2:] == each[:-2]).all()) for each in flat)
    return tuple(each[:1] for each in values) if alike else values


def settings_of(kernel: ModuleType, batch: Batch, level: Accuracy, detail: int) -> Any:
    """`Settings` of a kernel module."""
    return kernel.Settings(
        linear=MODELS[batch.model, batch.geometry].linear,
        tol=level.rtol,
        rest_speed=level.rest_speed,
        margin=max(2e-14, 10.0 * level.rtol),
        max_steps=MAX_STEPS[bool(kernels.compiled)],
        order=order_of(level.rtol),
        detail=detail,
    )


def order_of(rtol: float) -> int:
    """Order of the Taylor series: about where the cost of a step of given error per unit of time is least."""
    return int(np.clip(round(2.0 - 1.75 * np.log10(rtol)), 8, 30))


def _damper(batch: Batch) -> Array:
    """c / I_O of the base damper about each edge, (n, 2) [1/s]."""
    block, coefficient = batch.block, batch.damping.coefficient
    if coefficient is None:
        return repeated(np.zeros((1, 2)), batch.size)
    return dashpot_rate(coefficient[:, None], block.alpha, block.R, block.inertia, batch.g[:, None])
