"""Rows of the work space of the contact kernel: the Taylor series of one step."""

from __future__ import annotations

(
    A_G, WEIGHT, Q, SIN_B, COS_B, RATE, LEAN, NORMAL, FRICTION, STIFFNESS, HELD, TILT, SLIP, HEIGHT, GUARD, PATH, FOUND,
    N_ROWS,
) = range(18)  # fmt: skip
"""The ground's a_g, and W = g + a_v; q, sin and cos of beta = alpha - q, q' and the rate of sin(beta); N and T at the
edge; A of (K5), the numerator of N, sin(beta) - mu sigma_s cos(beta); velocity along the ground, of the foot or in
flight of the centre of mass; height of the centre of mass in flight.  GUARD, PATH and FOUND (extremes) are written over
at every use; the number of rows."""
