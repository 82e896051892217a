"""Bodies whose two edges differ: what changes in a lane as the body turns over (docs/lanes.md).

One that rolls from vertex to vertex is such a body on the facet it touched last.  The row of its parameters holds the
two ends of that facet, and is written anew as the next one touches.
"""

from __future__ import annotations

import math

from rockcli.kernels.constants import FAST as COUNTED
from rockcli.kernels.jit import jit
from rockcli.kernels.lanes.records import state as lane
from rockcli.kernels.lanes.records.step import HALF_PI
from rockcli.kernels.rigid import parameters as at
from rockcli.kernels.rigid import results as to
from rockcli.kernels.rolling import parameters as of
from rockcli.kernels.rolling import results as also
from rockcli.kernels.rolling.law import push_of

(
    BODY, FACET, TILT, EXTENT_LEFT, EXTENT_RIGHT, FALL_LEFT, FALL_RIGHT, SCALE, RISEN, PUSH_LEFT, PUSH_RIGHT, N_ROLLING,
) = range(at.N_PAR, at.N_PAR + 12)  # fmt: skip
"""What the row of a body that rolls holds beside: the row of its body; the facet, theta when it lies flat, the turn to
the next facet on each side; theta of the last barriers; rotation that errors are told by; height of the centre of mass
over that on the stand; ratio of the impulses of a landing on each of its ends; the length of the row."""

BALLISTIC, BALLISTIC_AFTER = 1e-2, 1e-4
"""Impacts slower than this fraction of p alpha bounce under a constant moment, during the motion and after it."""


@jit
def stand(par, body):
    """Write the facet on which a body stands, and what goes with the body, into its row."""
    par[FALL_LEFT], par[FALL_RIGHT], par[SCALE] = body[of.FALL_LEFT], body[of.FALL_RIGHT], body[of.SCALE]
    put_facet(par, body, int(body[of.STANDING]))


@jit
def put_facet(par, body, facet):
    """Write the ends of a facet into the row of a body that rolls."""
    g, first = par[at.G], of.FIRST + facet * of.FACET
    for e, end in ((at.LEFT, first + of.LEFT), (at.RIGHT, first + of.RIGHT)):
        sine, cosine = body[end + of.SIN], body[end + of.COS]
        par[e + at.P2], par[e + at.ALPHA], par[e + at.RADIUS] = (
            g * body[end + of.P2],
            body[end + of.ALPHA],
            body[end + of.RADIUS],
        )
        par[e + at.RS], par[e + at.RC], par[e + at.FC], par[e + at.FS] = -cosine, sine, cosine, sine
        par[e + at.THRESHOLD], par[e + at.ETA] = sine / cosine, body[end + of.ETA]
    par[FACET], par[TILT] = facet, body[first + of.TILT]
    left, right, height = first + of.LEFT, first + of.RIGHT, body[first + of.HEIGHT]
    par[EXTENT_LEFT], par[EXTENT_RIGHT] = body[left + of.EXTENT], body[right + of.EXTENT]
    par[RISEN] = height - body[of.FIRST + int(body[of.STANDING]) * of.FACET + of.HEIGHT]
    par[PUSH_LEFT] = push_of(height, body[left + of.ETA], body[left + of.B], body[right + of.B])
    par[PUSH_RIGHT] = push_of(height, body[right + of.ETA], body[right + of.B], body[left + of.B])


@jit
def rolls(par):
    """Whether a row of parameters is of a body that rolls."""
    return len(par) > at.N_PAR


@jit
def risen(par):
    """How far the centre of mass stands above where it first stood."""
    return par[RISEN] if rolls(par) else 0.0


@jit
def note_pushes(st, i, par, out):
    """Raise the ratio of the impulses to those of the landings of lane i on the facet it is about to leave."""
    onto_left = st[lane.ONTO_LEFT + i] - st[lane.LEFT_BEFORE + i]
    if onto_left > 0.0:
        out[also.MU_IMPACT] = max(out[also.MU_IMPACT], par[PUSH_LEFT])
    if st[lane.IMPACTS + i] - st[lane.IMPACTS_BEFORE + i] > onto_left:
        out[also.MU_IMPACT] = max(out[also.MU_IMPACT], par[PUSH_RIGHT])
    st[lane.LEFT_BEFORE + i], st[lane.IMPACTS_BEFORE + i] = st[lane.ONTO_LEFT + i], st[lane.IMPACTS + i]


