"""One column as the kernel wants it: modes, base law, unstable equilibrium, first state (docs/flexible.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from rockcli.errors import SolverError
from rockcli.kernels.column import layout as at
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import RECTANGLE_INERTIA
from rockcli.scene.constants import GREENHILL
from rockcli.solvers.flexible.beam import unit_beam
from rockcli.solvers.flexible.modes import Modes, UnstableError, make_modes

Array = NDArray[np.float64]


class RefusedError(ValueError):
    """A case that is no flexible column, with the sentence."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A column without its motion.

    Attributes:
        modes: of both phases.
        length, width, g: 2h, b [m], gravity [m/s²].
        theta_1: rotation at which a Winkler base opens [rad]; 0 for a rigid base.
        theta_star, barrier: rotation and energy (over m L^2) of the unstable equilibrium [rad, 1/s^2].
    """

    modes: Modes
    length: float
    width: float
    g: float
    theta_1: float
    theta_star: float
    barrier: float


def critical_modulus(rho: float, g: float, h: float, b: float) -> float:
    """Smallest E of a column 2h x 2b that does not buckle under itself [Pa] (Greenhill)."""
    return rho * 2.0 * b * g * (2.0 * h) ** 3 / (GREENHILL * (2.0 * b) ** 3 / 12.0)


def check_upright(batch: Batch, i: int) -> None:
    """Refuse a column that cannot stand: upright it is in equilibrium, too.

    Raises:
        SolverError: column i of the batch buckles under its own weight.
    """
    assert batch.column is not None
    E, rho, g = float(batch.column.E[i]), float(batch.column.rho[i]), float(batch.g[i])
    least = critical_modulus(rho, g, float(batch.block.h[i]), float(batch.block.b[i, 0]))
    if least >= E:
        raise SolverError(f"the column buckles under itself: E = {E:.6g} Pa, at least {least:.5g} Pa is needed")


def key_of(batch: Batch, i: int) -> tuple[float, ...]:
    """What a prepared column depends on: equal keys share it."""
    column, base, block = batch.column, batch.base, batch.block
    assert column is not None
    kw = float(base.kw[i]) if base is not None and base.law == "winkler" else np.inf
    numbers = (column.E[i], column.rho[i], column.zeta[i], batch.g[i], block.h[i], block.b[i, 0], kw)
    return tuple(float(x) for x in numbers)


def prepare(batch: Batch, i: int) -> Prepared:
    """Prepare case i.

    Raises:
        RefusedError: asymmetric or not a rectangle, values that cannot be, self-buckling, base too soft.
    """
    column, block = batch.column, batch.block
    if column is None:
        raise RefusedError("model flexible needs a column: {E, rho}")
    if not block.symmetric[i]:
        raise RefusedError("the flexible column is symmetric: give one b")
    if abs(block.inertia[i, 0] - RECTANGLE_INERTIA) > 1e-12:
        raise RefusedError("the flexible column is a rectangle: inertia and r_g do not apply")
    E, rho, zeta, g, h, b, kw = key_of(batch, i)
    if not (E > 0.0 and rho > 0.0 and zeta >= 0.0 and np.isfinite([E, rho, zeta]).all()):
        raise RefusedError("E and rho must be positive and zeta not negative")
    if not kw > 0.0:
        raise RefusedError("a winkler base needs a positive kw")
    length = 2.0 * h
    winkler = np.isfinite(kw)
    mass = rho * 2.0 * b * length
    theta_1 = mass * g / (2.0 * kw * b * b) if winkler else 0.0
    try:
        modes = make_modes(
            unit_beam(column.elements, column.mass),
            bending=E * (2.0 * b) ** 3 / 12.0 / (mass * length**3),
            weight=g / length,
            rotary=RECTANGLE_INERTIA * (b / length) ** 2,
            zeta=zeta,
            length=length,
            spring=2.0 / 3.0 * kw * b**3 / (mass * length**2) if winkler else None,
        )
    except UnstableError as error:
        least = critical_modulus(rho, g, h, b)
        more = f": E = {E:.6g} Pa, at least {least:.5g} Pa is needed" if "buckles" in str(error) else ""
        raise RefusedError(f"{error}{more}") from None
    theta_star, barrier = _unstable_equilibrium(modes, length, b, g, theta_1)
    return Prepared(modes, length, b, g, theta_1, theta_star, barrier)


def _unstable_equilibrium(modes: Modes, length: float, b: float, g: float, theta_1: float) -> tuple[float, float]:
    """Rotation and energy of the unstable equilibrium, the bending following statically (F7)."""
    full, pull, kappa = g * b / length**2, g / length, modes.kappa

    def slopes(q: Array) -> Array:
        base = full * (1.0 - 2.0 / 3.0 * np.sqrt(theta_1 / q))
        if theta_1 > 0.0:
            base = np.where(q > theta_1, base, full * q / (3.0 * theta_1))
        return np.asarray(base - 0.5 * pull * np.sin(q) - pull**2 * kappa * np.sin(q) * np.cos(q))

    def slope(q: float) -> float:
        return float(slopes(np.array([q]))[0])

    def energy(q: float) -> float:
        base = full * (q - 4.0 / 3.0 * np.sqrt(theta_1 * q) + 0.5 * theta_1)
        return float(base - pull * np.sin(0.5 * q) ** 2 - 0.5 * pull**2 * kappa * np.sin(q) ** 2)

    grid = np.linspace(theta_1, 0.5 * np.pi, 400)[1:]
    values = slopes(grid)
    up = np.flatnonzero(values > 0.0)
    if len(up) == 0:
        fine = np.geomspace(max(theta_1, 1e-9), grid[0], 200)[1:]
        lifted = fine[slopes(fine) > 0.0]
        if len(lifted) == 0:
            raise RefusedError("the column has no upright position it returns to: base or column are too soft")
        lo, hi = float(lifted[-1]), float(grid[0])
    elif up[-1] == len(grid) - 1:
        return 0.5 * np.pi, energy(0.5 * np.pi)
    else:
        lo, hi = float(grid[up[-1]]), float(grid[up[-1] + 1])
    q = float(brentq(slope, lo, hi, xtol=1e-15)) if slope(lo) * slope(hi) < 0.0 else lo
    return q, energy(q)


def first_state(
    column: Prepared, theta: float, theta_dot: float, a_g: float, a_v: float
) -> tuple[int, float, Array, Array]:
    """Phase, side and modal state (z, z') released at a base rotation and rate without bending vibration.

    The ground accelerates by a_g and a_v then [m/s²]; while it falls away the base carries nothing.
    """
    modes = column.modes
    N = modes.lam.shape[1]
    z, v = np.zeros(N), np.zeros(N)
    if theta == 0.0 and theta_dot == 0.0:
        return at.CONTACT, 1.0, z, v
    s = float(np.sign(theta) or np.sign(theta_dot))
    lam, th, bu = modes.lam[1], modes.th[1], modes.bu[1]
    weight = column.g + a_v
    winkler = column.theta_1 > 0.0
    q, theta_1 = abs(theta), max(column.theta_1 * weight / column.g, 0.0)
    moment = (max(weight, 0.0) if winkler else weight) * column.width / column.length**2
    if theta_1 > 0.0:
        moment *= 1.0 - 2.0 / 3.0 * np.sqrt(theta_1 / q) if q > theta_1 else q / (3.0 * theta_1)
    load = (weight * np.sin(theta) - column.g * theta - a_g * np.cos(theta)) / column.length
    bends = lam > 0.0
    z[bends] = (bu[bends] * load - th[bends] * s * moment) / lam[bends]
    rocks = int(np.flatnonzero(~bends)[0])
    z[rocks] = (theta - th[bends] @ z[bends]) / th[rocks]
    v[rocks] = theta_dot / th[rocks]
    if theta_1 > 0.0 and q <= theta_1:
        return at.CONTACT, s, modes.T.T @ z, modes.T.T @ v
    return at.OPEN, s, z, v
