"""The flow: Taylor coefficients of the turn q(t) about an end of a facet."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit_lean


@jit_lean
def flow(end, small, order, q, v, s, a, a_v, deg, launch, h, c, sine, cosine):
    """Coefficients of q about now into c, of the sine and cosine of alpha - q into the others; return (order, step).

    As `kernels.rigid.series.flow`; `small` is the error allowed.
    """
    n = order
    over_g = 1.0 / end.g
    c[0], c[1] = q, v
    y = end.alpha - q
    sine[0], cosine[0] = math.sin(y), math.cos(y)
    power = h * h
    enough = 4 if max(deg.a, deg.v) > 1 else 2
    below = 0
    for k in range(n - 1):
        if k > 0:
            up = 0.0
            down = 0.0
            for j in range(1, k + 1):
                rate = j * c[j]
                up += rate * cosine[k - j]
                down += rate * sine[k - j]
            sine[k], cosine[k] = -up / k, down / k
        moment = sine[k]
        drive = 0.0
        for j in range(min(k, deg.v) + 1):
            moment += a_v[j] * over_g * sine[k - j]
        for j in range(min(k, deg.a) + 1):
            drive += a[j] * cosine[k - j]
        c[k + 2] = -end.p2 * (moment + s * drive * over_g) / ((k + 1) * (k + 2))
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
def work_done(end, s, c, n, x, a, a_v, deg, sine, cosine, moment):
    """Work of the ground motion over a step, over m g; `moment` is work space."""
    if deg.a == 0 and a[0] == 0.0 and deg.v == 0 and a_v[0] == 0.0:
        return 0.0
    total = 0.0
    power = x
    for k in range(n - 1):
        drive = 0.0
        for j in range(min(k, deg.a) + 1):
            drive += a[j] * cosine[k - j]
        drive *= s
        for j in range(min(k, deg.v) + 1):
            drive += a_v[j] * sine[k - j]
        moment[k] = drive
        of_k = 0.0
        for i in range(k + 1):
            of_k += moment[i] * (k - i + 1) * c[k - i + 1]
        total += of_k * power / (k + 1)
        power *= x
    return -total * end.radius / end.g
