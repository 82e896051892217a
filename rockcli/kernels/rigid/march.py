"""The rocking body as a hybrid automaton: flow, guard, reset, mode.

Modes: REST (nothing moves until the guard `|a_g| > (g + a_v) tan(alpha)` opens) and ROCK (q = |theta| flows,
until the guard q = 0 closes and the reset turns the body over to its other edge).  Steps land on the
breakpoints of the motion; after an event no coefficient is reused.
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.constants import (
    DONE,
    FALLS,
    FAST,
    MAX_ORDER,
    MEANINGFUL,
    NO_ROOT,
    NOT_FINITE,
    NOT_YET,
    NUDGE,
    OUT_OF_STEPS,
    PATIENCE,
    RETURNS,
    UNDECIDED,
)
from rockcli.kernels.jit import entry, jit_lean, room
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import watch_rest, watch_rocking
from rockcli.kernels.rigid.free_outcome import free_rocking, lost_for_good
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, bound_from, expand, piece_at, piece_end, sight
from rockcli.kernels.rigid.law import edge_of, energy, separatrix
from rockcli.kernels.rigid.readings import forget_hops, raise_peak, set_peak, work_done
from rockcli.kernels.rigid.rest import lift_off, rest_time
from rockcli.kernels.rigid.roots import first_root, last_passage, passage
from rockcli.kernels.rigid.series import flow, slope, value
from rockcli.kernels.rigid.settings import Channel as Channel
from rockcli.kernels.rigid.settings import Degrees
from rockcli.kernels.rigid.settings import Settings as Settings

REST, ROCK = 0, 1

OUTCOME, PEAKS, ALL = 0, 1, 2
"""How much is wanted: the outcome; peaks and times too; forces, rates and the energy balance too."""


def work_space():
    """Work space of `march_all`: series of q, its sine and cosine, of the ground, a guard; forces."""
    return (*(room(MAX_ORDER + 1) for _ in range(6)), room(6))


@jit_lean
def march(par, how, horizontal, h_data, vertical, v_data, dt_out, history, impacts, spaces, out):
    """Solve one case.

    Histories at i dt_out go to history (2, k), theta and its rate, as far as they are long; impacts to impacts (3, j),
    time and rate before and after; results to out (`kernels.rigid.results`).
    """
    linear, detail = how.linear, how.detail
    theta_out, rate_out = history[0], history[1]
    t_impact, rate_before, rate_after = impacts[0], impacts[1], impacts[2]
    left, right = edge_of(par, at.LEFT), edge_of(par, at.RIGHT)
    n_hist, n_store = len(theta_out), len(t_impact)
    g = par[at.G]
    t_motion, t_stop = par[at.T_MOTION], par[at.T_STOP]
    p_min = math.sqrt(min(left.p2, right.p2))
    two_sided = left.alpha != right.alpha
    quiet = g * min(left.threshold, right.threshold)
    for i in range(to.N_OUT):
        out[i] = 0.0
    out[to.T_PEAK] = out[to.T_UPLIFT] = out[to.T_OVERTURN] = math.nan
    out[to.N_MIN] = out[to.N_STANDING] = math.inf
    out[to.PEAK_ALPHA] = 1.0

    c, sin_q, cos_q, a, a_v, guard, force = spaces
    for space in spaces:  # nothing of the case before
        for i in range(len(space)):
            space[i] = 0.0

    t = 0.0
    ih = iv = i_hist = 0
    verdict = NOT_YET
    work = lost = 0.0
    stalled, push = 0, NUDGE
    lifted = par[at.THETA_0] != 0.0 or par[at.THETA_DOT_0] != 0.0  # for longer than no time
    launch = False
    mode = REST
    q, v, s = abs(par[at.THETA_0]), 0.0, 1.0
    if lifted:
        mode = ROCK
        lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
        s = 1.0 if lead > 0.0 else -1.0
        v = s * par[at.THETA_DOT_0]
        out[to.T_UPLIFT] = 0.0
        first = right if s > 0.0 else left
        out[to.PEAK_SIDE] = s
        if q >= first.q_star:
            out[to.T_OVERTURN] = 0.0
        if v <= 0.0:
            set_peak(first.alpha, s, q, 0.0, how.tol, out)
        out[to.RATE_PEAK] = abs(v)
        work = energy(first, q, v, linear)

    while True:
        edge, other = (right, left) if s > 0.0 else (left, right)
        if t >= t_motion and verdict == NOT_YET:
            verdict = RETURNS
            if mode == ROCK:
                verdict = free_rocking(edge, other, q, v, linear, how.margin * edge.alpha)
            if detail == OUTCOME and verdict != NOT_YET:
                if verdict == FALLS and separatrix(edge, q, v, linear) < 0.0:  # an impact comes first
                    out[to.N_IMPACTS] += 1
                break
        if t >= t_stop and verdict == NOT_YET:  # beyond the report, until the damper has had its way
            if t >= t_stop + PATIENCE / p_min:
                verdict = UNDECIDED
                break
        elif t >= t_stop or (t >= t_motion and mode == REST and par[at.HAS_DURATION] == 0.0):
            break
        if out[to.N_STEPS] >= how.max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break

        # the piece we are in, and its end
        t_next = t_stop if t < t_stop else t_stop + PATIENCE / p_min
        deg_a = deg_v = 0
        a[0] = a_v[0] = 0.0
        a[1] = a_v[1] = 0.0
        if t < t_motion:
            t_next = t_motion
            ih, iv = piece_at(horizontal, h_data, ih, t), piece_at(vertical, v_data, iv, t)
            if ih < horizontal.pieces:
                t_next = min(t_next, piece_end(horizontal, h_data, ih))
                # nothing moves, and nobody asks what the ground does meanwhile
                unasked = mode == REST and vertical.kind == NOTHING and n_hist == 0 and detail < ALL
                if unasked and bound_from(horizontal, h_data, par[at.FACTOR_H], ih) <= quiet:
                    t = t_motion
                    continue
                deg_a = expand(horizontal, h_data, par[at.FACTOR_H], ih, t, how.order, a)
            if iv < vertical.pieces:
                t_next = min(t_next, piece_end(vertical, v_data, iv))
                deg_v = expand(vertical, v_data, par[at.FACTOR_V], iv, t, how.order, a_v)
        deg = Degrees(deg_a, deg_v)
        h = t_next - t
        out[to.N_STEPS] += 1

        if mode == REST:
            x, s_up, h = lift_off(left.threshold, right.threshold, left.threshold, a, a_v, deg, g, h, guard)
            moved = x if x != NO_ROOT else h
            if detail == ALL and moved > 0.0:  # at a jump of the ground that it answers at once it is not at rest
                watch_rest(a, a_v, deg, g, moved, out)
            t_new = t_next if (x == NO_ROOT and h == t_next - t) else t + moved
            if stalled > 100:  # lifted and dropped again and again at one instant
                x, t_new, stalled = NO_ROOT, min(t_next, t + max(push * (t_next - t), 4e-16 * t)), 0
                push *= 10.0  # the ground may stay just there for long
            while i_hist < n_hist and i_hist * dt_out <= t_new:
                theta_out[i_hist] = 0.0
                rate_out[i_hist] = 0.0
                i_hist += 1
            if x != NO_ROOT:
                stalled = stalled + 1 if t_new == t else 0
                mode, launch = ROCK, True
                q = v = 0.0
                s = s_up
                if not lifted:
                    out[to.T_UPLIFT] = t_new
            t = t_new
            continue

        h = min(h, 2.0 / p_min)
        if t < t_motion:
            h = min(h, sight(horizontal, h_data, ih, t), sight(vertical, v_data, iv, t))
        n, h = flow(edge, how, how.tol * edge.alpha, q, v, s, a, a_v, deg, launch, h, c, sin_q, cos_q)
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
        if reach >= 0.5 * math.pi and edge.q_star < math.inf:
            for k in range(n + 1):
                guard[k] = -c[k]
            guard[0] = 0.5 * math.pi - q
            if guard[0] > 0.0:
                over = first_root(guard, n, x, 0)
                if over != NO_ROOT and not linear:
                    event, x = 2, over
            if linear and value(c, n, x) >= 0.5 * math.pi:
                shaking = shaken = 0.0
                if t < t_motion:
                    shaking = bound_from(horizontal, h_data, par[at.FACTOR_H], ih)
                    shaken = bound_from(vertical, v_data, par[at.FACTOR_V], iv)
                if lost_for_good(edge, value(c, n, x), slope(c, n, x), shaking, shaken):
                    event = 2
                    if guard[0] > 0.0:
                        x = passage(c, n, 0.5 * math.pi, 0.0, x)

        # what happened on the way
        reported = t < t_stop
        parts = 1 if (horizontal.kind == SAMPLES and t < t_motion) else 8
        top = out[to.PEAK]
        if two_sided:
            top = out[to.PEAK_RIGHT] if s > 0.0 else out[to.PEAK_LEFT]
        if detail > OUTCOME and reported and reach > top:
            raise_peak(edge.alpha, s, c, n, x, t, parts, how.tol, out)
        if reach >= edge.q_star:
            passed = last_passage(c, n, edge.q_star, x, parts)
            if passed != NO_ROOT:
                out[to.T_OVERTURN] = t + passed
                if detail == ALL and reported:
                    watch_rocking(edge, s, c, n, passed, a, a_v, deg, parts, force, out)
                    out[to.MU_STANDING], out[to.N_STANDING] = out[to.MU], out[to.N_MIN]
        if detail == ALL:
            if reported:
                watch_rocking(edge, s, c, n, x, a, a_v, deg, parts, force, out)
            work += work_done(edge, s, c, n, x, a, a_v, deg, sin_q, cos_q, guard)
        q_new, v_new = (0.0 if event == 1 else value(c, n, x)), slope(c, n, x)
        t_new = t_next if (event == 0 and x == t_next - t) else t + x
        while i_hist < n_hist and i_hist * dt_out <= t_new:
            y = i_hist * dt_out - t
            theta_out[i_hist] = s * max(value(c, n, y), 0.0)
            rate_out[i_hist] = s * slope(c, n, y)
            i_hist += 1
        stalled = stalled + 1 if t_new == t else 0
        if t_new > t:
            push, lifted = NUDGE, True
        if detail > OUTCOME and par[at.HAS_DURATION] == 1.0 and t < t_stop <= t_new and v_new > 0.0:
            set_peak(edge.alpha, s, q_new, t_new, how.tol, out)  # the report ends while it rises, the run may go on
        t, q, v = t_new, q_new, v_new

        if event == 2:
            out[to.VERDICT] = FALLS
            break
        if event == 1:
            # reset: the body turns over to its other edge
            rate = s * min(v, 0.0)
            p = math.sqrt(edge.p2)
            eta = other.eta
            carried = (rate / (p * edge.alpha)) ** 2 - MEANINGFUL**2
            if carried > 0.0:
                out[to.SWINGS] += carried
                out[to.SWINGS_T] += carried * t
            if not reported:
                out[to.STRUCK_LATER] = 1.0
            if abs(rate) > FAST * p * edge.alpha and reported:
                out[to.N_IMPACTS] += 1
                out[to.ONTO_LEFT if s > 0.0 else to.ONTO_RIGHT] += 1
                k = int(out[to.IMPACTS_STORED])
                if k < n_store:
                    t_impact[k], rate_before[k], rate_after[k] = t, rate, eta * rate
                    out[to.IMPACTS_STORED] += 1
            before = energy(edge, 0.0, v, linear)
            v = eta * abs(rate)
            s = -s
            edge, other = other, edge
            lost += before - energy(edge, 0.0, v, linear)
            if stalled > 100:
                v = 0.0
            rest_at = rest_time(edge, other, s, v, a, a_v, deg, x, t, t_next, how.rest_speed)
            if rest_at >= 0.0:
                lost += energy(edge, 0.0, v, linear)
                mode = REST
                q = v = 0.0
                while i_hist < n_hist and i_hist * dt_out <= rest_at:
                    theta_out[i_hist] = 0.0
                    rate_out[i_hist] = 0.0
                    i_hist += 1
                t = rest_at
            elif v == 0.0:
                mode = REST

    if not lifted:
        forget_hops(out)
    out[to.T_END] = t_stop if par[at.HAS_DURATION] == 1.0 else min(t, t_stop)
    if out[to.VERDICT] == FALLS:
        verdict = FALLS
    if verdict == FALLS:
        out[to.PEAK_SIDE] = s
    out[to.VERDICT] = verdict if out[to.STATUS] == DONE else UNDECIDED
    if mode == ROCK and v > 0.0 and detail > OUTCOME and par[at.HAS_DURATION] == 0.0 and verdict != RETURNS:
        set_peak(edge.alpha, s, q, t, how.tol, out)  # cut off while rising
    rest_energy = energy(edge, q, v, linear) if mode == ROCK else 0.0
    out[to.ENERGY] = work - lost - rest_energy
    if (
        out[to.STATUS] == DONE
        and mode == ROCK
        and detail > OUTCOME
        and (par[at.HAS_DURATION] == 0.0 or verdict == FALLS)
    ):
        afterwards(edge, other, how, s, q, v, t, verdict, c, sin_q, cos_q, a, a_v, out)


@jit_lean
def afterwards(edge, other, how, s, q, v, t, verdict, c, sin_q, cos_q, a, a_v, out):
    """Beyond the report: the swing under way still has its peak; a body that falls is followed to where it does."""
    a[0] = a_v[0] = 0.0
    p = math.sqrt(edge.p2)
    for _ in range(100000):
        fallen = q >= edge.q_star and v >= 0.0
        if verdict == UNDECIDED or (fallen if verdict == FALLS else v <= 0.0):
            return
        n, h = flow(edge, how, how.tol * edge.alpha, q, v, s, a, a_v, Degrees(0, 0), False, 2.0 / p, c, sin_q, cos_q)
        hit = first_root(c, n, h, 1 if q == 0.0 else 0) if verdict == FALLS else NO_ROOT
        if hit != NO_ROOT:
            v, s, t, q = other.eta * abs(slope(c, n, hit)), -s, t + hit, 0.0
            edge, other = other, edge
            p = math.sqrt(edge.p2)
            out[to.STRUCK_LATER] = 1.0
            out[to.PEAK_SIDE], out[to.T_OVERTURN] = s, math.nan
            continue
        q_new, v_new = value(c, n, h), slope(c, n, h)
        if verdict == FALLS and q < edge.q_star <= q_new:
            out[to.T_OVERTURN] = t + passage(c, n, edge.q_star, 0.0, h)
        if verdict == RETURNS and v_new <= 0.0:
            raise_peak(edge.alpha, s, c, n, h, t, 8, how.tol, out)
        t, q, v = t + h, q_new, v_new


@entry(MATRIX, Settings, Channel, MATRIX, Channel, MATRIX, float, CUBE, CUBE, (VECTOR,) * 7, MATRIX)
def march_all(pars, how, horizontal, h_data, vertical, v_data, dt_out, histories, impacts, spaces, out):
    """`march` for every row of `pars`; histories, impacts, results and tables of pulses row by row too.

    spaces: `work_space()`.
    """
    for i in range(len(pars)):
        ih, iv = (i if horizontal.kind == PULSES else 0), (i if vertical.kind == PULSES else 0)
        march(
            pars[i], how, horizontal, h_data[ih], vertical, v_data[iv], dt_out, histories[i], impacts[i], spaces, out[i]
        )  # fmt: skip
