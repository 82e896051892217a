"""The mode REST of a lane: where a body begins, comes to rest, is lifted, and where it ends (docs/sweeps.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import FAST as COUNTED
from rockcli.kernels.constants import RETURNS, STANDSTILL
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.records.step import (
    CAP,
    END,
    FAST,
    FORCING_C,
    FORCING_S,
    FREE_0,
    FREE_C,
    FREE_S,
    HALF_PI,
    IMPACTS,
    LEN,
    LOOK,
    PIECE,
    SETTLING,
    SIDE,
    SLOW,
    SMALL,
    STEPS,
    Q,
    V,
    X,
)
from rockcli.kernels.lanes.records.step import ETA as LANE_ETA
from rockcli.kernels.lanes.records.step import ONTO_LEFT as LANE_ONTO_LEFT
from rockcli.kernels.lanes.records.step import PEAK as LANE_PEAK
from rockcli.kernels.rigid.layout import (
    ALPHA,
    ETA,
    FACTOR_H,
    FC,
    FELL,
    FS,
    LEFT,
    N_IMPACTS,
    N_MIN,
    N_OUT,
    N_STANDING,
    N_STEPS,
    ONTO_LEFT,
    ONTO_RIGHT,
    P2,
    PEAK,
    PEAK_ALPHA,
    PEAK_SIDE,
    Q_STAR,
    R0,
    RC,
    RIGHT,
    RS,
    STATUS,
    T_END,
    T_MOTION,
    T_OVERTURN,
    T_PEAK,
    T_UPLIFT,
    THETA_0,
    THETA_DOT_0,
    THRESHOLD,
    G,
)
from rockcli.kernels.rigid.readings import set_peak

FINISHED, STANDING, ROCKING = 0, 1, 2
"""What becomes of a lane: its body is done, or goes on from where it is; ROCKING: it does not come to rest."""

HANDED_OVER = 3
"""STATUS of a body that needs the single-body kernels."""

FARTHER = 1.25
"""Rotations at which a body beyond the equilibrium is looked at, each over the one before."""

BLOCK = 64
"""Samples per block of the bounds."""

NEARLY_STEADY = 5e-5
"""Change of the moment from one impact to the next, relative, below which it is taken to first order."""

BALLISTIC, BALLISTIC_AFTER = 1e-2, 1e-4
"""Impacts slower than this fraction of p alpha bounce under a constant moment, during the motion and after it."""


@jit_lean
def begin(st, i, par, tol, values, slopes, blocks, tail, path, dt, out):
    """Put a body into lane i, unless nothing ever lifts it: then it is FINISHED."""
    for k in range(N_OUT):
        out[k] = 0.0
    out[T_PEAK] = out[T_UPLIFT] = out[T_OVERTURN] = math.nan
    out[N_MIN] = out[N_STANDING] = math.inf
    out[PEAK_ALPHA] = 1.0
    p2 = par[RIGHT + P2]
    st[FREE_0 + i], st[FREE_S + i], st[FREE_C + i] = (
        -p2 * par[RIGHT + R0], -p2 * par[RIGHT + RS], -p2 * par[RIGHT + RC],
    )  # fmt: skip
    # the first term left out is at most an eighth of the last one kept: a hundredth of what the level allows, as an
    # error may grow with every impact, and it costs a tenth more steps
    st[SMALL + i] = 0.08 * tol * par[RIGHT + ALPHA]
    st[LANE_PEAK + i] = 0.0
    # who does not ask when it passes the equilibrium looks where it is farther from there, and mostly lost
    star = par[RIGHT + Q_STAR]
    st[LOOK + i] = star if path else min(FARTHER * star, max(star, HALF_PI))
    st[STEPS + i] = st[IMPACTS + i] = st[LANE_ONTO_LEFT + i] = 0.0
    p_alpha = math.sqrt(p2) * par[RIGHT + ALPHA]
    st[LANE_ETA + i], st[FAST + i], st[SLOW + i] = par[RIGHT + ETA], COUNTED * p_alpha, BALLISTIC * p_alpha
    # the sum of the bounces is least where the ground presses more on the edge of the first
    eta = par[RIGHT + ETA]
    st[SETTLING + i] = (1.0 + math.sqrt(eta)) ** 2 / ((1.0 - eta * eta) * p2 * (par[RIGHT + R0] + par[RIGHT + RC]))
    st[PIECE + i], st[X + i], st[LEN + i], st[CAP + i] = 0.0, 0.0, dt, math.inf
    st[END + i] = len(values) - 3.0
    if par[THETA_0] == 0.0 and par[THETA_DOT_0] == 0.0:
        return lift(st, i, par, values, slopes, blocks, tail, dt, out)
    lead = par[THETA_0] if par[THETA_0] != 0.0 else par[THETA_DOT_0]
    s = 1.0 if lead > 0.0 else -1.0
    q, v = abs(par[THETA_0]), s * par[THETA_DOT_0]
    out[T_UPLIFT] = 0.0
    out[PEAK_SIDE] = s
    if q >= par[RIGHT + Q_STAR]:
        out[T_OVERTURN] = 0.0
    if v <= 0.0:
        set_peak(par, RIGHT, s, q, 0.0, out)
        st[LANE_PEAK + i] = q
    st[Q + i], st[V + i] = q, v
    turn(st, i, par, s)
    return STANDING


@jit_lean
def turn(st, i, par, s):
    """Put lane i on side s."""
    st[SIDE + i] = s
    force = -par[RIGHT + P2] * s * par[FACTOR_H] / par[G]
    st[FORCING_C + i], st[FORCING_S + i] = force * par[RIGHT + FC], force * par[RIGHT + FS]


@jit_lean
def lift(st, i, par, values, slopes, blocks, tail, dt, out):
    """From rest at a time in a sample: put lane i where it uplifts next, or FINISHED if it never does.

    Samples that cannot open the guard are not looked at: the next that can is found by the bounds of blocks.
    """
    g, factor = par[G], par[FACTOR_H]
    quiet = g * par[RIGHT + THRESHOLD]
    last = len(values) - 3
    k, x = int(st[PIECE + i]), st[X + i]
    if k < last and factor != 0.0:
        level = quiet / abs(factor) * (1.0 - 1e-12)
        while tail[k] * abs(factor) > quiet:
            at = (values[k] + slopes[k] * x) * factor
            rate = slopes[k] * factor
            best, s_up = math.inf, 0.0
            for sign in (-1.0, 1.0):
                d, dd = quiet + sign * at, sign * rate
                y = math.inf
                if d < 0.0:
                    y = 0.0
                elif dd < 0.0:
                    y = 0.0 if d <= 1e-15 * quiet else (d + 2e-15 * quiet) / -dd  # open beyond rounding
                if y <= dt - x and y < best:
                    best, s_up = y, sign
            if s_up != 0.0 and x + best >= dt:  # at the sample's end: what counts is the next one's slope
                k += 1
                x = 0.0
                if k >= last:
                    break
                continue
            if s_up != 0.0:
                st[PIECE + i], st[X + i], st[Q + i], st[V + i] = k, x + best, 0.0, 0.0
                turn(st, i, par, s_up)
                if math.isnan(out[T_UPLIFT]):
                    out[T_UPLIFT] = k * dt + (x + best)
                return STANDING
            k += 1
            x = 0.0
            j = following(values, blocks, level, k, last)
            if j > last:
                break
            k = max(k, j - 1)
            if k >= last:
                break
    out[T_END] = par[T_MOTION]
    return finish(st, i, RETURNS, out)


@jit_lean
def following(values, blocks, level, k, last):
    """First sample from k on whose modulus reaches the level, or last + 1."""
    while k <= last:
        if k % BLOCK == 0:
            while blocks[k // BLOCK] < level:
                k += BLOCK
                if k > last:
                    return last + 1
        if abs(values[k]) >= level:
            return k
        k += 1
    return k


@jit_lean
def finish(st, i, verdict, out):
    """Note how it ended."""
    out[FELL] = verdict
    out[N_STEPS], out[N_IMPACTS] = st[STEPS + i], st[IMPACTS + i]
    out[ONTO_LEFT], out[ONTO_RIGHT] = st[LANE_ONTO_LEFT + i], st[IMPACTS + i] - st[LANE_ONTO_LEFT + i]
    return FINISHED


@jit_lean
def park(st, i):
    """Leave lane i without a body: in a sample without end, where no event comes of it."""
    st[Q + i], st[V + i], st[X + i], st[PIECE + i], st[END + i] = 1.0, 0.0, 0.0, 0.0, math.inf
    st[LEN + i], st[CAP + i], st[SMALL + i], st[LOOK + i] = math.inf, 1.0, 0.0, math.inf
    st[FORCING_C + i] = st[FORCING_S + i] = st[FREE_0 + i] = st[FREE_S + i] = st[FREE_C + i] = 0.0


@jit_lean
def hand_over(out):
    """Leave the body to the single-body kernels."""
    out[STATUS] = HANDED_OVER
    return FINISHED


@jit_lean
def rest(st, i, par, rest_speed, values, slopes, blocks, tail, dt, out):
    """Whether the body of lane i, just turned over, comes to rest inside this sample; if so, what then.

    Slow bounces are flights under a moment linear in time; each is solved for its end and its impact counted.
    """
    s, v = st[SIDE + i], st[V + i]
    e = RIGHT if s > 0.0 else LEFT
    p = math.sqrt(par[e + P2])
    p_alpha = p * par[e + ALPHA]
    k, x = int(st[PIECE + i]), st[X + i]
    left = st[LEN + i] - x
    press = par[e + P2] * (par[e + R0] + par[e + RC])
    force = s * par[e + P2] * par[e + FC] * par[FACTOR_H] / par[G]
    u0, u1 = force * (values[k] + slopes[k] * x), force * slopes[k]
    eta = par[e + ETA]
    still = STANDSTILL * p_alpha
    if abs(u0) >= press:  # a standing body that the ground just fails to lift must not bounce on one spot for ever
        return lift(st, i, par, values, slopes, blocks, tail, dt, out) if v <= still else ROCKING
    if v > still and eta >= 1.0:
        return ROCKING
    y, rate, turned = 0.0, v, 1.0
    counted = onto_left = 0.0
    if v > still:
        whole = 2.0 * v * (1.0 / (press + u0) + eta / (press - u0)) / (1.0 - eta * eta)
        lowest = press - max(abs(u0), abs(u0 + u1 * whole))
        if whole > left or lowest <= 0.0 or 0.5 * v * v / lowest > out[PEAK]:
            return ROCKING
        slow = rest_speed * p * math.sin(par[e + ALPHA])
        straight = NEARLY_STEADY * lowest * lowest / abs(u1)
        while rate > slow and rate > straight:
            D, D1 = press + turned * (u0 + u1 * y), turned * u1
            flight = 2.0 * rate / (0.5 * D + math.sqrt(0.25 * D * D + 2.0 / 3.0 * D1 * rate))
            y += flight
            if not (y < left and abs(u0 + u1 * y) < press):
                return ROCKING
            rate = (D + 0.5 * D1 * flight) * flight - rate
            if rate > st[FAST + i]:
                counted += 1.0
                if turned * s > 0.0:
                    onto_left += 1.0
            rate *= eta
            turned = -turned
        if rate > still:  # the rest is a geometric series
            u = turned * (u0 + u1 * y)
            here, there = press + u, press - u
            series = 1.0 / (1.0 - eta * eta)
            y += 2.0 * rate * (1.0 / here + eta / there) * series
            if not (y < left and abs(u0 + u1 * y) < press):
                return ROCKING
            if rate > slow:  # they are worth counting
                drift = turned * u1 * rate * (1.0 / (here * here) - eta / (there * there)) * series
                rate *= 1.0 + 2.0 / 3.0 * drift
                while rate > st[FAST + i]:
                    counted += 1.0
                    if turned * s > 0.0:
                        onto_left += 1.0
                    rate *= eta
                    turned = -turned
    st[IMPACTS + i] += counted
    st[LANE_ONTO_LEFT + i] += onto_left
    if k > len(values) - 3:
        out[T_END] = par[T_MOTION] + (x + y)
        return finish(st, i, out[FELL], out)
    st[X + i] = x + y
    return lift(st, i, par, values, slopes, blocks, tail, dt, out)
