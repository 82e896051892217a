"""The rules a study asks for (`rules`), beside the histories, and how often each would have misled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.measures import peaks
from rockcli.analysis.suites import members
from rockcli.errors import StudyError
from rockcli.motion.spectrum import displacement_spectrum, forcing
from rockcli.scene import rules
from rockcli.scene.batch import Batch
from rockcli.scene.damping import Fema356
from rockcli.scene.excitation import Channel, Samples
from rockcli.scene.rules import RULES
from rockcli.solvers import fema356
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.cases.buildable import buildable
from rockcli.study.study import Study

Array = NDArray[np.float64]

MOST = 20_000
"""Cases for which a response spectrum each is reasonable."""

_HOUSNER_PERIODS, _HOUSNER_ZETA = np.linspace(0.1, 2.5, 49), 0.05
_PERIODS = np.geomspace(0.05, 16.0, 160)
"""Periods [s] between which a record's spectrum is interpolated (a pulse scales them by its own period)."""

_SCAN = np.geomspace(1e-3, 1.0, 400)
"""theta/alpha at which capacity and demand are compared; the root is found between two of them."""


@dataclass(frozen=True)
class Misled:
    """A rule against the histories of a study.

    Attributes:
        name: of the rule; cases: where both have an answer.
        unsafe: the rule lets stand what the history overturns; wary: the opposite.  A case of which a part of the runs
            overturns counts by that part.
    """

    name: str
    cases: int
    unsafe: float
    wary: float


def check_rules(study: Study) -> None:
    """`StudyError` if there are too many cases for the rules asked for."""
    if study.size > MOST and {"housner", "asce43", "fema356"} & set(study.rules):
        who = "housner, asce43 and fema356 take a response spectrum per case"
        raise StudyError(f"rules: {who}; at most {MOST} cases, not {study.size}", file=study.file)


def with_rules(contents: Contents, study: Study) -> Contents:
    """Add what the rules say to a dataset, or take away those the study does not ask for."""
    every = {rule.variable for rule in RULES.values()}
    fields = {name: item for name, item in contents.fields.items() if name not in every}
    if study.rules:
        values = {name: np.full(study.size, np.nan) for name in study.rules}
        with np.errstate(all="ignore"):
            for indices, batch in buildable(study.batches, np.arange(study.size)):
                for name in study.rules:
                    values[name][indices] = _evaluate(name, batch)
        for name, flat in values.items():
            rule = RULES[name]
            said = {"references": rule.source, "comment": rule.caveat}
            field = variable_field(rule.variable, contents.axes, flat.reshape(study.shape), **said)
            fields[rule.variable] = field
    return Contents(contents.axes, fields, contents.attrs)


def misled(contents: Contents) -> tuple[Misled, ...]:
    """Every rule in a dataset against the outcomes in it."""
    if "outcome" not in contents.fields:
        return ()
    share = members(contents).share
    found = []
    for rule in RULES.values():
        if rule.variable not in contents.fields:
            continue
        values = contents.values(rule.variable)
        both = ~np.isnan(share) & ~np.isnan(values)
        predicted = np.isinf(values) | (values > rule.limit)
        unsafe, wary = share[both & ~predicted].sum(), (1.0 - share)[both & predicted].sum()
        found.append(Misled(rule.name, int(both.sum()), float(unsafe), float(wary)))
    return tuple(found)


