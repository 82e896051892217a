"""One step of every lane: the Taylor polynomial of q over the rest of the sample, and what calls for attention.

The polynomial is in the fraction of the step gone by, c_k = q^(k) h^k / k!, so that its value at the end is a sum.
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.forces import gives_way, may_give_way, weigh
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.fused import bits, gather
from rockcli.kernels.lanes.vector.plain import fma, load, select, store

HALF_PI = 1.5707963267948966

I2, I3, I4, I5, I6, I7, I8 = (1.0 / k for k in range(2, 9))


@jit
def advance(st, i, values, slopes, watch, hold, heave):
    """Step WIDTH lanes from lane i on; what comes back is said in `settle`.

    `watch`: forces too; `hold`: lanes stop where friction may not hold; heave: None, or the vertical motion.
    """
    q, v, x, piece = load(st, lane.Q + i), load(st, lane.V + i), load(st, lane.X + i), load(st, lane.PIECE + i)
    full, cap = load(st, lane.LEN + i), load(st, lane.CAP + i)
    h = select(full - x < cap, full - x, cap)
    pitch = gather(slopes, piece)
    a = fma(pitch, x, gather(values, piece))
    a1 = pitch * h
    h2 = h * h
    s0, k0 = sin_cos(q)
    fc, fs = load(st, lane.FORCING_C + i) * h2, load(st, lane.FORCING_S + i) * h2
    if heave is None:
        X0, Y0 = fma(fs, a, load(st, lane.FREE_S + i) * h2), fma(fc, a, load(st, lane.FREE_C + i) * h2)
        X1, Y1 = fs * a1, fc * a1
    else:
        up, pitch_up, w, w1 = gravity(st, i, heave, piece, x, h)
        rs, rc = load(st, lane.FREE_S + i) * h2, load(st, lane.FREE_C + i) * h2
        X0, Y0 = fma(fs, a, rs * w), fma(fc, a, rc * w)
        X1, Y1 = fma(fs, a1, rs * w1), fma(fc, a1, rc * w1)
    # d_k = k c_k by (T3); the newest term outermost, to shorten the chain from one coefficient to the next
    d1 = v * h
    r0 = load(st, lane.FREE_0 + i) * h2
    if heave is None:
        d2 = fma(Y0, k0, fma(X0, s0, r0))
        change = Y1 * k0
    else:
        d2 = fma(Y0, k0, fma(X0, s0, r0 * w))
        change = fma(Y1, k0, r0 * w1)
    s1, k1 = d1 * k0, -d1 * s0
    d3 = I2 * fma(X0, s1, fma(Y0, k1, fma(X1, s0, change)))
    s2, k2 = I2 * fma(d2, k0, d1 * k1), -I2 * fma(d2, s0, d1 * s1)
    d4 = I3 * fma(X0, s2, fma(Y0, k2, fma(X1, s1, Y1 * k1)))
    s3, k3 = I3 * fma(d3, k0, fma(d2, k1, d1 * k2)), -I3 * fma(d3, s0, fma(d2, s1, d1 * s2))
    d5 = I4 * fma(X0, s3, fma(Y0, k3, fma(X1, s2, Y1 * k2)))
    s4 = I4 * fma(d4, k0, fma(d3, k1, fma(d2, k2, d1 * k3)))
    k4 = -I4 * fma(d4, s0, fma(d3, s1, fma(d2, s2, d1 * s3)))
    d6 = I5 * fma(X0, s4, fma(Y0, k4, fma(X1, s3, Y1 * k3)))
    s5 = I5 * fma(d5, k0, fma(d4, k1, fma(d3, k2, fma(d2, k3, d1 * k4))))
    k5 = -I5 * fma(d5, s0, fma(d4, s1, fma(d3, s2, fma(d2, s3, d1 * s4))))
    d7 = I6 * fma(X0, s5, fma(Y0, k5, fma(X1, s4, Y1 * k4)))
    s6 = I6 * fma(d6, k0, fma(d5, k1, fma(d4, k2, fma(d3, k3, fma(d2, k4, d1 * k5)))))
    k6 = -I6 * fma(d6, s0, fma(d5, s1, fma(d4, s2, fma(d3, s3, fma(d2, s4, d1 * s5)))))
    d8 = I7 * fma(X0, s6, fma(Y0, k6, fma(X1, s5, Y1 * k5)))
    weak = h < 0.0
    if watch or hold:
        s_end = s0 + (s1 + (s2 + (s3 + (s4 + (s5 + s6)))))
        k_end = k0 + (k1 + (k2 + (k3 + (k4 + (k5 + k6)))))
    if watch:
        sines = s0 + (I2 * s1 + (I3 * s2 + (I4 * s3 + (I5 * s4 + (I6 * s5 + I7 * s6)))))
        cosines = k0 + (I2 * k1 + (I3 * k2 + (I4 * k3 + (I5 * k4 + (I6 * k5 + I7 * k6)))))
        area = fma(load(st, lane.FORCING_C + i), sines, load(st, lane.FORCING_S + i) * (1.0 - cosines))
        if heave is None:
            lifted = None
        else:
            late = I4 * (I3 * d3) + (I5 * (I4 * d4) + (I6 * (I5 * d5) + (I7 * (I6 * d6) + I8 * (I7 * d7))))
            arc = q + (I2 * d1 + (I3 * (I2 * d2) + late))  # integral of q, as the sums before are of sin q and cos q
            free_0, free_s, free_c = load(st, lane.FREE_0 + i), load(st, lane.FREE_S + i), load(st, lane.FREE_C + i)
            lifted = up, pitch_up, w, w1, fma(free_0, arc, fma(free_c, sines, free_s * (1.0 - cosines)))
        both = weigh(
            st, i, q, v, s0, k0, s_end, k_end, area, a, a1, pitch, h, d1, d2, d3, d4, d5, d6, d7, d8, lifted, hold
        )
        if hold:
            weak = may_give_way(st, i, *both)
    elif hold:
        weak = gives_way(st, i, s0, k0, s_end, k_end, a, a1, h, d1, d2, d3, d4, d5, d6, d7, d8)
    return settle(st, i, q, v, x, piece, full, cap, h, weak, d1, d2, d3, d4, d5, d6, d7, d8)


@jit
def advance_linear(st, i, values, slopes, watch, heave):
    """`advance` for the linear law: sin q is q, cos q is 1; its forces without a vertical motion alone."""
    q, v, x, piece = load(st, lane.Q + i), load(st, lane.V + i), load(st, lane.X + i), load(st, lane.PIECE + i)
    full, cap = load(st, lane.LEN + i), load(st, lane.CAP + i)
    h = select(full - x < cap, full - x, cap)
    a1 = gather(slopes, piece)
    a = fma(a1, x, gather(values, piece))
    h2 = h * h
    fc, rate2 = load(st, lane.FORCING_C + i) * h2, load(st, lane.FREE_S + i) * h2
    d1 = v * h
    free = (load(st, lane.FREE_0 + i) + load(st, lane.FREE_C + i)) * h2
    if heave is None:
        d2 = fma(rate2, q, fma(fc, a, free))
        d3 = I2 * fma(rate2, d1, fc * (a1 * h))
        d4, d5 = I3 * I2 * rate2 * d2, I4 * I3 * rate2 * d3
        d6, d7 = I5 * I4 * rate2 * d4, I6 * I5 * rate2 * d5
        d8 = I7 * I6 * rate2 * d6
    else:
        _, _, w, w1 = gravity(st, i, heave, piece, x, h)
        r, r1 = rate2 * w, rate2 * w1
        d2 = fma(r, q, fma(fc, a, free * w))
        d3 = I2 * fma(r, d1, fma(r1, q, fma(fc, a1 * h, free * w1)))
        d4 = I3 * fma(r, I2 * d2, r1 * d1)
        d5 = I4 * fma(r, I3 * d3, r1 * (I2 * d2))
        d6 = I5 * fma(r, I4 * d4, r1 * (I3 * d3))
        d7 = I6 * fma(r, I5 * d5, r1 * (I4 * d4))
        d8 = I7 * fma(r, I6 * d6, r1 * (I5 * d5))
    if watch:
        c2, c3, c4, c5, c6, c7, c8 = I2 * d2, I3 * d3, I4 * d4, I5 * d5, I6 * d6, I7 * d7, I8 * d8
        s0, k0 = sin_cos(q)
        s_end, k_end = sin_cos(q + (d1 + (c2 + ((c3 + c4) + ((c5 + c6) + (c7 + c8))))))
        sines = I4 * c3 + (I5 * c4 + (I6 * c5 + (I7 * c6 + (I8 * c7 + c8 / 9.0))))
        area = load(st, lane.FORCING_C + i) * (q + (I2 * d1 + (I3 * c2 + sines)))
        weigh(st, i, q, v, s0, k0, s_end, k_end, area, a, a1 * h, a1, h, d1, d2, d3, d4, d5, d6, d7, d8, None, False)
    return settle(st, i, q, v, x, piece, full, cap, h, h < 0.0, d1, d2, d3, d4, d5, d6, d7, d8)


@jit
def gravity(st, i, heave, piece, x, h):
    """The vertical motion where WIDTH lanes start their steps, and its slope; gravity over g there, and its change."""
    pitch, share = gather(heave[1], piece), load(st, lane.HEAVE + i)
    a_v = fma(pitch, x, gather(heave[0], piece))
    return a_v, pitch, fma(share, a_v, 1.0), share * (pitch * h)


@jit
def settle(st, i, q, v, x, piece, full, cap, h, weak, d1, d2, d3, d4, d5, d6, d7, d8):
    """Move WIDTH lanes to the end of their steps: (lanes that call for attention, those of them that have moved,
    those that may touch the base and nothing else, those that turn where the peak may be, those that may touch the next
    facet and nothing else).

    A lane stays where it is if it may touch the base, passes LOOK or WALL, is `weak` as its foot may give way, or
    if its last term is too large: then its next step is half as long.  One that moved and calls all the same has come
    to the end of its samples.  What was tried is stored for every lane, as a branch that is taken often costs more than
    the stores.
    """
    c1, c2, c3, c4, c5, c6, c7, c8 = d1, I2 * d2, I3 * d3, I4 * d4, I5 * d5, I6 * d6, I7 * d7, I8 * d8
    q_end = q + (c1 + (c2 + ((c3 + c4) + ((c5 + c6) + (c7 + c8)))))
    v_end = (d1 + (d2 + ((d3 + d4) + ((d5 + d6) + (d7 + d8))))) / h
    error = abs(c8)
    bend = (abs(c2) + abs(c3)) + ((abs(c4) + abs(c5)) + (abs(c6) + (abs(c7) + error)))
    reach = abs(c1) + bend
    small, look, peak = load(st, lane.SMALL + i), load(st, lane.LOOK + i), load(st, lane.PEAK + i)
    smooth, wall = error <= small, load(st, lane.WALL + i)
    lost = ~smooth & ~(h > 1e-9 * full)
    # one that leaves rest: nothing but its first terms, upward, counts
    launch = (c1 == 0.0) & (q == 0.0) & (c2 >= 0.0) & (c3 > 0.0) & (2.0 * (abs(c2) + abs(c3)) > bend)
    base = smooth & (q <= reach) & (c1 <= bend) & ~launch
    upper = q + reach
    low = smooth & (upper < look) & (upper < wall)
    weak = smooth & weak
    higher = (v > 0.0) & (upper > peak)
    turns = higher & (v_end <= 0.0)
    near = low & base & (abs(c1) > 0.0) & ~(higher & (v_end > 0.0)) & ~weak
    touches = smooth & (upper >= wall)
    passes = smooth & (upper >= look) & (turns | (q < look) & (q_end >= look)) | touches
    # up to the next facet, and nothing else: none where LOOK says that more is to be seen to
    touches = touches & ~base & (look == math.inf) & (v > 0.0) & (v_end > 0.0) & ~weak
    place = x + h
    whole = (h == full - x) | (place >= full)
    piece_end = select(whole, piece + 1.0, piece)
    ends = piece_end >= load(st, lane.END + i)
    last = low & turns & ends & ~base
    event = base | passes | ~smooth | last | weak
    over = ends & ~event
    store(st, lane.Q + i, select(event, q, q_end))
    store(st, lane.V + i, select(event, v, v_end))
    store(st, lane.X + i, select(event, x, select(whole, 0.0 * x, place)))
    store(st, lane.PIECE + i, select(event, piece, piece_end))
    coarse = (h == cap) & (256.0 * error < small)
    store(st, lane.CAP + i, select(smooth, select(coarse, 2.0 * cap, cap), 0.5 * h))
    store(st, lane.STEPS + i, load(st, lane.STEPS + i) + 1.0)
    store(st, lane.H + i, select(event, h, -h))
    store(st, lane.COEFFICIENTS + i, c1)
    store(st, lane.COEFFICIENTS + WIDTH + i, c2)
    store(st, lane.COEFFICIENTS + 2 * WIDTH + i, c3)
    store(st, lane.COEFFICIENTS + 3 * WIDTH + i, c4)
    store(st, lane.COEFFICIENTS + 4 * WIDTH + i, c5)
    store(st, lane.COEFFICIENTS + 5 * WIDTH + i, c6)
    store(st, lane.COEFFICIENTS + 6 * WIDTH + i, c7)
    store(st, lane.COEFFICIENTS + 7 * WIDTH + i, c8)
    calls = base & ~near | passes & ~touches | lost | last | over | weak
    return bits(calls), bits(over), near, low & turns & ~last & ~weak, touches
