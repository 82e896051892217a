"""Finite elements of the column on the unit length: matrices that depend on the number of elements only.

Degrees of freedom: the rotation of the base, then deflection and rotation of nodes 1 ... n (the base does not
move).  Lengths are over L = 2h, mass over m, so that the matrices of a column are

    M = mass + (dI0/(m L^2)) rotary,   K = EI/(m L^3) stiffness,   K_g = (g/L) weight              (F2)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Beam:
    """Matrices (N, N) and vectors (N,) of a column of n elements, N = 2n + 1.

    Attributes:
        mass: of a unit mass, `consistent` or `lumped` (half of an element's mass at each of its nodes).
        rotary: a unit rotary inertia shared out over the nodes, half shares at both ends.
        stiffness: of unit bending stiffness.
        weight: geometric stiffness of a column of unit weight under itself; destabilising, so it is subtracted.
        uniform: load of a unit horizontal acceleration.
        rigid: the rigid rotation, deflection x and rotation 1.
        tip: picks the deflection of the top.
    """

    mass: Array
    rotary: Array
    stiffness: Array
    weight: Array
    uniform: Array
    rigid: Array
    tip: Array

    @property
    def size(self) -> int:
        """Degrees of freedom N."""
        return len(self.rigid)


@lru_cache(maxsize=16)
def unit_beam(elements: int, mass: str) -> Beam:
    """Matrices of a column of `elements` Euler-Bernoulli elements."""
    n, l = elements, 1.0 / elements  # noqa: E741 - the element's length
    size = 2 * n + 2  # with the deflection of the base, taken out below
    M, K, W, J = (np.zeros((size, size)) for _ in range(4))
    load = np.zeros(size)
    k_e = np.array([[12, 6 * l, -12, 6 * l], [6 * l, 4 * l**2, -6 * l, 2 * l**2],
                    [-12, -6 * l, 12, -6 * l], [6 * l, 2 * l**2, -6 * l, 4 * l**2]]) / l**3  # fmt: skip
    m_e = np.array([[156, 22 * l, 54, -13 * l], [22 * l, 4 * l**2, 13 * l, -3 * l**2],
                    [54, 13 * l, 156, -22 * l], [-13 * l, -3 * l**2, -22 * l, 4 * l**2]]) * l / 420.0  # fmt: skip
    g_e = np.array([[36, 3 * l, -36, 3 * l], [3 * l, 4 * l**2, -3 * l, -(l**2)],
                    [-36, -3 * l, 36, -3 * l], [3 * l, -(l**2), -3 * l, 4 * l**2]]) / (30.0 * l)  # fmt: skip
    # axial force falling by one element's weight along the element: x g_e' beside the constant part
    s_e = np.array([[18, 3 * l, -18, 0], [3 * l, l**2, -3 * l, -0.5 * l**2],
                    [-18, -3 * l, 18, 0], [0, -0.5 * l**2, 0, 3 * l**2]]) / 30.0  # fmt: skip
    for e in range(n):
        at = slice(2 * e, 2 * e + 4)
        K[at, at] += k_e
        if mass == "lumped":
            M[2 * e, 2 * e] += 0.5 * l
            M[2 * e + 2, 2 * e + 2] += 0.5 * l
            load[2 * e] += 0.5 * l
            load[2 * e + 2] += 0.5 * l
            W[at, at] += (1.0 - l * (e + 0.5)) * g_e
        else:
            M[at, at] += m_e
            load[at] += np.array([0.5 * l, l**2 / 12.0, 0.5 * l, -(l**2) / 12.0])
            W[at, at] += (1.0 - l * e) * g_e - s_e
        J[2 * e + 1, 2 * e + 1] += 0.5 * l
        J[2 * e + 3, 2 * e + 3] += 0.5 * l
    keep = np.arange(1, size)
    rigid = np.zeros(size)
    rigid[0::2] = np.arange(n + 1) * l
    rigid[1::2] = 1.0
    tip = np.zeros(size)
    tip[2 * n] = 1.0
    cut = np.ix_(keep, keep)
    return Beam(M[cut], J[cut], K[cut], W[cut], load[keep], rigid[keep], tip[keep])
