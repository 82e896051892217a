"""Taylor coefficients of the ground acceleration about a time t (scene/ground/excitation.py for the pieces)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.rigid.settings import Degrees

WIDTH = 14
"""Numbers per piece of a pulse table."""

NOTHING, SAMPLES, PULSES = 0, 1, 2
"""Kinds of channel."""

LINEAR, WAVES, BELL = 0.0, 1.0, 2.0
"""Kinds of piece."""

NEAR, FAR = 0.5, -4.0
"""Longest step of a body that moves before a bell comes, and where that is, in its y: far from it the first terms of
its series are nothing, and by Cramer's bound |He_m(y)| < 1.09 sqrt(m!) exp(y^2/4) those left out are below the
tolerance."""


@jit
def piece_end(channel, data, i):
    """End of piece i [s]; samples: of the interval between samples i and i + 1."""
    if channel.kind == SAMPLES:
        return (i + 1) * channel.dt
    return data[i * WIDTH + 1]


@jit
def bound_from(channel, data, factor, i):
    """Bound of |a| over piece i and all later ones [m/s^2]."""
    if channel.kind == NOTHING or i >= channel.pieces:
        return 0.0
    if channel.kind == SAMPLES:
        return data[channel.pieces + 1 + i] * abs(factor)
    return data[i * WIDTH + 13]


@jit
def piece_at(channel, data, i, t):
    """The piece at time t, i an earlier one; `channel.pieces` beyond the last, and of a channel that is none."""
    if channel.kind == NOTHING:
        return channel.pieces
    while i < channel.pieces and piece_end(channel, data, i) <= t:
        i += 1
    return i


@jit_part
def pieces_at(ground, ih, iv, t, t_motion, t_end):
    """Pieces of both components at t, earlier ones given, and when the first of them ends: (ih, iv, t_next).

    From t_motion on there are none, and t_next is t_end.
    """
    if t >= t_motion:
        return ground.horizontal.pieces, ground.vertical.pieces, t_end
    t_next = t_motion
    ih, iv = piece_at(ground.horizontal, ground.h_data, ih, t), piece_at(ground.vertical, ground.v_data, iv, t)
    if ih < ground.horizontal.pieces:
        t_next = min(t_next, piece_end(ground.horizontal, ground.h_data, ih))
    if iv < ground.vertical.pieces:
        t_next = min(t_next, piece_end(ground.vertical, ground.v_data, iv))
    return ih, iv, t_next


@jit
def sight(channel, data, i, t):
    """Longest step from t at which the series of piece i tells what comes [s]."""
    if channel.kind != PULSES or i >= channel.pieces or data[i * WIDTH + 2] != BELL:
        return math.inf
    w = data[i * WIDTH + 4]
    return NEAR / w if w * (t - data[i * WIDTH + 3]) < FAR else math.inf


@jit
def expand(channel, data, factor, i, t, n, out):
    """Write the Taylor coefficients about t of piece i into out[0..deg]; return deg <= n.

    Coefficients beyond deg are zero and not written.
    """
    if channel.kind == SAMPLES:
        a, b = data[i], data[i + 1]
        slope = (b - a) / channel.dt
        out[0] = (a + slope * (t - i * channel.dt)) * factor
        out[1] = slope * factor
        return 1
    row = i * WIDTH
    if data[row + 2] == LINEAR:
        out[0] = data[row + 3] + data[row + 4] * (t - data[row])
        out[1] = data[row + 4]
        return 1 if out[1] != 0.0 else 0
    if data[row + 2] == WAVES:
        return _expand_waves(data, row, t, n, out)
    return _expand_bell(data, row, t, n, out)


@jit_part
def expand_both(ground, ih, iv, t, n, a, a_v):
    """Write the Taylor coefficients about t of both components, each in its piece, into a and a_v; their degrees."""
    deg_a = deg_v = 0
    a[0] = a_v[0] = 0.0
    a[1] = a_v[1] = 0.0
    if ih < ground.horizontal.pieces:
        deg_a = expand(ground.horizontal, ground.h_data, ground.factor_h, ih, t, n, a)
    if iv < ground.vertical.pieces:
        deg_v = expand(ground.vertical, ground.v_data, ground.factor_v, iv, t, n, a_v)
    return Degrees(deg_a, deg_v)


@jit_part
def longest_step(ground, ih, iv, t):
    """Longest step from t at which the series of both components tell what comes [s]."""
    return min(sight(ground.horizontal, ground.h_data, ih, t), sight(ground.vertical, ground.v_data, iv, t))


@jit_part
def bounds_from(ground, ih, iv):
    """Bounds of |a_g| and |a_v| from these pieces on [m/s^2]."""
    horizontal = bound_from(ground.horizontal, ground.h_data, ground.factor_h, ih)
    return horizontal, bound_from(ground.vertical, ground.v_data, ground.factor_v, iv)


@jit
def _expand_waves(table, row, t, n, out):
    for k in range(n + 1):
        out[k] = 0.0
    x = t - table[row + 3]
    for j in range(3):
        A = table[row + 4 + 3 * j]
        if A != 0.0:
            w = table[row + 5 + 3 * j]
            phase = w * x + table[row + 6 + 3 * j]
            s, c = A * math.sin(phase), A * math.cos(phase)
            out[0] += s
            for k in range(1, n + 1):
                s, c = c * w / k, -s * w / k
                out[k] += s
    return n


@jit
def _expand_bell(table, row, t, n, out):
    # exp(-y^2/2) obeys E' = -y y' E; out = (d0 + d1 y + d2 y^2 + d3 y^3) E with y = y0 + w x
    w = table[row + 4]
    y = w * (t - table[row + 3])
    d0, d1, d2, d3 = table[row + 5], table[row + 6], table[row + 7], table[row + 8]
    c0 = d0 + y * (d1 + y * (d2 + y * d3))
    c1 = w * (d1 + y * (2.0 * d2 + y * 3.0 * d3))
    c2 = w * w * (d2 + 3.0 * y * d3)
    c3 = w * w * w * d3
    e, e1, e2, e3 = math.exp(-0.5 * y * y), 0.0, 0.0, 0.0
    for k in range(n + 1):
        out[k] = c0 * e + c1 * e1 + c2 * e2 + c3 * e3
        e, e1, e2, e3 = -w * (y * e + w * e1) / (k + 1), e, e1, e2
    return n
