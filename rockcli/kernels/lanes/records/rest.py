"""The mode REST of a lane: where a body begins, comes to rest, is lifted, and where it ends (docs/lanes.md)."""

from __future__ import annotations

import math

from rockcli.kernels import handover as carry
from rockcli.kernels.constants import FALLS, GIVES_WAY, LEFT_TO_MARCH, NOT_YET, RETURNS, STANDSTILL
from rockcli.kernels.constants import FAST as COUNTED
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.bounces import bounce_out, feet, in_all, slowest, weakest
from rockcli.kernels.lanes.records.facets import (
    BALLISTIC,
    EXTENT_LEFT,
    EXTENT_RIGHT,
    FACET,
    FALL_LEFT,
    FALL_RIGHT,
    SCALE,
    TILT,
    face,
    note_pushes,
    risen,
    rolls,
    top_of,
)
from rockcli.kernels.lanes.records.forces import (
    account,
    begin_watch,
    bounces_matter,
    drive,
    drive_up,
    stood,
    watch_edge,
)
from rockcli.kernels.lanes.records.peaks import note_height
from rockcli.kernels.lanes.records.step import HALF_PI
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import edge_of, energy
from rockcli.kernels.rigid.march import ALL
from rockcli.kernels.rigid.readings import clear
from rockcli.kernels.rolling import results as also

FINISHED, STANDING, ROCKING = 0, 1, 2
"""What becomes of a lane: its body is done, or goes on from where it is; ROCKING: it does not come to rest."""

FARTHER = 1.25
"""Rotations at which a body beyond the equilibrium is looked at, each over the one before."""

BLOCK = 64
"""Samples per block of the bounds."""

NEAR = 1e-3
"""Bounces taken so reach no farther than this fraction of the turn to the next facet."""


@jit
def begin(st, i, par, span, how, values, slopes, blocks, tail, path, two_sided, hold, start, out, heave):
    """Put a body into lane i, unless nothing ever lifts it: then it is FINISHED.

    span: of its motion, the first sample and the last, the time between two, and a sample of zeros.  heave: None, or of
    a vertical motion below g what values, slopes, blocks and tail are of the horizontal one.
    """
    clear(out)
    watch = how.detail == ALL
    put_body(st, i, par, how.tol, path, two_sided)
    st[lane.WATCHED + i] = 1.0 if watch and two_sided else 0.0
    st[lane.HEAVE + i] = 0.0
    if heave is not None:
        st[lane.HEAVE + i] = par[at.FACTOR_V] / par[at.G]
    if st[lane.HEAVE + i] != 0.0:  # gravity may be up to twice what it is
        st[lane.SETTLING + i] *= 0.5
    if rolls(par):
        out[also.FACET] = -1.0
    st[lane.FIRST + i], st[lane.LAST + i], st[lane.DT + i] = span[0], span[1], span[2]
    st[lane.PIECE + i], st[lane.X + i], st[lane.CAP + i], st[lane.STILL + i] = span[0], 0.0, math.inf, span[3]
    aim(st, i, par, int(span[0]))
    if hold:
        st[lane.MU_HELD + i], st[lane.WEAK + i] = start[carry.MU], 0.0
        if start[carry.T] >= 0.0:
            return resume(st, i, par, how, values, slopes, blocks, tail, start, out, heave)
    if par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0:
        if watch or hold:
            begin_watch(st, i, par, how.linear, 0.0, 0.0, 0.0)
        return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave)
    set_off(st, i, par, how, values, watch, hold, out, heave)
    return STANDING


