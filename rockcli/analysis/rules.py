"""The rules a study asks for (`rules`), beside the histories, and how often each would have misled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.measures import peaks
from rockcli.analysis.suites.members import members_of
from rockcli.errors import StudyError
from rockcli.motion.spectrum import forcing, pseudo_acceleration
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Channel, Samples
from rockcli.scene.ground.spectra import FloorSpectrum
from rockcli.scene.laws.damping import Fema356
from rockcli.scene.rules import RULES, Facts, Rule, Spectra
from rockcli.solvers import fema356
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.cases.buildable import by_motion
from rockcli.study.study import Study

Array = NDArray[np.float64]

MOST = 20_000
"""Cases for which a response spectrum each is reasonable."""

GIVEN = "given by the study, taken as it stands whatever the damping"
"""Attribute `spectrum` of what a rule read on it."""

_PERIODS = np.geomspace(0.05, 16.0, 160)
"""Periods [s] between which a record's spectrum is interpolated (a pulse scales them by its own period)."""

_SPACING = float(np.log(_PERIODS[1] / _PERIODS[0]))
"""Of their logarithms."""


@dataclass(frozen=True)
class Misled:
    """A rule against the histories of a study.

    Attributes:
        name: of the rule; edition: of its standard, or the year of its paper; cases: where both have an answer.
        unconservative: the rule lets stand what the history overturns; false_alarms: the opposite.  A case of which a
            part of the runs overturns counts by that part.
        of_slide: it tells a distance instead: unconservative where a body that stands slides farther, false alarm
            where it does not slide at all.
    """

    name: str
    cases: int
    unconservative: float
    false_alarms: float
    edition: str = ""
    of_slide: bool = False


def check_rules(study: Study) -> None:
    """`StudyError` if there are too many cases for the rules asked for."""
    if study.size > MOST and any(RULES[name].spectral for name in study.rules):
        *many, last = (name for name, rule in RULES.items() if rule.spectral)
        who = f"{', '.join(many)} and {last} take a response spectrum per case"
        raise StudyError(f"rules: {who}; at most {MOST} cases, not {study.size}", file=study.file)


def with_rules(contents: Contents, study: Study) -> Contents:
    """Add what the rules say to a dataset, or take away those the study does not ask for."""
    every = {rule.variable for rule in RULES.values()}
    fields = {name: item for name, item in contents.fields.items() if name not in every}
    if study.rules:
        values = {name: np.full(study.size, np.nan) for name in study.rules}
        known: dict[tuple[object, ...], Array] = {}
        with np.errstate(all="ignore"):
            for indices, batch in by_motion(study.suites, np.arange(study.size)):
                for name in study.rules:
                    values[name][indices] = _evaluate(name, batch, study.rules_spectrum, known)
        for name, flat in values.items():
            rule = RULES[name]
            said = {"references": rule.source, "comment": rule.caveat, "edition": rule.edition}
            if rule.takes_given and study.rules_spectrum is not None:
                said["spectrum"] = GIVEN
            if study.search is not None:
                said["comment"] = f"at the lowest point of the range searched; {rule.caveat}"
            field = variable_field(rule.variable, contents.axes, flat.reshape(study.shape), **said)
            fields[rule.variable] = field
    return Contents(contents.axes, fields, contents.attrs)


def misled(contents: Contents) -> tuple[Misled, ...]:
    """Every rule in a dataset against the outcomes in it, of cases with a motion: a given spectrum needs none."""
    asked = [rule for rule in RULES.values() if rule.variable in contents.fields]
    if "outcome" not in contents.fields or not asked:
        return ()
    share = members_of(contents).share
    peak = next((name for name in ("pga", "a_p") if name in contents.fields), None)
    share = np.where(np.isnan(np.nan if peak is None else contents.over_axes(peak)), np.nan, share)
    found = []
    for rule in asked:
        values = contents.values(rule.variable)
        both = ~np.isnan(share) & ~np.isnan(values)
        if not rule.of_overturning:
            if "slide_peak" in contents.fields:
                slide = contents.values("slide_peak")
                found.append(_by_distance(rule, values, slide, both & (share == 0.0) & ~np.isnan(slide)))
            continue
        predicted = np.isinf(values) | (values > rule.limit)
        unconservative, false_alarms = share[both & ~predicted].sum(), (1.0 - share)[both & predicted].sum()
        counted = float(unconservative), float(false_alarms)
        found.append(Misled(rule.name, int(both.sum()), *counted, rule.edition))
    return tuple(found)


def _by_distance(rule: Rule, values: Array, slide: Array, stands: NDArray[np.bool_]) -> Misled:
    """A rule that tells a distance [m] against how far the bodies slide that do not overturn."""
    farther, still = stands & (slide > values), stands & (slide == 0.0) & (values > 0.0)
    return Misled(rule.name, int(stands.sum()), int(farther.sum()), int(still.sum()), rule.edition, of_slide=True)


