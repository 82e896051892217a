"""Where the masses are: the thesis's models 1-4 and its flexible column as beam elements [2.2, chapter 4]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels.frame import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT
from rockcli.scene.constants import DENSITY, ELEMENTS, RIGID
from rockcli.solvers.common.rotary import lacking

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Structure:
    """A column of `n` equal elements standing at node 0; N = 3 (n + 1) freedoms.

    Attributes:
        length: of an element [m]; axial = E A [N], bending = E I [N m^2].
        m: total mass [kg].  mass: (N, 6) lower band of the mass matrix.
        pull: nodal forces per unit of -a_g, (N,); weights: masses that feel gravity, at vertical freedoms, (N,).
        damping: factor of the stiffness in Rayleigh's damping [s].
    """

    n: int
    length: float
    axial: float
    bending: float
    m: float
    mass: Array
    pull: Array
    weights: Array
    damping: float

    @property
    def heights(self) -> Array:
        """Heights of the nodes above the base, (n + 1,) [m]."""
        return np.asarray(np.arange(self.n + 1) * np.float64(self.length))


def mass_of(batch: Batch, case: int) -> float:
    """Mass of a body [kg]: as given, or that of the column per unit depth, or of a block of `DENSITY`."""
    block, column = batch.block, batch.column
    if batch.model == "flexible" and column is not None:
        return float(column.rho[case] * 4.0 * block.b[case, LEFT] * block.h[case])
    given = float(block.mass[case])
    return given if np.isfinite(given) else float(DENSITY * 4.0 * block.b[case, LEFT] * block.h[case])


def structure_of(batch: Batch, case: int, *, fibres: bool) -> Structure:
    """The column of one case; on `fibres` it is as high as the body and its base can move vertically."""
    block, column = batch.block, batch.column
    R, alpha, h, b = (float(x) for x in (block.R[case, LEFT], block.alpha[case, LEFT], block.h[case], block.b[case, 0]))
    inertia, m = float(block.inertia[case, LEFT]), mass_of(batch, case)
    flexible = batch.model == "flexible"
    if flexible and column is not None:
        E = float(column.E[case])
    else:
        E = m / (2.0 * b * h) * float(batch.g[case]) * h * h / (b * RIGID)
    axial, bending = E * 2.0 * b, E * (2.0 * b) ** 3 / 12.0

    if batch.model in ("1", "2", "3"):
        height = R if batch.model == "1" else h
        mass, pull, weights = np.zeros((6, at.BAND)), np.zeros(6), np.zeros(6)
        weights[4] = m
        if batch.model == "2":
            mass[5, 0] = inertia * m * R**2
            pull[5] = m * R * np.cos(alpha)
        else:
            mass[3:5, 0] = m
            mass[5, 0] = inertia * m * R**2 - m * height**2
            pull[3] = m * np.cos(alpha) if batch.model == "1" else m
        return Structure(1, height, axial, bending, m, mass, pull, weights, 0.0)

    n = ELEMENTS if column is None else column.elements
    lumped = column is not None and column.mass == "lumped"
    full = 2.0 * h if flexible or fibres else 2.0 * R
    length = full / n
    mass = lumped_bar(n, m) if lumped else consistent_bar(n, m, length)
    # the rotary inertia a line of mass lacks; on fibres the base moves by b theta and brings m b^2 itself
    mass[2::3, 0] += lacking(inertia, m, R, full, m * b * b if fibres else 0.0) / (n + 1)
    ahead = np.zeros(3 * (n + 1))
    ahead[0::3] = 1.0
    pull = full_matrix(mass) @ ahead
    if not (flexible or fibres):
        pull *= np.cos(alpha)
    weights = np.zeros(3 * (n + 1))
    weights[1::3] = lumped_bar(n, m)[1::3, 0]
    zeta = float(column.zeta[case]) if flexible and column is not None else 0.0
    damping = 2.0 * zeta / clamped_frequency(n, length, axial, bending, mass) if zeta > 0.0 else 0.0
    return Structure(n, length, axial, bending, m, mass, pull, weights, damping)


def lumped_bar(n: int, m: float) -> Array:
    """Masses of a bar at its nodes, half ones at the ends, no rotary inertia, as a band (3 (n + 1), 6)."""
    band = np.zeros((3 * (n + 1), at.BAND))
    nodal = np.full(n + 1, m / n)
    nodal[[0, -1]] *= 0.5
    band[0::3, 0] = band[1::3, 0] = nodal
    return band


def consistent_bar(n: int, m: float, length: float) -> Array:
    """Consistent masses of a bar of Euler-Bernoulli elements, as a band (3 (n + 1), 6).

    Cubic across, linear along; formed upright, where theta of this code (clockwise) is du/ds.
    """
    L, e = length, np.zeros((6, 6))
    across = np.array(
        [
            [156.0, 22.0 * L, 54.0, -13.0 * L],
            [22.0 * L, 4.0 * L**2, 13.0 * L, -3.0 * L**2],
            [54.0, 13.0 * L, 156.0, -22.0 * L],
            [-13.0 * L, -3.0 * L**2, -22.0 * L, 4.0 * L**2],
        ]
    )
    e[np.ix_([0, 2, 3, 5], [0, 2, 3, 5])] = across / 420.0
    e[np.ix_([1, 4], [1, 4])] = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    band = np.zeros((3 * (n + 1), at.BAND))
    for i in range(n):
        for a in range(6):
            for b in range(a + 1):
                band[3 * i + a, a - b] += e[a, b] * m / n
    return band


def full_matrix(band: Array) -> Array:
    """The symmetric matrix of a band (N, 6): (N, N)."""
    N = len(band)
    full = np.zeros((N, N))
    for k in range(at.BAND):
        i = np.arange(k, N)
        full[i, i - k] = full[i - k, i] = band[i, k]
    return full


def upright_stiffness(n: int, length: float, axial: float, bending: float) -> Array:
    """Stiffness of the free column, upright and without load, (N, N)."""
    L = length
    e = np.zeros((6, 6))
    across = np.array(
        [
            [12.0, 6.0 * L, -12.0, 6.0 * L],
            [6.0 * L, 4.0 * L**2, -6.0 * L, 2.0 * L**2],
            [-12.0, -6.0 * L, 12.0, -6.0 * L],
            [6.0 * L, 2.0 * L**2, -6.0 * L, 4.0 * L**2],
        ]
    )
    e[np.ix_([0, 2, 3, 5], [0, 2, 3, 5])] = across * bending / L**3
    e[np.ix_([1, 4], [1, 4])] = np.array([[1.0, -1.0], [-1.0, 1.0]]) * axial / L
    full = np.zeros((3 * (n + 1), 3 * (n + 1)))
    for i in range(n):
        full[3 * i : 3 * i + 6, 3 * i : 3 * i + 6] += e
    return full


def clamped_frequency(n: int, length: float, axial: float, bending: float, mass: Array) -> float:
    """First circular frequency of the column clamped at its base [rad/s], compare (4.3)."""
    from scipy.linalg import eigh

    K = upright_stiffness(n, length, axial, bending)[3:, 3:]
    M = full_matrix(mass)[3:, 3:]
    largest = eigh(M, K, eigvals_only=True)[-1]  # of 1/omega^2: the mass matrix may be singular
    return float(1.0 / np.sqrt(largest))
