"""Floor and isolator response (`motion.through`): linear oscillators one on the other, the body on the last.

Each has x'' + 2 zeta omega x' + omega^2 x = -u, x its displacement relative to what it stands on, u the absolute
acceleration of that; its own absolute acceleration is u + x'' = -(2 zeta omega x' + omega^2 x).  The body does not act
back.  The chain is one linear system, advanced exactly over steps on which the ground is a polynomial (matrix
exponentials: Van Loan 1978, IEEE Trans. Autom. Control 23(3)).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from rockcli.motion.options import MAX_SAMPLES
from rockcli.motion.spectrum import Forcing, Stretch

Array = NDArray[np.float64]

BETWEEN = 1e-4
"""Largest distance of the motion from the straight line between its samples, over its peak."""

RINGS_TO = 1e-3
"""Part of its peak at which a motion that rings after the ground's is cut off."""

RINGS_PERIODS, RINGS_SECONDS = 60.0, 120.0
"""Longest periods, and seconds, after which it is cut off at the latest."""

FINEST = 256
"""Parts of a step of the ground that its samples are apart at the least."""

_TERMS = 18
"""Of the series of the matrix exponential, for norms up to 1/2."""


@dataclass(frozen=True, eq=False)
class Arrival:
    """The absolute acceleration on top, as straight lines between times i dt that have its mean over each.

    Attributes:
        values: (k,) [m/s²]; dt [s].
        between: largest distance of it from straight lines between its own values, over the peak.
        rings: time after the end of the ground motion [s].
        left: what is left at the end, over the peak.
    """

    values: Array
    dt: float
    between: float
    rings: float
    left: float


