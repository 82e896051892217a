"""The cases of the thesis that the tests solve with OpenSees."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scenes import G, array, block, make_batch, make_block, pulse

from rockcli.scene.batch import Batch
from rockcli.scene.body.column import Column
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics

_LOADS = subprocess.run([sys.executable, "-c", "import openseespy.opensees"], capture_output=True, check=False)

needs_opensees = pytest.mark.skipif(
    _LOADS.returncode != 0, reason="needs OpenSeesPy: pip install 'rockcli[opensees]', libblas3, liblapack3"
)

PULSES = [
    (R, shape, omega_p * np.pi, tan_alpha)
    for R, ricker, sine in ((2.0, 3.0, 4.44), (5.0, 2.0, 2.66), (10.0, 1.4, 1.905))
    for shape, omega_p in (("ricker", ricker), ("sine", sine))
    for tan_alpha in (0.1, 0.2, 0.333)
]
"""R [m], shape, omega_p [rad/s], tan alpha: the eighteen cases with a_p = 3.6 g tan alpha."""


def rigid(
    R: float = 2.0,
    shape: str = "ricker",
    omega_p: float = 3.0 * np.pi,
    tan_alpha: float = 0.2,
    *,
    model: str = "3",
    geometry: str = "corotational",
    scheme: str = "restitution",
    factor: float = 3.6,
    duration: float = np.nan,
    numerics: Numerics | None = None,
    **how,
) -> Batch:
    motion = pulse(shape, factor * G * tan_alpha, omega_p, duration=duration)
    batch = make_batch(block(R, tan_alpha), motion, eta="housner" if scheme == "restitution" else 1.0, **how)
    damping = Damping(scheme, batch.damping.eta, array(0.02) if scheme == "dashpot" else None)
    numerics = numerics or Numerics(accuracy="standard")
    return replace(batch, model=model, geometry=geometry, damping=damping, numerics=numerics)


def flexible(*, eta, zeta: float, elements: int = 5, mass: str = "lumped", duration: float = 9.0, **how) -> Batch:
    """The column of Figs 60 and 63: 50 x 5 m, sine T_p = 1.6 s, 5 g tan alpha."""
    body = make_block(h=25.0, b=2.5, tan_alpha=0.1)
    motion = pulse("sine", 5.0 * G * 0.1, 2.0 * np.pi / 1.6, duration=duration)
    batch = make_batch(body, motion, eta=eta, accuracy="standard", **how)
    column = Column(array(30e9), array(2500.0), array(zeta), elements, mass)
    return replace(batch, model="flexible", geometry=None, column=column)
