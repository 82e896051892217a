"""Points in the unit cube that stand for uncertain inputs: Latin hypercube, Sobol, random, and Saltelli's blocks.

They follow from number, inputs and seed alone, so that they are the same whoever solves which of them.
scipy is imported where it is called, as studies without uncertain inputs need none of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LATIN_HYPERCUBE, SOBOL, RANDOM, SALTELLI = "latin_hypercube", "sobol", "random", "saltelli"

SAMPLINGS: dict[str, str] = {
    LATIN_HYPERCUBE: "Latin hypercube samples",
    SOBOL: "scrambled Sobol points",
    RANDOM: "random samples",
    SALTELLI: "points of Saltelli's design",
}

MOST_INPUTS = 1000


def base_points(sampling: str, n: int, d: int) -> int:
    """Rows of the design: n, or for Saltelli's, whose blocks have d + 2 points for every row, n/(d + 2).

    Raises:
        ValueError: n is none the design can have; says which are nearest.
    """
    block = d + 2 if sampling == SALTELLI else 1
    if sampling in (LATIN_HYPERCUBE, RANDOM):
        return n
    rows = n // block
    if n % block == 0 and rows >= 2 and rows & (rows - 1) == 0:
        return rows
    below = max(2, 1 << max(rows, 1).bit_length() - 1) * block
    what = "powers of 2" if block == 1 else f"{block} (inputs and two) times a power of 2"
    raise ValueError(f"{sampling} points are balanced in numbers that are {what}: {below} or {2 * below}")


def unit_points(sampling: str, n: int, d: int, seed: int) -> Array:
    """(n, d) points inside the unit cube.

    Saltelli's design (Saltelli et al. 2010): blocks A, B, AB_1 ... AB_d one after the other, AB_i being A with the
    column i of B.  A and B are the two halves of one Sobol sequence in 2d dimensions.

    Raises:
        ValueError: as `base_points`.
    """
    from scipy.stats import qmc

    rows = base_points(sampling, n, d)
    rng = np.random.default_rng(seed)
    if sampling == RANDOM:
        points = rng.random((n, d))
    elif sampling == LATIN_HYPERCUBE:
        points = qmc.LatinHypercube(d, seed=rng).random(n)
    elif sampling == SOBOL:
        points = qmc.Sobol(d, seed=rng).random(n)
    else:
        both = qmc.Sobol(2 * d, seed=rng).random(rows)
        a, b = both[:, :d], both[:, d:]
        blocks = np.repeat(a[None], d, axis=0)
        blocks[np.arange(d), :, np.arange(d)] = b.T
        points = np.concatenate([a, b, blocks.reshape(d * rows, d)])
    return np.asarray(np.clip(points, 2.0**-64, 1.0 - 2.0**-53))  # inside: normal laws are infinite at 0 and 1