class Chain:
    """Oscillators of undamped natural periods T (m,) [s] and damping ratios zeta (m,), from the ground up."""

    def __init__(self, T: Array, zeta: Array) -> None:
        omega = 2.0 * np.pi / np.asarray(T, dtype=float)
        m = len(omega)
        self.T, self.zeta = np.asarray(T, dtype=float), np.asarray(zeta, dtype=float)
        # state: omega x and x' of every oscillator, both velocities, so that no entry is far larger than the rates
        A, B = np.zeros((2 * m, 2 * m)), np.zeros(2 * m)
        arrives = np.zeros(2 * m)  # what oscillator j stands on, beside the ground: a row of the states
        for j in range(m):
            x, v = 2 * j, 2 * j + 1
            A[x, v] = omega[j]
            A[v] -= arrives
            A[v, x] -= omega[j]
            A[v, v] -= 2.0 * self.zeta[j] * omega[j]
            if j == 0:
                B[v] = -1.0
            arrives = np.zeros(2 * m)
            arrives[x], arrives[v] = -omega[j], -2.0 * self.zeta[j] * omega[j]
        self.A, self.B, self.out = A, B, arrives

    def _steps(self, degree: int, s: Array) -> Array:
        """Of steps s (q,): what states and the derivatives of the ground at their beginning come to, (q, n, n + d)."""
        n = len(self.B)
        M = np.zeros((n + degree, n + degree))
        M[:n, :n], M[:n, n] = self.A, self.B
        for j in range(degree - 1):
            M[n + j, n + j + 1] = 1.0
        return _expm(M[None] * s[:, None, None])[:, :n]

    def run(self, motion: Forcing, t: Array) -> Array:
        """The absolute acceleration on top at ascending times t (k,) [s], (k,) [m/s²], from rest at 0; exact."""
        n = len(self.B)
        z, found = np.zeros(n), np.zeros(len(t))
        end = motion[-1].end if motion else 0.0
        last = max(float(t[-1]) - end, 0.0) if len(t) else 0.0
        h = motion[-1].h if motion else 1.0
        after = Stretch(end, h, np.zeros((int(last / h) + 2, 1)))
        for stretch in (*motion, after):
            k, d = stretch.c.shape
            derivatives = stretch.c * np.array([float(factorial(j)) for j in range(d)])
            (step,) = self._steps(d, np.array([stretch.h]))
            pushed = derivatives @ step[:, n:].T
            states = np.empty((k + 1, n))
            states[0], forward = z, step[:, :n]
            for i in range(k):
                states[i + 1] = forward @ states[i] + pushed[i]
            z = states[k]
            stop = np.inf if stretch is after else stretch.end
            inside = np.flatnonzero((t >= stretch.start) & (t < stop))
            at = (t[inside] - stretch.start) / stretch.h
            i = np.clip((at + 1e-9).astype(int), 0, k - 1)
            offsets, which = np.unique(np.round(np.maximum(at - i, 0.0), 11), return_inverse=True)
            rows = np.einsum("j,qjm->qm", self.out, self._steps(d, offsets * stretch.h))[which.ravel()]
            found[inside] = (rows[:, :n] * states[i]).sum(axis=1) + (rows[:, n:] * derivatives[i]).sum(axis=1)
        return found

    def lasts(self, motion: Forcing) -> float:
        """Time until what arrives of a motion of the ground has died away, or is cut off [s]."""
        slow = self.zeta - np.sqrt(np.maximum(self.zeta**2 - 1.0, 0.0))
        decay = float(np.min(2.0 * np.pi / self.T * slow))
        longest = min(RINGS_PERIODS * float(self.T.max()), RINGS_SECONDS)
        rings = min(longest, -np.log(0.1 * RINGS_TO) / decay) if decay > 0.0 else longest
        return (motion[-1].end if motion else 0.0) + rings

    def arrival(self, motion: Forcing, dt: float) -> Arrival:
        """The motion on top, sampled so closely that it is straight between samples to BETWEEN of its peak.

        Args:
            motion: of the ground.
            dt: longest time between samples, which is halved until that holds, or they would be more than MAX_SAMPLES.
        """
        end = motion[-1].end if motion else 0.0
        lasts = self.lasts(motion)
        parts = 1
        while True:
            h = dt / parts
            k = int(np.ceil(lasts / h)) + 1
            both = self.run(motion, 0.5 * h * np.arange(2.0 * k - 1.0))
            values, middle = both[::2], both[1::2]
            peak = float(np.abs(both).max())
            bent = float(np.abs(middle - 0.5 * (values[1:] + values[:-1])).max())
            if peak == 0.0 or bent <= BETWEEN * peak or parts >= FINEST or 2 * k > MAX_SAMPLES:
                break
            parts *= 2
        if bent <= BETWEEN * peak:  # Simpson's rule holds
            values = values + _of_the_mean(values, middle)
        loud = np.flatnonzero(np.abs(both) > RINGS_TO * peak)
        last = max(int(np.ceil(end / h)), int(loud[-1]) // 2 + 1 if len(loud) else 0, 1)
        values = values[: last + 1]
        # not followed to where it has died away: of what comes is known that it is no more than the last period
        begin = 2 * last if last < k - 1 else 2 * (k - max(int(self.T.max() / h), 1))
        tail = np.abs(both[max(begin, 0) :]).max(initial=0.0)
        over = peak or 1.0
        return Arrival(values, h, bent / over, max(last * h - end, 0.0), float(tail) / over)


def _of_the_mean(values: Array, middle: Array) -> Array:
    """What samples (k,) with `middle` (k - 1,) between them need for lines that have the mean of the curve, (k,).

    Lines between points of a curve lie on its inner side all the way, and a body that rocks sums it up; with the mean
    of every step right (Simpson's rule) what is left is of the fourth order of the step.
    """
    over = (0.5 * (values[1:] + values[:-1]) - middle) * (2.0 / 3.0)
    return -0.5 * (np.append(over, over[-1:]) + np.append(over[:1], over))


def _expm(M: Array) -> Array:
    """Exponentials of matrices (q, n, n): series of M/2^k, squared k times."""
    norm = float(np.abs(M).sum(axis=-1).max(initial=0.0))
    k = max(0, int(np.ceil(np.log2(norm / 0.5)))) if norm > 0.5 else 0
    small = M / 2.0**k
    eye = np.broadcast_to(np.eye(M.shape[-1]), M.shape)
    total = np.array(eye)
    for j in range(_TERMS, 0, -1):
        total = eye + small @ total / j
    for _ in range(k):
        total = total @ total
    return total
