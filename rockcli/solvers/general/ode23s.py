"""ode23s: the modified Rosenbrock pair of orders 2 and 3 of Shampine & Reichelt (1997).

L. F. Shampine, M. W. Reichelt, "The MATLAB ODE Suite", SIAM J. Sci. Comput. 18(1), 1-22, section 3.1:

    d = 1/(2 + sqrt 2),  e32 = 6 + sqrt 2,  W = I - h d J,  T = df/dt
    F0 = f(t, y)                           W k1 = F0 + h d T
    F1 = f(t + h/2, y + h k1/2)            k2 = W^-1 (F1 - k1) + k1
    y_new = y + h k2
    F2 = f(t + h, y_new)                   W k3 = F2 - e32 (k2 - F1) - 2 (k1 - F0) + h d T
    error = h (k1 - 2 k2 + k3)/6

One step, no iteration, L-stable, first same as last.  J and T are forward differences, anew at every step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DenseOutput, OdeSolver

Array = NDArray[np.float64]

D = 1.0 / (2.0 + math.sqrt(2.0))
E32 = 6.0 + math.sqrt(2.0)

ROOT_EPS = math.sqrt(np.finfo(float).eps)


class Ode23s(OdeSolver):  # type: ignore[misc]
    """The pair as a method for `scipy.integrate.solve_ivp`.

    Args:
        fun: f(t, y); t0, y0: initial state; t_bound: where to stop.
        first_step: None = chosen from f, its derivative and rtol.
        max_step: largest step.
        rtol, atol: the error of a step is held below rtol max(|y|, atol/rtol) in the maximum norm.
    """

    t: float
    y: Array

    def __init__(
        self,
        fun: Callable[[float, Array], Any],
        t0: float,
        y0: Any,
        t_bound: float,
        first_step: float | None = None,
        max_step: float = np.inf,
        rtol: float = 1e-3,
        atol: float = 1e-6,
        vectorized: bool = False,
    ) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)
        if not (rtol > 0.0 and atol > 0.0 and max_step > 0.0):
            raise ValueError("rtol, atol and max_step must be greater than 0")
        self.rtol, self.atol, self.max_step = rtol, atol, max_step
        self.f: Array = self.fun(self.t, self.y)
        self.h_abs = min(first_step or self._first_step(), max_step)

    def _first_step(self) -> float:
        """About the step whose second-order term is half the tolerance."""
        span = float(min(abs(self.t_bound - self.t), self.max_step))
        if span == 0.0:
            return 0.0
        weight = np.maximum(np.abs(self.y), self.atol / self.rtol)
        slow = float(np.max(np.abs(self.f) / weight)) / (0.7 * math.sqrt(self.rtol))
        h = min(span, 1.0 / slow) if slow > 0.0 else span
        J, T = self._derivatives(h)
        bend = float(np.max(np.abs(T + J @ self.f) / weight))
        rate = math.sqrt(0.5 * bend / self.rtol) / 0.7
        return min(h, 1.0 / rate) if rate > 0.0 else h

    def _derivatives(self, h: float) -> tuple[Array, Array]:
        """J = df/dy (n, n) and T = df/dt (n,) by differences in the direction of the motion, else away from zero."""
        t, y, f = self.t, self.y, self.f
        J = np.empty((self.n, self.n))
        floor = self.atol / self.rtol
        for j in range(self.n):
            shifted = y.copy()
            shifted[j] += ROOT_EPS * math.copysign(max(abs(y[j]), floor), f[j] if f[j] != 0.0 else y[j])
            J[:, j] = (self.fun(t, shifted) - f) / (shifted[j] - y[j])
        self.njev += 1
        later = t + self.direction * min(ROOT_EPS * max(abs(t), abs(t + h)), h)
        T = (self.fun(later, y) - f) / (later - t) if later != t else np.zeros(self.n)
        return J, T

    def _step_impl(self) -> tuple[bool, str | None]:
        t, y, F0 = self.t, self.y, self.f
        h_min = 16.0 * abs(np.nextafter(t, self.direction * np.inf) - t)
        h_abs = min(max(self.h_abs, h_min), self.max_step)
        J, T = self._derivatives(h_abs)
        failed = False
        while True:
            t_new = t + self.direction * h_abs
            if self.direction * (t_new - self.t_bound) > 0.0 or abs(self.t_bound - t_new) < 0.1 * h_abs:
                t_new = self.t_bound  # land on the end, stretching the step a little rather than leaving a crumb
            h = t_new - t
            W = np.eye(self.n) - h * D * J
            self.nlu += 1
            try:
                k1 = np.linalg.solve(W, F0 + h * D * T)
                F1 = self.fun(t + 0.5 * h, y + 0.5 * h * k1)
                k2 = np.linalg.solve(W, F1 - k1) + k1
                y_new = y + h * k2
                F2 = self.fun(t_new, y_new)
                k3 = np.linalg.solve(W, F2 - E32 * (k2 - F1) - 2.0 * (k1 - F0) + h * D * T)
            except np.linalg.LinAlgError:
                return False, "the matrix I - h d J is singular"
            weight = np.maximum(np.maximum(np.abs(y), np.abs(y_new)), self.atol / self.rtol)
            error = abs(h) / 6.0 * float(np.max(np.abs(k1 - 2.0 * k2 + k3) / weight))
            if error <= self.rtol:
                break
            if not h_abs > h_min:
                return False, self.TOO_SMALL_STEP
            shrink = 0.5 if failed or not math.isfinite(error) else max(0.5, 0.8 * (self.rtol / error) ** (1 / 3))
            h_abs = max(h_min, min(h_abs, abs(h)) * shrink)
            failed = True
        self.t_before, self.y_before, self.f_before = t, y, F0
        self.t, self.y, self.f = t_new, y_new, F2
        if not failed:
            grow = 1.25 * (error / self.rtol) ** (1 / 3)
            h_abs = h_abs / grow if grow > 0.2 else 5.0 * h_abs
        self.h_abs = min(h_abs, self.max_step)
        return True, None

    def _dense_output_impl(self) -> Hermite:
        return Hermite(self.t_before, self.t, self.y_before, self.y, self.f_before, self.f)


class Hermite(DenseOutput):  # type: ignore[misc]
    """The cubic through the values and slopes at both ends of a step."""

    def __init__(self, t_old: float, t: float, y_0: Array, y_1: Array, f_0: Array, f_1: Array) -> None:
        super().__init__(t_old, t)
        self.y_0, self.y_1, self.f_0, self.f_1 = y_0, y_1, f_0, f_1

    def _call_impl(self, t: Array) -> Array:
        h = self.t - self.t_old
        x = (t - self.t_old) / h
        rise, first, last = self.y_1 - self.y_0, h * self.f_0, h * self.f_1
        if np.ndim(t):
            rise, first, last, y_0 = rise[:, None], first[:, None], last[:, None], self.y_0[:, None]
        else:
            y_0 = self.y_0
        return np.asarray(y_0 + x * (first + x * (3.0 * rise - 2.0 * first - last + x * (first + last - 2.0 * rise))))
