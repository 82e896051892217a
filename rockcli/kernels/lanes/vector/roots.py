"""Guards of a vector of lanes: first roots and turning points of Taylor polynomials, all lanes at once.

Coefficients of order k stand at [k * WIDTH].  A lane that has found its root stays as it is while others go on.
"""

from __future__ import annotations

from rockcli.kernels.constants import NO_ROOT
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.vector import WIDTH
from rockcli.kernels.lanes.vector.plain import fma, load, select, some, spread, sqrt

LOST = -2.0


@jit
def first_root(c, n, h):
    """(x, slope there): smallest x in [0, h] where the polynomial is not positive, NO_ROOT if there is none.

    As `roots.first_root`: |P''| <= M gives a lower bound whose zero cannot pass a root and is Newton's near one.
    LOST: not found in many steps.
    """
    M = spread(0.0)
    for k in range(n, 1, -1):
        M = fma(M, h, (k * (k - 1)) * abs(load(c, k * WIDTH)))
    x, found = spread(0.0), spread(LOST)
    going = h >= 0.0
    for _ in range(200):
        P = load(c, n * WIDTH)
        dP = spread(0.0)
        for k in range(n - 1, -1, -1):
            dP = fma(dP, x, P)
            P = fma(P, x, load(c, k * WIDTH))
        root = sqrt(abs(fma(dP, dP, 2.0 * M * P)))
        step = select(dP > 0.0, dP + root, 2.0 * P) / select(dP > 0.0, M, root - dP)
        there = P <= 0.0
        gone = ~there & ~(step <= h - x)
        last = (step <= 4e-16 * x) | (
            M * step * step <= 4e-16 * (x + step) * abs(dP)
        )  # its own error is below rounding
        near = ~there & ~gone & last
        x = select(going & near, x + step, x)
        found = select(going & (there | near), select(x < h, x, h), found)
        found = select(going & gone, NO_ROOT, found)
        going = going & ~(there | gone | near)
        if not some(going):
            break
        x = select(going, x + step, x)
    dP = n * load(c, n * WIDTH)
    for k in range(n - 1, 0, -1):
        dP = fma(dP, x, k * load(c, k * WIDTH))
    return found, dP


@jit
def turning_point(c, n, lo, hi):
    """(x, value there) where P' changes sign from > 0 at lo to <= 0 at hi: Newton kept inside the bracket."""
    x = 0.5 * (lo + hi)
    top = spread(0.0)
    going = lo <= hi
    for _ in range(60):
        P = load(c, n * WIDTH)
        dP, ddP = spread(0.0), spread(0.0)
        for k in range(n - 1, -1, -1):
            ddP = fma(ddP, x, dP)
            dP = fma(dP, x, P)
            P = fma(P, x, load(c, k * WIDTH))
        top = select(going, P, top)
        lo = select(dP > 0.0, x, lo)
        hi = select(dP > 0.0, hi, x)
        new = x - dP / (2.0 * ddP)
        inside = (lo < new) & (new < hi)
        new = select(inside, new, 0.5 * (lo + hi))
        far = abs(new - x) > 1e-9 * hi  # Newton: the next error is the square of this, and P is stationary
        x = select(going, new, x)
        going = going & far
        if not some(going):
            break
    return x, top
