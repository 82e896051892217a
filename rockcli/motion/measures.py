"""Measures of a ground motion, exact for acceleration that is linear between samples and starts at rest.

All take acceleration (k,) [m/s²] and dt [s].  References: Arias (1970); Trifunac and Brady (1975) for the
significant duration; EPRI (1988) for CAV; Rathje, Abrahamson and Bray (1998) for the mean period, which is one of
the samples and not of the lines between them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels

Array = NDArray[np.float64]

MEAN_PERIOD_SPACING = 0.05
"""Largest spacing of the frequencies of the mean period [Hz] (Rathje, Faraj, Russell and Bray 2004)."""

IN_BAND = 1e-12
"""Relative error of such a frequency: one that is 20 Hz up to it is in the band."""

MOST_PADDED = 1 << 22
"""Samples that a record of small steps is filled up to with zeros; beyond, its few frequencies are summed singly."""


def pga(a: Array) -> float:
    """Peak ground acceleration [m/s²] (or in the units of `a`)."""
    return float(np.abs(a).max())


def velocity(a: Array, dt: float) -> Array:
    """Ground velocity at the samples, (k,) [m/s], zero at the first."""
    return np.concatenate(([0.0], np.cumsum(0.5 * dt * (a[:-1] + a[1:]))))


def displacement(a: Array, dt: float) -> Array:
    """Ground displacement at the samples, (k,) [m], zero at the first."""
    steps = velocity(a, dt)[:-1] * dt + dt * dt / 6.0 * (2.0 * a[:-1] + a[1:])
    return np.concatenate(([0.0], np.cumsum(steps)))


def pgv(a: Array, dt: float) -> float:
    """Peak ground velocity [m/s], also between samples, where the acceleration passes zero."""
    compiled = kernels.in_use_ahead("reading.peaks")
    if compiled is not None:
        return float(compiled.peak_velocity(np.ascontiguousarray(a), dt))
    v = velocity(a, dt)
    i = np.flatnonzero(a[:-1] * a[1:] < 0.0)
    between = v[i] + 0.5 * dt * a[i] * a[i] / (a[i] - a[i + 1])
    return float(np.abs(np.concatenate((v, between))).max())


def pgd(a: Array, dt: float) -> float:
    """Peak ground displacement [m], also between samples, where the velocity passes zero.

    Of a record without baseline correction it is mostly drift.
    """
    v, d = velocity(a, dt)[:-1], displacement(a, dt)
    a0, slope = a[:-1], np.diff(a) / dt
    peaks = [d]
    root = np.sqrt(np.maximum(a0 * a0 - 2.0 * slope * v, 0.0))
    q = -(a0 + np.copysign(root, a0))
    with np.errstate(divide="ignore", invalid="ignore"):
        for s in (q / slope, 2.0 * v / q):
            inside = (s > 0.0) & (s < dt)
            peaks.append((d[:-1] + s * (v + s * (a0 / 2.0 + s * slope / 6.0)))[inside])
    return float(np.abs(np.concatenate(peaks)).max())


def arias(a: Array, dt: float, g: float = 9.81) -> float:
    """Arias intensity pi/(2 g) times the integral of a^2 [m/s]."""
    return float(np.pi / (2.0 * g) * _squares(a, dt).sum())


def cav(a: Array, dt: float) -> float:
    """Cumulative absolute velocity, the integral of |a| [m/s]."""
    left, right = np.abs(a[:-1]), np.abs(a[1:])
    total = left + right
    crossing = a[:-1] * a[1:] < 0.0
    part = np.where(crossing, (left * left + right * right) / np.where(total > 0.0, total, 1.0), total)
    return float(0.5 * dt * part.sum())


def significant_duration(a: Array, dt: float | Array) -> float:
    """Time in which the Arias intensity grows from 5 to 95 % of its final value [s]; 0 for no motion.

    `dt` may be the length of every step, (k-1,), as of a motion that is cut between two samples.
    """
    husid = np.concatenate(([0.0], np.cumsum(_squares(a, dt))))
    if husid[-1] == 0.0:
        return 0.0
    wanted = np.array([0.05, 0.95]) * husid[-1]
    i = np.clip(np.searchsorted(husid, wanted, side="right") - 1, 0, len(a) - 2)
    begins, steps = (np.append(0.0, np.cumsum(dt))[i], dt[i]) if isinstance(dt, np.ndarray) else (dt * i, dt)
    more, left, slope = wanted - husid[i], a[i], (a[i + 1] - a[i]) / steps
    # a^3 grows by 3 slope times the integral of a^2; written so that a slope of 0 divides nothing by 0
    right = np.cbrt(left**3 + 3.0 * slope * more)
    squares = right * right + right * left + left * left
    inside = np.where(more > 0.0, 3.0 * more / np.where(squares > 0.0, squares, 1.0), 0.0)
    times = begins + np.minimum(inside, steps)
    return float(times[1] - times[0])


def mean_period(a: Array, dt: float) -> float:
    """Mean period [s]: sum(C^2/f)/sum(C^2) over Fourier amplitudes C at 0.25 Hz <= f <= 20 Hz; NaN if none.

    The frequencies are at most 0.05 Hz apart, whatever the length of the record.
    """
    n = max(len(a), int(np.ceil(1.0 / (MEAN_PERIOD_SPACING * dt) * (1.0 - IN_BAND))))
    low, high = 0.25 * (1.0 - IN_BAND), 20.0 * (1.0 + IN_BAND)
    if n > max(len(a), MOST_PADDED):
        f = np.arange(np.ceil(low * n * dt), np.floor(high * n * dt) + 1.0) / (n * dt)
        found = np.array([np.exp(-2j * np.pi * one * dt * np.arange(len(a))) @ a for one in f])
    else:
        f = np.asarray(np.fft.rfftfreq(n, dt), dtype=np.float64)
        found = np.fft.rfft(a, n)
    power = np.abs(found) ** 2
    band = (f >= low) & (f <= high)
    total = power[band].sum()
    return float((power[band] / f[band]).sum() / total) if total > 0.0 else float("nan")


def measures(a: Array, dt: float, g: float = 9.81) -> dict[str, float]:
    """All measures by name: pga [m/s²], pgv [m/s], pgd [m], arias [m/s], cav [m/s], d5_95 [s], t_mean [s]."""
    return {
        "pga": pga(a),
        "pgv": pgv(a, dt),
        "pgd": pgd(a, dt),
        "arias": arias(a, dt, g),
        "cav": cav(a, dt),
        "d5_95": significant_duration(a, dt),
        "t_mean": mean_period(a, dt),
    }


def _squares(a: Array, dt: float | Array) -> Array:
    """Integral of a^2 over each interval, (k-1,)."""
    left, right = a[:-1], a[1:]
    return np.asarray(dt / 3.0 * (left * left + left * right + right * right))
