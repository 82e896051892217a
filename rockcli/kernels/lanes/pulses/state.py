"""What a lane carries: where its numbers stand, how a case gets into a lane and out of it.

The lanes of a vector lie together, number by number, and with them the series they are expanded in: number `f` of the
lane that begins at i is state[i + f * WIDTH].  A vector is named by the place of its first lane's first number.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FALLS, NOT_YET
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import exp_of_negative, sin_cos
from rockcli.kernels.lanes.vector.plain import load, select, some, store
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.ground import BELL as BELL
from rockcli.kernels.rigid.ground import WIDTH as PIECE_WIDTH
from rockcli.kernels.rigid.law import edge_of, potential

VECTORS = 8
"""Vectors that run at a time: enough lanes to fill a vector with those that have an event."""

(
    CASE, MODE, PIECE, T, T_NEXT, H, X, Q, V, S, VERDICT, LAUNCH, N_STEPS, N_IMPACTS, UP_T,
    L_SIDE, TOP, TOP_T, L_P, L_ALPHA, L_R0, L_RS, L_RC, L_FC, L_FS, L_ALONG, L_ACROSS, L_GUARD, L_STAR, L_TOP, L_CREST,
    L_LONGEST, L_ETA,
    L_PULL, L_EXTENT, L_MASS, L_SIN, L_COS, L_SHAKE, L_WEIGHT, L_GRIP, L_END, L_STOP, L_GIVEN,
    L_BOUND, KIND, ORIGIN, C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, EVENT, NEW_Q, NEW_V, REACH, BRACKET, BREADTH, SINE,
    COSINE, BELL_E, TOP_SIDE, FACET, OUTSIDE_LEFT, OUTSIDE_RIGHT, TILT, FLOOR, BRIM, SWAY, KEEP_LEFT, KEEP_RIGHT,
    RESTS_ON, PEAK_LEFT, PEAK_RIGHT, PEAK_LEFT_T, PEAK_RIGHT_T,
    RATE_MAX, MU_MOST, WORK, LOST, SWUNG, SWUNG_T, MU_UP, ONTO_LEFT, ONTO_RIGHT, PUSHED, N_UP, N_LEAST, OVER_T,
    OTHER,
) = range(95)  # fmt: skip
"""CASE row of the case, -1 idle.  T, T_NEXT now and the next breakpoint; H the step, X how far it goes.  UP_T uplift.
L_*: constants of the case, p^2 and 1/g multiplied in; L_ALONG, L_ACROSS: the restoring
moment as r0 + along f + across df/dq, f = fc cos q + fs sin q; L_GUARD uplift |a_g|; L_TOP energy of the equilibrium,
L_CREST the rate sqrt(2 L_TOP) at q = 0 that just reaches it; L_LONGEST the longest step; L_PULL p^2 max|f|/g; L_BOUND
of |a_g|; L_GIVEN whether the report ends at a given time.  KIND, ORIGIN, C*: the piece of the motion
(scene/ground/excitation.py).  EVENT, NEW_*: what the step under way comes to; REACH bound of |q| on it, BRACKET where
the part of it with a turning point begins, and BREADTH how long that is, as shares of X.
SINE, COSINE of q (q, 1 if linear), BELL_E exp(-y^2/2): now.
What goes with an edge, L_SIDE to L_GRIP, is that of the edge the body turns about; of a body with two different edges
that of the other one, in the same order, stands from OTHER on, and the two change places as the body turns over.
TOP, TOP_T: the peak so far, of a body with two different edges that of its side; TOP_SIDE where it was.
Of a body that rolls (`rolling`) the two edges are the ends of a facet, L_EXTENT to FACET and on.
Of one whose path is followed (`path`) L_EXTENT is a quarter turn on two edges, L_SIN and L_COS are of alpha, L_SHAKE
is 1/R, L_WEIGHT g/R, L_GRIP |a_g|/g at uplift; RATE_MAX to OVER_T are its results, of one that rolls ONTO_* since it
came to its facet.
After the fields come the coefficients of q, orders 0 to ORDER and four more that stay zero, then those of a_g."""

OF_PLAIN, OF_ROLLING, OF_EDGE = L_PULL + 1 - L_SIDE, L_MASS + 1 - L_SIDE, L_GRIP + 1 - L_SIDE
"""Fields that go with an edge: of bodies on two edges, of those that roll, of those whose path is followed."""

FIELDS = OTHER + OF_EDGE

ORDER = 18
"""Of the series: about where a case costs least."""

LONGEST = 2.0
"""Longest step, over 1/p."""

STRIDE = (FIELDS + 2 * ORDER + 6) * WIDTH
"""Numbers of a vector with its series."""

TO_OTHER = (OTHER - L_SIDE) * WIDTH
"""From a number that goes with the edge under a body to that of its other edge."""

NONE, IMPACT, TOUCH, UPLIFT, DONE, FOR_MARCH = 0.0, 1.0, 1.5, 2.0, 3.0, 4.0
"""EVENT; TOUCH: the next facet lies flat; DONE: the case leaves with its verdict; FOR_MARCH: it is left to `march`."""

IDLE, REST, ROCK = -1.0, 0.0, 1.0
"""MODE."""

FREE = -1.0
"""KIND after the motion's end."""