def _evaluate(name: str, batch: Batch, given: FloorSpectrum | None, known: dict[tuple[object, ...], Array]) -> Array:
    """One rule for every case of a batch, (n,), about the edge that gives way first.

    NaN without a motion, or the spectrum that is given for it.  `known` are spectra that were worked out before.
    """
    block, motion, n = batch.block, batch.excitation.horizontal, batch.size
    given = given if RULES[name].takes_given else None
    if motion is None and given is None:
        return np.full(n, np.nan)
    pga, pgv = peaks(motion, n, batch.excitation.duration)
    spectra: Spectra
    if given is not None:
        spectra = _Given(given, batch.g)
        pga = np.array([spectra.interpolated(i, 0.0)[1][0] for i in range(n)])  # at the shortest period
    else:
        assert motion is not None
        spectra = _Spectra(motion, batch.excitation.duration, known)
    up = batch.excitation.vertical
    a_v = np.zeros(n) if up is None else peaks(up, n, batch.excitation.duration)[0]
    return RULES[name].of(
        Facts(
            R=block.of_weak_edge(block.R),
            alpha=block.of_weak_edge(block.alpha),
            inertia=block.of_weak_edge(block.inertia),
            p=block.of_weak_edge(batch.p),
            g=batch.g,
            pga=pga,
            pgv=pgv,
            mu=block.mu,
            a_v=a_v,
            spectra=spectra,
            fema356=lambda: _fema356(batch),
        )
    )


def _fema356(batch: Batch) -> Array:
    """The procedure's rotation over alpha, as the damping scheme of that name gives it."""
    scheme = Fema356(np.ones(batch.size), np.full(batch.size, np.nan))
    wanted = replace(batch.save, histories=False, scalars=frozenset({"outcome", "theta_peak_over_alpha"}))
    damping = replace(batch.damping, scheme="fema356", fema356=scheme)
    found = fema356.solve(replace(batch, model="rigid", geometry=None, damping=damping, save=wanted)).scalars
    return np.asarray(found["theta_peak_over_alpha"], dtype=np.float64)


class _Given:
    """A floor response spectrum that the study gives, taken as it stands whatever the damping; g (n,) of the cases."""

    def __init__(self, given: FloorSpectrum, g: Array) -> None:
        self._given, self._unit = given, g if given.in_g else np.ones(len(g))

    def S_a(self, case: int, zeta: float, periods: Array) -> Array:
        """At periods (m,) [s]: (m,) [m/s²]."""
        return np.interp(periods, *self.interpolated(case, zeta))

    def interpolated(self, case: int, zeta: float, longest: float = 0.0) -> tuple[Array, Array]:
        """Periods [s], ascending, and values to interpolate between, as far as they are given."""
        return self._given.periods, self._unit[case] * self._given.S_a


class _Spectra:
    """Pseudo-acceleration of the motions of a batch, worked out once for each that is alike but for its scale."""

    def __init__(self, motion: Channel, duration: Array, known: dict[tuple[object, ...], Array]) -> None:
        self._motion = motion
        self._record = (motion.dt, sha256(motion.values.tobytes()).digest()) if isinstance(motion, Samples) else None
        self._until = np.where(np.isfinite(duration), duration, np.inf)
        self._known = known if isinstance(motion, Samples) else {}  # pulses may be as many as cases

    def S_a(self, case: int, zeta: float, periods: Array) -> Array:
        """At periods (m,) [s]: (m,) [m/s²]."""
        scale, alike = self._scale(case)
        key = (alike, float(self._until[case]), zeta, periods.tobytes())
        if key not in self._known:
            force = forcing(self._motion, case, float(self._until[case]))
            self._known[key] = pseudo_acceleration(force, periods, zeta) / scale
        return self._known[key] * scale

    def interpolated(self, case: int, zeta: float, longest: float = 0.0) -> tuple[Array, Array]:
        """Periods [s], ascending, and values to interpolate between; up to `longest` [s] at least."""
        motion = self._motion
        T = _PERIODS if isinstance(motion, Samples) else _PERIODS * 2.0 * np.pi / motion.omega_p[case]
        if longest > T[-1]:  # a body is slow against a short pulse: as closely, as far as it takes
            more = int(np.ceil(np.log(longest / T[-1]) / _SPACING)) + 1
            T = np.concatenate([T, T[-1] * np.exp(_SPACING * np.arange(1, more + 1))])
        return T, self.S_a(case, zeta, T)

    def _scale(self, case: int) -> tuple[float, object]:
        """A factor of the motion, and what the motion is beside it."""
        if isinstance(self._motion, Samples):
            return float(abs(self._motion.factor[case])) or 1.0, self._record
        return 1.0, self._motion.table[case].tobytes()
