"""Trajectory of a case as it is solved: peaks, times, impacts and the history at the output times."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from rockcli.kernels.constants import DUE, FAST, RETURNS
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.response import MAX_IMPACTS_STORED
from rockcli.solvers.general import roots
from rockcli.solvers.general.body import Body
from rockcli.solvers.general.methods import Step

Array = NDArray[np.float64]


@dataclass
class Trajectory:
    """The notes of one case.

    Attributes:
        dt_out: output spacing [s]; theta, rate: histories (k,), NaN where nothing was noted, k = 0 without.
        same: fraction by which peaks differ that are equal but for errors, as those of an undamped body.
        peak: largest |theta| so far [rad], on the side of sign `side`, at t_peak; peaks: to the left, to the right.
        rate_peak: largest |rate| [rad/s].
        impacts: (t, rate before, rate after) of the first MAX_IMPACTS_STORED; n_impacts: how many there were;
            struck_later: whether one came beyond the report.
        verdict: what becomes of the body, see `body`.
        failure: why there is no answer, "" if there is one.
    """

    body: Body
    dt_out: float
    theta: Array
    rate: Array
    same: float
    written: int = 0
    peak: float = 0.0
    side: float = 1.0
    peaks: list[float] = field(default_factory=lambda: [0.0, 0.0])
    t_peak: float = math.nan
    rate_peak: float = 0.0
    t_uplift: float = math.nan
    t_overturn: float = math.nan
    t_end: float = math.nan
    n_impacts: int = 0
    struck_later: bool = False
    impacts: list[tuple[float, float, float]] = field(default_factory=list)
    verdict: int = RETURNS
    failure: str = ""

    def begin(self, theta: float, rate: float) -> None:
        """Note an initial state that is not rest."""
        self.t_uplift = 0.0
        self.side = math.copysign(1.0, theta if theta != 0.0 else rate)
        if theta * rate <= 0.0:
            self._higher(theta, 0.0)
        self.rate_peak = abs(rate)

    def rest(self, t: float) -> None:
        """Note that the body rests up to t."""
        until = self._due(t)
        self.theta[self.written : until] = 0.0
        self.rate[self.written : until] = 0.0
        self.written = max(self.written, until)

    def swing(self, step: Step, sign: float, x: float, t: float) -> None:
        """Note a step up to its fraction x, which is t; theta is `sign` times its rotation."""
        until = self._due(t)
        if until > self.written:
            due = np.arange(self.written, until) * self.dt_out
            rotation, rate = step.dense(np.clip(due, step.t_old, step.t))
            self.theta[self.written : until] = sign * rotation
            self.rate[self.written : until] = sign * rate
            self.written = until
        self._peaks(step, sign, x)

    def _due(self, t: float) -> int:
        """Number of output times up to t."""
        n = math.floor(t / self.dt_out) if len(self.theta) else -1
        while n + 1 < len(self.theta) and (n + 1) * self.dt_out <= t * (1.0 + DUE):
            n += 1
        while n >= 0 and n * self.dt_out > t * (1.0 + DUE):
            n -= 1
        return min(n + 1, len(self.theta))

    def _peaks(self, step: Step, sign: float, x: float) -> None:
        c_v = roots.coefficients(step.nodes[1])
        least = min(self.peaks) if self.body.left.alpha != self.body.right.alpha else self.peak
        if np.abs(step.nodes[0]).max() * 1.1 + 1e-300 > least:
            for r in roots.roots(c_v):
                if r <= x and abs(float(step.dense(step.t_old + r * (step.t - step.t_old))[0])) > 0.999 * least:
                    t, rotation, _ = step.at(r)
                    self._higher(sign * rotation, t)
        self.rate_peak = max(self.rate_peak, abs(float(step.y_old[1])))
        if abs(c_v[0]) + roots.reach(c_v) > self.rate_peak:
            inside = [r for r in roots.roots(np.asarray(chebyshev.chebder(c_v), dtype=float)) if r < x]
            self.rate_peak = max([self.rate_peak, *(abs(roots.value(c_v, r)) for r in inside)])

    def _higher(self, theta: float, t: float) -> None:
        side = RIGHT if theta > 0.0 else LEFT
        self.peaks[side] = max(self.peaks[side], abs(theta))
        if abs(theta) > self.peak * (1.0 + self.same):
            self.side, self.t_peak = math.copysign(1.0, theta), t
        self.peak = max(self.peak, abs(theta))

    def cut_off(self, theta: float, rate: float, t: float) -> None:
        """Note the state at which the report ends, which may be the highest or the fastest so far."""
        self._higher(theta, t)
        self.rate_peak = max(self.rate_peak, abs(rate))

    def impact(self, t: float, before: float, after: float) -> None:
        """Note an impact, if it is fast enough to count: theta_dot just before and after [rad/s]."""
        self.rate_peak = max(self.rate_peak, abs(before))
        edge = self.body.edge(-before)  # the one it turned about until now
        if abs(before) > FAST * edge.p * edge.alpha:
            self.n_impacts += 1
            if len(self.impacts) < MAX_IMPACTS_STORED:
                self.impacts.append((t, before, after))

    def equilibrium(self, step: Step, edge_sign: float, sign: float, x: float) -> None:
        """Note the outward passage of the unstable equilibrium of an edge, if the step up to x has one."""
        star = self.body.edge(edge_sign).q_star
        start, end = sign * edge_sign * step.y_old[0], sign * edge_sign * roots.value(_rotation(step), x)
        if start < star <= end:
            below = _shifted(-sign * edge_sign * _rotation(step), star)
            found = roots.first_below(below)
            self.t_overturn = step.t_old + (x if found is None else found) * (step.t - step.t_old)


def _rotation(step: Step) -> Array:
    return roots.coefficients(step.nodes[0])


def _shifted(c: Array, level: float) -> Array:
    c = c.copy()
    c[0] += level
    return c
