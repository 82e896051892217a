"""Animates one case of a dataset file, from the file alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rockcli.errors import StudyError
from rockcli.storage.atomic import replacing
from rockcli.storage.places import check_file
from rockcli.storage.read import open_dataset

if TYPE_CHECKING:
    import xarray

DEFAULT = "animation.gif"

FASTEST = 50.0
"""Pictures a second that are not too many."""


@dataclass(frozen=True)
class Animation:
    """What was made: the file, the case it shows, its pictures, its length [s], what it leaves out."""

    path: Path
    case: str
    pictures: int
    length: float
    notes: tuple[str, ...]


def animate(
    path: Path,
    out: Path | None = None,
    *,
    case: int | None = None,
    at: Mapping[str, str] | None = None,
    speed: float = 1.0,
    fps: float = 25.0,
    magnify: float = 1.0,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Animation:
    """Animate one case of a dataset file.

    Args:
        path: the dataset, with histories.
        out: the animation, .gif or .mp4; None: `DEFAULT` beside the dataset.
        case: number of the case, from 1, in the order of the axes, the last of them fastest.
        at: axis, by its name, its path or the end of that -> value; the first case that agrees is shown.
        speed: seconds of the response in a second of animation.
        fps: pictures a second.
        magnify: factor on the bending of a flexible column.
        start, end: part of the response [s]; None: what is worth showing, see `plotting.kinds.animate.scenes`.
        progress: called with (pictures done, pictures in all).

    Raises:
        StudyError: the file has no histories, there is no such case, or an option is out of range.
    """
    from rockcli.plotting.common.video import check_output, interval, write
    from rockcli.plotting.kinds import animate as stage

    target = path.parent / DEFAULT if out is None else out
    check_output(target)
    check_file(target)
    for name, value, most in (("speed", speed, np.inf), ("fps", fps, FASTEST), ("magnify", magnify, np.inf)):
        if not (np.isfinite(value) and 0.0 < value <= most):
            raise StudyError(
                f"--{name} {value:g}: expected a positive number" + f" up to {most:g}" * bool(most < np.inf)
            )
    dataset = open_dataset(path)
    complaint = stage.why_still(dataset)
    if complaint:
        raise StudyError(complaint, file=path)
    position, label, others = _chosen(dataset, case, dict(at or {}), path)
    step = interval(target, fps)
    shown = stage.scenes(dataset, position, step=step, speed=speed, magnify=magnify, start=start, end=end)
    with replacing(target) as scratch:
        write(scratch, stage.pictures(dataset, position, shown, label), len(shown.times), step, progress)
    notes = tuple(filter(None, (others, shown.note)))
    return Animation(target, label, len(shown.times), step * len(shown.times), notes)


def _chosen(
    dataset: xarray.Dataset, case: int | None, at: dict[str, str], path: Path
) -> tuple[tuple[int, ...], str, str]:
    """Position of the case to show, its name, and a sentence if nobody chose among several."""
    from rockcli.plotting.common.cases import axes_of
    from rockcli.plotting.common.labels import coordinate_label
    from rockcli.plotting.common.selection import axis_called, choices, place_on

    axes = axes_of(dataset)
    sizes = tuple(int(dataset.sizes[axis]) for axis in axes)
    total = int(np.prod(sizes))
    places: dict[str, int] = {}
    try:
        for said, value in at.items():
            axis = axis_called(dataset, said)
            if axis in places:
                raise StudyError(f"select {said}: {axis} is chosen twice")
            places[axis] = place_on(dataset, axis, value)
    except StudyError as error:
        raise StudyError(f"--at {error.message.removeprefix('select ')}", file=path) from None
    if case is not None:
        if at:
            raise StudyError("--case and --at both choose the case: give one of them")
        if not 1 <= case <= total:
            raise StudyError(f"--case {case}: there are cases 1 to {total}", file=path)
        position = tuple(int(i) for i in np.unravel_index(case - 1, sizes)) if axes else ()
    else:
        position = tuple(places.get(axis, 0) for axis in axes)
    open_axes = [axis for axis, n in zip(axes, sizes, strict=True) if n > 1 and axis not in places]
    label = ", ".join(coordinate_label(dataset, a, i) for a, i, n in zip(axes, position, sizes, strict=True) if n > 1)
    others = ""
    if case is None and open_axes:
        values = (f"{axis} ({', '.join(choices(dataset, axis, 8))})" for axis in open_axes)
        others = f"shows the first of several cases; --at chooses: {'; '.join(values)}"
    return position, label, others
