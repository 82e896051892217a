"""What is read off the flexible column in a phase: loads, guards, energy (docs/flexible.md).

Everything is per m L^2 (mass per unit depth, L = 2h), so that moments are in 1/s^2 and energies too.
"""

from __future__ import annotations

import math

from rockcli.kernels.column import layout as at
from rockcli.kernels.column.oscillator import HALF, PVV, PVZ, PZV, PZZ, WV, WZ
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.ground import PULSES, expand
from rockcli.kernels.rigid.ground import WIDTH as PIECE

UNIFORM_TO_ROTATION = 0.5
"""Uniform load times rigid rotation: the first moment of the mass over m L."""


@jit
def dot(a, b):
    """Scalar product."""
    total = 0.0
    for m in range(len(a)):
        total += a[m] * b[m]
    return total


@jit
def opens_at(par, a_v):
    """Rotation at which a Winkler base opens: it follows the weight, the stiffness below does not; 0: rigid base."""
    return par[at.THETA_1] * max(1.0 + a_v / par[at.G], 0.0) if par[at.THETA_1] > 0.0 else 0.0


@jit
def contact_moment(par, theta):
    """Moment of a Winkler base in full contact, whatever the weight [1/s^2]."""
    return par[at.G] * par[at.WIDTH] / (par[at.LENGTH] * par[at.LENGTH]) * theta / (3.0 * par[at.THETA_1])


@jit
def base_moment(par, s, theta, a_v):
    """Moment of the base opposing an open column: (g + a_v) b, or the Winkler law (F6); [1/s^2]."""
    weight = par[at.G] + a_v
    if weight <= 0.0 and par[at.THETA_1] > 0.0:
        return 0.0
    full = weight * par[at.WIDTH] / (par[at.LENGTH] * par[at.LENGTH])
    theta_1 = par[at.THETA_1] * weight / par[at.G]
    if theta_1 <= 0.0:
        return s * full
    q = s * theta
    if q <= theta_1:
        return s * full * q / (3.0 * theta_1)
    return s * full * (1.0 - 2.0 / 3.0 * math.sqrt(theta_1 / q))


@jit
def loads(par, phase, s, theta, y, a, a_v):
    """Loads beside the linear weight (F3): along the column, and the moment on the base rotation; y = b_u.y."""
    g, sin, cos = par[at.G], math.sin(theta), math.cos(theta)
    f = ((g + a_v) * sin - g * theta - a * cos) / par[at.LENGTH]
    moment = ((g + a_v) * cos - g + a * sin) * (y - UNIFORM_TO_ROTATION * theta) / par[at.LENGTH]
    if phase == at.OPEN:
        moment -= base_moment(par, s, theta, a_v)
    return f, moment


@jit
def quadratic(f_0, f_b, f_1, h, F, k):
    """Coefficients of f0 + f1 t + f2 t^2/2 through values at 0, h/2, h, into F[k : k + 3]."""
    F[k] = f_0
    F[k + 1] = (4.0 * f_b - 3.0 * f_0 - f_1) / h
    F[k + 2] = 4.0 * (f_0 - 2.0 * f_b + f_1) / (h * h)


@jit
def along(F, k, x):
    """Value of a quadratic at x."""
    return F[k] + x * (F[k + 1] + 0.5 * x * F[k + 2])


