"""The mode REST of a lane: where a body begins, comes to rest, is lifted, and where it ends (docs/lanes.md)."""

from __future__ import annotations

import math

from rockcli.kernels import handover as carry
from rockcli.kernels.constants import FALLS, GIVES_WAY, LEFT_TO_MARCH, NOT_YET, RETURNS, STANDSTILL
from rockcli.kernels.constants import FAST as COUNTED
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.records import state as lane
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
    scales,
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
from rockcli.kernels.rigid.law import edge_of, energy, pressed
from rockcli.kernels.rigid.march import ALL
from rockcli.kernels.rigid.readings import clear
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.rest import uncounted

FINISHED, STANDING, ROCKING = 0, 1, 2
"""What becomes of a lane: its body is done, or goes on from where it is; ROCKING: it does not come to rest."""

FARTHER = 1.25
"""Rotations at which a body beyond the equilibrium is looked at, each over the one before."""

BLOCK = 64
"""Samples per block of the bounds."""

NEAR = 1e-3
"""Bounces taken so reach no farther than this fraction of the turn to the next facet."""

NEARLY_STEADY = 5e-5
"""Change of the moment from one impact to the next, relative, below which it is taken to first order."""


@jit_lean
def begin(st, i, par, span, how, values, slopes, blocks, tail, path, two_sided, hold, start, out, heave):
    """Put a body into lane i, unless nothing ever lifts it: then it is FINISHED.

    span: of its motion, the first sample and the last, the time between two, and a sample of zeros.  heave: None, or of
    a vertical motion below g what values, slopes, blocks and tail are of the horizontal one.
    """
    clear(out)
    st[lane.HEAVE + i] = 0.0
    if heave is not None:
        st[lane.HEAVE + i] = par[at.FACTOR_V] / par[at.G]
    p2 = par[at.RIGHT + at.P2]
    st[lane.FREE_0 + i], st[lane.FREE_S + i], st[lane.FREE_C + i] = (
        -p2 * par[at.RIGHT + at.R0], -p2 * par[at.RIGHT + at.RS], -p2 * par[at.RIGHT + at.RC],
    )  # fmt: skip
    st[lane.UNLIKE + i], st[lane.AHEAD + i], st[lane.WALL + i] = (
        1.0 if two_sided else 0.0,
        1.0 if path else FARTHER,
        HALF_PI,
    )
    # the first term left out is at most an eighth of the last one kept: a hundredth of what the level allows, as an
    # error may grow with every impact, and it costs a tenth more steps
    st[lane.SMALL + i] = 0.08 * how.tol * par[at.RIGHT + at.ALPHA]
    if two_sided:
        st[lane.SMALL + i] = 0.08 * how.tol * min(par[at.LEFT + at.ALPHA], par[at.RIGHT + at.ALPHA])
    if rolls(par):
        st[lane.SMALL + i] = min(st[lane.SMALL + i], 0.08 * how.tol * par[SCALE])
        out[also.FACET] = -1.0
    st[lane.PEAK + i] = 0.0
    # who does not ask when it passes the equilibrium looks where it is farther from there, and mostly lost
    star = par[at.RIGHT + at.Q_STAR]
    st[lane.LOOK + i] = star if path else min(FARTHER * star, max(star, HALF_PI))
    st[lane.STEPS + i] = st[lane.IMPACTS + i] = st[lane.ONTO_LEFT + i] = 0.0
    p_alpha = math.sqrt(p2) * par[at.RIGHT + at.ALPHA]
    st[lane.ETA + i], st[lane.FAST + i], st[lane.SLOW + i] = (
        par[at.RIGHT + at.ETA],
        COUNTED * p_alpha,
        BALLISTIC * p_alpha,
    )
    # the sum of the bounces is least where the ground presses more on the edge of the first
    eta = par[at.RIGHT + at.ETA]
    st[lane.SETTLING + i] = (1.0 + math.sqrt(eta)) ** 2 / (
        (1.0 - eta * eta) * p2 * (par[at.RIGHT + at.R0] + par[at.RIGHT + at.RC])
    )
    if st[lane.HEAVE + i] != 0.0:  # gravity may be up to twice what it is
        st[lane.SETTLING + i] *= 0.5
    st[lane.FIRST + i], st[lane.LAST + i], st[lane.DT + i] = span[0], span[1], span[2]
    st[lane.PIECE + i], st[lane.X + i], st[lane.CAP + i], st[lane.STILL + i] = span[0], 0.0, math.inf, span[3]
    aim(st, i, par, int(span[0]))
    st[lane.SWINGS + i] = st[lane.SWINGS_T + i] = st[lane.LEFT_BEFORE + i] = st[lane.IMPACTS_BEFORE + i] = 0.0
    watch = how.detail == ALL
    st[lane.WATCHED + i] = 1.0 if watch and two_sided else 0.0
    if hold:
        st[lane.MU_HELD + i], st[lane.WEAK + i] = start[carry.MU], 0.0
        if start[carry.T] >= 0.0:
            dt = span[2]
            k = int(start[carry.T] / dt)
            while k > 0 and k * dt > start[carry.T]:
                k -= 1
            while (k + 1) * dt <= start[carry.T]:
                k += 1
            st[lane.PIECE + i], st[lane.X + i] = span[0] + k, start[carry.T] - k * dt
            st[lane.Q + i], st[lane.V + i] = start[carry.Q], start[carry.V]
            turn(st, i, par, start[carry.SIDE], out)
            begin_watch(st, i, par, how.linear, start[carry.Q], start[carry.V], ground(st, i, values, slopes))
            if start[carry.Q] == 0.0 and start[carry.V] == 0.0:
                return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave)
            return STANDING
    if par[at.THETA_0] == 0.0 and par[at.THETA_DOT_0] == 0.0:
        if watch or hold:
            begin_watch(st, i, par, how.linear, 0.0, 0.0, 0.0)
        return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave)
    lead = par[at.THETA_0] if par[at.THETA_0] != 0.0 else par[at.THETA_DOT_0]
    s = 1.0 if lead > 0.0 else -1.0
    q, v = abs(par[at.THETA_0]), s * par[at.THETA_DOT_0]
    out[to.T_UPLIFT] = 0.0
    out[to.PEAK_SIDE] = s
    if q >= par[(at.RIGHT if s > 0.0 else at.LEFT) + at.Q_STAR]:
        out[to.T_OVERTURN] = 0.0
    st[lane.Q + i], st[lane.V + i] = q, v
    turn(st, i, par, s, out)
    if v <= 0.0:
        note_height(st, i, par, q, 0.0, hold and watch, how.tol, out)
    if watch or hold:
        begin_watch(st, i, par, how.linear, q, v, values[int(span[0])])
        if heave is not None:
            st[lane.WORK + i] += heave[0][int(span[0])] * drive_up(st, i, q, how.linear)
    return STANDING


