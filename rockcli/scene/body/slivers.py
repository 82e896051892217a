"""Flat triangles of a surface, as they come of polygons with a corner on a straight side, taken out of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triangles = NDArray[np.int64]

FLAT = 1e-5
"""Height of a triangle above its longest side, over the size of the body, up to which it may be there for rounding."""


def without_slivers(corners: Array, triangles: Triangles) -> Triangles:
    """The same surface, (k, 3): a flat triangle and that across its longest side have the other diagonal of the two.

    Triangles with fewer than three corners are left out.  What bounds both together stays, so that a surface that
    leaks leaks still.  corners (n, 3), triangles (k, 3).
    """
    triangles = triangles[(np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)]
    points = corners[triangles]
    sides = np.roll(points, -1, axis=1) - points
    lengths = np.linalg.norm(sides, axis=2)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    flat = np.flatnonzero(doubled <= FLAT * np.ptp(corners, axis=0).max() * lengths.max(axis=1)).tolist()
    if not flat:
        return triangles
    faces: list[tuple[int, int, int]] = [tuple(face) for face in triangles.tolist()]
    with_side: dict[tuple[int, int], set[int]] = {}
    for number, face in enumerate(faces):
        for side in _sides(face):
            with_side.setdefault(side, set()).add(number)
    begins = lengths.argmax(axis=1)
    left, before = set(flat), len(flat) + 1
    while len(left) < before:  # one of a row of them has to wait for the next
        before = len(left)
        for number in sorted(left):
            c, a, m = np.roll(faces[number], -begins[number]).tolist()
            across = [(i, corner) for i in with_side.get((a, c), set()) - left for corner in {*faces[i]} - {a, m, c}]
            if not across:
                continue
            other, far = min(across)
            for which, new in ((number, (a, m, far)), (other, (m, c, far))):
                for side in _sides(faces[which]):
                    with_side[side].remove(which)
                faces[which] = new
            for which in (number, other):
                for side in _sides(faces[which]):
                    with_side.setdefault(side, set()).add(which)
            left.remove(number)
    return np.array(faces, dtype=np.int64)


def _sides(face: tuple[int, int, int]) -> tuple[tuple[int, int], ...]:
    a, b, c = face
    return (a, b), (b, c), (c, a)
