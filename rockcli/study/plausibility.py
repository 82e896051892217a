"""Plausibility warnings about a study: wrong units, motions too weak to do anything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Channel, Samples
from rockcli.scene.laws.models import MODELS
from rockcli.study.building.body_mesh import DENSITIES
from rockcli.study.building.body_outline import BLOCK
from rockcli.study.building.floors import THROUGH
from rockcli.study.building.ground_motion import MOTION
from rockcli.study.building.numbers import Numbers
from rockcli.study.building.scaling import INHERITED, scaling_key
from rockcli.study.document.expressions import says_its_unit
from rockcli.study.document.paths import is_path, resolve
from rockcli.study.document.tree import Keys, Map, dotted
from rockcli.study.document.values import WEAKEST

Array = NDArray[np.float64]

STRONG = 3.0
"""PGA above which its units are doubted [g]."""

TALL, SMALL = 60.0, 0.01
"""Heights of a body above and below which its units are doubted [m]: no column that stands alone is so tall."""

LARGE_INERTIA = 10.0
"""I_O/(m R^2) above which it is doubted: with all mass at the corners of a rectangle it is 2."""

ROUGH = 10.0
"""Friction above which it is doubted; 10 is written for a body that is not to slip."""

NAMED = 3
"""Motions too weak to uplift, or too strong to be meant, that are named one by one."""

STILL = "nothing moves: there is no motion and no initial state"

_ANGLES: dict[Keys, float] = {
    ("case", "block", "direction"): 2.0,
    (*MOTION, "record", "angle"): 1.0,
    (*MOTION, "pulse", "nu"): 1.0,
    (*MOTION, "vertical", "pulse", "nu"): 1.0,
}
"""Directions and phases [rad], and turns they may go round: a direction about 334 degrees may be uncertain."""

_RELATIVE = ("a_p_over_g_tan_alpha", "pga_over_g_tan_alpha", "scale")
"""Amplitudes that no wrong unit can make too large."""

_ABSOLUTE = ("a_p", "pga", "pgv", "sa")


def surely_meant(study: Map, searched: str | None) -> frozenset[Keys]:
    """Keys of the case whose numbers say their unit (`4*g`, `3*m/s**2`), or are only the ends of a search.

    Args:
        study: {case, vary}, short forms written out.
        searched: path of the searched range, None without one.
    """
    found = {keys for keys, value in _leaves(study.get("case"), ("case",)) if says_its_unit(value)}
    for text, entry in (study.get("vary") or {}).items():
        if not is_path(text):  # names of files
            continue
        path = resolve(text)
        points = isinstance(entry, list) or (isinstance(entry, dict) and "from" in entry)
        settings = [] if points or not isinstance(entry, dict) else [_leaves(value, path) for value in entry.values()]
        given = [(path, value) for _, value in _leaves(entry, path)] if points else list(chain(*settings))
        found -= {keys for keys, _ in given}  # what the axis puts there is what counts
        found |= {keys for keys, value in given if says_its_unit(value)}
    if searched is not None:
        found.add(resolve(searched))
    return frozenset(found)


def _leaves(value: Any, keys: Keys) -> Iterator[tuple[Keys, Any]]:
    """Every single value below some keys of a study, with its keys; those of a setting may be dotted."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, (*keys, *str(key).split(".")))
    elif isinstance(value, list):
        for item in value:
            yield from _leaves(item, keys)
    else:
        yield keys, value


def plausibility_warnings(
    numbers: Numbers, batch: Batch, strong: Strong, meant: frozenset[Keys] = frozenset()
) -> list[str]:
    """Sentences about the cases of a batch; `meant`: keys whose numbers are not doubted.

    What is too strong goes to `strong`, which tells of all batches.
    """
    if batch.excitation.suite is not None:
        said = [sentence for one in _suspects(batch) for sentence in plausibility_warnings(numbers, one, strong, meant)]
        rest = replace(batch, excitation=replace(batch.excitation, suite=None))
        return [*said, *plausibility_warnings(numbers, rest, strong, meant)]
    horizontal, vertical = batch.excitation.horizontal, batch.excitation.vertical
    with np.errstate(all="ignore"):
        said = [_too_strong(numbers, batch, MOTION, horizontal, strong, meant)]
        said.append(_too_strong(numbers, batch, (*MOTION, "vertical"), vertical, strong, meant))
        said += [_in_degrees(numbers, keys, turns) for keys, turns in _ANGLES.items()]
        said.append(_in_percent(numbers, ("case", "column", "zeta")))
        said += [_in_percent(numbers, (*THROUGH, j, "zeta")) for j in range(len(numbers.said(THROUGH) or ()))]
    return [sentence for sentence in said if sentence]


