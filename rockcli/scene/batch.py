"""The solver contract: a batch of fully resolved cases in, a response out.

Cases of one batch share every tag (model, geometry, damping scheme, kinds of motion, numerics) and differ
only in numbers, which are arrays over the cases.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.block import Block
from rockcli.scene.column import Base, Column
from rockcli.scene.damping import Damping
from rockcli.scene.excitation import Excitation
from rockcli.scene.numerics import Numerics

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Save:
    """What a solver has to return.

    Attributes:
        histories: theta(t) and what goes with it, and the impacts.
        dt_out: spacing of the output times i dt_out [s]; used when `histories`.
        scalars: names of the scalars wanted; a solver may stop as soon as they are known.
    """

    histories: bool
    dt_out: float
    scalars: frozenset[str]


@dataclass(frozen=True, eq=False)
class Batch:
    """`size` cases that differ only in numbers.

    Attributes:
        g: (n,) [m/s^2].
        theta_0, theta_dot_0: initial rotation [rad] and rate [rad/s], (n,).
        save: what is wanted back.
        warnings: sentences about the physics of these cases, for people.
        column: of the flexible model, else None.  base: what the body stands on; None = rigid.
    """

    g: Array
    block: Block
    excitation: Excitation
    theta_0: Array
    theta_dot_0: Array
    model: str
    geometry: str | None
    damping: Damping
    numerics: Numerics
    save: Save
    warnings: tuple[str, ...] = field(default=())
    column: Column | None = None
    base: Base | None = None

    @property
    def size(self) -> int:
        """Number of cases."""
        return len(self.g)

    @property
    def p(self) -> Array:
        """Frequency parameter of each edge, (n, 2) [rad/s]."""
        return self.block.p(self.g)