@jit
def series_of_q(o):
    """Where the coefficients of q of the vector or lane at o begin."""
    return o + FIELDS * WIDTH


@jit
def series_of_a(o):
    """Where the coefficients of a_g of the vector or lane at o begin."""
    return o + (FIELDS + ORDER + 5) * WIDTH


@jit
def put(state, i, field, value):
    """Write one number of lane i."""
    state[i + field * WIDTH] = value


@jit
def enter(state, i, case, par, table, pieces, linear, two_sided, energy, t_uplift, side, bell_e):
    """Put a case into lane i; False if it is not for lanes.

    `energy` of the equilibrium; `t_uplift`: when a bell first lifts the body that stands, NaN if that is to be found on
    the way, with the side it rocks to and exp(-y^2/2) then (`uplift_screen`).
    A body that cannot overturn, one that starts far out, one that a bell may lift at a time that is not known and a
    motion that grazes the threshold are left to `march`.
    """
    bound = table[13] if pieces > 0 else 0.0
    guard = par[at.G] * min(par[at.LEFT + at.THRESHOLD], par[at.RIGHT + at.THRESHOLD])
    q, rate = abs(par[at.THETA_0]), par[at.THETA_DOT_0]
    moves = q != 0.0 or rate != 0.0
    for e in (at.LEFT, at.RIGHT):
        graze = par[at.G] * par[e + at.THRESHOLD]
        if not par[e + at.Q_STAR] < 1.5 or not par[e + at.P2] > 0.0 or abs(bound - graze) <= 1e-9 * graze:
            return False
        if not (par[e + at.FC] ** 2 + par[e + at.FS] ** 2 > 0.0):
            return False
    if not q < 1.5:
        return False
    lifted = t_uplift >= 0.0
    if not (lifted or moves) and bound >= guard:
        for j in range(pieces):
            if table[j * PIECE_WIDTH + 2] == BELL:
                return False
    s = 1.0
    if moves:
        lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else rate
        s = 1.0 if lead > 0.0 else -1.0
    elif lifted:
        s = side
    first, second = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
    put_edge(state, i, edge_of(par, first), s, par[first + at.Q_STAR])
    put_top(state, i, energy)
    if two_sided:
        put_edge(state, i + TO_OTHER, edge_of(par, second), -s, par[second + at.Q_STAR])
        put_top(state, i, equilibrium(par, first, linear))
        put_top(state, i + TO_OTHER, equilibrium(par, second, linear))
    put(state, i, CASE, case)
    put(state, i, T, 0.0)
    put(state, i, T_NEXT, 0.0)
    put(state, i, Q, q)
    put(state, i, V, 0.0)
    put(state, i, S, s)
    put(state, i, MODE, REST)
    put(state, i, EVENT, NONE)
    put(state, i, LAUNCH, 0.0)
    put(state, i, VERDICT, 1.0 * NOT_YET)
    put(state, i, N_STEPS, 0.0)
    put(state, i, N_IMPACTS, 0.0)
    put(state, i, TOP_SIDE, 0.0)
    put(state, i, UP_T, math.nan)
    put(state, i, PIECE, -1.0)
    put(state, i, KIND, FREE)
    put(state, i, L_END, par[at.T_MOTION])
    put(state, i, L_STOP, par[at.T_STOP])
    put(state, i, L_GIVEN, par[at.HAS_DURATION])
    put(state, i, L_BOUND, bound)
    put(state, i, SINE, 0.0)
    put(state, i, COSINE, 1.0)
    if moves:
        put(state, i, V, s * rate)
        put(state, i, MODE, ROCK)
        put(state, i, UP_T, 0.0)
        put(state, i, TOP_SIDE, s)
        if s * rate <= 0.0:
            put(state, i, TOP, q)
            put(state, i, TOP_T, 0.0)
        sine, cosine = sin_cos(q)
        if linear:
            sine, cosine = q, 1.0
        put(state, i, SINE, sine)
        put(state, i, COSINE, cosine)
        if pieces > 0 and table[2] == BELL:
            y = table[4] * table[3]
            put(state, i, BELL_E, exp_of_negative(-0.5 * y * y))
    elif lifted:
        put(state, i, T, t_uplift)
        put(state, i, MODE, ROCK)
        put(state, i, LAUNCH, 1.0)
        put(state, i, UP_T, t_uplift)
        put(state, i, BELL_E, bell_e)
    elif bound < guard:  # nothing moves
        put(state, i, T, par[at.T_MOTION])
    return True


