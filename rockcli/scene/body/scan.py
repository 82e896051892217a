"""Bodies from closed surfaces: their profile in any vertical plane, how they rest there, and what overturning takes.

A body rocks in the vertical plane of a direction like the convex outline of its projection on that plane.  Tipped by
phi towards the direction its centre of mass stands h(phi) = max_i (x_i sin phi - z_i cos phi) above the ground,
(x_i, z_i) the vertices of the outline from the centre of mass: it rests where h is least, and balances over a vertex
where it is largest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.lower_outline import LEVEL, settling_turn, turned
from rockcli.scene.body.outline import OutlineError

Array = NDArray[np.float64]

DIRECTIONS = 360
"""Directions, evenly spaced, in which the barrier is told."""

_STEPS = (0.05, 0.002)
"""Finer and finer spacings in which the direction of the least barrier is looked for [deg]."""

_KEPT = 20_000
"""Profiles kept."""

_EQUAL = 1e-9
"""Relative difference below which two barriers are the same."""

QUARTER = 0.5 * np.pi
"""Tilt at which a body has overturned [rad]."""


@dataclass(frozen=True, eq=False)
class Profile:
    """A body seen along a horizontal axis, in the position in which it rests.

    Attributes:
        outline: corners of the convex hull of its projection, (k, 2) [m], counterclockwise: x along the direction,
            z up, from the centre of mass.
        h: height of the centre of mass above the ground [m].
        tilt: by which it turns from the position of its file to rest, towards the direction [rad].
        toes: corners it balances over on the way against and along the direction, (2, 2) [m].
        barriers: largest rise of the centre of mass on the way to a tilt of pi/2 against and along the direction [m].
        tilts: at which that is [rad], (2,).
        r_g: radius of gyration about the axis through the centre of mass [m].
    """

    outline: Array
    h: float
    tilt: float
    toes: Array
    barriers: Array
    tilts: Array
    r_g: float


@dataclass(frozen=True, eq=False)
class Scan:
    """A body of uniform density in the axes of its file, z up.

    Attributes:
        volume: [m^3].
        centre: of mass, (3,) [m].
        r2: tensor of inertia about the centre of mass over the mass, (3, 3) [m^2].
        hull: vertices of the convex hull, (k, 3) [m] from the centre of mass.
        poses: outward normals of the facets of the hull on which the body can rest, (j, 3), the lowest centre first.
        heights: of the centre of mass above the ground on them, (j,) [m].
        triangles: number of triangles of the surface.
    """

    volume: float
    centre: Array
    r2: Array
    hull: Array
    poses: Array
    heights: Array
    triangles: int

    def profile(self, direction: float) -> Profile:
        """The body in the vertical plane of a direction, counted from x towards y [rad].

        Raises:
            OutlineError: it finds no rest.
        """
        return _profile(self, float(direction))

    def poses_apart(self, angle: float) -> list[int]:
        """Poses, the lowest centre first, without those within an angle [rad] of a lower one."""
        kept: list[int] = []
        for i, pose in enumerate(self.poses):
            if all(pose @ self.poses[j] < np.cos(angle) for j in kept):
                kept.append(i)
        return kept

    @cached_property
    def barriers(self) -> Array:
        """Barrier towards each of DIRECTIONS directions, from x towards y, (DIRECTIONS,) [m]."""
        half = np.arange(DIRECTIONS // 2) * 2.0 * np.pi / DIRECTIONS
        both = np.array([self.profile(each).barriers for each in half])
        return np.concatenate([both[:, 1], both[:, 0]])

    @cached_property
    def weakest(self) -> float:
        """Direction of the least barrier, in [0, 2 pi) [rad]; the first of several."""
        spacing = 360.0 / DIRECTIONS
        angle = spacing * _first_least(self.barriers)
        for step in _STEPS:
            count = round(spacing / step)
            near = angle + step * np.arange(-count, count + 1)
            found = np.array([self.profile(np.radians(each)).barriers[1] for each in near])
            if found.min() < found[count] * (1.0 - _EQUAL):
                angle = float(near[_first_least(found)])
            spacing = step
        return float(np.radians(angle % 360.0))


def _first_least(values: Array) -> int:
    return int(np.argmax(values <= values.min() * (1.0 + _EQUAL)))


@lru_cache(maxsize=_KEPT)
def _profile(scan: Scan, direction: float) -> Profile:
    cos, sin = np.cos(direction), np.sin(direction)
    seen = np.column_stack([scan.hull[:, :2] @ [cos, sin], scan.hull[:, 2]])
    outline = corners(seen)
    tilt = settling_turn(outline, np.zeros(2))
    if np.isnan(tilt):
        raise OutlineError("finds no rest within a quarter turn of how it stands in its file; is z of the file up?")
    outline = turned(outline, tilt)
    h = float(-outline[:, 1].min())
    along = _overturning(outline, h)
    against = _overturning((outline * [-1.0, 1.0])[::-1], h)
    axis = np.array([-sin, cos, 0.0])
    return Profile(
        outline=outline,
        h=h,
        tilt=tilt,
        toes=np.array([against[0] * [-1.0, 1.0], along[0]]),
        barriers=np.array([against[1], along[1]]),
        tilts=np.array([against[2], along[2]]),
        r_g=float(np.sqrt(axis @ scan.r2 @ axis)),
    )


def corners(points: Array) -> Array:
    """Corners of the convex hull of points (n, 2), counterclockwise; those that are straight are left out."""
    from scipy.spatial import ConvexHull  # a fifth of a second that no run without a mesh needs

    hull = points[ConvexHull(points).vertices]
    before, after = np.roll(hull, 1, axis=0), np.roll(hull, -1, axis=0)
    across = (after - before) / np.linalg.norm(after - before, axis=1)[:, None]
    out = hull - before
    stands_out = across[:, 1] * out[:, 0] - across[:, 0] * out[:, 1]
    return np.ascontiguousarray(hull[stands_out > LEVEL * np.ptp(points, axis=0).max()])


def _normals(outline: Array) -> Array:
    """Tilt at which each side, from its corner to the next, lies on the ground, (k,) [rad]."""
    side = np.roll(outline, -1, axis=0) - outline
    return np.arctan2(side[:, 1], side[:, 0])


def _overturning(outline: Array, h: float) -> tuple[Array, float, float]:
    """The corner, the rise [m] and the tilt [rad] at the highest point of the centre's way to a quarter turn right."""
    normals = _normals(outline)
    balance = np.arctan2(outline[:, 0], -outline[:, 1])
    before = np.roll(normals, 1)
    on_the_way = (before <= balance) & (balance <= normals) & (balance > 0.0) & (balance < QUARTER)
    far = int(np.argmax(outline[:, 0]))
    ends = float(outline[far, 0])
    R = np.where(on_the_way, np.hypot(outline[:, 0], outline[:, 1]), 0.0)
    at = _first_highest(R, balance)
    if R[at] < ends:
        return outline[far], ends - h, QUARTER
    return outline[at], float(R[at]) - h, float(balance[at])


def _first_highest(R: Array, tilt: Array) -> int:
    """Of the corners at the largest distance the one that is met first."""
    highest = np.flatnonzero(R.max() * (1.0 - 1e-12) <= R)
    return int(highest[np.argmin(tilt[highest])])
