"""The rocking body as a script gives it to a solver: (2.2) with sgn(theta), jumps and all.

theta and its rate are integrated in one go from the instant the ground first exceeds the uplift threshold to the end of
the report; until then the body stands, as (2.2) does not hold.  As sgn(0) = 0 would be neither side, the body starts
with a rotation of PERTURBATION alpha to the side of the coming motion.  No impact is located, so there is no
restitution, and the method meets every jump of the right-hand side unprepared.  The largest step is a tenth of the time
to integrate, as in MATLAB, or the spacing of the samples of a record.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, NOT_YET, RETURNS, UNDECIDED
from rockcli.solvers.general import roots
from rockcli.solvers.general.body import SIDE, Body, Edge
from rockcli.solvers.general.ground import AFTERWARDS, Ground, Law
from rockcli.solvers.general.methods import Flow, Step, Walker
from rockcli.solvers.general.trajectory import Trajectory
from rockcli.solvers.general.uplift import uplift

Array = NDArray[np.float64]

LARGEST_STEP = 0.1
"""Largest step over the time to integrate."""

PERTURBATION = 1e-10
"""The rotation that gives the body its side, over alpha."""


def run(
    body: Body, ground: Ground, walker: Walker, trajectory: Trajectory, theta: float, rate: float, margin: float
) -> None:
    """Solve one case from theta [rad] and its rate [rad/s]; arguments as for `event_located.Located`.

    Raises:
        StuckError: the method fails.
    """
    t = 0.0
    if theta != 0.0 or rate != 0.0:
        trajectory.begin(theta, rate)
    else:
        t, theta = _first_uplift(body, ground, trajectory)
        if theta == 0.0:
            return
    whole = ground.whole()
    flow = _flow(body, whole.a_g, whole.a_v)
    walker.max_step = min(LARGEST_STEP * (ground.t_stop - t), ground.dt)
    state = (t, theta, rate)
    fallen = False
    for step in walker.walk(flow, t, (theta, rate), ground.t_stop):
        fallen, state = _note(body, ground, trajectory, step, reported=True)
        if fallen:
            break
    t, theta, rate = state
    trajectory.t_end = ground.t_stop if ground.has_duration else t
    trajectory.verdict = FALLS if fallen else _final(_verdict(body, state, margin))
    if not fallen:
        if ground.has_duration:
            trajectory.cut_off(theta, rate, t)
        state = _afterwards(body, ground, walker, trajectory, flow, state, margin)
    if trajectory.verdict == FALLS:
        trajectory.side = _edge(body, *state[1:]).sign


def _first_uplift(body: Body, ground: Ground, trajectory: Trajectory) -> tuple[float, float]:
    """When the body begins to rock, and the rotation it starts with; 0 if it never does."""
    for piece in ground.pieces():
        t, sign = uplift(body, ground, piece, piece.t_a)
        if sign != 0.0:
            trajectory.rest(t)
            trajectory.t_uplift = t
            return t, sign * PERTURBATION * body.edge(sign).alpha
        trajectory.rest(min(piece.t_b, ground.t_stop if ground.has_duration else ground.t_motion))
    trajectory.t_end = ground.t_stop if ground.has_duration else ground.t_motion
    return trajectory.t_end, 0.0


def _flow(body: Body, a_g: Law, a_v: Law) -> Flow:
    def flow(t: float, y: Array) -> tuple[float, float]:
        theta, rate = y.tolist()
        edge = _edge(body, theta, rate)
        return rate, edge.sign * body.acceleration(edge, abs(theta), edge.sign * rate, a_g(t), a_v(t))

    return flow


def _edge(body: Body, theta: float, rate: float) -> Edge:
    return body.edge(theta if theta != 0.0 else rate)


def _note(
    body: Body, ground: Ground, trajectory: Trajectory, step: Step, *, reported: bool
) -> tuple[bool, tuple[float, float, float]]:
    """Write a step into the trajectory; whether the body has fallen, and (t, theta, rate) at the end."""
    c = roots.coefficients(step.nodes[0])
    theta, rate = float(step.y[0]), float(step.y[1])
    x, fallen = 1.0, False
    if abs(theta) >= SIDE:
        side = math.copysign(1.0, theta)
        if body.linear:
            fallen = side * rate >= 0.0 and _beyond_help(body, ground, step.t, abs(theta))
        else:
            level = -side * c
            level[0] += SIDE
            found = roots.first_below(level)
            fallen, x = True, 1.0 if found is None else found
    t = step.t_old + x * (step.t - step.t_old)
    trajectory.swing(step, 1.0, x, t)
    trajectory.equilibrium(step, math.copysign(1.0, theta), 1.0, x)
    if reported:
        c_rate = roots.coefficients(step.nodes[1])
        for r in roots.roots(c):
            if r <= x and step.y_old[0] != 0.0 and roots.value(c, max(r - 1e-6, 0.0)) * roots.value(c, r + 1e-6) < 0.0:
                w = roots.value(c_rate, r)
                trajectory.impact(step.t_old + r * (step.t - step.t_old), w, w)
    elif step.y_old[0] * theta < 0.0:
        trajectory.struck_later = True
    if fallen and x < 1.0:
        return True, (t, math.copysign(SIDE, theta), rate)
    return fallen, (step.t, theta, rate)


def _beyond_help(body: Body, ground: Ground, t: float, q: float) -> bool:
    a_g, a_v = ground.bounds(t)
    return (body.g - a_v) * (q - max(body.left.alpha, body.right.alpha)) > a_g


def _verdict(body: Body, state: tuple[float, float, float], margin: float) -> int:
    """What becomes of the body left alone in this state, or NOT_YET if that cannot be told."""
    _, theta, rate = state
    edge = _edge(body, theta, rate)
    return body.left_alone(edge, abs(theta), edge.sign * rate, margin * edge.alpha)


def _final(verdict: int) -> int:
    """At the end what cannot be told stays undecided."""
    return UNDECIDED if verdict == NOT_YET else verdict


def _afterwards(
    body: Body,
    ground: Ground,
    walker: Walker,
    trajectory: Trajectory,
    flow: Flow,
    state: tuple[float, float, float],
    margin: float,
) -> tuple[float, float, float]:
    """Beyond the report: until the outcome is known, and the peak or the passage under way has come."""
    bound = state[0] + AFTERWARDS / min(body.left.p, body.right.p)
    verdict = _verdict(body, state, margin)

    side = state[1]

    def done() -> bool:
        _, theta, rate = state
        if verdict == RETURNS:
            return theta * rate <= 0.0 or theta * side <= 0.0 or ground.has_duration
        if verdict == FALLS:
            return theta * rate >= 0.0 and abs(theta) >= _edge(body, theta, rate).q_star
        return verdict == UNDECIDED

    if not done():
        for step in walker.walk(flow, state[0], state[1:], bound):
            fallen, state = _note(body, ground, trajectory, step, reported=False)
            verdict = FALLS if fallen else _verdict(body, state, margin) if verdict == NOT_YET else verdict
            if fallen or done():
                break
    trajectory.verdict = _final(verdict)
    return state
