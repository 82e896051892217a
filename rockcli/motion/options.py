"""Options of record processing (filters, taper, resampling, ...), from the study's words to numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rockcli.errors import RecordError

DETRENDS = {"constant": "constant", "demean": "constant", "linear": "linear", "simple": "simple"}
TAPERS = ("cosine", "hann", "hamming", "blackman", "bartlett", "parzen", "triang")
METHODS = ("fourier", "lanczos", "linear", "weighted_average_slopes")

MAX_SAMPLES = 10_000_000
"""Samples that resampling may make of a record: more than a day at 100 per second."""

SIDE = {"highpass": ("freq",), "lowpass": ("freq",), "bandpass": ("freqmin", "freqmax")}


class OptionError(RecordError):
    """An option of a record that cannot be; `key` is where it stands below the record, such as `resample.dt`."""

    def __init__(self, key: str, message: str, file: str | Path | None = None, line: int | None = None) -> None:
        self.key = key
        super().__init__(message, file, line)


def window_options(window: Any, end: float, dt: float, file: str) -> tuple[float, float]:
    """Begin and end [s] of `window: [t1, t2]`, inside a motion that lasts from 0 to `end`.

    Raises:
        OptionError: it is no such pair, or shorter than a time step.
    """
    expected = f"expected [t1, t2] in seconds with 0 <= t1 < t2 <= {end:g}"
    if isinstance(window, str) or not hasattr(window, "__len__") or len(window) != 2:
        raise OptionError("window", f"`window` is {window!r}; {expected}", file)
    t1, t2 = (number(value, "window", expected, file) for value in window)
    slack = 1e-6 * dt
    if not (-slack <= t1 and t1 + dt <= t2 + slack and t2 <= end + slack):
        raise OptionError("window", f"`window` is [{t1:g}, {t2:g}]; {expected}, at least one time step long", file)
    return t1, t2


def taper_options(taper: Any, file: str) -> tuple[float, str]:
    """Fraction of the length tapered at each end, and the shape, of `taper: 0.05` or `{fraction, type}`.

    Raises:
        OptionError: the fraction is not above 0 and at most 0.5, or the shape is not known.
    """
    options = _mapping(taper, "taper", ("fraction", "type"), ("fraction",), file)
    expected = "expected the fraction of the record tapered at each end, above 0, at most 0.5"
    fraction = number(options.get("fraction"), "taper", expected, file)
    if not 0.0 < fraction <= 0.5:
        raise OptionError("taper", f"`taper` is {fraction:g}; {expected}", file)
    return fraction, _one_of(options.get("type", "cosine"), "taper.type", TAPERS, file)


def filter_options(key: str, value: Any, dt: float, file: str) -> dict[str, Any]:
    """Frequencies [Hz], corners and zerophase of a filter, as ObsPy calls them.

    `highpass: 0.1`, `lowpass: {freq: 20, corners: 2, zerophase: false}`, `bandpass: [0.1, 20]` or
    `{freqmin, freqmax, corners, zerophase}`; 4 corners and zero phase unless said.

    Raises:
        OptionError: a frequency is not between 0 and that of Nyquist, or an option is none of these.
    """
    frequencies = SIDE[key]
    options = _mapping(value, key, (*frequencies, "corners", "zerophase"), frequencies, file)
    nyquist = 0.5 / dt
    expected = f"expected Hz, above 0 and below the Nyquist frequency, {nyquist:g}"
    checked: dict[str, Any] = {name: number(options.get(name), key, expected, file) for name in frequencies}
    for frequency in checked.values():
        if not 0.0 < frequency < nyquist:
            raise OptionError(key, f"`{key}` is {frequency:g}; {expected}", file)
    if key == "bandpass" and not checked["freqmin"] < checked["freqmax"]:
        raise OptionError("bandpass", f"`bandpass` is {value!r}; expected the lower frequency first", file)
    corners, zerophase = options.get("corners", 4), options.get("zerophase", True)
    if not isinstance(corners, int) or isinstance(corners, bool) or not 1 <= corners <= 10:
        raise OptionError(
            f"{key}.corners", f"`{key}.corners` is {corners!r}; expected a whole number from 1 to 10", file
        )
    if not isinstance(zerophase, bool):
        raise OptionError(f"{key}.zerophase", f"`{key}.zerophase` is {zerophase!r}; expected true or false", file)
    return {**checked, "corners": corners, "zerophase": zerophase}


def resample_options(resample: Any, duration: float, file: str) -> tuple[float, str]:
    """New time step [s] and method of `resample: {dt, method}`; the method moves the peaks, so it must be said.

    Raises:
        OptionError: one of them is missing or not known, or there would be too many samples.
    """
    expected = f"expected {{dt: seconds, method: one of {', '.join(METHODS)}}}"
    if not isinstance(resample, Mapping) or "method" not in resample:
        raise OptionError("resample", f"`resample` is {resample!r}; {expected}", file)
    options = _mapping(resample, "resample", ("dt", "method"), (), file)
    dt = number(options.get("dt"), "resample.dt", expected, file)
    if not 0.0 < dt <= duration:
        raise OptionError(
            "resample.dt", f"`resample.dt` is {dt:g}; expected seconds, above 0 and within the record", file
        )
    if duration / dt >= MAX_SAMPLES:
        much = f"would make {duration / dt:.3g} samples of the record; at most {MAX_SAMPLES:.0e} are allowed"
        raise OptionError("resample.dt", f"`resample.dt` is {dt:g}, which {much}", file)
    return dt, _one_of(options["method"], "resample.method", METHODS, file)


def number(value: Any, key: str, expected: str, file: str) -> float:
    """A finite number, or an error that names the key."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise OptionError(key, f"`{key}` holds {value!r}; {expected}", file)
    return float(value)


def _mapping(value: Any, key: str, known: tuple[str, ...], short: tuple[str, ...], file: str) -> dict[str, Any]:
    """The options by name; what is no mapping stands for the keys in `short`."""
    if isinstance(value, Mapping):
        unknown = [name for name in value if name not in known]
        if unknown:
            raise OptionError(key, f"`{key}` does not know {unknown[0]!r}; expected {', '.join(known)}", file)
        return dict(value)
    if len(short) == 1:
        return {short[0]: value}
    if isinstance(value, str) or not hasattr(value, "__len__") or len(value) != len(short):
        raise OptionError(key, f"`{key}` is {value!r}; expected [{', '.join(short)}]", file)
    return dict(zip(short, value, strict=True))


def _one_of(value: Any, key: str, known: tuple[str, ...], file: str) -> str:
    if value not in known:
        raise OptionError(key, f"`{key}` is {value!r}; expected one of {', '.join(known)}", file)
    return str(value)
