"""Bodies that roll in the lanes of records: the next facet, barriers, the end (docs/rolling.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, FAST, MEANINGFUL, NO_ROOT, RETURNS, UNDECIDED
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.facets import (
    BODY,
    EXTENT_LEFT,
    EXTENT_RIGHT,
    FACET,
    RISEN,
    SCALE,
    TILT,
    barrier_of,
    note_pushes,
    put_facet,
)
from rockcli.kernels.lanes.records.forces import account, drive, weigh_end
from rockcli.kernels.lanes.records.rest import STANDING, finish, ground, hand_over, turn
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import edge_of
from rockcli.kernels.rigid.march import ALL, OUTCOME
from rockcli.kernels.rigid.readings import set_peak
from rockcli.kernels.rigid.roots import first_root, last_passage
from rockcli.kernels.rolling import parameters as of
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.bounces import impacts_until, swings_low, swings_softly
from rockcli.kernels.rolling.free_rolling import free_rolling
from rockcli.kernels.rolling.law import end_of, energy


@jit
def time_of(st, i, par):
    """Where lane i is in the time of its body [s]."""
    piece = st[lane.PIECE + i]
    if piece > st[lane.LAST + i] + 1.0:
        return par[at.T_STOP]
    begun = par[at.T_MOTION] if piece > st[lane.LAST + i] else (piece - st[lane.FIRST + i]) * st[lane.DT + i]
    return begun + st[lane.X + i]


@jit
def touch_next(st, i, par, c, guard, x, reach):
    """Whether the next facet touches before the fraction x of the step that lane i tries, and where, or x.

    c: coefficients; reach: bound of q up to x.
    """
    extent = par[EXTENT_RIGHT if st[lane.SIDE + i] > 0.0 else EXTENT_LEFT]
    if reach >= extent:
        for k in range(lane.ORDER + 1):
            guard[k] = -c[k]
        guard[0] = extent - c[0]
        touch = first_root(guard, lane.ORDER, x, 0) if guard[0] > 0.0 else 0.0
        if touch != NO_ROOT:
            return True, touch
    return False, x


@jit
def passage_of(par, s, c, guard, x, reach):
    """The last outward passage of a last barrier up to the fraction x of a step, or NO_ROOT."""
    level = barrier_of(par, s)
    if level < 0.0 or reach < level:
        return NO_ROOT
    if s * par[TILT] >= 0.0:
        return last_passage(c, lane.ORDER, level, x, 1)
    for k in range(lane.ORDER + 1):
        guard[k] = -c[k]
    return last_passage(guard, lane.ORDER, -level, x, 1)


@jit
def roll_over(st, i, par, bodies, values, slopes, path, watch, out):
    """Lane i has come to where the next facet touches, at the rate it has there: it turns about that one's far end.

    FINISHED if there is none: it lies on its side.  `path`, `watch`: as in `impacts.land`.
    """
    body, s, rate = bodies[int(par[BODY])], st[lane.SIDE + i], abs(st[lane.V + i])
    t = time_of(st, i, par)
    facet, extent = int(par[FACET]) + (1 if s > 0.0 else -1), par[EXTENT_RIGHT if s > 0.0 else EXTENT_LEFT]
    if watch:
        st[lane.WORK + i] -= ground(st, i, values, slopes) * drive(st, i, extent, False)
    if facet < 0 or facet >= int(body[of.COUNT]):
        if math.isnan(out[to.T_OVERTURN]):
            out[to.T_OVERTURN] = t
        st[lane.Q + i] = extent
        out[to.T_END] = min(t, par[at.T_STOP])
        if watch:
            account(st, i, energy_of(par, body, s, extent, rate), out)
        return finish(st, i, par, FALLS, out)
    note_pushes(st, i, par, out)
    inertia = st[lane.INERTIA + i]
    put_facet(par, body, facet)
    e = at.RIGHT if s > 0.0 else at.LEFT
    pace = rate / (math.sqrt(par[e + at.P2]) * par[SCALE])
    if path:
        carried = pace * pace - MEANINGFUL * MEANINGFUL
        if carried > 0.0:
            st[lane.SWINGS + i] += carried
            st[lane.SWINGS_T + i] += carried * t
    if pace > FAST:
        st[lane.IMPACTS + i] += 1.0
        if s < 0.0:
            st[lane.ONTO_LEFT + i] += 1.0
    if par[TILT] != 0.0:
        set_peak(1.0, 1.0 if par[TILT] > 0.0 else -1.0, abs(par[TILT]), t, 0.0, out)
    st[lane.Q + i], st[lane.V + i] = 0.0, par[e + at.ETA] * rate
    turn(st, i, par, s, out)
    if watch:
        st[lane.LOST + i] += 0.5 * (inertia * rate**2 - st[lane.INERTIA + i] * st[lane.V + i] ** 2)
    return STANDING


@jit
def energy_of(par, body, s, q, v):
    """Energy over m g of a body that turns about the end on side s of its facet, less that on the stand."""
    end = end_of(body, par[at.G], int(par[FACET]), s)
    return par[RISEN] + energy(end, q, v) - end.height


@jit
def arrive_rolling(st, i, par, bodies, how, values, out):
    """A lane at the end of its samples: the motion's, after which the outcome is known, or the report's."""
    body, g, facet = bodies[int(par[BODY])], par[at.G], int(par[FACET])
    q, v, s = st[lane.Q + i], st[lane.V + i], st[lane.SIDE + i]
    last, edge = st[lane.LAST + i], edge_of(par, at.RIGHT if s > 0.0 else at.LEFT)
    if st[lane.END + i] == last:
        verdict, rests_on, hits = free_rolling(body, g, facet, s, q, v, how.margin * par[SCALE])
        out[to.VERDICT], out[also.FACET] = verdict, rests_on
        if how.detail == OUTCOME:
            if verdict == FALLS:
                st[lane.IMPACTS + i] += hits
            out[to.T_END] = par[at.T_MOTION]
            return finish(st, i, par, verdict, out)
        if verdict == FALLS and hits > 0:
            out[to.STRUCK_LATER] = 1.0
        if verdict == UNDECIDED:
            return hand_over(out)
        if how.detail == ALL:
            st[lane.WORK + i] -= values[int(last)] * drive(st, i, q, False)
            weigh_end(st, i, edge, s, q, v, values[int(last)] * par[at.FACTOR_H], 0.0, False)
        st[lane.PIECE + i], st[lane.END + i], st[lane.X + i] = last + 1.0, last + 2.0, 0.0
        st[lane.LEN + i] = par[at.T_STOP] - par[at.T_MOTION]
        st[lane.CAP + i] = st[lane.DT + i]
        turn(st, i, par, s, out)  # whose bounces are other ones from now on
        return STANDING
    # the swing under way still has its peak, or its passage of the last barrier
    verdict, theta = out[to.VERDICT], par[TILT] + s * q
    out[to.T_END] = par[at.T_STOP]
    if how.detail == ALL:
        weigh_end(st, i, edge, s, q, v, 0.0, 0.0, False)
        account(st, i, energy_of(par, body, s, q, v), out)
    inward = s * v * theta <= 0.0
    if verdict == FALLS:
        passed = not inward and not body[of.FALL_LEFT] <= theta <= body[of.FALL_RIGHT]
        return finish(st, i, par, FALLS, out) if passed else hand_over(out)
    if inward or swings_lower(body, g, facet, s, q, v, out):
        return finish(st, i, par, verdict, out)
    return hand_over(out)


@jit
def swings_lower(body, g, facet, s, q, v, out):
    """Whether no later swing of a body that returns is higher than its peaks."""
    if body[of.VALLEY] < 0.0 or body[of.LOSSLESS] == 1.0:
        return False
    end = end_of(body, g, facet, s)
    rate2 = 2.0 * end.p2 * (energy(end, q, v) - end.height) / end.radius
    return rate2 >= 0.0 and swings_low(
        body, g, facet, s, math.sqrt(rate2), out[to.PEAK_LEFT], out[to.PEAK_RIGHT], False
    )


@jit
def bounce(st, i, par, bodies, rest_speed, path, watch, out):
    """Lane i has landed after the motion: FINISHED if no later swing is higher than the peaks, its impacts counted.

    With `watch` also only where the forces on these swings are of no account.
    """
    body = bodies[int(par[BODY])]
    if out[to.VERDICT] != RETURNS or body[of.VALLEY] < 0.0 or body[of.LOSSLESS] == 1.0:
        return STANDING
    g, facet, s, v, stop = par[at.G], int(par[FACET]), st[lane.SIDE + i], st[lane.V + i], par[at.T_STOP]
    if not swings_low(body, g, facet, s, v, out[to.PEAK_LEFT], out[to.PEAK_RIGHT], path):
        return STANDING
    rate, least, most = st[lane.RATE_MAX + i], st[lane.N_LEAST + i], st[lane.MU_MOST + i]
    if watch and not swings_softly(body, g, facet, s, v, rate, least, most):
        return STANDING
    t = time_of(st, i, par)
    more, until, swung, swung_t, push = impacts_until(body, g, facet, s, v, t, stop, rest_speed, path)
    note_pushes(st, i, par, out)
    out[also.MU_IMPACT] = max(out[also.MU_IMPACT], push)
    st[lane.IMPACTS + i] += more
    st[lane.IMPACTS_BEFORE + i] += more
    if path:
        out[to.T_END] = until
        st[lane.SWINGS + i] += swung
        st[lane.SWINGS_T + i] += swung_t
    if watch:
        account(st, i, energy_of(par, body, s, 0.0, v), out)
    return finish(st, i, par, RETURNS, out)
