"""Beam elements along the vertical, and what stands under them (docs/frame.md, equations E1-E8).

Freedoms of node i: 3 i horizontal u, 3 i + 1 vertical v (up), 3 i + 2 rotation theta (clockwise, as u = s sin(theta)).
"""

from __future__ import annotations

import math

from rockcli.kernels.ahead import MATRIX, VECTOR
from rockcli.kernels.frame import layout as at
from rockcli.kernels.frame.banded import clear_band
from rockcli.kernels.jit import entry, jit


@jit
def pose(par, u, i, B):
    """Strain-displacement rows B (3, 6) of element i; return length, extension and both end rotations (E1, E2)."""
    L, j = par[at.LENGTH], 3 * i
    du, dv = u[j + 3] - u[j], u[j + 4] - u[j + 1]
    if par[at.COROTATIONAL] > 0.0:
        length = math.sqrt(du * du + (L + dv) * (L + dv))
        s, c = du / length, (L + dv) / length
        extension = (du * du + (2.0 * L + dv) * dv) / (length + L)
        chord = math.atan2(du, L + dv)
    else:
        length, s, c, extension, chord = L, 0.0, 1.0, dv, du / L
    B[0, 0], B[0, 1], B[0, 2], B[0, 3], B[0, 4], B[0, 5] = -s, -c, 0.0, s, c, 0.0
    x, z = c / length, -s / length
    B[1, 0], B[1, 1], B[1, 2], B[1, 3], B[1, 4], B[1, 5] = x, z, 1.0, -x, -z, 0.0
    B[2, 0], B[2, 1], B[2, 2], B[2, 3], B[2, 4], B[2, 5] = x, z, 0.0, -x, -z, 1.0
    return length, extension, u[j + 2] - chord, u[j + 5] - chord


@jit
def add_elements(par, u, n, f, K, B):
    """Add the nodal forces of n elements to f and their tangent stiffness to K (E3, E4)."""
    axial, bending = par[at.AXIAL] / par[at.LENGTH], par[at.BENDING] / par[at.LENGTH]
    geometric = par[at.COROTATIONAL] > 0.0
    for i in range(n):
        length, extension, lower, upper = pose(par, u, i, B)
        N = axial * extension
        M_lower = bending * (4.0 * lower + 2.0 * upper)
        M_upper = bending * (2.0 * lower + 4.0 * upper)
        pull, couple = N * length, M_lower + M_upper
        for a in range(6):
            f[3 * i + a] += B[0, a] * N + B[1, a] * M_lower + B[2, a] * M_upper
            # across = length d(chord): what the chord's rotation is made of, without the nodes' own rotation
            across_a = 0.0 if a % 3 == 2 else -B[1, a]
            for b in range(a + 1):
                k = axial * B[0, a] * B[0, b]
                k += bending * (B[1, a] * (4.0 * B[1, b] + 2.0 * B[2, b]) + B[2, a] * (2.0 * B[1, b] + 4.0 * B[2, b]))
                if geometric:
                    across_b = 0.0 if b % 3 == 2 else -B[1, b]
                    k += pull * across_a * across_b
                    k += couple / length * (B[0, a] * across_b + across_a * B[0, b])
                K[3 * i + a, a - b] += k


@jit
def damping(par, u, n, C, B):
    """Write the damping matrix at u: the dashpot, and `STIFF_DAMPING` times the material stiffness (E7).

    The material stiffness alone, so that a rigid rotation is not damped.
    """
    clear_band(C)
    axial = par[at.STIFF_DAMPING] * par[at.AXIAL] / par[at.LENGTH]
    bending = par[at.STIFF_DAMPING] * par[at.BENDING] / par[at.LENGTH]
    for i in range(n):
        pose(par, u, i, B)
        for a in range(6):
            for b in range(a + 1):
                k = axial * B[0, a] * B[0, b]
                k += bending * (B[1, a] * (4.0 * B[1, b] + 2.0 * B[2, b]) + B[2, a] * (2.0 * B[1, b] + 4.0 * B[2, b]))
                C[3 * i + a, a - b] += k
    C[2, 0] += par[at.DASHPOT]