@jit_lean
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


@jit_lean
def ground(st, i, values, slopes):
    """a_g over its scale where lane i is."""
    k = int(st[lane.PIECE + i])
    return 0.0 if k > st[lane.LAST + i] else values[k] + slopes[k] * st[lane.X + i]


@jit_lean
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


@jit_lean
def lift(st, i, par, watch, values, slopes, blocks, tail, out, heave):
    """From rest at a time in a sample: put lane i where it uplifts next, or FINISHED if it never does.

    Samples that cannot open the guard are not looked at: the next that can is found by the bounds of blocks.
    """
    g, factor = par[at.G], par[at.FACTOR_H]
    left, right = g * par[at.LEFT + at.THRESHOLD], g * par[at.RIGHT + at.THRESHOLD]
    quiet = min(left, right)
    first, last, dt = int(st[lane.FIRST + i]), int(st[lane.LAST + i]), st[lane.DT + i]
    k, x = int(st[lane.PIECE + i]), st[lane.X + i]
    k_0, x_0 = k, x
    if k < last and factor != 0.0:
        level = quiet / abs(factor) * (1.0 - 1e-12)
        while tail[k] * abs(factor) > (quiet if heave is None else quiet * lightest(st, i, heave[3][k])):
            aim(st, i, par, k)
            full = st[lane.LEN + i]
            a_g = (values[k] + slopes[k] * x) * factor
            rate = slopes[k] * factor
            weight, change = 1.0, 0.0
            if heave is not None:
                weight = 1.0 + st[lane.HEAVE + i] * (heave[0][k] + heave[1][k] * x)
                change = st[lane.HEAVE + i] * heave[1][k]
            best, s_up = math.inf, 0.0
            for sign in (-1.0, 1.0):
                own = right if sign > 0.0 else left
                d, dd = own * weight + sign * a_g, own * change + sign * rate
                y = math.inf
                if d < 0.0:
                    y = 0.0
                elif dd < 0.0:
                    y = 0.0 if d <= 1e-15 * own else (d + 2e-15 * own) / -dd  # open beyond rounding
                if y <= full - x and y < best:
                    best, s_up = y, sign
            if s_up != 0.0 and x + best >= full:  # at the sample's end: what counts is the next one's slope
                k += 1
                x = 0.0
                if k >= last:
                    break
                continue
            if s_up != 0.0:
                if watch and (k > k_0 or x + best > x_0):
                    if heave is not None:
                        stood_through(st, i, par, values, slopes, heave, k_0, x_0, k, x + best)
                    else:  # while at rest |a_g| is nowhere above what lifts it
                        most = abs(values[k] + slopes[k] * (x + best))
                        if st[lane.UNLIKE + i] > 0.0:  # to one side; to the other it may be
                            most = max(most, loudest(values, slopes, k_0, x_0, k))
                        stood(st, i, par, most)
                st[lane.PIECE + i], st[lane.X + i], st[lane.Q + i], st[lane.V + i] = k, x + best, 0.0, 0.0
                turn(st, i, par, s_up, out)
                if math.isnan(out[to.T_UPLIFT]):
                    out[to.T_UPLIFT] = (k - first) * dt + (x + best)
                return STANDING
            k += 1
            x = 0.0
            j = following(values, blocks, level, k, last, st[lane.HEAVE + i], heave)
            if j > last:
                break
            k = max(k, j - 1)
            if k >= last:
                break
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
        account(st, i, par, risen(par), out)
    if rolls(par):
        if not par[FALL_LEFT] < par[TILT] < par[FALL_RIGHT]:
            return finish(st, i, par, FALLS, out)
        out[also.FACET] = par[FACET]
    return finish(st, i, par, RETURNS, out)


