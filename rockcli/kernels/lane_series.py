"""The flow of a vector of lanes: Taylor coefficients of q(t) = |theta(t)| to a fixed order (docs/sweeps.md)."""

from __future__ import annotations

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lane_math import sin_cos
from rockcli.kernels.lane_state import L_FC, L_FS, L_R0, L_RC, L_RS, LANES, LAUNCH, Q, S, V
from rockcli.kernels.lane_vector import WIDTH, bits_of, from_bits, load, select, spread, store

ONE = 4607182418800017408.0
"""The bits of 1.0 read as an integer."""


@jit_lean
def flow(state, o, n, a, forced, linear, c, rate, sin_q, cos_q, drive):
    """Coefficients of q into c (of order k at [k * LANES + o]); returns sin q, 1 - cos q
    (q, q^2/2).

    rate, sin_q, cos_q, drive: work space.  `forced`: whether any lane is shaken.
    q'' = -(r0 + rs sin q + rc cos q) - s a (fc cos q + fs sin q); linear: sin q -> q, cos q -> 1.
    """
    q, v = load(state, Q * LANES + o), load(state, V * LANES + o)
    r0, rs, rc = load(state, L_R0 * LANES + o), load(state, L_RS * LANES + o), load(state, L_RC * LANES + o)
    s = load(state, S * LANES + o)
    fc, fs = s * load(state, L_FC * LANES + o), s * load(state, L_FS * LANES + o)
    launch = load(state, LAUNCH * LANES + o) > 0.0
    store(c, o, q)
    store(c, LANES + o, v)
    store(rate, WIDTH, v)
    if linear:
        sine, cosine = q, spread(1.0)
    else:
        sine, cosine = sin_cos(q)
    sin_0, cos_0 = sine, cosine
    store(sin_q, 0, sine)
    store(cos_q, 0, cosine)
    moment = r0 + rs * sine + rc * cosine
    a0 = load(a, o)
    f = fc * cosine + fs * sine
    store(drive, 0, f)
    moment = moment + a0 * f
    second = select(launch & (moment > 0.0), 0.0, -0.5 * moment)
    store(c, 2 * LANES + o, second)
    store(rate, 2 * WIDTH, 2.0 * second)
    for k in range(1, n - 1):
        if linear:
            sine, cosine = load(c, k * LANES + o), spread(0.0)
        else:
            up, down = spread(0.0), spread(0.0)
            for j in range(k, 0, -1):  # what was stored last is needed last
                r = load(rate, j * WIDTH)
                up = up + r * load(cos_q, (k - j) * WIDTH)
                down = down + r * load(sin_q, (k - j) * WIDTH)
            over = 1.0 / k
            sine, cosine = up * over, down * -over
        store(sin_q, k * WIDTH, sine)
        store(cos_q, k * WIDTH, cosine)
        moment = rs * sine + rc * cosine
        if forced:
            f = fc * cosine + fs * sine
            store(drive, k * WIDTH, f)
            pull = spread(0.0)
            for j in range(k, 0, -1):
                pull = pull + load(a, j * LANES + o) * load(drive, (k - j) * WIDTH)
            moment = moment + (pull + a0 * f)
        term = moment * (-1.0 / ((k + 1) * (k + 2)))
        store(c, (k + 2) * LANES + o, term)
        store(rate, (k + 2) * WIDTH, (k + 2) * term)
    return sin_0, (0.5 * q * q if linear else 1.0 - cos_0)


@jit_lean
def rough_power(x, e):
    """x^e of x > 0 for |e| < 1, to a few per cent: the bits of a float are nearly its logarithm."""
    return from_bits(ONE + e * (bits_of(x) - ONE))


@jit_lean
def reach_of(c, o, n, small, h):
    """Step, at most h, at which the last two terms of the series are below `small`."""
    for k in range(n - 1, n + 1):
        size = abs(load(c, k * LANES + o))
        size = select(size > 1e-280, size, 1e-280)
        step = rough_power(small / size, 1.0 / k)
        h = select(step < h, step, h)
    return h


@jit_lean
def value_and_slope(c, o, n, x):
    """The polynomial and its derivative at x."""
    P = load(c, n * LANES + o)
    dP = spread(0.0)
    for k in range(n - 1, -1, -1):
        dP = dP * x + P
        P = P * x + load(c, k * LANES + o)
    return P, dP


@jit_lean
def slope_of(c, o, n, x):
    """The derivative at x."""
    dP = n * load(c, n * LANES + o)
    for k in range(n - 1, 0, -1):
        dP = dP * x + k * load(c, k * LANES + o)
    return dP


@jit_lean
def bends_and_reach(c, o, n, h):
    """(bound of |P''|, bound of |P|) on [0, h]."""
    M, reach = spread(0.0), abs(load(c, n * LANES + o))
    for k in range(n, 1, -1):
        size = abs(load(c, k * LANES + o))
        M = M * h + (k * (k - 1)) * size
        if k < n:
            reach = reach * h + size
    reach = (reach * h + abs(load(c, LANES + o))) * h + abs(load(c, o))
    return M, reach
