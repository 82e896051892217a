"""From what the scripts wrote to variables by name, and the outcome by energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rockcli.kernels import formulas
from rockcli.kernels.constants import FALLS, FAST, NO_ANSWER, RETURNS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.scene.laws.models import MODELS
from rockcli.scene.response import UNRESOLVED
from rockcli.scene.variables import SCALARS
from rockcli.solvers.common.duration import output_times
from rockcli.solvers.common.found import Found, impacts_of, note_unstored, rigid_top
from rockcli.solvers.opensees.case import CaseOfOpenSees
from rockcli.solvers.opensees.run import Answer

Array = NDArray[np.float64]

MARGIN = {False: 1e-3, True: 0.05}
"""Fraction of the barrier by which the energy must differ from it for the outcome to be told; True: elastic."""

Outcome = tuple[CaseOfOpenSees, Answer] | str
"""A case with its answer, or the sentence of why there is none."""


def scalars_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, NDArray[Any]], list[str]]:
    """Scalars by name and a sentence per case; forces at the edge and energies are not computed (NaN)."""
    n = batch.size
    counted = {name: np.full(n, -1, dtype=np.int64) for name in ("n_impacts", "n_steps", "n_rhs")}
    verdict, side, struck_later = np.full(n, NO_ANSWER), np.zeros(n), np.zeros(n, dtype=bool)
    names = ("theta_peak", "theta_dot_peak", "u_top_peak", "t_peak", "t_uplift", "t_overturn", "t_end")
    said = {name: np.full(n, np.nan) for name in names}
    for i, outcome in enumerate(outcomes):
        if isinstance(outcome, str):
            continue
        answer = outcome[1]
        law = _law(batch, i, outcome[0].number("m"))
        verdict[i], side[i], struck_later[i] = fate(batch, i, answer, law)
        for name in names:
            said[name][i] = answer.summary.get(name)  # null where there is none
        if verdict[i] == FALLS:
            said["t_overturn"][i] = np.nan if struck_later[i] else _last_outward(answer.table, law.q_star)
        fast = FAST * float(batch.p[i, LEFT]) * float(batch.block.alpha[i, LEFT])
        counted["n_impacts"][i] = np.count_nonzero(np.abs(answer.impacts[:, 1]) > fast)
        counted["n_steps"][i], counted["n_rhs"][i] = answer.summary["steps"], answer.summary["iterations"]
    moved = np.isfinite(said["t_uplift"])
    peak, rate = (np.where(moved, said[name], 0.0) for name in ("theta_peak", "theta_dot_peak"))
    found = Found(
        moved=moved,
        fell=verdict == FALLS,
        undecided=verdict == UNDECIDED,
        failed=verdict == NO_ANSWER,
        n_impacts=counted["n_impacts"],
        peak=np.abs(peak),
        side=np.where(verdict == FALLS, side, np.sign(peak)),
        rate=rate,
        top=said["u_top_peak"] if batch.model == "flexible" else rigid_top(batch, np.abs(peak)),
        t_peak=said["t_peak"],
        t_uplift=said["t_uplift"],
        t_overturn=said["t_overturn"],
        t_end=said["t_end"],
        struck_later=struck_later,
    )
    scalars: dict[str, NDArray[Any]] = {name: np.full(n, np.nan) for name in SCALARS if name != "reason"}
    reasons = [outcome if isinstance(outcome, str) else "" for outcome in outcomes]
    for which in np.flatnonzero(found.outcome == UNRESOLVED):
        reasons[which] = "in the end its energy does not decide whether it overturns: give a longer duration"
    note_unstored(batch, found.n_impacts, reasons)
    return scalars | counted | found.scalars(batch), reasons


@dataclass(frozen=True)
class Law:
    """The law that tells the outcome, of a rigid body: rotation at which the restoring moment vanishes [rad]; its
    potential U(q)/(I_O p^2), and the derivative of that."""

    q_star: float
    potential: Callable[[float], float]
    force: Callable[[float], float]


def _law(batch: Batch, i: int, mass: float) -> Law:
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


def fate(batch: Batch, i: int, answer: Answer, law: Law) -> tuple[int, float, bool]:
    """Does the body, left alone from where the script ended, ever fall?  FALLS, RETURNS or UNDECIDED; side; landings.

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


def _last_outward(table: Array, q: float) -> float:
    """Time of the last outward passage of |theta| = q, linear between rows [s].

    0 where it has been beyond from the start, NaN where the passage is yet to come as the table ends.
    """
    t, theta = table[:, 0], np.abs(table[:, 1])
    if theta[-1] < q:
        return np.nan
    at = np.flatnonzero((theta[:-1] < q) & (theta[1:] >= q))
    if not len(at):
        return 0.0
    j = int(at[-1])
    return float(t[j] + (t[j + 1] - t[j]) * (q - theta[j]) / (theta[j + 1] - theta[j]))


def histories_of(batch: Batch, outcomes: list[Outcome]) -> tuple[dict[str, Array], dict[str, Array], Array]:
    """Histories (n, k) and impacts (n, j) by name, and the output times (k,) [s]; NaN where a case has ended."""
    answered = {i: outcome for i, outcome in enumerate(outcomes) if not isinstance(outcome, str)}
    ends = [float(answer.summary["t_end"]) for _, answer in answered.values()]
    n_time = output_times(batch.save.dt_out, max(ends, default=0.0))
    t = np.arange(n_time, dtype=np.float64) * np.float64(batch.save.dt_out)
    names = ("theta", "theta_dot", "u_top", "v_top", "u_top_bending", "M_base")
    histories = {name: np.full((batch.size, n_time), np.nan) for name in names}
    for i, (case, answer) in answered.items():
        live = t <= float(answer.summary["t_end"]) * (1.0 + 1e-12)
        for name, values in zip(names, _at(answer.table, t[live]), strict=True):
            histories[name][i, live] = values
        # a column is solved by the metre of its depth, whatever its mass
        mass = float(batch.block.mass[i])
        histories["M_base"][i] *= (mass if np.isfinite(mass) else 1.0) / case.number("m")
    if batch.model != "flexible":
        del histories["u_top_bending"]
    none = np.empty((0, 3))
    landings = [answered[i][1].impacts if i in answered else none for i in range(batch.size)]
    return histories, impacts_of(landings), t


def _at(table: Array, t: Array) -> list[Array]:
    """The columns of a table at times t: rotation by cubic Hermite interpolation, the others linearly."""
    if len(table) == 1:
        return [np.full(len(t), column[0]) for column in table.T[1:]]
    own, theta, rate = table[:, 0], table[:, 1], table[:, 2]
    j = np.clip(np.searchsorted(own, t, side="right") - 1, 0, len(own) - 2)
    h = own[j + 1] - own[j]
    x = np.clip((t - own[j]) / h, 0.0, 1.0)
    y = 1.0 - x
    turned = y * y * ((1.0 + 2.0 * x) * theta[j] + x * h * rate[j])
    turned += x * x * ((1.0 + 2.0 * y) * theta[j + 1] - y * h * rate[j + 1])
    return [turned, *(np.interp(t, own, column) for column in table.T[2:])]
