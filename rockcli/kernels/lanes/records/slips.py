"""Bodies that slip while they turn, many at a time: the flow (K5, K6) from sample to sample (docs/contact.md).

A slip lasts some ten samples, of which the first and the last hold events; those in between are told here, those two
body by body (`stick_slip`).  Series are in the fraction of the step gone by, as in `step`.
"""

from __future__ import annotations

import math

from rockcli.kernels.contact import workspace as row
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.step import HALF_PI
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.fused import bits, gather
from rockcli.kernels.lanes.vector.plain import fma, load, select, store

(
    LEN, END, SMALL, SPEED, SIN_ALPHA, COS_ALPHA, ALPHA, R, K2, GRAVITY, FACTOR, MU, SIGMA, SIDE, TOP,
    Q, V, U, SLIDE, X, PIECE, CAP, LAUNCH, STEPS, WORK, H, PEAK, RATE_MAX, N_LEAST, TOP_MOST, FIRST, DT, CASE, STRIDE,
) = (field * WIDTH for field in range(34))  # fmt: skip
"""Numbers of a body that slips, state[i + f] with i = `place(number)`.

The sample's length, the sample to stop before; last terms allowed of q and of the slip velocity [m/s]; sin(alpha),
cos(alpha), alpha, R, R^2/r_g^2, g, scale of the motion, mu in motion, signs of the slip and of theta, height of the
top.
Where it is: q, its rate, slip velocity, slide, place in the sample, sample, largest step; how many leading coefficients
of the slip are zero but for rounding; steps, energy at the beginning and the work since [J/kg], length of the step
tried.
Largest |theta| to its side, rate, least normal force over m g, displacement of the top so far.  Of its motion: the
first sample and the time between two; row of the case.
"""

