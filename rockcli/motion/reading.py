"""Reads a record file of any format into a `Motion`; units and time step are never guessed.

AT2, plain text and the formats of agencies (`agencies`) are read here; for all others ObsPy is asked.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rockcli import kernels
from rockcli.errors import RecordError, path_given
from rockcli.motion.agencies.channel import Channel
from rockcli.motion.agencies.formats import FORMATS, channels_of, format_of
from rockcli.motion.at2 import looks_like_at2, parse_at2
from rockcli.motion.file import record_bytes
from rockcli.motion.motion import Given, Motion, start_in
from rockcli.motion.options import OptionError
from rockcli.motion.text import SEMICOLON, first_line_of_words, first_semicolon, is_numeric_text, parse_text
from rockcli.motion.units import FACTORS, same_unit, unit_named

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

KNOWN_UNITS = "g, m/s2, cm/s2, gal, mm/s2"

MIN_DT, MAX_DT = 1e-9, 1e6
"""Time steps between which a record is believed [s]."""

MAX_VALUE = 1e30
"""Values above are no accelerations, whatever their units."""

LARGE = 10.0
"""Peak [g] above which the units are doubted aloud: no earthquake has been recorded that shook so hard."""

STATED = 0.01
"""Relative difference of the peak of the values from that in the header above which it is mentioned."""

SLOW = 0.5
"""Time step from which the units of time are doubted aloud [s]: strong motion is sampled ten times as often."""

OFFSET = 0.05
"""Mean value over PGA above which it is mentioned: the raw output of an instrument, not a motion."""


COMPRESSED = {
    b"\x1f\x8b": "compressed by gzip",
    b"BZh": "compressed by bzip2",
    b"\xfd7zXZ": "compressed by xz",
    b"PK\x03\x04": "a ZIP archive, or a spreadsheet (save it as CSV)",
}
"""How files begin that hold records inside."""

UNSTATED = ("COUNTS", "COUNT", "UNKNOWN", "INTEGER", "FLOAT", "")
"""What stands in SLIST and TSPAIR files in place of a unit, in capitals."""

OTHER_QUANTITIES = {6: "displacement", 7: "velocity"}
"""What IDEP of a SAC header says beside acceleration (8), unknown (5) and volts (50), as SAC calls what it makes."""

OTHER_KINDS = (2, 3, 4, 51)
"""What IFTYPE of a SAC header says of two kinds of spectra, of pairs x and y, and of values over a plane."""

SINGLE = ("SAC", "SACXY", "AH")
"""Formats of ObsPy that hold the time step in single precision."""

SEVERAL = 50
"""Files from which it pays to load compiled kernels, which takes 30 ms, as half a millisecond is saved with each."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a reader found in a file: values (k,) in `units`, one of the names of `units.py`."""

    values: NDArray[np.float64]
    dt: float
    units: str
    format: str
    component: str = ""
    header: dict[str, Any] = field(default_factory=dict)
    processing: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def ready_for(files: int) -> None:
    """Load kernels for reading and measuring, if there are many files and nobody waits for a compiler."""
    if files >= SEVERAL and kernels.compiled_ahead():
        kernels.load("reading.decimals", compile_them=True)


def read_record(
    path: str | Path, *, component: str | int | None = None, units: str | None = None, dt: float | None = None
) -> Motion:
    """Read one component of a ground-motion record.

    Args:
        path: of the file: AT2, a format of `agencies.formats`, text in one column (acceleration), two (time,
            acceleration) or as many as one likes (acceleration, line by line), or any format ObsPy reads;
            compressed files are not.
        component: which one, if the file holds several: its name as the file gives it (`UP (2)`: the second that is
            called `UP`), or its place from 0. If the file holds one, it must be that one.
        units: of the values: `g`, `m/s2`, `cm/s2`, `gal`, `mm/s2`; needed where the format does not state
            them, and must not contradict the file where it does.
        dt: time step [s]; the same holds.

    Returns:
        values in g where the file is in g, else in m/s² (calibration applied), float64.

    Raises:
        RecordError: naming file, line if any, what is wrong and what to do.
    """
    path = path_given(path, RecordError)
    unit = _known_unit(units, path)
    if dt is not None and not _is_step(dt):
        raise OptionError("dt", f"`dt` is {dt!r}; expected the time step in seconds, above zero", path)
    data = _bytes(path)
    if looks_like_at2(data):
        found = _at2(data, path, component, unit)
    elif (one := format_of(data)) is not None:
        found = _of_agency(channels_of(data, one, str(path)), one.name, path, component, unit)
    elif is_numeric_text(data):
        _only_component("", component, path)
        text = parse_text(data, str(path), unit, dt)
        found = Found(text.values, text.dt, text.units, "text", "", text.header, text.processing, text.warnings)
    else:
        found = _through_obspy(path, component, unit)
    if dt is not None and abs(dt - found.dt) > 1e-6 * found.dt:
        message = f"the file says its time step is {found.dt:g} s, `dt` says {dt:g} s; leave `dt` out"
        raise OptionError("dt", message, path)
    return _motion(found, path, hashlib.sha256(data).hexdigest())


