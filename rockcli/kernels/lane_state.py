"""What a lane carries: where its numbers stand, how a case gets into a lane and out of it.

The state is one flat array, field by field: number `f` of lane `i` is state[f * LANES + i].
"""

from __future__ import annotations

import math

from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lane_vector import WIDTH
from rockcli.kernels.layout import (
    ALPHA,
    ETA,
    FC,
    FS,
    P2,
    PEAK,
    PEAK_ALPHA,
    PEAK_SIDE,
    Q_STAR,
    R0,
    RC,
    RIGHT,
    RS,
    T_END,
    T_MOTION,
    T_PEAK,
    T_STOP,
    T_UPLIFT,
    THETA_0,
    THETA_DOT_0,
    THRESHOLD,
    G,
)
from rockcli.kernels.layout import FELL as OUT_FELL
from rockcli.kernels.layout import N_IMPACTS as OUT_N_IMPACTS
from rockcli.kernels.layout import N_STEPS as OUT_N_STEPS
from rockcli.kernels.motion import WIDTH as PIECE_WIDTH

LANES = 8 * WIDTH
"""Lanes that run at a time, each at its own pace: enough to fill a vector with those that have an event."""

(
    CASE, MODE, PIECE, T, T_NEXT, H, X, Q, V, S, VERDICT, LAUNCH, N_STEPS, N_IMPACTS, TOP, TOP_SIDE, TOP_T, UP_T,
    L_P, L_ALPHA, L_R0, L_RS, L_RC, L_FC, L_FS, L_GUARD, L_STAR, L_TOP, L_ETA, L_PULL, L_END, L_STOP, L_BOUND, L_LAST,
    KIND, ORIGIN, C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, EVENT, NEW_Q, NEW_V, REACH, FIELDS,
) = range(51)  # fmt: skip
"""CASE row of the case, -1 idle.  T, T_NEXT now and the next breakpoint; H the step, X how far it goes.  TOP* the
peak so far; UP_T uplift.  L_*: constants of the case, p^2 and 1/g multiplied in; L_GUARD uplift |a_g|; L_TOP energy
of the equilibrium; L_PULL p^2 max|f|/g; L_BOUND of |a_g|; L_LAST whether the piece is the last.
KIND, ORIGIN, C*: the piece of the motion (scene/excitation.py).  EVENT, NEW_*: what the step under way comes to;
REACH bound of |q| on it."""

NONE, IMPACT, UPLIFT, DONE, HANDED = 0.0, 1.0, 2.0, 3.0, 4.0
"""EVENT; DONE: the case leaves with its verdict; HANDED: it is left to `march`."""

IDLE, REST, ROCK = -1.0, 0.0, 1.0
"""MODE."""

FREE = -1.0
"""KIND after the motion's end."""

STEEPEST = 9.5
"""|y| up to which exp(-y^2/2) of a bell is computed; the shapes stop at 8.9."""


@jit_lean
def put(state, i, field, value):
    """Write one number of lane i."""
    state[field * LANES + i] = value


@jit_lean
def enter(state, i, case, par, table, pieces, linear):
    """Put a case into lane i; False if it is not for lanes.

    A body that cannot overturn, one that starts far out, one that moves before a bell comes (far from it the series of
    the bell knows nothing of it) and a motion that grazes the threshold are left to `march`.
    """
    star, guard, g, p2 = par[RIGHT + Q_STAR], par[G] * par[RIGHT + THRESHOLD], par[G], par[RIGHT + P2]
    bound = table[13] if pieces > 0 else 0.0
    q, rate = abs(par[THETA_0]), par[THETA_DOT_0]
    if not star < 1.5 or not q < 1.5 or not p2 > 0.0 or abs(bound - guard) <= 1e-9 * guard:
        return False
    for j in range(pieces):
        row = j * PIECE_WIDTH
        w = table[row + 4]
        if table[row + 2] == 2.0:
            if q != 0.0 or rate != 0.0:
                return False
            steep = max(abs(w * (table[row] - table[row + 3])), abs(w * (table[row + 1] - table[row + 3])))
            if not steep <= STEEPEST:
                return False
    state[CASE * LANES + i] = case
    put(state, i, T, 0.0)
    put(state, i, T_NEXT, 0.0)
    put(state, i, Q, q)
    put(state, i, V, 0.0)
    put(state, i, S, 1.0)
    put(state, i, MODE, REST)
    put(state, i, EVENT, NONE)
    put(state, i, LAUNCH, 0.0)
    put(state, i, VERDICT, -1.0)
    put(state, i, N_STEPS, 0.0)
    put(state, i, N_IMPACTS, 0.0)
    put(state, i, TOP, 0.0)
    put(state, i, TOP_SIDE, 0.0)
    put(state, i, TOP_T, math.nan)
    put(state, i, UP_T, math.nan)
    put(state, i, PIECE, -1.0)
    put(state, i, KIND, FREE)
    put(state, i, L_P, math.sqrt(p2))
    put(state, i, L_ALPHA, par[RIGHT + ALPHA])
    put(state, i, L_R0, p2 * par[RIGHT + R0])
    put(state, i, L_RS, p2 * par[RIGHT + RS])
    put(state, i, L_RC, p2 * par[RIGHT + RC])
    put(state, i, L_FC, p2 * par[RIGHT + FC] / g)
    put(state, i, L_FS, p2 * par[RIGHT + FS] / g)
    put(state, i, L_PULL, p2 * math.sqrt(par[RIGHT + FC] ** 2 + par[RIGHT + FS] ** 2) / g)
    put(state, i, L_GUARD, guard)
    put(state, i, L_STAR, star)
    put(state, i, L_ETA, par[RIGHT + ETA])
    put(state, i, L_END, par[T_MOTION])
    put(state, i, L_STOP, par[T_STOP])
    put(state, i, L_BOUND, bound)
    if linear:
        bend = 0.5 * star * star
        height = par[RIGHT + R0] * star + par[RIGHT + RS] * bend
    else:
        half = math.sin(0.5 * star)
        height = par[RIGHT + R0] * star + 2.0 * par[RIGHT + RS] * half * half + par[RIGHT + RC] * math.sin(star)
    state[L_TOP * LANES + i] = p2 * height
    if par[THETA_0] != 0.0 or rate != 0.0:
        lead = par[THETA_0] if par[THETA_0] != 0.0 else rate
        s = 1.0 if lead > 0.0 else -1.0
        state[S * LANES + i], state[V * LANES + i], state[MODE * LANES + i] = s, s * rate, ROCK
        state[UP_T * LANES + i] = 0.0
        state[TOP_SIDE * LANES + i] = s
        if s * rate <= 0.0:
            state[TOP * LANES + i], state[TOP_T * LANES + i] = q, 0.0
    elif bound < guard:  # nothing moves
        state[T * LANES + i] = par[T_MOTION]
    return True


