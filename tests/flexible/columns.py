"""Columns of the thesis's chapter 4, built by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scenes import G, array, make_batch, pulse

from rockcli.scene.batch import Batch
from rockcli.scene.body.block import make_block
from rockcli.scene.body.column import Base, Column
from rockcli.scene.ground.excitation import Excitation
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import Response
from rockcli.solvers.flexible import solve

E_CONCRETE, RHO = 30e9, 2500.0


def column_batch(
    motion: Excitation,
    *,
    h: float = 25.0,
    tan_alpha: float = 0.1,
    E=E_CONCRETE,
    rho=RHO,
    zeta=0.01,
    n: int = 10,
    mass: str = "consistent",
    eta="housner",
    kw: float | None = None,
    accuracy: str = "standard",
    dt: float | None = None,
    **how,
) -> Batch:
    """The 50 x 5 m column of concrete unless said otherwise."""
    body = make_block(h=h, b=h * tan_alpha, tan_alpha=tan_alpha, alpha=np.arctan(tan_alpha))
    batch = make_batch(body, motion, eta=eta, **how)
    return replace(
        batch,
        model="flexible",
        column=Column(array(E), array(rho), array(zeta), n, mass),
        base=None if kw is None else Base("winkler", array(kw)),
        numerics=Numerics(accuracy=accuracy, dt=dt),
    )


def rock_column(motion: Excitation, **how) -> Response:
    return solve(column_batch(motion, **how))


def sine(a_p_over_g_tan_alpha: float = 5.0, T_p: float = 1.6, *, tan_alpha: float = 0.1, **options) -> Excitation:
    """The one-cycle sine of Figs 60 and 63."""
    return pulse("sine", a_p_over_g_tan_alpha * G * tan_alpha, 2.0 * np.pi / T_p, **options)


def ricker(a_p_over_g_tan_alpha: float, T_p: float) -> Excitation:
    return pulse("ricker", a_p_over_g_tan_alpha * G * 0.1, 2.0 * np.pi / T_p)


def scalar(response: Response, name: str) -> float:
    return float(response.scalars[name][0])
