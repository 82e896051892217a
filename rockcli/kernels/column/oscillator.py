"""Exact steps of the modal oscillator z'' + c z' + lam z = f0 + f1 t + f2 t^2/2 (docs/flexible.md).

With S_k the response from rest to t^k/k!, S_{-1} the impulse response and S_{k-1} = S_k':

    lam S_k + c S_{k-1} + S_{k-2} = t^k/k!                                                       (F8)

lam may be negative (the rocking mode) and c as large as one likes (over-damped).
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit

SERIES_BELOW = 1.0
"""|lam| t^2 + c t below which the S_k are summed as power series: the recursion would lose digits there."""

PZZ, PZV, PVZ, PVV, WZ, WV, HALF = 0, 1, 2, 3, 4, 7, 10
"""Rows of a step table: transition, weights of f at 0, h/2, h on z and on z', and what is read at h/2."""

TABLE_ROWS, PACE_ROWS = 14, 7
INFLUENCES = 24


@jit
def responses(lam, c, t, S):
    """Write S_{-2} ... S_2 at t into S[0..4]."""
    if abs(lam) * t * t + c * t < SERIES_BELOW:
        # S_2 = sum over j >= 4 of a_j t^j/j!, a_4 = 1, a_{j+2} = -c a_{j+1} - lam a_j
        before, now = 0.0, 1.0
        power = t * t * t / 6.0
        s_1 = s_2 = 0.0
        for j in range(4, 40):
            s_1 += now * power
            power *= t / j
            s_2 += now * power
            before, now = now, -c * now - lam * before
            if abs(now * power) < 1e-18 * abs(s_2) and abs(before * power) < 1e-18 * abs(s_2):
                break
        S[4], S[3] = s_2, s_1
        S[2] = 0.5 * t * t - c * s_1 - lam * s_2
        S[1] = t - c * S[2] - lam * s_1
        S[0] = 1.0 - c * S[1] - lam * S[2]
        return
    d = lam - 0.25 * c * c
    k = math.sqrt(abs(d))
    half = 0.5 * c
    if d > 0.0:
        e = math.exp(-half * t)
        s = e * math.sin(k * t) / k
        rate = e * math.cos(k * t) - half * s
    elif k * t < 1.0:
        e = math.exp(-half * t)
        s = e * (math.sinh(k * t) / k if k > 0.0 else t)
        rate = e * math.cosh(k * t) - half * s
    else:
        slow, fast = -lam / (half + k), -(half + k)
        e_slow, e_fast = math.exp(slow * t), math.exp(fast * t)
        s = (e_slow - e_fast) / (2.0 * k)
        rate = (slow * e_slow - fast * e_fast) / (2.0 * k)
    S[0], S[1] = rate, s
    S[2] = (1.0 - c * s - rate) / lam
    S[3] = (t - c * S[2] - s) / lam
    S[4] = (0.5 * t * t - c * S[3] - S[2]) / lam


@jit
def fill(lam, c, bu, th, h, S, table, influence):
    """Tables of a step h for all modes of a phase.

    `bu` and `th` are the modes' components along the uniform load and the base rotation, both as input and as
    output.  `table` (TABLE_ROWS, N); `influence` (INFLUENCES,): what the two loads at 0, h/2 and h add to
    theta(h/2) [0:6], Y(h/2) [6:12], theta(h) [12:18], Y(h) [18:24], uniform load first.
    """
    for i in range(INFLUENCES):
        influence[i] = 0.0
    for m in range(len(lam)):
        for part in range(2):  # 0: at h/2, 1: at h
            x = 0.5 * h if part == 0 else h
            responses(lam[m], c[m], x, S)
            pzz, pzv = S[0] + c[m] * S[1], S[1]
            one, two = S[3] / h, 4.0 * S[4] / (h * h)
            w_0, w_1, w_2 = S[2] - 3.0 * one + two, 4.0 * one - 2.0 * two, two - one
            if part == 0:
                table[HALF, m], table[HALF + 1, m] = th[m] * pzz, th[m] * pzv
                table[HALF + 2, m], table[HALF + 3, m] = bu[m] * pzz, bu[m] * pzv
            else:
                table[PZZ, m], table[PZV, m] = pzz, pzv
                table[PVZ, m], table[PVV, m] = -lam[m] * S[1], S[0]
                table[WZ, m], table[WZ + 1, m], table[WZ + 2, m] = w_0, w_1, w_2
                one, two = S[2] / h, 4.0 * S[3] / (h * h)
                table[WV, m] = S[1] - 3.0 * one + two
                table[WV + 1, m] = 4.0 * one - 2.0 * two
                table[WV + 2, m] = two - one
            row = 12 * part
            for k in range(3):
                w = w_0 if k == 0 else (w_1 if k == 1 else w_2)
                influence[row + k] += th[m] * w * bu[m]
                influence[row + 3 + k] += th[m] * w * th[m]
                influence[row + 6 + k] += bu[m] * w * bu[m]
                influence[row + 9 + k] += bu[m] * w * th[m]


