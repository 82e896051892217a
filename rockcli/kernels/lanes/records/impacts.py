"""Steps that may touch the base or the next facet, many at a time: the guards and the reset (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.constants import FAST, MEANINGFUL
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.forces import weigh_landing
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.fused import bits, gather, scatter
from rockcli.kernels.lanes.vector.plain import fma, load, select, some, sqrt


@jit
def land(st, queue, j, path, watch, linear, onward, heave):
    """Take the lanes queue[j: j + WIDTH] to the first zero of their polynomials, turned over, or to their steps' ends.

    One of which neither can be told stays where it is, and tries half the step next.

    Returns (lanes at the end of their samples, lanes that may come to rest in the sample they are in, lanes whose
    forces to look into, lanes that have turned over).  `path`: what impacts carry is asked for; `watch`: forces are.
    `onward`: to where the next facet touches, not turned over and with the rate at which they come; what that impact
    carries and loses is not counted here.  heave: None, or the vertical motion.
    """
    lanes = load(queue, j)
    q, h = gather(st, lanes + lane.Q), gather(st, lanes + lane.H)
    c1, c2 = gather(st, lanes + lane.COEFFICIENTS), gather(st, lanes + (lane.COEFFICIENTS + WIDTH))
    c3, c4 = gather(st, lanes + (lane.COEFFICIENTS + 2 * WIDTH)), gather(st, lanes + (lane.COEFFICIENTS + 3 * WIDTH))
    c5, c6 = gather(st, lanes + (lane.COEFFICIENTS + 4 * WIDTH)), gather(st, lanes + (lane.COEFFICIENTS + 5 * WIDTH))
    c7, c8 = gather(st, lanes + (lane.COEFFICIENTS + 6 * WIDTH)), gather(st, lanes + (lane.COEFFICIENTS + 7 * WIDTH))

    # the zero at the start of a flight is divided out
    if onward:
        b0, b1, b2, b3, b4 = gather(st, lanes + lane.WALL) - q, -c1, -c2, -c3, -c4
        b5, b6, b7, b8 = -c5, -c6, -c7, -c8
    else:
        off = q == 0.0
        b0, b1, b2, b3 = select(off, c1, q), select(off, c2, c1), select(off, c3, c2), select(off, c4, c3)
        b4, b5, b6, b7 = select(off, c5, c4), select(off, c6, c5), select(off, c7, c6), select(off, c8, c7)
        b8 = select(off, 0.0 * c8, c8)
    x, hit, going = first_zero(b0, b1, b2, b3, b4, b5, b6, b7, b8)
    x = select(hit, select(x < 1.0, x, 1.0), 1.0)
    end = q + (c1 + (c2 + ((c3 + c4) + ((c5 + c6) + (c7 + c8)))))
    if some(going):  # the bound is too loose to tell, as over all of a sample of one lifted just before: half the step
        x, end = select(going, 0.0, x), select(going, q, end)
        scatter(st, lanes + lane.CAP, select(going, 0.5 * h, gather(st, lanes + lane.CAP)))

    rate = fma(x, 8.0 * c8, 7.0 * c7)
    rate = fma(x, fma(x, fma(x, fma(x, rate, 6.0 * c6), 5.0 * c5), 4.0 * c4), 3.0 * c3)
    rate = fma(x, fma(x, rate, 2.0 * c2), c1) / h
    inward = select(rate < 0.0, -rate, 0.0 * rate)
    place, full, piece = gather(st, lanes + lane.X), gather(st, lanes + lane.LEN), gather(st, lanes + lane.PIECE)
    side, count = (
        gather(st, lanes + lane.SIDE),
        select(hit & (inward > gather(st, lanes + lane.FAST)), 0.0 * q + 1.0, 0.0),
    )
    turned = select(hit, 0.0 * q - 1.0, 1.0)
    doubtful = 0
    if watch:
        there = gather(st, lanes + lane.WALL) if onward else 0.0 * q
        loss = 0.0 * q if onward else select(hit, gather(st, lanes + lane.LOSS), 0.0 * q)
        there = select(hit, there, end)
        doubtful = weigh_landing(st, lanes, q, h, c1, c2, c3, c4, c5, c6, c7, c8, x, loss, there, rate, linear, heave)
    if path and not onward:
        note_carried(st, lanes, hit, inward, piece, fma(x, h, place))
    v = select(hit, gather(st, lanes + lane.ETA) * inward, rate)
    if onward:
        v = rate
    now = fma(x, h, place)
    whole = (now >= full) | (x == 1.0) & (h == full - place)
    piece = select(whole, piece + 1.0, piece)
    now = select(whole, 0.0 * now, now)
    scatter(st, lanes + lane.Q, select(hit, 0.0 * q, end))
    scatter(st, lanes + lane.V, v)
    scatter(st, lanes + lane.X, now)
    scatter(st, lanes + lane.PIECE, piece)
    over = piece >= gather(st, lanes + lane.END)
    if onward:
        return bits(over), 0, doubtful, bits(hit)
    scatter(st, lanes + lane.SIDE, side * turned)
    scatter(st, lanes + lane.FORCING_C, gather(st, lanes + lane.FORCING_C) * turned)
    scatter(st, lanes + lane.FORCING_S, gather(st, lanes + lane.FORCING_S) * turned)
    scatter(st, lanes + lane.IMPACTS, gather(st, lanes + lane.IMPACTS) + count)
    scatter(st, lanes + lane.ONTO_LEFT, gather(st, lanes + lane.ONTO_LEFT) + select(side > 0.0, count, 0.0 * count))
    late = v * gather(st, lanes + lane.SETTLING) > full - now
    slow = hit & ~over & ~late & (v <= gather(st, lanes + lane.SLOW))
    return bits(over), bits(slow), doubtful, bits(hit)


@jit_part
def first_zero(b0, b1, b2, b3, b4, b5, b6, b7, b8):
    """First zeros of WIDTH polynomials in [0, 1], by (T4): (places, whether there is one, whether none can be told)."""
    M = 2.0 * abs(b2) + 6.0 * abs(b3) + 12.0 * abs(b4) + 20.0 * abs(b5)
    M = M + (30.0 * abs(b6) + 42.0 * abs(b7) + 56.0 * abs(b8))
    x = 0.0 * abs(b1)
    going = x == 0.0
    hit = x > 0.0
    for _ in range(400):
        P, dP = fma(b8, x, b7), b8
        dP = fma(dP, x, P)
        P = fma(P, x, b6)
        dP = fma(dP, x, P)
        P = fma(P, x, b5)
        dP = fma(dP, x, P)
        P = fma(P, x, b4)
        dP = fma(dP, x, P)
        P = fma(P, x, b3)
        dP = fma(dP, x, P)
        P = fma(P, x, b2)
        dP = fma(dP, x, P)
        P = fma(P, x, b1)
        dP = fma(dP, x, P)
        P = fma(P, x, b0)
        there = P <= 0.0
        root = sqrt(fma(dP, dP, 2.0 * M * select(there, 0.0 * P, P)))
        up = dP > 0.0
        step = select(up, dP + root, 2.0 * P) / select(up, M, root - dP)
        beyond = ~(step <= 1.0 - x)
        moved = going & ~there & ~beyond
        x = select(moved, x + step, x)
        there = there | (step <= 4e-16 * x) | (M * step * step <= 4e-16 * x * abs(dP))
        hit = hit | going & there
        going = going & ~there & ~beyond
        if not some(going):
            break
    return x, hit, going


@jit_part
def note_carried(st, lanes, hit, inward, piece, x):
    """What impacts at rates `inward`, x after the samples `piece` begin, carry, by which two runs are compared."""
    pace = FAST * inward / gather(st, lanes + lane.FAST)
    carried = pace * pace - MEANINGFUL * MEANINGFUL
    carried = select(hit & (carried > 0.0), carried, 0.0 * inward)
    last = gather(st, lanes + lane.LAST)
    begun = (select(piece > last, last, piece) - gather(st, lanes + lane.FIRST)) * gather(st, lanes + lane.DT)
    scatter(st, lanes + lane.SWINGS, gather(st, lanes + lane.SWINGS) + carried)
    when = carried * (begun + x)
    scatter(st, lanes + lane.SWINGS_T, gather(st, lanes + lane.SWINGS_T) + when)
