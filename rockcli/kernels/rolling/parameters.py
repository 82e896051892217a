"""Where a number stands in the vectors of parameters that the kernel of a rolling body takes."""

from __future__ import annotations

# one end of a facet, from its offset on
P2, ALPHA, SIN, COS, RADIUS, EXTENT, RISE, ETA, B, END = range(10)
"""p^2 over g; alpha, its sine and cosine; R; turn to the next facet on that side, and how far the centre of mass
rises by it over R; restitution when landing on this end; its distance from the foot of the centre of mass; then the
length."""

# one facet
TILT, HEIGHT, LEFT, RIGHT, FACET = 0, 1, 2, 2 + END, 2 + 2 * END
"""theta at which it lies flat; height of the centre of mass above it; its two ends; the length."""

# a body
COUNT, STANDING, FALL_LEFT, FALL_RIGHT, SCALE, LOSSLESS = range(6)
"""Facets; that on which it stands; theta of the last barriers; rotation that errors are told by; 1 if nothing is lost
at impacts."""

VALLEY, LOWEST, TOP, SWAY, KEEP_LEFT, KEEP_RIGHT, FIRST = range(6, 13)
"""What decides early: the one facet between the last barriers that can carry it, -1 if there are more; height of the
centre of mass above the lowest facet there, and that of the lower of the last barriers; the largest R/sqrt(I/m); part
of the rate that impacts beyond the last barrier on each side leave, 0 where a facet there can carry it.  Then its first
facet."""

# a case
G, BODY, THETA_0, THETA_DOT_0, T_MOTION, T_STOP, HAS_DURATION, FACTOR_H, FACTOR_V, N_PAR = range(10)
"""BODY the row of the body; T_MOTION end of the motion, T_STOP end of the report [s]; FACTOR_* multiply sampled
motions; the length."""
