"""Where a number stands in the row with which lanes and the kernel of contact hand a body over to each other."""

from __future__ import annotations

T, SIDE, Q, V, U, SLIDE, MU, SINCE, N_HANDOVER = range(9)
"""Time [s], negative: the body begins as its parameters have it; sign of theta, |theta| [rad] and its rate; slip
velocity [m/s], 0 of a foot that holds or may just give way; slide of the base [m]; friction at rest; when it last may
have given way in lanes [s]; the length."""
