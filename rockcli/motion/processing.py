"""Record processing: window, detrend, taper, filter, resample, scale; every step says what it did to PGA and PGV.

In this order, whatever the order in the study: window, detrend, taper, filters, resample.  Nothing is done that
is not asked for.  The steps are ObsPy's, except the window and the Fourier method of resampling (see `_fourier`).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.motion import options
from rockcli.motion.measures import pga, pgv
from rockcli.motion.motion import Motion
from rockcli.motion.options import OptionError

LANCZOS_WIDTH = 20
"""Samples on each side that an interpolated value depends on."""


def process(
    motion: Motion,
    *,
    window: Any = None,
    detrend: str | None = None,
    taper: Any = None,
    highpass: Any = None,
    lowpass: Any = None,
    bandpass: Any = None,
    resample: Any = None,
    g: float = 9.81,
) -> Motion:
    """The motion after the steps asked for; the given one stays as it is.

    Args:
        motion: the record.
        window: [t1, t2] in seconds from the first sample: the samples nearest to the two times and all between
            stay; t1 becomes t = 0.
        detrend: `constant` (or `demean`): minus the mean; `linear`: minus the least-squares line; `simple`:
            minus the line through first and last sample.
        taper: fraction of the length, at each end, or {fraction, type}; type `cosine` unless said.
        highpass: frequency in Hz, or {freq, corners, zerophase}: Butterworth, 4 corners, zero phase unless said
            (run forward and back, so that the order doubles and the gain at the corner is 1/2).
        lowpass: the same.
        bandpass: [freqmin, freqmax] in Hz, or {freqmin, freqmax, corners, zerophase}.
        resample: {dt, method}, method one of `lanczos` (20 samples to each side), `fourier` (periodic,
            band-limited), `linear`, `weighted_average_slopes` (a cubic without overshoot).  Downsampling without
            a low-pass below the new Nyquist frequency is warned of.
        g: turns PGV of a motion in g into m/s, in the sentences only [m/s²].

    Returns:
        the new motion, one sentence per step appended to `processing`, e.g.
        "highpass 0.1 Hz, 4 corners, zero phase: PGA 0.313 -> 0.305 g, PGV 0.298 -> 0.293 m/s".

    Raises:
        OptionError: an option that cannot be, naming the key and what was expected.
    """
    with np.errstate(all="ignore"):  # what overflows is found as values that are not finite
        return _processed(motion, window, detrend, taper, highpass, lowpass, bandpass, resample, g)


def _processed(
    motion: Motion,
    window: Any,
    detrend: str | None,
    taper: Any,
    highpass: Any,
    lowpass: Any,
    bandpass: Any,
    resample: Any,
    g: float,
) -> Motion:
    asked = {"highpass": highpass, "lowpass": lowpass, "bandpass": bandpass}
    now = motion
    if window is not None:
        now = _windowed(now, window, g)
    if detrend is not None:
        now = _detrended(now, detrend, g)
    if taper is not None:
        fraction, shape = options.taper_options(taper, now.name)
        trace = _trace(now)
        trace.taper(max_percentage=fraction, type=shape)
        step = f"taper {fraction:g} of the length at each end, {shape}"
        if fraction * len(now.values) < 1.0:
            step += f" ({len(now.values)} samples): not one sample, nothing done"
            warning = f"`taper` {fraction:g} of {len(now.values)} samples is not one: nothing is tapered"
            now = dataclasses.replace(now, warnings=(*now.warnings, warning))
        now = _after(now, trace.data, now.dt, step, g)
    for key, value in asked.items():
        if value is not None:
            now = _filtered(now, key, value, g)
    if resample is not None:
        now = _resampled(now, resample, tuple(_cutoffs(asked)), g)
    return now


def _trace(motion: Motion) -> Any:
    from obspy import Trace

    return Trace(data=np.array(motion.values, dtype=np.float64), header={"delta": motion.dt})


def _after(motion: Motion, values: NDArray[np.float64], dt: float, step: str, g: float) -> Motion:
    """The motion with new values and a sentence about them."""
    if not np.isfinite(values).all():
        key = step.split()[0]
        raise OptionError(key, f"{step} leaves values that are not finite; it does not suit this record", motion.name)
    after = dataclasses.replace(motion, values=np.ascontiguousarray(values, dtype=np.float64), dt=dt)
    sentence = (
        f"{step}: PGA {pga(motion.values):.4g} -> {pga(after.values):.4g} {motion.units}, "
        f"PGV {pgv(motion.acceleration(g), motion.dt):.4g} -> {pgv(after.acceleration(g), dt):.4g} m/s"
    )
    return dataclasses.replace(after, processing=(*motion.processing, sentence))


def _windowed(motion: Motion, window: Any, g: float) -> Motion:
    t1, t2 = options.window_options(window, motion.duration, motion.dt, motion.name)
    first, last = (math.floor(t / motion.dt + 0.5) for t in (t1, t2))  # ObsPy's `trim` knows times to a microsecond
    motion = dataclasses.replace(motion, header=motion.header_from(round(first * motion.dt, 9)))
    kept = motion.values[first : last + 1]
    return _after(motion, kept, motion.dt, f"window {t1:g} to {t2:g} s ({len(kept)} samples)", g)


def _detrended(motion: Motion, detrend: Any, g: float) -> Motion:
    if not isinstance(detrend, str) or detrend not in options.DETRENDS:
        raise OptionError(
            "detrend", f"`detrend` is {detrend!r}; expected one of {', '.join(options.DETRENDS)}", motion.name
        )
    trace = _trace(motion)
    trace.detrend(options.DETRENDS[detrend])
    return _after(motion, trace.data, motion.dt, f"detrend {detrend}", g)


def _filtered(motion: Motion, key: str, value: Any, g: float) -> Motion:
    settings = options.filter_options(key, value, motion.dt, motion.name)
    trace = _trace(motion)
    trace.filter(key, **settings)
    band = " to ".join(f"{settings[name]:g}" for name in options.SIDE[key])
    phase = "zero phase" if settings["zerophase"] else "causal"
    after = _after(motion, trace.data, motion.dt, f"{key} {band} Hz, {settings['corners']} corners, {phase}", g)
    lowest = settings[options.SIDE[key][0]]
    if key == "lowpass" or lowest * motion.duration >= 1.0:
        return after
    warning = (
        f"`{key}` from {lowest:g} Hz on, a period of {1.0 / lowest:.4g} s, of a record of {motion.duration:.4g} s: "
        "what drifts over the record is not all removed"
    )
    return dataclasses.replace(after, warnings=(*after.warnings, warning))


def _cutoffs(asked: dict[str, Any]) -> Iterator[float]:
    """Upper cut-off frequencies of the filters that were run [Hz]."""
    for key, value in asked.items():
        if value is not None and key != "highpass":
            yield float(options.filter_options(key, value, 1e-9, "")[options.SIDE[key][-1]])


def _resampled(motion: Motion, resample: Any, cutoffs: tuple[float, ...], g: float) -> Motion:
    dt, method = options.resample_options(resample, motion.duration, motion.name)
    values = _fourier(motion, dt) if method == "fourier" else _interpolated(motion, dt, method)
    step = f"resample from dt {motion.dt:g} to {dt:g} s, {method}"
    after = _after(motion, values, dt, step, g)
    nyquist = 0.5 / dt
    if dt <= motion.dt or any(cutoff <= nyquist for cutoff in cutoffs):
        return after
    warning = (
        f"resampled to {dt:g} s without a low-pass below the new Nyquist frequency, {nyquist:g} Hz: what lies above "
        "appears as lower frequencies; consider `lowpass`"
    )
    return dataclasses.replace(after, warnings=(*after.warnings, warning))


def _interpolated(motion: Motion, dt: float, method: str) -> NDArray[np.float64]:
    """Values at 0, dt, 2 dt, ... up to the last sample, which is taken over where a new time falls on it.

    (Left to itself, ObsPy refuses that time when rounding puts it behind the last sample.)
    """
    trace = _trace(motion)
    steps = motion.duration / dt
    npts = int(steps) + 1
    on_last = abs(steps - round(steps)) < 1e-6
    if on_last:
        npts = round(steps)
    settings: dict[str, Any] = {"a": LANCZOS_WIDTH} if method == "lanczos" else {}
    trace.interpolate(sampling_rate=1.0 / dt, method=method, npts=npts, **settings)
    return np.append(trace.data, motion.values[-1:] if on_last else [])


def _fourier(motion: Motion, dt: float) -> NDArray[np.float64]:
    """Band-limited interpolation of the motion continued periodically.

    Not ObsPy's `resample`: above the old Nyquist frequency it continues the last spectral value instead of
    zero, and a length that is no whole number of new steps stretches the motion in time.
    """
    old = len(motion.values)
    exact = old * motion.dt / dt
    new = round(exact)
    if abs(exact - new) > 1e-6 * exact or new < 2:
        raise OptionError(
            "resample",
            f"`resample` by fourier needs a length, {old} x {motion.dt:g} s, that is a whole number of new steps of "
            f"{dt:g} s; choose `window` so that it is, or method lanczos",
            motion.name,
        )
    spectrum = np.fft.rfft(motion.values)
    if new > old and old % 2 == 0:
        spectrum[-1] *= 0.5  # the old Nyquist frequency becomes a pair
    elif new < old and new % 2 == 0:
        spectrum[new // 2] *= 2.0  # a pair becomes the new one
    return np.asarray(np.fft.irfft(spectrum, new) * (new / old))
