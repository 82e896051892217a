"""The body on the ground as a hybrid automaton with five modes: flow, guard, mode by complementarity (docs/contact.md).

Steps land on the breakpoints of the motion; flows are Taylor series, guards their polynomials, so that an event is
known to rounding.  After an event the mode is chosen anew, with the ground motion just after it.
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.constants import (
    DONE,
    FALLS,
    FAST,
    ILL_POSED,
    MAX_ORDER,
    MEANINGFUL,
    NO_ROOT,
    NOT_FINITE,
    OUT_OF_STEPS,
    PATIENCE,
    RETURNS,
    SAME,
    UNDECIDED,
)
from rockcli.kernels.contact import flows, impacts
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact.readings import (
    energy_in_flight,
    energy_on_edge,
    extremes,
    note_angle,
    note_slide,
    work,
)
from rockcli.kernels.contact.rest import frequency, settles
from rockcli.kernels.contact.results import FLIGHT, REST, ROCK, SLIDE, SLIDE_ROCK
from rockcli.kernels.contact.selection import JAM, NEITHER, on_base, on_edge, stiffness
from rockcli.kernels.jit import entry, jit_lean, room
from rockcli.kernels.rigid.ground import PULSES, expand, piece_at, piece_end
from rockcli.kernels.rigid.roots import first_root, last_passage, uplift
from rockcli.kernels.rigid.series import slope, value
from rockcli.kernels.rigid.settings import Channel

EXACT = 1e-17
"""Truncation of the series of the motion, over the weight, where its integrals are all there is to the flow."""

DOWN = 1e-9
"""A corner or a base that bounces slower than this is taken as down [m/s]."""

LOOKS = 8
"""Parts of a step in which extremes are looked for."""

SETTLED, ON_EDGE, ON_BASE = 0, 1, 2
"""What the next mode is to be chosen for."""

LANDS, TOPPLES, SLIPS, LEAVES, STOPS, JAMS, LIFTS, STRIKES = range(1, 9)
"""Events."""


@jit_lean
def within(c, lo, hi, small, h):
    """The step cut so that terms lo ... hi of a series are below `small`."""
    for k in range(lo, hi + 1):
        if abs(c[k]) > 0.0:
            h = min(h, (small / abs(c[k])) ** (1.0 / k))
    return h


@jit_lean
def integral(c, n, x):
    """Integral of a polynomial from 0 to x."""
    y = c[n] / (n + 1)
    for k in range(n - 1, -1, -1):
        y = y * x + c[k] / (k + 1)
    return y * x


@jit_lean
def leaves(c, n, h, scale):
    """First x in [0, h] where a guard of forces turns negative, or NO_ROOT; what rounding of `scale` hides is zero."""
    if abs(c[0]) <= 1e-13 * scale:
        c[0] = 0.0
    return uplift(c, n, h, scale)


@jit_lean
def starts(c, n, h, handled):
    """First x in (0, h] where a guard reaches zero, or NO_ROOT; 0 where it turns negative at once.

    `handled` leading coefficients are zero but for rounding, and none of them can point the wrong way.
    """
    for k in range(handled):
        c[k] = max(c[k], 0.0) if k == handled - 1 else 0.0
    skip = 0
    while skip < min(n, 4) and c[skip] == 0.0:
        skip += 1
    if c[skip] <= 0.0:
        return 0.0
    return first_root(c, n, h, skip)


@jit_lean
def note_event(t, mode, t_event, mode_event, out):
    """Write down that a mode was entered, and count it."""
    k = int(out[to.N_EVENTS])
    if k < len(t_event):
        t_event[k], mode_event[k] = t, mode
    out[to.N_EVENTS] += 1


@jit_lean
def note_slip(t, turns, slipped, out):
    """The foot begins to slip, or goes on slipping another way."""
    if not slipped:
        out[to.N_SLIPS] += 1
    if math.isnan(out[to.T_SLIP]):
        out[to.T_SLIP] = t
    if turns and math.isnan(out[to.T_SLIDE_ROCK]):
        out[to.T_SLIDE_ROCK] = t


@jit_lean
def note_flight(t, turns, out):
    """The body leaves the ground, tilted or turning, or flat."""
    out[to.N_FLIGHTS] += 1
    if math.isnan(out[to.T_FLIGHT]):
        out[to.T_FLIGHT] = t
    if turns and math.isnan(out[to.T_UPLIFT]):
        out[to.T_UPLIFT] = t


def work_space():
    """Work space of `march_all`: series and guards; the flow that is taken in steps of its own."""
    return (*(room(MAX_ORDER + 2) for _ in range(15)), room(4))


@jit_lean
def march(
    par, tol, rest_speed, max_steps, order, horizontal, h_data, vertical, v_data, dt_out,
    histories, impacts_out, events, spaces, out,
):  # fmt: skip
    """Solve one case.

    Motion channels as those of `rigid.march`.  `histories` are theta, theta', slide, slide rate, mode and lift at
    i dt_out as far as they are long, `impacts_out` t, theta' before and after, `events` time and mode entered; the mode
    at t = 0 is no event.
    """
    n = order
    theta_out, rate_out, slide_out = histories[0], histories[1], histories[2]
    slide_rate_out, mode_out, lift_out = histories[3], histories[4], histories[5]
    t_impact, rate_before, rate_after = impacts_out[0], impacts_out[1], impacts_out[2]
    t_event, mode_event = events[0], events[1]
    n_hist, n_store = len(theta_out), len(t_impact)
    g, h_cm, rg2, mu_s, mu_k = par[at.G], par[at.H], par[at.RG2], par[at.MU_S], par[at.MU_K]
    t_motion, t_stop, lasts = par[at.T_MOTION], par[at.T_STOP], par[at.HAS_DURATION] == 1.0
    p_min = min(frequency(par, at.LEFT), frequency(par, at.RIGHT))
    p_max = max(frequency(par, at.LEFT), frequency(par, at.RIGHT))
    alpha_min = min(par[at.LEFT + at.ALPHA], par[at.RIGHT + at.ALPHA])
    R_min = min(par[at.LEFT + at.RADIUS], par[at.RIGHT + at.RADIUS])
    small = tol * alpha_min
    speed = small * p_max * R_min
    for i in range(to.N_OUT):
        out[i] = 0.0
    for i in (to.T_PEAK, to.T_UPLIFT, to.T_OVERTURN, to.T_REST, to.T_SLIP, to.T_SLIDE_ROCK, to.T_FLIGHT):
        out[i] = math.nan
    out[to.N_MIN] = out[to.NEARLY_FLAT] = math.inf
    out[to.VERDICT] = UNDECIDED

    a, W, c, sin_b, cos_b, rate2, N, T, A, numerator, tilt, slip, guard, path, height, found = spaces
    for space in spaces:  # nothing of the case before
        for i in range(len(space)):
            space[i] = 0.0

    t = 0.0
    ih = iv = i_hist = 0
    stalled, launch, contact = 0, 0, 0
    mode = REST
    s, q, v, u, place, sigma = 1.0, abs(par[at.THETA_0]), 0.0, par[at.SLIDE_RATE_0], 0.0, 0.0
    x_rate, z, z_rate, theta, turn, x_0 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    pick = ON_BASE
    if par[at.THETA_0] != 0.0 or par[at.THETA_DOT_0] != 0.0:
        lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
        s = 1.0 if lead > 0.0 else -1.0
        v = s * par[at.THETA_DOT_0]
        out[to.T_UPLIFT] = 0.0
        note_angle(q, s, 0.0, out)
        pick = ON_EDGE
        if q >= par[(at.RIGHT if s > 0.0 else at.LEFT) + at.ALPHA]:
            out[to.T_OVERTURN] = 0.0
    out[to.RATE_PEAK] = abs(v)
    out[to.TOP_PEAK] = par[at.TOP] * math.sin(min(q, 0.5 * math.pi))
    balance = energy_on_edge(par, at.RIGHT if s > 0.0 else at.LEFT, s, q, v, u)
    slipped = jumped = False
    reach = 0.0

    while True:
        # the end
        if t >= t_motion and pick == SETTLED and mode == REST and (not lasts or t >= t_stop):
            out[to.VERDICT] = RETURNS
            break
        if t >= t_stop and pick == SETTLED:
            e = at.RIGHT if s > 0.0 else at.LEFT
            if mode in (REST, SLIDE):
                sure = t >= t_motion
            else:
                barrier = g * min(par[at.LEFT + at.RADIUS], par[at.RIGHT + at.RADIUS]) - g * h_cm
                if mode == FLIGHT:
                    whole, angle = energy_in_flight(par, x_rate, z, z_rate, turn), abs(theta)
                else:
                    whole, angle = energy_on_edge(par, e, s, q, v, u), q
                sure = t >= t_motion and angle < alpha_min and whole < barrier
            if t >= t_stop + PATIENCE / p_min:
                out[to.VERDICT] = RETURNS if sure else UNDECIDED
                break
        if out[to.N_STEPS] >= max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break
        out[to.N_STEPS] += 1

        # the piece of the motion we are in, and its end
        t_next = t_stop if t < t_stop else t_stop + PATIENCE / p_min
        deg_a = deg_v = 0
        a[0] = W[0] = 0.0
        if t < t_motion:
            t_next = min(t_next, t_motion)
            ih, iv = piece_at(horizontal, h_data, ih, t), piece_at(vertical, v_data, iv, t)
            if ih < horizontal.pieces:
                t_next = min(t_next, piece_end(horizontal, h_data, ih))
                deg_a = expand(horizontal, h_data, par[at.FACTOR_H], ih, t, n, a)
            if iv < vertical.pieces:
                t_next = min(t_next, piece_end(vertical, v_data, iv))
                deg_v = expand(vertical, v_data, par[at.FACTOR_V], iv, t, n, W)
        for k in range(deg_a + 1, n + 1):
            a[k] = 0.0
        for k in range(deg_v + 1, n + 1):
            W[k] = 0.0
        W[0] += g
        h = t_next - t
        fine = tol if mode in (ROCK, SLIDE_ROCK) else min(tol, EXACT)
        if deg_a > 1:
            h = within(a, n - 2, n, fine * g * min(max(mu_s, 0.01), math.tan(alpha_min)), h)
        if deg_v > 1:
            h = within(W, n - 2, n, fine * g, h)

        # the mode, with the ground motion from now on
        if pick != SETTLED:
            first = t == 0.0 and out[to.N_STEPS] == 1
            if pick == ON_BASE:
                q = v = 0.0
                new, s, sigma = on_base(par, u, a[0], W[0])
            else:
                new, sigma = on_edge(par, s, q, v, u, a[0], W[0])
            e = at.RIGHT if s > 0.0 else at.LEFT
            if new == JAM:
                before = energy_on_edge(par, e, s, q, v, u)
                v = s * impacts.jam(par, e, q, s * v, u)
                u = 0.0
                out[to.N_JAMS] += 1
                change = energy_on_edge(par, e, s, q, v, u) - before
                balance += change
                out[to.GAIN] = max(out[to.GAIN], change)
                if q == 0.0 and v < 0.0:
                    v = 0.0
                new, sigma = on_edge(par, s, q, v, u, a[0], W[0])
            if new == NEITHER:
                out[to.TWO_WAYS] += 1
                new = FLIGHT
            if new == FLIGHT:
                if pick == ON_BASE:
                    theta = turn = 0.0
                    x_rate, z, z_rate, x_0, contact = u, h_cm, 0.0, place, 3
                else:
                    beta = par[e + at.ALPHA] - q
                    z, z_rate = par[e + at.RADIUS] * math.cos(beta), par[e + at.RADIUS] * math.sin(beta) * v
                    x_rate = u + s * z * v
                    x_0 = place + s * par[e + at.B] - s * par[e + at.RADIUS] * math.sin(beta)
                    theta, turn, contact = s * q, s * v, (1 if e == at.LEFT else 2)
                launch = 3
            elif new in (SLIDE, SLIDE_ROCK):
                launch = 1 if u == 0.0 else 0
            else:
                launch = 0
            unchanged = jumped and new == mode  # only rounding made a guard of it
            mode, pick, jumped = new, SETTLED, False
            if not first and not unchanged:
                note_event(t, mode, t_event, mode_event, out)
            if (mode in (ROCK, SLIDE_ROCK)) and math.isnan(out[to.T_UPLIFT]):
                out[to.T_UPLIFT] = t
            if mode == FLIGHT:
                note_flight(t, theta != 0.0 or turn != 0.0, out)
            if mode in (SLIDE, SLIDE_ROCK):
                note_slip(t, mode == SLIDE_ROCK, slipped, out)
            slipped = mode in (SLIDE, SLIDE_ROCK)
            if mode == REST and not unchanged:
                out[to.T_REST] = t
            continue  # expanded again, as the step may begin with this mode's own guards

        e, other = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
        R, alpha = par[e + at.RADIUS], par[e + at.ALPHA]
        d = max(deg_a, deg_v, 1)  # of the motion
        m, ns = n, n  # orders of q and of `slip`
        looks = 1 if d == 1 and t < t_motion else LOOKS
        event, x, way = 0, NO_ROOT, 0.0
        if stalled > 100:
            h = min(h, max(1e-12 * (t_next - t), 4e-16 * t))

        # flow and guards
        if mode == REST:
            for side in range(4):
                sign = 1.0 if side % 2 == 1 else -1.0
                edge = at.RIGHT if side % 2 == 1 else at.LEFT
                hold = mu_s if side < 2 else par[edge + at.B] / h_cm
                if side >= 2 and mu_s <= hold * SAME:
                    continue  # it slides before it tips
                for k in range(d + 1):
                    guard[k] = hold * W[k] + sign * a[k]
                root = leaves(guard, d, h, g * hold)
                if root != NO_ROOT and (event == 0 or root < x):
                    event, x, way = (SLIPS if side < 2 else LIFTS), root, sign
            for k in range(d + 1):
                guard[k] = W[k]
            root = leaves(guard, d, h, g)
            if root != NO_ROOT and (event == 0 or root < x):
                event, x = LEAVES, root
        elif mode == SLIDE:
            ns = d + 1
            flows.slide(mu_k, sigma, u, a, W, ns, slip)
            for k in range(ns + 1):
                guard[k] = sigma * slip[k]
            x = starts(guard, ns, h, 0 if u != 0.0 else 1 + launch)
            event = 0 if x == NO_ROOT else STOPS
            for k in range(d + 1):
                guard[k] = W[k]
            root = leaves(guard, d, h, g)
            if root != NO_ROOT and (event == 0 or root < x):
                event, x = LEAVES, root
        elif mode == FLIGHT:
            flows.fly(x_rate, z, z_rate, a, W, n, slip, height)
            if turn != 0.0:
                h = min(h, 1.0 / abs(turn))
            for side in range(2):
                sign, edge = (1.0, at.RIGHT) if side == 1 else (-1.0, at.LEFT)
                flows.turning(-sign * par[edge + at.B], -h_cm, theta, turn, n, guard)
                h = within(guard, n - 1, n, small * R_min, h)
            for side in range(2):
                sign, edge = (1.0, at.RIGHT) if side == 1 else (-1.0, at.LEFT)
                flows.turning(-sign * par[edge + at.B], -h_cm, theta, turn, n, guard)
                for k in range(n + 1):
                    guard[k] += height[k]
                touched = (contact == 3) or (contact == 1 + side)
                handled = launch if touched else 0
                if handled == 0 and guard[0] <= 0.0:
                    guard[0] = 0.0
                root = starts(guard, n, h, handled)
                if root != NO_ROOT and (event == 0 or root < x):
                    event, x, way = STRIKES, root, sign
            if turn != 0.0:
                root = (0.5 * math.pi - math.copysign(1.0, turn) * theta) / abs(turn)
                if root <= h and (event == 0 or root < x):
                    event, x = TOPPLES, max(root, 0.0)
        else:
            h = min(h, 1.0 / p_max)
            foot = flows.Foot(e, s, sigma, q, v, u)
            if mode == ROCK:
                m = flows.rock(par, foot, a, W, h, small, n, c, sin_b, cos_b, rate2, N, T)
            else:
                m = flows.slide_rock(par, foot, a, W, h, small, n, c, sin_b, cos_b, rate2, N, A, numerator, tilt, slip)
                ns = m - 1
                h = within(slip, m - 3, m - 1, speed, h)
            h = within(c, m - 2, m, small, h)
            if not h > 0.0 or math.isnan(c[m]):
                out[to.STATUS] = NOT_FINITE
                break
            for k in range(m + 1):
                guard[k] = c[k]
            handled = 0
            if q == 0.0:
                handled = 1 if v > 0.0 else 3
                if v == 0.0 and guard[2] != 0.0:
                    handled = 2 if guard[2] > 1e-13 * p_max * p_max else 3
            x = starts(guard, m, h, handled)
            event = 0 if x == NO_ROOT else LANDS
            if mode == ROCK:
                for side in range(2):
                    sign = 1.0 if side == 1 else -1.0
                    for k in range(m - 1):
                        guard[k] = mu_s * N[k] + sign * T[k]
                    root = leaves(guard, m - 2, h, max(mu_s, 1e-3) * g)
                    if root != NO_ROOT and (event == 0 or root < x):
                        event, x, way = SLIPS, root, sign
                for k in range(m - 1):
                    guard[k] = N[k]
            else:
                for k in range(m):
                    guard[k] = sigma * slip[k]
                root = starts(guard, m - 1, h, 0 if u != 0.0 else 1 + launch)
                if root != NO_ROOT and (event == 0 or root < x):
                    event, x = STOPS, root
                if mu_k * R * R / rg2 > math.sqrt(1.0 + R * R / rg2):  # (K7), half of it, to be safe
                    for k in range(m - 1):
                        guard[k] = A[k]
                    root = leaves(guard, m - 2, h, 1.0)
                    if root != NO_ROOT and (event == 0 or root < x):
                        event, x = JAMS, root
                for k in range(m - 1):
                    guard[k] = numerator[k]
            root = leaves(guard, m - 2, h, g)
            if root != NO_ROOT and (event == 0 or root < x):
                event, x = LEAVES, root
            reach = 0.0
            for k in range(m, -1, -1):
                reach = reach * (h if event == 0 else x) + abs(c[k])
            if reach >= 0.5 * math.pi:
                for k in range(m + 1):
                    guard[k] = -c[k]
                guard[0] = 0.5 * math.pi - q
                root = 0.0 if guard[0] <= 0.0 else first_root(guard, m, h, 0)
                if root != NO_ROOT and (event == 0 or root < x):
                    event, x = TOPPLES, root
        if stalled > 100:
            event, x, stalled = 0, h, 0
        if event == 0:
            x = h

        # what happened on the way
        t_new = t_next if x == t_next - t else t + x
        counted = t < t_stop or not lasts
        if mode in (ROCK, SLIDE_ROCK):
            if counted:
                extremes(c, m, x, looks, found)
                note_angle(found[0], s, t + found[1], out)
                for k in range(m):
                    guard[k] = (k + 1) * c[k + 1]
                extremes(guard, m - 1, x, looks, found)
                out[to.RATE_PEAK] = max(out[to.RATE_PEAK], abs(found[0]), abs(found[2]))
                extremes(N, m - 2, x, looks, found)
                out[to.N_MIN] = min(out[to.N_MIN], found[2] / g)
            if value(c, m, x) >= alpha or reach >= alpha:
                passed = last_passage(c, m, alpha, x, LOOKS)
                if passed != NO_ROOT:
                    out[to.T_OVERTURN] = t + passed
            if counted:  # the top: slide + top sin(theta)
                for k in range(m):
                    guard[k] = s * par[at.TOP] * (math.sin(alpha) * cos_b[k] - math.cos(alpha) * sin_b[k])
                    if mode == SLIDE_ROCK and k > 0:
                        guard[k] += slip[k - 1] / k
                guard[0] += place
                extremes(guard, m - 1, x, looks, found)
                out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(found[0]), abs(found[2]))
        elif mode == FLIGHT:
            out[to.N_MIN] = min(out[to.N_MIN], 0.0)
            end = abs(theta + turn * x)
            tilted = 1.0 if theta + turn * x > 0.0 else -1.0
            limit = par[(at.RIGHT if tilted > 0.0 else at.LEFT) + at.ALPHA]
            if end >= limit and tilted * theta < limit:
                out[to.T_OVERTURN] = t + (limit - tilted * theta) / abs(turn)
            if counted:
                note_angle(end, tilted, t + x, out)
                out[to.RATE_PEAK] = max(out[to.RATE_PEAK], abs(turn))
                for part in range(2):  # the slide of the lower edge, then the top
                    up = -h_cm if part == 0 else par[at.TOP] - h_cm
                    lower = 1.0 if theta + 0.5 * turn * x >= 0.0 else -1.0
                    b = lower * par[(at.RIGHT if lower > 0.0 else at.LEFT) + at.B]
                    flows.turning(up, b, theta, turn, n, path)
                    path[0] += x_0 - b
                    for k in range(1, n + 1):
                        path[k] += slip[k - 1] / k
                    extremes(path, n, x, LOOKS, found)
                    if part == 0:
                        note_slide(found[0], out)
                        note_slide(found[2], out)
                    else:
                        out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(found[0]), abs(found[2]))
        elif counted:
            extremes(W, d, x, looks, found)
            out[to.N_MIN] = min(out[to.N_MIN], found[2] / g)
        balance += work(par, mode, e, s, sigma, c, m, slip, ns, height, n, x, a, W, d)

        while i_hist < n_hist and i_hist * dt_out <= t_new:
            y = i_hist * dt_out - t
            mode_out[i_hist] = mode
            theta_out[i_hist] = rate_out[i_hist] = slide_rate_out[i_hist] = lift_out[i_hist] = 0.0
            slide_out[i_hist] = place
            if mode in (ROCK, SLIDE_ROCK):
                theta_out[i_hist], rate_out[i_hist] = s * max(value(c, m, y), 0.0), s * slope(c, m, y)
            if mode in (SLIDE, SLIDE_ROCK):
                slide_out[i_hist] = place + integral(slip, ns, y)
                slide_rate_out[i_hist] = value(slip, ns, y)
            if mode == FLIGHT:
                angle = theta + turn * y
                sin_t, cos_t = math.sin(angle), math.cos(angle)
                lower = 1.0 if angle > 0.0 else -1.0
                b = lower * par[(at.RIGHT if lower > 0.0 else at.LEFT) + at.B]
                theta_out[i_hist], rate_out[i_hist] = angle, turn
                slide_out[i_hist] = x_0 + integral(slip, n, y) + b * cos_t - h_cm * sin_t - b
                slide_rate_out[i_hist] = value(slip, n, y) - turn * (b * sin_t + h_cm * cos_t)
                lift_out[i_hist] = max(value(height, n, y) - b * sin_t - h_cm * cos_t, 0.0)
            i_hist += 1

        # the state at its end
        if mode in (SLIDE, SLIDE_ROCK):
            place += integral(slip, ns, x)
            u = 0.0 if event == STOPS else value(slip, ns, x)
            if counted:
                note_slide(place, out)
                if mode == SLIDE:
                    out[to.TOP_PEAK] = max(out[to.TOP_PEAK], abs(place))
        if mode in (ROCK, SLIDE_ROCK):
            q, v = (0.0 if event == LANDS else value(c, m, x)), slope(c, m, x)
            if event == LANDS:
                v = min(v, 0.0)
        if mode == FLIGHT:
            x_0 += integral(slip, n, x)
            x_rate, z, z_rate = value(slip, n, x), value(height, n, x), slope(height, n, x)
            theta += turn * x
            if x > 0.0:
                contact = 0
        stalled = stalled + 1 if t_new == t else 0
        t_was, t = t, t_new
        if event == 0:
            if x > 0.0:
                launch = 0
            continue

        # the event
        if event == TOPPLES:
            out[to.VERDICT] = FALLS
            out[to.PEAK_SIDE] = s if mode != FLIGHT else math.copysign(1.0, theta)
            break
        if event == STRIKES:
            before = energy_in_flight(par, x_rate, z, z_rate, turn)
            out[to.NEARLY_FLAT] = min(out[to.NEARLY_FLAT], abs(theta) / alpha_min)
            if theta == 0.0 and turn == 0.0 and par[at.FIRST] == 0.0:
                hit = abs(z_rate)
                old = turn
                turn, x_rate, z_rate = impacts.flat(par, x_rate, z_rate)
                after = energy_in_flight(par, x_rate, z, z_rate, turn)
                place = x_0
                if turn == 0.0:
                    if z_rate > DOWN:
                        contact, launch, z = 3, 1, h_cm
                        pick = SETTLED
                    else:
                        z_rate, u, pick = 0.0, x_rate, ON_BASE
                else:
                    s = 1.0 if turn > 0.0 else -1.0
                    if math.isnan(out[to.T_UPLIFT]):
                        out[to.T_UPLIFT] = t
                    e = at.RIGHT if s > 0.0 else at.LEFT
                    lifts = z_rate - s * par[e + at.B] * turn
                    if lifts > DOWN:
                        contact, launch = (2 if s > 0.0 else 1), 1
                    else:
                        q, v, u, pick = 0.0, s * turn, x_rate - h_cm * turn, ON_EDGE
            else:
                edge = at.RIGHT if way > 0.0 else at.LEFT
                if par[at.FIRST] != 0.0 and abs(theta) < ILL_POSED * par[edge + at.ALPHA]:
                    way, theta, z = par[at.FIRST], 0.0, h_cm
                    edge = at.RIGHT if way > 0.0 else at.LEFT
                sin_t, cos_t = math.sin(theta), math.cos(theta)
                b = way * par[edge + at.B]
                cc, dd = b * cos_t - h_cm * sin_t, -b * sin_t - h_cm * cos_t
                old = turn
                along, across = x_rate + dd * turn, z_rate - cc * turn
                hit = abs(across)
                turn, along, across = impacts.corner(par, cc, dd, turn, along, min(across, 0.0))
                x_rate, z_rate = along - dd * turn, across + cc * turn
                after = energy_in_flight(par, x_rate, z, z_rate, turn)
                if across > DOWN:
                    contact, launch = (2 if way > 0.0 else 1), 1
                    z = -dd
                else:
                    s, q = way, max(way * theta, 0.0)
                    v, u, pick = s * turn, along, ON_EDGE
                    place = x_0 + cc - b
            balance += after - before
            out[to.GAIN] = max(out[to.GAIN], after - before)
            if hit > FAST * p_min * alpha_min * R_min and (t <= t_stop or not lasts):
                out[to.N_IMPACTS] += 1
                k = int(out[to.IMPACTS_STORED])
                if k < n_store:
                    t_impact[k], rate_before[k], rate_after[k] = t, old, turn
                    out[to.IMPACTS_STORED] += 1
            if pick == SETTLED:  # it bounces
                note_event(t, FLIGHT, t_event, mode_event, out)
                continue
            if not (pick == ON_EDGE and q == 0.0 and v < 0.0):
                continue
            event, mode = LANDS, ROCK  # the other edge at once
            e, other = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
        if event == LANDS:
            before = energy_on_edge(par, e, s, 0.0, v, u)
            if v == 0.0:
                pick = ON_BASE
                continue
            w, slid, _ = impacts.landing(par, e, other, -v, -s * u)
            hit = -v
            s, u = -s, -s * slid
            e, other = other, e
            change = energy_on_edge(par, e, s, 0.0, w, u) - before
            balance += change
            out[to.GAIN] = max(out[to.GAIN], change)
            carried = (hit / (p_min * alpha_min)) ** 2 - MEANINGFUL**2
            if carried > 0.0:
                out[to.SWINGS] += carried
                out[to.SWINGS_T] += carried * t
            if hit > FAST * p_min * alpha_min and (t <= t_stop or not lasts):
                out[to.N_IMPACTS] += 1
                k = int(out[to.IMPACTS_STORED])
                if k < n_store:
                    t_impact[k], rate_before[k], rate_after[k] = t, s * hit, s * w
                    out[to.IMPACTS_STORED] += 1
            q, v = 0.0, w
            if stalled > 100:
                v = 0.0
            pick = ON_EDGE if v > 0.0 else ON_BASE
            if v > 0.0:
                wait, slid = settles(par, s, v, u, a, W, d, t - t_was, t_next - t, rest_speed)
                if wait >= 0.0:
                    balance -= energy_on_edge(par, e, s, 0.0, v, u) - 0.5 * slid * slid
                    between = 0.5 * (u + slid) * wait
                    while i_hist < n_hist and i_hist * dt_out <= t + wait:
                        theta_out[i_hist] = rate_out[i_hist] = lift_out[i_hist] = 0.0
                        slide_out[i_hist] = place + u * (i_hist * dt_out - t)
                        slide_rate_out[i_hist], mode_out[i_hist] = u, (ROCK if u == 0.0 else SLIDE_ROCK)
                        i_hist += 1
                    t += wait
                    place += between
                    note_slide(place, out)
                    u, v, pick = slid, 0.0, ON_BASE
            continue
        if event == STOPS:
            u = 0.0
            pick = ON_BASE if mode == SLIDE else ON_EDGE
            continue
        if event == JAMS or x == 0.0:  # also a jump of the ground: what holds is told by complementarity
            pick = ON_BASE if mode in (REST, SLIDE) else ON_EDGE
            jumped = event != JAMS
            if event == JAMS or stalled <= 3:
                continue
        pick, jumped = SETTLED, False
        if event == SLIPS:
            sigma, u, launch = way, 0.0, (1 if mu_s == mu_k else 0)
            if mode == ROCK and stiffness(par, e, alpha - q, mu_k * s * sigma) <= 0.0:
                event = LEAVES  # as it gives way it leaves, as W < R cos(beta) q'^2: no slip is consistent
            mode = SLIDE if mode == REST else SLIDE_ROCK
            note_slip(t, mode == SLIDE_ROCK, False, out)
            slipped = True
            note_event(t, mode, t_event, mode_event, out)
        if event == LEAVES:
            launch, slipped = 3, False
            if mode in (REST, SLIDE):
                theta = turn = 0.0
                x_rate, z, z_rate, x_0, contact = u, h_cm, 0.0, place, 3
            else:
                beta = alpha - q
                z, z_rate = R * math.cos(beta), R * math.sin(beta) * v
                x_rate = u + s * z * v
                x_0 = place + s * par[e + at.B] - s * R * math.sin(beta)
                theta, turn, contact = s * q, s * v, (1 if e == at.LEFT else 2)
            mode = FLIGHT
            note_flight(t, theta != 0.0 or turn != 0.0, out)
            note_event(t, mode, t_event, mode_event, out)
        elif event == LIFTS:
            s, q, v, u, mode, launch = way, 0.0, 0.0, 0.0, ROCK, 0
            if math.isnan(out[to.T_UPLIFT]):
                out[to.T_UPLIFT] = t
            note_event(t, mode, t_event, mode_event, out)

    out[to.T_END] = t_stop if lasts else min(t, t_stop)
    if out[to.STATUS] != DONE:
        out[to.VERDICT] = UNDECIDED
    e = at.RIGHT if s > 0.0 else at.LEFT
    if mode == FLIGHT:
        last = energy_in_flight(par, x_rate, z, z_rate, turn)
        b = math.copysign(par[(at.RIGHT if theta > 0.0 else at.LEFT) + at.B], theta)
        place = x_0 + b * math.cos(theta) - h_cm * math.sin(theta) - b
    else:
        last = energy_on_edge(par, e, s, q, v, u) if mode != REST else 0.0
    out[to.BALANCE] = balance - last
    out[to.SLIDE_END] = place
    while i_hist < n_hist and i_hist * dt_out <= out[to.T_END] and mode == REST:
        theta_out[i_hist] = rate_out[i_hist] = slide_rate_out[i_hist] = lift_out[i_hist] = mode_out[i_hist] = 0.0
        slide_out[i_hist] = place
        i_hist += 1


@entry(
    MATRIX, float, float, int, int, Channel, MATRIX, Channel, MATRIX, float, CUBE, CUBE, CUBE, (VECTOR,) * 16, MATRIX,
)  # fmt: skip
def march_all(
    pars, tol, rest_speed, max_steps, order, horizontal, h_data, vertical, v_data, dt_out,
    histories, impacts_out, events, spaces, out,
):  # fmt: skip
    """`march` for every row of `pars`; histories, impacts, events, results and tables of pulses row by row too.

    spaces: `work_space()`.
    """
    for i in range(len(pars)):
        ih, iv = (i if horizontal.kind == PULSES else 0), (i if vertical.kind == PULSES else 0)
        march(
            pars[i], tol, rest_speed, max_steps, order, horizontal, h_data[ih], vertical, v_data[iv],
            dt_out, histories[i], impacts_out[i], events[i], spaces, out[i],
        )  # fmt: skip
