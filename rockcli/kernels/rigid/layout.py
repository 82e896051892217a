"""Where a number stands in the vectors that go into and come out of the kernels."""

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

# what a case returns
(
    STATUS, FELL, PEAK, PEAK_SIDE, PEAK_ALPHA, T_PEAK, RATE_PEAK, T_UPLIFT, T_OVERTURN, T_END, N_IMPACTS, MU, N_MIN,
    ENERGY, N_STEPS, ONTO_LEFT, ONTO_RIGHT, IMPACTS_STORED, MU_STANDING, N_STANDING, PEAK_LEFT, PEAK_RIGHT,
    SWINGS, SWINGS_T, N_OUT,
) = range(25)  # fmt: skip
"""STATUS how the run ended; FELL the verdict; PEAK |theta| at its earliest maximum, PEAK_SIDE its sign, PEAK_ALPHA
alpha of that edge; MU, N_MIN over [0, T_END], *_STANDING up to the last outward passage of the equilibrium; ENERGY
not accounted for, over m g; ONTO_* counted impacts that landed on each edge; IMPACTS_STORED of them; PEAK_LEFT,
PEAK_RIGHT largest |theta| to each side (of bodies of two equal edges that of the side of PEAK alone); SWINGS what the
impacts carry, and SWINGS_T the same times their time [s] (`march.MEANINGFUL`; of single-body kernels); the length."""

# a sliding case, and what it returns beside the above
FRICTION, GRAVITY, MOTION_ENDS, REPORT_ENDS, LASTS, SCALE_H, SCALE_V = range(7)
"""mu, g, end of the motion, longest report [s], whether that is the duration asked for, factors of sampled motions."""

SLIDE_PEAK, SLIDE_END, T_FLIGHT, SLIDE_OUT = range(N_OUT, N_OUT + 4)
"""Largest displacement with its sign, that at the end [m], when the normal force vanishes [s]; the length."""
