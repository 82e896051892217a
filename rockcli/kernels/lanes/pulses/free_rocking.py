"""Free rocking after the motion, without steps: each swing is as long as an integral says (docs/sweeps.md)."""

from __future__ import annotations

import numpy as np

from rockcli.kernels.constants import LEFT_TO_MARCH
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.elementary import sin_cos
from rockcli.kernels.lanes.vector.plain import load, select, some, spread, sqrt, store
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rigid.law import potential, restoring

NODES, WEIGHTS = (np.polynomial.legendre.leggauss(10)[0] + 1.0) / 2.0, np.polynomial.legendre.leggauss(10)[1] / 2.0
"""Of Gauss and Legendre on [0, 1]."""

LOW = 0.7
"""Rate at take-off over that which reaches the equilibrium, up to which the quadrature is good to 1e-11."""

MOST = 100000
"""Impacts counted."""

BACKLOG = 16
"""Numbers of a case that waits to be counted: case, end of the report, time, rate; of the edge it turns about, and of
the other one, eta, the rates above which an impact is counted and above which it does not rest there, r0, rs, rc."""


@jit_lean
def swing(v, r0, rs, rc, linear):
    """Time from take-off at rate v to the next impact.

    With the rate w as the variable, dt = dw/M(q(w)) with U(q) = (v^2 - w^2)/2: nothing is singular.  Of the moment
    M = r0 + rs sin q + rc cos q (linear: r0 + rs q) and U its integral, M^2 = (r0 + rc)^2 + 2 rs U - U^2 if r0 = 0,
    without U^2 if linear; else q is sought.
    """
    total = spread(0.0)
    m0 = r0 + rc
    sought = False
    if not linear:
        sought = some(abs(r0) > 0.0)
    for i in range(10):
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


@jit_lean
def impacts_until(stop, t, v, edge, other, linear, going):
    """Impacts of bodies that take off at t with rate v, up to the time `stop`; -1: too many.

    edge, other: of the edge they turn about first, as in the backlog.
    """
    count = spread(0.0)
    going = going & (v > edge[2])
    for _ in range(MOST):
        if not some(going):
            break
        t = t + swing(v, edge[3], edge[4], edge[5], linear)
        going = going & (t <= stop)
        count = select(going & (v > edge[1]), count + 1.0, count)
        edge, other = other, edge
        v = edge[0] * v
        going = going & (v > edge[2])
    return select(going, -1.0, count)


@jit_lean
def waiting_edge(backlog, first):
    """The numbers of an edge of the cases in the backlog."""
    return (
        load(backlog, first * WIDTH), load(backlog, (first + 1) * WIDTH), load(backlog, (first + 2) * WIDTH),
        load(backlog, (first + 3) * WIDTH), load(backlog, (first + 4) * WIDTH), load(backlog, (first + 5) * WIDTH),
    )  # fmt: skip


@jit_lean
def count_impacts(backlog, count, linear, two_sided, out):
    """Add to the results of the cases in the backlog the impacts they still have."""
    for j in range(count, WIDTH):
        for field in range(BACKLOG):
            backlog[field * WIDTH + j] = backlog[field * WIDTH]
    second = 10 if two_sided else 4
    more = impacts_until(
        load(backlog, WIDTH), load(backlog, 2 * WIDTH), load(backlog, 3 * WIDTH),
        waiting_edge(backlog, 4), waiting_edge(backlog, second), linear, load(backlog, 0) >= 0.0,
    )  # fmt: skip
    store(backlog, WIDTH, more)
    for j in range(count):
        case = int(backlog[j])
        if backlog[WIDTH + j] >= 0.0:
            out[case][to.N_IMPACTS] += backlog[WIDTH + j]
        else:
            out[case][to.STATUS] = LEFT_TO_MARCH
