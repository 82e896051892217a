"""Looking inside a step of the flexible column: the first event, the turning points (docs/flexible.md, section 3).

The look moves in paces of a power of two of a second, whatever the step: what a pace does to the modes depends on the
column only, is found once and kept (`paces`).  How long a pace may be is asked of the bound of `wander` again and
again: it lengthens as the vibrations die out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from rockcli.kernels.column import layout as at
from rockcli.kernels.column.law import along, dot, gap, limit, limit_change
from rockcli.kernels.column.oscillator import PACE_ROWS, advance, hop, know_pace, wander
from rockcli.kernels.jit import jit

LONGEST, LEVELS = 4, 56
"""Paces are 2^LONGEST, ... 2^(LONGEST - LEVELS + 1) s."""

PACE_SHAPE = (LEVELS, PACE_ROWS)

RESOLVED, COARSELY = 0.5, 1.0
"""Longest pace, in radians of the fastest mode that matters, in which values and rates at its ends tell of a dip; at
accuracy `draft`."""

PATIENCE = 200
"""Paces in a step after which RESOLVED is let grow."""

MOST_PACES = 240.0
"""A step is walked for its peaks in no more paces than twice this."""


class Bound(NamedTuple):
    """How far the guard's quantity and its rate may stray in a step, and the fastest modes that matter in them.

    Attributes:
        stray, swing: of the quantity, of its rate.
        omega, omega_swing: [rad/s].
    """

    stray: float
    omega: float
    swing: float
    omega_swing: float


@jit
def mode_of(modes, phase):
    """The rows of `modes` of `march` for a phase."""
    return (
        modes[0, phase], modes[1, phase], modes[2, phase], modes[3, phase], modes[4, phase], modes[5, phase],
        modes[6, phase],
    )  # fmt: skip


@jit
def matters(par):
    """Share below which a mode is too weak at this accuracy to set how densely a step is looked at."""
    return 1e-5 if par[at.FINENESS] >= 1.0 else (1e-7 if par[at.FINENESS] >= 0.5 else 1e-9)


@jit
def level_of(d):
    """Level of the longest pace that is not beyond d."""
    return min(max(LONGEST + 1 - math.frexp(d * (1.0 + 1e-9))[1], 0), LEVELS - 1)


@jit
def shift(F, x, out):
    """Quadratics of F[0:12] about x."""
    for k in range(0, 12, 3):
        out[k] = F[k] + x * (F[k + 1] + 0.5 * x * F[k + 2])
        out[k + 1], out[k + 2] = F[k + 1] + x * F[k + 2], F[k + 2]


@jit
def drop(par, phase, lam, c, bu, th, row, row_v, F, d, z, v, floor, floor_rate, found):
    """Bound of how far `gap` may fall within d; found as from `wander`."""
    wander(lam, c, bu, th, F, d, z, v, row, row_v, floor, floor_rate, found)
    stray = found[0]
    if phase == at.CONTACT and par[at.THETA_1] == 0.0:
        stray += d * abs(par[at.R_A]) * (abs(F[7]) + 0.5 * d * abs(F[8]))
    nearer = 1.0 if phase == at.OPEN else -1.0  # the heavier, the sooner contact begins and the later it ends
    change = max(nearer * F[10], 0.0) + 0.5 * d * max(nearer * F[11], 0.0)
    return stray + limit_change(par, phase, d * change)


@jit
def look(par, phase, s, armed, lam, c, bu, th, row, row_v, F, x, z, v):
    """`gap` at x, where the modal state is z, v, and its rate."""
    f, m = along(F, 0, x), along(F, 3, x)
    value = rate = 0.0
    for k in range(len(lam)):
        value += row[k] * z[k] + row_v[k] * v[k]
        rate += row[k] * v[k] + row_v[k] * (bu[k] * f + th[k] * m - c[k] * v[k] - lam[k] * z[k])
    a_v = along(F, 9, x) if phase == at.CONTACT or par[at.THETA_1] > 0.0 else 0.0
    edge_rate = limit_change(par, phase, F[10] + x * F[11])
    if par[at.THETA_1] > 0.0 and par[at.G] + a_v <= 0.0:
        edge_rate = 0.0
    if phase == at.OPEN:
        return gap(par, phase, s, armed, value, a_v), s * rate - edge_rate
    if par[at.THETA_1] == 0.0:
        value += par[at.R_A] * along(F, 6, x)
        rate += par[at.R_A] * (F[7] + x * F[8])
    near = gap(par, phase, s, armed, value, a_v)
    if near < gap(par, phase, s, False, value, a_v):
        return near, s * rate
    return near, edge_rate - math.copysign(rate, value * rate)


@jit
def first_event(par, phase, s, armed, mode, F, h, ends, floor, known, room, about, S, found, z_x, v_x):
    """First time in [0, h] a guard turns negative, or -1; the state there is left in z_x, v_x.

    `mode`: the rows of `modes` of `march` for the phase; `ends`: z, v at 0 and at h; `known`: paces and which of them
    are filled.  A pace is taken where the bound excludes an event within it, or where it resolves the modes that
    matter; then a dip between its ends shows in the rates there.
    """
    (lam, c, bu, th, _, row, row_v), (z, v, z_1, v_1), (paces, filled) = mode, ends, known
    z_a, v_a, z_b, v_b = room[0], room[1], room[2], room[3]
    for m in range(len(z)):
        z_a[m], v_a[m], z_x[m], v_x[m] = z[m], v[m], z[m], v[m]
    g, rate = look(par, phase, s, armed, lam, c, bu, th, row, row_v, F, 0.0, z, v)
    if g < 0.0:
        return 0.0
    level = level_of(h)
    count, resolved = 0, RESOLVED if par[at.FINENESS] < 1.0 else COARSELY
    x = 0.0
    while x < h:
        d = math.ldexp(1.0, LONGEST - level)
        last = h - x <= d * (1.0 + 1e-6)
        d = h - x if last else d
        shift(F, x, about)
        fall = drop(par, phase, lam, c, bu, th, row, row_v, about, d, z_a, v_a, floor, math.inf, found)
        safe = g > fall
        if not safe and found[1] * d > resolved and level < LEVELS - 1:
            level = max(level + 1, min(level + 2, level_of(resolved / found[1])))
            continue
        if last:
            for m in range(len(z)):
                z_b[m], v_b[m] = z_1[m], v_1[m]
        else:
            know_pace(lam, c, d, S, paces, filled, level)
            hop(paces, level, bu, th, about, z_a, v_a, z_b, v_b)
        g_b, rate_b = look(par, phase, s, armed, lam, c, bu, th, row, row_v, about, d, z_b, v_b)
        end = d if g_b < 0.0 else 0.0
        if g_b >= 0.0 and not safe and rate < 0.0 < rate_b:
            y = d * rate / (rate - rate_b)
            if g + 0.5 * rate * y < 0.5 * g:
                advance(lam, c, bu, th, about, y, S, z_a, v_a, z_x, v_x)
                dip, _ = look(par, phase, s, armed, lam, c, bu, th, row, row_v, about, y, z_x, v_x)
                if dip < 0.0:
                    end, g_b = y, dip
        if end > 0.0:
            y = _refine(
                par, phase, s, armed, lam, c, bu, th, row, row_v, about, end, g, g_b, S, z_a, v_a, z_x, v_x
            )  # fmt: skip
            return min(x + y, h)
        z_a, v_a, z_b, v_b = z_b, v_b, z_a, v_a
        g, rate = g_b, rate_b
        x = h if last else x + d
        if g > 2.0 * fall or 2.0 * d * found[1] < resolved:
            level = max(level - 1, 0)
        count += 1
        if count > PATIENCE:
            resolved *= 1.1
    return -1.0


@jit
def guards(par, modes, phase, s, armed, F, h, z, v, known, work, about, S, found):
    """When the first guard turns negative in a step, or h: (time, whether one does, `Bound` of the step).

    Where one does, rows 0, 1 of `work` hold the state then.
    """
    mode, z_1, v_1, z_x, v_x = mode_of(modes, phase), work[0], work[1], work[2], work[3]
    lam, c, bu, th, _, row, row_v = mode
    weak = matters(par)
    floor = weak * (limit(par, at.CONTACT, 0.0) if phase == at.CONTACT else par[at.ALPHA])
    near, _ = look(par, phase, s, armed, lam, c, bu, th, row, row_v, F, 0.0, z, v)
    floor_rate = math.sqrt(weak) * par[at.P] * par[at.ALPHA]
    fall = drop(par, phase, lam, c, bu, th, row, row_v, F, h, z, v, floor, floor_rate, found)
    bound = Bound(found[0], found[1], found[2], found[3])
    if near <= fall:
        ends, room = (z, v, z_1, v_1), work[4:8]
        y = first_event(par, phase, s, armed, mode, F, h, ends, floor, known, room, about, S, found, z_x, v_x)
        if y >= 0.0:
            for m in range(len(z)):
                z_1[m], v_1[m] = z_x[m], v_x[m]
            return y, True, bound
    return h, False, bound


@jit
def _refine(par, phase, s, armed, lam, c, bu, th, row, row_v, F, hi, g_lo, g_hi, S, z, v, z_x, v_x):
    """Newton's method, bisecting where it leaves the bracket [0, hi]; ends just beyond the guard."""
    lo, d = 0.0, hi
    beyond = 0.1 * par[at.TOL]
    if phase == at.CONTACT and par[at.THETA_1] == 0.0:
        beyond = 1e-12 * limit(par, phase, 0.0)
    y = hi * g_lo / (g_lo - g_hi)
    for _ in range(60):
        advance(lam, c, bu, th, F, y, S, z, v, z_x, v_x)
        g, rate = look(par, phase, s, armed, lam, c, bu, th, row, row_v, F, y, z_x, v_x)
        if g >= 0.0:
            lo = y
        else:
            hi = y
            if g > -beyond:
                return y
        if hi - lo <= 1e-15 * d:
            break
        y = y - (g + 0.5 * beyond) / rate if rate < 0.0 else lo
        if not lo < y < hi:
            y = 0.5 * (lo + hi)
    advance(lam, c, bu, th, F, hi, S, z, v, z_x, v_x)
    return hi