@jit
def put_body(st, i, par, tol, path, two_sided):
    """What lane i knows of its body, and nothing found of it yet."""
    p2, eta, star = par[at.RIGHT + at.P2], par[at.RIGHT + at.ETA], par[at.RIGHT + at.Q_STAR]
    st[lane.FREE_0 + i], st[lane.FREE_S + i], st[lane.FREE_C + i] = (
        -p2 * par[at.RIGHT + at.R0], -p2 * par[at.RIGHT + at.RS], -p2 * par[at.RIGHT + at.RC],
    )  # fmt: skip
    st[lane.UNLIKE + i], st[lane.WALL + i] = (1.0 if two_sided else 0.0), HALF_PI
    # the first term left out is at most an eighth of the last one kept: a hundredth of what the level allows, as an
    # error may grow with every impact, and it costs a tenth more steps
    st[lane.SMALL + i] = 0.08 * tol * par[at.RIGHT + at.ALPHA]
    if two_sided:
        st[lane.SMALL + i] = 0.08 * tol * min(par[at.LEFT + at.ALPHA], par[at.RIGHT + at.ALPHA])
    if rolls(par):
        st[lane.SMALL + i] = min(st[lane.SMALL + i], 0.08 * tol * par[SCALE])
    # who does not ask when it passes the equilibrium looks where it is farther from there, and mostly lost
    st[lane.AHEAD + i] = 1.0 if path else FARTHER
    st[lane.LOOK + i] = star if path else min(FARTHER * star, max(star, HALF_PI))
    p_alpha = math.sqrt(p2) * par[at.RIGHT + at.ALPHA]
    st[lane.ETA + i], st[lane.FAST + i], st[lane.SLOW + i] = eta, COUNTED * p_alpha, BALLISTIC * p_alpha
    # the sum of the bounces is least where the ground presses more on the edge of the first
    st[lane.SETTLING + i] = (1.0 + math.sqrt(eta)) ** 2 / (
        (1.0 - eta * eta) * p2 * (par[at.RIGHT + at.R0] + par[at.RIGHT + at.RC])
    )
    st[lane.PEAK + i] = st[lane.STEPS + i] = st[lane.IMPACTS + i] = st[lane.ONTO_LEFT + i] = 0.0
    st[lane.SWINGS + i] = st[lane.SWINGS_T + i] = st[lane.LEFT_BEFORE + i] = st[lane.IMPACTS_BEFORE + i] = 0.0


@jit
def resume(st, i, par, how, values, slopes, blocks, tail, start, out, heave):
    """Put lane i where `start`, a row of `handover`, has its body."""
    first, dt, q, v = st[lane.FIRST + i], st[lane.DT + i], start[carry.Q], start[carry.V]
    k = int(start[carry.T] / dt)
    while k > 0 and k * dt > start[carry.T]:
        k -= 1
    while (k + 1) * dt <= start[carry.T]:
        k += 1
    st[lane.PIECE + i], st[lane.X + i] = first + k, start[carry.T] - k * dt
    st[lane.Q + i], st[lane.V + i] = q, v
    turn(st, i, par, start[carry.SIDE], out)
    begin_watch(st, i, par, how.linear, q, v, ground(st, i, values, slopes))
    if q == 0.0 and v == 0.0:
        return lift(st, i, par, how.detail == ALL, values, slopes, blocks, tail, out, heave)
    return STANDING


@jit
def set_off(st, i, par, how, values, watch, hold, out, heave):
    """Lane i moves at first."""
    lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
    s = 1.0 if lead > 0.0 else -1.0
    q, v, first = abs(par[at.THETA_0]), s * par[at.THETA_DOT_0], int(st[lane.FIRST + i])
    out[to.T_UPLIFT] = 0.0
    out[to.PEAK_SIDE] = s
    if q >= par[(at.RIGHT if s > 0.0 else at.LEFT) + at.Q_STAR]:
        out[to.T_OVERTURN] = 0.0
    st[lane.Q + i], st[lane.V + i] = q, v
    turn(st, i, par, s, out)
    if v <= 0.0:
        note_height(st, i, par, q, 0.0, hold and watch, how.tol, out)
    if watch or hold:
        begin_watch(st, i, par, how.linear, q, v, values[first])
        if heave is not None:
            st[lane.WORK + i] += heave[0][first] * drive_up(st, i, q, how.linear)


@jit
def aim(st, i, par, k):
    """Lane i is in sample k of its motion: how long that is, and the sample to stop before.

    A report that ends inside a sample ends the motion there; before that sample the lane stops once.
    """
    last, dt = st[lane.LAST + i], st[lane.DT + i]
    st[lane.END + i], st[lane.LEN + i] = last, dt
    if par[at.HAS_DURATION] == 1.0 and par[at.T_MOTION] < (last - st[lane.FIRST + i]) * dt:
        if k < last - 1.0:
            st[lane.END + i] = last - 1.0
        else:
            st[lane.LEN + i] = par[at.T_MOTION] - (last - 1.0 - st[lane.FIRST + i]) * dt


@jit
def ground(st, i, values, slopes):
    """a_g over its scale where lane i is."""
    k = int(st[lane.PIECE + i])
    return 0.0 if k > st[lane.LAST + i] else values[k] + slopes[k] * st[lane.X + i]


@jit
def turn(st, i, par, s, out):
    """Put lane i on side s."""
    e = at.RIGHT if s > 0.0 else at.LEFT
    st[lane.SIDE + i] = s
    force = -par[e + at.P2] * s * par[at.FACTOR_H] / par[at.G]
    st[lane.FORCING_C + i], st[lane.FORCING_S + i] = force * par[e + at.FC], force * par[e + at.FS]
    if st[lane.UNLIKE + i] > 0.0:
        face(st, i, par, s, out)
        if st[lane.WATCHED + i] > 0.0:
            watch_edge(st, i, par, s)