@jit
def put_edge(state, i, edge, s, star):
    """What goes with an edge, that of the side s, with its equilibrium at `star`; without a peak."""
    g, p2 = edge.g, edge.p2
    fc, fs = p2 * edge.fc / g, p2 * edge.fs / g
    r0, rs, rc = p2 * edge.r0, p2 * edge.rs, p2 * edge.rc
    force = fc * fc + fs * fs
    put(state, i, L_SIDE, s)
    put(state, i, TOP, 0.0)
    put(state, i, TOP_T, math.nan)
    p = math.sqrt(p2)
    put(state, i, L_P, p)
    put(state, i, L_LONGEST, LONGEST / p)
    put(state, i, L_ALPHA, edge.alpha)
    put(state, i, L_R0, r0)
    put(state, i, L_RS, rs)
    put(state, i, L_RC, rc)
    put(state, i, L_FC, fc)
    put(state, i, L_FS, fs)
    put(state, i, L_ALONG, (rc * fc + rs * fs) / force)
    put(state, i, L_ACROSS, (rc * fs - rs * fc) / force)
    put(state, i, L_GUARD, g * edge.threshold)
    put(state, i, L_STAR, star)
    put(state, i, L_ETA, edge.eta)
    put(state, i, L_PULL, math.sqrt(force))


@jit
def put_top(state, i, energy):
    """The energy of the equilibrium of the edge of lane i."""
    put(state, i, L_TOP, energy)
    put(state, i, L_CREST, math.sqrt(max(2.0 * energy, 0.0)))


@jit
def equilibrium(par, e, linear):
    """Energy of the equilibrium of an edge, as L_TOP has it."""
    star, p2 = par[e + at.Q_STAR], par[e + at.P2]
    bend, sine = 0.5 * star * star, star
    if not linear:
        half = math.sin(0.5 * star)
        bend, sine = 2.0 * half * half, math.sin(star)
    return potential(p2 * par[e + at.R0], p2 * par[e + at.RC], star, p2 * par[e + at.RS] * bend, sine)