@jit
def step(par, phase, s, lam, bu, th, h, table, influence, A, z, v, z_1, v_1, F):
    """One step: the loads by collocation at 0, h/2, h (F9), then the exact modal flow under them.

    A holds a_g and a_v at 0, h/2, h.  Writes the state at h into z_1, v_1 and the loads' coefficients into F.
    Returns how often the loads were evaluated, negative if they do not converge (the step is too long).
    """
    n = len(lam)
    theta_b = y_b = theta_1 = y_1 = 0.0
    for m in range(n):
        z_1[m] = table[PZZ, m] * z[m] + table[PZV, m] * v[m]
        v_1[m] = table[PVZ, m] * z[m] + table[PVV, m] * v[m]
        theta_b += table[HALF, m] * z[m] + table[HALF + 1, m] * v[m]
        y_b += table[HALF + 2, m] * z[m] + table[HALF + 3, m] * v[m]
        theta_1 += th[m] * z_1[m]
        y_1 += bu[m] * z_1[m]
    theta = dot(th, z)
    w = influence
    f_0, m_0 = loads(par, phase, s, theta, dot(bu, z), A[0], A[3])
    rate = 0.5 * h * dot(th, v)
    t_b, t_1, s_b, s_1 = theta + rate, theta + 2.0 * rate, dot(bu, z) + 0.5 * rate, dot(bu, z) + rate
    f_b = f_1 = m_b = m_1 = 0.0
    close = 1e-7 if par[at.FINENESS] >= 1.0 else 1e-14
    converged = False
    evaluated = 1
    for _ in range(60):
        f_b, m_b = loads(par, phase, s, t_b, s_b, A[1], A[4])
        f_1, m_1 = loads(par, phase, s, t_1, s_1, A[2], A[5])
        evaluated += 2
        new_b = theta_b + w[0] * f_0 + w[1] * f_b + w[2] * f_1 + w[3] * m_0 + w[4] * m_b + w[5] * m_1
        s_b = y_b + w[6] * f_0 + w[7] * f_b + w[8] * f_1 + w[9] * m_0 + w[10] * m_b + w[11] * m_1
        new_1 = theta_1 + w[12] * f_0 + w[13] * f_b + w[14] * f_1 + w[15] * m_0 + w[16] * m_b + w[17] * m_1
        s_1 = y_1 + w[18] * f_0 + w[19] * f_b + w[20] * f_1 + w[21] * m_0 + w[22] * m_b + w[23] * m_1
        change = abs(new_b - t_b) + abs(new_1 - t_1)
        t_b, t_1 = new_b, new_1
        if change <= close * (abs(theta) + abs(t_1)) + 1e-3 * par[at.TOL]:
            converged = True
            break
        if not change < 1e3:
            break
    for m in range(n):
        q_0, q_b, q_1 = bu[m] * f_0 + th[m] * m_0, bu[m] * f_b + th[m] * m_b, bu[m] * f_1 + th[m] * m_1
        z_1[m] += table[WZ, m] * q_0 + table[WZ + 1, m] * q_b + table[WZ + 2, m] * q_1
        v_1[m] += table[WV, m] * q_0 + table[WV + 1, m] * q_b + table[WV + 2, m] * q_1
    quadratic(f_0, f_b, f_1, h, F, 0)
    quadratic(m_0, m_b, m_1, h, F, 3)
    quadratic(A[0], A[1], A[2], h, F, 6)
    quadratic(A[3], A[4], A[5], h, F, 9)
    return evaluated if converged else -evaluated


@jit
def limit(par, phase, a_v):
    """What the guard's quantity is held against: see `gap`."""
    if phase == at.OPEN:
        return opens_at(par, a_v) * (1.0 - 1e-9) - par[at.TOL]
    if par[at.THETA_1] > 0.0:
        return opens_at(par, a_v) * (1.0 + 1e-9)
    return (par[at.G] + a_v) * par[at.WIDTH] / (par[at.LENGTH] * par[at.LENGTH]) * (1.0 + 1e-10)


@jit
def limit_change(par, phase, change):
    """By how much `limit` changes with a_v, where there is a weight."""
    if par[at.THETA_1] > 0.0:
        return par[at.THETA_1] * change / par[at.G]
    return 0.0 if phase == at.OPEN else change * par[at.WIDTH] / (par[at.LENGTH] * par[at.LENGTH])


@jit
def gap(par, phase, s, armed, value, a_v):
    """Distance to the nearest guard, an event where it turns negative.

    OPEN: s theta above where contact begins.  CONTACT: |base moment| below (g + a_v) b (rigid base), |theta|
    below `opens_at` and, if eta is armed, theta on its side of zero (Winkler).
    """
    edge = limit(par, phase, a_v)
    if phase == at.OPEN:
        return s * value - edge
    room = edge - abs(value)
    if armed and par[at.THETA_1] > 0.0:
        room = min(room, s * value + par[at.TOL])
    return room


