"""The rocking body piece by piece: a smooth equation between events, and no event stepped over.

Modes: rest, until the ground exceeds the uplift threshold; rocking in q = |theta|, until q = 0.  A method never sees a
jump: it starts anew at every break of the motion and after every impact.  Events are the roots of the polynomial that
the dense output of a step is, all of which are found (`roots`), so two crossings in one step are not lost; the step is
then taken again to end on the event.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.constants import FALLS, NOT_YET, RETURNS, STANDSTILL, UNDECIDED
from rockcli.solvers.general import roots
from rockcli.solvers.general.body import SIDE, Body, Edge
from rockcli.solvers.general.ground import AFTERWARDS, Ground, Piece
from rockcli.solvers.general.methods import Step, Walker
from rockcli.solvers.general.roots import NODES
from rockcli.solvers.general.trajectory import Trajectory
from rockcli.solvers.general.uplift import uplift

Array = NDArray[np.float64]


class Located:
    """Solves one case; what it finds is in its trajectory.

    Args:
        body, ground: the case.
        walker: the method.
        rest_speed: impacts slower than this fraction of p sin(alpha), the lesser of the two edges, may end in rest.
        margin: distance from a separatrix below which the outcome is not decided, over alpha.
    """

    def __init__(
        self, body: Body, ground: Ground, walker: Walker, trajectory: Trajectory, rest_speed: float, margin: float
    ) -> None:
        self.body, self.ground, self.walker, self.trajectory = body, ground, walker, trajectory
        self.rest_speed, self.margin = rest_speed, margin
        self.swing = 1.0 / max(body.left.p, body.right.p)
        self.t, self.q, self.v = 0.0, 0.0, 0.0
        self.sign = 1.0
        self.resting = True
        self.fallen = False
        self.reported = True
        self.verdict = NOT_YET
        self.stalled = 0

    def run(self, theta: float, rate: float) -> None:
        """Solve from theta [rad] and its rate [rad/s] at t = 0.

        Raises:
            StuckError: the method fails.
        """
        if theta != 0.0 or rate != 0.0:
            self.sign = math.copysign(1.0, theta if theta != 0.0 else rate)
            self.q, self.v, self.resting = abs(theta), self.sign * rate, False
            self.trajectory.begin(theta, rate)
        ground = self.ground
        for piece in ground.pieces():
            after = piece.t_a >= ground.t_motion
            if after:
                self._decide()
                if self.resting and not ground.has_duration:
                    break
            self.walker.max_step = self.swing if after else min(self.swing, ground.detail)
            self.walker.first = self.walker.max_step
            self._over(piece, after)
            if self.fallen:
                break
        self._finish()

    def _finish(self) -> None:
        ground, trajectory = self.ground, self.trajectory
        self._decide()
        trajectory.t_end = ground.t_stop if ground.has_duration else self.t
        if not self.fallen and not self.resting:
            if ground.has_duration:
                trajectory.cut_off(self.sign * self.q, self.v, self.t)
            self._afterwards()
        trajectory.verdict = FALLS if self.fallen else (UNDECIDED if self.verdict == NOT_YET else self.verdict)
        if trajectory.verdict == FALLS:
            trajectory.side = self.sign

    def _decide(self) -> None:
        """What becomes of the body left alone from now on, if that can be told."""
        if self.verdict == NOT_YET:
            self.verdict = RETURNS if self.resting else self.body.left_alone(
                self._edge, self.q, self.v, self.margin * self._edge.alpha
            )  # fmt: skip

    def _afterwards(self) -> None:
        """Beyond the report: until the outcome is known, and the peak or the passage under way has come."""
        span = AFTERWARDS / min(self.body.left.p, self.body.right.p)
        piece = Piece(self.t, self.t + span, lambda t: 0.0, lambda t: 0.0)
        self.reported = False
        self.walker.max_step = self.swing
        side = self.sign
        while self.t < piece.t_b and not self.fallen and not self.resting:
            if self.verdict == RETURNS and (self.v <= 0.0 or self.sign != side or self.ground.has_duration):
                return
            if self.verdict == UNDECIDED or (self.verdict == FALLS and self.v >= 0.0 and self.q >= self._edge.q_star):
                return
            self._rock(piece, True, once=True)
            self._decide()

    @property
    def _edge(self) -> Edge:
        return self.body.edge(self.sign)

    # -- modes --------------------------------------------------------------------------------------------------

    def _over(self, piece: Piece, after: bool) -> None:
        """Follow the body to the end of a piece, or to where it has fallen or rests for good."""
        while self.t < piece.t_b and not self.fallen:
            if self.resting:
                if after and not self.ground.has_duration:
                    return
                self._rest(piece)
            else:
                self._rock(piece, after)

    def _rest(self, piece: Piece) -> None:
        if self.stalled > 100:  # lifted and dropped again and again at one instant
            self.t = min(piece.t_b, self.t + max(1e-12 * (piece.t_b - piece.t_a), 4e-16 * self.t))
            self.stalled = 0
        t, sign = uplift(self.body, self.ground, piece, self.t)
        self.trajectory.rest(t)
        if sign != 0.0:
            self.stalled = self.stalled + 1 if t == self.t else 0
            self.q = self.v = 0.0
            self.sign, self.resting = sign, False
            if math.isnan(self.trajectory.t_uplift):
                self.trajectory.t_uplift = t
        self.t = t

    def _rock(self, piece: Piece, after: bool, *, once: bool = False) -> None:
        """Follow the flow to the next event or the end of the piece; `once`: one step at most."""
        body, edge = self.body, self._edge
        a_g, a_v, acceleration = piece.a_g, piece.a_v, body.acceleration

        def flow(t: float, y: Array) -> tuple[float, float]:
            q, v = y.tolist()
            return v, acceleration(edge, q, v, a_g(t), a_v(t))

        launch = self.q == 0.0 and self.v == 0.0
        for step in self.walker.walk(flow, self.t, (self.q, self.v), piece.t_b, small=launch):
            event, x = self._event(step)
            if event == "impact" and x == 0.0:  # would enter the ground at once
                self.resting, self.q, self.v = True, 0.0, 0.0
                self.stalled += 1
                return
            level = 0.0 if event == "impact" else SIDE
            t, q, v = step.crossing(x, level) if event in ("impact", "side", "lost") and x < 1.0 else step.at(x)
            self.trajectory.swing(step, self.sign, x, t)
            self.trajectory.equilibrium(step, self.sign, self.sign, x)
            self.stalled = self.stalled + 1 if t == self.t else 0
            self.t, self.q, self.v = t, q, v
            if event == "impact":
                self._reset(piece)
            self.fallen = event in ("side", "lost")
            if after and not self.fallen:
                self._decide()
            if event or once:
                return

    # -- events -------------------------------------------------------------------------------------------------

    def _event(self, step: Step) -> tuple[str, float]:
        """The first event of a step and the fraction of the step at which it is; "" and 1 if there is none."""
        q = step.nodes[0]
        q_end, v_end = float(step.y[0]), float(step.y[1])
        event, x = "", 1.0
        start, launched = float(step.y_old[0]), float(step.y_old[1]) == 0.0
        if start > 0.0 or not launched or q_end <= 0.0 or v_end < 0.0:
            # a root at the start is the event just handled: it is divided out
            order = 0 if start > 0.0 else (2 if launched else 1)
            found = roots.first_below(roots.coefficients(q / NODES**order))
            if found is None and q_end < 0.0:
                found = 1.0
            if found is not None:
                event, x = "impact", found
        if math.isfinite(self._edge.q_star) and (q.max() > 0.9 * SIDE or q_end >= SIDE):
            if self.body.linear:
                if q_end >= SIDE and event == "" and self._lost(step.t, q_end, v_end):
                    passage = roots.first_below(roots.coefficients(SIDE - q)) if start < SIDE else 1.0
                    return "lost", 1.0 if passage is None else passage
                return event, x
            c = roots.coefficients(SIDE - q)
            side = roots.first_below(c) if start < SIDE else 0.0
            if side is not None and side < x:
                return "side", side
        return event, x

    def _lost(self, t: float, q: float, v: float) -> bool:
        """Linear body beyond its equilibrium: no return whatever the rest of the motion does."""
        if v < 0.0 or q <= self._edge.q_star:
            return False
        a_g, a_v = self.ground.bounds(t)
        return (self.body.g - a_v) * (q - self._edge.alpha) > a_g

    def _reset(self, piece: Piece) -> None:
        """The body turns over to its other edge, or comes to rest."""
        other = self.body.edge(-self.sign)
        before = max(-self.v, 0.0)
        after = other.eta * before
        if self.reported:
            self.trajectory.impact(self.t, -self.sign * before, -self.sign * after)
        else:
            self.trajectory.struck_later = True
        self.q, self.v, self.sign = 0.0, after, other.sign
        if self.stalled > 100:
            self.v = 0.0
        at = self._rest_from(piece)
        if at is not None:
            self.trajectory.rest(at)
            self.t, self.v, self.resting = at, 0.0, True
        elif self.v == 0.0:
            self.resting = True

    def _rest_from(self, piece: Piece) -> float | None:
        """When the bounces to come will have ended, if they end within the piece with the body pressed down (T6)."""
        here, other = self._edge, self.body.edge(-self.sign)
        if self.v > self.rest_speed * min(edge.p * math.sin(edge.alpha) for edge in (here, other)):
            return None
        down, down_other = self._pressed(here, piece, self.t), self._pressed(other, piece, self.t)
        if down <= 0.0 or down_other <= 0.0:
            return None
        if self.v <= STANDSTILL * here.p * here.alpha:
            return self.t
        cycle = here.eta * other.eta
        if cycle >= 1.0:
            # a damper slows the bounces for ever: too slow to be seen is at rest
            return self.t if here.damper > 0.0 else None
        end = self.t + 2.0 * self.v * (1.0 / down + other.eta / down_other) / (1.0 - cycle)
        if end > piece.t_b or min(self._pressed(edge, piece, end) for edge in (here, other)) <= 0.0:
            return None
        return end

    def _pressed(self, edge: Edge, piece: Piece, t: float) -> float:
        """Deceleration of a body that starts to turn about `edge` at t [rad/s^2]."""
        return -self.body.acceleration(edge, 0.0, 0.0, piece.a_g(t), piece.a_v(t))
