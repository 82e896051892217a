"""Response spectra of records, drawn over one another."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

from rockcli.plotting.common.labels import escape
from rockcli.plotting.common.style import (
    COLOURS,
    LINES,
    MOST_CURVES,
    RC,
    SINGLE,
    headline,
    legend_below,
    new_figure,
    save,
)
from rockcli.plotting.kinds.map import scale_axes


def draw(
    path: Path, periods: NDArray[np.float64], spectra: Sequence[tuple[str, NDArray[np.float64]]], title: str
) -> None:
    """Write a figure.

    Args:
        path: its file, .png, .pdf or .svg.
        periods: (m,) [s].
        spectra: names and pseudo-accelerations over g, (m,) each; more than can be told apart are grey, with a median.
        title: of the figure.
    """
    with mpl.rc_context(RC):
        figure = new_figure(SINGLE * 1.3, SINGLE * 1.1)
        axes = figure.subplots()
        many = len(spectra) > MOST_CURVES
        shown = []
        for i, (name, values) in enumerate(spectra):
            style: dict[str, Any] = {"color": "0.7", "linewidth": 0.6}
            if not many:
                style = {"color": COLOURS[i], "linestyle": LINES[i % len(LINES)], "label": _label(name)}
            shown += axes.plot(periods, values, **style)
        if many:
            with np.errstate(divide="ignore"):  # of a record that is zero throughout
                median = np.exp(np.median(np.log([values for _, values in spectra]), axis=0))
            shown = axes.plot(periods, median, color=COLOURS[0], linewidth=1.8, label=f"median of {len(spectra)}")
        scale_axes(axes, True, any((values > 0.0).any() for _, values in spectra))
        axes.set_xlim(periods[0], periods[-1])
        axes.set_xlabel("period [s]")
        axes.set_ylabel(r"$S_a$(5 %) [g]")
        legend_below(figure, shown, 2)
        headline(figure, title)
        save(figure, path)


def _label(name: str) -> str:
    """A name in a legend, which leaves out what begins with an underscore and reads dollars as mathematics."""
    return escape(f" {name}" if name.startswith("_") else name)
