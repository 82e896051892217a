"""Where a number stands in the vector of parameters of the contact kernel."""

from __future__ import annotations

# one edge of the body, from its offset on
B, ALPHA, RADIUS, PLACE, EDGE = range(5)
"""Distance from the centre of mass; alpha; R; where the impulse of a landing on this edge acts, from the middle
towards it (K10) [m]; then the length."""

# a case
G, H, RG2, MU_S, MU_K, E_N, TOP = range(7)
"""g; height of the centre of mass; square of the radius of gyration; friction at rest and in motion; restitution of a
corner that strikes from flight; height of the point whose displacement is reported."""
LEFT, RIGHT = 7, 7 + EDGE
THETA_0, THETA_DOT_0, SLIDE_RATE_0, T_MOTION, T_STOP, HAS_DURATION, FACTOR_H, FACTOR_V, FIRST, N_PAR = range(
    RIGHT + EDGE, RIGHT + EDGE + 10
)
"""Initial state; T_MOTION end of the motion, T_STOP end of the report [s]; FACTOR_* multiply sampled motions; FIRST
the edge that strikes first where a body comes down nearly flat, -1 left, 1 right, 0 as its tilt has it; the length."""
