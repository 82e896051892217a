"""From which peak of its motion on a body lifts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.analysis.measures import peaks_of_both_signs
from rockcli.scene.auto import highest
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import MODELS
from rockcli.scene.repeated import repeated

Array = NDArray[np.float64]


def lifts_at(batch: Batch, *, slides: bool = False) -> Array:
    """Peak horizontal acceleration at and below which the body of every case does not lift, (n,) [m/s^2].

    If `slides`, at and below which it does not slip either, which friction may allow before.

    NaN where that is not known: bodies that move at t = 0, vertical motion, deformable bodies, FEMA-356 on a spectrum.
    """
    batch = highest(batch)  # of model auto
    found = np.full(batch.size, np.nan)
    row = MODELS.get((batch.model, batch.geometry))
    if row is None or batch.excitation.vertical is not None or batch.base is not None:
        return found
    if batch.excitation.suite is not None:
        for rows, part in batch.apart():
            found[rows] = lifts_at(part, slides=slides)
        return found
    still = (batch.theta_0 == 0.0) & (batch.theta_dot_0 == 0.0)
    still &= True if batch.slide_rate_0 is None else batch.slide_rate_0 == 0.0
    threshold = _threshold(batch)
    if slides:
        threshold = np.fmin(threshold, batch.block.mu)
    return np.where(still, batch.g * threshold, np.nan)


def factor_of(batch: Batch) -> Array:
    """By what the PGA that lifts the body of every case differs from g tan(alpha), as FEMA-356 takes it, (n,).

    NaN where the procedure asks a spectrum.
    """
    scheme = batch.damping.fema356
    if scheme is None:
        return repeated(np.ones(1), batch.size)
    return np.where(np.isnan(scheme.fixed_base_period) & (scheme.spectrum is None), scheme.W_over_Mg, np.nan)


def _threshold(batch: Batch) -> Array:
    """Peak acceleration over g at which the motion of every case, scaled, lifts the body about one of its edges, (n,).

    Of two unequal edges each is reached by the motion towards one side alone.
    """
    alpha = batch.block.alpha
    if batch.damping.fema356 is not None:  # its own threshold, of the weaker edge
        return factor_of(batch) * batch.block.of_weak_edge(batch.block.tan_alpha)
    left, right = MODELS[(batch.model, batch.geometry)].law(alpha, np.tan(alpha)).threshold.T
    nearer = np.minimum(left, right)
    motion = batch.excitation.horizontal
    if motion is None or (left == right).all():
        return np.asarray(nearer)
    # a_g > 0 lifts the body about its left edge
    to_left, to_right = peaks_of_both_signs(motion, batch.size, batch.excitation.duration).T
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.maximum(to_left, to_right) / np.maximum(to_left / left, to_right / right)
    return np.asarray(np.where((left == right) | ~np.isfinite(first), nearer, first))
