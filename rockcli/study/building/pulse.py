"""The pulse of a study: from its keys to pieces of ground acceleration."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.ground.amplitudes import PULSE_AMPLITUDES, PULSE_FREQUENCIES
from rockcli.scene.ground.excitation import Pulses
from rockcli.scene.ground.pulses import SHAPES, make_pulses, mavroeidis_papageorgiou_peak
from rockcli.study.building.numbers import Numbers, in_range
from rockcli.study.document.expressions import Value, parse
from rockcli.study.document.tree import Keys, nearest
from rockcli.study.schema import PulsePart

Array = NDArray[np.float64]

OPTIONS = tuple(dict.fromkeys(option for shape in SHAPES.values() for option in shape.options))

WAVELET = "mavroeidis_papageorgiou"

MAX_GAMMA = 1000.0
"""Largest gamma of a wavelet, whose peak is sought by sampling its half cycles."""


def build_pulses(numbers: Numbers, keys: Keys, warnings: list[str]) -> Pulses:
    """The pulses at `keys`; what a careful reader would remark is appended to `warnings`.

    Raises:
        StudyError: amplitude or frequency missing or said twice, an option the shape does not take.
    """
    return _pulses(numbers, keys, warnings)[0]


def unit_pulses(numbers: Numbers, keys: Keys) -> tuple[Pulses, Array]:
    """The same pulses with an amplitude of 1 m/s², and their amplitudes with sign, (n,) [m/s²]."""
    return _pulses(numbers, keys, [], unit=True)


def _pulses(numbers: Numbers, keys: Keys, warnings: list[str], *, unit: bool = False) -> tuple[Pulses, Array]:
    pulse: PulsePart = numbers.said(keys)
    law = SHAPES[pulse.shape]
    for option in OPTIONS:
        if getattr(pulse, option) is not None and option not in law.options:
            takes = nearest(option, law.options) if law.options else "it takes none"
            numbers.fail((*keys, option), f"is no option of the shape {law.name}; {takes}")
    names = tuple(name for name in PULSE_AMPLITUDES if name != "A" or "A" in law.options)
    amplitude = _one_of(numbers, keys, names, "amplitude")
    omega_p = _omega_p(numbers, keys)
    options: dict[str, Array] = {}
    if law.name == WAVELET:
        options = _wavelet(numbers, keys)
    elif pulse.cycles is not None:
        options["cycles"] = numbers.array(_present(numbers.positive((*keys, "cycles"))))
    value = _present(numbers.value((*keys, amplitude)))
    if law.name == WAVELET:
        unit_peak = omega_p * _unit_peak(options["gamma"], options["nu"])
        if amplitude == "A":
            options["A"] = numbers.array(value)
            a_p = options["A"] * unit_peak
        else:
            a_p = _a_p(numbers, amplitude, value)
            options["A"] = a_p / unit_peak
        if unit:
            options["A"] = 1.0 / unit_peak
    else:
        a_p = _a_p(numbers, amplitude, value)
    for option in (*OPTIONS, "t0"):
        if getattr(pulse, option) is not None:
            in_range(numbers, (*keys, option), numbers.value((*keys, option)))
    t0 = numbers.value((*keys, "t0"))
    if t0 is not None:
        _warn_if_cut(law.name, numbers.array(t0), omega_p, options, law.lead_in_periods, warnings)
    in_range(numbers, (*keys, amplitude), a_p)
    with np.errstate(all="ignore"):
        pulses = make_pulses(
            law.name,
            a_p=np.ones_like(a_p) if unit else a_p,
            omega_p=omega_p,
            t0=None if t0 is None else numbers.array(t0),
            **options,
        )
    numbers.require(keys, np.isfinite(pulses.table), "amplitude and frequency give no finite motion")
    return pulses, a_p


def _a_p(numbers: Numbers, key: str, value: Value) -> Array:
    if key == "a_p":
        return numbers.array(value)
    # the product that the uplift condition is compared with, to the last bit
    return numbers.array(value * (numbers.g * numbers.symbol("tan_alpha")))


def _omega_p(numbers: Numbers, keys: Keys) -> Array:
    key = _one_of(numbers, keys, PULSE_FREQUENCIES, "frequency")
    value = _present(numbers.positive((*keys, key)))
    text = numbers.said((*keys, key))
    if key == "omega_p" and isinstance(text, str) and "Hz" in parse(text).names:
        numbers.fail((*keys, key), "is a circular frequency [rad/s]; a frequency in Hz is f_p")
    with np.errstate(all="ignore"):
        if key == "T_p":
            omega_p: Any = 2.0 * np.pi / value
        elif key == "f_p":
            omega_p = 2.0 * np.pi * value
        elif key == "omega_p_over_p":
            omega_p = value * numbers.symbol("p")
        else:
            omega_p = value
        in_range(numbers, (*keys, key), omega_p)
        in_range(numbers, (*keys, key), 2.0 * np.pi / omega_p)
    return numbers.array(omega_p)


def _one_of(numbers: Numbers, keys: Keys, names: tuple[str, ...], what: str) -> str:
    pulse: PulsePart = numbers.said(keys)
    given = [name for name in names if getattr(pulse, name) is not None]
    if not given:
        numbers.fail(keys, f"the pulse has no {what}; give one of {', '.join(names)}")
    if len(given) > 1:
        numbers.fail((*keys, given[-1]), f"{' and '.join(given)} say the same thing; leave one out")
    return given[0]


def _wavelet(numbers: Numbers, keys: Keys) -> dict[str, Array]:
    gamma, nu = numbers.value((*keys, "gamma")), numbers.value((*keys, "nu"))
    if gamma is None:
        numbers.fail(keys, f"the shape {WAVELET} needs gamma")
    good = np.greater(gamma, 1.0) & np.less_equal(gamma, MAX_GAMMA)
    numbers.require((*keys, "gamma"), good, f"must be greater than 1 and at most {MAX_GAMMA:g}")
    return {"gamma": numbers.array(gamma), "nu": numbers.array(0.0 if nu is None else nu)}


def _unit_peak(gamma: Array, nu: Array) -> Array:
    """Peak acceleration of the wavelet of A = 1 m/s and omega_p = 1 rad/s, found once per distinct (gamma, nu)."""
    distinct, inverse = np.unique(np.stack([gamma, nu], axis=1), axis=0, return_inverse=True)
    peaks = mavroeidis_papageorgiou_peak(np.ones(len(distinct)), distinct[:, 0].copy(), distinct[:, 1].copy())
    return np.asarray(peaks[inverse.reshape(-1)])


def _warn_if_cut(
    shape: str, t0: Array, omega_p: Array, options: dict[str, Array], lead_in: float, warnings: list[str]
) -> None:
    T_p = 2.0 * np.pi / omega_p
    needed = 0.5 * options["gamma"] * T_p if shape == WAVELET else lead_in * T_p
    if np.any(t0 < needed * (1.0 - 1e-12)):
        said = "gamma T_p/2" if shape == WAVELET else f"{lead_in:g} T_p" if lead_in else "0"
        what = "are zero for t < 0: their beginning is cut off, and the ground starts with a jump"
        warnings.append(f"{shape} pulses with t0 < {said} {what}")


def _present(value: Value | None) -> Value:
    assert value is not None
    return value