@jit
def lift(st, i, par, watch, values, slopes, blocks, tail, out, heave):
    """From rest at a time in a sample: put lane i where it uplifts next, or FINISHED if it never does.

    Samples that cannot open the guard are not looked at: the next that can is found by the bounds of blocks.
    """
    factor, last = par[at.FACTOR_H], int(st[lane.LAST + i])
    k, x = int(st[lane.PIECE + i]), st[lane.X + i]
    k_0, x_0 = k, x
    if k < last and factor != 0.0:
        quiet = par[at.G] * min(par[at.LEFT + at.THRESHOLD], par[at.RIGHT + at.THRESHOLD])
        level = quiet / abs(factor) * (1.0 - 1e-12)
        while tail[k] * abs(factor) > (quiet if heave is None else quiet * lightest(st, i, heave[3][k])):
            aim(st, i, par, k)
            wait, s_up = opens(st, i, par, k, x, values, slopes, heave)
            at_end = s_up != 0.0 and x + wait >= st[lane.LEN + i]  # what counts is the next sample's slope
            if s_up != 0.0 and not at_end:
                if watch and (k > k_0 or x + wait > x_0):
                    stood_up_to(st, i, par, values, slopes, heave, k_0, x_0, k, x + wait)
                st[lane.PIECE + i], st[lane.X + i], st[lane.Q + i], st[lane.V + i] = k, x + wait, 0.0, 0.0
                turn(st, i, par, s_up, out)
                if math.isnan(out[to.T_UPLIFT]):
                    out[to.T_UPLIFT] = (k - int(st[lane.FIRST + i])) * st[lane.DT + i] + (x + wait)
                return STANDING
            k += 1
            x = 0.0
            if not at_end:
                k = max(k, following(values, blocks, level, k, last, st[lane.HEAVE + i], heave) - 1)
            if k >= last:
                break
    return stay(st, i, par, watch, values, slopes, tail, k_0, x_0, out, heave)


@jit_part
def opens(st, i, par, k, x, values, slopes, heave):
    """When after x in sample k a guard of a body at rest opens in it, and the side; or (inf, 0)."""
    g, factor = par[at.G], par[at.FACTOR_H]
    left, right = g * par[at.LEFT + at.THRESHOLD], g * par[at.RIGHT + at.THRESHOLD]
    a_g, rate = (values[k] + slopes[k] * x) * factor, slopes[k] * factor
    weight, change = 1.0, 0.0
    if heave is not None:
        weight = 1.0 + st[lane.HEAVE + i] * (heave[0][k] + heave[1][k] * x)
        change = st[lane.HEAVE + i] * heave[1][k]
    wait, s_up = math.inf, 0.0
    for sign in (-1.0, 1.0):
        own = right if sign > 0.0 else left
        d, dd = own * weight + sign * a_g, own * change + sign * rate
        y = math.inf
        if d < 0.0:
            y = 0.0
        elif dd < 0.0:
            y = 0.0 if d <= 1e-15 * own else (d + 2e-15 * own) / -dd  # open beyond rounding
        if y <= st[lane.LEN + i] - x and y < wait:
            wait, s_up = y, sign
    return wait, s_up


@jit_part
def stood_up_to(st, i, par, values, slopes, heave, k_0, x_0, k, x):
    """Lane i has been at rest from x_0 in sample k_0 to x in sample k, where it is lifted."""
    if heave is not None:
        stood_through(st, i, par, values, slopes, heave, k_0, x_0, k, x)
        return
    most = abs(values[k] + slopes[k] * x)  # |a_g| is nowhere above what lifts it
    if st[lane.UNLIKE + i] > 0.0:  # to one side; to the other it may be
        most = max(most, loudest(values, slopes, k_0, x_0, k))
    stood(st, i, par, most)


@jit
def stay(st, i, par, watch, values, slopes, tail, k_0, x_0, out, heave):
    """Lane i is at rest from x_0 in sample k_0 to the end."""
    last, dt = int(st[lane.LAST + i]), st[lane.DT + i]
    out[to.T_END] = par[at.T_MOTION]
    if watch:
        if k_0 < last:
            aim(st, i, par, last - 1)
            if heave is not None:
                stood_through(st, i, par, values, slopes, heave, k_0, x_0, last - 1, st[lane.LEN + i])
            else:
                most = max(abs(values[k_0] + slopes[k_0] * x_0), tail[k_0 + 1])
                if st[lane.LEN + i] < dt or last + 1.0 < st[lane.STILL + i]:  # cut off before its record ends
                    cut = abs(values[last - 1] + slopes[last - 1] * st[lane.LEN + i])
                    most = max(loudest(values, slopes, k_0, x_0, last - 1), cut)
                stood(st, i, par, most)
        account(st, i, risen(par), out)
    if rolls(par):
        if not par[FALL_LEFT] < par[TILT] < par[FALL_RIGHT]:
            return finish(st, i, par, FALLS, out)
        out[also.FACET] = par[FACET]
    return finish(st, i, par, RETURNS, out)


