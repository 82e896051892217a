"""What is read off a step: energy, work, peaks, forces at the edge (docs/theory.md)."""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.roots import turning_point
from rockcli.kernels.rigid.series import bend, slope, value


@jit_lean
def energy(par, e, q, v, linear):
    """Energy about edge e over I_O p_right^2 of its side: v^2/(2 p^2) + potential, zero at q = 0."""
    r0, rs, rc = par[e + at.R0], par[e + at.RS], par[e + at.RC]
    if linear:
        potential = q * (r0 + 0.5 * rs * q)
    else:
        half = math.sin(0.5 * q)
        potential = r0 * q + 2.0 * rs * half * half + rc * math.sin(q)
    # edges of unequal bodies: m g R is the common unit, I_O p^2 = m g R
    return par[e + at.RADIUS] * (0.5 * v * v / par[e + at.P2] + potential)


@jit_lean
def work_done(par, e, s, g, c, n, x, a, deg_a, a_v, deg_v, sin_q, cos_q, moment):
    """Work of the ground motion and of the damper over a step, over m g: -R * integral of their moments times q'.

    `moment` is work space.  sin_q and cos_q are known to order n - 2; the product series is cut there too.
    """
    damper = par[e + at.DAMPER] * g / par[e + at.P2]
    if deg_a == 0 and a[0] == 0.0 and deg_v == 0 and a_v[0] == 0.0 and damper == 0.0:
        return 0.0
    r0, rs, rc, fc, fs = par[e + at.R0], par[e + at.RS], par[e + at.RC], par[e + at.FC], par[e + at.FS]
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
    return -total * par[e + at.RADIUS] / g


@jit_lean
def raise_peak(par, e, s, c, n, x, t, parts, out):
    """Raise the peak of |theta| to the largest turning point on [0, x].

    Equal peaks of an undamped body differ by rounding: a later one must be higher by more than that.
    """
    lo, v_lo, b_lo = 0.0, c[1], 2.0 * c[2]
    for j in range(1, parts + 1):
        end = x * j / parts
        b_hi = bend(c, n, end)
        # where the bend changes its sign the rate has an extreme, which the ends do not show
        middle = lo + (end - lo) * b_lo / (b_lo - b_hi) if b_lo * b_hi < 0.0 else end
        for hi in (middle, end):
            v_hi = slope(c, n, hi)
            if (v_lo > 0.0 or (v_lo == 0.0 and b_lo > 0.0)) and v_hi <= 0.0 and hi > lo:
                y = turning_point(c, n, lo, hi)
                set_peak(par, e, s, value(c, n, y), t + y, out)
            lo, v_lo = hi, v_hi
        b_lo = b_hi


@jit_lean
def set_peak(par, e, s, q, t, out):
    """Note |theta| = q at t if it is the largest so far, of all or of its side."""
    side = to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT
    out[side] = max(out[side], q)
    if q > out[to.PEAK] * (1.0 + 1e-12):
        out[to.PEAK], out[to.PEAK_SIDE], out[to.PEAK_ALPHA], out[to.T_PEAK] = q, s, par[e + at.ALPHA], t
