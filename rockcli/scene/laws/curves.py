"""Static curves: what a body and the models that stand for it do when turned slowly, theta in [0, alpha].

All quantities are those of a turn to the right about the edge with the smaller alpha.  Arrays are (n, k): n bodies,
k rotations.  A model's curves follow from its row of scene/laws/models.py; the block's are those of the row `rigid`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rockcli.kernels import formulas
from rockcli.scene.body.block import LEFT, RIGHT, Block
from rockcli.scene.laws.models import MODELS, Law, Model

Array = NDArray[np.float64]

POINTS = 201
"""Rotations of a saved curve, evenly spaced over [0, alpha]."""

BLOCK: Model = MODELS[("rigid", None)]

_ZOOMS = 4
"""Refinements of the place where a curve errs most; each divides the spacing by 100."""


@dataclass(frozen=True)
class Error:
    """A row: the scalar `name` is max |model - block| over [0, alpha], divided by `scale` of the block.

    `scale` is a block's variable and the theta/alpha at which it is read.
    """

    name: str
    model: str
    block: str
    scale: tuple[str, float]


@dataclass(frozen=True)
class Kind:
    """A row: variables of a kind of static curve, and the errors that sum it up."""

    model: tuple[str, ...]
    block: tuple[str, ...]
    errors: tuple[Error, ...]


def _beside_block(name: str, kind: str, *, more: tuple[str, ...] = ()) -> Kind:
    block = f"{name}_block"
    return Kind((name, *more), (block,), (Error(f"curve_error_{kind}", name, block, (block, 0.0)),))


KINDS: dict[str, Kind] = {
    "moment_rotation": _beside_block("restoring_moment", "moment_rotation", more=("spring_moment",)),
    "pushover": _beside_block("pushover_force", "pushover"),
    "displacements": Kind(
        ("u_model", "v_model"),
        ("u_pivot_corner", "v_pivot_corner", "u_free_corner", "v_free_corner"),
        (
            Error("curve_error_displacements", "u_model", "u_free_corner", ("u_free_corner", 1.0)),
            Error("curve_error_displacements_vertical", "v_model", "v_free_corner", ("u_free_corner", 1.0)),
        ),
    ),
    "overturning_moment": _beside_block("overturning_moment", "overturning_moment"),
    "energy_per_cycle": Kind(("energy_ratio",), ("energy_ratio_block",), ()),
}

ENERGY = "energy_per_cycle"
"""The kind that asks for the damping of the case (scene/laws/energy.py), not for its model."""

CRITICAL = "theta_critical_over_alpha"
"""Scalar of `moment_rotation`: the rotation at which the restoring moment vanishes."""


def variables_of(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Variables of the dataset that these kinds of curve bring, in order; () for none."""
    names: list[str] = ["theta_over_alpha"] if kinds else []
    for kind in kinds:
        row = KINDS[kind]
        names += [*row.model, *row.block, *(error.name for error in row.errors)]
        if kind == "moment_rotation":
            names.append(CRITICAL)
    return tuple(names)


def curves_of(kind: str, model: Model, block: Block, ratio: Array) -> dict[str, Array]:
    """The curves of a kind, by variable name, each (n, k).

    Args:
        kind: of KINDS; model: a row of scene/laws/models.py; block: n bodies.
        ratio: theta/alpha, (k,) or (n, k).
    """
    alpha, tan_alpha = (block.of_weak_edge(both)[:, None] for both in (block.alpha, block.tan_alpha))
    theta = alpha * ratio
    if kind == "displacements":
        return _displacements(model, block, theta)
    own, of_block = model.law(alpha, tan_alpha), BLOCK.law(alpha, tan_alpha)
    if kind == "moment_rotation":
        restoring = restoring_moment(own, theta, linear=model.linear)
        return {
            "restoring_moment": restoring,
            "spring_moment": spring_moment(model, own, restoring),
            "restoring_moment_block": restoring_moment(of_block, theta),
        }
    if kind == "pushover":
        return {
            "pushover_force": restoring_moment(own, theta, linear=model.linear) / _lever(own, theta, model.linear),
            "pushover_force_block": np.tan(alpha - theta),  # (2.21)
        }
    return {
        "overturning_moment": _lever(own, theta, model.linear),
        "overturning_moment_block": _lever(of_block, theta, False),
    }


