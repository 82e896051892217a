"""The flow: Taylor coefficients of q(t) = |theta(t)| between events (docs/theory.md)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid import parameters as at


@jit_lean
def flow(par, e, g, q, v, s, a, deg_a, a_v, deg_v, launch, linear, h, tol, n, c, sin_q, cos_q):
    """Coefficients of q about now into c; return (order, step).

    `e` is the offset of the edge in `par`, `s` the sign of theta, `a`, `a_v` the coefficients of the ground
    acceleration [m/s^2] up to deg_a, deg_v, `h` the largest step wanted.  Stops at the order where the next
    terms at h fall below tol * alpha; at order n the step is cut so that they do.  `launch`: the body leaves
    rest, so that its acceleration cannot point into the ground by rounding.
    """
    p2, r0, rs, rc, fc, fs, damper = (
        par[e + at.P2], par[e + at.R0], par[e + at.RS], par[e + at.RC], par[e + at.FC], par[e + at.FS],
        par[e + at.DAMPER],
    )  # fmt: skip
    small = tol * par[e + at.ALPHA]
    c[0], c[1] = q, v
    if linear:
        sin_q[0], cos_q[0] = q, 1.0
    else:
        sin_q[0], cos_q[0] = math.sin(q), math.cos(q)
    power = h * h
    # sines and hyperbolic sines may cancel in three coefficients running, a straight line in one
    enough = 4 if max(deg_a, deg_v) > 1 else 2
    below = 0
    for k in range(n - 1):
        if k > 0:
            if linear:
                sin_q[k], cos_q[k] = c[k], 0.0
            else:
                up = 0.0
                down = 0.0
                for j in range(1, k + 1):
                    rate = j * c[j]
                    up += rate * cos_q[k - j]
                    down += rate * sin_q[k - j]
                sin_q[k], cos_q[k] = up / k, -down / k
        moment = rs * sin_q[k] + rc * cos_q[k]
        if k == 0:
            moment += r0
        # gravity is g + a_v, and the ground drives with s a_g
        for j in range(min(k, deg_v) + 1):
            restoring = rs * sin_q[k - j] + rc * cos_q[k - j]
            if k == j:
                restoring += r0
            moment += a_v[j] / g * restoring
        for j in range(min(k, deg_a) + 1):
            moment += s * a[j] / g * (fc * cos_q[k - j] + fs * sin_q[k - j])
        c[k + 2] = -(p2 * moment + damper * (k + 1) * c[k + 1]) / ((k + 1) * (k + 2))
        if k == 0 and launch:
            c[2] = max(c[2], 0.0)
        if abs(c[k + 2]) * power <= small:
            below += 1
            if below >= enough:
                return k + 2, h
        else:
            below = 0
        power *= h
    for k in range(n - 3, n + 1):
        if abs(c[k]) > 0.0:
            h = min(h, (small / abs(c[k])) ** (1.0 / k))
    return n, h


@jit_lean
def value(c, n, x):
    """Polynomial c[0] + ... + c[n] x^n."""
    y = c[n]
    for k in range(n - 1, -1, -1):
        y = y * x + c[k]
    return y


@jit_lean
def slope(c, n, x):
    """Its derivative."""
    if n < 1:
        return 0.0
    y = n * c[n]
    for k in range(n - 1, 0, -1):
        y = y * x + k * c[k]
    return y


@jit_lean
def bend(c, n, x):
    """Its second derivative."""
    if n < 2:
        return 0.0
    y = n * (n - 1) * c[n]
    for k in range(n - 1, 1, -1):
        y = y * x + k * (k - 1) * c[k]
    return y


@jit_lean
def third(c, n, x):
    """Its third derivative."""
    if n < 3:
        return 0.0
    y = n * (n - 1) * (n - 2) * c[n]
    for k in range(n - 1, 2, -1):
        y = y * x + k * (k - 1) * (k - 2) * c[k]
    return y
