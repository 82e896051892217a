"""Intensities of a suite's motions: what fragility is told against, and where the body begins to move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.measures import peaks
from rockcli.analysis.uplift import lifts_at
from rockcli.motion.spectrum import forcing, pseudo_acceleration
from rockcli.scene.batch import Batch
from rockcli.scene.ground.excitation import Channel, Samples
from rockcli.scene.variables import VARIABLES
from rockcli.storage.contents import Contents
from rockcli.study.cases.buildable import by_motion
from rockcli.study.intensity import GROUND, bare, period_of
from rockcli.study.study import Study

Array = NDArray[np.float64]


def unit_of(name: str, contents: Contents) -> str:
    """Unit of an intensity."""
    if period_of(name) is not None:
        return "m s-2"
    if name == "pgv_over_pga":
        return "s"
    name = bare(name)
    item = contents.fields[name]
    return str(item.attrs.get("units", VARIABLES[name].unit if name in VARIABLES else "1"))


def values_of(name: str, contents: Contents, study: Study) -> Array | None:
    """An intensity of every case, over the axes; None where the dataset does not tell it."""
    of_ground = name.startswith(GROUND)
    if (period := period_of(name)) is not None:
        return _spectral(study, period, of_ground=of_ground).reshape(contents.shape)
    if of_ground:
        return _peak_of_ground(study, bare(name)).reshape(contents.shape)
    if name == "pgv_over_pga":
        pair = [values_of(one, contents, study) for one in ("pgv", "pga")]
        return None if pair[0] is None or pair[1] is None else pair[0] / pair[1]
    item = contents.fields.get(name)
    if item is None or item.values.dtype.kind not in "fiu" or not set(item.dims) <= set(contents.axes):
        return None
    return np.asarray(contents.over_axes(name), dtype=float)


def _motion(batch: Batch, *, of_ground: bool) -> Channel | None:
    """The horizontal motion that the body stands on, or that of the ground below floors and isolators."""
    motion = batch.excitation.horizontal
    below = motion.ground if isinstance(motion, Samples) else None
    return below if of_ground and below is not None else motion


def _peak_of_ground(study: Study, name: str) -> Array:
    """PGA [m/s^2] or PGV [m/s] of the ground of every case, (n,)."""
    found = np.full(study.size, np.nan)
    for indices, batch in by_motion(study.suites, np.arange(study.size)):
        pga, pgv = peaks(_motion(batch, of_ground=True), len(indices), batch.excitation.duration)
        found[indices] = pgv if name == "pgv" else pga
    return found


def _spectral(study: Study, period: float, *, of_ground: bool) -> Array:
    """Pseudo-spectral acceleration at 5 % of the horizontal motion of every case, (n,) [m/s^2]."""
    found = np.full(study.size, np.nan)
    known: dict[tuple[bytes, float, float], float] = {}
    for indices, batch in by_motion(study.suites, np.arange(study.size)):
        motion = _motion(batch, of_ground=of_ground)
        if motion is None:
            continue
        raw = motion.values.tobytes() if isinstance(motion, Samples) else b""
        for i, index in enumerate(indices):
            duration = batch.excitation.duration[i]
            until = np.inf if np.isnan(duration) else float(duration)
            size = 1.0
            if isinstance(motion, Samples):  # of records scaled up and down the spectrum is found once
                size = abs(float(np.broadcast_to(motion.factor, (batch.size,))[i]))
            key = (raw, motion.dt, until) if isinstance(motion, Samples) else None
            if key is None or key not in known or not size > 0.0:
                S_a = float(pseudo_acceleration(forcing(motion, i, until), np.array([period]))[0])
                found[index] = S_a
                if key is not None and size > 0.0:
                    known[key] = S_a / size
            else:
                found[index] = known[key] * size
    return found


def moves_at(study: Study, *, slides: bool) -> Array:
    """Peak horizontal acceleration at and below which the body of every case does not lift, (n,) [m/s^2].

    If `slides`, at and below which it does not slip either, which friction may allow before.  NaN: see `lifts_at`.
    """
    found = np.full(study.size, np.nan)
    for indices, batch in by_motion(study.suites, np.arange(study.size)):
        found[indices] = lifts_at(batch, slides=slides)
    return found
