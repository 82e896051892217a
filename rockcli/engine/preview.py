"""What a study is about to do, without doing it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rockcli.engine.choose import choose
from rockcli.engine.limits import HISTORIES_AT_MOST, histories_size
from rockcli.engine.measures import peaks
from rockcli.errors import SolverError
from rockcli.scene.batch import Batch
from rockcli.scene.excitation import Channel, Pulses, Samples
from rockcli.study.study import Study

Array = NDArray[np.float64]

WARNED_ABOUT = 20_000
"""Cases looked at for warnings."""

STARTING = 0.5
"""Seconds for loading compiled kernels."""

SECONDS_PER_PULSE, SECONDS_PER_SAMPLE = 1e-4, 1e-6
"""Order of magnitude of the work of one case, compiled: a pulse; one sample of a record."""


@dataclass(frozen=True)
class Preview:
    """A study before it is solved.

    Attributes:
        cases: how many; axes: (name, path, points) outermost first.
        block: symbol -> value of the first case, SI units and radians.
        motion: words -> value of the first case: accelerations in g and over g tan(alpha).
        backend: name, or why there is none.
        seconds: estimated time of the solution, order of magnitude; megabytes: of histories, 0 if not saved.
        warnings: about the study and its cases (of a large study, about its first cases).
    """

    name: str
    title: str
    cases: int
    axes: tuple[tuple[str, str, int], ...]
    block: dict[str, float]
    motion: dict[str, float | str]
    backend: str
    seconds: float
    megabytes: float
    warnings: tuple[str, ...]


def preview(study: Study) -> Preview:
    """Look at a study; `StudyError` or `RecordError` if a case cannot be built."""
    with np.errstate(all="ignore"):
        return _preview(study)


def _preview(study: Study) -> Preview:
    _, batch = next(iter(study.batches(np.array([0]))))
    said = [w for _, part in study.batches(np.arange(min(study.size, WARNED_ABOUT))) for w in part.warnings]
    try:
        backend = choose(batch).name
    except SolverError as error:
        backend = str(error)
    return Preview(
        name=study.name,
        title=study.title,
        cases=study.size,
        axes=tuple((axis.name, axis.path, axis.size) for axis in study.axes),
        block=_block(batch),
        motion=_motion(batch),
        backend=backend,
        seconds=STARTING + study.size * _seconds(batch),
        megabytes=histories_size(study, HISTORIES_AT_MOST).bytes / 1e6,
        warnings=tuple(dict.fromkeys((*study.warnings, *said))),
    )


def _block(batch: Batch) -> dict[str, float]:
    block = batch.block
    both = {"R [m]": block.R, "alpha [rad]": block.alpha, "tan alpha": block.tan_alpha, "p [rad/s]": batch.p}
    table = {name: float(block.of_weak_edge(values)[0]) for name, values in both.items()}
    table["height 2h [m]"] = float(2.0 * block.h[0])
    table["width [m]"] = float(block.b[0].sum())
    table["eta"] = float(block.of_weak_edge(batch.damping.eta)[0])
    return table


def _motion(batch: Batch) -> dict[str, float | str]:
    g, tan_alpha = float(batch.g[0]), float(batch.block.of_weak_edge(batch.block.tan_alpha)[0])
    table: dict[str, float | str] = {"uplift at [g]": tan_alpha}
    table |= _channel(batch.excitation.horizontal, batch.excitation.duration, g, tan_alpha, "")
    if batch.excitation.vertical is not None:
        table |= _channel(batch.excitation.vertical, batch.excitation.duration, g, tan_alpha, "vertical ")
    return table


def _channel(
    channel: Channel | None, duration: Array, g: float, tan_alpha: float, which: str
) -> dict[str, float | str]:
    if channel is None:
        return {f"{which}motion": "none (free rocking)"}
    pga, pgv = (float(values[0]) for values in peaks(channel, len(duration), duration))
    what: dict[str, Any] = {f"{which}motion": channel.shape if isinstance(channel, Pulses) else channel.name}
    if isinstance(channel, Pulses):
        what["omega_p [rad/s]"] = float(channel.omega_p[0])
    return what | {
        f"{which}PGA [m/s2]": pga,
        f"{which}PGA [g]": pga / g,
        f"{which}PGA over g tan alpha": pga / (g * tan_alpha),
        f"{which}PGV [m/s]": pgv,
    }


def _seconds(batch: Batch) -> float:
    motion = batch.excitation.horizontal
    return SECONDS_PER_SAMPLE * len(motion.values) if isinstance(motion, Samples) else SECONDS_PER_PULSE
