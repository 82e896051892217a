"""Where a number stands in the vectors of the frame kernels."""

from __future__ import annotations

# one case
(
    LENGTH, AXIAL, BENDING, COROTATIONAL, BASE, YIELD_MOMENT, YIELD_ROTATION, ALPHA, KW, HALF_WIDTH, WEIGHT, HINGED,
    G, GRAVITY, DASHPOT, STIFF_DAMPING, ETA_LEFT, ETA_RIGHT, ALPHA_D, TOLERANCE, REARM, UPLIFT, REACH, BARRIER, DT,
    T_MOTION, T_STOP, T_LAST, DT_OUT, FAST, OWN_DURATION, SHUT, Q_STAR, N_PAR,
) = range(34)  # fmt: skip
"""LENGTH of an element [m]; AXIAL = E A, BENDING = E I; COROTATIONAL 1 or 0; BASE kind of base; the base spring's
YIELD_MOMENT and YIELD_ROTATION, ALPHA of its softening branch; KW [N/m^3], HALF_WIDTH b, WEIGHT m g of a Winkler base;
HINGED 1: the base node cannot move vertically; G; GRAVITY 1: weights act as loads (0: the spring contains them);
DASHPOT c of the base [N m s]; STIFF_DAMPING, the factor of the stiffness [s]; ETA_LEFT, ETA_RIGHT restitution;
ALPHA_D of the integrator; TOLERANCE of Newton's increments; REARM rotation beyond which a landing counts again;
UPLIFT rotation at which the body counts as uplifted; REACH length that makes rotations of displacements [m];
BARRIER energy that has to be there to overturn [J]; DT; T_MOTION end of the motion, T_STOP of the report, T_LAST of
the search for the outcome; DT_OUT output spacing, 0 without histories; FAST rate above which an impact is counted;
OWN_DURATION 1: the peaks end with the report; SHUT energy below which the base cannot open any more [J];
Q_STAR rotation whose outward passage is the time of overturning."""

SOFTENING, PLASTIC, WINKLER, FIBRES = 0.0, 1.0, 2.0, 3.0
"""Kinds of base: spring falling as sin(alpha - theta), rigid-plastic spring, quasi-static law of a no-tension elastic
base, discrete no-tension fibres."""

# what a case returns
(
    STATUS, VERDICT, PEAK, PEAK_SIDE, T_PEAK, RATE_PEAK, TOP_PEAK, T_UPLIFT, T_OVERTURN, T_END, N_IMPACTS, N_STORED,
    ENERGY, N_STEPS, ITERATIONS, CUTS, N_RHS, STRUCK_LATER, N_OUT,
) = range(19)  # fmt: skip
"""STATUS; VERDICT; PEAK |theta|, PEAK_SIDE its sign; ENERGY not accounted for [J]; N_STEPS steps that converged;
ITERATIONS of Newton in them; CUTS steps that had to be divided; N_RHS residuals assembled, those of CUTS too;
STRUCK_LATER 1 if it lands beyond the report."""

DONE, NO_CONVERGENCE, NO_STATICS = 0.0, 1.0, 2.0
"""STATUS: solved, a step that no division made converge, no equilibrium to begin with."""

# columns of a history
TH, RATE, U_TOP, V_TOP, U_BENDING, MOMENT, N_HISTORY = range(7)

BAND = 6
"""Stored diagonals of a symmetric matrix."""

# rows of the work space, (N_ROWS, N)
TRIAL, VELOCITY, ACCELERATION, AT_ALPHA, FORCE, REST, INERTIA, DRAG, LOAD, UPRIGHT, BEFORE, N_ROWS = range(12)

# matrices of the work space, (N_BANDS, N, 6)
STIFFNESS, DAMPING, SYSTEM, N_BANDS = range(4)
