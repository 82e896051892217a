"""Numbers on which kernels and solvers agree: how a run ended, what becomes of a body, what counts as an impact."""

from __future__ import annotations

DONE, OUT_OF_STEPS, NOT_FINITE, LEFT_TO_MARCH, GIVES_WAY, HOLDS = range(6)
"""How a run ended; LEFT_TO_MARCH: lanes leave the case to the kernel of a single body.  Two that end on the way:
GIVES_WAY, lanes stop as the foot may, HOLDS, the kernel of contact does as it holds again."""

RETURNS, FALLS, UNDECIDED, NOT_YET, NO_ANSWER = 0, 1, 2, -1, -2
"""The verdict: what becomes of a body left alone.  UNDECIDED: rounding decides; NOT_YET: only going on can tell;
NO_ANSWER: the run broke off."""

FAST = 1e-6
"""Impacts faster than this fraction of p alpha are counted."""

STANDSTILL = 1e-13
"""Impacts slower than this fraction of p alpha end in rest whatever eta is."""

PUSH = 1e-12
"""A body that is lifted and dropped again and again at one instant rests for this part of what is left of the piece,
ten times as long each time that this comes to nothing."""

DUE = 1e-12
"""An output time i dt_out that is later than an instant by no more than this fraction of it is that instant."""

NO_EVENT, LANDS, TOPPLES, TOUCHES = range(4)
"""What ends a step of a body that does not slip: its length; theta is 0 again, or a facet lies flat; pi/2 is reached;
the next facet touches, after the last one the side of the body."""

STALLED = 100
"""Steps at one instant after which no event is heeded any more."""

NO_ROOT = -1.0
"""In place of the root of a guard that has none on the step."""

MAX_ORDER = 30
"""Highest order of a Taylor step."""

PATIENCE = 60.0
"""A damped body near the separatrix is followed this many 1/p beyond the report."""

MEANINGFUL = 1e-2
"""Impacts slower than this fraction of p alpha say nothing about where a body goes: an impact carries (v/p alpha)^2
less this squared, so that one just as slow changes nothing."""

ILL_POSED = 2e-3
"""A body that comes down from flight tilted less than this fraction of alpha lands on an edge that nobody can tell."""

SAME = 1.0 + 4.0 * 2.220446049250313e-16
"""mu and tan(alpha), computed in two ways, are the same number up to this factor: the body slides."""

STRICTER = 0.1
"""Part of the tolerance of a body on two edges that a step of one that rolls may use: the energy, told over the least
barrier, has more steps between more impacts to gather errors from."""
