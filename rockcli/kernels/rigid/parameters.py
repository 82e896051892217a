"""Where a number stands in the vector of parameters that a kernel of one rigid body takes."""

from __future__ import annotations

# one edge of the body, from its offset on
(
    P2, ALPHA, R0, RS, RC, FC, FS, THRESHOLD, Q_STAR, SLOPE, ETA, DAMPER, RADIUS, EDGE,
) = range(14)  # fmt: skip
"""p^2; alpha; the law's five coefficients; uplift |a_g|/(g + a_v); rotation of zero restoring moment and the slope
of the restoring law there; restitution when landing on this edge; base damper c/I_O; R; then the length."""

# a case: g, the two edges, then
G, LEFT, RIGHT = 0, 1, 1 + EDGE
THETA_0, THETA_DOT_0, T_MOTION, T_STOP, HAS_DURATION, FACTOR_H, FACTOR_V, N_PAR = range(1 + 2 * EDGE, 9 + 2 * EDGE)
"""T_MOTION end of the motion, T_STOP end of the report [s]; FACTOR_* multiply sampled motions; the length."""
