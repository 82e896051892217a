"""A measured rocking motion, and what was fitted to it."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rockcli.plotting.common.style import COLOURS, DOUBLE, QUIET, RC, headline, legend_below, new_figure

Array = NDArray[np.float64]

_FEW = 60
"""Points up to which each is marked."""


def figure(along: Array, head: str, measured: Array, fitted: Array, title: str) -> Figure:
    """Both over one another, and the residuals below.

    Args:
        along: times or numbers of swings, (n,); head: what they are, with the unit.
        measured, fitted: rotations, (n,) [rad].
        title: of the figure.
    """
    with mpl.rc_context(RC):
        drawn = new_figure(DOUBLE, 0.55 * DOUBLE)
        above, below = drawn.subplots(2, 1, sharex=True, height_ratios=[3, 1])
        few = len(along) < _FEW
        above.plot(along, measured, "o" if few else "-", color=QUIET, linewidth=1.8, label="measured", markersize=4.0)
        above.plot(along, fitted, color=COLOURS[0], linewidth=0.9, label="fitted")
        below.plot(along, measured - fitted, "o" if few else "-", color=COLOURS[1], linewidth=0.7, markersize=3.0)
        for axes, words in ((above, r"$\theta$ [rad]"), (below, "residual [rad]")):
            axes.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
            axes.set_ylabel(words)
        below.set_xlabel(head)
        if not few:
            below.set_xlim(along[0], along[-1])
        drawn.align_ylabels()
        scatter = float(np.sqrt(np.mean((measured - fitted) ** 2)))
        headline(drawn, title, f"{len(along)} points, residuals {scatter:.3g} rad (root mean square)")
        legend_below(drawn, above.get_legend_handles_labels()[0])
    return drawn
