"""The rocking body as a hybrid automaton: flow, guard, reset, mode.

Modes: REST (nothing moves until the guard `|a_g| > (g + a_v) tan(alpha)` opens) and ROCK (q = |theta| flows,
until the guard q = 0 closes and the reset turns the body over to its other edge).  Steps land on the
breakpoints of the motion; after an event no coefficient is reused.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import (
    DONE,
    FALLS,
    FAST,
    MAX_ORDER,
    MEANINGFUL,
    NO_ROOT,
    NOT_FINITE,
    NOT_YET,
    OUT_OF_STEPS,
    PATIENCE,
    RETURNS,
    UNDECIDED,
)
from rockcli.kernels.jit import jit, zeros_maker
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import watch_rest, watch_rocking
from rockcli.kernels.rigid.free_outcome import free_rocking, lost_for_good, separatrix
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, bound_from, expand, piece_end
from rockcli.kernels.rigid.readings import energy, raise_peak, set_peak, work_done
from rockcli.kernels.rigid.rest import rest_time
from rockcli.kernels.rigid.roots import first_root, last_passage, passage, uplift
from rockcli.kernels.rigid.series import flow, slope, value

zeros = zeros_maker()

REST, ROCK = 0, 1

OUTCOME, PEAKS, ALL = 0, 1, 2
"""How much is wanted: the outcome; peaks and times too; forces, rates and the energy balance too."""


@jit
def march(
    par, linear, tol, rest_speed, margin, max_steps, order, detail,
    hk, h_values, h_tail, h_dt, h_table, h_n, vk, v_values, v_tail, v_dt, v_table, v_n,
    dt_out, theta_out, rate_out, t_impact, rate_before, rate_after, out,
):  # fmt: skip
    """Solve one case.

    Motion channels (h horizontal, v vertical): kind, values, running bound, dt, pulse table, number of pieces.
    Histories at i dt_out go to theta_out, rate_out as far as they are long; impacts likewise.
    """
    n_hist, n_store = len(theta_out), len(t_impact)
    g = par[at.G]
    t_motion, t_stop = par[at.T_MOTION], par[at.T_STOP]
    p_min = math.sqrt(min(par[at.LEFT + at.P2], par[at.RIGHT + at.P2]))
    two_sided = par[at.LEFT + at.ALPHA] != par[at.RIGHT + at.ALPHA]
    for i in range(to.N_OUT):
        out[i] = 0.0
    out[to.T_PEAK] = out[to.T_UPLIFT] = out[to.T_OVERTURN] = math.nan
    out[to.N_MIN] = out[to.N_STANDING] = math.inf
    out[to.PEAK_ALPHA] = 1.0

    c, sin_q, cos_q = zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1)
    a, a_v, guard, force = zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1), zeros(MAX_ORDER + 1), zeros(6)

    t = 0.0
    ih = iv = i_hist = 0
    verdict = NOT_YET
    work = lost = 0.0
    stalled = 0
    launch = False
    mode = REST
    q, v, s = abs(par[at.THETA_0]), 0.0, 1.0
    if par[at.THETA_0] != 0.0 or par[at.THETA_DOT_0] != 0.0:
        mode = ROCK
        lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
        s = 1.0 if lead > 0.0 else -1.0
        v = s * par[at.THETA_DOT_0]
        out[to.T_UPLIFT] = 0.0
        e0 = at.RIGHT if s > 0.0 else at.LEFT
        out[to.PEAK_SIDE] = s
        if q >= par[e0 + at.Q_STAR]:
            out[to.T_OVERTURN] = 0.0
        if v <= 0.0:
            set_peak(par, e0, s, q, 0.0, out)
        out[to.RATE_PEAK] = abs(v)
        work = energy(par, e0, q, v, linear)

    while True:
        e, other = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
        if t >= t_motion and verdict == NOT_YET:
            verdict = RETURNS
            if mode == ROCK:
                verdict = free_rocking(par, e, other, q, v, linear, margin * par[e + at.ALPHA])
            if detail == OUTCOME and verdict != NOT_YET:
                if verdict == FALLS and separatrix(par, e, q, v, linear) < 0.0:  # an impact comes first
                    out[to.N_IMPACTS] += 1
                break
        if t >= t_stop and verdict == NOT_YET:  # beyond the report, until the damper has had its way
            if t >= t_stop + PATIENCE / p_min:
                verdict = UNDECIDED
                break
        elif t >= t_stop or (t >= t_motion and mode == REST and par[at.HAS_DURATION] == 0.0):
            break
        if out[to.N_STEPS] >= max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break

        # the piece we are in, and its end
        t_next = t_stop if t < t_stop else t_stop + PATIENCE / p_min
        deg_a = deg_v = 0
        a[0] = a_v[0] = 0.0
        a[1] = a_v[1] = 0.0
        if t < t_motion:
            t_next = t_motion
            if hk != NOTHING:
                while ih < h_n and piece_end(hk, h_table, h_dt, ih) <= t:
                    ih += 1
                if ih < h_n:
                    t_next = min(t_next, piece_end(hk, h_table, h_dt, ih))
                    if mode == REST and vk == NOTHING and n_hist == 0 and detail < ALL:
                        # nothing moves, and nobody asks what the ground does meanwhile
                        quiet = g * min(par[at.LEFT + at.THRESHOLD], par[at.RIGHT + at.THRESHOLD])
                        if bound_from(hk, h_table, h_tail, par[at.FACTOR_H], ih) <= quiet:
                            t = t_motion
                            continue
                    deg_a = expand(hk, h_values, h_dt, par[at.FACTOR_H], h_table, ih, t, order, a)
            if vk != NOTHING:
                while iv < v_n and piece_end(vk, v_table, v_dt, iv) <= t:
                    iv += 1
                if iv < v_n:
                    t_next = min(t_next, piece_end(vk, v_table, v_dt, iv))
                    deg_v = expand(vk, v_values, v_dt, par[at.FACTOR_V], v_table, iv, t, order, a_v)
        h = t_next - t
        out[to.N_STEPS] += 1

        if mode == REST:
            deg = max(deg_a, deg_v)
            if deg > 1:  # keep to where the series of the motion has converged
                for k in range(deg - 1, deg + 1):
                    big = max(abs(a[k]) if k <= deg_a else 0.0, abs(a_v[k]) if k <= deg_v else 0.0)
                    if big > 0.0:
                        h = min(h, (1e-17 * g * par[at.LEFT + at.THRESHOLD] / big) ** (1.0 / k))
            x, s_up = NO_ROOT, 0.0
            for side in range(2):
                edge, sign = (at.RIGHT, 1.0) if side == 1 else (at.LEFT, -1.0)
                for k in range(deg + 1):
                    guard[k] = 0.0
                    if k <= deg_v:
                        guard[k] = par[edge + at.THRESHOLD] * (a_v[k] + g if k == 0 else a_v[k])
                    elif k == 0:
                        guard[k] = par[edge + at.THRESHOLD] * g
                    if k <= deg_a:
                        guard[k] += sign * a[k]
                root = uplift(guard, deg, h, g * par[edge + at.THRESHOLD])
                if root != NO_ROOT and (x == NO_ROOT or root < x):
                    x, s_up = root, sign
            moved = x if x != NO_ROOT else h
            if detail == ALL and moved > 0.0:  # at a jump of the ground that it answers at once it is not at rest
                watch_rest(a, deg_a, a_v, deg_v, g, moved, out)
            t_new = t_next if (x == NO_ROOT and h == t_next - t) else t + moved
            if stalled > 100:  # lifted and dropped again and again at one instant
                x, t_new, stalled = NO_ROOT, min(t_next, t + max(1e-12 * (t_next - t), 4e-16 * t)), 0
            while i_hist < n_hist and i_hist * dt_out <= t_new:
                theta_out[i_hist] = 0.0
                rate_out[i_hist] = 0.0
                i_hist += 1
            if x != NO_ROOT:
                stalled = stalled + 1 if t_new == t else 0
                mode, launch = ROCK, True
                q = v = 0.0
                s = s_up
                if math.isnan(out[to.T_UPLIFT]):
                    out[to.T_UPLIFT] = t_new
            t = t_new
            continue

        h = min(h, 2.0 / p_min)
        n, h = flow(par, e, g, q, v, s, a, deg_a, a_v, deg_v, launch, linear, h, tol, order, c, sin_q, cos_q)
        if not h > 0.0 or math.isnan(c[n]):
            out[to.STATUS] = NOT_FINITE
            break
        skip = 0
        if q == 0.0:
            skip = 1
            while skip < min(n, 4) and c[skip] == 0.0:
                skip += 1
            if c[skip] <= 0.0:  # would enter the ground at once: not an uplift
                mode, launch = REST, False
                stalled += 1
                continue
        launch = False

        # guards
        x = first_root(c, n, h, skip)
        event = 1 if x != NO_ROOT else 0
        if event == 0:
            x = h
        reach = 0.0
        for k in range(n, -1, -1):
            reach = reach * x + abs(c[k])
        if reach >= 0.5 * math.pi and par[e + at.Q_STAR] < math.inf:
            for k in range(n + 1):
                guard[k] = -c[k]
            guard[0] = 0.5 * math.pi - q
            if guard[0] > 0.0:
                over = first_root(guard, n, x, 0)
                if over != NO_ROOT and not linear:
                    event, x = 2, over
            if linear and value(c, n, x) >= 0.5 * math.pi:
                gone = lost_for_good(
                    par, e, g, value(c, n, x), slope(c, n, x), t >= t_motion,
                    hk, h_table, h_tail, ih, h_n, vk, v_table, v_tail, iv, v_n,
                )  # fmt: skip
                if gone:
                    event = 2
                    if guard[0] > 0.0:
                        x = passage(c, n, 0.5 * math.pi, 0.0, x)

        # what happened on the way
        reported = t < t_stop
        parts = 1 if (hk == SAMPLES and t < t_motion) else 8
        top = out[to.PEAK]
        if two_sided:
            top = out[to.PEAK_RIGHT] if s > 0.0 else out[to.PEAK_LEFT]
        if detail > OUTCOME and reach > top:
            raise_peak(par, e, s, c, n, x, t, parts, out)
        star = par[e + at.Q_STAR]
        if reach >= star:
            passed = last_passage(c, n, star, x, parts)
            if passed != NO_ROOT:
                out[to.T_OVERTURN] = t + passed
                if detail == ALL and reported:
                    watch_rocking(par, e, s, g, c, n, passed, a, deg_a, a_v, deg_v, parts, force, out)
                    out[to.MU_STANDING], out[to.N_STANDING] = out[to.MU], out[to.N_MIN]
        if detail == ALL:
            if reported:
                watch_rocking(par, e, s, g, c, n, x, a, deg_a, a_v, deg_v, parts, force, out)
            work += work_done(par, e, s, g, c, n, x, a, deg_a, a_v, deg_v, sin_q, cos_q, guard)
        q_new, v_new = (0.0 if event == 1 else value(c, n, x)), slope(c, n, x)
        t_new = t_next if (event == 0 and x == t_next - t) else t + x
        while i_hist < n_hist and i_hist * dt_out <= t_new:
            y = i_hist * dt_out - t
            theta_out[i_hist] = s * max(value(c, n, y), 0.0)
            rate_out[i_hist] = s * slope(c, n, y)
            i_hist += 1
        stalled = stalled + 1 if t_new == t else 0
        t, q, v = t_new, q_new, v_new

        if event == 2:
            out[to.FELL] = 1.0
            break
        if event == 1:
            # reset: the body turns over to its other edge
            rate = s * min(v, 0.0)
            p = math.sqrt(par[e + at.P2])
            eta = par[other + at.ETA]
            onto = other
            carried = (rate / (p * par[e + at.ALPHA])) ** 2 - MEANINGFUL**2
            if carried > 0.0:
                out[to.SWINGS] += carried
                out[to.SWINGS_T] += carried * t
            if abs(rate) > FAST * p * par[e + at.ALPHA] and reported:
                out[to.N_IMPACTS] += 1
                out[to.ONTO_RIGHT if onto == at.RIGHT else to.ONTO_LEFT] += 1
                k = int(out[to.IMPACTS_STORED])
                if k < n_store:
                    t_impact[k], rate_before[k], rate_after[k] = t, rate, eta * rate
                    out[to.IMPACTS_STORED] += 1
            before = energy(par, e, 0.0, v, linear)
            v = eta * abs(rate)
            s = -s
            e, other = other, e
            lost += before - energy(par, e, 0.0, v, linear)
            if stalled > 100:
                v = 0.0
            rest_at = rest_time(par, e, other, s, g, v, a, deg_a, a_v, deg_v, x, t, t_next, rest_speed)
            if rest_at >= 0.0:
                lost += energy(par, e, 0.0, v, linear)
                mode = REST
                q = v = 0.0
                while i_hist < n_hist and i_hist * dt_out <= rest_at:
                    theta_out[i_hist] = 0.0
                    rate_out[i_hist] = 0.0
                    i_hist += 1
                t = rest_at
            elif v == 0.0:
                mode = REST

    out[to.T_END] = t_stop if par[at.HAS_DURATION] == 1.0 else min(t, t_stop)
    if out[to.FELL] == 1.0:
        verdict = FALLS
    if verdict == FALLS:
        out[to.PEAK_SIDE] = s
    out[to.FELL] = verdict if out[to.STATUS] == DONE else UNDECIDED
    if mode == ROCK and v > 0.0 and detail > OUTCOME and (par[at.HAS_DURATION] == 1.0 or verdict != RETURNS):
        set_peak(par, e, s, q, t, out)  # cut off while rising
    rest_energy = energy(par, e, q, v, linear) if mode == ROCK else 0.0
    out[to.ENERGY] = work - lost - rest_energy
    if (
        out[to.STATUS] == DONE
        and mode == ROCK
        and detail > OUTCOME
        and (par[at.HAS_DURATION] == 0.0 or verdict == FALLS)
    ):
        afterwards(par, e, s, g, q, v, t, verdict, linear, tol, order, c, sin_q, cos_q, a, a_v, out)


@jit
def afterwards(par, e, s, g, q, v, t, verdict, linear, tol, order, c, sin_q, cos_q, a, a_v, out):
    """Beyond the report: the swing under way still has its peak, or its last passage of the equilibrium."""
    a[0] = a_v[0] = 0.0
    star = par[e + at.Q_STAR]
    p = math.sqrt(par[e + at.P2])
    for _ in range(400):
        if v <= 0.0 or verdict == UNDECIDED or (verdict == FALLS and q >= star):
            return
        n, h = flow(par, e, g, q, v, s, a, 0, a_v, 0, False, linear, 2.0 / p, tol, order, c, sin_q, cos_q)
        q_new, v_new = value(c, n, h), slope(c, n, h)
        if verdict == FALLS and q < star <= q_new:
            out[to.T_OVERTURN] = t + passage(c, n, star, 0.0, h)
        if verdict == RETURNS and v_new <= 0.0:
            raise_peak(par, e, s, c, n, h, t, 8, out)
        t, q, v = t + h, q_new, v_new


@jit
def march_all(
    pars, linear, tol, rest_speed, margin, max_steps, order, detail,
    hk, h_values, h_tail, h_dt, h_tables, h_n, vk, v_values, v_tail, v_dt, v_tables, v_n,
    dt_out, theta_out, rate_out, t_impact, rate_before, rate_after, out,
):  # fmt: skip
    """`march` for every row of `pars`; pulse tables, histories, impacts and results row by row too."""
    for i in range(len(pars)):
        ih, iv = (i if hk == PULSES else 0), (i if vk == PULSES else 0)
        march(
            pars[i], linear, tol, rest_speed, margin, max_steps, order, detail,
            hk, h_values, h_tail, h_dt, h_tables[ih], h_n, vk, v_values, v_tail, v_dt, v_tables[iv], v_n,
            dt_out, theta_out[i], rate_out[i], t_impact[i], rate_before[i], rate_after[i], out[i],
        )  # fmt: skip
