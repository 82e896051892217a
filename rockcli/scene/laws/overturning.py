"""Closed forms of the overturning of the linearized block (2.3) by a pulse, in the dimensionless groups.

With tau = p t, q = |theta|/alpha on the side of the first uplift, A = a_p/(g alpha) and Omega = omega_p/p,

    q'' = q - 1 + A f(tau),   f = sin(Omega tau) for a sine;   uplift at sin(psi) = 1/A, psi = Omega tau_u.

The growing part of q - 1 is q + q' - 1; without impact it ends as an integral of f exp(-tau) over the pulse, and the
block overturns where that is positive (Housner 1963; Makris and Roussos 2000; Zhang and Makris 2001).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SCANNED = 256
"""Times of a pulse at which an impact is looked for; then it is bisected."""

_HALVINGS = 80

_HALVINGS_OF_A_PIECE = 50
"""Of the time between two of those that are looked at: to less than its last digit."""


def rectangular_without_impact(Omega: Array) -> Array:
    """A above which a rectangular pulse of half a period 2 pi/Omega overturns: 1/(1 - exp(-pi/Omega))."""
    return np.asarray(-1.0 / np.expm1(-np.pi / np.asarray(Omega, dtype=float)))


def sine_without_impact(Omega: Array, half_cycles: int = 2) -> Array:
    """A above which one or two half cycles of a sine overturn the block without impact; Omega > 0, any shape.

    The root of sqrt(A^2 - 1) - (-1)^n A exp(-(n pi - psi)/Omega) = Omega, n half cycles (B1).

    Raises:
        ValueError: more half cycles, during which an impact may come first.
    """
    if half_cycles not in (1, 2):
        raise ValueError(f"one or two half cycles, not {half_cycles}")
    Omega = np.asarray(Omega, dtype=float)
    sign = (-1.0) ** half_cycles
    low, high = np.ones_like(Omega), 2.0 + 2.0 * Omega + Omega**2  # beyond Omega^2/(2 pi) + Omega/2, the limit
    for _ in range(_HALVINGS):
        A = 0.5 * (low + high)
        rest = A * np.exp(-(half_cycles * np.pi - np.arcsin(1.0 / A)) / Omega)
        falls = np.sqrt(A**2 - 1.0) - sign * rest > Omega
        low, high = np.where(falls, low, A), np.where(falls, A, high)
    return np.asarray(0.5 * (low + high))


def sine_one_impact(A: Array, Omega: Array, eta: float) -> Array:
    """Excess over what one full sine needs to overturn the block on the other side, after one impact.

    eta |q'| - 1 - A * integral of sin(Omega tau) exp(tau_i - tau) from the impact tau_i to the end of the pulse: the
    growing part after the impact (B2).  Positive: it overturns; NaN where no impact comes (from `sine_without_impact`
    on) or nothing lifts (A <= 1).  A, Omega broadcast.
    """
    highest = sine_without_impact(Omega)
    A, Omega, highest = np.broadcast_arrays(np.asarray(A, dtype=float), np.asarray(Omega, dtype=float), highest)
    answer = np.full(A.shape, np.nan)
    impacts = (A > 1.0) & (highest > A)
    A, Omega = A[impacts], Omega[impacts]
    k = 1.0 / (1.0 + Omega**2)
    psi = np.arcsin(1.0 / A)
    length = (2.0 * np.pi - psi) / Omega  # of the pulse after uplift
    grows, decays = (0.5 * (k - 1.0 + sign * A * Omega * np.cos(psi) * k) for sign in (1.0, -1.0))

    def rotation(s: Array) -> Array:
        return np.asarray(1.0 + grows * np.exp(s) + decays * np.exp(-s) - A * k * np.sin(psi + Omega * s))

    def rate(s: Array) -> Array:
        return np.asarray(grows * np.exp(s) - decays * np.exp(-s) - A * Omega * k * np.cos(psi + Omega * s))

    with np.errstate(over="ignore", invalid="ignore"):  # long after a slow block has come down
        down = np.zeros(A.shape, dtype=int)  # the first of the times at which it is down; 0: at none
        growth, turn = np.exp(length / _SCANNED), np.exp(1j * Omega * length / _SCANNED)
        grown, decayed, phasor = grows.copy(), decays.copy(), A * k * np.exp(1j * psi)
        for j in range(1, _SCANNED + 1):
            grown *= growth
            decayed /= growth
            phasor *= turn
            down[(down == 0) & (1.0 + grown + decayed <= phasor.imag)] = j
        late = down == 0  # it comes down after the pulse, with the energy it has at its end
        low, high = length * ((down - 1) / _SCANNED), np.where(late, np.nan, length * (down / _SCANNED))
        for _ in range(_HALVINGS_OF_A_PIECE):
            s = 0.5 * (low + high)
            above = rotation(s) > 0.0
            low, high = np.where(above, s, low), np.where(above, high, s)
        at = psi + Omega * high
        left = (np.sin(at) + Omega * np.cos(at) - Omega * np.exp(high - length)) * k  # the integral
        q, v = rotation(length), rate(length)
        speed = np.sqrt(np.maximum(np.where(late, v**2 + q * (2.0 - q), rate(high) ** 2), 0.0))
        answer[impacts] = eta * speed - 1.0 - np.where(late, 0.0, A * left)
    return answer
