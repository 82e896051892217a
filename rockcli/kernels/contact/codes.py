"""What the contact kernel's whole numbers mean: modes of contact, events, what a mode is chosen for, edges."""

from __future__ import annotations

REST, SLIDE, ROCK, SLIDE_ROCK, FLIGHT = range(5)
"""Modes of contact, as the history `contact_mode` has them."""

JAM, NEITHER = -1, -2
"""In place of a mode: no finite force is consistent (K13); slip and flight both are, flight is taken."""

NO_EVENT, LANDS, TOPPLES, SLIPS, LEAVES, STOPS, JAMS, LIFTS, STRIKES, DIVERGES = range(10)
"""What ends a step.  In order: its length; theta is 0 again; pi/2 is reached; a foot that held gives way; the normal
force vanishes; a slip ends; no finite force lets it slide on; a body at rest tips; a corner meets the ground from
flight; the series is not finite."""

SETTLED, ON_EDGE, ON_BASE = range(3)
"""What the next mode is to be chosen for; SETTLED: nothing, it holds."""

NO_EDGE, LEFT_EDGE, RIGHT_EDGE, BOTH_EDGES = range(4)
"""Edges from which a body in flight has not yet moved away."""
