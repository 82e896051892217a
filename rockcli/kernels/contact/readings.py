"""What is read off a step: energy, work, extremes."""

from __future__ import annotations

import math

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.contact import results as to
from rockcli.kernels.contact.results import FLIGHT, REST, ROCK, SLIDE
from rockcli.kernels.jit import jit_lean
from rockcli.kernels.rigid.roots import lowest_point, turning_point
from rockcli.kernels.rigid.series import slope, value

# half of the nodes of Gauss and Legendre on [-1, 1], and their weights
NODES = (
    0.09501250983763744, 0.2816035507792589, 0.45801677765722737, 0.6178762444026438,
    0.755404408355003, 0.8656312023878318, 0.9445750230732326, 0.9894009349916499,
)  # fmt: skip
WEIGHTS = (
    0.1894506104550685, 0.18260341504492358, 0.16915651939500254, 0.14959598881657674,
    0.12462897125553388, 0.09515851168249279, 0.062253523938647894, 0.02715245941175409,
)  # fmt: skip


@jit_lean
def energy_on_edge(par, e, s, q, v, u):
    """Energy of a body on an edge over m: kinetic, that of sliding included, and height [J/kg]."""
    R, beta = par[e + at.RADIUS], par[e + at.ALPHA] - q
    x_rate, z_rate = u + s * R * math.cos(beta) * v, R * math.sin(beta) * v
    half = math.sin(0.5 * q)
    rise = R * (math.sin(par[e + at.ALPHA]) * math.sin(q) - 2.0 * math.cos(par[e + at.ALPHA]) * half * half)
    return 0.5 * (x_rate * x_rate + z_rate * z_rate + par[at.RG2] * v * v) + par[at.G] * rise


@jit_lean
def energy_in_flight(par, x_rate, z, z_rate, rate):
    """Energy of a body in flight over m [J/kg]."""
    kinetic = 0.5 * (x_rate * x_rate + z_rate * z_rate + par[at.RG2] * rate * rate)
    return kinetic + par[at.G] * (z - par[at.H])


@jit_lean
def power(par, mode, e, s, sigma, c, m, slip, ns, height, n, y, a, W, d):
    """Power of the ground motion and of friction at y over m: -a_g x' - a_v z' + T v_t [W/kg]."""
    a_g, weight, g = value(a, d, y), value(W, d, y), par[at.G]
    if mode == FLIGHT:
        return -a_g * value(slip, ns, y) - (weight - g) * slope(height, n, y)
    if mode == SLIDE:
        u = value(slip, ns, y)
        return -(a_g + par[at.MU_K] * sigma * weight) * u
    R, v = par[e + at.RADIUS], slope(c, m, y)
    beta = par[e + at.ALPHA] - value(c, m, y)
    sin_b, cos_b = math.sin(beta), math.cos(beta)
    x_rate, z_rate = s * R * cos_b * v, R * sin_b * v
    if mode == ROCK:
        return -a_g * x_rate - (weight - g) * z_rate
    u, way = value(slip, ns, y), par[at.MU_K] * s * sigma
    N = (weight - R * cos_b * v * v) / (1.0 + R * R / par[at.RG2] * sin_b * (sin_b - way * cos_b))
    return -a_g * (x_rate + u) - (weight - g) * z_rate - par[at.MU_K] * sigma * N * u


@jit_lean
def work(par, mode, e, s, sigma, c, m, slip, ns, height, n, x, a, W, d):
    """Work of the ground motion and of friction on [0, x] over m [J/kg].

    By quadrature of the forces times the velocities, so that the balance of energy judges the flow.
    """
    if mode == REST or x == 0.0:
        return 0.0
    total, half = 0.0, 0.5 * x
    for i in range(8):
        for side in range(2):
            y = half * (1.0 + (NODES[i] if side == 1 else -NODES[i]))
            total += WEIGHTS[i] * power(par, mode, e, s, sigma, c, m, slip, ns, height, n, y, a, W, d)
    return total * half


@jit_lean
def extremes(c, n, x, parts, found):
    """Largest value of a polynomial on [0, x] and where, then the smallest and where, into found[0:4]."""
    lo, P_lo, v_lo = 0.0, c[0], slope(c, n, 0.0)
    found[0] = found[2] = P_lo
    found[1] = found[3] = 0.0
    for j in range(1, parts + 1):
        hi = x * j / parts if j < parts else x
        P_hi, v_hi = value(c, n, hi), slope(c, n, hi)
        for inside in range(2):
            y, P = hi, P_hi
            if inside == 0:
                if v_lo > 0.0 > v_hi:
                    y = turning_point(c, n, lo, hi)
                elif v_lo < 0.0 < v_hi:
                    y = lowest_point(c, n, lo, hi)
                else:
                    continue
                P = value(c, n, y)
            if found[0] < P:
                found[0], found[1] = P, y
            if found[2] > P:
                found[2], found[3] = P, y
        lo, v_lo = hi, v_hi


@jit_lean
def note_angle(q, side, t, out):
    """Raise the peak of |theta| to q if it is the largest so far, of all or of its side."""
    which = to.PEAK_RIGHT if side > 0.0 else to.PEAK_LEFT
    out[which] = max(out[which], q)
    if q > out[to.PEAK] * (1.0 + 1e-12):
        out[to.PEAK], out[to.PEAK_SIDE], out[to.T_PEAK] = q, side, t


@jit_lean
def note_slide(place, out):
    """Raise the largest slide."""
    if abs(place) > abs(out[to.SLIDE_PEAK]):
        out[to.SLIDE_PEAK] = place
