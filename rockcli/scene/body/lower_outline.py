"""The lower convex outline of a body: the vertices it rolls over, the facets between them, where it can rest.

Turned by theta (clockwise) a body touches the ground at one vertex, at two where a facet lies flat: the facet from
vertex j to j + 1 does so at its tilt psi_j.  On a facet it is the body on two edges of that base.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEVEL = 1e-9
"""Points within this fraction of the body's size above the lowest stand on the ground."""


def lower_hull(points: Array) -> Array:
    """Vertices of the lower convex hull of points (k, 2) = x, z [m], from left to right, (v, 2).

    What is nearer than LEVEL times the size to the line between two others is no vertex, a side as steep as that no
    facet; points that far above the lowest are on its level.
    """
    points = points[np.isfinite(points).all(axis=1)]
    size = float(np.ptp(points, axis=0).max())
    lowest = points[:, 1].min()
    z = np.where(points[:, 1] - lowest <= LEVEL * size, lowest, points[:, 1])
    order = np.lexsort((z, points[:, 0]))
    hull: list[tuple[float, float]] = []
    for x, height in zip(points[order, 0].tolist(), z[order].tolist(), strict=True):
        while len(hull) > 1 and _is_above(hull[-2], hull[-1], (x, height), LEVEL * size):
            hull.pop()
        hull.append((x, height))
    while len(hull) > 1 and hull[1][0] - hull[0][0] <= LEVEL * size:
        hull.pop(0 if hull[0][1] > hull[1][1] else 1)
    while len(hull) > 1 and hull[-1][0] - hull[-2][0] <= LEVEL * size:
        hull.pop(-1 if hull[-1][1] > hull[-2][1] else -2)
    return np.array(hull)


def _is_above(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], slack: float) -> bool:
    """Whether b is above the line a-c, or nearer to it than `slack`."""
    dx, dz = c[0] - a[0], c[1] - a[1]
    below = dz * (b[0] - a[0]) - dx * (b[1] - a[1])
    return bool(below <= slack * np.hypot(dx, dz))


def settling_turn(points: Array, centre: Array) -> float:
    """The turn (clockwise) [rad] by which a body let go as it is rolls downhill to its rest; NaN: none in a quarter.

    points (k, 2), centre of mass (2,) [m].
    """
    vertices = lower_hull(points) - centre
    tilts = np.arctan2(np.diff(vertices[:, 1]), np.diff(vertices[:, 0]))
    i = int(np.argmin(vertices[:, 1]))  # of two the left one
    if vertices[i, 0] > 0.0:  # the centre of mass is on the left of it: it rolls to the left
        facets, last, sign = range(i - 1, -1, -1), 0, -1.0
    else:
        facets, last, sign = range(i, len(tilts)), 1, 1.0
    for j in facets:
        ahead = turned(vertices[j + last], float(tilts[j]))
        if sign * ahead[0] > 0.0:
            return float(tilts[j])
    return np.nan


def turned(points: Array, theta: float) -> Array:
    """Points (..., 2) turned clockwise about the origin."""
    sine, cosine = np.sin(theta), np.cos(theta)
    x, z = points[..., 0], points[..., 1]
    return np.stack([cosine * x + sine * z, cosine * z - sine * x], axis=-1)