@jit
def note(par, th, top, t, z, v, peaks):
    """Note the largest |theta| with its time and side, rate and top displacement into peaks (5,)."""
    theta = dot(th, z)
    if abs(theta) > peaks[0] * (1.0 + 1e-12):
        peaks[0], peaks[1], peaks[2] = abs(theta), math.copysign(1.0, theta), t
    peaks[3] = max(peaks[3], abs(dot(th, v)))
    u = par[at.LENGTH] * (math.sin(theta) + (dot(top, z) - theta) * math.cos(theta))
    peaks[4] = max(peaks[4], abs(u))


@jit
def bend(lam, c, bu, th, row, F, x, z, v):
    """Second rate of row.z where the modal state at x is z, v."""
    f, m_0 = along(F, 0, x), along(F, 3, x)
    total = 0.0
    for m in range(len(lam)):
        total += row[m] * (bu[m] * f + th[m] * m_0 - c[m] * v[m] - lam[m] * z[m])
    return total


@jit
def note_peaks(par, mode, F, h, omega, turns, t, ends, known, room, about, S, z_x, v_x, peaks):
    """`note` along a step, RESOLVED radians of omega apart, and where the rate turns in between.

    `turns`: theta and the top are looked at too, also where they turn in between; without it COARSELY does.
    """
    (lam, c, bu, th, top, _, _), (z, v, z_1, v_1), (paces, filled) = mode, ends, known
    z_a, v_a, z_b, v_b = room[0], room[1], room[2], room[3]
    for m in range(len(z)):
        z_a[m], v_a[m] = z[m], v[m]
    note(par, th, top, t, z, v, peaks)
    apart = RESOLVED if turns or par[at.FINENESS] < 0.5 else COARSELY
    level = level_of(max(min(apart / omega, 0.5 * h) if omega > 0.0 else 0.5 * h, h / MOST_PACES))
    know_pace(lam, c, math.ldexp(1.0, LONGEST - level), S, paces, filled, level)
    rate, turning = dot(th, v), bend(lam, c, bu, th, th, F, 0.0, z, v)
    x = 0.0
    while x < h:
        d = math.ldexp(1.0, LONGEST - level)
        last = h - x <= d * (1.0 + 1e-6)
        d = h - x if last else d
        shift(F, x, about)
        if last:
            for m in range(len(z)):
                z_b[m], v_b[m] = z_1[m], v_1[m]
        else:
            hop(paces, level, bu, th, about, z_a, v_a, z_b, v_b)
        if turns or last:
            note(par, th, top, t + x + d, z_b, v_b, peaks)
        for part in range(2 if turns else 0):
            row = th if part == 0 else top
            record = peaks[0] if part == 0 else peaks[4] / par[at.LENGTH]
            r_a, r_b = dot(row, v_a), dot(row, v_b)
            q = max(abs(dot(row, z_a)), abs(dot(row, z_b)))
            if r_a * r_b < 0.0 and q + 0.5 * d * max(abs(r_a), abs(r_b)) > 0.99 * record:
                y = d * r_a / (r_a - r_b)
                for _ in range(2):
                    advance(lam, c, bu, th, about, y, S, z_a, v_a, z_x, v_x)
                    note(par, th, top, t + x + y, z_x, v_x, peaks)
                    r, slope = dot(row, v_x), bend(lam, c, bu, th, row, about, y, z_x, v_x)
                    if abs(r) > abs(slope) * d:
                        break
                    y = min(max(y - r / slope, 0.0), d)
        before, turning = turning, bend(lam, c, bu, th, th, about, d, z_b, v_b)
        y = d * before / (before - turning) if before * turning < 0.0 else 0.0
        if abs(rate) + 0.5 * abs(before) * y > peaks[3]:
            advance(lam, c, bu, th, about, y, S, z_a, v_a, z_x, v_x)
            peaks[3] = max(peaks[3], abs(dot(th, v_x)))
        rate = dot(th, v_b)
        peaks[3] = max(peaks[3], abs(rate))
        z_a, v_a, z_b, v_b = z_b, v_b, z_a, v_a
        x = h if last else x + d
