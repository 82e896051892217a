"""Peak acceleration and velocity of the motion a batch uses."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.pulse_extremes import extremes, extremes_of_both_signs
from rockcli.motion.measures import velocity
from rockcli.scene.ground.excitation import (
    AMPLITUDE_COLUMNS,
    BELL,
    LINEAR,
    PIECE_WIDTH,
    WAVES,
    Channel,
    Pulses,
    Samples,
)

Array = NDArray[np.float64]

_RATES = {LINEAR: (4,), WAVES: (5, 8, 11), BELL: (4,)}
"""Columns that are proportional to its frequency."""

_TIMES = {LINEAR: (), WAVES: (3,), BELL: (3,)}
"""Columns that are times, beside those of the beginning and the end."""

FEW = 4
"""Kinds of pulses that are found without sorting all."""


def peaks(channel: Channel | None, n: int, duration: Array | None = None) -> tuple[Array, Array]:
    """Peak ground acceleration [m/s²] and velocity [m/s] of each of n cases; NaN without a motion.

    `duration` (n,) [s] cuts the motion off, NaN where it does not.
    """
    if channel is None:
        return np.full(n, np.nan), np.full(n, np.nan)
    until = np.full(n, np.inf) if duration is None else np.where(np.isnan(duration), np.inf, duration)
    with np.errstate(all="ignore"):
        return _of_samples(channel, until) if isinstance(channel, Samples) else _of_pulses(channel, until)


def peaks_of_both_signs(channel: Channel, n: int, duration: Array) -> Array:
    """Largest ground acceleration of each of n cases, and the largest of the motion turned round, (n, 2) [m/s²].

    `duration` (n,) [s] as in `peaks`.
    """
    until = np.where(np.isnan(duration), np.inf, duration)
    if not isinstance(channel, Samples):
        return extremes_of_both_signs(channel.table, until)
    factor = np.broadcast_to(channel.factor, (n,))
    up, down = (_highest(sign * channel.values, channel.dt, np.minimum(until, channel.end)) for sign in (1.0, -1.0))
    turned = factor < 0.0
    return np.asarray(
        np.abs(factor)[:, None] * np.column_stack([np.where(turned, down, up), np.where(turned, up, down)])
    )


def _highest(a: Array, dt: float, until: Array) -> Array:
    """Largest of a motion that is linear between samples, up to a time; not below 0."""
    i = np.clip(np.floor(until / dt).astype(int), 0, len(a) - 2)
    last = a[i] + (a[i + 1] - a[i]) * (until - i * dt) / dt
    return np.asarray(np.maximum(np.maximum(np.maximum.accumulate(a)[i], last), 0.0))


def _of_samples(samples: Samples, until: Array) -> tuple[Array, Array]:
    """Those of the whole record, or up to a time between two samples."""
    factor = np.abs(np.broadcast_to(samples.factor, until.shape))
    pga = np.full(len(until), samples.measures.get("pga", np.nan))
    pgv = np.full(len(until), samples.measures.get("pgv", np.nan))
    cut = until < samples.end * (1.0 - 1e-12)
    if cut.any():
        pga[cut], pgv[cut] = _until(samples.values, samples.dt, until[cut])
    return factor * pga, factor * pgv


def _until(a: Array, dt: float, until: Array) -> tuple[Array, Array]:
    v = velocity(a, dt)
    reached = np.abs(v)
    between = _at_zero(v[:-1], a[:-1], a[1:], dt)
    reached[1:] = np.maximum(reached[1:], between)
    i = np.clip(np.floor(until / dt).astype(int), 0, len(a) - 2)
    rest = until - i * dt
    last = a[i] + (a[i + 1] - a[i]) * rest / dt
    pga = np.maximum(np.maximum.accumulate(np.abs(a))[i], np.abs(last))
    end = np.abs(v[i] + 0.5 * rest * (a[i] + last))
    pgv = np.maximum.reduce([np.maximum.accumulate(reached)[i], end, _at_zero(v[i], a[i], last, rest)])
    return pga, pgv


def _at_zero(v: Array, left: Array, right: Array, dt: Array | float) -> Array:
    """|velocity| where a straight line of acceleration passes zero; 0 where it does not."""
    passes = left * right < 0.0
    return np.where(passes, np.abs(v + 0.5 * dt * left * left / np.where(passes, left - right, 1.0)), 0.0)


def _of_pulses(pulses: Pulses, until: Array) -> tuple[Array, Array]:
    """Measure each distinct pulse of unit amplitude and frequency once: mostly there is one."""
    n = len(pulses.a_p)
    a_p = np.where(pulses.a_p > 0.0, pulses.a_p, 1.0)
    table = pulses.table.copy()
    table[:, :, PIECE_WIDTH - 1] = 0.0
    kinds = pulses.table[:, :, 2]
    for columns, scale in ((AMPLITUDE_COLUMNS, 1.0 / a_p), (_RATES, 1.0 / pulses.omega_p), (_TIMES, pulses.omega_p)):
        for kind, of_kind in columns.items():
            for column in of_kind:
                table[:, :, column] *= np.where(kinds == kind, scale[:, None], 1.0)
    table[:, :, :2] *= pulses.omega_p[:, None, None]
    until = np.minimum(until * pulses.omega_p, table[:, -1, 1])
    # what is measured is the rounded pulse itself, so that it does not depend on the cases it stands among
    keys = np.asarray(np.round(np.column_stack([table.reshape(n, -1), until]), 12), dtype=np.float64)
    distinct, inverse = _distinct(keys)
    if len(distinct) == 1:  # as at every point of a search
        pga, pgv = _of_one(distinct.tobytes(), table.shape[1])
    else:
        pga, pgv = _of_distinct(distinct, table.shape[1])
    return pga[inverse] * a_p, pgv[inverse] * a_p / pulses.omega_p


def _distinct(rows: Array) -> tuple[Array, NDArray[np.int64]]:
    """Distinct rows (k, m), and which of them each of all rows (n, m) is, (n,).

    To sort rows takes longer than to solve the pulses; the first few kinds are found by comparison with one of each.
    """
    kinds: list[Array] = []
    which, left = np.zeros(len(rows), dtype=np.int64), np.arange(len(rows))
    while len(left) and len(kinds) < FEW:
        alike = (rows[left] == rows[left[0]]).all(axis=1)
        which[left[alike]] = len(kinds)
        kinds.append(rows[left[:1]])
        left = left[~alike]
    if len(left):
        others, of = np.unique(rows[left], axis=0, return_inverse=True)
        which[left] = len(kinds) + of.reshape(-1)
        kinds.append(others)
    return np.concatenate(kinds), which


def _of_distinct(keys: Array, pieces: int) -> tuple[Array, Array]:
    """Extremes of pulses (k, pieces x PIECE_WIDTH + 1) of unit amplitude and frequency; last, what cuts each off."""
    return extremes(keys[:, :-1].reshape(len(keys), pieces, -1), np.ascontiguousarray(keys[:, -1]))


@lru_cache(maxsize=256)
def _of_one(key: bytes, pieces: int) -> tuple[Array, Array]:
    return _of_distinct(np.frombuffer(key)[None, :], pieces)
