"""Plausibility warnings about a study: wrong units, motions too weak to do anything."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Channel, Samples
from rockcli.scene.models import MODELS
from rockcli.study.building.ground_motion import MOTION
from rockcli.study.building.numbers import Numbers
from rockcli.study.document.expressions import UNITS, ExpressionError, parse
from rockcli.study.document.paths import is_path, resolve
from rockcli.study.document.tree import Keys, Map, dotted

Array = NDArray[np.float64]

STRONG = 3.0
"""PGA above which its units are doubted [g]."""

TALL, SMALL = 60.0, 0.01
"""Heights of a body above and below which its units are doubted [m]: no column that stands alone is so tall."""

STILL = "nothing moves: there is no motion and no initial state"

_ANGLES: tuple[Keys, ...] = (
    (*MOTION, "record", "angle"),
    (*MOTION, "pulse", "nu"),
    (*MOTION, "vertical", "pulse", "nu"),
)
"""Directions and phases [rad]."""

_RELATIVE = ("a_p_over_g_tan_alpha", "pga_over_g_tan_alpha", "scale", "pgv")
"""Amplitudes that no wrong unit of acceleration can make too large."""

_ABSOLUTE = ("a_p", "pga")


def surely_meant(study: Map, searched: str | None) -> frozenset[Keys]:
    """Keys of the case whose numbers say their unit (`4*g`, `3*m/s**2`), or are only the ends of a search.

    Args:
        study: {case, vary}, short forms written out.
        searched: path of the searched range, None without one.
    """
    found = {keys for keys, value in _leaves(study.get("case"), ("case",)) if _says_its_unit(value)}
    for text, entry in (study.get("vary") or {}).items():
        if not is_path(text):  # names of files
            continue
        path = resolve(text)
        points = isinstance(entry, list) or (isinstance(entry, dict) and "from" in entry)
        settings = [] if points or not isinstance(entry, dict) else [_leaves(value, path) for value in entry.values()]
        given = [(path, value) for _, value in _leaves(entry, path)] if points else list(chain(*settings))
        found -= {keys for keys, _ in given}  # what the axis puts there is what counts
        found |= {keys for keys, value in given if _says_its_unit(value)}
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


def _says_its_unit(value: Any) -> bool:
    try:
        return isinstance(value, str) and bool(parse(value).names & {"g", *UNITS})
    except ExpressionError:
        return False


def plausibility_warnings(numbers: Numbers, batch: Batch, meant: frozenset[Keys] = frozenset()) -> list[str]:
    """Sentences about the cases of a batch; `meant`: keys whose numbers are not doubted."""
    if batch.excitation.suite is not None:
        said = [sentence for one in _suspects(batch) for sentence in plausibility_warnings(numbers, one, meant)]
        rest = replace(batch, excitation=replace(batch.excitation, suite=None))
        return [*said, *plausibility_warnings(numbers, rest, meant)]
    horizontal, vertical = batch.excitation.horizontal, batch.excitation.vertical
    with np.errstate(all="ignore"):
        said = [_too_weak(batch), _implausible_size(batch), _too_strong(numbers, batch, MOTION, horizontal, meant)]
        said.append(_too_strong(numbers, batch, (*MOTION, "vertical"), vertical, meant))
        said += [_in_degrees(numbers, keys) for keys in _ANGLES]
    return [sentence for sentence in said if sentence]


def _in_degrees(numbers: Numbers, keys: Keys) -> str:
    """Where a direction or a phase goes round more than once."""
    value = numbers.value(keys)
    largest = 0.0 if value is None else float(np.abs(value).max())
    if largest <= 2.0 * np.pi * (1.0 + 1e-9):
        return ""
    return f"{dotted(keys[1:])} is {largest:.4g} rad: if degrees are meant, write {largest:.4g}*deg"


def _implausible_size(batch: Batch) -> str:
    height = float(2.0 * batch.block.h.max())
    if height > TALL:
        return f"a body is {height:.4g} m high: are its sizes in metres?"
    low = float(2.0 * batch.block.h.min())
    return f"a body is {1e3 * low:.3g} mm high: are its sizes in metres?" if low < SMALL else ""


def _suspects(batch: Batch) -> Iterator[Batch]:
    """The cases of those motions of a suite that are too strong, or so weak that they may lift no body."""
    suite = batch.excitation.suite
    assert suite is not None
    pga = np.abs(suite.factor) * suite.measure("pga") / batch.g
    uplifts = pga >= (1.0 + 1e-9) * batch.block.of_weak_edge(batch.block.tan_alpha)
    for record, rows in suite.cases():
        if not uplifts[rows].any() or (pga[rows] > STRONG).any():
            yield batch.rows(rows).under(record)


def _too_strong(numbers: Numbers, batch: Batch, keys: Keys, channel: Channel | None, meant: frozenset[Keys]) -> str:
    if channel is None:
        return ""
    kind = "record" if isinstance(channel, Samples) else "pulse"
    given = numbers.said((*keys, kind))
    largest = float((_pga(channel) / batch.g).max())
    if largest <= STRONG or any(getattr(given, key, None) is not None for key in _RELATIVE):
        return ""
    if any(getattr(given, key, None) is not None and (*keys, kind, key) in meant for key in _ABSOLUTE):
        return ""
    which = "" if keys == MOTION else "vertical "
    return f"the {which}PGA of {_name(channel)} is {largest:.4g} g: are its units right (a_p and pga are in m/s²)?"


def _too_weak(batch: Batch) -> str:
    """Where no case can uplift: the body stands and the motion nowhere reaches g tan(alpha) (or its linear form)."""
    motion, vertical = batch.excitation.horizontal, batch.excitation.vertical
    pair = (batch.model, batch.geometry)
    if motion is None or pair not in MODELS or batch.damping.scheme == "fema356":
        return ""
    if isinstance(motion, Samples) and len(motion.files) > 1:  # in some directions a motion is weak
        return ""
    block = batch.block
    alpha, tan_alpha = block.of_weak_edge(block.alpha), block.of_weak_edge(block.tan_alpha)
    weight = 1.0 if vertical is None else 1.0 - _pga(vertical) / batch.g
    pga = _pga(motion) / batch.g
    over = pga / MODELS[pair].law(alpha, tan_alpha).threshold
    moving = (batch.theta_0 != 0.0) | (batch.theta_dot_0 != 0.0)
    if moving.any() or not (over < weight).all():
        return ""
    angle = "alpha" if batch.model == "linearized" else "tan alpha"
    return f"{_name(motion)}: PGA {_words(pga)} g = {_words(over)} g {angle}: too weak to uplift"


def _pga(channel: Channel) -> Array:
    """Peak acceleration of every case, whole motion, (n,) [m/s²]."""
    if isinstance(channel, Samples):
        return np.abs(channel.factor) * channel.measures["pga"]
    return np.abs(channel.a_p)


def _name(channel: Channel) -> str:
    return channel.name if isinstance(channel, Samples) else f"the {channel.shape} pulse"


def _words(values: Array) -> str:
    low, high = (f"{end:.3g}" for end in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"