@dataclass(frozen=True, eq=False)
class Facets:
    """The facets of n bodies, f at most, NaN after the last of a body; in a last axis of two the left edge, the right.

    Attributes:
        count: how many there are, (n,).
        standing: index of that on which the body stands at theta = 0, (n,).
        tilt: theta at which it lies flat, (n, f) [rad].
        height: of the centre of mass above it, (n, f) [m].
        b: horizontal distances from the centre of mass to its ends, of one beside it negative, (n, f, 2) [m].
        R, alpha: distance to its ends [m], and atan(b/height) [rad], (n, f, 2).
        extent: turn from lying flat on it to the next facet on that side, of the last to a quarter turn, (n, f, 2).
        fall: theta of the last barrier on the left and on the right, (n, 2) [rad]; a quarter turn where there is none
            or the centre of mass is higher there than at the last.
        barrier: what the centre of mass rises from its stand to the highest barrier on each side, (n, 2) [m].
    """

    count: NDArray[np.int64]
    standing: NDArray[np.int64]
    tilt: Array
    height: Array
    b: Array
    R: Array
    alpha: Array
    extent: Array
    fall: Array
    barrier: Array

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Which facets a body left alone can rest on, (n, f): those over whose inside its centre of mass is."""
        return np.asarray((self.b > 0.0).all(axis=2))


def facets_of(vertices: Array) -> Facets:
    """The facets between vertices (n, v, 2) from the centre of mass, from left to right, NaN after the last."""
    count = np.isfinite(vertices[:, :, 0]).sum(axis=1) - 1
    step = np.diff(vertices, axis=1)
    length = np.hypot(step[:, :, 0], step[:, :, 1])
    tilt = np.arctan2(step[:, :, 1], step[:, :, 0])
    along = step / length[:, :, None]
    ends = np.stack([vertices[:, :-1], vertices[:, 1:]], axis=2)
    place = (ends * along[:, :, None, :]).sum(axis=3)  # of the ends, along the facet, from the foot of the centre
    b = place * np.array([-1.0, 1.0])
    across = along[:, :, 1] * vertices[:, :-1, 0] - along[:, :, 0] * vertices[:, :-1, 1]
    quarter = np.full((len(vertices), 1), 0.5 * np.pi)
    last = np.arange(tilt.shape[1]) == count[:, None] - 1
    beyond = np.where(last, quarter, np.concatenate([tilt[:, 1:], quarter], axis=1))
    before = np.concatenate([-quarter, tilt[:, :-1]], axis=1)
    extent = np.stack([tilt - before, beyond - tilt], axis=2)
    alpha = np.arctan2(b, across[:, :, None])
    R = np.hypot(b, across[:, :, None])
    with np.errstate(invalid="ignore"):
        standing = np.nanargmin(np.abs(tilt), axis=1)
        over = (alpha > 0.0) & (alpha < extent)  # the centre of mass comes over the end before the next facet touches
    fall, barrier = np.empty((len(vertices), 2)), np.empty((len(vertices), 2))
    own = np.take_along_axis(across, standing[:, None], axis=1)[:, 0]
    j = np.arange(tilt.shape[1])
    for side, sign in ((0, -1.0), (1, 1.0)):
        outward = np.where(side == 0, j <= standing[:, None], j >= standing[:, None])
        there = over[:, :, side] & outward
        at = np.where(there, sign * tilt + alpha[:, :, side], -np.inf)
        outermost = np.argmax(at, axis=1)[:, None]
        end = vertices[:, 0, 0] if side == 0 else np.take_along_axis(vertices[:, :, 0], count[:, None], axis=1)[:, 0]
        top = np.where(there, R[:, :, side], -np.inf)
        wall = (
            np.abs(end) > np.take_along_axis(top, outermost, axis=1)[:, 0]
        )  # a quarter turn is higher than the last one
        fall[:, side] = sign * np.where(wall, quarter[:, 0], np.take_along_axis(at, outermost, axis=1)[:, 0])
        barrier[:, side] = np.maximum(top.max(axis=1), np.where(wall, np.abs(end), -np.inf)) - own
    return Facets(count, standing, tilt, across, b, R, alpha, extent, fall, barrier)


def rolled(vertices: Array, theta: Array) -> tuple[Array, Array, NDArray[np.int64]]:
    """The centre of mass relative to the ground, x from its place at rest, and z, and the vertex in contact, (n, k).

    vertices (n, v, 2) from the centre of mass, NaN after the last; theta (n, k).
    """
    step = np.diff(vertices, axis=1)
    tilt = np.arctan2(step[:, :, 1], step[:, :, 0])
    with np.errstate(invalid="ignore"):
        vertex: NDArray[np.int64] = (theta[:, :, None] > tilt[:, None, :]).sum(axis=2)
        standing: NDArray[np.int64] = np.nanargmin(np.abs(tilt), axis=1)
    run = np.concatenate([np.zeros((len(tilt), 1)), np.cumsum(np.hypot(step[:, :, 0], step[:, :, 1]), axis=1)], axis=1)
    at = run - np.take_along_axis(run, standing[:, None], axis=1)
    foot = np.take_along_axis(vertices[:, :, 0], standing[:, None], axis=1)  # the left end of the base, on the ground
    x, z = (np.take_along_axis(vertices[:, :, i], vertex, axis=1) for i in (0, 1))
    place = np.take_along_axis(at, vertex, axis=1) + foot
    sine, cosine = np.sin(theta), np.cos(theta)
    return place - (x * cosine + z * sine), x * sine - z * cosine, vertex
