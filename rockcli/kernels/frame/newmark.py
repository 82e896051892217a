"""One step of the Newmark family with Newton's iterations, and the states it begins from (docs/frame.md, E9-E13)."""

from __future__ import annotations

from rockcli.kernels.ahead import CUBE, MATRIX, VECTOR
from rockcli.kernels.frame import layout as at
from rockcli.kernels.frame.banded import clear, clear_band, copy, hold, solve, times
from rockcli.kernels.frame.elements import add_base, add_elements
from rockcli.kernels.jit import entry, jit

MAX_ITERATIONS = 12
"""Iterations after which a step is divided."""

STATIC_ITERATIONS = 60
"""Iterations allowed to find the equilibrium to begin with."""


@jit
def load(par, pull, weights, a_g, a_v, out):
    """Write the external forces at ground accelerations a_g, a_v [m/s^2]: -a_g pull, -(g + a_v) weights."""
    down = (par[at.G] + a_v) if par[at.GRAVITY] > 0.0 else 0.0
    for i in range(len(out)):
        out[i] = -a_g * pull[i] - down * weights[i]


@jit
def forces(par, u, n, a_v, fibres, f, K, B):
    """Write the internal forces f and their tangent K at u."""
    clear(f)
    clear_band(K)
    add_elements(par, u, n, f, K, B)
    add_base(par, u, 1.0 + a_v / par[at.G], fibres, f, K)


@jit
def size(par, x):
    """Largest change of a rotation, or of a displacement over `REACH`; infinite if one is not a number."""
    largest = 0.0
    for i in range(len(x)):
        value = abs(x[i]) if i % 3 == 2 else abs(x[i]) / par[at.REACH]
        if not value < 1e300:
            return 1e300
        largest = max(largest, value)
    return largest


@jit
def step(par, n, mass, damped, pull, weights, fibres, h, a_g, a_v, u, v, a, work, bands, B):
    """Try one step of h [s]; accelerations of the ground are those at the instant of equilibrium.

    On success u, v, a are the state at its end.  Returns the number of iterations, negative without success.
    """
    alpha_d = par[at.ALPHA_D]
    gamma, beta = 1.5 - alpha_d, 0.25 * (2.0 - alpha_d) ** 2
    u_1, v_1, a_1, u_m, f = work[at.TRIAL], work[at.VELOCITY], work[at.ACCELERATION], work[at.AT_ALPHA], work[at.FORCE]
    r, inertia, drag, external = work[at.REST], work[at.INERTIA], work[at.DRAG], work[at.LOAD]
    K, C, A = bands[at.STIFFNESS], bands[at.DAMPING], bands[at.SYSTEM]
    N = len(u)
    load(par, pull, weights, a_g, a_v, external)
    for i in range(N):
        u_1[i] = u[i] + h * v[i] + 0.5 * h * h * a[i]
    u_1[0] = 0.0
    if par[at.HINGED] > 0.0:
        u_1[1] = 0.0
    to_a, to_v = 1.0 / (beta * h * h), gamma / (beta * h)
    for iteration in range(1, MAX_ITERATIONS + 1):
        for i in range(N):
            a_1[i] = to_a * (u_1[i] - u[i]) - v[i] / (beta * h) - (0.5 / beta - 1.0) * a[i]
            v_1[i] = v[i] + h * ((1.0 - gamma) * a[i] + gamma * a_1[i])
            u_m[i] = u[i] + alpha_d * (u_1[i] - u[i])
        forces(par, u_m, n, a_v, fibres, f, K, B)
        times(mass, a_1, inertia)
        for i in range(N):
            r[i] = external[i] - f[i] - inertia[i]
            for k in range(at.BAND):
                A[i, k] = to_a * mass[i, k] + alpha_d * K[i, k]
        if damped:
            for i in range(N):
                u_m[i] = v[i] + alpha_d * (v_1[i] - v[i])
            times(C, u_m, drag)
            for i in range(N):
                r[i] -= drag[i]
                for k in range(at.BAND):
                    A[i, k] += alpha_d * to_v * C[i, k]
        hold(A, r, 0)
        if par[at.HINGED] > 0.0:
            hold(A, r, 1)
        if not solve(A, r):
            return -iteration
        change = size(par, r)
        if change >= 1e300:
            return -iteration
        for i in range(N):
            u_1[i] += r[i]
        if change <= par[at.TOLERANCE]:
            for i in range(N):
                a_1[i] += to_a * r[i]
                v_1[i] += to_v * r[i]
                u[i], v[i], a[i] = u_1[i], v_1[i], a_1[i]
            return iteration
    return -MAX_ITERATIONS


@jit
def accelerate(par, n, mass, damped, pull, weights, fibres, a_g, a_v, u, v, a, work, bands, B):
    """Write the accelerations consistent with u and v; zero for freedoms without mass."""
    f, r, drag, A = work[at.FORCE], work[at.REST], work[at.DRAG], bands[at.SYSTEM]
    forces(par, u, n, a_v, fibres, f, bands[at.STIFFNESS], B)
    load(par, pull, weights, a_g, a_v, r)
    clear(drag)
    if damped:
        times(bands[at.DAMPING], v, drag)
    for i in range(len(u)):
        r[i] -= f[i] + drag[i]
        for k in range(at.BAND):
            A[i, k] = mass[i, k]
    for i in range(len(u)):
        if i == 0 or (i == 1 and par[at.HINGED] > 0.0) or mass[i, 0] == 0.0:
            hold(A, r, i)
    solve(A, r)
    copy(r, a)


@entry(VECTOR, int, VECTOR, VECTOR, MATRIX, VECTOR, MATRIX, CUBE, MATRIX, gives=bool)
def settle(par, n, pull, weights, fibres, u, work, bands, B):
    """Find the equilibrium under the weights with the base held at its rotation u[2]; True if there is a stable one."""
    f, r, A = work[at.FORCE], work[at.REST], bands[at.SYSTEM]
    for _ in range(STATIC_ITERATIONS):
        forces(par, u, n, 0.0, fibres, f, A, B)
        load(par, pull, weights, 0.0, 0.0, r)
        for i in range(len(u)):
            r[i] -= f[i]
        hold(A, r, 0)
        hold(A, r, 2)
        if par[at.HINGED] > 0.0:
            hold(A, r, 1)
        if not solve(A, r):
            return False
        change = size(par, r)
        if change >= 1e300:
            return False
        for i in range(len(u)):
            u[i] += r[i]
        if change <= par[at.TOLERANCE]:
            lowest = A[0, 0]
            for i in range(len(u)):
                lowest = min(lowest, A[i, 0])
            return lowest > 0.0  # a negative pivot: it would buckle
    return False
