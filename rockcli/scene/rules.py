"""Rules of thumb and code checks for rocking, beside the history: what each says of a body under a motion.

Each reduces a body and a motion to one number; the table names what it means, where it is from and what it leaves
out (docs/rules.md).  None of them is a history; they are here to be measured against one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ISHIYAMA_FACTOR = 0.4
"""Of the impulsive velocity that overturns a standing block: Ishiyama's lower limit for earthquakes."""


HOUSNER_PERIODS, HOUSNER_ZETA = np.linspace(0.1, 2.5, 49), 0.05
"""Periods [s] over which the pseudo-velocity of Housner's rule is averaged, and its damping ratio."""

_SCAN = np.geomspace(1e-3, 1.0, 400)
"""theta/alpha at which capacity and demand are compared; the root is found between two of them."""


class Spectra(Protocol):
    """Pseudo-acceleration of the motion of every case."""

    def S_a(self, case: int, zeta: float, periods: Array) -> Array:
        """At periods (m,) [s]: (m,) [m/s²]."""
        ...

    def interpolated(self, case: int, zeta: float, longest: float = 0.0) -> tuple[Array, Array]:
        """Periods [s], ascending, and values to interpolate between; to `longest` [s] at least, where known."""
        ...


@dataclass(frozen=True, eq=False)
class Facts:
    """What a rule may ask about n cases: body about the edge that gives way first, and motion, (n,) each, SI.

    `mu`: friction of the base; `a_v`: peak vertical acceleration.  `spectra`: of the motions.  `fema356()`: rotation
    over alpha by the damping scheme of that name.
    """

    R: Array
    alpha: Array
    inertia: Array
    p: Array
    g: Array
    pga: Array
    pgv: Array
    mu: Array
    a_v: Array
    spectra: Spectra
    fema356: Callable[[], Array]


