"""The waiting room of the lanes: when a bell first lifts bodies that stand, WIDTH cases at a time (docs/sweeps.md)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import RETURNS
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.ground import rest_of_bell
from rockcli.kernels.lanes.pulses.series import ONE
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import exp_of_negative, sin_cos
from rockcli.kernels.lanes.vector.plain import bits_of, load, select, some, spread, sqrt, store
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential

GUARD, EVEN, ODD, RATE, MIDDLE, FROM, TO, PULL, STAR, W_R0, W_RS, W_RC, SIDE, BELL_E, WAKES, ENERGY, KNOWN = range(17)
ROOM = 17
"""Vectors of the waiting room.  In: uplift |a_g|; the bell (`lane_ground`) and the y between which it lasts, FROM NaN
if the case has none; PULL p^2 max|f|/g; the equilibrium and the law.  Out: when the body is lifted (WAKES: inf never,
NaN not found here), the side it rocks to and exp(-y^2/2) then; PULL the most the motion can change its rate; the
energy of the equilibrium; whether the answer is KNOWN."""

STEEPEST = 9.5
"""|y| up to which exp(-y^2/2) of a bell is computed; the shapes stop at 8.9."""

TO_LOGARITHM = math.log(2.0) / 2.0**52


@jit_lean
def call_in(space, first, pars, tables, pieces, linear, doubt, early):
    """Fill the waiting room with cases `first` to `first` + WIDTH - 1.

    `early`: a body that the motion cannot overturn is not followed; `doubt`: with this margin on its rate.
    """
    for j in range(WIDTH):
        case = min(first + j, len(pars) - 1)
        _sit_down(space, j, pars[case], tables[case], pieces)
    _wake(space)
    _foresee(space, linear, doubt, early)


@jit_lean
def _sit_down(space, j, par, table, pieces):
    """One case into place j."""
    g, p2, star = par[at.G], par[at.RIGHT + at.P2], par[at.RIGHT + at.Q_STAR]
    guard = g * par[at.RIGHT + at.THRESHOLD]
    space[j + GUARD * WIDTH] = guard
    space[j + PULL * WIDTH] = p2 / g * math.sqrt(par[at.RIGHT + at.FC] ** 2 + par[at.RIGHT + at.FS] ** 2)
    space[j + STAR * WIDTH] = star if star < 1.5 else 0.0
    space[j + W_R0 * WIDTH] = p2 * par[at.RIGHT + at.R0]
    space[j + W_RS * WIDTH] = p2 * par[at.RIGHT + at.RS]
    space[j + W_RC * WIDTH] = p2 * par[at.RIGHT + at.RC]
    space[j + FROM * WIDTH] = math.nan
    if pieces != 1 or table[2] != lane.BELL:
        return
    w, t0, end = table[4], table[3], min(table[1], par[at.T_MOTION])
    d0, d1, d2, d3 = table[5], table[6], table[7], table[8]
    space[j + RATE * WIDTH], space[j + MIDDLE * WIDTH] = w, t0
    space[j + EVEN * WIDTH], space[j + ODD * WIDTH] = d0, d3
    space[j + TO * WIDTH] = w * (end - t0)
    fits = par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0 and star < 1.5 and p2 > 0.0
    fits = fits and abs(d0 + d2) <= 1e-15 * abs(d0) and abs(d1 + 3.0 * d3) <= 1e-15 * abs(d1) and d0 * d3 == 0.0
    fits = fits and abs(w * (table[0] - t0)) <= STEEPEST and abs(w * (end - t0)) <= STEEPEST
    if fits and abs(table[13] - guard) > 1e-9 * guard:
        space[j + FROM * WIDTH] = w * (table[0] - t0)


@jit_lean
def _wake(space):
    """First y at which |D(y)| = guard, D the bell: as |D''| <= M, by steps that cannot pass it, Newton's near it."""
    guard, even, odd = load(space, GUARD * WIDTH), load(space, EVEN * WIDTH), load(space, ODD * WIDTH)
    begin, end = load(space, FROM * WIDTH), load(space, TO * WIDTH)
    M = 3.0 * abs(even) + 6.0 * abs(odd)
    over = 1.0 / M
    # |D| < most exp(-y^2/4), below the guard beyond |y| = far; the bits of a float are nearly its logarithm
    most = (1.15 * abs(even) + 1.92 * abs(odd)) / guard
    far = 2.0 * sqrt((bits_of(select(most > 1.0, most, 1.0)) - ONE) * TO_LOGARITHM + 0.06)
    y = select(begin > -far, begin, -far)
    end = select(end < far, end, far)
    going = (begin == begin) & (y <= end)
    side = spread(0.0)
    for _ in range(200):
        if not some(going):
            break
        z = y * y
        e = exp_of_negative(-0.5 * z)
        D = (even * (1.0 - z) + odd * (y * (z - 3.0))) * e
        slope = (even * (y * (z - 3.0)) + odd * (z * (6.0 - z) - 3.0)) * e
        above, below = guard - D, guard + D
        rises, steep = slope > 0.0, abs(slope)
        ahead, behind = select(rises, above, below), select(rises, below, above)
        step = 2.0 * ahead / (steep + sqrt(abs(slope * slope + 2.0 * M * ahead)))
        back = (steep + sqrt(abs(slope * slope + 2.0 * M * behind))) * over
        step = select(back < step, back, step)
        there = going & ((above <= 0.0) | (below <= 0.0))
        near = going & ~there & ((step <= 4e-16 * abs(y)) | (M * step * step <= 4e-16 * abs(y * slope)))
        y = select(going & ~there, y + step, y)
        side = select(there | near, select(above < below, -1.0, 1.0), side)
        going = going & ~(there | near) & (y <= end)
    y = select(begin == begin, y, 0.0)
    found = abs(side) > 0.0
    e = exp_of_negative(-0.5 * y * y)
    w = select(found, load(space, RATE * WIDTH), 1.0)
    plus, minus = rest_of_bell(even, odd, y, e)
    time = select(found, load(space, MIDDLE * WIDTH) + y / w, math.inf)
    store(space, WAKES * WIDTH, select((begin == begin) & ~going, time, math.nan))
    store(space, SIDE * WIDTH, side)
    store(space, BELL_E * WIDTH, e)
    store(space, PULL * WIDTH, select(found, (plus + minus) * load(space, PULL * WIDTH) / w, 0.0))


