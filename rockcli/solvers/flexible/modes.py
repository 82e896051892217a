"""Modes of the column in its two phases and what couples them (docs/flexible.md, F4-F7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, solve, solve_triangular

from rockcli.solvers.flexible.beam import Beam

Array = NDArray[np.float64]

SEPARATED = 1e-3
"""Weight over bending stiffness below which the rocking mode is found apart from the bending modes."""


@dataclass(frozen=True, eq=False)
class Modes:
    """M-orthonormal modes of both phases (contact, open), (2, N); a rigid base leaves N - 1 contact modes, padded.

    Attributes:
        lam, c: z'' + c z' + lam z = loads [1/s^2, 1/s].
        bu, th, top: components along the uniform load, of the base rotation and of the deflection of the top.
        row, row_v, r_a: guard quantity row.z + row_v.z' + r_a a_g: base moment of the held column over m L^2, or theta.
        T: contact modes to open modes (N, N).
        mobility: [M^-1]_00.
        kappa: b_u' K_cc^-1 b_u of the held column: softening by bending under its own lean [s^2].
    """

    lam: Array
    c: Array
    bu: Array
    th: Array
    top: Array
    row: Array
    row_v: Array
    r_a: float
    T: Array
    mobility: float
    kappa: float


class UnstableError(ValueError):
    """The column buckles under its own weight, or its base is too soft to keep it upright."""


def held_modes(beam: Beam, bending: float, weight: float, rotary: float) -> tuple[Array, Array]:
    """Eigenvalues (N - 1,) [1/s^2], ascending, and modes (N - 1, N - 1) of the column clamped at its base.

    `bending` EI/(m L^3) [1/s^2], `weight` g/L [1/s^2], `rotary` dI0/(m L^2).
    """
    held = slice(1, None)
    M = (beam.mass + rotary * beam.rotary)[held, held]
    K = (bending * beam.stiffness - weight * beam.weight)[held, held]
    lam, phi = eigh(K, M)
    return lam, phi


def free_modes(beam: Beam, bending: float, weight: float, rotary: float, spring: float) -> tuple[Array, Array]:
    """Eigenvalues (N,) and modes (N, N) of the column on a base spring (0: free to rotate), the lowest first.

    The stiffness of a nearly rigid column exceeds its weight by more digits than a number has, so the rigid
    rotation, which bending does not feel, is taken out first and the rocking mode found by iteration (F4).
    """
    N = beam.size
    lower = cholesky(beam.mass + rotary * beam.rotary, lower=True)

    def reduced(A: Array) -> Array:
        half = solve_triangular(lower, A, lower=True)
        return np.asarray(solve_triangular(lower, half.T, lower=True))

    rigid = lower.T @ beam.rigid
    complement = _complement(rigid)
    stiff, bend = eigh(complement.T @ reduced(bending * beam.stiffness) @ complement)
    basis = np.column_stack([rigid / np.linalg.norm(rigid), complement @ bend])
    base = solve_triangular(lower, np.eye(N)[:, 0], lower=True)  # L^-1 e_0
    small = spring * np.outer(basis.T @ base, basis.T @ base) - basis.T @ reduced(weight * beam.weight) @ basis
    A = np.diag(np.concatenate([[0.0], stiff])) + small
    if abs(small[0, 0]) < SEPARATED * stiff[0]:
        first, x = small[0, 0], np.zeros(N - 1)
        for _ in range(50):
            x = solve(A[1:, 1:] - first * np.eye(N - 1), -A[1:, 0], assume_a="sym")
            new = A[0, 0] + A[0, 1:] @ x
            done = abs(new - first) <= 1e-15 * abs(new)
            first = new
            if done:
                break
        lead = np.concatenate([[1.0], x])
        lead /= np.linalg.norm(lead)
        rest = _complement(lead)
        others, V = eigh(rest.T @ A @ rest)
        lam, vectors = np.concatenate([[first], others]), np.column_stack([lead, rest @ V])
    else:
        lam, vectors = eigh(A)
    phi = solve_triangular(lower, basis @ vectors, lower=True, trans="T")
    return np.asarray(lam), np.asarray(phi)


def _complement(vector: Array) -> Array:
    """Orthonormal basis (N, N - 1) of what is orthogonal to a vector (Householder)."""
    unit = vector / np.linalg.norm(vector)
    mirror = unit.copy()
    mirror[0] += np.copysign(1.0, unit[0])
    mirror /= np.linalg.norm(mirror)
    return np.asarray((np.eye(len(unit)) - 2.0 * np.outer(mirror, mirror))[:, 1:])


def make_modes(
    beam: Beam, *, bending: float, weight: float, rotary: float, zeta: float, length: float, spring: float | None
) -> Modes:
    """Modes of both phases; `spring` is the stiffness of a Winkler base in contact over m L^2, None a rigid base.

    Raises:
        UnstableError: the held column has no positive stiffness left, or the base is too soft.
    """
    N = beam.size
    held_lam, held = held_modes(beam, bending, weight, rotary)
    if held_lam[0] <= 1e-9 * bending:
        raise UnstableError("the column buckles under its own weight")
    beta = 2.0 * zeta / float(np.sqrt(held_lam[0]))  # 2 zeta/omega_1 of the held column
    M = beam.mass + rotary * beam.rotary
    K = bending * beam.stiffness - weight * beam.weight
    lam, phi = free_modes(beam, bending, weight, rotary, 0.0)
    c = beta * np.where(lam > 0.0, lam, 0.0)
    mobile = solve(M, np.eye(N)[:, 0], assume_a="pos")  # M^-1 e_0

    lams, cs = np.ones((2, N)), np.zeros((2, N))
    bu, th, top, row, row_v = (np.zeros((2, N)) for _ in range(5))
    lams[1], cs[1] = lam, c
    bu[1], th[1], top[1] = beam.uniform @ phi, phi[0], beam.tip @ phi
    row[1] = phi[0]
    r_a = 0.0
    T = np.zeros((N, N))
    if spring is None:
        lams[0, : N - 1], cs[0, : N - 1] = held_lam, beta * held_lam
        bu[0, : N - 1], top[0, : N - 1] = beam.uniform[1:] @ held, beam.tip[1:] @ held
        T[:, : N - 1] = phi.T @ M[:, 1:] @ held
        pull = mobile / mobile[0]
        row[0, : N - 1] = (pull @ K[:, 1:]) @ held
        # C = beta (K - lam_r M phi_r phi_r' M): the rocking mode is not damped
        rocking = lam <= 0.0
        undamped = (phi[0, rocking] * lam[rocking] / mobile[0]) @ T[rocking][:, : N - 1]
        row_v[0, : N - 1] = beta * (row[0, : N - 1] - undamped)
        r_a = float(pull @ beam.uniform) / length
    else:
        on_spring, shape = free_modes(beam, bending, weight, rotary, spring)
        if on_spring[0] <= 0.0:
            raise UnstableError("the base is too soft to keep the column upright")
        lams[0] = on_spring
        cs[0] = beta * np.maximum(on_spring - spring * shape[0] ** 2, 0.0)
        bu[0], th[0], top[0] = beam.uniform @ shape, shape[0], beam.tip @ shape
        row[0] = shape[0]
        T[...] = phi.T @ M @ shape
    kappa = float(beam.uniform[1:] @ solve(K[1:, 1:], beam.uniform[1:], assume_a="sym"))
    return Modes(lams, cs, bu, th, top, row, row_v, r_a, T, float(mobile[0]), kappa)
