"""Where a number stands in the vectors that go into and come out of the kernels of the flexible column."""

from __future__ import annotations

CONTACT, OPEN = 0, 1
"""Phases: base held (rigid base) or in full contact (Winkler); base rocking on an edge."""

(
    G, LENGTH, WIDTH, THETA_1, ALPHA, P, ETA, REARM, BARRIER, THETA_STAR, H_MAX, H_FREE, T_MOTION, T_STOP,
    HAS_DURATION, FACTOR_H, FACTOR_V, R_A, MOBILITY, TOL, GIVE_UP, PHASE_0, SIDE_0, DETAIL, FINENESS,
    N_PAR,
) = range(26)  # fmt: skip
"""g; 2h; b; rotation at which a Winkler base opens under the weight at rest (0: rigid base); alpha; p; eta;
rotation of an open base that re-arms eta;
energy and rotation of the unstable equilibrium; largest steps with and without ground motion; end of the motion and
of the report; is the duration given; factors of sampled motions; base moment per a_g of the held column;
[M^-1]_00; rounding of theta; free rocking after T_STOP; first phase and side; is the work wanted;
factor of the accuracy level on the steps."""

LAM, DAMPING, UNIFORM, TURN, TOP, ROW, ROW_RATE = range(7)
"""Rows of `modes` of `march`: lam, c; components along uniform load, base rotation, top; the guard's quantity of z, of
z'."""

# what a case returns
(
    STATUS, VERDICT, PEAK, PEAK_SIDE, T_PEAK, RATE_PEAK, U_PEAK, T_UPLIFT, T_OVERTURN, T_END, N_LANDINGS, ENERGY,
    LANDING_LOSS, N_STEPS, N_STORED, CAPTURES, N_RHS, STRUCK_LATER, N_OUT,
) = range(19)  # fmt: skip
"""How it ended; the verdict; largest |theta|, its sign and time; largest rate and top displacement; times; landings
counted; energy not accounted for, and lost where the base caught a re-crossing (both over m L^2); steps; stored
landings; such captures; evaluations of the loads; landings beyond the report."""
