"""Impacts with friction along the path of the impulse (Routh; docs/contact.md).

Rates of change per unit of normal impulse are constant while the foot slips one way or sticks, so that the path is a
few straight pieces.
"""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.jit import jit

STOPPED = 1e-9
"""A base that slips slower than this after an impact that stopped the rotation has stopped [m/s]."""


@jit
def landing(par, i, j, w, v):
    """A body that turns about edge i comes down on edge j (K10, K11): (rate, slip, normal impulse) just after.

    `w` > 0 is the rate, `v` the slip velocity of the base, in the direction of the rotation.  A rate of 0 after it:
    both edges stay down.
    """
    h, rg2, mu_s, mu_k = par[at.H], par[at.RG2], par[at.MU_S], par[at.MU_K]
    b_i, b_j, place = par[i + at.B], par[j + at.B], par[j + at.PLACE]
    sticking = h * place / (rg2 + h * h)
    whole = v + h * w  # velocity of the centre of mass
    w_0, v_n, impulse = w, -(b_i + b_j) * w, 0.0
    for _ in range(4):
        sticks = v == 0.0 and mu_s >= sticking
        f = -sticking if sticks else (-mu_k if v >= 0.0 else mu_k)
        dw = -(h * f + place) / rg2
        dv = 0.0 if sticks else f - h * dw
        dn = 1.0 - b_j * dw
        end = -v_n / dn if dn > 0.0 else math.inf
        stop = -v / dv if v * dv < 0.0 else math.inf
        if stop < end:
            w, v, v_n, impulse = w + dw * stop, 0.0, v_n + dn * stop, impulse + stop
            continue
        if end < math.inf:
            w, v, impulse = w + dw * end, v + dv * end, impulse + end
        break
    if w < 0.0:
        impulse = b_i * w_0
        left = abs(whole) - mu_k * impulse
        # a slip that trips, stops and lets the body down again would follow, smaller each time, without end
        return 0.0, (math.copysign(left, whole) if left > STOPPED else 0.0), impulse
    return w, v, impulse


@jit
def corner(par, c, d, rate, v_t, v_n):
    """A corner at (c, d) from the centre of mass strikes the ground at v_n < 0 (K12): (theta', v_t, v_n) just after.

    Compression ends where v_n vanishes, restitution where the normal force has given back e_n^2 of the work it took.
    """
    rg2, mu_s, mu_k = par[at.RG2], par[at.MU_S], par[at.MU_K]
    sticking = c * d / (rg2 + d * d)
    work, back = 0.0, 0.0
    compressing = True
    for _ in range(8):
        sticks = v_t == 0.0 and abs(sticking) <= mu_s
        if sticks:
            f = sticking
        elif v_t == 0.0:
            f = math.copysign(mu_k, sticking)  # friction cannot hold it: it slips against what it can give
        else:
            f = -math.copysign(mu_k, v_t)
        turn = (d * f - c) / rg2
        dt = 0.0 if sticks else f + d * turn
        dn = 1.0 - c * turn
        if compressing:
            end = -v_n / dn if dn > 0.0 else math.inf
        else:
            # v_n J + dn J^2/2 = what is still owed
            owed = max(back - work, 0.0)
            end = 2.0 * owed / (v_n + math.sqrt(max(v_n * v_n + 2.0 * dn * owed, 0.0))) if owed > 0.0 else 0.0
        stop = -v_t / dt if v_t * dt < 0.0 else math.inf
        J = min(stop, end)
        if math.isinf(J):
            break
        work += v_n * J + 0.5 * dn * J * J
        rate += turn * J
        v_n += dn * J
        v_t = 0.0 if stop <= end else v_t + dt * J
        if stop < end:
            continue
        v_n = 0.0 if compressing else v_n
        if not compressing or par[at.E_N] == 0.0:
            break
        compressing = False
        back = -par[at.E_N] * par[at.E_N] * work
        work = 0.0
    return rate, v_t, v_n


@jit
def flat(par, x_rate, z_rate):
    """A body lands flat on the ground, neither edge first (docs/contact.md): (theta', x', z') of the centre of mass.

    It stays flat if the impulse that friction takes leaves the normal one within the base; else the impulse acts at the
    leading edge alone.
    """
    edge = at.RIGHT if x_rate > 0.0 else at.LEFT
    impulse = -(1.0 + par[at.E_N]) * z_rate
    along = min(par[at.MU_K] * impulse, abs(x_rate))
    if par[at.H] * along <= par[edge + at.B] * impulse:
        return 0.0, math.copysign(abs(x_rate) - along, x_rate), par[at.E_N] * abs(z_rate)
    c, d = math.copysign(par[edge + at.B], x_rate), -par[at.H]
    rate, v_t, v_n = corner(par, c, d, 0.0, x_rate, z_rate)
    return rate, v_t - d * rate, v_n + c * rate


@jit
def jam(par, e, q, rate, u):
    """theta' just after a jam: an impulse at the edge that stops its slip at once (K13)."""
    R = par[e + at.RADIUS]
    return rate + R * math.cos(par[e + at.ALPHA] - q) * u / (par[at.RG2] + R * R)
