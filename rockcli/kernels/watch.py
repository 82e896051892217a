"""What is read off a step: energy, work, peaks, forces at the edge (docs/theory.md)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit
from rockcli.kernels.layout import (
    ALPHA,
    DAMPER,
    FC,
    FS,
    MU,
    N_MIN,
    P2,
    PEAK,
    PEAK_ALPHA,
    PEAK_SIDE,
    R0,
    RADIUS,
    RATE_PEAK,
    RC,
    RS,
    T_PEAK,
)
from rockcli.kernels.roots import turning_point
from rockcli.kernels.series import bend, slope, value


@jit
def energy(par, e, q, v, linear):
    """Energy about edge e over I_O p_right^2 of its side: v^2/(2 p^2) + potential, zero at q = 0."""
    r0, rs, rc = par[e + R0], par[e + RS], par[e + RC]
    if linear:
        potential = q * (r0 + 0.5 * rs * q)
    else:
        half = math.sin(0.5 * q)
        potential = r0 * q + 2.0 * rs * half * half + rc * math.sin(q)
    # edges of unequal bodies: m g R is the common unit, I_O p^2 = m g R
    return par[e + RADIUS] * (0.5 * v * v / par[e + P2] + potential)


@jit
def work_done(par, e, s, g, c, n, x, a, deg_a, a_v, deg_v, sin_q, cos_q, moment):
    """Work of the ground motion and of the damper over a step, over m g: -R * integral of their moments times q'.

    `moment` is work space.  sin_q and cos_q are known to order n - 2; the product series is cut there too.
    """
    damper = par[e + DAMPER] * g / par[e + P2]
    if deg_a == 0 and a[0] == 0.0 and deg_v == 0 and a_v[0] == 0.0 and damper == 0.0:
        return 0.0
    r0, rs, rc, fc, fs = par[e + R0], par[e + RS], par[e + RC], par[e + FC], par[e + FS]
    total = 0.0
    power = x
    for k in range(n - 1):
        driving = 0.0
        for j in range(min(k, deg_a) + 1):
            driving += a[j] * (fc * cos_q[k - j] + fs * sin_q[k - j])
        driving *= s
        for j in range(min(k, deg_v) + 1):
            driving += a_v[j] * (rs * sin_q[k - j] + rc * cos_q[k - j])
        moment[k] = driving + (a_v[k] * r0 if k <= deg_v else 0.0) + damper * (k + 1) * c[k + 1]
        power_k = 0.0
        for i in range(k + 1):
            power_k += moment[i] * (k - i + 1) * c[k - i + 1]
        total += power_k * power / (k + 1)
        power *= x
    return -total * par[e + RADIUS] / g


@jit
def raise_peak(par, e, s, c, n, x, t, parts, out):
    """Raise the peak of |theta| to the largest turning point on [0, x].

    Equal peaks of an undamped body differ by rounding: a later one must be higher by more than that.
    """
    lo, v_lo = 0.0, c[1]
    for j in range(1, parts + 1):
        hi = x * j / parts
        v_hi = slope(c, n, hi)
        if v_lo > 0.0 >= v_hi:
            y = turning_point(c, n, lo, hi)
            set_peak(par, e, s, value(c, n, y), t + y, out)
        lo, v_lo = hi, v_hi


@jit
def set_peak(par, e, s, q, t, out):
    """Note |theta| = q at t if it is the largest so far."""
    if q > out[PEAK] * (1.0 + 1e-12):
        out[PEAK], out[PEAK_SIDE], out[PEAK_ALPHA], out[T_PEAK] = q, s, par[e + ALPHA], t


@jit
def contact(par, e, s, g, c, n, y, a, deg_a, a_v, deg_v, force):
    """|T|/N and N/(m g) at y into force[0], force[1] (docs/theory.md: forces at the edge)."""
    q, v, acc = value(c, n, y), slope(c, n, y), bend(c, n, y)
    beta, R = par[e + ALPHA] - q, par[e + RADIUS]
    sin_b, cos_b = math.sin(beta), math.cos(beta)
    T = value(a, deg_a, y) + s * R * (cos_b * acc + sin_b * v * v)
    N = g + value(a_v, deg_v, y) + R * (sin_b * acc - cos_b * v * v)
    force[0] = abs(T) / N if N > 0.0 else math.inf
    force[1] = N / g


@jit
def vertex(f_0, f_1, f_2, x_1, width):
    """Where the parabola through three equidistant points about x_1 is extreme; not all three equal."""
    return x_1 + 0.5 * width * (f_0 - f_2) / (f_0 - 2.0 * f_1 + f_2)


@jit
def inflection(c, n, lo, hi, f_lo, f_hi):
    """Root of P'' in [lo, hi], where it has the values f_lo and f_hi of different sign (Illinois method)."""
    z = lo
    kept = 0
    for _ in range(30):
        last, z = z, (lo * f_hi - hi * f_lo) / (f_hi - f_lo)
        f = bend(c, n, z)
        if f == 0.0 or abs(z - last) <= 1e-9 * hi:  # the rate is flat here: its error is of second order
            break
        if (f > 0.0) == (f_hi > 0.0):
            hi, f_hi = z, f
            if kept == 1:
                f_lo *= 0.5
            kept = 1
        else:
            lo, f_lo = z, f
            if kept == -1:
                f_hi *= 0.5
            kept = -1
    return z


@jit
def watch_rocking(par, e, s, g, c, n, x, a, deg_a, a_v, deg_v, parts, force, out):
    """Largest rate, friction and smallest normal force on [0, x]."""
    mu_0 = mu_1 = 0.0
    acc_lo = 2.0 * c[2]
    width = x / parts
    for j in range(parts + 1):
        y = width * j
        out[RATE_PEAK] = max(out[RATE_PEAK], abs(slope(c, n, y)))
        acc = bend(c, n, y)
        if j > 0 and acc_lo * acc < 0.0:  # an extreme of the rate inside
            out[RATE_PEAK] = max(out[RATE_PEAK], abs(slope(c, n, inflection(c, n, y - width, y, acc_lo, acc))))
        acc_lo = acc
        contact(par, e, s, g, c, n, y, a, deg_a, a_v, deg_v, force)
        mu = force[0]
        out[MU] = max(out[MU], mu)
        out[N_MIN] = min(out[N_MIN], force[1])
        if j >= 2 and mu_1 > mu_0 and mu_1 >= mu and mu_1 < math.inf:
            z = vertex(mu_0, mu_1, mu, y - width, width)
            contact(par, e, s, g, c, n, z, a, deg_a, a_v, deg_v, force)
            out[MU] = max(out[MU], force[0])
            out[N_MIN] = min(out[N_MIN], force[1])
        mu_0, mu_1 = mu_1, mu


@jit
def watch_rest(a, deg_a, a_v, deg_v, g, x, out):
    """Friction |a_g|/(g + a_v) and normal force of a body at rest on [0, x]."""
    parts = 1 if max(deg_a, deg_v) <= 1 else 16
    width = x / parts
    mu_0 = mu_1 = 0.0
    for j in range(parts + 1):
        N = g + value(a_v, deg_v, width * j)
        out[N_MIN] = min(out[N_MIN], N / g)
        mu = abs(value(a, deg_a, width * j)) / N if N > 0.0 else math.inf
        out[MU] = max(out[MU], mu)
        if j >= 2 and mu_1 > mu_0 and mu_1 >= mu and mu_1 < math.inf:
            z = vertex(mu_0, mu_1, mu, width * (j - 1), width)
            out[MU] = max(out[MU], abs(value(a, deg_a, z)) / (g + value(a_v, deg_v, z)))
        mu_0, mu_1 = mu_1, mu
