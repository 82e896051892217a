"""The flow: Taylor coefficients of q(t) = |theta(t)| between events (docs/theory.md)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.rigid.law import driving, restoring


@jit
def flow(edge, how, small, q, v, s, a, a_v, deg, launch, h, c, sin_q, cos_q):
    """Coefficients of q about now into c; return (order, step).

    `s` is the sign of theta, `a`, `a_v` the coefficients of the ground acceleration [m/s^2] up to `deg`, `h` the
    largest step wanted.  Stops at the order where the next terms at h fall below `small`; at order n the step is
    cut so that they do.  `launch`: the body leaves rest, so that its acceleration cannot point into the ground by
    rounding.
    """
    g, linear, n = edge.g, how.linear, how.order
    c[0], c[1] = q, v
    if linear:
        sin_q[0], cos_q[0] = q, 1.0
    else:
        sin_q[0], cos_q[0] = math.sin(q), math.cos(q)
    power = h * h
    # sines and hyperbolic sines may cancel in three coefficients running, a straight line in one
    enough = 4 if max(deg.a, deg.v) > 1 else 2
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
        # terms of order k of the products in (T2): gravity is g + a_v, and the ground drives with s a_g
        moment = restoring(edge.r0 if k == 0 else 0.0, edge.rs, edge.rc, sin_q[k], cos_q[k])
        for j in range(min(k, deg.v) + 1):
            back = restoring(edge.r0 if k == j else 0.0, edge.rs, edge.rc, sin_q[k - j], cos_q[k - j])
            moment += a_v[j] / g * back
        for j in range(min(k, deg.a) + 1):
            moment += s * a[j] / g * driving(edge.fc, edge.fs, sin_q[k - j], cos_q[k - j])
        c[k + 2] = -(edge.p2 * moment + edge.damper * (k + 1) * c[k + 1]) / ((k + 1) * (k + 2))
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


@jit
def value(c, n, x):
    """Polynomial c[0] + ... + c[n] x^n."""
    y = c[n]
    for k in range(n - 1, -1, -1):
        y = y * x + c[k]
    return y


@jit
def slope(c, n, x):
    """Its derivative."""
    if n < 1:
        return 0.0
    y = n * c[n]
    for k in range(n - 1, 0, -1):
        y = y * x + k * c[k]
    return y


@jit
def bend(c, n, x):
    """Its second derivative."""
    if n < 2:
        return 0.0
    y = n * (n - 1) * c[n]
    for k in range(n - 1, 1, -1):
        y = y * x + k * (k - 1) * c[k]
    return y


@jit
def third(c, n, x):
    """Its third derivative."""
    if n < 3:
        return 0.0
    y = n * (n - 1) * (n - 2) * c[n]
    for k in range(n - 1, 2, -1):
        y = y * x + k * (k - 1) * (k - 2) * c[k]
    return y


@jit_part
def bound(c, n, x):
    """Bound of its modulus on [0, x]."""
    y = 0.0
    for k in range(n, -1, -1):
        y = y * x + abs(c[k])
    return y
