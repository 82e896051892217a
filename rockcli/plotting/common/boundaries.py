"""Closed forms of overturning over a map of pulses, where the map is of what they speak of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from rockcli.plotting.common.case_settings import DATASET, case_settings
from rockcli.plotting.common.cases import axes_of
from rockcli.plotting.common.labels import path_of, two_edged
from rockcli.scene.body.lower_outline import lower_hull
from rockcli.scene.laws.overturning import rectangular_without_impact, sine_one_impact, sine_without_impact

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

PLANE = ("omega_p_over_p", "a_p_over_g_tan_alpha")

_WITHOUT_IMPACT: dict[str, Any] = {
    "sine": sine_without_impact,
    "half_sine": lambda Omega: sine_without_impact(Omega, 1),
    "rectangular": rectangular_without_impact,
}

_SAYS_NOTHING = ("block.", "solver.", "column.", "base.", "damping.", "motion.pulse.omega_p", "motion.pulse.a_p")
"""Settings that the closed forms hold for whatever they are, or that the dataset has as alpha and eta."""

_AS_NEEDED: dict[str, tuple[str, ...]] = {
    "model": ("linearized", "rigid"),
    "damping.scheme": ("restitution", "none"),
    "motion.pulse.shape": tuple(_WITHOUT_IMPACT),
    "motion.pulse.cycles": ("1", "1.0"),
    "initial.theta": ("0", "0.0"),
    "initial.theta_dot": ("0", "0.0"),
}

_DRAWN_AT = 180

_SLOWEST = 1e-3
"""Lowest omega_p/p drawn, over the highest."""

_WIDTH = 1.1

_STYLES: dict[str, Any] = {"no impact": "-", "one impact": (0, (3.5, 1.6))}


def draw_boundaries(axes: Axes, dataset: xarray.Dataset, found: tuple[str, str]) -> tuple[str, ...]:
    """Draw what is known in closed form over one map, axes (x, y) of it; the labels of what was drawn.

    Known are, for the linearized block from rest, overturning without impact by a full or half sine or a rectangular
    pulse, and for the full sine overturning after one impact.  Over a map of the block they show the linearization.
    """
    shape = _shape(dataset, found)
    if not shape:
        return ()
    alpha, eta = float(dataset["alpha"]), float(dataset["eta"])
    per_g_tan_alpha = alpha / np.tan(alpha)  # the closed forms are over g alpha, the axis is over g tan(alpha)
    without, after = _STYLES
    limits = axes.get_xlim(), axes.get_ylim()
    spaced = np.geomspace if axes.get_xscale() == "log" else np.linspace
    Omega = spaced(max(limits[0][0], _SLOWEST * limits[0][1]), limits[0][1], _DRAWN_AT)  # a cell may reach beyond 0
    highest = _WITHOUT_IMPACT[shape](Omega)
    look: dict[str, Any] = {"zorder": 4, "path_effects": [withStroke(linewidth=2.6, foreground="white")]}
    drawn = []
    for scale in (per_g_tan_alpha, -per_g_tan_alpha):  # of pulses turned round, too
        if _within(highest * scale, limits[1]):
            axes.plot(Omega, highest * scale, color="black", linewidth=_WIDTH, linestyle=_STYLES[without], **look)
            drawn.append(without)
        # one impact needs less; the band ends close to both 1 and the line above
        between = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, _DRAWN_AT)[1:-1])
        A = 1.0 + (highest - 1.0) * between[:, None]
        if shape != "sine" or not _within(A * scale, limits[1]):
            continue
        excess = sine_one_impact(A, Omega, eta)
        if np.nanmax(excess, initial=-1.0) > 0.0:
            X = np.broadcast_to(Omega, A.shape)
            how: dict[str, Any] = {"colors": "black", "linewidths": _WIDTH, "linestyles": [_STYLES[after]]}
            line = axes.contour(X, A * scale, excess, levels=[0.0], zorder=4, **how)
            line.set(**look)
            drawn += [after] * any(_within(np.asarray(path.vertices)[:, 1], limits[1]) for path in line.get_paths())
    axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])
    return tuple(drawn)


def _within(heights: Any, limits: tuple[float, float]) -> bool:
    """Whether any of a line is between the limits of an axis."""
    return bool(np.any((heights > limits[0]) & (heights < limits[1])))


def boundary_handles(drawn: set[str]) -> list[Line2D]:
    """Entries of a legend."""
    return [
        Line2D([], [], color="black", linewidth=_WIDTH, linestyle=style, label=f"closed form (linearized): {label}")
        for label, style in _STYLES.items()
        if label in drawn
    ]


def _shape(dataset: xarray.Dataset, found: tuple[str, str]) -> str:
    """The shape of the pulses of a map that the closed forms speak of; "" where they do not."""
    path = {axis: path_of(dataset, axis).removeprefix("case.") for axis in axes_of(dataset)}
    if tuple(path[axis].removeprefix("motion.pulse.") for axis in found) != PLANE:
        return ""
    settings = case_settings(dataset)
    for axis, where in path.items():
        if axis not in found and axis != DATASET:  # the settings are those of its own case
            settings[where] = str(dataset[axis].values)
    if "motion.pulse.shape" not in settings or two_edged(dataset) or rolls(dataset):
        return ""
    for where, value in settings.items():
        if value not in _AS_NEEDED.get(where, (value,) if where.startswith(_SAYS_NOTHING) or where == "g" else ()):
            return ""
    known = all(name in dataset.variables and dataset[name].ndim == 0 for name in ("alpha", "eta"))
    return settings["motion.pulse.shape"] if known else ""


def rolls(dataset: xarray.Dataset) -> bool:
    """Whether a body, of one point on the axes that change it, rolls over vertices beside its two edges."""
    if "outline_x" not in dataset.variables:
        return False
    stands = [case_settings(dataset).get("block.stands", "")]
    stands += [
        str(dataset[axis].values) for axis in axes_of(dataset) if path_of(dataset, axis).endswith("block.stands")
    ]
    x, z = (np.ravel(dataset[name].values) for name in ("outline_x", "outline_z"))
    return stands[-1] != "toes" and len(lower_hull(np.column_stack([x, z]))) > 2
