"""What became of the members of a suite: by the share of their runs that overturn, never by dropping one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.response import UNRESOLVED, overturned
from rockcli.scene.variables import PEAK, SCALARS
from rockcli.storage.contents import Contents

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Members:
    """What became of every case, over the axes.

    Attributes:
        share: of its runs that overturn, 0 or 1 where that is certain, NaN without an answer.
        scalars: what else is saved of the cases, by name.
    """

    share: Array
    scalars: Mapping[str, Array] = field(default_factory=dict)

    @property
    def answered(self) -> Mask:
        """Whether there is an answer."""
        return ~np.isnan(self.share)

    @property
    def divided(self) -> Mask:
        """Whether some runs overturn and some do not."""
        return (self.share > 0.0) & (self.share < 1.0)

    def values(self, scalar: Array) -> Array:
        """A scalar of the members, inf where at least half of the runs overturn, NaN where it is not known."""
        return np.where(self.share >= 0.5, np.inf, np.where(self.answered & ~self.divided, scalar, np.nan))


def members_of(contents: Contents) -> Members:
    """What became of every case, by its share, its outcome, or its peak, whichever is saved."""
    if "outcome" in contents.fields:
        flags = contents.values("outcome")
        share = np.where(flags > UNRESOLVED, overturned(flags).astype(float), np.nan)
    elif "overturn_share" in contents.fields:
        share = np.full(contents.shape, np.nan)
    else:
        peak = contents.values(PEAK)
        share = np.where(np.isnan(peak), np.nan, np.isposinf(peak).astype(float))
    if "overturn_share" in contents.fields:
        known = contents.values("overturn_share")
        share = np.where(np.isnan(known), share, known)
    return Members(share, {name: contents.values(name) for name in SCALARS if name in contents.fields})