def motion_of(
    given: Given | Motion,
    name: str,
    *,
    component: str | int | None = None,
    units: str | None = None,
    dt: float | None = None,
) -> Motion:
    """Values given in memory as a `Motion`, as `read_record` reads those of a file; a `Motion` gets another hash only.

    Raises:
        RecordError: units or time step are not told, or are told twice and differ; values that are no record.
    """
    path = Path(name)
    unit = _known_unit(units, path)
    own = given.units if isinstance(given, Motion) else None
    if unit is None and own is None:
        message = f"values in memory do not tell their units; give them with `units:`, one of {KNOWN_UNITS}"
        raise OptionError("units", message, path)
    if own is not None and unit is not None and not same_unit(own, unit):
        raise OptionError("units", f"the motion is in {own}, `units` says {unit}; leave it out", path)
    if given.dt is None and dt is None:
        raise OptionError("dt", "values in memory do not tell their time step; give it with `dt:` [s]", path)
    if given.dt is not None and dt is not None and abs(dt - given.dt) > 1e-6 * given.dt:
        raise OptionError("dt", f"the time step told with the values is {given.dt:g} s; leave `dt` out", path)
    _only_component(given.component, component, path)
    if isinstance(given, Motion):  # which may be no longer what its file held
        told = repr((given.dt, given.in_g)).encode()
        return replace(given, sha256=hashlib.sha256(given.values.tobytes() + told).hexdigest())
    step = given.dt if given.dt is not None else float(dt or 0.0)
    # of what is given alone: one array may be read in several units or steps, as one file may
    digest = hashlib.sha256(given.values.tobytes() + repr(given.dt).encode()).hexdigest()
    header = {"start": given.start} if given.start else {}
    return _motion(Found(given.values, step, str(unit), "array", given.component, header), path, digest)


def components_of(path: str | Path) -> list[str | None]:
    """What chooses each component with numbers: its name, those of one name with a number; [None] for one alone.

    Raises:
        RecordError: it cannot be read.
    """
    path = Path(path)
    data = _bytes(path)
    if looks_like_at2(data):
        return [None]
    if (one := format_of(data)) is not None:
        names = _told_apart([channel.component for channel in channels_of(data, one, str(path))])
        return [None] if len(names) == 1 else [*names]
    if is_numeric_text(data):
        return [None]
    traces = _obspy_traces(path, _obspy_format(path))
    names = _told_apart([str(trace.id) for trace in traces])
    numbers = [name for name, trace in zip(names, traces, strict=True) if not _is_text(trace)]
    return [None] if len(names) == 1 else [*(numbers or names)]  # one with text alone is refused as it is read


def _is_step(dt: Any) -> bool:
    return not isinstance(dt, bool) and isinstance(dt, Real) and 0.0 < float(dt) < np.inf


def _known_unit(units: str | None, path: Path) -> str | None:
    if units is None:
        return None
    unit = unit_named(str(units))
    if unit is None:
        raise OptionError("units", f"`units` is {units!r}; expected one of {KNOWN_UNITS}", path)
    return unit


def _bytes(path: Path) -> bytes:
    data = record_bytes(path)
    if not data or data.isspace():
        raise RecordError("the file is empty; get it anew", path)
    if (kind := next((kind for begin, kind in COMPRESSED.items() if data.startswith(begin)), None)) is not None:
        raise RecordError(f"this is {kind}; give the record itself", path)
    return data


