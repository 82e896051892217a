"""Screening of pulse cases before they take a lane: when a bell first lifts the body (docs/lanes.md).

Many cases of a map never lift, or lift and cannot overturn: these have their answer here and take no lane.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import RETURNS
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.pulses import state as lane
from rockcli.kernels.lanes.pulses.ground import rest_of_bell
from rockcli.kernels.lanes.pulses.series import ONE
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import exp_of_negative, sin_cos
from rockcli.kernels.lanes.vector.plain import bits_of, fetch, load, select, some, spread, sqrt, store
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential

(
    GUARD, GUARD_LEFT, EVEN, ODD, RATE, MIDDLE, FROM, TO, PULL, STAR, W_R0, W_RS, W_RC, SIDE, BELL_E, UPLIFT_T, ENERGY,
    KNOWN, SCREEN_FIELDS,
) = range(19)  # fmt: skip
"""Vectors of what is screened.  In: uplift |a_g| to the right and to the left; the bell (`ground`) and the y between
which it lasts, FROM NaN if the case has none; PULL p^2 max|f|/g; the equilibrium and the law.  Out: UPLIFT_T, inf
never, NaN not found here, the side it rocks to and exp(-y^2/2) then; PULL the most the motion can change its rate; the
energy of the equilibrium; whether the answer is KNOWN."""

STEEPEST = 9.5
"""|y| up to which exp(-y^2/2) of a bell is computed; the shapes stop at 8.9."""

LINE = 8
"""Numbers in a line of memory."""

TO_LOGARITHM = math.log(2.0) / 2.0**52


@jit
def screen(screened, first, cases, linear, doubt, early):
    """Screen the cases that come `first` to `first` + WIDTH - 1.

    `early`: a body that the motion cannot overturn is not followed; `doubt`: with this margin on its rate.
    """
    last = len(cases.order) - 1
    for j in range(WIDTH):
        case, later = cases.order[min(first + j, last)], cases.order[min(first + j + WIDTH, last)]
        _fetch(cases.pars[later])
        _fetch(cases.tables[later])
        _fetch(cases.out[later])
        _put_in(screened, j, cases.pars[case], cases.tables[case], cases.pieces)
    _first_uplift(screened)
    _surely_returns(screened, linear, doubt, early)


@jit
def _fetch(row):
    """Have a row brought near."""
    for i in range(0, len(row), LINE):
        fetch(row, i)


@jit
def _put_in(screened, j, par, table, pieces):
    """One case into place j."""
    g, p2, star = par[at.G], par[at.RIGHT + at.P2], par[at.RIGHT + at.Q_STAR]
    guard = g * par[at.RIGHT + at.THRESHOLD]
    guard_left = g * par[at.LEFT + at.THRESHOLD]
    screened[j + GUARD * WIDTH], screened[j + GUARD_LEFT * WIDTH] = guard, guard_left
    screened[j + PULL * WIDTH] = p2 / g * math.sqrt(par[at.RIGHT + at.FC] ** 2 + par[at.RIGHT + at.FS] ** 2)
    screened[j + STAR * WIDTH] = star if star < 1.5 else 0.0
    screened[j + W_R0 * WIDTH] = p2 * par[at.RIGHT + at.R0]
    screened[j + W_RS * WIDTH] = p2 * par[at.RIGHT + at.RS]
    screened[j + W_RC * WIDTH] = p2 * par[at.RIGHT + at.RC]
    screened[j + FROM * WIDTH] = math.nan
    if pieces != 1 or table[2] != lane.BELL:
        return
    w, t0, end = table[4], table[3], min(table[1], par[at.T_MOTION])
    d0, d1, d2, d3 = table[5], table[6], table[7], table[8]
    screened[j + RATE * WIDTH], screened[j + MIDDLE * WIDTH] = w, t0
    screened[j + EVEN * WIDTH], screened[j + ODD * WIDTH] = d0, d3
    screened[j + TO * WIDTH] = w * (end - t0)
    fits = par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0 and star < 1.5 and p2 > 0.0
    fits = fits and abs(d0 + d2) <= 1e-15 * abs(d0) and abs(d1 + 3.0 * d3) <= 1e-15 * abs(d1) and d0 * d3 == 0.0
    fits = fits and abs(w * (table[0] - t0)) <= STEEPEST and abs(w * (end - t0)) <= STEEPEST
    fits = fits and abs(table[13] - guard_left) > 1e-9 * guard_left
    if fits and abs(table[13] - guard) > 1e-9 * guard:
        screened[j + FROM * WIDTH] = w * (table[0] - t0)


@jit
def _first_uplift(screened):
    """First y at which |D(y)| = guard, D the bell: as |D''| <= M, by steps that cannot pass it, Newton's near it."""
    to_right, to_left = load(screened, GUARD * WIDTH), load(screened, GUARD_LEFT * WIDTH)
    even, odd = load(screened, EVEN * WIDTH), load(screened, ODD * WIDTH)
    guard = select(to_left < to_right, to_left, to_right)
    begin, end = load(screened, FROM * WIDTH), load(screened, TO * WIDTH)
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
        above, below = to_left - D, to_right + D
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
    w = select(found, load(screened, RATE * WIDTH), 1.0)
    plus, minus = rest_of_bell(even, odd, y, e)
    time = select(found, load(screened, MIDDLE * WIDTH) + y / w, math.inf)
    store(screened, UPLIFT_T * WIDTH, select((begin == begin) & ~going, time, math.nan))
    store(screened, SIDE * WIDTH, side)
    store(screened, BELL_E * WIDTH, e)
    store(screened, PULL * WIDTH, select(found, (plus + minus) * load(screened, PULL * WIDTH) / w, 0.0))


@jit
def _surely_returns(screened, linear, doubt, early):
    """Energy of the equilibrium, and whether what the motion can do at most, PULL by now, stays below it."""
    star = load(screened, STAR * WIDTH)
    bend, sine = 0.5 * star * star, star
    if not linear:
        half, cosine = sin_cos(0.5 * star)
        bend, sine = 2.0 * half * half, 2.0 * half * cosine
    bent = load(screened, W_RS * WIDTH) * bend
    energy = potential(load(screened, W_R0 * WIDTH), load(screened, W_RC * WIDTH), star, bent, sine)
    t_uplift = load(screened, UPLIFT_T * WIDTH)
    known = t_uplift == math.inf
    if early:
        brim = sqrt(select(energy > 0.0, 2.0 * energy, 0.0))
        known = known | ((t_uplift >= 0.0) & (load(screened, PULL * WIDTH) < brim * (1.0 - doubt)))
    store(screened, ENERGY * WIDTH, energy)
    store(screened, KNOWN * WIDTH, select(known, 1.0, 0.0))


@jit
def leave_screened(screened, j, par, out):
    """Results of a case whose answer is known before it begins: it never moves, or cannot be overturned."""
    out[to.STATUS], out[to.N_STEPS], out[to.VERDICT] = 0.0, 0.0, RETURNS
    out[to.PEAK_SIDE], out[to.PEAK_ALPHA], out[to.T_PEAK] = screened[j + SIDE * WIDTH], 1.0, math.nan
    t_uplift = screened[j + UPLIFT_T * WIDTH]
    out[to.T_UPLIFT] = t_uplift if t_uplift < math.inf else math.nan
    out[to.T_END] = par[at.T_MOTION]
