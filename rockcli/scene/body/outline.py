"""Bodies from polygon outlines: area, centre of mass, second moment and edges, exactly.

A body is one polygon or several, each of uniform density and depth.  Second moments are exact integrals over the
polygon (Green's theorem), about the middle of its bounding box, so that sizes far from the origin lose no digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.body.lower_outline import LEVEL, lower_hull, settling_turn, turned
from rockcli.scene.counted import counted

Array = NDArray[np.float64]

EVEN = 1e-12
"""Edges whose distances differ by less than this fraction of the base are equally far."""


class OutlineError(ValueError):
    """An outline that is no body; `part` says which polygon of several, None = the body as a whole."""

    def __init__(self, message: str, part: int | None = None) -> None:
        super().__init__(message)
        self.part = part


@dataclass(frozen=True)
class Figure:
    """A polygon: area [m^2], centroid [m], polar second moment about the centroid [m^4], each (n,).

    `clockwise`: the points run clockwise in some case; the area is positive either way.
    """

    area: Array
    x: Array
    z: Array
    polar: Array
    clockwise: bool


@dataclass(frozen=True)
class Solid:
    """A planar body standing on the ground, (n,) each.

    Attributes:
        mass: sum of weight x area over the parts [kg, if the weights are density x depth].
        h: height of the centre of mass above the base [m].
        b: distances from the centre of mass to the left and right edge, (n, 2) [m].
        r_g: radius of gyration about the centre of mass [m].
        height: of the highest point above the base [m].
        rise: height of the right edge above the left one [m]; of a tilted support the base is its middle.
        outline: all polygons, (n, points, 2) [m]: x from the centre of mass, z from the base; NaN between two.
        vertices: of the lower convex outline, (n, v, 2) [m] from the centre of mass, left to right, NaN after the last;
            None where there are but the two edges.
    """

    mass: Array
    h: Array
    b: Array
    r_g: Array
    height: Array
    rise: Array
    outline: Array
    vertices: Array | None = None


@dataclass(frozen=True)
class Given:
    """What of n bodies is given beside their outline: centre of mass (n, 2), radius of gyration about it (n,) [m]."""

    centre: Array
    r_g: Array


def figure(points: Array) -> Figure:
    """Area, centroid and polar second moment of polygons, `points` (n, k, 2) = x, z [m]; the last joins the first.

    Raises:
        OutlineError: fewer than three points, points that repeat, no area, sides that cross or touch.
    """
    k = points.shape[1]
    if k < 3:
        raise OutlineError(f"has {counted(k, 'point')}; a polygon has at least 3")
    _check_simple(points)
    middle = 0.5 * (points.min(axis=1) + points.max(axis=1))
    x, z = np.moveaxis(points - middle[:, None, :], 2, 0)
    x_, z_ = np.roll(x, -1, axis=1), np.roll(z, -1, axis=1)
    cross = x * z_ - x_ * z
    twice = cross.sum(axis=1)
    if not np.all(np.abs(twice) > 1e-12 * np.prod(np.ptp(points, axis=1), axis=1)):
        raise OutlineError("has no area")
    # integrals of 1, x, z and x^2 + z^2 over the polygon as sums over its sides
    mean_x = ((x + x_) * cross).sum(axis=1) / (3.0 * twice)
    mean_z = ((z + z_) * cross).sum(axis=1) / (3.0 * twice)
    squares = x * x + x * x_ + x_ * x_ + z * z + z * z_ + z_ * z_
    radius2 = (squares * cross).sum(axis=1) / (6.0 * twice) - mean_x**2 - mean_z**2
    area = 0.5 * np.abs(twice)
    clockwise = bool((twice < 0.0).any())
    return Figure(area, mean_x + middle[:, 0], mean_z + middle[:, 1], radius2 * area, clockwise)


def _check_simple(points: Array) -> None:
    """Refuse polygons with sides of no length, or with sides that cross or touch others."""
    k = points.shape[1]
    size = np.ptp(points, axis=1).max(axis=1)
    ends = np.roll(points, -1, axis=1)
    short = np.hypot(*np.moveaxis(ends - points, 2, 0)) <= 1e-12 * size[:, None]
    if short.any():
        i = int(np.argmax(short.any(axis=0)))
        raise OutlineError(f"repeats a point: points {i + 1} and {(i + 1) % k + 1} are the same")
    for i in range(k - 1):
        others = np.arange(i + 1, k)
        met = meet(points[:, i, None], ends[:, i, None], points[:, others], ends[:, others])
        met[:, 0] = _folded(points[:, i], ends[:, i], ends[:, others[0]])
        if i == 0:
            met[:, -1] = _folded(points[:, -1], ends[:, -1], ends[:, 0])
        if met.any():
            j = int(others[np.argmax(met.any(axis=0))])
            raise OutlineError(f"crosses or touches itself: the sides after points {i + 1} and {j + 1} meet")


def meet(a: Array, b: Array, c: Array, d: Array) -> NDArray[np.bool_]:
    """Whether the segments a-b and c-d have a point in common; (..., 2) each, broadcast."""
    one, two, three, four = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    proper = (one * two < 0.0) & (three * four < 0.0)
    touching = (
        ((one == 0.0) & _between(a, b, c))
        | ((two == 0.0) & _between(a, b, d))
        | ((three == 0.0) & _between(c, d, a))
        | ((four == 0.0) & _between(c, d, b))
    )
    return np.asarray(proper | touching)


def _turn(a: Array, b: Array, c: Array, slack: float = 0.0) -> Array:
    """Twice the area of a-b-c, positive if it turns left; rounding, or c within `slack` of the line, is straight."""
    u, v = b - a, c - a
    left, right = u[..., 0] * v[..., 1], u[..., 1] * v[..., 0]
    area, least = left - right, slack * np.hypot(u[..., 0], u[..., 1])
    return np.where(np.abs(area) <= np.maximum(1e-14 * (np.abs(left) + np.abs(right)), least), 0.0, area)


def _between(a: Array, b: Array, c: Array, slack: float = 0.0) -> NDArray[np.bool_]:
    """Whether c, on the line a-b, lies between a and b, or no more than `slack` beyond."""
    return np.asarray(((c >= np.minimum(a, b) - slack) & (c <= np.maximum(a, b) + slack)).all(axis=-1))


def _folded(a: Array, b: Array, c: Array) -> NDArray[np.bool_]:
    """Whether the side b-c runs back along the side a-b, (n,)."""
    return np.asarray((_turn(a, b, c) == 0.0) & (((b - a) * (c - b)).sum(axis=-1) < 0.0))


def _inside(point: Array, points: Array, slack: float) -> NDArray[np.bool_]:
    """Whether points (n, m, 2) lie in polygons (n, k, 2), (n, m), and not within `slack` of a side."""
    a, b = points[:, None, :, :], np.roll(points, -1, axis=1)[:, None, :, :]
    p = point[:, :, None, :]
    rising = (a[..., 1] <= p[..., 1]) & (b[..., 1] > p[..., 1])
    falling = (a[..., 1] > p[..., 1]) & (b[..., 1] <= p[..., 1])
    turn = _turn(a, b, p, slack)
    winding = (rising & (turn > 0.0)).sum(axis=2) - (falling & (turn < 0.0)).sum(axis=2)
    on_a_side = ((turn == 0.0) & _between(a, b, p, slack)).any(axis=2)
    return np.asarray((winding != 0) & ~on_a_side)


def _check_apart(parts: Sequence[Array]) -> None:
    """Refuse parts that overlap: their mass would count twice."""
    for j, one in enumerate(parts):
        for i, other in enumerate(parts[:j]):
            if _overlap(one, other) or _overlap(other, one):
                raise OutlineError(f"overlaps part {i + 1}: the mass in common would count twice", j)


def _overlap(one: Array, other: Array) -> bool:
    """Whether a side of `one` crosses one of `other`, or a point of it, of a side or of its inside lies in `other`.

    Parts that touch but for rounding, as at heights of .3 and .1 + .2, do not.
    """
    slack = 1e-12 * float(max(np.abs(one).max(), np.abs(other).max()))
    ends, other_ends = np.roll(one, -1, axis=1), np.roll(other, -1, axis=1)
    a, b, c, d = one[:, :, None], ends[:, :, None], other[:, None], other_ends[:, None]
    across = _turn(a, b, c, slack) * _turn(a, b, d, slack) < 0.0
    if (across & (_turn(c, d, a, slack) * _turn(c, d, b, slack) < 0.0)).any():
        return True
    middles = 0.5 * (one + ends)
    ears = (np.roll(one, 1, axis=1) + one + ends) / 3.0
    within = np.where(_inside(ears, one, slack)[:, :, None], ears, middles)
    return bool(_inside(np.concatenate([one, middles, within], axis=1), other, slack).any())


def _as_seen(parts: Sequence[Array], origin: Array) -> Array:
    """Points of polygons from an origin (n, 2), one polygon after the other with NaN between."""
    between = np.full((len(origin), 1, 2), np.nan)
    rows = [piece for points in parts for piece in (between, points - origin[:, None, :])]
    return np.concatenate(rows[1:], axis=1)


def _same(points: Array) -> bool:
    """Whether the points (n, k, 2) of all bodies are the same."""
    return bool((points == points[:1]).all())


def _settled(parts: Sequence[Array], centre: Array) -> tuple[list[Array], Array]:
    """Polygons turned about the centre of mass (n, 2) to where the body comes to rest, from there, and all points."""
    moved = [points - centre[:, None, :] for points in parts]
    every = np.concatenate(moved, axis=1)
    cases = range(1) if _same(every) else range(len(every))
    turns = np.array([settling_turn(every[i], np.zeros(2)) for i in cases])
    if np.isnan(turns).any():
        raise OutlineError("finds no rest within a quarter turn: it has no side over which its centre of mass is")
    turns = np.broadcast_to(turns, len(every))
    laid = [np.stack([turned(points, turn) for points, turn in zip(each, turns, strict=True)]) for each in moved]
    return laid, np.concatenate(laid, axis=1)


def _vertices(every: Array, centre: Array, left: Array, right: Array) -> Array | None:
    """Vertices of the lower convex outline of points (n, k, 2) from the centre of mass (n, 2), (n, v, 2).

    None where no body reaches beyond its edges `left` and `right`.
    """
    size = np.ptp(every, axis=1).max(axis=1)
    beyond = (every[:, :, 0] < (left - LEVEL * size)[:, None]) | (every[:, :, 0] > (right + LEVEL * size)[:, None])
    if not beyond.any():
        return None
    moved = every - centre[:, None, :]
    hulls = [lower_hull(points) for points in (moved[:1] if _same(moved) else moved)]
    found = np.full((len(hulls), max(len(hull) for hull in hulls), 2), np.nan)
    for row, hull in zip(found, hulls, strict=True):
        row[: len(hull)] = hull
    return None if found.shape[1] < 3 else np.broadcast_to(found, (len(every), *found.shape[1:]))


def solid(
    parts: Sequence[Array],
    weights: Sequence[Array],
    contacts: Array | None = None,
    given: Given | None = None,
    *,
    settle: bool = False,
    rolls: bool = False,
) -> tuple[Solid, tuple[int, ...]]:
    """The body made of polygons (n, k, 2) [m] of given density x depth (n,) [kg/m^2], and the parts given clockwise.

    The edges are the lowest points farthest left and right, or the `contacts` (n, 2, 2); the parts are rigidly joined.

    Args:
        given: the centre of mass and the radius of gyration, where they do not follow from the polygons.
        settle: the body is let go as it is, and stands where it comes to rest.
        rolls: it has the vertices of its lower convex outline, not its two edges alone.

    Raises:
        OutlineError: a polygon that is none, parts that overlap, a body that stands on a point or not by itself.
    """
    figures = []
    for j, points in enumerate(parts):
        try:
            figures.append(figure(points))
        except OutlineError as error:
            raise OutlineError(str(error), j) from None
    _check_apart(parts)
    every = np.concatenate(list(parts), axis=1)
    ground = every[:, :, 1].min(axis=1)
    size = np.ptp(every, axis=1).max(axis=1)
    masses = [weight * f.area for weight, f in zip(weights, figures, strict=True)]
    mass = np.sum(masses, axis=0)
    x = np.sum([m * f.x for m, f in zip(masses, figures, strict=True)], axis=0) / mass
    z = np.sum([m * f.z for m, f in zip(masses, figures, strict=True)], axis=0) / mass
    I_cm = np.zeros_like(mass)
    for m, f in zip(masses, figures, strict=True):
        I_cm += m * (f.polar / f.area + (f.x - x) ** 2 + (f.z - z) ** 2)
    if given is not None:
        x, z, I_cm = given.centre[:, 0], given.centre[:, 1], mass * given.r_g**2
    if settle:
        parts, every = _settled(parts, np.stack([x, z], axis=1))
        x = z = np.zeros_like(mass)
        ground = every[:, :, 1].min(axis=1)
    stands = every[:, :, 1] - ground[:, None] <= LEVEL * size[:, None]
    left = np.where(stands, every[:, :, 0], np.inf).min(axis=1)
    right = np.where(stands, every[:, :, 0], -np.inf).max(axis=1)
    rise = np.zeros_like(x)
    if contacts is not None:
        ground = contacts[:, :, 1].mean(axis=1)
        order = np.argsort(contacts[:, :, 0], axis=1)
        (left, right), (low, high) = (np.take_along_axis(contacts[:, :, k], order, axis=1).T for k in (0, 1))
        rise = high - low
        if not (contacts[:, :, 1] < z[:, None]).all():
            raise OutlineError("has its centre of mass below its contacts (in a photograph z runs down: z_down: true)")
    if (right - left <= LEVEL * size).any():
        raise OutlineError("rests on one point: two lowest points at the same height are needed")
    b = np.stack([x - left, right - x], axis=1)
    if not (b > 0.0).all():
        i = int(np.argmin((b > 0.0).all(axis=1)))
        raise OutlineError(
            f"falls by itself: its centre of mass, x = {x[i]:.6g} m, is not between its lowest points, "
            f"x = {left[i]:.6g} and {right[i]:.6g} m"
        )
    even = np.abs(b[:, 0] - b[:, 1]) <= EVEN * (right - left)
    b = np.where(even[:, None], 0.5 * (right - left)[:, None], b)
    outline = _as_seen(parts, np.stack([x, ground], axis=1))
    vertices = _vertices(every, np.stack([x, z], axis=1), left, right) if rolls else None
    height = every[:, :, 1].max(axis=1) - ground
    body = Solid(mass, z - ground, b, np.sqrt(I_cm / mass), height, rise, outline, vertices)
    return body, tuple(j for j, f in enumerate(figures) if f.clockwise)