STATE = (lane.LANES // WIDTH + 1) * STRIDE
"""Numbers in a state."""

ANGLE, RATE, SIN_B, COS_B, LEAN, TILT, STIFFNESS, HELD, NORMAL, SLIP, END_OF_ROWS = (
    first * WIDTH for first in (0, 9, 17, 26, 35, 43, 50, 57, 64, 71, 79)
)
"""Where the series of WIDTH bodies begin, a coefficient a vector; as the rows of `contact.workspace`."""

SERIES = END_OF_ROWS
"""Numbers of these series."""

STIFF = 0.02
"""A of (K5) below which a body is left to the kernel of contact: where it vanishes the foot jams."""


@jit
def place(number):
    """Where the numbers of a body that slips begin."""
    return number // WIDTH * STRIDE + number % WIDTH


@jit
def clear(sl, i):
    """Leave place i without a body: on a step that is never fine enough to be taken."""
    for field in range(0, STRIDE, WIDTH):
        sl[i + field] = 0.0
    sl[i + LEN] = sl[i + END] = math.inf
    sl[i + CAP], sl[i + SMALL], sl[i + CASE] = 1.0, -1.0, -1.0


@jit
def expand(w, s0, k0, start, v, u, a, a1, g, way, grip, lever, k2, radius):
    """Series of WIDTH bodies into `w`, each over the fraction of a step.

    s0, k0: sine and cosine of beta; start: q; v, u: rates times the step; a, a1, g: the ground, its change and gravity
    times its square; way: mu sgn(u) sgn(theta); grip: mu sgn(u); lever: R sgn(theta); k2: R^2/r_g^2; radius: R.
    """
    share = k2 / radius
    store(w, ANGLE, start)
    store(w, ANGLE + WIDTH, v)
    store(w, RATE, v)
    store(w, SIN_B, s0)
    store(w, COS_B, k0)
    store(w, SLIP, u)
    part = v
    for k in range(lane.ORDER):
        at = k * WIDTH
        up, down, driven = 0.0 * v, 0.0 * v, 0.0 * v
        for j in range(k + 1):
            rate = load(w, RATE + j * WIDTH)
            up = fma(rate, load(w, COS_B + at - j * WIDTH), up)
            down = fma(rate, load(w, SIN_B + at - j * WIDTH), down)
        lean = -up
        store(w, LEAN + at, lean)
        store(w, SIN_B + at + WIDTH, lean * (1.0 / (k + 1)))
        store(w, COS_B + at + WIDTH, down * (1.0 / (k + 1)))
        if k > 0:
            pushed = fma(grip, load(w, NORMAL + at - WIDTH), a if k == 1 else a1 if k == 2 else 0.0 * a)
            store(w, SLIP + at, fma(lever, lean, pushed * (-1.0 / k)))
        if k == lane.ORDER - 1:
            break
        tilt = load(w, SIN_B + at) - way * load(w, COS_B + at)
        store(w, TILT + at, tilt)
        stiff, given, turned = 0.0 * v, 0.0 * v, 0.0 * v
        for j in range(k + 1):
            stiff = fma(load(w, SIN_B + j * WIDTH), load(w, TILT + at - j * WIDTH), stiff)
            driven = fma(load(w, LEAN + j * WIDTH), load(w, RATE + at - j * WIDTH), driven)
        stiff, held = k2 * stiff, radius * driven
        if k == 0:
            stiff, held = 1.0 + stiff, held + g
            part = 1.0 / stiff
        store(w, STIFFNESS + at, stiff)
        store(w, HELD + at, held)
        for j in range(1, k + 1):
            given = fma(load(w, STIFFNESS + j * WIDTH), load(w, NORMAL + at - j * WIDTH), given)
        store(w, NORMAL + at, (held - given) * part)
        for j in range(k + 1):
            turned = fma(load(w, NORMAL + j * WIDTH), load(w, TILT + at - j * WIDTH), turned)
        rate = turned * share * (-1.0 / (k + 1))
        store(w, RATE + at + WIDTH, rate)
        store(w, ANGLE + at + 2 * WIDTH, rate * (1.0 / (k + 2)))


@jit
def total(w, first, last):
    """Sum of the coefficients first ... last of WIDTH series."""
    up = load(w, last)
    for at in range(last - WIDTH, first - 1, -WIDTH):
        up = up + load(w, at)
    return up


@jit
def sizes(w, first, last):
    """Sum of the moduli of the coefficients first ... last of WIDTH series."""
    up = abs(load(w, last))
    for at in range(last - WIDTH, first - 1, -WIDTH):
        up = up + abs(load(w, at))
    return up


@jit
def slope_at_end(w, first, n):
    """Derivative at the end of the step of WIDTH series of order n."""
    up = (1.0 * n) * load(w, first + n * WIDTH)
    for k in range(n - 1, 0, -1):
        up = fma(1.0 * k, load(w, first + k * WIDTH), up)
    return up


@jit
def slide_on(sl, i, w, values, slopes, watch):
    """Step the WIDTH bodies from place i on: (bodies whose step may hold an event or an extreme, bodies at the end of
    their motion, bodies whose steps are too short), as bits; their series are left in `w`.

    The first and the last stay where they are, as does a body whose last terms are too large: its next step is half as
    long.
    """
    q, v, u, slide = load(sl, Q + i), load(sl, V + i), load(sl, U + i), load(sl, SLIDE + i)
    x, piece, full, cap = load(sl, X + i), load(sl, PIECE + i), load(sl, LEN + i), load(sl, CAP + i)
    h = select(full - x < cap, full - x, cap)
    h2 = h * h
    pitch, factor = gather(slopes, piece), load(sl, FACTOR + i)
    ground, change = factor * fma(pitch, x, gather(values, piece)), factor * pitch * h
    sine, cosine = sin_cos(q)
    sin_a, cos_a = load(sl, SIN_ALPHA + i), load(sl, COS_ALPHA + i)
    s0, k0 = fma(sin_a, cosine, -(cos_a * sine)), fma(cos_a, cosine, sin_a * sine)
    sigma, side, mu = load(sl, SIGMA + i), load(sl, SIDE + i), load(sl, MU + i)
    radius, k2, g = load(sl, R + i), load(sl, K2 + i), load(sl, GRAVITY + i)
    grip, lever, weight = mu * sigma, radius * side, g * h2
    expand(w, s0, k0, q, v * h, u * h, ground * h2, change * h2, weight, grip * side, grip, lever, k2, radius)
    c1, last = v * h, load(w, ANGLE + 8 * WIDTH)
    bend = sizes(w, ANGLE + 2 * WIDTH, ANGLE + 8 * WIDTH)
    reach = abs(c1) + bend
    q_end = q + total(w, ANGLE + WIDTH, ANGLE + 8 * WIDTH)
    v_end = total(w, RATE, RATE + 7 * WIDTH) / h
    small, error = load(sl, SMALL + i), abs(last)
    slip_1, slip_2 = load(w, SLIP + WIDTH), load(w, SLIP + 2 * WIDTH)
    further = sizes(w, SLIP + 3 * WIDTH, SLIP + 7 * WIDTH)
    slip_error = abs(load(w, SLIP + 7 * WIDTH))
    fast = load(sl, SPEED + i) * h
    smooth = (error <= small) & (slip_error <= fast)
    halved = ~smooth & ~(h > 1e-9 * full)

    # events: it stops, lands, leaves the ground or jams; what is to be noted: the equilibrium, a top
    launch = load(sl, LAUNCH + i)
    # least of the first terms of the slip: a parabola that opens downward is least at an end, another above its tangent
    first, second = sigma * slip_1, sigma * slip_2
    fall = select(second < 0.0, first + second, first)
    begins = (fall > further) | (launch > 1.0) & (second > further)
    goes = select(
        launch > 0.0, select(begins, 1.0, 0.0 * q), sigma * u * h + select(fall < 0.0, fall, 0.0 * q) - further
    )
    held, stiff, normal = load(w, HELD), load(w, STIFFNESS), load(w, NORMAL)
    presses = held > 1.000001 * sizes(w, HELD + WIDTH, HELD + 6 * WIDTH)
    free = stiff > STIFF + sizes(w, STIFFNESS + WIDTH, STIFFNESS + 6 * WIDTH)
    upper = q + reach
    turns = (v > 0.0) & (v_end <= 0.0) & (upper > load(sl, PEAK + i))
    alpha, rises = load(sl, ALPHA + i), c1 > 1.000001 * bend
    stays = (upper < alpha) | (q >= alpha) & (rises | (q - reach > alpha)) & (upper < HALF_PI)
    quiet = (goes > 0.0) & presses & free & ((q > 1.000001 * reach) | rises) & stays & ~turns
    slip = slip_1 + (slip_2 + total(w, SLIP + 3 * WIDTH, SLIP + 7 * WIDTH))
    path = 0.5 * slip_1
    for k in range(2, lane.ORDER):
        path = path + load(w, SLIP + k * WIDTH) * (1.0 / (k + 1))
    path = fma(u, h, path)
    if watch:
        # an extreme inside the step that may be the largest; at its ends, where it goes on, there is none but of the
        # normal force, which jumps as a slip begins
        rate, least, far = load(sl, RATE_MAX + i), load(sl, N_LEAST + i), load(sl, TOP_MOST + i)
        swift, light = sizes(w, RATE, RATE + 7 * WIDTH), normal - sizes(w, NORMAL + WIDTH, NORMAL + 6 * WIDTH)
        top = load(sl, TOP + i) * side
        moved = abs(u * h) + (abs(slip_1) + abs(slip_2) + further)
        reached = abs(slide) + moved + abs(top) * select(upper < 1.0, upper, 1.0)
        bends = load(w, RATE + WIDTH) * slope_at_end(w, RATE, 7) <= 0.0
        dips = (load(w, NORMAL + WIDTH) <= 0.0) & (slope_at_end(w, NORMAL, 6) >= 0.0)
        s1, k1 = total(w, SIN_B, SIN_B + 8 * WIDTH), total(w, COS_B, COS_B + 8 * WIDTH)
        leans = (fma(top * cosine, v, u)) * fma(top * fma(cos_a, k1, sin_a * s1), v_end, u + slip / h) <= 0.0
        quiet = quiet & ~(bends & (swift > rate * h)) & ~(dips & (light < least * weight)) & ~(leans & (reached > far))
        store(sl, N_LEAST + i, select(normal < least * weight, normal / weight, least))
        # work of the ground and of friction, integrals over the fraction of the step
        work, grips, before = 0.0 * q, 0.0 * q, 0.0 * q
        for k in range(lane.ORDER):
            back = lever * load(w, LEAN + k * WIDTH) - load(w, SLIP + k * WIDTH)
            work = fma(fma(ground, back, change * before), 1.0 / (k + 1), work)
            before = back
            for j in range(lane.ORDER - 1):
                grips = fma(
                    load(w, NORMAL + j * WIDTH) * (1.0 / (j + k + 1)), load(w, SLIP + k * WIDTH), grips
                )  # fmt: skip
        work = fma(change * before, 1.0 / (lane.ORDER + 1), work) - grip * grips / h2
    moves = smooth & quiet
    now = x + h
    whole = (h == full - x) | (now >= full)
    piece_end = select(whole, piece + 1.0, piece)
    over = moves & (piece_end >= load(sl, END + i))
    store(sl, Q + i, select(moves, q_end, q))
    store(sl, V + i, select(moves, v_end, v))
    store(sl, U + i, select(moves, u + slip / h, u))
    store(sl, SLIDE + i, select(moves, slide + path, slide))
    store(sl, X + i, select(moves, select(whole, 0.0 * x, now), x))
    store(sl, PIECE + i, select(moves, piece_end, piece))
    store(sl, LAUNCH + i, select(moves, 0.0 * q, launch))
    coarse = (h == cap) & (256.0 * error < small) & (128.0 * slip_error < fast)
    store(sl, CAP + i, select(smooth, select(coarse, 2.0 * cap, cap), 0.5 * h))
    store(sl, STEPS + i, load(sl, STEPS + i) + 1.0)
    store(sl, H + i, h)
    if watch:
        store(sl, WORK + i, load(sl, WORK + i) + select(moves, work, 0.0 * q))
    return bits(smooth & ~quiet), bits(over), bits(halved)


@jit
def copy_series(w, bit, h, everything, rows):
    """The series of one body, in powers of time, to the work space of the kernel of contact.

    `everything`: also those that only extremes and the balance of energy need.
    """
    copy(w, ANGLE + bit, 9, h, 1.0, rows[row.Q])
    copy(w, SLIP + bit, 8, h, 1.0 / h, rows[row.SLIP])
    copy(w, STIFFNESS + bit, 7, h, 1.0, rows[row.STIFFNESS])
    copy(w, HELD + bit, 7, h, 1.0 / (h * h), rows[row.HELD])
    if everything:
        copy(w, NORMAL + bit, 7, h, 1.0 / (h * h), rows[row.NORMAL])
        copy(w, SIN_B + bit, 8, h, 1.0, rows[row.SIN_B])
        copy(w, COS_B + bit, 8, h, 1.0, rows[row.COS_B])
        copy(w, LEAN + bit, 8, h, 1.0 / h, rows[row.LEAN])


@jit
def copy(w, first, n, h, unit, into):
    """The n coefficients of one body from w[first] on, the first times `unit`."""
    for k in range(n):
        into[k] = w[first + k * WIDTH] * unit
        unit /= h