def _in_degrees(numbers: Numbers, keys: Keys, turns: float) -> str:
    """Where a direction or a phase goes round more often than it may."""
    value = None if numbers.said(keys) == WEAKEST else numbers.value(keys)
    largest = 0.0 if value is None else float(np.abs(value).max())
    if largest <= turns * 2.0 * np.pi * (1.0 + 1e-9):
        return ""
    return f"{dotted(keys[1:])} is {largest:.4g} rad: if degrees are meant, write {largest:.4g}*deg"


def _in_percent(numbers: Numbers, keys: Keys) -> str:
    """Where a damping ratio is beyond that of a structure that swings at all."""
    value = numbers.value(keys)
    largest = 0.0 if value is None else float(np.max(value))
    if largest <= 1.0:
        return ""
    return f"{dotted(keys[1:])} is {largest:.4g}, more than critical: if per cent are meant, write {largest:.4g}/100"


def doubt_size(numbers: Numbers, batch: Batch) -> None:
    """Note in `numbers.doubts` a body of a size, or with a moment of inertia, that few have."""
    given = any(getattr(numbers.case.block, key) is not None for key in ("r_g", "inertia"))
    ratios = batch.block.inertia.max(axis=-1)
    if given and (ratio := float(ratios.max())) > LARGE_INERTIA:
        said = f"I_O/(m R²) of a body is {ratio:.4g} (4/3 of a solid rectangle): is r_g in metres, inertia over m R²?"
        numbers.doubts[said] = int(ratios.argmax())
    heights = 2.0 * batch.block.h
    if (high := float(heights.max())) > TALL:
        numbers.doubts[f"a body is {high:.4g} m high: are its sizes in metres?"] = int(heights.argmax())
    elif (low := float(heights.min())) < SMALL:
        numbers.doubts[f"a body is {1e3 * low:.3g} mm high: are its sizes in metres?"] = int(heights.argmin())


def doubt_friction(numbers: Numbers, batch: Batch) -> None:
    """Note in `numbers.doubts` a friction that no pair of surfaces has."""
    mu = batch.block.mu
    if (mu > ROUGH).any():
        most = int(np.nanargmax(mu))
        numbers.doubts[f"a mu is {mu[most]:.4g}: if per cent are meant, write {mu[most]:.4g}/100"] = most


def doubt_density(numbers: Numbers) -> None:
    """Note in `numbers.doubts` a density that nothing a body is made of has."""
    parts = len(numbers.said((*BLOCK, "parts")) or ())
    at = [(*BLOCK, "density"), *((*BLOCK, "parts", j, "density") for j in range(parts)), ("case", "column", "rho")]
    for values in (numbers.array(density) for density in map(numbers.value, at) if density is not None):
        least, most = int(values.argmin()), int(values.argmax())
        if values[least] < DENSITIES[0]:
            said = f"a density is {values[least]:.4g} kg/m³: if t/m³ or g/cm³ are meant, write {values[least]:.4g}*1000"
            numbers.doubts[said] = least
        elif values[most] > DENSITIES[1]:
            numbers.doubts[f"a density is {values[most]:.4g} kg/m³: is it in kg/m³?"] = most


def _suspects(batch: Batch) -> Iterator[Batch]:
    """The cases of those motions of a suite that are too strong."""
    suite = batch.excitation.suite
    assert suite is not None
    pga = np.abs(suite.factor) * suite.measure("pga") / batch.g
    for record, rows in suite.cases():
        if (pga[rows] > STRONG).any():
            yield batch.rows(rows).under(record)


def _too_strong(
    numbers: Numbers, batch: Batch, keys: Keys, channel: Channel | None, strong: Strong, meant: frozenset[Keys]
) -> str:
    if channel is None:
        return ""
    kind = "record" if isinstance(channel, Samples) else "pulse"
    given = numbers.said((*keys, kind))
    largest = float((_pga(channel) / batch.g).max())
    if largest <= STRONG or any(getattr(given, key, None) is not None for key in _RELATIVE):
        return ""
    if any(getattr(given, key, None) is not None and (*keys, kind, key) in meant for key in _ABSOLUTE):
        return ""
    if kind == "record" and scaling_key(numbers, keys) == INHERITED:
        return (
            f"the vertical {_name(channel)} takes the factor of the horizontal record, which makes its PGA more than "
            f"{STRONG:g} g: say its own scale or pga if that is not meant"
        )
    strong.note("PGA" if keys == MOTION else "vertical PGA", _name(channel), largest)
    return ""


def _pga(channel: Channel) -> Array:
    """Peak acceleration of every case, whole motion, (n,) [m/s²]."""
    if isinstance(channel, Samples):
        return np.abs(channel.factor) * channel.measures["pga"]
    return np.abs(channel.a_p)