def _evaluate(name: str, batch: Batch) -> Array:
    """One rule for every case of a batch, (n,), about the edge that gives way first; NaN without a motion."""
    block, motion, n = batch.block, batch.excitation.horizontal, batch.size
    if motion is None:
        return np.full(n, np.nan)
    R, alpha = block.of_weak_edge(block.R), block.of_weak_edge(block.alpha)
    inertia, p = block.of_weak_edge(block.inertia), block.of_weak_edge(batch.p)
    pga, pgv = peaks(motion, n, batch.excitation.duration)
    if name == "west":
        return rules.west(pga, np.tan(alpha), batch.g)
    if name == "ishiyama":
        return rules.ishiyama(pga, pgv, R, alpha, inertia, batch.g)
    if name == "fema356":
        return _fema356(batch)
    spectra = _Spectra(motion, batch.excitation.duration)
    out = np.empty(n)
    for i in range(n):
        if name == "housner":
            S_v = spectra.S_a(i, _HOUSNER_ZETA, _HOUSNER_PERIODS) * _HOUSNER_PERIODS / (2.0 * np.pi)
            out[i] = np.mean(0.5 * (S_v[1:] + S_v[:-1]))
            continue
        tan_alpha, h = float(np.tan(alpha[i])), float(R[i] * np.cos(alpha[i]))
        zeta = min(rules.asce43_damping(tan_alpha, float(inertia[i])), 0.99)
        T, S_a = spectra.interpolated(i, zeta)
        capacity, f = rules.asce43_capacity(alpha[i] * _SCAN, h, tan_alpha, float(inertia[i]), float(batch.g[i]))
        demand = np.interp(1.0 / f, T, S_a, left=pga[i])
        out[i] = _largest_root(demand / capacity - 1.0) if pga[i] > batch.g[i] * tan_alpha else 0.0
    return rules.housner(out, p, alpha, batch.g) if name == "housner" else out


def _fema356(batch: Batch) -> Array:
    """The procedure's rotation over alpha, as the damping scheme of that name gives it."""
    scheme = Fema356(np.ones(batch.size), np.full(batch.size, np.nan))
    wanted = replace(batch.save, histories=False, scalars=frozenset({"outcome", "theta_peak_over_alpha"}))
    damping = replace(batch.damping, scheme="fema356", fema356=scheme)
    found = fema356.solve(replace(batch, model="rigid", geometry=None, damping=damping, save=wanted)).scalars
    return np.asarray(found["theta_peak_over_alpha"], dtype=np.float64)


def _largest_root(excess: Array) -> float:
    """theta/alpha from which on the capacity is enough; inf if it is not at alpha."""
    over = np.flatnonzero(excess > 0.0)
    if not len(over):
        return float(_SCAN[0])
    last = int(over[-1])
    if last == len(_SCAN) - 1:
        return float("inf")
    share = excess[last] / (excess[last] - excess[last + 1])
    return float(_SCAN[last] + share * (_SCAN[last + 1] - _SCAN[last]))


class _Spectra:
    """Pseudo-acceleration of the motions of a batch, worked out once for each that is alike but for its scale."""

    def __init__(self, motion: Channel, duration: Array) -> None:
        self._motion = motion
        self._until = np.where(np.isfinite(duration), duration, np.inf)
        self._known: dict[tuple[object, ...], Array] = {}

    def S_a(self, case: int, zeta: float, periods: Array) -> Array:
        """At periods (m,) [s]: (m,) [m/s^2]."""
        scale, alike = self._scale(case)
        key = (alike, float(self._until[case]), zeta, periods.tobytes())
        if key not in self._known:
            force = forcing(self._motion, case, float(self._until[case]))
            S_d = displacement_spectrum(force, periods, zeta)
            self._known[key] = (2.0 * np.pi / periods) ** 2 * S_d / scale
        return self._known[key] * scale

    def interpolated(self, case: int, zeta: float) -> tuple[Array, Array]:
        """Periods [s], ascending, and values to interpolate between."""
        motion = self._motion
        T = _PERIODS if isinstance(motion, Samples) else _PERIODS * 2.0 * np.pi / motion.omega_p[case]
        return T, self.S_a(case, zeta, T)

    def _scale(self, case: int) -> tuple[float, object]:
        """A factor of the motion, and what the motion is beside it."""
        if isinstance(self._motion, Samples):
            return float(abs(self._motion.factor[case])) or 1.0, "record"
        return 1.0, self._motion.table[case].tobytes()
