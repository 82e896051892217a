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
    LANDS,
    MAX_ORDER,
    NO_EVENT,
    NO_ROOT,
    NOT_FINITE,
    NOT_YET,
    OUT_OF_STEPS,
    PATIENCE,
    PUSH,
    RETURNS,
    STALLED,
    TOPPLES,
    UNDECIDED,
)
from rockcli.kernels.jit import entry, jit, jit_part, room
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import BRIEF, note_passage, watch_rocking
from rockcli.kernels.rigid.free_outcome import free_rocking, lost_for_good
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, bounds_from, expand_both, longest_step, pieces_at
from rockcli.kernels.rigid.law import edge_of, energy, separatrix
from rockcli.kernels.rigid.readings import (
    clear,
    empty,
    forget_hops,
    note_impact,
    note_swing,
    raise_peak,
    set_peak,
    work_done,
    write_rest,
    write_step,
)
from rockcli.kernels.rigid.rest import rest_time, stand
from rockcli.kernels.rigid.roots import first_root, last_passage, passage, zeros_before
from rockcli.kernels.rigid.series import bound, flow, slope, value
from rockcli.kernels.rigid.settings import Channel as Channel
from rockcli.kernels.rigid.settings import Degrees, Ground
from rockcli.kernels.rigid.settings import Settings as Settings

REST, ROCK = 0, 1
"""Modes."""

OUTCOME, PEAKS, ALL = 0, 1, 2
"""How much is wanted: the outcome; peaks and times too; forces, rates and the energy balance too."""


def work_space():
    """Work space of `march_all`: series of q, its sine and cosine, of the ground, a guard; forces."""
    return (*(room(MAX_ORDER + 1) for _ in range(6)), room(6))


@jit
def march(par, how, horizontal, h_data, vertical, v_data, dt_out, history, impacts, spaces, out):
    """Solve one case.

    Histories at i dt_out go to history (2, k), theta and its rate, as far as they are long; impacts to impacts (3, j),
    time and rate before and after; results to out (`kernels.rigid.results`).
    """
    linear, detail = how.linear, how.detail
    ground = Ground(horizontal, h_data, par[at.FACTOR_H], vertical, v_data, par[at.FACTOR_V])
    left, right = edge_of(par, at.LEFT), edge_of(par, at.RIGHT)
    t_motion, t_stop, given = par[at.T_MOTION], par[at.T_STOP], par[at.HAS_DURATION] == 1.0
    p_min = math.sqrt(min(left.p2, right.p2))
    waits = vertical.kind == NOTHING and len(history[0]) == 0 and detail < ALL
    quiet = par[at.G] * min(left.threshold, right.threshold)
    clear(out)
    empty(spaces)
    c, sin_q, cos_q, a, a_v, guard, _ = spaces
    mode, s, q, v = begin(par, left, right, how, out)
    lifted = mode == ROCK  # for longer than no time
    t = lost = 0.0
    work = energy(right if s > 0.0 else left, q, v, linear)
    ih = iv = i_hist = stalled = 0
    verdict, push, launch = NOT_YET, PUSH, False

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
        reported = t < t_stop
        t_end = t_stop if reported else t_stop + PATIENCE / p_min
        if not reported and verdict == NOT_YET:  # beyond the report, until the damper has had its way
            if t >= t_end:
                verdict = UNDECIDED
                break
        elif not reported or (t >= t_motion and mode == REST and not given):
            break
        if out[to.N_STEPS] >= how.max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break

        ih, iv, t_next = pieces_at(ground, ih, iv, t, t_motion, t_end)
        if mode == REST and waits and t < t_motion and bounds_from(ground, ih, iv)[0] <= quiet:
            t = t_motion  # nothing moves, and nobody asks what the ground does meanwhile
            continue
        deg = expand_both(ground, ih, iv, t, how.order, a, a_v)
        out[to.N_STEPS] += 1

        if mode == REST:
            t, s_up, stalled, push = stand(
                left, right, left.threshold, a, a_v, deg, t, t_next, stalled, push, detail == ALL, guard, out
            )  # fmt: skip
            i_hist = write_rest(history, i_hist, dt_out, min(t, t_stop), 0.0)
            if s_up != 0.0:
                mode, launch, s, q, v = ROCK, True, s_up, 0.0, 0.0
                if not lifted:
                    out[to.T_UPLIFT] = t
            continue

        h = min(t_next - t, 2.0 / p_min, longest_step(ground, ih, iv, t))
        n, h = flow(edge, how, how.tol * edge.alpha, q, v, s, a, a_v, deg, launch, h, c, sin_q, cos_q)
        if not h > 0.0 or math.isnan(c[n]):
            out[to.STATUS] = NOT_FINITE
            break
        launch, skip = False, zeros_before(c, n)
        if skip < 0:  # would enter the ground at once: not an uplift
            mode = REST
            stalled += 1
            continue
        event, x, reach = first_event(edge, c, n, h, skip, linear, ground, ih, iv, guard)

        parts = 1 if (horizontal.kind == SAMPLES and t < t_motion and x * x * edge.p2 < BRIEF) else 8
        work += note_way(edge, other, how, s, n, x, reach, t, parts, reported, deg, spaces, out)
        t_was, t = t, (t_next if (event == NO_EVENT and x == t_next - t) else t + x)
        q, v = (0.0 if event == LANDS else value(c, n, x)), slope(c, n, x)
        i_hist = write_step(history, i_hist, dt_out, t_was, min(t, t_stop), 0.0, s, c, n)
        stalled = stalled + 1 if t == t_was else 0
        if t > t_was:
            push, lifted = PUSH, True
        if detail > OUTCOME and given and reported and t >= t_stop and v > 0.0:
            set_peak(edge.alpha, s, q, t, how.tol, out)  # the report ends while it rises, the run may go on

        if event == TOPPLES:
            verdict = FALLS
            break
        if event == LANDS:  # reset: the body turns over to its other edge
            note_landing(edge, other, s, s * min(v, 0.0), t, reported, impacts, out)
            before, v = energy(edge, 0.0, v, linear), other.eta * abs(s * min(v, 0.0))
            lost += before - energy(other, 0.0, v, linear)
            s = -s
            if stalled > STALLED:
                v = 0.0
            rest_at = rest_time(other, edge, s, v, a, a_v, deg, x, t, t_next, how.rest_speed)
            if rest_at >= 0.0:
                lost += energy(other, 0.0, v, linear)
                i_hist = write_rest(history, i_hist, dt_out, min(rest_at, t_stop), 0.0)
                mode, t, q, v = REST, rest_at, 0.0, 0.0
            elif v == 0.0:
                mode = REST

    if not lifted:
        forget_hops(out)
    out[to.T_END] = t_stop if given else min(t, t_stop)
    if verdict == FALLS:
        out[to.PEAK_SIDE] = s
    out[to.VERDICT] = verdict if out[to.STATUS] == DONE else UNDECIDED
    out[to.ENERGY] = work - lost - (energy(edge, q, v, linear) if mode == ROCK else 0.0)
    if mode == REST or detail == OUTCOME:
        return
    if v > 0.0 and not given and verdict != RETURNS:
        set_peak(edge.alpha, s, q, t, how.tol, out)  # cut off while rising
    if out[to.STATUS] == DONE and (not given or verdict == FALLS):
        afterwards(edge, other, how, s, q, v, t, verdict, c, sin_q, cos_q, a, a_v, out)


