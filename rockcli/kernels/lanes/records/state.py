"""What a lane carries: where its numbers stand."""

from __future__ import annotations

from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.vector import WIDTH

LANES = 256
"""Lanes in flight."""

ORDER = 8
"""Of the polynomials."""

(
    LEN, END, FREE_0, FREE_S, FREE_C, FORCING_C, FORCING_S, SMALL, PEAK, LOOK, WALL,
    Q, V, X, PIECE, CAP, STEPS, H, COEFFICIENTS,
) = (field * WIDTH for field in range(19))  # fmt: skip
SIDE, ETA, FAST, SLOW, SETTLING, IMPACTS, ONTO_LEFT, CASE, STRIDE = (
    COEFFICIENTS + (ORDER + field) * WIDTH for field in range(9)
)
"""Numbers of a lane: state[i + f], i = `place(lane)`.  Those of a vector lie together, so that it comes from the cache
in one piece: first what a step reads, then what it reads and writes or writes alone, then what only events need.

The sample's length, the sample to stop before.  The law (T2) times -p^2, the forcing also times the side and the scale
over g.  Last term allowed; largest q so far; rotation at which to look at the lane: of the equilibrium or beyond it;
rotation at which the body touches the ground again.
Where it is: q, its rate, place in the sample, sample, largest step; steps so far.  Length of the step tried, negative
if it was taken, and its ORDER coefficients c_1, c_2, ...

Sign of theta; restitution; impacts faster than FAST are counted, slower than SLOW may end in rest; least time to rest
over the rate.  Impacts, those onto the left edge; row of the case, -1 if the lane is free.
"""

VECTORS = (LANES // WIDTH + 1) * STRIDE
"""Numbers of all vectors; the last is there to be written to by those that are not full."""

(
    SIN_ALPHA, COS_ALPHA, SHAKE, WEIGHT, LOSS, RATE_MAX, N_LEAST, MU_MOST, WORK, LOST, Q_BEFORE, A_0, A_1, X_HIT,
    SIDE_BEFORE, STEP_WORK, DOUBT, SWINGS, SWINGS_T, FIRST, LAST, DT, MU_HELD, WEAK, UNLIKE, AHEAD,
    INERTIA, WATCHED, LEFT_BEFORE, IMPACTS_BEFORE, STILL, HEAVE, UP_0, UP_1,
) = (VECTORS + field * WIDTH for field in range(34))  # fmt: skip
"""What `forces`, the comparison of runs and clocks need, apart from the rest, so that what a step reads stays together.

sin(alpha), cos(alpha); scale of the motion over R, g/R; energy lost at an impact over m g and its rate squared.
Largest rate, least normal force over m g, largest friction; work of the ground (see `forces`), energy lost over m g.
Of the step tried: q and the ground at its start, its slope [m/s^3]; where it landed and on which side it was; its
work; whether something may be extreme inside it.  What impacts carry, and the same times their time.
Of the body's motion: its first and its last sample, the time between two [s].  Friction that holds its foot; whether it
may give way in the step tried.  Whether its edges differ; LOOK over the rotation of the equilibrium.  R/p^2; whether
forces of two different edges are watched.  Impacts, those onto the left edge, when the body came to its facet.
A sample of zeros, which is that of free rocking.  Scale of the vertical motion over g, 0 without one; of the step tried
that motion at its start, and its slope.
"""

STATE = 2 * VECTORS
"""Numbers in a state."""


@jit
def place(lane):
    """Where the numbers of a lane begin."""
    return lane // WIDTH * STRIDE + lane % WIDTH
