"""A rocking block under cycles of a sine or a cosine, in 64 bits of mantissa: a Taylor series written apart from the solver.

In theta' = w from (2.2), the angle from the edge to the vertical, phi = alpha - |theta|, and the phase of the ground; order 24,
impacts by Newton's method on the polynomial, uplift from the arcsine, rest at impacts of 1e-15 p alpha.
"""

from __future__ import annotations

import numpy as np

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Pulses

L = np.longdouble
ORDER, TOLERANCE, REST = 24, L(1e-20), L(1e-15)
PI = L(4) * np.arctan(L(1))


def takes(batch: Batch) -> bool:
    """Whether it can solve a batch."""
    motion = batch.excitation.horizontal
    cycles = isinstance(motion, Pulses) and motion.shape in ("sine", "cosine") and batch.excitation.vertical is None
    return bool(cycles and batch.block.symmetric.all() and batch.model == "rigid" and (batch.theta_0 == 0.0).all())


def solve(batch: Batch, i: int) -> tuple[bool, float]:
    """Whether case i overturns, and its largest |theta|/alpha."""
    motion = batch.excitation.horizontal
    assert isinstance(motion, Pulses)
    row = motion.table[i, -1]
    alpha, eta, g = L(batch.block.alpha[i, 0]), L(batch.damping.eta[i, 0]), L(batch.g[i])
    p2, end = L(batch.p[i, 0]) ** 2, L(row[1])
    A, w, phase = L(row[4]) / g, L(row[5]), L(row[6])
    phase = PI / 2 if phase > 1.0 else phase
    threshold = np.tan(alpha)
    t, q, v, s, peak = L(row[0]), L(0), L(0), 0, L(0)
    while t < end:
        if s == 0:
            t, s = uplift(t, A, w, phase, threshold)
            q = v = L(0)
            if t >= end:
                return False, float(peak / alpha)
        h = min(end - t, 2 / w, 1 / np.sqrt(p2))
        c = series(q, v, alpha, p2, s * A, w, w * t + phase)
        for k in range(ORDER - 3, ORDER + 1):
            if c[k] != 0.0:
                h = min(h, (TOLERANCE * alpha / abs(c[k])) ** (L(1) / k))
        x, hit = impact(c, h)
        peak = max(peak, largest(c, x))
        t, q, v = (end if x == end - t else t + x), polynomial(c, x), slope(c, x)
        if q > PI / 2:
            return True, np.inf
        if hit:
            q, v, s = L(0), -eta * v, -s
            pressed = abs(A * np.sin(w * t + phase)) < threshold
            if v < REST * np.sqrt(p2) * alpha and pressed:
                s = 0
    if s == 0:
        return False, float(peak / alpha)
    # free rocking: the energy against that of the unstable equilibrium, now and after the impact to come
    top = 2 * p2 * (1 - np.cos(alpha - q))
    if q > alpha and v > -np.sqrt(top):
        return True, np.inf
    before = v * v + 2 * p2 * (np.cos(alpha - q) - np.cos(alpha))
    rate2 = before if v > 0.0 else eta**2 * before
    height = np.cos(alpha) + rate2 / (2 * p2)
    if height > 1.0:
        return True, np.inf
    return False, float(max(peak, alpha - np.arccos(height)) / alpha)


def series(q, v, alpha, p2, A, w, phase) -> np.ndarray:
    """Coefficients of |theta|: q'' = -p^2 [sin(alpha - q) + A sin(w t + phase) cos(alpha - q)], A with the sign of theta."""
    c, S, C, G = (np.zeros(ORDER + 1, dtype=L) for _ in range(4))
    c[0], c[1] = q, v
    S[0], C[0] = np.sin(alpha - q), np.cos(alpha - q)
    sines = (np.sin(phase), np.cos(phase), -np.sin(phase), -np.cos(phase))
    factor = A
    for k in range(ORDER + 1):
        G[k] = factor * sines[k % 4]
        factor = factor * w / (k + 1)
    for k in range(ORDER - 1):
        if k:
            rates = c[1 : k + 1] * np.arange(1, k + 1)
            S[k], C[k] = -np.dot(rates, C[k - 1 :: -1][:k]) / k, np.dot(rates, S[k - 1 :: -1][:k]) / k
        c[k + 2] = -p2 * (S[k] + np.dot(G[: k + 1], C[k::-1][: k + 1])) / ((k + 1) * (k + 2))
    return c


def polynomial(c, x):
    """Value at x."""
    y = L(0)
    for one in c[::-1]:
        y = y * x + one
    return y


def slope(c, x):
    """Derivative at x."""
    return polynomial(c[1:] * np.arange(1, ORDER + 1), x)


def impact(c, h):
    """First time in (0, h] at which |theta| is back at 0, and whether there is one; else h."""
    grid = h * np.arange(1, 65, dtype=L) / 64
    below = np.flatnonzero(np.array([polynomial(c, x) for x in grid]) <= 0.0)
    if not len(below):
        return h, False
    low, high = (grid[below[0] - 1] if below[0] else h * L(1e-9)), grid[below[0]]
    if polynomial(c, low) <= 0.0:
        low = L(0)
    for _ in range(70):
        middle = (low + high) / 2
        if polynomial(c, middle) > 0.0 or middle == 0.0:
            low = middle
        else:
            high = middle
    return high, True


def largest(c, x):
    """Largest value at a turning point in (0, x]."""
    low, high = L(0), x
    if slope(c, low + x * L(1e-12)) <= 0.0 or slope(c, high) > 0.0:
        return L(0)
    for _ in range(70):
        middle = (low + high) / 2
        low, high = (middle, high) if slope(c, middle) > 0.0 else (low, middle)
    return polynomial(c, low)


def uplift(t, A, w, phase, threshold):
    """Next time from t on at which |a_g| exceeds what uplifts, and the sign of theta."""
    ratio = threshold / abs(A)
    if ratio >= 1.0:
        return L(np.inf), 1
    angle, x = np.arcsin(ratio), w * t + phase
    if abs(np.sin(x)) > ratio:
        return t, (-1 if A * np.sin(x) > 0.0 else 1)
    n = np.floor((x - angle) / PI) + 1
    x = n * PI + angle
    t = max(t, (x - phase) / w)
    return t, (-1 if A * np.sin(x) > 0.0 else 1)
