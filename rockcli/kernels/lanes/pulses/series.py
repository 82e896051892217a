"""The flow of a vector of lanes: Taylor coefficients of q(t) = |theta(t)| to a fixed order (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.state import ORDER, series_of_a, series_of_q
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import bits_of, fma, from_bits, load, select, spread, store

ONE = 4607182418800017408.0
"""The bits of 1.0 read as an integer."""


@jit
def flow(state, o, forced, work):
    """Coefficients of q of the vector at o; SINE and COSINE must be of now.  work: 3 (ORDER + 1) vectors.

    q'' = -(r0 + along f + across g) - s a f,  f = fc cos q + fs sin q,  g = df/dq.
    `forced`: whether any lane is shaken.
    """
    c, a = series_of_q(o), series_of_a(o)
    rate, f, g = 0, (ORDER + 1) * WIDTH, 2 * (ORDER + 1) * WIDTH
    s = load(state, o + lane.S * WIDTH)
    fc, fs = s * load(state, o + lane.L_FC * WIDTH), s * load(state, o + lane.L_FS * WIDTH)
    along, across = s * load(state, o + lane.L_ALONG * WIDTH), s * load(state, o + lane.L_ACROSS * WIDTH)
    sine, cosine = load(state, o + lane.SINE * WIDTH), load(state, o + lane.COSINE * WIDTH)
    force, turned = fma(fs, sine, fc * cosine), fma(fs, cosine, -fc * sine)
    along = along + load(state, a)
    moment = fma(along, force, fma(across, turned, load(state, o + lane.L_R0 * WIDTH)))
    store(work, f, force)
    store(work, g, turned)
    begin(state, o, c, moment, work)
    for k in range(1, ORDER - 1, 2):  # two orders at a time: what is loaded for one serves both
        last_f, last_g = load(work, f), load(work, g)
        r = load(work, rate + (k + 1) * WIDTH)
        up, down, pull = spread(0.0), spread(0.0), spread(0.0)
        next_up, next_down, next_pull = r * last_g, r * last_f, spread(0.0)
        if forced:
            next_pull = load(state, a + (k + 1) * WIDTH) * last_f
        for j in range(k, 1, -1):  # what was stored last is needed last
            r, i = load(work, rate + j * WIDTH), (k + 1 - j) * WIDTH
            next_f, next_g = load(work, f + i), load(work, g + i)
            up, next_up = fma(r, last_g, up), fma(r, next_g, next_up)
            down, next_down = fma(r, last_f, down), fma(r, next_f, next_down)
            if forced:
                shake = load(state, a + j * WIDTH)
                pull, next_pull = fma(shake, last_f, pull), fma(shake, next_f, next_pull)
            last_f, last_g = next_f, next_g
        r, shake = load(work, rate + WIDTH), load(state, a + WIDTH)
        up, down, pull = fma(r, last_g, up), fma(r, last_f, down), fma(shake, last_f, pull)
        force, turned = up * (1.0 / k), down * (-1.0 / k)
        store(work, f + k * WIDTH, force)
        store(work, g + k * WIDTH, turned)
        add(state, c, k, fma(along, force, fma(across, turned, pull)), work)
        up, down, pull = fma(r, turned, next_up), fma(r, force, next_down), fma(shake, force, next_pull)
        force, turned = up * (1.0 / (k + 1)), down * (-1.0 / (k + 1))
        store(work, f + (k + 1) * WIDTH, force)
        store(work, g + (k + 1) * WIDTH, turned)
        add(state, c, k + 1, fma(along, force, fma(across, turned, pull)), work)


@jit
def flow_linear(state, o, forced, work):
    """`flow` with sin q -> q, cos q -> 1."""
    c, a = series_of_q(o), series_of_a(o)
    s = load(state, o + lane.S * WIDTH)
    fc, fs = s * load(state, o + lane.L_FC * WIDTH), s * load(state, o + lane.L_FS * WIDTH)
    rs, q = load(state, o + lane.L_RS * WIDTH), load(state, o + lane.Q * WIDTH)
    force = fma(fs, q, fc)
    store(work, (ORDER + 1) * WIDTH, force)
    moment = fma(rs, q, load(state, o + lane.L_R0 * WIDTH) + load(state, o + lane.L_RC * WIDTH))
    begin(state, o, c, fma(load(state, a), force, moment), work)
    for k in range(1, ORDER - 1):
        now = load(state, c + k * WIDTH)
        store(work, (ORDER + 1 + k) * WIDTH, fs * now)
        moment = rs * now
        if forced:
            for j in range(k + 1):
                moment = fma(load(state, a + j * WIDTH), load(work, (ORDER + 1 + k - j) * WIDTH), moment)
        add(state, c, k, moment, work)


@jit
def begin(state, o, c, moment, work):
    """The first three coefficients; a body about to be lifted is not pressed down by rounding."""
    v = load(state, o + lane.V * WIDTH)
    launch = load(state, o + lane.LAUNCH * WIDTH) > 0.0
    second = select(launch & (moment > 0.0), 0.0, -0.5 * moment)
    store(state, c, load(state, o + lane.Q * WIDTH))
    store(state, c + WIDTH, v)
    store(state, c + 2 * WIDTH, second)
    store(work, WIDTH, v)
    store(work, 2 * WIDTH, 2.0 * second)


@jit
def add(state, c, k, moment, work):
    """The coefficient of order k + 2 from that of the moment of order k; and of order k + 1 of the rate."""
    rate = moment * (-1.0 / (k + 1))
    store(work, (k + 2) * WIDTH, rate)
    store(state, c + (k + 2) * WIDTH, rate * (1.0 / (k + 2)))


@jit
def reach_of(state, c, small, h):
    """Step, at most h, at which the last two terms of the series at c are below `small`, to a per cent.

    The bits of a float are nearly its logarithm.
    """
    small = bits_of(small)
    for k in range(ORDER - 1, ORDER + 1):
        size = abs(load(state, c + k * WIDTH))
        size = bits_of(select(size > 1e-280, size, 1e-280))
        step = from_bits(ONE + (small - size) * (1.0 / k))
        h = select(step < h, step, h)
    return h


@jit
def value_and_slope(state, c, y):
    """Of the polynomial of the series at c, at y in the step under way."""
    P, dP = load(state, c + ORDER * WIDTH), spread(0.0)
    for k in range(ORDER - 1, -1, -1):
        dP = fma(dP, y, P)
        P = fma(P, y, load(state, c + k * WIDTH))
    return P, dP


@jit
def look_along(state, c, h):
    """(P(h), P'(h), bound of |P''|, bound of |P|) of the polynomial P at c, the bounds on [0, h]."""
    P = load(state, c + ORDER * WIDTH)
    dP, reach = spread(0.0), abs(P)
    M = (ORDER * (ORDER - 1)) * reach
    for k in range(ORDER - 1, 1, -1):
        term = load(state, c + k * WIDTH)
        size = abs(term)
        dP = fma(dP, h, P)
        P = fma(P, h, term)
        M = fma(M, h, (k * (k - 1)) * size)
        reach = fma(reach, h, size)
    for k in range(1, -1, -1):
        term = load(state, c + k * WIDTH)
        dP = fma(dP, h, P)
        P = fma(P, h, term)
        reach = fma(reach, h, abs(term))
    return P, dP, M, reach
