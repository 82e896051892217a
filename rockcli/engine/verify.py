"""Closed forms of rocking against the solvers.

Free rocking from theta_0, linear equation: phi = alpha - theta = (alpha - theta_0) cosh(p t), so the first
impact comes at p t = acosh(1/(1 - theta_0/alpha)), with the speed p sqrt(alpha^2 - (alpha - theta_0)^2), and after
n impacts the body rises for p t = atanh(v_n/(p alpha)).  Nonlinear:
theta_dot^2 = 2 p^2 [cos(alpha - theta_0) - cos(alpha - theta)].

Overturning of the forced linear block: scene/laws/overturning.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import acosh, atan, atanh, cos, isnan, nan, pi, sin, sqrt
from typing import Any

import numpy as np

from rockcli.scene.laws.overturning import rectangular_without_impact, sine_without_impact
from rockcli.scene.response import NO_UPLIFT, OVERTURNED_WITHOUT_IMPACT, ROCKING
from rockcli.storage.contents import Contents

G, R, TAN_ALPHA = 9.81, 5.0, 0.2
ALPHA = atan(TAN_ALPHA)
P = sqrt(0.75 * G / R)
THETA_0 = 0.5
"""Initial rotation over alpha."""


@dataclass(frozen=True)
class Check:
    """One closed form: what it gives, what the solvers give, and the relative difference allowed."""

    name: str
    expected: float
    got: float
    tolerance: float

    @property
    def difference(self) -> float:
        """Relative difference; absolute where nothing is expected."""
        return abs(self.got - self.expected) / (abs(self.expected) or 1.0)

    @property
    def passed(self) -> bool:
        """Whether the difference is allowed."""
        return self.difference <= self.tolerance  # false for NaN

    def as_dict(self) -> dict[str, Any]:
        """Plain values; None where there is no number."""
        values = asdict(self) | {"difference": self.difference, "passed": self.passed}
        return {k: None if isinstance(v, float) and isnan(v) else v for k, v in values.items()}


def checks() -> Iterator[Check]:
    """Solve and compare, one after the other."""
    yield from _free_linear()
    yield from _free_nonlinear()
    yield _rest()
    yield from _uplift()
    yield from _rectangular()
    yield _one_sine()


def _free_linear() -> Iterator[Check]:
    eta = 0.9
    found = _free("linearized", eta)
    v_0 = P * ALPHA * sqrt(1.0 - (1.0 - THETA_0) ** 2)
    times, before = found.values("t_impact"), found.values("theta_dot_before")
    quarter = acosh(1.0 / (1.0 - THETA_0)) / P
    yield Check("linear free rocking: time of the first impact [s]", quarter, float(times[0]), 1e-12)
    yield Check("linear free rocking: speed at the first impact [rad/s]", v_0, float(abs(before[0])), 1e-12)
    yield Check("linear free rocking: speed at the sixth impact", eta**5 * v_0, float(abs(before[5])), 1e-11)
    sixth = quarter + sum(2.0 * atanh(eta**n * v_0 / (P * ALPHA)) / P for n in range(1, 6))
    yield Check("linear free rocking: time of the sixth impact [s]", sixth, float(times[5]), 1e-11)


def _free_nonlinear() -> Iterator[Check]:
    found = _free("rigid", "housner")
    eta = 1.0 - 1.5 * sin(ALPHA) ** 2
    speed = P * sqrt(2.0 * (cos(ALPHA * (1.0 - THETA_0)) - cos(ALPHA)))
    before = found.values("theta_dot_before")
    yield Check("restitution of a rectangle", eta, float(found.values("eta")), 1e-14)
    quarter = quarter_period(THETA_0 * ALPHA, ALPHA, P)
    yield Check("free rocking: time of the first impact [s]", quarter, float(found.values("t_impact")[0]), 1e-12)
    yield Check("free rocking: speed at the first impact [rad/s]", speed, float(abs(before[0])), 1e-12)
    yield Check("free rocking: speed at the sixth impact", eta**5 * speed, float(abs(before[5])), 1e-11)
    friction = (1.0 - eta) / (1.0 + eta) / TAN_ALPHA
    yield Check("friction an impact needs", friction, float(found.values("mu_impact")), 1e-12)


def quarter_period(theta_0: float, alpha: float, p: float) -> float:
    """Time from rest at theta_0 [rad] to the impact of a free rigid block [s].

    The integral of d theta/theta_dot with theta = theta_0 - x^2, which takes the root out of the integrand.
    """
    nodes, weights = np.polynomial.legendre.leggauss(80)
    x = 0.5 * sqrt(theta_0) * (nodes + 1.0)
    fall = 2.0 * np.sin(alpha - theta_0 + 0.5 * x * x) * np.sin(0.5 * x * x)
    return float(0.5 * sqrt(theta_0) * np.sum(weights * 2.0 * x / np.sqrt(2.0 * fall)) / p)


def _rest() -> Check:
    """Infinitely many impacts in a finite time."""
    eta = 0.6
    found = _free("linearized", eta)
    v_0 = sqrt(1.0 - (1.0 - THETA_0) ** 2)
    total = acosh(1.0 / (1.0 - THETA_0)) + sum(2.0 * atanh(eta**n * v_0) for n in range(1, 200))
    return Check("linear free rocking: time of rest [s]", total / P, float(found.values("t_end")), 1e-6)


def _uplift() -> Iterator[Check]:
    for model, threshold in (("rigid", TAN_ALPHA), ("linearized", ALPHA)):
        pulse = {"shape": "rectangular", "omega_p": 4.0 * P}
        got = _flip(model, pulse, threshold * G, 1e-12, lambda flag: flag > NO_UPLIFT)
        yield Check(f"uplift acceleration, {model} [m/s²]", threshold * G, got, 1.01e-12)


def _rectangular() -> Iterator[Check]:
    for duration in (0.5, 1.0, 2.0):  # p t_1
        expected = ALPHA * G * float(rectangular_without_impact(np.array(pi / duration)))
        pulse = {"shape": "rectangular", "T_p": 2.0 * duration / P}
        got = _flip("linearized", pulse, expected, 1e-7, lambda flag: flag == OVERTURNED_WITHOUT_IMPACT)
        yield Check(f"overturning by a rectangular pulse, p t = {duration:g} [m/s²]", expected, got, 1.01e-7)


def _one_sine() -> Check:
    ratio = 3.0  # omega_p/p
    expected = ALPHA * G * float(sine_without_impact(np.array(ratio)))
    pulse = {"shape": "sine", "omega_p": ratio * P}
    got = _flip("linearized", pulse, expected, 1e-7, lambda flag: flag == OVERTURNED_WITHOUT_IMPACT)
    return Check(f"overturning by one sine, no impact, omega/p = {ratio:g} [m/s²]", expected, got, 1.01e-7)


def _flip(model: str, pulse: dict[str, Any], expected: float, step: float, reached: Any) -> float:
    """Amplitude at which an outcome is first reached, sought at (1 -/+ step) and farther off; NaN if not there.

    Of the two amplitudes between which it changes, the one farther from what is expected.
    """
    offsets = [-1e3, -30.0, -1.0, 1.0, 30.0, 1e3]
    amplitudes = [expected * (1.0 + offset * step) for offset in offsets]
    case = _case(model, "housner") | {"motion": {"pulse": pulse | {"a_p": amplitudes[0]}}}
    named = {f"amplitude {number}": amplitude for number, amplitude in enumerate(amplitudes)}
    found = _solve({"case": case, "vary": {"motion.pulse.a_p": named}, "save": {"histories": False}})
    flags = [bool(reached(int(flag))) for flag in found.values("outcome")]
    if sorted(flags) != flags or len(set(flags)) < 2:
        return nan
    at = flags.index(True)
    return max(amplitudes[at - 1], amplitudes[at], key=lambda amplitude: abs(amplitude - expected))


def _free(model: str, eta: float | str) -> Contents:
    case = _case(model, eta) | {"initial": {"theta": f"{THETA_0}*alpha"}}
    found = _solve({"case": case, "save": {"histories": True, "dt_out": 0.01}})
    if int(found.values("outcome")) != ROCKING:
        raise AssertionError(f"free rocking from {THETA_0} alpha ended otherwise than in rocking")
    return found


def _case(model: str, eta: float | str) -> dict[str, Any]:
    return {
        "g": G,
        "block": {"R": R, "tan_alpha": TAN_ALPHA},
        "model": model,
        "damping": {"scheme": "restitution", "eta": eta},
        "solver": {"accuracy": "reference"},
    }


def _solve(study: dict[str, Any]) -> Contents:
    from rockcli.engine.run import solve
    from rockcli.study.open import open_study

    return solve(open_study({"name": "verify"} | study))
