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
    LANDS,
    NO_EVENT,
    NO_ROOT,
    NOT_FINITE,
    NOT_YET,
    OUT_OF_STEPS,
    PATIENCE,
    PUSH,
    RETURNS,
    STALLED,
    STRICTER,
    TOUCHES,
    UNDECIDED,
)
from rockcli.kernels.jit import entry, jit, jit_part
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.edge_forces import BRIEF, note_passage, watch_rocking
from rockcli.kernels.rigid.ground import NOTHING, PULSES, SAMPLES, bounds_from, expand_both, longest_step, pieces_at
from rockcli.kernels.rigid.march import ALL, OUTCOME, REST, ROCK
from rockcli.kernels.rigid.march import work_space as work_space
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
from rockcli.kernels.rigid.rest import stand
from rockcli.kernels.rigid.roots import first_root, last_passage, zeros_before
from rockcli.kernels.rigid.series import bound, flow, slope, value
from rockcli.kernels.rigid.settings import Channel as Channel
from rockcli.kernels.rigid.settings import Ground
from rockcli.kernels.rigid.settings import Settings as Settings
from rockcli.kernels.rolling import parameters as at
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.eventless import step_over_samples, waits
from rockcli.kernels.rolling.free_rolling import free_rolling
from rockcli.kernels.rolling.law import end_of, energy, push_of
from rockcli.kernels.rolling.rest import rest_time

SURE = 1.0 - 1e-9
"""An acceleration nearer to uplift than this is looked at closely."""


@jit
def march(par, body, how, horizontal, h_data, vertical, v_data, dt_out, history, impacts, spaces, out):
    """Solve one case of a body, a row of the table of `kernels.rolling.parameters`; else as `kernels.rigid.march`."""
    detail, scale = how.detail, body[at.SCALE]
    ground = Ground(horizontal, h_data, par[at.FACTOR_H], vertical, v_data, par[at.FACTOR_V])
    t_motion, t_stop, given = par[at.T_MOTION], par[at.T_STOP], par[at.HAS_DURATION] == 1.0
    lean = vertical.kind == NOTHING and len(history[0]) == 0 and detail < ALL
    steps_over = lean and horizontal.kind == SAMPLES and t_motion >= horizontal.pieces * horizontal.dt
    clear(out)
    empty(spaces)
    c, sine, cosine, a, a_v, guard, _ = spaces
    mode, facet, s, q, v = begin(par, body, how, out)
    end, other = end_of(body, par[at.G], facet, s), end_of(body, par[at.G], facet, -s)
    small = STRICTER * how.tol * min(scale, standing_angle(body, par[at.G]))
    lifted = par[at.THETA_0] != 0.0 or par[at.THETA_DOT_0] != 0.0  # for longer than no time
    t = lost = 0.0
    work = energy(end, q, v)
    ih = iv = i_hist = stalled = 0
    verdict, push, launch = NOT_YET, PUSH, False

    while True:
        if t >= t_motion and verdict == NOT_YET:
            verdict, out[also.FACET], hits = free_rolling(body, par[at.G], facet, s, q, v, how.margin * scale)
            if detail == OUTCOME:
                if verdict == FALLS:
                    out[to.N_IMPACTS] += hits
                break
            if verdict == FALLS and hits > 0:
                out[to.STRUCK_LATER] = 1.0
        reported = t < t_stop
        t_end = t_stop if reported else t_stop + PATIENCE / math.sqrt(end.p2)
        if not reported:
            if t >= t_end or told(body, end, mode, s, q, v, verdict, given):
                break
        elif t >= t_motion and mode == REST and not given and end.threshold >= 0.0 and other.threshold >= 0.0:
            break
        if out[to.N_STEPS] >= how.max_steps:
            out[to.STATUS] = OUT_OF_STEPS
            break

        ih, iv, t_next = pieces_at(ground, ih, iv, t, t_motion, t_end)
        left, right = (other, end) if s > 0.0 else (end, other)
        if lean and ih < horizontal.pieces:
            if mode == REST:
                still = stands_until(left, right, ground, ih, t_motion)
                if still > t:
                    t = still
                    continue
            elif steps_over and q > 0.0 and not launch:
                moved_on, t, q, v = step_over_samples(
                    end, s, h_data, horizontal.dt, par[at.FACTOR_H], horizontal.pieces, ih, t, q, v, small,
                    barrier_of(body, end, s), ceiling_of(end, s, detail, out),
                )  # fmt: skip
                if moved_on > 0:
                    out[to.N_STEPS] += moved_on
                    stalled = 0
                    continue
        deg = expand_both(ground, ih, iv, t, how.order, a, a_v)
        out[to.N_STEPS] += 1

        if mode == REST:
            least = max(min(abs(end.threshold), abs(other.threshold)), 1e-3)
            t, s_up, stalled, push = stand(
                left, right, least, a, a_v, deg, t, t_next, stalled, push, detail == ALL and reported, guard, out
            )  # fmt: skip
            i_hist = write_rest(history, i_hist, dt_out, t, end.tilt)
            if s_up != 0.0:
                mode, launch, s, q, v = ROCK, True, s_up, 0.0, 0.0
                end, other = (right, left) if s > 0.0 else (left, right)
                if not lifted:
                    out[to.T_UPLIFT] = t
            continue

        h = min(t_next - t, 2.0 / math.sqrt(end.p2), longest_step(ground, ih, iv, t))
        n, h = flow(end, how, small, q, v, s, a, a_v, deg, launch, h, c, sine, cosine)
        if not h > 0.0 or math.isnan(c[n]):
            out[to.STATUS] = NOT_FINITE
            break
        launch, skip = False, zeros_before(c, n)
        if skip < 0:  # would enter the ground at once: not an uplift
            mode = REST
            stalled += 1
            continue
        event, x, reach = first_event(end, c, n, h, skip, guard)

        parts = 1 if (horizontal.kind == SAMPLES and t < t_motion and x * x * end.p2 < BRIEF) else 8
        work += note_way(body, end, how, s, n, x, reach, t, parts, reported, given, deg, spaces, out)
        t_was, t = t, (t_next if (event == NO_EVENT and x == t_next - t) else t + x)
        q, v = (0.0 if event == LANDS else value(c, n, x)), slope(c, n, x)
        i_hist = write_step(history, i_hist, dt_out, t_was, min(t, t_stop), end.tilt, s, c, n)
        stalled = stalled + 1 if t == t_was else 0
        if t > t_was:
            push, lifted = PUSH, True
        if event == NO_EVENT:
            continue

        # reset: the body turns over to the far end of the facet that touches
        rate = s * v
        if event == TOUCHES:
            facet += 1 if s > 0.0 else -1
            if facet < 0 or facet == int(body[at.COUNT]):  # there is none: it lies on its side
                verdict = FALLS
                if math.isnan(out[to.T_OVERTURN]):
                    out[to.T_OVERTURN] = t
                break
            s = -s
        other, end = end_of(body, par[at.G], facet, s), end_of(body, par[at.G], facet, -s)
        s, q = -s, 0.0
        note_landing(end, other, scale, rate, t, reported, how, impacts, out)
        v = end.eta * abs(rate)
        lost += energy(other, 0.0, rate) - energy(end, 0.0, v)
        if stalled > STALLED:
            v = 0.0
        rest_at = rest_time(end, other, s, v, scale, a, a_v, deg, x, t, t_next, how.rest_speed)
        if rest_at >= 0.0:
            lost += energy(end, 0.0, v) - end.height
            i_hist = write_rest(history, i_hist, dt_out, rest_at, end.tilt)
            mode, t, v = REST, rest_at, 0.0
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


