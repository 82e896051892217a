"""Models of a rocking body (rigid, linearized, springs 1-4): restoring and driving law, one row of a table each.

In bounce coordinates q = |theta|, s = sgn(theta), every law of the thesis has the form

    q'' = -p^2 [ (1 + a_v/g) (r0 + rs sin q + rc cos q) + s (a_g/g) (fc cos q + fs sin q) ]

(linear: sin q -> q, cos q -> 1), so a model is the five coefficients and the rotation `q_star` at which
the restoring moment vanishes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Law:
    """Coefficients of a model for given alpha; all of alpha's shape (module docstring).

    `q_star` is infinite where the restoring moment never vanishes: such a body cannot overturn.
    """

    r0: Array
    rs: Array
    rc: Array
    fc: Array
    fs: Array
    q_star: Array
    threshold: Array


@dataclass(frozen=True)
class Model:
    """A row: `law(alpha, tan_alpha)` gives the coefficients, `linear` says what sin q stands for.

    `threshold` of the law is the uplift acceleration over g (+ a_v): tan(alpha), or alpha if linear.
    `sentence` says what it is good for; `reference` where it comes from.
    """

    name: str
    geometry: str | None
    linear: bool
    law: Callable[[Array, Array], Law]
    sentence: str
    reference: str

    def slope(self, law: Law) -> Array:
        """|d(restoring moment)/dq| at `q_star`, where the moment vanishes."""
        if self.linear:
            return -law.rs
        q = np.where(np.isfinite(law.q_star), law.q_star, 0.0)
        return np.asarray(law.rc * np.sin(q) - law.rs * np.cos(q))

    def missing(self, law: Law, q: Array) -> Array:
        """Energy missing at q to the unstable equilibrium, over I_O p^2 (T7), of the shape of both together."""
        y = law.q_star - q
        if self.linear:
            return np.asarray(0.5 * self.slope(law) * y**2)
        return np.asarray(law.r0 * (y - np.sin(y)) + 2.0 * self.slope(law) * np.sin(0.5 * y) ** 2)


def _rigid(alpha: Array, tan_alpha: Array) -> Law:
    sin, cos = np.sin(alpha), np.cos(alpha)
    return Law(r0=0.0 * alpha, rs=-cos, rc=sin, fc=cos, fs=sin, q_star=alpha, threshold=tan_alpha)


def _linearized(alpha: Array, tan_alpha: Array) -> Law:
    one = np.ones_like(alpha)
    return Law(r0=alpha, rs=-one, rc=0.0 * one, fc=one, fs=0.0 * one, q_star=alpha, threshold=alpha)


def _negative_stiffness(alpha: Array, tan_alpha: Array) -> Law:
    # the block's restoring moment, the overturning moment -m a_g R cos(alpha) cos(theta) (2.26)
    sin, cos = np.sin(alpha), np.cos(alpha)
    return Law(r0=0.0 * alpha, rs=-cos, rc=sin, fc=cos, fs=0.0 * alpha, q_star=alpha, threshold=tan_alpha)


def _corotational_at_R(alpha: Array, tan_alpha: Array) -> Law:
    # rigid-plastic spring m g R sin(alpha), weight at height R
    sin, one = np.sin(alpha), np.ones_like(alpha)
    return Law(r0=sin, rs=-one, rc=0.0 * one, fc=np.cos(alpha), fs=0.0 * one, q_star=alpha, threshold=tan_alpha)


def _corotational_at_h(alpha: Array, tan_alpha: Array) -> Law:
    # the same spring, weight at height h = R cos(alpha); the moment vanishes at asin(tan alpha), if anywhere
    sin, cos, zero = np.sin(alpha), np.cos(alpha), 0.0 * alpha
    with np.errstate(invalid="ignore"):
        q_star = np.where(tan_alpha <= 1.0, np.arcsin(tan_alpha), np.inf)
    return Law(r0=sin, rs=-cos, rc=zero, fc=cos, fs=zero, q_star=q_star, threshold=tan_alpha)


_ROWS: tuple[Model, ...] = (
    Model(
        "rigid",
        None,
        False,
        _rigid,
        "the rigid block, exact for any slenderness; with block.mu it slides and leaves the ground too",
        "(2.2)",
    ),
    Model(
        "linearized",
        None,
        True,
        _linearized,
        "slender blocks: good to a few per cent for tan(alpha) <= 0.2 away from overturning",
        "(2.3)",
    ),
    Model("1", "negative_stiffness", False, _negative_stiffness, "mass and rotary inertia at height R", "(2.4), (2.8)"),
    Model("1", "corotational", False, _corotational_at_R, "the same with a rigid-plastic spring and P-Delta", "(2.9)"),
    Model("2", "negative_stiffness", False, _negative_stiffness, "rotary inertia alone, driven in rotation", "(2.5)"),
    Model("2", "corotational", False, _corotational_at_h, "the same with a rigid-plastic spring and P-Delta", "(2.10)"),
    Model(
        "3", "negative_stiffness", False, _negative_stiffness, "mass at height h, rotary inertia of the rest", "(2.6)"
    ),
    Model("3", "corotational", False, _corotational_at_h, "the same with a rigid-plastic spring and P-Delta", "(2.10)"),
    Model("4", "negative_stiffness", False, _negative_stiffness, "distributed mass along 2R, rigid", "(2.7), (2.8)"),
    Model("4", "corotational", False, _corotational_at_R, "the same with a rigid-plastic spring and P-Delta", "(2.9)"),
)

MODELS: dict[tuple[str, str | None], Model] = {(row.name, row.geometry): row for row in _ROWS}

DEFAULT_GEOMETRY = "negative_stiffness"
"""Of models 1-4 where a study says none."""

MODEL_NAMES: tuple[str, ...] = tuple(dict.fromkeys(row.name for row in _ROWS))

FLEXIBLE = "flexible"
"""The deformable column (scene/body/column.py, docs/flexible.md): no law of one rotation, so no row; corotational."""

CONTINUUM = "continuum"
"""The same body as a full mesh (docs/calculix.md)."""

DEFORMABLE: tuple[str, ...] = (FLEXIBLE, CONTINUUM)
"""Models of a body with a column."""
