"""`Batch`, the input of every solver: fully resolved cases as arrays; a `Response` comes out.

Cases of one batch share every tag (model, geometry, damping scheme, kinds of motion, numerics) and differ
only in numbers, which are arrays over the cases.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.block import Block
from rockcli.scene.body.column import Base, Column
from rockcli.scene.ground.excitation import Channel, Excitation, Samples
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.repeated import is_repeated, repeated

Array = NDArray[np.float64]
T = TypeVar("T")


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
        g: (n,) [m/s²].
        theta_0, theta_dot_0: initial rotation [rad] and rate [rad/s], (n,).
        save: what is wanted back.
        warnings: sentences about the physics of these cases, for people.
        column: of the flexible model, else None.  base: what the body stands on; None = rigid.
        slide_rate_0: initial velocity along the ground, (n,) [m/s]; None = none.
        tolerance: error of theta_peak/alpha allowed to model auto, (n,); None for all others.
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
    tolerance: Array | None = None
    slide_rate_0: Array | None = None

    @property
    def size(self) -> int:
        """Number of cases."""
        return len(self.g)

    @cached_property
    def p(self) -> Array:
        """Frequency parameter of each edge, (n, 2) [rad/s]."""
        return self.block.p(self.g)

    def rows(self, at: NDArray[np.int64]) -> Batch:
        """Some of the cases, by their places (k,)."""
        motion = self.excitation
        return replace(
            self,
            g=self.g[at],
            block=_taken(self.block, at),
            excitation=Excitation(
                horizontal=_channel(motion.horizontal, at, self.size),
                vertical=_channel(motion.vertical, at, self.size),
                duration=motion.duration[at],
                suite=None if motion.suite is None else _taken(motion.suite, at),
            ),
            theta_0=self.theta_0[at],
            theta_dot_0=self.theta_dot_0[at],
            damping=_taken(self.damping, at),
            column=None if self.column is None else _taken(self.column, at),
            base=None if self.base is None else _taken(self.base, at),
            tolerance=None if self.tolerance is None else self.tolerance[at],
            slide_rate_0=None if self.slide_rate_0 is None else self.slide_rate_0[at],
        )

    def apart(self) -> Iterator[tuple[NDArray[np.int64], Batch]]:
        """The cases of a suite by their motions: places, and a batch as those of one motion have it."""
        assert self.excitation.suite is not None
        for record, rows in self.excitation.suite.cases():
            yield rows, self.rows(rows).under(record)

    def under(self, record: Samples) -> Batch:
        """These cases of a suite, all of which have this motion."""
        motion = self.excitation
        assert motion.suite is not None
        one = replace(record, factor=motion.suite.factor)
        return replace(self, excitation=Excitation(one, motion.vertical, motion.duration))


def _taken(value: T, at: NDArray[np.int64]) -> T:
    """A frozen value whose arrays are all over the cases, for some of them."""
    arrays = {f.name: getattr(value, f.name) for f in fields(value)}  # type: ignore[arg-type]
    changed: dict[str, Any] = {name: _at(of, at) for name, of in arrays.items() if isinstance(of, np.ndarray)}
    return replace(value, **changed)  # type: ignore[type-var]


def _at(of: Array, at: NDArray[np.int64]) -> Array:
    """Rows of an array; one row that stands for all of them is not copied out."""
    return repeated(of[:1], len(at)) if is_repeated(of) else of[at]


def _channel(channel: Channel | None, at: NDArray[np.int64], n: int) -> Channel | None:
    if isinstance(channel, Samples):
        factor = np.broadcast_to(channel.factor, n)[at]
        return replace(channel, factor=factor, ground=_channel(channel.ground, at, n))
    return None if channel is None else _taken(channel, at)