@jit
def spring(par, theta, factor):
    """Moment and tangent of a rotational base spring at theta (E5) under `factor` = 1 + a_v/g times the weight.

    The moment of a rigid base is in proportion to the weight, the stiffness of a Winkler base in contact is not.
    """
    if par[at.BASE] != at.WINKLER:
        M, k = rigid_spring(par, theta)
        return factor * M, factor * k
    q, s = abs(theta), 1.0 if theta >= 0.0 else -1.0
    b, kw, W = par[at.HALF_WIDTH], par[at.KW], factor * par[at.WEIGHT]
    k = 2.0 / 3.0 * kw * b**3
    if W <= 0.0:
        return 0.0, 0.0
    if q <= W / (2.0 * kw * b * b):
        return k * theta, k
    root = math.sqrt(2.0 * W / (kw * q))
    return s * W * (b - root / 3.0), W * root / (6.0 * q)


@jit
def rigid_spring(par, theta):
    """Moment and tangent of a spring that stays at or softens from its yield moment, under the weight at rest."""
    q, s = abs(theta), 1.0 if theta >= 0.0 else -1.0
    if q <= par[at.YIELD_ROTATION]:
        k = par[at.YIELD_MOMENT] / par[at.YIELD_ROTATION]
        return k * theta, k
    if par[at.BASE] == at.PLASTIC:
        return s * par[at.YIELD_MOMENT], 0.0
    strength = par[at.YIELD_MOMENT] / math.sin(par[at.ALPHA] - par[at.YIELD_ROTATION])
    return s * strength * math.sin(par[at.ALPHA] - q), -strength * math.cos(par[at.ALPHA] - q)


@jit
def add_base(par, u, factor, fibres, f, K):
    """Add the base, the weight times `factor`: a spring, or fibres, place and stiffness (k, 2) (E5, E6)."""
    if par[at.BASE] != at.FIBRES:
        M, k = spring(par, u[2], factor)
        f[2] += M
        K[2, 0] += k
        return
    for j in range(len(fibres)):
        x, k = fibres[j, 0], fibres[j, 1]
        gap = u[1] - x * u[2]
        if gap <= 0.0:
            f[1] += k * gap
            f[2] -= x * k * gap
            K[1, 0] += k
            K[2, 1] -= x * k
            K[2, 0] += x * x * k


@jit
def base_moment(par, u, factor, fibres):
    """Moment of the base opposing theta [N m]."""
    if par[at.BASE] != at.FIBRES:
        M, _ = spring(par, u[2], factor)
        return M
    M = 0.0
    for j in range(len(fibres)):
        gap = u[1] - fibres[j, 0] * u[2]
        if gap < 0.0:
            M -= fibres[j, 0] * fibres[j, 1] * gap
    return M


@entry(VECTOR, float, gives=float)
def spring_energy(par, theta):
    """Energy stored in a rotational base spring [J]."""
    q = abs(theta)
    if par[at.BASE] == at.WINKLER:
        b, kw, W = par[at.HALF_WIDTH], par[at.KW], par[at.WEIGHT]
        q_1 = W / (2.0 * kw * b * b)
        stored = kw * b**3 / 3.0 * min(q, q_1) ** 2
        if q > q_1:
            stored += W * (b * (q - q_1) - 2.0 / 3.0 * math.sqrt(2.0 * W / kw) * (math.sqrt(q) - math.sqrt(q_1)))
        return stored
    q_y, M_y = par[at.YIELD_ROTATION], par[at.YIELD_MOMENT]
    stored = 0.5 * M_y / q_y * min(q, q_y) ** 2
    if q > q_y:
        if par[at.BASE] == at.PLASTIC:
            stored += M_y * (q - q_y)
        else:
            alpha = par[at.ALPHA]
            stored += M_y / math.sin(alpha - q_y) * (math.cos(alpha - q) - math.cos(alpha - q_y))
    return stored


@entry(VECTOR, VECTOR, int, VECTOR, MATRIX, MATRIX, gives=float)
def stored_energy(par, u, n, weights, fibres, B):
    """Strain energy of elements and base, and potential of the weights where they are loads [J] (E8)."""
    total = 0.0
    axial, bending = par[at.AXIAL] / par[at.LENGTH], par[at.BENDING] / par[at.LENGTH]
    for i in range(n):
        _, extension, lower, upper = pose(par, u, i, B)
        total += 0.5 * axial * extension * extension
        total += 2.0 * bending * (lower * lower + lower * upper + upper * upper)
    if par[at.BASE] == at.FIBRES:
        for j in range(len(fibres)):
            gap = u[1] - fibres[j, 0] * u[2]
            if gap < 0.0:
                total += 0.5 * fibres[j, 1] * gap * gap
    else:
        total += spring_energy(par, u[2])
    if par[at.GRAVITY] > 0.0:
        for i in range(1, len(u), 3):
            total += par[at.G] * weights[i] * u[i]
    return total