@jit_part
def begin(par, body, how, out):
    """How a case starts: (mode, facet, s, q, v)."""
    facet, theta, rate = int(body[at.STANDING]), par[at.THETA_0], par[at.THETA_DOT_0]
    out[also.FACET] = -1.0
    if theta == 0.0 and rate == 0.0:
        return REST, facet, 1.0, 0.0, 0.0
    s = 1.0 if (theta if theta != 0.0 else rate) > 0.0 else -1.0
    step = 1 if s > 0.0 else -1
    while 0 <= facet + step < int(body[at.COUNT]):
        if abs(theta) < abs(end_of(body, par[at.G], facet + step, s).tilt):
            break
        facet += step
    out[to.T_UPLIFT] = 0.0
    if theta >= body[at.FALL_RIGHT] or theta <= body[at.FALL_LEFT]:
        out[to.T_OVERTURN] = 0.0
    set_peak(1.0, s, abs(theta), 0.0, how.tol, out)
    out[to.PEAK_SIDE], out[to.RATE_PEAK] = s, abs(rate)
    q, v = abs(theta) - abs(end_of(body, par[at.G], facet, s).tilt), s * rate
    if q == 0.0 and v < 0.0:
        return ROCK, facet, -s, q, -v
    return (REST if q == v == 0.0 else ROCK), facet, s, q, v


@jit
def standing_angle(body, g):
    """The lesser alpha of the facet on which a body stands."""
    facet = int(body[at.STANDING])
    return min(end_of(body, g, facet, 1.0).alpha, end_of(body, g, facet, -1.0).alpha)


