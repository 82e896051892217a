"""The deformable column of the flexible model, and what it stands on (the thesis's chapter 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.constants import ELEMENTS

Array = NDArray[np.float64]

ACROSS = 4
"""Elements across the width of a full mesh where a study gives none."""


@dataclass(frozen=True, eq=False)
class Column:
    """A prismatic column of full height 2h and base width 2b, per unit depth.

    Attributes:
        E: modulus of elasticity, (n,) [Pa].
        rho: mass density, (n,) [kg/m³].
        zeta: damping ratio of the first clamped mode, stiffness-proportional, (n,).
        elements: elements along the height; a tag, the same for all cases of a batch; 0 = as many as make the
            elements of a full mesh square.
        mass: `consistent` or `lumped`.
        across: elements across the width of a full mesh; a tag.
    """

    E: Array
    rho: Array
    zeta: Array
    elements: int = ELEMENTS
    mass: str = "consistent"
    across: int = ACROSS


@dataclass(frozen=True, eq=False)
class Base:
    """What the column stands on.

    Attributes:
        law: `rigid` (the thesis's all-or-nothing moment) or `winkler` (a no-tension elastic base).
        kw: stiffness of the Winkler base, (n,) [N/m³]; NaN for `rigid`.
        fibres: number of fibres of a discrete base (finite-element backends); None = their default.
    """

    law: str
    kw: Array
    fibres: int | None = None
