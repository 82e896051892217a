"""The ground motion of a study: pulses and records, horizontal and vertical, as the solvers take them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import RecordError
from rockcli.scene.constants import STANDARD_G
from rockcli.scene.counted import counted
from rockcli.scene.ground.amplitudes import FLOOR_SCALINGS, RECORD_SCALINGS
from rockcli.scene.ground.excitation import Channel, Excitation, Samples, Suite
from rockcli.study.building.floors import goes_through, of_pulse, of_record
from rockcli.study.building.numbers import Motions, Numbers, in_range
from rockcli.study.building.pulse import build_pulses
from rockcli.study.building.records import MissingRecordError, Prepared, Records
from rockcli.study.document.expressions import Value
from rockcli.study.document.tree import Keys, dotted, place
from rockcli.study.intensity import period_of
from rockcli.study.schema import CasePart, MotionPart, Part, RecordPart, VerticalPart

if TYPE_CHECKING:
    from rockcli.motion.motion import Motion

Array = NDArray[np.float64]

MOTION: Keys = ("case", "motion")
DIRECTIONS_KEPT = 512
"""Of two components: a batch is built some times."""

STEPS = ("window", "detrend", "taper", "highpass", "lowpass", "bandpass", "resample")


def alike_but_for_records(case: CasePart, *, directions: bool) -> bool:
    """Whether cases like this one may have a record each, in one batch, with nothing above or below.

    Of one component, or each two in a direction of its own.
    """
    motion, record = case.motion, case.motion.record
    beside = motion.pulse is not None or motion.vertical is not None or motion.duration is not None
    beside |= any(getattr(motion, key) for key in ("through", *FLOOR_SCALINGS))
    scheme = getattr(case.damping, "scheme", None)
    if record is None or beside or scheme == "fema356":
        return False
    single = isinstance(record.file, str) and record.angle is None and not isinstance(record.component, list)
    return not isinstance(record.file, str) if directions else single


def build_excitation(numbers: Numbers, records: Records, warnings: list[str]) -> Excitation:
    """The motion of every case.

    Raises:
        StudyError: more than one motion, a scaling that cannot be.
        RecordError: a record is missing or cannot be read.
    """
    for key in ("through", *FLOOR_SCALINGS):
        said = getattr(numbers.case.motion, key)
        if said and numbers.case.motion.pulse is None and numbers.case.motion.record is None:
            numbers.fail((*MOTION, key), "needs a motion of the ground: a pulse or a record")
        if said and not goes_through(numbers):
            numbers.fail((*MOTION, key), "is of what arrives through floors: it needs `through: [{T, zeta}, ...]`")
    if numbers.suite is not None:
        return Excitation(None, None, np.full(numbers.n, np.nan), _suite(numbers, numbers.suite, records, warnings))
    horizontal, amplitude = _channel(numbers, MOTION, records, warnings, inherited=1.0)
    vertical = None
    if numbers.case.motion.vertical is not None:
        vertical, _ = _channel(numbers, (*MOTION, "vertical"), records, warnings, inherited=amplitude)
        warnings.extend(_apart(numbers, records))
    duration = numbers.positive((*MOTION, "duration"))
    if duration is None:
        return Excitation(horizontal, vertical, np.full(numbers.n, np.nan))
    for channel in (horizontal, vertical):
        if channel is not None and np.any(np.less(duration, np.asarray(channel.end) * (1.0 - 1e-12))):
            warnings.append("`duration` is shorter than the motion, which is cut off there")
            break
    return Excitation(horizontal, vertical, numbers.array(duration))


def _apart(numbers: Numbers, records: Records) -> list[str]:
    """That a vertical record is of another place than the horizontal one, or begins earlier or later, as their files
    or windows say."""
    from rockcli.motion.direction import of_other_places

    both = [(*MOTION, "record"), (*MOTION, "vertical", "record")]
    if any(numbers.said(keys) is None for keys in both):
        return []
    g = _g_of_records(numbers)
    across, up = (_prepared(numbers, keys, records, g, numbers.constant((*keys, "angle"))).motion for keys in both)
    told = [f"the vertical {up.name} {elsewhere}"] if (elsewhere := of_other_places(up, across)) else []
    if later := up.begins_after(across):
        when = f"{abs(later):g} s {'after' if later > 0.0 else 'before'}"
        said = f"{up.name} begins {when} {across.name}, as the files say; both are taken from their first samples on"
        return [*told, said]
    first, above = (0.0 if numbers.said(keys).window is None else _step(numbers, (*keys, "window"))[0] for keys in both)
    if abs(above - first) <= 0.5 * up.dt or up.same_clock(across):
        return told
    return [
        *told,
        f"the vertical {up.name} is taken from {above:g} s on and {across.name} from {first:g} s (`window`): motions "
        "recorded side by side need the same window",
    ]


def _channel(
    numbers: Numbers, keys: Keys, records: Records, warnings: list[str], inherited: Value
) -> tuple[Channel | None, Value]:
    """A component of the motion, and what its record is multiplied with (1 for a pulse)."""
    motion: MotionPart | VerticalPart = numbers.said(keys)
    if motion.pulse is not None and motion.record is not None:
        numbers.fail((*keys, "record"), "a motion is a pulse or a record, not both")
    between = keys == MOTION and goes_through(numbers)
    if motion.pulse is not None:
        if between:
            return of_pulse(numbers, records, warnings), 1.0
        return build_pulses(numbers, (*keys, "pulse"), warnings), 1.0
    if motion.record is not None:
        ground, amplitude = _samples(numbers, (*keys, "record"), records, warnings, inherited)
        if between:
            arrives, scale = of_record(numbers, records, ground, warnings)
            return arrives, amplitude * scale
        return ground, amplitude
    if keys != MOTION:
        numbers.fail(keys, "needs a pulse or a record")
    return None, 1.0


def _samples(
    numbers: Numbers, keys: Keys, records: Records, warnings: list[str], inherited: Value
) -> tuple[Samples, Value]:
    record: RecordPart = numbers.said(keys)
    g = _g_of_records(numbers)
    prepared = _prepared(numbers, keys, records, g, numbers.constant((*keys, "angle")))
    files = (record.file,) if isinstance(record.file, str) else tuple(record.file)
    samples = _unscaled(prepared, files, g, sa_name(numbers, keys))
    motion = prepared.motion
    warnings.extend(_told(motion, two=len(files) > 1, across=keys[:-1] == MOTION))
    factor, amplitude = _factor(numbers, keys, samples.measures, motion.in_g, inherited)
    return replace(samples, factor=factor), amplitude


def _suite(numbers: Numbers, motions: Motions, records: Records, warnings: list[str]) -> Suite:
    """The motions of cases that have a record each, all read and scaled in the same way."""
    keys: Keys = (*MOTION, "record")
    record: RecordPart = numbers.said(keys)
    g, sa = _g_of_records(numbers), sa_name(numbers, keys)
    if motions.directions:
        files = [tuple(record.file)] * len(motions.points)
        prepared = [_prepared(numbers, keys, records, g, float(angle)) for angle, _ in motions.points]
    else:
        files = [(name,) for name, _ in motions.points]
        reading, steps = _reading(numbers, keys)
        prepared = records.prepare_all(
            motions.points,
            reading={**reading, "component": record.component},
            steps=steps,
            g=g,
            measure=lambda each, name: _unscaled(each, (name,), g, sa),
        )
    for each in prepared:
        warnings.extend(_told(each.motion, two=motions.directions, across=True))
    unscaled = tuple(_unscaled(each, names, g, sa) for each, names in zip(prepared, files, strict=True))
    known = ("pga", "pgv", sa) if sa else ("pga", "pgv")
    measures = {name: np.array([each.measures[name] for each in unscaled])[motions.which] for name in known}
    in_g = np.array([each.motion.in_g for each in prepared])[motions.which]
    factor, _ = _factor(numbers, keys, measures, in_g, 1.0)
    return Suite(unscaled, motions.which, factor)


def _told(motion: Motion, *, two: bool, across: bool) -> list[str]:
    """What is remarkable about a record, under its name; that of two components is under theirs already.

    Args:
        across: whether it is taken as horizontal.
    """
    from rockcli.motion.direction import told_of

    said = motion.warnings if two else told_of(motion, horizontal=across)
    return list(said) if two else [f"{motion.name}: {sentence}" for sentence in said]


def _g_of_records(numbers: Numbers) -> float:
    """The g of records in g [m/s²].

    Where g differs from case to case it goes into the factor, so that a case does not depend on its neighbours.
    """
    return STANDARD_G if isinstance(numbers.g, np.ndarray) else float(numbers.g)


def sa_name(numbers: Numbers, keys: Keys) -> str:
    """`sa(0.5)` of a record that is scaled to its Sa(0.5 s), "" of another.

    Raises:
        StudyError: one of `sa` and `sa_period` is there without the other, or the latter is no period.
    """
    record: RecordPart = numbers.said(keys)
    if record.sa is None:
        if record.sa_period is not None and all(getattr(record, key) is None for key in RECORD_SCALINGS):
            numbers.fail((*keys, "sa_period"), "is the period of `sa`, which the record does not give")
        return ""
    period = numbers.constant((*keys, "sa_period"))
    if period is None:
        numbers.fail((*keys, "sa"), "needs `sa_period`, the period at which it is wanted")
    numbers.require((*keys, "sa_period"), np.greater(period, 0.0), "must be greater than 0")
    return f"sa({period:.12g})"


def _unscaled(prepared: Prepared, files: tuple[str, ...], g: float, sa: str) -> Samples:
    """A record before its factors, measured; `sa`: whose Sa(T) beside PGA and PGV, "" = none."""
    from rockcli.motion.flatfile import metadata_of
    from rockcli.motion.measures import pga, pgv
    from rockcli.motion.spectrum import forcing, pseudo_acceleration

    if (g, files, sa) not in prepared.unscaled:
        motion, raw = prepared.motion, prepared.raw
        values = motion.acceleration(g)
        measures = {"pga": pga(values), "pgv": pgv(values, motion.dt)}
        unprocessed = raw is motion
        raw_values = values if unprocessed else raw.acceleration(g)
        measures["pga_raw"] = measures["pga"] if unprocessed else pga(raw_values)
        measures["pgv_raw"] = measures["pgv"] if unprocessed else pgv(raw_values, raw.dt)
        measures |= metadata_of(prepared.path, raw.header)
        if period := period_of(sa):
            whole = forcing(Samples(values, motion.dt, np.ones(1)))
            measures[sa] = float(pseudo_acceleration(whole, np.array([period]))[0])
        samples = Samples(values, motion.dt, np.empty(0), motion.name, motion.processing, measures, files)
        prepared.unscaled[g, files, sa] = samples
    return prepared.unscaled[g, files, sa]


def _factor(
    numbers: Numbers, keys: Keys, measures: Mapping[str, Value], in_g: bool | NDArray[np.bool_], inherited: Value
) -> tuple[Array, Value]:
    """What each case multiplies its record with, (n,), and that without the record's own sign and unit.

    Args:
        measures: pga, pgv and, where it is scaled to it, sa(T) of the record, or of that of each case, (n,).
        in_g: whether it is in g.
    """
    record: RecordPart = numbers.said(keys)
    of_g: Value = np.where(in_g, numbers.g / STANDARD_G, 1.0) if isinstance(numbers.g, np.ndarray) else 1.0
    amplitude = _amplitude(numbers, keys, measures, of_g, inherited)
    polarity = numbers.value((*keys, "polarity"))
    if polarity is not None:
        numbers.require((*keys, "polarity"), np.abs(polarity) == 1.0, "must be 1 or -1")
    scaling = next((key for key in RECORD_SCALINGS if getattr(record, key) is not None), "file")
    in_range(numbers, (*keys, scaling), amplitude * of_g * np.maximum(measures["pga"], measures["pgv"]))
    return numbers.array(amplitude * of_g * (1.0 if polarity is None else polarity)), amplitude


def _reading(numbers: Numbers, keys: Keys) -> tuple[dict[str, Any], dict[str, Any]]:
    """How a record is read, but for its component, and the steps of its processing."""
    record: RecordPart = numbers.said(keys)
    steps = {step: _step(numbers, (*keys, step)) for step in STEPS if getattr(record, step) is not None}
    return {"units": record.units, "dt": numbers.constant((*keys, "dt"))}, steps


def _prepared(numbers: Numbers, keys: Keys, records: Records, g: float, angle: float | None) -> Prepared:
    """The processed record, of two components in the direction of an angle [rad].

    Raises:
        RecordError: a file is missing or cannot be read, or two components do not fit together.
    """
    record: RecordPart = numbers.said(keys)
    reading, steps = _reading(numbers, keys)
    names, components = record.file, record.component
    try:
        if isinstance(names, str):
            if angle is not None:
                numbers.fail((*keys, "angle"), "needs two horizontal components: file: [H1, H2]")
            if isinstance(components, list):
                numbers.fail((*keys, "component"), "is a list: two components need two files, file: [H1, H2]")
            where = place(numbers.tree, (*keys, "file"))
            return records.prepare(names, where, reading={**reading, "component": components}, steps=steps, g=g)
        if keys[:-1] != MOTION:
            numbers.fail((*keys, "file"), "the vertical motion is one component, one file")
        if len(names) != 2:
            numbers.fail((*keys, "file"), f"has {counted(len(names), 'name')}; two horizontal components are expected")
        if angle is None:
            numbers.fail(keys, "two horizontal components need an angle, from the first towards the second")
        pair = []
        for i, name in enumerate(names):
            component = components[i] if isinstance(components, list) else components
            where = place(numbers.tree, (*keys, "file", i))
            pair.append(records.prepare(name, where, reading={**reading, "component": component}, steps=steps, g=g))
        one, two = pair
        if (one, two, angle) not in records.directions:
            if len(records.directions) >= DIRECTIONS_KEPT:
                records.directions.clear()
            records.directions[one, two, angle] = _in_direction(one, two, angle)
        return records.directions[one, two, angle]
    except MissingRecordError:
        raise
    except RecordError as error:
        raise _at_its_key(numbers, keys, error) from None


def _in_direction(one: Prepared, two: Prepared, angle: float) -> Prepared:
    """Two processed components in one direction; as filed too, as long as both components last there."""
    from rockcli.motion.direction import in_direction

    motion = in_direction(one.motion, two.motion, angle)
    if one.raw is one.motion and two.raw is two.motion:
        return Prepared(motion, motion, one.path)
    common = min(len(one.raw.values), len(two.raw.values))
    raw_one, raw_two = (replace(part.raw, values=part.raw.values[:common]) for part in (one, two))
    return Prepared(motion, in_direction(raw_one, raw_two, angle), one.path)


def _at_its_key(numbers: Numbers, keys: Keys, error: RecordError) -> RecordError:
    """What is wrong with a record or its options, at the place of the study that asks for it."""
    from rockcli.motion.options import OptionError

    below = error.key.split(".") if isinstance(error, OptionError) else ["file"]
    at = (*keys, *below)
    return numbers.source.record_error(place(numbers.tree, at), f"{dotted(at)}: {error}")


def _amplitude(numbers: Numbers, keys: Keys, measures: Mapping[str, Value], of_g: Value, inherited: Value) -> Value:
    """What the processed motion is multiplied with; its own scaling, or the one inherited."""
    record: RecordPart = numbers.said(keys)
    given = [key for key in RECORD_SCALINGS if getattr(record, key) is not None]
    if not given:
        return inherited
    if len(given) > 1:
        numbers.fail((*keys, given[-1]), f"{' and '.join(given)} say the same thing; leave one out")
    wanted = numbers.value((*keys, given[0]))
    assert wanted is not None
    numbers.require(
        (*keys, given[0]), np.greater_equal(wanted, 0.0), "must not be negative; polarity: -1 turns a motion"
    )
    if given[0] == "scale":
        return wanted
    measure = measures[sa_name(numbers, keys) or ("pgv" if given[0] == "pgv" else "pga")]
    if np.any(np.equal(measure, 0.0)):
        numbers.fail((*keys, given[0]), "the record is zero throughout and cannot be scaled")
    if given[0] == "pga_over_g_tan_alpha":
        wanted = wanted * (numbers.g * numbers.symbol("tan_alpha"))
    factor = wanted / (measure * of_g)
    numbers.require((*keys, given[0]), np.isfinite(factor), "gives no finite factor")
    return factor


def _step(numbers: Numbers, keys: Keys) -> Any:
    """The options of a processing step as plain numbers and words."""
    value = numbers.said(keys)
    if isinstance(value, Part):
        return {key: _step(numbers, (*keys, key)) for key, item in value if item is not None}
    if isinstance(value, list):
        return [_step(numbers, (*keys, i)) for i in range(len(value))]
    if isinstance(value, bool | int) or (isinstance(value, str) and keys[-1] in ("detrend", "type", "method")):
        return value
    return numbers.constant(keys)
