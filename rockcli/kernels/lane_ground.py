"""Taylor coefficients of the ground acceleration of the pulses of a vector of lanes (scene/excitation.py)."""

from __future__ import annotations

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lane_math import exp_of_negative, sin_cos_of_any
from rockcli.kernels.lane_state import C0, C1, C2, C3, C4, C5, KIND, L_BOUND, L_END, L_LAST, LANES, ORIGIN, T
from rockcli.kernels.lane_vector import load, select, some, spread, store

LINEAR, WAVES, BELL = 0.0, 1.0, 2.0


@jit_lean
def expand(state, o, n, a):
    """Coefficients about now of the vector at offset o into a; returns a bound of the rest of the integral of |a|."""
    kind = load(state, KIND * LANES + o)
    t = load(state, T * LANES + o)
    zero = spread(0.0)
    for k in range(n + 1):
        store(a, k * LANES + o, zero)
    left = load(state, L_BOUND * LANES + o) * (load(state, L_END * LANES + o) - t)
    left = select(left > 0.0, left, zero)
    if some(kind == LINEAR):
        where = kind == LINEAR
        slope = load(state, C1 * LANES + o)
        a0 = load(state, C0 * LANES + o) + slope * (t - load(state, ORIGIN * LANES + o))
        store(a, o, select(where, a0, zero))
        store(a, LANES + o, select(where, slope, zero))
    if some(kind == WAVES):
        _waves(state, o, n, a, kind == WAVES, t)
    if some(kind == BELL):
        tail = _bell(state, o, n, a, kind == BELL, t)
        last = (kind == BELL) & (load(state, L_LAST * LANES + o) == 1.0) & (tail < left)
        left = select(last, tail, left)
    return left


@jit_lean
def _waves(state, o, n, a, where, t):
    x = t - load(state, C0 * LANES + o)
    for j in range(3):
        A = load(state, (C1 + 3 * j) * LANES + o)
        A = select(where, A, 0.0)
        if some(abs(A) > 0.0):
            w = load(state, (C2 + 3 * j) * LANES + o)
            s, c = sin_cos_of_any(w * x + load(state, (C3 + 3 * j) * LANES + o))
            s, c = select(where, A * s, 0.0), select(where, A * c, 0.0)
            store(a, o, load(a, o) + s)
            for k in range(1, n + 1):
                r = w * (1.0 / k)
                s, c = c * r, -s * r
                store(a, k * LANES + o, load(a, k * LANES + o) + s)


@jit_lean
def _bell(state, o, n, a, where, t):
    """exp(-y^2/2) obeys E' = -y y' E; a = (d0 + d1 y + d2 y^2 + d3 y^3) E, y = y0 + w x.  Returns int |a| to come."""
    w = load(state, C1 * LANES + o)
    y = w * (t - load(state, C0 * LANES + o))
    w, y = select(where, w, 1.0), select(where, y, 0.0)
    d0 = select(where, load(state, C2 * LANES + o), 0.0)
    d1 = select(where, load(state, C3 * LANES + o), 0.0)
    d2 = select(where, load(state, C4 * LANES + o), 0.0)
    d3 = select(where, load(state, C5 * LANES + o), 0.0)
    e = exp_of_negative(-0.5 * y * y)
    c0 = d0 + y * (d1 + y * (d2 + y * d3))
    c1 = w * (d1 + y * (2.0 * d2 + y * (3.0 * d3)))
    c2 = w * w * (d2 + 3.0 * y * d3)
    c3 = w * w * w * d3
    # beyond y > 1: int_y^oo u^k exp(-u^2/2) du <= exp(-y^2/2) {1/y, 1, y + 1/y, y^2 + 2}
    over = 1.0 / select(y > 1.0, y, 1.0)
    tail = (abs(d0) * over + abs(d1) + abs(d2) * (y + over) + abs(d3) * (y * y + 2.0)) * (abs(e) + 4e-16) / w
    tail = select(y > 1.0, tail, 1e300)
    e1 = e2 = e3 = spread(0.0)
    wy, ww = -w * y, -w * w
    for k in range(n + 1):
        store(a, k * LANES + o, load(a, k * LANES + o) + (c0 * e + c1 * e1 + c2 * e2 + c3 * e3))
        over = 1.0 / (k + 1)
        e, e1, e2, e3 = (wy * e + ww * e1) * over, e, e1, e2
    return tail
