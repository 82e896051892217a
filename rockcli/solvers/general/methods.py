"""The methods by name, and how a step of any of them is taken."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import BDF, DOP853, LSODA, RK23, RK45, Radau

from rockcli.solvers.general.ode23s import Ode23s
from rockcli.solvers.general.roots import NODES

Array = NDArray[np.float64]
Flow = Callable[[float, Array], tuple[float, float]]

FLOOR = 2.5e-14
"""Smallest rtol: a little above what scipy takes, 100 eps."""

MAX_STEPS = 200_000
"""Steps a case may take."""


class StuckError(Exception):
    """A method cannot go on; the message is the sentence of the failed case."""


@dataclass(frozen=True)
class Method:
    """A method: its name, scipy's class (or one that looks like it), its order, and where it comes from.

    `multistep`: it needs its past, so that a new start (every sample of a record is one) is expensive, and events are
    read off its dense output; a one-step method takes a step that ends on the event.
    """

    name: str
    make: Any
    order: int
    reference: str
    multistep: bool = False


METHODS: dict[str, Method] = {
    row.name: row
    for row in (
        Method("RK23", RK23, 3, "Bogacki & Shampine (1989)"),
        Method("RK45", RK45, 5, "Dormand & Prince (1980), the pair of MATLAB's ode45"),
        Method("DOP853", DOP853, 8, "Hairer, Norsett & Wanner (1993)"),
        Method("Radau", Radau, 5, "Radau IIA, Hairer & Wanner (1996)"),
        Method("BDF", BDF, 5, "Shampine & Reichelt (1997), variable order 1-5", multistep=True),
        Method("LSODA", LSODA, 12, "Petzold (1983), Adams or BDF", multistep=True),
        Method("ode23s", Ode23s, 2, "Shampine & Reichelt (1997), section 3.1"),
    )
}

DEFAULT_METHOD = "DOP853"

ATOL_OVER_RTOL = 1e-3
"""With it accuracy `draft` is what ODE solvers do unasked (rtol 1e-3, atol 1e-6)."""


@dataclass
class Walker:
    """Takes steps of one method at one tolerance, and counts them.

    Attributes:
        rtol: relative tolerance; atol [rad, rad/s] is a thousandth of it.
        max_step: largest step [s].
        first: length of the very first step, None = the method's own choice [s].
        taken: steps so far; last: length of the last one that was not cut by the end [s].
        evaluated: calls of the flow so far.
    """

    method: Method
    rtol: float
    max_step: float
    first: float | None = None
    taken: int = 0
    evaluated: int = 0
    last: float | None = None

    def walk(
        self, flow: Flow, t: float, y: tuple[float, float], t_bound: float, *, small: bool = False
    ) -> Iterator[Step]:
        """Steps from (t, y) to t_bound; `small`: begin with a small step.

        Raises:
            StuckError: the method fails, or has used up its steps.
        """
        first = self.last or self.first
        first = None if self.method.multistep or first is None else min(first, t_bound - t)
        if small:
            first = min(t_bound - t, self.max_step, 1e-3)
        solver = self._start(flow, t, y, t_bound, first)
        while solver.status == "running":
            t_old, y_old = solver.t, solver.y
            message = self._step(solver)
            if solver.status == "failed":
                raise StuckError(f"{self.method.name} gave up at t = {solver.t:.6g} s: {message}")
            if not np.isfinite(solver.y).all():
                raise StuckError("the solution ceased to be finite: check the motion and the block for extreme numbers")
            if solver.t < t_bound:
                self.last = solver.t - t_old
            yield Step(self, flow, t_old, solver.t, y_old, solver.y, solver.dense_output())

    def to(self, flow: Flow, t: float, y: Array, t_bound: float) -> Array:
        """The state at t_bound, in one step if the tolerance allows."""
        solver = self._start(flow, t, y, t_bound, min(t_bound - t, self.max_step))
        while solver.status == "running":
            message = self._step(solver)
            if solver.status == "failed":
                raise StuckError(f"{self.method.name} gave up at t = {solver.t:.6g} s: {message}")
        return np.asarray(solver.y)

    def _start(self, flow: Flow, t: float, y: Any, t_bound: float, first: float | None) -> Any:
        first = None if first is None or not first > 0.0 else min(first, self.max_step)

        def counted(t: float, y: Array) -> tuple[float, float]:
            self.evaluated += 1  # scipy's own count leaves out differences for Jacobians
            return flow(t, y)

        return self.method.make(
            counted, t, y, t_bound, first_step=first, max_step=self.max_step, rtol=self.rtol,
            atol=self.rtol * ATOL_OVER_RTOL,
        )  # fmt: skip

    def _step(self, solver: Any) -> str | None:
        self.taken += 1
        if self.taken > MAX_STEPS:
            raise StuckError(f"gave up after {MAX_STEPS} steps at t = {solver.t:.6g} s")
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # what LSODA says before it fails
            try:
                message: str | None = solver.step()
            except (ValueError, OverflowError, ZeroDivisionError) as error:
                raise StuckError(f"the solution ceased to be finite at t = {solver.t:.6g} s ({error})") from None
        return message


@dataclass(frozen=True)
class Step:
    """A step of a method from (t_old, y_old) to (t, y), y = (rotation, rate), with its dense output."""

    walker: Walker
    flow: Flow
    t_old: float
    t: float
    y_old: Array
    y: Array
    dense: Any

    @cached_property
    def nodes(self) -> Array:
        """The state at the nodes of `roots`, (2, 13)."""
        return np.asarray(self.dense(self.t_old + NODES * (self.t - self.t_old)))

    def at(self, x: float) -> tuple[float, float, float]:
        """(t, rotation, rate) at the fraction x of the step, by a step of the method that ends there."""
        if x >= 1.0:
            return self.t, float(self.y[0]), float(self.y[1])
        t = self.t_old + x * (self.t - self.t_old)
        if t <= self.t_old:
            return self.t_old, float(self.y_old[0]), float(self.y_old[1])
        y = self.dense(t) if self.walker.method.multistep else self.walker.to(self.flow, self.t_old, self.y_old, t)
        return t, float(y[0]), float(y[1])

    def crossing(self, x: float, level: float) -> tuple[float, float, float]:
        """(t, rotation, rate) where the rotation passes `level`, near the fraction x: Newton on the method itself."""
        best = self.at(x)
        span = self.t - self.t_old
        for _ in range(3):
            t, q, v = best
            if abs(q - level) <= 1e-16 or v == 0.0 or self.walker.method.multistep:
                break
            x_new = (t - (q - level) / v - self.t_old) / span
            if not (0.0 < x_new <= 1.0 and math.isfinite(x_new)):
                break
            found = self.at(x_new)
            if abs(found[1] - level) >= abs(q - level):
                break
            best = found
        return best
