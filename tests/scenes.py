"""Batches built by hand for the tests of the solvers: no study file in between."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from rockcli.scene.batch import Batch, Save
from rockcli.scene.body.block import Block, housner_eta, make_block
from rockcli.scene.ground.excitation import Excitation, Samples
from rockcli.scene.ground.pulses import make_pulses
from rockcli.scene.laws.damping import Damping
from rockcli.scene.numerics import Numerics
from rockcli.scene.response import OVERTURNED_AFTER_IMPACT, OVERTURNED_WITHOUT_IMPACT, Response
from rockcli.scene.variables import GROUND, SCALARS
from rockcli.solvers.common.ground import ground_of_case
from rockcli.solvers.event.solver import solve

G = 9.81
SHARED = Path(__file__).resolve().parents[2] / "shared"
"""Folder of real records beside the checkout; tests that need it skip where it is absent."""


def array(x) -> np.ndarray:
    return np.atleast_1d(np.asarray(x, dtype=float))


def block(R: float, tan_alpha: float, n: int = 1) -> Block:
    """Rectangular blocks of size R and slenderness tan(alpha), n of them."""
    alpha = np.arctan(tan_alpha)
    return make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=tan_alpha, n=n)


def unit_block(alpha: float = 0.1, p: float = 1.0) -> Block:
    """A rectangular block of given alpha and frequency parameter, so that p t = t for p = 1."""
    R = 0.75 * G / p**2
    return make_block(h=R * np.cos(alpha), b=R * np.sin(alpha), R=R, alpha=alpha, tan_alpha=np.tan(alpha))


def repeated(body: Block, n: int) -> Block:
    """One body n times."""
    given = {f: getattr(body, f) for f in body.__dataclass_fields__}
    return Block(**{f: None if values is None else np.repeat(values, n, axis=0) for f, values in given.items()})


def still(duration: float | np.ndarray = np.nan) -> Excitation:
    return Excitation(None, None, array(duration))


def pulse(shape: str, a_p, omega_p, *, duration: float = np.nan, **options) -> Excitation:
    channel = make_pulses(shape, a_p=array(a_p), omega_p=array(omega_p), **{k: array(v) for k, v in options.items()})
    return Excitation(channel, None, np.full(len(channel.a_p), duration))


def record(values, dt: float, *, factor=1.0, vertical=None, duration: float = np.nan) -> Excitation:
    factor = array(factor)
    up = None if vertical is None else Samples(np.asarray(vertical, float), dt, np.ones_like(factor))
    return Excitation(Samples(np.asarray(values, float), dt, factor), up, np.full(len(factor), duration))


def make_batch(
    body: Block,
    excitation: Excitation,
    *,
    eta="housner",
    model: str = "rigid",
    theta_0: float | np.ndarray = 0.0,
    theta_dot_0: float | np.ndarray = 0.0,
    g: float = G,
    accuracy: str = "reference",
    histories: bool = False,
    dt_out: float = 0.005,
    scalars=tuple(s for s in SCALARS if s not in ("error_estimate", "overturn_share")),
) -> Batch:
    n = body.size
    ratio = np.clip(housner_eta(body), 0.0, 1.0) if isinstance(eta, str) else np.broadcast_to(array(eta), (n, 2))
    return Batch(
        g=np.full(n, g),
        block=body,
        excitation=excitation,
        theta_0=np.full(n, theta_0),
        theta_dot_0=np.full(n, theta_dot_0),
        model=model,
        geometry=None,
        damping=Damping("restitution", np.ascontiguousarray(ratio)),
        numerics=Numerics(accuracy=accuracy),
        save=Save(histories, dt_out, frozenset(scalars)),
    )


def rock(body: Block, excitation: Excitation, **how) -> Response:
    return solve(make_batch(body, excitation, **how))


def with_ground(response: Response, body: Block, excitation: Excitation) -> Response:
    """A response of one case with a_g and a_v among its histories, as a dataset has them."""
    both = ground_of_case(make_batch(body, excitation), 0, response.time)
    told = dict(zip(GROUND, (values[None] for values in both), strict=True))
    return replace(response, histories=response.histories | told)


def peak(response: Response) -> float:
    """Largest |theta|/alpha of one case, which has an answer."""
    assert int(response.scalars["outcome"][0]) >= 0, response.reasons
    return float(response.scalars["theta_peak_over_alpha"][0])


def overturns(response: Response) -> bool:
    outcome = int(response.scalars["outcome"][0])
    assert outcome >= 0, response.reasons
    return outcome in (OVERTURNED_WITHOUT_IMPACT, OVERTURNED_AFTER_IMPACT)


def theta_at(response: Response, t, case: int = 0) -> np.ndarray:
    """theta at times that are output times."""
    index = np.rint(np.asarray(t) / response.time[1]).astype(int)
    np.testing.assert_allclose(response.time[index], t, rtol=1e-12)
    return response.histories["theta"][case, index]