def restoring_moment(law: Law, theta: Array, *, linear: bool = False) -> Array:
    """Moment that turns the body back, over m g R: the left-hand sides of (2.2), (2.3), (2.8)-(2.10)."""
    return np.asarray(formulas.restoring(law.r0, law.rs, law.rc, *_sin_cos(theta, linear)))


def spring_moment(model: Model, law: Law, restoring: Array) -> Array:
    """Moment of the base spring of models 1-4 alone, over m g R; NaN for a body without a spring (Fig. 5).

    A negative stiffness contains the weight; the rigid-plastic spring of the corotational models yields at
    m g R sin(alpha) and leaves the rest to the weight.
    """
    if model.geometry is None:
        return np.full_like(restoring, np.nan)
    return np.broadcast_to(law.r0, restoring.shape).copy() if model.geometry == "corotational" else restoring


def _lever(law: Law, theta: Array, linear: bool) -> Array:
    """Overturning moment over m a_g R, without its sign: cos(alpha - theta) (2.25), cos(alpha) cos(theta) (2.26).

    A static force F at the centroid has the same lever, so F/(m g) is the restoring moment over it: (2.21)-(2.24).
    """
    return np.asarray(formulas.driving(law.fc, law.fs, *_sin_cos(theta, linear)))


def _sin_cos(theta: Array, linear: bool) -> tuple[Array, Array]:
    return (theta, np.ones_like(theta)) if linear else (np.sin(theta), np.cos(theta))


def _displacements(model: Model, block: Block, theta: Array) -> dict[str, Array]:
    """Of the top [m]: the block's corners, and the models' one point (2.13)-(2.20).

    The corner above the pivot and the other, `width` beside it, turn about the pivot; for a rectangle this is

        u_pivot = 2R cos(alpha) sin(theta)                   v_pivot = -2R cos(alpha) (1 - cos(theta))
        u_free = 2R [sin(alpha) - sin(alpha - theta)]        v_free = 2R [cos(alpha - theta) - cos(alpha)]

    which (2.11), (2.12) misprint (docs/curves.md).
    """
    top, width = block.of_weak_edge(block.tops)[:, None], (block.b[:, LEFT] + block.b[:, RIGHT])[:, None]
    u_pivot, v_pivot = top * np.sin(theta), -2.0 * top * np.sin(0.5 * theta) ** 2
    return {
        "u_model": u_pivot,
        "v_model": np.zeros_like(v_pivot) if model.geometry == "negative_stiffness" else v_pivot,
        "u_pivot_corner": u_pivot,
        "v_pivot_corner": v_pivot,
        "u_free_corner": u_pivot + 2.0 * width * np.sin(0.5 * theta) ** 2,
        "v_free_corner": v_pivot + width * np.sin(theta),
    }


def critical_ratio(model: Model, block: Block) -> Array:
    """Rotation at which the restoring moment vanishes, over alpha, (n,); inf if it never does."""
    alpha, tan_alpha = block.of_weak_edge(block.alpha), block.of_weak_edge(block.tan_alpha)
    return np.asarray(model.law(alpha, tan_alpha).q_star / alpha)


def errors_of(kind: str, model: Model, block: Block) -> dict[str, Array]:
    """The errors of a model's curves by name, (n,); zero for the block itself, whose top has two corners."""
    return {error.name: _largest(kind, error, model, block) for error in KINDS[kind].errors}


def _largest(kind: str, error: Error, model: Model, block: Block) -> Array:
    """max |model - block| / scale over [0, alpha], (n,): the best of a grid, then of ever finer ones around it."""
    if model is BLOCK:
        return np.zeros(block.size)
    grid = np.linspace(0.0, 1.0, POINTS)
    ratio = np.broadcast_to(grid, (block.size, POINTS))
    spacing = grid[1]
    worst = np.zeros(block.size)
    for _ in range(1 + _ZOOMS):
        curves = curves_of(kind, model, block, ratio)
        gap = np.abs(curves[error.model] - curves[error.block])
        worst = np.maximum(worst, gap.max(axis=1))
        at = np.take_along_axis(ratio, gap.argmax(axis=1)[:, None], axis=1)
        ratio = np.clip(at + spacing * (2.0 * grid - 1.0), 0.0, 1.0)
        spacing *= 2.0 * grid[1]
    name, where = error.scale
    return np.asarray(worst / curves_of(kind, model, block, np.array([where]))[name][:, 0])
