"""The mesh: one layer of bricks, and the struts the body stands on (docs/calculix.md, section 1).

x to the right, y up, z out of the plane; the origin is the middle of the base.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A structured mesh of a rectangle, one brick deep.

    Attributes:
        across, along: number of elements in x and y.
        depth: extent in z [m]; in plane stress nothing but the total mass depends on it.
        nodes: coordinates, (n, 3) [m]; the first half has z = 0, the second z = depth; numbered from 1 in the deck.
        bricks: nodes (from 0) of each element, (across * along, 8), in the order of C3D8.
        base: nodes of the base with z = 0, from left to right, (across + 1,).
        share: length of the base each of them stands for, (across + 1,) [m].
        top: nodes of the top left and the top right corner with z = 0, (2,).
    """

    across: int
    along: int
    depth: float
    nodes: Array
    bricks: Index
    base: Index
    share: Array
    top: Index

    @property
    def layer(self) -> int:
        """Nodes of one layer: node i of the front is tied to node i + layer of the back."""
        return len(self.nodes) // 2

    @property
    def x_base(self) -> Array:
        """Positions of the base nodes, (across + 1,) [m]."""
        return np.asarray(self.nodes[self.base, 0])


def make_mesh(height: float, width: float, across: int, along: int) -> Mesh:
    """Mesh of a body `height` x `width` [m] with `along` x `across` elements, as deep as an element is wide."""
    depth = width / across
    x, y = np.linspace(-0.5 * width, 0.5 * width, across + 1), np.linspace(0.0, height, along + 1)
    plane = np.column_stack([np.tile(x, along + 1), np.repeat(y, across + 1)])
    layer = len(plane)
    nodes = np.vstack([np.column_stack([plane, np.full(layer, z)]) for z in (0.0, depth)])
    row, column = np.divmod(np.arange(across * along), across)
    corner = row * (across + 1) + column
    front = np.column_stack([corner, corner + 1, corner + across + 2, corner + across + 1])
    share = np.full(across + 1, width / across)
    share[[0, -1]] *= 0.5
    return Mesh(
        across=across,
        along=along,
        depth=depth,
        nodes=nodes,
        bricks=np.hstack([front, front + layer]),
        base=np.arange(across + 1),
        share=share,
        top=np.array([layer - across - 1, layer - 1]),
    )
