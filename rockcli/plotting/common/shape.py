"""The outline of a rocking body, its own or a rectangle: it turns about its edges, and bends if it is flexible."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.path import Path

from rockcli.kernels.contact.codes import SLIDE, SLIDE_ROCK
from rockcli.plotting.common.case_settings import case_settings, may_vary
from rockcli.plotting.common.cases import Array, axes_of, has_overturned, values_at
from rockcli.plotting.common.response import edges
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.body.lower_outline import LEVEL, lower_hull, rolled
from rockcli.scene.body.lower_outline import turned as turned_by

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

_SECTIONS = 25
"""Points along each side of a body that bends."""

_LIES = 1.4
"""Last rotation of a body that overturned beyond which it is drawn on the ground [rad]."""

NARROWEST = 0.6
"""Width over height from which the numbers along the axis of a slender body do not touch."""

_NUMBER = re.compile(r"[0-9.]+(?:e[-+]?[0-9]+)?")

_HALVINGS = 30
"""Bisections for the largest bending that stays above the ground."""


@dataclass(frozen=True)
class Body:
    """The body drawn: distances of its axis, through the centre of mass, from the edges; twice the height of that [m].

    `points` are its outline, (points, 2) from the foot of the axis [m], NaN between polygons; None = a rectangle.
    `rise` is the height of its right edge above the left one [m]; the foot of the axis is halfway.  `vertices` are
    those it rolls over, (v, 2) [m] from the centre of mass; None of a body that turns about its two edges.
    """

    left: float
    right: float
    height: float
    points: Array | None = None
    rise: float = 0.0
    vertices: Array | None = None


@dataclass(frozen=True)
class Motion:
    """A history of (time,) arrays: rotation, |theta| <= pi/2; displacement of the top across the axis [m]; a_g; slide
    along the ground and height of the lower edge above it [m]; the mode of contact, -1 where none is told."""

    time: Array
    theta: Array
    w_top: Array
    a_g: Array
    slide: Array
    lift: Array
    mode: Array

    @property
    def bends(self) -> bool:
        """Whether the body has any bending."""
        return bool(np.any(self.w_top != 0.0))


def body_of(dataset: xarray.Dataset, position: tuple[int, ...]) -> Body:
    """The body of a case, with h = R cos alpha and b = R sin alpha of each edge."""
    R, alpha = edges(dataset, "R", position), edges(dataset, "alpha", position)
    b = R * np.sin(alpha)
    h = R * np.cos(alpha)
    level = bool(abs(h[LEFT] - h[RIGHT]) <= LEVEL * h.max())
    rise = 0.0 if level else float(h[LEFT] - h[RIGHT])
    points = outline_at(dataset, position)
    vertices = None
    if points is None and level:
        points = _up_to_its_top(dataset, position, b, float(h.sum()))
    elif points is not None and _rolls(dataset, position):
        vertices = lower_hull(points) - np.array([0.0, 0.5 * h.sum()])
    return Body(float(b[LEFT]), float(b[RIGHT]), float(h.sum()), points, rise, vertices)


def _up_to_its_top(dataset: xarray.Dataset, position: tuple[int, ...], b: Array, height: float) -> Array | None:
    """Corners of a rectangle as high as its `top`, (4, 2) [m].

    None if that is 2h, below the centre of mass, no plain number, or may be that of a setting or a sample.
    """
    axes = axes_of(dataset)
    at = next((name for name in ("given_top", "block_top", "top") if name in dataset.variables), "")
    if at and set(dataset[at].dims) <= set(axes):
        top = float(values_at(dataset, at, position))
    else:
        said = case_settings(dataset).get("block.top", "")
        known = not may_vary(dataset, "block.top") and _NUMBER.fullmatch(said)
        top = float(said) if known else np.nan
    if not top > 0.5 * height or abs(top - height) <= LEVEL * height:
        return None
    left, right = -b[LEFT], b[RIGHT]
    return np.array([[left, 0.0], [right, 0.0], [right, top], [left, top]])


def _rolls(dataset: xarray.Dataset, position: tuple[int, ...]) -> bool:
    """Whether a body of an outline rolls over the vertices beside its base, as its study says."""
    block = json.loads(dataset.attrs.get("case", "{}")).get("block") or {}
    axes, stands = axes_of(dataset), block.get("stands", "outline")
    if "stands" in axes:
        stands = str(dataset["stands"].values[position[axes.index("stands")]])
    return stands != "toes" and not block.get("contacts") and "residual_tilt" in dataset.variables


def outline_at(dataset: xarray.Dataset, position: tuple[int, ...]) -> Array | None:
    """The outline of a case, (points, 2) [m], x from the centre of mass, z from the base; None if there is none."""
    if "outline_x" not in dataset.variables:
        return None
    points = np.column_stack([values_at(dataset, name, position) for name in ("outline_x", "outline_z")])
    known = np.flatnonzero(np.isfinite(points).all(axis=1))
    return points[: known[-1] + 1] if len(known) else None


def path_of(points: Array) -> Path:
    """Closed polygons (points, 2), NaN between two, as something to fill."""
    gaps = np.flatnonzero(np.isnan(points[:, 0]))
    ends = (*gaps.tolist(), len(points))
    pieces = [points[begin:end] for begin, end in zip((0, *(gaps + 1).tolist()), ends, strict=True)]
    return Path.make_compound_path(*(Path(np.vstack([piece, piece[:1]]), closed=True) for piece in pieces))


def with_room_beside(axes: Axes, narrowest: float = NARROWEST) -> None:
    """Make a panel of a slender body, equal in both directions, wide enough for the numbers of its axis."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    missing = max(narrowest * (high - low) - (right - left), 0.0)
    axes.set_xlim(left - 0.5 * missing, right + 0.5 * missing)