def _name(channel: Channel) -> str:
    return channel.name if isinstance(channel, Samples) else f"the {channel.shape} pulse"


def _words(low: float, high: float) -> str:
    first, last = f"{low:.3g}", f"{high:.3g}"
    return first if first == last else f"{first} to {last}"


@dataclass(frozen=True)
class _Weak:
    """Ends of the PGA of motions [g], and of what it is over g tan(alpha) (or its linear form)."""

    name: str
    pga: tuple[float, float]
    over: tuple[float, float]
    angle: str

    def with_(self, other: _Weak) -> _Weak:
        return replace(self, pga=_ends(*self.pga, *other.pga), over=_ends(*self.over, *other.over))

    @property
    def words(self) -> str:
        return f"PGA {_words(*self.pga)} g = {_words(*self.over)} g {self.angle}"


def _range(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _ends(*values: float) -> tuple[float, float]:
    return min(values), max(values)


@dataclass(eq=False)
class Strong:
    """The motions of a study so strong that their units are doubted."""

    _pga: dict[str, dict[str, float]] = field(default_factory=dict)

    def note(self, what: str, name: str, largest: float) -> None:
        """Take note of the largest PGA of a motion [g]; `what`: `PGA` or `vertical PGA`."""
        known = self._pga.setdefault(what, {})
        known[name] = max(largest, known.get(name, 0.0))

    def sentences(self) -> list[str]:
        """One about each motion; of many one sentence."""
        said = []
        for what, found in self._pga.items():
            of = [f"{name} is {pga:.4g} g" for name, pga in found.items()]
            if len(found) > NAMED:
                most = max(found, key=lambda name: found[name])
                low, high = _range(np.array(list(found.values())))
                of = [f"{len(found)} motions is {_words(low, high)} g (such as {most})"]
            said += [f"the {what} of {one}: are its units right ({_UNITS})?" for one in of]
        return said


_UNITS = "a_p and pga are in m/s², pgv in m/s"


@dataclass(eq=False)
class Uplift:
    """Which motions of a study can uplift no body of it: bodies that stand, and a PGA nowhere at g tan(alpha)."""

    _moving: set[_Motion] = field(default_factory=set)
    _weak: dict[_Motion, _Weak] = field(default_factory=dict)

    def look(self, batch: Batch) -> None:
        """Take note of a batch."""
        suite = batch.excitation.suite
        if suite is None:
            self._look(batch)
            return
        pga = np.abs(suite.factor) * suite.measure("pga") / batch.g
        uplifts = pga >= (1.0 + 1e-9) * batch.block.of_weak_edge(batch.block.tan_alpha)
        for record, rows in suite.cases():
            motion = _motion(record)
            if motion in self._moving:
                continue
            if uplifts[rows].any():
                self._moving.add(motion)
            else:
                self._look(batch.rows(rows).under(record))

    def _look(self, batch: Batch) -> None:
        channel, vertical = batch.excitation.horizontal, batch.excitation.vertical
        pair = (batch.model, batch.geometry)
        if channel is None or pair not in MODELS or batch.damping.scheme == "fema356":
            return
        if isinstance(channel, Samples) and len(channel.files) > 1:  # in some directions a motion is weak
            return
        block = batch.block
        alpha, tan_alpha = block.of_weak_edge(block.alpha), block.of_weak_edge(block.tan_alpha)
        with np.errstate(all="ignore"):
            weight = 1.0 if vertical is None else 1.0 - _pga(vertical) / batch.g
            pga = _pga(channel) / batch.g
            over = pga / MODELS[pair].law(alpha, tan_alpha).threshold
        motion = _motion(channel)
        if (batch.theta_0 != 0.0).any() or (batch.theta_dot_0 != 0.0).any() or not (over < weight).all():
            self._moving.add(motion)
            return
        angle = "alpha" if batch.model == "linearized" else "tan alpha"
        weak = _Weak(_name(channel), _range(pga), _range(over), angle)
        self._weak[motion] = self._weak[motion].with_(weak) if motion in self._weak else weak

    def sentences(self) -> list[str]:
        """About those that are too weak; of many one sentence."""
        weak = [words for motion, words in self._weak.items() if motion not in self._moving]
        if len(weak) <= NAMED:
            return [f"{one.name}: {one.words}: too weak to uplift" for one in weak]
        every = reduce(_Weak.with_, weak)
        return [f"{len(weak)} motions are too weak to uplift a body: {every.words} (such as {every.name})"]


_Motion = tuple[str, tuple[str, ...]]
"""What tells motions apart: name and files."""


def _motion(channel: Channel) -> _Motion:
    return _name(channel), channel.files if isinstance(channel, Samples) else ()