@jit_lean
def loudest(values, slopes, k_0, x_0, k):
    """Largest modulus from x_0 in sample k_0 to the beginning of sample k."""
    most = abs(values[k_0] + slopes[k_0] * x_0)
    for j in range(k_0 + 1, k + 1):
        most = max(most, abs(values[j]))
    return most


@jit_lean
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


@jit_lean
def lightest(st, i, most):
    """Bound of gravity over g under lane i while its vertical motion is `most` at most."""
    return 1.0 - abs(st[lane.HEAVE + i]) * most


@jit_lean
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


@jit_lean
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


@jit_lean
def park(st, i):
    """Leave lane i without a body: in a sample without end, where no event comes of it, nor of the ground's force."""
    st[lane.CASE + i], st[lane.SHAKE + i] = -1.0, 0.0
    st[lane.Q + i], st[lane.V + i], st[lane.X + i], st[lane.PIECE + i], st[lane.END + i] = 1.0, 0.0, 0.0, 0.0, math.inf
    st[lane.LEN + i], st[lane.CAP + i], st[lane.SMALL + i] = math.inf, 1.0, 0.0
    st[lane.LOOK + i] = st[lane.WALL + i] = math.inf
    st[lane.FORCING_C + i] = st[lane.FORCING_S + i] = st[lane.FREE_0 + i] = st[lane.FREE_S + i] = st[
        lane.FREE_C + i
    ] = 0.0


