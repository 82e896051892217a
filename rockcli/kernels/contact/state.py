"""The state of a body between events, and what is known of a step: named values of the contact kernel."""

from __future__ import annotations

from typing import NamedTuple

from rockcli.kernels.contact import parameters as at
from rockcli.kernels.jit import jit


class Settings(NamedTuple):
    """How a case is solved.

    Attributes:
        tol: error of a step over alpha.
        rest_speed: rate over p sin(alpha), the lesser of the two edges, below which bounces may end in rest.
        max_steps: most steps of a case.
        order: of the Taylor series.
        balance: the balance of energy is wanted, for which the work along every step is integrated.
        extremes: peaks of the rate and of the top, and the smallest normal force, are wanted.
        hands_back: a case stops where its foot has held for a while under a sampled motion, for lanes to go on.
    """

    tol: float
    rest_speed: float
    max_steps: int
    order: int
    balance: bool
    extremes: bool
    hands_back: bool


class Scales(NamedTuple):
    """Sizes by which a case's numbers are small: frequencies of its edges, the weaker one's alpha and R.

    Attributes:
        p_min, p_max: [rad/s].
        alpha_min: [rad].
        R_min: [m].
        small: error of an angle [rad].
        speed: error of a slip velocity [m/s].
    """

    p_min: float
    p_max: float
    alpha_min: float
    R_min: float
    small: float
    speed: float


class Foot(NamedTuple):
    """A body on the ground: on one edge, or flat with q = v = 0.

    Attributes:
        s: sign of theta: -1 left, +1 right.
        sigma: sign of the slip velocity, present or about to be; without meaning where the foot holds.
        q: |theta| [rad].
        v: its rate [rad/s].
        u: slip velocity of the edge [m/s].
        place: slide of the base [m].
    """

    s: float
    sigma: float
    q: float
    v: float
    u: float
    place: float


class Air(NamedTuple):
    """A body in flight.

    Attributes:
        x: of the centre of mass, as `place` counts it [m].
        x_rate: [m/s].
        z: height of the centre of mass [m].
        z_rate: [m/s].
        theta: [rad].
        turn: its rate, constant [rad/s].
        touching: edge at which it still is, `codes.NO_EDGE` and following.
    """

    x: float
    x_rate: float
    z: float
    z_rate: float
    theta: float
    turn: float
    touching: int


class Ahead(NamedTuple):
    """What lies ahead of a step.

    Attributes:
        t_next: next breakpoint of the motion, or end [s].
        h: longest step on which the series of the motion are known [s].
        degree: of the motion.
        level: the ground does not move vertically.
        stuck: nothing has moved for a hundred steps: no event may end this one.
    """

    t_next: float
    h: float
    degree: int
    level: bool
    stuck: bool


class Event(NamedTuple):
    """The first event of a step so far.

    Attributes:
        kind: `codes.NO_EVENT` and following.
        x: after which time [s]; NO_ROOT if none.
        way: the direction of a slip or tilt, or the edge that strikes: -1 or +1.
    """

    kind: int
    x: float
    way: float


class Step(NamedTuple):
    """A step of one mode, and what ends it.

    Attributes:
        event, way: as in `Event`.
        x: how long it is [s].
        order, slip_order: of the series of q, and of the velocity along the ground.
        reach: bound of q on it [rad].
    """

    event: int
    way: float
    x: float
    order: int
    slip_order: int
    reach: float


@jit
def edge_under(s):
    """Where the numbers of the edge begin about which a body tilts with sign s."""
    return at.RIGHT if s > 0.0 else at.LEFT


@jit
def edge_beyond(s):
    """Where the numbers of the other edge begin."""
    return at.LEFT if s > 0.0 else at.RIGHT
