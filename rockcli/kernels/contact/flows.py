"""The flows of a body on one edge, in flight, and along the ground, as Taylor series (docs/contact.md)."""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import workspace as row
from rockcli.kernels.contact.state import edge_under
from rockcli.kernels.jit import jit

COARSER = 1e3
"""Accelerations need be known to so many times the truncation of the rotation."""

ENOUGH, ENOUGH_OF_STRAIGHT = 4, 2
"""Terms in a row that must be small, as sines of the ground's motion may cancel in three, a straight line in one."""


@jit
def turn(c, k, w):
    """Coefficient k of q' and of the rate of sin(beta), k + 1 of sin and cos of beta = alpha - q, from those of q.

    Both sums in one loop: each waits for its last addition, not for the other's.
    """
    rate, lean, sin_b, cos_b = w[row.RATE], w[row.LEAN], w[row.SIN_B], w[row.COS_B]
    rate[k] = (k + 1) * c[k + 1]
    up = down = 0.0
    for j in range(k + 1):
        up += rate[j] * cos_b[k - j]
        down += rate[j] * sin_b[k - j]
    lean[k] = -up
    share = 1.0 / (k + 1)
    sin_b[k + 1], cos_b[k + 1] = -up * share, down * share


@jit
def converged(c, k, power, h, coarse, small):
    """Whether term k + 2 of q and term k of q'' at h are small; `power` is h^k."""
    return abs(c[k + 2]) * power * h * h <= small and (k + 1) * (k + 2) * abs(c[k + 2]) * power <= coarse


@jit
def rock(par, foot, h, small, n, degree, w):
    """Series of q, of the normal force and friction at the edge (two orders less) of a foot that holds, into `w`.

    degree: of the ground's motion.  Returns the order: before n it stops where the terms of q at h are below `small`,
    those of q'' below p^2 COARSER times as much.  N and T are the accelerations of R cos(beta) and -s R sin(beta).
    """
    a, W, c, sin_b, cos_b = w[row.A_G], w[row.WEIGHT], w[row.Q], w[row.SIN_B], w[row.COS_B]
    N, T = w[row.NORMAL], w[row.FRICTION]
    s, q, e = foot.s, foot.q, edge_under(foot.s)
    R, beta = par[e + at.RADIUS], par[e + at.ALPHA] - q
    lever = R / (par[at.RG2] + R * R)
    coarse, below, power = COARSER * small * par[at.G] * lever, 0, 1.0
    enough = ENOUGH if degree > 1 else ENOUGH_OF_STRAIGHT
    c[0], c[1] = q, foot.v
    sin_b[0], cos_b[0] = math.sin(beta), math.cos(beta)
    for k in range(n - 1):
        turn(c, k, w)
        moment = 0.0
        for j in range(min(k, degree) + 1):
            moment += W[j] * sin_b[k - j] + s * a[j] * cos_b[k - j]
        c[k + 2] = -lever * moment / ((k + 1) * (k + 2))
        below = below + 1 if converged(c, k, power, h, coarse, small) else 0
        power *= h
        if below >= enough:
            n = k + 2
            break
    turn(c, n - 1, w)
    for k in range(n - 1):
        twice = (k + 1) * (k + 2)
        N[k] = W[k] + R * twice * cos_b[k + 2]
        T[k] = a[k] - s * R * twice * sin_b[k + 2]
    return n


