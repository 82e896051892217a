"""The reliability diagram: what share overturned of the runs that were given a probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from rockcli.plotting.common.style import BODY_EDGE, BODY_FACE, COLOURS, QUIET, RC, SINGLE, headline, new_figure


@dataclass(frozen=True)
class Point:
    """Runs of similar probability: their mean, the share that overturned, its limits, how many."""

    p: float
    share: float
    low: float
    high: float
    n: int


def figure(points: Sequence[Point], title: str, note: str) -> Figure:
    """Shares with their limits over the probabilities, the diagonal of a perfect one, and how many runs there are."""
    with mpl.rc_context(RC):
        drawn = new_figure(SINGLE, SINGLE * 1.2)
        above, below = drawn.subplots(2, 1, sharex=True, height_ratios=[4, 1])
        p, share, n = (np.array([getattr(point, name) for point in points]) for name in ("p", "share", "n"))
        low = share - np.array([point.low for point in points])
        high = np.array([point.high for point in points]) - share
        above.plot([0.0, 1.0], [0.0, 1.0], color=QUIET, linewidth=0.7)
        above.errorbar(p, share, yerr=[low, high], fmt="o", color=COLOURS[0], markersize=3.5, linewidth=0.8, capsize=2)
        above.set_xlim(-0.02, 1.02)
        above.set_ylim(-0.02, 1.02)
        above.set_ylabel("share that overturned")
        below.bar(p, n, width=0.06, color=BODY_FACE, edgecolor=BODY_EDGE, linewidth=0.5)
        below.set_ylabel("runs")
        below.set_xlabel("predicted probability of overturning")
        headline(drawn, title, note)
    return drawn
