"""Batches for the frame backend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scenes import G, array, block, make_batch, pulse, still

from rockcli.scene.batch import Batch
from rockcli.scene.body.block import make_block
from rockcli.scene.body.column import Base, Column
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import Response

PAIRS = [(model, geometry) for geometry in ("negative_stiffness", "corotational") for model in "1234"]


def ricker(
    model: str, geometry: str, *, R: float = 2.0, tan_alpha: float = 0.1, amplitude: float = 3.6, **how
) -> Batch:
    """Fig. 7: a Ricker pulse of 3.6 g tan(alpha), 3 pi rad/s."""
    excitation = how.pop("excitation", None) or pulse("ricker", amplitude * G * tan_alpha, 3.0 * np.pi)
    return replace(make_batch(block(R, tan_alpha), excitation, model=model, **how), geometry=geometry)


def framed(batch: Batch, *, dt: float | None = 1e-4, yield_rotation: float | None = 1e-6, **numerics) -> Batch:
    """The batch with settings of the frame backend."""
    return replace(batch, numerics=Numerics(backend="frame", dt=dt, yield_rotation=yield_rotation, **numerics))


def column(
    *, E=30e9, zeta=0.01, n=5, mass="consistent", eta=1.0, height=50.0, tan_alpha=0.1, amplitude=5.0, T_p=1.6, **how
) -> Batch:
    """Figs 60, 63: a concrete column under one sine."""
    body = make_block(h=0.5 * height, b=0.5 * height * tan_alpha)
    excitation = how.pop("excitation", None) or pulse("sine", amplitude * G * tan_alpha, 2.0 * np.pi / T_p)
    batch = make_batch(body, excitation, eta=eta, model="flexible", **how)
    return replace(batch, column=Column(array(E), array(2500.0), array(zeta), n, mass))


def on_fibres(*, kw: float, fibres: int, alpha_d: float = 0.7, tan_alpha: float = 0.2, duration: float = 9.0) -> Batch:
    """Free rocking of model 4, R = 10 m, from alpha/2 on a no-tension base, damped by the integrator alone."""
    body = block(10.0, tan_alpha)
    batch = make_batch(
        body, still(duration), eta=1.0, model="4", theta_0=0.5 * float(body.alpha[0, 0]), histories=True, dt_out=2e-3
    )
    return replace(
        batch,
        geometry="corotational",
        base=Base("winkler", array(kw), fibres),
        damping=Damping("hht", np.ones((1, 2)), alpha_d=array(alpha_d)),
    )


def restitution(response: Response, alpha: float) -> np.ndarray:
    """Ratio of angular velocities each swing keeps, from the energies of its turning points under (2.10)."""
    theta = response.histories["theta"][0]
    theta = theta[np.isfinite(theta)]
    swings = np.split(np.abs(theta), np.flatnonzero(theta[1:] * theta[:-1] < 0.0) + 1)
    q = np.array([x.max() for x in swings if x.max() > 0.02 * alpha])
    energy = np.sin(alpha) * q - np.cos(alpha) * (1.0 - np.cos(q))
    return np.sqrt(energy[1:] / energy[:-1])[:-1]
