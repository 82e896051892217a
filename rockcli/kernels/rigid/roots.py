"""Guards: the first root of a Taylor polynomial, never overshot."""

from __future__ import annotations

import math

from rockcli.kernels.constants import NO_ROOT
from rockcli.kernels.jit import jit, jit_part
from rockcli.kernels.rigid.series import bend, slope, value

SQUARED = 1e-9
"""A step of Newton this small, relative, is the last: the next would be about its square."""


@jit
def safe_step(P, dP, M):
    """Zero y > 0 of the lower bound P + dP y - M y^2/2, P >= 0; infinite if it has none."""
    root = math.sqrt(dP * dP + 2.0 * M * P)
    if dP > 0.0:
        return (dP + root) / M if M > 0.0 else math.inf
    return 2.0 * P / (root - dP) if root > dP else math.inf


SLOW = 400
"""Steps after which the bound of the curvature on all of [0, h] is too coarse where the search stands."""

STEPS = 10 * SLOW
"""Steps after which a search ends where it stands."""


@jit
def curvature(c, n, skip, h):
    """Bound of |P''| on [0, h] of the P of `first_root`."""
    M = 0.0
    for k in range(n - skip, 1, -1):
        M = M * h + k * (k - 1) * abs(c[k + skip])
    return M


@jit
def first_root(c, n, h, skip):
    """Smallest x in (0, h] where P(x) = c[skip] + c[skip+1] x + ... reaches zero from above, or NO_ROOT.

    `skip` leading coefficients are known to be zero: a root at x = 0 is divided out, so that an event just
    handled is not found again.  P(0) must be positive.  |P''| <= M on [0, h] gives the lower bound
    P(x) + P'(x) y - M y^2/2: stepping to its zero cannot pass a root, and is Newton's step near one.  A search that
    hardly moves looks at twice as far as it has come, with the bound of that, and so on.
    """
    m = n - skip
    x, far, M = 0.0, h, curvature(c, n, skip, h)
    for i in range(STEPS):
        if i >= SLOW and i % SLOW == 0 and 2.0 * x < far:
            far = 2.0 * x
            M = curvature(c, n, skip, far)
        P = c[n]
        dP = 0.0
        for k in range(m - 1, -1, -1):
            dP = dP * x + P
            P = P * x + c[k + skip]
        if P <= 0.0:
            return min(x, h)
        step = safe_step(P, dP, M)
        if not step <= far - x:  # also where the bound has no zero
            if far == h:
                return NO_ROOT
            x, far = far, min(2.0 * far, h)
            M = curvature(c, n, skip, far)
            continue
        x += step
        if step <= 4e-16 * x or M * step * step <= 4e-16 * x * abs(dP):  # the step's own error is below rounding
            return min(x, h)
    return min(x, h)


@jit_part
def zeros_before(c, n):
    """How many leading coefficients of P are zero before a positive one, or -1 if the first other one is not."""
    if c[0] != 0.0:
        return 0
    skip = 1
    while skip < min(n, 4) and c[skip] == 0.0:
        skip += 1
    return -1 if c[skip] <= 0.0 else skip


@jit
def turning_point(c, n, lo, hi):
    """Root of P' in [lo, hi] where P' > 0 at lo and <= 0 at hi: Newton kept inside the bracket."""
    x = 0.5 * (lo + hi)
    for _ in range(60):
        f = slope(c, n, x)
        if f > 0.0:
            lo = x
        else:
            hi = x
        df = bend(c, n, x)
        new = x - f / df if df != 0.0 else lo
        near = abs(new - x) <= SQUARED * abs(new)
        if not lo < new < hi:
            new = 0.5 * (lo + hi)
            near = abs(new - x) <= 4e-16 * abs(new)
        if near:
            return new
        x = new
    return x


@jit
def passage(c, n, level, lo, hi):
    """Root of P - level in [lo, hi] where P < level at lo and >= level at hi."""
    x = 0.5 * (lo + hi)
    for _ in range(60):
        f = value(c, n, x) - level
        if f < 0.0:
            lo = x
        else:
            hi = x
        df = slope(c, n, x)
        new = x - f / df if df != 0.0 else lo
        near = abs(new - x) <= SQUARED * abs(new)
        if not lo < new < hi:
            new = 0.5 * (lo + hi)
            near = abs(new - x) <= 4e-16 * abs(new)
        if near:
            return new
        x = new
    return x


@jit
def last_passage(c, n, level, x, parts):
    """Last upward passage of P through level on (0, x], or NO_ROOT.

    Between looks at `parts` places a dip below level and back is found by its lowest point.
    """
    found = NO_ROOT
    lo, P_lo, v_lo = 0.0, c[0], c[1]
    for j in range(1, parts + 1):
        hi = x * j / parts
        P_hi, v_hi = value(c, n, hi), slope(c, n, hi)
        if P_hi >= level:
            if P_lo < level:
                found = passage(c, n, level, lo, hi)
            elif v_lo < 0.0 < v_hi:
                bottom = lowest_point(c, n, lo, hi)
                if value(c, n, bottom) < level:
                    found = passage(c, n, level, bottom, hi)
        elif P_lo < level and v_lo > 0.0 > v_hi:
            top = turning_point(c, n, lo, hi)
            if value(c, n, top) >= level:
                found = passage(c, n, level, lo, top)
        lo, P_lo, v_lo = hi, P_hi, v_hi
    return found


@jit
def lowest_point(c, n, lo, hi):
    """Root of P' in [lo, hi] where P' < 0 at lo and > 0 at hi, by bisection to a millionth of the bracket."""
    for _ in range(20):
        mid = 0.5 * (lo + hi)
        if slope(c, n, mid) < 0.0:
            lo = mid
        else:
            hi = mid
    return 0.5 * (lo + hi)


@jit
def uplift(d, n, h, scale):
    """First x in [0, h] where the guard polynomial d turns negative for good, or NO_ROOT.

    d is threshold minus driving acceleration, positive at rest.  A touch of zero that rounding of `scale`
    cannot tell from none is not an uplift: at least the tangent must promise to go below.
    """
    if d[0] < 0.0:
        return 0.0
    noise = 1e-15 * scale  # rounding of a polynomial of terms up to twice the threshold
    x, far, M = 0.0, h, curvature(d, n, 0, h)
    for i in range(2 * STEPS):
        if i >= 5 * SLOW and i % SLOW == 0 and 2.0 * x < far:  # as `first_root`
            far = 2.0 * x
            M = curvature(d, n, 0, far)
        P = value(d, n, x)
        dP = slope(d, n, x)
        if -noise > P:
            return x
        if noise >= P:
            if dP < 0.0 and dP * dP > 8.0 * M * noise:
                return x
            step = math.sqrt(8.0 * noise / M) if M > 0.0 else math.inf
        else:
            step = safe_step(P, dP, M)
        if not step <= far - x:
            if far == h:
                return NO_ROOT
            x, far = far, min(2.0 * far, h)
            M = curvature(d, n, 0, far)
            continue
        x += step
        if step <= 4e-16 * x:
            return x
    return x
