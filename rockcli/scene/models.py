"""The models: what restores and what drives a rocking body, one row of a table each.

In bounce coordinates q = |theta|, s = sgn(theta), every law of the source has the form

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
    """Coefficients of a model for given alpha; all of alpha's shape (module docstring)."""

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


def _rigid(alpha: Array, tan_alpha: Array) -> Law:
    sin, cos = np.sin(alpha), np.cos(alpha)
    return Law(r0=0.0 * alpha, rs=-cos, rc=sin, fc=cos, fs=sin, q_star=alpha, threshold=tan_alpha)


def _linearized(alpha: Array, tan_alpha: Array) -> Law:
    one = np.ones_like(alpha)
    return Law(r0=alpha, rs=-one, rc=0.0 * one, fc=one, fs=0.0 * one, q_star=alpha, threshold=alpha)


_ROWS: tuple[Model, ...] = (
    Model(
        "rigid",
        None,
        False,
        _rigid,
        "the rigid block, exact for any slenderness; no sliding, no bouncing",
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
)

MODELS: dict[tuple[str, str | None], Model] = {(row.name, row.geometry): row for row in _ROWS}

MODEL_NAMES: tuple[str, ...] = tuple(dict.fromkeys(row.name for row in _ROWS))
