"""Friction and contact of a body on the ground: the five modes of contact, and when it only slides.

Friction is Coulomb's; `mu` is the coefficient at rest, which decides what begins.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rockcli.kernels.constants import SAME
from rockcli.kernels.contact.codes import FLIGHT, REST, ROCK, SLIDE, SLIDE_ROCK
from rockcli.scene.batch import Batch
from rockcli.scene.laws.models import MODELS

MODES: dict[int, str] = {
    REST: "rest",
    SLIDE: "slide",
    ROCK: "rock",
    SLIDE_ROCK: "slide_rock",
    FLIGHT: "flight",
}
"""Flags of the history `contact_mode`."""


def slides_first(mu: ArrayLike, tan_alpha: ArrayLike) -> NDArray[np.bool_]:
    """Where friction lets a body slide before it can rock: mu <= tan(alpha); False where no mu is given (NaN).

    While a body slides, friction is mu N whatever the ground does, and its moment mu N h about the centre of mass
    needs the normal force no farther out than mu h from the middle: within the base, at mu = tan(alpha) at its edge.
    """
    with np.errstate(invalid="ignore"):
        return np.asarray(np.asarray(mu) <= np.asarray(tan_alpha) * SAME)


def slides_only(batch: Batch) -> NDArray[np.bool_]:
    """Which cases can slide and never rock, (n,): mu is given and at most tan(alpha) of both edges, from rest."""
    block, pair = batch.block, (batch.model, batch.geometry)
    if pair not in MODELS:
        return np.zeros(batch.size, dtype=bool)
    threshold = MODELS[pair].law(block.alpha, block.tan_alpha).threshold.min(axis=1)
    return np.asarray(slides_first(block.mu, threshold) & (batch.theta_0 == 0.0) & (batch.theta_dot_0 == 0.0))


def mode_from_rest(
    tan_alpha: ArrayLike, inertia: ArrayLike, mu: ArrayLike, a_h: ArrayLike, a_v: ArrayLike = 0.0
) -> NDArray[np.int64]:
    """The mode in which a body at rest begins to move under accelerations a_h, a_v (over g) of the ground.

    Shenton (1996), Criteria for initiation of slide, rock, and slide-rock rigid-body modes, J. Eng. Mech. 122(7), for
    any inertia I_O/(m R^2) and with vertical acceleration.  `mu_rock` is the friction that the edge needs as rocking
    begins; it grows with a_h.
    """
    tan_alpha, inertia, mu, a_h, a_v = np.broadcast_arrays(*map(np.asarray, (tan_alpha, inertia, mu, a_h, a_v)))
    weight, a = 1.0 + a_v, np.abs(a_h)
    with np.errstate(divide="ignore", invalid="ignore"):
        # lengths over h: angular acceleration psi h/g about the edge, then T and N at it
        psi = np.maximum(a - weight * tan_alpha, 0.0) / (inertia * (1.0 + tan_alpha**2))
        mu_rock = (a - psi) / (weight + tan_alpha * psi)
    begins = np.where(mu_rock > mu, SLIDE_ROCK, ROCK)
    mode = np.where(a > weight * tan_alpha, begins, REST)
    mode = np.where(slides_first(mu, tan_alpha), np.where(a > weight * mu, SLIDE, REST), mode)
    return np.where(weight <= 0.0, FLIGHT, mode)
