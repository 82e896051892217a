"""The ground acceleration of the pulses of a vector of lanes: its Taylor coefficients now, and what is still to come.

A bell is b times the second derivative of -exp(-y^2/2), (1 - y^2) exp(-y^2/2), or the third, (y^3 - 3 y) exp(-y^2/2),
in y = w (t - t_0) (scene/ground/excitation.py, docs/lanes.md); others are left to `march`.
"""

from __future__ import annotations

from math import exp, sqrt

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.state import ORDER, series_of_a
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import exp_of_negative, sin_cos_of_any
from rockcli.kernels.lanes.vector.plain import fma, load, select, some, spread, store
from rockcli.kernels.rigid.ground import LINEAR, WAVES

ROOT = sqrt(3.0)
AT_ONE, AT_ROOT = exp(-0.5), 2.0 * exp(-1.5)
"""|integral| of the two bells from their outer zeros, +-1 and +-sqrt 3, to infinity."""

EXP_ERROR = 4e-16
"""Error of exp(-y^2/2)."""


@jit
def expand(state, o):
    """Coefficients about now of the vector at o.  BELL_E must be of now."""
    kind, t = load(state, o + lane.KIND * WIDTH), load(state, o + lane.T * WIDTH)
    a = series_of_a(o)
    if some(kind == lane.BELL):
        _bell(state, o, a, kind == lane.BELL, t)
    else:
        zero = spread(0.0)
        for k in range(ORDER + 1):
            store(state, a + k * WIDTH, zero)
    if some(kind == LINEAR):
        where = kind == LINEAR
        slope = load(state, o + lane.C1 * WIDTH)
        a0 = load(state, o + lane.C0 * WIDTH) + slope * (t - load(state, o + lane.ORIGIN * WIDTH))
        store(state, a, load(state, a) + select(where, a0, 0.0))
        store(state, a + WIDTH, load(state, a + WIDTH) + select(where, slope, 0.0))
    if some(kind == WAVES):
        _waves(state, o, a, kind == WAVES, t)


@jit
def _waves(state, o, a, where, t):
    x = t - load(state, o + lane.C0 * WIDTH)
    for j in range(3):
        A = load(state, o + (lane.C1 + 3 * j) * WIDTH)
        A = select(where, A, 0.0)
        if some(abs(A) > 0.0):
            w = load(state, o + (lane.C2 + 3 * j) * WIDTH)
            s, c = sin_cos_of_any(w * x + load(state, o + (lane.C3 + 3 * j) * WIDTH))
            s, c = select(where, A * s, 0.0), select(where, A * c, 0.0)
            store(state, a, load(state, a) + s)
            for k in range(1, ORDER + 1):
                r = w * (1.0 / k)
                s, c = c * r, -s * r
                store(state, a + k * WIDTH, load(state, a + k * WIDTH) + s)


@jit
def _bell(state, o, a, where, t):
    """D, a derivative of order m of exp(-y^2/2), obeys D'' + y D' + (m + 1) D = 0."""
    w = load(state, o + lane.C1 * WIDTH)
    y = w * (t - load(state, o + lane.C0 * WIDTH))
    w, y = select(where, w, 0.0), select(where, y, 0.0)
    even, odd = load(state, o + lane.C2 * WIDTH), load(state, o + lane.C5 * WIDTH)
    e = select(where, load(state, o + lane.BELL_E * WIDTH), 0.0)
    z = y * y
    now = fma(even, 1.0 - z, odd * (y * (z - 3.0))) * e
    after = w * (fma(even, y * (z - 3.0), odd * fma(z, 6.0 - z, -3.0)) * e)
    store(state, a, now)
    store(state, a + WIDTH, after)
    wy, ww = w * y, w * w
    more = select(abs(odd) > 0.0, 3.0, 2.0) * ww
    for k in range(1, ORDER):
        over = -1.0 / (k + 1)
        now, after = after, fma(wy, after, fma(more, 1.0 / k, ww) * now) * over
        store(state, a + (k + 1) * WIDTH, after)


@jit
def to_come(state, o, t):
    """Bounds of the integrals of a_g > 0 and of -a_g > 0 over what is left; sets BELL_E."""
    left = load(state, o + lane.L_BOUND * WIDTH) * (load(state, o + lane.L_END * WIDTH) - t)
    left = select(left > 0.0, left, 0.0)
    plus, minus = left, left
    bell = load(state, o + lane.KIND * WIDTH) == lane.BELL
    if some(bell):
        w = load(state, o + lane.C1 * WIDTH)
        y = select(bell, w * (t - load(state, o + lane.C0 * WIDTH)), 0.0)
        e = exp_of_negative(-0.5 * y * y)
        store(state, o + lane.BELL_E * WIDTH, e)
        up, down = rest_of_bell(load(state, o + lane.C2 * WIDTH), load(state, o + lane.C5 * WIDTH), y, e)
        over = 1.0 / w
        plus, minus = select(bell, up * over, plus), select(bell, down * over, minus)
    return plus, minus


@jit
def rest_of_bell(even, odd, y, e):
    """Integrals over y of a bell's positive and negative part from y on: between zeros, of the lower derivative."""
    rest = (odd * (y * y - 1.0) - even * y) * e
    two = abs(even) > 0.0  # zeros +-1 if even, else 0 and +-sqrt 3
    first = select(y > select(two, -1.0, -ROOT), rest, AT_ONE * even + AT_ROOT * odd)
    second = select(y > select(two, 1.0, 0.0), rest, -AT_ONE * even - odd)
    third = select(y > select(two, 1.0, ROOT), rest, AT_ROOT * odd - AT_ONE * even)
    slack = EXP_ERROR * (abs(even) + abs(odd)) * (1.0 + y * y)
    up = slack + _positive(rest - first) + _positive(first - second) + _positive(second - third) + _positive(third)
    return up, up - rest + slack


@jit
def _positive(x):
    return select(x > 0.0, x, 0.0)
