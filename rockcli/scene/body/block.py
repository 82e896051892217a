"""The body: a planar rigid body on two edges, and the quantities that follow from its geometry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rockcli.scene.body.scan import Scan
from rockcli.scene.repeated import once, repeated

Array = NDArray[np.float64]

LEFT, RIGHT = 0, 1
"""Column of the edge the body turns about: LEFT while theta < 0, RIGHT while theta > 0."""

RECTANGLE_INERTIA = 4.0 / 3.0
"""I_O / (m R^2) of a rectangular block about its edge (2.1)."""


@dataclass(frozen=True, eq=False)
class Block:
    """`n` bodies.  Two-column arrays hold the left edge in column 0, the right in column 1.

    Attributes:
        h: height of the centre of mass above the base, above its middle where the support is tilted, (n,) [m].
        b: horizontal distance from the centre of mass to each edge, (n, 2) [m].
        tan_alpha: b/h of each edge exactly as given, (n, 2); alpha = atan(b/h), (n, 2) [rad].
        R: distance from each edge to the centre of mass, (n, 2) [m].
        inertia: I_O/(m R^2) about each edge, (n, 2).
        top: height of the point whose displacement is reported, as h, (n,) [m].
        mass: (n,) [kg], NaN where the study gives none.
        mu: coefficient of friction of the base, at rest, (n,), NaN where the study gives none.
        mu_kinetic: the same in motion, (n,), NaN: as at rest.
        e_n: restitution of a corner that strikes the ground from flight, (n,), NaN: none given, it stays down.
        rise: height of the right edge above the left one, on a tilted support, (n,) [m].
        outline: points of its polygons, (n, points, 2) [m], x from the centre of mass, z from the base, NaN between two
            polygons; None for a body of no outline.
        vertices: of its lower convex outline where it rolls over more than two, (n, v, 2) [m], from the centre of mass,
            left to right, NaN after the last; None where all stand on two edges.  The edges are those of the base then.
        scan: the surface that the bodies are of, None for those of none; direction: in which each rocks, (n,) [rad].
    """

    h: Array
    b: Array
    tan_alpha: Array
    alpha: Array
    R: Array
    inertia: Array
    top: Array
    mass: Array
    mu: Array
    mu_kinetic: Array
    e_n: Array
    rise: Array
    outline: Array | None = None
    vertices: Array | None = None
    scan: Scan | None = None
    direction: Array | None = None

    @property
    def rolls(self) -> NDArray[np.bool_]:
        """Which bodies roll over more than two vertices, (n,)."""
        if self.vertices is None:
            return np.zeros(self.size, dtype=bool)
        return np.asarray(np.isfinite(self.vertices[:, :, 0]).sum(axis=1) > 2)

    @property
    def r_g2(self) -> Array:
        """Radius of gyration about the centre of mass, squared, (n,) [m^2]."""
        return np.asarray((self.inertia[:, LEFT] - 1.0) * self.R[:, LEFT] ** 2)

    @property
    def mu_in_motion(self) -> Array:
        """Coefficient of friction of a base that slides, (n,): `mu_kinetic`, or that at rest."""
        return np.where(np.isnan(self.mu_kinetic), self.mu, self.mu_kinetic)

    @property
    def mass_or_1(self) -> Array:
        """Mass, (n,) [kg]; 1 where none is given, so that forces and moments are those per unit mass."""
        return np.where(np.isfinite(self.mass), self.mass, 1.0)

    @property
    def size(self) -> int:
        """Number of bodies."""
        return len(self.h)

    @cached_property
    def symmetric(self) -> NDArray[np.bool_]:
        """Where both edges are equally far from the centre of mass and equally high, (n,)."""
        return once(lambda b, rise: (b[:, LEFT] == b[:, RIGHT]) & (rise == 0.0), self.b, self.rise)

    @property
    def heights(self) -> Array:
        """Height of the centre of mass above each edge, (n, 2) [m]."""
        return _heights(self.h, self.rise)

    @property
    def tops(self) -> Array:
        """Height of the point whose displacement is reported above each edge, (n, 2) [m]."""
        return _heights(self.top, self.rise)

    @cached_property
    def weak(self) -> NDArray[np.intp]:
        """Column of the edge with the smaller alpha, (n,): the one that uplifts first.

        The symbols `R alpha tan_alpha b p` of an asymmetric body are those of this edge.
        """
        return once(lambda tan_alpha: np.argmin(tan_alpha, axis=1), self.tan_alpha)

    def of_weak_edge(self, both: Array) -> Array:
        """Pick the weak edge's column of a (n, 2) array: (n,)."""
        return once(lambda weak, both: np.where(weak == LEFT, both[:, LEFT], both[:, RIGHT]), self.weak, both)

    def p(self, g: Array) -> Array:
        """Frequency parameter of each edge, p = sqrt(m g R / I_O) (2.2), (n, 2) [rad/s]."""
        return once(lambda g, inertia, R: np.sqrt(g[:, None] / (inertia * R)), g, self.inertia, self.R)

    def repeated(self, n: int) -> Block:
        """One body for n cases, or bodies that are as many already."""
        if self.size == n:
            return self
        arrays: dict[str, Any] = {
            f.name: repeated(value, n) for f in fields(self) if isinstance(value := getattr(self, f.name), np.ndarray)
        }
        return replace(self, **arrays)


