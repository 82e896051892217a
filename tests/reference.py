"""An independent solver: scipy's DOP853, restarted at every sample of the motion and every impact.

Written from (2.2) alone in theta (not in |theta|), with its own event handling; slow and simple.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


@dataclass
class Body:
    """Edges by sign of theta: -1 left, +1 right."""

    R: dict
    alpha: dict
    p: dict
    eta: dict
    g: float = 9.81


def body_of(block, eta, g: float = 9.81, case: int = 0) -> Body:
    """The same body as a `Block`, from its public numbers only."""
    p = np.sqrt(g / (block.inertia[case] * block.R[case]))
    sides = (-1, 1)
    return Body(
        R=dict(zip(sides, block.R[case], strict=True)),
        alpha=dict(zip(sides, block.alpha[case], strict=True)),
        p=dict(zip(sides, p, strict=True)),
        eta=dict(zip(sides, np.broadcast_to(eta, (2,)), strict=True)),
        g=g,
    )


@dataclass
class History:
    peak: float = 0.0
    peak_over_alpha: float = 0.0
    peaks: dict = field(default_factory=lambda: {-1: 0.0, 1: 0.0})
    overturned: bool = False
    t_impact: list = field(default_factory=list)
    w_before: list = field(default_factory=list)
    theta: list = field(default_factory=list)


def integrate(body: Body, values, dt: float, *, vertical=None, free: float = 20.0, theta_0=0.0, rate_0=0.0) -> History:
    """Rocking under a piecewise-linear motion, then `free`/p of free rocking, then energy."""
    h = History()
    values = np.asarray(values, float)
    up = np.zeros_like(values) if vertical is None else np.asarray(vertical, float)
    times = np.arange(len(values)) * dt
    t_free = times[-1] + free / min(body.p.values())
    pieces = [(times[i], times[i + 1], values[i], values[i + 1], up[i], up[i + 1]) for i in range(len(values) - 1)]
    quiet = np.linspace(times[-1], t_free, int(free * 4) + 1)
    pieces += [(a, b, 0.0, 0.0, 0.0, 0.0) for a, b in itertools.pairwise(quiet)]
    y = np.array([theta_0, rate_0])
    s = int(np.sign(theta_0 if theta_0 != 0.0 else rate_0))  # 0: at rest
    for piece in pieces:
        y, s = _over_piece(body, piece, y, s, h)
        if h.overturned:
            return h
    if s != 0:
        _finish(body, y, s, h)
    return h


def _over_piece(body, piece, y, s, h):
    t0, t1, a0, a1, v0, v1 = piece
    t = t0

    def a_g(x):
        return a0 + (a1 - a0) * (x - t0) / (t1 - t0)

    def gravity(x):
        return body.g + v0 + (v1 - v0) * (x - t0) / (t1 - t0)

    while t < t1:
        if s == 0:
            lifted = _uplift(body, a_g, gravity, t, t1)
            if lifted is None:
                return np.zeros(2), 0
            t, s = lifted
            y = np.zeros(2)
        alpha, p = body.alpha[s], body.p[s]

        def rhs(x, u, alpha=alpha, p=p, s=s):
            beta = alpha * s - u[0]
            return [u[1], -(p**2) * (gravity(x) / body.g * np.sin(beta) + a_g(x) / body.g * np.cos(beta))]

        def base(x, u, s=s):
            return s * u[0]

        def side(x, u, s=s):
            return 0.5 * np.pi - s * u[0]

        base.terminal = side.terminal = True
        base.direction = side.direction = -1
        sol = solve_ivp(
            rhs, (t, t1), y, method="DOP853", rtol=2.3e-14, atol=1e-18, events=(base, side), dense_output=True
        )
        _watch(sol, s, alpha, h)
        if len(sol.t_events[1]):
            h.overturned = True
            return y, s
        if not len(sol.t_events[0]):
            return sol.y[:, -1], s
        t, w = sol.t_events[0][0], sol.y_events[0][0][1]
        h.t_impact.append(t)
        h.w_before.append(w)
        y, s = np.array([0.0, body.eta[-s] * w]), -s
        pressed = all(gravity(t) * np.sin(body.alpha[k]) + k * a_g(t) * np.cos(body.alpha[k]) > 0.0 for k in (-1, 1))
        if abs(y[1]) < 1e-9 * p * alpha and pressed:
            y, s = np.zeros(2), 0
        else:  # step off the base, or the same event is found again
            y[0] = s * 1e-300
    return y, s


def _uplift(body, a_g, gravity, t, t1):
    best = None
    for s in (-1, 1):
        tan = np.tan(body.alpha[s])

        def excess(x, s=s, tan=tan):
            return -s * a_g(x) - gravity(x) * tan

        if excess(t) > 0.0:
            return t, s
        if excess(t1) > 0.0:
            x = brentq(excess, t, t1, xtol=1e-15, rtol=9e-16)
            if best is None or x < best[0]:
                best = (x, s)
    return best


def _watch(sol, s, alpha, h):
    """The peak of |theta|: at steps' ends, refined where the rate changes sign."""
    for i in range(len(sol.t) - 1):
        if s * sol.y[1, i] > 0.0 >= s * sol.y[1, i + 1]:
            x = brentq(lambda x: sol.sol(x)[1], sol.t[i], sol.t[i + 1], xtol=1e-15)
            q = s * float(sol.sol(x)[0])
            h.peaks[s] = max(h.peaks[s], q)
            if q / alpha > h.peak_over_alpha:
                h.peak, h.peak_over_alpha = s * q, q / alpha


def _finish(body, y, s, h):
    """Free rocking by energy: past the top it falls; a rise under way ends at its turning point."""
    alpha, p = body.alpha[s], body.p[s]
    q, v = s * y[0], s * y[1]
    top = p**2 * (1.0 - np.cos(alpha - q))
    if (q >= alpha and v >= 0.0) or (v > 0.0 and 0.5 * v**2 > top):
        h.overturned = True
    elif v > 0.0:
        q_max = alpha - np.arccos(np.cos(alpha - q) + 0.5 * v**2 / p**2)
        h.peak_over_alpha = max(h.peak_over_alpha, q_max / alpha)
