"""The worst direction of two horizontal components: which angle of a study's axis rocks a body most."""

from __future__ import annotations

import numpy as np

from rockcli.scene.variables import PEAK
from rockcli.storage.contents import Contents, variable_field
from rockcli.study.study import Study

WORST: tuple[str, ...] = ("angle_worst", "theta_peak_over_alpha_worst")
"""What a study with an axis over the angle has, over its other axes."""


def angle_axis(study: Study) -> str | None:
    """Name of the axis over the direction of the motion; None without one of numbers, or where no peaks are saved."""
    turned = [axis for axis in study.axes if axis.path.removeprefix("case.") == "motion.record.angle"]
    named = [axis.name for axis in turned if axis.numeric]
    return named[0] if named and PEAK in study.scalars and study.search is None else None


def with_worst_direction(contents: Contents, study: Study) -> Contents:
    """Add the angle of the largest peak and that peak, over the other axes.

    Overturning is the largest peak there is, and the first angle that overturns the worst.  NaN where an angle has no
    answer and none overturns: the worst is then not known; no angle is the worst where none uplifts the body.
    """
    axis = angle_axis(study)
    if axis is None:
        return contents
    at = contents.axes.index(axis)
    peaks = contents.values(PEAK)
    overturned = np.isposinf(peaks).any(axis=at)
    known = overturned | ~np.isnan(peaks).any(axis=at)
    first = np.argmax(np.where(np.isnan(peaks), -1.0, peaks), axis=at)
    largest = np.take_along_axis(peaks, np.expand_dims(first, at), axis=at).squeeze(axis=at)
    angles = np.where(largest == 0.0, np.nan, contents.values(axis)[first])
    dims = tuple(name for name in contents.axes if name != axis)
    found = {"angle_worst": angles, "theta_peak_over_alpha_worst": largest}
    fields = {name: variable_field(name, dims, np.where(known, values, np.nan)) for name, values in found.items()}
    return Contents(contents.axes, contents.fields | fields, contents.attrs)