def make_block(
    *,
    h: ArrayLike,
    b: ArrayLike,
    R: ArrayLike | None = None,
    alpha: ArrayLike | None = None,
    tan_alpha: ArrayLike | None = None,
    inertia: ArrayLike | None = None,
    r_g: ArrayLike | None = None,
    top: ArrayLike | None = None,
    mass: ArrayLike | None = None,
    mu: ArrayLike | None = None,
    mu_kinetic: ArrayLike | None = None,
    e_n: ArrayLike | None = None,
    rise: ArrayLike = 0.0,
    n: int = 1,
) -> Block:
    """Build `n` bodies from height and edge distances.

    `b` is one number (or (n,)) for a symmetric body, (2,) or (n, 2) for [left, right].  `R`, `alpha`
    and `tan_alpha` may be passed beside them so that a value the user gave is kept to the last bit;
    they are ignored for asymmetric bodies.  `inertia` is I_O/(m R^2) (symmetric bodies only),
    `r_g` the radius of gyration about the centre of mass [m].  Without either the body is a
    rectangle: I_O = 4/3 m R^2 (2.1); an asymmetric one then has the radius of gyration of the
    rectangle of the same base width and of height 2h.  `rise`: see `Block`.
    """
    h_ = _column(h, n)
    b_ = np.asarray(b, dtype=float)
    if b_.ndim == 0 or (b_.ndim == 1 and b_.shape == (n,) and not (n == 2 and b_.shape == (2,) and R is None)):
        edges = np.repeat(_column(b_, n)[:, None], 2, axis=1)
    else:
        edges = np.ascontiguousarray(np.broadcast_to(b_, (n, 2)))
    rise_ = _column(rise, n)
    symmetric = ((edges[:, LEFT] == edges[:, RIGHT]) & (rise_ == 0.0))[:, None]

    all_symmetric = bool(symmetric.all())

    def kept(given: ArrayLike | None, compute: Callable[[], Array]) -> Array:
        if given is None:
            return compute()
        both = np.repeat(_column(given, n)[:, None], 2, axis=1)
        return both if all_symmetric else np.where(symmetric, both, compute())

    height = _heights(h_, rise_)
    tan_ = kept(tan_alpha, lambda: edges / height)
    alpha_ = kept(alpha, lambda: np.arctan(tan_))
    R_ = kept(R, lambda: np.hypot(edges, height))
    if r_g is not None:
        ratio = 1.0 + (_column(r_g, n)[:, None] / R_) ** 2
    else:
        given = RECTANGLE_INERTIA if inertia is None else _column(inertia, n)[:, None]
        ratio = np.ascontiguousarray(np.broadcast_to(given, (n, 2)))
        if not all_symmetric:
            rectangle = 1.0 + (height**2 + (0.5 * edges.sum(axis=1, keepdims=True)) ** 2) / (3.0 * R_**2)
            ratio = np.where(symmetric, ratio, rectangle)
    return Block(
        h=h_,
        b=edges,
        tan_alpha=tan_,
        alpha=alpha_,
        R=R_,
        inertia=ratio,
        top=2.0 * h_ if top is None else _column(top, n),
        mass=_column(np.nan if mass is None else mass, n),
        mu=_column(np.nan if mu is None else mu, n),
        mu_kinetic=_column(np.nan if mu_kinetic is None else mu_kinetic, n),
        e_n=_column(np.nan if e_n is None else e_n, n),
        rise=rise_,
    )


def housner_eta(block: Block) -> Array:
    """Restitution of an inelastic impact that keeps angular momentum about the new edge, (n, 2).

    Column j is the value when the body lands on edge j coming from edge i:
    eta = [I_cm + m (h_i h_j - b_i b_j)] / (I_cm + m R_j^2); for equal edges 1 - 2 (m R^2/I_O) sin^2(alpha),
    for a rectangle 1 - 1.5 sin^2(alpha) [3.2].  It is negative for tan(alpha) > sqrt 2 (rectangle):
    the caller clamps and says so.
    """
    symmetric = once(lambda alpha, inertia: 1.0 - 2.0 * np.sin(alpha) ** 2 / inertia, block.alpha, block.inertia)
    if block.symmetric.all():
        return symmetric
    I_cm = (block.inertia - 1.0) * block.R**2
    product = (block.b[:, LEFT] * block.b[:, RIGHT])[:, None]
    general = (I_cm + np.prod(block.heights, axis=1)[:, None] - product) / (block.inertia * block.R**2)
    return np.where(block.symmetric[:, None], symmetric, general)


def impulse_ratio(block: Block, eta: Array) -> Array:
    """Ratio of the impulses of an impact, along the ground over up: h (1 - eta)/(b_i + eta b_j) onto edge j, (n, 2)."""
    return np.asarray(block.h[:, None] * (1.0 - eta) / (block.b[:, ::-1] + eta * block.b))


def _heights(h: Array, rise: Array) -> Array:
    if not rise.any():
        return np.repeat(h[:, None], 2, axis=1)
    return h[:, None] + np.array([0.5, -0.5]) * rise[:, None]


def _column(value: ArrayLike, n: int) -> Array:
    return np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=float), (n,)))