@jit
def energy(par, phase, lam, bu, th, z, v):
    """Kinetic, elastic and gravity energy and that stored in the base, zero upright; over m L^2 [1/s^2]."""
    total = 0.0
    for m in range(len(lam)):
        total += 0.5 * (v[m] * v[m] + lam[m] * z[m] * z[m])
    theta = dot(th, z)
    sigma = dot(bu, z) - UNIFORM_TO_ROTATION * theta
    half = math.sin(0.5 * theta)
    falls = 2.0 * half * half - 0.5 * theta * theta
    pull = par[at.G] / par[at.LENGTH]
    total -= pull * ((math.sin(theta) - theta) * sigma + UNIFORM_TO_ROTATION * falls)
    q, theta_1 = abs(theta), par[at.THETA_1]
    full = par[at.G] * par[at.WIDTH] / (par[at.LENGTH] * par[at.LENGTH])
    held = phase == at.CONTACT and theta_1 > 0.0 and q > theta_1 * (1.0 + 1e-6)  # by more than the weight at rest
    opened = 0.0
    if held or (phase == at.OPEN and q > theta_1):
        opened = full * (q - 4.0 / 3.0 * math.sqrt(theta_1 * q) + 0.5 * theta_1)
    if phase == at.OPEN:
        if q > theta_1:
            total += opened
        elif theta_1 > 0.0:
            total += full * q * q / (6.0 * theta_1)
    elif held:  # the modes count the contact's stiffness
        total += opened - full * q * q / (6.0 * theta_1)
    return total


@jit
def work_of(F, k, h, y_0, y_b, y_1, r_0, r_1):
    """Integral of load(t) y'(t) over a step, y the quartic through values at 0, h/2, h and rates at 0, h."""
    end = along(F, k, h)
    whole = h * (7.0 * y_0 + 16.0 * y_b + 7.0 * y_1) / 30.0 + h * h * (r_0 - r_1) / 60.0
    slope = 0.25 * h * (r_0 + r_1)
    skew = 0.25 * h * h * (0.4 * (y_1 - y_0) - 2.0 * slope / 15.0)
    return end * y_1 - F[k] * y_0 - (F[k + 1] + 0.5 * h * F[k + 2]) * whole - F[k + 2] * skew


@jit
def ground(channel, data, factor, i, t, t_end, tmp):
    """Acceleration of a channel at t, read on its piece i; a step that ends with the motion has rounding beyond it."""
    if i >= channel.pieces:
        return 0.0
    t = min(t, t_end)
    if channel.kind == PULSES and t < data[i * PIECE]:
        return 0.0
    expand(channel, data, factor, i, t, 0, tmp)
    return tmp[0]


@jit
def ground_loads(par, phase, s, theta_0, theta_b, theta_1, y_0, y_b, y_1, x, F):
    """The ground's part of the two loads as quadratics into F[12:15], F[15:18]."""
    for k in range(3):
        theta = theta_0 if k == 0 else (theta_b if k == 1 else theta_1)
        y = y_0 if k == 0 else (y_b if k == 1 else y_1)
        where = 0.5 * x * k
        a, a_v = along(F, 6, where), along(F, 9, where)
        sigma = y - 0.5 * theta
        F[18 + k] = (a_v * math.sin(theta) - a * math.cos(theta)) / par[at.LENGTH]
        F[21 + k] = (a_v * math.cos(theta) + a * math.sin(theta)) * sigma / par[at.LENGTH]
        if phase == at.OPEN:
            F[21 + k] -= base_moment(par, s, theta, a_v) - base_moment(par, s, theta, 0.0)
        elif par[at.THETA_1] > 0.0 and a_v > 0.0 and abs(theta) > par[at.THETA_1]:
            F[21 + k] -= contact_moment(par, theta) - base_moment(par, math.copysign(1.0, theta), theta, 0.0)
    for j in range(2):
        f_0, f_b, f_1 = F[18 + 3 * j], F[19 + 3 * j], F[20 + 3 * j]
        F[12 + 3 * j] = f_0
        F[13 + 3 * j] = (4.0 * f_b - 3.0 * f_0 - f_1) / x if x > 0.0 else 0.0
        F[14 + 3 * j] = 4.0 * (f_0 - 2.0 * f_b + f_1) / (x * x) if x > 0.0 else 0.0
