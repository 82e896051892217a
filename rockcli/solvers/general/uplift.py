"""When the ground lifts a body that rests."""

from __future__ import annotations

import math

from rockcli.solvers.general import roots
from rockcli.solvers.general.body import Body
from rockcli.solvers.general.ground import Ground, Piece

PARTS = 16
"""Parts of a smooth piece of the motion, on each of which the ground is a polynomial for the uplift condition."""

ROUNDING = 4e-16
"""A ground that reaches the threshold to machine precision lifts nothing."""


def uplift(body: Body, ground: Ground, piece: Piece, t: float) -> tuple[float, float]:
    """When [s] and to which side the ground lifts the body, from t on; side 0: not before the end of the piece."""
    parts = PARTS if ground.dt == math.inf else 1
    width = (piece.t_b - t) / parts
    for part in range(parts):
        begin = t + part * width
        nodes = [(piece.a_g(x), piece.a_v(x)) for x in (begin + roots.NODES * width).tolist()]
        first: tuple[float, float] | None = None
        for edge in (body.left, body.right):
            slack = ROUNDING * body.g * edge.threshold
            x: float | None = 0.0
            if body.excess(edge, piece.a_g(begin), piece.a_v(begin)) <= slack:
                c = roots.coefficients([slack - body.excess(edge, *a) for a in nodes])
                x = roots.first_below(c)
            if x is not None and (first is None or x < first[0]):
                first = x, edge.sign
        if first is not None:
            return begin + first[0] * width, first[1]
    return piece.t_b, 0.0