@dataclass(frozen=True)
class Rule:
    """A row.

    Attributes:
        name: in the study; variable, symbol, unit, meaning: of what it fills in the dataset.
        limit: values above it predict overturning (inf: only an infinite value does).
        of: the value of every case, (n,).
        sentence, source, caveat: what it is, where it is from, what it leaves out.
        edition: of the standard, or the year of the paper.
        spectral: whether it takes a response spectrum per case; takes_given: one that the study gives, in its place.
        of_overturning: whether it tells if the body overturns.
    """

    name: str
    variable: str
    symbol: str
    meaning: str
    limit: float
    of: Callable[[Facts], Array]
    sentence: str
    source: str
    caveat: str
    edition: str
    spectral: bool = False
    takes_given: bool = False
    of_overturning: bool = True
    unit: str = "1"


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
    """Spectral acceleration capacity [m/s²] and effective frequency [Hz] at rotations theta (k,) > 0.

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


def _housner(facts: Facts) -> Array:
    S_v = np.empty(len(facts.g))
    for i in range(len(S_v)):
        of_period = facts.spectra.S_a(i, HOUSNER_ZETA, HOUSNER_PERIODS) * HOUSNER_PERIODS / (2.0 * np.pi)
        S_v[i] = np.mean(0.5 * (of_period[1:] + of_period[:-1]))
    return housner(S_v, facts.p, facts.alpha, facts.g)


def _asce43(facts: Facts) -> Array:
    out = np.empty(len(facts.g))
    for i, (R, alpha, inertia, g, pga) in enumerate(
        zip(facts.R, facts.alpha, facts.inertia, facts.g, facts.pga, strict=True)
    ):
        tan_alpha, h = float(np.tan(alpha)), float(R * np.cos(alpha))
        zeta = min(asce43_damping(tan_alpha, float(inertia)), 0.99)
        capacity, f = asce43_capacity(alpha * _SCAN, h, tan_alpha, float(inertia), float(g))
        T, S_a = facts.spectra.interpolated(i, zeta, 1.0 / f[-1])
        demand = np.interp(1.0 / f, T, S_a, left=pga, right=np.nan)
        out[i] = _largest_root(demand / capacity - 1.0) if pga > g * tan_alpha else 0.0
    return out


def asce43_friction(mu: Array, a_v: Array, g: Array) -> Array:
    """Effective coefficient of friction under a peak vertical acceleration a_v [m/s²]: mu (1 - 0.4 a_v/g)."""
    return np.maximum(mu * (1.0 - 0.4 * a_v / g), 0.0)


SLIDING_ZETA = 0.1
"""Damping ratio of the spectrum that sliding is read on."""


def _asce43_sliding(facts: Facts) -> Array:
    out = np.empty(len(facts.g))
    effective = asce43_friction(facts.mu, facts.a_v, facts.g)
    for i, (mu, g, pga) in enumerate(zip(effective, facts.g, facts.pga, strict=True)):
        if np.isnan(mu) or pga <= mu * g:
            out[i] = np.nan if np.isnan(mu) else 0.0
            continue
        T, S_a = facts.spectra.interpolated(i, SLIDING_ZETA)
        out[i] = asce43_slide(T, S_a, 2.0 * mu * g)
    return out


def asce43_slide(T: Array, S_a: Array, c_s: float) -> float:
    """Sliding distance c_s/(2 pi f)² [m] at the lowest frequency f at which the spectrum has the value c_s [m/s²].

    0 where the spectrum is below it throughout; NaN where it is still above at the longest of the periods T (m,) [s].
    """
    above = np.flatnonzero(S_a >= c_s)
    if not len(above):
        return 0.0
    last = int(above[-1])
    if last == len(T) - 1:
        return float("nan")
    share = (S_a[last] - c_s) / (S_a[last] - S_a[last + 1])
    period = T[last] + share * (T[last + 1] - T[last])
    return float(c_s * (period / (2.0 * np.pi)) ** 2)


def _largest_root(excess: Array) -> float:
    """theta/alpha from which on the capacity is enough; inf if it is not at alpha, NaN if nobody knows there."""
    if np.isnan(excess[-1]):
        return float("nan")
    over = np.flatnonzero(excess > 0.0)
    if not len(over):
        return float(_SCAN[0])
    last = int(over[-1])
    if last == len(_SCAN) - 1:
        return float("inf")
    share = excess[last] / (excess[last] - excess[last + 1])
    return float(_SCAN[last] + share * (_SCAN[last + 1] - _SCAN[last]))


_ROWS: tuple[Rule, ...] = (
    Rule(
        "west",
        "west_ratio",
        r"$\mathrm{PGA}/(g\,\tan\alpha)$",
        "rule of West: overturning predicted above 1",
        1.0,
        lambda facts: west(facts.pga, np.tan(facts.alpha), facts.g),
        "PGA over g b/h",
        "West, in Milne (1885), Trans. Seismological Society of Japan 8",
        "the acceleration at which a body lifts, not at which it overturns: on the safe side",
        "1885",
    ),
    Rule(
        "ishiyama",
        "ishiyama_ratio",
        r"$r_{\mathrm{Ishiyama}}$",
        "rule of Ishiyama: overturning possible above 1",
        1.0,
        lambda facts: ishiyama(facts.pga, facts.pgv, facts.R, facts.alpha, facts.inertia, facts.g),
        "the smaller of PGA over g b/h and PGV over 0.4 of the impulsive velocity that overturns",
        "Ishiyama (1982), Earthq. Eng. Struct. Dyn. 10; (1984), 8th WCEE",
        "lower limits from simulations and tests: overturning needs both, and may not happen beyond them",
        "1982, 1984",
    ),
    Rule(
        "housner",
        "housner_ratio",
        r"$p S_v/(g\alpha)$",
        "rule of Housner: overturning likelier than not above 1",
        1.0,
        _housner,
        "p S_v/g over alpha: beyond 1 overturning is more likely than not",
        "Housner (1963), Bull. Seism. Soc. Am. 53(2)",
        "a probability of 50 %, for a constant velocity spectrum and slender bodies; S_v is taken as the mean "
        "pseudo-velocity of 5 % damping over periods of 0.1 to 2.5 s",
        "1963",
        spectral=True,
    ),
    Rule(
        "asce43",
        "asce43_theta_over_alpha",
        r"$\theta_{\mathrm{ASCE\ 43}}/\alpha$",
        "ASCE 43-05: best-estimate rotation over alpha; inf: overturning predicted",
        np.inf,
        _asce43,
        "best-estimate rotation over alpha; infinite where the spectrum exceeds the capacity at theta = alpha",
        "ASCE/SEI 43-05, appendix A.2",
        "an equivalent oscillator on the response spectrum; horizontal motion alone; where several rotations "
        "satisfy it, the largest",
        "ASCE/SEI 43-05",
        spectral=True,
        takes_given=True,
    ),
    Rule(
        "asce43_sliding",
        "asce43_slide",
        r"$\delta_{\mathrm{ASCE\ 43}}$",
        "ASCE 43-05: best-estimate sliding distance",
        np.inf,
        _asce43_sliding,
        "best-estimate sliding distance c_s/(2 pi f)², c_s = 2 mu (1 - 0.4 a_v/g) g, f the lowest frequency at which "
        "the 10 %-damped spectrum has the value c_s; 0 below the acceleration of sliding",
        "ASCE/SEI 43-05, appendix A.1 (recalled, not re-read)",
        "one horizontal component in the place of the vector of two; a body that does not tip",
        "ASCE/SEI 43-05",
        spectral=True,
        takes_given=True,
        of_overturning=False,
        unit="m",
    ),
    Rule(
        "fema356",
        "fema356_theta_over_alpha",
        r"$\theta_{\mathrm{FEMA}}/\alpha$",
        "FEMA-356 as a rule: rotation over alpha; inf: overturning predicted",
        np.inf,
        lambda facts: facts.fema356(),
        "rotation over alpha by the rocking procedure; infinite where it has no solution",
        "FEMA-356 (2000), section 4.4.2 and the thesis's (3.4)-(3.7)",
        "an equivalent oscillator on the response spectrum, known to be poor (docs/fema356.md); the whole weight "
        "at the base",
        "FEMA-356 (2000)",
        spectral=True,
    ),
)

RULES: dict[str, Rule] = {row.name: row for row in _ROWS}

RULE_NAMES: tuple[str, ...] = tuple(RULES)