@jit
def loudest(values, slopes, k_0, x_0, k):
    """Largest modulus from x_0 in sample k_0 to the beginning of sample k."""
    most = abs(values[k_0] + slopes[k_0] * x_0)
    for j in range(k_0 + 1, k + 1):
        most = max(most, abs(values[j]))
    return most


@jit
def stood_through(st, i, par, values, slopes, heave, k_0, x_0, k, x):
    """Lane i has been at rest from x_0 in sample k_0 to x in sample k, lifted or pressed by the vertical motion.

    Both components are linear, so that |a_g|/(g + a_v) is largest where a sample ends.
    """
    share, shake = st[lane.HEAVE + i], abs(par[at.FACTOR_H]) / par[at.G]
    for j in range(k_0, k + 2):
        o, y = (k, x) if j > k else (j, x_0 if j == k_0 else 0.0)
        weight = 1.0 + share * (heave[0][o] + heave[1][o] * y)
        st[lane.N_LEAST + i] = min(st[lane.N_LEAST + i], weight)
        st[lane.MU_MOST + i] = max(st[lane.MU_MOST + i], abs(values[o] + slopes[o] * y) * shake / weight)


@jit
def lightest(st, i, most):
    """Bound of gravity over g under lane i while its vertical motion is `most` at most."""
    return 1.0 - abs(st[lane.HEAVE + i]) * most


@jit
def following(values, blocks, level, k, last, share, heave):
    """First sample from k on whose modulus reaches the level, or last + 1.

    heave: None, or the vertical motion, whose scale over g is `share`: the level is that times gravity over g.
    """
    while k <= last:
        if k % BLOCK == 0:
            j = k // BLOCK
            while blocks[j] < (level if heave is None else level * (1.0 - abs(share) * heave[2][j])):
                k += BLOCK
                j += 1
                if k > last:
                    return last + 1
        if abs(values[k]) >= (level if heave is None else level * (1.0 + share * heave[0][k])):
            return k
        k += 1
    return k


@jit
def finish(st, i, par, verdict, out):
    """Note how it ended; a report of a given duration ends then, whatever became of the body."""
    if par[at.HAS_DURATION] == 1.0:
        out[to.T_END] = par[at.T_STOP]
    if rolls(par):
        note_pushes(st, i, par, out)
    if rolls(par) and verdict == FALLS:
        theta = par[TILT] + st[lane.SIDE + i] * st[lane.Q + i]
        out[to.PEAK_SIDE] = 1.0 if theta > 0.0 or (theta == 0.0 and st[lane.SIDE + i] > 0.0) else -1.0
    out[to.VERDICT] = verdict
    out[to.N_STEPS], out[to.N_IMPACTS] = st[lane.STEPS + i], st[lane.IMPACTS + i]
    out[to.SWINGS], out[to.SWINGS_T] = st[lane.SWINGS + i], st[lane.SWINGS_T + i]
    out[to.ONTO_LEFT], out[to.ONTO_RIGHT] = st[lane.ONTO_LEFT + i], st[lane.IMPACTS + i] - st[lane.ONTO_LEFT + i]
    return FINISHED


@jit
def park(st, i):
    """Leave lane i without a body: in a sample without end, where no event comes of it, nor of the ground's force."""
    st[lane.CASE + i], st[lane.SHAKE + i] = -1.0, 0.0
    st[lane.Q + i], st[lane.V + i], st[lane.X + i], st[lane.PIECE + i], st[lane.END + i] = 1.0, 0.0, 0.0, 0.0, math.inf
    st[lane.LEN + i], st[lane.CAP + i], st[lane.SMALL + i] = math.inf, 1.0, 0.0
    st[lane.LOOK + i] = st[lane.WALL + i] = math.inf
    st[lane.FORCING_C + i] = st[lane.FORCING_S + i] = st[lane.FREE_0 + i] = st[lane.FREE_S + i] = st[
        lane.FREE_C + i
    ] = 0.0


@jit
def hand_over(out):
    """Leave the body to the single-body kernels."""
    out[to.STATUS] = LEFT_TO_MARCH
    return FINISHED


