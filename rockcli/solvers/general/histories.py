"""From the diaries of a batch to its histories and impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.block import LEFT, RIGHT
from rockcli.scene.excitation import acceleration
from rockcli.scene.models import MODELS
from rockcli.solvers.general.diary import Diary

Array = NDArray[np.float64]


def histories_of(batch: Batch, diaries: list[Diary]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories by name (n, k), impacts by name (n, j), and the output times (k,) [s]; NaN-padded."""
    n_time = max(max(d.written for d in diaries), 1)
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    theta, rate = np.full((2, batch.size, n_time), np.nan)
    a_g, a_v = np.zeros((2, batch.size, n_time))
    for i, diary in enumerate(diaries):
        theta[i, : diary.written] = diary.theta[: diary.written]
        rate[i, : diary.written] = diary.rate[: diary.written]
        for a, channel in ((a_g, batch.excitation.horizontal), (a_v, batch.excitation.vertical)):
            a[i] = acceleration(channel, t, i)
            a[i, t > batch.excitation.duration[i]] = 0.0
    live = np.isfinite(theta)
    a_g, a_v = (np.where(live, a, np.nan) for a in (a_g, a_v))
    top = batch.block.top[:, None]
    histories = {
        "theta": theta,
        "theta_dot": rate,
        "a_g": a_g,
        "a_v": a_v,
        "u_top": top * np.sin(theta),
        "v_top": -top * (1.0 - np.cos(theta)),
        "M_base": _base_moment(batch, theta, a_g, a_v),
    }
    return histories, _impacts(diaries), t


def _impacts(diaries: list[Diary]) -> dict[str, Array]:
    table = np.full((3, len(diaries), max(len(d.impacts) for d in diaries)), np.nan)
    for i, diary in enumerate(diaries):
        if diary.impacts:
            table[:, i, : len(diary.impacts)] = np.array(diary.impacts).T
    return {"t_impact": table[0], "theta_dot_before": table[1], "theta_dot_after": table[2]}


def _base_moment(batch: Batch, theta: Array, a_g: Array, a_v: Array) -> Array:
    """Moment of the base opposing theta: the restoring moment while rocking, -m a_g h at rest, (n, k)."""
    model = MODELS[batch.model, batch.geometry]
    block = batch.block
    law = model.law(block.alpha, block.tan_alpha)
    r0, rs, rc, R = (
        np.where(theta > 0.0, both[:, RIGHT, None], both[:, LEFT, None])
        for both in (law.r0, law.rs, law.rc, block.R)
    )  # fmt: skip
    q = np.abs(theta)
    shape = r0 + rs * q if model.linear else r0 + rs * np.sin(q) + rc * np.cos(q)
    rocking = np.sign(theta) * R * (batch.g[:, None] + a_v) * shape
    mass = np.where(np.isfinite(block.mass), block.mass, 1.0)
    return np.asarray(np.where(theta == 0.0, -a_g * block.h[:, None], rocking) * mass[:, None])
