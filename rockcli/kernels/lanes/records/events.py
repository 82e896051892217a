"""What a rocking lane meets: impact, peak, overturning, the motion's end (docs/sweeps.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, NO_ROOT, RETURNS
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.records.rest import (
    BALLISTIC,
    BALLISTIC_AFTER,
    FARTHER,
    ROCKING,
    STANDING,
    finish,
    hand_over,
    rest,
    turn,
)
from rockcli.kernels.lanes.records.step import (
    CAP,
    COEFFICIENTS,
    END,
    FAST,
    FORCING_C,
    FORCING_S,
    FREE_0,
    FREE_S,
    HALF_PI,
    IMPACTS,
    LEN,
    LOOK,
    ORDER,
    PIECE,
    SIDE,
    SLOW,
    SMALL,
    H,
    Q,
    V,
    X,
)
from rockcli.kernels.lanes.records.step import ONTO_LEFT as LANE_ONTO_LEFT
from rockcli.kernels.lanes.records.step import PEAK as LANE_PEAK
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.rigid.free_outcome import free_rocking, lost_for_good, separatrix
from rockcli.kernels.rigid.ground import NOTHING, SAMPLES
from rockcli.kernels.rigid.layout import (
    ALPHA,
    ETA,
    FELL,
    LEFT,
    PEAK,
    PEAK_SIDE,
    Q_STAR,
    RIGHT,
    T_END,
    T_MOTION,
    T_OVERTURN,
    T_STOP,
    G,
)
from rockcli.kernels.rigid.march import OUTCOME, afterwards
from rockcli.kernels.rigid.readings import set_peak
from rockcli.kernels.rigid.roots import first_root, last_passage, passage, turning_point
from rockcli.kernels.rigid.series import slope, value


@jit_lean
def arrive(st, i, par, linear, tol, margin, detail, order, n_values, dt, velocity, c, sin_q, cos_q, a, a_v, out):
    """A rocking lane at the end of its samples: the motion's, or the report's.

    At the motion's end the outcome of free rocking is known in closed form; what follows is one long sample of zeros.
    """
    q, v, s = st[Q + i], st[V + i], st[SIDE + i]
    e, other = (RIGHT, LEFT) if s > 0.0 else (LEFT, RIGHT)
    verdict = free_rocking(par, e, other, q, v, linear, margin * par[e + ALPHA])
    if st[END + i] < n_values - 1.0:
        out[FELL] = verdict
        if detail == OUTCOME:
            if verdict == FALLS and separatrix(par, e, q, v, linear) < 0.0:  # an impact comes first
                st[IMPACTS + i] += 1.0
            out[T_END] = par[T_MOTION]
            return finish(st, i, verdict, out)
        if verdict == FALLS and v > 0.0 and len(velocity) > 0:
            out[T_END], out[PEAK_SIDE] = par[T_MOTION], s
            return finish(st, i, verdict, out)
        st[PIECE + i], st[END + i], st[X + i] = n_values - 2, n_values - 1, 0.0
        st[LEN + i] = par[T_STOP] - par[T_MOTION]
        st[CAP + i] = dt
        st[SLOW + i] *= BALLISTIC_AFTER / BALLISTIC
        return STANDING
    verdict = out[FELL]
    t = par[T_STOP]
    out[T_END] = t
    if verdict == FALLS:
        out[PEAK_SIDE] = s
    if v > 0.0 and verdict != RETURNS:
        set_peak(par, e, s, q, t, out)
    afterwards(par, e, s, par[G], q, v, t, verdict, linear, tol, order, c, sin_q, cos_q, a, a_v, out)
    return finish(st, i, verdict, out)


@jit_lean
def attend(
    st, i, par, linear, tol, rest_speed, margin, detail, order, values, slopes, blocks, tail, velocity, dt,
    c, guard, sin_q, cos_q, a, a_v, out,
):  # fmt: skip
    """Look at the step lane i tried, go as far as its first event, and see to that."""
    q, h, x0 = st[Q + i], st[H + i], st[X + i]
    c[0] = q
    for k in range(ORDER):
        c[k + 1] = st[COEFFICIENTS + k * WIDTH + i]
    if not abs(c[ORDER]) <= st[SMALL + i]:  # halved too often
        return hand_over(out)
    last = len(values) - 3
    piece = int(st[PIECE + i])
    free = piece > last
    t0 = (par[T_MOTION] if free else piece * dt) + x0
    s = st[SIDE + i]
    e, other = (RIGHT, LEFT) if s > 0.0 else (LEFT, RIGHT)
    path = len(velocity) == 0
    if not (path or free or q < par[e + Q_STAR] or c[1] <= 0.0):
        if lost(st, i, values, slopes, velocity, linear):
            out[T_END], out[PEAK_SIDE] = t0, s
            return finish(st, i, FALLS, out)
        st[LOOK + i] = min(FARTHER * max(q, st[LOOK + i]), HALF_PI)
    skip = 0
    if q == 0.0:
        if c[1] == 0.0:
            c[2] = max(c[2], 0.0)
        skip = 1
        while skip < 4 and c[skip] == 0.0:
            skip += 1
        if c[skip] <= 0.0:
            return hand_over(out)

    # guards
    x = first_root(c, ORDER, 1.0, skip)
    impact = x != NO_ROOT
    if not impact:
        x = 1.0
    fell = False
    reach = 0.0
    for k in range(ORDER, -1, -1):
        reach = reach * x + abs(c[k])
    star = par[e + Q_STAR]
    if reach >= HALF_PI:
        if star == math.inf:
            return hand_over(out)
        for k in range(ORDER + 1):
            guard[k] = -c[k]
        guard[0] = HALF_PI - q
        if linear:
            if value(c, ORDER, x) >= HALF_PI and lost_for_good(
                par, e, par[G], value(c, ORDER, x), slope(c, ORDER, x), free,
                SAMPLES, tail, tail, piece, last, NOTHING, tail, tail, 0, 0,
            ):  # fmt: skip
                fell = True
                if guard[0] > 0.0:
                    x = passage(c, ORDER, HALF_PI, 0.0, x)
        elif guard[0] > 0.0:
            over = first_root(guard, ORDER, x, 0)
            if over != NO_ROOT:
                fell, x = True, over
    if fell:
        impact = False
    v = slope(c, ORDER, x)
    if reach > out[PEAK] and c[1] > 0.0 >= v:
        y = turning_point(c, ORDER, 0.0, x)
        set_peak(par, e, s, value(c, ORDER, y), t0 + y * h, out)
        st[LANE_PEAK + i] = out[PEAK]
    if path and reach >= star:
        passed = last_passage(c, ORDER, star, x, 1)
        if passed != NO_ROOT:
            out[T_OVERTURN] = t0 + passed * h
    v /= h
    if fell:
        out[T_END] = t0 + x * h
        out[PEAK_SIDE] = s
        afterwards(
            par,
            e,
            s,
            par[G],
            value(c, ORDER, x),
            v,
            t0 + x * h,
            FALLS,
            linear,
            tol,
            order,
            c,
            sin_q,
            cos_q,
            a,
            a_v,
            out,
        )
        return finish(st, i, FALLS, out)

    # go there
    st[Q + i], st[V + i] = 0.0 if impact else value(c, ORDER, x), v
    length = st[LEN + i]
    place = x0 + x * h
    if (x == 1.0 and h == length - x0) or place >= length:
        st[PIECE + i] += 1.0
        st[X + i] = 0.0
        at_end = st[PIECE + i] >= st[END + i]
    else:
        st[X + i] = place
        at_end = False
    if impact:
        rate = abs(min(v, 0.0))
        if rate > st[FAST + i]:
            st[IMPACTS + i] += 1.0
            if s > 0.0:
                st[LANE_ONTO_LEFT + i] += 1.0
        st[V + i] = par[other + ETA] * rate
        turn(st, i, par, -s)
        if not at_end and st[V + i] <= st[SLOW + i]:
            state = rest(st, i, par, rest_speed, values, slopes, blocks, tail, dt, out)
            if state != ROCKING:
                return state
    if at_end:
        return arrive(
            st, i, par, linear, tol, margin, detail, order, len(values), dt, velocity, c, sin_q, cos_q, a, a_v, out
        )
    return STANDING


@jit_lean
def lost(st, i, values, slopes, velocity, linear):
    """Whether lane i, beyond the equilibrium and going on, falls whatever the ground still does.

    Out there gravity only helps and the part of the forcing that counts, f = fc cos q + fs sin q, falls as q grows; by
    the mean value theorem the ground takes at most f times its largest later change of velocity (docs/sweeps.md, L6).
    velocity: at each sample, its largest and its least from there on.
    """
    q, v, k, x = st[Q + i], st[V + i], int(st[PIECE + i]), st[X + i]
    force, change = st[FORCING_C + i], 0.0
    if not linear:
        sine, cosine = math.sin(q), math.cos(q)
        force, change = force * cosine + st[FORCING_S + i] * sine, st[FORCING_S + i] * cosine - force * sine
        if st[FREE_0 + i] + st[FREE_S + i] < 0.0 or force * change > 0.0:
            return False
    now = velocity[k, 0] + x * (values[k] + 0.5 * x * slopes[k])
    pull = velocity[k, 1] - now if force < 0.0 else now - velocity[k, 2]
    return v > abs(force) * pull + st[FAST + i]
