"""Panels of ground acceleration: each motion once, however many cases it moves and however they scale it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.lines import Line2D

from rockcli.plotting.common.cases import Array, axes_of, group_label, number_at, values_at, values_of
from rockcli.plotting.common.labels import lifts_from, two_edged, unit_g
from rockcli.plotting.common.style import COLOURS, DOUBLE, QUIET, trace_title, width_or
from rockcli.scene.variables import MOTION

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

MOST_PANELS = 3
"""Records up to which each has a panel of its own."""

_NEARLY = 0.6
"""Peak over that of uplift from which the latter is marked."""

_SAME = 1e-6
"""Difference of scales up to which they are one."""

_HORIZONTAL, _VERTICAL = "#333333", "#A9A9A9"

Position = tuple[int, ...]


@dataclass
class Motion:
    """A motion of one or several cases, up to scale.

    Attributes:
        cases: the cases it moves, by their number in the figure.
        scales: its size in each, over that of `horizontal`.
        horizontal: [g], of the case in which it lasts longest; vertical: [g], None if there is none.
        label: what distinguishes it from the others of the figure.
        recorded: whether it is a record, not a pulse.
    """

    cases: list[int]
    scales: list[float]
    horizontal: Array
    vertical: Array | None
    label: str = ""
    recorded: bool = False

    @property
    def scaled(self) -> bool:
        """Whether the cases have it in different sizes."""
        return bool(np.ptp(self.scales) > _SAME)


def motions(dataset: xarray.Dataset, positions: list[Position]) -> list[Motion]:
    """The different motions of some cases; none where the ground stands still in all of them."""
    if "a_g" not in dataset.variables:
        return []
    found: dict[float, Motion] = {}
    g = unit_g(dataset)
    for number, position in enumerate(positions):
        a = values_at(dataset, "a_g", position) / g
        v = values_at(dataset, "a_v", position) / g if "a_v" in dataset.variables else None
        v = v if v is not None and np.nanmax(np.abs(v), initial=0.0) > 0.0 else None
        said = number_at(dataset, MOTION, position)
        which = said if np.isfinite(said) else -1.0 - number  # of an earlier build: each case has its own
        if which not in found:
            recorded = not np.isfinite(number_at(dataset, "omega_p", position))
            found[which] = Motion([number], [1.0], a, v, recorded=recorded)
            continue
        motion = found[which]
        scale = _scale(motion.horizontal, a)
        motion.cases.append(number)
        motion.scales.append(scale)
        if np.isfinite(a).sum() > np.isfinite(motion.horizontal).sum():
            motion.horizontal, motion.vertical = a, v
            motion.scales = [s / scale for s in motion.scales]
    return _labelled(dataset, positions, list(found.values()))


def _labelled(dataset: xarray.Dataset, positions: list[Position], found: list[Motion]) -> list[Motion]:
    """Motions with what tells them apart; none where the ground stands still in all of them."""
    if all(np.nanmax(np.abs(m.horizontal), initial=0.0) == 0.0 and m.vertical is None for m in found):
        return []
    for motion in found if len(found) > 1 else ():
        motion.label = _distinction(dataset, [positions[i] for i in motion.cases], positions)
    return found


def panels_of(found: list[Motion]) -> list[list[Motion]]:
    """Which motions share a panel."""
    if 1 < len(found) <= MOST_PANELS and all(motion.recorded for motion in found):
        return [[motion] for motion in found]
    return [found] if found else []


def height_of(panel: list[Motion]) -> float:
    """Height of a panel, over that of a single trace."""
    return 1.0 + 0.28 * len(panel) if _stacked(panel) else 1.0


def uplift_at(dataset: xarray.Dataset, positions: list[Position]) -> tuple[float, float]:
    """a_g to the right and to the left that lifts a rigid body about its left and right edge, one for all cases [g].

    g tan(alpha); NaN where they differ.
    """
    if "alpha" not in dataset.variables:
        return np.nan, np.nan
    axes, g = axes_of(dataset), unit_g(dataset)
    sides = ("alpha_left", "alpha_right") if two_edged(dataset) else ("alpha", "alpha")
    found = [lifts_from(dataset, side) for side in sides]
    levels = np.array([[float(values_of(one, axes, position)) / g for one in found] for position in positions])
    alike = len(levels) > 0 and bool((np.ptp(levels, axis=0) <= _SAME).all())
    return (float(levels[0, 0]), float(levels[0, 1])) if alike else (np.nan, np.nan)


def draw_ground(
    axes: Axes,
    time: Array,
    panel: list[Motion],
    *,
    coloured: bool,
    named: bool = False,
    uplift: tuple[float, float] = (np.nan, np.nan),
    word: str = "",
) -> None:
    """A panel of the motions given: one trace, pulses over one another, or records below one another.

    Args:
        axes: to draw in.
        time: output times [s].
        panel: motions.
        coloured: a motion of one case only has its colour, where there are others.
        named: write what distinguishes a motion above its panel.
        uplift: g tan(alpha) to both sides [g], marked where the motions reach it or nearly do; NaN = not.
        word: what it is.
    """
    stacked = _stacked(panel)
    level = 0.0
    scaled = any(motion.scaled for motion in panel)
    levels, peaks = [], []
    for number, motion in enumerate(panel):
        own = coloured and len(motion.cases) == 1
        colour = COLOURS[motion.cases[0] % len(COLOURS)] if own else _HORIZONTAL
        peak = float(np.nanmax(np.abs(motion.horizontal), initial=0.0)) or 1.0
        unit = peak if scaled else 1.0
        if stacked and number:
            level -= 1.15 * (_reach(panel[number - 1], -1.0) + _reach(motion, 1.0)) / unit
        if motion.vertical is not None:
            axes.plot(time, level + motion.vertical / unit, color=_VERTICAL, linewidth=0.6, zorder=2)
        width = 0.7 if len(panel) == 1 else 0.5
        axes.plot(time, level + motion.horizontal / unit, color=colour, linewidth=width, zorder=3)
        axes.axhline(level, color=QUIET, linewidth=0.4, zorder=0)
        levels.append(level)
        peaks.append(f"{peak:.2g}")
    nearly = any(
        _reach(m, side) > _NEARLY * level for m in panel for side, level in zip((1.0, -1.0), uplift, strict=True)
    )
    if not scaled and not stacked and nearly:
        left, right = (word.replace(r"\alpha", rf"\alpha_{{\mathrm{{{edge}}}}}") for edge in ("left", "right"))
        marks = (rf"$\pm {word}$", "") if uplift[0] == uplift[1] else (f"${left}$", f"$-{right}$")
        for level, words in zip((uplift[0], -uplift[1]), marks, strict=True):
            axes.axhline(level, color=QUIET, linewidth=0.6, dashes=(1, 2), zorder=1)
            axes.annotate(
                words,
                (1.0, level),
                (-2.0, 1.0),
                xycoords=("axes fraction", "data"),
                textcoords="offset points",
                ha="right",
                va="bottom",
                fontsize=7.0,
                color="#555555",
            )
    axes.set_ylabel(r"$a_g\,/\,\max|a_g|$" if scaled else r"$a_g$ [g]")
    if stacked:
        axes.set_yticks(levels, peaks)
        axes.set_ylabel("peak $a_g$ [g]")
    words = panel[0].label if named and len(panel) == 1 else ""
    if words:
        trace_title(axes, words, width_or(DOUBLE))
    if any(motion.vertical is not None for motion in panel):
        handles = [
            Line2D([], [], color=colour, linewidth=0.8, label=label)
            for colour, label in ((_HORIZONTAL, r"$a_g$"), (_VERTICAL, r"$a_v$"))
        ]
        axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=8.0)


def _reach(motion: Motion, side: float) -> float:
    """How far the traces of a motion reach up (side 1) or down (-1) [g]."""
    traces = [motion.horizontal] + ([] if motion.vertical is None else [motion.vertical])
    return max(float(np.nanmax(side * trace, initial=0.0)) for trace in traces)


def _stacked(panel: list[Motion]) -> bool:
    """Records over one another would hide each other."""
    return len(panel) > 1 and any(motion.recorded for motion in panel)


def _scale(a: Array, b: Array) -> float:
    """b/a of two sizes of one motion, where a is largest of what both last; 1 where nothing moves there."""
    both = np.where(np.isfinite(a) & np.isfinite(b), np.abs(a), 0.0)
    at = int(np.argmax(both))
    return float(b[at] / a[at]) if both[at] > 0.0 and b[at] != 0.0 else 1.0


def _distinction(dataset: xarray.Dataset, own: list[Position], every: list[Position]) -> str:
    """Words for the axes on which some cases are at one point and others elsewhere."""
    axes = axes_of(dataset)
    telling = [
        axis
        for i, axis in enumerate(axes)
        if len({position[i] for position in own}) == 1 and len({position[i] for position in every}) > 1
    ]
    return group_label(dataset, own[:1], telling)
