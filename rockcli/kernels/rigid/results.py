"""Where a number stands in the vector of results of a kernel of one rigid body."""

from __future__ import annotations

(
    STATUS, VERDICT, PEAK, PEAK_SIDE, PEAK_ALPHA, T_PEAK, RATE_PEAK, T_UPLIFT, T_OVERTURN, T_END, N_IMPACTS, MU, N_MIN,
    ENERGY, N_STEPS, ONTO_LEFT, ONTO_RIGHT, IMPACTS_STORED, MU_STANDING, N_STANDING, PEAK_LEFT, PEAK_RIGHT,
    SWINGS, SWINGS_T, STRUCK_LATER, N_OUT,
) = range(26)  # fmt: skip
"""STATUS how the run ended; VERDICT the verdict; PEAK |theta| at its earliest maximum, PEAK_SIDE its sign, PEAK_ALPHA
alpha of that edge; MU, N_MIN over [0, T_END], *_STANDING up to the last outward passage of the equilibrium; ENERGY
not accounted for, over m g; ONTO_* counted impacts that landed on each edge; IMPACTS_STORED of them; PEAK_LEFT,
PEAK_RIGHT largest |theta| to each side (of bodies of two equal edges that of the side of PEAK alone); SWINGS what the
impacts carry, and SWINGS_T the same times their time [s] (`MEANINGFUL`; of single-body kernels); STRUCK_LATER 1 if it
comes down on an edge beyond the report before it falls; the length."""