@jit
def know_pace(lam, c, d, S, paces, filled, level):
    """What d does to every mode into paces[level] (PACE_ROWS, N), once: transition, responses S_0, S_1, S_2."""
    if filled[level] == 0.0:
        filled[level] = 1.0
        for m in range(len(lam)):
            responses(lam[m], c[m], d, S)
            paces[level, PZZ, m], paces[level, PZV, m] = S[0] + c[m] * S[1], S[1]
            paces[level, PVZ, m], paces[level, PVV, m] = -lam[m] * S[1], S[0]
            paces[level, 4, m], paces[level, 5, m], paces[level, 6, m] = S[2], S[3], S[4]


@jit
def hop(paces, level, bu, th, F, z, v, z_out, v_out):
    """`advance` by a known pace."""
    for m in range(len(z)):
        f_0, f_1, f_2 = bu[m] * F[0] + th[m] * F[3], bu[m] * F[1] + th[m] * F[4], bu[m] * F[2] + th[m] * F[5]
        s_1, s_0, s_00 = paces[level, PZV, m], paces[level, 4, m], paces[level, 5, m]
        z_out[m] = paces[level, PZZ, m] * z[m] + s_1 * v[m] + s_0 * f_0 + s_00 * f_1 + paces[level, 6, m] * f_2
        v_out[m] = paces[level, PVZ, m] * z[m] + paces[level, PVV, m] * v[m] + s_1 * f_0 + s_0 * f_1 + s_00 * f_2


@jit
def advance(lam, c, bu, th, F, x, S, z, v, z_out, v_out):
    """Modal state at x under the loads F = (f0, f1, f2 of the uniform load; of the base moment)."""
    for m in range(len(lam)):
        responses(lam[m], c[m], x, S)
        f_0, f_1, f_2 = bu[m] * F[0] + th[m] * F[3], bu[m] * F[1] + th[m] * F[4], bu[m] * F[2] + th[m] * F[5]
        z_out[m] = (S[0] + c[m] * S[1]) * z[m] + S[1] * v[m] + S[2] * f_0 + S[3] * f_1 + S[4] * f_2
        v_out[m] = -lam[m] * S[1] * z[m] + S[0] * v[m] + S[1] * f_0 + S[2] * f_1 + S[3] * f_2


@jit
def wander(lam, c, bu, th, F, h, z, v, row, row_v, floor, floor_rate, found):
    """Bound of how far row.z + row_v.z' strays from its value at the start of a step, into found[0].

    A damped free oscillation never exceeds its first energy, so |z - z_p| <= amp and |z' - z_p'| <= omega amp
    with z_p the polynomial solution.  found[1]: highest omega whose share in the output exceeds `floor`.
    found[2], found[3]: the same of the rate row.z', with `floor_rate`.
    """
    total = omega_max = rate = omega_rate = 0.0
    for m in range(len(lam)):
        g_0, g_1 = abs(row[m]), abs(row_v[m])
        if g_0 == 0.0 and g_1 == 0.0:
            continue
        f_0, f_1, f_2 = bu[m] * F[0] + th[m] * F[3], bu[m] * F[1] + th[m] * F[4], bu[m] * F[2] + th[m] * F[5]
        if lam[m] * h * h > 0.01:
            soft = 1.0 / lam[m]
            a_2 = f_2 * soft
            a_1 = (f_1 - c[m] * a_2) * soft
            a_0 = (f_0 - c[m] * a_1 - a_2) * soft
            omega = math.sqrt(lam[m])
            y, r = z[m] - a_0, v[m] - a_1
            amp = math.sqrt(y * y + r * r * soft)
            share = (g_0 + g_1 * omega) * amp
            within = min(omega * h, 2.0)
            total += share * within + g_0 * h * (abs(a_1) + abs(a_2) * h) + g_1 * h * abs(a_2)
            if share > floor and omega > omega_max:
                omega_max = omega
            share = g_0 * omega * amp
            rate += share * within + g_0 * h * abs(a_2)
            if share > floor_rate and omega > omega_rate:
                omega_rate = omega
        else:
            pull = abs(f_0) + h * (abs(f_1) + h * abs(f_2)) + abs(lam[m]) * (abs(z[m]) + h * abs(v[m]))
            pull += c[m] * abs(v[m])
            total += 1.1 * (g_0 * h * (abs(v[m]) + h * pull) + g_1 * h * pull)
            rate += 1.1 * g_0 * h * pull
    found[0], found[1], found[2], found[3] = total, omega_max, rate, omega_rate
