"""What a rocking lane meets: impact, peak, overturning, the motion's end (docs/lanes.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, FAST, LANDS, MEANINGFUL, NO_EVENT, NO_ROOT, RETURNS, TOPPLES, TOUCHES
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.facets import BALLISTIC, BALLISTIC_AFTER, rolls
from rockcli.kernels.lanes.records.forces import account, drive, drive_up, look_into, weigh_end, work_until
from rockcli.kernels.lanes.records.peaks import note_height
from rockcli.kernels.lanes.records.rest import (
    FARTHER,
    FINISHED,
    ROCKING,
    STANDING,
    aim,
    finish,
    hand_over,
    rest,
    stop,
    turn,
)
from rockcli.kernels.lanes.records.rolling import arrive_rolling, passage_of, roll_over, touch_next
from rockcli.kernels.lanes.records.step import HALF_PI
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.free_outcome import free_rocking, lost_for_good
from rockcli.kernels.rigid.law import driving, edge_of, energy, separatrix
from rockcli.kernels.rigid.march import ALL, OUTCOME, afterwards
from rockcli.kernels.rigid.readings import set_peak
from rockcli.kernels.rigid.roots import first_root, last_passage, passage, turning_point, zeros_before
from rockcli.kernels.rigid.series import bound, slope, value

NOT_HERE = -1
"""In place of an event: what ends the step is for the kernel of a single body to find."""


@jit
def arrive(st, i, par, bodies, how, values, slopes, velocity, c, sin_q, cos_q, a, a_v, hold, start, out, heave):
    """A rocking lane where it stops: before a sample that ends early, or at the end of the motion or of the report.

    At the motion's end the outcome of free rocking is known in closed form; what follows is one long sample of zeros.
    """
    if rolls(par):
        return arrive_rolling(st, i, par, bodies, how, values, out)
    q, v, s = st[lane.Q + i], st[lane.V + i], st[lane.SIDE + i]
    last = st[lane.LAST + i]
    if st[lane.END + i] < last:
        aim(st, i, par, last - 1.0)
        return STANDING
    edge, other = edge_of(par, at.RIGHT if s > 0.0 else at.LEFT), edge_of(par, at.LEFT if s > 0.0 else at.RIGHT)
    verdict = free_rocking(edge, other, q, v, how.linear, how.margin * edge.alpha)
    if st[lane.END + i] == last:
        out[to.VERDICT] = verdict
        if how.detail == OUTCOME:
            if verdict == FALLS and separatrix(edge, q, v, how.linear) < 0.0:  # an impact comes first
                st[lane.IMPACTS + i] += 1.0
            out[to.T_END] = par[at.T_MOTION]
            return finish(st, i, par, verdict, out)
        if verdict == FALLS and v > 0.0 and len(velocity) > 0 and separatrix(edge, q, v, how.linear) > 0.0:
            if hold:  # it may yet slip before it is beyond the equilibrium
                return stop(st, i, par, how, values, slopes, start, out)
            out[to.T_END], out[to.PEAK_SIDE] = par[at.T_MOTION], s
            return finish(st, i, par, verdict, out)
        if how.detail == ALL:
            shaking, k = values[int(last)], int(last) - 1
            if st[lane.LEN + i] < st[lane.DT + i]:
                shaking = values[k] + slopes[k] * st[lane.LEN + i]
            st[lane.WORK + i] -= shaking * drive(st, i, q, how.linear)
            lifting = 0.0
            if heave is not None:
                lifting = heave[0][int(last)]
                if st[lane.LEN + i] < st[lane.DT + i]:
                    lifting = heave[0][k] + heave[1][k] * st[lane.LEN + i]
                st[lane.WORK + i] -= lifting * drive_up(st, i, q, how.linear)
            weigh_end(st, i, edge, s, q, v, shaking * par[at.FACTOR_H], lifting * par[at.FACTOR_V], how.linear)
        still = st[lane.STILL + i]
        st[lane.PIECE + i], st[lane.END + i], st[lane.X + i] = still, still + 1.0, 0.0
        st[lane.LEN + i] = par[at.T_STOP] - par[at.T_MOTION]
        st[lane.CAP + i] = st[lane.DT + i]
        st[lane.SLOW + i] *= BALLISTIC_AFTER / BALLISTIC
        if st[lane.LEN + i] > 0.0:
            return STANDING
    verdict = out[to.VERDICT]
    t = par[at.T_STOP]
    out[to.T_END] = t
    if verdict == FALLS:
        out[to.PEAK_SIDE] = s
    given = par[at.HAS_DURATION] == 1.0
    if v > 0.0 and (given or verdict != RETURNS):
        set_peak(edge.alpha, s, q, t, how.tol, out)  # cut off while rising
    if how.detail == ALL:
        if par[at.T_STOP] > par[at.T_MOTION]:
            weigh_end(st, i, edge, s, q, v, 0.0, 0.0, how.linear)
        account(st, i, energy(edge, q, v, how.linear), out)
    if not given or verdict == FALLS:
        afterwards(edge, other, how, s, q, v, t, verdict, c, sin_q, cos_q, a, a_v, out)
    return finish(st, i, par, verdict, out)


@jit
def attend(
    st, i, par, bodies, how, values, slopes, blocks, tail, velocity, c, guard, sin_q, cos_q, a, a_v, force, hold, start,
    out, heave,
):  # fmt: skip
    """Look at the step lane i tried, go as far as its first event, and see to that."""
    q, h, x0 = st[lane.Q + i], st[lane.H + i], st[lane.X + i]
    c[0] = q
    for k in range(lane.ORDER):
        c[k + 1] = st[lane.COEFFICIENTS + k * WIDTH + i]
    if not abs(c[lane.ORDER]) <= st[lane.SMALL + i]:  # halved too often
        return hand_over(out)
    if hold and st[lane.WEAK + i] > 0.0:
        return stop(st, i, par, how, values, slopes, start, out)
    last, piece = int(st[lane.LAST + i]), int(st[lane.PIECE + i])
    free = piece > last
    t0 = (par[at.T_MOTION] if free else (piece - st[lane.FIRST + i]) * st[lane.DT + i]) + x0
    s = st[lane.SIDE + i]
    edge = edge_of(par, at.RIGHT if s > 0.0 else at.LEFT)
    path, watch = len(velocity) == 0, how.detail == ALL
    if not (path or free or q < edge.q_star or c[1] <= 0.0 or rolls(par)):
        if lost(st, i, values, slopes, velocity, how.linear):
            out[to.T_END], out[to.PEAK_SIDE] = t0, s
            return finish(st, i, par, FALLS, out)
        st[lane.LOOK + i] = min(FARTHER * max(q, st[lane.LOOK + i]), HALF_PI)
    if q == 0.0 and c[1] == 0.0:
        c[2] = max(c[2], 0.0)
    skip = zeros_before(c, lane.ORDER)
    if skip < 0:
        return hand_over(out)
    event, x, reach = first_event(st, i, par, how, c, skip, guard, edge, tail, heave)
    if event == NOT_HERE:
        return hand_over(out)
    note_way(st, i, par, how, c, x, reach, t0, h, path, hold, guard, sin_q, cos_q, a, a_v, force, edge, out)
    v = slope(c, lane.ORDER, x) / h
    if event == TOPPLES:
        q = value(c, lane.ORDER, x)
        out[to.T_END], out[to.PEAK_SIDE] = t0 + x * h, s
        if watch:
            close_account(st, i, how, q, v, x, h, edge, heave, out)
        afterwards(edge, edge, how, s, q, v, t0 + x * h, FALLS, c, sin_q, cos_q, a, a_v, out)
        return finish(st, i, par, FALLS, out)

    # go there
    st[lane.Q + i], st[lane.V + i] = (value(c, lane.ORDER, x) if event == NO_EVENT else 0.0), v
    at_end = move_on(st, i, x, x0, h)
    if event == LANDS:
        strike(st, i, par, s, v, t0 + x * h, path, watch, out)
    if event == TOUCHES and roll_over(st, i, par, bodies, values, slopes, path, watch, out) == FINISHED:
        return FINISHED
    if event != NO_EVENT and not at_end and st[lane.V + i] <= st[lane.SLOW + i]:
        state = rest(st, i, par, how, values, slopes, blocks, tail, hold, start, out, heave)
        if state != ROCKING:
            return state
    if at_end:
        return arrive(
            st, i, par, bodies, how, values, slopes, velocity, c, sin_q, cos_q, a, a_v, hold, start, out, heave
        )
    return STANDING


@jit_part
def first_event(st, i, par, how, c, skip, guard, edge, tail, heave):
    """What ends the step of lane i, at which part of it, and the bound of q until then: (event, x, reach)."""
    x = first_root(c, lane.ORDER, 1.0, skip)
    event = NO_EVENT if x == NO_ROOT else LANDS
    if event == NO_EVENT:
        x = 1.0
    reach = bound(c, lane.ORDER, x)
    if rolls(par):
        touches, x = touch_next(st, i, par, c, guard, x, reach)
        return TOUCHES if touches else event, x, reach
    if reach < HALF_PI:
        return event, x, reach
    if edge.q_star == math.inf:
        return NOT_HERE, x, reach
    for k in range(lane.ORDER + 1):
        guard[k] = -c[k]
    guard[0] = HALF_PI - c[0]
    if how.linear:
        shaking = lightening = 0.0
        last, piece = int(st[lane.LAST + i]), int(st[lane.PIECE + i])
        if piece < last:
            shaking = tail[piece] * abs(par[at.FACTOR_H])
            if heave is not None:
                lightening = heave[3][piece] * abs(par[at.FACTOR_V])
        q, v = value(c, lane.ORDER, x), slope(c, lane.ORDER, x)
        if q >= HALF_PI and lost_for_good(edge, q, v, shaking, lightening):
            return TOPPLES, (passage(c, lane.ORDER, HALF_PI, 0.0, x) if guard[0] > 0.0 else x), reach
    elif guard[0] > 0.0:
        over = first_root(guard, lane.ORDER, x, 0)
        if over != NO_ROOT:
            return TOPPLES, over, reach
    return event, x, reach


@jit_part
def note_way(st, i, par, how, c, x, reach, t0, h, path, hold, guard, sin_q, cos_q, a, a_v, force, edge, out):
    """Note what happens on the step of lane i up to x: peak, passage of the equilibrium, forces and work."""
    s, watch = st[lane.SIDE + i], how.detail == ALL
    if reach > st[lane.PEAK + i] and c[1] > 0.0 >= slope(c, lane.ORDER, x):
        y = turning_point(c, lane.ORDER, 0.0, x)
        note_height(st, i, par, value(c, lane.ORDER, y), t0 + y * h, hold and watch, how.tol, out)
    passed = NO_ROOT
    if path and rolls(par):
        passed = passage_of(par, s, c, guard, x, reach)
    elif path and reach >= edge.q_star:
        passed = last_passage(c, lane.ORDER, edge.q_star, x, 1)
    if passed != NO_ROOT:
        out[to.T_OVERTURN] = t0 + passed * h
        if watch:
            look_into(st, i, par, s, passed, guard, force, a, a_v, out)
            out[to.MU_STANDING], out[to.N_STANDING] = st[lane.MU_MOST + i], st[lane.N_LEAST + i]
    if watch:
        look_into(st, i, par, s, x, guard, force, a, a_v, out)
        work_until(st, i, x, c, sin_q, cos_q, how.linear)


@jit_part
def close_account(st, i, how, q, v, x, h, edge, heave, out):
    """The balance of energy of lane i as it falls, at part x of a step of h."""
    st[lane.WORK + i] -= (st[lane.A_0 + i] + st[lane.A_1 + i] * x * h) * drive(st, i, q, how.linear)
    if heave is not None:
        st[lane.WORK + i] -= (st[lane.UP_0 + i] + st[lane.UP_1 + i] * x * h) * drive_up(st, i, q, how.linear)
    account(st, i, energy(edge, q, v, how.linear), out)


@jit_part
def move_on(st, i, x, x0, h):
    """Lane i has gone part x of a step of h from x0 in its sample; whether it must stop before the next one."""
    length, now = st[lane.LEN + i], x0 + x * h
    if not ((x == 1.0 and h == length - x0) or now >= length):
        st[lane.X + i] = now
        return False
    st[lane.PIECE + i] += 1.0
    st[lane.X + i] = 0.0
    return st[lane.PIECE + i] >= st[lane.END + i]


@jit_part
def strike(st, i, par, s, v, t, path, watch, out):
    """Lane i turns over to its other edge."""
    rate = abs(min(v, 0.0))
    if path:
        carried = (FAST * rate / st[lane.FAST + i]) ** 2 - MEANINGFUL**2
        if carried > 0.0:
            st[lane.SWINGS + i] += carried
            st[lane.SWINGS_T + i] += carried * t
    if watch:
        st[lane.LOST + i] += st[lane.LOSS + i] * rate * rate
    if rate > st[lane.FAST + i]:
        st[lane.IMPACTS + i] += 1.0
        if s > 0.0:
            st[lane.ONTO_LEFT + i] += 1.0
    st[lane.V + i] = st[lane.ETA + i] * rate
    turn(st, i, par, -s, out)


@jit
def lost(st, i, values, slopes, velocity, linear):
    """Whether lane i, beyond the equilibrium and going on, falls whatever the ground still does.

    Out there gravity only helps, whatever a vertical motion below g makes of it, and the part of the forcing that
    counts, f = fc cos q + fs sin q, falls as q grows; by the mean value theorem the ground takes at most f times its
    largest later change of velocity (docs/lanes.md, L6).
    velocity: at each sample, its largest and its least from there on.
    """
    q, v, k, x = st[lane.Q + i], st[lane.V + i], int(st[lane.PIECE + i]), st[lane.X + i]
    force, change = st[lane.FORCING_C + i], 0.0
    if not linear:
        sine, cosine = math.sin(q), math.cos(q)
        forcing_s = st[lane.FORCING_S + i]
        force, change = driving(force, forcing_s, sine, cosine), forcing_s * cosine - force * sine
        if st[lane.FREE_0 + i] + st[lane.FREE_S + i] < 0.0 or force * change > 0.0:
            return False
    now = velocity[k, 0] + x * (values[k] + 0.5 * x * slopes[k])
    pull = velocity[k, 1] - now if force < 0.0 else now - velocity[k, 2]
    return v > abs(force) * pull + st[lane.FAST + i]
