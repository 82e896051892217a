"""Fragility curves of a dataset as a fragility model of OpenQuake: NRML 0.5, one function per body.

A curve from zero is told by its parameters (`continuous`, logncdf: mean and standard deviation of the capacity), one
that begins at uplift by points (`discrete`), between which OpenQuake interpolates linearly, with noDamageLimit there.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.fragility.curves import FITTED, NONE_EXCEEDS
from rockcli.analysis.places import coordinate, units_of
from rockcli.analysis.suites.words import of_what_arrives
from rockcli.errors import StudyError
from rockcli.scene.axis_path import axis_path
from rockcli.scene.variables import LIMIT
from rockcli.storage.contents import Contents
from rockcli.study.intensity import bare, period_of

Array = NDArray[np.float64]

NAMESPACE = "http://openquake.org/xmlns/nrml/0.5"

_TYPES: dict[str, tuple[str, float]] = {"pga": ("PGA", 0.0), "pgv": ("PGV", 0.01), "arias": ("IA", 1.0)}
"""By name of the intensity: OpenQuake's name of it, and its unit there in SI units (0: g)."""

_Z = 3.7
"""Standard deviations of the capacity that points reach from their medians: beyond them is 1e-4."""

_POINTS = 100


@dataclass(frozen=True)
class Model:
    """The XML text, the bodies in it, those left out with the reason, and what must be known to use it."""

    text: str
    bodies: tuple[str, ...]
    left_out: tuple[str, ...]
    warnings: tuple[str, ...]


def fragility_model(contents: Contents) -> Model:
    """The fragility curves of a dataset for OpenQuake.

    Raises:
        StudyError: there are none, their intensity is none of OpenQuake's, they cross, no body has all of them, or two
            bodies have one name.
    """
    about = json.loads(contents.attrs.get("ensemble", "null"))
    if about is None or "fragility_median" not in contents.fields:
        raise StudyError("has no fragility curves (over: an axis, with an intensity that is varied)")
    if "fragility_second" in contents.fields:
        raise StudyError(
            "has curves of two intensities, which OpenQuake knows none of; fit one: over: {intensity: pga}"
        )
    told = str(about["told_against"])
    kind, unit = _intensity_type(contents, told)
    states, names = _states(contents)
    functions, bodies, left_out = [], [], []
    never = [name for j, name in zip(states, names, strict=True) if _never_exceeded(contents, j)]
    if len(never) < len(names):
        left_out = [f"the limit state {name}, which no case exceeds" for name in never]
        kept = [(j, name) for j, name in zip(states, names, strict=True) if name not in never]
        states, names = [j for j, _ in kept], [name for _, name in kept]
    for at, body in _bodies(contents):
        missing = [name for j, name in zip(states, names, strict=True) if not _has_curve(contents, at, j)]
        if missing:
            left_out.append(f"{body} has no curve for {', '.join(missing)}")
            continue
        functions.append(_function(contents, at, states, names, body, kind, unit))
        bodies.append(body)
    if not functions:
        raise StudyError(f"no body has a curve for every limit state: {'; '.join(left_out)}")
    title = contents.attrs.get("title") or contents.attrs.get("study_name", "")
    text = "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f"<nrml xmlns={quoteattr(NAMESPACE)}>",
            f"<fragilityModel id={quoteattr(_word(contents.attrs.get('study_name', 'rocking')))} "
            'assetCategory="buildings" lossCategory="structural">',
            f"  <description>{escape(title or 'rocking bodies')}</description>",
            f"  <limitStates>{' '.join(names)}</limitStates>",
            *functions,
            "</fragilityModel>",
            "</nrml>",
            "",
        ]
    )
    return Model(text, tuple(bodies), tuple(left_out), tuple(of_what_arrives(contents, (told,))))


def _intensity_type(contents: Contents, told: str) -> tuple[str, float]:
    """OpenQuake's name of the intensity, and its unit there [SI]."""
    item = contents.fields.get(told)
    name = bare(told) if item is None or told not in contents.axes else axis_path(item.attrs, told)
    name = name.rsplit(".", 1)[-1] if period_of(name) is None else name
    g = float(units_of(contents).g or 1.0)
    if (period := period_of(name)) is not None:
        return f"SA({period:g})", g
    if name not in _TYPES:
        known = ", ".join([*_TYPES, "sa(T)"])
        raise StudyError(f"its curves are told against {name}, which OpenQuake does not know; over: intensity: {known}")
    kind, unit = _TYPES[name]
    return kind, unit or g