@jit_lean
def hand_over(out):
    """Leave the body to the single-body kernels."""
    out[to.STATUS] = LEFT_TO_MARCH
    return FINISHED


@jit_lean
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
        account(st, i, par, energy(edge_of(par, at.RIGHT), q, v, how.linear), out)
    finish(st, i, par, NOT_YET, out)
    out[to.STATUS] = GIVES_WAY
    return FINISHED


@jit_lean
def rest(st, i, par, how, values, slopes, blocks, tail, hold, start, out, heave):
    """Whether the body of lane i, just turned over, comes to rest inside this sample; if so, what then.

    Slow bounces are flights under a moment linear in time; each is solved for its end and its impact counted.
    """
    s, v = st[lane.SIDE + i], st[lane.V + i]
    e, o = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
    p = math.sqrt(par[e + at.P2])
    k, x = int(st[lane.PIECE + i]), st[lane.X + i]
    left = st[lane.LEN + i] - x
    # about its edge and about the other: what presses it down at rest, and what the ground adds, linear in time
    press, press_o = pressed(edge_of(par, e), s, 0.0, 0.0), pressed(edge_of(par, o), -s, 0.0, 0.0)
    force = s * par[e + at.P2] * par[e + at.FC] * par[at.FACTOR_H] / par[at.G]
    force_o = -s * par[o + at.P2] * par[o + at.FC] * par[at.FACTOR_H] / par[at.G]
    a = values[k] + slopes[k] * x
    u0, u1, w0, w1 = force * a, force * slopes[k], force_o * a, force_o * slopes[k]
    eta, eta_o = par[e + at.ETA], par[o + at.ETA]
    scale, scale_o = scales(par, e, o)
    still, watch = STANDSTILL * (p * par[SCALE] if rolls(par) else scale), how.detail == ALL
    if press <= 0.0 or press_o <= 0.0:  # the ground alone holds it on this facet, if anything does
        return ROCKING if v > still else hand_over(out)
    weight, lighter = 1.0, 0.0
    if heave is not None:
        lighter = st[lane.HEAVE + i] * heave[1][k]
        weight = 1.0 + st[lane.HEAVE + i] * heave[0][k] + lighter * x
        u1, w1 = u1 + press * lighter, w1 + press_o * lighter
        press, press_o = press * weight, press_o * weight
    if press + u0 <= 0.0 or press_o + w0 <= 0.0:
        # a standing body that the ground just fails to lift must not bounce on one spot for ever
        return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave) if v <= still else ROCKING
    per_cycle = eta * eta_o
    if v > still and per_cycle >= 1.0:
        return ROCKING
    y, rate, turned = 0.0, v, 1.0
    counted = onto_left = 0.0
    if v > still:
        whole = 2.0 * v * (1.0 / (press + u0) + eta_o / (press_o + w0)) / (1.0 - per_cycle)
        lowest = press - max(abs(u0), abs(u0 + u1 * whole))
        highest = st[lane.PEAK + i]
        if st[lane.UNLIKE + i] > 0.0:
            lowest = min(lowest, press_o - max(abs(w0), abs(w0 + w1 * whole)))
            highest = min(highest, top_of(par, -s, out))
            if rolls(par):
                highest = min(highest, NEAR * min(par[EXTENT_LEFT], par[EXTENT_RIGHT]))
        if heave is not None:  # what it adds is alike on both sides, the ground's is not
            lowest = min(lowest, press_o - max(abs(w0), abs(w0 + w1 * whole)))
        if whole > left or lowest <= 0.0 or 0.5 * v * v / lowest > highest:
            return ROCKING
        p_o, limit = math.sqrt(par[o + at.P2]), math.inf
        slow = how.rest_speed * min(p * math.sin(par[e + at.ALPHA]), p_o * math.sin(par[o + at.ALPHA]))
        if rolls(par):
            limit = uncounted(p, eta, p_o, eta_o, par[SCALE])
            slow = min(how.rest_speed * min(press + u0, press_o + w0) / p, limit)
        change, lighter = slopes[k] * whole, lighter * whole
        if hold and v > slow and bounces_matter(st, i, par, s, a, change, 1.0, 0.0, 0.0, st[lane.MU_HELD + i]):
            if start[carry.T] < 0.0:  # so that all that never stop have the bits of pure rocking
                return stop(st, i, par, how, values, slopes, start, out)
            return ROCKING
        least, most = st[lane.N_LEAST + i], st[lane.MU_MOST + i]
        if watch and v > slow and bounces_matter(st, i, par, s, a, change, weight, lighter, least, most):
            return ROCKING
        straight = NEARLY_STEADY * lowest * lowest / max(abs(u1), abs(w1))
        fast, fast_o = COUNTED * scale, COUNTED * scale_o
        while rate > slow and rate > straight:
            D, D1 = press + (u0 + u1 * y), u1
            flight = 2.0 * rate / (0.5 * D + math.sqrt(0.25 * D * D + 2.0 / 3.0 * D1 * rate))
            y += flight
            if not (y < left and press + (u0 + u1 * y) > 0.0 and press_o + (w0 + w1 * y) > 0.0):
                return ROCKING
            rate = (D + 0.5 * D1 * flight) * flight - rate
            if rate > fast:
                counted += 1.0
                if turned * s > 0.0:
                    onto_left += 1.0
            rate *= eta_o
            turned = -turned
            press, press_o, u0, w0, u1, w1 = press_o, press, w0, u0, w1, u1
            eta, eta_o, fast, fast_o, force, force_o = eta_o, eta, fast_o, fast, force_o, force
            if rolls(par):
                slow = min(how.rest_speed * min(press + (u0 + u1 * y), press_o + (w0 + w1 * y)) / p, limit)
        if rate > still:  # the rest is a geometric series
            here, there = press + (u0 + u1 * y), press_o + (w0 + w1 * y)
            series = 1.0 / (1.0 - per_cycle)
            if rolls(par):
                slow = min(how.rest_speed * min(here, there) / p, limit)
            y += 2.0 * rate * (1.0 / here + eta_o / there) * series
            if not (y < left and press + (u0 + u1 * y) > 0.0 and press_o + (w0 + w1 * y) > 0.0):
                return ROCKING
            if rate > slow:  # they are worth counting
                back = force_o / force if u1 != 0.0 else -1.0
                drift = u1 * rate * (1.0 / (here * here) + back * eta_o / (there * there)) * series
                if heave is not None:
                    drift = rate * (u1 / (here * here) + w1 * eta_o / (there * there)) * series
                rate *= 1.0 + 2.0 / 3.0 * drift
                while rate > slow:
                    if rate > fast:
                        counted += 1.0
                        if turned * s > 0.0:
                            onto_left += 1.0
                    rate *= eta_o
                    turned = -turned
                    eta, eta_o, fast, fast_o = eta_o, eta, fast_o, fast
    st[lane.IMPACTS + i] += counted
    st[lane.ONTO_LEFT + i] += onto_left
    st[lane.LOST + i] += 0.5 * par[e + at.RADIUS] * (v / p) ** 2
    if k > st[lane.LAST + i]:
        out[to.T_END] = par[at.T_MOTION] + (x + y)
        if watch:
            account(st, i, par, risen(par), out)
        if rolls(par) and out[to.VERDICT] == RETURNS:
            out[also.FACET] = par[FACET]
        return finish(st, i, par, out[to.VERDICT], out)
    st[lane.X + i] = x + y
    return lift(st, i, par, watch, values, slopes, blocks, tail, out, heave)
