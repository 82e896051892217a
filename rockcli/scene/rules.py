"""Rules of thumb and code checks for rocking, beside the history: what each says of a body under a motion.

Each reduces a body and a motion to one number; the table names what it means, where it is from and what it leaves
out (docs/rules.md).  None of them is a history; they are here to be measured against one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ISHIYAMA_FACTOR = 0.4
"""Of the impulsive velocity that overturns a standing block: Ishiyama's lower limit for earthquakes."""


@dataclass(frozen=True)
class Rule:
    """A row: name in the study, the variable it fills, from where it speaks of overturning, source and caveat.

    `limit`: values above it predict overturning (inf: only an infinite value does).
    """

    name: str
    variable: str
    limit: float
    sentence: str
    source: str
    caveat: str


_ROWS: tuple[Rule, ...] = (
    Rule(
        "west",
        "west_ratio",
        1.0,
        "PGA over g b/h",
        "West, in Milne (1885), Trans. Seismological Society of Japan 8",
        "the acceleration at which a body lifts, not at which it overturns: on the safe side",
    ),
    Rule(
        "ishiyama",
        "ishiyama_ratio",
        1.0,
        "the smaller of PGA over g b/h and PGV over 0.4 of the impulsive velocity that overturns",
        "Ishiyama (1982), Earthq. Eng. Struct. Dyn. 10; (1984), 8th WCEE",
        "lower limits from simulations and tests: overturning needs both, and may not happen beyond them",
    ),
    Rule(
        "housner",
        "housner_ratio",
        1.0,
        "p S_v/g over alpha: beyond 1 overturning is more likely than not",
        "Housner (1963), Bull. Seism. Soc. Am. 53(2)",
        "a probability of 50 %, for a constant velocity spectrum and slender bodies; S_v is taken as the mean "
        "pseudo-velocity of 5 % damping over periods of 0.1 to 2.5 s",
    ),
    Rule(
        "asce43",
        "asce43_theta_over_alpha",
        np.inf,
        "best-estimate rotation over alpha; infinite where the spectrum exceeds the capacity at theta = alpha",
        "ASCE/SEI 43-05, appendix A.2",
        "an equivalent oscillator on the response spectrum; horizontal motion alone; where several rotations "
        "satisfy it, the largest",
    ),
    Rule(
        "fema356",
        "fema356_theta_over_alpha",
        np.inf,
        "rotation over alpha by the rocking procedure; infinite where it has no solution",
        "FEMA-356 (2000), section 4.4.2 and the source's (3.4)-(3.7)",
        "an equivalent oscillator on the response spectrum, known to be poor (docs/fema356.md); the whole weight "
        "at the base",
    ),
)

RULES: dict[str, Rule] = {row.name: row for row in _ROWS}

RULE_NAMES: tuple[str, ...] = tuple(RULES)


def impulsive_velocity(R: Array, alpha: Array, inertia: Array, g: Array) -> Array:
    """Sudden ground velocity [m/s] that just overturns a standing block; `inertia` = I_O/(m R^2).

    Angular momentum about the edge gives theta_dot = V cos(alpha)/(inertia R); its energy reaches the separatrix at
    V^2 = 2 inertia g R (1 - cos alpha)/cos^2 alpha.
    """
    rise = 2.0 * np.sin(0.5 * alpha) ** 2
    return np.asarray(np.sqrt(2.0 * inertia * g * R * rise) / np.cos(alpha))


def west(pga: Array, tan_alpha: Array, g: Array) -> Array:
    """PGA/(g tan alpha)."""
    return np.asarray(pga / (g * tan_alpha))


def ishiyama(pga: Array, pgv: Array, R: Array, alpha: Array, inertia: Array, g: Array) -> Array:
    """Both of Ishiyama's limits have to be passed: the smaller of the two ratios."""
    velocity = ISHIYAMA_FACTOR * impulsive_velocity(R, alpha, inertia, g)
    return np.minimum(west(pga, np.tan(alpha), g), pgv / velocity)


def housner(S_v: Array, p: Array, alpha: Array, g: Array) -> Array:
    """p S_v/(g alpha), from alpha = S_v p/g of a constant velocity spectrum."""
    return np.asarray(p * S_v / (g * alpha))


def asce43_capacity(theta: Array, h: float, tan_alpha: float, inertia: float, g: float) -> tuple[Array, Array]:
    """Spectral acceleration capacity [m/s^2] and effective frequency [Hz] at rotations theta (k,) > 0.

    With a = b/h, B = cos theta + a sin theta - 1 and C_I = I_O/(m h^2): S_a = 2 B g/theta,
    f = sqrt(2 B g/(C_I theta^2 h))/(2 pi).
    """
    B = tan_alpha * np.sin(theta) - 2.0 * np.sin(0.5 * theta) ** 2
    C_I = inertia * (1.0 + tan_alpha**2)
    S_a = 2.0 * B * g / theta
    f = np.sqrt(np.maximum(S_a / (C_I * theta * h), 0.0)) / (2.0 * np.pi)
    return S_a, f


def asce43_damping(tan_alpha: float, inertia: float) -> float:
    """Effective damping ratio gamma/sqrt(4 pi^2 + gamma^2), gamma = -2 ln C_R, C_R = 1 - 2 a^2/C_I.

    C_R is the restitution of Housner's impact; 1 - a body that loses everything - gives ratios up to 1.
    """
    C_R = 1.0 - 2.0 * tan_alpha**2 / (inertia * (1.0 + tan_alpha**2))
    gamma = -2.0 * np.log(max(C_R, 1e-12))
    return float(gamma / np.hypot(2.0 * np.pi, gamma))
