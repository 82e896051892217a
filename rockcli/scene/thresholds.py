"""What a search for overturning found, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FOUND = "_overturning"
"""End of the name of what a search found, after that of the axis searched."""

WHY_NOT = "the first point overturns already, or one on the way has no answer"
"""What a threshold that is NaN may mean."""


def threshold_words(values: NDArray[np.float64], axes: Mapping[str, NDArray[Any]]) -> str:
    """The lowest and the highest threshold, where they are, and how many cases have none.

    Args:
        values: thresholds over the axes, inf where nothing overturns, NaN where that cannot be said (WHY_NOT).
        axes: name -> coordinates, outermost first.
    """

    def at(flat: int) -> str:
        place = np.unravel_index(flat, values.shape)
        words = [
            f"{name}={x[i]}" if x.dtype.kind in "OUT" else f"{name}={x[i]:.6g}"
            for (name, x), i in zip(axes.items(), place, strict=True)
        ]
        return f" ({', '.join(words)})" if words else ""

    found = np.flatnonzero(np.isfinite(values))
    said = []
    if found.size:
        order = np.argsort(values.flat[found], kind="stable")
        low, high = int(found[order[0]]), int(found[order[-1]])
        to = f" to {values.flat[high]:.6g}{at(high)}" if high != low else ""
        said.append(f"from {values.flat[low]:.6g}{at(low)}{to} on")
    for which, words, why in ((np.isinf(values), "not at all", ""), (np.isnan(values), "not found", f": {WHY_NOT}")):
        if count := int(which.sum()):
            said.append((words if count == values.size else f"{words} in {count} of {values.size} cases") + why)
    return "; ".join(said)
