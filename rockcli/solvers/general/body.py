"""One case as plain numbers: edges, acceleration (T2 of docs/theory.md), and whether it falls when left alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rockcli.kernels.constants import FALLS, NOT_YET, RETURNS, UNDECIDED
from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT, RIGHT
from rockcli.scene.laws.damping import dashpot_rate
from rockcli.scene.laws.models import MODELS

SIDE = 0.5 * math.pi
"""|theta| of a body that lies on its side."""


@dataclass(frozen=True)
class Edge:
    """What holds while the body turns about one edge: theta < 0 (sign -1) or theta > 0 (sign 1).

    Attributes:
        p, alpha, R: of this edge [rad/s, rad, m].
        r0, rs, rc, fc, fs: coefficients of the model (scene/laws/models.py).
        threshold: uplift |a_g|/(g + a_v).
        q_star: rotation of zero restoring moment [rad]; slope: of the restoring law there, positive.
        eta: restitution when landing on this edge.
        damper: rate of the dashpot c/I_O [1/s].
    """

    sign: float
    p: float
    alpha: float
    R: float
    r0: float
    rs: float
    rc: float
    fc: float
    fs: float
    threshold: float
    q_star: float
    slope: float
    eta: float
    damper: float


@dataclass(frozen=True)
class Body:
    """A case: g [m/s²], whether the model is linear in q, and both edges."""

    g: float
    linear: bool
    left: Edge
    right: Edge

    def edge(self, sign: float) -> Edge:
        """The edge the body turns about at this sign of theta."""
        return self.right if sign > 0.0 else self.left

    @property
    def damped(self) -> bool:
        """Whether energy is lost between impacts."""
        return self.left.damper > 0.0 or self.right.damper > 0.0

    def restoring(self, edge: Edge, q: float) -> float:
        """Restoring moment over m g R."""
        if self.linear:
            return edge.r0 + edge.rs * q
        return edge.r0 + edge.rs * math.sin(q) + edge.rc * math.cos(q)

    def acceleration(self, edge: Edge, q: float, v: float, a_g: float, a_v: float) -> float:
        """q'' of q = |theta| [rad/s^2] for ground accelerations [m/s²]."""
        driving = edge.fc if self.linear else edge.fc * math.cos(q) + edge.fs * math.sin(q)
        moment = (1.0 + a_v / self.g) * self.restoring(edge, q) + edge.sign * a_g / self.g * driving
        return -edge.p * edge.p * moment - edge.damper * v

    def excess(self, edge: Edge, a_g: float, a_v: float) -> float:
        """How much the ground exceeds the uplift threshold of this edge [m/s²]: the body rests while both are <= 0."""
        return -edge.sign * a_g - (self.g + a_v) * edge.threshold

    def barrier(self, edge: Edge, q: float) -> float:
        """Energy missing at q to the unstable equilibrium, over I_O p^2 (T7)."""
        y = edge.q_star - q
        if self.linear:
            return 0.5 * edge.slope * y * y
        return edge.r0 * (y - math.sin(y)) + 2.0 * edge.slope * math.sin(0.5 * y) ** 2

    def beyond(self, edge: Edge, q: float, v: float) -> float:
        """Distance from the separatrix in units of rotation (T8): > 0 falls, < 0 returns to the base."""
        root = math.sqrt(2.0 * max(self.barrier(edge, q), 0.0))
        return v / edge.p - (root if q <= edge.q_star else -root)

    def left_alone(self, edge: Edge, q: float, v: float, margin: float) -> int:
        """Whether the body, left alone at q >= 0 with rate v about `edge`, ever falls.

        Closed form without a dashpot; with one, NOT_YET as long as it cannot be told from the energy.
        `margin` [rad]: nearer than this to a separatrix is `UNDECIDED`.
        """
        if not math.isfinite(edge.q_star):  # (2.10) above 45 degrees: the moment never vanishes
            return RETURNS
        if self.damped:
            return self._damped_alone(edge, q, v)
        u = self.beyond(edge, q, v)
        if abs(u) <= margin:
            return UNDECIDED
        if u > 0.0:
            return FALLS
        energy = 0.5 * v * v + edge.p**2 * (self.barrier(edge, 0.0) - self.barrier(edge, q))
        rate = math.sqrt(2.0 * max(energy, 0.0))
        here = edge
        previous = math.inf
        for _ in range(100_000):  # landing after landing, until the rate is too small for either edge
            here = self.edge(-here.sign)
            rate *= here.eta
            u = self.beyond(here, 0.0, rate)
            if abs(u) <= margin:
                return UNDECIDED
            if u > 0.0:
                return FALLS
            if previous < 0.0:
                return RETURNS
            previous = u
        return UNDECIDED

    def _damped_alone(self, edge: Edge, q: float, v: float) -> int:
        if q >= edge.q_star:
            return FALLS if v >= 0.0 else NOT_YET
        kinetic = 0.5 * (v / edge.p) ** 2
        above = edge.R * (kinetic + self.barrier(edge, 0.0) - self.barrier(edge, q))
        if all(above < side.R * self.barrier(side, 0.0) for side in (self.left, self.right)):
            return RETURNS
        return NOT_YET


def body_of(batch: Batch, case: int) -> Body:
    """The numbers of one case of a batch."""
    model = MODELS[batch.model, batch.geometry]
    block = batch.block
    law = model.law(block.alpha, block.tan_alpha)
    damper = np.zeros_like(block.alpha)
    if batch.damping.coefficient is not None:
        coefficient, g = batch.damping.coefficient[:, None], batch.g[:, None]
        damper = dashpot_rate(coefficient, block.alpha, block.R, block.inertia, g)
    columns = (
        batch.p, block.alpha, block.R, law.r0, law.rs, law.rc, law.fc, law.fs, law.threshold, law.q_star,
        model.slope(law), batch.damping.eta, damper,
    )  # fmt: skip
    left, right = (
        Edge(sign, *(float(column[case, j]) for column in columns)) for j, sign in ((LEFT, -1.0), (RIGHT, 1.0))
    )
    return Body(float(batch.g[case]), model.linear, left, right)
