"""The rolling body as a hybrid automaton: flow, guard, reset, mode (docs/rolling.md).

Modes: REST on a facet (nothing moves until a guard |a_g| > (g + a_v) tan(alpha) of one of its ends opens) and ROCK
about an end of a facet (q flows until the facet lies flat again, q = 0, or the next one touches, q = extent; either
reset turns the body over to the far end of the facet that touches).  One facet makes the body of `kernels.rigid`.
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.constants import (
    DONE,
    FALLS,
    FAST,
    MEANINGFUL,
    NO_ROOT,
    NOT_FINITE,
    NOT_YET,
    NUDGE,
    OUT_OF_STEPS,
    PATIENCE,
    RETURNS,
    STRICTER,
    UNDECIDED,
)
from rockcli.kernels.jit import entry, jit_lean
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import watch_rest, watch_rocking
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, bound_from, expand, piece_at, piece_end, sight
from rockcli.kernels.rigid.march import ALL, OUTCOME, REST, ROCK
from rockcli.kernels.rigid.march import work_space as work_space
from rockcli.kernels.rigid.readings import forget_hops, raise_peak, set_peak, work_done
from rockcli.kernels.rigid.rest import lift_off
from rockcli.kernels.rigid.roots import first_root, last_passage
from rockcli.kernels.rigid.series import flow, slope, value
from rockcli.kernels.rigid.settings import Channel as Channel
from rockcli.kernels.rigid.settings import Degrees
from rockcli.kernels.rigid.settings import Settings as Settings
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.free_rolling import free_rolling
from rockcli.kernels.rolling.glide import glide, waits
from rockcli.kernels.rolling.law import end_of, energy, push_of
from rockcli.kernels.rolling.rest import rest_time

SURE = 1.0 - 1e-9
"""An acceleration nearer to uplift than this is looked at closely."""


@jit_lean
def march(par, body, how, horizontal, h_data, vertical, v_data, dt_out, history, impacts, spaces, out):
    """Solve one case of a body, a row of the table of `kernels.rolling.parameters`; else as `kernels.rigid.march`."""
    detail = how.detail
    theta_out, rate_out = history[0], history[1]
    t_impact, rate_before, rate_after = impacts[0], impacts[1], impacts[2]
    n_hist, n_store = len(theta_out), len(t_impact)
    g = par[at.G]
    count, scale = int(body[at.COUNT]), body[at.SCALE]
    fall_left, fall_right = body[at.FALL_LEFT], body[at.FALL_RIGHT]
    margin = how.margin * scale
    t_motion, t_stop = par[at.T_MOTION], par[at.T_STOP]
    given = par[at.HAS_DURATION] == 1.0
    for i in range(also.N_OUT):
        out[i] = 0.0
    out[to.T_PEAK] = out[to.T_UPLIFT] = out[to.T_OVERTURN] = math.nan
    out[to.N_MIN] = out[to.N_STANDING] = math.inf
    out[to.PEAK_ALPHA] = 1.0
    out[also.FACET] = -1.0

    c, sine, cosine, a, a_v, guard, force = spaces
    for space in spaces:  # nothing of the case before
        for i in range(len(space)):
            space[i] = 0.0

    t = 0.0
    ih = iv = i_hist = 0
    verdict = NOT_YET
    work = lost = 0.0
    stalled, push = 0, NUDGE
    launch = False
    mode = REST
    facet, s, q, v = int(body[at.STANDING]), 1.0, 0.0, 0.0
    base = min(end_of(body, g, facet, 1.0).alpha, end_of(body, g, facet, -1.0).alpha)
    small = STRICTER * how.tol * min(scale, base)
    lean = horizontal.kind == SAMPLES and vertical.kind == NOTHING and n_hist == 0 and detail < ALL
    theta_0, rate_0 = par[at.THETA_0], par[at.THETA_DOT_0]
    lifted = theta_0 != 0.0 or rate_0 != 0.0  # for longer than no time
    if lifted:
        lead = theta_0 if theta_0 != 0.0 else rate_0
        s = 1.0 if lead > 0.0 else -1.0
        step = 1 if s > 0.0 else -1
        while 0 <= facet + step < count and abs(theta_0) >= abs(end_of(body, g, facet + step, s).tilt):
            facet += step
        end = end_of(body, g, facet, s)
        q, v = abs(theta_0) - abs(end.tilt), s * rate_0
        mode = ROCK
        if q == 0.0 and v < 0.0:
            s, v = -s, -v
        elif q == 0.0 and v == 0.0:
            mode = REST
        out[to.T_UPLIFT] = 0.0
        if theta_0 >= fall_right or theta_0 <= fall_left:
            out[to.T_OVERTURN] = 0.0
        set_peak(1.0, 1.0 if lead > 0.0 else -1.0, abs(theta_0), 0.0, how.tol, out)
        out[to.PEAK_SIDE] = 1.0 if lead > 0.0 else -1.0
        out[to.RATE_PEAK] = abs(v)
    end, other = end_of(body, g, facet, s), end_of(body, g, facet, -s)
    began = energy(end, q, v)
    work = began

    while True:
        if t >= t_motion and verdict == NOT_YET:
            verdict, rests_on, hits = free_rolling(body, g, facet, s, q, v, margin)
            out[also.FACET] = rests_on
            if detail == OUTCOME:
                if verdict == FALLS:
                    out[to.N_IMPACTS] += hits
                break
            if verdict == FALLS and hits > 0:
                out[to.STRUCK_LATER] = 1.0
        if t >= t_stop:  # beyond the report: the swing under way still has its peak, its passage of the last barrier
            theta = end.tilt + s * q
            inward = v == 0.0 or s * v * theta <= 0.0
            passed = verdict == FALLS and (theta > fall_right or theta < fall_left) and not inward
            if mode == REST or passed or (verdict != FALLS and (given or inward)):
                break
            if t >= t_stop + PATIENCE / math.sqrt(end.p2):
                break
        elif t >= t_motion and mode == REST and not given and end.threshold >= 0.0 and other.threshold >= 0.0:
            break
        if out[to.N_STEPS] >= how.max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break

        # the piece we are in, and its end
        reported = t < t_stop
        t_next = t_stop if reported else t_stop + PATIENCE / math.sqrt(end.p2)
        deg_a = deg_v = 0
        a[0] = a_v[0] = 0.0
        a[1] = a_v[1] = 0.0
        if t < t_motion:
            t_next = t_motion
            ih, iv = piece_at(horizontal, h_data, ih, t), piece_at(vertical, v_data, iv, t)
            if ih < horizontal.pieces:
                t_next = min(t_next, piece_end(horizontal, h_data, ih))
                if mode == REST and vertical.kind == NOTHING and n_hist == 0 and detail < ALL:
                    # nothing moves, and nobody asks what the ground does meanwhile
                    quiet = g * min(end.threshold, other.threshold)
                    if bound_from(horizontal, h_data, par[at.FACTOR_H], ih) <= quiet:
                        t = t_motion
                        continue
                    if lean and end.threshold > 0.0 and other.threshold > 0.0:
                        left, right = (other, end) if s > 0.0 else (end, other)
                        low, high = -g * right.threshold, g * left.threshold
                        still = waits(h_data, par[at.FACTOR_H], horizontal.pieces, ih, low * SURE, high * SURE)
                        if still > ih:
                            t = min(still * horizontal.dt, t_motion)
                            continue
                if lean and mode == ROCK and q > 0.0 and not launch and t_motion >= horizontal.pieces * horizontal.dt:
                    rises = s * end.tilt >= 0.0 and detail > OUTCOME
                    ceiling = out[to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT] - abs(end.tilt) if rises else math.inf
                    fall = fall_right if end.tilt + 0.5 * s * end.extent > 0.0 else fall_left
                    moved_on, t, q, v = glide(
                        end, s, h_data, horizontal.dt, par[at.FACTOR_H], horizontal.pieces, ih, t, q, v, small,
                        s * (fall - end.tilt), ceiling,
                    )  # fmt: skip
                    if moved_on > 0:
                        out[to.N_STEPS] += moved_on
                        stalled = 0
                        continue
                deg_a = expand(horizontal, h_data, par[at.FACTOR_H], ih, t, how.order, a)
            if iv < vertical.pieces:
                t_next = min(t_next, piece_end(vertical, v_data, iv))
                deg_v = expand(vertical, v_data, par[at.FACTOR_V], iv, t, how.order, a_v)
        deg = Degrees(deg_a, deg_v)
        h = t_next - t
        out[to.N_STEPS] += 1

        if mode == REST:
            at_left, at_right = (other, end) if s > 0.0 else (end, other)
            least = max(min(abs(end.threshold), abs(other.threshold)), 1e-3)
            x, s_up, h = lift_off(at_left.threshold, at_right.threshold, least, a, a_v, deg, g, h, guard)
            moved = x if x != NO_ROOT else h
            if detail == ALL and reported and moved > 0.0:
                watch_rest(a, a_v, deg, g, moved, out)
            t_new = t_next if (x == NO_ROOT and h == t_next - t) else t + moved
            if stalled > 100:  # lifted and dropped again and again at one instant
                x, t_new, stalled = NO_ROOT, min(t_next, t + max(push * (t_next - t), 4e-16 * t)), 0
                push *= 10.0  # the ground may stay just there for long
            while i_hist < n_hist and i_hist * dt_out <= t_new:
                theta_out[i_hist] = end.tilt
                rate_out[i_hist] = 0.0
                i_hist += 1
            if x != NO_ROOT:
                stalled = stalled + 1 if t_new == t else 0
                mode, launch = ROCK, True
                q = v = 0.0
                if s_up != s:
                    s = s_up
                    end, other = other, end
                if not lifted:
                    out[to.T_UPLIFT] = t_new
            t = t_new
            continue

        h = min(h, 2.0 / math.sqrt(end.p2))
        if t < t_motion:
            h = min(h, sight(horizontal, h_data, ih, t), sight(vertical, v_data, iv, t))
        n, h = flow(end, how, small, q, v, s, a, a_v, deg, launch, h, c, sine, cosine)
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

        # guards: the facet lies flat again, or the next one touches (of the last one a quarter turn, the fall)
        x = first_root(c, n, h, skip)
        event = 1 if x != NO_ROOT else 0
        if event == 0:
            x = h
        reach = 0.0
        for k in range(n, -1, -1):
            reach = reach * x + abs(c[k])
        if reach >= end.extent:
            for k in range(n + 1):
                guard[k] = -c[k]
            guard[0] = end.extent - q
            touch = first_root(guard, n, x, 0) if guard[0] > 0.0 else 0.0
            if touch != NO_ROOT:
                event, x = 2, touch
        outermost = (s > 0.0 and facet == count - 1) or (s < 0.0 and facet == 0)

        # what happened on the way
        parts = 1 if (horizontal.kind == SAMPLES and t < t_motion) else 8
        if s * end.tilt >= 0.0:  # q grows outward; else no rotation passes that of the facet, which has been noted
            far = abs(end.tilt)
            side = to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT
            if detail > OUTCOME and (reported or not given) and reach + far > out[side]:
                c[0] = q + far
                raise_peak(1.0, s, c, n, x, t, parts, how.tol, out)
                c[0] = q
        level = s * ((fall_right if end.tilt + 0.5 * s * end.extent > 0.0 else fall_left) - end.tilt)
        if 0.0 < level < end.extent and reach >= level:
            passed = NO_ROOT
            if s * end.tilt >= 0.0:
                passed = last_passage(c, n, level, x, parts)
            else:
                for k in range(n + 1):
                    guard[k] = -c[k]
                passed = last_passage(guard, n, -level, x, parts)
            if passed != NO_ROOT:
                out[to.T_OVERTURN] = t + passed
                if detail == ALL and reported:
                    watch_rocking(end, s, c, n, passed, a, a_v, deg, parts, force, out)
                    out[to.MU_STANDING], out[to.N_STANDING] = out[to.MU], out[to.N_MIN]
        if detail == ALL:
            if reported:
                watch_rocking(end, s, c, n, x, a, a_v, deg, parts, force, out)
            work += work_done(end, s, c, n, x, a, a_v, deg, sine, cosine, guard)
        q_new, v_new = (0.0 if event == 1 else value(c, n, x)), slope(c, n, x)
        t_new = t_next if (event == 0 and x == t_next - t) else t + x
        while i_hist < n_hist and i_hist * dt_out <= min(t_new, t_stop):
            y = i_hist * dt_out - t
            theta_out[i_hist] = end.tilt + s * max(value(c, n, y), 0.0)
            rate_out[i_hist] = s * slope(c, n, y)
            i_hist += 1
        stalled = stalled + 1 if t_new == t else 0
        if t_new > t:
            push, lifted = NUDGE, True
        t, q, v = t_new, q_new, v_new

        if event == 2 and outermost:
            verdict = FALLS
            if math.isnan(out[to.T_OVERTURN]):
                out[to.T_OVERTURN] = t
            break
        if event == 0:
            continue

        # reset: the body turns over to the far end of the facet that touches
        rate = s * v
        if event == 2:
            facet += 1 if s > 0.0 else -1
            end = end_of(body, g, facet, -s)
            s = -s
        other, end = end, end_of(body, g, facet, -s)  # the end it comes from, and the one it turns onto
        s = -s
        q = 0.0
        p = math.sqrt(end.p2)
        eta = end.eta
        carried = (rate / (p * scale)) ** 2 - MEANINGFUL**2
        if carried > 0.0:
            out[to.SWINGS] += carried
            out[to.SWINGS_T] += carried * t
        if abs(rate) > FAST * p * scale and reported:
            out[to.N_IMPACTS] += 1
            out[also.MU_IMPACT] = max(out[also.MU_IMPACT], push_of(end.height, eta, end.b, other.b))
            k = int(out[to.IMPACTS_STORED])
            if k < n_store:
                t_impact[k], rate_before[k], rate_after[k] = t, rate, eta * rate
                out[to.IMPACTS_STORED] += 1
        if end.tilt != 0.0:
            set_peak(1.0, 1.0 if end.tilt > 0.0 else -1.0, abs(end.tilt), t, how.tol, out)
        before = energy(other, 0.0, rate)
        v = eta * abs(rate)
        lost += before - energy(end, 0.0, v)
        if stalled > 100:
            v = 0.0
        rest_at = rest_time(end, other, s, v, scale, a, a_v, deg, x, t, t_next, how.rest_speed)
        if rest_at >= 0.0:
            lost += energy(end, 0.0, v) - end.height
            mode = REST
            q = v = 0.0
            while i_hist < n_hist and i_hist * dt_out <= rest_at:
                theta_out[i_hist] = end.tilt
                rate_out[i_hist] = 0.0
                i_hist += 1
            t = rest_at
        elif v == 0.0:
            mode = REST

    if not lifted:
        forget_hops(out)
    theta = end.tilt + s * q
    out[to.T_END] = t_stop if given else min(t, t_stop)
    if verdict == FALLS:
        out[to.PEAK_SIDE] = 1.0 if theta > 0.0 or (theta == 0.0 and s > 0.0) else -1.0
    if verdict == RETURNS and mode == REST:
        out[also.FACET] = facet
    out[to.VERDICT] = verdict if out[to.STATUS] == DONE else UNDECIDED
    if mode == ROCK and s * v * theta > 0.0 and detail > OUTCOME and t <= t_stop and (given or verdict != RETURNS):
        set_peak(1.0, 1.0 if theta > 0.0 else -1.0, abs(theta), t, how.tol, out)  # cut off while rising
    out[to.ENERGY] = work - lost - energy(end, q, v)


@entry(MATRIX, MATRIX, Settings, Channel, MATRIX, Channel, MATRIX, float, CUBE, CUBE, (VECTOR,) * 7, MATRIX)
def march_all(pars, bodies, how, horizontal, h_data, vertical, v_data, dt_out, histories, impacts, spaces, out):
    """`march` for every row of `pars`; histories, impacts, results and tables of pulses row by row too.

    bodies: `kernels.rolling.parameters`, a row each; spaces: `work_space()`.
    """
    for i in range(len(pars)):
        ih, iv = (i if horizontal.kind == PULSES else 0), (i if vertical.kind == PULSES else 0)
        march(
            pars[i], bodies[int(pars[i][at.BODY])], how, horizontal, h_data[ih], vertical, v_data[iv], dt_out,
            histories[i], impacts[i], spaces, out[i],
        )  # fmt: skip
