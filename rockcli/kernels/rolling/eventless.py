"""From sample to sample of a record while nothing happens: no facet near, no turning point that counts, no fall.

What `kernels.rolling.march` does step by step, for a horizontal motion alone, at a fixed order and with bounds in place
of roots: a step for which they do not exclude every event is left to it, and so is one that order 8 does not resolve.
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit


@jit
def waits(data, factor, pieces, i, low, high):
    """The first piece from i on at one of whose ends the ground's acceleration is not within low, high; or `pieces`."""
    while i < pieces:
        a = data[i] * factor
        if a < low or a > high:
            return i
        b = data[i + 1] * factor
        if b < low or b > high:
            return i
        i += 1
    return pieces


@jit
def step_over_samples(end, s, data, dt, factor, pieces, i, t, q, v, small, level, ceiling):
    """Steps to the ends of pieces i, i + 1, ... of a record; return (how many, t, q, v).

    level: turn at which the last barrier is passed, none if not between 0 and the extent; ceiling: q up to which a
    turning point counts for nothing.
    """
    p2, over_g = end.p2, 1.0 / end.g
    done = 0
    while i < pieces:
        t_next = (i + 1) * dt
        h = t_next - t
        a = data[i] * factor
        a1 = (data[i + 1] * factor - a) / dt
        a0 = (a + a1 * (t - i * dt)) * over_g * s
        a1 *= over_g * s
        y = end.alpha - q
        sine_0, cosine_0 = math.sin(y), math.cos(y)
        c2 = -p2 * (sine_0 + a0 * cosine_0) / 2.0
        s1, k1 = -v * cosine_0, v * sine_0
        c3 = -p2 * (s1 + a0 * k1 + a1 * cosine_0) / 6.0
        s2, k2 = -(v * k1 + 2.0 * c2 * cosine_0) / 2.0, (v * s1 + 2.0 * c2 * sine_0) / 2.0
        c4 = -p2 * (s2 + a0 * k2 + a1 * k1) / 12.0
        s3 = -(v * k2 + 2.0 * c2 * k1 + 3.0 * c3 * cosine_0) / 3.0
        k3 = (v * s2 + 2.0 * c2 * s1 + 3.0 * c3 * sine_0) / 3.0
        c5 = -p2 * (s3 + a0 * k3 + a1 * k2) / 20.0
        s4 = -(v * k3 + 2.0 * c2 * k2 + 3.0 * c3 * k1 + 4.0 * c4 * cosine_0) / 4.0
        k4 = (v * s3 + 2.0 * c2 * s2 + 3.0 * c3 * s1 + 4.0 * c4 * sine_0) / 4.0
        c6 = -p2 * (s4 + a0 * k4 + a1 * k3) / 30.0
        s5 = -(v * k4 + 2.0 * c2 * k3 + 3.0 * c3 * k2 + 4.0 * c4 * k1 + 5.0 * c5 * cosine_0) / 5.0
        k5 = (v * s4 + 2.0 * c2 * s3 + 3.0 * c3 * s2 + 4.0 * c4 * s1 + 5.0 * c5 * sine_0) / 5.0
        c7 = -p2 * (s5 + a0 * k5 + a1 * k4) / 42.0
        s6 = -(v * k5 + 2.0 * c2 * k4 + 3.0 * c3 * k3 + 4.0 * c4 * k2 + 5.0 * c5 * k1 + 6.0 * c6 * cosine_0) / 6.0
        k6 = (v * s5 + 2.0 * c2 * s4 + 3.0 * c3 * s3 + 4.0 * c4 * s2 + 5.0 * c5 * s1 + 6.0 * c6 * sine_0) / 6.0
        c8 = -p2 * (s6 + a0 * k6 + a1 * k5) / 56.0
        h2 = h * h
        h7 = h2 * h2 * h2 * h
        if abs(c7) * h7 > small or abs(c8) * h7 * h > small or h > 2.0 / math.sqrt(p2):
            return done, t, q, v
        # |q''| is at most `most` on the step, and q between `low` and `high`
        most = 2.0 * abs(c2) + h * (
            6.0 * abs(c3) + h * (12.0 * abs(c4) + h * (20.0 * abs(c5) + h * (30.0 * abs(c6) + h * 42.0 * abs(c7))))
        )
        most *= 1.0 + 1e-6
        bent = 0.5 * most * h2
        low, high = q + min(v * h, 0.0) - bent, q + max(v * h, 0.0) + bent
        if not (low > 0.0 and high < end.extent) or (low <= level <= high):
            return done, t, q, v
        if high > ceiling and v >= 0.0 and v - most * h <= 0.0:
            return done, t, q, v
        q += h * (v + h * (c2 + h * (c3 + h * (c4 + h * (c5 + h * (c6 + h * (c7 + h * c8)))))))
        v += h * (
            2.0 * c2 + h * (3.0 * c3 + h * (4.0 * c4 + h * (5.0 * c5 + h * (6.0 * c6 + h * (7.0 * c7 + h * 8.0 * c8)))))
        )
        t = t_next
        i += 1
        done += 1
    return done, t, q, v
