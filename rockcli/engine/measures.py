"""Peak acceleration and velocity of the motion a batch uses."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.excitation import BELL, LINEAR, PIECE_WIDTH, WAVES, Channel, Pulses, Samples, acceleration

Array = NDArray[np.float64]

_AMPLITUDES = {LINEAR: (3, 4), WAVES: (4, 7, 10), BELL: (5, 6, 7, 8)}
"""Columns of a piece that are proportional to the amplitude of the pulse."""

_POINTS = 4096
"""Intervals per piece over which a pulse is sampled."""


def peaks(channel: Channel | None, n: int) -> tuple[Array, Array]:
    """Peak ground acceleration [m/s^2] and velocity [m/s] of each of n cases; NaN without a motion."""
    if channel is None:
        return np.full(n, np.nan), np.full(n, np.nan)
    if isinstance(channel, Samples):
        factor = np.abs(np.broadcast_to(channel.factor, (n,)))
        return factor * channel.measures.get("pga", np.nan), factor * channel.measures.get("pgv", np.nan)
    return _pulse_peaks(channel)


def _pulse_peaks(pulses: Pulses) -> tuple[Array, Array]:
    """Sample each distinct pulse of unit amplitude once: a map of n x m pulses has only m of them."""
    n = len(pulses.a_p)
    scale = np.where(pulses.a_p > 0.0, pulses.a_p, 1.0)
    table = pulses.table.copy()
    table[:, :, PIECE_WIDTH - 1] = 0.0
    for kind, columns in _AMPLITUDES.items():
        for column in columns:
            values = table[:, :, column]
            table[:, :, column] = np.where(table[:, :, 2] == kind, values / scale[:, None], values)
    keys = np.round(table.reshape(n, -1), 12)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    measured = np.array([_sampled(pulses, int(case)) for case in first]) / scale[first, None]
    unit = measured[inverse.reshape(-1)]
    return unit[:, 0] * scale, unit[:, 1] * scale


def _sampled(pulses: Pulses, case: int) -> tuple[float, float]:
    edges = pulses.table[case][:, :2]
    pga = velocity = pgv = 0.0
    for t_a, t_b in edges:
        if t_b <= t_a:
            continue
        t = np.linspace(t_a, t_b, _POINTS + 1)
        t[-1] = np.nextafter(t_b, t_a)  # a pulse is zero from the end of its last piece on
        a = acceleration(pulses, t, case)
        steps = 0.5 * (a[1:] + a[:-1]) * np.diff(t)
        path = velocity + np.concatenate([[0.0], np.cumsum(steps)])
        pga, pgv, velocity = max(pga, float(np.max(np.abs(a)))), max(pgv, float(np.max(np.abs(path)))), float(path[-1])
    return pga, pgv