@jit_lean
def next_piece(state, i, table, pieces):
    """The piece of the motion that lane i is in now, and its end."""
    t = state[T * LANES + i]
    end, stop = state[L_END * LANES + i], state[L_STOP * LANES + i]
    if t >= end:
        state[KIND * LANES + i] = FREE
        state[T_NEXT * LANES + i] = stop if t < stop else math.inf
        state[L_LAST * LANES + i] = 1.0
        return
    j = int(state[PIECE * LANES + i])
    while j < 0 or (j < pieces and table[j * PIECE_WIDTH + 1] <= t):
        j += 1
    state[PIECE * LANES + i] = j
    row = j * PIECE_WIDTH
    if j >= pieces:  # silence before the motion's end
        state[KIND * LANES + i] = FREE
        state[T_NEXT * LANES + i] = end
        return
    state[T_NEXT * LANES + i] = min(table[row + 1], end)
    state[KIND * LANES + i] = table[row + 2]
    state[ORIGIN * LANES + i] = table[row]
    state[L_LAST * LANES + i] = 1.0 if j == pieces - 1 else 0.0
    for k in range(10):
        state[(C0 + k) * LANES + i] = table[row + 3 + k]
    if table[row + 2] == 2.0 and state[MODE * LANES + i] == REST:
        state[T * LANES + i] = max(t, min(_wakes(state, i), state[T_NEXT * LANES + i]))


@jit_lean
def _wakes(state, i):
    """Time before which a bell cannot lift the body: left of it |d| exp(-y^2/2) is below the threshold."""
    d0, d1 = abs(state[C2 * LANES + i]), abs(state[C3 * LANES + i])
    d2, d3 = abs(state[C4 * LANES + i]), abs(state[C5 * LANES + i])
    w, y = state[C1 * LANES + i], STEEPEST
    for _ in range(3):  # decreases towards the largest root, as y^k exp(-y^2/2) falls beyond sqrt 3
        more = d0 + y * (d1 + y * (d2 + y * d3))
        y = math.sqrt(max(2.0 * math.log(max(more / state[L_GUARD * LANES + i], 1.0)), 3.0))
    return state[C0 * LANES + i] - y / w


@jit_lean
def leave(state, i, verdict, out):
    """Take the case out of lane i: its results in the layout of `march`."""
    out[OUT_FELL] = verdict
    out[OUT_N_IMPACTS] += state[N_IMPACTS * LANES + i]
    out[OUT_N_STEPS] = state[N_STEPS * LANES + i]
    out[PEAK], out[PEAK_SIDE] = state[TOP * LANES + i], state[TOP_SIDE * LANES + i]
    out[PEAK_ALPHA] = state[L_ALPHA * LANES + i] if state[TOP * LANES + i] > 0.0 else 1.0
    out[T_PEAK], out[T_UPLIFT] = state[TOP_T * LANES + i], state[UP_T * LANES + i]
    out[T_END] = state[T * LANES + i]
    if verdict == 1.0:
        out[PEAK_SIDE] = state[S * LANES + i]
    state[MODE * LANES + i] = IDLE
