"""Where a number stands in the row with which lanes and the kernel of contact hand a body over to each other."""

from __future__ import annotations

T, SIDE, Q, V, SLIDE, MU, N_HANDOVER = range(7)
"""Time [s], negative: the body begins as its parameters have it; sign of theta, |theta| [rad] and its rate, of a foot
that holds or may just give way; slide of the base [m]; friction at rest; the length."""
