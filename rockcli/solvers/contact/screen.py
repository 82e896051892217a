"""Bodies whose friction surely suffices, told from how far they rock or its forces (docs/contact.md, section 10)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rockcli.scene.batch import Batch
from rockcli.scene.body.block import LEFT
from rockcli.scene.ground.excitation import PIECE_WIDTH, Channel, Samples, Suite

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

ROUNDING = 1.0 - 1e-9
"""The bound must hold by more than rounding."""


def surely_holds(batch: Batch, peak: Array, returns: Mask) -> Mask:
    """Where a symmetric body that rocked to |theta| = peak (n,) cannot have needed more friction than there is.

    Between an impact and the top of a swing R theta'^2/g is at most 2 peak (sin(alpha) + A) over the inertia
    I_O/(m R^2), with A the largest |a_g|/g: what gravity and the ground can do on the way to the top (K15).
    """
    block = batch.block
    alpha, b, inertia, eta = block.alpha[:, LEFT], block.b[:, LEFT], block.inertia[:, LEFT], batch.damping.eta
    shaken = largest(batch.excitation.suite or batch.excitation.horizontal, batch.size)
    A, sin_a, cos_a = shaken / batch.g, np.sin(alpha), np.cos(alpha)
    spin = 2.0 * peak * (sin_a + A) / inertia
    along = A * (1.0 - cos_a**2 / inertia) + sin_a * np.maximum(1.0 / inertia, spin)
    across = 1.0 - (sin_a**2 + A * sin_a) / inertia - spin
    landing = np.max(block.h[:, None] * (1.0 - eta) / (b[:, None] * (1.0 + eta)), axis=1)
    with np.errstate(invalid="ignore"):
        rocks = along < block.mu * across * ROUNDING
        stands = (block.mu > block.tan_alpha[:, LEFT]) & (landing < block.mu)
    calm = (peak < alpha) & (batch.theta_dot_0 == 0.0)
    return np.asarray(returns & block.symmetric & calm & (across > 0.0) & rocks & stands)


def surely_presses(mu: Array, needs: Array, least: Array) -> Mask:
    """Where friction of at most `needs` and a normal force of `least` m g or more keep the base on the ground, (n,)."""
    with np.errstate(invalid="ignore"):
        return np.asarray((needs < mu * ROUNDING) & (least > 1.0 - ROUNDING))


def largest(channel: Channel | Suite | None, n: int) -> Array:
    """A bound of |a_g|, (n,) [m/s^2]."""
    if channel is None:
        return np.zeros(n)
    if isinstance(channel, Suite):
        return np.array([np.abs(record.values).max() for record in channel.records])[channel.which] * np.abs(
            channel.factor
        )
    if isinstance(channel, Samples):
        return np.broadcast_to(np.abs(channel.values).max() * np.abs(channel.factor), n)
    return np.asarray(channel.table[:, :, PIECE_WIDTH - 1].max(axis=1))
