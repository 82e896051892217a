"""From displacements of the mesh to the motion of the body (docs/calculix.md, section 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.solvers.calculix.deck import INCLINATION, Deck

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of the body at the increments of CalculiX, all (k,).

    Attributes:
        t: time [s].
        theta: rotation of the base, clockwise positive [rad].
        u_top, v_top: displacement of the pivot-side top corner [m].
        u_bend: u_top less that of a rigid body at theta [m].
        N, T: normal (up) and tangential force of the base on the body [N].
        M: moment of the base on the body about the middle of the base, opposing theta [N m].
        lift: of the higher corner over the ground that bears nothing; below it the edge is not open [m].
    """

    t: Array
    theta: Array
    u_top: Array
    v_top: Array
    u_bend: Array
    N: Array
    T: Array
    M: Array
    lift: Array


def motion_of(deck: Deck, t: Array, u: Array) -> Motion:
    """The motion from displacements u (k, across + 3, 3) [m] of the base nodes and the two top corners."""
    mesh = deck.mesh
    base, top = u[:, :-2], u[:, -2:]
    theta = rotation(mesh.x_base, base)
    pivot = np.where(theta >= 0.0, 1, 0)
    at_top = top[np.arange(len(t)), pivot]
    height = float(mesh.nodes[:, 1].max())
    sin, cos = np.sin(INCLINATION), np.cos(INCLINATION)
    # a strut pushes along its axis (side sin, cos) when it is shortened
    pushes = [deck.strut * np.maximum(-(side * sin * base[:, :, 0] + cos * base[:, :, 1]), 0.0) for side in (-1.0, 1.0)]
    up, along = cos * (pushes[0] + pushes[1]), sin * (pushes[1] - pushes[0])
    return Motion(
        t=t,
        theta=theta,
        u_top=at_top[:, 0],
        v_top=at_top[:, 1],
        u_bend=at_top[:, 0] - height * np.sin(theta),
        N=up.sum(axis=1),
        T=along.sum(axis=1),
        M=(up * mesh.x_base).sum(axis=1),
        lift=np.maximum(base[:, np.argmin(mesh.x_base), 1], base[:, np.argmax(mesh.x_base), 1]),
    )


def rotation(x: Array, base: Array) -> Array:
    """Rotation of the base, (k,) [rad], clockwise positive: of the straight line nearest to its nodes.

    x (m,) are their positions about the middle [m], base (k, m, 3) their displacements [m].
    """
    return np.arctan2(-base[:, :, 1] @ x, (x + base[:, :, 0]) @ x)


@dataclass(frozen=True, eq=False)
class Impacts:
    """Impacts: times (j,) [s] and rates of rotation before and after [rad/s]; opened: when it first rocked [s]."""

    t: Array
    before: Array
    after: Array
    opened: float

    @property
    def rows(self) -> Array:
        """Time, rate before and after of every impact, (j, 3)."""
        return np.column_stack([self.t, self.before, self.after])


def find_impacts(t: Array, theta: Array, lift: Array, threshold: float) -> Impacts:
    """Passages of theta (k,) through zero, one per excursion beyond +-threshold [rad] with an edge open, `lift` > 0.

    The base may vibrate within the threshold as it likes, and a soft one turn with the body: an excursion ends at the
    first zero crossing after it was left.  The rates are mean slopes over an eighth of the way in time to the
    neighbouring extremes.
    """
    beyond = np.minimum(np.abs(theta) - threshold, lift)
    out = beyond > 0.0
    if not out.any():
        return Impacts(np.empty(0), np.empty(0), np.empty(0), np.nan)
    first = int(np.argmax(out))
    opened = float(t[first]) if first == 0 else _between(t, beyond, first - 1)
    found: list[int] = []
    armed = False
    for i in range(len(t) - 1):
        armed = armed or bool(out[i])
        if armed and theta[i] != 0.0 and theta[i] * theta[i + 1] <= 0.0:
            found.append(i)
            armed = False
    times = np.array([_between(t, theta, i) for i in found])
    edges = [0, *found, len(t) - 1]
    before, after = np.empty(len(found)), np.empty(len(found))
    for j, i in enumerate(found):
        before[j] = _slope(t, theta, edges[j], i, late=True)
        after[j] = _slope(t, theta, i + 1, edges[j + 2], late=False)
    return Impacts(times, before, after, opened)


def _between(t: Array, value: Array, i: int) -> float:
    """Time of the zero of `value` between t[i] and t[i + 1]."""
    change = value[i + 1] - value[i]
    part = -value[i] / change if change != 0.0 else 0.0
    return float(t[i] + np.clip(part, 0.0, 1.0) * (t[i + 1] - t[i]))


def _slope(t: Array, theta: Array, first: int, last: int, *, late: bool) -> float:
    """Mean slope of theta next to the late or the early end of t[first : last + 1]."""
    if last <= first:
        return float("nan")
    extreme = first + int(np.argmax(np.abs(theta[first : last + 1])))
    reach = max(1, abs((last if late else first) - extreme) // 8)
    a, b = (max(last - reach, first), last) if late else (first, min(first + reach, last))
    return float((theta[b] - theta[a]) / (t[b] - t[a]))
