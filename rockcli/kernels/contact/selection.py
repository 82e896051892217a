"""The mode that follows an event: complementarity of contact forces and accelerations, in closed form (K8, K9)."""

from __future__ import annotations

import math

from rockcli.kernels.constants import SAME
from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact.codes import FLIGHT, JAM, NEITHER, REST, ROCK, SLIDE, SLIDE_ROCK
from rockcli.kernels.contact.state import edge_under
from rockcli.kernels.jit import jit
from rockcli.kernels.rigid.law import pull


@jit
def stiffness(par, e, beta, slip):
    """A of (K5): normal acceleration of the edge per normal force; slip = mu sgn(u) sgn(theta)."""
    k = par[e + at.RADIUS] ** 2 / par[at.RG2]
    sin_b = math.sin(beta)
    return 1.0 + k * sin_b * (sin_b - slip * math.cos(beta))


@jit
def on_edge(par, foot, a, W):
    """Mode of a body on one edge: (mode, sgn of slip) (K9)."""
    s, q, v, u, e = foot.s, foot.q, foot.v, foot.u, edge_under(foot.s)
    R, rg2, mu_s, mu_k = par[e + at.RADIUS], par[at.RG2], par[at.MU_S], par[at.MU_K]
    beta = par[e + at.ALPHA] - q
    sin_b, cos_b = math.sin(beta), math.cos(beta)
    held = W - R * cos_b * v * v
    if u != 0.0:
        sigma = 1.0 if u > 0.0 else -1.0
        if stiffness(par, e, beta, mu_k * s * sigma) > 0.0:
            return (SLIDE_ROCK, sigma) if held > 0.0 else (FLIGHT, 0.0)
        return (JAM, sigma) if held > 0.0 else (NEITHER, 0.0)
    acc = -R / (rg2 + R * R) * pull(W, sin_b, s * a, cos_b)
    N = W + R * (sin_b * acc - cos_b * v * v)
    T = a + s * R * (cos_b * acc + sin_b * v * v)
    if N > 0.0 and abs(T) <= mu_s * N:
        return ROCK, 0.0
    if held <= 0.0:
        return FLIGHT, 0.0
    best, way = -math.inf, 0.0
    for side in range(2):
        sigma = 1.0 if side == 1 else -1.0
        slip = mu_k * s * sigma
        A = stiffness(par, e, beta, slip)
        if A > 0.0:
            gains = sigma * slip_rate(par, e, s, beta, v, sigma, held / A, a)
            if gains > best:
                best, way = gains, sigma
    return SLIDE_ROCK, way


@jit
def slip_rate(par, e, s, beta, v, sigma, N, a):
    """u' of an edge that slips under the normal force N (K6)."""
    R, rg2, mu = par[e + at.RADIUS], par[at.RG2], par[at.MU_K]
    k = R * R / rg2
    sin_b, cos_b = math.sin(beta), math.cos(beta)
    return s * (-s * a - R * sin_b * v * v - mu * s * sigma * N * (1.0 + k * cos_b * cos_b) + k * N * sin_b * cos_b)


@jit
def on_base(par, u, a, W):
    """Mode of a body flat on the ground that does not turn: (mode, edge it tips over, sgn of slip) (K8)."""
    if W <= 0.0:
        return FLIGHT, 1.0, 0.0
    mu_s, mu_k = par[at.MU_S], par[at.MU_K]
    lead = u if u != 0.0 else -a
    s = -1.0 if lead < 0.0 else 1.0
    e = edge_under(s)
    tan = par[e + at.B] / par[at.H]
    trips = stiffness(par, e, par[e + at.ALPHA], mu_k) > 0.0
    if u != 0.0:
        if mu_k <= tan * SAME:
            return SLIDE, s, s
        return (SLIDE_ROCK, s, s) if trips else (JAM, s, s)
    force = abs(a)
    if force <= W * min(mu_s, tan):
        return REST, s, 0.0
    if force > W * tan and mu_s > tan * SAME:
        inertia = 1.0 + par[at.RG2] / par[e + at.RADIUS] ** 2
        psi = (force - W * tan) / (inertia * (1.0 + tan * tan))
        if force - psi <= mu_s * (W + psi * tan):
            return ROCK, s, 0.0
        if mu_k > tan * SAME:
            return SLIDE_ROCK, s, s
    return SLIDE, s, s
