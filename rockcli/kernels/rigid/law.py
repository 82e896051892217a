"""One edge of the body and what its law says (docs/theory.md, T2): moments, energy, the separatrix."""

from __future__ import annotations

import math
from typing import NamedTuple

from rockcli.kernels import formulas
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid import parameters as at

restoring = jit(formulas.restoring)
driving = jit(formulas.driving)
pull = jit(formulas.pull)
potential = jit(formulas.potential)


class Edge(NamedTuple):
    """What is known of the body while it turns about one of its edges: `kernels.rigid.parameters`, and g."""

    g: float
    p2: float
    alpha: float
    r0: float
    rs: float
    rc: float
    fc: float
    fs: float
    threshold: float
    q_star: float
    slope: float
    eta: float
    damper: float
    radius: float


@jit
def edge_of(par, e):
    """The edge whose numbers begin at par[e]: at.LEFT or at.RIGHT."""
    return Edge(
        par[at.G], par[e + at.P2], par[e + at.ALPHA], par[e + at.R0], par[e + at.RS], par[e + at.RC], par[e + at.FC],
        par[e + at.FS], par[e + at.THRESHOLD], par[e + at.Q_STAR], par[e + at.SLOPE], par[e + at.ETA],
        par[e + at.DAMPER], par[e + at.RADIUS],
    )  # fmt: skip


@jit
def pressed(edge, s, a, a_v):
    """Deceleration of a body that starts to turn about an edge: -q'' at q = 0."""
    back = restoring(edge.r0, edge.rs, edge.rc, 0.0, 1.0)
    return edge.p2 * pull(1.0 + a_v / edge.g, back, s * a / edge.g, driving(edge.fc, edge.fs, 0.0, 1.0))


@jit
def energy(edge, q, v, linear):
    """Energy about an edge over m g: R (v^2/(2 p^2) + potential), zero at q = 0.

    Edges of unequal bodies: m g R is the common unit, as I_O p^2 = m g R.
    """
    if linear:
        stored = q * (edge.r0 + 0.5 * edge.rs * q)
    else:
        half = math.sin(0.5 * q)
        stored = potential(edge.r0, edge.rc, q, 2.0 * edge.rs * half * half, math.sin(q))
    return edge.radius * (0.5 * v * v / edge.p2 + stored)


@jit
def barrier(edge, q, linear):
    """Potential energy still missing to the unstable equilibrium, over I_O p^2.

    With y = q_star - q the restoring law is r0 (1 - cos y) + slope sin y, so the energy is
    r0 (y - sin y) + 2 slope sin^2(y/2): no cancellation near the top.  Linear: slope y^2/2.
    """
    y = edge.q_star - q
    if linear:
        return 0.5 * edge.slope * y * y
    half = math.sin(0.5 * y)
    return edge.r0 * (y - math.sin(y)) + 2.0 * edge.slope * half * half


@jit
def separatrix(edge, q, v, linear):
    """Distance from the separatrix in units of rotation: > 0 falls, < 0 returns.

    v/p - sgn(q_star - q) sqrt(2 barrier): the unstable coordinate of the saddle at q_star.
    """
    root = math.sqrt(2.0 * max(barrier(edge, q, linear), 0.0))
    side = 1.0 if q <= edge.q_star else -1.0
    return v / math.sqrt(edge.p2) - side * root
