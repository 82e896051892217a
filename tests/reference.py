"""Independent solvers: scipy's DOP853, restarted at every sample of the motion and every impact.

A block is written from (2.2) alone in theta (not in |theta|), with its own event handling; slow and simple.  `integrate`
takes a sampled motion from rest on, with every uplift in it; `flights` smooth functions of time, from a given uplift or
release.  `oscillator` is the linear one of a response spectrum.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

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


def symmetric(alpha: float, p: float, eta: float) -> Body:
    """A rectangular block whose accelerations are in g."""
    return Body(*({-1: x, 1: x} for x in (0.75 / p**2, alpha, p, eta)), g=1.0)


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


def flight(
    body, s, y, span, a_g, gravity=None, *, linear=False, fallen=0.5 * np.pi, rtol=2.3e-14, atol=1e-18, **how
) -> Any:
    """What scipy finds from the state y over one edge: until the impact, until |theta| = `fallen`, or to the span's end.

    The first event is the impact, the second the fall.
    """
    alpha, p = body.alpha[s], body.p[s]
    sin, cos = ((lambda x: x), (lambda x: 1.0)) if linear else (np.sin, np.cos)

    def rhs(t, u):
        beta = alpha * s - u[0]
        down = 1.0 if gravity is None else gravity(t) / body.g
        return [u[1], -(p**2) * (down * sin(beta) + a_g(t) / body.g * cos(beta))]

    def base(t, u):
        return s * u[0]

    def side(t, u):
        return fallen - s * u[0]

    base.terminal = side.terminal = True  # type: ignore[attr-defined]
    base.direction = side.direction = -1  # type: ignore[attr-defined]
    start = [y[0] if y[0] != 0.0 else s * 1e-300, y[1]]  # off the base, or the impact before is found again
    how |= {"method": "DOP853", "rtol": rtol, "atol": atol, "dense_output": True}
    return solve_ivp(rhs, span, start, events=(base, side), **how)


def flights(
    body: Body, s: int, y, t: float, pieces: list[tuple[float, Callable]], *, rest: float = 1e-9, **how
) -> Iterator[tuple[Any, int]]:
    """Rocking over edge s from the state y at t on, flight by flight, each with its edge; (end, a_g) are the pieces.

    Ends with the last piece, with a fall, or where the rate after an impact is below `rest` p alpha.
    """
    how = {"rtol": 1e-12, "atol": 1e-14} | how
    for end, a_g in pieces:
        while t < end:
            sol = flight(body, s, y, (t, end), a_g, **how)
            yield sol, s
            t, y = float(sol.t[-1]), sol.y[:, -1]
            if sol.t_events[1].size:
                return
            if sol.t_events[0].size:
                y, s = np.array([0.0, body.eta[-s] * y[1]]), -s
                if abs(y[1]) < rest * body.p[s] * body.alpha[s]:
                    return


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
        sol = flight(body, s, y, (t, t1), a_g, gravity)
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
    if falls(body, s, y):
        h.overturned = True
    elif v > 0.0:
        q_max = alpha - np.arccos(np.cos(alpha - q) + 0.5 * v**2 / p**2)
        h.peak_over_alpha = max(h.peak_over_alpha, q_max / alpha)


def falls(body, s, y) -> bool:
    """Whether a body over edge s that the ground leaves alone falls: by energy, v against the separatrix."""
    q, v = s * y[0], s * y[1]
    top = body.p[s] * np.sqrt(2.0 * (1.0 - np.cos(body.alpha[s] - q)))
    return bool(v > (top if q < body.alpha[s] else -top))


def oscillator(pieces: list[tuple[float, Callable]], T: float, zeta: float, *, rtol=1e-11, atol=1e-14) -> float:
    """Largest |x| of the linear oscillator at rest at t = 0: x'' + 2 zeta w x' + w^2 x = -a_g, extrema located.

    (end, a_g) are pieces of the motion, one after the other; after the last one it swings freely for one period.
    """
    w = 2.0 * np.pi / T
    t, y, largest = 0.0, np.zeros(2), 0.0
    for end, a_g in [*pieces, (pieces[-1][0] + T, lambda t: 0.0)]:

        def rhs(t, u, a_g=a_g):
            return [u[1], -2.0 * zeta * w * u[1] - w**2 * u[0] - a_g(t)]

        how = {"method": "DOP853", "rtol": rtol, "atol": atol, "max_step": T / 8.0}
        sol = solve_ivp(rhs, (t, end), y, events=lambda t, u: u[1], **how)
        largest = max(largest, np.max(np.abs(sol.y[0])), *(abs(state[0]) for state in sol.y_events[0]))
        t, y = end, sol.y[:, -1]
    return float(largest)