def _motion(found: Found, path: Path, sha256: str) -> Motion:
    in_g = found.units == "g"
    values = found.values if in_g else found.values * FACTORS[found.units]
    converted = () if found.units in ("g", "m/s2") else (f"values in {found.units} converted to m/s2",)
    if not MIN_DT <= found.dt <= MAX_DT:
        message = f"the time step is {found.dt:g} s; expected seconds between {MIN_DT:g} and {MAX_DT:g}"
        raise OptionError("dt", message, path)
    if len(values) < 2 or not np.isfinite(values).all():
        raise RecordError("a record needs two or more values, all finite", path)
    if (peak := float(np.abs(values).max())) > MAX_VALUE:
        raise RecordError(f"a value of {peak:g} is too large to be an acceleration; get the file anew", path)
    return Motion(
        values=np.ascontiguousarray(values),
        dt=found.dt,
        in_g=in_g,
        name=path.name,
        sha256=sha256,
        processing=(*found.processing, *converted),
        warnings=(*found.warnings, *_remarks(values, peak, found.dt, in_g)),
        format=found.format,
        component=found.component,
        header=found.header,
    )


def _remarks(values: NDArray[np.float64], peak: float, dt: float, in_g: bool) -> tuple[str, ...]:
    mean = float(values.mean())
    unit = "g" if in_g else "m/s2"
    remarks = []
    if peak > (LARGE if in_g else LARGE * 9.81):
        remarks.append(f"the peak is {peak:.4g} {unit}: are the units right?")
    if dt >= SLOW:
        remarks.append(f"the time step is {dt:g} s: is the time in seconds, and not in ms?")
    if abs(mean) > OFFSET * peak > 0.0:
        remarks.append(
            f"the mean value is {mean:.3g} {unit}, {abs(mean) / peak:.0%} of the peak, as an instrument's offset "
            "would be: consider `detrend: constant`"
        )
    if peak == 0.0:
        remarks.append("all values are zero")
    return tuple(remarks)


def _at2(data: bytes, path: Path, component: str | int | None, unit: str | None) -> Found:
    record = parse_at2(data, str(path), unit)
    _only_component(record.component, component, path)
    header = {
        "title": list(record.titles),
        "event": record.event,
        "date": record.date,
        "station": record.station,
        **start_in(" ".join(record.titles)),
    }
    return Found(record.values, record.dt, record.units, "AT2", record.component, header, warnings=record.warnings)


def _of_agency(channels: list[Channel], name: str, path: Path, component: str | int | None, unit: str | None) -> Found:
    """A component of a file that states everything itself."""
    names = [channel.component for channel in channels]
    one = channels[_chosen(names, _told_apart(names), component, path)]
    if unit is not None and not same_unit(unit, one.units):
        raise OptionError("units", f"the file says its units are {one.units}, `units` says {unit}; leave it out", path)
    peak = float(np.abs(one.values).max(initial=0.0))
    differs = abs(peak - one.peak) > STATED * one.peak  # False where the header states none
    said = f"the header says the peak is {one.peak:.5g} {one.units}, that of the values is {peak:.5g}"
    header = {"station": one.station, **one.header}
    return Found(one.values, one.dt, one.units, name, one.component, header, warnings=(said,) if differs else ())


def _same_name(name: str, asked: str | int) -> bool:
    asked = str(asked)
    return name.casefold() == asked.casefold() or (name.isdigit() and asked.isdigit() and int(name) == int(asked))


def _only_component(name: str, asked: str | int | None, path: Path) -> None:
    """Refuse to take the only component of a file for another one."""
    if asked is None or asked == 0 or (name and _same_name(name, asked)):
        return
    has = f"holds component {name!r} only" if name else "does not name its component"
    raise OptionError("component", f"`component` is {asked!r}, but the file {has}; leave `component` out", path)


