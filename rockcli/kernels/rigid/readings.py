"""What is noted of a case, and read off a step: work, peaks, impacts, histories (docs/theory.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import DUE, MEANINGFUL
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import driving, restoring
from rockcli.kernels.rigid.roots import turning_point
from rockcli.kernels.rigid.series import bend, slope, value


@jit_part
def clear(out):
    """Nothing is known of a case yet."""
    for i in range(len(out)):
        out[i] = 0.0
    out[to.T_PEAK] = out[to.T_UPLIFT] = out[to.T_OVERTURN] = math.nan
    out[to.N_MIN] = out[to.N_STANDING] = math.inf
    out[to.PEAK_ALPHA] = 1.0


@jit_part
def empty(spaces):
    """Nothing is left in work space of the case before."""
    for space in spaces:
        for i in range(len(space)):
            space[i] = 0.0


@jit
def work_done(edge, s, c, n, x, a, a_v, deg, sin_q, cos_q, moment):
    """Work of the ground motion and of the damper over a step, over m g: -R * integral of their moments times q'.

    `moment` is work space.  sin_q and cos_q are known to order n - 2; the product series is cut there too.
    """
    damper = edge.damper * edge.g / edge.p2
    if deg.a == 0 and a[0] == 0.0 and deg.v == 0 and a_v[0] == 0.0 and damper == 0.0:
        return 0.0
    total = 0.0
    power = x
    for k in range(n - 1):
        drive = 0.0
        for j in range(min(k, deg.a) + 1):
            drive += a[j] * driving(edge.fc, edge.fs, sin_q[k - j], cos_q[k - j])
        drive *= s
        for j in range(min(k, deg.v) + 1):
            drive += a_v[j] * restoring(0.0, edge.rs, edge.rc, sin_q[k - j], cos_q[k - j])
        moment[k] = drive + (a_v[k] * edge.r0 if k <= deg.v else 0.0) + damper * (k + 1) * c[k + 1]
        power_k = 0.0
        for i in range(k + 1):
            power_k += moment[i] * (k - i + 1) * c[k - i + 1]
        total += power_k * power / (k + 1)
        power *= x
    return -total * edge.radius / edge.g


@jit
def raise_peak(alpha, s, c, n, x, t, parts, tol, out):
    """Raise the peak of |theta| to the largest turning point on [0, x]."""
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
                set_peak(alpha, s, value(c, n, y), t + y, tol, out)
            lo, v_lo = hi, v_hi
        b_lo = b_hi


@jit
def set_peak(alpha, s, q, t, tol, out):
    """Note |theta| = q at t if it is the largest so far, of all or of its side; alpha of that side.

    Equal peaks of an undamped body differ by the errors of its steps: a later one that is higher by no more leaves side
    and time as they are.
    """
    side = to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT
    out[side] = max(out[side], q)
    if q > out[to.PEAK] * (1.0 + 1e-12 + 100.0 * tol):
        out[to.PEAK_SIDE], out[to.PEAK_ALPHA], out[to.T_PEAK] = s, alpha, t
    out[to.PEAK] = max(out[to.PEAK], q)


@jit
def forget_hops(out):
    """Take back the uplift and the peaks of hops that took no time: rounding, of a body that moves at no other time."""
    out[to.PEAK] = out[to.PEAK_LEFT] = out[to.PEAK_RIGHT] = out[to.RATE_PEAK] = 0.0
    out[to.T_PEAK] = out[to.T_UPLIFT] = math.nan


@jit
def note_swing(rate, t, out):
    """Note what an impact at t carries, its rate over p alpha."""
    carried = rate**2 - MEANINGFUL**2
    if carried > 0.0:
        out[to.SWINGS] += carried
        out[to.SWINGS_T] += carried * t


@jit
def note_impact(t, rate, eta, impacts, out):
    """Count an impact, and store it as far as there is room: time, rate before and after."""
    out[to.N_IMPACTS] += 1
    k = int(out[to.IMPACTS_STORED])
    if k < len(impacts[0]):
        impacts[0][k], impacts[1][k], impacts[2][k] = t, rate, eta * rate
        out[to.IMPACTS_STORED] += 1


@jit_part
def write_rest(history, i, dt_out, until, theta):
    """Write a body that stands at theta to its histories from i dt_out on until a time; return the next i."""
    while i < len(history[0]) and i * dt_out <= until * (1.0 + DUE):
        history[0][i] = theta
        history[1][i] = 0.0
        i += 1
    return i


@jit_part
def write_step(history, i, dt_out, t, until, tilt, s, c, n):
    """Write a step from t on, theta = tilt + s q, to the histories from i dt_out on until a time; return the next i."""
    while i < len(history[0]) and i * dt_out <= until * (1.0 + DUE):
        y = min(i * dt_out, until) - t
        history[0][i] = tilt + s * max(value(c, n, y), 0.0)
        history[1][i] = s * slope(c, n, y)
        i += 1
    return i