@jit
def to_the_edge(state, o, fields):
    """Where a body of the vector at o is on the side of its other edge, so many `fields` of the two change places."""
    side = load(state, o + L_SIDE * WIDTH)
    over = side * load(state, o + S * WIDTH) < 0.0
    if some(over):
        for field in range(fields):
            here, there = o + (L_SIDE + field) * WIDTH, o + (OTHER + field) * WIDTH
            one, other = load(state, here), load(state, there)
            store(state, here, select(over, other, one))
            store(state, there, select(over, one, other))


@jit
def next_piece(state, i, table, pieces):
    """The piece of the motion that lane i is in now, and its end."""
    t = state[i + T * WIDTH]
    end, stop = state[i + L_END * WIDTH], state[i + L_STOP * WIDTH]
    if t >= end:
        put(state, i, KIND, FREE)
        put(state, i, T_NEXT, stop if t < stop else math.inf)
        return
    j = int(state[i + PIECE * WIDTH])
    while j < 0 or (j < pieces and table[j * PIECE_WIDTH + 1] <= t):
        j += 1
    put(state, i, PIECE, j)
    row = j * PIECE_WIDTH
    if j >= pieces:  # silence before the motion's end
        put(state, i, KIND, FREE)
        put(state, i, T_NEXT, end)
        return
    put(state, i, T_NEXT, min(table[row + 1], end))
    put(state, i, KIND, table[row + 2])
    put(state, i, ORIGIN, table[row])
    for k in range(10):
        put(state, i, C0 + k, table[row + 3 + k])


@jit
def leave(state, i, two_sided, verdict, out):
    """Take the case out of lane i: its results in the layout of `march`."""
    s = state[i + S * WIDTH]
    if state[i + L_GIVEN * WIDTH] > 0.0 and state[i + MODE * WIDTH] == ROCK and state[i + V * WIDTH] > 0.0:
        q = state[i + Q * WIDTH]  # cut off while it rises
        if q > state[i + TOP * WIDTH] * (1.0 + 1e-12):
            put(state, i, TOP, q)
            put(state, i, TOP_T, state[i + T * WIDTH])
            put(state, i, TOP_SIDE, s)
    out[to.VERDICT] = verdict
    out[to.N_IMPACTS] += state[i + N_IMPACTS * WIDTH]
    out[to.N_STEPS] = state[i + N_STEPS * WIDTH]
    top = state[i + TOP * WIDTH]
    out[to.PEAK], out[to.PEAK_SIDE] = top, state[i + TOP_SIDE * WIDTH]
    out[to.PEAK_ALPHA] = state[i + L_ALPHA * WIDTH] if top > 0.0 else 1.0
    out[to.T_PEAK], out[to.T_UPLIFT] = state[i + TOP_T * WIDTH], state[i + UP_T * WIDTH]
    if two_sided:
        there = i + TO_OTHER
        second = state[there + TOP * WIDTH]
        out[to.PEAK_SIDE] = state[i + L_SIDE * WIDTH]
        right = out[to.PEAK_SIDE] > 0.0
        out[to.PEAK_RIGHT], out[to.PEAK_LEFT] = (top, second) if right else (second, top)
        if second > top:
            out[to.PEAK], out[to.PEAK_SIDE] = second, -out[to.PEAK_SIDE]
            out[to.PEAK_ALPHA], out[to.T_PEAK] = state[there + L_ALPHA * WIDTH], state[there + TOP_T * WIDTH]
    out[to.T_END] = max(out[to.T_END], state[i + T * WIDTH])  # later where its bounces have been counted
    if verdict == FALLS:
        out[to.PEAK_SIDE] = s
    put(state, i, MODE, IDLE)