def _through_obspy(path: Path, component: str | int | None, unit: str | None) -> Found:
    """The record through ObsPy, its traces multiplied by their calibration factors."""
    format_name = _obspy_format(path)
    traces = _obspy_traces(path, format_name)
    _refuse_part_of_a_record(traces, format_name, path)
    _refuse_short_series(traces, path)
    trace = _chosen_trace(traces, component, path)
    stats = trace.stats
    if _is_text(trace):
        raise RecordError(f"{trace.id} holds text, as the log of an instrument, and no numbers", path)
    if format_name == "KNET":
        _refuse_knet(stats, path)
    _refuse_other_sac(stats.get("sac", {}), path)
    calib = float(stats.calib)
    values = np.ma.filled(np.ma.asarray(trace.data, dtype=float), np.nan) * calib
    processing = () if calib == 1.0 else (f"values as stored multiplied by the file's calibration factor {calib:.8g}",)
    of_format = stats.get(format_name.lower(), {}).items()
    header = {
        **{key: str(value) for key, value in of_format if not isinstance(value, Mapping)},  # as `station` of AH is
        "network": stats.network,
        "station": stats.station,
    }
    with suppress(OverflowError, ValueError):  # of no date, as a damaged header has it
        header["start"] = str(stats.starttime)
    units = _obspy_units(format_name, unit, stats, path)
    dt = float(stats.delta)
    if format_name in SINGLE:  # .01 is then .00999999978
        dt = float(str(np.float32(dt)))
    warnings = _one_of_pieces(traces, trace)
    return Found(values, dt, units, format_name, str(stats.channel), header, processing, warnings)


def _one_of_pieces(traces: list[Any], trace: Any) -> tuple[str, ...]:
    """A sentence where a file holds a component in pieces, of which this is one."""
    pieces = sum(each.id == trace.id for each in traces)
    if pieces == 1 or not trace.stats.channel:
        return ()
    return (
        f"the file holds {trace.id} in {pieces} pieces, with gaps or overlaps between them: this is the one from "
        f"{trace.stats.starttime} on, {len(trace.data)} values",
    )


def _is_text(trace: Any) -> bool:
    """Whether a trace holds no numbers, as the log of a recorder in MiniSEED."""
    return trace.data.dtype.kind not in "iufb"


def _refuse_knet(stats: Any, path: Path) -> None:
    """Refuse a file of which ObsPy takes numbers without a header, or with more or fewer values than announced."""
    if "knet" not in stats:
        raise RecordError("its header does not end with a line 'Memo.': the file is damaged; get it anew", path)
    if stats.npts != (count := round(stats.knet.duration * stats.sampling_rate)):
        said = f"the header announces {count} values and {stats.npts} follow: the file is damaged; get it anew"
        raise RecordError(said, path)


def _refuse_other_sac(header: Any, path: Path) -> None:
    """Refuse a SAC file whose header says that it is no acceleration at equal time steps."""
    if (quantity := OTHER_QUANTITIES.get(header.get("idep"))) is not None:
        said = f"its header (IDEP) says that this is a {quantity}; a motion needs the acceleration"
    elif header.get("leven") == 0 or header.get("iftype") in OTHER_KINDS:
        said = "its header (LEVEN, IFTYPE) says that this is no series at equal time steps"
    else:
        return
    raise RecordError(f"{said}: correct the header if it is wrong", path)


def _refuse_part_of_a_record(traces: list[Any], format_name: str, path: Path) -> None:
    """MiniSEED is made of records of one length or a few, powers of two; ObsPy passes over one that is not whole.

    So is WIN of seconds, each of which begins with its length.
    """
    of_mseed = [trace.stats.mseed for trace in traces if "filesize" in trace.stats.get("mseed", {})]
    if of_mseed and of_mseed[0].filesize % (length := min(one.record_length for one in of_mseed)):
        raise RecordError(f"the file ends inside a record of {length} bytes: it has been cut; get it anew", path)
    if format_name == "WIN":
        data, at = record_bytes(path), 0
        while at < len(data):
            at += max(int.from_bytes(data[at : at + 4], "big"), 4)
        if at != len(data):
            raise RecordError("the file ends inside a second: it has been cut; get it anew", path)


def _refuse_short_series(traces: list[Any], path: Path) -> None:
    """SLIST and TSPAIR files announce how many values follow; ObsPy takes what there is."""
    if not any("ascii" in trace.stats for trace in traces):
        return
    lines = record_bytes(path).replace(b"\r", b"\n")
    announced = re.findall(rb"^TIMESERIES\s+[^\s,]+[\s,]+(\d+)", lines, re.M)
    for trace, count in zip(traces, map(int, announced), strict=True):
        if (follow := len(trace.data)) != count:
            said = f"its header announces {count} values of {trace.id} and {follow} follow"
            raise RecordError(f"{said}: the file is damaged; get it anew", path)


