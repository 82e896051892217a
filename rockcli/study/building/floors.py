"""`motion.through`: what floors and isolators make of the ground motion of a study, as samples the body stands on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.motion.floors import BETWEEN, RINGS_TO, Arrival, Chain
from rockcli.motion.options import MAX_SAMPLES
from rockcli.motion.spectrum import forcing
from rockcli.scene.ground.amplitudes import FLOOR_SCALINGS, RECORD_SCALINGS
from rockcli.scene.ground.excitation import AMPLITUDE_COLUMNS, PIECE_WIDTH, Pulses, Samples, scaled
from rockcli.study.building.numbers import Numbers, in_range
from rockcli.study.building.pulse import build_pulses, unit_pulses
from rockcli.study.building.records import Records
from rockcli.study.document.expressions import Value
from rockcli.study.document.tree import Keys

Array = NDArray[np.float64]

ARRIVES = "the peak acceleration that arrives is"
"""What the processing of every motion through floors says."""

THROUGH: Keys = ("case", "motion", "through")
PULSE: Keys = ("case", "motion", "pulse")

PULSE_STEP = 1.0 / 40.0
"""Longest time between samples of what a pulse makes of a floor, over the period of the pulse."""


def goes_through(numbers: Numbers) -> bool:
    """Whether something stands between the ground and the body."""
    return bool(numbers.said(THROUGH))


def waveforms(numbers: Numbers) -> Array | None:
    """What the motions of the cases are beside their scale, (n, q); None where nothing stands between.

    Cases of one batch are of one waveform: its samples are the batch's.
    """
    if not goes_through(numbers):
        return None
    columns = [numbers.array(value) for pair in _chain(numbers) for value in pair]
    if numbers.said(PULSE) is None:
        return np.stack(columns, axis=1)
    table = build_pulses(numbers, PULSE, []).table.copy()
    table[:, :, PIECE_WIDTH - 1] = 0.0
    for kind, amplitudes in AMPLITUDE_COLUMNS.items():
        for column in amplitudes:
            table[:, :, column] *= table[:, :, 2] != kind
    return np.concatenate([np.stack(columns, axis=1), table.reshape(numbers.n, -1)], axis=1)


def of_record(numbers: Numbers, records: Records, ground: Samples, warnings: list[str]) -> tuple[Samples, Value]:
    """What arrives of a record, and what it is multiplied with beside the factor of the ground."""
    arrival = _arrival(numbers, records, replace(ground, factor=np.ones(1)), ground.dt)
    arrives, scale = _samples(numbers, ground, arrival, ground.factor, warnings)
    return replace(arrives, ground=replace(ground, factor=arrives.factor)), scale


def of_pulse(numbers: Numbers, records: Records, warnings: list[str]) -> Samples:
    """What arrives of a pulse: that of a unit pulse, times the amplitude."""
    pulses = build_pulses(numbers, PULSE, warnings)
    unit, amplitude = unit_pulses(numbers, PULSE)
    period = 2.0 * np.pi / float(unit.omega_p[0])
    arrival = _arrival(numbers, records, unit, PULSE_STEP * period)
    peaks = {"pga": 1.0, "pgv": np.nan, "pga_raw": 1.0, "pgv_raw": np.nan}
    ground = Samples(np.zeros(2), arrival.dt, amplitude, f"{pulses.shape} pulse", (), peaks)
    arrives, _ = _samples(numbers, ground, arrival, amplitude, warnings)
    return replace(arrives, ground=scaled(unit, arrives.factor))


def _samples(
    numbers: Numbers, ground: Samples, arrival: Arrival, factor: Array, warnings: list[str]
) -> tuple[Samples, Value]:
    from rockcli.motion.measures import pga, pgv

    before = ground.measures
    peak = pga(arrival.values)
    measures = before | {"pga_ground": before["pga"], "pgv_ground": before["pgv"]}
    measures |= {"pga": peak, "pgv": pgv(arrival.values, arrival.dt)}
    scale = _floor_scale(numbers, peak, factor)
    oscillators = ", then ".join(
        f"T = {float(np.ravel(T)[0]):.6g} s, zeta = {float(np.ravel(zeta)[0]):.4g}" for T, zeta in _chain(numbers)
    )
    share = peak / before["pga"] if before["pga"] > 0.0 else 0.0  # a record may be zero throughout
    said = (
        f"through {oscillators}: {ARRIVES} {share:.4g} of the ground's; "
        f"in straight lines over {arrival.dt:.6g} s with its mean over each, to {arrival.between:.1g} of its peak; "
        f"rings {arrival.rings:.4g} s after the ground motion, to {arrival.left:.1g} of its peak"
    )
    if arrival.left > 10.0 * RINGS_TO:
        warnings.append(f"what stands below the body still rings at {arrival.left:.2g} of its peak where it is cut off")
    if arrival.between > BETWEEN:
        warnings.append(f"what arrives is linear between samples to {arrival.between:.1g} of its peak only")
    name, files = ground.name, ground.files
    processing = (*ground.processing, said)
    return Samples(arrival.values, arrival.dt, factor * scale, name, processing, measures, files), scale


def _arrival(numbers: Numbers, records: Records, ground: Samples | Pulses, dt: float) -> Arrival:
    T, zeta = (
        np.array([float(np.ravel(value)[0]) for value in column]) for column in zip(*_chain(numbers), strict=True)
    )
    content = ground.values if isinstance(ground, Samples) else ground.table[0]
    key = (content.tobytes(), dt, T.tobytes(), zeta.tobytes())
    if key not in records.arrivals:
        chain, motion = Chain(T, zeta), forcing(ground)
        if (many := chain.lasts(motion) / dt) >= MAX_SAMPLES:
            said = f"would make {many:.3g} samples of what arrives, {dt:.3g} s apart"
            numbers.fail(THROUGH, f"{said}; at most {MAX_SAMPLES:.0e} are allowed", 0)
        records.arrivals[key] = chain.arrival(motion, dt)
    return records.arrivals[key]


def _chain(numbers: Numbers) -> list[tuple[Value, Value]]:
    """Period and damping ratio of every oscillator, from the ground up; floats or (n,).

    Raises:
        StudyError: no period or two, a value that cannot be.
    """
    found: list[tuple[Value, Value]] = []
    for j, part in enumerate(numbers.said(THROUGH)):
        keys: Keys = (*THROUGH, j)
        given = [key for key in ("T", "f") if getattr(part, key) is not None]
        if len(given) != 1:
            has = "T and f, which say the same thing" if given else "neither T nor f"
            numbers.fail(keys, f"has {has}; an oscillator has one of them, and zeta")
        value = numbers.positive((*keys, given[0]))
        assert value is not None
        T: Any = value if given[0] == "T" else 1.0 / value
        in_range(numbers, (*keys, given[0]), T)
        numbers.require((*keys, given[0]), np.greater(T, 1e-4), "makes a period below 0.1 ms")
        zeta = numbers.value((*keys, "zeta"))
        if zeta is None:
            numbers.fail(keys, "has no zeta, the damping ratio of the floor or isolator")
        inside = np.greater_equal(zeta, 0.0) & np.less_equal(zeta, 10.0)
        numbers.require((*keys, "zeta"), inside, "must be between 0 and 10")
        found.append((T, zeta))
    return found


def _floor_scale(numbers: Numbers, peak: float, factor: Array) -> Value:
    """What arrives is multiplied with."""
    given = [key for key in FLOOR_SCALINGS if getattr(numbers.case.motion, key) is not None]
    if not given:
        return 1.0
    keys: Keys = ("case", "motion", given[-1])
    if len(given) > 1:
        numbers.fail(keys, "floor_scale and floor_pga say the same thing; leave one out")
    value = numbers.value(keys)
    assert value is not None
    numbers.require(keys, np.greater_equal(value, 0.0), "must not be negative")
    if given[0] == "floor_scale":
        return value
    record = numbers.case.motion.record
    for key in RECORD_SCALINGS:
        if record is not None and getattr(record, key) is not None:
            numbers.fail(keys, f"says how strong what arrives is, and record.{key} the ground; leave one out")
    arrives = peak * np.abs(factor)
    numbers.require(keys, arrives > 0.0, "nothing arrives that could be scaled")
    return np.asarray(value / arrives)
