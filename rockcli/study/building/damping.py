"""The damping of a study: from the keys of its scheme to what a batch is solved with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.excitation import Excitation
from rockcli.scene.ground.spectra import SPECTRA, DesignSpectrum
from rockcli.scene.laws.damping import SCHEMES, Damping, Fema356
from rockcli.study.building.numbers import Numbers
from rockcli.study.document.expressions import says_its_unit
from rockcli.study.document.tree import Keys
from rockcli.study.schema import SpectrumPart

Array = NDArray[np.float64]

KEYS: Keys = ("case", "damping")

IN_UNITS = ("S_a", "S_XS", "S_X1")
"""Keys of a design spectrum that its `units` are of."""

FEMA356_IS_POOR = (
    "damping fema356 is an equivalent linear method known to be poor (on the thesis's pulses its peaks are off by "
    "-43 to +66 %, docs/fema356.md): it is offered for comparison"
)


def build_damping(numbers: Numbers) -> Damping:
    """The damping of every case; what a careful reader would doubt is noted in `numbers.doubts`.

    Raises:
        StudyError: a key of another scheme, two keys that say the same thing, a number that cannot be.
    """
    said = numbers.said(KEYS)
    given = {key: value for key in type(said).model_fields if (value := getattr(said, key)) is not None}
    scheme = SCHEMES[given.pop("scheme")]
    known = {key.name: key for key in scheme.keys}
    for name in given:
        if name not in known:
            numbers.fail((*KEYS, name), f"is no key of the damping scheme {scheme.name}")
        for other in known[name].instead_of:
            if other in given:
                numbers.fail((*KEYS, name), f"{other} and {name} say the same thing; leave one out")
    block, g = numbers.block, numbers.array(numbers.g)
    values: dict[str, Array | None] = dict.fromkeys(known)
    for key in scheme.keys:
        value = numbers.value((*KEYS, key.name)) if key.number and given.get(key.name) not in (None, key.word) else None
        if value is not None:
            values[key.name] = of_case = numbers.array(value)
            for good, must in key.checks:
                numbers.require((*KEYS, key.name), good(of_case, block, g), must)
    damping = scheme.make(values, block, g)
    doubted = scheme.doubted(values, block)
    if doubted.any():
        numbers.doubts[scheme.doubt] = int(np.argmax(doubted))
    if damping.fema356 is not None:
        spectrum = _design_spectrum(numbers, (*KEYS, "spectrum"))
        damping = replace(damping, fema356=replace(damping.fema356, spectrum=spectrum))
    return damping


def _design_spectrum(numbers: Numbers, keys: Keys) -> DesignSpectrum | None:
    """The design spectrum, None for the motion's own."""
    said: SpectrumPart | None = numbers.said(keys)
    if said is None:
        return None
    fields = (key for key in SpectrumPart.model_fields if key not in ("shape", "units"))
    given = {key: value for key in fields if (value := getattr(said, key)) is not None}
    shape = "table" if said.shape is None and "periods" in given else said.shape
    if shape is None:
        numbers.fail(keys, f"needs a shape ({', '.join(SPECTRA)}), or periods and S_a of a table")
    wanted = () if shape == "motion" else SPECTRA[shape].keys
    for key in given:
        if key not in wanted:
            numbers.fail((*keys, key), f"is no key of the spectrum {shape}")
    if said.units == "g" and not set(wanted) & set(IN_UNITS):
        numbers.fail((*keys, "units"), f"is of {', '.join(IN_UNITS)}, which the spectrum {shape} does not have")
    if shape == "motion":
        return None
    unit = numbers.g if said.units == "g" else 1.0
    values: dict[str, Array] = {}
    for key in wanted:
        at = (*keys, key)
        if key not in given:
            numbers.fail(keys, f"needs {key} for the spectrum {shape}")
        if isinstance(given[key], list) != SPECTRA[shape].lists:
            numbers.fail(at, f"must be a {'list' if SPECTRA[shape].lists else 'number'} for the spectrum {shape}")
        if said.units == "g" and key in IN_UNITS:
            of_key = given[key] if isinstance(given[key], list) else [given[key]]
            if twice := [value for value in of_key if says_its_unit(value)]:
                numbers.fail(at, f"{twice[0]!r} says its unit, and `units: g` too; leave one out")
        items = [numbers.positive((*at, i)) for i in range(len(given[key]))] if SPECTRA[shape].lists else []
        value = np.stack([numbers.array(item) for item in items if item is not None], axis=1) if items else None
        if value is None:
            one = numbers.positive(at)
            assert one is not None
            value = numbers.array(one)
        scale = numbers.array(unit if key in IN_UNITS else 1.0)
        values[key] = value * (scale[:, None] if items else scale)
    if shape == "table":
        numbers.require((*keys, "periods"), np.diff(values["periods"], axis=1) > 0.0, "must ascend")
        same = len(given["periods"]) == len(given["S_a"])
        numbers.require((*keys, "S_a"), same, "must have as many values as there are periods")
    return DesignSpectrum(shape, values)


def fema356_warnings(numbers: Numbers, scheme: Fema356, excitation: Excitation, *, moving: bool) -> list[str]:
    """What the scheme is worth, and what of the case it does not see."""
    if scheme.spectrum is None and excitation.horizontal is None:
        numbers.fail(("case", "damping"), "fema356 needs a ground motion, or a design spectrum under `spectrum`")
    said = [FEMA356_IS_POOR]
    if excitation.vertical is not None:
        said.append("damping fema356 ignores the vertical motion")
    if moving:
        said.append("damping fema356 ignores the initial state")
    if not numbers.block.symmetric.all():
        said.append("damping fema356 uses one edge only, the one with the smaller alpha")
    return said
