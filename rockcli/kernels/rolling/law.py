"""One end of a facet, and what its law says of a body that turns about it (docs/rolling.md).

    q'' = -p^2 [ (1 + a_v/g) sin(alpha - q) + s (a_g/g) cos(alpha - q) ]

q is the turn from lying flat on the facet, about its right end where s = 1, about its left one where s = -1.  alpha is
negative at an end on the near side of the foot of the centre of mass.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from rockcli.kernels.jit import jit
from rockcli.kernels.rolling import parameters as at


class End(NamedTuple):
    """What is known of the body while it turns about one end of a facet: `kernels.rolling.parameters`, and g.

    g to `radius` are those of `kernels.rigid.law.Edge`, whose flow, rest and work are those of this body too.
    """

    g: float
    p2: float
    alpha: float
    r0: float
    rs: float
    rc: float
    fc: float
    fs: float
    threshold: float
    damper: float
    radius: float
    extent: float
    rise: float
    eta: float
    b: float
    height: float
    tilt: float


@jit
def end_of(body, g, facet, s):
    """The end of a facet on the side s = 1 or -1."""
    of_facet = at.FIRST + facet * at.FACET
    e = of_facet + (at.RIGHT if s > 0.0 else at.LEFT)
    sine, cosine = body[e + at.SIN], body[e + at.COS]
    return End(
        g, g * body[e + at.P2], body[e + at.ALPHA], 0.0, -cosine, sine, cosine, sine, sine / cosine, 0.0,
        body[e + at.RADIUS], body[e + at.EXTENT], body[e + at.RISE], body[e + at.ETA], body[e + at.B],
        body[of_facet + at.HEIGHT], body[of_facet + at.TILT],
    )  # fmt: skip


@jit
def push_of(height, eta, b, other_b):
    """Ratio of the impulses of a landing, along the ground and up: the body turns from one end of a facet to the other.

    b, other_b: of the end it turns onto and of the one it comes from.
    """
    pushed = other_b + eta * b
    return height * abs(1.0 - eta) / pushed if pushed > 0.0 else math.inf


@jit
def energy(end, q, v):
    """Energy over m g: R v^2/(2 p^2) and the height of the centre of mass above the ground."""
    # R (cos(alpha - q) - cos(alpha)), which is small near q = 0, without cancellation
    risen = 2.0 * end.radius * math.sin(0.5 * q) * math.sin(end.alpha - 0.5 * q)
    return end.radius * 0.5 * v * v / end.p2 + end.height + risen
