"""What the column stands on: a yielding spring, the law of a no-tension elastic base, or fibres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.errors import SolverError
from rockcli.kernels.frame import layout as at
from rockcli.scene.backends import unfit_base
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT
from rockcli.scene.constants import FIBRES

Array = NDArray[np.float64]


def kind_of_base(batch: Batch) -> float:
    """Kind of base of a batch; `SolverError` where model, base and damping do not go together."""
    if why := unfit_base(batch):
        raise SolverError(why)
    base = batch.base
    if base is None or base.law == "rigid":
        return at.SOFTENING if batch.geometry == "negative_stiffness" else at.PLASTIC
    if not (batch.damping.scheme == "hht" or base.fibres is not None):
        return at.WINKLER
    return at.FIBRES


def fibres(b: float, kw: float, n: int, *, place: str = "corners") -> Array:
    """Places x [m] and stiffnesses [N/m] of n >= 2 fibres under a base from -b to b, (n, 2), of total stiffness 2 b kw.

    `corners`: evenly from corner to corner, the two at the corners half as stiff.
    `middles`: in the middles of n equal parts; the pivot is then at b (1 - 1/n).
    """
    if place == "middles":
        x = b * ((2.0 * np.arange(n) + 1.0) / n - 1.0)
        return np.column_stack([x, np.full(n, 2.0 * b * kw / n)])
    share = np.full(n, 2.0 * b * kw / (n - 1))
    share[[0, -1]] *= 0.5
    return np.column_stack([np.linspace(-b, b, n), share])


def fibres_of(batch: Batch, case: int) -> Array:
    """Fibres of one case, (k, 2), none for the other kinds of base."""
    if batch.base is None or kind_of_base(batch) != at.FIBRES:
        return np.zeros((0, 2))
    number = batch.base.fibres or FIBRES
    return fibres(float(batch.block.b[case, LEFT]), float(batch.base.kw[case]), number)