@jit
def barrier_of(body, end, s):
    """q at the last barrier of the side to which an end of a facet leads, on whatever facet that is."""
    fall = body[at.FALL_RIGHT] if end.tilt + 0.5 * s * end.extent > 0.0 else body[at.FALL_LEFT]
    return s * (fall - end.tilt)


@jit
def ceiling_of(end, s, detail, out):
    """q beyond which there would be a new peak, infinite where none is wanted, or q does not grow outward."""
    if s * end.tilt < 0.0 or detail == OUTCOME:
        return math.inf
    return out[to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT] - abs(end.tilt)


@jit
def told(body, end, mode, s, q, v, verdict, given):
    """Beyond the report: whether the swing under way has had its peak, its passage of the last barrier."""
    theta = end.tilt + s * q
    inward = v == 0.0 or s * v * theta <= 0.0
    passed = verdict == FALLS and (theta > body[at.FALL_RIGHT] or theta < body[at.FALL_LEFT]) and not inward
    return mode == REST or passed or (verdict != FALLS and (given or inward))


@jit
def stands_until(left, right, ground, ih, t_motion):
    """Until when the horizontal motion from piece ih on surely lifts a body off neither edge [s]; 0: not known."""
    if bounds_from(ground, ih, 0)[0] <= left.g * min(left.threshold, right.threshold):
        return t_motion
    if ground.horizontal.kind != SAMPLES or left.threshold <= 0.0 or right.threshold <= 0.0:
        return 0.0
    low, high = -left.g * right.threshold, left.g * left.threshold
    still = waits(ground.h_data, ground.factor_h, ground.horizontal.pieces, ih, low * SURE, high * SURE)
    return min(still * ground.horizontal.dt, t_motion) if still > ih else 0.0


@jit_part
def first_event(end, c, n, h, skip, guard):
    """What ends a step of at most h, and when, and the bound of q on it: (event, x, reach).

    `skip` leading coefficients of q are zero; `guard` is work space.  After the last facet a quarter turn is the fall.
    """
    x = first_root(c, n, h, skip)
    event = NO_EVENT if x == NO_ROOT else LANDS
    if event == NO_EVENT:
        x = h
    reach = bound(c, n, x)
    if reach >= end.extent:
        for k in range(n + 1):
            guard[k] = -c[k]
        guard[0] = end.extent - c[0]
        touch = first_root(guard, n, x, 0) if guard[0] > 0.0 else 0.0
        if touch != NO_ROOT:
            return TOUCHES, touch, reach
    return event, x, reach


@jit_part
def note_way(body, end, how, s, n, x, reach, t, parts, reported, given, deg, spaces, out):
    """As `kernels.rigid.march.note_way`: peak, passage of the last barrier, forces; the work."""
    c, sine, cosine, a, a_v, guard, force = spaces
    outward, far, watched = s * end.tilt >= 0.0, abs(end.tilt), how.detail == ALL and reported
    side = to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT
    # where q grows inward no rotation passes that of the facet, which has been noted
    if outward and how.detail > OUTCOME and (reported or not given) and reach + far > out[side]:
        q, c[0] = c[0], c[0] + far
        raise_peak(1.0, s, c, n, x, t, parts, how.tol, out)
        c[0] = q
    level = barrier_of(body, end, s)
    if 0.0 < level < end.extent and reach >= level:
        for k in range(n + 1):
            guard[k] = -c[k]
        passed = last_passage(c, n, level, x, parts) if outward else last_passage(guard, n, -level, x, parts)
        if passed != NO_ROOT:
            note_passage(passed, end, s, c, n, t, a, a_v, deg, parts, watched, force, out)
    if watched:
        watch_rocking(end, s, c, n, x, a, a_v, deg, parts, force, out)
    return work_done(end, s, c, n, x, a, a_v, deg, sine, cosine, guard) if how.detail == ALL else 0.0


@jit_part
def note_landing(end, other, scale, rate, t, reported, how, impacts, out):
    """Note an impact of a body that comes from one end of a facet and turns onto the other, `end`."""
    unit = math.sqrt(end.p2) * scale
    note_swing(rate / unit, t, out)
    if abs(rate) > FAST * unit and reported:
        note_impact(t, rate, end.eta, impacts, out)
        out[also.MU_IMPACT] = max(out[also.MU_IMPACT], push_of(end.height, end.eta, end.b, other.b))
    if end.tilt != 0.0:
        set_peak(1.0, 1.0 if end.tilt > 0.0 else -1.0, abs(end.tilt), t, how.tol, out)


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