@jit_lean
def _foresee(space, linear, doubt, early):
    """Energy of the equilibrium, and whether what the motion can do at most, PULL by now, stays below it."""
    star = load(space, STAR * WIDTH)
    bend, sine = 0.5 * star * star, star
    if not linear:
        half, cosine = sin_cos(0.5 * star)
        bend, sine = 2.0 * half * half, 2.0 * half * cosine
    bent = load(space, W_RS * WIDTH) * bend
    energy = potential(load(space, W_R0 * WIDTH), load(space, W_RC * WIDTH), star, bent, sine)
    wakes = load(space, WAKES * WIDTH)
    known = wakes == math.inf
    if early:
        brim = sqrt(select(energy > 0.0, 2.0 * energy, 0.0))
        known = known | ((wakes >= 0.0) & (load(space, PULL * WIDTH) < brim * (1.0 - doubt)))
    store(space, ENERGY * WIDTH, energy)
    store(space, KNOWN * WIDTH, select(known, 1.0, 0.0))


@jit_lean
def turn_away(space, j, par, out):
    """Results of a case whose answer is known before it begins: it never moves, or cannot be overturned."""
    out[to.STATUS], out[to.N_STEPS], out[to.FELL] = 0.0, 0.0, RETURNS
    out[to.PEAK_SIDE], out[to.PEAK_ALPHA], out[to.T_PEAK] = space[j + SIDE * WIDTH], 1.0, math.nan
    wakes = space[j + WAKES * WIDTH]
    out[to.T_UPLIFT] = wakes if wakes < math.inf else math.nan
    out[to.T_END] = par[at.T_MOTION]