@jit_part
def begin(par, left, right, how, out):
    """How a case starts: (mode, sign of theta, |theta|, its rate)."""
    theta, rate = par[at.THETA_0], par[at.THETA_DOT_0]
    if theta == 0.0 and rate == 0.0:
        return REST, 1.0, 0.0, 0.0
    s = 1.0 if (theta if theta != 0.0 else rate) > 0.0 else -1.0
    q, v, edge = abs(theta), s * rate, right if s > 0.0 else left
    out[to.T_UPLIFT], out[to.PEAK_SIDE], out[to.RATE_PEAK] = 0.0, s, abs(v)
    if q >= edge.q_star:
        out[to.T_OVERTURN] = 0.0
    if v <= 0.0:
        set_peak(edge.alpha, s, q, 0.0, how.tol, out)
    return ROCK, s, q, v


@jit_part
def first_event(edge, c, n, h, skip, linear, ground, ih, iv, guard):
    """What ends a step of at most h, and when, and the bound of q on it: (event, x, reach).

    skip: how many leading coefficients of q are zero; shaking, lightening: bounds of |a_g| and |a_v| to come; guard:
    work space.
    """
    x = first_root(c, n, h, skip)
    event = NO_EVENT if x == NO_ROOT else LANDS
    if event == NO_EVENT:
        x = h
    reach = bound(c, n, x)
    if reach < 0.5 * math.pi or edge.q_star == math.inf:
        return event, x, reach
    for k in range(n + 1):
        guard[k] = -c[k]
    guard[0] = 0.5 * math.pi - c[0]
    if linear:
        shaking, lightening = bounds_from(ground, ih, iv)
        if value(c, n, x) >= 0.5 * math.pi and lost_for_good(edge, value(c, n, x), slope(c, n, x), shaking, lightening):
            return TOPPLES, (passage(c, n, 0.5 * math.pi, 0.0, x) if guard[0] > 0.0 else x), reach
    elif guard[0] > 0.0:
        over = first_root(guard, n, x, 0)
        if over != NO_ROOT:
            return TOPPLES, over, reach
    return event, x, reach


@jit_part
def note_way(edge, other, how, s, n, x, reach, t, parts, reported, deg, spaces, out):
    """Note what happens on a step from t on, looked at in `parts` parts: peak, passage of the equilibrium, forces.

    Return its work (0 where that is not wanted).
    """
    c, sin_q, cos_q, a, a_v, guard, force = spaces
    top = out[to.PEAK]
    if edge.alpha != other.alpha:
        top = out[to.PEAK_RIGHT] if s > 0.0 else out[to.PEAK_LEFT]
    if how.detail > OUTCOME and reported and reach > top:
        raise_peak(edge.alpha, s, c, n, x, t, parts, how.tol, out)
    watched = how.detail == ALL and reported
    if reach >= edge.q_star:
        passed = last_passage(c, n, edge.q_star, x, parts)
        if passed != NO_ROOT:
            note_passage(passed, edge, s, c, n, t, a, a_v, deg, parts, watched, force, out)
    if watched:
        watch_rocking(edge, s, c, n, x, a, a_v, deg, parts, force, out)
    return work_done(edge, s, c, n, x, a, a_v, deg, sin_q, cos_q, guard) if how.detail == ALL else 0.0


@jit_part
def note_landing(edge, other, s, rate, t, reported, impacts, out):
    """Note an impact of a body that turns over from one edge to the other; after the report only that there is one."""
    unit = math.sqrt(edge.p2) * edge.alpha
    note_swing(rate / unit, t, out)
    if not reported:
        out[to.STRUCK_LATER] = 1.0
    elif abs(rate) > FAST * unit:
        note_impact(t, rate, other.eta, impacts, out)
        out[to.ONTO_LEFT if s > 0.0 else to.ONTO_RIGHT] += 1


@jit
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