def motion_of(dataset: xarray.Dataset, position: tuple[int, ...]) -> Motion:
    """The history of a case as far as it goes; empty if there is none."""
    theta = values_at(dataset, "theta", position)
    known = np.flatnonzero(np.isfinite(theta))
    last = int(known[-1]) + 1 if len(known) else 0
    theta = theta[:last]
    if last and has_overturned(dataset, position) and abs(theta[-1]) > _LIES:
        theta = np.append(theta[:-1], np.copysign(0.5 * np.pi, theta[-1]))
    a_g, slide, lift = (
        values_at(dataset, name, position)[:last] if name in dataset.variables else np.zeros(last)
        for name in ("a_g", "slide", "lift")
    )
    told = "contact_mode" in dataset.variables
    mode = values_at(dataset, "contact_mode", position)[:last] if told else np.full(last, -1.0)
    return Motion(
        np.asarray(dataset["time"].values, dtype=float)[:last],
        np.clip(theta, -0.5 * np.pi, 0.5 * np.pi),
        _bending(dataset, position, theta),
        np.nan_to_num(a_g),
        np.nan_to_num(slide),
        np.nan_to_num(lift),
        np.nan_to_num(mode, nan=-1.0),
    )


def friction_marks(body: Body, motion: Motion) -> tuple[Array, Array]:
    """What sliding edges scratch into the ground: pieces (k, 2) from x to x [m], and when each is made [s], (k,)."""
    flat, tilted = motion.mode[:-1] == SLIDE, motion.mode[:-1] == SLIDE_ROCK
    pieces = np.column_stack([motion.slide[:-1], motion.slide[1:]])
    made, when = [], []
    for edge, turned in ((-body.left, motion.theta[:-1] < 0.0), (body.right, motion.theta[:-1] > 0.0)):
        scratches = flat | (tilted & turned)
        made.append(edge + pieces[scratches])
        when.append(motion.time[1:][scratches])
    order = np.argsort(np.concatenate(when), kind="stable")
    return np.concatenate(made)[order], np.concatenate(when)[order]


def _bending(dataset: xarray.Dataset, position: tuple[int, ...], theta: Array) -> Array:
    """Displacement of the top across the axis, whose horizontal part is u_top_bending [m]; 0 for what does not bend."""
    if "u_top_bending" not in dataset.variables:
        return np.zeros_like(theta)
    across = values_at(dataset, "u_top_bending", position)[: len(theta)]
    upright = np.cos(theta) > 0.1
    return np.nan_to_num(np.where(upright, across / np.where(upright, np.cos(theta), 1.0), 0.0))


def outline(body: Body, theta: float, w_top: float = 0.0) -> Array:
    """Corners of the body, (k, 2), NaN between polygons: x from its axis at rest, z up from the ground [m].

    The body turns about its right edge while theta > 0 and about its left one while theta < 0.  A top displaced by
    `w_top` bends the axis into the cubic of a cantilever with a force at its top; sections stay plane and across it.
    Bending that would take the body below the ground is drawn smaller.
    """
    if w_top == 0.0:
        return _placed(body, theta, 0.0)
    points = _placed(body, theta, w_top)
    if np.nanmin(points[:, 1]) >= -1e-9 * body.height:
        return points
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        inside = np.nanmin(_placed(body, theta, middle * w_top)[:, 1]) >= -1e-9 * body.height
        low, high = (middle, high) if inside else (low, middle)
    return _placed(body, theta, low * w_top)


def _placed(body: Body, theta: float, w_top: float) -> Array:
    if body.points is None:
        up = np.linspace(0.0, 1.0, _SECTIONS if w_top else 2)
        s = np.concatenate([up, up[::-1]])
        x = np.repeat([-body.left, body.right], len(up))
    else:
        x, s = body.points[:, 0], body.points[:, 1] / body.height
    across = 0.5 * w_top * (3.0 - s) * s**2
    tilt = np.arctan(1.5 * w_top / body.height * (2.0 - s) * s)
    points = np.column_stack([across + x * np.cos(tilt), s * body.height - x * np.sin(tilt)])
    if body.vertices is not None:
        x_0, z_0, _ = rolled(body.vertices[None], np.array([[theta]]))
        from_centre = turned_by(points - np.array([0.0, 0.5 * body.height]), theta)
        return np.asarray(from_centre + np.array([x_0[0, 0], z_0[0, 0]]))
    edge, base = (body.right, 0.5 * body.rise) if theta > 0.0 else (-body.left, -0.5 * body.rise)
    cos, sin = np.cos(theta), np.sin(theta)
    arm, up = points[:, 0] - edge, points[:, 1] - base
    return np.column_stack([edge + arm * cos + up * sin, base + up * cos - arm * sin])
