"""Batches of the full mesh for its tests: the thesis's 50 m x 5 m column of concrete."""

from __future__ import annotations

import shutil
from dataclasses import replace

import numpy as np
import pytest
from scenes import array, make_batch, pulse

from rockcli.scene.batch import Batch
from rockcli.scene.body.block import make_block
from rockcli.scene.body.column import Base, Column
from rockcli.scene.laws.damping import Damping
from rockcli.solvers.calculix.run import HOW_TO_INSTALL

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason=HOW_TO_INSTALL)


def fig60(*, duration: float, **how) -> Batch:
    """Sine pulse of Fig. 60: T_p 1.6 s, a_p 5 g tan(alpha)."""
    return mesh_batch(pulse("sine", 4.905, 2.0 * np.pi / 1.6, duration=duration), **how)


def mesh_batch(
    excitation,
    *,
    across: int = 2,
    along: int = 10,
    h: float = 25.0,
    tan_alpha: float = 0.1,
    E: float = 30e9,
    zeta: float = 0.0,
    theta_0: float = 0.0,
    kw: float | None = None,
    dt: float | None = None,
    dt_out: float = 0.005,
    scheme: str = "none",
    alpha_d: float | None = None,
    accuracy: str = "standard",
) -> Batch:
    body = make_block(h=h, b=h * tan_alpha, tan_alpha=tan_alpha)
    batch = make_batch(
        body, excitation, model="continuum", theta_0=theta_0, histories=True, accuracy=accuracy, dt_out=dt_out
    )
    hht = None if alpha_d is None else array(alpha_d)
    return replace(
        batch,
        column=Column(array(E), array(2500.0), array(zeta), elements=along, across=across),
        base=None if kw is None else Base("winkler", array(kw)),
        damping=Damping(scheme, np.ones((1, 2)), alpha_d=hht),
        numerics=replace(batch.numerics, dt=dt),
    )