@jit
def stop(st, i, par, how, values, slopes, start, out):
    """Leave the body to the kernel of contact where it is, as its foot may give way there."""
    piece, last = st[lane.PIECE + i], st[lane.LAST + i]
    t = (piece - st[lane.FIRST + i]) * st[lane.DT + i] + st[lane.X + i]
    if piece >= last:
        t = par[at.T_MOTION] + (st[lane.X + i] if piece > last else 0.0)
    start[carry.T], start[carry.SIDE] = t, st[lane.SIDE + i]
    q, v = st[lane.Q + i], st[lane.V + i]
    start[carry.Q], start[carry.V] = q, v
    if how.detail == ALL:
        st[lane.WORK + i] -= ground(st, i, values, slopes) * drive(st, i, q, how.linear)
        account(st, i, energy(edge_of(par, at.RIGHT), q, v, how.linear), out)
    finish(st, i, par, NOT_YET, out)
    out[to.STATUS] = GIVES_WAY
    return FINISHED


@jit
def rest(st, i, par, how, values, slopes, blocks, tail, hold, start, out, heave):
    """Whether the body of lane i, just turned over, comes to rest inside this sample; if so, what then.

    Slow bounces are flights under a moment linear in time; each is solved for its end and its impact counted.
    """
    v, k, x = st[lane.V + i], int(st[lane.PIECE + i]), st[lane.X + i]
    a, watch = values[k] + slopes[k] * x, how.detail == ALL
    weight, lighter = 1.0, 0.0
    if heave is not None:
        lighter = st[lane.HEAVE + i] * heave[1][k]
        weight = 1.0 + st[lane.HEAVE + i] * heave[0][k] + lighter * x
    here, there = feet(par, st[lane.SIDE + i], a, slopes[k], weight, lighter)
    still = STANDSTILL * (here.p * par[SCALE] if rolls(par) else here.p * par[here.edge + at.ALPHA])
    if here.press <= 0.0 or there.press <= 0.0:  # the ground alone holds it on this facet, if anything does
        return ROCKING if v > still else hand_over(out)
    if here.press + here.push <= 0.0 or there.press + there.push <= 0.0:
        # a standing body that the ground just fails to lift must not bounce on one spot for ever
        return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave) if v <= still else ROCKING
    wait = 0.0
    if v > still:
        if here.eta * there.eta >= 1.0:
            return ROCKING
        left = st[lane.LEN + i] - x
        whole = in_all(here, there, v)
        lowest = weakest(here, there, whole, st[lane.UNLIKE + i] > 0.0 or heave is not None)
        if whole > left or lowest <= 0.0 or 0.5 * v * v / lowest > flattest(st, i, par, here.side, out):
            return ROCKING
        slow = slowest(par, how.rest_speed, here, there)
        change, lighter = slopes[k] * whole, lighter * whole
        if hold and v > slow and bounces_matter(st, i, par, here.side, a, change, 1.0, 0.0, 0.0, st[lane.MU_HELD + i]):
            if start[carry.T] < 0.0:  # so that all that never stop have the bits of pure rocking
                return stop(st, i, par, how, values, slopes, start, out)
            return ROCKING
        least, most = st[lane.N_LEAST + i], st[lane.MU_MOST + i]
        if watch and v > slow and bounces_matter(st, i, par, here.side, a, change, weight, lighter, least, most):
            return ROCKING
        wait, n, n_left = bounce_out(par, how.rest_speed, here, there, v, slow, still, left, lowest)
        if wait < 0.0:
            return ROCKING
        st[lane.IMPACTS + i] += n
        st[lane.ONTO_LEFT + i] += n_left
    st[lane.LOST + i] += 0.5 * par[here.edge + at.RADIUS] * (v / here.p) ** 2
    if k > st[lane.LAST + i]:
        out[to.T_END] = par[at.T_MOTION] + (x + wait)
        if watch:
            account(st, i, risen(par), out)
        if rolls(par) and out[to.VERDICT] == RETURNS:
            out[also.FACET] = par[FACET]
        return finish(st, i, par, out[to.VERDICT], out)
    st[lane.X + i] = x + wait
    return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave)


@jit_part
def flattest(st, i, par, s, out):
    """Rotation up to which bounces of lane i from the edge of side s on are taken in one go: no peak is in them."""
    highest = st[lane.PEAK + i]
    if st[lane.UNLIKE + i] > 0.0:
        highest = min(highest, top_of(par, -s, out))
        if rolls(par):
            highest = min(highest, NEAR * min(par[EXTENT_LEFT], par[EXTENT_RIGHT]))
    return highest