@jit
def slide_rock(par, foot, h, small, n, degree, w):
    """Series of q, of the slip velocity (an order less), of N, A and the numerator of N (two less) of a foot that slips
    (K5, K6), into `w`; returns the order, as `rock` does.

    The slip velocity is that of the centre of mass, whose acceleration is -a_g + T, and the turning of the edge about
    it.  As R cos(beta) q'^2 is -R q' times the rate of sin(beta), all sums of a term go on in one loop.
    """
    a, W, c, sin_b, cos_b, rate, lean = (
        w[row.A_G], w[row.WEIGHT], w[row.Q], w[row.SIN_B], w[row.COS_B], w[row.RATE], w[row.LEAN],
    )  # fmt: skip
    N, A, held, tilt, slip = w[row.NORMAL], w[row.STIFFNESS], w[row.HELD], w[row.TILT], w[row.SLIP]
    s, sigma, q, e = foot.s, foot.sigma, foot.q, edge_under(foot.s)
    R, beta, mu = par[e + at.RADIUS], par[e + at.ALPHA] - q, par[at.MU_K]
    k2, way = R * R / par[at.RG2], mu * s * sigma
    coarse, below, power = COARSER * small * par[at.G] * R / (par[at.RG2] + R * R), 0, 1.0
    enough = ENOUGH if degree > 1 else ENOUGH_OF_STRAIGHT
    c[0], c[1], part = q, foot.v, 0.0
    sin_b[0], cos_b[0] = math.sin(beta), math.cos(beta)
    for k in range(n - 1):
        turn(c, k, w)
        tilt[k] = sin_b[k] - way * cos_b[k]
        stiff, driven = sin_b[0] * tilt[k], lean[0] * rate[k]
        given = turned = 0.0
        for j in range(1, k):
            stiff += sin_b[j] * tilt[k - j]
            driven += lean[j] * rate[k - j]
            given += A[j] * N[k - j]
            turned += N[j] * tilt[k - j]
        if k == 0:
            A[0], held[0] = 1.0 + k2 * stiff, W[0] + R * driven
            part = 1.0 / A[0]
            N[0] = held[0] * part
        else:
            A[k], held[k] = k2 * (stiff + sin_b[k] * tilt[0]), W[k] + R * (driven + lean[k] * rate[0])
            N[k] = (held[k] - given - A[k] * N[0]) * part
            turned += N[0] * tilt[k]
        c[k + 2] = -k2 / R * (turned + N[k] * tilt[0]) / ((k + 1) * (k + 2))
        near = abs(N[k]) * power <= COARSER * small * par[at.G]
        below = below + 1 if near and converged(c, k, power, h, coarse, small) else 0
        power *= h
        if below >= enough and k >= 2:
            n = k + 2
            break
    turn(c, n - 1, w)
    slip[0] = foot.u
    for k in range(1, n):
        slip[k] = s * R * lean[k] - (a[k - 1] + mu * sigma * N[k - 1]) / k
    return n


@jit
def slide(mu, foot, n, w):
    """Series (order n) of the velocity of a body that slides and does not turn."""
    a, W, slip = w[row.A_G], w[row.WEIGHT], w[row.SLIP]
    slip[0] = foot.u
    for k in range(n):
        slip[k + 1] = -(a[k] + mu * foot.sigma * W[k]) / (k + 1)


@jit
def fly(air, n, w):
    """Series (order n) of the horizontal velocity and the height of the centre of mass in flight."""
    a, W, along, height = w[row.A_G], w[row.WEIGHT], w[row.SLIP], w[row.HEIGHT]
    along[0], height[0], height[1] = air.x_rate, air.z, air.z_rate
    for k in range(n):
        along[k + 1] = -a[k] / (k + 1)
        if k + 2 <= n:
            height[k + 2] = -W[k] / ((k + 1) * (k + 2))


@jit
def turning(of_sin, of_cos, air, n, out):
    """Series (order n) of of_sin sin(theta) + of_cos cos(theta) while theta grows at a constant rate."""
    rate, sin_t, cos_t = air.turn, math.sin(air.theta), math.cos(air.theta)
    f, df, power = of_sin * sin_t + of_cos * cos_t, of_sin * cos_t - of_cos * sin_t, 1.0
    for k in range(n + 1):
        out[k] = f * power
        f, df = df, -f  # derivatives by theta go round in fours
        power *= rate / (k + 1)
