"""Friction and normal force at the edge, and their extremes on a step (docs/theory.md, T9)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.roots import lowest_point
from rockcli.kernels.rigid.series import bend, slope, third, value

RATE, NORMAL, FRICTION = 0, 1, 2
"""What is watched: |q'|, N and |T|/N, in slots 0-2; slots 3-5 have the signs of the slopes of |q'|, -N and T/N."""

BRIEF = 0.01
"""(p x)² of a step x between samples of a record below which each of these has one extreme on it at most."""


@jit
def contact(edge, s, c, n, y, a, a_v, deg, force):
    """Rate, N/g and |T|/N at y, and what has the sign of slopes (RATE), into force[0:6]; per unit mass.  Returns T.

    T = a_g + s R (cos b q'' + sin b q'^2), N = g + a_v + R (sin b q'' - cos b q'^2), b = alpha - q.
    """
    q, v, acc, jerk = value(c, n, y), slope(c, n, y), bend(c, n, y), third(c, n, y)
    beta, R, g = edge.alpha - q, edge.radius, edge.g
    sin_b, cos_b = math.sin(beta), math.cos(beta)
    T = value(a, deg.a, y) + s * R * (cos_b * acc + sin_b * v * v)
    N = g + value(a_v, deg.v, y) + R * (sin_b * acc - cos_b * v * v)
    dT = slope(a, deg.a, y) + s * R * (cos_b * jerk + 3.0 * sin_b * v * acc - cos_b * v * v * v)
    dN = slope(a_v, deg.v, y) + R * (sin_b * jerk - 3.0 * cos_b * v * acc - sin_b * v * v * v)
    force[0], force[1] = abs(v), N / g
    force[2] = abs(T) / N if N > 0.0 else math.inf
    force[3], force[4] = v * acc, -dN
    force[5] = dT * N - T * dN
    return T


@jit
def note(force, out):
    """Raise the largest rate and friction, lower the smallest normal force."""
    out[to.RATE_PEAK] = max(out[to.RATE_PEAK], force[RATE])
    out[to.N_MIN] = min(out[to.N_MIN], force[NORMAL])
    out[to.MU] = max(out[to.MU], force[FRICTION])


@jit
def watch_rocking(edge, s, c, n, x, a, a_v, deg, parts, force, out):
    """Largest rate and friction and smallest normal force on [0, x].

    Each of `parts` parts is looked at at its ends, and where a derivative says that an extreme lies inside, there.  Of
    T/N that is a maximum or a minimum: |T|/N may have one, and T change its sign within the part.
    """
    T_lo = contact(edge, s, c, n, 0.0, a, a_v, deg, force)
    note(force, out)
    d0, d1, d2 = force[3], force[4], force[5]
    width = x / parts
    for j in range(1, parts + 1):
        y = width * j if j < parts else x
        T_hi = contact(edge, s, c, n, y, a, a_v, deg, force)
        note(force, out)
        e0, e1, e2 = force[3], force[4], force[5]
        for what in range(3):
            f_lo, f_hi = (d0, e0) if what == RATE else ((d1, e1) if what == NORMAL else (d2, e2))
            side = 1.0 if what < FRICTION or f_lo > 0.0 else -1.0
            if side * f_lo > 0.0 > side * f_hi and (what < FRICTION or side * T_lo > 0.0 or side * T_hi > 0.0):
                extreme(edge, s, c, n, a, a_v, deg, y - width, y, f_lo, f_hi, what, force, out)
        d0, d1, d2, T_lo = e0, e1, e2, T_hi


@jit
def note_passage(passed, edge, s, c, n, t, a, a_v, deg, parts, watched, force, out):
    """Note that a step from t on passes the equilibrium outward, and, if watched, the forces of a body that stands."""
    out[to.T_OVERTURN] = t + passed
    if watched:
        watch_rocking(edge, s, c, n, passed, a, a_v, deg, parts, force, out)
        out[to.MU_STANDING], out[to.N_STANDING] = out[to.MU], out[to.N_MIN]


@jit
def extreme(edge, s, c, n, a, a_v, deg, lo, hi, f_lo, f_hi, what, force, out):
    """Locate an extreme of `what` in [lo, hi] by its derivative (Illinois method) and note it."""
    kept, rises = 0, f_lo > 0.0
    z = lo
    for _ in range(40):
        last, z = z, (lo * f_hi - hi * f_lo) / (f_hi - f_lo)
        contact(edge, s, c, n, z, a, a_v, deg, force)
        f = force[3 + what]
        if f == 0.0 or abs(z - last) <= 1e-9 * hi:  # flat here: the error is of second order
            break
        if (f > 0.0) != rises:
            hi, f_hi = z, f
            if kept == 1:
                f_lo *= 0.5
            kept = 1
        else:
            lo, f_lo = z, f
            if kept == -1:
                f_hi *= 0.5
            kept = -1
    note(force, out)


@jit
def watch_rest(a, a_v, deg, g, x, out):
    """Friction |a_g|/(g + a_v) and normal force of a body at rest on [0, x]."""
    parts = 1 if max(deg.a, deg.v) <= 1 else 32
    width = x / parts
    before, before_v = 0.0, 0.0
    for j in range(parts + 1):
        y = width * j if j < parts else x
        A, N, rise_v = value(a, deg.a, y), g + value(a_v, deg.v, y), slope(a_v, deg.v, y)
        if before_v < 0.0 < rise_v:
            bottom = lowest_point(a_v, deg.v, y - width, y)
            out[to.N_MIN] = min(out[to.N_MIN], 1.0 + value(a_v, deg.v, bottom) / g)
        out[to.N_MIN] = min(out[to.N_MIN], N / g)
        out[to.MU] = max(out[to.MU], abs(A) / N if N > 0.0 else math.inf)
        rise = A * (slope(a, deg.a, y) * N - A * rise_v)
        if before > 0.0 > rise and N > 0.0:
            # from where a parabola turns, by Newton's method on the slope
            z = y - width * rise / (rise - before)
            for _ in range(3):
                A, N = value(a, deg.a, z), g + value(a_v, deg.v, z)
                bent = bend(a, deg.a, z) * N - A * bend(a_v, deg.v, z)
                if bent != 0.0:
                    step = (slope(a, deg.a, z) * N - A * slope(a_v, deg.v, z)) / bent
                    z = min(max(z - step, y - width), y)
            out[to.MU] = max(out[to.MU], abs(value(a, deg.a, z)) / (g + value(a_v, deg.v, z)))
        before, before_v = rise, rise_v
