"""Whether a body falls, told from how an OpenSees script left it: by its energy, impact by impact."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rockcli.kernels import formulas
from rockcli.kernels.constants import FALLS, RETURNS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.scene.laws.models import MODELS
from rockcli.solvers.opensees.run import Answer

Array = NDArray[np.float64]

MARGIN = {False: 1e-3, True: 0.05}
"""Fraction of the barrier by which the energy must differ from it for the outcome to be told; True: elastic."""


@dataclass(frozen=True)
class Law:
    """The law that tells the outcome.

    Attributes:
        q_star: rotation at which the restoring moment vanishes [rad].
        potential, force: U(q)/(I_O p^2) [1] at a rotation [rad], and its derivative.
    """

    q_star: float
    potential: Callable[[float], float]
    force: Callable[[float], float]


def outcome_law(batch: Batch, i: int, mass: float) -> Law:
    """The law of case i: of the flexible column that for E = inf, on a Winkler base with its moment (F6).

    `mass` [kg]: of the metre of depth that is solved, of which kw is.
    """
    pair = ("3", "corotational") if batch.model == "flexible" else (batch.model, batch.geometry)
    at = slice(i, i + 1)
    law = MODELS[pair].law(batch.block.alpha[at, LEFT], batch.block.tan_alpha[at, LEFT])
    r0, rs, rc = (float(x[0]) for x in (law.r0, law.rs, law.rc))
    if batch.base is not None and batch.base.law == "winkler":
        opens = mass * float(batch.g[i]) / (2.0 * float(batch.base.kw[i]) * float(batch.block.b[i, LEFT]) ** 2)
        return _on_winkler_base(r0, rs, opens)

    def potential(q: float) -> float:
        return float(formulas.potential(r0, rc, q, 2.0 * rs * float(np.sin(0.5 * q)) ** 2, float(np.sin(q))))

    def force(q: float) -> float:
        return r0 + rs * float(np.sin(q)) + rc * float(np.cos(q))

    return Law(float(law.q_star[0]), potential, force)


def _on_winkler_base(r0: float, rs: float, opens: float) -> Law:
    """The corotational law r0 + rs sin q with the moment of a base that `opens` at a rotation [rad] in place of r0."""

    def potential(q: float) -> float:
        stored = q - 4.0 / 3.0 * np.sqrt(opens * q) + 0.5 * opens if q > opens else q * q / (6.0 * opens)
        return float(r0 * stored + 2.0 * rs * np.sin(0.5 * q) ** 2)

    def force(q: float) -> float:
        held = 1.0 - 2.0 / 3.0 * np.sqrt(opens / q) if q > opens else q / (3.0 * opens)
        return float(r0 * held + rs * np.sin(q))

    q = np.linspace(0.0, 0.5 * np.pi, 2001)[1:]
    back = np.flatnonzero([force(x) > 0.0 for x in q])
    if not len(back) or back[-1] + 1 == len(q):
        return Law(0.0 if not len(back) else np.inf, potential, force)
    return Law(float(brentq(force, q[back[-1]], q[back[-1] + 1])), potential, force)


def _damper(batch: Batch, i: int) -> float:
    """c/(I_O p) of the dashpot of case i, 0 without one."""
    damping, block, at = batch.damping, batch.block, slice(i, i + 1)
    if damping.coefficient is None:
        return 0.0
    body = block.alpha[i, :1], block.R[i, :1], block.inertia[i, :1]
    return float(dashpot_rate(damping.coefficient[at], *body, batch.g[at])[0]) / float(batch.p[i, LEFT])


def verdict_afterwards(batch: Batch, i: int, answer: Answer, law: Law) -> tuple[int, float, bool]:
    """What becomes of case i after its script: FALLS, RETURNS or UNDECIDED; on which side; whether it lands before.

    Past pi/2 it has fallen, at rest it has not.  Otherwise the rigid law decides by its energy, impact by impact: the
    side, -1 or 1, is the one it is on by then, and it may have landed on the way there.  A dashpot takes energy on the
    way.
    """
    if answer.summary["ended"] == "overturned":
        return FALLS, float(np.sign(answer.summary["theta"])), False
    q_star, potential = law.q_star, law.potential
    if answer.summary["ended"] == "rest" or q_star == np.inf:
        return RETURNS, 0.0, False
    theta, rate = answer.summary["rigid_part"]
    s = np.sign(theta) or np.sign(rate) or 1.0
    q, v = abs(theta), s * rate / float(batch.p[i, LEFT])
    barrier = potential(q_star)
    if not barrier > 0.0:  # it stands upright on no such base
        return UNDECIDED, float(s), False
    margin = MARGIN[batch.model == "flexible" or batch.base is not None]
    damper, landed = _damper(batch, i), False
    for _ in range(1000):
        if v >= 0.0 and q > (1.0 + margin) * q_star:  # its weight turns it on
            return FALLS, s, landed
        energy = (0.5 * v * v + potential(q)) / barrier
        if abs(energy - 1.0) < margin:
            return UNDECIDED, s, landed
        if energy < 1.0 and q < q_star:
            return RETURNS, s, landed
        if energy < 1.0 or (v >= 0.0 and (q >= q_star or damper == 0.0)):
            return FALLS, s, landed  # beyond the barrier with less, or moving outward with more
        if damper > 0.0:
            q, v = _where_it_lands_or_turns(law.force, damper, q_star, q, v)
            if q > 0.0:
                continue
            energy = 0.5 * v * v / barrier
        elif batch.damping.scheme == "hht":  # what it takes at the impact is not known beforehand
            return UNDECIDED, s, landed
        s, landed = -s, True
        v = float(batch.damping.eta[i, RIGHT if s > 0.0 else LEFT]) * float(np.sqrt(2.0 * energy * barrier))
        q = 0.0
    return UNDECIDED, s, landed


def _where_it_lands_or_turns(
    force: Callable[[float], float], damper: float, q_star: float, q: float, v: float
) -> tuple[float, float]:
    """State of a body with a dashpot, over p t, when it lands (q = 0), turns (v = 0), or passes q_star outward."""

    def lands(_: float, y: Array) -> float:
        return float(y[0])

    def turns(_: float, y: Array) -> float:
        return float(y[1])

    def passes(_: float, y: Array) -> float:
        return float(y[0]) - q_star

    for event, direction in ((lands, -1.0), (turns, 0.0), (passes, 1.0)):
        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda _, y: (y[1], -force(y[0]) - damper * y[1]), (0.0, 1e4), (q, v), events=(lands, turns, passes),
        method="DOP853", rtol=1e-10, atol=1e-13,
    )  # fmt: skip
    end = [float(x) for x in found.y[:, -1]]
    exact = ((0.0, end[1]), (end[0], 0.0), (q_star, end[1]))
    return next((state for state, t in zip(exact, found.t_events, strict=True) if len(t)), (end[0], end[1]))