def _states(contents: Contents) -> tuple[list[int], list[str]]:
    """Places and names (letters, digits and _) of limit states, which are nested: of one quantity, and overturning."""
    labels = [str(label) for label in contents.values(LIMIT)]
    families = list(dict.fromkeys(_family(label) for label in labels[:-1]))
    chosen = families[0] if families else ""
    if len(families) > 1:
        raise StudyError(
            f"has limit states of {' and '.join(families)}, which are not nested; give `limits` of one of them and run "
            "the study again, which solves no case for it"
        )
    names = [f"{chosen}_{label.rpartition(' > ')[2].removesuffix(' m')}" for label in labels[:-1]]
    return list(range(len(labels))), [_word(name.replace(".", "p")) for name in (*names, labels[-1])]


def _family(label: str) -> str:
    return label.rpartition(" > ")[0] or "theta"


def _word(text: str) -> str:
    return re.sub(r"\W", "_", text)


def _bodies(contents: Contents) -> list[tuple[tuple[int, ...], str]]:
    """Places on the axes of the bodies, and their names: the taxonomy strings of the exposure, one for each.

    Raises:
        StudyError: two bodies have one name: OpenQuake keeps one function of a name.
    """
    item = contents.fields["fragility_begins_at"]
    places = list(np.ndindex(*item.values.shape))
    words = [[contents.values(dim)[i] for dim, i in zip(item.dims, at, strict=True)] for at in places]
    names: list[str] = []
    for exactly in (False, True):  # numbers have six digits where these tell the bodies apart
        names = [_taxonomy(contents, item.dims, values, exactly) for values in words]
        if len(set(names)) == len(names):
            return list(zip(places, names, strict=True))
    name = next(name for name in names if names.count(name) > 1)
    both = " and ".join(
        repr("_".join(str(value) for value in values)) for values, own in zip(words, names, strict=True) if own == name
    )
    raise StudyError(f"has bodies that would all be called {name} in OpenQuake: {both}; give them other labels")


def _taxonomy(contents: Contents, dims: tuple[str, ...], values: list[Any], exactly: bool) -> str:
    words = [
        value if isinstance(value, str) else f"{dim}={value if exactly else coordinate(contents, dim, value)}"
        for dim, value in zip(dims, values, strict=True)
    ]
    return re.sub(r"[^\w.=+-]+", "_", "_".join(words) or contents.attrs.get("study_name", "body"))


def _has_curve(contents: Contents, at: tuple[int, ...], state: int) -> bool:
    return int(contents.values("fragility_status")[(*at, state)]) == FITTED


def _never_exceeded(contents: Contents, state: int) -> bool:
    """Whether no case of any body exceeds a limit state, as bodies that only slide never overturn."""
    return bool((contents.values("fragility_status")[..., state] == NONE_EXCEEDS).all())


def _function(
    contents: Contents, at: tuple[int, ...], states: list[int], names: list[str], body: str, kind: str, unit: float
) -> str:
    begin = float(contents.values("fragility_begins_at")[at]) / unit
    median, beta = (
        np.array([contents.values(f"fragility_{name}")[(*at, j)] for j in states]) for name in ("median", "beta_total")
    )
    above = median / unit - begin
    x = begin + np.geomspace((above * np.exp(-_Z * beta)).min(), (above * np.exp(_Z * beta)).max(), _POINTS)
    p = _curve(x - begin, above, beta)
    if (np.diff(p, axis=0) > 1e-9).any():
        raise StudyError(f"curves of {body} cross, which OpenQuake does not take; over: {{fit: ordinal}}")
    if begin > 0.0:
        levels = " ".join(f"{value:.8g}" for value in x)
        rows = [
            f"    <poes ls={quoteattr(name)}>{' '.join(f'{value:.6g}' for value in row)}</poes>"
            for name, row in zip(names, p, strict=True)
        ]
        form, imls = 'format="discrete"', f'<imls imt="{kind}" noDamageLimit="{begin:.8g}">{levels}</imls>'
    else:
        mean = above * np.exp(0.5 * beta**2)
        deviation = mean * np.sqrt(np.expm1(beta**2))
        rows = [
            f'    <params ls={quoteattr(name)} mean="{m:.8g}" stddev="{s:.8g}"/>'
            for name, m, s in zip(names, mean, deviation, strict=True)
        ]
        form = 'format="continuous" shape="logncdf"'
        imls = f'<imls imt="{kind}" noDamageLimit="{x[0]:.8g}" minIML="{x[0]:.8g}" maxIML="{x[-1]:.8g}"/>'
    head = f"  <fragilityFunction id={quoteattr(body)} {form}>"
    return "\n".join([head, f"    {imls}", *rows, "  </fragilityFunction>"])


def _curve(above: Array, median: Array, beta: Array) -> Array:
    """Probabilities at intensities above the beginning, (states, points)."""
    from scipy.special import ndtr

    return np.asarray(ndtr(np.log(above / median[:, None]) / beta[:, None]))
