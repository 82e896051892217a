"""What a record does not tell: the same motion with half of its samples, and with what lies between them filled in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rockcli.scene.ground.excitation import Channel, Excitation, Samples


def every_second(motion: Samples) -> Samples:
    """Every second sample, the first included, linear between; no filter, so that what is left is what was recorded.

    A last sample of odd number is lost.  Linear interpolation errs with dt^2, so for a motion smooth between its
    samples an answer changes by about three times what the samples that were never taken leave open.
    """
    return replace(motion, values=motion.values[::2], dt=2.0 * motion.dt)


def band_limited(motion: Samples) -> Samples:
    """Twice the samples: those between are of the motion that has no frequency above the record's own limit 1/(2 dt).

    By its Fourier series over the record (periodic beyond it); the recorded samples stay as they are.
    """
    n = len(motion.values)
    spectrum = np.fft.rfft(motion.values)
    if n % 2 == 0:
        spectrum[-1] *= 0.5  # at the limit itself: shared by +f and -f
    values = 2.0 * np.fft.irfft(spectrum, 2 * n)[: 2 * n - 1]
    values[::2] = motion.values
    return replace(motion, values=values, dt=0.5 * motion.dt)


SAMPLINGS: dict[str, Callable[[Samples], Samples]] = {"every 2nd sample": every_second, "band-limited": band_limited}
"""Other samplings of a record, by what they do."""


def resampled(excitation: Excitation, how: str) -> Excitation:
    """An excitation whose records are sampled otherwise (a key of `SAMPLINGS`); pulses have no samples."""

    def of(channel: Channel | None) -> Channel | None:
        return SAMPLINGS[how](channel) if isinstance(channel, Samples) else channel

    return replace(excitation, horizontal=of(excitation.horizontal), vertical=of(excitation.vertical))


def has_samples(excitation: Excitation) -> bool:
    """Whether a component is a record."""
    return any(isinstance(channel, Samples) for channel in (excitation.horizontal, excitation.vertical))


def through_floors(excitation: Excitation) -> bool:
    """Whether a component is what arrives through floors, whose samples are closer than those of the record."""
    channels = (excitation.horizontal, excitation.vertical)
    return any(isinstance(channel, Samples) and channel.ground is not None for channel in channels)
