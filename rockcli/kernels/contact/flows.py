"""The flows of a body on one edge, in flight, and along the ground, as Taylor series (docs/contact.md)."""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.state import edge_under
from rockcli.kernels.jit import jit_lean


@jit_lean
def trigonometry(c, k, sin_b, cos_b):
    """Coefficient k > 0 of sin and cos of beta = alpha - q from those of q up to k."""
    up = down = 0.0
    for j in range(1, k + 1):
        rate = j * c[j]
        up += rate * cos_b[k - j]
        down += rate * sin_b[k - j]
    sin_b[k], cos_b[k] = -up / k, down / k


@jit_lean
def product(x, y, k):
    """Coefficient k of the product of two series."""
    total = 0.0
    for j in range(k + 1):
        total += x[j] * y[k - j]
    return total


@jit_lean
def squared_rate(c, k):
    """Coefficient k of q'^2."""
    total = 0.0
    for j in range(k + 1):
        total += (j + 1) * c[j + 1] * (k - j + 1) * c[k - j + 1]
    return total


COARSER = 1e3
"""Accelerations need be known to so many times the truncation of the rotation."""

ENOUGH = 4
"""Terms in a row that must be small, as sines may cancel in three."""


@jit_lean
def converged(c, k, power, h, coarse, small):
    """Whether term k + 2 of q and term k of q'' at h are small; `power` is h^k."""
    return abs(c[k + 2]) * power * h * h <= small and (k + 1) * (k + 2) * abs(c[k + 2]) * power <= coarse


@jit_lean
def rock(par, foot, h, small, n, w):
    """Series of q, of the normal force and friction at the edge (two orders less) of a foot that holds, into `w`.

    Returns the order: before n it stops where the terms of q at h are below `small`, those of q'' below p^2 COARSER
    times as much.
    """
    a, W, c, sin_b, cos_b, rate2 = w[row.A_G], w[row.WEIGHT], w[row.Q], w[row.SIN_B], w[row.COS_B], w[row.RATE2]
    N, T = w[row.NORMAL], w[row.FRICTION]
    s, q, e = foot.s, foot.q, edge_under(foot.s)
    R, beta = par[e + at.RADIUS], par[e + at.ALPHA] - q
    lever = R / (par[at.RG2] + R * R)
    coarse, below, power = COARSER * small * par[at.G] * lever, 0, 1.0
    c[0], c[1] = q, foot.v
    sin_b[0], cos_b[0] = math.sin(beta), math.cos(beta)
    for k in range(n - 1):
        if k > 0:
            trigonometry(c, k, sin_b, cos_b)
        c[k + 2] = -lever * (product(W, sin_b, k) + s * product(a, cos_b, k)) / ((k + 1) * (k + 2))
        rate2[k] = squared_rate(c, k)
        below = below + 1 if converged(c, k, power, h, coarse, small) else 0
        power *= h
        if below >= ENOUGH:
            n = k + 2
            break
    trigonometry(c, n - 1, sin_b, cos_b)
    for k in range(n - 1):
        across = along = 0.0
        for j in range(k + 1):
            acc = (j + 1) * (j + 2) * c[j + 2]
            across += sin_b[k - j] * acc - cos_b[k - j] * rate2[j]
            along += cos_b[k - j] * acc + sin_b[k - j] * rate2[j]
        N[k] = W[k] + R * across
        T[k] = a[k] + s * R * along
    return n


@jit_lean
def slide_rock(par, foot, h, small, n, w):
    """Series of q, of the slip velocity (an order less), of N, A and the numerator of N (two less) of a foot that slips
    (K5, K6), into `w`; returns the order, as `rock` does.

    The slip velocity is that of the centre of mass, whose acceleration is -a_g + T, and the turning of the edge about
    it.
    """
    a, W, c, sin_b, cos_b, rate2 = w[row.A_G], w[row.WEIGHT], w[row.Q], w[row.SIN_B], w[row.COS_B], w[row.RATE2]
    N, A, held, tilt, slip = w[row.NORMAL], w[row.STIFFNESS], w[row.HELD], w[row.TILT], w[row.SLIP]
    s, sigma, q, e = foot.s, foot.sigma, foot.q, edge_under(foot.s)
    R, beta, mu = par[e + at.RADIUS], par[e + at.ALPHA] - q, par[at.MU_K]
    k2, way = R * R / par[at.RG2], mu * s * sigma
    coarse, below, power = COARSER * small * par[at.G] * R / (par[at.RG2] + R * R), 0, 1.0
    c[0], c[1] = q, foot.v
    sin_b[0], cos_b[0] = math.sin(beta), math.cos(beta)
    for k in range(n - 1):
        if k > 0:
            trigonometry(c, k, sin_b, cos_b)
        tilt[k] = sin_b[k] - way * cos_b[k]
        A[k] = k2 * product(sin_b, tilt, k)
        if k == 0:
            A[0] += 1.0
        rate2[k] = squared_rate(c, k)
        held[k] = W[k] - R * product(cos_b, rate2, k)
        taken = held[k]
        for j in range(1, k + 1):
            taken -= A[j] * N[k - j]
        N[k] = taken / A[0]
        c[k + 2] = -k2 / R * product(N, tilt, k) / ((k + 1) * (k + 2))
        near = abs(N[k]) * power <= COARSER * small * par[at.G]
        below = below + 1 if near and converged(c, k, power, h, coarse, small) else 0
        power *= h
        if below >= ENOUGH and k >= 2:
            n = k + 2
            break
    trigonometry(c, n - 1, sin_b, cos_b)
    slip[0] = foot.u
    for k in range(1, n):
        turning = 0.0
        for j in range(k + 1):
            turning += cos_b[k - j] * (j + 1) * c[j + 1]
        slip[k] = -(a[k - 1] + mu * sigma * N[k - 1]) / k - s * R * turning
    return n


@jit_lean
def slide(mu, foot, n, w):
    """Series (order n) of the velocity of a body that slides and does not turn."""
    a, W, slip = w[row.A_G], w[row.WEIGHT], w[row.SLIP]
    slip[0] = foot.u
    for k in range(n):
        slip[k + 1] = -(a[k] + mu * foot.sigma * W[k]) / (k + 1)


@jit_lean
def fly(air, n, w):
    """Series (order n) of the horizontal velocity and the height of the centre of mass in flight."""
    a, W, along, height = w[row.A_G], w[row.WEIGHT], w[row.SLIP], w[row.HEIGHT]
    along[0], height[0], height[1] = air.x_rate, air.z, air.z_rate
    for k in range(n):
        along[k + 1] = -a[k] / (k + 1)
        if k + 2 <= n:
            height[k + 2] = -W[k] / ((k + 1) * (k + 2))


@jit_lean
def turning(of_sin, of_cos, air, n, out):
    """Series (order n) of of_sin sin(theta) + of_cos cos(theta) while theta grows at a constant rate."""
    rate, sin_t, cos_t = air.turn, math.sin(air.theta), math.cos(air.theta)
    f, df, power = of_sin * sin_t + of_cos * cos_t, of_sin * cos_t - of_cos * sin_t, 1.0
    for k in range(n + 1):
        out[k] = f * power
        f, df = df, -f  # derivatives by theta go round in fours
        power *= rate / (k + 1)