@jit
def scales(par, e, o):
    """What rates are measured by when the body leaves the edge e and lands on the edge o, and the other way round."""
    if rolls(par):
        return math.sqrt(par[o + at.P2]) * par[SCALE], math.sqrt(par[e + at.P2]) * par[SCALE]
    return math.sqrt(par[e + at.P2]) * par[e + at.ALPHA], math.sqrt(par[o + at.P2]) * par[o + at.ALPHA]


@jit
def top_of(par, s, out):
    """Rotation about the edge of side s up to which no peak counts."""
    peak = out[to.PEAK_RIGHT if s > 0.0 else to.PEAK_LEFT]
    if rolls(par):
        return peak - abs(par[TILT]) if s * par[TILT] >= 0.0 else math.inf
    return peak


@jit
def barrier_of(par, s):
    """Rotation about the end of side s at which the last barrier is passed, or -1 where it is not on the way."""
    extent, tilt = par[EXTENT_RIGHT if s > 0.0 else EXTENT_LEFT], par[TILT]
    level = s * (par[FALL_RIGHT if tilt + 0.5 * s * extent > 0.0 else FALL_LEFT] - tilt)
    return level if 0.0 < level < extent else -1.0


@jit
def face(st, i, par, s, out):
    """What goes with the edge of side s of a body whose edges differ, put on that side."""
    e, o = (at.RIGHT, at.LEFT) if s > 0.0 else (at.LEFT, at.RIGHT)
    p2, other2 = par[e + at.P2], par[o + at.P2]
    st[lane.FREE_0 + i], st[lane.FREE_S + i] = -p2 * par[e + at.R0], -p2 * par[e + at.RS]
    st[lane.FREE_C + i] = -p2 * par[e + at.RC]
    st[lane.PEAK + i] = top_of(par, s, out)
    here, there = scales(par, e, o)
    st[lane.FAST + i], st[lane.ETA + i] = COUNTED * here, par[o + at.ETA]
    # what presses it down on either edge, of which a share `sway` is the ground's
    down, down_other = p2 * (par[e + at.R0] + par[e + at.RC]), other2 * (par[o + at.R0] + par[o + at.RC])
    slowest = min(here, there)
    if rolls(par):
        slowest = min(math.sqrt(p2) * par[e + at.ALPHA], math.sqrt(other2) * par[o + at.ALPHA])
        level, wall = barrier_of(par, s), par[EXTENT_RIGHT if s > 0.0 else EXTENT_LEFT]
        st[lane.LOOK + i], st[lane.WALL + i] = math.inf, wall
        if level > 0.0 and st[lane.AHEAD + i] == 1.0:
            st[lane.LOOK + i] = level
            if s * par[TILT] < 0.0:  # it is passed outward as q falls
                st[lane.WALL + i] = level
    else:
        star = par[e + at.Q_STAR]
        st[lane.LOOK + i] = min(st[lane.AHEAD + i] * star, max(star, HALF_PI))
    share = BALLISTIC if st[lane.PIECE + i] <= st[lane.LAST + i] else BALLISTIC_AFTER
    st[lane.SLOW + i] = max(share * slowest, 0.0)
    # the sum of the bounces is least where the ground presses so on the two edges
    k = other2 * par[o + at.FC] / (p2 * par[e + at.FC])
    lost, eta = 1.0 - par[o + at.ETA] * par[e + at.ETA], par[o + at.ETA]
    together = down_other / k + down
    st[lane.SETTLING + i] = 0.0
    if lost > 0.0 and together > 0.0 and k > 0.0:
        st[lane.SETTLING + i] = 2.0 * (1.0 + math.sqrt(eta / k)) ** 2 / (together * lost)
        if st[lane.HEAVE + i] != 0.0:  # gravity may be up to twice what it is
            st[lane.SETTLING + i] *= 0.5