def _obspy_units(format_name: str, unit: str | None, stats: Any, path: Path) -> str:
    """K-NET and KiK-net state theirs (ObsPy's factor gives m/s²), SLIST and TSPAIR may; the others do not."""
    if format_name == "KNET":
        if unit not in (None, "gal", "cm/s2"):
            message = f"the file states its own units, gal per count, `units` says {unit}; leave it out"
            raise OptionError("units", message, path)
        return "m/s2"
    stated = str(stats.ascii.unit) if "ascii" in stats else ""
    if stated.upper() not in UNSTATED:
        return _agreed(stated, unit, path)
    if unit is None:
        raise OptionError(
            "units",
            f"the format ({format_name}) does not state the units; give them with `units:`, one of {KNOWN_UNITS} "
            "(of the values times the file's calibration factor)",
            path,
        )
    return unit


def _agreed(stated: str, given: str | None, path: Path) -> str:
    """The unit of acceleration that a file states, which its user may not contradict."""
    if (unit := unit_named(stated)) is None:
        raise RecordError(f"the values are in {stated!r}, not a unit of acceleration known here", path)
    if given is not None and not same_unit(given, unit):
        raise OptionError("units", f"the file says its units are {unit}, `units` says {given}; leave it out", path)
    return unit


def _obspy_format(path: Path) -> str:
    """Name of the format ObsPy would read the file in.

    ObsPy's pickle reader is not asked: it runs whatever program the file contains.
    """
    from importlib.metadata import entry_points

    from obspy.core.util.base import ENTRY_POINTS

    declared = entry_points()
    not_asked = ("PICKLE", "AT2", *(one.name for one in FORMATS))
    for name in ENTRY_POINTS["waveform"]:
        asked = declared.select(group=f"obspy.plugin.waveform.{name}", name="isFormat")
        if name not in not_asked and any(_says_yes(entry, path) for entry in asked):
            return str(name)
    if found := first_line_of_words(record_bytes(path)):
        line, text = found
        raise RecordError(f"{text.strip()[:40]!r} is no line of numbers, as those before are; correct it", path, line)
    as_text = "two columns under a line `time [s],acceleration [m/s2]`"
    if separated := first_semicolon(record_bytes(path)):
        raise RecordError(f"{SEMICOLON}; write the record as {as_text}", path, separated)
    agencies = ", ".join(one.name for one in FORMATS)
    raise RecordError(
        f"the format is not known (read are AT2, {agencies}, columns of numbers, and what ObsPy reads); write the "
        f"record as AT2, or as {as_text}",
        path,
    )


def _says_yes(entry: EntryPoint, path: Path) -> bool:
    """Whether a format's own test recognises the file; one that stumbles does not."""
    import warnings

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return bool(entry.load()(str(path)))
    except Exception:
        return False


def _obspy_traces(path: Path, format_name: str) -> list[Any]:
    import glob
    import warnings

    import obspy

    # of SAC files the step would be rounded to microseconds, that of 1/128 s by 64 in a million
    exact = {"round_sampling_interval": False} if format_name in ("SAC", "SACXY") else {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return list(obspy.read(glob.escape(str(path)), format=format_name, check_compression=False, **exact))
    except RecordError:
        raise
    except Exception as error:
        raise RecordError(f"ObsPy takes it for {format_name} but cannot read it; get it anew: {error}", path) from error


def _chosen_trace(traces: list[Any], component: str | int | None, path: Path) -> Any:
    ids = _told_apart([str(trace.id) for trace in traces])
    return traces[_chosen([str(trace.stats.channel) for trace in traces], ids, component, path)]


def _told_apart(names: list[str]) -> list[str]:
    """The names, each of several that are alike with a number: `UP (1)`, `90`, `UP (2)`."""
    alike, before = Counter(names), Counter[str]()
    told = []
    for name in names:
        before[name] += 1
        told.append(name if alike[name] == 1 and name else f"{name} ({before[name]})".strip())
    return told


def _chosen(names: list[str], ids: list[str], component: str | int | None, path: Path) -> int:
    """Place of the one component of a file that is meant."""
    listed = ", ".join(f"{i}: {one}" for i, one in enumerate(ids))
    if not names:
        raise RecordError("the file holds no component", path)
    if component is None:
        chosen = list(range(len(names)))
    else:
        chosen = [i for i, name in enumerate(names) if _same_name(name, component) or ids[i] == component]
        if not chosen and isinstance(component, int) and 0 <= component < len(names):
            chosen = [component]
    if len(chosen) != 1:
        what = "choose one with `component`" if component is None else f"`component` is {component!r}"
        raise OptionError("component", f"{what}; the file holds {listed}", path)
    return chosen[0]
