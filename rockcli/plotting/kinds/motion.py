"""The ground motion: acceleration against time, and the response spectrum of its saved history."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rockcli.motion.spectrum import forcing, pseudo_acceleration
from rockcli.plotting.common.cases import Array, axes_of, positions_on, selection_note
from rockcli.plotting.common.ground import Motion, motions
from rockcli.plotting.common.labels import title_of
from rockcli.plotting.common.style import (
    COLOURS,
    DOUBLE,
    LINES,
    PAIR,
    QUIET,
    headline,
    legend_of,
    new_figure,
    trace_title,
    width_or,
)
from rockcli.scene.ground.excitation import Samples

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

_MOST = 3
"""Motions that are drawn, each above the other."""

_EVERY = 400
"""Cases that are looked through for different motions."""

_PERIODS = np.geomspace(0.05, 10.0, 121)


def without_motion(dataset: xarray.Dataset) -> str:
    """Why a dataset cannot be drawn so; "" if it can."""
    if "a_g" not in dataset.variables:
        return "the dataset holds no histories of the ground (save: {histories: true})"
    return "" if np.nan_to_num(dataset["a_g"].values).any() else "the ground does not move"


def draw(dataset: xarray.Dataset) -> Figure:
    """Left the acceleration of each motion, right the response spectra of all, or below where there is no room."""
    every = positions_on(dataset, axes_of(dataset))[:_EVERY]
    found = [motion for motion in motions(dataset, every) if np.nanmax(np.abs(motion.horizontal), initial=0.0) > 0.0]
    shown = found[:_MOST]
    n = len(shown)
    width = width_or(DOUBLE)
    if width >= PAIR:
        figure = new_figure(width, 1.5 + 0.75 * n)
        grid = figure.add_gridspec(n, 2, width_ratios=(1.7, 1.0))
        right = figure.add_subplot(grid[:, 1])
    else:
        figure = new_figure(width, 2.9 + 1.1 * n)
        grid = figure.add_gridspec(n + 1, 1, height_ratios=(*n * (1.0,), 1.6))
        right = figure.add_subplot(grid[n, 0])
    time = np.asarray(dataset["time"].values, dtype=float)
    first = None
    for number, motion in enumerate(shown):
        left = figure.add_subplot(grid[number, 0], sharex=first, sharey=first)
        first = first or left
        left.plot(time, motion.horizontal, color=COLOURS[number], linewidth=0.6)
        left.axhline(0.0, color=QUIET, linewidth=0.4, zorder=0)
        left.set_ylabel(r"$a_g$ [g]")
        left.tick_params(labelbottom=number == len(shown) - 1)
        words = motion.label or "the ground"
        style = LINES[number % len(LINES)]
        right.plot(_PERIODS, _spectrum(time, motion), color=COLOURS[number], linestyle=style, label=words)
        if len(shown) > 1:
            trace_title(left, words, width * (0.6 if width >= PAIR else 1.0))
    left.set_xlabel("time [s]")
    ends = [float(time[np.flatnonzero(np.nan_to_num(motion.horizontal))[-1]]) for motion in shown]
    left.set_xlim(0.0, min(1.05 * max(ends), float(time[-1])))
    right.set_xscale("log")
    right.set_xlim(_PERIODS[0], _PERIODS[-1])
    right.set_xticks([0.1, 1.0, 10.0], ["0.1", "1", "10"])
    right.set_ylim(bottom=0.0)
    right.set_xlabel("period [s]")
    right.set_ylabel(r"$S_a$, 5 % damping [g]")
    if len(shown) > 1:
        legend_of(figure, right, 3)
    scaled = "in the size of the first case that has it" if any(motion.scaled for motion in shown) else ""
    headline(
        figure, title_of(dataset), "; ".join(filter(None, [selection_note(len(shown), len(found), "motions"), scaled]))
    )
    return figure


def _spectrum(time: Array, motion: Motion) -> Array:
    """Pseudo-acceleration of the history as it is saved, linear between its samples [g]."""
    known = np.flatnonzero(np.isfinite(motion.horizontal))
    a = np.asarray(motion.horizontal[known[0] : known[-1] + 1])
    if len(a) < 2:
        return np.full(len(_PERIODS), np.nan)
    steady = np.arange(len(a)) * float(time[1] - time[0])
    a = np.interp(steady, time[: len(a)] - time[0], a)  # output times are steady, but for the end of the response
    samples = Samples(a, float(time[1] - time[0]), np.ones(1))
    return pseudo_acceleration(forcing(samples), _PERIODS)
