"""Peaks of a recorded motion, in one pass over its samples."""

from __future__ import annotations

from typing import Any

from rockcli.kernels.ahead import VECTOR
from rockcli.kernels.jit import entry


@entry(VECTOR, float, gives=float)
def peak_velocity(a: Any, dt: float) -> float:
    """Peak ground velocity [m/s] of acceleration a (k,) [m/s²], linear between samples dt [s] apart, from rest.

    Also between samples, where the acceleration passes zero; in the order of sums of `motion.measures.pgv`.
    """
    half, v, peak = 0.5 * dt, 0.0, 0.0
    for i in range(len(a) - 1):
        now, after = a[i], a[i + 1]
        if now * after < 0.0:
            peak = max(peak, abs(v + half * now * now / (now - after)))
        v += half * (now + after)
        peak = max(peak, abs(v))
    return peak
