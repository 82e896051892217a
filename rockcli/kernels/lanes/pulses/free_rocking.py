"""Free rocking after the motion, without steps: each swing is as long as an integral says (docs/lanes.md)."""

from __future__ import annotations

from rockcli.kernels.constants import FAST, LEFT_TO_MARCH, MEANINGFUL
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import fma, load, select, some, spread, sqrt, store
from rockcli.kernels.quadrature import NODES, POINTS, WEIGHTS
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential, restoring

MOST = 100000
"""Impacts counted."""

SHORT = 0.01
"""(v/w)^2 of a swing, w the rate at which it would reach the equilibrium, up to which its time is a series: the first
term left out is below 1e-13 of it for tan(alpha) up to .1, 1e-12 up to 1.5."""

BACKLOG = 16
"""Numbers of a case that waits to be counted: case, end of the report, time, rate; of the edge it turns about, and of
the other one, eta, the rates above which an impact is counted and above which it does not rest there, r0, rs, rc."""


@jit
def swing(v, r0, rs, rc, linear, going):
    """Time from take-off at rate v to the next impact, of bodies that are `going`."""
    down = r0 + rc
    pace = v / down
    A = rs * pace * pace
    B = spread(0.0)
    short = abs(A) < SHORT
    if not linear:
        B = 0.25 * v * v * pace * pace
        short = short & (B < SHORT * SHORT) & (abs(r0) <= 0.0)
    # the integral of (1 + A y - B y^2)^(-1/2), y = 1 - x^2, over x from 0 to 1
    a = fma(A, fma(A, fma(A, fma(A, fma(A, -1.0 / 11.0, 1.0 / 9.0), -1.0 / 7.0), 1.0 / 5.0), -1.0 / 3.0), 1.0)
    b = fma(
        A,
        fma(A, fma(A, -40.0 / 99.0, 8.0 / 21.0), -12.0 / 35.0),
        fma(B, fma(A, -80.0 / 231.0, 16.0 / 105.0), 4.0 / 15.0),
    )
    time = 2.0 * pace * fma(B, b, a)
    if some(going & ~short):
        time = select(short, time, long_swing(v, r0, rs, rc, linear))
    return time


@jit
def long_swing(v, r0, rs, rc, linear):
    """The same by a quadrature.

    With the rate w as the variable, dt = dw/M(q(w)) with U(q) = (v^2 - w^2)/2: nothing is singular.  Of the moment
    M = r0 + rs sin q + rc cos q (linear: r0 + rs q) and U its integral, M^2 = (r0 + rc)^2 + 2 rs U - U^2 if r0 = 0,
    without U^2 if linear; else q is sought.
    """
    total = spread(0.0)
    m0 = r0 + rc
    sought = False
    if not linear:
        sought = some(abs(r0) > 0.0)
    for i in range(POINTS):
        u = 0.5 * v * v * (1.0 - NODES[i] * NODES[i])
        square = m0 * m0 + 2.0 * rs * u
        if not linear:
            square = square - u * u
        moment = sqrt(abs(square))
        if sought:
            q = 2.0 * u / (m0 + moment)
            for _ in range(4):
                sine, cosine = sin_cos(q)
                moment = restoring(r0, rs, rc, sine, cosine)
                q = q - (potential(r0, rc, q, rs * (1.0 - cosine), sine) - u) / moment
            sine, cosine = sin_cos(q)
            moment = restoring(r0, rs, rc, sine, cosine)
        total = total + WEIGHTS[i] / moment
    return 2.0 * v * total


@jit
def impacts_until(stop, t, v, edge, other, linear, path, going):
    """Impacts of bodies that take off at t with rate v, up to the time `stop`; -1: too many.

    edge, other: of the edge they turn about first, as in the backlog.  With `path`, also when they
    come to rest, or `stop`; what the impacts carry, the sum of (v/p alpha)^2; and the sum of that times their time.
    """
    count, swung, swung_t, end = spread(0.0), spread(0.0), spread(0.0), stop
    if path:
        end = select(going & ~(v > edge[2]), rest_of(t, v, edge, other), end)
    going = going & (v > edge[2])
    for _ in range(MOST):
        if not some(going):
            break
        t = t + swing(v, edge[3], edge[4], edge[5], linear, going)
        going = going & (t <= stop)
        count = select(going & (v > edge[1]), count + 1.0, count)
        if path:
            size = v * FAST / edge[1]
            carried = size * size - MEANINGFUL * MEANINGFUL
            carried = select(going & (carried > 0.0), carried, 0.0)
            swung, swung_t = swung + carried, swung_t + carried * t
        edge, other = other, edge
        v = edge[0] * v
        if path:
            end = select(going & ~(v > edge[2]), rest_of(t, v, edge, other), end)
        going = going & (v > edge[2])
    return select(going, -1.0, count), select(end < stop, end, stop), swung, swung_t


@jit
def rest_of(t, v, edge, other):
    """When bounces that begin with rate v about an edge at t have ended: a geometric series."""
    return t + 2.0 * v * (1.0 / (edge[3] + edge[5]) + other[0] / (other[3] + other[5])) / (1.0 - edge[0] * other[0])


@jit
def waiting_edge(backlog, first):
    """The numbers of an edge of the cases in the backlog."""
    return (
        load(backlog, first * WIDTH), load(backlog, (first + 1) * WIDTH), load(backlog, (first + 2) * WIDTH),
        load(backlog, (first + 3) * WIDTH), load(backlog, (first + 4) * WIDTH), load(backlog, (first + 5) * WIDTH),
    )  # fmt: skip


@jit
def count_impacts(backlog, count, linear, two_sided, path, out):
    """Add to the results of the cases in the backlog the impacts they still have, and what goes with their `path`."""
    for j in range(count, WIDTH):
        for field in range(BACKLOG):
            backlog[field * WIDTH + j] = backlog[field * WIDTH]
    second = 10 if two_sided else 4
    more, end, swung, swung_t = impacts_until(
        load(backlog, WIDTH), load(backlog, 2 * WIDTH), load(backlog, 3 * WIDTH),
        waiting_edge(backlog, 4), waiting_edge(backlog, second), linear, path,
        load(backlog, 0) >= 0.0,
    )  # fmt: skip
    store(backlog, WIDTH, more)
    store(backlog, 2 * WIDTH, end)
    store(backlog, 3 * WIDTH, swung)
    store(backlog, 4 * WIDTH, swung_t)
    for j in range(count):
        case = int(backlog[j])
        if backlog[WIDTH + j] >= 0.0:
            out[case][to.N_IMPACTS] += backlog[WIDTH + j]
            if path:
                out[case][to.T_END] = backlog[2 * WIDTH + j]
                out[case][to.ONTO_LEFT] += backlog[WIDTH + j]  # to and fro
                out[case][to.ONTO_RIGHT] += backlog[WIDTH + j]
                out[case][to.SWINGS] += backlog[3 * WIDTH + j]
                out[case][to.SWINGS_T] += backlog[4 * WIDTH + j]
        else:
            out[case][to.STATUS] = LEFT_TO_MARCH
